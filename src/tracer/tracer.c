/* Prepares a scene: objects of any group become primitives in the space relative to the camera,
 * lights become lamps. All is computed in double precision and rounded once, at the end. */
#include "tracer/tracer.h"

#include <math.h>

#include "base/diag.h"

/* How far a transform may be from turning and scaling alike in all directions for a sphere to
 * stay a sphere: well above what products of a few rotations round to, and far below a pixel.
 */
#define SIMILARITY_TOLERANCE 1e-12

static real3 to_real3(vec3 v) { return (real3){(real)v.x, (real)v.y, (real)v.z}; }

static bool finite3(vec3 v) { return isfinite(v.x) && isfinite(v.y) && isfinite(v.z); }

/* The factor of a transform that scales alike in all directions, or 0 for another one. */
static double similarity_scale(const xform *m) {
    double xx = vec3_dot(m->x, m->x), yy = vec3_dot(m->y, m->y), zz = vec3_dot(m->z, m->z);
    double largest = fmax(xx, fmax(yy, zz)), off = SIMILARITY_TOLERANCE * largest;
    bool similar = largest - fmin(xx, fmin(yy, zz)) <= off &&
                   fabs(vec3_dot(m->x, m->y)) <= off && fabs(vec3_dot(m->y, m->z)) <= off &&
                   fabs(vec3_dot(m->z, m->x)) <= off;
    return similar ? sqrt(xx) : 0;
}

/* Each of the following makes one primitive and its surface; false where there is nothing to
 * hit. `world` takes the object's numbers to the world relative to the camera. */

static bool prepare_plane(zt_primitive *primitive, zt_surface *surface, const zt_plane *plane,
                          const xform *world) {
    vec3 given = vec3_normalize(plane->normal);
    vec3 point = xform_point(world, vec3_scale(given, plane->distance));
    vec3 normal = vec3_normalize(xform_normal(world, given));
    double distance = vec3_dot(normal, point);
    if (vec3_max_abs(normal) == 0 || !finite3(normal) || !isfinite(distance)) return false;
    primitive->kind = ZT_PRIMITIVE_PLANE;
    primitive->plane.normal = to_real3(normal);
    primitive->plane.distance = (real)distance;
    surface->normal = primitive->plane.normal;
    surface->level = primitive->plane.distance;
    surface->extent = (real)fabs(distance);
    return true;
}

static bool prepare_ellipsoid(zt_primitive *primitive, zt_surface *surface,
                              const zt_sphere *sphere, const xform *world) {
    vec3 center = xform_point(world, sphere->center);
    xform unit = xform_inverse(world);
    double shrink = 1 / sphere->radius;
    vec3 rows[3] = {vec3_scale((vec3){unit.x.x, unit.y.x, unit.z.x}, shrink),
                    vec3_scale((vec3){unit.x.y, unit.y.y, unit.z.y}, shrink),
                    vec3_scale((vec3){unit.x.z, unit.y.z, unit.z.z}, shrink)};
    if (!finite3(center) || !finite3(rows[0]) || !finite3(rows[1]) || !finite3(rows[2]))
        return false;
    primitive->kind = ZT_PRIMITIVE_ELLIPSOID;
    for (int i = 0; i < 3; i++) primitive->ellipsoid.to_unit[i] = to_real3(rows[i]);
    primitive->ellipsoid.center = to_real3(center);
    const xform *w = world; /* the sphere reaches as far along an axis as a row of it is long */
    vec3 reach = {vec3_length((vec3){w->x.x, w->y.x, w->z.x}) * sphere->radius,
                  vec3_length((vec3){w->x.y, w->y.y, w->z.y}) * sphere->radius,
                  vec3_length((vec3){w->x.z, w->y.z, w->z.z}) * sphere->radius};
    surface->extent = (real)(vec3_max_abs(center) + vec3_max_abs(reach));
    return true;
}

static bool prepare_sphere(zt_primitive *primitive, zt_surface *surface,
                           const zt_sphere *sphere, const xform *world) {
    double scale = similarity_scale(world);
    if (scale == 0) return prepare_ellipsoid(primitive, surface, sphere, world);
    vec3 center = xform_point(world, sphere->center);
    double radius = sphere->radius * scale;
    if (!(radius > 0) || !isfinite(radius) || !finite3(center)) return false;
    primitive->kind = ZT_PRIMITIVE_SPHERE;
    primitive->sphere.center = to_real3(center);
    primitive->sphere.radius = (real)radius;
    vec3 reach = {radius, radius, radius};
    primitive->box =
        (zt_box){to_real3(vec3_sub(center, reach)), to_real3(vec3_add(center, reach))};
    surface->bend = (real)(1 / radius);
    surface->center = primitive->sphere.center;
    surface->level = primitive->sphere.radius;
    surface->extent = (real)(vec3_max_abs(center) + radius);
    return true;
}

static bool prepare_triangle(zt_primitive *primitive, zt_surface *surface,
                             const zt_triangle *triangle, const xform *world) {
    vec3 v[3];
    double extent = 0;
    for (int i = 0; i < 3; i++) {
        v[i] = xform_point(world, triangle->vertices[i]);
        if (!finite3(v[i])) return false;
        extent = fmax(extent, vec3_max_abs(v[i]));
        primitive->triangle.vertices[i] = to_real3(v[i]);
    }
    vec3 normal = vec3_normalize(
        vec3_cross(vec3_normalize(vec3_sub(v[1], v[0])), vec3_normalize(vec3_sub(v[2], v[0]))));
    if (vec3_max_abs(normal) == 0) return false;
    primitive->kind = ZT_PRIMITIVE_TRIANGLE;
    primitive->box = (zt_box){to_real3(vec3_min(v[0], vec3_min(v[1], v[2]))),
                              to_real3(vec3_max(v[0], vec3_max(v[1], v[2])))};
    surface->normal = to_real3(normal);
    surface->center = primitive->triangle.vertices[0];
    surface->extent = (real)extent;
    return true;
}

/* `index` is the number that the primitive will have. */
static zt_status prepare_mesh(bool *hittable, zt_primitive *primitive, int32_t index,
                              const zt_object *object, const xform *world, zt_meshes *meshes) {
    const zt_placement *p = &object->placement;
    xform own = xform_place(p->position, p->rotation, p->scale);
    xform place = xform_mul(world, &own);
    double determinant = xform_determinant(&place);
    *hittable = determinant != 0 && isfinite(determinant) && finite3(place.shift);
    if (!*hittable) return ZT_OK;
    primitive->kind = ZT_PRIMITIVE_MESH;
    primitive->mesh = object->mesh;
    return zt_meshes_place(meshes, object->mesh, index, &place);
}

static zt_status prepare_objects(zt_tracer *tracer, const zt_scene *scene, zt_meshes *meshes,
                                 zt_arena *arena) {
    size_t count = (size_t)scene->object_count;
    zt_primitive *primitives = ZT_PUSH(arena, zt_primitive, count);
    zt_surface *surfaces = ZT_PUSH(arena, zt_surface, count);
    xform *worlds = ZT_PUSH(arena, xform, count);
    if (!primitives || !surfaces || !worlds) return ZT_EMEMORY;
    zt_scene_worlds(worlds, scene, scene->camera.position);
    int32_t made = 0;
    for (int32_t i = 0; i < scene->object_count; i++) {
        const zt_object *object = &scene->objects[i];
        if (object->shape == ZT_SHAPE_GROUP) continue;
        zt_primitive *primitive = &primitives[made];
        zt_surface *surface = &surfaces[made];
        *primitive = (zt_primitive){.object = i, .mesh = -1};
        *surface = (zt_surface){0};
        bool hittable = false;
        switch (object->shape) {
        case ZT_SHAPE_PLANE:
            hittable = prepare_plane(primitive, surface, &object->plane, &worlds[i]);
            break;
        case ZT_SHAPE_SPHERE:
            hittable = prepare_sphere(primitive, surface, &object->sphere, &worlds[i]);
            break;
        case ZT_SHAPE_TRIANGLE:
            hittable = prepare_triangle(primitive, surface, &object->triangle, &worlds[i]);
            break;
        case ZT_SHAPE_MESH:
            ZT_TRY(prepare_mesh(&hittable, primitive, made, object, &worlds[i], meshes));
            if (hittable) tracer->meshes = meshes;
            break;
        default:
            break;
        }
        if (!hittable) continue;
        tracer->has_other_surfaces |=
            primitive->kind == ZT_PRIMITIVE_MESH || primitive->kind == ZT_PRIMITIVE_ELLIPSOID;
        const zt_material *material = &scene->materials[object->material];
        surface->color = to_real3(material->color);
        surface->reflectivity = (real)material->reflectivity;
        made++;
    }
    tracer->primitives = primitives;
    tracer->surfaces = surfaces;
    tracer->primitive_count = made;
    return ZT_OK;
}

static zt_status prepare_lights(zt_tracer *tracer, const zt_scene *scene, zt_arena *arena) {
    zt_lamp *lamps = ZT_PUSH(arena, zt_lamp, (size_t)scene->light_count);
    if (!lamps) return ZT_EMEMORY;
    vec3 ambient = {0, 0, 0};
    for (int32_t i = 0; i < scene->light_count; i++) {
        const zt_light *light = &scene->lights[i];
        vec3 power = vec3_scale(light->color, light->intensity);
        if (light->kind == ZT_LIGHT_AMBIENT)
            ambient = vec3_add(ambient, power);
        else
            lamps[tracer->lamp_count++] =
                (zt_lamp){to_real3(vec3_sub(light->position, scene->camera.position)),
                          to_real3(power), light->shadows};
    }
    tracer->ambient = to_real3(ambient);
    tracer->lamps = lamps;
    return ZT_OK;
}

zt_status zt_tracer_prepare(zt_tracer *tracer, const zt_scene *scene, zt_meshes *meshes,
                            zt_arena *arena) {
    *tracer = (zt_tracer){.reflection_depth = scene->reflection_depth};
    zt_meshes_clear(meshes);
    ZT_TRY(prepare_lights(tracer, scene, arena));
    ZT_TRY(prepare_objects(tracer, scene, meshes, arena));
    return tracer->meshes ? zt_meshes_commit(meshes) : ZT_OK;
}
