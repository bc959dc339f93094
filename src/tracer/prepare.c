/* Prepares a scene: objects become primitives, patterns find their places.
 * All is computed in double precision and rounded once, at the end. Compiled once for each
 * precision. */
#include "tracer/prepare.h"

#include <math.h>

#include "base/diag.h"
#include "base/module.h"
#include "tracer/motion.h"

static void make_pattern(zt_weave *weave, const zt_material *material, const zt_making *m) {
    xform place = ZT_REAL_NAME(zt_pattern_place)(m->object, m->world);
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
    zt_change *changes; /* of primitives, too; NULL where nothing moves */
    int32_t count, placed_count, weave_count;
} made;

/* By how much doubles round places far from the world's origin, or from that of a group that
 * is far around it. */
static double grain_of(const zt_making *m, const xform *worlds) {
    const zt_extent *e = m->extent;
    const zt_object *objects = m->scene->objects, *o = m->object;
    vec3 at = isfinite(e->low.x) ? vec3_scale(vec3_add(e->low, e->high), 0.5)
                                 : vec3_scale(e->normal, e->distance);
    double far = vec3_max_abs(m->origin);
    for (; o->parent >= 0; o = &objects[o->parent]) {
        vec3 shift = worlds[o - objects].shift;
        far = fmax(far, vec3_max_abs(vec3_sub(at, shift)));
        at = shift;
    }
    return ZT_GRAIN * far;
}

static void find_distances(zt_making *m) {
    const zt_scene *scene = m->scene;
    zt_extent *e = m->extent;
    e->near = ZT_REAL_NAME(zt_shape_distance)(m, (vec3){0, 0, 0});
    e->lamp = INFINITY;
    for (int32_t i = 0; i < scene->light_count; i++) {
        if (scene->lights[i].kind == ZT_LIGHT_AMBIENT) continue;
        vec3 lamp = vec3_sub(scene->lights[i].position, m->origin);
        double distance =
            fmax(ZT_REAL_NAME(zt_shape_distance)(m, lamp), zt_light_reach(&scene->lights[i]));
        if (!(distance < e->lamp)) continue;
        e->lamp = distance;
        e->lamp_light = i;
    }
}

/* Makes an object into what it is at one moment; false where there is nothing to hit. */
static bool make_at(zt_making *m, zt_placed_mesh *placed, const zt_course *c, int32_t i,
                    int32_t moment) {
    const zt_scene *scene = &c->exposure->moments[moment];
    const xform *worlds = zt_course_worlds(c, moment);
    m->scene = scene;
    m->object = &scene->objects[i];
    m->world = &worlds[i];
    m->origin = c->exposure->moments->camera.position;
    *m->primitive = (zt_primitive){.object = i, .stretch = 1};
    *m->surface = (zt_surface){.pattern = -1};
    *m->extent = (zt_extent){.object = i, .least = INFINITY, .thin = INFINITY, .stretch = 1};
    bool mesh = m->object->shape == ZT_SHAPE_MESH;
    if (mesh ? !ZT_REAL_NAME(zt_prepare_mesh)(m, placed, &scene->meshes[m->object->mesh])
             : !ZT_REAL_NAME(zt_prepare_shape)(m))
        return false;
    find_distances(m);
    m->extent->grain = grain_of(m, worlds);
    return true;
}

static void add_extent(zt_extent *all, const zt_extent *e) {
    all->size = fmax(all->size, e->size);
    all->least = fmin(all->least, e->least);
    all->thin = fmin(all->thin, e->thin);
    all->askew = fmax(all->askew, e->askew);
    all->grain = fmax(all->grain, e->grain);
    all->near = fmin(all->near, e->near);
    all->stretch = fmax(all->stretch, e->stretch);
    if (!(e->lamp < all->lamp)) return;
    all->lamp = e->lamp;
    all->lamp_light = e->lamp_light;
}

/* An object that moves: as it is at the first moment at which there is anything, and its way.
 */
static zt_status make_moving(bool *there, zt_making *m, zt_placed_mesh *placed,
                             const zt_course *c, int32_t i) {
    zt_primitive primitive;
    zt_surface surface;
    zt_extent extent;
    zt_placed_mesh other;
    zt_making later = {.primitive = &primitive, .surface = &surface, .extent = &extent};
    *there = false;
    for (int32_t k = 0; k < c->exposure->moment_count; k++) {
        if (!*there)
            *there = make_at(m, placed, c, i, k);
        else if (make_at(&later, &other, c, i, k))
            add_extent(m->extent, &extent);
    }
    if (!*there) return ZT_OK;
    zt_extent all = *m->extent;
    if (m->primitive->kind == ZT_PRIMITIVE_MESH)
        ZT_TRY(ZT_REAL_NAME(zt_prepare_mesh_motion)(there, m, placed, c));
    else
        ZT_TRY(ZT_REAL_NAME(zt_prepare_motion)(there, m, c));
    add_extent(m->extent, &all);
    m->primitive->stretch = (real)m->extent->stretch;
    return ZT_OK;
}

/* How what was made looks. */
static zt_status prepare_looks(made *all, const zt_making *m, const zt_course *c, int32_t i) {
    const zt_material *material = &c->exposure->moments->materials[m->object->material];
    m->surface->color = to_real3(material->color);
    m->surface->reflectivity = (real)material->reflectivity;
    if (all->changes) {
        zt_change *change = &all->changes[all->count];
        ZT_TRY(ZT_REAL_NAME(zt_prepare_looks)(change, m->object, i, c));
        if (change->looks) return ZT_OK;
    }
    if (material->pattern == ZT_PATTERN_NONE) return ZT_OK;
    m->surface->pattern = all->weave_count;
    make_pattern(&all->weaves[all->weave_count++], material, m);
    return ZT_OK;
}

static zt_status prepare_objects(made *all, zt_tracer *tracer, const zt_course *c,
                                 zt_meshes *meshes) {
    const zt_scene *scene = c->exposure->moments;
    for (int32_t i = 0; i < scene->object_count; i++) {
        if (scene->objects[i].shape == ZT_SHAPE_GROUP) continue;
        zt_placed_mesh *placed = &all->placed[all->placed_count];
        zt_making m = {.primitive = &all->primitives[all->count],
                       .surface = &all->surfaces[all->count],
                       .extent = &all->extents[all->count]};
        bool there;
        if (c->moves[i])
            ZT_TRY(make_moving(&there, &m, placed, c, i));
        else
            there = make_at(&m, placed, c, i, 0);
        if (!there) continue;
        if (m.primitive->kind == ZT_PRIMITIVE_MESH) {
            m.primitive->placed = all->placed_count++;
            ZT_TRY(zt_meshes_begin(&placed->built, meshes, m.object->mesh));
            tracer->moves |= placed->places != NULL;
        }
        ZT_TRY(prepare_looks(all, &m, c, i));
        tracer->moves |= m.primitive->poses || (all->changes && all->changes[all->count].looks);
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
    tracer->changes = all->changes;
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

/* Those that stay have a hierarchy of their own, so that it serves many frames, where they are
 * many. */
enum { OTHERS, STAYING, UNBOUNDED, GROUP_COUNT };

static int group_of(const zt_tracer *tracer, int32_t index) {
    const bool *stays = tracer->exposure->stays;
    const zt_primitive *p = &tracer->primitives[index];
    return p->kind == ZT_PRIMITIVE_PLANE ? UNBOUNDED
           : stays && stays[p->object]   ? STAYING
                                         : OTHERS;
}

static zt_status make_crowd(zt_tracer *tracer, const int32_t *primitives, int32_t count,
                            bool stays, zt_meshes *meshes, zt_arena *arena) {
    zt_crowd *crowd = &tracer->crowds[tracer->crowd_count++];
    zt_bvh_box *boxes = ZT_PUSH(arena, zt_bvh_box, (size_t)count);
    if (!boxes) return ZT_EMEMORY;
    zt_box all = tracer->primitives[primitives[0]].box;
    for (int32_t i = 1; i < count; i++) {
        const zt_box *box = &tracer->primitives[primitives[i]].box;
        all = (zt_box){min3(all.low, box->low), max3(all.high, box->high)};
    }
    for (int32_t i = 0; i < count; i++)
        boxes[i] = outside(&tracer->primitives[primitives[i]], zt_box_size(&all));
    *crowd = (zt_crowd){.primitives = primitives, .count = count, .box = all};
    return zt_meshes_crowd(&crowd->bvh, meshes, stays, boxes, count);
}

zt_status ZT_REAL_NAME(zt_prepare_search)(zt_tracer *tracer, zt_meshes *meshes,
                                          zt_arena *arena) {
    if (!tracer->everything) ZT_TRY(ZT_REAL_NAME(zt_prepare_reach)(tracer, arena));
    /* Without Embree there is no hierarchy; the bits are the same. */
    const bool built = zt_module_is_built("embree", NULL, (zt_listener){0});
    int32_t counts[GROUP_COUNT] = {0};
    for (int32_t i = 0; i < tracer->primitive_count; i++) counts[group_of(tracer, i)]++;
    const bool apart = counts[STAYING] > ZT_SINGLE_MAX;
    if (!apart) counts[OTHERS] += counts[STAYING];
    const size_t room = (size_t)tracer->primitive_count;
    int32_t *single = ZT_PUSH(arena, int32_t, room);
    int32_t *members[ZT_CROWDS_MAX] = {ZT_PUSH(arena, int32_t, room),
                                       ZT_PUSH(arena, int32_t, room)};
    if (!single || !members[OTHERS] || !members[STAYING]) return ZT_EMEMORY;
    int32_t found[ZT_CROWDS_MAX] = {0, 0};
    tracer->single = single;
    for (int32_t i = 0; i < tracer->primitive_count; i++) {
        int group = group_of(tracer, i);
        if (group == STAYING && !apart) group = OTHERS;
        if (group == UNBOUNDED || !built || counts[group] <= ZT_SINGLE_MAX)
            single[tracer->single_count++] = i;
        else
            members[group][found[group]++] = i;
    }
    for (int group = OTHERS; group <= STAYING; group++)
        if (found[group] > 0)
            ZT_TRY(make_crowd(tracer, members[group], found[group], group == STAYING, meshes,
                              arena));
    return ZT_OK;
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

static bool lights_move(const zt_tracer *tracer) {
    bool moves = tracer->ambients != NULL;
    for (int32_t i = 0; i < tracer->lamp_count; i++) moves |= tracer->lamps[i].moves;
    return moves;
}

zt_status ZT_REAL_NAME(zt_prepare)(zt_tracer **out, zt_extents *extents,
                                   const zt_exposure *exposure, const zt_needs *needs,
                                   bool everything, zt_meshes *meshes, zt_arena *arena) {
    const zt_scene *scene = exposure->moments;
    size_t count = (size_t)scene->object_count;
    zt_tracer *tracer = ZT_PUSH(arena, zt_tracer, 1);
    made all = {.primitives = ZT_PUSH(arena, zt_primitive, count),
                .surfaces = ZT_PUSH(arena, zt_surface, count),
                .extents = ZT_PUSH(arena, zt_extent, count),
                .placed = ZT_PUSH(arena, zt_placed_mesh, count_meshes(scene)),
                .weaves = ZT_PUSH(arena, zt_weave, count_patterns(scene))};
    if (!tracer || !all.primitives || !all.surfaces || !all.extents || !all.placed ||
        !all.weaves)
        return ZT_EMEMORY;
    if (exposure->moment_count > 1) {
        all.changes = ZT_PUSH(arena, zt_change, count);
        if (!all.changes) return ZT_EMEMORY;
    }
    zt_course course;
    ZT_TRY(ZT_REAL_NAME(zt_course_make)(&course, exposure, arena));
    *tracer = (zt_tracer){.reflection_depth = needs->mirror_depth,
                          .asked_depth = scene->reflection_depth,
                          .brightest = (real)(needs->brightest * (1 + 0x1p-10)),
                          .faint_depth = needs->faint_depth,
                          .everything = everything,
                          .exposure = exposure,
                          .straight = exposure->moment_count == 2};
    ZT_TRY(ZT_REAL_NAME(zt_prepare_lamps)(tracer, exposure, needs, arena));
    ZT_TRY(prepare_objects(&all, tracer, &course, meshes));
    tracer->moves |= lights_move(tracer);
    if (tracer->moves) ZT_TRY(zt_exposure_index(&tracer->moment_at, exposure, arena));
    *extents = (zt_extents){.all = all.extents, .count = all.count};
    ZT_TRY(zt_twins_make(&extents->twins, all.extents, all.count, arena));
    if (zt_twins_within(extents->twins, (double)TIE)) tracer->tie = TIE;
    *out = tracer;
    return ZT_OK;
}

void ZT_REAL_NAME(zt_prepare_ready)(zt_ready *ready, const zt_tracer *tracer) {
    ready->tracer = tracer;
    ready->moves = tracer->moves;
    for (int32_t i = 0; i < tracer->lamp_count; i++) ready->random |= tracer->lamps[i].has_size;
}
