/* One round over a picture: the samples of the pixels whose turn it is. */
#ifndef ZT_RENDER_TAKE_H
#define ZT_RENDER_TAKE_H

#include "render/work.h"

/* What all slots of a round have in common. */
typedef struct zt_round_job {
    zt_frame *frame;
    int32_t asked, more; /* samples so far, and now */
    int32_t group;       /* slots that share a batch */
    int32_t task_slots;  /* slots of a task */
    float wanted;        /* the squared error below which a pixel is left */
    bool is_signed;
} zt_round_job;

/* The round of slots that have taken so many samples: each takes as many again, the first time
 * as many as are asked for at least. */
zt_round_job zt_round_plan(zt_frame *frame, int32_t asked);

/* How many rounds there are at most, each the first of a pixel, its second and so on. */
int zt_round_count(const zt_frame *frame);

/* Some of the canvas's slots in the round take their samples, and know how far off they are.
 * `user` is a zt_round_job; for a pool. */
void zt_round_task(void *user, int task, int worker);

#endif
