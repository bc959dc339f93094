/* Poses of what moves, computed in double precision relative to the first moment's camera, and
 * rounded once. Compiled once for each precision. */
#include "tracer/motion.h"

#include <string.h>

#include "base/bits.h"
#include "base/diag.h"

/* ---- what moves -----------------------------------------------------------------------------
 */

static bool object_moves(const zt_exposure *e, int32_t i) {
    const zt_object *first = &e->moments->objects[i];
    for (int32_t m = 1; m < e->moment_count; m++)
        if (!zt_object_stays(first, &e->moments[m].objects[i])) return true;
    return false;
}

zt_status ZT_REAL_NAME(zt_course_make)(zt_course *c, const zt_exposure *e, zt_arena *arena) {
    size_t count = (size_t)e->moments->object_count, moments = (size_t)e->moment_count;
    *c = (zt_course){.exposure = e,
                     .worlds = ZT_PUSH(arena, xform, count * moments),
                     .moves = ZT_PUSH(arena, bool, count),
                     .poses = ZT_PUSH(arena, double, moments *ZT_POSE_NUMBERS),
                     .arena = arena};
    if (!c->worlds || !c->moves || !c->poses) return ZT_EMEMORY;
    for (int32_t m = 0; m < e->moment_count; m++)
        zt_scene_worlds(zt_course_worlds(c, m), &e->moments[m], e->moments->camera.position);
    for (int32_t i = 0; i < e->moments->object_count; i++) {
        int32_t parent = e->moments->objects[i].parent;
        c->moves[i] = (parent >= 0 && c->moves[parent]) || object_moves(e, i);
    }
    return ZT_OK;
}

/* ---- poses ----------------------------------------------------------------------------------
 */

/* One kind must do for all moments: spheres and cylinders only where they are that always. */
static zt_primitive_kind kind_of(const zt_course *c, int32_t i, zt_primitive_kind made) {
    for (int32_t m = 0; m < c->exposure->moment_count; m++) {
        const zt_object *o = &c->exposure->moments[m].objects[i];
        if (o->shape == ZT_SHAPE_SPHERE &&
            ZT_REAL_NAME(zt_similarity_scale)(&zt_course_worlds(c, m)[i]) < 0)
            return ZT_PRIMITIVE_BALL;
        if (o->shape == ZT_SHAPE_CONE && o->tube.radius != o->tube.end_radius)
            return ZT_PRIMITIVE_CONE;
    }
    return made;
}

/* The axes x and z of something round at the moment before: x is turned no further from there
 * than it must be, since between moments axes go straight on. */
typedef struct round_axes {
    vec3 x, z;
} round_axes;

static vec3 across(vec3 z) {
    vec3 a = {fabs(z.x), fabs(z.y), fabs(z.z)};
    vec3 least = a.x <= a.y && a.x <= a.z ? (vec3){1, 0, 0}
                 : a.y <= a.z             ? (vec3){0, 1, 0}
                                          : (vec3){0, 0, 1};
    return vec3_normalize(vec3_cross(least, z));
}

static xform round_place(const xform *world, vec3 center, vec3 axis, double length, double wide,
                         round_axes *last) {
    vec3 z = vec3_normalize(axis);
    if (vec3_max_abs(z) == 0) z = last->z;
    if (vec3_max_abs(z) == 0) z = (vec3){0, 0, 1};
    vec3 x = vec3_sub(last->x, vec3_scale(z, vec3_dot(last->x, z)));
    x = vec3_length(x) > 0.5 ? vec3_normalize(x) : across(z);
    *last = (round_axes){x, z};
    xform own = {vec3_scale(x, wide), vec3_scale(vec3_cross(z, x), wide), vec3_scale(z, length),
                 center};
    return xform_mul(world, &own);
}

static void plane_pose(double *pose, const zt_plane *plane, const xform *world) {
    vec3 out = xform_normal(world, vec3_normalize(plane->normal)), n = vec3_normalize(out);
    double distance = plane->distance * fabs(xform_determinant(world)) / vec3_length(out) +
                      vec3_dot(n, world->shift);
    bool good = isfinite(distance) && vec3_max_abs(n) > 0;
    pose[0] = good ? n.x : 0;
    pose[1] = good ? n.y : 0;
    pose[2] = good ? n.z : 0;
    pose[3] = good ? distance : 0;
}

static xform solid_pose(double *p, double *q, const zt_object *o, const xform *world,
                        zt_primitive_kind kind, round_axes *axes) {
    vec3 way = vec3_sub(o->tube.to, o->tube.from);
    *p = *q = 0;
    xform own;
    switch (kind) {
    case ZT_PRIMITIVE_DISK:
        return round_place(world, o->disk.center, o->disk.normal, o->disk.radius,
                           o->disk.radius, axes);
    case ZT_PRIMITIVE_CYLINDER:
        return round_place(world, o->tube.from, way, vec3_length(way), o->tube.radius, axes);
    case ZT_PRIMITIVE_CONE:
        *p = o->tube.radius;
        *q = o->tube.end_radius;
        return round_place(world, o->tube.from, way, vec3_length(way), 1, axes);
    case ZT_PRIMITIVE_CAPSULE:
        *p = vec3_length(way);
        *q = o->tube.radius;
        return round_place(world, o->tube.from, way, 1, 1, axes);
    case ZT_PRIMITIVE_TORUS:
        *p = fmin(o->torus.tube_radius, o->torus.radius);
        *q = o->torus.radius;
        return round_place(world, o->torus.center, o->torus.axis, 1, 1, axes);
    case ZT_PRIMITIVE_BOX:
        own = xform_place(o->box.center, o->box.rotation, vec3_scale(o->box.size, 0.5));
        return xform_mul(world, &own);
    default:
        own = (xform){.shift = o->sphere.center};
        own.x.x = own.y.y = own.z.z = o->sphere.radius;
        return xform_mul(world, &own);
    }
}

static void make_pose(double *pose, const zt_object *o, const xform *world,
                      zt_primitive_kind kind, round_axes *axes) {
    if (kind == ZT_PRIMITIVE_PLANE) {
        plane_pose(pose, &o->plane, world);
    } else if (kind == ZT_PRIMITIVE_SPHERE) {
        vec3 center = xform_point(world, o->sphere.center);
        memcpy(pose, &center, sizeof center);
        pose[3] = o->sphere.radius * ZT_REAL_NAME(zt_similarity_scale)(world);
    } else if (kind == ZT_PRIMITIVE_TRIANGLE) {
        for (int i = 0; i < 3; i++) {
            vec3 v = xform_point(world, o->triangle.vertices[i]);
            memcpy(pose + 3 * i, &v, sizeof v);
        }
    } else {
        xform place = solid_pose(&pose[12], &pose[13], o, world, kind, axes);
        memcpy(pose, &place, sizeof place);
    }
}

/* ---- bounds ---------------------------------------------------------------------------------
 */

/* How far a solid reaches in its own space: `round` from the axis z in each direction across,
 * or `square` along x and y, from `low` to `high` along the axis, and `ball` more around. */
typedef struct solid_form {
    double round, square, low, high, ball;
} solid_form;

/* With the largest p and q that there are: between moments axes and sizes change at once. */
static solid_form form_of(zt_primitive_kind kind, double p, double q) {
    switch (kind) {
    case ZT_PRIMITIVE_DISK:
        return (solid_form){.round = 1};
    case ZT_PRIMITIVE_BOX:
        return (solid_form){.square = 1, .low = -1, .high = 1};
    case ZT_PRIMITIVE_CYLINDER:
        return (solid_form){.round = 1, .high = 1};
    case ZT_PRIMITIVE_CONE:
        return (solid_form){.round = fmax(p, q), .high = 1};
    case ZT_PRIMITIVE_CAPSULE:
        return (solid_form){.ball = q, .high = p};
    case ZT_PRIMITIVE_TORUS:
        return (solid_form){.round = q, .ball = p};
    default:
        return (solid_form){.ball = 1};
    }
}

static void bound_solid(vec3 *low, vec3 *high, const double *pose, const solid_form *f) {
    xform place;
    memcpy(&place, pose, sizeof place);
    vec3 middle = xform_point(&place, (vec3){0, 0, (f->low + f->high) / 2});
    double half = (f->high - f->low) / 2, reach[3];
    for (int i = 0; i < 3; i++) {
        vec3 r = zt_xform_row(&place, i);
        reach[i] = f->round * hypot(r.x, r.y) + f->square * (fabs(r.x) + fabs(r.y)) +
                   f->ball * vec3_length(r) + half * fabs(r.z);
    }
    *low = vec3_sub(middle, (vec3){reach[0], reach[1], reach[2]});
    *high = vec3_add(middle, (vec3){reach[0], reach[1], reach[2]});
}

static void bound_pose(vec3 *low, vec3 *high, const double *pose, zt_primitive_kind kind,
                       const solid_form *form) {
    vec3 v[3];
    memcpy(v, pose, sizeof v);
    if (kind == ZT_PRIMITIVE_TRIANGLE) {
        *low = vec3_min(v[0], vec3_min(v[1], v[2]));
        *high = vec3_max(v[0], vec3_max(v[1], v[2]));
    } else if (kind == ZT_PRIMITIVE_SPHERE) {
        vec3 reach = {pose[3], pose[3], pose[3]};
        *low = vec3_sub(v[0], reach);
        *high = vec3_add(v[0], reach);
    } else {
        bound_solid(low, high, pose, form);
    }
}

/* Points go straight on between moments, so that what is around all poses is around the way. */
static void bound_motion(zt_making *m, const double *poses, int32_t count,
                         zt_primitive_kind kind) {
    double p = 0, q = 0;
    for (int32_t i = 0; i < count; i++) {
        p = fmax(p, poses[i * ZT_POSE_NUMBERS + 12]);
        q = fmax(q, poses[i * ZT_POSE_NUMBERS + 13]);
    }
    solid_form form = form_of(kind, p, q);
    vec3 all_low, all_high;
    bound_pose(&all_low, &all_high, poses, kind, &form);
    for (int32_t i = 1; i < count; i++) {
        vec3 low, high;
        bound_pose(&low, &high, poses + i * ZT_POSE_NUMBERS, kind, &form);
        all_low = vec3_min(all_low, low);
        all_high = vec3_max(all_high, high);
    }
    ZT_REAL_NAME(zt_set_bounds)(m, all_low, all_high);
}

/* ---- tables ---------------------------------------------------------------------------------
 */

/* Brings the numbers of a solid to where their products stay in range. Returns its unit. */
static double fit_range(double *poses, int32_t count, zt_primitive_kind kind) {
    double wide = 0, longest = 0;
    bool cone = kind == ZT_PRIMITIVE_CONE;
    for (int32_t i = 0; i < count; i++) {
        const double *pose = poses + i * ZT_POSE_NUMBERS;
        wide = fmax(wide, cone ? fmax(pose[12], pose[13]) : pose[13]);
    }
    if (zt_pose_size(kind) < ZT_POSE_NUMBERS) wide = 1;
    for (int32_t i = 0; i < count; i++) {
        double *pose = poses + i * ZT_POSE_NUMBERS;
        pose[12] /= wide;
        pose[13] /= wide;
        for (int n = 0; n < 9; n++) {
            if (!cone || n < 6) pose[n] *= wide;
            longest = fmax(longest, fabs(pose[n]));
        }
    }
    int exponent;
    frexp(longest, &exponent);
    double unit = ldexp(1, -exponent);
    for (int32_t i = 0; i < count; i++)
        for (int n = 0; n < 9; n++) poses[i * ZT_POSE_NUMBERS + n] *= unit;
    return unit;
}

static real *make_table(const double *poses, int32_t count, int size, zt_arena *arena) {
    real *table = ZT_PUSH(arena, real, (size_t)(count - 1) * 2 * (size_t)size);
    if (!table) return NULL;
    for (int32_t i = 0; i < count - 1; i++)
        for (int n = 0; n < size; n++) {
            const double *at = poses + i * ZT_POSE_NUMBERS + n;
            table[2 * i * size + n] = (real)*at;
            table[(2 * i + 1) * size + n] = (real)(at[ZT_POSE_NUMBERS] - *at);
        }
    return table;
}

zt_status ZT_REAL_NAME(zt_prepare_motion)(bool *there, zt_making *m, const zt_course *c) {
    zt_primitive *p = m->primitive;
    const int32_t count = c->exposure->moment_count, i = p->object;
    const zt_primitive_kind kind = kind_of(c, i, p->kind);
    const int size = zt_pose_size(kind);
    round_axes axes = {{0, 0, 0}, {0, 0, 0}};
    bool moves = false;
    for (int32_t k = 0; k < count; k++) {
        double *pose = c->poses + k * ZT_POSE_NUMBERS;
        memset(pose, 0, ZT_POSE_NUMBERS * sizeof *pose);
        make_pose(pose, &c->exposure->moments[k].objects[i], &zt_course_worlds(c, k)[i], kind,
                  &axes);
        moves |= !zt_bits_equal(c->poses, pose, (size_t)size * sizeof *pose);
        for (int n = 0; n < size; n++) *there &= isfinite(pose[n]);
    }
    if (!moves || !*there) return ZT_OK;
    bool solid = zt_kind_is_solid(kind);
    if (kind != ZT_PRIMITIVE_PLANE) bound_motion(m, c->poses, count, kind);
    double unit = solid ? fit_range(c->poses, count, kind) : 1;
    p->kind = kind;
    p->unit = (real)unit;
    p->poses = make_table(c->poses, count, size, c->arena);
    zt_surface *s = m->surface;
    *s = (zt_surface){.pattern = -1, .closed = s->closed};
    return p->poses ? ZT_OK : ZT_EMEMORY;
}

/* ---- looks ----------------------------------------------------------------------------------
 */

xform ZT_REAL_NAME(zt_pattern_place)(const zt_object *o, const xform *world) {
    xform own;
    if (o->shape == ZT_SHAPE_MESH)
        own = xform_place(o->placement.position, o->placement.rotation, o->placement.scale);
    else if (o->shape == ZT_SHAPE_BOX)
        own = xform_place(o->box.center, o->box.rotation, (vec3){1, 1, 1});
    else
        return *world;
    return xform_mul(world, &own);
}

static zt_looks looks_at(const zt_course *c, int32_t i, int32_t moment) {
    const zt_scene *scene = &c->exposure->moments[moment];
    const zt_object *object = &scene->objects[i];
    const zt_material *m = &scene->materials[object->material];
    zt_looks looks = {.color = m->color, .reflectivity = m->reflectivity};
    if (m->pattern == ZT_PATTERN_NONE) return looks;
    looks.other_color = m->other_color;
    looks.place = ZT_REAL_NAME(zt_pattern_place)(object, &zt_course_worlds(c, moment)[i]);
    looks.across = vec3_normalize(m->pattern_direction);
    looks.size = m->pattern_size;
    return looks;
}

zt_status ZT_REAL_NAME(zt_prepare_looks)(zt_change *change, const zt_object *object, int32_t i,
                                         const zt_course *c) {
    const int32_t count = c->exposure->moment_count;
    bool changes = false;
    zt_looks first = looks_at(c, i, 0);
    for (int32_t k = 1; k < count && !changes; k++) {
        zt_looks looks = looks_at(c, i, k);
        changes = !zt_bits_equal(&looks, &first, sizeof looks);
    }
    if (!changes) return ZT_OK;
    zt_looks *all = ZT_PUSH(c->arena, zt_looks, (size_t)count);
    if (!all) return ZT_EMEMORY;
    for (int32_t k = 0; k < count; k++) all[k] = looks_at(c, i, k);
    *change = (zt_change){all, c->exposure->moments->materials[object->material].pattern};
    return ZT_OK;
}
