/* Lamps as points see them: in which direction a place on the lamp is, how far, and how much of
 * the lamp's power arrives from there. Straight code without branches, for loops over a batch.
 * For lamps with a size that is an estimate of what the whole lamp gives: its mean over the
 * random numbers (u, v) of [0, 1)^2 is that, hidden parts left aside. Each does as a point
 * light does, power / d^2, where its size is 0, or too small against its distance to make a
 * difference. */
#ifndef ZT_TRACER_LAMPS_H
#define ZT_TRACER_LAMPS_H

#include "tracer/isa.h"
#include "tracer/points.h"
#include "tracer/tracer.h"

/* The way from a point to a lamp. */
typedef struct zt_lamp_way {
    real x, y, z;  /* the direction, unit */
    real distance; /* along which nothing may be in between; 0: nothing can */
    real fade;     /* by which the power is multiplied; 0 behind the surface; or not finite */
} zt_lamp_way;

/* What is no further from a lamp than this share of its size hides nothing of it: so that a
 * lamp may lie on a ceiling, and fill a ball or a shade to its surface. */
#define LAMP_INLINE inline __attribute__((always_inline))
#define LAMP_SKIN   ((real)0x1p-10)

/* ---- numbers --------------------------------------------------------------------------------
 */

/* Sine and cosine of an angle of up to an eighth of a turn: Taylor's series, to the last bits
 * of a double. */
static LAMP_INLINE void zt_arc(double *sine, double *cosine, double angle) {
    double q = -angle * angle;
    double s = 1 + q * (1. / 210);
    s = 1 + q * (1. / 156) * s;
    s = 1 + q * (1. / 110) * s;
    s = 1 + q * (1. / 72) * s;
    s = 1 + q * (1. / 42) * s;
    s = 1 + q * (1. / 20) * s;
    *sine = angle + angle * (q * (1. / 6) * s);
    double c = 1 + q * (1. / 240);
    c = 1 + q * (1. / 182) * c;
    c = 1 + q * (1. / 132) * c;
    c = 1 + q * (1. / 90) * c;
    c = 1 + q * (1. / 56) * c;
    c = 1 + q * (1. / 30) * c;
    c = 1 + q * (1. / 12) * c;
    *cosine = 1 + q * (1. / 2) * c;
}

/* Of so many turns, 0 to 1. */
static LAMP_INLINE void zt_turn(double *sine, double *cosine, double turns) {
    int32_t quarter = (int32_t)(4 * turns + 0.5);
    double s, c;
    zt_arc(&s, &c, (turns - 0.25 * quarter) * 6.283185307179586477);
    bool odd = quarter & 1;
    double sine_there = odd ? c : s, cosine_there = odd ? s : c;
    *sine = (quarter & 2) ? -sine_there : sine_there;
    *cosine = ((quarter + 1) & 2) ? -cosine_there : cosine_there;
}

/* The angle of the vector (x, y), y >= 0, in 0 .. pi: halved three times, then Taylor's series.
 * Right to the last bits of its own, however small. */
static LAMP_INLINE double zt_angle(double x, double y) {
    double length = sqrt(x * x + y * y);
    /* The tangent of half of it, either way without cancellation. */
    double t = x > 0 ? y / (length + x) : (length - x) / y;
    bool steep = t > 1;
    t = steep ? 1 / t : t;
    t = t / (1 + sqrt(1 + t * t));
    t = t / (1 + sqrt(1 + t * t));
    double q = -t * t, sum = 1. / 21;
    sum = 1. / 19 + q * sum;
    sum = 1. / 17 + q * sum;
    sum = 1. / 15 + q * sum;
    sum = 1. / 13 + q * sum;
    sum = 1. / 11 + q * sum;
    sum = 1. / 9 + q * sum;
    sum = 1. / 7 + q * sum;
    sum = 1. / 5 + q * sum;
    sum = 1. / 3 + q * sum;
    double half = 4 * (t + t * (q * sum));
    return 2 * (steep ? 1.5707963267948966192 - half : half);
}

static LAMP_INLINE double zt_between(double value, double low, double high) {
    double most = value > low ? value : low;
    return most < high ? most : high;
}

/* ---- rectangles -----------------------------------------------------------------------------
 */

/* Below this solid angle roundings begin to show in where zt_sheet_sample takes its places. */
#define SHEET_LEAST 0x1p-20

/* A rectangle as a point sees it that lies before its front: across the z axis, the point being
 * the origin. Computed in double precision for all. */
typedef struct zt_sheet {
    double x0, x1, y0, y1, z; /* z > 0 */
    double yy0, yy1, zz;      /* squares */
    double l0, l1, b0, b1;    /* sqrt(y^2 + z^2), and y / l */
    double cosine, sine;      /* of the sum of the angles between the edges at x0 */
    double solid_angle;       /* give or take 1e-15 */
} zt_sheet;

/* Projected onto the unit sphere the edges are great circles, and the solid angle is what the
 * four angles between them exceed 2 pi by: added up as products of complex numbers. */
static LAMP_INLINE zt_sheet zt_sheet_of(double x0, double x1, double y0, double y1, double z) {
    double xx0 = x0 * x0, xx1 = x1 * x1, yy0 = y0 * y0, yy1 = y1 * y1, zz = z * z;
    double a0 = sqrt(xx0 + zz), a1 = sqrt(xx1 + zz), l0 = sqrt(yy0 + zz), l1 = sqrt(yy1 + zz);
    double b0 = y0 / l0, b1 = y1 / l1, c0 = x0 / a0, c1 = x1 / a1;
    double cos00 = -c0 * b0, sin00 = z * sqrt(xx0 + yy0 + zz) / (a0 * l0);
    double cos01 = c0 * b1, sin01 = z * sqrt(xx0 + yy1 + zz) / (a0 * l1);
    double cos10 = c1 * b0, sin10 = z * sqrt(xx1 + yy0 + zz) / (a1 * l0);
    double cos11 = -c1 * b1, sin11 = z * sqrt(xx1 + yy1 + zz) / (a1 * l1);
    double cos0 = cos00 * cos01 - sin00 * sin01, sin0 = sin00 * cos01 + cos00 * sin01;
    double cos1 = cos10 * cos11 - sin10 * sin11, sin1 = sin10 * cos11 + cos10 * sin11;
    double cosine = cos0 * cos1 - sin0 * sin1, sine = sin0 * cos1 + cos0 * sin1;
    double angle = zt_angle(cosine, fabs(sine));
    bool all = (x0 < -z) & (x1 > z) & (y0 < -z) & (y1 > z); /* then it is not nothing */
    double rest = sine < 0 ? 6.283185307179586477 - angle : angle;
    rest = angle > 1e-14 ? rest : all ? 6.283185307179586477 : 0;
    return (zt_sheet){x0, x1, y0, y1, z, yy0, yy1, zz, l0, l1, b0, b1, cos0, sin0, rest};
}

/* A place on it, all directions to it being as probable: Urena, Fajardo and King, "An
 * area-preserving parametrization for spherical rectangles", EGSR 2013, without the differences
 * of nearly equal numbers. */
static LAMP_INLINE void zt_sheet_sample(double *x, double *y, const zt_sheet *s, double u,
                                        double v) {
    /* The sum of the other two angles of the part from x0 to x, which has u of the whole. */
    double sin_u, cos_u;
    zt_turn(&sin_u, &cos_u, u * s->solid_angle * 0.15915494309189533577);
    double cosine = s->cosine * cos_u + s->sine * sin_u;
    double sine = s->cosine * sin_u - s->sine * cos_u;
    double low = s->y0 * s->l1, high = s->y1 * s->l0; /* b1 - b0 is (high - low) / (l0 l1) */
    double wide = low * high > 0 ? s->zz * (s->yy1 - s->yy0) / (high + low) : high - low;
    wide /= s->l0 * s->l1;
    double more = cosine < 0 ? sine * sine / (1 - cosine) : 1 + cosine;
    double c = -sine / sqrt(wide * wide + 2 * s->b0 * s->b1 * more);
    *x = zt_between(s->z * c / sqrt(1 - c * c), s->x0, s->x1);
    double dd = *x * *x + s->zz;
    double t0 = s->y0 / sqrt(dd + s->yy0), t1 = s->y1 / sqrt(dd + s->yy1),
           t = t0 + v * (t1 - t0);
    *y = zt_between(t * sqrt(dd / (1 - t * t)), s->y0, s->y1);
}

/* ---- the kinds of lamps ---------------------------------------------------------------------
 */

/* The light of a point of space. */
static LAMP_INLINE zt_lamp_way zt_point_way(const zt_lamp_pose *lamp, real px, real py, real pz,
                                            real nx, real ny, real nz, float u, float v) {
    (void)u, (void)v;
    real vx = lamp->position.x - px, vy = lamp->position.y - py, vz = lamp->position.z - pz;
    real toward = real_dot(nx, ny, nz, vx, vy, vz);
    real distance = real_sqrt(real_dot(vx, vy, vz, vx, vy, vz)), near = 1 / distance;
    real fade = toward * near * near * near;
    return (zt_lamp_way){vx * near, vy * near, vz * near, distance, toward > 0 ? fade : 0};
}

/* Of a ball: power / (pi r^2) from all its surface, in the cone that it fills, all directions
 * being as probable. A point inside of it (or as near as its skin) has it all around, and
 * nothing in between. */
static LAMP_INLINE zt_lamp_way zt_ball_way(const zt_lamp_pose *lamp, real px, real py, real pz,
                                           real nx, real ny, real nz, float u, float v) {
    real vx = lamp->position.x - px, vy = lamp->position.y - py, vz = lamp->position.z - pz;
    real distance = real_sqrt(real_dot(vx, vy, vz, vx, vy, vz)), near = 1 / distance;
    real r = lamp->a, sine = r * near, sine2 = sine * sine; /* of the cone */
    real cosine = real_sqrt(real_max((1 - sine) * (1 + sine), 0));
    real part = (real)u * (sine2 / (1 + cosine)); /* 1 - cos of the angle off its axis */
    real aside2 = part * (2 - part), aside = distance * real_sqrt(aside2);
    double sine_v, cosine_v;
    zt_turn(&sine_v, &cosine_v, (double)v);
    real s = aside * (real)sine_v, c = aside * (real)cosine_v;
    /* Across the axis: Duff et al., "Building an orthonormal basis, revisited", JCGT 6(1),
     * 2017.
     */
    real wx = vx * near, wy = vy * near, wz = vz * near;
    real sign = wz < 0 ? -1 : 1, a = -1 / (sign + wz), b = wx * wy * a;
    real qx = vx - part * vx + c * (1 + sign * wx * wx * a) + s * b;
    real qy = vy - part * vy + c * (sign * b) + s * (sign + wy * wy * a);
    real qz = vz - part * vz - c * (sign * wx) - s * wy;
    real toward = real_dot(nx, ny, nz, qx, qy, qz);
    real fade = toward * near * near * near * (2 / (1 + cosine));
    /* To the side of the ball that is nearer. */
    real half = real_sqrt(real_max(sine2 - aside2, 0));
    real way = distance * ((1 - sine) * (1 + sine) / (1 - part + half)) - LAMP_SKIN * r;
    bool inside = sine * (1 + LAMP_SKIN) >= 1;
    fade = toward > 0 ? fade : 0;
    return (zt_lamp_way){inside ? nx : qx * near, inside ? ny : qy * near,
                         inside ? nz : qz * near, inside ? 0 : real_max(way, 0),
                         inside ? 1 / r * (1 / r) : fade};
}

/* Where a point sees a flat lamp: its middle, along its own axes. */
typedef struct zt_front {
    real3 v; /* the way there */
    double x, y, z;
} zt_front;

static LAMP_INLINE zt_front zt_front_of(const zt_lamp_pose *l, real px, real py, real pz) {
    real3 v = {l->position.x - px, l->position.y - py, l->position.z - pz};
    return (zt_front){v, (double)real_dot(v.x, v.y, v.z, l->x.x, l->x.y, l->x.z),
                      (double)real_dot(v.x, v.y, v.z, l->y.x, l->y.y, l->y.z),
                      (double)real_dot(v.x, v.y, v.z, l->z.x, l->z.y, l->z.z)};
}

/* The way to the place (a, b) off the middle of a flat lamp. `share` is the solid angle, by
 * which the place was sampled, over the lamp's area; 0: it was sampled by area. */
static LAMP_INLINE zt_lamp_way zt_flat_way(const zt_lamp_pose *l, const zt_front *front,
                                           real nx, real ny, real nz, double a, double b,
                                           double share) {
    real x = (real)a, y = (real)b;
    real qx = front->v.x + x * l->x.x + y * l->y.x, qy = front->v.y + x * l->x.y + y * l->y.y,
         qz = front->v.z + x * l->x.z + y * l->y.z;
    real toward = real_dot(nx, ny, nz, qx, qy, qz);
    real distance = real_sqrt(real_dot(qx, qy, qz, qx, qy, qz)), near = 1 / distance;
    real fade = toward * near * near * near * ((real)front->z * near);
    fade = share > 0 ? toward * near * (real)share : fade;
    real size = real_max(l->a, l->b);
    return (zt_lamp_way){qx * near, qy * near, qz * near,
                         real_max(distance - LAMP_SKIN * size, 0),
                         ((toward > 0) & (front->z > 0)) ? fade : 0};
}

/* Of a rectangle: power / area, times the cosine, from all its front. By solid angle, all
 * directions being as probable; by area where that is as good. */
static LAMP_INLINE zt_lamp_way zt_rectangle_way(const zt_lamp_pose *l, real px, real py,
                                                real pz, real nx, real ny, real nz, float u,
                                                float v) {
    zt_front f = zt_front_of(l, px, py, pz);
    double a = (double)l->a, b = (double)l->b, x, y;
    zt_sheet sheet = zt_sheet_of(f.x - a, f.x + a, f.y - b, f.y + b, f.z);
    zt_sheet_sample(&x, &y, &sheet, (double)u, (double)v);
    bool wide = sheet.solid_angle > SHEET_LEAST;
    x = wide ? x - f.x : (2 * (double)u - 1) * a;
    y = wide ? y - f.y : (2 * (double)v - 1) * b;
    return zt_flat_way(l, &f, nx, ny, nz, x, y, wide ? sheet.solid_angle / (4 * a * b) : 0);
}

/* A place on the unit disk: Shirley and Chiu, "A low distortion map between disk and square",
 * 1997. */
static LAMP_INLINE void zt_disk_sample(double *x, double *y, double u, double v) {
    double a = 2 * u - 1, b = 2 * v - 1, sine, cosine;
    bool flat = a * a > b * b;
    double r = flat ? a : b, across = flat ? b : a;
    zt_arc(&sine, &cosine, across / (r != 0 ? r : 1) * 0.78539816339744830962);
    *x = r * (flat ? cosine : sine);
    *y = r * (flat ? sine : cosine);
}

/* Whether a point is so near to a disk that its directions are sampled: then the noise of what
 * misses it is less than that of distances. */
static LAMP_INLINE bool zt_disk_is_near(const zt_lamp_pose *l, const zt_front *f) {
    double r = (double)l->a, beyond = sqrt(f->x * f->x + f->y * f->y) - r;
    beyond = beyond > 0 ? beyond : 0;
    return beyond * beyond + f->z * f->z < 0.5 * r * r;
}

/* Of a disk, likewise. By area; where it is near and that would be noisy by the solid angle of
 * the square around it, with nothing from beside the disk (Gamito, "Solid angle sampling of
 * disk and cylinder lights", 2016): of a disk itself there is no closed form. `any_near`: there
 * are such points in the batch. */
static LAMP_INLINE zt_lamp_way zt_disk_way(const zt_lamp_pose *l, real px, real py, real pz,
                                           real nx, real ny, real nz, float u, float v,
                                           bool any_near) {
    zt_front f = zt_front_of(l, px, py, pz);
    double r = (double)l->a, x, y, share = 0, met = 1;
    zt_disk_sample(&x, &y, (double)u, (double)v);
    x *= r;
    y *= r;
    if (any_near) {
        double sx, sy;
        zt_sheet sheet = zt_sheet_of(f.x - r, f.x + r, f.y - r, f.y + r, f.z);
        zt_sheet_sample(&sx, &sy, &sheet, (double)u, (double)v);
        bool wide = sheet.solid_angle > (zt_disk_is_near(l, &f) ? SHEET_LEAST : INFINITY);
        x = wide ? sx - f.x : x;
        y = wide ? sy - f.y : y;
        share = wide ? sheet.solid_angle / (3.141592653589793238 * r * r) : 0;
        met = x * x + y * y > r * r ? 0 : 1;
        met = wide ? met : 1;
    }
    zt_lamp_way way = zt_flat_way(l, &f, nx, ny, nz, x, y, share);
    way.fade *= (real)met;
    return way;
}

/* ---- batches --------------------------------------------------------------------------------
 */

/* What a lamp gives points, in each channel. */
typedef struct zt_lamp_light {
    alignas(64) real r[ZT_BATCH];
    alignas(64) real g[ZT_BATCH];
    alignas(64) real b[ZT_BATCH];
} zt_lamp_light;

/* What a lamp gives each of the points where nothing is in between, still to be multiplied by
 * the points' colors; and the directions and lengths (t) of the shadow rays. Which random
 * numbers: those of the `given` rays' keys in a dimension. `straight`: the exposure has two
 * moments only. */
void ZT_KERNEL_NAME(zt_lamp_aim)(zt_lamp_light *light, zt_batch *shadow, const zt_lamp *lamp,
                                 const zt_points *points, const zt_rays *given,
                                 uint32_t dimension, bool straight);

#endif
