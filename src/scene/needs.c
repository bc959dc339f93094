#include "scene/needs.h"

#include "base/diag.h"

/* What lies on another side of a plane does so by this share of the largest number around. */
#define APART 0x1p-10

/* ---- how far things reach ------------------------------------------------------------------
 */

/* The numbers n . p of some points p. */
typedef struct range {
    double low, high;
} range;

static range around(double middle, double half) {
    return (range){middle - half, middle + half};
}
static range both(range a, range b) {
    return (range){fmin(a.low, b.low), fmax(a.high, b.high)};
}

/* Of a disk across an axis. */
static range disk_range(vec3 center, vec3 axis, double radius, vec3 n) {
    vec3 a = vec3_normalize(axis);
    vec3 within = vec3_sub(n, vec3_scale(a, vec3_dot(n, a)));
    return around(vec3_dot(n, center), radius * vec3_length(within));
}

static range box_range(const xform *place, vec3 half, vec3 n) {
    double reach = half.x * fabs(vec3_dot(n, place->x)) + half.y * fabs(vec3_dot(n, place->y)) +
                   half.z * fabs(vec3_dot(n, place->z));
    return around(vec3_dot(n, place->shift), reach);
}

static range mesh_range(const zt_mesh *mesh, const zt_placement *p, vec3 n) {
    xform place = xform_place(p->position, p->rotation, p->scale);
    place.shift = xform_point(&place, vec3_scale(vec3_add(mesh->low, mesh->high), 0.5));
    return box_range(&place, vec3_scale(vec3_sub(mesh->high, mesh->low), 0.5), n);
}

static range tube_range(const zt_tube *tube, double end_radius, vec3 n) {
    vec3 way = vec3_sub(tube->to, tube->from);
    return both(disk_range(tube->from, way, tube->radius, n),
                disk_range(tube->to, way, end_radius, n));
}

/* Of an object in its own space; planes and groups have no end. */
static range own_range(const zt_object *o, const zt_mesh *meshes, vec3 n) {
    const double length = vec3_length(n);
    xform place;
    range r;
    switch (o->shape) {
    case ZT_SHAPE_SPHERE:
        return around(vec3_dot(n, o->sphere.center), o->sphere.radius * length);
    case ZT_SHAPE_TRIANGLE:
        r = around(vec3_dot(n, o->triangle.vertices[0]), 0);
        for (int i = 1; i < 3; i++)
            r = both(r, around(vec3_dot(n, o->triangle.vertices[i]), 0));
        return r;
    case ZT_SHAPE_DISK:
        return disk_range(o->disk.center, o->disk.normal, o->disk.radius, n);
    case ZT_SHAPE_BOX:
        place = xform_place(o->box.center, o->box.rotation, (vec3){1, 1, 1});
        return box_range(&place, vec3_scale(o->box.size, 0.5), n);
    case ZT_SHAPE_CYLINDER:
        return tube_range(&o->tube, o->tube.radius, n);
    case ZT_SHAPE_CONE:
        return tube_range(&o->tube, o->tube.end_radius, n);
    case ZT_SHAPE_CAPSULE:
        return both(around(vec3_dot(n, o->tube.from), o->tube.radius * length),
                    around(vec3_dot(n, o->tube.to), o->tube.radius * length));
    case ZT_SHAPE_TORUS:
        r = disk_range(o->torus.center, o->torus.axis, o->torus.radius, n);
        return (range){r.low - o->torus.tube_radius * length,
                       r.high + o->torus.tube_radius * length};
    case ZT_SHAPE_MESH:
        return mesh_range(&meshes[o->mesh], &o->placement, n);
    default:
        return (range){-INFINITY, INFINITY};
    }
}

static range object_range(const zt_scene *scene, const xform *world, int32_t object, vec3 n) {
    vec3 own = {vec3_dot(n, world->x), vec3_dot(n, world->y), vec3_dot(n, world->z)};
    range r = own_range(&scene->objects[object], scene->meshes, own);
    double shift = vec3_dot(n, world->shift);
    return (range){r.low + shift, r.high + shift};
}

static range light_range(const zt_light *light, vec3 n) {
    return around(vec3_dot(n, light->position), zt_light_reach(light));
}

/* ---- which lights reach what ---------------------------------------------------------------
 */

/* -1, 0 or 1: below a plane, on both sides of it or too near, above. */
static int side_of(range r, double distance, double size) {
    double room = APART * fmax(size, fmax(fabs(r.low), fabs(r.high)));
    return r.high < distance - room ? -1 : r.low > distance + room ? 1 : 0;
}

/* A plane in the world; false where it has nothing to hit. */
static bool plane_of(vec3 *n, double *distance, const zt_object *o, const xform *world) {
    vec3 own = vec3_normalize(o->plane.normal);
    *n = vec3_normalize(xform_normal(world, own));
    *distance = vec3_dot(*n, xform_point(world, vec3_scale(own, o->plane.distance)));
    return vec3_max_abs(own) > 0 && vec3_max_abs(*n) > 0;
}

/* Whether a plane stands still between a light and an object at all moments. */
static bool is_between(const zt_exposure *e, const xform *worlds, int32_t plane, int32_t light,
                       int32_t object) {
    const size_t count = (size_t)e->moments->object_count;
    for (int32_t m = 0; m < e->moment_count; m++) {
        const zt_scene *scene = &e->moments[m];
        const xform *world = worlds + (size_t)m * count;
        const zt_object *o = &scene->objects[plane];
        vec3 n;
        double distance;
        if (!plane_of(&n, &distance, o, &world[plane])) return false;
        if (m > 0 && (!zt_object_stays(o, &e->moments->objects[plane]) ||
                      !xform_equal(&world[plane], &worlds[plane])))
            return false;
        int lit = side_of(light_range(&scene->lights[light], n), distance, fabs(distance));
        int own =
            side_of(object_range(scene, &world[object], object, n), distance, fabs(distance));
        if (lit == 0 || lit + own != 0) return false;
    }
    return true;
}

/* Whether a light that shines to one side has the object on the other at all moments. */
static bool is_away(const zt_exposure *e, const xform *worlds, int32_t light, int32_t object) {
    for (int32_t m = 0; m < e->moment_count; m++) {
        const zt_scene *scene = &e->moments[m];
        const zt_light *l = &scene->lights[light];
        if (l->kind != ZT_LIGHT_DISK && l->kind != ZT_LIGHT_RECTANGLE) return false;
        vec3 n = xform_place(l->position, l->rotation, (vec3){1, 1, 1}).z;
        double distance = vec3_dot(n, l->position);
        const xform *world = worlds + (size_t)m * (size_t)scene->object_count + object;
        range r = object_range(scene, world, object, n);
        if (side_of(r, distance, fabs(distance)) != 1) return false;
    }
    return true;
}

zt_reaching zt_needs_reaching(int32_t *plane, const zt_exposure *e, const xform *worlds,
                              int32_t light, int32_t object) {
    if (is_away(e, worlds, light, object)) return ZT_REACHES_AWAY;
    for (int32_t i = 0; i < e->moments->object_count; i++) {
        if (e->moments->objects[i].shape != ZT_SHAPE_PLANE || i == object) continue;
        *plane = i;
        if (is_between(e, worlds, i, light, object)) return ZT_REACHES_BEHIND;
    }
    return ZT_REACHES;
}

/* ---- what occurs ---------------------------------------------------------------------------
 */

static bool mirrors(const zt_exposure *e, int32_t object) {
    bool any = false;
    for (int32_t m = 0; m < e->moment_count; m++) {
        int32_t material = e->moments[m].objects[object].material;
        any |= material >= 0 && e->moments[m].materials[material].reflectivity > 0;
    }
    return any;
}

/* Whether an object, or the light with this index, is not the same at all moments. */
static bool object_moves(const zt_exposure *e, int32_t object) {
    for (int32_t m = 1; m < e->moment_count; m++)
        for (int32_t i = object; i >= 0; i = e->moments->objects[i].parent)
            if (!zt_object_equal(&e->moments[m].objects[i], &e->moments->objects[i]))
                return true;
    return false;
}

static void find_objects(zt_needs *needs, const zt_exposure *e) {
    const zt_scene *scene = e->moments;
    needs->mirror = -1;
    for (int32_t i = 0; i < scene->object_count; i++) {
        const zt_object *o = &scene->objects[i];
        if (o->shape == ZT_SHAPE_GROUP) continue;
        needs->object_count++;
        needs->mesh_count += o->shape == ZT_SHAPE_MESH;
        needs->pattern_count += scene->materials[o->material].pattern != ZT_PATTERN_NONE;
        needs->moving_count += object_moves(e, i);
        if (!mirrors(e, i)) continue;
        if (needs->mirror_count++ == 0) needs->mirror = i;
    }
}

/* Whether an infinite plane, the only mirror, has all else behind its back as the camera sees
 * it: so that what is mirrored is nothing. A picture that is orthographic, or seen through an
 * opening, is not seen from one place alone. */
static bool mirrors_nothing(const zt_needs *needs, const zt_exposure *e) {
    const zt_scene *scene = e->moments;
    const zt_object *mirror = &scene->objects[needs->mirror];
    vec3 n = vec3_normalize(mirror->plane.normal);
    double distance = mirror->plane.distance;
    if (e->moment_count > 1 || needs->mirror_count != 1 || mirror->shape != ZT_SHAPE_PLANE ||
        scene->camera.lens == ZT_LENS_ORTHOGRAPHIC || needs->has_opening)
        return false;
    for (int32_t i = 0; i < scene->object_count; i++)
        if (scene->objects[i].parent >= 0) return false;
    double eye = vec3_dot(n, scene->camera.position);
    int seen = side_of((range){eye, eye}, distance, fabs(distance));
    for (int32_t i = 0; i < scene->object_count; i++) {
        if (i == needs->mirror) continue;
        range r = own_range(&scene->objects[i], scene->meshes, n);
        if (!isfinite(r.low + r.high) || seen * side_of(r, distance, fabs(distance)) != -1)
            return false;
    }
    return seen != 0;
}

static zt_status find_lights(zt_needs *needs, const zt_exposure *e, bool everything,
                             zt_arena *arena) {
    size_t count = (size_t)e->moments->light_count;
    bool *shines = ZT_PUSH(arena, bool, count), *shadows = ZT_PUSH(arena, bool, count);
    if (!shines || !shadows) return ZT_EMEMORY;
    for (size_t i = 0; i < count; i++)
        for (int32_t m = 0; m < e->moment_count; m++) {
            const zt_light *l = &e->moments[m].lights[i];
            bool dark = l->intensity == 0 || vec3_max_abs(l->color) == 0;
            shines[i] |= everything || !dark;
            shadows[i] |= l->shadows;
        }
    needs->shines = shines;
    needs->shadows = shadows;
    return ZT_OK;
}

static double greatest(vec3 a) { return fmax(a.x, fmax(a.y, a.z)); }

/* All of the ambient light, and of each lamp as much as a point may have of it. */
static double find_brightest(const zt_exposure *e) {
    double ambient = 0, color = 0, lamps = 0;
    for (int32_t m = 0; m < e->moment_count; m++) {
        const zt_scene *scene = &e->moments[m];
        vec3 sum = {0, 0, 0};
        for (int32_t i = 0; i < scene->light_count; i++) {
            const zt_light *l = &scene->lights[i];
            bool somewhere = l->kind != ZT_LIGHT_AMBIENT;
            lamps += m == 0 && somewhere;
            if (!somewhere) sum = vec3_add(sum, vec3_scale(l->color, l->intensity));
        }
        ambient = fmax(ambient, greatest(sum));
        for (int32_t i = 0; i < scene->material_count; i++)
            color = fmax(color, fmax(greatest(scene->materials[i].color),
                                     greatest(scene->materials[i].other_color)));
        for (int32_t i = 0; i < scene->object_count; i++) /* times any number there is */
            if (scene->objects[i].vertex_colors) return INFINITY;
    }
    return ambient * color + lamps;
}

/* Light may be faint where it is less than half of the last place of a sum: of as many points
 * as there were mirrors, and one. */
static int32_t find_faint_depth(const zt_exposure *e) {
    double least = 1, share = 1;
    for (int32_t m = 0; m < e->moment_count; m++)
        for (int32_t i = 0; i < e->moments->object_count; i++) {
            int32_t material = e->moments[m].objects[i].material;
            if (material < 0) continue;
            double own = e->moments[m].materials[material].reflectivity;
            /* On its way from or to none it is any. */
            if (own == 0 && mirrors(e, i)) return 0;
            if (own > 0) least = fmin(least, own);
        }
    for (int32_t depth = 0; depth < e->moments->reflection_depth; depth++) {
        share *= least;
        if (share < (depth + 1) * 0x1p-25) return depth;
    }
    return INT32_MAX;
}

zt_status zt_needs_find(zt_needs *needs, const zt_exposure *exposure, bool everything,
                        zt_arena *arena) {
    const zt_scene *scene = exposure->moments;
    *needs = (zt_needs){.mirror_depth = scene->reflection_depth,
                        .brightest = find_brightest(exposure),
                        .faint_depth = find_faint_depth(exposure)};
    ZT_TRY(find_lights(needs, exposure, everything, arena));
    find_objects(needs, exposure);
    for (int32_t m = 0; m < exposure->moment_count; m++) {
        const zt_camera *camera = &exposure->moments[m].camera;
        needs->camera_moves |= !zt_camera_equal(camera, &scene->camera);
        needs->has_opening |= zt_camera_opening(camera) > 0;
    }
    if (everything) return ZT_OK;
    if (needs->mirror_count == 0 || mirrors_nothing(needs, exposure)) needs->mirror_depth = 0;
    return ZT_OK;
}
