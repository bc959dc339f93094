/* Exposures made ready for a test's own rays, without a lens and a film. */
#ifndef ZT_TESTS_TRACING_H
#define ZT_TESTS_TRACING_H

#include "rendering.h"
#include "stage.h"

/* cmocka's own takes floats. */
#define assert_near(a, b, room) near_or_fail((double)(a), (double)(b), (double)(room), __LINE__)
static inline void near_or_fail(double a, double b, double room, int line) {
    if (fabs(a - b) <= room) return;
    print_error("line %d: %.17g is not %.17g within %g\n", line, a, b, room);
    fail();
}

/* In the precision that is tested. */
static inline void open_stage(stage *st, const zt_exposure *exposure) {
    open_stage_of(st, exposure, precision, zt_lens_pixel(&exposure->moments->camera, 100));
}

static inline zt_light *scene_disk_light(test_scene *s, vec3 position, double radius) {
    zt_light *light = scene_point_light(s, position, 1);
    light->kind = ZT_LIGHT_DISK;
    light->radius = radius;
    light->rotation = quat_axis_angle((vec3){1, 0, 0}, -1.57079632679489661923); /* down */
    return light;
}

static inline zt_light *scene_rectangle_light(test_scene *s, vec3 position, double width,
                                              double height) {
    zt_light *light = scene_disk_light(s, position, 0);
    light->kind = ZT_LIGHT_RECTANGLE;
    light->width = width;
    light->height = height;
    return light;
}

/* A floor, seen from above through (x, 0, z). */
static inline void begin_floor(test_scene *s) {
    scene_begin(s);
    scene_material(s, white, 0);
    scene_plane(s, (vec3){0, 1, 0}, 0, 0);
}

/* All of the following hold in either precision. */
#define EACH_PRECISION                                                                         \
    for (precision = ZT_PRECISION_SINGLE; precision <= ZT_PRECISION_DOUBLE; precision++)

#endif
