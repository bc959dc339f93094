/* Content keys are complete: whatever changes a pixel changes the key, of all that can be
 * keyed, of all settings, and of files; and what changes none leaves it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <zoetrope/aov.h>

#include "files.h"
#include "keyframe/animation.h"
#include "scenes.h"
#include "sequence/renderer.h"

/* One of each thing, so that each can be seen; %s: the camera, and what the film has besides.
 */
static const char text[] =
    "zoetrope: 1\n"
    "film: { size: [32, 24], duration: 3, samples: 2%s }\n"
    "camera: { %s }\n"
    "materials:\n"
    "  squares: { color: [0.8, 0.7, 0.6], pattern: checker, other_color: [0.1, 0.2, 0.3],\n"
    "             pattern_size: 0.7, reflectivity: 0.2 }\n"
    "  barber: { color: [0.9, 0.1, 0.1], pattern: stripes, other_color: [1, 1, 1],\n"
    "            pattern_size: 0.3, pattern_direction: [1, 0.4, 0] }\n"
    "lights:\n"
    "  - ambient: { intensity: 0.2 }\n"
    "  - point: { position: [2, 5, 4], intensity: 9, radius: 0.3 }\n"
    "  - disk_light: { position: [-3, 5, 1], rotation: [-80, 0, 0], radius: 0.5, intensity: 9 "
    "}\n"
    "  - rectangle_light: { position: [0, 6, -1], rotation: [-90, 0, 0], width: 1, height: 2,\n"
    "                       intensity: 9 }\n"
    "objects:\n"
    "  - plane: { normal: [0, 1, 0], material: squares }\n"
    "  - sphere: { center: [-2, 0.6, 0], radius: 0.6, material: barber }\n"
    "  - triangle: { vertices: [[-1.5, 0, -1], [-0.3, 0.1, -1], [-1, 1.8, -1.1]], material: "
    "barber }\n"
    "  - disk: { center: [0, 1.6, -0.5], normal: [0, 0.3, 1], radius: 0.5, material: squares "
    "}\n"
    "  - box: { center: [0.9, 0.5, 0.3], size: [0.8, 1, 0.7], rotation: [0, 30, 0],\n"
    "           material: barber }\n"
    "  - cylinder: { from: [1.9, 0, 0], to: [2, 1.2, 0], radius: 0.3, material: barber }\n"
    "  - cone: { from: [2.8, 0, 0], to: [2.8, 1.2, 0], radius: 0.4, end_radius: 0.2,\n"
    "            material: squares }\n"
    "  - torus: { center: [-0.8, 0.4, 1.2], axis: [0.3, 1, 0.2], radius: 0.4, tube_radius: "
    "0.15,\n"
    "             material: barber }\n"
    "  - capsule: { from: [0.3, 0.2, 1.5], to: [0.9, 0.5, 1.4], radius: 0.2, material: barber "
    "}\n"
    "  - group:\n"
    "      position: [0.1, 0.2, 0]\n"
    "      objects:\n"
    "        - mesh: { file: k.ply, vertex_colors: true, position: [-2.6, 1.4, -0.5], "
    "material: squares }\n";

static const char model[] =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\n"
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0 -0.4 0 1 255 0 0\n1 0 0 0.4 0 1 0 255 0\n1 1 0 0.4 0 1 0 0 255\n"
    "0 1 0.2 -0.4 0 1 200 200 90\n3 0 1 2\n3 0 2 3\n";

static const char *const cameras[] = {
    "position: [0.3, 2, 7], look_at: [0.2, 0.8, 0], fov: 40 deg, aperture: 0.1, blades: 5, "
    "focus_distance: 6",
    "position: [0.3, 1, 7], rotation: [2, 1, 0], focal_length: 35, f_number: 0.005, "
    "focus_on: [0, 1, 1]",
    "position: [0.3, 2, 7], look_at: [0.2, 0.8, 0], lens: orthographic, height: 4"};
enum { CAMERAS = sizeof cameras / sizeof *cameras };

/* What is shown, and by which key. */
typedef struct shown {
    zt_image *image;
    zt_hash key;
} shown;

static void write_file(const char *path, const char *bytes) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(bytes, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static void open_film(zt_animation **animation, zt_renderer **renderer, const char *description,
                      const zt_render_settings *settings) {
    static heard h; /* renderers tell of frames later */
    zt_render_settings own = *settings;
    if (own.threads == 0) own.threads = 1;
    write_file("f.yaml", description);
    if (zt_animation_read(animation, "f.yaml", NULL, 0, listener_of(&h)) != ZT_OK)
        fail_msg("%s", h.text);
    assert_int_equal(zt_renderer_open(renderer, *animation, &own, listener_of(&h)), ZT_OK);
}

/* All of it is rendered, without what an earlier one has. */
static shown show(zt_renderer *r) {
    shown s;
    zt_output_format format = zt_renderer_format(r);
    assert_int_equal(zt_renderer_key(&s.key, r, 1), ZT_OK);
    assert_int_equal(zt_image_create(&s.image, format.width, format.height), ZT_OK);
    assert_int_equal(zt_image_add_aovs(s.image, r->aovs), ZT_OK);
    assert_int_equal(zt_renderer_take(r, 1, s.image, NULL), ZT_OK);
    return s;
}

static shown show_text(const char *description, const zt_render_settings *settings) {
    zt_animation *animation;
    zt_renderer *renderer;
    open_film(&animation, &renderer, description, settings);
    shown s = show(renderer);
    zt_renderer_close(&renderer);
    zt_animation_free(&animation);
    return s;
}

static bool same_image(const zt_image *a, const zt_image *b) {
    size_t size = (size_t)a->width * (size_t)a->height * sizeof(float);
    bool same = a->width == b->width && a->height == b->height &&
                a->channel_count == b->channel_count &&
                memcmp(a->pixels, b->pixels, 4 * size) == 0;
    for (int i = 0; i < a->channel_count && same; i++)
        same = memcmp(a->channels[i].values, b->channels[i].values, size) == 0;
    return same;
}

static bool same_key(const shown *a, const shown *b) { return zt_hash_equal(a->key, b->key); }

/* ---- all that can be keyed ------------------------------------------------------------------
 */

static const zt_thing *thing_of(const zt_animation *animation, zt_owner owner) {
    for (int i = 0; i < animation->thing_count; i++)
        if (animation->things[i].owner == owner) return &animation->things[i];
    return NULL;
}

/* Another value that is legal: each channel alone, by a little. */
static void change_value(double *value, const zt_property *p, int channel) {
    double turn[4] = {0.999, 0.02, -0.03, 0.01}; /* about a unit quaternion */
    if (p->kind == ZT_VALUE_SWITCH)
        *value = *value < 0.5;
    else if (p->kind == ZT_VALUE_ROTATION) {
        quat q = {value[0], value[1], value[2], value[3]},
             t = {turn[0], turn[1], turn[2], turn[3]};
        q = quat_normalize(quat_mul(t, q));
        value[0] = q.w, value[1] = q.x, value[2] = q.y, value[3] = q.z;
    } else {
        value[channel] = value[channel] * 0.9 + (value[channel] == 0 ? 0.05 : 0);
    }
}

/* Changes a property there and back; returns whether the image changed meanwhile. */
static bool try_property(zt_animation *animation, zt_renderer *r, const shown *usual,
                         const zt_property *p, int channel) {
    double value[ZT_VALUE_WIDTH_MAX], other[ZT_VALUE_WIDTH_MAX];
    const zt_thing *thing = thing_of(animation, p->owner);
    int32_t index = thing ? thing->index : 0; /* the camera is one alone */
    zt_property_get(value, p, &animation->rest, index);
    memcpy(other, value, sizeof other);
    change_value(other, p, channel);
    zt_property_set(p, &animation->rest, index, other);
    shown now = show(r);
    zt_property_set(p, &animation->rest, index, value);
    bool changed = !same_image(usual->image, now.image);
    if (changed && same_key(usual, &now))
        fail_msg("%s.%s, channel %d, is in no key", zt_owner_name(p->owner), p->name, channel);
    zt_image_free(&now.image);
    return changed;
}

/* With one camera or another, each property that there is decides pixels, and is in the key. */
static void all_properties_are_in_keys(void **state) {
    (void)state;
    bool seen[256] = {false};
    assert_true(zt_property_count <= 256);
    for (int c = 0; c < CAMERAS; c++) {
        char description[4096];
        zt_animation *animation;
        zt_renderer *r;
        snprintf(description, sizeof description, text, "", cameras[c]);
        open_film(&animation, &r, description, &(zt_render_settings){0});
        shown usual = show(r);
        for (int i = 0; i < zt_property_count; i++) {
            const zt_property *p = &zt_properties[i];
            bool whole = p->kind == ZT_VALUE_ROTATION;
            if (c > 0 && p->owner != ZT_OWNER_CAMERA) continue;
            for (int k = 0; k < (whole ? 1 : zt_value_width(p->kind)); k++)
                seen[i] |= try_property(animation, r, &usual, p, k);
        }
        shown again = show(r);
        assert_true(same_key(&usual, &again) && same_image(usual.image, again.image));
        zt_image_free(&usual.image);
        zt_image_free(&again.image);
        zt_renderer_close(&r);
        zt_animation_free(&animation);
    }
    for (int i = 0; i < zt_property_count; i++)
        if (!seen[i])
            fail_msg("%s.%s changes nothing", zt_owner_name(zt_properties[i].owner),
                     zt_properties[i].name);
}

/* ---- all else -------------------------------------------------------------------------------
 */

/* The usual film but for a word. */
static void replace(char out[4096], const char *in, const char *from, const char *to) {
    const char *at = strstr(in, from);
    if (!at) fail_msg("no %s", from);
    snprintf(out, 4096, "%.*s%s%s", (int)(at - in), in, to, at + strlen(from));
}

/* What a description says besides: what shows changes the key, and what does not leaves it. */
static void words_count_where_they_show(void **state) {
    (void)state;
    const struct {
        const char *from, *to;
        bool shows;
    } cases[] = {
        {"samples: 2", "samples: 3", true},
        {"samples: 2", "samples: { min: 1, max: 4, error: 0.05 }", true},
        {"samples: 2", "samples: 2, seed: 5", true},
        {"samples: 2", "samples: 2, seed: fixed", true},
        {"samples: 2", "samples: 2, filter: tent", true},
        {"samples: 2", "samples: 2, filter: { kind: gaussian, width: 3 }", true},
        {"samples: 2", "samples: 16, quality: edges", true},
        {"samples: 2", "samples: 2, reflections: 0", true},
        {"samples: 2", "samples: 2, aovs: [Z, P]", true},
        {"samples: 2", "samples: 2, background: transparent", true},
        {"size: [32, 24]", "size: [24, 32]", true},
        {"size: [32, 24]", "size: [32, 25]", true},
        {"blades: 5", "blades: 6", true},
        {"look_at: [0.2", "lens: equirectangular, look_at: [0.2", true},
        {"pattern: stripes", "pattern: checker", true},
        {"  - sphere: { center: [-2, 0.6, 0], radius: 0.6, material: barber }\n", "", true},
        {"file: k.ply", "file: k.ply, smooth: false", true},
        {"normal: [0, 1, 0], material: squares", "normal: [0, 1, 0], material: barber", true},
        {"zoetrope: 1\n", "zoetrope: 1\n# a remark\n\n", false},
        {"samples: 2", "samples: 2, view: raw", false},
        {"samples: 2", "samples: 2, rate: 30", false},
        {"duration: 3", "duration: 9", false},
        {"  - sphere: { center", "  - sphere: { name: ball, center", false},
        {"radius: 0.6, material: barber", "material: barber, radius: 0.6", false},
        {"size: [0.8, 1, 0.7], rotation", "size: [8e-1, 1.0, 0.70], rotation", false},
        {"intensity: 0.2 }", "color: white, intensity: 0.2 }", false},
        {"samples: 2", "samples: 2, shutter: 180 deg", false}, /* nothing moves */
    };
    char usual_text[4096], other_text[4096];
    snprintf(usual_text, sizeof usual_text, text, "", cameras[0]);
    shown usual = show_text(usual_text, &(zt_render_settings){0});
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        replace(other_text, usual_text, cases[i].from, cases[i].to);
        shown other = show_text(other_text, &(zt_render_settings){0});
        if (same_image(usual.image, other.image) == cases[i].shows)
            fail_msg("%s: the image", cases[i].to);
        if (same_key(&usual, &other) == cases[i].shows) fail_msg("%s: the key", cases[i].to);
        zt_image_free(&other.image);
    }
    zt_image_free(&usual.image);
}

/* Names may be others, wherever they are used. */
static void names_do_not_count(void **state) {
    (void)state;
    char usual_text[4096], other_text[4096];
    snprintf(usual_text, sizeof usual_text, text, "", cameras[0]);
    snprintf(other_text, sizeof other_text, text, "", cameras[0]);
    for (char *at = other_text; (at = strstr(at, "barber")); at++) memcpy(at, "zebras", 6);
    shown usual = show_text(usual_text, &(zt_render_settings){0}),
          other = show_text(other_text, &(zt_render_settings){.threads = 2});
    assert_true(same_key(&usual, &other) && same_image(usual.image, other.image));
    zt_image_free(&usual.image);
    zt_image_free(&other.image);
}

/* A film says what its runs can say otherwise; channels that move are of two frames. */
static void settings_count(void **state) {
    (void)state;
    const zt_render_settings cases[] = {{.width = 24, .height = 16},
                                        {.samples = 3},
                                        {.precision = ZT_PRECISION_DOUBLE},
                                        {.aovs = 1u << 2},
                                        {.aovs = ZT_AOV_MOTION}};
    char description[4096];
    snprintf(description, sizeof description, text, "", cameras[0]);
    shown usual = show_text(description, &(zt_render_settings){0});
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        shown other = show_text(description, &cases[i]);
        assert_false(same_image(usual.image, other.image));
        assert_false(same_key(&usual, &other));
        zt_image_free(&other.image);
    }
    zt_image_free(&usual.image);
}

/* What moves: by how the shutter is open, and, where motion is a channel, by what comes next.
 */
static void motion_counts(void **state) {
    (void)state;
    const struct {
        const char *film, *to;
        unsigned aovs;
        bool shows;
    } cases[] = {{"", "1: [-2, 0.6, 0], 2: [-1, 0.6, 0]", 0, false},
                 {"", "1: [-2, 0.6, 0], 2: [-1, 0.6, 0]", ZT_AOV_MOTION, true},
                 {"", "1: [-2.1, 0.6, 0], 2: [-2, 0.6, 0]", 0, true},
                 {", shutter: 360 deg", "1: [-2, 0.6, 0], 2: [-1, 0.6, 0]", 0, true},
                 {", shutter: 180 deg", "1: [-2, 0.6, 0], 2: [-2, 0.6, 0]", 0, false}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char base[4096], still[4096], moving[4096], keys[256];
        snprintf(base, sizeof base, text, cases[i].film, cameras[0]);
        snprintf(keys, sizeof keys, "center: { curve: linear, keys: { %s } }", cases[i].to);
        replace(still, base, "center: [-2, 0.6, 0]",
                "center: { curve: linear, keys: { 1: [-2, 0.6, 0], 2: [-2, 0.6, 0] } }");
        replace(moving, base, "center: [-2, 0.6, 0]", keys);
        zt_render_settings settings = {.aovs = cases[i].aovs};
        shown a = show_text(still, &settings), b = show_text(moving, &settings);
        if (same_image(a.image, b.image) == cases[i].shows) fail_msg("%zu: the image", i);
        if (same_key(&a, &b) == cases[i].shows) fail_msg("%zu: the key", i);
        zt_image_free(&a.image);
        zt_image_free(&b.image);
    }
}

/* A model counts by what it holds, each part of it, and not by its name. */
static void models_count(void **state) {
    (void)state;
    const struct {
        const char *from, *to;
    } cases[] = {{"\n1 1 0 ", "\n1 1.3 0 "},
                 {"0 0 0 -0.4 0 1", "0 0 0 -0.9 0 1"},
                 {"0 255 0", "9 255 0"},
                 {"3 0 1 2\n3 0 2 3", "3 0 1 3\n3 1 2 3"}};
    char description[4096], other[4096], renamed[4096];
    snprintf(description, sizeof description, text, "", cameras[0]);
    replace(renamed, description, "file: k.ply", "file: other.ply");
    write_file("other.ply", model);
    shown usual = show_text(description, &(zt_render_settings){0}),
          same = show_text(renamed, &(zt_render_settings){0});
    assert_true(same_key(&usual, &same) && same_image(usual.image, same.image));
    zt_image_free(&same.image);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        replace(other, model, cases[i].from, cases[i].to);
        write_file("k.ply", other);
        shown now = show_text(description, &(zt_render_settings){0});
        if (same_image(usual.image, now.image)) fail_msg("%s: the image", cases[i].to);
        if (same_key(&usual, &now)) fail_msg("%s: the key", cases[i].to);
        zt_image_free(&now.image);
    }
    zt_image_free(&usual.image);
    write_file("k.ply", model);
}

static int begin(void **state) {
    int failed = files_begin(state);
    if (!failed) write_file("k.ply", model);
    return failed;
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(all_properties_are_in_keys),
                                       cmocka_unit_test(words_count_where_they_show),
                                       cmocka_unit_test(names_do_not_count),
                                       cmocka_unit_test(settings_count),
                                       cmocka_unit_test(motion_counts),
                                       cmocka_unit_test(models_count)};
    return cmocka_run_group_tests(tests, begin, files_end);
}
