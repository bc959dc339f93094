/* What is known of lamps and of what may be in their way before any batch is. Compiled once for
 * each precision. */
#include "base/diag.h"
#include "tracer/prepare.h"
#include "tracer/reach.h"

static bool is_shadowed(const zt_lamp *lamp, int32_t moment_count) {
    bool all = true;
    for (int32_t m = 0; m < moment_count; m++) all &= lamp->poses[m].shadows != 0;
    return all;
}

static zt_status prepare_bounds(zt_reach *reach, const zt_tracer *tracer, zt_arena *arena) {
    size_t room = (size_t)zt_batch_padded(tracer->lamp_count);
    real *bounds = ZT_PUSH(arena, real, 6 * room);
    int32_t *shines = ZT_PUSH(arena, int32_t, room), *shadows = ZT_PUSH(arena, int32_t, room);
    if (!bounds || !shines || !shadows) return ZT_EMEMORY;
    for (int32_t i = 0; i < tracer->lamp_count; i++) {
        const zt_lamp *lamp = &tracer->lamps[i];
        const real3 low = lamp->bounds.low, high = lamp->bounds.high;
        const real numbers[6] = {low.x, low.y, low.z, high.x, high.y, high.z};
        for (size_t k = 0; k < 6; k++) bounds[k * room + (size_t)i] = numbers[k];
        shines[i] = lamp->shines;
        shadows[i] = is_shadowed(lamp, tracer->exposure->moment_count);
    }
    *reach = (zt_reach){.low_x = bounds,
                        .low_y = bounds + room,
                        .low_z = bounds + 2 * room,
                        .high_x = bounds + 3 * room,
                        .high_y = bounds + 4 * room,
                        .high_z = bounds + 5 * room,
                        .shines = shines,
                        .shadows = shadows};
    return ZT_OK;
}

/* How much it may be in the way: the square of its middle length; 0: not at all. */
static real blocking_size(const zt_primitive *p) {
    if (p->poses) return 0;
    real3 low = p->box.low, high = p->box.high;
    real x = high.x - low.x, y = high.y - low.y, z = high.z - low.z;
    switch (p->kind) {
    case ZT_PRIMITIVE_PLANE:
        return REAL_INFINITY;
    case ZT_PRIMITIVE_SPHERE:
    case ZT_PRIMITIVE_BOX:
        return real_max(x * y, real_max(y * z, z * x));
    default:
        return 0;
    }
}

/* The largest, and of those that are as large the first. */
static void choose_blockers(zt_reach *reach, const zt_tracer *tracer) {
    real sizes[ZT_BLOCKERS_MAX];
    int32_t count = 0;
    for (int32_t i = 0; i < tracer->primitive_count; i++) {
        real size = blocking_size(&tracer->primitives[i]);
        int32_t at = count;
        while (at > 0 && sizes[at - 1] < size) at--;
        if (!(size > 0) || at == ZT_BLOCKERS_MAX) continue;
        int32_t last = count < ZT_BLOCKERS_MAX ? count++ : ZT_BLOCKERS_MAX - 1;
        for (int32_t k = last; k > at; k--) {
            sizes[k] = sizes[k - 1];
            reach->blockers[k] = reach->blockers[k - 1];
        }
        sizes[at] = size;
        reach->blockers[at] = i;
    }
    reach->blocker_count = count;
}

zt_status ZT_REAL_NAME(zt_prepare_reach)(zt_tracer *tracer, zt_arena *arena) {
    if (tracer->lamp_count < ZT_REACH_LAMPS) return ZT_OK;
    zt_reach *reach = ZT_PUSH(arena, zt_reach, 1);
    if (!reach) return ZT_EMEMORY;
    ZT_TRY(prepare_bounds(reach, tracer, arena));
    choose_blockers(reach, tracer);
    tracer->reach = reach;
    return ZT_OK;
}
