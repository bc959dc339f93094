/* Lamps against a batch's bounds. Loops run over lamps, many at a time. Compiled once for each
 * width of instructions and each precision (tracer/isa.h). */
#include "tracer/reach.h"

#include <math.h>

#include "tracer/bundle.h"

/* How far beyond its bounds something has to be for all roundings of an intersection to be
 * within, as a share of the largest number around: of what decides whether a ray meets a side,
 * and of where it does so, rays running along that side as little as they do here. */
#define ROOM      ((real)512 * REAL_ROUNDING)
#define WIDE_ROOM ((real)8192 * REAL_ROUNDING)

/* Points and lamp are at least this share of the largest number apart, across a box's side. */
#define APART ((real)0x1p-6)

/* What is no further from a lamp than this share of it hides nothing of it (tracer/lamps.h). */
#define SKIN ((real)0x1p-10)

/* The lamps that are left, compacted. */
typedef struct lamps {
    alignas(64) real x[ZT_BATCH]; /* the middle, and half as long as it is, of the bounds */
    alignas(64) real y[ZT_BATCH];
    alignas(64) real z[ZT_BATCH];
    alignas(64) real half_x[ZT_BATCH];
    alignas(64) real half_y[ZT_BATCH];
    alignas(64) real half_z[ZT_BATCH];
    alignas(64) real size[ZT_BATCH]; /* the largest number of lamp and points */
    alignas(64) int32_t number[ZT_BATCH];
    alignas(64) int32_t blockable[ZT_BATCH];
    alignas(64) int32_t left[ZT_BATCH];
    int count;
} lamps;

static inline real most3(real a, real b, real c) { return real_max(real_max(a, b), c); }

/* The least and the greatest product of two ranges. */
static inline real least_product(real a, real b, real c, real d) {
    return real_min(real_min(a * c, a * d), real_min(b * c, b * d));
}
static inline real greatest_product(real a, real b, real c, real d) {
    return real_max(real_max(a * c, a * d), real_max(b * c, b * d));
}

static bool is_finite(const zt_box *b) {
    real sum = (b->low.x - b->low.x) + (b->low.y - b->low.y) + (b->low.z - b->low.z) +
               (b->high.x - b->high.x) + (b->high.y - b->high.y) + (b->high.z - b->high.z);
    return sum == 0;
}

/* Takes the lamps that the points do not all turn away from. Of a point that is hidden a path
 * takes note where the surface faces the lamp: where that is not the same for all points, or
 * its light may be too little to be any, a lamp is not blockable. */
static void take_faced(lamps *restrict to, const zt_reach_points *p, const zt_tracer *tracer,
                       int32_t first, int count) {
    const zt_reach *reach = tracer->reach;
    const real *restrict lx = reach->low_x + first, *restrict hx = reach->high_x + first;
    const real *restrict ly = reach->low_y + first, *restrict hy = reach->high_y + first;
    const real *restrict lz = reach->low_z + first, *restrict hz = reach->high_z + first;
    const int32_t *restrict shadows = reach->shadows + first;
    const zt_box at = p->places, n = p->normals;
    const real size = zt_box_size(&at);
    const int32_t all = !p->labels;
    WIDE_LOOP for (int i = 0; i < zt_batch_padded(count); i++) {
        real x0 = lx[i] - at.high.x, x1 = hx[i] - at.low.x;
        real y0 = ly[i] - at.high.y, y1 = hy[i] - at.low.y;
        real z0 = lz[i] - at.high.z, z1 = hz[i] - at.low.z;
        real low = least_product(n.low.x, n.high.x, x0, x1) +
                   least_product(n.low.y, n.high.y, y0, y1) +
                   least_product(n.low.z, n.high.z, z0, z1);
        real high = greatest_product(n.low.x, n.high.x, x0, x1) +
                    greatest_product(n.low.y, n.high.y, y0, y1) +
                    greatest_product(n.low.z, n.high.z, z0, z1);
        real own = real_max(most3(real_abs(lx[i]), real_abs(ly[i]), real_abs(lz[i])),
                            most3(real_abs(hx[i]), real_abs(hy[i]), real_abs(hz[i])));
        real largest = real_max(size, own), room = ROOM * largest;
        to->size[i] = largest;
        to->left[i] = !(high < -room);
        to->blockable[i] = shadows[i] & (all | (low > room));
        to->x[i] = (hx[i] + lx[i]) / 2;
        to->y[i] = (hy[i] + ly[i]) / 2;
        to->z[i] = (hz[i] + lz[i]) / 2;
        to->half_x[i] = (hx[i] - lx[i]) * ((real)0.5 + SKIN);
        to->half_y[i] = (hy[i] - ly[i]) * ((real)0.5 + SKIN);
        to->half_z[i] = (hz[i] - lz[i]) * ((real)0.5 + SKIN);
        to->number[i] = first + i;
    }
    to->count = count;
}

/* Whether a lamp that all points face, and that is a point itself, shines on all of them by a
 * number above 0. */
static bool is_lit(const zt_lamp *lamp, const zt_reach_points *p, real size) {
    const real3 power = lamp->poses->power, color = p->least_color;
    /* The way is no longer than 4 `size`, and along the normal it is ROOM times that. */
    real fade = ROOM / (128 * size * size);
    real least = fade * most3(power.x * real_min(color.x, 1), power.y * real_min(color.y, 1),
                              power.z * real_min(color.z, 1));
    return fade > 16 * REAL_LEAST && least > 16 * REAL_LEAST;
}

static void move_lamp(lamps *l, int to, int i) {
    l->x[to] = l->x[i];
    l->y[to] = l->y[i];
    l->z[to] = l->z[i];
    l->half_x[to] = l->half_x[i];
    l->half_y[to] = l->half_y[i];
    l->half_z[to] = l->half_z[i];
    l->size[to] = l->size[i];
    l->number[to] = l->number[i];
    l->blockable[to] = l->blockable[i];
}

/* Keeps, of the lamps that the points face, those that shine at all. */
static void keep_shining(lamps *l, const zt_reach_points *points, const zt_tracer *tracer) {
    int kept = 0;
    for (int i = 0; i < l->count; i++) {
        /* take_faced() has told it of each, which the analyzer cannot know. */
        if (!l->left[i]) continue; /* NOLINT(*core.uninitialized.Branch) */
        int32_t number = l->number[i];
        if (tracer->reach->shines[number]) {
            move_lamp(l, kept++, i);
        } else if (points->footprint) {
            uint64_t bit = zt_footprint_bit(points->outline->lamps[number].place);
            points->footprint->faced |= bit;
            points->footprint->lit |= bit;
        }
    }
    l->count = kept;
}

/* Keeps the lamps that are not hidden. */
static void keep_open(lamps *l, uint32_t *hidden, const zt_reach_points *points) {
    int kept = 0;
    for (int i = 0; i < l->count; i++) {
        if (l->left[i]) {
            move_lamp(l, kept++, i);
            continue;
        }
        if (points->labels) *hidden += points->labels->lamps[l->number[i]];
        if (points->footprint)
            points->footprint->faced |=
                zt_footprint_bit(points->outline->lamps[l->number[i]].place);
    }
    l->count = kept;
}

/* ---- blockers -------------------------------------------------------------------------------
 * Each clears `left` of the lamps that are hidden, and says whether there may be any. */

/* An infinite plane: points on one side, lamps on the other. */
static bool block_by_plane(lamps *restrict l, const zt_primitive *p,
                           const zt_reach_points *points) {
    const real3 n = p->plane.normal;
    const real distance = p->plane.distance, own = real_abs(distance);
    double low, high;
    zt_span(&low, &high, n, &points->places);
    real size = real_max(zt_box_size(&points->places), own);
    bool above = low > (double)(distance + ROOM * size);
    if (!above && !(high < (double)(distance - ROOM * size))) return false;
    /* Of the near end, as far as lamps are large themselves. */
    const real side = above ? 1 : -1;
    const real near = above ? (real)low - distance : distance - (real)high;
    WIDE_LOOP for (int i = 0; i < zt_batch_padded(l->count); i++) {
        real across = real_dot(n.x, n.y, n.z, l->x[i], l->y[i], l->z[i]) - distance;
        real half = real_dot(real_abs(n.x), real_abs(n.y), real_abs(n.z), l->half_x[i],
                             l->half_y[i], l->half_z[i]);
        real room = ROOM * real_max(l->size[i], own);
        bool blocked = (side * across + half < -room) & (near > room);
        l->left[i] = !(blocked & l->blockable[i]);
    }
    return true;
}

/* A sphere: where the ways from the ball around the points to that around a lamp pass its
 * center, a ball around all of them is within. */
static bool block_by_sphere(lamps *restrict l, const zt_primitive *p,
                            const zt_reach_points *points) {
    const zt_box at = points->places;
    const real3 c = p->sphere.center;
    const real radius = p->sphere.radius, own = zt_box_size(&p->box);
    real px = (at.low.x + at.high.x) / 2 - c.x, py = (at.low.y + at.high.y) / 2 - c.y,
         pz = (at.low.z + at.high.z) / 2 - c.z;
    real hx = at.high.x - at.low.x, hy = at.high.y - at.low.y, hz = at.high.z - at.low.z;
    const real around = real_sqrt(real_dot(hx, hy, hz, hx, hy, hz)) / 2;
    const real away = real_sqrt(real_dot(px, py, pz, px, py, pz)) - around - radius;
    if (!(around < radius) || !(away > 0)) return false;
    WIDE_LOOP for (int i = 0; i < zt_batch_padded(l->count); i++) {
        real qx = l->x[i] - c.x, qy = l->y[i] - c.y, qz = l->z[i] - c.z;
        real half = real_sqrt(real_dot(l->half_x[i], l->half_y[i], l->half_z[i], l->half_x[i],
                                       l->half_y[i], l->half_z[i]));
        real vx = qx - px, vy = qy - py, vz = qz - pz;
        real s = -real_dot(px, py, pz, vx, vy, vz) / real_dot(vx, vy, vz, vx, vy, vz);
        s = real_min(real_max(s, 0), 1);
        real mx = px + s * vx, my = py + s * vy, mz = pz + s * vz;
        real within =
            real_sqrt(real_dot(mx, my, mz, mx, my, mz)) + around + s * (half - around);
        real beyond = real_sqrt(real_dot(qx, qy, qz, qx, qy, qz)) - half - radius;
        real room = WIDE_ROOM * real_max(l->size[i], own);
        bool blocked = (within < radius - room) & (away > room) & (beyond > room);
        l->left[i] = !(blocked & l->blockable[i]);
    }
    return true;
}

/* The middle and the half length of bounds in the space of a solid, along one of its axes. */
static inline real along(const zt_primitive *p, int axis, real x, real y, real z) {
    const real3 row = p->solid.rows[axis], c = p->solid.center;
    return real_dot(row.x, row.y, row.z, x - c.x, y - c.y, z - c.z);
}
static inline real half_along(const zt_primitive *p, int axis, real x, real y, real z) {
    const real3 row = p->solid.rows[axis];
    return real_dot(real_abs(row.x), real_abs(row.y), real_abs(row.z), x, y, z);
}

/* Along an axis of a box beyond whose side all points lie. */
typedef struct beyond {
    int axis, next[2]; /* the others */
    real side;         /* 1 or -1 */
    real near, far;    /* of the points from that side */
} beyond;

/* Whether all ways between bounds cross a side well within its edges along another axis. Of a
 * way, the crossing parts it in the shares of its ends' distances: between `least` and `most`
 * is the lamp's. */
static inline bool crosses_within(real p_low, real p_high, real l_low, real l_high, real least,
                                  real most, real room) {
    real high = real_max(p_high + least * (l_high - p_high), p_high + most * (l_high - p_high));
    real low = real_min(p_low + least * (l_low - p_low), p_low + most * (l_low - p_low));
    return (high < 1 - room) & (low > room - 1);
}

static void block_by_side(lamps *restrict l, const zt_primitive *p, const beyond *b,
                          const real *restrict lengths, const real *restrict middle,
                          const real *restrict reach, real own) {
    const int a = b->axis, u = b->next[0], v = b->next[1];
    const real side = b->side, near = b->near, far = b->far;
    const real u0 = middle[u] - reach[u], u1 = middle[u] + reach[u];
    const real v0 = middle[v] - reach[v], v1 = middle[v] + reach[v];
    const real length_a = lengths[a], length_u = lengths[u], length_v = lengths[v];
    const zt_primitive box = *p;
    WIDE_LOOP for (int i = 0; i < zt_batch_padded(l->count); i++) {
        real x = l->x[i], y = l->y[i], z = l->z[i];
        real hx = l->half_x[i], hy = l->half_y[i], hz = l->half_z[i];
        real size = real_max(l->size[i], own), room = ROOM * size * length_a;
        real ha = half_along(&box, a, hx, hy, hz);
        real depth = 1 - side * along(&box, a, x, y, z); /* of the lamp behind the side */
        real d0 = depth - ha, d1 = depth + ha;
        real lu = along(&box, u, x, y, z), hu = half_along(&box, u, hx, hy, hz);
        real lv = along(&box, v, x, y, z), hv = half_along(&box, v, hx, hy, hz);
        real least = near / (near + d1), most = far / (far + d0);
        bool behind = (d0 > room) & (near > room) & (d0 + near > APART * size * length_a);
        bool thick = room < (real)0.25;
        bool within_u =
            crosses_within(u0, u1, lu - hu, lu + hu, least, most, WIDE_ROOM * size * length_u);
        bool within_v =
            crosses_within(v0, v1, lv - hv, lv + hv, least, most, WIDE_ROOM * size * length_v);
        l->left[i] &= !(behind & thick & within_u & within_v & l->blockable[i]);
    }
}

/* A box: all ways enter it by the same side. */
static bool block_by_box(lamps *restrict l, const zt_primitive *p,
                         const zt_reach_points *points) {
    const zt_box at = points->places;
    const real hx = (at.high.x - at.low.x) / 2, hy = (at.high.y - at.low.y) / 2,
               hz = (at.high.z - at.low.z) / 2;
    real lengths[3], middle[3], reach[3];
    bool any = false;
    for (int a = 0; a < 3; a++) {
        const real3 row = p->solid.rows[a];
        lengths[a] = real_sqrt(real_dot(row.x, row.y, row.z, row.x, row.y, row.z));
        middle[a] = along(p, a, at.low.x + hx, at.low.y + hy, at.low.z + hz);
        reach[a] = half_along(p, a, hx, hy, hz);
    }
    for (int a = 0; a < 3; a++) {
        real side = middle[a] > 0 ? 1 : -1, off = side * middle[a] - 1;
        if (!(off - reach[a] > 0)) continue;
        if (!any)
            for (int i = 0; i < zt_batch_padded(l->count); i++) l->left[i] = 1;
        any = true;
        beyond b = {a, {(a + 1) % 3, (a + 2) % 3}, side, off - reach[a], off + reach[a]};
        block_by_side(l, p, &b, lengths, middle, reach, zt_box_size(&p->box));
    }
    return any;
}

static bool block(lamps *l, const zt_primitive *p, const zt_reach_points *points) {
    switch (p->kind) {
    case ZT_PRIMITIVE_PLANE:
        return block_by_plane(l, p, points);
    case ZT_PRIMITIVE_SPHERE:
        return block_by_sphere(l, p, points);
    default:
        return block_by_box(l, p, points);
    }
}

static bool any_gone(const lamps *l) {
    int32_t all = 1;
    for (int i = 0; i < l->count; i++) all &= l->left[i];
    return !all;
}

/* Has a blocker clear away what it hides; it is useful where that is anything. */
static void ask(lamps *l, uint32_t *hidden, zt_reach_memory *memory, uint32_t blocker,
                const zt_reach_points *points, const zt_tracer *tracer) {
    const zt_primitive *p = &tracer->primitives[tracer->reach->blockers[blocker]];
    if (!block(l, p, points) || !any_gone(l)) return;
    keep_open(l, hidden, points);
    memory->useful[memory->useful_count++] = (uint8_t)blocker;
}

/* Those that blocked something before, from the last to the first, so that one that hides only
 * what another one hides as well comes after that and is forgotten; and a few others each time,
 * or many where more lamps are left than the last time. */
static void block_all(lamps *l, uint32_t *hidden, zt_reach_memory *memory,
                      const zt_reach_points *points, const zt_tracer *tracer) {
    enum { FEW = 2, MANY = 16 };
    const zt_reach_memory before = *memory;
    const uint32_t count = (uint32_t)tracer->reach->blocker_count;
    uint32_t asked = 0, others = 0;
    memory->useful_count = 0;
    for (uint32_t i = before.useful_count % (ZT_BLOCKERS_MAX + 1); i-- > 0 && l->count > 0;) {
        const uint32_t b = before.useful[i];
        if (b >= count || asked >> b & 1) continue;
        asked |= 1u << b;
        ask(l, hidden, memory, b, points, tracer);
    }
    const uint32_t most = l->count > before.left ? MANY : FEW;
    for (uint32_t i = 0; i < count && others < most && l->count > 0; i++) {
        const uint32_t b = (before.next % count + i) % count;
        if (asked >> b & 1) continue;
        others++;
        memory->next = b + 1;
        ask(l, hidden, memory, b, points, tracer);
    }
    memory->left = l->count;
}

int ZT_KERNEL_NAME(zt_reach_list)(int32_t *list, uint32_t *hidden, zt_reach_memory *memory,
                                  const zt_reach_points *points, const zt_tracer *tracer,
                                  int32_t first) {
    lamps l;
    int32_t left = tracer->lamp_count - first;
    int count = left < ZT_BATCH ? (int)left : ZT_BATCH;
    *hidden = 0;
    if (!is_finite(&points->places) || !is_finite(&points->normals)) {
        for (int i = 0; i < count; i++) list[i] = first + i;
        return count;
    }
    take_faced(&l, points, tracer, first, count);
    keep_shining(&l, points, tracer);
    for (int i = 0; points->labels && i < l.count; i++)
        l.blockable[i] &= is_lit(&tracer->lamps[l.number[i]], points, l.size[i]);
    block_all(&l, hidden, memory, points, tracer);
    for (int i = 0; i < l.count; i++) list[i] = l.number[i];
    return l.count;
}
