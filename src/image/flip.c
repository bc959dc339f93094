#include "image/flip.h"

#include <math.h>

#include "base/diag.h"
#include "image/develop.h"
#include "image/planes.h"

static const double pi = 3.14159265358979323846;

/* How the pictures are looked at, and the paper's constants. */
static const double distance_m = 0.7, display_m = 0.7, display_pixels = 3840;
static const double color_exponent = 0.7, feature_exponent = 0.5;
static const double bend_at = 0.4, bend_to = 0.95; /* p_c, p_t */
static const double feature_deg = 0.082;           /* the width of what is an edge or a point */

/* D65, as the matrix below makes it of white. */
static const double white_x = 23359437 / 24577794.0, white_z = 80288307 / 73733382.0;

/* What is seen of one picture: its colours in CIELAB with a and b by Hunt's effect less where
 * it is dark, and how much of an edge and of a point each pixel is. */
typedef struct seen {
    double *color[3], *edge, *point;
} seen;

/* What all of it is made with. */
typedef struct eye {
    int width, height;
    size_t count;
    double pixels_per_degree;
    double *rows, *one, *two; /* planes to work with */
    double linear[256];
} eye;

/* ---- colours -------------------------------------------------------------------------------
 */

typedef struct triple {
    double x, y, z;
} triple;

static triple xyz_of_linear(triple c) {
    const double n = 24577794, m = 12288897, k = 73733382;
    return (triple){(10135552 * c.x + 8788810 * c.y + 4435075 * c.z) / n,
                    (2613072 * c.x + 8788810 * c.y + 887015 * c.z) / m,
                    (1425312 * c.x + 8788810 * c.y + 70074185 * c.z) / k};
}

static triple linear_of_xyz(triple c) {
    return (triple){3.241003275 * c.x - 1.537398934 * c.y - 0.498615861 * c.z,
                    -0.969224334 * c.x + 1.875930071 * c.y + 0.041554224 * c.z,
                    0.055639423 * c.x - 0.204011202 * c.y + 1.057148933 * c.z};
}

/* CIELAB without its roots (Flohr et al. 1993): light that is blurred there stays the same. */
static triple opponent_of_linear(triple c) {
    triple t = xyz_of_linear(c);
    double x = t.x / white_x, y = t.y, z = t.z / white_z;
    return (triple){116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

static double cut(double x) { return x < 0 ? 0 : x > 1 ? 1 : x; }

static triple linear_of_opponent(triple c) {
    double y = (c.x + 16) / 116, x = (y + c.y / 500) * white_x, z = (y - c.z / 200) * white_z;
    triple t = linear_of_xyz((triple){x, y, z});
    return (triple){cut(t.x), cut(t.y), cut(t.z)};
}

static double lab_root(double t) {
    const double d = 6.0 / 29;
    return t > d * d * d ? cbrt(t) : t / (3 * d * d) + 4.0 / 29;
}

static triple hunt_lab_of_linear(triple c) {
    triple t = xyz_of_linear(c);
    double x = lab_root(t.x / white_x), y = lab_root(t.y), z = lab_root(t.z / white_z);
    double lightness = 116 * y - 16, vivid = 0.01 * lightness;
    return (triple){lightness, vivid * 500 * (x - y), vivid * 200 * (y - z)};
}

/* Large differences of colour (Abasi, Tehran and Fairchild 2020). */
static double hyab(triple a, triple b) { return fabs(a.x - b.x) + hypot(a.y - b.y, a.z - b.z); }

/* ---- one picture ---------------------------------------------------------------------------
 */

static zt_kernel_1d sensitivity(const eye *e, double b) {
    double sigma = sqrt(b / (2 * pi * pi)) * e->pixels_per_degree;
    int radius = (int)ceil(3 * sqrt(0.04 / (2 * pi * pi)) * e->pixels_per_degree);
    return zt_kernel_gaussian(sigma, radius);
}

/* Blurs as the eye does with what is fine: lightness least, blue and yellow most. */
static void blur(double *const c[3], const eye *e) {
    zt_kernel_1d light = sensitivity(e, 0.0047), red_green = sensitivity(e, 0.0053);
    zt_plane_filter(c[0], c[0], e->rows, e->width, e->height, &light, &light);
    zt_plane_filter(c[1], c[1], e->rows, e->width, e->height, &red_green, &red_green);
    /* The sum of two Gaussians. Over all pixels each adds up to its peak times the square of
     * what it adds up to along one axis, which is 1 over the middle weight. */
    zt_kernel_1d wide = sensitivity(e, 0.04), narrow = sensitivity(e, 0.025);
    double wide_peak = 34.1 * sqrt(pi / 0.04), narrow_peak = 13.5 * sqrt(pi / 0.025);
    int r = wide.radius;
    double wide_sum = wide_peak / pow(wide.weights[r], 2);
    double narrow_sum = narrow_peak / pow(narrow.weights[r], 2);
    double share = (wide_sum / (wide_sum + narrow_sum));
    zt_plane_filter(e->one, c[2], e->rows, e->width, e->height, &wide, &wide);
    zt_plane_filter(e->two, c[2], e->rows, e->width, e->height, &narrow, &narrow);
    for (size_t i = 0; i < e->count; i++) c[2][i] = share * e->one[i] + (1 - share) * e->two[i];
}

/* The first or second derivative of a Gaussian, its positive and its negative weights adding up
 * to 1 each. */
static zt_kernel_1d derivative(double sigma, int radius, int order) {
    zt_kernel_1d kernel = {.radius = radius};
    double values[2 * ZT_KERNEL_RADIUS_MAX + 1] = {0}, above = 0, below = 0;
    for (int i = -radius; i <= radius; i++) {
        double t = i / sigma, g = exp(-t * t / 2), v = order == 1 ? -t * g : (t * t - 1) * g;
        values[i + radius] = v;
        *(v > 0 ? &above : &below) += fabs(v);
    }
    for (int i = 0; i <= 2 * radius; i++)
        kernel.weights[i] = (values[i] / (values[i] > 0 ? above : below));
    return kernel;
}

/* How long the vector is that two kernels, along x and along y, make of the lightness. */
static void find_features(double *to, const double *lightness, const eye *e, int order) {
    double sigma = 0.5 * feature_deg * e->pixels_per_degree;
    int radius = (int)ceil(3 * sigma);
    zt_kernel_1d across = derivative(sigma, radius, order),
                 along = zt_kernel_gaussian(sigma, radius);
    zt_plane_filter(e->one, lightness, e->rows, e->width, e->height, &across, &along);
    zt_plane_filter(e->two, lightness, e->rows, e->width, e->height, &along, &across);
    for (size_t i = 0; i < e->count; i++) to[i] = hypot(e->one[i], e->two[i]);
}

static void look(seen *s, const uint8_t *bytes, const eye *e) {
    for (size_t i = 0; i < e->count; i++) {
        const uint8_t *p = bytes + 3 * i;
        triple t =
            opponent_of_linear((triple){e->linear[p[0]], e->linear[p[1]], e->linear[p[2]]});
        s->color[0][i] = t.x;
        s->color[1][i] = t.y;
        s->color[2][i] = t.z;
        s->edge[i] = (t.x + 16) / 116;
    }
    find_features(s->point, s->edge, e, 2);
    find_features(s->edge, s->edge, e, 1);
    blur(s->color, e);
    for (size_t i = 0; i < e->count; i++) {
        triple t = {s->color[0][i], s->color[1][i], s->color[2][i]};
        t = hunt_lab_of_linear(linear_of_opponent(t));
        s->color[0][i] = t.x;
        s->color[1][i] = t.y;
        s->color[2][i] = t.z;
    }
}

/* ---- two pictures --------------------------------------------------------------------------
 */

static double color_difference(const seen *a, const seen *b, size_t i, double most) {
    triple ca = {a->color[0][i], a->color[1][i], a->color[2][i]};
    triple cb = {b->color[0][i], b->color[1][i], b->color[2][i]};
    double d = pow(hyab(ca, cb), color_exponent), bend = bend_at * most;
    return d < bend ? bend_to / bend * d : bend_to + (d - bend) / (most - bend) * (1 - bend_to);
}

static double feature_difference(const seen *a, const seen *b, size_t i) {
    double edge = fabs(a->edge[i] - b->edge[i]), point = fabs(a->point[i] - b->point[i]);
    return cut(pow((edge > point ? edge : point) * sqrt(0.5), feature_exponent));
}

static double mean_difference(const seen *a, const seen *b, size_t count) {
    double most =
        pow(hyab(hunt_lab_of_linear((triple){0, 1, 0}), hunt_lab_of_linear((triple){0, 0, 1})),
            color_exponent);
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += pow(cut(color_difference(a, b, i, most)), 1 - feature_difference(a, b, i));
    return sum / (double)count;
}

static zt_status push_planes(eye *e, seen *s, zt_arena *arena) {
    double **planes[] = {&e->rows,       &e->one,        &e->two,        &s[0].color[0],
                         &s[0].color[1], &s[0].color[2], &s[0].edge,     &s[0].point,
                         &s[1].color[0], &s[1].color[1], &s[1].color[2], &s[1].edge,
                         &s[1].point};
    for (size_t i = 0; i < sizeof planes / sizeof *planes; i++) {
        *planes[i] = ZT_PUSH(arena, double, e->count);
        if (!*planes[i]) return ZT_EMEMORY;
    }
    return ZT_OK;
}

zt_status zt_flip(double *mean, const uint8_t *image, const uint8_t *reference, int width,
                  int height, zt_arena *arena) {
    eye e = {.width = width,
             .height = height,
             .count = (size_t)width * (size_t)height,
             .pixels_per_degree = distance_m * display_pixels / display_m * pi / 180};
    seen s[2] = {0};
    ZT_TRY(push_planes(&e, s, arena));
    for (int i = 0; i < 256; i++) e.linear[i] = zt_srgb_to_linear(i / 255.0);
    look(&s[0], image, &e);
    look(&s[1], reference, &e);
    *mean = mean_difference(&s[0], &s[1], e.count);
    return ZT_OK;
}
