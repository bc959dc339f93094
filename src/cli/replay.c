#include "cli/replay.h"

#include <inttypes.h>
#include <stdio.h>

static void print_point(const char *before, const double point[3]) {
    printf("%s[%.9g, %.9g, %.9g]", before, point[0], point[1], point[2]);
}

static void print_light(const char *before, double r, double g, double b) {
    printf("%s[%.9g, %.9g, %.9g]\n", before, r, g, b);
}

/* "knot, triangle 217" */
static void print_thing(const char *name, int64_t triangle) {
    printf(" %s", name);
    if (triangle >= 0) printf(", triangle %" PRId64 ",", triangle);
}

static void print_lamp(const zt_replay_lamp *lamp) {
    switch (lamp->gift) {
    case ZT_GIFT_LIGHT:
        printf("    lit by %s", lamp->name);
        break;
    case ZT_GIFT_HIDDEN:
        printf("    not lit by %s: ", lamp->name);
        print_thing(lamp->hider, lamp->hider_triangle);
        printf(" is in between, after %.9g; it is", lamp->hider_distance);
        break;
    case ZT_GIFT_BEHIND:
        printf("    not lit by %s, behind the surface", lamp->name);
        break;
    case ZT_GIFT_NOTHING:
        printf("    not lit by %s, whose light does not show there", lamp->name);
        break;
    }
    print_point(" at ", lamp->point);
    putchar('\n');
}

static void print_ray(const zt_replay_ray *ray, bool mirrored) {
    print_point(mirrored ? "  mirrored from " : "  from ", ray->origin);
    print_point(" along ", ray->direction);
    if (!ray->hit) {
        puts(": meets nothing");
        return;
    }
    printf(": meets");
    print_thing(ray->hit, ray->triangle);
    printf(" after %.9g\n", ray->distance);
    print_point("    at ", ray->point);
    print_point(", normal ", ray->normal);
    putchar('\n');
    for (int i = 0; i < ray->lamp_count; i++) print_lamp(&ray->lamps[i]);
}

static void print_sample(void *user, const zt_replay_sample *s) {
    (void)user;
    if (s->number < 0)
        printf("the sample in the middle");
    else
        printf("sample %d", s->number);
    printf(", at %.9g,%.9g", s->place[0], s->place[1]);
    if (s->timed) printf(", at %.9g s, %.6g %% of the opening", s->time_s, 100 * s->opening);
    if (s->through_lens) printf(", through %.9g,%.9g of the lens", s->lens[0], s->lens[1]);
    if (s->weight != 1) printf(", counting %g", s->weight);
    putchar('\n');
    for (int i = 0; i < s->ray_count; i++) print_ray(&s->rays[i], i > 0);
    print_light("  light ", (double)s->light[0], (double)s->light[1], (double)s->light[2]);
}

zt_status zt_replay_pixel(zt_renderer *renderer, const zt_options *options,
                          const zt_watcher *watcher, zt_report *report) {
    zt_output_format format = zt_renderer_format(renderer);
    zt_replay replay = {.sample = print_sample};
    if (options->column >= format.width || options->row >= format.height) {
        zt_report_say(report, ZT_ERROR, "there is no pixel %d,%d: the picture is %dx%d",
                      options->column, options->row, format.width, format.height);
        return ZT_EARGUMENT;
    }
    if (options->sample >= 0)
        return zt_renderer_replay_sample(renderer, options->first, options->column,
                                         options->row, options->sample, &replay);
    zt_replayed result;
    zt_status status = zt_renderer_replay(&result, renderer, options->first, options->column,
                                          options->row, &replay, watcher);
    if (status != ZT_OK) return status;
    printf("%d sample%s\n", result.sample_count, result.sample_count == 1 ? "" : "s");
    print_light("mean of the samples' light ", result.mean[0], result.mean[1], result.mean[2]);
    print_light("the pixel of the frame     ", (double)result.pixel[0], (double)result.pixel[1],
                (double)result.pixel[2]);
    return ZT_OK;
}
