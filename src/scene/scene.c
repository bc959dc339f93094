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

double zt_light_reach(const zt_light *light) {
    switch (light->kind) {
    case ZT_LIGHT_POINT:
    case ZT_LIGHT_DISK:
        return light->radius;
    case ZT_LIGHT_RECTANGLE:
        return hypot(light->width, light->height) / 2;
    default:
        return 0;
    }
}
