/* Which samples each frame takes: the renderer's own, those of a manifest that it follows, or
 * what a budget of time allots. */
#ifndef ZT_SEQUENCE_PACING_H
#define ZT_SEQUENCE_PACING_H

#include "sequence/budget.h"
#include "sequence/renderer.h"

/* A budget that is being spent. */
struct zt_pacing {
    zt_plan plan;   /* its frames are its own */
    double begun_s; /* by the clock */
    int64_t next;   /* the position of the frame that has its turn */
};

/* ZT_EARGUMENT, told, where the manifest that is followed has no such frame. */
zt_status zt_pacing_sampling(zt_sampling *sampling, const zt_renderer *renderer, int64_t frame);

/* A frame has been rendered, in so many seconds: tells a budget. */
void zt_pacing_done(zt_renderer *renderer, int64_t frame, double took_s);

void zt_pacing_free(zt_pacing **pacing);

#endif
