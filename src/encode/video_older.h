/* Pieces that the finished film of an earlier run has, taken over into the one that grows. */
#ifndef ZT_ENCODE_VIDEO_OLDER_H
#define ZT_ENCODE_VIDEO_OLDER_H

#include "encode/video_part.h"

/* What is wished for. */
typedef struct zt_video_wished {
    int64_t count;    /* of frames of the piece */
    zt_hash key;      /* of the piece */
    zt_hash checksum; /* of its packets; zero: it is not wished for */
    double render_s;
} zt_video_wished;

/* Copies from the file at `path` what is wished for: pieces of `piece_frames` frames each, the
 * first one from frame 0 on. `parameters` are the encoder's; a file whose description of itself
 * is another one, and pieces whose packets are other ones, are passed over. Files may hold
 * anything: whatever fails ends the copying, silently, as what is not copied is made again. */
void zt_video_take_older(zt_video_part *part, const char *path, const zt_video_wished *wished,
                         int64_t wished_count, int64_t piece_frames,
                         const AVCodecParameters *parameters);

#endif
