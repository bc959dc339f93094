#include "cli/stats.h"

#include <inttypes.h>
#include <stdio.h>

enum { LABEL_WIDTH = 14 };

/* A number with its digits in threes. */
static void print_number(int64_t number) {
    char digits[32];
    int length = snprintf(digits, sizeof digits, "%" PRId64, number);
    for (int i = 0; i < length; i++) {
        putchar(digits[i]);
        if ((length - i) % 3 == 1 && i + 1 < length) putchar(',');
    }
}

static void print_share(int64_t part, int64_t whole) {
    if (whole > 0) printf(" (%.3g %%)", 100. * (double)part / (double)whole);
}

static void print_rays(const char *label, zt_ray_stats rays) {
    printf("%-*s ", LABEL_WIDTH, label);
    print_number(rays.traced);
    fputs(" traced, ", stdout);
    print_number(rays.avoided);
    fputs(" avoided", stdout);
    print_share(rays.avoided, rays.traced + rays.avoided);
    putchar('\n');
}

static void print_frames(const zt_film_result *r) {
    printf("%-*s %" PRId64 " rendered", LABEL_WIDTH, "frames", r->rendered);
    if (r->held > 0) printf(", %" PRId64 " held: the same as another one", r->held);
    if (r->kept > 0) printf(", %" PRId64 " there already", r->kept);
    putchar('\n');
}

/* Loaded, not loaded, left out of the program. */
static int state_of(const zt_library *l) { return !l->built ? 2 : !l->loaded; }

static void print_libraries(void) {
    zt_library libraries[ZT_LIBRARY_COUNT];
    zt_libraries(libraries);
    for (int state = 0; state < 3; state++) {
        static const char *const before[] = {"libraries", "not loaded", "not built"};
        int count = 0;
        for (int i = 0; i < ZT_LIBRARY_COUNT; i++) {
            if (state_of(&libraries[i]) != state) continue;
            if (count++ == 0)
                printf("%-*s ", LABEL_WIDTH, before[state]);
            else
                fputs(", ", stdout);
            printf("%s (%s)", libraries[i].name, libraries[i].what);
        }
        if (count > 0) putchar('\n');
    }
}

/* Batches of rays that did not go the whole way. */
static void print_short_ways(const zt_stats *s) {
    printf("%-*s ", LABEL_WIDTH, "short ways");
    print_number(s->bare_batches);
    fputs(" of ", stdout);
    print_number(s->batches);
    fputs(" batches of rays meet nothing, ", stdout);
    print_number(s->flat_batches);
    puts(" one flat thing that nothing shadows and that mirrors nothing");
}

/* Tiles of images that were the same as before when they went out. */
static void print_way_out(const zt_film_result *r) {
    if (r->unconverted + r->unsummed == 0) return;
    printf("%-*s of ", LABEL_WIDTH, "way out");
    print_number(r->tiles);
    fputs(" tiles ", stdout);
    print_number(r->unconverted);
    fputs(" not converted again, ", stdout);
    print_number(r->unsummed);
    puts(" not added up again");
}

/* What earlier runs had kept, and what there is for later ones. */
static void print_keepsakes(const zt_stats *s) {
    if (s->found == 0 && s->keepsakes == 0) return;
    printf("%-*s ", LABEL_WIDTH, "keepsakes");
    if (s->found > 0)
        printf("of %" PRId64 " frames as they were before: %.3g %% of their tiles copied; ",
               s->found, 100. * (double)s->found_copied / (double)s->found_tiles);
    printf("%" PRId64 " in %.3g GB for later edits\n", s->keepsakes,
           1e-9 * (double)s->keepsake_bytes);
}

static void print_unmet(void *user, const char *sentence) {
    int *count = user;
    printf("%-*s %s\n", LABEL_WIDTH, (*count)++ ? "" : "left out", sentence);
}

void zt_stats_print(const zt_renderer *renderer, const zt_film_result *result, double wall_s) {
    zt_stats s = zt_renderer_stats(renderer);
    print_frames(result);
    print_rays("primary rays", s.primary);
    print_rays("shadow rays", s.shadow);
    print_rays("mirrored rays", s.mirror);
    printf("%-*s ", LABEL_WIDTH, "tiles");
    print_number(s.copied_tiles);
    fputs(" copied of ", stdout);
    print_number(s.tiles);
    print_share(s.copied_tiles, s.tiles);
    putchar('\n');
    print_short_ways(&s);
    print_way_out(result);
    print_keepsakes(&s);
    int unmet = 0;
    zt_renderer_unmet(renderer, print_unmet, &unmet);
    print_libraries();
    double stages_s = s.freeze_s + s.prepare_s + s.render_s;
    printf("%-*s freeze %.3g s, prepare %.3g s, render %.3g s, all else %.3g s\n", LABEL_WIDTH,
           "time", s.freeze_s, s.prepare_s, s.render_s, wall_s - stages_s);
}
