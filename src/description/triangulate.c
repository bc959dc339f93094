/* Fans for convex polygons, ear clipping for all others, in a ring of corners seen in the
 * plane. */
#include "description/triangulate.h"

#include <math.h>
#include <stdbool.h>

#include "base/vec.h"

enum {
    CORNERS_MAX = 1 << 16, /* a polygon of more would take too long in any case */
    SHARE = 64,            /* comparisons for each corner that do not strain our patience */
    PATIENCE = 1 << 25     /* about a third of a second */
};

/* A corner of what is left of the polygon. */
typedef struct zt_polygon_corner {
    double x, y;            /* in the plane, where the polygon winds counterclockwise */
    int32_t previous, next; /* in the ring */
    uint32_t vertex;
    bool bent; /* turns inward or goes straight on: only such a corner can lie in an ear */
} corner;

zt_status zt_triangulator_create(zt_triangulator *t, zt_arena *scratch, const double *positions,
                                 int32_t most_corners) {
    *t = (zt_triangulator){.positions = positions, .patience = PATIENCE};
    int32_t size = most_corners < CORNERS_MAX ? most_corners : CORNERS_MAX;
    t->ring = ZT_PUSH(scratch, corner, (size_t)size);
    return t->ring ? ZT_OK : ZT_EMEMORY;
}

static void fan(uint32_t *triangles, const uint32_t *corners, int32_t count) {
    for (int32_t i = 2; i < count; i++) {
        *triangles++ = corners[0];
        *triangles++ = corners[i - 1];
        *triangles++ = corners[i];
    }
}

/* Where corner i is, seen from the first one, so that models far from the origin lose no
 * digits. */
static vec3 corner_position(const zt_triangulator *t, const uint32_t *corners, int32_t i) {
    const double *p = t->positions + 3 * (int64_t)corners[i],
                 *o = t->positions + 3 * (int64_t)corners[0];
    return (vec3){p[0] - o[0], p[1] - o[1], p[2] - o[2]};
}

/* The polygon's area as a vector along its normal, which need not be plane for that. */
static vec3 vector_area(const zt_triangulator *t, const uint32_t *corners, int32_t count) {
    vec3 area = {0, 0, 0};
    for (int32_t i = 1; i + 1 < count; i++)
        area = vec3_add(area, vec3_cross(corner_position(t, corners, i),
                                         corner_position(t, corners, i + 1)));
    return vec3_scale(area, 0.5);
}

/* Twice the area of a triangle of corners, positive where they turn counterclockwise. */
static double turn(const corner *a, const corner *b, const corner *c) {
    return (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
}

static bool together(const corner *a, const corner *b) { return a->x == b->x && a->y == b->y; }

static double turn_at(const corner *ring, int32_t i) {
    return turn(&ring[ring[i].previous], &ring[i], &ring[ring[i].next]);
}

/* Lays the polygon into the plane of the two other axes. True where it is strictly convex. */
static bool lay_out(zt_triangulator *t, const uint32_t *corners, int32_t count) {
    corner *ring = t->ring;
    vec3 n = vector_area(t, corners, count);
    bool along_x = fabs(n.x) >= fmax(fabs(n.y), fabs(n.z)), along_y = fabs(n.y) >= fabs(n.z);
    double side = along_x ? n.x : along_y ? n.y : n.z;
    for (int32_t i = 0; i < count; i++) {
        vec3 p = corner_position(t, corners, i);
        double x = along_x ? p.y : along_y ? p.z : p.x, y = along_x ? p.z : along_y ? p.x : p.y;
        ring[i] = (corner){.x = side < 0 ? -x : x,
                           .y = y,
                           .previous = i > 0 ? i - 1 : count - 1,
                           .next = i + 1 < count ? i + 1 : 0,
                           .vertex = corners[i]};
    }
    bool convex = true;
    for (int32_t i = 0; i < count; i++) {
        ring[i].bent = !(turn_at(ring, i) > 0);
        convex &= !ring[i].bent;
    }
    return convex;
}

/* Can corner i be cut off? Not where the triangle with its neighbours holds a bent corner; one
 * that stands where a neighbour does is in nobody's way. Adds to `steps`. */
static bool is_ear(const corner *ring, int32_t i, int64_t *steps) {
    if (ring[i].bent) return false;
    const corner *a = &ring[ring[i].previous], *b = &ring[i], *c = &ring[ring[i].next];
    for (int32_t j = c->next; j != b->previous; j = ring[j].next) {
        const corner *p = &ring[j];
        ++*steps;
        if (p->bent && turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0 &&
            !together(p, a) && !together(p, c))
            return false;
    }
    return true;
}

/* Cuts off corner i, whatever its triangle. Returns where its triangle's three indices end. */
static uint32_t *cut_off(corner *ring, int32_t i, uint32_t *triangles) {
    int32_t previous = ring[i].previous, next = ring[i].next;
    *triangles++ = ring[previous].vertex;
    *triangles++ = ring[i].vertex;
    *triangles++ = ring[next].vertex;
    ring[previous].next = next;
    ring[next].previous = previous;
    ring[previous].bent = !(turn_at(ring, previous) > 0);
    ring[next].bent = !(turn_at(ring, next) > 0);
    return triangles;
}

/* The next corner to cut off from `i` on: an ear; where there is none, because corners coincide
 * or edges cross, one that goes straight on, which cuts off nothing; or else any. */
static int32_t next_to_cut(const corner *ring, int32_t i, int64_t *steps, int64_t steps_max) {
    int32_t straight = i;
    for (int32_t j = i; *steps < steps_max;) {
        ++*steps;
        if (is_ear(ring, j, steps)) return j;
        if (ring[j].bent && turn_at(ring, j) == 0) straight = j;
        j = ring[j].next;
        if (j == i) break;
    }
    return straight;
}

void zt_triangulate(zt_triangulator *t, uint32_t *triangles, const uint32_t *corners,
                    int32_t count) {
    if (count == 3 || count > CORNERS_MAX || lay_out(t, corners, count)) {
        t->given_up += count > CORNERS_MAX;
        fan(triangles, corners, count);
        return;
    }
    corner *ring = t->ring;
    int64_t steps = 0, share = (int64_t)SHARE * count, steps_max = share + t->patience;
    int32_t at = 0;
    for (int32_t left = count; left >= 3; left--) {
        if (steps < steps_max) at = next_to_cut(ring, at, &steps, steps_max);
        triangles = cut_off(ring, at, triangles);
        at = ring[ring[at].next].next; /* not its neighbour: fewer slivers */
    }
    t->given_up += steps >= steps_max;
    if (steps > share) t->patience -= steps - share;
}
