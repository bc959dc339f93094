#include "scene/scene.h"

#include "base/bits.h"

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

/* ---- what is equal --------------------------------------------------------------------------
 */

#define EQUAL(field) zt_bits_equal(&a->field, &b->field, sizeof a->field)

bool zt_camera_equal(const zt_camera *a, const zt_camera *b) {
    return EQUAL(position) && EQUAL(look_at) && EQUAL(up) && EQUAL(rotation) && EQUAL(aimed) &&
           EQUAL(roll) && EQUAL(lens) && EQUAL(fov) && EQUAL(focal_length) &&
           EQUAL(sensor_height) && EQUAL(height) && EQUAL(aperture) && EQUAL(f_number) &&
           EQUAL(focus_distance) && EQUAL(focus_on) && EQUAL(focused) && EQUAL(blades) &&
           EQUAL(blade_rotation);
}

bool zt_material_equal(const zt_material *a, const zt_material *b) {
    return EQUAL(color) && EQUAL(reflectivity) && EQUAL(pattern) && EQUAL(other_color) &&
           EQUAL(pattern_size) && EQUAL(pattern_direction);
}

bool zt_light_equal(const zt_light *a, const zt_light *b) {
    return EQUAL(kind) && EQUAL(color) && EQUAL(intensity) && EQUAL(position) &&
           EQUAL(shadows) && EQUAL(radius) && EQUAL(rotation) && EQUAL(width) && EQUAL(height);
}

bool zt_object_equal(const zt_object *a, const zt_object *b) {
    return EQUAL(shape) && EQUAL(parent) && EQUAL(material) && EQUAL(mesh) && EQUAL(smooth) &&
           EQUAL(vertex_colors) && zt_object_stays(a, b);
}

bool zt_object_stays(const zt_object *a, const zt_object *b) {
    switch (a->shape) {
    case ZT_SHAPE_PLANE:
        return EQUAL(plane);
    case ZT_SHAPE_SPHERE:
        return EQUAL(sphere);
    case ZT_SHAPE_TRIANGLE:
        return EQUAL(triangle);
    case ZT_SHAPE_DISK:
        return EQUAL(disk);
    case ZT_SHAPE_BOX:
        return EQUAL(box);
    case ZT_SHAPE_CYLINDER:
    case ZT_SHAPE_CONE:
    case ZT_SHAPE_CAPSULE:
        return EQUAL(tube);
    case ZT_SHAPE_TORUS:
        return EQUAL(torus);
    case ZT_SHAPE_MESH:
    case ZT_SHAPE_GROUP:
        return EQUAL(placement);
    case ZT_SHAPE_COUNT:
        break;
    }
    return true;
}
