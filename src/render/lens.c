#include "render/lens.h"

#include <float.h>
#include <math.h>

#include "base/bits.h"
#include "tracer/isa.h"

static const double pi = 3.14159265358979323846;

/* The lens at one moment. The ray through the place (x, y), in pixels from the top left corner,
 * and through the point (u, v) of the opening, which the unit circle is around, begins at
 *     origin + x step_right + y step_down + u wide + v high
 * and runs along
 *     ahead + x right + y down - (u wide_away + v high_away).
 * Of an equirectangular lens, right, down and ahead are its axes, and (x, y) are angles. All of
 * it goes straight on from one moment to the next. */
typedef struct view {
    vec3 origin, step_right, step_down, wide, high;
    vec3 ahead, right, down, wide_away, high_away;
} view;

enum { BLADES_MAX = 64 };

struct zt_lens {
    view still;        /* at the first moment */
    const view *views; /* at each, where it moves */
    zt_exposure exposure;
    const uint16_t *moment_at;
    zt_lens_kind kind;
    bool moves, opens;
    double turns_right, turns_down; /* of an equirectangular lens: a pixel's share of a turn */
    int32_t blades;                 /* 0: the opening is round */
    double corner_u[BLADES_MAX + 1], corner_v[BLADES_MAX + 1]; /* the last is the first */
};

/* ---- preparing ------------------------------------------------------------------------------
 */

zt_pixel zt_lens_pixel(const zt_camera *camera, int height) {
    zt_pixel pixel = {.reach = zt_camera_opening(camera)};
    if (camera->lens == ZT_LENS_EQUIRECTANGULAR)
        pixel.angle = pi / height;
    else if (camera->lens == ZT_LENS_ORTHOGRAPHIC)
        pixel.width = 2 * zt_camera_half_height(camera) / height;
    else
        pixel.angle = 2 * zt_camera_half_height(camera) / height;
    return pixel;
}

zt_pixel zt_lens_finest_pixel(const zt_exposure *exposure, int width, int height) {
    const zt_camera *first = &exposure->moments[0].camera;
    zt_pixel finest = {INFINITY, INFINITY, 0};
    for (int32_t i = 0; i < exposure->moment_count; i++) {
        const zt_camera *camera = &exposure->moments[i].camera;
        zt_pixel pixel = zt_lens_pixel(camera, height);
        pixel.reach += vec3_length(vec3_sub(camera->position, first->position)) +
                       pixel.width / 2 * hypot(width, height);
        finest = (zt_pixel){fmin(finest.width, pixel.width), fmin(finest.angle, pixel.angle),
                            fmax(finest.reach, pixel.reach)};
    }
    return finest;
}

static view view_of(const zt_camera *camera, vec3 first, int width, int height) {
    xform axes = zt_camera_xform(camera);
    view v = {.origin = vec3_sub(camera->position, first), .ahead = vec3_scale(axes.z, -1)};
    if (camera->lens == ZT_LENS_EQUIRECTANGULAR) {
        v.right = axes.x;
        v.down = vec3_scale(axes.y, -1);
        return v;
    }
    double step = 2 * zt_camera_half_height(camera) / height;
    vec3 right = vec3_scale(axes.x, step), down = vec3_scale(axes.y, -step);
    vec3 half = vec3_add(vec3_scale(right, width / 2.0), vec3_scale(down, height / 2.0));
    if (camera->lens == ZT_LENS_ORTHOGRAPHIC) {
        v.origin = vec3_sub(v.origin, half);
        v.step_right = right;
        v.step_down = down;
    } else {
        v.ahead = vec3_scale(vec3_add(axes.z, half), -1);
        v.right = right;
        v.down = down;
    }
    double radius = zt_camera_opening(camera), focus = zt_camera_focus(camera);
    double c = cos(camera->blade_rotation), s = sin(camera->blade_rotation);
    vec3 wide = vec3_add(vec3_scale(axes.x, c), vec3_scale(axes.y, s));
    vec3 high = vec3_sub(vec3_scale(axes.y, c), vec3_scale(axes.x, s));
    v.wide = vec3_scale(wide, radius);
    v.high = vec3_scale(high, radius);
    v.wide_away = vec3_scale(wide, radius / fmax(focus, DBL_MIN));
    v.high_away = vec3_scale(high, radius / fmax(focus, DBL_MIN));
    return v;
}

/* The corners of the opening, counterclockwise as the camera looks, the first one up. */
static void set_blades(zt_lens *lens, int32_t blades) {
    lens->blades = blades < 3 ? 0 : blades < BLADES_MAX ? blades : BLADES_MAX;
    for (int32_t i = 0; i < lens->blades; i++) {
        lens->corner_u[i] = -sin(2 * pi * i / lens->blades);
        lens->corner_v[i] = cos(2 * pi * i / lens->blades);
    }
    lens->corner_u[lens->blades] = lens->corner_u[0];
    lens->corner_v[lens->blades] = lens->corner_v[0];
}

zt_status zt_lens_prepare(zt_lens **out, const zt_exposure *exposure, int width, int height,
                          zt_arena *arena) {
    const zt_camera *first = &exposure->moments[0].camera;
    int32_t count = exposure->moment_count;
    zt_lens *lens = *out = ZT_PUSH(arena, zt_lens, 1);
    view *views = ZT_PUSH(arena, view, (size_t)count);
    if (!lens || !views) return ZT_EMEMORY;
    *lens = (zt_lens){.exposure = *exposure,
                      .views = views,
                      .kind = first->lens,
                      .turns_right = 1.0 / width,
                      .turns_down = 0.5 / height};
    set_blades(lens, first->blades);
    for (int32_t i = 0; i < count; i++) {
        views[i] = view_of(&exposure->moments[i].camera, first->position, width, height);
        lens->moves |= !zt_bits_equal(&views[i], &views[0], sizeof *views);
        lens->opens |= vec3_max_abs(views[i].wide) > 0 || vec3_max_abs(views[i].high) > 0;
    }
    lens->still = views[0];
    return lens->moves ? zt_exposure_index(&lens->moment_at, exposure, arena) : ZT_OK;
}

bool zt_lens_has_aperture(const zt_lens *lens) { return lens->opens; }

bool zt_lens_moves(const zt_lens *lens) { return lens->moves; }

/* ---- angles ---------------------------------------------------------------------------------
 */

/* Cosine and sine of an angle no further than pi / 4 from 0, by Taylor's series, right to
 * 1e-15. */
static inline void arc(double *c, double *s, double a) {
    double z = a * a;
    double even = 1. / 40320 - z * (1. / 3628800 - z * (1. / 479001600 - z / 87178291200.));
    double odd = 1. / 362880 - z * (1. / 39916800 - z * (1. / 6227020800. - z / 1307674368e3));
    *c = 1 - z * (1. / 2 - z * (1. / 24 - z * (1. / 720 - z * even)));
    *s = a * (1 - z * (1. / 6 - z * (1. / 120 - z * (1. / 5040 - z * odd))));
}

/* Cosine and sine of so many turns, between -100 and 100; exact at quarters. */
static inline void turned(double *c, double *s, double turns) {
    int quarter = (int)(4 * turns + 1024.5) - 1024;
    double x, y;
    arc(&x, &y, (turns - 0.25 * quarter) * (2 * pi));
    double across = quarter & 1 ? y : x, along = quarter & 1 ? x : y;
    *c = (quarter + 1) & 2 ? -across : across;
    *s = quarter & 2 ? -along : along;
}

/* ---- the opening ----------------------------------------------------------------------------
 */

/* Points of an opening, in the unit circle. */
typedef struct points {
    double u[ZT_BATCH], v[ZT_BATCH];
} points;

/* The unit square onto the disk, squares around its middle onto circles (P. Shirley and
 * K. Chiu, "A low distortion map between disk and square", 1997). */
ZT_CLONES static void pass_disk(points *restrict p, const float *restrict u,
                                const float *restrict v, int count) {
    for (int i = 0; i < count; i++) {
        double a = 2 * (double)u[i] - 1, b = 2 * (double)v[i] - 1, x, y;
        bool wide = fabs(a) > fabs(b);
        double radius = wide ? a : b, other = wide ? b : a;
        arc(&x, &y, pi / 4 * (other / (radius == 0 ? 1 : radius)));
        p->u[i] = radius * (wide ? x : y);
        p->v[i] = radius * (wide ? y : x);
    }
}

/* The unit square onto a polygon: a strip of it onto each triangle between its middle and two
 * corners, by the root that makes all areas the same share. */
ZT_CLONES static void pass_blades(points *restrict p, const zt_lens *lens,
                                  const float *restrict u, const float *restrict v, int count) {
    const double *restrict corner_u = lens->corner_u, *restrict corner_v = lens->corner_v;
    int32_t blades = lens->blades;
    for (int i = 0; i < count; i++) {
        double place = (double)u[i] * blades;
        int32_t k = (int32_t)place;
        k = k < blades ? k : blades - 1;
        double on = place - k, out = sqrt((double)v[i]);
        p->u[i] = out * (corner_u[k] + on * (corner_u[k + 1] - corner_u[k]));
        p->v[i] = out * (corner_v[k] + on * (corner_v[k + 1] - corner_v[k]));
    }
}

/* ---- rays -----------------------------------------------------------------------------------
 */

/* On its way from which moment to the next each ray is, and how far. */
typedef struct whens {
    int32_t moment[ZT_BATCH];
    double between[ZT_BATCH];
} whens;

static void find_whens(whens *w, const zt_lens *lens, const float *time, int count) {
    for (int i = 0; i < count; i++)
        w->between[i] =
            zt_exposure_find(&w->moment[i], &lens->exposure, lens->moment_at, (double)time[i]);
}

static inline vec3 on_way(vec3 a, vec3 b, double between) {
    return vec3_add(a, vec3_scale(vec3_sub(b, a), between));
}

static inline view view_between(const view *a, const view *b, double k) {
    return (view){
        on_way(a->origin, b->origin, k),       on_way(a->step_right, b->step_right, k),
        on_way(a->step_down, b->step_down, k), on_way(a->wide, b->wide, k),
        on_way(a->high, b->high, k),           on_way(a->ahead, b->ahead, k),
        on_way(a->right, b->right, k),         on_way(a->down, b->down, k),
        on_way(a->wide_away, b->wide_away, k), on_way(a->high_away, b->high_away, k)};
}

/* p + a x + b y */
static inline vec3 plus(vec3 p, double a, vec3 x, double b, vec3 y) {
    return (vec3){p.x + a * x.x + b * y.x, p.y + a * x.y + b * y.y, p.z + a * x.z + b * y.z};
}

static inline void set_ray(zt_rays *restrict rays, int i, vec3 o, vec3 d) {
    rays->ox[i] = o.x, rays->oy[i] = o.y, rays->oz[i] = o.z;
    rays->dx[i] = d.x, rays->dy[i] = d.y, rays->dz[i] = d.z;
}

/* A perspective lens that stays, a pinhole. */
ZT_CLONES static void see_plainly(zt_rays *restrict rays, const zt_lens *lens,
                                  const float *restrict x, const float *restrict y, int count) {
    const view l = lens->still;
    for (int i = 0; i < count; i++)
        set_ray(rays, i, (vec3){0, 0, 0},
                plus(l.ahead, (double)x[i], l.right, (double)y[i], l.down));
}

static inline double least_of(double a, double b) { return b < a ? b : a; }
static inline double most_of(double a, double b) { return b > a ? b : a; }

/* Roundings keep the order of numbers, so that all is between the corners. */
bool zt_lens_bounds(vec3 *low, vec3 *high, const zt_lens *lens, int x0, int y0, int x1,
                    int y1) {
    const view *l = &lens->still;
    if (lens->kind != ZT_LENS_PERSPECTIVE || lens->moves || lens->opens) return false;
    *low = *high = plus(l->ahead, x0, l->right, y0, l->down);
    for (int i = 1; i < 4; i++) {
        vec3 d = plus(l->ahead, i & 1 ? x1 : x0, l->right, i & 2 ? y1 : y0, l->down);
        *low = (vec3){least_of(low->x, d.x), least_of(low->y, d.y), least_of(low->z, d.z)};
        *high = (vec3){most_of(high->x, d.x), most_of(high->y, d.y), most_of(high->z, d.z)};
    }
    return true;
}

/* Loops of their own for what opens, and for what moves. */
#define ALWAYS_INLINE static inline __attribute__((always_inline))
#define NOT_NULL      __attribute__((nonnull))

/* All lenses with a flat picture; a pinhole where `opening` is NULL, still where `when` is. */
ALWAYS_INLINE void see_flat(zt_rays *restrict rays, const zt_lens *lens,
                            const float *restrict x, const float *restrict y,
                            const points *restrict opening, const whens *restrict when,
                            int count) {
    const view *views = lens->views;
    const view still = lens->still;
    for (int i = 0; i < count; i++) {
        const view *from = when ? &views[when->moment[i]] : views;
        const view l = when ? view_between(from, from + 1, when->between[i]) : still;
        vec3 o = plus(l.origin, (double)x[i], l.step_right, (double)y[i], l.step_down);
        vec3 d = plus(l.ahead, (double)x[i], l.right, (double)y[i], l.down);
        if (opening) {
            o = plus(o, opening->u[i], l.wide, opening->v[i], l.high);
            d = plus(d, -opening->u[i], l.wide_away, -opening->v[i], l.high_away);
        }
        set_ray(rays, i, o, d);
    }
}

ZT_CLONES static void see_flat_still(zt_rays *rays, const zt_lens *lens, const float *x,
                                     const float *y, int count) {
    see_flat(rays, lens, x, y, NULL, NULL, count);
}

ZT_CLONES NOT_NULL static void see_flat_moving(zt_rays *rays, const zt_lens *lens,
                                               const float *x, const float *y,
                                               const whens *when, int count) {
    see_flat(rays, lens, x, y, NULL, when, count);
}

ZT_CLONES NOT_NULL static void see_open_still(zt_rays *rays, const zt_lens *lens,
                                              const float *x, const float *y,
                                              const points *opening, int count) {
    see_flat(rays, lens, x, y, opening, NULL, count);
}

ZT_CLONES NOT_NULL static void see_open_moving(zt_rays *rays, const zt_lens *lens,
                                               const float *x, const float *y,
                                               const points *opening, const whens *when,
                                               int count) {
    see_flat(rays, lens, x, y, opening, when, count);
}

/* All around: x is longitude, from behind by the left, y latitude, from straight up. */
ALWAYS_INLINE void see_around(zt_rays *restrict rays, const zt_lens *lens,
                              const float *restrict x, const float *restrict y,
                              const whens *restrict when, int count) {
    const view *views = lens->views;
    const view still = lens->still;
    const double turns_right = lens->turns_right, turns_down = lens->turns_down;
    for (int i = 0; i < count; i++) {
        const view *from = when ? &views[when->moment[i]] : views;
        const view l = when ? view_between(from, from + 1, when->between[i]) : still;
        double right, ahead, level, down;
        turned(&ahead, &right, (double)x[i] * turns_right - 0.5);
        turned(&level, &down, (double)y[i] * turns_down - 0.25);
        vec3 d = plus(vec3_scale(l.down, down), level * right, l.right, level * ahead, l.ahead);
        set_ray(rays, i, l.origin, d);
    }
}

ZT_CLONES static void see_around_still(zt_rays *rays, const zt_lens *lens, const float *x,
                                       const float *y, int count) {
    see_around(rays, lens, x, y, NULL, count);
}

ZT_CLONES NOT_NULL static void see_around_moving(zt_rays *rays, const zt_lens *lens,
                                                 const float *x, const float *y,
                                                 const whens *when, int count) {
    see_around(rays, lens, x, y, when, count);
}

static void see_moving(zt_rays *rays, const zt_lens *lens, const float *x, const float *y,
                       const points *opening, int count) {
    whens when;
    find_whens(&when, lens, rays->time, count);
    if (lens->kind == ZT_LENS_EQUIRECTANGULAR)
        see_around_moving(rays, lens, x, y, &when, count);
    else if (opening)
        see_open_moving(rays, lens, x, y, opening, &when, count);
    else
        see_flat_moving(rays, lens, x, y, &when, count);
}

void zt_lens_rays(zt_rays *rays, const zt_lens *lens, const float *x, const float *y,
                  const float *u, const float *v, int count) {
    points opening;
    bool opens = lens->opens && u;
    rays->count = count;
    if (opens && lens->blades)
        pass_blades(&opening, lens, u, v, count);
    else if (opens)
        pass_disk(&opening, u, v, count);
    if (lens->moves)
        see_moving(rays, lens, x, y, opens ? &opening : NULL, count);
    else if (lens->kind == ZT_LENS_EQUIRECTANGULAR)
        see_around_still(rays, lens, x, y, count);
    else if (opens)
        see_open_still(rays, lens, x, y, &opening, count);
    else if (lens->kind == ZT_LENS_PERSPECTIVE)
        see_plainly(rays, lens, x, y, count);
    else
        see_flat_still(rays, lens, x, y, count);
}
