#include "sequence/marks.h"

#include <math.h>

#include "render/lens.h"

/* The numbers of a pattern reach far: what a cell's size is off adds up from cell to cell. */
#define PATTERN_SIZE_SHARE  (1.0 / 8192)
#define PATTERN_ANGLE_SHARE (1.0 / 2048)

/* ---- points ---------------------------------------------------------------------------------
 */

/* The corners of the block from center - x - y - z to center + x + y + z. */
static vec3 *put_corners(vec3 *out, const xform *block) {
    for (int i = 0; i < 8; i++) {
        vec3 p = block->shift;
        p = vec3_add(p, vec3_scale(block->x, i & 1 ? 1 : -1));
        p = vec3_add(p, vec3_scale(block->y, i & 2 ? 1 : -1));
        *out++ = vec3_add(p, vec3_scale(block->z, i & 4 ? 1 : -1));
    }
    return out;
}

/* Those of the block around a ball in an object's own space. */
static vec3 *put_ball(vec3 *out, const xform *world, vec3 center, double radius) {
    xform block = {vec3_scale(world->x, radius), vec3_scale(world->y, radius),
                   vec3_scale(world->z, radius), xform_point(world, center)};
    return put_corners(out, &block);
}

static vec3 *put_axis(vec3 *out, const xform *world, vec3 center, vec3 axis, double length) {
    vec3 tip = vec3_add(center, vec3_scale(vec3_normalize(axis), length));
    *out++ = xform_point(world, tip);
    return out;
}

static vec3 *put_tube(vec3 *out, const zt_object *object, const xform *world) {
    const zt_tube *tube = &object->tube;
    bool cone = object->shape == ZT_SHAPE_CONE;
    out = put_ball(out, world, tube->from, tube->radius);
    return put_ball(out, world, tube->to, cone ? tube->end_radius : tube->radius);
}

static vec3 *put_torus(vec3 *out, const zt_torus *torus, const xform *world) {
    double reach = torus->radius + torus->tube_radius;
    out = put_ball(out, world, torus->center, reach);
    out = put_axis(out, world, torus->center, torus->axis, reach);
    return put_axis(out, world, torus->center, (vec3){1, 0, 0}, torus->tube_radius);
}

static vec3 *put_mesh(vec3 *out, const zt_object *object, const xform *world,
                      const zt_mesh *mesh) {
    const zt_placement *p = &object->placement;
    xform own = xform_place(p->position, p->rotation, p->scale);
    xform place = xform_mul(world, &own);
    vec3 half = vec3_scale(vec3_sub(mesh->high, mesh->low), 0.5);
    xform block = {vec3_scale(place.x, half.x), vec3_scale(place.y, half.y),
                   vec3_scale(place.z, half.z), xform_point(&place, vec3_add(mesh->low, half))};
    return put_corners(out, &block);
}

int zt_marks_of_object(vec3 *marks, const zt_object *object, const xform *world,
                       const zt_mesh *meshes) {
    vec3 *out = marks;
    xform place;
    switch (object->shape) {
    case ZT_SHAPE_SPHERE:
        out = put_ball(out, world, object->sphere.center, object->sphere.radius);
        break;
    case ZT_SHAPE_TRIANGLE:
        for (int i = 0; i < 3; i++) *out++ = xform_point(world, object->triangle.vertices[i]);
        break;
    case ZT_SHAPE_DISK:
        out = put_ball(out, world, object->disk.center, object->disk.radius);
        out =
            put_axis(out, world, object->disk.center, object->disk.normal, object->disk.radius);
        break;
    case ZT_SHAPE_BOX:
        place = xform_place(object->box.center, object->box.rotation,
                            vec3_scale(object->box.size, 0.5));
        place = xform_mul(world, &place);
        out = put_corners(out, &place);
        break;
    case ZT_SHAPE_CYLINDER:
    case ZT_SHAPE_CONE:
    case ZT_SHAPE_CAPSULE:
        out = put_tube(out, object, world);
        break;
    case ZT_SHAPE_TORUS:
        out = put_torus(out, &object->torus, world);
        break;
    case ZT_SHAPE_MESH:
        out = put_mesh(out, object, world, &meshes[object->mesh]);
        break;
    case ZT_SHAPE_PLANE:
    case ZT_SHAPE_GROUP:
    case ZT_SHAPE_COUNT:
        break;
    }
    return (int)(out - marks);
}

double zt_marks_ball(vec3 *center, const vec3 *points, int count) {
    vec3 sum = {0, 0, 0};
    for (int i = 0; i < count; i++) sum = vec3_add(sum, vec3_scale(points[i], 1.0 / count));
    double most = 0;
    for (int i = 0; i < count; i++) {
        vec3 way = vec3_sub(points[i], sum);
        double square = vec3_dot(way, way);
        if (square > most) most = square;
    }
    *center = sum;
    return sqrt(most);
}

double zt_marks_plane(vec3 *normal, const zt_plane *plane, const xform *world) {
    vec3 across = xform_normal(world, vec3_normalize(plane->normal));
    *normal = vec3_normalize(across);
    return plane->distance * fabs(xform_determinant(world)) / vec3_length(across) +
           vec3_dot(*normal, world->shift);
}

/* ---- what a glance allows -------------------------------------------------------------------
 */

/* The eye and the width of pixels of a look, which its places are measured by. */
typedef struct sight {
    const zt_chords *chords;
    const zt_scene *scene;
    zt_pixel pixel;
    vec3 eye; /* relative to the origin */
    xform axes;
} sight;

/* As much of a pixel as things may be off, so far away. */
static double pixels_at(const sight *s, double distance) {
    return s->chords->error * (s->pixel.width + s->pixel.angle * distance);
}

static double mark_object(vec3 *marks, const zt_part *part, const sight *s) {
    const zt_object *object = &s->scene->objects[part->index];
    const xform *world = &s->chords->worlds[part->index];
    if (object->shape == ZT_SHAPE_PLANE) {
        vec3 normal;
        double distance = zt_marks_plane(&normal, &object->plane, world);
        marks[0] = vec3_scale(normal, distance);
        marks[1] = vec3_scale(normal, part->reach);
        xform block = part->anchor ? xform_mul(world, part->anchor) : xform_identity();
        if (part->anchor) put_corners(marks + 2, &block);
        double away = fabs(distance - vec3_dot(normal, s->eye));
        return pixels_at(s, fmax(away, ZT_MARK_NEAREST * part->reach));
    }
    vec3 center;
    int count = zt_marks_of_object(marks, object, world, s->scene->meshes);
    double radius = zt_marks_ball(&center, marks, count);
    double distance = vec3_length(vec3_sub(center, s->eye));
    double allowed = pixels_at(s, fmax(distance - radius, ZT_MARK_NEAREST * radius));
    return fmax(allowed, ZT_MARK_ROUNDINGS * (distance + radius));
}

static double mark_lamp(vec3 *marks, const zt_part *part, const sight *s) {
    const zt_light *light = &s->scene->lights[part->index];
    vec3 size = {light->radius, light->radius, light->radius};
    bool rectangle = light->kind == ZT_LIGHT_RECTANGLE;
    if (rectangle)
        size =
            (vec3){light->width / 2, light->height / 2, fmax(light->width, light->height) / 2};
    vec3 place = vec3_sub(light->position, s->chords->origin);
    bool turns = rectangle || light->kind == ZT_LIGHT_DISK;
    xform block = xform_place(place, turns ? light->rotation : quat_identity(), size);
    put_corners(marks, &block);
    double distance = vec3_length(vec3_sub(place, s->eye));
    return fmax(pixels_at(s, fmax(distance, s->chords->near)), ZT_MARK_ROUNDINGS * distance);
}

static double largest_of(vec3 v, double share) { return vec3_max_abs(v) * share; }

static double mark_value(vec3 *marks, const zt_part *part, const sight *s) {
    double v[ZT_VALUE_WIDTH_MAX] = {0};
    zt_property_get(v, part->property, s->scene, part->index);
    *marks = (vec3){v[0], v[1], v[2]};
    if (part->property->kind == ZT_VALUE_COLOR) return largest_of(*marks, ZT_CHORD_SHARE);
    if (part->property->flags & ZT_PROPERTY_DIRECTION) {
        *marks = vec3_normalize(*marks);
        return PATTERN_ANGLE_SHARE;
    }
    bool size = part->property->offset == offsetof(zt_material, pattern_size) &&
                part->property->owner == ZT_OWNER_MATERIAL;
    return size ? largest_of(*marks, PATTERN_SIZE_SHARE) : ZT_CHORD_SHARE;
}

/* The rays through the picture's corners, as the lens makes them (render/lens.c). */
static double mark_view(vec3 *marks, const sight *s) {
    const zt_camera *camera = &s->scene->camera;
    const xform *axes = &s->axes;
    if (camera->lens == ZT_LENS_EQUIRECTANGULAR) {
        marks[0] = axes->x, marks[1] = axes->y, marks[2] = marks[3] = marks[4] = axes->z;
        return s->chords->error * s->pixel.angle;
    }
    double half = zt_camera_half_height(camera);
    vec3 right = vec3_scale(axes->x, half * s->chords->aspect), up = vec3_scale(axes->y, half);
    bool parallel = camera->lens == ZT_LENS_ORTHOGRAPHIC;
    for (int i = 0; i < 4; i++) {
        marks[i] = vec3_add(vec3_scale(right, i & 1 ? 1 : -1), vec3_scale(up, i & 2 ? 1 : -1));
        if (!parallel) marks[i] = vec3_sub(marks[i], axes->z);
    }
    marks[4] = vec3_scale(axes->z, parallel ? s->chords->far : 1);
    return s->chords->error * (parallel ? s->pixel.width : s->pixel.angle);
}

/* The aperture's two half axes; and the same as they are seen from where it is sharp, all as
 * long as they are at the nearest surface. */
static double mark_opening(vec3 *marks, const sight *s) {
    const zt_camera *camera = &s->scene->camera;
    double radius = zt_camera_opening(camera), focus = zt_camera_focus(camera);
    double c = cos(camera->blade_rotation), t = sin(camera->blade_rotation);
    bool parallel = camera->lens == ZT_LENS_ORTHOGRAPHIC;
    double seen = parallel ? s->chords->far : s->chords->near;
    for (int i = 0; i < 2; i++) {
        vec3 axis =
            vec3_add(vec3_scale(s->axes.x, i ? -t : c), vec3_scale(s->axes.y, i ? c : t));
        marks[i] = vec3_scale(axis, radius);
        marks[i + 2] = radius > 0 ? vec3_scale(axis, radius / focus * seen) : axis;
    }
    return pixels_at(s, s->chords->near);
}

static double mark_part(vec3 *marks, const zt_part *part, const sight *s) {
    const zt_light *light = &s->scene->lights[part->index];
    switch (part->kind) {
    case ZT_PART_OBJECT:
        return mark_object(marks, part, s);
    case ZT_PART_LAMP:
        return mark_lamp(marks, part, s);
    case ZT_PART_POWER:
        *marks = vec3_scale(light->color, light->intensity);
        return largest_of(*marks, ZT_CHORD_SHARE);
    case ZT_PART_VALUE:
        return mark_value(marks, part, s);
    case ZT_PART_EYE:
        *marks = s->eye;
        return fmax(pixels_at(s, s->chords->near), ZT_MARK_ROUNDINGS * vec3_max_abs(s->eye));
    case ZT_PART_VIEW:
        return mark_view(marks, s);
    case ZT_PART_OPENING:
        return mark_opening(marks, s);
    }
    return 0;
}

void zt_marks_make(zt_glance *glance, const zt_chords *chords) {
    const zt_scene *scene = &glance->scene;
    sight s = {chords, scene, zt_lens_pixel(&scene->camera, chords->height),
               vec3_sub(scene->camera.position, chords->origin),
               zt_camera_xform(&scene->camera)};
    zt_scene_worlds(chords->worlds, scene, chords->origin);
    for (int32_t i = 0; i < chords->part_count; i++) {
        zt_part *part = &chords->parts[i];
        glance->allowed[i] = mark_part(glance->marks + part->first, part, &s);
        part->most_allowed = fmax(part->most_allowed, glance->allowed[i]);
    }
}
