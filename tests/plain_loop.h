/* What rays meet by a plain loop over all primitives and all triangles, which passes nothing
 * by: distances are those of the kernel that ZT_ISA names. cmocka.h comes first. */
#ifndef ZT_TESTS_PLAIN_LOOP_H
#define ZT_TESTS_PLAIN_LOOP_H

#include "culled_scenes.h"
#include "tracer/intersect.h"
#include "tracer/motion_meet.h"
#include "tracer/prepare.h"

/* A scene made ready; and, for each of its meshes, one of each of the triangles. */
typedef struct stage {
    zt_arena arena;
    zt_meshes *meshes, *piece_meshes;
    const zt_tracer *tracer;
    zt_tracer pieces; /* asked one by one, and only the pieces */
    int32_t object_count;
    int32_t meshes_of[SCENE_OBJECTS_MAX]; /* the primitive of each mesh, in order */
    zt_exposure exposure;
} stage;

static inline zt_tracer *prepare(const zt_exposure *exposure, zt_meshes *meshes,
                                 zt_arena *arena) {
    zt_tracer *tracer;
    zt_extents extents;
    zt_needs needs;
    assert_int_equal(zt_needs_find(&needs, exposure, false, arena), ZT_OK);
    assert_int_equal(
        ZT_REAL_NAME(zt_prepare)(&tracer, &extents, exposure, &needs, false, meshes, arena),
        ZT_OK);
    assert_int_equal(ZT_REAL_NAME(zt_prepare_search)(tracer, meshes, arena), ZT_OK);
    return tracer;
}

enum { MOMENTS_MAX = 4 };
static zt_scene scenes[MOMENTS_MAX];

/* Of scenes that have the same things, at moments of an exposure. */
static inline void set_stage(stage *st, test_scene *s, int moments) {
    static const double times[][MOMENTS_MAX] = {{0}, {0, 1}, {0, .25, 1}, {0, .125, .75, 1}};
    static const bool steps[MOMENTS_MAX] = {false};
    st->arena = (zt_arena){0};
    st->exposure = (zt_exposure){.moments = scenes,
                                 .times = times[moments - 1],
                                 .steps = steps,
                                 .moment_count = moments};
    for (int m = 0; m < moments; m++) scenes[m] = s[m].scene;
    st->tracer = prepare(&st->exposure, st->meshes, &st->arena);
    st->object_count = s->scene.object_count;
    int placed = 0;
    for (int32_t i = 0; i < st->tracer->primitive_count; i++)
        if (st->tracer->primitives[i].kind == ZT_PRIMITIVE_MESH) st->meshes_of[placed++] = i;
    for (int m = 0; m < moments; m++) {
        for (int k = 0; k < placed * PARTS; k++) {
            int32_t mesh = st->tracer->primitives[st->meshes_of[k / PARTS]].object;
            zt_object *o = scene_object(&s[m], ZT_SHAPE_MESH, 0);
            *o = s[m].objects[mesh];
            o->mesh = 1 + k % PARTS;
        }
        scenes[m] = s[m].scene;
    }
    st->pieces = *prepare(&st->exposure, st->piece_meshes, &st->arena);
    /* None is turned away by halves of its bounds. */
    for (int32_t i = 0; i < st->pieces.placed_count; i++) {
        assert_true(zt_meshes_build(st->pieces.placed[i].built));
        zt_bvh_box *boxes = st->pieces.placed[i].built->hull->boxes;
        for (int k = 2; k < 1 << ZT_HULL_LEVELS; k++) boxes[k] = boxes[1];
    }
    int32_t *single = ZT_PUSH(&st->arena, int32_t, (size_t)st->pieces.primitive_count);
    st->pieces.crowd_count = 0;
    st->pieces.tie = 0;
    st->pieces.single = single;
    st->pieces.single_count = 0;
    for (int32_t i = 0; i < st->pieces.primitive_count; i++)
        if (st->pieces.primitives[i].object >= st->object_count)
            single[st->pieces.single_count++] = i;
    assert_int_equal(st->pieces.single_count, placed * PARTS);
}

static const zt_bundle anywhere = {.origins = {{-1e30, -1e30, -1e30}, {1e30, 1e30, 1e30}},
                                   .directions = {{-1, -1, -1}, {1, 1, 1}},
                                   .source = -1};

static inline int32_t leaving(const zt_batch *rays, int i, int32_t index) {
    int32_t source = rays->from->source[i];
    return source < 0 || source >> 1 != index ? 0 : source & 1 ? -1 : 1;
}

/* Of what moves, the one number there is comes from the loop that is asked about all: the
 * nearest, or, of shadow rays, whether there is one. */
static inline real moving_distance(const zt_tracer *tracer, int32_t index, const zt_batch *rays,
                                   int i, real near) {
    static zt_batch one;
    int first = i / ZT_BATCH_LANES * ZT_BATCH_LANES;
    one.from = rays->from;
    one.count = rays->count;
    for (int k = first; k < first + ZT_BATCH_LANES; k++) {
        one.dx[k] = rays->dx[k], one.dy[k] = rays->dy[k], one.dz[k] = rays->dz[k];
        one.t[k] = near > 0 ? rays->t[k] : REAL_INFINITY, one.hit[k] = -1;
    }
    zt_tracer plain = *tracer;
    plain.tie = 0;
    ZT_KERNEL_NAME(zt_meet_moving)
    (&one, &plain, index, first, first + ZT_BATCH_LANES, near > 0);
    return near == 0 ? one.t[i] : one.hit[i] < 0 ? REAL_INFINITY : rays->t[i] / 2;
}

static inline real distance_of(const zt_tracer *tracer, int32_t index, const zt_batch *rays,
                               int i, real near) {
    const zt_primitive *p = &tracer->primitives[index];
    const zt_origins *o = rays->from;
    int32_t left = leaving(rays, i, index);
    if (p->kind != ZT_PRIMITIVE_MESH && p->poses)
        return moving_distance(tracer, index, rays, i, near);
#define DISTANCE(kind)                                                                         \
    zt_##kind##_distance(p, o->x[i], o->y[i], o->z[i], rays->dx[i], rays->dy[i], rays->dz[i],  \
                         left, near)
    switch (p->kind) {
    case ZT_PRIMITIVE_PLANE:
        return DISTANCE(plane);
    case ZT_PRIMITIVE_SPHERE:
        return DISTANCE(sphere);
    case ZT_PRIMITIVE_TRIANGLE:
        return DISTANCE(triangle);
    case ZT_PRIMITIVE_BALL:
        return DISTANCE(ball);
    case ZT_PRIMITIVE_DISK:
        return DISTANCE(disk);
    case ZT_PRIMITIVE_BOX:
        return DISTANCE(box);
    case ZT_PRIMITIVE_CYLINDER:
        return DISTANCE(cylinder);
    case ZT_PRIMITIVE_CONE:
        return DISTANCE(cone);
    case ZT_PRIMITIVE_CAPSULE:
        return DISTANCE(capsule);
    case ZT_PRIMITIVE_TORUS:
        return DISTANCE(torus);
    default:
        return REAL_INFINITY;
    }
}

static inline void plain_nearest(zt_batch *rays, const stage *st) {
    static zt_batch pieces;
    pieces = *rays;
    if (st->pieces.single_count > 0)
        ZT_KERNEL_NAME(zt_intersect)(&pieces, &anywhere, &st->pieces);
    for (int i = 0; i < rays->count; i++) {
        rays->t[i] = REAL_INFINITY;
        rays->hit[i] = -1;
        for (int32_t p = 0; p < st->tracer->primitive_count; p++) {
            real t = distance_of(st->tracer, p, rays, i, 0);
            if (t < rays->t[i]) rays->t[i] = t, rays->hit[i] = p;
        }
        if (st->pieces.single_count == 0 || pieces.hit[i] < 0) continue;
        assert_int_equal(pieces.part[i], 0); /* not one without area */
        int32_t piece = st->pieces.primitives[pieces.hit[i]].object - st->object_count;
        int32_t index = st->meshes_of[piece / PARTS];
        if (pieces.t[i] > rays->t[i] || (pieces.t[i] == rays->t[i] && rays->hit[i] < index))
            continue;
        rays->t[i] = pieces.t[i];
        rays->hit[i] = index;
        rays->part[i] = piece % PARTS;
    }
}

/* Sets hit to -1, or to what hides. */
static inline void plain_any(zt_batch *rays, const stage *st) {
    static zt_batch pieces;
    for (int i = 0; i < rays->count; i++) rays->hit[i] = -1;
    pieces = *rays;
    if (st->pieces.single_count > 0)
        ZT_KERNEL_NAME(zt_occlude)(&pieces, &anywhere, &st->pieces);
    for (int i = 0; i < rays->count; i++) {
        if (pieces.hit[i] >= 0) rays->hit[i] = INT32_MAX;
        for (int32_t p = 0; p < st->tracer->primitive_count; p++) {
            real near = rays->from->near[i], t = distance_of(st->tracer, p, rays, i, near);
            if (t > near && t * (1 + TIE) + near < rays->t[i]) rays->hit[i] = p;
        }
    }
}

#endif
