#include "sequence/pacing.h"

#include <inttypes.h>
#include <stdlib.h>

#include "base/clock.h"
#include "base/diag.h"
#include "sequence/manifest.h"

void zt_pacing_free(zt_pacing **slot) {
    if (*slot) free((int64_t *)(*slot)->plan.frames);
    free(*slot);
    *slot = NULL;
}

void zt_renderer_follow(zt_renderer *r, const zt_manifest *manifest) { r->followed = manifest; }

static zt_status follow(zt_sampling *sampling, const zt_renderer *r, int64_t frame) {
    const zt_manifest_frame *found = zt_manifest_find(r->followed, frame);
    if (!found) {
        zt_tell(r->listener, ZT_ERROR, "the manifest has no frame %" PRId64, frame);
        return ZT_EARGUMENT;
    }
    if (found->max == 0) return ZT_OK; /* it had those of its settings */
    sampling->min = found->min;
    sampling->max = found->max;
    sampling->error = found->error;
    sampling->mean_max = found->mean_max;
    if (found->min == found->max) sampling->edges = false;
    return ZT_OK;
}

zt_status zt_pacing_sampling(zt_sampling *sampling, const zt_renderer *r, int64_t frame) {
    *sampling = r->sampling;
    if (r->followed) return follow(sampling, r, frame);
    if (r->pacing) *sampling = zt_plan_sampling(&r->pacing->plan, frame);
    return ZT_OK;
}

void zt_pacing_done(zt_renderer *r, int64_t frame, double took_s) {
    zt_pacing *p = r->pacing;
    if (!p || r->followed || p->next == p->plan.frame_count || p->plan.frames[p->next] != frame)
        return;
    zt_plan_done(&p->plan, frame, took_s, zt_clock_s() - p->begun_s);
    p->next++;
}
