/* Makes a scene ready for the reference: each object in the space relative to the camera. */
#include "reference.h"

/* The world of each object's group, relative to the camera. */
static void find_worlds(affine *worlds, const zt_scene *scene) {
    real3 eye = real3_of(scene->camera.position);
    for (int32_t i = 0; i < scene->object_count; i++) {
        int32_t parent = scene->objects[i].parent;
        worlds[i] = (affine){{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, real3_scale(eye, -1)};
        if (parent < 0) continue;
        const zt_placement *p = &scene->objects[parent].placement;
        affine own = affine_place(p->position, p->rotation, real3_of(p->scale));
        worlds[i] = affine_mul(&worlds[parent], &own);
    }
}

static real squares(const real3 v[3]) {
    return real3_dot(v[0], v[0]) + real3_dot(v[1], v[1]) + real3_dot(v[2], v[2]);
}

/* Makes `own`, which takes the primitive's own space to its group's, its place in the world;
 * the ball around it is that of all points at most `reach` from `middle` in its own space. */
static void place(ref_primitive *p, const affine *world, const affine *own, real3 middle,
                  real reach) {
    affine whole = affine_mul(world, own);
    p->present = affine_inverse_rows(p->rows, &whole);
    for (int i = 0; i < 3; i++) p->lengths[i] = real3_length(p->rows[i]);
    p->center = whole.shift;
    p->place = whole;
    real3 back[3];
    if (affine_inverse_rows(back, world))
        p->askew =
            REAL(sqrt)(squares(back) * squares((real3[]){world->x, world->y, world->z})) / 3;
    p->middle = middle;
    p->round = reach;
    real size = REAL(sqrt)(squares((real3[]){whole.x, whole.y, whole.z})) * reach;
    p->around = real3_round(affine_point(&whole, middle));
    p->reach = (double)size * 1.0001;
    p->extent = real3_length(affine_point(&whole, middle)) + size;
}

/* z along `axis`, x and y across, at `at`. */
static affine stand(vec3 at, real3 axis, real across, real along) {
    real3 x, y, z = real3_unit(axis);
    real3_frame(&x, &y, z);
    return (affine){real3_scale(x, across), real3_scale(y, across), real3_scale(z, along),
                    real3_of(at)};
}

static void prepare_tube(ref_primitive *p, const zt_tube *tube, const affine *world) {
    real3 way = real3_sub(real3_of(tube->to), real3_of(tube->from));
    real length = real3_length(way), r = tube->radius;
    if (p->shape == ZT_SHAPE_CAPSULE) {
        if (length == 0) way = (real3){0, 0, 1};
        affine own = stand(tube->from, way, r, r);
        p->a = length / r;
        place(p, world, &own, (real3){0, 0, p->a / 2}, 1 + p->a / 2);
        return;
    }
    if (p->shape == ZT_SHAPE_CONE) r = real_max(r, tube->end_radius);
    affine own = stand(tube->from, way, r, length);
    p->a = tube->radius / r;
    p->b = tube->end_radius / r;
    place(p, world, &own, (real3){0, 0, (real)0.5}, (real)1.2);
    p->present &= length > 0;
}

static void prepare_plane(ref_primitive *p, const zt_plane *plane, const affine *world) {
    real3 given = real3_unit(real3_of(plane->normal));
    real3 point = affine_point(world, real3_scale(given, plane->distance));
    /* Cofactors take normals along; a mirroring world keeps the side. */
    real3 n = real3_add(real3_add(real3_scale(real3_cross(world->y, world->z), given.x),
                                  real3_scale(real3_cross(world->z, world->x), given.y)),
                        real3_scale(real3_cross(world->x, world->y), given.z));
    bool mirrors = real3_dot(real3_cross(world->x, world->y), world->z) < 0;
    p->normal = real3_unit(mirrors ? real3_scale(n, -1) : n);
    p->present = real3_dot(n, n) > 0;
    p->level = real3_dot(p->normal, point);
    p->extent = real_abs(p->level);
    p->grain = (real)0x1p-49 * (real_abs(plane->distance) + real3_length(world->shift));
    p->reach = INFINITY;
}

static void prepare_triangle(ref_triangle *t, const affine *to_world, const vec3 corners[3]) {
    real3 middle = {0, 0, 0};
    for (int i = 0; i < 3; i++) {
        t->v[i] = affine_point(to_world, real3_of(corners[i]));
        middle = real3_add(middle, real3_scale(t->v[i], (real)1 / 3));
    }
    real3 cross = real3_cross(real3_sub(t->v[1], t->v[0]), real3_sub(t->v[2], t->v[0]));
    t->normal = real3_unit(cross);
    real reach = 0, longest = 0;
    for (int i = 0; i < 3; i++) {
        reach = real_max(reach, real3_length(real3_sub(t->v[i], middle)));
        longest = real_max(longest, real3_length(real3_sub(t->v[(i + 1) % 3], t->v[i])));
    }
    t->around = real3_round(middle);
    t->reach = (double)reach * 1.0001;
    t->smallest = longest > 0 ? real3_length(cross) / longest : 0;
}

/* The ball around all triangles, and whether any of them has an area. */
static void surround(ref_primitive *p) {
    real3 middle = {0, 0, 0};
    for (int32_t i = 0; i < p->triangle_count; i++)
        middle = real3_add(
            middle, real3_scale(real3_of(p->triangles[i].around), (real)1 / p->triangle_count));
    real reach = 0;
    for (int32_t i = 0; i < p->triangle_count; i++) {
        const ref_triangle *t = &p->triangles[i];
        p->present |= real3_dot(t->normal, t->normal) > 0;
        for (int k = 0; k < 3; k++)
            reach = real_max(reach, real3_length(real3_sub(t->v[k], middle)));
    }
    p->around = real3_round(middle);
    p->reach = (double)reach * 1.0001;
    p->extent = real3_length(middle) + reach;
}

static bool prepare_mesh(ref_primitive *p, const zt_object *object, const zt_mesh *mesh,
                         const affine *world, zt_arena *arena) {
    const zt_placement *at = &object->placement;
    affine own = affine_place(at->position, at->rotation, real3_of(at->scale));
    affine whole = affine_mul(world, &own);
    real3 rows[3];
    if (!affine_inverse_rows(rows, &whole)) return true; /* flattened: nothing to hit */
    p->triangle_count = mesh->triangle_count;
    p->triangles = ZT_PUSH(arena, ref_triangle, (size_t)p->triangle_count);
    if (!p->triangles) return false;
    for (int32_t i = 0; i < p->triangle_count; i++) {
        vec3 corners[3];
        for (int k = 0; k < 3; k++) corners[k] = zt_mesh_corner(mesh, i, k);
        prepare_triangle(&p->triangles[i], &whole, corners);
    }
    surround(p);
    return true;
}

static bool prepare(ref_primitive *p, const zt_scene *scene, const affine *world,
                    zt_arena *arena) {
    const zt_object *object = &scene->objects[p->object];
    affine own;
    switch (object->shape) {
    case ZT_SHAPE_PLANE:
        prepare_plane(p, &object->plane, world);
        return true;
    case ZT_SHAPE_SPHERE:
        own = stand(object->sphere.center, (real3){0, 0, 1}, object->sphere.radius,
                    object->sphere.radius);
        place(p, world, &own, (real3){0, 0, 0}, 1);
        return true;
    case ZT_SHAPE_DISK:
        own = stand(object->disk.center, real3_of(object->disk.normal), object->disk.radius,
                    object->disk.radius);
        place(p, world, &own, (real3){0, 0, 0}, 1);
        return true;
    case ZT_SHAPE_BOX:
        own = affine_place(object->box.center, object->box.rotation,
                           real3_scale(real3_of(object->box.size), (real)0.5));
        place(p, world, &own, (real3){0, 0, 0}, (real)1.7320509);
        return true;
    case ZT_SHAPE_CYLINDER:
    case ZT_SHAPE_CONE:
    case ZT_SHAPE_CAPSULE:
        prepare_tube(p, &object->tube, world);
        return true;
    case ZT_SHAPE_TORUS:
        own = stand(object->torus.center, real3_of(object->torus.axis), object->torus.radius,
                    object->torus.radius);
        p->a = (real)object->torus.tube_radius / object->torus.radius;
        place(p, world, &own, (real3){0, 0, 0}, 1 + p->a);
        return true;
    case ZT_SHAPE_TRIANGLE:
        p->triangle_count = 1;
        p->triangles = ZT_PUSH(arena, ref_triangle, 1);
        if (!p->triangles) return false;
        prepare_triangle(p->triangles, world, object->triangle.vertices);
        surround(p);
        return true;
    case ZT_SHAPE_MESH:
        return prepare_mesh(p, object, &scene->meshes[object->mesh], world, arena);
    default:
        return true;
    }
}

bool ref_prepare(ref_scene *ref, const zt_scene *scene, zt_arena *arena) {
    size_t count = (size_t)scene->object_count;
    ref_primitive *primitives = ZT_PUSH(arena, ref_primitive, count);
    affine *worlds = ZT_PUSH(arena, affine, count);
    real3 *lights = ZT_PUSH(arena, real3, (size_t)scene->light_count);
    if (!primitives || !worlds || !lights) return false;
    find_worlds(worlds, scene);
    for (int32_t i = 0; i < scene->object_count; i++) {
        primitives[i] = (ref_primitive){.shape = scene->objects[i].shape, .object = i};
        if (!prepare(&primitives[i], scene, &worlds[i], arena)) return false;
    }
    for (int32_t i = 0; i < scene->light_count; i++)
        lights[i] =
            real3_sub(real3_of(scene->lights[i].position), real3_of(scene->camera.position));
    *ref = (ref_scene){scene, primitives, lights};
    return true;
}
