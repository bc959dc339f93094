/* How frames are divided among processes that share a target. */
#ifndef ZT_SEQUENCE_SPLIT_H
#define ZT_SEQUENCE_SPLIT_H

#include "sequence/manifest.h"
#include "sequence/renderer.h"

/* Leaves part `part` of `count`, from 1 on; maybe none. Parts are stretches of the list that
 * took about as long by what the manifest knows of all its frames; where it does not, they are
 * equally many. All processes come to the same parts, whatever others have added meanwhile: the
 * first one that divides these frames, as they are now, notes it down, and it counts for ever.
 * `notes` NULL: equally many. Fails as freezing does. */
zt_status zt_split_take(zt_frames *frames, int64_t part, int64_t count, zt_notes *notes,
                        zt_renderer *renderer);

/* Where each part ends. `costs` by position, none negative; NULL: all the same. */
void zt_split_ends(int64_t *ends, int64_t count, const double *costs, int64_t frame_count);

#endif
