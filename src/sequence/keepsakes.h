/* Keepsakes of a film's frames (render/keepsake.h), in files beside its target: after an edit
 * of the description, tiles that it cannot affect are copied from them.
 *
 * TARGET.keepsakes/N is that of frame N, of whatever version of the description; it says by
 * itself what it is good for. All take no more than the disk has free. One is made behind the
 * rendering, where tiles can be copied from such frames at all, the frame took much longer than
 * making and finding it does, and as long as there is room; where there is none, those of the
 * frames that took longest stay. */
#ifndef ZT_SEQUENCE_KEEPSAKES_H
#define ZT_SEQUENCE_KEEPSAKES_H

#include <zoetrope/frames.h>

#include "sequence/renderer.h"

typedef struct zt_keepsakes_order {
    const char *target;
    const zt_frames *frames; /* that are rendered */
    int64_t part_count;      /* 0, or how many processes share the target, each with frames of
                                its own */
    int64_t bytes_max;       /* of all together; 0: there are none any more */
    bool anew;               /* those of earlier runs go */
} zt_keepsakes_order;

/* Finds what earlier runs left, and removes of it what nobody knows, what is of frames that the
 * film has no more, and what there is no room for. *keepsakes is NULL where nothing is to be
 * kept, or copied by the renderer. The order's frames, and the renderer, outlive it.
 * ZT_EMEMORY.
 */
zt_status zt_keepsakes_open(zt_keepsakes **keepsakes, const zt_keepsakes_order *order,
                            zt_renderer *renderer);

/* Before a frame is rendered: has the renderer copy from what was kept of it. NULL does
 * nothing.
 */
void zt_keepsakes_offer(zt_keepsakes *keepsakes, const zt_render_job *job, int64_t frame);

/* After it was: keeps it, where that is worth it. Where that fails, which is told once, no more
 * are kept. NULL does nothing. */
void zt_keepsakes_take(zt_keepsakes *keepsakes, int64_t frame, zt_hash key);

/* Waits for the last one, and notes in the renderer's stats how many there are. */
void zt_keepsakes_close(zt_keepsakes **keepsakes);

#endif
