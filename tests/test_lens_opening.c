/* The opening of a lens: points are blurred as the lens equation has it, and light comes
 * through all of the opening alike, round or of blades.
 *
 * Points of the opening are drawn by a generator from a fixed seed, so that a test which passes
 * always does. Of a right lens a mean is further off than three standard errors with a chance
 * of 0.27 percent, and 18 of random points are looked at: one seed in twenty would fail. A
 * chi-square statistic is with one of 3e-5, 17 in all: one seed in two thousand.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "chance.h"
#include "lenses.h"
#include "rendering.h"
#include "tracer/sampler.h"

static const double pi = 3.14159265358979323846;

static test_lens l;

enum { WIDE = 64, HIGH = 48, SAMPLES = 4096 };

static void assert_within(double got, double wanted, double most, const char *what) {
    if (!(fabs(got - wanted) <= most))
        fail_msg("%s is %.12g, not %.12g within %.3g", what, got, wanted, most);
}

/* ---- the circle of confusion ----------------------------------------------------------------
 */

/* A thin lens of focal length F (millimetres) and f-number N, its sensor where what is f metres
 * ahead is sharp: what is d ahead converges at v', 1/v' = 1/F - 1/d, and so is a circle
 * F / N * |v' - v| / v' wide on the sensor at v. Seen from the lens that is as wide, at d, as
 * the result, in metres. */
static double circle_of(double focal_length, double f_number, double focus, double distance) {
    double F = focal_length / 1000, v = 1 / (1 / F - 1 / focus),
           other = 1 / (1 / F - 1 / distance);
    double on_sensor = F / f_number * fabs(other - v) / other;
    return on_sensor * distance / v;
}

/* Where rays through the places of a picture and of the opening meet a plane across the view,
 * so far ahead: traced, in double precision. */
static void meet_plane(vec3 *hits, const test_lens *lens, zt_camera camera, double distance,
                       const float *x, const float *y, const float *u, const float *v,
                       int count) {
    static test_scene s;
    static zt_rays rays;
    static zt_probe probes[ZT_BATCH];
    zt_meshes *meshes;
    zt_ready ready;
    zt_arena arena = {0};
    scene_begin(&s);
    scene_plane(&s, (vec3){0, 0, 1}, -distance, scene_material(&s, white, 0));
    s.scene.camera = camera;
    zt_exposure exposure = zt_exposure_of(&s.scene);
    assert_int_equal(zt_meshes_open(&meshes, NULL, 0, 1, (zt_listener){0}), ZT_OK);
    assert_int_equal(zt_tracer_prepare(&ready, &exposure, ZT_PRECISION_DOUBLE,
                                       zt_lens_finest_pixel(&exposure, WIDE, HIGH), meshes,
                                       &arena),
                     ZT_OK);
    void *work = zt_arena_push(&arena, zt_kernel_work_size());
    assert_non_null(work);
    for (int first = 0; first < count; first += ZT_BATCH) {
        int now = count - first < ZT_BATCH ? count - first : ZT_BATCH;
        zt_lens_rays(&rays, lens->lens, x + first, y + first, u + first, v + first, now);
        for (int i = 0; i < now; i++)
            probes[i] = (zt_probe){.origin = {rays.ox[i], rays.oy[i], rays.oz[i]},
                                   .direction = {rays.dx[i], rays.dy[i], rays.dz[i]},
                                   .source = -1};
        ready.kernel->probe(ready.tracer, probes, now, work);
        for (int i = 0; i < now; i++) {
            assert_int_equal(probes[i].object, 0);
            hits[first + i] = probes[i].point;
        }
    }
    zt_meshes_close(&meshes);
    zt_arena_free(&arena);
}

static const struct {
    double focal_length, f_number, focus, distance;
} pulls[] = {{50, 1.4, 3, 8},  {50, 1.4, 3, 1.2},   {24, 2.8, 1, 100},
             {200, 4, 20, 19}, {85, 1.2, 0.9, 2.5}, {35, 1, 1000, 2}};
enum { PULLS = sizeof pulls / sizeof *pulls };

static zt_camera pulled(int i) {
    zt_camera camera = lens_camera(ZT_LENS_PERSPECTIVE);
    camera.focal_length = pulls[i].focal_length;
    camera.f_number = pulls[i].f_number;
    camera.focus_distance = pulls[i].focus;
    return camera;
}

/* Hits spread evenly over a disk of that diameter around the one through the lens's middle:
 * means of x, y and r^2 within three standard errors, and all within the circle. */
static void assert_disk(const vec3 *hits, int count, vec3 middle, double diameter) {
    double x = 0, y = 0, squares = 0, radius = diameter / 2, root = sqrt(count);
    for (int i = 0; i < count; i++) {
        vec3 way = vec3_sub(hits[i], middle);
        assert_true(vec3_length(way) <= radius * (1 + 1e-9));
        x += way.x / count, y += way.y / count;
        squares += (way.x * way.x + way.y * way.y) / count;
    }
    assert_within(x, 0, 3 * radius / 2 / root, "the mean along x");
    assert_within(y, 0, 3 * radius / 2 / root, "the mean along y");
    /* r^2 of a disk is uniform up to radius^2. */
    assert_within(squares, radius * radius / 2, 3 * radius * radius / sqrt(12) / root,
                  "the mean square");
}

static void circle_of_confusion(void **state) {
    (void)state;
    static float x[SAMPLES], y[SAMPLES], u[SAMPLES], v[SAMPLES];
    static vec3 hits[SAMPLES];
    uint64_t random = 1;
    for (int i = 0; i < 2 * PULLS; i++) {
        zt_camera camera = pulled(i / 2);
        double distance = pulls[i / 2].distance;
        double wanted = circle_of(pulls[i / 2].focal_length, pulls[i / 2].f_number,
                                  pulls[i / 2].focus, distance);
        for (int k = 0; k < SAMPLES; k++) {
            x[k] = 20.5f, y[k] = 30.25f;
            u[k] = (float)test_random(&random) * 0.99999994f;
            v[k] = (float)test_random(&random) * 0.99999994f;
            if (i % 2) zt_sample_point(&u[k], &v[k], 77, ZT_DIMENSION_LENS, (uint32_t)k);
        }
        lens_begin(&l, &camera, NULL, 1, WIDE, HIGH);
        assert_true(zt_lens_has_aperture(l.lens) && !zt_lens_moves(l.lens));
        meet_plane(hits, &l, camera, distance, x, y, u, v, SAMPLES);
        vec3 middle = lens_middle(&l, 20.5, 30.25).direction;
        middle = vec3_scale(middle, -distance / middle.z);
        assert_disk(hits, SAMPLES, middle, wanted);
        meet_plane(hits, &l, camera, pulls[i / 2].focus, x, y, u, v, SAMPLES);
        for (int k = 1; k < SAMPLES; k++) /* sharp */
            assert_true(vec3_length(vec3_sub(hits[k], hits[0])) < 1e-13 * pulls[i / 2].focus);
        lens_end(&l);
    }
}

/* The same in a picture: a small bright disk, blurred, has the mean square of its own and of
 * its circle of confusion. */
static void blurred_picture(void **state) {
    (void)state;
    static test_scene s;
    const double distance = 6, radius = 0.1;
    scene_begin(&s);
    int32_t material = scene_material(&s, white, 0);
    scene_object(&s, ZT_SHAPE_DISK, material)->disk =
        (zt_disk){{0.1, -0.05, -distance}, {0, 0, 1}, radius};
    scene_ambient(&s, white, 1);
    s.scene.camera = lens_camera(ZT_LENS_PERSPECTIVE);
    s.scene.camera.fov = 0.2;
    s.scene.camera.focus_distance = 2;
    s.scene.camera.aperture = 0.1;
    zt_image *image = render(&s.scene, WIDE, HIGH, 256, 1);
    double pixel = distance * zt_lens_pixel(&s.scene.camera, HIGH).angle;
    double sum = 0, x = 0, y = 0, squares = 0;
    for (int row = 0; row < HIGH; row++)
        for (int column = 0; column < WIDE; column++) {
            double light = pixel_at(image, column, row).x;
            double right = (column + 0.5 - WIDE / 2.0) * pixel,
                   up = (HIGH / 2.0 - row - 0.5) * pixel;
            sum += light, x += light * right, y += light * up;
            squares += light * (right * right + up * up);
        }
    x /= sum, y /= sum;
    squares = squares / sum - x * x - y * y - pixel * pixel / 6; /* a pixel's own spread */
    double confused = 0.1 * (distance - 2) / 2;
    assert_within(sum * pixel * pixel, pi * radius * radius, 1e-4, "all light");
    assert_within(x, 0.1, 1e-3, "the middle along x");
    assert_within(y, -0.05, 1e-3, "the middle along y");
    assert_within(squares, (radius * radius + confused * confused) / 2, 2e-4, "the spread");
    zt_image_free(&image);
}

/* ---- the opening's shape --------------------------------------------------------------------
 */

/* Where on the opening rays begin, in units of its radius: right and up. */
static void draw_opening(double *right, double *up, uint64_t *random) {
    test_ray ray = lens_ray(&l, 1, 2, test_random(random) * 0.99999994,
                            test_random(random) * 0.99999994, 0);
    assert_true(ray.origin.z == 0);
    *right = ray.origin.x / 3, *up = ray.origin.y / 3;
}

static void open_lens(int blades, double rotation) {
    zt_camera camera = lens_camera(ZT_LENS_PERSPECTIVE);
    camera.aperture = 3;
    camera.blades = blades;
    camera.blade_rotation = rotation;
    lens_begin(&l, &camera, NULL, 1, WIDE, HIGH);
}

enum { ACROSS = 4, ALONG = 4, DRAWN = 60000 };

/* The cell of a regular polygon that a point is in, all of the same area: which side it is
 * towards, how near to that, and how far along. By angles alone. */
static int cell_of(double right, double up, int blades, double rotation) {
    double turn = 2 * pi / blades, angle = atan2(-right, up) - rotation;
    angle -= 2 * pi * floor(angle / (2 * pi));
    int side = (int)(angle / turn) % blades;
    double off = angle - (side + 0.5) * turn, apothem = cos(turn / 2);
    double out = hypot(right, up) * cos(off) / apothem; /* 1 at the side */
    double along = 0.5 + tan(off) / tan(turn / 2) / 2;
    assert_true(out <= 1 + 1e-12);
    int near = (int)(out * out * ACROSS), at = (int)(along * ALONG);
    near = near < ACROSS ? near : ACROSS - 1;
    at = at < 0 ? 0 : at < ALONG ? at : ALONG - 1;
    return (side * ACROSS + near) * ALONG + at;
}

/* Light comes through all of a polygon alike, and nowhere beside it; its first corner is up
 * where it is not turned. */
static void blades(void **state) {
    (void)state;
    static const int blade_counts[] = {3, 4, 5, 6, 7, 9, 64};
    uint64_t random = 2;
    for (int i = 0; i < 14; i++) {
        int count = blade_counts[i / 2], counts[64 * ACROSS * ALONG] = {0};
        double rotation = i % 2 ? 0.3 : 0;
        open_lens(count, rotation);
        double highest = 0, right, up;
        for (int k = 0; k < DRAWN; k++) {
            draw_opening(&right, &up, &random);
            counts[cell_of(right, up, count, rotation)]++;
            if (i % 2 == 0) highest = fmax(highest, up);
        }
        int cells = count * ACROSS * ALONG;
        double got = chi_square(counts, cells, (double)DRAWN / cells);
        if (got >= chi_square_limit(cells - 1, 4))
            fail_msg("%d blades: chi-square %.0f of %d cells", count, got, cells);
        if (i % 2 == 0) assert_true(highest > 0.97 && highest <= 1);
        lens_end(&l);
    }
}

/* The same of a disk, in rings of the same area and sectors; fewer than three blades are none.
 */
static void round_opening(void **state) {
    (void)state;
    enum { RINGS = 8, SECTORS = 16 };
    uint64_t random = 3;
    for (int i = 0; i < 3; i++) {
        int counts[RINGS * SECTORS] = {0};
        open_lens(i, 0.2);
        for (int k = 0; k < DRAWN; k++) {
            double right, up;
            draw_opening(&right, &up, &random);
            double square = right * right + up * up;
            assert_true(square <= 1 + 1e-12);
            int ring = (int)(square * RINGS),
                sector = (int)((atan2(up, right) / pi + 1) / 2 * SECTORS);
            ring = ring < RINGS ? ring : RINGS - 1;
            counts[ring * SECTORS + sector % SECTORS]++;
        }
        assert_true(chi_square(counts, RINGS * SECTORS, (double)DRAWN / RINGS / SECTORS) <
                    chi_square_limit(RINGS * SECTORS - 1, 4));
        lens_end(&l);
    }
}

/* Near places of the unit square are near on the disk: it keeps the points of a sampler spread.
 */
static void low_distortion(void **state) {
    (void)state;
    open_lens(0, 0);
    uint64_t random = 4;
    for (int i = 0; i < 100000; i++) {
        double u = test_random(&random) * 0.999, v = test_random(&random) * 0.999;
        vec3 a = lens_ray(&l, 1, 2, u, v, 0).origin,
             b = lens_ray(&l, 1, 2, u + 1e-3, v, 0).origin,
             c = lens_ray(&l, 1, 2, u, v + 1e-3, 0).origin;
        assert_true(vec3_length(vec3_sub(b, a)) / 3 < 1e-3 * 2 * 1.3);
        assert_true(vec3_length(vec3_sub(c, a)) / 3 < 1e-3 * 2 * 1.3);
    }
    lens_end(&l);
}

/* ---- where it is sharp ----------------------------------------------------------------------
 */

/* By a point: all rays of a place cross as far ahead as the point is, whatever way the camera
 * is turned; an orthographic lens opens likewise. */
static void focus_on_a_point(void **state) {
    (void)state;
    uint64_t random = 5;
    for (int round = 0; round < 2000; round++) {
        zt_camera camera = lens_camera(round % 2 ? ZT_LENS_ORTHOGRAPHIC : ZT_LENS_PERSPECTIVE);
        camera.position = vec3_scale(test_direction(&random), 50);
        camera.rotation =
            quat_axis_angle(test_direction(&random), test_between(&random, -3, 3));
        camera.focused = true;
        double ahead = exp(test_between(&random, -3, 5));
        xform axes = zt_camera_xform(&camera);
        vec3 aside = vec3_add(vec3_scale(axes.x, test_between(&random, -9, 9)),
                              vec3_scale(axes.y, test_between(&random, -9, 9)));
        camera.focus_on = vec3_add(camera.position, vec3_sub(aside, vec3_scale(axes.z, ahead)));
        camera.aperture = 0.5 * ahead;
        camera.blades = round % 7;
        lens_begin(&l, &camera, NULL, 1, WIDE, HIGH);
        vec3 at[2];
        for (int i = 0; i < 2; i++) {
            test_ray ray = lens_ray(&l, 3, 4, test_random(&random) * 0.999,
                                    test_random(&random) * 0.999, 0);
            double step =
                (ahead + vec3_dot(ray.origin, axes.z)) / -vec3_dot(ray.direction, axes.z);
            at[i] = vec3_add(ray.origin, vec3_scale(ray.direction, step));
        }
        assert_true(vec3_length(vec3_sub(at[1], at[0])) < 1e-12 * (ahead + 50));
        assert_within(zt_camera_focus(&camera), ahead, 1e-12 * (ahead + 50), "the focus");
        lens_end(&l);
    }
}

/* A point behind the camera is focused on as near as can be; the rays are numbers still. */
static void focus_behind(void **state) {
    (void)state;
    zt_camera camera = lens_camera(ZT_LENS_PERSPECTIVE);
    camera.focused = true;
    camera.aperture = 0.1;
    static const vec3 points[] = {
        {0, 0, 5}, {0, 0, 0}, {3, 0, 0}, {0, 0, 1e308}, {0, 1e-300, 0}};
    for (size_t i = 0; i < sizeof points / sizeof *points; i++) {
        camera.focus_on = points[i];
        assert_true(zt_camera_depth(&camera, camera.focus_on) <= 0);
        assert_within(zt_camera_focus(&camera), 1e-7, 1e-20, "the focus");
        lens_begin(&l, &camera, NULL, 1, WIDE, HIGH);
        test_ray ray = lens_ray(&l, 0, 0, 0.9, 0.2, 0);
        assert_true(isfinite(vec3_length(ray.direction)) && vec3_length(ray.direction) > 0);
        lens_end(&l);
    }
}

/* While the focus is pulled, rays at a moment's time have that moment's; in between the inverse
 * of the distance goes straight on. */
static void pull_within_the_shutter(void **state) {
    (void)state;
    zt_camera cameras[2] = {lens_camera(ZT_LENS_PERSPECTIVE), lens_camera(ZT_LENS_PERSPECTIVE)};
    static const double times[2] = {0, 1};
    static const struct { double time, focus; } sharp[] = {{0, 2}, {0.5, 2 / 0.75}, {1, 4}};
    cameras[0].aperture = cameras[1].aperture = 0.25;
    cameras[0].focus_distance = 2, cameras[1].focus_distance = 4;
    lens_begin(&l, cameras, times, 2, WIDE, HIGH);
    assert_true(zt_lens_moves(l.lens) && zt_lens_has_aperture(l.lens));
    for (int i = 0; i < 3; i++) {
        vec3 at[2];
        for (int k = 0; k < 2; k++) {
            test_ray ray = lens_ray(&l, 9, 9, 0.1 + 0.7 * k, 0.2, sharp[i].time);
            at[k] = vec3_add(ray.origin,
                             vec3_scale(ray.direction, -sharp[i].focus / ray.direction.z));
        }
        assert_true(vec3_length(vec3_sub(at[1], at[0])) < 1e-14);
    }
    lens_end(&l);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(circle_of_confusion),
        cmocka_unit_test(blurred_picture),
        cmocka_unit_test(blades),
        cmocka_unit_test(round_opening),
        cmocka_unit_test(low_distortion),
        cmocka_unit_test(focus_on_a_point),
        cmocka_unit_test(focus_behind),
        cmocka_unit_test(pull_within_the_shutter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
