/* The file that a film grows in: a head, and pieces, each behind a mark that says what it is.
 * It is Matroska, and marks are Void elements, which players skip: it plays at any time. A mark
 * is written when its piece is complete, so that whatever stopped a program, what is whole is
 * known from the file alone. */
#ifndef ZT_ENCODE_VIDEO_PART_H
#define ZT_ENCODE_VIDEO_PART_H

#include <stdbool.h>

#include "encode/video_libav.h"
#include "encode/video_piece.h"

/* A piece that is complete. */
typedef struct zt_video_piece {
    int64_t first, count; /* positions of its frames */
    zt_hash key;          /* of what decides its bytes; zero: not known */
    zt_hash checksum;     /* of its packets */
    int64_t begin, end;   /* its bytes in the file */
    int64_t delay;        /* how many packets the last one that is decoded early waits */
    double render_s;      /* that its frames took, added up */
} zt_video_piece;

/* Zeroed, but for `file` -1: nothing is open. */
typedef struct zt_video_part {
    const zt_video_ear *ear;
    int file;
    AVRational rate;
    uint8_t *head;
    int head_size;
    int64_t end; /* of the last piece */
    zt_video_piece *pieces;
    int64_t count, capacity;
    zt_piece_muxer muxer; /* of the piece under way */
    bool under_way;
} zt_video_part;

/* Opens or makes the file at `path` for packets like `parameters`. `keeps`: with those pieces
 * that are there whole, if its head is that of such a film; all else is cut away. */
zt_status zt_video_part_open(zt_video_part *part, const char *path,
                             const AVCodecParameters *parameters, AVRational rate, bool keeps,
                             const zt_video_ear *ear);

/* The index of the piece with this key; -1: there is none. */
int64_t zt_video_part_find(const zt_video_part *part, int64_t first, int64_t count,
                           zt_hash key);

/* Begins a piece at the end. `parameters` may hold what an encoder says of itself in another
 * way, but must mean the same: ZT_EFILE, told, where the head would be another one. */
zt_status zt_video_part_begin(zt_video_part *part, const AVCodecParameters *parameters,
                              int64_t first);

/* Packets in the order of decoding, `pts` counted from the piece's first frame. */
zt_status zt_video_part_put(zt_video_part *part, AVPacket *packet);

/* Completes the piece, which is the last one then, after reading it back: ZT_EFILE, told, where
 * it has not `count` packets. */
zt_status zt_video_part_finish(zt_video_part *part, int64_t count, zt_hash key,
                               double render_s);

/* Takes back the piece under way, if one is; or the last one that was completed. */
void zt_video_part_abandon(zt_video_part *part);
void zt_video_part_take_back(zt_video_part *part);

/* Opens a piece for reading. */
int zt_video_part_read(zt_piece_reader *reader, const zt_video_part *part,
                       const zt_video_piece *piece);
void zt_video_part_close(zt_video_part *part);

#endif
