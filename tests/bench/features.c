/* What each way of sampling costs: samples a second of the documents' room, plain and with one
 * thing more. */
#include <stdio.h>

#include "bench.h"
#include "measure.h"

enum { ROUNDS = 5, SAMPLES = 16, OVERRIDES_MAX = 4 };

typedef struct feature {
    const char *name;
    zt_override overrides[OVERRIDES_MAX]; /* and film.samples; end with an empty name */
} feature;

/* A ball that crosses a third of the picture while the shutter is open. */
#define MOVING                                                                                 \
    {                                                                                          \
        "ball.center",                                                                         \
            "{ curve: linear, after: loop, keys: { 0: [1.7, 0.9, 0.3], 1: [-1, 1.4, 0.3] } }"  \
    }

static const feature features[] = {
    {"plain", {{NULL, NULL}}},
    {"tent", {{"film.filter", "tent"}}},
    {"gaussian", {{"film.filter", "gaussian"}}},
    {"mitchell", {{"film.filter", "mitchell"}}},
    {"blackman-harris", {{"film.filter", "blackman-harris"}}},
    {"shutter open, nothing moves", {{"film.shutter", "180 deg"}}},
    {"shutter open, the ball moves", {{"film.shutter", "360 deg"}, MOVING}},
    {"shutter open, the camera turns",
     {{"film.shutter", "360 deg"},
      {"camera.roll", "{ curve: linear, after: loop, keys: { 0: 0, 1: 20 } }"}}},
    {"aperture", {{"camera.aperture", "0.05"}, {"camera.focus_distance", "7"}}},
    {"aperture of 6 blades",
     {{"camera.aperture", "0.05"}, {"camera.focus_distance", "7"}, {"camera.blades", "6"}}},
    {"orthographic", {{"camera.lens", "orthographic"}, {"camera.height", "5"}}},
    {"equirectangular", {{"camera.lens", "equirectangular"}}},
    {"both lamps are balls", {{"key light.radius", "0.3"}, {"fill light.radius", "0.2"}}},
};
enum { FEATURE_COUNT = sizeof features / sizeof *features };

void bench_features(void) {
    zt_animation *animations[FEATURE_COUNT];
    frames opened[FEATURE_COUNT];
    runner runners[FEATURE_COUNT];
    for (int i = 0; i < FEATURE_COUNT; i++) {
        zt_override all[OVERRIDES_MAX + 2] = {{"film.samples", "16"}};
        int count = 1;
        for (const zt_override *o = features[i].overrides; o->name; o++) all[count++] = *o;
        animations[i] = film_open("fig1b", all);
        opened[i] = frames_open(animations[i], (zt_render_settings){0}, 1);
        runners[i] = (runner){.name = features[i].name, .run = frames_run, .user = &opened[i]};
    }
    race(runners, FEATURE_COUNT, ROUNDS);
    print_title("the room, %d samples a pixel, and one thing more", SAMPLES);
    for (int i = 0; i < FEATURE_COUNT; i++) {
        zt_output_format format = zt_renderer_format(opened[i].renderer);
        print_spent(runners[i].name, runners[i].median);
        printf("  %5.1f million samples a second",
               1e-6 * SAMPLES * format.width * format.height / runners[i].median.wall_s);
        if (i > 0) print_ratio(runners[i].median.wall_s / runners[0].median.wall_s, 0);
        print_end();
        frames_close(&opened[i]);
        zt_animation_free(&animations[i]);
    }
}
