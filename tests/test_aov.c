/* What images tell besides their colours: against closed forms, whatever the lens, the motion
 * and how far from the world's origin all is; and that telling it changes no colour. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/vec.h"
#include "pictures.h"

enum { WIDTH = 50, HEIGHT = 34 }; /* no whole number of tiles */

/* ---- names ----------------------------------------------------------------------------------
 */

/* Each name of the list is one, and has bits of its own; all of them together are "all". */
static void names(void **state) {
    (void)state;
    char list[256];
    unsigned together = 0, found;
    snprintf(list, sizeof list, "%s", zt_aov_names());
    for (char *rest, *name = strtok_r(list, ", ", &rest); name;
         name = strtok_r(NULL, ", ", &rest)) {
        assert_true(zt_aov_find(&found, name));
        if (strcmp(name, "all") == 0)
            assert_int_equal(found, together);
        else
            assert_int_equal(found & together, 0);
        together |= found;
    }
    assert_int_equal(together, ZT_AOV_ALL);
    const char *const others[] = {"", "z", "P.X", "depth", "id", "Z,N", "al", "motion.x"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        assert_false(zt_aov_find(&found, others[i]));
}

static void channels(void **state) {
    (void)state;
    static const char *const all[] = {"Z",         "P.X",         "P.Y",      "P.Z",
                                      "N.X",       "N.Y",         "N.Z",      "albedo.R",
                                      "albedo.G",  "albedo.B",    "motion.x", "motion.y",
                                      "id.object", "id.material", "samples",  "error"};
    zt_image *image;
    assert_int_equal(zt_image_create(&image, 3, 2), ZT_OK);
    assert_int_equal(zt_image_add_aovs(image, 0), ZT_OK);
    assert_int_equal(image->channel_count, 0);
    for (int twice = 0; twice < 2; twice++) {
        assert_int_equal(zt_image_add_aovs(image, ZT_AOV_ALL), ZT_OK);
        assert_int_equal(image->channel_count, sizeof all / sizeof *all);
        for (int i = 0; i < image->channel_count; i++)
            assert_string_equal(image->channels[i].name, all[i]);
    }
    zt_image_free(&image);
    assert_int_equal(zt_image_create(&image, 3, 2), ZT_OK);
    assert_int_equal(zt_image_add_aovs(image, ZT_AOV_ERROR | ZT_AOV_N), ZT_OK);
    assert_int_equal(image->channel_count, 4);
    assert_string_equal(image->channels[0].name, "N.X");
    assert_string_equal(image->channels[3].name, "error");
    zt_image_free(&image);
}

static void description(void **state) {
    (void)state;
    assert_int_equal(film_of_words("").aovs, 0);
    assert_int_equal(film_of_words(", aovs: []").aovs, 0);
    assert_int_equal(film_of_words(", aovs: all").aovs, ZT_AOV_ALL);
    assert_int_equal(film_of_words(", aovs: N").aovs, ZT_AOV_N);
    assert_int_equal(film_of_words(", aovs: [id.object, Z, Z]").aovs, ZT_AOV_Z | ZT_AOV_OBJECT);
}

/* ---- pictures -------------------------------------------------------------------------------
 */

static zt_image *taken(const char *text, int64_t frame, unsigned aovs, int threads) {
    return picture_of(text, frame,
                      &(zt_render_settings){
                          .width = WIDTH, .height = HEIGHT, .threads = threads, .aovs = aovs});
}

static double value(const zt_image *image, const char *name, int x, int y) {
    const float *values = zt_image_channel(image, name);
    assert_non_null(values);
    return (double)values[y * WIDTH + x];
}
static vec3 values(const zt_image *image, const char *x_name, const char *y_name,
                   const char *z_name, int x, int y) {
    return (vec3){value(image, x_name, x, y), value(image, y_name, x, y),
                  value(image, z_name, x, y)};
}

/* Within what single precision has of numbers as large as `size`. */
static void assert_near(double is, double expected, double size, const char *what, int x,
                        int y) {
    if (!(fabs(is - expected) <= 4e-6 * size))
        fail_msg("%s at %d, %d: %.9g, not %.9g", what, x, y, is, expected);
}
static void assert_vec3_near(vec3 is, vec3 expected, double size, const char *what, int x,
                             int y) {
    assert_near(is.x, expected.x, size, what, x, y);
    assert_near(is.y, expected.y, size, what, x, y);
    assert_near(is.z, expected.z, size, what, x, y);
}

/* A ball of radius 1 around the middle of its world, before a wall at z = -3 that ends at
 * x = 4; two other things, which nothing shows, count in the numbers. The camera looks along -z
 * from `eye`. `at` is where the middle of that world is in the other one. */
typedef struct stage {
    vec3 at, eye;
    bool flat; /* an orthographic lens, 6 high; else a fov of 60 degrees */
} stage;

/* What the ray through a pixel's middle meets. */
typedef struct seen {
    int object, material;
    double depth;
    vec3 place, normal, color;
} seen;

static seen look(const stage *s, int x, int y) {
    double step = s->flat ? 6.0 / HEIGHT : 2 * tan(acos(-1) / 6) / HEIGHT;
    double right = (x + 0.5 - WIDTH / 2.0) * step, up = (HEIGHT / 2.0 - y - 0.5) * step;
    vec3 o = s->eye, d = {right, up, -1};
    if (s->flat) o = (vec3){o.x + right, o.y + up, o.z}, d = (vec3){0, 0, -1};
    double a = vec3_dot(d, d), b = vec3_dot(o, d), c = vec3_dot(o, o) - 1;
    double root = b * b - a * c;
    if (fabs(root) < 0.05) return (seen){.object = -1}; /* too near to the edge to be sure */
    if (root > 0) {
        double t = (-b - sqrt(root)) / a;
        vec3 p = vec3_add(o, vec3_scale(d, t));
        return (seen){3, 3, t, vec3_add(p, s->at), p, {1, 1, 1}};
    }
    double t = o.z + 3;
    vec3 p = vec3_add(o, vec3_scale(d, t));
    if (fabs(p.x - 4) < 0.01) return (seen){.object = -1};
    if (p.x > 4) return (seen){.depth = INFINITY};
    return (seen){2, 2, t, vec3_add(p, s->at), {0, 0, 1}, {1, 0, 0}};
}

/* `size` is that of the numbers in the world. */
static void check(const zt_image *image, const stage *s, double size) {
    int counts[4] = {0};
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            seen e = look(s, x, y);
            if (e.object < 0) continue;
            counts[e.object]++;
            assert_true(value(image, "id.object", x, y) == e.object);
            assert_true(value(image, "id.material", x, y) == e.material);
            if (e.object)
                assert_near(value(image, "Z", x, y), e.depth, 10, "Z", x, y);
            else
                assert_true(value(image, "Z", x, y) == INFINITY);
            assert_vec3_near(values(image, "P.X", "P.Y", "P.Z", x, y), e.place,
                             e.object ? size : 0, "P", x, y);
            assert_vec3_near(values(image, "N.X", "N.Y", "N.Z", x, y), e.normal,
                             e.object ? 4 : 0, "N", x, y);
            assert_vec3_near(values(image, "albedo.R", "albedo.G", "albedo.B", x, y), e.color,
                             0, "albedo", x, y);
        }
    }
    /* There was something to see of each. */
    assert_true(counts[0] > 20 && counts[2] > 100 && counts[3] > 50);
}

/* The stage as a description; `film` and `camera` say more of these. */
static const char *text_of(const stage *s, const char *film, const char *camera) {
    static char text[2048];
    const vec3 a = s->at, e = vec3_add(a, s->eye);
    snprintf(text, sizeof text,
             "zoetrope: 1\n"
             "film: { duration: 24%s }\n"
             "camera: { look_at: [%.17g, %.17g, %.17g], %s,\n"
             "          position: [%.17g, %.17g, %.17g]%s }\n"
             "lights:\n"
             "  - ambient: { intensity: 0.2 }\n"
             "  - point: { position: [%.17g, %.17g, %.17g], intensity: 60 }\n"
             "objects:\n"
             "  - sphere: { center: [%.17g, %.17g, %.17g], radius: 1 }\n"
             "  - box: { center: [%.17g, %.17g, %.17g], size: [104, 200, 2],\n"
             "           material: { color: red } }\n"
             "  - sphere: { center: [%.17g, %.17g, %.17g], radius: 1,\n"
             "              material: { color: white, reflectivity: 0.3 } }\n",
             film, e.x, e.y, e.z - 1, s->flat ? "lens: orthographic, height: 6" : "fov: 60 deg",
             e.x, e.y, e.z, camera, a.x + 3, a.y + 4, a.z + 5, a.x, a.y, a.z + 500, a.x - 48,
             a.y, a.z - 4, a.x, a.y, a.z);
    return text;
}

/* Near and a million away, through both kinds of lens; a wide opening makes no difference. */
static void against_closed_forms(void **state) {
    (void)state;
    const vec3 near = {0, 0, 0}, far = {1e6, -1e6, 1e6}, eye = {0.25, 0.5, 5};
    const stage stages[] = {
        {near, eye, false}, {near, eye, true}, {far, eye, false}, {far, eye, true}};
    const char *const lenses[] = {"", ", aperture: 0.5, focus_distance: 2",
                                  ", aperture: 0.5, focus_distance: 2, blades: 5"};
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 3; k++) {
            zt_image *image = taken(text_of(&stages[i], "", lenses[k]), 0, ZT_AOV_ALL, 2);
            /* Places are rounded once: to half of the last bit of a million. */
            check(image, &stages[i], stages[i].at.x > 0 ? 0.03126 / 4e-6 : 10);
            zt_image_free(&image);
        }
    }
}

/* A camera that passes by is where it is in the middle of the opening. */
static void moving_camera(void **state) {
    (void)state;
    const stage s = {{0, 0, 0}, {0.25, 0.5, 5}, false};
    /* At the stage's eye at frame 10.25. */
    static const char keys[] = "rotation: [0, 0, 0], position: { curve: linear, keys: {\n"
                               "  0: [-10, 10.75, 15.25], 20: [10, -9.25, -4.75] } } }\n";
    static char text[4096];
    const char *still = text_of(&s, ", shutter: 180 deg", "");
    const char *camera = strstr(still, "look_at"), *fov = strstr(still, "fov"),
               *position = strstr(still, "position"), *rest = strstr(still, "lights");
    snprintf(text, sizeof text, "%.*s%.*s%s%s", (int)(camera - still), still,
             (int)(position - fov), fov, keys, rest);
    zt_image *image = taken(text, 10, ZT_AOV_ALL, 1);
    check(image, &s, 10);
    zt_image_free(&image);
}

/* So is what moves before it. */
static void moving_ball(void **state) {
    (void)state;
    const stage s = {{0, 0, 0}, {0.25, 0.5, 5}, false};
    static const char keys[] = "  - sphere: { center: { curve: linear, keys: {\n"
                               "      0: [-20.5, 10.25, 0], 20: [19.5, -9.75, 0] } },\n"
                               "      radius: 1, material: { color: white } }\n";
    static char text[4096];
    const char *still = text_of(&s, ", shutter: 180 deg", ""),
               *ball = strstr(strstr(still, "- box"), "  - sphere");
    snprintf(text, sizeof text, "%.*s%s", (int)(ball - still), still, keys);
    zt_image *image = taken(text, 10, ZT_AOV_ALL, 2);
    check(image, &s, 60); /* of the way that it goes */
    zt_image_free(&image);
}

/* Of patterns the color of the cell, of models that of their corners, whatever lights them: a
 * wall of cells 2 long before which a triangle stands. Nothing is lit. */
static void own_colors(void **state) {
    (void)state;
    static const char ply[] = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                              "property float y\nproperty float z\nproperty float red\n"
                              "property float green\nproperty float blue\nelement face 1\n"
                              "property list uchar int vertex_indices\nend_header\n"
                              "0 0 0 1 0 0\n20 0 0 0 1 0\n0 20 0 0 0 1\n3 0 1 2\n";
    static const char text[] =
        "zoetrope: 1\nfilm: { duration: 1 }\n"
        "camera: { lens: orthographic, height: 34, position: [0.2, 0.3, 9],\n"
        "          rotation: [0, 0, 0] }\n"
        "objects:\n"
        "  - plane: { normal: [0, 0, 1], distance: -1, material: { pattern: checker,\n"
        "             color: [0.5, 0.25, 1], other_color: [0, 0.125, 0], pattern_size: 2 } }\n"
        "  - mesh: { file: colors.ply, vertex_colors: true, material: { color: [0.5, 1, 1] } "
        "}\n";
    write_bytes("colors.ply", ply, sizeof ply - 1);
    zt_image *image = taken(text, 0, ZT_AOV_ALBEDO, 2);
    int counts[3] = {0};
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            double right = x + 0.5 - WIDTH / 2.0 + 0.2, up = HEIGHT / 2.0 - y - 0.5 + 0.3;
            bool on = right > 0 && up > 0 && right + up < 20;
            bool odd = (int)(floor(right / 2) + floor(up / 2) - 1) % 2 != 0;
            vec3 cell = odd ? (vec3){0, 0.125, 0} : (vec3){0.5, 0.25, 1};
            vec3 mixed = {0.5 * (1 - (right + up) / 20), right / 20, up / 20};
            counts[on ? 2 : odd]++;
            assert_vec3_near(values(image, "albedo.R", "albedo.G", "albedo.B", x, y),
                             on ? mixed : cell, 1, "albedo", x, y);
        }
    }
    assert_true(counts[0] > 100 && counts[1] > 100 && counts[2] > 100);
    zt_image_free(&image);
}

/* The colours have the same bits with channels and without, and all has with one thread and
 * with two; for even samples, and where some pixels take more. */
static void same_bits(void **state) {
    (void)state;
    const stage s = {{0, 0, 0}, {0.25, 0.5, 5}, false};
    const char *const films[] = {"", ", samples: 4, shutter: 180 deg", ", quality: edges",
                                 ", samples: { min: 2, max: 16, error: 0.01 }"};
    for (size_t i = 0; i < sizeof films / sizeof *films; i++) {
        const char *text = text_of(&s, films[i], "");
        zt_image *plain = taken(text, 3, 0, 2), *one = taken(text, 3, ZT_AOV_ALL, 1),
                 *two = taken(text, 3, ZT_AOV_ALL, 2);
        size_t size = (size_t)WIDTH * HEIGHT * sizeof(float);
        assert_memory_equal(plain->pixels, one->pixels, 4 * size);
        assert_memory_equal(plain->pixels, two->pixels, 4 * size);
        for (int k = 0; k < one->channel_count; k++)
            assert_memory_equal(one->channels[k].values, two->channels[k].values, size);
        /* One alone is what it is among all. */
        zt_image *alone = taken(text, 3, ZT_AOV_OBJECT, 2);
        assert_int_equal(alone->channel_count, 1);
        assert_memory_equal(alone->channels[0].values, zt_image_channel(one, "id.object"),
                            size);
        zt_image_free(&alone);
        zt_image_free(&plain);
        zt_image_free(&one);
        zt_image_free(&two);
    }
}

static bool stop_at_once(void *user) { return ++*(int *)user > 0; }

static void stopped(void **state) {
    (void)state;
    const stage s = {{0, 0, 0}, {0.25, 0.5, 5}, false};
    zt_animation *animation = animation_of(text_of(&s, "", ""));
    zt_renderer *renderer;
    zt_image *image;
    int asked = 0;
    zt_watcher watcher = {.stopped = stop_at_once, .user = &asked};
    zt_render_settings settings = {.width = WIDTH, .height = HEIGHT, .threads = 1};
    assert_int_equal(zt_renderer_open(&renderer, animation, &settings, (zt_listener){0}),
                     ZT_OK);
    assert_int_equal(zt_image_create(&image, WIDTH, HEIGHT), ZT_OK);
    assert_int_equal(zt_image_add_aovs(image, ZT_AOV_ALL), ZT_OK);
    assert_int_equal(zt_renderer_frame(renderer, 0, image, &watcher), ZT_ESTOPPED);
    /* Within the guides: each of the picture's twelve tiles is let through. */
    asked = -12;
    assert_int_equal(zt_renderer_frame(renderer, 0, image, &watcher), ZT_ESTOPPED);
    asked = -1000;
    assert_int_equal(zt_renderer_frame(renderer, 0, image, &watcher), ZT_OK);
    zt_image_free(&image);
    zt_renderer_close(&renderer);
    zt_animation_free(&animation);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names),         cmocka_unit_test(channels),
        cmocka_unit_test(description),   cmocka_unit_test(against_closed_forms),
        cmocka_unit_test(moving_camera), cmocka_unit_test(moving_ball),
        cmocka_unit_test(own_colors),    cmocka_unit_test(same_bits),
        cmocka_unit_test(stopped)};
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
