/* Motion blur against numerical integration: what balls that move, turn and accelerate leave on
 * a picture is the share of each pixel, and of the shutter's time, that they cover. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <zoetrope/renderer.h>

#include "descriptions.h"

enum { WIDTH = 48, HEIGHT = 27, SAMPLES = 4096, PLACES = 16, TIMES = 256 };
static const double rate = 24, radius = 0.8, eye = 6;

#define FILM                                                                                   \
    "zoetrope: 1\n"                                                                            \
    "film: { size: [48, 27], rate: 24, duration: 24, view: raw, samples: 4096, shutter: %s "   \
    "}\n"                                                                                      \
    "camera: { fov: 40 deg, rotation: [0, 0, 0], position: %s }\n"                             \
    "lights: [ambient: {}]\n"                                                                  \
    "objects:\n"

/* Where a ball is, `t` seconds into the film, and how large. */
typedef struct ball {
    vec3 center;
    double radius;
} ball;
typedef ball motion(double t);

static bool meets(ball b, vec3 d) {
    vec3 f = vec3_sub((vec3){0, 0, eye}, b.center);
    double along = vec3_dot(f, d), square = vec3_dot(d, d);
    return along < 0 && along * along >= square * (vec3_dot(f, f) - b.radius * b.radius);
}

/* The width of a pixel at the balls' distance. */
static double pixel_width(void) {
    return 2 * tan(20 * 3.14159265358979323846 / 180) / HEIGHT * eye;
}

/* The share of pixel (x, y) and of the opening from `open` to `close`, frames, that is covered
 * by a ball so much larger: the mean over the middles of equal cells of place and time. */
static double covered(motion *where, int x, int y, double open, double close, double larger) {
    const double step = pixel_width() / eye;
    int64_t inside = 0;
    for (int k = 0; k < TIMES; k++) {
        ball b = where((open + (k + 0.5) / TIMES * (close - open)) / rate);
        b.radius = fmax(b.radius + larger, 0);
        for (int j = 0; j < PLACES * PLACES; j++) {
            double px = x + (j % PLACES + 0.5) / PLACES, py = y + (j / PLACES + 0.5) / PLACES;
            inside +=
                meets(b, (vec3){(px - WIDTH / 2.0) * step, (HEIGHT / 2.0 - py) * step, -1});
        }
    }
    return (double)inside / ((double)TIMES * PLACES * PLACES);
}

/* Each pixel is within three standard errors of independent samples of what it should be, give
 * or take a cell of the integration. The points are spread better than independent ones are, of
 * which 0.27 % would be further off; the seeds are fixed. What goes on a curve may be off its
 * way by a quarter of a pixel: then it lies between a smaller ball's picture and a larger
 * one's.
 */
static void assert_blurred_from(const char *position, const char *shutter, const char *objects,
                                motion *where, double open, double close, double pixels) {
    char text[2048];
    int length = snprintf(text, sizeof text, FILM, shutter, position);
    snprintf(text + length, sizeof text - (size_t)length, "%s", objects);
    zt_animation *animation = animation_of(text);
    zt_renderer *renderer;
    zt_image *image;
    enum { FRAME = 6 };
    int touched = 0;
    assert_int_equal(
        zt_renderer_open(&renderer, animation, &(zt_render_settings){0}, (zt_listener){0}),
        ZT_OK);
    assert_int_equal(zt_image_create(&image, WIDTH, HEIGHT), ZT_OK);
    assert_int_equal(zt_renderer_frame(renderer, FRAME, image, NULL), ZT_OK);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        double room = pixels * pixel_width(), got = (double)image->pixels[4 * i];
        double least = covered(where, i % WIDTH, i / WIDTH, FRAME + open, FRAME + close, -room);
        double most =
            room > 0 ? covered(where, i % WIDTH, i / WIDTH, FRAME + open, FRAME + close, room)
                     : least;
        double error = 3 * sqrt(fmax(got * (1 - got), 0) / SAMPLES) + 1.0 / TIMES;
        touched += got > 0.02 && got < 0.98;
        if (!(got >= least - error && got <= most + error))
            fail_msg("pixel %d, %d is %.5f, not %.5f to %.5f +- %.5f", i % WIDTH, i / WIDTH,
                     got, least, most, error);
    }
    assert_true(touched > 10); /* there is something to see */
    zt_image_free(&image);
    zt_renderer_close(&renderer);
    zt_animation_free(&animation);
}

static void assert_blurred(const char *shutter, const char *objects, motion *where, double open,
                           double close, double pixels) {
    assert_blurred_from("[0, 0, 6]", shutter, objects, where, open, close, pixels);
}

static ball straight(double t) { return (ball){{8 * t - 2, 0.3, 0}, radius}; }

static void moving(void **state) {
    (void)state;
    assert_blurred("180 deg",
                   "  - sphere: { radius: 0.8, center: { curve: linear, after: linear, keys: "
                   "{ 0 s: [-2, 0.3, 0], 1 s: [6, 0.3, 0] } } }\n",
                   straight, 0, 0.5, 0);
}

static ball faster(double t) { return (ball){{40 * t * t - 3.4, 1 - 12 * t * t, 0}, radius}; }

/* Over a whole frame, and beginning before it. */
static void accelerating(void **state) {
    (void)state;
    assert_blurred(
        "{ angle: 360 deg, phase: -180 deg }",
        "  - sphere: { radius: 0.8, center: \"= {40 * t * t - 3.4, 1 - 12 * t * t, 0}\" }\n",
        faster, -0.5, 0.5, 0.25);
}

static ball around(double t) {
    double a = 2 * 3.14159265358979323846 * 10 * t;
    return (ball){{1.4 * cos(a), 1.4 * sin(a), 0}, 0.4};
}

/* On the rim of a wheel that turns ten times a second: 150 degrees while the shutter is open.
 */
static void spinning(void **state) {
    (void)state;
    assert_blurred(
        "360 deg",
        "  - group: { rotation: { in: turns, curve: linear, keys: { 0 s: [0, 0, 0], "
        "1 s: [0, 0, 3600] } }, objects: [ sphere: { radius: 0.4, center: [1.4, 0, 0] } ] }\n",
        around, 0, 1, 0.25);
}

static ball growing(double t) { return (ball){{0.2, 0, 0}, 30 * (t - 0.25)}; }

/* From nothing, by its radius, and by the scale of its group. */
static void growing_from_nothing(void **state) {
    (void)state;
    assert_blurred(
        "360 deg",
        "  - sphere: { center: [0.2, 0, 0], radius: \"= max(0, 30 * (t - 0.25))\" }\n", growing,
        0, 1, 0);
    assert_blurred("360 deg",
                   "  - group: { position: [0.2, 0, 0], scale: \"= vec(1, 1, 1) * max(0, 30 * "
                   "(t - 0.25))\", "
                   "objects: [ sphere: { center: [0, 0, 0], radius: 1 } ] }\n",
                   growing, 0, 1, 0);
}

static ball jumping(double t) {
    return (ball){{t < (6 + 0.375) / rate ? -1.5 : 1.5, 0, 0}, radius};
}

/* A key within the opening at which the ball is somewhere else at once. */
static void a_key_inside(void **state) {
    (void)state;
    assert_blurred(
        "360 deg",
        "  - sphere: { radius: 0.8, center: { curve: hold, keys: { 0 s: [-1.5, 0, 0], "
        "265.625 ms: [1.5, 0, 0] } } }\n",
        jumping, 0, 1, 0);
}

/* A camera that goes past a ball that rests: as the ball would go past the camera. */
static void a_moving_camera(void **state) {
    (void)state;
    assert_blurred_from("{ curve: linear, after: linear, keys: { 0 s: [2, -0.3, 6], 1 s: [-6, "
                        "-0.3, 6] } }",
                        "180 deg", "  - sphere: { radius: 0.8, center: [0, 0, 0] }\n", straight,
                        0, 0.5, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(moving),       cmocka_unit_test(accelerating),
        cmocka_unit_test(spinning),     cmocka_unit_test(growing_from_nothing),
        cmocka_unit_test(a_key_inside), cmocka_unit_test(a_moving_camera),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
