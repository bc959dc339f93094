/* What decides a frame's pixels, as one hash. */
#include "sequence/renderer.h"

#include <zoetrope/aov.h>

#include <stdlib.h>

#include "base/diag.h"
#include "base/hash.h"
#include "base/machine.h"
#include "keyframe/animation.h"
#include "sequence/pacing.h"
#include "sequence/shutter.h"

const char zt_arithmetic[] = "zoetrope 3 " ZT_MACHINE;

/* Of all meshes, once: they are the film's, and never change. */
static zt_status find_held(zt_renderer *r) {
    if (zt_hash_is_known(r->held)) return ZT_OK;
    const zt_scene *rest = &r->animation->rest;
    zt_hash *hashes = calloc((size_t)rest->mesh_count + 1, sizeof *hashes);
    if (!hashes) return ZT_EMEMORY;
    for (int32_t i = 0; i < rest->mesh_count; i++)
        hashes[i] = zt_mesh_content(&rest->meshes[i]);
    r->held = zt_hash_bytes(hashes, ((size_t)rest->mesh_count + 1) * sizeof *hashes);
    free(hashes);
    return ZT_OK;
}

/* What motion is between. */
static zt_status find_motion(zt_hash *motion, zt_renderer *r, int64_t frame) {
    zt_hash both[2] = {{0}};
    for (int i = 0; i < 2 && r->aovs & ZT_AOV_MOTION; i++) {
        zt_scene scene;
        ZT_TRY(zt_shutter_middle(&scene, r->animation, frame + i, &r->frame, r->listener));
        zt_exposure exposure = zt_exposure_of(&scene);
        both[i] = zt_shutter_content(&exposure);
    }
    *motion = zt_hash_bytes(both, sizeof both);
    return ZT_OK;
}

zt_status zt_renderer_key(zt_hash *key, zt_renderer *r, int64_t frame) {
    zt_exposure exposure;
    zt_division division;
    zt_hash motion;
    zt_sampling s;
    ZT_TRY(zt_pacing_sampling(&s, r, frame));
    ZT_TRY(find_held(r));
    zt_arena_reset(&r->frame);
    ZT_TRY(zt_shutter_expose(&exposure, &division, r->animation, frame, r->format.height,
                             &r->frame, r->listener));
    ZT_TRY(find_motion(&motion, r, frame));
    const double numbers[] = {r->format.width, r->format.height,
                              r->precision,    r->aovs,
                              s.min,           s.max,
                              s.error,         s.mean_max,
                              s.edges,         s.filter,
                              s.filter_width,  s.seed,
                              s.seed_fixed,    r->animation->film.transparent};
    const zt_hash parts[] = {zt_hash_bytes(zt_arithmetic, sizeof zt_arithmetic),
                             zt_hash_bytes(numbers, sizeof numbers), r->held,
                             zt_shutter_content(&exposure), motion};
    *key = zt_hash_bytes(parts, sizeof parts);
    return ZT_OK;
}
