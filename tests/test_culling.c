/* What bundles pass by, what hulls turn away and what hierarchies do not look at is met by no
 * ray: the bits are those of a plain loop over all primitives and all triangles. Compiled once
 * for each precision. A number given to the program draws other scenes. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define ZT_ISA base
#include "scenes.h"
#include "tracer/intersect.h"
#include "tracer/motion_meet.h"
#include "tracer/prepare.h"

extern const zt_kernel ZT_KERNEL_NAME(zt_kernel);

/* ---- a model, and each of its triangles as a model of its own -----------------------------
 */

/* The triangles of the whole along a bow, far from its own origin, but for the last ones, which
 * nearly lie on each other. A model of one triangle also has some without area, which no ray
 * meets, so that its bounds are those of the whole and rays are taken to its space in the same
 * way. */
enum { PARTS = 30, LAYERS = 12, FLAT = 3, MODELS = 1 + PARTS };
static float positions[PARTS * 9 + 1];
static uint32_t whole[PARTS * 3], pieces[PARTS][(1 + FLAT) * 3];
static zt_mesh models[MODELS];

static void make_models(uint64_t *seed) {
    uint32_t least[3] = {0, 0, 0}, most[3] = {0, 0, 0};
    zt_mesh mesh = {.origin = {1000, -2000, 500},
                    .positions = positions,
                    .triangles = whole,
                    .vertex_count = PARTS * 3,
                    .triangle_count = PARTS,
                    .low = {INFINITY, INFINITY, INFINITY},
                    .high = {-INFINITY, -INFINITY, -INFINITY}};
    for (uint32_t i = 0; i < PARTS * 3; i++) {
        double along = 4.0 * (i / 3) / PARTS;
        vec3 p = vec3_add((vec3){2 * cos(along), 2 * sin(along), along / 2},
                          vec3_scale(test_direction(seed), .6));
        whole[i] = i;
        float *at = positions + 3 * (size_t)i;
        at[0] = (float)p.x, at[1] = (float)p.y, at[2] = (float)p.z;
        if (i / 3 > PARTS - LAYERS)
            for (int axis = 0; axis < 3; axis++) at[axis] = at[axis - 9] + 0x1p-17f;
        vec3 v = vec3_add(mesh.origin, (vec3){(double)at[0], (double)at[1], (double)at[2]});
        mesh.low = vec3_min(mesh.low, v);
        mesh.high = vec3_max(mesh.high, v);
        for (int axis = 0; axis < 3; axis++) {
            if (at[axis] < positions[3 * least[axis] + axis]) least[axis] = i;
            if (at[axis] > positions[3 * most[axis] + axis]) most[axis] = i;
        }
    }
    models[0] = mesh;
    for (int k = 0; k < PARTS; k++) {
        for (int i = 0; i < 3; i++) pieces[k][i] = whole[3 * k + i];
        for (int axis = 0; axis < FLAT; axis++) {
            uint32_t *flat = pieces[k] + 3 + 3 * axis;
            flat[0] = flat[1] = least[axis];
            flat[2] = most[axis];
        }
        models[1 + k] = mesh;
        models[1 + k].triangles = pieces[k];
        models[1 + k].triangle_count = 1 + FLAT;
    }
}

/* ---- scenes -------------------------------------------------------------------------------
 */

static void random_solid(zt_object *o, uint64_t *seed, vec3 at, double size) {
    vec3 axis = test_direction(seed);
    vec3 end = vec3_add(at, vec3_scale(axis, size * test_between(seed, .2, 2)));
    double radius = size * test_between(seed, .2, 1);
    switch (o->shape) {
    case ZT_SHAPE_SPHERE:
        o->sphere = (zt_sphere){at, radius};
        break;
    case ZT_SHAPE_TRIANGLE:
        for (int i = 0; i < 3; i++)
            o->triangle.vertices[i] =
                vec3_add(at, vec3_scale(test_direction(seed), 1.5 * size));
        break;
    case ZT_SHAPE_DISK:
        o->disk = (zt_disk){at, axis, radius};
        break;
    case ZT_SHAPE_BOX:
        o->box.center = at;
        o->box.size = (vec3){radius, size * test_between(seed, .1, 2), size};
        o->box.rotation = quat_axis_angle(axis, test_between(seed, 0, 6));
        break;
    case ZT_SHAPE_CYLINDER:
    case ZT_SHAPE_CAPSULE:
        o->tube = (zt_tube){at, end, radius / 2, 0};
        break;
    case ZT_SHAPE_CONE:
        o->tube = (zt_tube){at, end, radius, radius * fmax(0, test_between(seed, -1, 1))};
        break;
    case ZT_SHAPE_TORUS:
        o->torus = (zt_torus){at, axis, radius, radius * test_between(seed, .05, 1)};
        break;
    default:
        break;
    }
}

static vec3 random_scale(uint64_t *seed) {
    return (vec3){exp(test_between(seed, -1, 1)), exp(test_between(seed, -1, 1)),
                  -exp(test_between(seed, -1, 1))};
}

static quat random_turn(uint64_t *seed) {
    return quat_axis_angle(test_direction(seed), test_between(seed, 0, 6));
}

/* So that the model's middle comes to somewhere near. */
static void place_mesh(zt_object *o, uint64_t *seed, vec3 at, double size) {
    o->mesh = 0;
    zt_placement *p = &o->placement;
    *p = (zt_placement){{0, 0, 0}, random_turn(seed), vec3_scale(random_scale(seed), size)};
    xform place = xform_place(p->position, p->rotation, p->scale);
    p->position = vec3_sub(at, xform_point(&place, models[0].origin));
}

/* Things of all kinds and sizes, by themselves and in groups that shear them. */
static void make_scene(test_scene *s, uint64_t *seed, int things) {
    scene_begin(s);
    scene_material(s, (vec3){1, 1, 1}, .5);
    s->scene.meshes = models;
    s->scene.mesh_count = MODELS;
    int32_t groups[3] = {-1};
    for (int i = 1; i < 3; i++) {
        zt_object *group = scene_object(s, ZT_SHAPE_GROUP, -1);
        groups[i] = s->scene.object_count - 1;
        group->parent = groups[i - 1];
        group->placement = (zt_placement){vec3_scale(test_direction(seed), .5),
                                          random_turn(seed), random_scale(seed)};
    }
    for (int i = 0; i < things; i++) {
        zt_shape shape = (zt_shape)(test_random(seed) * ZT_SHAPE_GROUP);
        if (shape == ZT_SHAPE_PLANE && i % 4) shape = ZT_SHAPE_SPHERE;
        zt_object *o = scene_object(s, shape, 0);
        o->parent = groups[(int)(test_random(seed) * 3)];
        double size = exp(test_between(seed, -4, .5));
        vec3 at = vec3_scale(test_direction(seed), test_between(seed, .5, 6));
        if (shape == ZT_SHAPE_PLANE)
            o->plane = (zt_plane){test_direction(seed), test_between(seed, 4, 9)};
        else if (shape == ZT_SHAPE_MESH)
            place_mesh(o, seed, at, size / 2);
        else
            random_solid(o, seed, at, size);
    }
    s->scene.camera.position = vec3_scale(test_direction(seed), exp(test_between(seed, -2, 4)));
    /* Shells, as near to each other as things may be that are not the same. */
    vec3 at = vec3_scale(test_direction(seed), 4);
    if (things % 4 == 0) at = vec3_add(s->scene.camera.position, vec3_scale(at, .1));
    double gap = 8 * 0x1p-20 * (vec3_length(s->scene.camera.position) + 5);
    for (int i = 0; i < things / 3; i++) scene_sphere(s, at, .5 + i * gap, 0);
    for (int i = 0; i < 3; i++)
        scene_point_light(s, vec3_scale(test_direction(seed), test_between(seed, 0, 9)), 1);
}

/* Carries, turns and grows about half of the things, by more at each moment. */
static void carry(test_scene *s, uint64_t seed, double amount) {
    for (int32_t i = 0; i < s->scene.object_count; i++) {
        zt_object *o = &s->objects[i];
        vec3 way = vec3_scale(test_direction(&seed), amount * test_random(&seed));
        vec3 axis = test_direction(&seed);
        bool turns = o->shape == ZT_SHAPE_MESH || o->shape == ZT_SHAPE_GROUP;
        if (test_random(&seed) < (o->shape == ZT_SHAPE_GROUP ? .8 : .5)) continue;
        if (o->shape == ZT_SHAPE_PLANE)
            o->plane.distance += amount;
        else if (o->shape == ZT_SHAPE_TRIANGLE)
            o->triangle.vertices[0] = vec3_add(o->triangle.vertices[0], way);
        else if (o->shape >= ZT_SHAPE_CYLINDER && o->shape <= ZT_SHAPE_CAPSULE &&
                 o->shape != ZT_SHAPE_TORUS) {
            o->tube.from = vec3_add(o->tube.from, way);
            o->tube.radius *= 1 + .3 * amount;
        } else if (turns) {
            o->placement.rotation =
                quat_mul(quat_axis_angle(axis, .5 * amount), o->placement.rotation);
            o->placement.position = vec3_add(o->placement.position, way);
        } else { /* they all begin with their centers */
            o->sphere.center = vec3_add(o->sphere.center, way);
        }
    }
}

/* ---- the plain loop -----------------------------------------------------------------------
 */

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

static zt_tracer *prepare(const zt_exposure *exposure, zt_meshes *meshes, zt_arena *arena) {
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
static void set_stage(stage *st, test_scene *s, int moments) {
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

static int32_t leaving(const zt_batch *rays, int i, int32_t index) {
    int32_t source = rays->from->source[i];
    return source < 0 || source >> 1 != index ? 0 : source & 1 ? -1 : 1;
}

/* Of what moves, the one number there is comes from the loop that is asked about all: the
 * nearest, or, of shadow rays, whether there is one. */
static real moving_distance(const zt_tracer *tracer, int32_t index, const zt_batch *rays, int i,
                            real near) {
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

static real distance_of(const zt_tracer *tracer, int32_t index, const zt_batch *rays, int i,
                        real near) {
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

static void plain_nearest(zt_batch *rays, const stage *st) {
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
static void plain_any(zt_batch *rays, const stage *st) {
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

/* ---- comparing ----------------------------------------------------------------------------
 */

static int met[ZT_PRIMITIVE_KIND_COUNT], passed, hidden, open, mirrored, leaving_one, outlines;

static zt_bundle bundle_of(const zt_batch *rays, int32_t source) {
    const zt_origins *o = rays->from;
    return (zt_bundle){.origins = zt_range3(o->x, o->y, o->z, rays->count),
                       .directions = zt_range3(rays->dx, rays->dy, rays->dz, rays->count),
                       .source = source};
}

/* The primitive on which all rays begin, none of them inside it, or -1. */
static int32_t source_of(const zt_batch *rays) {
    int32_t source = rays->from->source[0];
    for (int i = 0; i < rays->count; i++)
        if (rays->from->source[i] != source) return -1;
    return source >= 0 && source % 2 == 0 ? source / 2 : -1;
}

static void tell(const zt_batch *rays, const stage *st, int i, const zt_batch *wanted) {
    int32_t hit = rays->hit[i], other = wanted->hit[i];
    printf("ray %d: o %.17g %.17g %.17g d %.17g %.17g %.17g source %d\n", i,
           (double)rays->from->x[i], (double)rays->from->y[i], (double)rays->from->z[i],
           (double)rays->dx[i], (double)rays->dy[i], (double)rays->dz[i],
           rays->from->source[i]);
    printf("  got %d (kind %d) at %.17g, wanted %d (kind %d) at %.17g; crowd %d\n", hit,
           hit < 0 ? -1 : (int)st->tracer->primitives[hit].kind, (double)rays->t[i], other,
           other < 0 || other == INT32_MAX ? -1 : (int)st->tracer->primitives[other].kind,
           (double)wanted->t[i], st->tracer->crowd_count > 0);
}

static void compare_nearest(zt_batch *rays, const stage *st) {
    static zt_batch wanted;
    wanted = *rays;
    plain_nearest(&wanted, st);
    int32_t source = source_of(rays);
    leaving_one += source >= 0;
    zt_bundle bundle = bundle_of(rays, source);
    ZT_KERNEL_NAME(zt_intersect)(rays, &bundle, st->tracer);
    for (int i = 0; i < rays->count; i++) {
        int32_t hit = rays->hit[i];
        bool mesh = hit >= 0 && st->tracer->primitives[hit].kind == ZT_PRIMITIVE_MESH;
        /* Of layers within a rounding of each other any may be told. */
        bool layer = rays->part[i] >= PARTS - LAYERS && wanted.part[i] >= PARTS - LAYERS;
        bool same = hit == wanted.hit[i] && rays->t[i] == wanted.t[i] &&
                    (!mesh || layer || rays->part[i] == wanted.part[i]);
        if (!same) tell(rays, st, i, &wanted);
        assert_true(same);
        if (hit >= 0)
            met[st->tracer->primitives[hit].kind]++;
        else
            passed++;
    }
    bool any = false;
    for (int i = 0; i < rays->count; i++) any |= wanted.hit[i] >= 0;
    if (any) assert_true(ZT_KERNEL_NAME(zt_may_meet)(&bundle, st->tracer));
}

/* The shadow rays from where the others begin to a lamp. */
static void compare_shadows(const zt_batch *rays, const stage *st, real3 lamp) {
    static zt_batch shadow, wanted;
    const zt_origins *o = rays->from;
    shadow = *rays;
    for (int i = 0; i < rays->count; i++) {
        real x = lamp.x - o->x[i], y = lamp.y - o->y[i], z = lamp.z - o->z[i];
        real distance = real_sqrt(real_dot(x, y, z, x, y, z));
        shadow.dx[i] = x / distance, shadow.dy[i] = y / distance, shadow.dz[i] = z / distance;
        shadow.t[i] = i % 9 ? distance : 0; /* such a ray looks nowhere */
        shadow.hit[i] = -1;
    }
    wanted = shadow;
    plain_any(&wanted, st);
    zt_bundle bundle = zt_bundle_to(zt_range3(o->x, o->y, o->z, rays->count),
                                    (zt_box){lamp, lamp}, source_of(rays));
    bool may = ZT_KERNEL_NAME(zt_may_meet)(&bundle, st->tracer);
    ZT_KERNEL_NAME(zt_occlude)(&shadow, &bundle, st->tracer);
    for (int i = 0; i < rays->count; i++) {
        bool same = (shadow.hit[i] >= 0) == (wanted.hit[i] >= 0);
        if (!same) tell(&shadow, st, i, &wanted);
        assert_true(same);
        hidden += wanted.hit[i] >= 0;
        open += wanted.hit[i] < 0;
        assert_true(may || wanted.hit[i] < 0);
    }
}

/* ---- rays ---------------------------------------------------------------------------------
 */

static zt_origins from;
static zt_batch rays;
static double times[ZT_BATCH]; /* of rays, where something moves */

/* At one time all, or each at its own. */
static void set_times(uint64_t *seed) {
    double time = test_random(seed);
    bool one = test_random(seed) < .3;
    for (int i = 0; i < ZT_BATCH; i++)
        times[i] = floor((one ? time : test_random(seed)) * 65536) / 65536;
}

static void set_moments(const stage *st) {
    if (!st->tracer->moves) return;
    for (int i = 0; i < ZT_BATCH; i++)
        from.between[i] = (real)zt_exposure_find(&from.moment[i], &st->exposure,
                                                 st->tracer->moment_at, times[i]);
}

static void set_ray(int i, vec3 o, vec3 d, int32_t source) {
    from.x[i] = (real)o.x, from.y[i] = (real)o.y, from.z[i] = (real)o.z;
    from.near[i] = (real)vec3_max_abs(o) * TIE;
    from.source[i] = source;
    rays.dx[i] = (real)d.x, rays.dy[i] = (real)d.y, rays.dz[i] = (real)d.z;
}

/* Rays from the camera: narrow, wide, along an axis; to one of the things or anywhere. */
static void camera_rays(uint64_t *seed, int batch, const stage *st) {
    rays.from = &from;
    set_times(seed);
    set_moments(st);
    rays.count = 1 + (int)(test_random(seed) * ZT_BATCH);
    vec3 along = test_direction(seed);
    const zt_primitive *p =
        &st->tracer->primitives[(int32_t)(test_random(seed) * st->tracer->primitive_count)];
    if (batch % 2 && p->kind != ZT_PRIMITIVE_PLANE)
        along = vec3_normalize((vec3){(double)(p->box.low.x + p->box.high.x),
                                      (double)(p->box.low.y + p->box.high.y),
                                      (double)(p->box.low.z + p->box.high.z)});
    double spread = exp(test_between(seed, -6, 1));
    for (int i = 0; i < rays.count; i++) {
        vec3 d = vec3_normalize(vec3_add(along, vec3_scale(test_direction(seed), spread)));
        if (batch % 7 == 6) d = (vec3){0, 0, i % 2 ? 1 : -1};
        set_ray(i, (vec3){0, 0, 0}, d, -1);
    }
}

/* Rays to corners of meshes, or rather as far inside of a triangle as the share says. */
static void corner_rays(uint64_t *seed, const stage *st, double inside) {
    const zt_placed_mesh *m =
        &st->tracer->placed[(int)(test_random(seed) * st->tracer->placed_count)];
    int part = (int)(test_random(seed) * PARTS), which = (int)(test_random(seed) * 3);
    for (int i = 0; i < rays.count; i++) {
        vec3 corners[3], aim = {0, 0, 0};
        for (int k = 0; k < 3; k++) {
            const float *v = positions + 3 * (size_t)whole[3 * part + (which + k) % 3];
            corners[k] = (vec3){(double)v[0], (double)v[1], (double)v[2]};
            aim = vec3_add(aim, vec3_scale(corners[k], k ? inside / 2 : 1 - inside));
        }
        set_ray(i, (vec3){0, 0, 0}, vec3_normalize(xform_point(&m->place, aim)), -1);
        if (i % 3 == 2) part = (int)(test_random(seed) * PARTS), which = i % 3;
    }
}

/* Makes what were rays to something, and others that met something else or nothing, the last
 * ones on the way from those to these that still meet what those met: rays along an outline. */
static void outline_rays(uint64_t *seed, const stage *st) {
    enum { STEPS = 2 + (int)(8 * sizeof(real)) };
    static zt_batch within, without;
    camera_rays(seed, 1, st);
    rays.count = rays.count < 24 ? rays.count : 24;
    bool corners = st->tracer->placed_count > 0 && test_random(seed) < .5;
    uint64_t before = *seed;
    if (corners) corner_rays(seed, st, .01);
    within = rays;
    plain_nearest(&within, st);
    if (corners) {
        *seed = before;
        corner_rays(seed, st, -.01);
    }
    for (int i = 0; i < rays.count && !corners; i++) {
        vec3 d = {(double)rays.dx[i], (double)rays.dy[i], (double)rays.dz[i]};
        double spread = exp(test_between(seed, -4, 1));
        d = vec3_normalize(vec3_add(d, vec3_scale(test_direction(seed), spread)));
        set_ray(i, (vec3){0, 0, 0}, d, -1);
    }
    without = rays;
    plain_nearest(&without, st);
    int count = 0;
    for (int i = 0; i < rays.count; i++) {
        if (within.hit[i] == without.hit[i]) continue;
        within.hit[count] = within.hit[i];
        within.dx[count] = within.dx[i], without.dx[count] = without.dx[i];
        within.dy[count] = within.dy[i], without.dy[count] = without.dy[i];
        within.dz[count] = within.dz[i], without.dz[count] = without.dz[i];
        times[count] = times[i];
        count++;
    }
    set_moments(st);
    rays.count = count;
    for (int step = 0; step < STEPS; step++) {
        for (int i = 0; i < count; i++) {
            vec3 a = {(double)within.dx[i], (double)within.dy[i], (double)within.dz[i]};
            vec3 b = {(double)without.dx[i], (double)without.dy[i], (double)without.dz[i]};
            set_ray(i, (vec3){0, 0, 0}, vec3_normalize(vec3_add(a, b)), -1);
        }
        plain_nearest(&rays, st);
        for (int i = 0; i < count; i++) {
            zt_batch *side = rays.hit[i] == within.hit[i] ? &within : &without;
            side->dx[i] = rays.dx[i], side->dy[i] = rays.dy[i], side->dz[i] = rays.dz[i];
        }
    }
    /* As few, now and then, as make the narrowest bundles. */
    if (test_random(seed) < .7) rays.count = count = count < 3 ? count : 3;
    for (int i = 0; i < count; i++)
        rays.dx[i] = within.dx[i], rays.dy[i] = within.dy[i], rays.dz[i] = within.dz[i];
    outlines += count;
}

/* Where the kernel itself says that mirrored rays go on: all of those that hit something, or
 * only those from the thing that the first one hit. */
static void mirror_rays(zt_probe *probes, const stage *st, void *work, bool one) {
    for (int i = 0; i < rays.count; i++)
        probes[i] = (zt_probe){
            .origin = {(double)from.x[i], (double)from.y[i], (double)from.z[i]},
            .direction = {(double)rays.dx[i], (double)rays.dy[i], (double)rays.dz[i]},
            .time = times[i],
            .source = from.source[i]};
    ZT_KERNEL_NAME(zt_kernel).probe(st->tracer, probes, rays.count, work);
    int count = 0;
    int32_t first = -1;
    for (int i = 0; i < rays.count; i++) {
        const zt_probe *p = &probes[i];
        if (p->object < 0) continue;
        if (first < 0) first = p->object;
        if (one && p->object != first) continue;
        times[count] = times[i];
        set_ray(count++, p->mirror_origin, p->mirror_direction, p->mirror_source);
    }
    rays.count = count;
    set_moments(st);
}

static void compare_film(uint64_t *seed, int rounds, int least, int most, int batches,
                         bool moves) {
    static test_scene s[MOMENTS_MAX];
    static stage st;
    static zt_probe probes[ZT_BATCH];
    void *work = aligned_alloc(64, (ZT_KERNEL_NAME(zt_kernel).work_size + 63) / 64 * 64);
    assert_non_null(work);
    assert_int_equal(zt_meshes_open(&st.meshes, models, MODELS, 1, (zt_listener){0}), ZT_OK);
    assert_int_equal(zt_meshes_open(&st.piece_meshes, models, MODELS, 1, (zt_listener){0}),
                     ZT_OK);
    for (int round = 0; round < rounds; round++) {
        int moments = moves ? 2 + round % 3 : 1,
            things = least + (int)(test_random(seed) * (most - least + 1));
        uint64_t before = *seed, way = before + 5;
        for (int m = 0; m < moments; m++) {
            *seed = before;
            make_scene(&s[m], seed, things);
            if (m > 0) carry(&s[m], way, .4 * m / (moments - 1));
        }
        set_stage(&st, s, moments);
        if (!moves) assert_true(st.tracer->tie == 0);
        for (int batch = 0; batch < batches; batch++) {
            if (batch % 2)
                outline_rays(seed, &st);
            else
                camera_rays(seed, batch / 2, &st);
            if (rays.count == 0) continue;
            compare_nearest(&rays, &st);
            for (int depth = 0; depth < 3; depth++) {
                mirror_rays(probes, &st, work, batch % 3 == 0);
                if (rays.count == 0) break;
                for (int32_t l = 0; l < st.tracer->lamp_count; l++)
                    compare_shadows(&rays, &st, st.tracer->lamps[l].poses->position);
                compare_nearest(&rays, &st);
                mirrored += rays.count;
            }
        }
        zt_arena_free(&st.arena);
    }
    zt_meshes_close(&st.meshes);
    zt_meshes_close(&st.piece_meshes);
    free(work);
}

static void assert_all_met(void) {
    printf("met by kind:");
    for (int k = 0; k < ZT_PRIMITIVE_KIND_COUNT; k++) printf(" %d", met[k]);
    printf("; %d passed, %d hidden, %d open, %d mirrored, %d bundles from one thing, "
           "%d along outlines\n",
           passed, hidden, open, mirrored, leaving_one, outlines);
    for (int k = 0; k < ZT_PRIMITIVE_KIND_COUNT; k++) assert_true(met[k] > 150);
    assert_true(passed > 10000 && hidden > 10000 && open > 10000 && mirrored > 10000);
    assert_true(leaving_one > 100 && outlines > 1000);
    memset(met, 0, sizeof met);
    passed = hidden = open = mirrored = leaving_one = outlines = 0;
}

static uint64_t more; /* other numbers than the usual ones */

/* Few things, which are asked one by one. */
static void test_few(void **state) {
    (void)state;
    uint64_t seed = 1 + more;
    make_models(&seed);
    compare_film(&seed, 250, 1, 20, 16, false);
    assert_all_met();
}

/* So many that a hierarchy tells where to look. */
static void test_crowd(void **state) {
    (void)state;
    uint64_t seed = 2 + more;
    make_models(&seed);
    compare_film(&seed, 60, 50, 120, 16, false);
    assert_all_met();
}

/* The same of what moves: each ray at its own time. */
static void test_moving(void **state) {
    (void)state;
    uint64_t seed = 3 + more;
    make_models(&seed);
    compare_film(&seed, 80, 1, 20, 16, true);
    compare_film(&seed, 12, 50, 120, 16, true);
    assert_all_met();
}

int main(int count, char **arguments) {
    if (count > 1) more = (uint64_t)atoll(arguments[1]);
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_few), cmocka_unit_test(test_crowd),
                                       cmocka_unit_test(test_moving)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
