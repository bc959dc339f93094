/* What the kernels of one precision work on: a scene made ready for rays. Lives for one frame,
 * in the frame's arena. */
#ifndef ZT_TRACER_TRACER_H
#define ZT_TRACER_TRACER_H

#include <stdint.h>

#include "tracer/kernel.h"
#include "tracer/primitives.h"
#include "tracer/ray.h"

/* How a primitive looks; and, of a plane, sphere or triangle, its surface: of a point p near
 * it, the normal n is the unit vector along normal + bend (p - center), and n . (p - center) -
 * level is the distance that p still has to it. One form for all three, so that one loop
 * without branches serves them. Rows of other kinds have zeros there. */
typedef struct zt_surface {
    real3 normal;
    real bend;
    real3 center;
    real level;
    real3 color;
    real reflectivity;
    int32_t pattern; /* an index, or -1 */
    int32_t closed;  /* 1: it has an inside; 0: it is flat; -1: a mesh, which may be either */
} zt_surface;

/* A pattern made ready: the point p has the place row . p + at, counted in cells, and lies in a
 * cell of `other` color where the sum of the place's whole parts is odd. */
typedef struct zt_weave {
    real3 rows[3], at;
    real3 other;
} zt_weave;

typedef enum zt_lamp_kind {
    ZT_LAMP_POINT,
    ZT_LAMP_BALL,
    ZT_LAMP_DISK,
    ZT_LAMP_RECTANGLE
} zt_lamp_kind;

/* A lamp at one moment. */
typedef struct zt_lamp_pose {
    real3 position; /* the middle */
    real3 power;    /* color * intensity */
    real3 x, y, z;  /* the axes of disks and rectangles: unit; they shine along -z */
    real a, b; /* half as long as it is along x and along y; a: the radius of what is round */
    int32_t shadows; /* whether there are any */
} zt_lamp_pose;

typedef struct zt_lamp {
    zt_lamp_kind kind;
    int32_t light; /* its index in the scene */
    bool moves;    /* its poses, one at each moment of the exposure, are not all the same */
    bool has_size; /* at some moment: random numbers say where on it rays go */
    bool shines;   /* at some moment */
    bool shadows;  /* likewise */
    const zt_lamp_pose *poses;
    zt_box bounds; /* around it at all times, roundings included; of a point its place */
} zt_lamp;

/* A mesh in its place: a point p relative to the camera is at row . p + at in the mesh's own
 * space, `origin` left out; give or take `room` (in that space), which grows by `reach` times
 * the largest coordinate of p. */
typedef struct zt_placed_mesh {
    zt_built_mesh *built;
    vec3 rows[3], at;
    xform place; /* the way back */
    real reach, room;
    real inner;  /* the largest coordinate of its bounds in its own space */
    real extent; /* no less than any number in the arithmetic of its place */
    bool smooth, vertex_colors;
    /* Of one that moves, else NULL: the way back at each moment of the exposure. Then what is
     * said above of its place is true of no other than that moment at which it was made. */
    const xform *places;
} zt_placed_mesh;

static inline vec3 zt_mix3(vec3 a, vec3 b, double between) {
    return vec3_add(a, vec3_scale(vec3_sub(b, a), between));
}

static inline vec3 zt_placed_point(const zt_placed_mesh *m, vec3 p) {
    return vec3_add(m->at, (vec3){vec3_dot(m->rows[0], p), vec3_dot(m->rows[1], p),
                                  vec3_dot(m->rows[2], p)});
}

/* A mesh that moves, so far on its way from a moment to the next. */
static inline zt_placed_mesh zt_placed_at(const zt_placed_mesh *m, int32_t moment,
                                          double between) {
    zt_placed_mesh now = *m;
    const xform *a = &m->places[moment], *b = a + 1;
    now.place = (xform){zt_mix3(a->x, b->x, between), zt_mix3(a->y, b->y, between),
                        zt_mix3(a->z, b->z, between), zt_mix3(a->shift, b->shift, between)};
    xform back = xform_inverse(&now.place);
    now.rows[0] = (vec3){back.x.x, back.y.x, back.z.x};
    now.rows[1] = (vec3){back.x.y, back.y.y, back.z.y};
    now.rows[2] = (vec3){back.x.z, back.y.z, back.z.z};
    now.at = back.shift;
    return now;
}

/* So many things at most are asked whether they are in the way. Where lamps are fewer than so
 * many, asking costs as much as their rays do. */
enum { ZT_BLOCKERS_MAX = 32, ZT_REACH_LAMPS = 4 };

/* Made with the tracer: bounds of the lamps as a structure of arrays, lamp_count of each and up
 * to a whole group of lanes more that mean nothing; and what may be in their way: things that
 * stand still and are convex. */
typedef struct zt_reach {
    const real *low_x, *low_y, *low_z, *high_x, *high_y, *high_z;
    const int32_t *shines;             /* whether it does at some moment */
    const int32_t *shadows;            /* whether all of its rays are shadow rays */
    int32_t blockers[ZT_BLOCKERS_MAX]; /* primitives; the largest first */
    int32_t blocker_count;
} zt_reach;

/* Primitives that are asked through a hierarchy over their boxes: of those that stay, which is
 * kept from frame to frame, and of the others. */
enum { ZT_CROWDS_MAX = 2 };
typedef struct zt_crowd {
    const int32_t *primitives;
    int32_t count;
    const zt_bvh *bvh;
    zt_box box; /* around them all */
} zt_crowd;

/* What of a primitive's looks changes (tracer/motion.h). */
typedef struct zt_change zt_change;

struct zt_tracer {
    const zt_primitive *primitives;
    const zt_surface *surfaces; /* one for each primitive */
    int32_t primitive_count;
    const int32_t *single; /* the primitives that are asked one by one, in order */
    int32_t single_count;
    zt_crowd crowds[ZT_CROWDS_MAX];
    int crowd_count; /* 0 where there are few things */
    const zt_placed_mesh *placed;
    int32_t placed_count;
    const zt_weave *weaves;
    const zt_lamp *lamps; /* the lights that are somewhere, in order */
    int32_t lamp_count;
    const zt_reach *reach;    /* NULL where lamps are few, or everything is to be done */
    real3 ambient;            /* the sum of the ambient lights */
    const real3 *ambients;    /* at each moment of the exposure; NULL where it stays the same */
    int32_t reflection_depth; /* beyond which nothing can change any more */
    int32_t asked_depth;      /* the scene's own */
    real brightest;           /* no point's light is more, in any channel */
    int32_t faint_depth;      /* from which on light may be too faint to count */
    bool everything;          /* nothing is left out, so that what is can be compared */
    real tie; /* TIE where things lie on each other, so that the first object's hit counts; or 0
               */
    bool has_solids, has_patterns;
    bool moves; /* then the next two are there */
    const zt_exposure *exposure;
    const uint16_t *moment_at; /* of zt_exposure_index() */
    bool straight;             /* there are two moments only */
    const zt_change *changes;  /* of each primitive: what of its looks changes; NULL: nothing */
};

#endif
