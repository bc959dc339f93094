/* Motion of what is seen, in pixels until the next frame, to the right and upwards: against
 * closed forms; and the camera's matrices against pictures. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/vec.h"
#include "pictures.h"
#include "sequence/renderer.h"

enum { WIDTH = 50, HEIGHT = 34, AOVS = ZT_AOV_MOTION | ZT_AOV_P | ZT_AOV_OBJECT };

static const double pi = 3.14159265358979323846;

/* One unit of an orthographic picture is a pixel, the origin its middle. */
#define FLAT                                                                                   \
    "camera: { lens: orthographic, height: 34, position: [0, 0, 50], rotation: [0, 0, 0] }\n"

static zt_image *taken(const char *film, const char *rest, int64_t frame) {
    char text[4096];
    snprintf(text, sizeof text, "zoetrope: 1\nfilm: { duration: 24%s }\n%s", film, rest);
    return picture_of(
        text, frame,
        &(zt_render_settings){.width = WIDTH, .height = HEIGHT, .threads = 2, .aovs = AOVS});
}

static double value(const zt_image *image, const char *name, int x, int y) {
    return (double)zt_image_channel(image, name)[y * WIDTH + x];
}

/* What a pixel shows: which object, where in the world, where in the picture (pixels to the
 * right and upwards from its middle), and where it goes. */
typedef struct pixel {
    int object;
    vec3 place;
    double right, up, goes_right, goes_up;
} pixel;

static pixel pixel_at(const zt_image *image, int x, int y) {
    return (pixel){
        (int)value(image, "id.object", x, y),
        {value(image, "P.X", x, y), value(image, "P.Y", x, y), value(image, "P.Z", x, y)},
        x + 0.5 - WIDTH / 2.0,
        HEIGHT / 2.0 - y - 0.5,
        value(image, "motion.x", x, y),
        value(image, "motion.y", x, y)};
}

/* Where what a pixel shows is meant to go; nothing goes nowhere. */
typedef void way(double *right, double *up, const pixel *p);

/* All pixels, at least `least` of which show the object that is looked at. Frees the image. */
static void check(zt_image *image, int object, int least, way *expected, double off) {
    int count = 0;
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            pixel p = pixel_at(image, x, y);
            double right = 0, up = 0;
            if (p.object == object) expected(&right, &up, &p);
            count += p.object == object;
            if (p.object == object
                    ? !(fabs(p.goes_right - right) <= off && fabs(p.goes_up - up) <= off)
                    : p.goes_right != 0 || p.goes_up != 0)
                fail_msg("object %d at %d, %d goes %.9g, %.9g, not %.9g, %.9g", p.object, x, y,
                         p.goes_right, p.goes_up, right, up);
        }
    }
    if (count < least) fail_msg("only %d pixels", count);
    zt_image_free(&image);
}

/* ---- things ---------------------------------------------------------------------------------
 */

static void goes_3_2(double *right, double *up, const pixel *p) {
    (void)p;
    *right = 3, *up = 2;
}

/* A ball that goes 3 pixels to the right and 2 up in each frame; also while the shutter is
 * open. What stands still goes exactly nowhere. */
static void ball(void **state) {
    (void)state;
    const char *const shutters[] = {"", ", shutter: 180 deg",
                                    ", shutter: { angle: 90 deg, phase: 45 deg }"};
    for (int i = 0; i < 3; i++) {
        for (int64_t frame = 0; frame < 2; frame++)
            check(taken(shutters[i],
                        FLAT
                        "objects:\n"
                        "  - sphere: { radius: 6, center: { curve: linear, before: linear,\n"
                        "      after: linear, keys: { 0: [-3, 1, 0], 1: [0, 3, 0] } } }\n"
                        "  - box: { center: [0, -10, -20], size: [30, 9, 2] }\n",
                        frame),
                  1, 90, goes_3_2, 1e-4);
    }
}

static void turns(double *right, double *up, const pixel *p) {
    double c = cos(pi / 18), s = sin(pi / 18);
    *right = c * p->right - s * p->up - p->right;
    *up = s * p->right + c * p->up - p->up;
}

/* A wheel that turns by 10 degrees in each frame. */
static void wheel(void **state) {
    (void)state;
    static const char rest[] =
        FLAT "objects:\n"
             "  - group:\n"
             "      rotation: { curve: linear, keys: { 0: [0, 0, 0], 9: [0, 0, 90] } }\n"
             "      objects: [disk: { center: [0, 0, 0], normal: [0, 0, 1], radius: 15 }]\n";
    check(taken("", rest, 4), 2, 600, turns, 1e-4);
    /* As it is in the middle of the opening. */
    check(taken(", shutter: 180 deg", rest, 4), 2, 600, turns, 0.02);
}

static void grows(double *right, double *up, const pixel *p) {
    *right = p->right / 4, *up = p->up / 4;
}

static void thickens(double *right, double *up, const pixel *p) {
    double out = hypot(p->right, p->up), more = (out - 10) / 2;
    *right = p->right / out * more, *up = p->up / out * more;
}

/* Radii take the points of a surface along. */
static void growing(void **state) {
    (void)state;
    check(taken("",
                FLAT "objects:\n"
                     "  - sphere: { center: [0, 0, 0],\n"
                     "              radius: { curve: linear, keys: { 0: 8, 1: 10 } } }\n",
                0),
          1, 150, grows, 1e-4);
    check(taken("",
                FLAT "objects:\n"
                     "  - torus: { center: [0, 0, 0], axis: [0, 0, 1], radius: 10,\n"
                     "             tube_radius: { curve: linear, keys: { 0: 2, 1: 3 } } }\n",
                0),
          1, 150, thickens, 1e-4);
}

/* The corner of a model, 20 long, is where it lies; it turns by a quarter, grows twice as wide
 * and goes 5 up. */
static void model_goes(double *right, double *up, const pixel *p) {
    double x = (p->right + 9) / 20, y = (p->up + 8) / 20;
    *right = -9 - 20 * y - p->right, *up = -3 + 40 * x - p->up;
}

static void model(void **state) {
    (void)state;
    write_model("m.ply");
    check(taken("",
                FLAT
                "objects:\n"
                "  - mesh:\n"
                "      file: m.ply\n"
                "      position: { curve: linear, keys: { 0: [-9, -8, 0], 1: [-9, -3, 0] } }\n"
                "      rotation: { curve: linear, keys: { 0: [0, 0, 0], 1: [0, 0, 90] } }\n"
                "      scale: { curve: linear, keys: { 0: [20, 20, 1], 1: [40, 20, 1] } }\n",
                0),
          1, 150, model_goes, 1e-4);
}

/* ---- cameras --------------------------------------------------------------------------------
 */

#define WALL                                                                                   \
    "objects: [box: { center: [0, 0, -11], size: [900, 900, 2], rotation: [0, 0, 0] }]\n"

/* The height of half a picture at a distance of 1, pixels. */
static double focal(void) { return HEIGHT / 2.0 / tan(20 * pi / 180); }

static void pans(double *right, double *up, const pixel *p) {
    double c = cos(5 * pi / 180), s = sin(5 * pi / 180), f = focal();
    double x = c * p->right + s * f, z = c * f - s * p->right;
    *right = f * x / z - p->right, *up = f * p->up / z - p->up;
}

/* By 5 degrees to the left. */
static void pan(void **state) {
    (void)state;
    static const char rest[] =
        "camera: { position: [0, 0, 0], fov: 40 deg,\n"
        "          rotation: { curve: linear, keys: { 0: [0, 0, 0], 9: [0, 45, 0] } } }\n"
        "objects: [sphere: { center: [0, 0, 0], radius: 30 }]\n";
    check(taken("", rest, 0), 1, WIDTH * HEIGHT, pans, 1e-3);
}

static void doubles(double *right, double *up, const pixel *p) {
    *right = p->right, *up = p->up;
}

/* To half of the angle, and of the height. */
static void zoom(void **state) {
    (void)state;
    check(taken("",
                "camera: { position: [0, 0, 0], rotation: [0, 0, 0], sensor_height: 24 mm,\n"
                "          focal_length: { curve: linear, keys: { 0: 24, 1: 48 } } }\n" WALL,
                0),
          1, WIDTH * HEIGHT, doubles, 1e-3);
    check(taken("",
                "camera: { position: [0, 0, 0], rotation: [0, 0, 0], lens: orthographic,\n"
                "          height: { curve: linear, keys: { 0: 8, 1: 4 } } }\n" WALL,
                0),
          1, WIDTH * HEIGHT, doubles, 1e-3);
}

static void passes_by(double *right, double *up, const pixel *p) {
    (void)p;
    *right = -focal() * 0.5 / 10, *up = focal() * 0.25 / 10;
}

/* A camera that goes sideways before a wall ten away; all its rays pass through its lens. */
static void travel(void **state) {
    (void)state;
    static const char rest[] =
        "camera: { fov: 40 deg, rotation: [0, 0, 0], aperture: 0.2, focus_distance: 4,\n"
        "          position: { curve: linear, keys: { 0: [0, 0, 0], 8: [4, -2, 0] } } }\n" WALL;
    check(taken("", rest, 3), 1, WIDTH * HEIGHT, passes_by, 1e-3);
    check(taken(", shutter: 180 deg", rest, 3), 1, WIDTH * HEIGHT, passes_by, 1e-3);
}

static void nowhere(double *right, double *up, const pixel *p) {
    (void)p;
    *right = *up = 0;
}

/* What will be behind the camera. */
static void behind(void **state) {
    (void)state;
    check(taken("",
                "camera: { fov: 40 deg, rotation: [0, 0, 0], position: { curve: linear,\n"
                "          keys: { 0: [0, 0, 0], 1: [0, 0, -20] } } }\n" WALL,
                0),
          1, WIDTH * HEIGHT, nowhere, 0);
}

/* Pixels to the right of the middle at which a place is seen all around. */
static double around_at(double x, double z) { return atan2(x, -z) / (2 * pi) * WIDTH; }

static void goes_around(double *right, double *up, const pixel *p) {
    vec3 next = vec3_add(p->place, (vec3){1, 0.5, 0});
    double turns = around_at(next.x, next.z) - p->right;
    *right = turns - WIDTH * rint(turns / WIDTH);
    *up = atan2(next.y, hypot(next.x, next.z)) / pi * HEIGHT - p->up;
    assert_true(*right < 0 && *right > -WIDTH / 8.0); /* behind, right is left */
}

/* A ball behind a camera that sees all around lies on both edges of the picture, and goes over
 * them. */
static void around(void **state) {
    (void)state;
    check(taken("",
                "camera: { lens: equirectangular, position: [0, 0, 0], rotation: [0, 0, 0] }\n"
                "objects:\n"
                "  - sphere: { radius: 2, center: { curve: linear,\n"
                "              keys: { 0: [0, 0, 5], 1: [1, 0.5, 5] } } }\n",
                0),
          1, 20, goes_around, 1e-4);
}

/* ---- matrices -------------------------------------------------------------------------------
 */

static const char *const lenses[] = {"fov: 50 deg", "focal_length: 35 mm, roll: 20 deg",
                                     "lens: orthographic, height: 9"};

/* The renderer after a frame of a film with such a camera, which moves. */
static zt_renderer *rendered(zt_animation **animation, zt_image **image, const char *film,
                             const char *lens, const char *objects) {
    char text[2048];
    zt_renderer *renderer;
    const zt_render_settings settings = {
        .width = WIDTH, .height = HEIGHT, .threads = 2, .aovs = AOVS};
    snprintf(text, sizeof text,
             "zoetrope: 1\nfilm: { duration: 24%s }\n"
             "camera: { look_at: [0, 1, 0], %s, position: { curve: linear,\n"
             "          keys: { 0: [3, 2, 8], 20: [-7, 6, 8] } } }\n"
             "lights: [ambient: {}]\nobjects:\n%s",
             film, lens, objects);
    *animation = animation_of(text);
    assert_int_equal(zt_renderer_open(&renderer, *animation, &settings, (zt_listener){0}),
                     ZT_OK);
    assert_int_equal(zt_image_create(image, WIDTH, HEIGHT), ZT_OK);
    assert_int_equal(zt_image_add_aovs(*image, AOVS), ZT_OK);
    assert_int_equal(zt_renderer_frame(renderer, 5, *image, NULL), ZT_OK);
    return renderer;
}

/* Where on the picture the matrix shows a point, in pixels from the upper left corner. */
static void show(double *x, double *y, const double m[16], vec3 p) {
    double w = p.x * m[3] + p.y * m[7] + p.z * m[11] + m[15];
    *x = (p.x * m[0] + p.y * m[4] + p.z * m[8] + m[12]) / w * WIDTH;
    *y = (p.x * m[1] + p.y * m[5] + p.z * m[9] + m[13]) / w * HEIGHT;
}

/* Each pixel's place in the world is shown at the pixel's middle. */
static void places(void **state) {
    (void)state;
    static const char objects[] = "  - sphere: { center: [0, 1, 0], radius: 2 }\n"
                                  "  - plane: { normal: [0, 1, 0], distance: -1 }\n";
    const char *const films[] = {"", ", shutter: 180 deg"};
    for (int i = 0; i < 6; i++) {
        zt_animation *animation;
        zt_image *image;
        zt_renderer *r = rendered(&animation, &image, films[i / 3], lenses[i % 3], objects);
        int count = 0;
        for (int y = 0; y < HEIGHT; y++) {
            for (int x = 0; x < WIDTH; x++) {
                pixel p = pixel_at(image, x, y);
                double is_x, is_y;
                if (!p.object) continue;
                count++;
                show(&is_x, &is_y, r->world_to_ndc, p.place);
                if (!(fabs(is_x - x - 0.5) < 0.01 && fabs(is_y - y - 0.5) < 0.01))
                    fail_msg("%s: %d, %d is shown at %g, %g", lenses[i % 3], x, y, is_x, is_y);
            }
        }
        assert_true(count > WIDTH * HEIGHT / 2);
        zt_renderer_close(&r);
        zt_image_free(&image);
        zt_animation_free(&animation);
    }
}

/* A small ball is where its middle is shown: by what it covers. */
static void small_ball(void **state) {
    (void)state;
    for (int i = 0; i < 3; i++) {
        zt_animation *animation;
        zt_image *image;
        zt_renderer *r =
            rendered(&animation, &image, ", samples: 256, background: transparent", lenses[i],
                     "  - sphere: { center: [1.5, 0.2, -0.7], radius: 0.3 }\n");
        double sum = 0, sum_x = 0, sum_y = 0, x, y;
        for (int p = 0; p < WIDTH * HEIGHT; p++) {
            double alpha = (double)image->pixels[4 * p + 3];
            sum += alpha;
            sum_x += alpha * (p % WIDTH + 0.5);
            sum_y += alpha * (p / WIDTH + 0.5);
        }
        show(&x, &y, r->world_to_ndc, (vec3){1.5, 0.2, -0.7});
        assert_true(sum > 1);
        if (!(fabs(sum_x / sum - x) < 0.05 && fabs(sum_y / sum - y) < 0.05))
            fail_msg("%s: %g, %g and not %g, %g", lenses[i], x, y, sum_x / sum, sum_y / sum);
        zt_renderer_close(&r);
        zt_image_free(&image);
        zt_animation_free(&animation);
    }
}

/* ---- the whole ------------------------------------------------------------------------------
 */

/* The same bits on any number of threads, and alone as with all others; colours do not change.
 */
static void same_bits(void **state) {
    (void)state;
    static const char text[] =
        "zoetrope: 1\nfilm: { duration: 24, samples: 4, shutter: 180 deg }\n"
        "camera: { fov: 40 deg, look_at: [0, 0, 0],\n"
        "          position: { curve: linear, keys: { 0: [0, 0, 9], 9: [5, 1, 7] } } }\n"
        "lights: [ambient: {}]\n"
        "objects:\n"
        "  - sphere: { radius: 2, center: { curve: linear,\n"
        "              keys: { 0: [-1, 0, 0], 9: [1, 0.5, 1] } } }\n";
    zt_render_settings settings = {.width = WIDTH, .height = HEIGHT, .threads = 1};
    zt_image *plain = picture_of(text, 4, &settings);
    settings.aovs = ZT_AOV_ALL;
    zt_image *one = picture_of(text, 4, &settings);
    settings.aovs = ZT_AOV_MOTION;
    settings.threads = 3;
    zt_image *three = picture_of(text, 4, &settings);
    size_t size = pixel_count_of(one) * sizeof(float);
    assert_memory_equal(plain->pixels, three->pixels, 4 * size);
    assert_int_equal(three->channel_count, 2);
    for (int c = 0; c < 2; c++)
        assert_memory_equal(three->channels[c].values,
                            zt_image_channel(one, three->channels[c].name), size);
    zt_image_free(&plain);
    zt_image_free(&one);
    zt_image_free(&three);
}

/* A ball that rests until frame 4: where motion is asked for, its key differs a frame before
 * that, since what is seen will go; else not. */
static void keys(void **state) {
    (void)state;
    static const char text[] = "zoetrope: 1\nfilm: { duration: 24 }\n" FLAT "objects:\n"
                               "  - sphere: { radius: 2, center: { curve: linear,\n"
                               "              keys: { 4: [-1, 0, 0], 9: [1, 0.5, 1] } } }\n";
    for (unsigned aovs = 0; aovs <= ZT_AOV_MOTION; aovs += ZT_AOV_MOTION) {
        zt_animation *animation = animation_of(text);
        zt_renderer *renderer;
        zt_hash key[3];
        const zt_render_settings settings = {.threads = 1, .aovs = aovs};
        assert_int_equal(zt_renderer_open(&renderer, animation, &settings, (zt_listener){0}),
                         ZT_OK);
        for (int i = 0; i < 3; i++)
            assert_int_equal(zt_renderer_key(&key[i], renderer, 2 + i), ZT_OK);
        assert_memory_equal(&key[0], &key[1], sizeof *key);
        assert_int_equal(memcmp(&key[1], &key[2], sizeof *key) != 0, aovs != 0);
        zt_renderer_close(&renderer);
        zt_animation_free(&animation);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ball),   cmocka_unit_test(wheel),      cmocka_unit_test(growing),
        cmocka_unit_test(model),  cmocka_unit_test(pan),        cmocka_unit_test(zoom),
        cmocka_unit_test(travel), cmocka_unit_test(behind),     cmocka_unit_test(around),
        cmocka_unit_test(places), cmocka_unit_test(small_ball), cmocka_unit_test(same_bits),
        cmocka_unit_test(keys)};
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
