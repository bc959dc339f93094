#include "sequence/shutter.h"

#include "base/random.h"

zt_status zt_shutter_expose(zt_exposure *exposure, const zt_animation *animation, int64_t frame,
                            int height, zt_arena *arena, zt_listener listener) {
    (void)height;
    zt_scene *scene = ZT_PUSH(arena, zt_scene, 1);
    if (!scene) return ZT_EMEMORY;
    *exposure = zt_exposure_of(scene);
    return zt_animation_freeze(scene, animation, zt_rate_time(animation->film.rate, frame),
                               arena, listener);
}

void zt_shutter_keys(uint64_t *place_key, uint64_t *frame_key, const zt_exposure *exposure,
                     const zt_sampling *sampling) {
    (void)exposure;
    *place_key = *frame_key = zt_random_key(0, sampling->seed);
}
