/* Random scenes of all kinds of things, lamps and lenses, of which random parts change from
 * frame to frame. cmocka.h comes first. */
#ifndef ZT_TESTS_RANDOM_SCENES_H
#define ZT_TESTS_RANDOM_SCENES_H

#include <string.h>

#include "draw.h"
#include "scenes.h"

enum { MATERIALS = 6, MESHES = 2, GROUPS = 3 };

static inline vec3 draw_vec(draw *d, double reach) {
    return (vec3){draw_between(d, -reach, reach), draw_between(d, -reach, reach),
                  draw_between(d, -reach, reach)};
}

/* Somewhere before the camera, seldom beside or behind it. */
static inline vec3 draw_place(draw *d) {
    if (draw_below(d, 6) == 0) return draw_vec(d, 8);
    return (vec3){draw_between(d, -4, 4), draw_between(d, -2, 2.5), draw_between(d, -9, -3)};
}

static inline vec3 draw_color(draw *d) {
    return (vec3){draw_unit(d), draw_unit(d), draw_unit(d)};
}

static inline zt_material draw_material(draw *d) {
    zt_material m = {.color = draw_color(d), .other_color = draw_color(d), .pattern_size = 1};
    if (draw_below(d, 3) == 0) m.reflectivity = draw_unit(d);
    if (draw_below(d, 4) == 0) m.pattern = draw_below(d, ZT_PATTERN_STRIPES + 1);
    m.pattern_size = draw_between(d, 0.1, 1);
    m.pattern_direction = draw_vec(d, 1);
    return m;
}

/* Gives an object its numbers; some are degenerate: nothing is there. */
static inline void draw_shape(draw *d, zt_object *o, double size) {
    double r = draw_below(d, 12) == 0 ? 0 : size * draw_between(d, 0.2, 1);
    vec3 at = draw_place(d), way = draw_vec(d, 1);
    switch (o->shape) {
    case ZT_SHAPE_PLANE:
        o->plane = (zt_plane){{0, 1, 0}, draw_between(d, -3, -1)};
        break;
    case ZT_SHAPE_SPHERE:
        o->sphere = (zt_sphere){at, r};
        break;
    case ZT_SHAPE_TRIANGLE:
        for (int i = 0; i < 3; i++) o->triangle.vertices[i] = vec3_add(at, draw_vec(d, 2 * r));
        break;
    case ZT_SHAPE_DISK:
        o->disk = (zt_disk){at, way, r};
        break;
    case ZT_SHAPE_BOX:
        o->box = (zt_block){at, {r, 2 * r, r}, draw_rotation(d)};
        if (draw_below(d, 2)) o->box.rotation = (quat){1, 0, 0, 0};
        break;
    case ZT_SHAPE_CYLINDER:
    case ZT_SHAPE_CONE:
    case ZT_SHAPE_CAPSULE:
        o->tube = (zt_tube){at, vec3_add(at, vec3_scale(way, size)), r / 2, r / 4};
        break;
    case ZT_SHAPE_TORUS:
        o->torus = (zt_torus){at, way, r, r / 3};
        break;
    default:
        o->placement = (zt_placement){at, draw_rotation(d), {r, r, r}};
        if (draw_below(d, 3) == 0) o->placement.scale.y = 2 * r;
    }
}

static inline void draw_object(draw *d, test_scene *s, double size) {
    zt_shape shape = draw_below(d, ZT_SHAPE_GROUP);
    if (shape == ZT_SHAPE_PLANE && draw_below(d, 3)) shape = ZT_SHAPE_BOX;
    zt_object *o = scene_object(s, shape, draw_below(d, MATERIALS));
    if (shape == ZT_SHAPE_MESH) {
        o->mesh = draw_below(d, MESHES);
        o->smooth = draw_below(d, 2);
    }
    draw_shape(d, o, size);
    if (draw_below(d, 4) == 0) o->parent = draw_below(d, GROUPS);
    if (shape == ZT_SHAPE_PLANE) o->parent = -1;
    if (s->scene.object_count < 12 || draw_below(d, 10)) return;
    /* Once more, so that their faces lie on each other. */
    zt_object *twin = scene_object(s, shape, draw_below(d, MATERIALS));
    int32_t material = twin->material;
    *twin = *o;
    twin->material = material;
}

static inline void draw_light(draw *d, zt_light *l) {
    static const zt_light_kind kinds[] = {ZT_LIGHT_POINT,    ZT_LIGHT_POINT, ZT_LIGHT_POINT,
                                          ZT_LIGHT_POINT,    ZT_LIGHT_POINT, ZT_LIGHT_DISK,
                                          ZT_LIGHT_RECTANGLE};
    *l = (zt_light){
        .kind = kinds[draw_below(d, 7)],
        .color = draw_color(d),
        .intensity = draw_between(d, 1, 12),
        .position = {draw_between(d, -5, 5), draw_between(d, 0, 5), draw_between(d, -9, 3)},
        .shadows = draw_below(d, 5) > 0,
        .rotation = draw_rotation(d),
        .width = 1,
        .height = 0.5};
    if (l->kind == ZT_LIGHT_DISK || (l->kind == ZT_LIGHT_POINT && draw_below(d, 12) == 0))
        l->radius = 0.4;
}

static inline void draw_scene(draw *d, test_scene *s, const zt_mesh *meshes) {
    scene_begin(s);
    s->scene.meshes = meshes;
    s->scene.mesh_count = MESHES;
    zt_camera *c = &s->scene.camera;
    for (int i = 0; i < MATERIALS; i++) {
        scene_material(s, (vec3){1, 1, 1}, 0);
        s->materials[i] = draw_material(d);
    }
    for (int i = 0; i < GROUPS; i++) {
        zt_object *group = scene_object(s, ZT_SHAPE_GROUP, -1);
        group->placement.position = draw_vec(d, 0.5);
        if (i > 0 && draw_below(d, 2)) group->parent = i - 1;
        if (draw_below(d, 3) == 0) group->placement.scale = (vec3){1, 1.5, 0.7};
    }
    int count = draw_below(d, 3) ? 2 + draw_below(d, 10) : 36 + draw_below(d, 30);
    scene_plane(s, (vec3){0, 1, 0}, -2, draw_below(d, MATERIALS));
    for (int i = 0; i < count; i++) draw_object(d, s, count > 20 ? 0.5 : 1.2);
    scene_ambient(s, draw_color(d), 0.2);
    for (int i = draw_below(d, 4); i >= 0; i--)
        draw_light(d, scene_point_light(s, (vec3){1, 1, 1}, 1));
    s->scene.reflection_depth = draw_below(d, 6);
    if (draw_below(d, 5) == 0) c->lens = ZT_LENS_EQUIRECTANGULAR;
    if (draw_below(d, 5) == 0) {
        c->lens = ZT_LENS_ORTHOGRAPHIC;
        c->height = 6;
    }
    if (draw_below(d, 25) == 0) {
        c->aperture = 0.05;
        c->focus_distance = 5;
    }
}

/* Changes one thing, as animations do. */
static inline void change(draw *d, test_scene *s) {
    zt_object *o = &s->objects[draw_below(d, s->scene.object_count)];
    zt_material *m = &s->materials[draw_below(d, MATERIALS)];
    zt_light *l = &s->lights[draw_below(d, s->scene.light_count)];
    switch (draw_below(d, 12)) {
    case 0:
        m->color = draw_color(d);
        break;
    case 1:
        m->reflectivity = draw_below(d, 2) ? 0 : draw_unit(d);
        break;
    case 2:
        *m = draw_material(d);
        break;
    case 3:
        l->color = draw_color(d);
        break;
    case 4:
        l->intensity = draw_below(d, 2) ? 0 : draw_between(d, 1, 12);
        break;
    case 5:
        l->position = draw_vec(d, 4);
        break;
    case 6:
        if (draw_below(d, 4) == 0) s->scene.camera.position.x += 0.1;
        break;
    default:
        if (o->shape == ZT_SHAPE_GROUP)
            o->placement.position = vec3_add(o->placement.position, draw_vec(d, 0.3));
        else if (o->shape != ZT_SHAPE_PLANE)
            draw_shape(d, o, draw_between(d, 0.1, 0.8));
        else
            o->plane.distance -= 0.1;
    }
}

/* Changes what there is: something comes, goes, or stands elsewhere in the order. Groups, which
 * others are in, stay. */
static inline void edit(draw *d, test_scene *s) {
    int32_t count = s->scene.object_count, lights = s->scene.light_count;
    int32_t at = GROUPS + draw_below(d, count - GROUPS),
            other = GROUPS + draw_below(d, count - GROUPS);
    zt_object *o = s->objects;
    zt_light *l = s->lights;
    switch (draw_below(d, 8)) {
    case 0:
    case 1:
        draw_object(d, s, 0.8);
        zt_object last = o[s->scene.object_count - 1];
        memmove(o + at + 1, o + at, (size_t)(s->scene.object_count - 1 - at) * sizeof *o);
        o[at] = last;
        break;
    case 2:
        memmove(o + at, o + at + 1, (size_t)(count - 1 - at) * sizeof *o);
        s->scene.object_count--;
        break;
    case 3:
        last = o[at];
        o[at] = o[other];
        o[other] = last;
        break;
    case 4:
        draw_light(d, scene_point_light(s, (vec3){1, 1, 1}, 1));
        break;
    case 5:
        at = draw_below(d, lights);
        memmove(l + at, l + at + 1, (size_t)(lights - 1 - at) * sizeof *l);
        s->scene.light_count--;
        break;
    default:
        change(d, s);
    }
    if (s->scene.light_count == 0) scene_point_light(s, (vec3){2, 4, 1}, 9);
    if (s->scene.object_count <= GROUPS) scene_sphere(s, (vec3){0, 0, -5}, 1, 0);
}

/* Frame number `frame` of a scene: what changes in it, always the same; two moments of it
 * where the shutter is open. */
static inline void frame_of(test_scene moments[2], const test_scene *base, uint64_t key,
                            int frame) {
    draw d = {key, 1000 * (uint64_t)frame};
    for (int i = 0; i < 2; i++) {
        moments[i] = *base;
        moments[i].scene.objects = moments[i].objects;
        moments[i].scene.lights = moments[i].lights;
        moments[i].scene.materials = moments[i].materials;
    }
    int count = frame == 0 ? 0 : 1 + draw_below(&d, 2);
    for (int k = 0; k < count; k++) {
        draw both = d;
        change(&both, &moments[0]);
        if (draw_below(&d, 2)) change(&d, &moments[1]);
        d.number = both.number + 500;
    }
}

#endif
