#include "encode/video_spool.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <libavutil/imgutils.h>

#include "base/hash.h"
#include "base/text.h"

/* What stands before a frame's numbers. */
typedef struct head {
    uint8_t magic[8];
    int64_t width, height, format, position;
    zt_hash key, checksum;
    double render_s;
} head;
static const uint8_t magic[8] = "Zt frame";

static zt_status refuse(const zt_video_spool *s) {
    return zt_libav_refuse(s->ear, AVERROR(errno));
}

static head head_of(const zt_video_spool *s, int64_t position, zt_hash key, double render_s) {
    head h = {.width = s->like->width,
              .height = s->like->height,
              .format = s->like->format,
              .position = position,
              .key = key,
              .checksum = zt_hash_bytes(s->bytes, (size_t)s->frame_size),
              .render_s = render_s};
    memcpy(h.magic, magic, sizeof magic);
    return h;
}

/* Whether a head is of a frame of this film and of the numbers that are in s->bytes. */
static bool is_like(const zt_video_spool *s, const head *h) {
    zt_hash checksum = zt_hash_bytes(s->bytes, (size_t)s->frame_size);
    return memcmp(h->magic, magic, sizeof magic) == 0 && h->width == s->like->width &&
           h->height == s->like->height && h->format == s->like->format &&
           zt_hash_equal(h->checksum, checksum);
}

static bool get(const zt_video_spool *s, void *bytes, size_t size, int64_t at) {
    return pread(s->file, bytes, size, at) == (ssize_t)size;
}

static bool put(const zt_video_spool *s, const void *bytes, size_t size, int64_t at) {
    ssize_t done = pwrite(s->file, bytes, size, at);
    if (done >= 0 && done < (ssize_t)size) errno = ENOSPC;
    return done == (ssize_t)size;
}

static zt_status push(zt_video_spool *s, const zt_video_spooled *frame) {
    if (s->count == s->capacity) {
        int64_t more = s->capacity ? 2 * s->capacity : 64;
        zt_video_spooled *frames = reallocarray(s->frames, (size_t)more, sizeof *frames);
        if (!frames) return ZT_EMEMORY;
        s->frames = frames;
        s->capacity = more;
    }
    s->frames[s->count++] = *frame;
    s->size = frame->at + s->frame_size;
    return ZT_OK;
}

/* All are of one size; one that is damaged is passed over. */
static zt_status recover(zt_video_spool *s, int64_t size) {
    int64_t stride = (int64_t)sizeof(head) + s->frame_size;
    for (int64_t at = 0; stride <= size - at; at += stride) {
        head found;
        if (!get(s, &found, sizeof found, at) ||
            !get(s, s->bytes, (size_t)s->frame_size, at + (int64_t)sizeof found))
            break;
        if (!is_like(s, &found) || found.position < 0 || !isfinite(found.render_s)) continue;
        zt_video_spooled frame = {found.position, found.key, found.render_s,
                                  at + (int64_t)sizeof found};
        ZT_TRY(push(s, &frame));
    }
    return ZT_OK;
}

zt_status zt_video_spool_open(zt_video_spool *s, const char *path, const AVFrame *like,
                              bool keeps, const zt_video_ear *ear) {
    *s = (zt_video_spool){.ear = ear, .file = -1, .like = like};
    int size = av_image_get_buffer_size(like->format, like->width, like->height, 1);
    s->frame_size = size;
    s->path = strdup(path);
    s->bytes = size > 0 ? malloc((size_t)size) : NULL;
    if (!s->path || !s->bytes) return ZT_EMEMORY;
    s->file = open(path, O_RDWR | O_CLOEXEC);
    struct stat there;
    if (s->file < 0) return errno == ENOENT ? ZT_OK : refuse(s);
    if (fstat(s->file, &there) != 0) return refuse(s);
    if (keeps) ZT_TRY(recover(s, there.st_size));
    return ftruncate(s->file, s->size) == 0 ? ZT_OK : refuse(s);
}

const zt_video_spooled *zt_video_spool_find(const zt_video_spool *s, int64_t position,
                                            zt_hash key) {
    for (int64_t i = 0; i < s->count && zt_hash_is_known(key); i++)
        if (s->frames[i].position == position && zt_hash_equal(s->frames[i].key, key))
            return &s->frames[i];
    return NULL;
}

zt_status zt_video_spool_put(zt_video_spool *s, const AVFrame *frame, int64_t position,
                             zt_hash key, double render_s) {
    if (s->file < 0) s->file = open(s->path, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (s->file < 0) return refuse(s);
    int size = av_image_copy_to_buffer(s->bytes, (int)s->frame_size,
                                       (const uint8_t *const *)frame->data, frame->linesize,
                                       frame->format, frame->width, frame->height, 1);
    AV_TRY(s->ear, size);
    head what = head_of(s, position, key, render_s);
    zt_video_spooled added = {position, key, render_s, s->size + (int64_t)sizeof what};
    /* The numbers first: a head without them would have to be read to be known as such. */
    bool written = put(s, s->bytes, (size_t)s->frame_size, added.at) &&
                   put(s, &what, sizeof what, s->size);
    return written ? push(s, &added) : refuse(s);
}

/* Readers may look past the ends of lines: what is there must not depend on what memory held.
 */
static zt_status make_frame(AVFrame **frame, const zt_video_spool *s) {
    AVFrame *f = *frame = av_frame_alloc();
    if (!f) return ZT_EMEMORY;
    f->width = s->like->width;
    f->height = s->like->height;
    f->format = s->like->format;
    AV_TRY(s->ear, av_frame_get_buffer(f, 0));
    for (int i = 0; i < AV_NUM_DATA_POINTERS && f->buf[i]; i++)
        memset(f->buf[i]->data, 0, f->buf[i]->size);
    AV_TRY(s->ear, av_frame_copy_props(f, s->like));
    return ZT_OK;
}

static zt_status fill(AVFrame *frame, const zt_video_spool *s) {
    uint8_t *planes[4];
    int strides[4];
    AV_TRY(s->ear, av_image_fill_arrays(planes, strides, s->bytes, frame->format, frame->width,
                                        frame->height, 1));
    av_image_copy(frame->data, frame->linesize, (const uint8_t **)planes, strides,
                  frame->format, frame->width, frame->height);
    return ZT_OK;
}

zt_status zt_video_spool_get(AVFrame **frame, const zt_video_spool *s,
                             const zt_video_spooled *spooled) {
    *frame = NULL;
    if (!get(s, s->bytes, (size_t)s->frame_size, spooled->at)) return refuse(s);
    zt_status status = make_frame(frame, s);
    if (status == ZT_OK) status = fill(*frame, s);
    if (status != ZT_OK) av_frame_free(frame);
    return status;
}

zt_status zt_video_spool_pass(zt_video_spool *s, int64_t position) {
    for (int64_t i = 0; i < s->count; i++)
        if (s->frames[i].position >= position) return ZT_OK;
    if (s->size == 0) return ZT_OK;
    s->count = s->size = 0;
    return ftruncate(s->file, 0) == 0 ? ZT_OK : refuse(s);
}

void zt_video_spool_close(zt_video_spool *s, bool keeps) {
    if (s->file >= 0) close(s->file);
    if (s->path && s->file >= 0 && !(keeps && s->count > 0)) unlink(s->path);
    free(s->path);
    free(s->bytes);
    free(s->frames);
    *s = (zt_video_spool){.file = -1};
}
