/* A tracer as rays can tell it: what their arithmetic reads of each thing and lamp, hashed
 * number by number. Compiled once for each precision. */
#include "tracer/outline.h"

#include <math.h>

#include "base/diag.h"
#include "base/hash.h"
#include "tracer/motion.h"

/* Numbers that are hashed together. */
enum { NUMBERS_MAX = 64 };
typedef struct numbers {
    int count;
    double of[NUMBERS_MAX];
} numbers;

static void put(numbers *n, double number) { n->of[n->count++] = number; }
static void put3(numbers *n, real3 v) {
    put(n, (double)v.x);
    put(n, (double)v.y);
    put(n, (double)v.z);
}
static void put_vec(numbers *n, vec3 v) {
    put(n, v.x);
    put(n, v.y);
    put(n, v.z);
}
static void put_xform(numbers *n, const xform *m) {
    put_vec(n, m->x);
    put_vec(n, m->y);
    put_vec(n, m->z);
    put_vec(n, m->shift);
}

static zt_hash hash_of(const numbers *n) {
    return zt_hash_bytes(n->of, (size_t)n->count * sizeof *n->of);
}

static zt_hash joined(zt_hash a, zt_hash b) {
    zt_hash parts[2] = {a, b};
    return zt_hash_bytes(parts, sizeof parts);
}

/* Of a table besides; where there is none the hash of the numbers stays. */
static zt_hash hash_with(const numbers *n, const void *table, size_t size) {
    return table ? joined(hash_of(n), zt_hash_bytes(table, size)) : hash_of(n);
}

static void put_mesh(numbers *n, const zt_placed_mesh *m) {
    const double rest[] = {(double)m->reach,  (double)m->room, (double)m->inner,
                           (double)m->extent, m->smooth,       m->vertex_colors};
    for (int i = 0; i < 3; i++) put_vec(n, m->rows[i]);
    put_vec(n, m->at);
    put_xform(n, &m->place);
    put(n, m->built->mesh->triangle_count);
    for (size_t i = 0; i < sizeof rest / sizeof *rest; i++) put(n, rest[i]);
}

/* When the moments of the exposure are: nothing where it has one alone. */
static zt_hash times_of(const zt_tracer *tracer) {
    const zt_exposure *e = tracer->exposure;
    const size_t count = (size_t)e->moment_count;
    zt_hash parts[2] = {{0, 0}, {0, 0}};
    if (count == 1) return parts[0];
    parts[0] = zt_hash_bytes(e->times, count * sizeof *e->times);
    parts[1] = zt_hash_bytes(e->steps, (count - 1) * sizeof *e->steps);
    return zt_hash_bytes(parts, sizeof parts);
}

/* What of a primitive decides where it is met, and the surface there. */
static zt_hash shape_of(const zt_tracer *tracer, int32_t index) {
    const zt_primitive *p = &tracer->primitives[index];
    const zt_surface *s = &tracer->surfaces[index];
    const zt_placed_mesh *mesh =
        p->kind == ZT_PRIMITIVE_MESH ? &tracer->placed[p->placed] : NULL;
    const size_t moments = (size_t)tracer->exposure->moment_count;
    numbers n;
    n.count = 0;
    put(&n, p->kind);
    put(&n, (double)p->stretch);
    put(&n, s->closed);
    if (mesh) {
        put_mesh(&n, mesh);
        zt_hash hash = hash_with(&n, mesh->places, moments * sizeof *mesh->places);
        return joined(hash, mesh->built->content);
    }
    put3(&n, p->box.low);
    put3(&n, p->box.high);
    if (p->poses) {
        put(&n, (double)p->unit);
        size_t row = 2 * (size_t)zt_pose_size(p->kind);
        return hash_with(&n, p->poses, (moments - 1) * row * sizeof *p->poses);
    }
    put3(&n, s->normal);
    put(&n, (double)s->bend);
    put3(&n, s->center);
    put(&n, (double)s->level);
    if (p->kind == ZT_PRIMITIVE_TRIANGLE)
        for (int i = 0; i < 3; i++) put3(&n, p->triangle.vertices[i]);
    if (!zt_kind_is_solid(p->kind)) return hash_of(&n);
    for (int i = 0; i < 3; i++) put3(&n, p->solid.rows[i]);
    put3(&n, p->solid.center);
    put(&n, (double)p->solid.a);
    put(&n, (double)p->solid.b);
    return hash_of(&n);
}

static zt_hash looks_of(const zt_tracer *tracer, int32_t index) {
    const zt_surface *s = &tracer->surfaces[index];
    const zt_change *change = tracer->changes ? &tracer->changes[index] : NULL;
    const size_t moments = (size_t)tracer->exposure->moment_count;
    numbers n;
    n.count = 0;
    put3(&n, s->color);
    put(&n, (double)s->reflectivity);
    if (change && change->looks) {
        put(&n, change->pattern);
        return hash_with(&n, change->looks, moments * sizeof *change->looks);
    }
    if (s->pattern < 0) return hash_of(&n);
    const zt_weave *weave = &tracer->weaves[s->pattern];
    for (int i = 0; i < 3; i++) put3(&n, weave->rows[i]);
    put3(&n, weave->at);
    put3(&n, weave->other);
    return hash_of(&n);
}

static zt_outline_thing thing_of(const zt_tracer *tracer, int32_t index, zt_hash times) {
    const zt_primitive *p = &tracer->primitives[index];
    bool mesh_moves = p->kind == ZT_PRIMITIVE_MESH && tracer->placed[p->placed].places;
    bool moves = p->poses || mesh_moves || (tracer->changes && tracer->changes[index].looks);
    zt_hash shape = shape_of(tracer, index);
    return (zt_outline_thing){.moves = moves,
                              .unbounded = p->kind == ZT_PRIMITIVE_PLANE,
                              .round = p->kind == ZT_PRIMITIVE_SPHERE && !p->poses,
                              .box = zt_outwards(&p->box),
                              .stretch = (float)p->stretch,
                              .shape = moves ? joined(shape, times) : shape,
                              .looks = looks_of(tracer, index)};
}

static zt_outline_lamp lamp_of(const zt_tracer *tracer, int32_t index, zt_hash times) {
    const zt_lamp *lamp = &tracer->lamps[index];
    const int32_t moments = lamp->moves ? tracer->exposure->moment_count : 1;
    zt_hash place = lamp->moves ? times : (zt_hash){0, 0}, power = place;
    if (lamp->has_size) /* which random numbers are its own */
        place = joined(place, (zt_hash){(uint64_t)index, (uint64_t)tracer->lamp_count});
    for (int32_t i = 0; i < moments; i++) {
        const zt_lamp_pose *pose = &lamp->poses[i];
        numbers n;
        n.count = 0;
        put(&n, lamp->kind);
        put3(&n, pose->position);
        put3(&n, pose->x);
        put3(&n, pose->y);
        put3(&n, pose->z);
        put(&n, (double)pose->a);
        put(&n, (double)pose->b);
        put(&n, pose->shadows);
        place = joined(place, hash_of(&n));
        n.count = 0;
        put3(&n, pose->power);
        power = joined(power, hash_of(&n));
    }
    return (zt_outline_lamp){.drawn = lamp->has_size || lamp->moves,
                             .shadows = lamp->shadows,
                             .bounds = zt_outwards(&lamp->bounds),
                             .place = place,
                             .power = power};
}

/* All that concerns rays wherever they are. */
static zt_hash rest_of(const zt_tracer *tracer) {
    const zt_scene *scene = tracer->exposure->moments;
    numbers n;
    n.count = 0;
    put(&n, sizeof(real));
    put(&n, (double)tracer->tie);
    put(&n, scene->reflection_depth);
    put(&n, tracer->crowd_count > 0);
    return hash_of(&n);
}

/* Which things share a hierarchy. */
static zt_hash order_of(const zt_tracer *tracer) {
    zt_hash order = {0, 0};
    for (int i = 0; i < tracer->crowd_count; i++) {
        const zt_crowd *c = &tracer->crowds[i];
        order = joined(order,
                       zt_hash_bytes(c->primitives, (size_t)c->count * sizeof *c->primitives));
    }
    return order;
}

static zt_hash ambient_of(const zt_tracer *tracer, zt_hash times) {
    const size_t moments = (size_t)tracer->exposure->moment_count;
    numbers n;
    n.count = 0;
    put3(&n, tracer->ambient);
    if (!tracer->ambients) return hash_of(&n);
    return joined(times, hash_with(&n, tracer->ambients, moments * sizeof *tracer->ambients));
}

/* Whether there are mirrors, in which nothing is to be seen, so that nobody looked. */
static bool is_blind(const zt_tracer *tracer) {
    bool mirrors = false;
    for (int32_t i = 0; i < tracer->primitive_count; i++)
        mirrors |= tracer->surfaces[i].reflectivity > 0 ||
                   (tracer->changes && tracer->changes[i].looks);
    return mirrors && tracer->reflection_depth < tracer->exposure->moments->reflection_depth;
}

zt_status ZT_REAL_NAME(zt_outline)(zt_outline *outline, const zt_tracer *tracer,
                                   zt_arena *arena) {
    const zt_hash times = times_of(tracer);
    zt_outline o = {.thing_count = tracer->primitive_count,
                    .lamp_count = tracer->lamp_count,
                    .ambient = ambient_of(tracer, times),
                    .ambient_moves = tracer->ambients != NULL,
                    .rest = rest_of(tracer),
                    .order = order_of(tracer),
                    .blind = is_blind(tracer),
                    .brightest = (double)tracer->brightest};
    o.faint = tracer->faint_depth < tracer->reflection_depth;
    o.things = ZT_PUSH(arena, zt_outline_thing, (size_t)o.thing_count);
    o.lamps = ZT_PUSH(arena, zt_outline_lamp, (size_t)o.lamp_count);
    if (!o.things || !o.lamps) return ZT_EMEMORY;
    for (int32_t i = 0; i < o.thing_count; i++) o.things[i] = thing_of(tracer, i, times);
    for (int32_t i = 0; i < o.lamp_count; i++) o.lamps[i] = lamp_of(tracer, i, times);
    *outline = o;
    return ZT_OK;
}

zt_status ZT_REAL_NAME(zt_labels)(zt_labels *labels, const zt_tracer *tracer, zt_arena *arena) {
    const zt_hash times = times_of(tracer);
    labels->things = ZT_PUSH(arena, uint32_t, (size_t)tracer->primitive_count);
    labels->lamps = ZT_PUSH(arena, uint32_t, (size_t)tracer->lamp_count);
    if (!labels->things || !labels->lamps) return ZT_EMEMORY;
    for (int32_t i = 0; i < tracer->primitive_count; i++)
        labels->things[i] = (uint32_t)shape_of(tracer, i).low;
    for (int32_t i = 0; i < tracer->lamp_count; i++)
        labels->lamps[i] = (uint32_t)lamp_of(tracer, i, times).place.low;
    return ZT_OK;
}
