#include "stage.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

static void *push(stage *s, size_t size) {
    void *memory = zt_arena_push(&s->arena, size);
    if (!memory) {
        fputs("out of memory\n", stderr);
        abort();
    }
    return memory;
}

void stage_begin(stage *s, int ray_limit) {
    scene_begin(&s->s);
    scene_material(&s->s, (vec3){.5, .5, .5}, .5);
    s->s.scene.meshes = s->meshes;
    zt_arena_reset(&s->arena);
    s->ray_count = 0;
    s->ray_limit = ray_limit < STAGE_RAYS_MAX ? ray_limit : STAGE_RAYS_MAX;
}

void stage_ray(stage *s, vec3 origin, vec3 direction) {
    vec3 unit = vec3_normalize(direction);
    if (s->ray_count >= s->ray_limit || vec3_max_abs(unit) == 0) return;
    s->origins[s->ray_count] = vec3_sub(origin, s->s.scene.camera.position);
    s->directions[s->ray_count++] = unit;
}
void stage_aim(stage *s, vec3 origin, vec3 target) {
    stage_ray(s, origin, vec3_sub(target, origin));
}

vec3 stage_direction(draw *d) { return vec3_normalize(stage_within(d, 1)); }

vec3 stage_within(draw *d, double radius) {
    for (;;) {
        vec3 v = {draw_between(d, -1, 1), draw_between(d, -1, 1), draw_between(d, -1, 1)};
        double square = vec3_dot(v, v);
        if (square < 1 && square > 1e-6) return vec3_scale(v, radius);
    }
}

vec3 stage_across(draw *d, vec3 direction) {
    for (;;) {
        vec3 across = vec3_cross(direction, stage_direction(d));
        if (vec3_length(across) > 0.1 * vec3_length(direction)) return vec3_normalize(across);
    }
}

double stage_sign(draw *d) { return draw_below(d, 2) ? 1 : -1; }

zt_object *stage_object(stage *s, draw *d, zt_shape shape, vec3 center, double size,
                        double thin) {
    zt_object *object = scene_object(&s->s, shape, 0);
    vec3 axis = stage_direction(d);
    double part = draw_magnitude(d, thin, 1) * size, other = draw_magnitude(d, thin, 1) * size;
    switch (shape) {
    case ZT_SHAPE_PLANE:
        object->plane = (zt_plane){axis, vec3_dot(axis, center)};
        break;
    case ZT_SHAPE_SPHERE:
        object->sphere = (zt_sphere){center, size};
        break;
    case ZT_SHAPE_TRIANGLE:
        for (int i = 0; i < 3; i++)
            object->triangle.vertices[i] = vec3_add(center, stage_within(d, size));
        break;
    case ZT_SHAPE_DISK:
        object->disk = (zt_disk){center, axis, size};
        break;
    case ZT_SHAPE_BOX:
        object->box = (zt_block){center, {size, part, other}, draw_rotation(d)};
        break;
    case ZT_SHAPE_CYLINDER:
    case ZT_SHAPE_CAPSULE:
    case ZT_SHAPE_CONE: {
        vec3 half = vec3_scale(axis, size / 2);
        double end = draw_below(d, 2) ? 0 : other;
        object->tube = (zt_tube){vec3_sub(center, half), vec3_add(center, half), part, end};
        break;
    }
    case ZT_SHAPE_TORUS:
        object->torus = (zt_torus){center, axis, size, part};
        break;
    default:
        break;
    }
    return object;
}

int32_t stage_group(stage *s, int32_t parent, vec3 position, quat rotation, vec3 scale) {
    zt_object *group = scene_object(&s->s, ZT_SHAPE_GROUP, -1);
    group->parent = parent;
    group->placement = (zt_placement){position, rotation, scale};
    return s->s.scene.object_count - 1;
}

int32_t stage_mesh(stage *s, const vec3 *positions, int vertex_count, const uint32_t *triangles,
                   int triangle_count) {
    float *numbers = push(s, sizeof *numbers * (3 * (size_t)vertex_count + 1));
    uint32_t *corners = push(s, sizeof *corners * 3 * (size_t)triangle_count);
    zt_mesh *mesh = &s->meshes[s->s.scene.mesh_count];
    vec3 low = {INFINITY, INFINITY, INFINITY}, high = vec3_scale(low, -1);
    for (int i = 0; i < vertex_count; i++) {
        float *p = &numbers[3 * i];
        p[0] = (float)positions[i].x;
        p[1] = (float)positions[i].y;
        p[2] = (float)positions[i].z;
        vec3 rounded = {(double)p[0], (double)p[1], (double)p[2]};
        low = vec3_min(low, rounded);
        high = vec3_max(high, rounded);
    }
    memcpy(corners, triangles, sizeof *corners * 3 * (size_t)triangle_count);
    *mesh = (zt_mesh){.positions = numbers,
                      .triangles = corners,
                      .vertex_count = vertex_count,
                      .triangle_count = triangle_count,
                      .low = low,
                      .high = high};
    return s->s.scene.mesh_count++;
}

int32_t stage_ball_mesh(stage *s, double radius, int rings, int sectors, bool normals) {
    int vertex_count = 2 + (rings - 1) * sectors, triangle_count = 2 * (rings - 1) * sectors;
    vec3 *at = push(s, sizeof *at * (size_t)vertex_count);
    uint32_t *corners = push(s, sizeof *corners * 3 * (size_t)triangle_count), *c = corners;
    at[0] = (vec3){0, radius, 0};
    at[1] = (vec3){0, -radius, 0};
    for (int r = 1; r < rings; r++)
        for (int k = 0; k < sectors; k++) {
            double a = PI * r / rings, b = 2 * PI * k / sectors;
            at[2 + (r - 1) * sectors + k] =
                (vec3){radius * sin(a) * cos(b), radius * cos(a), -radius * sin(a) * sin(b)};
        }
    for (int k = 0; k < sectors; k++) {
        uint32_t here = (uint32_t)k, next = (uint32_t)((k + 1) % sectors);
        uint32_t last = (uint32_t)(2 + (rings - 2) * sectors);
        const uint32_t caps[6] = {0, 2 + here, 2 + next, 1, last + next, last + here};
        memcpy(c, caps, sizeof caps);
        c += 6;
        for (int r = 1; r < rings - 1; r++) {
            uint32_t up = (uint32_t)(2 + (r - 1) * sectors), low = up + (uint32_t)sectors;
            const uint32_t quad[6] = {up + here, low + here, low + next,
                                      up + here, low + next, up + next};
            memcpy(c, quad, sizeof quad);
            c += 6;
        }
    }
    int32_t number = stage_mesh(s, at, vertex_count, corners, triangle_count);
    if (normals) {
        float *n = push(s, sizeof *n * 3 * (size_t)vertex_count);
        for (int i = 0; i < vertex_count; i++) {
            vec3 unit = vec3_normalize(at[i]);
            n[3 * i] = (float)unit.x;
            n[3 * i + 1] = (float)unit.y;
            n[3 * i + 2] = (float)unit.z;
        }
        s->meshes[number].normals = n;
    }
    return number;
}

zt_object *stage_mesh_object(stage *s, int32_t mesh, vec3 position) {
    zt_object *object = scene_object(&s->s, ZT_SHAPE_MESH, 0);
    object->mesh = mesh;
    object->placement.position = position;
    return object;
}
