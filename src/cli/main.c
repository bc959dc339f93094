/* The program: read a description, open a renderer and an output, render, close. */
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <zoetrope/zoetrope.h>

#include "cli/curves.h"
#include "cli/diff.h"
#include "cli/encode.h"
#include "cli/errors.h"
#include "cli/explain.h"
#include "cli/options.h"
#include "cli/progress.h"
#include "cli/replay.h"
#include "cli/report.h"
#include "cli/reproduce.h"
#include "cli/stats.h"

enum {
    EXIT_MISTAKES = 1,
    EXIT_DIFFERENT = 1,
    EXIT_USAGE = 2,
    EXIT_REFUSED = 3,
    EXIT_INTERRUPTED = 130
};

/* Set by a signal; read by the rendering threads. */
static atomic_bool stop_asked;
static atomic_llong stop_asked_ms;

/* The first interrupt asks the sequence to stop, a later one ends the program. What comes
 * within half a second is one interrupt: timeout(1), for one, sends it to the program and to
 * its group. */
static void ask_to_stop(int signal_number) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    long long now_ms = (long long)now.tv_sec * 1000 + now.tv_nsec / 1000000;
    if (!atomic_load(&stop_asked)) {
        atomic_store(&stop_asked_ms, now_ms);
        atomic_store(&stop_asked, true);
    } else if (now_ms - atomic_load(&stop_asked_ms) > 500) {
        signal(signal_number, SIG_DFL);
        raise(signal_number);
    }
}

static bool stopped(void *user) {
    (void)user;
    return atomic_load_explicit(&stop_asked, memory_order_relaxed);
}

/* A signal that is ignored, as shells have it for work in the background, stays so. */
static void listen_for_interrupts(void) {
    const int signals[] = {SIGINT, SIGTERM};
    struct sigaction action = {.sa_handler = ask_to_stop, .sa_flags = SA_RESTART};
    for (int i = 0; i < 2; i++) {
        struct sigaction before;
        if (sigaction(signals[i], NULL, &before) == 0 && before.sa_handler != SIG_IGN)
            sigaction(signals[i], &action, NULL);
    }
}

/* A standard stream that is closed stays unusable, but no file that is opened later takes its
 * number and with it our messages. */
static void hold_standard_streams(void) {
    for (int fd = 0; fd <= 2; fd++)
        if (fcntl(fd, F_GETFD) < 0 && errno == EBADF)
            (void)open("/dev/null", fd ? O_RDONLY : O_WRONLY);
    signal(SIGPIPE, SIG_IGN); /* a film is finished even when nobody reads of its progress */
}

/* A quarter of a side, to the nearest even number, which movies need. */
static int preview_side(int side) { return side < 8 ? 2 : (side + 4) / 8 * 2; }

static zt_render_settings choose_settings(const zt_options *options, const zt_film *film) {
    zt_render_settings settings = options->settings;
    if (options->command != ZT_COMMAND_PREVIEW) return settings;
    if (settings.width == 0) {
        settings.width = preview_side(film->width);
        settings.height = preview_side(film->height);
    }
    if (settings.samples == 0) settings.samples = 1;
    return settings;
}

static void show_progress(void *user, int64_t done_count, int64_t total_count, int64_t frame) {
    ((zt_progress *)user)->total_count = total_count;
    zt_progress_frame(user, done_count, frame);
}

static void say_interrupted(const zt_progress *progress, const char *target) {
    if (progress->done_count == 0)
        zt_report_say(progress->report, ZT_WARNING,
                      "interrupted before the first frame was done");
    else
        zt_report_say(progress->report, ZT_WARNING,
                      "interrupted: %s has the first %" PRId64 " of %" PRId64 " frames", target,
                      progress->done_count, progress->total_count);
}

/* Renders into the output, which is told the film's title and sound. */
static zt_status render_film(zt_film_result *result, zt_renderer *renderer,
                             zt_film_order *order, const zt_options *options, const char *audio,
                             zt_progress *progress) {
    zt_output_option wishes[ZT_OUTPUT_OPTIONS_MAX + 3] = {{"title", NULL}, {"audio", audio}};
    zt_watcher watcher = {show_progress, stopped, progress};
    int length;
    const char *name = zt_options_name(&length, options);
    char *title = strndup(name, (size_t)length);
    if (!title) return ZT_EMEMORY;
    wishes[0].value = order->title = title;
    memcpy(wishes + (audio ? 2 : 1), options->output_options, sizeof options->output_options);
    order->options = wishes;
    zt_status status = zt_film_render(result, renderer, order, &watcher);
    free(title);
    return status;
}

/* Renders the frames that the target lacks. */
static zt_status write_frames(zt_renderer *renderer, const zt_options *options,
                              const zt_frames *frames, const char *target, const char *audio,
                              zt_report *report) {
    zt_film_order order = {.target = target,
                           .frames = frames,
                           .part = options->part,
                           .part_count = options->part_count,
                           .budget = options->budget,
                           .verify = options->verify,
                           .keep_bytes = options->keep_bytes,
                           .overwrites = options->overwrites,
                           .forgets = options->command == ZT_COMMAND_FRAME,
                           .description = options->file,
                           .overrides = options->sets,
                           .override_count = options->set_count};
    zt_film_result result = {0};
    listen_for_interrupts();
    zt_progress progress = zt_progress_begin(report, frames->count);
    struct timespec begun, ended;
    clock_gettime(CLOCK_MONOTONIC, &begun);
    zt_status status = render_film(&result, renderer, &order, options, audio, &progress);
    clock_gettime(CLOCK_MONOTONIC, &ended);
    if (result.kept > 0)
        zt_report_say(report, ZT_NOTE, "%" PRId64 " of %" PRId64 " frames were there already",
                      result.kept, result.count);
    if (result.verified > 0)
        zt_report_say(report, ZT_NOTE,
                      "%" PRId64 " of them, rendered again, %s the same, bit for bit",
                      result.verified, result.verified == 1 ? "is" : "are");
    if (status == ZT_OK && result.count > 0) zt_progress_end(&progress, target);
    if (status == ZT_ESTOPPED) say_interrupted(&progress, target);
    if (options->stats)
        zt_stats_print(renderer, &result,
                       (double)(ended.tv_sec - begun.tv_sec) +
                           1e-9 * (double)(ended.tv_nsec - begun.tv_nsec));
    return status;
}

static zt_status replay(zt_renderer *renderer, const zt_options *options, zt_report *report) {
    zt_watcher watcher = {.stopped = stopped};
    listen_for_interrupts();
    return zt_replay_pixel(renderer, options, &watcher, report);
}

static int64_t last_frame(const zt_options *options, const zt_film *film) {
    return options->all_frames ? film->frame_count - 1 : options->last;
}

static zt_status render(const zt_options *options, const zt_manifest *manifest,
                        const zt_animation *animation, zt_report *report) {
    const zt_film *film = zt_animation_film(animation);
    zt_frames frames = {0};
    zt_status status = zt_options_frames(&frames, options, film, report);
    if (status != ZT_OK) return status;
    char *target = zt_options_target(options);
    zt_render_settings settings = choose_settings(options, film);
    zt_renderer *renderer = NULL;
    status = target
                 ? zt_renderer_open(&renderer, animation, &settings, zt_report_listener(report))
                 : ZT_EMEMORY;
    if (status == ZT_OK && manifest) zt_renderer_follow(renderer, manifest);
    if (status == ZT_OK && options->replays)
        status = replay(renderer, options, report);
    else if (status == ZT_OK)
        status = write_frames(renderer, options, &frames, target, film->audio, report);
    zt_renderer_close(&renderer);
    zt_frames_free(&frames);
    free(target);
    return status;
}

static zt_status check(const zt_animation *animation, zt_report *report) {
    zt_status status = zt_animation_advise(animation, zt_report_listener(report));
    if (status != ZT_OK) return status;
    zt_report_contents(animation);
    return ZT_OK;
}

static zt_status explain_frames(const zt_options *options, const zt_animation *animation,
                                zt_report *report) {
    return zt_explain_frames(animation, options->first,
                             last_frame(options, zt_animation_film(animation)), report);
}

/* What was asked for, of an animation that has been read. */
static zt_status run(const zt_options *options, const zt_manifest *manifest,
                     const zt_animation *animation, zt_report *report) {
    const zt_film *film = zt_animation_film(animation);
    if (options->last >= film->frame_count) {
        zt_report_say(report, ZT_ERROR,
                      "there is no frame %" PRId64 ": the film has frames 0 to %" PRId64,
                      options->last, film->frame_count - 1);
        return ZT_EARGUMENT;
    }
    switch (options->command) {
    case ZT_COMMAND_CHECK:
        return check(animation, report);
    case ZT_COMMAND_EXPLAIN:
        return options->question ? zt_explain(animation, options->question, report)
                                 : explain_frames(options, animation, report);
    case ZT_COMMAND_CURVES:
        return zt_curves(options, animation, report);
    case ZT_COMMAND_REPORT:
        listen_for_interrupts();
        return zt_errors_report(options, animation, stopped, report);
    default:
        return render(options, manifest, animation, report);
    }
}

/* The manifest that is to be followed, and what of the options it decides. */
static zt_status read_manifest(zt_manifest **manifest, zt_options *options, zt_report *report) {
    if (!options->manifest) return ZT_OK;
    zt_status status =
        zt_manifest_read(manifest, options->manifest, zt_report_listener(report));
    if (status != ZT_OK) return status;
    zt_manifest_settings(&options->settings, *manifest);
    if (options->all_frames) zt_manifest_range(&options->first, &options->last, *manifest);
    options->all_frames = false;
    return ZT_OK;
}

static int exit_code(zt_status status, zt_report *report) {
    if (status != ZT_OK && status != ZT_ESTOPPED && report->error_count == 0)
        zt_report_say(report, ZT_ERROR, "%s", zt_status_text(status));
    switch (status) {
    case ZT_OK:
        return EXIT_SUCCESS;
    case ZT_EDESCRIPTION:
        return EXIT_MISTAKES;
    case ZT_EARGUMENT:
        return EXIT_USAGE;
    case ZT_ESTOPPED:
        return EXIT_INTERRUPTED;
    default:
        return EXIT_REFUSED;
    }
}

/* Whatever needs the animation of a description. */
static zt_status of_film(zt_options *options, zt_report *report) {
    zt_animation *animation = NULL;
    zt_manifest *manifest = NULL;
    zt_status status = read_manifest(&manifest, options, report);
    if (status == ZT_OK)
        status = zt_animation_read(&animation, options->file, options->sets, options->set_count,
                                   zt_report_listener(report));
    if (status == ZT_OK) status = run(options, manifest, animation, report);
    zt_manifest_free(&manifest);
    zt_animation_free(&animation);
    return status;
}

static int reproduce(const zt_options *options, zt_report *report) {
    bool differs;
    zt_status status = zt_reproduce_image(&differs, options, stopped, report);
    return status == ZT_OK && differs ? EXIT_DIFFERENT : exit_code(status, report);
}

static int run_command(int argc, char **argv, zt_report *report) {
    zt_options options;
    switch (zt_options_read(&options, argc, argv, report)) {
    case ZT_REQUEST_SHOWN:
        return EXIT_SUCCESS;
    case ZT_REQUEST_WRONG:
        return EXIT_USAGE;
    case ZT_REQUEST_RUN:
        break;
    }
    report->quiet = options.quiet;
    switch (options.command) {
    case ZT_COMMAND_ENCODE:
        listen_for_interrupts();
        return exit_code(zt_encode(&options, stopped, report), report);
    case ZT_COMMAND_DIFF:
        listen_for_interrupts();
        return exit_code(zt_diff_films(&options, stopped, report), report);
    case ZT_COMMAND_REPRODUCE:
        listen_for_interrupts();
        return reproduce(&options, report);
    default:
        return exit_code(of_film(&options, report), report);
    }
}

int main(int argc, char **argv) {
    hold_standard_streams();
    zt_report report = zt_report_create();
    int code = run_command(argc, argv, &report);
    if (code == EXIT_SUCCESS)
        code = exit_code(zt_report_finish(&report), &report);
    else
        fflush(stdout); /* it has failed as it is, or looked after that itself */
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
    return code; /* what they found is told at the end */
#else
    /* All is written and closed. Libraries, over a hundred, are not taken down one by one,
     * which takes more memory than anything before. */
    _Exit(code);
#endif
}
