#include "sequence/pacing.h"

#include <inttypes.h>
#include <stdlib.h>

#include "base/clock.h"
#include "base/diag.h"
#include "sequence/manifest.h"

void zt_pacing_free(zt_pacing **slot) {
    if (*slot) zt_manifest_free(&(*slot)->manifest);
    free(*slot);
    *slot = NULL;
}

void zt_renderer_follow(zt_renderer *r, const zt_manifest *manifest) { r->followed = manifest; }

const zt_manifest *zt_renderer_manifest(const zt_renderer *r) {
    return r->pacing ? r->pacing->manifest : NULL;
}

static zt_status follow(zt_sampling *sampling, const zt_renderer *r, int64_t frame) {
    const zt_manifest_frame *found = zt_manifest_find(r->followed, frame);
    if (!found) {
        zt_tell(r->listener, ZT_ERROR, "the manifest has no frame %" PRId64, frame);
        return ZT_EARGUMENT;
    }
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

zt_status zt_pacing_done(zt_renderer *r, int64_t frame, const zt_sampling *sampling,
                         double took_s) {
    zt_pacing *p = r->pacing;
    if (!p || r->followed) return ZT_OK;
    zt_manifest_frame done = {frame, sampling->min, sampling->max, sampling->error,
                              sampling->mean_max};
    ZT_TRY(zt_manifest_add(p->manifest, &done));
    if (frame == p->next && frame <= p->plan.last) {
        zt_plan_done(&p->plan, frame, took_s, zt_clock_s() - p->begun_s);
        p->next++;
    }
    return ZT_OK;
}
