/* A whole film of the room to MP4, against ffmpeg that only encodes the same frames. */
#include <stdio.h>
#include <stdlib.h>

#include <zoetrope/film.h>

#include "bench.h"
#include "measure.h"

enum { ROUNDS = 3 };

/* A ball that moves, so that no two frames are the same. */
static const zt_override room[] = {
    {"film.duration", "96"},
    {"ball.center", "{ keys: { 0: [-1.2, 0.9, 0.8], 48: [1.7, 2, 0.3], 96: [1.7, 0.9, -1] } }"},
    {NULL, NULL}};

/* As src/encode/video.c asks x264 to, but without a picture to convert. */
static char *const encode_only[] = {
    "ffmpeg",      "-y",          "-f",         "rawvideo",    "-pixel_format",
    "yuv420p",     "-video_size", "1280x720",   "-framerate",  "24",
    "-i",          "frames.yuv",  "-c:v",       "libx264",     "-preset",
    "medium",      "-crf",        "18",         "-g",          "48",
    "-flags",      "+cgop",       "-threads",   "4",           "-x264-params",
    "force-cfr=1", "-movflags",   "+faststart", "encoded.mp4", NULL};
static char *const decode[] = {"ffmpeg", "-y",       "-i",         "frames.mkv",
                               "-f",     "rawvideo", "frames.yuv", NULL};

static void render_to(const char *name, const zt_output_option *options,
                      const zt_animation *animation) {
    const char *target = scratch_path(name);
    zt_renderer *renderer;
    zt_film_result result;
    must(zt_renderer_open(&renderer, animation, &(zt_render_settings){0}, to_stderr), target);
    zt_frames all;
    must(zt_frames_read(&all, "0--1", zt_animation_film(animation)->frame_count, to_stderr),
         target);
    zt_film_order order = {
        .target = target, .options = options, .frames = &all, .overwrites = true};
    must(zt_film_render(&result, renderer, &order, NULL), target);
    zt_frames_free(&all);
    zt_renderer_close(&renderer);
}

static spent render_film(void *user) {
    const zt_output_option options[] = {{"preset", "medium"}, {NULL, NULL}};
    spent start = spent_now();
    render_to("film.mp4", options, user);
    return spent_per(spent_since(start), (double)zt_animation_film(user)->frame_count);
}

static spent encode_film(void *user) {
    return spent_per(run_program(encode_only, 1), (double)zt_animation_film(user)->frame_count);
}

static spent render_frames(void *user) {
    frames f =
        frames_open(user, (zt_render_settings){0}, (int)zt_animation_film(user)->frame_count);
    spent each = frames_run(&f);
    frames_close(&f);
    return each;
}

/* The film's own frames, as they are before x264. */
static void write_frames(const zt_animation *animation) {
    const zt_output_option options[] = {
        {"codec", "ffv1"}, {"pixel-format", "yuv420p"}, {NULL, NULL}};
    render_to("frames.mkv", options, animation);
    run_program(decode, 1);
    remove(scratch_path("frames.mkv"));
}

void bench_movie(void) {
    if (system("command -v ffmpeg >/dev/null") != 0) {
        print_title("the film of the room to MP4: left out, there is no ffmpeg");
        return;
    }
    zt_animation *animation = film_open("fig1b", room);
    runner runners[] = {
        {.name = "ffmpeg, only encoding", .run = encode_film, .user = animation},
        {.name = "zoetrope, the whole film", .run = render_film, .user = animation},
        {.name = "zoetrope, only rendering", .run = render_frames, .user = animation}};
    write_frames(animation);
    race(runners, 3, ROUNDS);
    print_title("a film of the room, %lld frames of 1280 x 720 to MP4, x264 medium, each frame",
                (long long)zt_animation_film(animation)->frame_count);
    for (int i = 0; i < 3; i++) {
        print_spent(runners[i].name, runners[i].median);
        if (i == 1) print_ratio(runners[1].median.wall_s / runners[0].median.wall_s, -1.3);
        print_end();
    }
    remove(scratch_path("frames.yuv"));
    zt_animation_free(&animation);
}
