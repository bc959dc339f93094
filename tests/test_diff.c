/* Shows which frames of a film change by what is changed in its description, as follows from
 * its keys, and what is said to be the cause of it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <zoetrope/diff.h>

#include "program.h"

/* Twelve frames: the ball rests until 4, moves until 8, and rests again. */
static const char still[] =
    "zoetrope: 1\n"
    "film: { size: [16, 10], rate: 12, duration: 1 s }\n"
    "camera: { position: [0, 1, 6], look_at: [0, 1, 0], fov: 40 deg }\n"
    "materials:\n"
    "  clay: { color: [0.5, 0.4, 0.3] }\n"
    "  lead: { color: [0.1, 0.1, 0.1] }\n"
    "lights:\n"
    "  - point: { name: lamp, position: [2, 4, 2], intensity: 30 }\n"
    "objects:\n"
    "  - group: { name: carriage, objects: [] }\n"
    "  - mesh: { name: roof, file: m.ply, material: lead }\n"
    "  - sphere:\n"
    "      name: ball\n"
    "      material: clay\n"
    "      radius: 1\n"
    "      center: { curve: linear, keys: { 0: [0, 1, 0], 4: [0, 1, 0], 8: [2, 1, 0] } }\n";
static const char mesh[] = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                           "property float y\nproperty float z\nelement face 1\n"
                           "property list uchar int vertex_indices\nend_header\n"
                           "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

enum { CHANGES_MAX = 3 };

/* Texts of the film, and what stands in their place. */
typedef struct change {
    const char *from, *to;
} change;

static void write_changed(const char *path, const change changes[CHANGES_MAX]) {
    char text[4096], next[4096];
    strcpy(text, still);
    for (int i = 0; i < CHANGES_MAX && changes[i].from; i++) {
        const char *at = strstr(text, changes[i].from);
        if (!at) fail_msg("no %s", changes[i].from);
        snprintf(next, sizeof next, "%.*s%s%s", (int)(at - text), text, changes[i].to,
                 at + strlen(changes[i].from));
        strcpy(text, next);
    }
    write_text(path, text);
}

typedef struct side {
    zt_animation *animation;
    zt_renderer *renderer;
} side;

static side open_side(const char *path, heard *h) {
    const zt_render_settings settings = {.threads = 1};
    side s;
    if (zt_animation_read(&s.animation, path, NULL, 0, listener_of(h)) != ZT_OK)
        fail_msg("%s", h->text);
    assert_int_equal(zt_renderer_open(&s.renderer, s.animation, &settings, listener_of(h)),
                     ZT_OK);
    return s;
}

static void close_side(side *s) {
    zt_renderer_close(&s->renderer);
    zt_animation_free(&s->animation);
}

/* What differs, "5-11: ball.center; 0-11: camera.fov", then behind a | what is rendered. */
static const char *describe(char text[1024], const zt_diff *d) {
    char *end = text;
    *end = '\0';
    for (int64_t i = 0; i < d->cause_count; i++) {
        const zt_diff_cause *c = &d->causes[i];
        for (int64_t k = 0; k < c->spans.count; k++)
            end += sprintf(end, "%s%d-%d", k ? "," : "", (int)c->spans.all[k].first,
                           (int)c->spans.all[k].last);
        end += sprintf(end, " %s; ", c->name);
    }
    end += sprintf(end, "|");
    for (int64_t i = 0; i < d->frame_count; i++) end += sprintf(end, " %d", (int)d->frames[i]);
    return text;
}

static const char *diff(char text[1024], const change older[CHANGES_MAX],
                        const change newer[CHANGES_MAX]) {
    heard h;
    zt_diff *d;
    write_changed("older.yaml", older);
    write_changed("newer.yaml", newer);
    side was = open_side("older.yaml", &h), is = open_side("newer.yaml", &h);
    assert_int_equal(zt_diff_find(&d, was.renderer, is.renderer, NULL), ZT_OK);
    describe(text, d);
    int64_t changed = 0;
    for (int64_t k = 0; k < d->changed.count; k++)
        changed += d->changed.all[k].last - d->changed.all[k].first + 1;
    assert_int_equal(changed, d->changed_count);
    zt_diff_free(&d);
    assert_null(d);
    close_side(&was);
    close_side(&is);
    return text;
}

static int begin(void **state) {
    if (enter_directory(state) != 0) return -1;
    write_text("m.ply", mesh);
    write_text("n.ply", mesh);
    char text[1024];
    snprintf(text, sizeof text, "%.*s0.5 1 0\n3 0 1 2\n",
             (int)(strstr(mesh, "0 1 0\n3") - mesh), mesh);
    write_text("other.ply", text);
    return 0;
}

/* A change of one thing: which frames it reaches, by the keys alone; those that show the same
 * as the one before are rendered once. */
static void causes(void **state) {
    (void)state;
    static const struct {
        change change[CHANGES_MAX];
        const char *told;
    } cases[] = {
        {{{"zoetrope: 1\n", "zoetrope: 1 # with a comment\n"}}, "|"},
        {{{"clay: {", "mud: {"}, {"material: clay", "material: mud"}}, "|"},
        {{{"name: ball", "name: globe"}}, "|"},
        {{{"m.ply", "n.ply"}}, "|"},
        {{{"8: [2, 1, 0]", "8: [3, 1, 0]"}}, "5-11 ball.center; | 5 6 7 8"},
        {{{"4: [0, 1, 0]", "4: [0, 1, 1]"}}, "1-7 ball.center; | 1 2 3 4 5 6 7"},
        {{{"fov: 40 deg", "fov: { curve: hold, keys: { 0: 40, 2: 41, 6: 40 } }"}},
         "2-5 camera.fov; | 2 5"},
        {{{"fov: 40 deg", "fov: { curve: hold, keys: { 0: 40, 2: 41, 3: 40, 9: 50 } }"},
          {"8: [2, 1, 0]", "8: [3, 1, 0]"}},
         "2-2,9-11 camera.fov; 5-11 ball.center; | 2 5 6 7 8 9"},
        {{{"intensity: 30", "intensity: 31, radius: 0.1"}},
         "0-11 lamp.intensity; 0-11 lamp.radius; | 0 5 6 7 8"},
        {{{"material: clay", "material: lead"}}, "0-11 ball.material; | 0 5 6 7 8"},
        {{{"clay: { color: [0.5", "clay: { pattern: checker, color: [0.6"}},
         "0-11 clay.color; 0-11 clay.pattern; | 0 5 6 7 8"},
        {{{"m.ply", "other.ply"}}, "0-11 roof.file; | 0 5 6 7 8"},
        {{{"look_at: [0, 1, 0]", "rotation: [0, 0, 0]"}}, "0-11 camera.look_at; | 0 5 6 7 8"},
        {{{"fov: 40 deg", "fov: 40 deg, lens: orthographic"}}, "0-11 camera.lens; | 0 5 6 7 8"},
        {{{"objects:\n", "objects:\n  - sphere: { center: [9, 0, 0], radius: 1 }\n"}},
         "0-11 sphere 1 (new); | 0 5 6 7 8"},
        {{{"  - point: { name: lamp, position: [2, 4, 2], intensity: 30 }\n",
           "  - ambient: { intensity: 1 }\n"}},
         "0-11 ambient 1 (new); 0-11 lamp (gone); | 0 5 6 7 8"},
        {{{"rate: 12", "rate: 12, samples: 2, filter: tent, reflections: 1"}},
         "0-11 film.filter; 0-11 film.reflections; 0-11 film.samples; | 0 5 6 7 8"},
        {{{"rate: 12", "rate: 12, seed: 1"}}, "0-11 film.seed; | 0 5 6 7 8"},
        {{{"rate: 12", "rate: 12, view: filmic"}}, "|"},
        {{{"[16, 10]", "[16, 12]"}}, "0-11 film.size; | 0 5 6 7 8"},
        {{{"rate: 12", "rate: 12, quality: edges, background: transparent, aovs: [Z]"}},
         "0-11 film.aovs; 0-11 film.background; 0-11 film.quality; 0-11 film.samples; | 0 5 6 "
         "7 8"},
        {{{"duration: 1 s", "duration: 1.25 s"}}, "| 12"},
        {{{"duration: 1 s", "duration: 0.5 s"}}, "|"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[1024];
        diff(text, (change[CHANGES_MAX]){{0}}, cases[i].change);
        if (strcmp(text, cases[i].told) != 0)
            fail_msg("%s: \"%s\" instead of \"%s\"", cases[i].change[0].to, text,
                     cases[i].told);
    }
}

/* A shutter that opens longer shows only where something moves, and is the only cause: the
 * ball's way is the same. */
static void shutters(void **state) {
    (void)state;
    char text[1024];
    diff(text, (change[CHANGES_MAX]){{"rate: 12", "rate: 12, shutter: 90 deg"}},
         (change[CHANGES_MAX]){{"rate: 12", "rate: 12, shutter: 180 deg"}});
    assert_string_equal(text, "4-7 film.shutter; | 4 5 6 7");
    /* From 4 on it moves within the opening, though at 4 itself it is where it was. */
    diff(text, (change[CHANGES_MAX]){{"rate: 12", "rate: 12, shutter: 180 deg"}},
         (change[CHANGES_MAX]){{"rate: 12", "rate: 12, shutter: 180 deg"},
                               {"8: [2, 1, 0]", "8: [3, 1, 0]"}});
    assert_string_equal(text, "4-11 ball.center; | 4 5 6 7 8");
}

/* Things in another order are the cause where nothing else is. */
static void order(void **state) {
    (void)state;
    char text[1024];
    const char *ball = strstr(still, "  - sphere"), *group = strstr(still, "  - group");
    char swapped[1024];
    snprintf(swapped, sizeof swapped, "%s%.*s", ball, (int)(ball - group), group);
    diff(text, (change[CHANGES_MAX]){{0}}, (change[CHANGES_MAX]){{group, swapped}});
    assert_string_equal(text, "0-11 ball.order; 0-11 carriage.order; 0-11 roof.order; | 0 5 6 "
                              "7 8");
}

/* Times are what the manifest says of those frames, others as long on average; where it says
 * nothing that holds, they are measured. */
static void times(void **state) {
    (void)state;
    heard h;
    zt_diff *d;
    zt_diff_time time;
    zt_manifest *manifest;
    const zt_render_settings settings = {.threads = 1};
    write_changed("older.yaml", (change[CHANGES_MAX]){{0}});
    write_changed("newer.yaml", (change[CHANGES_MAX]){{"8: [2, 1, 0]", "8: [3, 1, 0]"}});
    write_text("m", "{\"zoetrope\": 1, \"description\": \"newer.yaml\", \"size\": [16, 10], "
                    "\"precision\": \"auto\", \"written\": \"\"}\n"
                    "{\"frame\": 4, \"time\": 100}\n"
                    "{\"frame\": 5, \"time\": 2}\n"
                    "{\"frame\": 6, \"time\": 99}\n"
                    "{\"frame\": 6, \"time\": 3}\n"
                    "{\"frame\": 8, \"time\": 7}\n");
    side was = open_side("older.yaml", &h), is = open_side("newer.yaml", &h);
    assert_int_equal(zt_diff_find(&d, was.renderer, is.renderer, NULL), ZT_OK);
    assert_int_equal(d->frame_count, 4); /* 5 6 7 8 */
    assert_int_equal(zt_manifest_read(&manifest, "m", listener_of(&h)), ZT_OK);
    assert_int_equal(
        zt_diff_estimate(&time, d, manifest, is.animation, &settings, NULL, listener_of(&h)),
        ZT_OK);
    assert_int_equal(time.known_count, 3);
    assert_true(time.seconds == 16);
    zt_render_settings larger = settings;
    larger.width = 32;
    larger.height = 20;
    assert_int_equal(
        zt_diff_estimate(&time, d, manifest, is.animation, &larger, NULL, listener_of(&h)),
        ZT_OK);
    assert_int_equal(time.known_count, 0);
    assert_int_equal(time.measured_count, 2);
    assert_int_equal(time.measured[0], 6);
    assert_int_equal(time.measured[1], 8);
    assert_int_equal(time.measured_part, 1);
    assert_true(time.seconds > 0 && time.seconds < 10);
    larger.width = 640;
    larger.height = 400;
    assert_int_equal(
        zt_diff_estimate(&time, d, NULL, is.animation, &larger, NULL, listener_of(&h)), ZT_OK);
    assert_int_equal(time.measured_part, 4);
    assert_true(time.seconds > 0);
    zt_manifest_free(&manifest);
    zt_diff_free(&d);
    close_side(&was);
    close_side(&is);
}

/* The program says it in lines that a person reads; times come from the target's manifest. */
static void program_says(void **state) {
    (void)state;
    write_changed("older.yaml", (change[CHANGES_MAX]){{0}});
    write_changed("newer.yaml",
                  (change[CHANGES_MAX]){{"8: [2, 1, 0]", "8: [3, 1, 0]"},
                                        {"intensity: 30", "intensity: 31, radius: 0.1"},
                                        {"duration: 1 s", "duration: 1.25 s, view: filmic"}});
    run *r = zoetrope("diff older.yaml older.yaml");
    assert_int_equal(r->code, 0);
    assert_string_equal(r->out, "no frame changes\n");
    assert_string_equal(r->err, "");
    r = zoetrope("diff older.yaml newer.yaml -o t.##.png");
    assert_int_equal(r->code, 0);
    assert_contains(r->err, "warning: there is no t.##.png.manifest, which would tell times");
    const char *const lines[] = {"12 of 12 frames change",
                                 "frames 0-11: lamp.intensity, lamp.radius",
                                 "frames 5-11: ball.center", "frames 12-14 are new",
                                 "film.view is filmic and was srgb: "};
    char line[256];
    for (int i = 0; i < 5; i++) assert_contains(line_of(line, r->out, i), lines[i]);
    assert_contains(line_of(line, r->out, 5), "rendering 5 frames takes about ");
    assert_contains(line, ": frames 5 and 7 took as much");
    assert_string_equal(line_of(line, r->out, 6), "");
    zoetrope_succeeds("render older.yaml --frames 0-7 -o t.##.png");
    r = zoetrope("diff older.yaml newer.yaml -o t.##.png");
    assert_int_equal(r->code, 0);
    assert_string_equal(r->err, "");
    assert_contains(line_of(line, r->out, 5), ": t.##.png.manifest knows 4 of them");
    r = zoetrope("diff newer.yaml older.yaml -o t.##.png --set film.view=srgb");
    assert_contains(r->out, "frames 12-14 are gone\n");
    assert_null(strstr(r->out, "film.view"));
    r = zoetrope("diff older.yaml none.yaml");
    assert_int_equal(r->code, 3);
    assert_contains(r->err, "none.yaml");
}

#define IN_FILES(test) cmocka_unit_test_setup_teardown(test, begin, leave_directory)

int main(void) {
    const struct CMUnitTest tests[] = {
        IN_FILES(causes), IN_FILES(shutters),     IN_FILES(order),
        IN_FILES(times),  IN_FILES(program_says),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
