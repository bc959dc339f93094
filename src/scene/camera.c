/* What a camera's numbers amount to, however they are given. */
#include "scene/scene.h"

#include <string.h>

/* Nothing that follows from them is larger: what is added up stays a number. */
#define LARGEST 1e100

/* A focal length gives no wider nor narrower view than fov may. */
static const double tangent_min = 8.7e-9, tangent_max = 1146;

/* A lens focuses no nearer than this share of its opening. */
#define NEAREST 1e-6

/* Any unit vector across `v`, chosen by the smallest component so that it never degenerates. */
static vec3 some_normal(vec3 v) {
    double x = fabs(v.x), y = fabs(v.y), z = fabs(v.z);
    vec3 axis = x <= y && x <= z ? (vec3){1, 0, 0} : y <= z ? (vec3){0, 1, 0} : (vec3){0, 0, 1};
    return vec3_normalize(vec3_cross(axis, v));
}

/* The axes of a camera that is aimed. */
static xform aim(const zt_camera *camera) {
    vec3 back = vec3_normalize(vec3_sub(camera->position, camera->look_at));
    if (vec3_max_abs(back) == 0) back = (vec3){0, 0, 1}; /* looking at itself: straight on */
    vec3 right = vec3_cross(vec3_normalize(camera->up), back);
    /* Looking along its own up vector leaves the roll open. */
    right = vec3_max_abs(right) < 1e-12 ? some_normal(back) : vec3_normalize(right);
    return (xform){right, vec3_cross(back, right), back, camera->position};
}

xform zt_camera_xform(const zt_camera *camera) {
    xform m = camera->aimed ? aim(camera)
                            : xform_place(camera->position, camera->rotation, (vec3){1, 1, 1});
    if (camera->roll == 0) return m;
    double c = cos(camera->roll), s = sin(camera->roll);
    vec3 right = vec3_add(vec3_scale(m.x, c), vec3_scale(m.y, s));
    m.y = vec3_sub(vec3_scale(m.y, c), vec3_scale(m.x, s));
    m.x = right;
    return m;
}

double zt_camera_half_height(const zt_camera *camera) {
    if (camera->lens == ZT_LENS_ORTHOGRAPHIC) return fmin(camera->height, LARGEST) / 2;
    if (!(camera->focal_length > 0)) return tan(camera->fov / 2);
    double tangent = camera->sensor_height / 2 / camera->focal_length;
    return fmin(fmax(tangent, tangent_min), tangent_max);
}

double zt_camera_focal_length(const zt_camera *camera) {
    return camera->sensor_height / (2 * zt_camera_half_height(camera));
}

double zt_camera_opening(const zt_camera *camera) {
    if (camera->lens == ZT_LENS_EQUIRECTANGULAR) return 0;
    if (camera->lens == ZT_LENS_ORTHOGRAPHIC || !(camera->f_number > 0))
        return fmin(camera->aperture, LARGEST);
    const double metre = 1000; /* millimetres */
    return fmin(zt_camera_focal_length(camera) / metre / (2 * camera->f_number), LARGEST);
}

double zt_camera_depth(const zt_camera *camera, vec3 point) {
    /* Quarters first: the difference could be too large. */
    vec3 way = vec3_sub(vec3_scale(camera->position, 0.25), vec3_scale(point, 0.25));
    return 4 * vec3_dot(way, zt_camera_xform(camera).z);
}

double zt_camera_focus(const zt_camera *camera) {
    double distance =
        camera->focused ? zt_camera_depth(camera, camera->focus_on) : camera->focus_distance;
    return fmax(distance, NEAREST * zt_camera_opening(camera));
}

zt_projection zt_camera_projection(const zt_camera *camera, vec3 origin, double aspect) {
    xform axes = zt_camera_xform(camera);
    axes.z = vec3_scale(axes.z, -1);
    axes.shift = vec3_sub(axes.shift, origin);
    double high = 2 * zt_camera_half_height(camera);
    return (zt_projection){camera->lens, xform_inverse(&axes), high * aspect, high};
}

bool zt_project(double *x, double *y, const zt_projection *projection, vec3 point) {
    const double pi = 3.14159265358979323846;
    vec3 p = xform_point(&projection->camera, point);
    if (projection->lens == ZT_LENS_EQUIRECTANGULAR) {
        *x = 0.5 + atan2(p.x, p.z) / (2 * pi);
        *y = 0.5 - atan2(p.y, hypot(p.x, p.z)) / pi;
        return vec3_max_abs(p) > 0;
    }
    double depth = projection->lens == ZT_LENS_PERSPECTIVE ? p.z : 1;
    *x = 0.5 + p.x / (depth * projection->wide);
    *y = 0.5 - p.y / (depth * projection->high);
    return p.z > 0 && isfinite(*x) && isfinite(*y);
}

void zt_camera_matrices(double to_camera[16], double to_picture[16], const zt_camera *camera,
                        double aspect) {
    zt_projection p = zt_camera_projection(camera, (vec3){0, 0, 0}, aspect);
    const vec3 rows[4] = {p.camera.x, p.camera.y, p.camera.z, p.camera.shift};
    bool around = p.lens == ZT_LENS_EQUIRECTANGULAR, flat = p.lens == ZT_LENS_ORTHOGRAPHIC;
    memset(to_picture, 0, 16 * sizeof *to_picture);
    for (int i = 0; i < 4; i++) {
        const vec3 r = rows[i];
        const double one = i == 3, w = flat ? one : r.z;
        const double own[4] = {r.x, r.y, r.z, one},
                     seen[4] = {w / 2 + r.x / p.wide, w / 2 - r.y / p.high, flat ? r.z : one,
                                w};
        memcpy(to_camera + 4 * i, own, sizeof own);
        if (!around) memcpy(to_picture + 4 * i, seen, sizeof seen);
    }
}
