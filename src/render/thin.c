/* Each thing is held by a prism: two quadrilaterals and what lies between. It is cut into
 * pieces until each is about as far away at both ends, so that a rail that runs to the horizon
 * is thin there; then the convex hull of the piece's corners on the picture says how thin it
 * is, and which pixels it covers. */
#include "render/thin.h"

#include <math.h>

enum { CORNERS = 8, CLIPPED = CORNERS + CORNERS * CORNERS / 4, CUTS = 16 };
enum { LEAST_LOW = 2, LEAST_HIGH = 6 };

static const double thin_px = 2, depth_ratio = 2;

struct zt_thin {
    const zt_scene *scene;
    const xform *worlds;
    xform axes;  /* the camera's */
    double step; /* a pixel's width at a distance of 1, or at any */
    bool is_flat, is_round;
    int width, height;
};

/* Corners 0 .. 3 and 4 .. 7, each around its end; `thickness` is that of what is within, in the
 * unit of space, where that is less than the prism's own, else infinite. */
typedef struct prism {
    vec3 corners[CORNERS];
    double thickness;
} prism;

typedef struct point {
    double x, y;
} point;

zt_status zt_thin_prepare(const zt_thin **out, const zt_exposure *exposure, int width,
                          int height, zt_arena *arena) {
    const zt_scene *scene = &exposure->moments[0];
    zt_thin *thin = ZT_PUSH(arena, zt_thin, 1);
    xform *worlds = ZT_PUSH(arena, xform, (size_t)scene->object_count);
    if (!thin || !worlds) return ZT_EMEMORY;
    zt_scene_worlds(worlds, scene, scene->camera.position);
    *thin = (zt_thin){.scene = scene,
                      .worlds = worlds,
                      .axes = zt_camera_xform(&scene->camera),
                      .step = 2 * zt_camera_half_height(&scene->camera) / height,
                      .is_flat = scene->camera.lens == ZT_LENS_ORTHOGRAPHIC,
                      .is_round = scene->camera.lens == ZT_LENS_EQUIRECTANGULAR,
                      .width = width,
                      .height = height};
    *out = thin;
    return ZT_OK;
}

/* What holds a thing ------------------------------------------------------------------------*/

static void set_end(prism *p, int end, vec3 middle, vec3 u, vec3 v) {
    p->corners[4 * end] = vec3_add(vec3_add(middle, u), v);
    p->corners[4 * end + 1] = vec3_sub(vec3_add(middle, u), v);
    p->corners[4 * end + 2] = vec3_sub(vec3_sub(middle, u), v);
    p->corners[4 * end + 3] = vec3_add(vec3_sub(middle, u), v);
}

/* Of half axes, of which the prism's ends are those of the longest. */
static void set_block(prism *p, vec3 middle, vec3 a, vec3 b, vec3 c) {
    vec3 axes[3] = {a, b, c};
    double lengths[3] = {vec3_length(a), vec3_length(b), vec3_length(c)};
    int k = lengths[0] >= lengths[1] ? 0 : 1;
    if (lengths[2] > lengths[k]) k = 2;
    set_end(p, 0, vec3_sub(middle, axes[k]), axes[(k + 1) % 3], axes[(k + 2) % 3]);
    set_end(p, 1, vec3_add(middle, axes[k]), axes[(k + 1) % 3], axes[(k + 2) % 3]);
}

/* Two unit vectors across a third one. */
static void across(vec3 *u, vec3 *v, vec3 n) {
    vec3 other = fabs(n.x) < 0.6 ? (vec3){1, 0, 0} : (vec3){0, 1, 0};
    *u = vec3_normalize(vec3_cross(n, other));
    *v = vec3_cross(n, *u);
}

static void set_tube(prism *p, const zt_tube *t, zt_shape shape) {
    vec3 along = vec3_normalize(vec3_sub(t->to, t->from)), u, v;
    double from = t->radius, to = shape == ZT_SHAPE_CONE ? t->end_radius : t->radius;
    vec3 cap = vec3_scale(along, shape == ZT_SHAPE_CAPSULE ? t->radius : 0);
    across(&u, &v, along);
    set_end(p, 0, vec3_sub(t->from, cap), vec3_scale(u, from), vec3_scale(v, from));
    set_end(p, 1, vec3_add(t->to, cap), vec3_scale(u, to), vec3_scale(v, to));
}

static void set_round(prism *p, vec3 middle, vec3 axis, double radius, double height) {
    vec3 n = vec3_normalize(axis), u, v;
    across(&u, &v, n);
    set_block(p, middle, vec3_scale(u, radius), vec3_scale(v, radius), vec3_scale(n, height));
}

/* In the object's space; false where there is none. */
static bool hold(prism *p, const zt_object *o, const zt_mesh *meshes) {
    p->thickness = INFINITY;
    switch (o->shape) {
    case ZT_SHAPE_SPHERE:
        set_round(p, o->sphere.center, (vec3){0, 1, 0}, o->sphere.radius, o->sphere.radius);
        return true;
    case ZT_SHAPE_TRIANGLE:
        for (int i = 0; i < CORNERS; i++) p->corners[i] = o->triangle.vertices[i < 4 ? 0 : 1];
        p->corners[6] = p->corners[7] = o->triangle.vertices[2];
        return true;
    case ZT_SHAPE_DISK:
        set_round(p, o->disk.center, o->disk.normal, o->disk.radius, 0);
        return true;
    case ZT_SHAPE_BOX: {
        xform m = xform_place(o->box.center, o->box.rotation, vec3_scale(o->box.size, 0.5));
        set_block(p, m.shift, m.x, m.y, m.z);
        return true;
    }
    case ZT_SHAPE_CYLINDER:
    case ZT_SHAPE_CONE:
    case ZT_SHAPE_CAPSULE:
        set_tube(p, &o->tube, o->shape);
        return true;
    case ZT_SHAPE_TORUS:
        set_round(p, o->torus.center, o->torus.axis, o->torus.radius + o->torus.tube_radius,
                  o->torus.tube_radius);
        p->thickness = 2 * o->torus.tube_radius;
        return true;
    case ZT_SHAPE_MESH: {
        const zt_mesh *mesh = &meshes[o->mesh];
        xform m = xform_place(o->placement.position, o->placement.rotation, o->placement.scale);
        vec3 half = vec3_scale(vec3_sub(mesh->high, mesh->low), 0.5);
        set_block(p, xform_point(&m, vec3_add(mesh->low, half)), vec3_scale(m.x, half.x),
                  vec3_scale(m.y, half.y), vec3_scale(m.z, half.z));
        return true;
    }
    default:
        return false;
    }
}

/* On the picture ----------------------------------------------------------------------------*/

/* From the space relative to the camera to its own: x right, y down, z ahead. */
static vec3 seen_at(const zt_thin *thin, vec3 p) {
    return (vec3){vec3_dot(thin->axes.x, p), -vec3_dot(thin->axes.y, p),
                  -vec3_dot(thin->axes.z, p)};
}

static point project(const zt_thin *thin, vec3 p) {
    double width = thin->is_flat ? thin->step : thin->step * p.z;
    return (point){thin->width / 2.0 + p.x / width, thin->height / 2.0 + p.y / width};
}

/* Corners before the camera, and where the ways from these to those behind it pass `near`. */
static int clip(point *points, const zt_thin *thin, const vec3 *corners, double near) {
    int count = 0;
    for (int i = 0; i < CORNERS; i++) {
        if (corners[i].z < near) continue;
        points[count++] = project(thin, corners[i]);
        for (int k = 0; k < CORNERS; k++) {
            if (corners[k].z >= near) continue;
            double share = (corners[i].z - near) / (corners[i].z - corners[k].z);
            vec3 way = vec3_sub(corners[k], corners[i]);
            points[count++] = project(thin, vec3_add(corners[i], vec3_scale(way, share)));
        }
    }
    return count;
}

static double turn(point a, point b, point c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/* Sorts points and keeps the corners of their convex hull, counterclockwise (Andrew, "Another
 * efficient algorithm for convex hulls in two dimensions", 1979). */
static int make_hull(point *hull, point *points, int count) {
    for (int i = 1; i < count; i++)
        for (int k = i;
             k > 0 && (points[k].x < points[k - 1].x ||
                       (points[k].x == points[k - 1].x && points[k].y < points[k - 1].y));
             k--) {
            point other = points[k];
            points[k] = points[k - 1];
            points[k - 1] = other;
        }
    int size = 0;
    for (int pass = 0; pass < 2; pass++) {
        int first = size;
        for (int i = 0; i < count; i++) {
            point p = points[pass ? count - 1 - i : i];
            while (size - first >= 2 && turn(hull[size - 2], hull[size - 1], p) <= 0) size--;
            hull[size++] = p;
        }
        size--; /* the last one begins the other half */
    }
    return size < 1 ? 1 : size;
}

/* The width of a convex polygon where it is least: across one of its sides. */
static double least_width(const point *hull, int count) {
    double least = INFINITY;
    for (int i = 0; i < count; i++) {
        point a = hull[i], b = hull[(i + 1) % count];
        double length = hypot(b.x - a.x, b.y - a.y), most = 0;
        for (int k = 0; k < count && length > 0; k++)
            most = fmax(most, fabs(turn(a, b, hull[k])) / length);
        if (length > 0) least = fmin(least, most);
    }
    return isinf(least) ? 0 : least;
}

/* Raises the pixels of a row that a polygon comes as near to as `reach`. */
static void mark_row(uint8_t *row, int width, const point *hull, int count, double top,
                     double bottom, double reach, uint8_t level) {
    double low = INFINITY, high = -INFINITY;
    for (int i = 0; i < count; i++) {
        point a = hull[i], b = hull[(i + 1) % count];
        double from = fmax(fmin(a.y, b.y), top), to = fmin(fmax(a.y, b.y), bottom);
        if (from > to) continue;
        double slope = a.y == b.y ? 0 : (b.x - a.x) / (b.y - a.y);
        double first = a.x + (from - a.y) * slope, last = a.x + (to - a.y) * slope;
        if (a.y == b.y) last = b.x;
        low = fmin(low, fmin(first, last));
        high = fmax(high, fmax(first, last));
    }
    if (!(low <= high)) return;
    int begin = (int)fmax(floor(low - reach), 0), end = (int)fmin(high + reach, width - 1);
    for (int x = begin; x <= end; x++)
        if (row[x] < level) row[x] = level;
}

/* The logarithm of how many equal intervals of a pixel there must be for one of them to lie
 * within so much of it. */
static double intervals(double width) { return fmax(ceil(log2(2 / fmax(width, 0x1p-10))), 0); }

/* As many samples as have one in each such strip of the pixel; or, where the thing is no longer
 * than a pixel either, in each such box within what is round. */
static uint8_t level_of(double width, double across, double down) {
    const double round = 0.70710678118654752;
    double level = intervals(width);
    if (across < 1 && down < 1) level = intervals(round * across) + intervals(round * down);
    return (uint8_t)fmin(fmax(level, LEAST_LOW), LEAST_HIGH);
}

static void mark_piece(uint8_t *least, const zt_thin *thin, const vec3 *corners, double near,
                       double thickness, int reach) {
    point points[CLIPPED], hull[CLIPPED + 1];
    int count = clip(points, thin, corners, near);
    if (count < 1) return;
    count = make_hull(hull, points, count);
    double width = least_width(hull, count), far = near, room = reach + 0.5;
    for (int i = 0; i < CORNERS; i++) far = fmax(far, corners[i].z);
    width = fmin(width, thickness / (thin->is_flat ? thin->step : thin->step * far));
    if (!(width < thin_px)) return;
    double top = INFINITY, bottom = -INFINITY, left = INFINITY, right = -INFINITY;
    for (int i = 0; i < count; i++) {
        top = fmin(top, hull[i].y);
        bottom = fmax(bottom, hull[i].y);
        left = fmin(left, hull[i].x);
        right = fmax(right, hull[i].x);
    }
    uint8_t level = level_of(width, right - left, bottom - top);
    int first = (int)fmax(floor(top - room), 0);
    int last = (int)fmin(bottom + room, thin->height - 1);
    for (int y = first; y <= last; y++)
        mark_row(least + (size_t)y * (size_t)thin->width, thin->width, hull, count, y - room,
                 y + 1 + room, room, level);
}

/* Cuts a prism, whose corners are the camera's, until both ends are about as far away. */
static void mark_prism(uint8_t *least, const zt_thin *thin, const prism *p, int cuts,
                       int reach) {
    double ends[2] = {0, 0}, farthest = -INFINITY, size = 0;
    for (int i = 0; i < CORNERS; i++) {
        ends[i / 4] += p->corners[i].z / 4;
        farthest = fmax(farthest, p->corners[i].z);
        size = fmax(size, vec3_max_abs(p->corners[i]));
    }
    double near = size * 0x1p-20;
    if (!(farthest > near)) return;
    bool is_even = fmax(ends[0], ends[1]) <= depth_ratio * fmin(ends[0], ends[1]);
    if (thin->is_flat || cuts == CUTS || is_even) {
        mark_piece(least, thin, p->corners, near, p->thickness, reach);
        return;
    }
    prism halves[2] = {*p, *p};
    for (int i = 0; i < 4; i++)
        halves[0].corners[4 + i] = halves[1].corners[i] =
            vec3_scale(vec3_add(p->corners[i], p->corners[4 + i]), 0.5);
    mark_prism(least, thin, &halves[0], cuts + 1, reach);
    mark_prism(least, thin, &halves[1], cuts + 1, reach);
}

void zt_thin_mark(uint8_t *least, const zt_thin *thin, int reach) {
    for (int32_t i = 0; !thin->is_round && i < thin->scene->object_count; i++) {
        const xform *world = &thin->worlds[i];
        prism p;
        if (!hold(&p, &thin->scene->objects[i], thin->scene->meshes)) continue;
        bool finite = true;
        for (int k = 0; k < CORNERS; k++) {
            p.corners[k] = seen_at(thin, xform_point(world, p.corners[k]));
            finite &= isfinite(vec3_max_abs(p.corners[k]));
        }
        /* Of a group that stretches, the way it does so least. */
        p.thickness *=
            fmin(fmin(vec3_length(world->x), vec3_length(world->y)), vec3_length(world->z));
        if (finite) mark_prism(least, thin, &p, 0, reach);
    }
}
