#include "cli/diff.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/findings.h"

/* A film, ready to be compared. */
typedef struct side {
    zt_animation *animation;
    zt_renderer *renderer;
} side;

static zt_status open_side(side *s, const char *file, const zt_options *options,
                           zt_report *report) {
    zt_listener listener = zt_report_listener(report);
    zt_status status =
        zt_animation_read(&s->animation, file, options->sets, options->set_count, listener);
    return status == ZT_OK
               ? zt_renderer_open(&s->renderer, s->animation, &options->settings, listener)
               : status;
}

static void close_side(side *s) {
    zt_renderer_close(&s->renderer);
    zt_animation_free(&s->animation);
}

/* ---- the frames ----------------------------------------------------------------------------
 */

static const char *frames_word(int64_t count) { return count == 1 ? "frame" : "frames"; }

static void print_spans(const zt_frame_spans *spans) {
    bool one = spans->count == 1 && spans->all[0].first == spans->all[0].last;
    printf("%s ", frames_word(one ? 1 : 2));
    for (int64_t i = 0; i < spans->count; i++) {
        printf("%s%" PRId64, i ? ", " : "", spans->all[i].first);
        if (spans->all[i].last > spans->all[i].first) printf("-%" PRId64, spans->all[i].last);
    }
}

static bool same_spans(const zt_frame_spans *a, const zt_frame_spans *b) {
    return a->count == b->count &&
           memcmp(a->all, b->all, (size_t)a->count * sizeof *a->all) == 0;
}

/* A line for each set of frames: "frames 12-47: ball.center, ball.radius". */
static void print_causes(const zt_diff *d) {
    for (int64_t i = 0; i < d->cause_count; i++) {
        bool next = i > 0 && same_spans(&d->causes[i].spans, &d->causes[i - 1].spans);
        if (i > 0) fputs(next ? ", " : "\n", stdout);
        if (!next) {
            print_spans(&d->causes[i].spans);
            fputs(": ", stdout);
        }
        fputs(d->causes[i].name, stdout);
    }
    if (d->cause_count > 0) putchar('\n');
}

static void print_length(const zt_diff *d) {
    int64_t older = d->older_count, newer = d->newer_count;
    if (newer == older) return;
    const zt_frame_span span = {newer > older ? older : newer,
                                (newer > older ? newer : older) - 1};
    print_spans(&(zt_frame_spans){(zt_frame_span *)&span, 1});
    printf(" %s %s\n", span.first == span.last ? "is" : "are", newer > older ? "new" : "gone");
}

/* What does not change a frame's light, but how it is shown. */
static void print_view(const zt_animation *older, const zt_animation *newer) {
    zt_view was = zt_animation_film(older)->view, is = zt_animation_film(newer)->view;
    if (was != is)
        printf("film.view is %s and was %s: what is for a display is made again, all of it; "
               "linear light (.exr, .hdr) is not\n",
               zt_view_name(is), zt_view_name(was));
}

/* ---- the time ------------------------------------------------------------------------------
 */

/* The manifest of a target, if there is one. */
static zt_status read_manifest(zt_manifest **manifest, char **path, const char *target,
                               zt_report *report) {
    if (asprintf(path, "%s.manifest", target) < 0) {
        *path = NULL;
        return ZT_EMEMORY;
    }
    if (access(*path, F_OK) == 0)
        return zt_manifest_read(manifest, *path, zt_report_listener(report));
    free(*path);
    *path = NULL;
    return ZT_OK;
}

/* That of the target that was named, or of those that the films have by themselves. */
static zt_status find_manifest(zt_manifest **manifest, char **path, const zt_options *options,
                               zt_report *report) {
    const char *const files[] = {options->other, options->file};
    *manifest = NULL;
    *path = NULL;
    for (int i = 0; i < 2 && !*manifest; i++) {
        zt_options own = *options;
        own.file = files[i];
        char *target = zt_options_target(&own);
        if (!target) return ZT_EMEMORY;
        zt_status status = read_manifest(manifest, path, target, report);
        free(target);
        if (status != ZT_OK) return status;
    }
    if (!*manifest && options->target)
        zt_report_say(report, ZT_WARNING, "there is no %s.manifest, which would tell times",
                      options->target);
    return ZT_OK;
}

static void print_time(const zt_diff_time *t, const zt_diff *d, const char *manifest) {
    printf("rendering %" PRId64 " %s takes about %s: ", d->frame_count,
           frames_word(d->frame_count), zt_words_of_time(t->seconds).text);
    if (t->known_count > 0) {
        printf("%s knows %" PRId64 " of them\n", manifest, t->known_count);
        return;
    }
    printf("frame%s %" PRId64, t->measured_count > 1 ? "s" : "", t->measured[0]);
    if (t->measured_count > 1) printf(" and %" PRId64, t->measured[1]);
    if (t->measured_part > 1) printf(", rendered at 1/%d of the size,", t->measured_part);
    printf(" took as much\n");
}

static zt_status tell_time(const zt_diff *d, const zt_options *options,
                           const zt_animation *newer, const zt_watcher *watcher,
                           zt_report *report) {
    zt_manifest *manifest;
    char *path;
    zt_diff_time time;
    if (d->frame_count == 0) return ZT_OK;
    zt_status status = find_manifest(&manifest, &path, options, report);
    if (status == ZT_OK)
        status = zt_diff_estimate(&time, d, manifest, newer, &options->settings, watcher,
                                  zt_report_listener(report));
    if (status == ZT_OK) print_time(&time, d, path);
    zt_manifest_free(&manifest);
    free(path);
    return status;
}

static zt_status tell(const side *older, const side *newer, const zt_options *options,
                      const zt_watcher *watcher, zt_report *report) {
    zt_diff *d;
    zt_status status = zt_diff_find(&d, older->renderer, newer->renderer, watcher);
    if (status != ZT_OK) return status;
    int64_t both = d->older_count < d->newer_count ? d->older_count : d->newer_count;
    if (d->changed_count > 0)
        printf("%" PRId64 " of %" PRId64 " frames change%s\n", d->changed_count, both,
               d->changed_count == 1 ? "s" : "");
    else
        puts("no frame changes");
    print_causes(d);
    print_length(d);
    print_view(older->animation, newer->animation);
    status = tell_time(d, options, newer->animation, watcher, report);
    zt_diff_free(&d);
    return status;
}

zt_status zt_diff_films(const zt_options *options, bool (*stopped)(void *user),
                        zt_report *report) {
    side older = {0}, newer = {0};
    const zt_watcher watcher = {.stopped = stopped};
    zt_status status = open_side(&older, options->file, options, report);
    if (status == ZT_OK) status = open_side(&newer, options->other, options, report);
    if (status == ZT_OK) status = tell(&older, &newer, options, &watcher, report);
    close_side(&older);
    close_side(&newer);
    return status;
}
