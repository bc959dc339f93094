#include "scene/scene.h"

void zt_scene_worlds(xform *worlds, const zt_scene *scene, vec3 origin) {
    xform outermost = xform_identity();
    outermost.shift = vec3_sub(outermost.shift, origin);
    for (int32_t i = 0; i < scene->object_count; i++) {
        int32_t parent = scene->objects[i].parent;
        if (parent < 0) {
            worlds[i] = outermost;
            continue;
        }
        const zt_placement *p = &scene->objects[parent].placement;
        xform own = xform_place(p->position, p->rotation, p->scale);
        worlds[i] = xform_mul(&worlds[parent], &own);
    }
}

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
