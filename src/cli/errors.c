#include "cli/errors.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include <zoetrope/zoetrope.h>

#include "cli/chart.h"
#include "cli/page.h"
#include "cli/pictures.h"
#include "cli/tables.h"

enum { WIDE = 1000, NARROW = 368 };
static const char ending[] = ".html";

/* A page under way. */
typedef struct errors {
    const zt_options *options;
    zt_report *report;
    char *stem; /* the target without its ending; owned */
    zt_pictures pictures;
    zt_findings findings;
    char *wide, *narrow; /* charts; owned */
    size_t wide_length, narrow_length;
    bool (*stopped)(void *user);
    int64_t shown; /* percent done when a line was last printed */
} errors;

/* ---- files ---------------------------------------------------------------------------------
 */

/* Tells why a file cannot be written. */
static zt_status refuse(const errors *e, const char *path) {
    zt_report_say(e->report, ZT_ERROR, "cannot write %s: %s", path, strerror(errno));
    return ZT_EFILE;
}

static void print_page(FILE *out, const errors *e) {
    const char *slash = strrchr(e->stem, '/');
    zt_page_print(out, &e->findings, &e->pictures, e->wide, e->narrow,
                  slash ? slash + 1 : e->stem);
}
static void print_csv(FILE *out, const errors *e) { zt_table_csv(out, &e->findings); }
static void print_json(FILE *out, const errors *e) { zt_table_json(out, &e->findings); }

/* Writes a file beside where it will be, and gives it its name when it is complete. */
static zt_status write_file(const errors *e, const char *file_ending,
                            void (*print)(FILE *out, const errors *e)) {
    char *path = NULL, *part = NULL;
    if (asprintf(&path, "%s%s", e->stem, file_ending) < 0) return ZT_EMEMORY;
    if (asprintf(&part, "%s.part", path) < 0) {
        free(path);
        return ZT_EMEMORY;
    }
    FILE *out = fopen(part, "wb");
    if (out) print(out, e);
    bool good = out && !ferror(out);
    if (out) good = fclose(out) == 0 && good;
    good = good && rename(part, path) == 0;
    zt_status status = good ? ZT_OK : refuse(e, path);
    if (!good) remove(part);
    free(path);
    free(part);
    return status;
}

/* Writing the chart first also makes directories that are missing. */
static zt_status write_chart(const errors *e, const char *file_ending) {
    char *path = NULL;
    if (asprintf(&path, "%s%s", e->stem, file_ending) < 0) return ZT_EMEMORY;
    zt_status status =
        zt_drawing_write(path, e->wide, e->wide_length, zt_report_listener(e->report));
    free(path);
    return status;
}

static zt_status write_all(errors *e) {
    zt_status status = zt_chart_draw(&e->wide, &e->wide_length, &e->findings, WIDE);
    if (status == ZT_OK)
        status = zt_chart_draw(&e->narrow, &e->narrow_length, &e->findings, NARROW);
    if (status == ZT_OK) status = write_chart(e, ".svg");
    if (status == ZT_OK) status = write_chart(e, ".png");
    if (status == ZT_OK) status = write_file(e, ".csv", print_csv);
    if (status == ZT_OK) status = write_file(e, ".json", print_json);
    if (status == ZT_OK) status = write_file(e, ending, print_page);
    return status;
}

/* ---- the ladder ----------------------------------------------------------------------------
 */

static void show_progress(void *user, int64_t done_count, int64_t total_count, int64_t frame) {
    (void)frame;
    errors *e = user;
    int64_t percent = total_count > 0 ? 100 * done_count / total_count : 0;
    if (percent < e->shown + (e->report->terminal ? 1 : 10)) return;
    e->shown = percent;
    zt_report_line(e->report, false, "climbing: %d %%", (int)percent);
}

static bool is_stopped(void *user) {
    const errors *e = user;
    return e->stopped && e->stopped(NULL);
}

static void say_advice(const errors *e) {
    const zt_findings *f = &e->findings;
    if (f->best < 0) {
        zt_report_line(e->report, true, "%s%s: no rung is known to be as good as RMSE %g",
                       e->stem, ending, f->advice[0].rmse);
        return;
    }
    const zt_rung *rung = &f->ladder->rungs[f->advice[f->best].rung];
    zt_report_line(e->report, true, "%s%s: for RMSE <= %g use %s: %s a frame, %s for the film",
                   e->stem, ending, f->advice[f->best].rmse, zt_words_of_rung(rung).text,
                   zt_words_of_time(rung->frame_s).text,
                   zt_words_of_time(zt_findings_film_s(f, rung)).text);
}

static zt_status climb(errors *e, const zt_animation *animation, const zt_frames *frames) {
    zt_ladder_settings settings = {.render = e->options->settings,
                                   .frames = frames->numbers,
                                   .frame_count = (int)frames->count,
                                   .filters = e->options->filters,
                                   .frame_limit_s = e->options->budget.frame_s,
                                   .show = zt_pictures_show,
                                   .user = &e->pictures};
    zt_watcher watcher = {show_progress, is_stopped, e};
    zt_ladder *ladder;
    zt_status status =
        zt_ladder_climb(&ladder, animation, &settings, &watcher, zt_report_listener(e->report));
    if (status == ZT_OK) status = e->pictures.status;
    if (status == ZT_OK) {
        e->findings = zt_findings_of(ladder, animation);
        e->findings.file = e->options->file;
        e->findings.frames = frames->numbers;
        e->findings.frame_count = (int)frames->count;
        status = write_all(e);
    }
    if (status == ZT_OK) say_advice(e);
    zt_ladder_free(&ladder);
    return status;
}

static zt_status choose_frames(zt_frames *frames, const errors *e,
                               const zt_animation *animation) {
    int64_t count = zt_animation_film(animation)->frame_count;
    char middle[24];
    snprintf(middle, sizeof middle, "%lld", (long long)(count / 2));
    return zt_frames_read(frames, e->options->frame_list ? e->options->frame_list : middle,
                          count, zt_report_listener(e->report));
}

zt_status zt_errors_report(const zt_options *options, const zt_animation *animation,
                           bool (*stopped)(void *user), zt_report *report) {
    char *target = zt_options_target(options);
    if (!target) return ZT_EMEMORY;
    size_t length = strlen(target), end = strlen(ending);
    if (length <= end || strcmp(target + length - end, ending) != 0) {
        zt_report_say(report, ZT_ERROR, "%s: a report is a page, and ends in .html", target);
        free(target);
        return ZT_EARGUMENT;
    }
    target[length - end] = '\0';
    errors e = {.options = options,
                .report = report,
                .stem = target,
                .stopped = stopped,
                .pictures = {.listener = zt_report_listener(report),
                             .view = zt_animation_film(animation)->view}};
    zt_frames frames = {0};
    zt_status status = choose_frames(&frames, &e, animation);
    if (status == ZT_OK) status = climb(&e, animation, &frames);
    zt_frames_free(&frames);
    zt_pictures_free(&e.pictures);
    free(e.wide);
    free(e.narrow);
    free(e.stem);
    return status;
}
