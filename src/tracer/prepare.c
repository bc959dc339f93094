/* Prepares a scene: objects become primitives, patterns find their places.
 * All is computed in double precision and rounded once, at the end. Compiled once for each
 * precision. */
#include "tracer/prepare.h"

#include <math.h>

#include "base/diag.h"
#include "tracer/shapes.h"

/* More bounded things than this are asked through a hierarchy. */
enum { SINGLE_MAX = 32 };

static void make_pattern(zt_weave *weave, const zt_material *material, const zt_making *m) {
    xform place = *m->world;
    const zt_object *o = m->object;
    if (o->shape == ZT_SHAPE_MESH) {
        xform own =
            xform_place(o->placement.position, o->placement.rotation, o->placement.scale);
        place = xform_mul(m->world, &own);
    } else if (o->shape == ZT_SHAPE_BOX) {
        xform own = xform_place(o->box.center, o->box.rotation, (vec3){1, 1, 1});
        place = xform_mul(m->world, &own);
    }
    xform back = xform_inverse(&place);
    bool stripes = material->pattern == ZT_PATTERN_STRIPES;
    vec3 across = vec3_normalize(material->pattern_direction);
    double cells = 1 / material->pattern_size;
    double at[3];
    for (int i = 0; i < 3; i++) {
        vec3 r = zt_xform_row(&back, i);
        double shift = i == 0 ? back.shift.x : i == 1 ? back.shift.y : back.shift.z;
        if (stripes) {
            r = i > 0 ? (vec3){0, 0, 0}
                      : (vec3){vec3_dot(across, back.x), vec3_dot(across, back.y),
                               vec3_dot(across, back.z)};
            shift = i > 0 ? 0 : vec3_dot(across, back.shift);
        }
        weave->rows[i] = to_real3(vec3_scale(r, cells));
        at[i] = fmod(shift * cells, 2); /* two cells on, it is the same */
    }
    weave->at = to_real3((vec3){at[0], at[1], at[2]});
    weave->other = to_real3(material->other_color);
}

/* Everything that a scene's objects become; room for as many of each as there may be. */
typedef struct made {
    zt_primitive *primitives;
    zt_surface *surfaces;
    zt_extent *extents; /* of primitives, too */
    zt_placed_mesh *placed;
    zt_weave *weaves;
    int32_t count, placed_count, weave_count;
} made;

static void find_distances(zt_making *m, const zt_scene *scene) {
    zt_extent *e = m->extent;
    e->near = ZT_REAL_NAME(zt_shape_distance)(m, (vec3){0, 0, 0});
    e->lamp = INFINITY;
    for (int32_t i = 0; i < scene->light_count; i++) {
        if (scene->lights[i].kind == ZT_LIGHT_AMBIENT) continue;
        vec3 lamp = vec3_sub(scene->lights[i].position, scene->camera.position);
        double distance =
            fmax(ZT_REAL_NAME(zt_shape_distance)(m, lamp), zt_light_reach(&scene->lights[i]));
        if (!(distance < e->lamp)) continue;
        e->lamp = distance;
        e->lamp_light = i;
    }
}

static zt_status prepare_objects(made *all, zt_tracer *tracer, const zt_scene *scene,
                                 const xform *worlds, zt_meshes *meshes) {
    for (int32_t i = 0; i < scene->object_count; i++) {
        const zt_object *object = &scene->objects[i];
        if (object->shape == ZT_SHAPE_GROUP) continue;
        zt_making m = {&all->primitives[all->count], &all->surfaces[all->count],
                       &all->extents[all->count], object, &worlds[i]};
        *m.primitive = (zt_primitive){.object = i, .stretch = 1};
        *m.surface = (zt_surface){.pattern = -1};
        *m.extent = (zt_extent){.object = i, .least = INFINITY, .stretch = 1};
        if (object->shape == ZT_SHAPE_MESH) {
            zt_placed_mesh *placed = &all->placed[all->placed_count];
            if (!ZT_REAL_NAME(zt_prepare_mesh)(&m, placed, &scene->meshes[object->mesh]))
                continue;
            m.primitive->placed = all->placed_count++;
            ZT_TRY(zt_meshes_build(&placed->built, meshes, object->mesh));
        } else if (!ZT_REAL_NAME(zt_prepare_shape)(&m)) {
            continue;
        }
        find_distances(&m, scene);
        const zt_material *material = &scene->materials[object->material];
        m.surface->color = to_real3(material->color);
        m.surface->reflectivity = (real)material->reflectivity;
        if (material->pattern != ZT_PATTERN_NONE) {
            m.surface->pattern = all->weave_count;
            make_pattern(&all->weaves[all->weave_count++], material, &m);
        }
        tracer->has_solids |= zt_kind_is_solid(m.primitive->kind);
        all->count++;
    }
    tracer->primitives = all->primitives;
    tracer->surfaces = all->surfaces;
    tracer->primitive_count = all->count;
    tracer->placed = all->placed;
    tracer->placed_count = all->placed_count;
    tracer->weaves = all->weaves;
    tracer->has_patterns = all->weave_count > 0;
    return ZT_OK;
}

static real3 min3(real3 a, real3 b) {
    return (real3){real_min(a.x, b.x), real_min(a.y, b.y), real_min(a.z, b.z)};
}
static real3 max3(real3 a, real3 b) {
    return (real3){real_max(a.x, b.x), real_max(a.y, b.y), real_max(a.z, b.z)};
}

/* The box of a primitive in single precision, grown by what the roundings of its intersection
 * reach beyond it, and by those of rays that are made single precision at the crowd's box. */
static zt_bvh_box outside(const zt_primitive *p, real crowd_size) {
    const double low[3] = {(double)p->box.low.x, (double)p->box.low.y, (double)p->box.low.z};
    const double high[3] = {(double)p->box.high.x, (double)p->box.high.y,
                            (double)p->box.high.z};
    double room = (double)(BOX_ROUNDINGS * REAL_ROUNDING * p->stretch * zt_box_size(&p->box)) +
                  (double)crowd_size * 0x1p-20;
    zt_bvh_box box;
    for (int i = 0; i < 3; i++) {
        box.low[i] = nextafterf((float)(low[i] - room), -INFINITY);
        box.high[i] = nextafterf((float)(high[i] + room), INFINITY);
    }
    return box;
}

zt_status ZT_REAL_NAME(zt_prepare_search)(zt_tracer *tracer, zt_meshes *meshes,
                                          zt_arena *arena) {
    size_t count = (size_t)tracer->primitive_count;
    int32_t *single = ZT_PUSH(arena, int32_t, count), *crowd = ZT_PUSH(arena, int32_t, count);
    if (!single || !crowd) return ZT_EMEMORY;
    int32_t single_count = 0, crowd_count = 0;
    for (int32_t i = 0; i < tracer->primitive_count; i++)
        if (tracer->primitives[i].kind != ZT_PRIMITIVE_PLANE) crowd[crowd_count++] = i;
    bool many = crowd_count > SINGLE_MAX;
    for (int32_t i = 0; i < tracer->primitive_count; i++)
        if (!many || tracer->primitives[i].kind == ZT_PRIMITIVE_PLANE)
            single[single_count++] = i;
    tracer->single = single;
    tracer->single_count = single_count;
    tracer->crowd_primitives = crowd;
    if (!many) return ZT_OK;
    zt_bvh_box *boxes = ZT_PUSH(arena, zt_bvh_box, (size_t)crowd_count);
    if (!boxes) return ZT_EMEMORY;
    zt_box *all = &tracer->crowd_box;
    *all = tracer->primitives[crowd[0]].box;
    for (int32_t i = 1; i < crowd_count; i++) {
        const zt_box *box = &tracer->primitives[crowd[i]].box;
        *all = (zt_box){min3(all->low, box->low), max3(all->high, box->high)};
    }
    for (int32_t i = 0; i < crowd_count; i++)
        boxes[i] = outside(&tracer->primitives[crowd[i]], zt_box_size(all));
    return zt_meshes_crowd(&tracer->crowd, meshes, boxes, crowd_count);
}

static size_t count_meshes(const zt_scene *scene) {
    size_t count = 0;
    for (int32_t i = 0; i < scene->object_count; i++)
        count += scene->objects[i].shape == ZT_SHAPE_MESH;
    return count;
}

static size_t count_patterns(const zt_scene *scene) {
    size_t count = 0;
    for (int32_t i = 0; i < scene->object_count; i++) {
        int32_t material = scene->objects[i].material;
        count += material >= 0 && scene->materials[material].pattern != ZT_PATTERN_NONE;
    }
    return count;
}

zt_status ZT_REAL_NAME(zt_prepare)(zt_tracer **out, zt_extent **extents, int32_t *extent_count,
                                   const zt_exposure *exposure, zt_meshes *meshes,
                                   zt_arena *arena) {
    const zt_scene *scene = exposure->moments;
    size_t count = (size_t)scene->object_count;
    zt_tracer *tracer = ZT_PUSH(arena, zt_tracer, 1);
    made all = {.primitives = ZT_PUSH(arena, zt_primitive, count),
                .surfaces = ZT_PUSH(arena, zt_surface, count),
                .extents = ZT_PUSH(arena, zt_extent, count),
                .placed = ZT_PUSH(arena, zt_placed_mesh, count_meshes(scene)),
                .weaves = ZT_PUSH(arena, zt_weave, count_patterns(scene))};
    xform *worlds = ZT_PUSH(arena, xform, count);
    if (!tracer || !all.primitives || !all.surfaces || !all.extents || !all.placed ||
        !all.weaves || !worlds)
        return ZT_EMEMORY;
    *tracer = (zt_tracer){.reflection_depth = scene->reflection_depth};
    zt_scene_worlds(worlds, scene, scene->camera.position);
    ZT_TRY(ZT_REAL_NAME(zt_prepare_lamps)(tracer, exposure, arena));
    ZT_TRY(prepare_objects(&all, tracer, scene, worlds, meshes));
    if (zt_accuracy_twins(all.extents, all.count, (double)TIE)) tracer->tie = TIE;
    *out = tracer;
    *extents = all.extents;
    *extent_count = all.count;
    return ZT_OK;
}
