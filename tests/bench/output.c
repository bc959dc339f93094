/* What the way out costs: a film of the room as numbered images and as each kind of movie, by
 * the program itself, beside rendering alone; against the same frames piped to the ffmpeg
 * program with the same settings, and against oiiotool writing the same images. Names of
 * targets as arguments choose some of them. */
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "image/develop.h"
#include "measure.h"

#define FRAMES "72"
enum { FRAME_COUNT = 72, ROUNDS = 3, PEER_ARGUMENTS_MAX = 24, TARGETS_MAX = 16 };

static const char ball[] =
    "{ keys: { 0: [-1.2, 0.9, 0.8], 36: [1.7, 2, 0.3], 72: [1.7, 0.9, -1] } }";

/* The peers' settings are those of src/encode/video_codecs.c and src/image/file_parts.cpp. */
static const struct target {
    const char *name, *codec; /* NULL: the target's own */
    int bits;                 /* of the numbers that the peer is given */
    char *const peer[PEER_ARGUMENTS_MAX];
} targets[] = {
    {"f.####.png",
     NULL,
     8,
     {"oiiotool", "--frames", "0-71", "s.%04d.tif", "--attrib", "png:compressionLevel", "1",
      "--compression", "rle", "--attrib", "png:filter", "16", "-o", "o.%04d.png"}},
    {"f.####.exr",
     NULL,
     32,
     {"oiiotool", "--frames", "0-71", "s.%04d.exr", "--compression", "rle", "-o",
      "o.%04d.exr"}},
    {"h264.mp4",
     NULL,
     8,
     {"-c:v", "libx264", "-preset", "veryfast", "-crf", "18", "-pix_fmt", "yuv420p", "-g", "48",
      "-threads", "4", "-x264-params", "force-cfr=1", "o.mp4"}},
    {"h265.mp4",
     "h265",
     8,
     {"-c:v", "libx265", "-preset", "veryfast", "-crf", "20", "-pix_fmt", "yuv420p", "-g", "48",
      "-threads", "2", "-tag:v", "hvc1", "-x265-params", "log-level=none:open-gop=0:pools=4",
      "o5.mp4"}},
    {"av1.mp4",
     "av1",
     8,
     {"-c:v", "libsvtav1", "-preset", "10", "-crf", "24", "-pix_fmt", "yuv420p", "-g", "48",
      "-svtav1-params", "lp=4", "o1.mp4"}},
    {"vp9.webm",
     NULL,
     8,
     {"-c:v", "libvpx-vp9", "-deadline", "good", "-cpu-used", "5", "-crf", "20", "-b:v", "0",
      "-pix_fmt", "yuv420p", "-g", "48", "-threads", "4", "o.webm"}},
    {"prores.mov",
     "prores",
     16,
     {"-c:v", "prores_ks", "-profile:v", "hq", "-vendor", "apl0", "-pix_fmt", "yuv422p10le",
      "-threads", "4", "o.mov"}},
    {"prores4444.mov",
     "prores4444",
     16,
     {"-c:v", "prores_ks", "-profile:v", "4444", "-vendor", "apl0", "-pix_fmt", "yuv444p10le",
      "-threads", "4", "o4.mov"}},
    {"dnxhr.mov",
     "dnxhr",
     16,
     {"-c:v", "dnxhd", "-profile:v", "dnxhr_hqx", "-pix_fmt", "yuv422p10le", "-threads", "4",
      "od.mov"}},
    {"ffv1.mkv",
     "ffv1",
     16,
     {"-c:v", "ffv1", "-level", "3", "-coder", "1", "-context", "1", "-slices", "4",
      "-slicecrc", "1", "-g", "1", "-pix_fmt", "gbrp10le", "-threads", "4", "of.mkv"}},
    {"film.gif", NULL, 8, {"-vf", "split[a][b];[a]palettegen[p];[b][p]paletteuse", "o.gif"}},
    {"film.apng", NULL, 8, {"-pred", "mixed", "-compression_level", "4", "o.apng"}},
};
enum { TARGET_COUNT = sizeof targets / sizeof *targets };

static zt_animation *animation;

static bool is_still(const struct target *t) { return strchr(t->name, '#') != NULL; }

/* The program itself. */
static spent render_film(void *user) {
    const struct target *t = user;
    char set[128];
    snprintf(set, sizeof set, "ball.center=%s", ball);
    char *arguments[24] = {ZT_BENCH_PROGRAM,
                           "render",
                           ZT_BENCH_SOURCE_DIR "/animations/fig1b.yaml",
                           "--set",
                           "film.duration=" FRAMES,
                           "--set",
                           set,
                           "--quiet",
                           "--overwrite",
                           "-o",
                           (char *)t->name};
    if (t->codec) {
        arguments[11] = "--codec";
        arguments[12] = (char *)t->codec;
    }
    return spent_per(run_program(arguments, 1), FRAME_COUNT);
}

/* From the first frame's end to the last one's. */
typedef struct window {
    spent begin, all;
} window;

static void note_frame(void *user, int64_t done, int64_t total, int64_t frame) {
    window *w = user;
    (void)frame;
    if (done == 1) w->begin = spent_now();
    if (done == total) w->all = spent_since(w->begin);
}

/* The same through the library, while there are frames to render: without starting, and what
 * has to be done when all are there. */
static spent render_frames(void *user) {
    const struct target *t = user;
    const zt_output_option options[] = {{t->codec ? "codec" : NULL, t->codec}, {NULL, NULL}};
    window w = {.begin = {0, 0}, .all = {0, 0}};
    const zt_watcher watcher = {.progress = note_frame, .user = &w};
    zt_renderer *renderer;
    zt_film_result result;
    zt_frames all;
    must(zt_renderer_open(&renderer, animation, &(zt_render_settings){0}, to_stderr), t->name);
    must(zt_frames_read(&all, "0--1", FRAME_COUNT, to_stderr), t->name);
    const zt_film_order order = {.target = scratch_path(t->name),
                                 .options = options,
                                 .frames = &all,
                                 .overwrites = true};
    must(zt_film_render(&result, renderer, &order, &watcher), t->name);
    zt_frames_free(&all);
    zt_renderer_close(&renderer);
    return w.all;
}

static spent render_only(void *user) {
    (void)user;
    frames f = frames_open(animation, (zt_render_settings){0}, FRAME_COUNT);
    spent each = frames_run(&f);
    frames_close(&f);
    return each;
}

/* Starts ffmpeg with raw frames at its standard input; returns where to write them. */
static int start_ffmpeg(pid_t *child, const struct target *t) {
    static char *const head[] = {"ffmpeg",      "-y",       "-f",           "rawvideo",
                                 "-video_size", "1280x720", "-framerate",   "24",
                                 "-sws_flags",  "bicubic",  "-pixel_format"};
    char *arguments[sizeof head / sizeof *head + PEER_ARGUMENTS_MAX + 8];
    int count = 0, ends[2];
    for (size_t i = 0; i < sizeof head / sizeof *head; i++) arguments[count++] = head[i];
    arguments[count++] = t->bits == 8 ? "rgb24" : "rgb48le";
    arguments[count++] = "-i";
    arguments[count++] = "-";
    for (int i = 0; t->peer[i]; i++) arguments[count++] = t->peer[i];
    arguments[count] = NULL;
    scratch();
    must_be(pipe2(ends, O_CLOEXEC) == 0, "no pipe");
    fflush(NULL);
    *child = fork();
    must_be(*child >= 0, "no further process");
    if (*child == 0) {
        int silence = open("/dev/null", O_WRONLY);
        dup2(ends[0], 0);
        dup2(silence, 1);
        dup2(silence, 2);
        if (chdir(scratch()) == 0) execvp(arguments[0], arguments);
        _exit(127);
    }
    close(ends[0]);
    return ends[1];
}

static void write_all(int file, const uint8_t *bytes, size_t size) {
    while (size > 0) {
        ssize_t count = write(file, bytes, size);
        must_be(count > 0, "ffmpeg takes no more frames");
        bytes += count;
        size -= (size_t)count;
    }
}

/* Renders frames and pipes them to ffmpeg, as a script would. */
static spent pipe_to_ffmpeg(void *user) {
    const struct target *t = user;
    frames f = frames_open(animation, (zt_render_settings){0}, 1);
    size_t row = (size_t)f.image->width * 3 * (size_t)(t->bits / 8);
    size_t size = row * (size_t)f.image->height;
    uint8_t *bytes = malloc(size);
    must_be(bytes != NULL, "out of memory");
    const zt_developing how = {.view = zt_renderer_format(f.renderer).view};
    pid_t child;
    int status;
    struct rusage usage;
    spent start = spent_now();
    int pipe = start_ffmpeg(&child, t);
    for (int i = 0; i < FRAME_COUNT; i++) {
        frames_run(&f);
        if (t->bits == 8)
            zt_develop_8(bytes, row, f.image, &how, 0, f.image->height);
        else
            zt_develop_16((uint16_t *)(void *)bytes, row, f.image, &how, 0, f.image->height);
        write_all(pipe, bytes, size);
    }
    close(pipe);
    must_be(wait4(child, &status, 0, &usage) == child && status == 0, "ffmpeg failed");
    spent all = spent_since(start);
    all.cpu_s += (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
                 1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
    free(bytes);
    frames_close(&f);
    return spent_per(all, FRAME_COUNT);
}

/* Images that are there, without compression, become such as ours. */
static spent write_by_oiiotool(void *user) {
    const struct target *t = user;
    return spent_per(run_program(t->peer, 1), FRAME_COUNT);
}

/* The images that oiiotool reads. */
static void write_sources(void) {
    static const char *const sources[][2] = {{"s.####.tif", "bits=8"},
                                             {"s.####.exr", "bits=float"}};
    for (int s = 0; s < 2; s++) {
        const zt_output_option options[] = {{"format-option", sources[s][1]},
                                            {"format-option", "compression=none"},
                                            {NULL, NULL}};
        frames f = frames_open(animation, (zt_render_settings){0}, 1);
        zt_output_format format = zt_renderer_format(f.renderer);
        zt_output *output;
        must(zt_output_open(&output, scratch_path(sources[s][0]), &format, options, to_stderr),
             "the sources");
        for (int64_t i = 0; i < FRAME_COUNT; i++) {
            frames_run(&f);
            must(zt_output_write(output, f.image, i), "the sources");
        }
        must(zt_output_close(&output), "the sources");
        frames_close(&f);
    }
}

static bool is_chosen(const struct target *t, int count, char **names) {
    bool chosen = count == 0;
    for (int i = 0; i < count; i++) chosen |= strcmp(names[i], t->name) == 0;
    return chosen;
}

/* How many times as much as the peer's: of movies all, of images what writing them adds. */
static double idle(spent s) {
    return 100 * (1 - s.cpu_s / s.wall_s / (double)sysconf(_SC_NPROCESSORS_ONLN));
}

static void print_target(const struct target *t, spent own, spent working, spent alone,
                         spent peer) {
    spent out = spent_less(own, alone), held = is_still(t) ? out : own;
    printf("%-16s %7.1f %7.1f %8.1f %6.2f %6.1f %6.1f %%  %8.1f %7.1f %8.2f %7.2f\n", t->name,
           1e3 * own.wall_s, 1e3 * own.cpu_s, 1e3 * out.cpu_s, out.cpu_s / alone.cpu_s,
           idle(own), idle(working), 1e3 * peer.wall_s, 1e3 * peer.cpu_s,
           held.wall_s / peer.wall_s, held.cpu_s / peer.cpu_s);
    fflush(stdout);
}

int main(int argc, char **argv) {
    const zt_override room[] = {{"film.duration", FRAMES}, {"ball.center", ball}, {NULL, NULL}};
    must_be(system("command -v ffmpeg oiiotool >/dev/null") == 0, "needs ffmpeg and oiiotool");
    signal(SIGPIPE, SIG_IGN);
    animation = film_open("fig1b", room);
    write_sources();
    printf("A film of the room, " FRAMES
           " frames of 1280 x 720: milliseconds a frame, medians\n"
           "out: processor time besides rendering's, and as a share of it\n"
           "idle: of all cores, in all, and while frames are rendered\n"
           "peer: rendering, piped to ffmpeg; of images oiiotool without rendering, held "
           "against out\n\n"
           "                    wall     CPU      out      x    idle  working  peer wall     "
           "CPU   x "
           "wall   "
           "x CPU\n");
    for (int i = 0; i < TARGET_COUNT; i++) {
        const struct target *t = &targets[i];
        if (!is_chosen(t, argc - 1, argv + 1)) continue;
        runner runners[] = {{.name = "alone", .run = render_only},
                            {.name = "own", .run = render_film, .user = (void *)t},
                            {.name = "working", .run = render_frames, .user = (void *)t},
                            {.name = "peer",
                             .run = is_still(t) ? write_by_oiiotool : pipe_to_ffmpeg,
                             .user = (void *)t}};
        race(runners, 4, ROUNDS);
        print_target(t, runners[1].median, runners[2].median, runners[0].median,
                     runners[3].median);
    }
    zt_animation_free(&animation);
    return 0;
}
