/* Finished frames are rendered again, and compared with what they were. */
#ifndef ZT_SEQUENCE_VERIFY_H
#define ZT_SEQUENCE_VERIFY_H

#include <zoetrope/film.h>

#include "sequence/manifest.h"

/* Finished frames, by position. */
typedef struct zt_verify_job {
    const int64_t *frames;
    const zt_hash *keys;
    const bool *wanted; /* those that are are not finished */
    int64_t count;
    const zt_manifest *known;
    const char *target;
} zt_verify_job;

/* Renders up to `most` finished frames again, spread over the film, and sets how many
 * were the same. Their files are whole, which is how they came to be finished; what is compared
 * is the checksum of their numbers, as it was when the files were made of them. ZT_EFILE, told
 * with each frame and its file, where one is not the same; fails as rendering does. */
zt_status zt_verify_frames(int64_t *verified, const zt_verify_job *job, int64_t most,
                           zt_renderer *renderer, const zt_watcher *watcher);

#endif
