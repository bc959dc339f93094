#include "encode/video_part.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PIECE_FRAMES_MAX = 1 << 20 };

/* What stands before a piece: an element of EBML (RFC 8794) that says nothing to players. Zeros
 * while the piece is not complete. */
typedef struct mark {
    uint8_t magic[8];
    int64_t first, count, length, delay;
    zt_hash key, checksum;
    double render_s;
} mark;
enum { MARK_HEAD = 2, MARK_SIZE = MARK_HEAD + sizeof(mark) };
static const uint8_t magic[8] = "Zt piece", element[MARK_HEAD] = {0xEC, 0x80 | sizeof(mark)};

static zt_status refuse(const zt_video_part *p) {
    return zt_libav_refuse(p->ear, AVERROR(errno));
}

/* Reads or writes all of it. */
static bool get(const zt_video_part *p, void *bytes, size_t size, int64_t at) {
    return pread(p->file, bytes, size, at) == (ssize_t)size;
}

static bool put(const zt_video_part *p, const void *bytes, size_t size, int64_t at) {
    ssize_t done = pwrite(p->file, bytes, size, at);
    if (done >= 0 && done < (ssize_t)size) errno = ENOSPC;
    return done == (ssize_t)size;
}

static bool put_mark(const zt_video_part *p, const mark *what, int64_t at) {
    uint8_t bytes[MARK_SIZE];
    memcpy(bytes, element, sizeof element);
    memcpy(bytes + MARK_HEAD, what, sizeof *what);
    return put(p, bytes, sizeof bytes, at);
}

static zt_status push(zt_video_part *p, const zt_video_piece *piece) {
    if (p->count == p->capacity) {
        int64_t more = p->capacity ? 2 * p->capacity : 64;
        zt_video_piece *pieces = reallocarray(p->pieces, (size_t)more, sizeof *pieces);
        if (!pieces) return ZT_EMEMORY;
        p->pieces = pieces;
        p->capacity = more;
    }
    p->pieces[p->count++] = *piece;
    p->end = piece->end;
    return ZT_OK;
}

int zt_video_part_read(zt_piece_reader *reader, const zt_video_part *p,
                       const zt_video_piece *piece) {
    return zt_piece_open(reader, p->head, p->head_size, p->rate, piece->first, p->file,
                         piece->begin, piece->end);
}

/* Reads a piece's packets: how many, in which order, their checksum. */
static int examine(const zt_video_part *p, zt_video_piece *piece) {
    zt_piece_reader reader;
    int error = zt_video_part_read(&reader, p, piece);
    piece->count = piece->delay = 0;
    piece->checksum = (zt_hash){0};
    while (error >= 0 && piece->count < PIECE_FRAMES_MAX &&
           (error = zt_piece_next(&reader)) >= 0) {
        int64_t number = reader.packet->pts, rank = piece->count++;
        if (rank - number > piece->delay) piece->delay = rank - number;
        piece->checksum = zt_packet_checksum(piece->checksum, reader.packet, number);
    }
    zt_piece_end(&reader);
    return error == AVERROR_EOF ? 0 : error;
}

/* Reads the mark at `at`. False where there is none of a piece that the file has room for. */
static bool read_mark(mark *found, const zt_video_part *p, int64_t at, int64_t size) {
    uint8_t bytes[MARK_SIZE];
    if (size - at < MARK_SIZE || !get(p, bytes, sizeof bytes, at)) return false;
    memcpy(found, bytes + MARK_HEAD, sizeof *found);
    return memcmp(bytes, element, sizeof element) == 0 &&
           memcmp(found->magic, magic, sizeof magic) == 0 && found->length > 0 &&
           found->length <= size - at - MARK_SIZE && found->first >= 0 &&
           found->first < INT64_MAX / 2000 && found->count > 0 && isfinite(found->render_s);
}

/* Of each piece, its mark must be there, and its packets those of which the mark tells. One
 * that is damaged is passed over. */
static zt_status recover(zt_video_part *p, int64_t size) {
    mark found;
    for (int64_t at = p->end; read_mark(&found, p, at, size);) {
        zt_video_piece piece = {.first = found.first, .key = found.key};
        piece.begin = at + MARK_SIZE;
        piece.end = at = piece.begin + found.length;
        piece.render_s = found.render_s;
        if (examine(p, &piece) >= 0 && piece.count == found.count &&
            piece.delay == found.delay && zt_hash_equal(piece.checksum, found.checksum))
            ZT_TRY(push(p, &piece));
    }
    return ZT_OK;
}

/* Whether the file begins with the head of this film. */
static bool has_head(const zt_video_part *p, int64_t size) {
    if (size < p->head_size) return false;
    uint8_t *found = malloc((size_t)p->head_size);
    bool same_head = found && get(p, found, (size_t)p->head_size, 0) &&
                     memcmp(found, p->head, (size_t)p->head_size) == 0;
    free(found);
    return same_head;
}

static zt_status make_head(zt_video_part *p, const AVCodecParameters *parameters) {
    zt_piece_muxer muxer;
    int error = zt_piece_begin(&muxer, parameters, p->rate, 0, p->file, 0);
    p->head = muxer.head;
    p->head_size = muxer.head_size;
    muxer.head = NULL;
    zt_piece_close(&muxer);
    AV_TRY(p->ear, error);
    p->end = p->head_size;
    return ZT_OK;
}

zt_status zt_video_part_open(zt_video_part *p, const char *path,
                             const AVCodecParameters *parameters, AVRational rate, bool keeps,
                             const zt_video_ear *ear) {
    *p = (zt_video_part){.ear = ear, .rate = rate};
    p->file = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    struct stat there;
    if (p->file < 0 || fstat(p->file, &there) != 0) return refuse(p);
    ZT_TRY(make_head(p, parameters));
    bool ours = keeps && has_head(p, there.st_size);
    if (ours) ZT_TRY(recover(p, there.st_size));
    if (ftruncate(p->file, ours ? p->end : 0) != 0) return refuse(p);
    return put(p, p->head, (size_t)p->head_size, 0) ? ZT_OK : refuse(p);
}

int64_t zt_video_part_find(const zt_video_part *p, int64_t first, int64_t count, zt_hash key) {
    if (!zt_hash_is_known(key)) return -1;
    for (int64_t i = p->count - 1; i >= 0; i--)
        if (p->pieces[i].first == first && p->pieces[i].count == count &&
            zt_hash_equal(p->pieces[i].key, key))
            return i;
    return -1;
}

zt_status zt_video_part_begin(zt_video_part *p, const AVCodecParameters *parameters,
                              int64_t first) {
    const mark nothing = {.magic = {0}};
    if (!put_mark(p, &nothing, p->end)) return refuse(p);
    p->under_way = true;
    AV_TRY(p->ear,
           zt_piece_begin(&p->muxer, parameters, p->rate, first, p->file, p->end + MARK_SIZE));
    if (p->muxer.head_size == p->head_size &&
        memcmp(p->muxer.head, p->head, (size_t)p->head_size) == 0)
        return ZT_OK;
    return zt_video_refuse(p->ear, ZT_EFILE,
                           "the encoder describes frames from %lld on in another way than "
                           "those before",
                           (long long)first);
}

zt_status zt_video_part_put(zt_video_part *p, AVPacket *packet) {
    AV_TRY(p->ear, zt_piece_put(&p->muxer, packet));
    return ZT_OK;
}

static zt_status complete(zt_video_part *p, int64_t count, zt_hash key, double render_s) {
    AV_TRY(p->ear, zt_piece_finish(&p->muxer));
    zt_video_piece piece = {.first = p->muxer.first,
                            .key = key,
                            .begin = p->end + MARK_SIZE,
                            .end = p->muxer.at,
                            .render_s = render_s};
    AV_TRY(p->ear, examine(p, &piece));
    if (piece.count != count)
        return zt_video_refuse(p->ear, ZT_EFILE, "%lld frames became %lld", (long long)count,
                               (long long)piece.count);
    mark whole = {.first = piece.first,
                  .count = count,
                  .length = piece.end - piece.begin,
                  .delay = piece.delay,
                  .key = key,
                  .checksum = piece.checksum,
                  .render_s = render_s};
    memcpy(whole.magic, magic, sizeof magic);
    int64_t at = p->end;
    ZT_TRY(push(p, &piece));
    return put_mark(p, &whole, at) ? ZT_OK : refuse(p);
}

static void stop(zt_video_part *p) {
    zt_piece_close(&p->muxer);
    p->under_way = false;
}

zt_status zt_video_part_finish(zt_video_part *p, int64_t count, zt_hash key, double render_s) {
    zt_status status = complete(p, count, key, render_s);
    stop(p);
    return status;
}

/* Where the file cannot be cut, the next piece writes over what is there. */
static void cut(const zt_video_part *p) {
    if (ftruncate(p->file, p->end) != 0) errno = 0;
}

void zt_video_part_abandon(zt_video_part *p) {
    if (!p->under_way) return;
    stop(p);
    cut(p);
}

void zt_video_part_take_back(zt_video_part *p) {
    if (p->count == 0) return;
    p->end = p->pieces[--p->count].begin - MARK_SIZE;
    cut(p);
}

void zt_video_part_close(zt_video_part *p) {
    stop(p);
    if (p->file >= 0) close(p->file);
    av_free(p->head);
    free(p->pieces);
    *p = (zt_video_part){.file = -1};
}
