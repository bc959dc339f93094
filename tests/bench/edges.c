/* Smooth edges: ours against POV-Ray's adaptive ones and against our own even samples, each at
 * its error, which is measured against the same renderer's 1,024 samples a pixel. A program of
 * its own, for the minutes that POV-Ray needs for these. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "measure.h"
#include "peers.h"
#include "sequence/renderer.h"

/* POV-Ray's reference takes minutes, so it is compared in some rows: the middle ones of so many
 * bands of the picture. */
enum { WIDTH = 1280, HEIGHT = 720, ROWS = 24, GRID = 32, REFERENCE = 1024, FRAMES = 2 };

static const zt_override round_knot[] = {{"knot.smooth", "true"}, {NULL, NULL}};

/* The knot's flat triangles are about as large as pixels: all of it is edges. So it is there
 * once more, shaded as if it were round, which POV-Ray is not asked for. */
static const struct scene {
    const char *name, *film;
    const zt_override *overrides;
    int frames, rounds;
    double povray_reach, even_reach; /* 0: there is nothing to reach */
} scenes[] = {{"fig1b", "fig1b", NULL, 8, 3, 40, 4},
              {"fig1a", "fig1a", NULL, 2, 3, 20, 4},
              {"smooth", "fig1a", round_knot, 2, 3, 0, 4}};

static const double errors[] = {0.2, 0.1, 0.05, 0.025, 0.0125, 0.006, 0.003, 0.0015, 0.00075};
static const int counts[] = {1, 2, 4, 8, 16, 32, 64, 128, 256};
enum {
    ERROR_COUNT = sizeof errors / sizeof *errors,
    EVEN_COUNT = sizeof counts / sizeof *counts,
    BOTH_COUNT = ERROR_COUNT + EVEN_COUNT
};

static int row_number(int i) { return (2 * i + 1) * HEIGHT / (2 * ROWS); }

/* POV-Ray -----------------------------------------------------------------------------------*/

enum { ARGUMENTS = 32 };

/* `what` are further words. The files have 16 bits a channel, or their error would be that
 * of 8.
 */
static spent run_povray(const char *film, int processes, int width, int height,
                        const char *what) {
    static char texts[ARGUMENTS][64];
    char *arguments[ARGUMENTS + 1] = {NULL}, line[512];
    snprintf(line, sizeof line,
             "povray +I%s.pov +FP16 File_Gamma=1.0 +WT%d -D -V -GA +W%d +H%d %s", film,
             2 / processes, width, height, what);
    const char *rest = line;
    int length;
    for (int i = 0; i < ARGUMENTS && sscanf(rest, "%63s%n", texts[i], &length) > 0; i++) {
        arguments[i] = texts[i];
        rest += length;
    }
    return run_program(arguments, processes);
}

/* A row of a PPM file of WIDTH columns and 16 bits, counted from the last one. */
static void read_row(double *row, const char *name, int from_end) {
    static uint8_t bytes[6 * WIDTH];
    FILE *file = fopen(scratch_path(name), "rb");
    must_be(file != NULL, "no picture of POV-Ray's");
    must_be(fseek(file, -from_end * (long)sizeof bytes, SEEK_END) == 0 &&
                fread(bytes, sizeof bytes, 1, file) == 1,
            "POV-Ray's picture cannot be read");
    fclose(file);
    for (int i = 0; i < 3 * WIDTH; i++)
        row[i] = (256 * bytes[2 * i] + bytes[2 * i + 1]) / 65535.0;
}

/* What a frame takes, in the better of two ways, without what it takes to begin. */
static spent time_povray(const char *film) {
    spent best = {INFINITY, INFINITY};
    for (int processes = 1; processes <= 2; processes++) {
        spent whole = run_povray(film, processes, WIDTH, HEIGHT,
                                 "+AM1 +A0.3 +R4 +Osmooth%d.ppm +KF1 +KFI1 +KFF2");
        spent rest =
            run_povray(film, processes, 16, 16, "+AM1 +A0.3 +R4 +Otiny%d.ppm +KF1 +KFI1 +KFF2");
        spent each = spent_per(spent_less(whole, rest), FRAMES * processes);
        if (each.wall_s < best.wall_s) best = each;
    }
    return best;
}

static double povray_error(const char *film) {
    static double own[3 * WIDTH], reference[3 * WIDTH];
    double sum = 0;
    for (int i = 0; i < ROWS; i++) {
        char what[128];
        int row = row_number(i);
        snprintf(what, sizeof what, "+AM1 +A0.0 +R%d -J +Orow.ppm +SR%d +ER%d", GRID, row + 1,
                 row + 1);
        run_povray(film, 1, WIDTH, HEIGHT, what);
        read_row(reference, "row.ppm", HEIGHT - row); /* the others are black */
        read_row(own, "smooth01.ppm", HEIGHT - row);
        for (int k = 0; k < 3 * WIDTH; k++)
            sum += (own[k] - reference[k]) * (own[k] - reference[k]);
    }
    return sqrt(sum / (3.0 * WIDTH * ROWS));
}

/* Ours --------------------------------------------------------------------------------------*/

/* The mean squared error of a row. */
static double row_error(const zt_image *image, const zt_image *reference, int row) {
    double sum = 0;
    for (int x = 0; x < WIDTH; x++)
        for (int k = 0; k < 3; k++) {
            size_t at = 4 * ((size_t)row * WIDTH + (size_t)x) + (size_t)k;
            double d = (double)image->pixels[at] - (double)reference->pixels[at];
            sum += d * d;
        }
    return sum / (3.0 * WIDTH);
}

typedef struct contender {
    frames *frames;
    zt_sampling sampling;
    char name[40];
    double error, rows_error; /* of all rows, and of those that POV-Ray is compared in */
} contender;

static void find_errors(contender *c, const zt_image *reference) {
    const zt_image *image = c->frames->image;
    double all = 0, some = 0;
    for (int y = 0; y < HEIGHT; y++) all += row_error(image, reference, y);
    for (int i = 0; i < ROWS; i++) some += row_error(image, reference, row_number(i));
    c->error = sqrt(all / HEIGHT);
    c->rows_error = sqrt(some / ROWS);
}

static spent contender_run(void *user) {
    contender *c = user;
    c->frames->renderer->sampling = c->sampling;
    c->frames->next = 0;
    return frames_run(c->frames);
}

/* The time that even samples take for an error, between two counts of which one has more and
 * one less, on the straight line between the logarithms. */
static double even_time(const contender *even, const runner *runners, double error) {
    int i = 0;
    while (i < EVEN_COUNT - 2 && even[i + 1].error > error) i++;
    double slope = log(runners[i + 1].median.wall_s / runners[i].median.wall_s) /
                   log(even[i + 1].error / even[i].error);
    return runners[i].median.wall_s * exp(slope * log(error / even[i].error));
}

static void compare(const struct scene *s, frames *own, const zt_image *reference,
                    bool has_peer) {
    static contender contenders[BOTH_COUNT];
    runner runners[BOTH_COUNT];
    for (int i = 0; i < BOTH_COUNT; i++) {
        contender *c = &contenders[i];
        int count = i < EVEN_COUNT ? counts[i] : 1024;
        double error = i < EVEN_COUNT ? 0 : errors[i - EVEN_COUNT];
        *c = (contender){.frames = own};
        c->sampling = (zt_sampling){
            .min = error > 0 ? 1 : count, .max = count, .error = error, .edges = error > 0};
        if (error > 0)
            snprintf(c->name, sizeof c->name, "edges to %g", error);
        else
            snprintf(c->name, sizeof c->name, "%d samples", count);
        contender_run(c);
        find_errors(c, reference);
        runners[i] = (runner){.name = c->name, .run = contender_run, .user = c};
    }
    race(runners, BOTH_COUNT, s->rounds);
    print_title("%s, %d x %d: POV-Ray +AM1 +A0.3 +R4, edges first, even samples", s->name,
                WIDTH, HEIGHT);
    spent povray = {0, 0};
    double most = 0;
    if (has_peer) {
        povray = time_povray(s->film);
        most = povray_error(s->film);
        print_spent("POV-Ray", povray);
        printf("  RMSE in %d rows %.5f", ROWS, most);
        print_end();
    }
    bool is_first = true;
    for (int i = 0; i < BOTH_COUNT; i++) {
        const contender *c = &contenders[i];
        print_spent(c->name, runners[i].median);
        printf("  RMSE %.5f, in %d rows %.5f", c->error, ROWS, c->rows_error);
        if (i >= EVEN_COUNT) {
            bool as_good = !has_peer || c->rows_error <= most;
            double ratio = povray.wall_s / runners[i].median.wall_s;
            if (has_peer) {
                printf("  POV-Ray:");
                print_ratio(ratio, as_good && is_first ? s->povray_reach : 0);
            }
            printf("  even, at this error:");
            print_ratio(even_time(contenders, runners, c->error) / runners[i].median.wall_s,
                        as_good ? s->even_reach : 0);
            is_first &= !as_good;
        }
        print_end();
    }
}

/* All scenes, or the one that is named; with a word more without POV-Ray. */
int main(int argc, char **argv) {
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        const struct scene *s = &scenes[i];
        if (argc > 1 && strcmp(argv[1], s->name) != 0) continue;
        const bool has_peer = argc < 3 && s->povray_reach > 0;
        zt_animation *animation = film_open(s->film, s->overrides);
        frames own =
            frames_open(animation, (zt_render_settings){.width = WIDTH, .height = HEIGHT}, 1);
        zt_image *reference;
        must(zt_image_create(&reference, WIDTH, HEIGHT), "an image");
        if (has_peer) write_peers(s->film, WIDTH, HEIGHT);
        own.renderer->sampling = (zt_sampling){.min = REFERENCE, .max = REFERENCE, .seed = 1};
        must(zt_renderer_frame(own.renderer, 0, reference, NULL), "a reference");
        own.repeats = s->frames;
        compare(s, &own, reference, has_peer);
        zt_image_free(&reference);
        frames_close(&own);
        zt_animation_free(&animation);
    }
    return 0;
}
