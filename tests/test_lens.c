/* Lenses: each sends a ray through a place of its picture where the closed form has it, and
 * back; cameras that move are where they are at each ray's time, but for the chord between two
 * moments; numbers of any size give rays that are numbers. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "lenses.h"
#include "real.h"
#include "tracer/kernel.h"

static const double pi = 3.14159265358979323846;

static test_lens l;

static void assert_close(vec3 a, vec3 b, double most) {
    double apart = vec3_length(vec3_sub(a, b));
    if (!(apart <= most))
        fail_msg("(%.17g %.17g %.17g) is not (%.17g %.17g %.17g): %g apart", a.x, a.y, a.z, b.x,
                 b.y, b.z, apart);
}

static void assert_same_bits(test_ray a, test_ray b) { assert_memory_equal(&a, &b, sizeof a); }

/* Somewhere, turned and rolled somehow; its lens as `kind` has it at first. */
static zt_camera some_camera(uint64_t *random, zt_lens_kind kind) {
    zt_camera camera = lens_camera(kind);
    camera.position = vec3_scale(test_direction(random), test_between(random, 0, 1000));
    camera.rotation = quat_axis_angle(test_direction(random), test_between(random, -pi, pi));
    camera.roll = test_between(random, -4, 4);
    camera.fov = test_between(random, 0.01, 3);
    camera.height = test_between(random, 0.01, 100);
    return camera;
}

/* A direction in the camera's own axes: right, up and ahead. */
static vec3 own(const zt_camera *camera, vec3 v) {
    xform m = zt_camera_xform(camera);
    return (vec3){vec3_dot(v, m.x), vec3_dot(v, m.y), -vec3_dot(v, m.z)};
}

/* ---- there and back -------------------------------------------------------------------------
 */

/* The place on the picture that a ray belongs to, by the closed form of each lens. */
static void place_of(double *x, double *y, const zt_camera *camera, test_ray ray, int width,
                     int height) {
    vec3 d = vec3_normalize(own(camera, ray.direction)), o = own(camera, ray.origin);
    if (camera->lens == ZT_LENS_EQUIRECTANGULAR) {
        *x = (atan2(d.x, d.z) / (2 * pi) + 0.5) * width;
        *y = (0.5 - asin(d.y) / pi) * height;
        return;
    }
    double half = camera->focal_length > 0 ? camera->sensor_height / (2 * camera->focal_length)
                                           : tan(camera->fov / 2);
    double right = d.x / d.z / half, up = d.y / d.z / half; /* in halves of the height */
    if (camera->lens == ZT_LENS_ORTHOGRAPHIC) {
        right = 2 * o.x / camera->height;
        up = 2 * o.y / camera->height;
    }
    *x = width / 2.0 + right * height / 2;
    *y = height / 2.0 - up * height / 2;
}

static void there_and_back(void **state) {
    (void)state;
    uint64_t random = 1;
    for (int round = 0; round < 3000; round++) {
        zt_lens_kind kind = (zt_lens_kind)(round % ZT_LENS_KIND_COUNT);
        zt_camera camera = some_camera(&random, kind);
        if (round % 2) camera.focal_length = test_between(&random, 4, 4000);
        int width = 1 + (int)test_between(&random, 0, 4000), height = 1 + width / 3;
        lens_begin(&l, &camera, NULL, 1, width, height);
        float x = (float)test_between(&random, 0, width),
              y = (float)test_between(&random, 0, height);
        test_ray ray = lens_middle(&l, (double)x, (double)y);
        double back_x, back_y;
        place_of(&back_x, &back_y, &camera, ray, width, height);
        /* The arc sine is flat at the poles, and there longitudes are close together. */
        bool pole = kind == ZT_LENS_EQUIRECTANGULAR && fabs((double)y / height - 0.5) > 0.499;
        if (!pole && !(fabs(back_x - (double)x) < 1e-8 && fabs(back_y - (double)y) < 1e-8))
            fail_msg("lens %d: (%.9g, %.9g) comes back as (%.9g, %.9g)", kind, (double)x,
                     (double)y, back_x, back_y);
        if (kind != ZT_LENS_ORTHOGRAPHIC) assert_close(ray.origin, (vec3){0, 0, 0}, 0);
        assert_false(zt_lens_moves(l.lens) || zt_lens_has_aperture(l.lens));
        lens_end(&l);
    }
}

/* By fov or by the focal length that belongs to it: fov = 2 atan(sensor / (2 focal length)). 35
 * mm film, 24 mm high, has 27.0 degrees at 50 mm and 53.1 at 24 mm. */
static void focal_length_and_fov(void **state) {
    (void)state;
    uint64_t random = 2;
    for (int round = 0; round < 1000; round++) {
        zt_camera by_fov = lens_camera(ZT_LENS_PERSPECTIVE), by_length = by_fov;
        by_length.sensor_height = test_between(&random, 1, 100);
        by_length.focal_length = exp(test_between(&random, log(0.5), log(1e4)));
        by_fov.sensor_height = by_length.sensor_height;
        by_fov.fov = 2 * atan(by_length.sensor_height / (2 * by_length.focal_length));
        by_length.fov = test_between(&random, 0.1, 3); /* which says nothing */
        double half = tan(by_fov.fov / 2);
        assert_true(fabs(zt_camera_half_height(&by_length) / half - 1) < 1e-14);
        assert_true(fabs(zt_camera_focal_length(&by_fov) / by_length.focal_length - 1) < 1e-14);
        lens_begin(&l, &by_fov, NULL, 1, 640, 360);
        vec3 wanted = lens_middle(&l, 3, 5).direction;
        lens_end(&l);
        lens_begin(&l, &by_length, NULL, 1, 640, 360);
        assert_close(lens_middle(&l, 3, 5).direction, wanted, 1e-14 * vec3_length(wanted));
        lens_end(&l);
    }
    zt_camera camera = lens_camera(ZT_LENS_PERSPECTIVE);
    camera.focal_length = 50;
    assert_true(fabs(2 * atan(zt_camera_half_height(&camera)) * 180 / pi - 26.991) < 1e-3);
    camera.focal_length = 24;
    assert_true(fabs(2 * atan(zt_camera_half_height(&camera)) * 180 / pi - 53.130) < 1e-3);
}

/* All rays of an orthographic lens run along the view, bit for bit, from a grid of squares that
 * is `height` high. */
static void orthographic(void **state) {
    (void)state;
    uint64_t random = 3;
    zt_camera camera = some_camera(&random, ZT_LENS_ORTHOGRAPHIC);
    lens_begin(&l, &camera, NULL, 1, 200, 100);
    vec3 ahead = lens_middle(&l, 0, 0).direction;
    assert_close(own(&camera, ahead), (vec3){0, 0, 1}, 1e-15);
    for (int y = 0; y <= 100; y += 10)
        for (int x = 0; x <= 200; x += 10) {
            test_ray ray = lens_middle(&l, x, y);
            assert_memory_equal(&ray.direction, &ahead, sizeof ahead);
            vec3 wanted = {(x - 100) * camera.height / 100, (50 - y) * camera.height / 100, 0};
            assert_close(own(&camera, ray.origin), wanted, 1e-12 * camera.height);
        }
    lens_end(&l);
}

/* The middle of the picture is ahead, a quarter further right is right, the upper edge is
 * straight up, in all of its width; left and right edge are the same; the pixels together, each
 * with its solid angle, are all directions once. */
static void all_around(void **state) {
    (void)state;
    enum { WIDTH = 256, HEIGHT = 100 };
    uint64_t random = 4;
    zt_camera camera = some_camera(&random, ZT_LENS_EQUIRECTANGULAR);
    lens_begin(&l, &camera, NULL, 1, WIDTH, HEIGHT);
    static const struct {
        double x, y;
        vec3 at;
    } places[] = {{0.5, 0.5, {0, 0, 1}},   {0.75, 0.5, {1, 0, 0}},  {0.25, 0.5, {-1, 0, 0}},
                  {0, 0.5, {0, 0, -1}},    {1, 0.5, {0, 0, -1}},    {0.5, 0, {0, 1, 0}},
                  {0.3, 0, {0, 1, 0}},     {0.9, 1, {0, -1, 0}},    {0.5, 0.25, {0, 1, 1}},
                  {0.625, 0.5, {1, 0, 1}}, {0.5, -0.25, {0, 1, -1}}}; /* beyond the pole */
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        test_ray ray = lens_middle(&l, places[i].x * WIDTH, places[i].y * HEIGHT);
        assert_close(own(&camera, ray.direction), vec3_normalize(places[i].at), 1e-15);
    }
    double sum = 0, cap = 0;
    vec3 mean = {0, 0, 0}, squares = {0, 0, 0}, axis = test_direction(&random);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            vec3 d = lens_middle(&l, x + 0.5, y + 0.5).direction;
            assert_true(fabs(vec3_length(d) - 1) < 1e-15);
            double top = sin(pi / 2 - y * pi / HEIGHT),
                   bottom = sin(pi / 2 - (y + 1) * pi / HEIGHT);
            double angle = 2 * pi / WIDTH * (top - bottom); /* solid, exactly */
            sum += angle;
            mean = vec3_add(mean, vec3_scale(d, angle));
            squares =
                vec3_add(squares, vec3_scale((vec3){d.x * d.x, d.y * d.y, d.z * d.z}, angle));
            if (vec3_dot(d, axis) > 0.5) cap += angle;
        }
    assert_true(fabs(sum - 4 * pi) < 1e-12);
    assert_close(mean, (vec3){0, 0, 0}, 1e-12);
    assert_close(squares, (vec3){4 * pi / 3, 4 * pi / 3, 4 * pi / 3}, 5e-3);
    assert_true(fabs(cap - pi) < 0.02); /* 2 pi (1 - cos(60 degrees)) */
    lens_end(&l);
}

/* A pixel is as wide as the lens says: the angle between two rays, or what lies between them.
 */
static void pixels(void **state) {
    (void)state;
    enum { WIDTH = 640, HEIGHT = 360 };
    uint64_t random = 5;
    for (int round = 0; round < 300; round++) {
        zt_camera camera = some_camera(&random, (zt_lens_kind)(round % ZT_LENS_KIND_COUNT));
        if (round % 2) camera.focal_length = test_between(&random, 4, 400);
        lens_begin(&l, &camera, NULL, 1, WIDTH, HEIGHT);
        zt_pixel pixel = zt_lens_pixel(&camera, HEIGHT);
        test_ray a = lens_middle(&l, WIDTH / 2.0, HEIGHT / 2.0 - 0.5),
                 b = lens_middle(&l, WIDTH / 2.0, HEIGHT / 2.0 + 0.5);
        vec3 across = vec3_cross(vec3_normalize(a.direction), vec3_normalize(b.direction));
        double angle = 2 * tan(asin(vec3_length(across)) / 2);
        assert_true(fabs(angle - pixel.angle) <= 1e-5 * pixel.angle);
        double apart = vec3_length(vec3_sub(a.origin, b.origin));
        assert_true(fabs(apart - pixel.width) <= 1e-9 * pixel.width);
        assert_true((pixel.width > 0) != (pixel.angle > 0));
        lens_end(&l);
    }
}

/* ---- cameras that move ----------------------------------------------------------------------
 */

/* A camera on a circle, turning as fast, that zooms in; t may be of any precision. */
#define TURN 0.8
#define PATH 3
static const vec3 axis = {0.48, 0.6, 0.64};

static double fov_at(double t) { return 1.1 - 0.6 * t; }

static zt_camera flying(zt_lens_kind kind, double t) {
    zt_camera camera = lens_camera(kind);
    camera.position = (vec3){1000 + PATH * cos(TURN * t), 2, PATH * sin(TURN * t)};
    camera.rotation = quat_axis_angle(axis, TURN * t);
    camera.fov = fov_at(t);
    camera.height = 2 + t;
    return camera;
}

typedef struct real3 {
    real x, y, z;
} real3;

/* The same in high precision: v turned around the axis (Rodrigues). */
static real3 turned(vec3 v, real angle) {
    real c = REAL(cos)(angle), s = REAL(sin)(angle), x = v.x, y = v.y, z = v.z;
    real kx = axis.x, ky = axis.y, kz = axis.z, along = (kx * x + ky * y + kz * z) * (1 - c);
    return (real3){x * c + (ky * z - kz * y) * s + kx * along,
                   y * c + (kz * x - kx * z) * s + ky * along,
                   z * c + (kx * y - ky * x) * s + kz * along};
}

static real3 sum3(real a, real3 x, real b, real3 y) {
    return (real3){a * x.x + b * y.x, a * x.y + b * y.y, a * x.z + b * y.z};
}

static double apart(vec3 a, real3 b) {
    real x = (real)a.x - b.x, y = (real)a.y - b.y, z = (real)a.z - b.z;
    return (double)REAL(sqrt)(x * x + y * y + z * z);
}

enum { WIDE = 160, HIGH = 90 };

/* How far a ray is from that of the camera as it stands at time t, in closed form. */
static void find_errors(double *origin, double *direction, zt_lens_kind kind, test_ray ray,
                        real x, real y, real t) {
    real angle = TURN * t, c = REAL(cos)(angle), s = REAL(sin)(angle);
    real3 right = turned((vec3){1, 0, 0}, angle), up = turned((vec3){0, 1, 0}, angle),
          ahead = turned((vec3){0, 0, -1}, angle), o = {PATH * c - PATH, 0, PATH * s};
    real3 flat = sum3((x - WIDE / 2) / (HIGH / 2), right, (HIGH / 2 - y) / (HIGH / 2), up);
    real3 d = ahead;
    if (kind == ZT_LENS_PERSPECTIVE) {
        d = sum3(1, ahead, REAL(tan)((real)fov_at((double)t) / 2), flat);
    } else if (kind == ZT_LENS_ORTHOGRAPHIC) {
        o = sum3(1, o, (2 + t) / 2, flat);
    } else {
        real lon = (x / WIDE - 0.5) * 2 * REAL_PI, lat = (0.5 - y / HIGH) * REAL_PI;
        real3 level = sum3(REAL(sin)(lon), right, REAL(cos)(lon), ahead);
        d = sum3(REAL(cos)(lat), level, REAL(sin)(lat), up);
    }
    *origin = apart(ray.origin, o);
    *direction = apart(ray.direction, d);
}

/* What a straight way may be off by within `length` of time: length^2 / 8 times the second
 * derivative, of vectors that turn, and grow as the lens zooms. */
static void find_bounds(double *origin, double *direction, zt_lens_kind kind, double x,
                        double y, double t, double length) {
    double reach = hypot((x - WIDE / 2) / (HIGH / 2), (HIGH / 2 - y) / (HIGH / 2));
    double share = length * length / 8, turn = TURN * TURN;
    *origin = share * PATH * turn;
    *direction = share * turn;
    if (kind == ZT_LENS_ORTHOGRAPHIC)
        *origin += share * reach * (turn * (2 + t + length) / 2 + 2 * TURN / 2.0);
    if (kind != ZT_LENS_PERSPECTIVE) return;
    double half = tan(fov_at(t - length) / 2), speed = 0.3 * (1 + half * half);
    *direction = share * (turn * hypot(1, half * reach) + 2 * TURN * speed * reach +
                          2 * 0.3 * speed * half * reach);
}

/* Moments that are not evenly spread. */
static int spread_moments(double *times, zt_camera *cameras, zt_lens_kind kind, int count) {
    for (int i = 0; i < count; i++) {
        double even = (double)i / (count - 1);
        times[i] = floor(4096 * even * (0.5 + even / 2)) / 4096;
        cameras[i] = flying(kind, times[i]);
    }
    return count;
}

/* Rays of a camera that moves, turns and zooms are those of the camera frozen at their times,
 * but for the chords; twice as many moments are four times as near. */
static void moving(void **state) {
    (void)state;
    uint64_t random = 6;
    static zt_camera cameras[LENS_MOMENTS_MAX];
    static double times[LENS_MOMENTS_MAX];
    for (int kind = 0; kind < ZT_LENS_KIND_COUNT; kind++) {
        double worst[2] = {0}, tight = 0;
        for (int fine = 0; fine < 2; fine++) {
            int count = spread_moments(times, cameras, (zt_lens_kind)kind, fine ? 33 : 17);
            lens_begin(&l, cameras, times, count, WIDE, HIGH);
            assert_true(zt_lens_moves(l.lens));
            for (int i = 0; i < 4000; i++) {
                float x = (float)test_between(&random, 0, WIDE),
                      y = (float)test_between(&random, 0, HIGH),
                      t = (float)test_random(&random);
                int m = 0;
                while (times[m + 1] <= (double)t) m++;
                double origin, direction, most_origin, most_direction;
                test_ray ray = lens_ray(&l, (double)x, (double)y, 0.5, 0.5, (double)t);
                find_errors(&origin, &direction, (zt_lens_kind)kind, ray, x, y, t);
                find_bounds(&most_origin, &most_direction, (zt_lens_kind)kind, (double)x,
                            (double)y, (double)t, times[m + 1] - times[m]);
                assert_true(origin <= most_origin + 1e-12);
                assert_true(direction <= most_direction + 1e-14);
                tight = fmax(tight, direction / most_direction);
                worst[fine] = fmax(worst[fine], direction);
            }
            lens_end(&l);
        }
        assert_true(tight > 0.7 && tight <= 1); /* the bound is that of what happens */
        assert_true(worst[0] > 3 * worst[1] && worst[0] < 5 * worst[1]);
    }
}

/* At a moment's own time a ray is that of the camera which stays there, and where all moments
 * are the same it has the bits of one that stays, whatever else moves. */
static void at_moments(void **state) {
    (void)state;
    static zt_camera cameras[LENS_MOMENTS_MAX];
    static double times[LENS_MOMENTS_MAX];
    static test_lens still;
    for (int kind = 0; kind < ZT_LENS_KIND_COUNT; kind++) {
        int count = spread_moments(times, cameras, (zt_lens_kind)kind, 9);
        lens_begin(&l, cameras, times, count, WIDE, HIGH);
        for (int i = 0; i < count; i++) {
            lens_begin(&still, &cameras[i], NULL, 1, WIDE, HIGH);
            test_ray a = lens_ray(&l, 31.25, 7.5, 0, 0, times[i]),
                     b = lens_middle(&still, 31.25, 7.5);
            vec3 gone = vec3_sub(cameras[i].position, cameras[0].position);
            assert_close(a.origin, vec3_add(b.origin, gone), 1e-12);
            assert_close(a.direction, b.direction, 1e-15);
            lens_end(&still);
        }
        lens_end(&l);
        for (int i = 1; i < count; i++) cameras[i] = cameras[0];
        lens_begin(&l, cameras, times, count, WIDE, HIGH);
        lens_begin(&still, cameras, NULL, 1, WIDE, HIGH);
        assert_false(zt_lens_moves(l.lens));
        assert_same_bits(lens_ray(&l, 31.25, 7.5, 0, 0, 0.7), lens_middle(&still, 31.25, 7.5));
        lens_end(&still);
        lens_end(&l);
    }
}

/* What steps between two moments is the earlier before the middle and the later after it; a
 * zoom that is a step leaves nothing in between. */
static void steps(void **state) {
    (void)state;
    zt_camera cameras[2] = {lens_camera(ZT_LENS_PERSPECTIVE), lens_camera(ZT_LENS_PERSPECTIVE)};
    static const double times[2] = {0, 1};
    cameras[1].fov = 0.2;
    lens_begin(&l, cameras, times, 2, WIDE, HIGH);
    vec3 wide = lens_ray(&l, 0, 0, 0, 0, 0).direction,
         narrow = lens_ray(&l, 0, 0, 0, 0, 1).direction;
    assert_close(lens_ray(&l, 0, 0, 0, 0, 0.25).direction,
                 vec3_add(vec3_scale(wide, 0.75), vec3_scale(narrow, 0.25)), 1e-15);
    l.steps[0] = true;
    assert_close(lens_ray(&l, 0, 0, 0, 0, 0.49).direction, wide, 0);
    assert_close(lens_ray(&l, 0, 0, 0, 0, 0.51).direction, narrow, 1e-15);
    lens_end(&l);
}

/* ---- what accuracy is asked for -------------------------------------------------------------
 */

/* Of several moments the finest pixel counts, and where rays begin furthest from the first one:
 * where the camera goes, in the opening, in the corner of an orthographic picture. */
static void finest_pixel(void **state) {
    (void)state;
    zt_camera cameras[3];
    static const double times[3] = {0, 0.5, 1};
    for (int i = 0; i < 3; i++) {
        cameras[i] = lens_camera(ZT_LENS_PERSPECTIVE);
        cameras[i].fov = i == 1 ? 0.2 : 0.9;
        cameras[i].position = (vec3){7, 7, 7 + 2 * i};
        cameras[i].aperture = 0.25;
    }
    lens_begin(&l, cameras, times, 3, WIDE, HIGH);
    zt_pixel pixel = zt_lens_finest_pixel(&l.exposure, WIDE, HIGH);
    assert_true(fabs(pixel.angle - 2 * tan(0.1) / HIGH) < 1e-15);
    assert_true(pixel.width == 0 && fabs(pixel.reach - 4.25) < 1e-15);
    lens_end(&l);
    cameras[0].lens = ZT_LENS_ORTHOGRAPHIC;
    cameras[0].height = 9;
    lens_begin(&l, cameras, NULL, 1, WIDE, HIGH);
    pixel = zt_lens_finest_pixel(&l.exposure, WIDE, HIGH);
    assert_true(pixel.angle == 0 && fabs(pixel.width - 0.1) < 1e-15);
    assert_true(fabs(pixel.reach - 0.25 - hypot(8, 4.5)) < 1e-12);
    lens_end(&l);
}

static zt_precision precision_of(zt_camera camera, double near) {
    static test_scene s;
    zt_meshes *meshes;
    zt_ready ready;
    scene_begin(&s);
    scene_material(&s, (vec3){1, 1, 1}, 0);
    scene_sphere(&s, (vec3){0, 0, -near - 1}, 1, 0);
    s.scene.camera = camera;
    zt_exposure exposure = zt_exposure_of(&s.scene);
    zt_arena arena = {0};
    assert_int_equal(zt_meshes_open(&meshes, NULL, 0, 1, (zt_listener){0}), ZT_OK);
    assert_int_equal(zt_tracer_prepare(&ready, &exposure, ZT_PRECISION_AUTO,
                                       zt_lens_finest_pixel(&exposure, 640, 360), meshes,
                                       &arena),
                     ZT_OK);
    zt_meshes_close(&meshes);
    zt_arena_free(&arena);
    return ready.precision;
}

/* Rays that begin far away, or right at something, are traced in double precision. */
static void far_reach(void **state) {
    (void)state;
    zt_camera camera = lens_camera(ZT_LENS_ORTHOGRAPHIC);
    camera.height = 3;
    assert_int_equal(precision_of(camera, 1), ZT_PRECISION_SINGLE);
    camera.height = 1e16;
    assert_int_equal(precision_of(camera, 1), ZT_PRECISION_DOUBLE);
    camera = lens_camera(ZT_LENS_PERSPECTIVE);
    camera.aperture = 0.1;
    assert_int_equal(precision_of(camera, 1), ZT_PRECISION_SINGLE);
    camera.aperture = 1.1;
    assert_int_equal(precision_of(camera, 1), ZT_PRECISION_DOUBLE);
}

/* ---- extremes -------------------------------------------------------------------------------
 */

static bool is_number(vec3 v) { return isfinite(v.x) && isfinite(v.y) && isfinite(v.z); }

/* All numbers that a description may hold give rays that are numbers, and go somewhere. */
static void extremes(void **state) {
    (void)state;
    static const double sizes[] = {1e-300, 1e-12, 1e-6, 1, 1e6, 1e300, 1.7e308};
    static const double fovs[] = {1e-6, 1, 179.9};
    enum { SIZES = sizeof sizes / sizeof *sizes };
    uint64_t random = 7;
    for (int round = 0; round < 30000; round++) {
        zt_camera camera = lens_camera((zt_lens_kind)(round % ZT_LENS_KIND_COUNT));
        double drawn[9];
        for (int i = 0; i < 9; i++) drawn[i] = sizes[(int)test_between(&random, 0, SIZES)];
        camera.fov = fovs[round / 3 % 3] * pi / 180;
        camera.focal_length = round % 5 ? 0 : drawn[0];
        camera.sensor_height = fmax(drawn[1], 1e-6);
        camera.height = drawn[2];
        camera.aperture = round % 7 ? drawn[3] : 0;
        camera.f_number = round % 4 ? 0 : drawn[4];
        camera.focus_distance = fmax(drawn[5], 1e-12);
        camera.focused = round % 2;
        camera.focus_on = vec3_scale(test_direction(&random), drawn[6] / 2);
        camera.blades = round % 11;
        camera.blade_rotation = drawn[7];
        camera.roll = drawn[8];
        camera.aimed = round % 13 == 0;
        camera.look_at = vec3_scale(test_direction(&random), drawn[5] / 2);
        lens_begin(&l, &camera, NULL, 1, round % 17 ? 640 : 1, round % 19 ? 360 : 1);
        zt_pixel pixel = zt_lens_finest_pixel(&l.exposure, l.width, l.height);
        assert_true(isfinite(pixel.width) && isfinite(pixel.angle) && isfinite(pixel.reach));
        for (int i = 0; i < 4; i++) {
            test_ray ray = lens_ray(&l, i % 2 * l.width, i / 2 * l.height,
                                    i == 1 ? 0 : 0.9999999, i == 2 ? 0 : 0.9999999, 0);
            double length = vec3_length(ray.direction);
            if (!is_number(ray.origin) || !(length > 0.5 && length < 1e7))
                fail_msg("round %d: (%g %g %g) + t (%g %g %g)", round, ray.origin.x,
                         ray.origin.y, ray.origin.z, ray.direction.x, ray.direction.y,
                         ray.direction.z);
        }
        lens_end(&l);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(there_and_back), cmocka_unit_test(focal_length_and_fov),
        cmocka_unit_test(orthographic),   cmocka_unit_test(all_around),
        cmocka_unit_test(pixels),         cmocka_unit_test(moving),
        cmocka_unit_test(at_moments),     cmocka_unit_test(steps),
        cmocka_unit_test(finest_pixel),   cmocka_unit_test(far_reach),
        cmocka_unit_test(extremes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
