/* Frames against POV-Ray's and Tachyon's: the same scenes, and what their pictures differ by.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "bench.h"
#include "image/develop.h"
#include "measure.h"
#include "peers.h"

enum { WIDTH = 1280, HEIGHT = 720, ARGUMENTS_MAX = 32 };

/* How many frames each run of a peer renders; 0: not asked. */
static const struct duel {
    const char *film;
    int samples, rounds;
    int own_frames, tachyon_frames, povray_frames;
    double tachyon_reach, povray_reach;
} duels[] = {
    {"fig1b", 1, 3, 16, 8, 2, 10, 80},
    {"fig1b", 16, 3, 2, 1, 0, 12, 0},
    {"fig1a", 1, 3, 4, 2, 1, 10, 25},
    {"fig1a", 16, 1, 2, 1, 1, 10, 25},
};

/* A peer's way of rendering: processes side by side, each with some threads. */
typedef struct way {
    const char *name;
    int processes, threads;
    bool is_povray;
} way;

static const way ways[] = {{"tachyon, 2 processes", 2, 1, false},
                           {"tachyon, 2 threads", 1, 2, false},
                           {"POV-Ray, 2 processes", 2, 1, true},
                           {"POV-Ray, 2 threads", 1, 2, true}};
enum { WAY_COUNT = sizeof ways / sizeof *ways };

/* One run of a peer, and the same with next to no pixels. */
typedef struct peer {
    char texts[2][ARGUMENTS_MAX][64];
    char *arguments[2][ARGUMENTS_MAX + 1];
    int processes, frames;
} peer;

/* What the run takes for each frame, without what it takes to begin, to read the scene (POV-Ray
 * does so for each frame) and to wait between frames. */
static spent peer_run(void *user) {
    peer *p = user;
    spent whole = run_program(p->arguments[0], p->processes);
    spent rest = run_program(p->arguments[1], p->processes);
    return spent_per(spent_less(whole, rest), (double)p->frames * p->processes);
}

/* The words of a text become arguments. */
static void split(peer *p, int which, const char *text) {
    int count = 0, length;
    for (; count < ARGUMENTS_MAX && sscanf(text, "%63s%n", p->texts[which][count], &length) > 0;
         text += length, count++)
        p->arguments[which][count] = p->texts[which][count];
    p->arguments[which][count] = NULL;
}

/* A `%d` is the number of the process. The last frame is left in fileN.ppm, of POV-Ray's first
 * of several in povrayN1.ppm. */
static void prepare_peer(peer *p, const way *w, const struct duel *d) {
    char text[512];
    p->processes = w->processes;
    p->frames = w->is_povray ? d->povray_frames : d->tachyon_frames;
    for (int tiny = 0; tiny < 2; tiny++) {
        int width = tiny ? 16 : WIDTH, height = tiny ? 16 : HEIGHT;
        const char *file = tiny ? "tiny" : w->is_povray ? "povray" : "tachyon";
        if (w->is_povray)
            snprintf(text, sizeof text,
                     "povray +I%s.pov +O%s%%d.ppm +FP8 File_Gamma=1.0 +W%d +H%d +WT%d +KF1 "
                     "+KFI1 +KFF%d -D -V -GA %s",
                     d->film, file, width, height, w->threads, p->frames,
                     d->samples > 1 ? "+A0.0 +AM1 +R4 -J" : "-A");
        else
            snprintf(text, sizeof text,
                     "tachyon %s.tachyon -camfile %s.%d.cam -res %d %d -numthreads %d "
                     "-aasamples %d -format PPM -o %s%%d.ppm",
                     d->film, d->film, p->frames, width, height, w->threads, d->samples - 1,
                     file);
        split(p, tiny, text);
    }
    if (!w->is_povray) write_peer_camera(d->film, p->frames);
}

/* The peak signal-to-noise ratio of a peer's picture, 8 bits a channel, to ours; dB. The pixels
 * are the end of a PPM file. */
static double likeness(const char *name, const zt_image *image) {
    long size = 3L * WIDTH * HEIGHT;
    FILE *file = fopen(scratch_path(name), "rb");
    uint8_t *own = malloc((size_t)size), *other = malloc((size_t)size);
    must_be(file && own && other, "no picture of a peer's");
    must_be(fseek(file, -size, SEEK_END) == 0 && fread(other, (size_t)size, 1, file) == 1,
            "a peer's picture cannot be read");
    fclose(file);
    const zt_developing raw = {.view = ZT_VIEW_RAW};
    zt_develop_8(own, (size_t)3 * WIDTH, image, &raw, 0, HEIGHT);
    double sum = 0;
    for (long i = 0; i < size; i++) sum += (own[i] - other[i]) * (own[i] - other[i]);
    free(own);
    free(other);
    return 10 * log10(255.0 * 255.0 * (double)size / sum);
}

/* What is asked is asked of a peer's better way. */
static void print_peers(const struct duel *d, const runner *runners, const way *const *raced,
                        int count) {
    for (int i = 1; i < count; i++) {
        bool is_best = true;
        for (int k = 1; k < count; k++)
            is_best &= raced[k]->is_povray != raced[i]->is_povray ||
                       runners[k].median.wall_s >= runners[i].median.wall_s;
        double reach = raced[i]->is_povray ? d->povray_reach : d->tachyon_reach;
        print_spent(runners[i].name, runners[i].median);
        print_ratio(runners[i].median.wall_s / runners[0].median.wall_s, is_best ? reach : 0);
        printf("  (x %.1f of CPU)", runners[i].median.cpu_s / runners[0].median.cpu_s);
        print_end();
    }
}

static void duel(const struct duel *d) {
    static peer peers[WAY_COUNT + 1];
    const way *raced[WAY_COUNT + 1] = {NULL};
    zt_animation *animation = film_open(d->film, NULL);
    zt_render_settings settings = {.width = WIDTH, .height = HEIGHT, .samples = d->samples};
    frames own = frames_open(animation, settings, d->own_frames);
    runner runners[WAY_COUNT + 1] = {{.name = "zoetrope", .run = frames_run, .user = &own}};
    int count = 1;
    write_peers(d->film, WIDTH, HEIGHT);
    for (const way *w = ways; w < ways + WAY_COUNT; w++) {
        if ((w->is_povray ? d->povray_frames : d->tachyon_frames) == 0) continue;
        if (d->samples > 1 && w->processes == 1) continue; /* never the better one, and long */
        raced[count] = w;
        prepare_peer(&peers[count], w, d);
        runners[count] = (runner){.name = w->name, .run = peer_run, .user = &peers[count]};
        count++;
    }
    race(runners, count, d->rounds);
    print_title("%s, %d x %d, %d sample%s a pixel, rendering only", d->film, WIDTH, HEIGHT,
                d->samples, d->samples == 1 ? "" : "s");
    print_spent(runners[0].name, runners[0].median);
    print_end();
    print_peers(d, runners, raced, count);
    printf("  likeness of the pictures: Tachyon's %.1f dB",
           likeness("tachyon0.ppm", own.image));
    if (d->povray_frames)
        printf(", POV-Ray's %.1f dB",
               likeness(d->povray_frames > 1 ? "povray01.ppm" : "povray0.ppm", own.image));
    print_end();
    frames_close(&own);
    zt_animation_free(&animation);
}

void bench_duels(void) {
    for (size_t i = 0; i < sizeof duels / sizeof *duels; i++) duel(&duels[i]);
}
