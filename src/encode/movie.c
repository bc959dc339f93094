/* Movies: this side of the door to FFmpeg. */
#include <stdlib.h>

#include "encode/sink.h"
#include "encode/video.h"

typedef struct movie {
    const zt_video_door *door;
    void *state; /* of the door's */
} movie;

static zt_status open_movie(void **state, const char *target, const zt_output_format *format,
                            const zt_output_option *options, zt_listener listener) {
    const zt_video_door *door = zt_module_door("video", "a movie", listener);
    if (!door) return ZT_EUNSUPPORTED;
    movie *m = calloc(1, sizeof *m);
    if (!m) return ZT_EMEMORY;
    m->door = door;
    zt_status status = door->open(&m->state, target, format, options, listener);
    if (status == ZT_OK)
        *state = m;
    else
        free(m);
    return status;
}

static bool movie_wants(void *state, int64_t position) {
    movie *m = state;
    return m->door->wants(m->state, position);
}

static zt_status make_frame(void **made, void *state, const zt_image *image, int64_t frame) {
    movie *m = state;
    return m->door->make(made, m->state, image, frame);
}

static zt_status write_frame(void *state, void *made, int64_t frame) {
    movie *m = state;
    return m->door->write(m->state, made, frame);
}

static void drop_frame(void *state, void *made) {
    movie *m = state;
    m->door->drop(m->state, made);
}

static int64_t spared_tiles(void *state) {
    movie *m = state;
    return m->door->spared(m->state);
}

static zt_status close_movie(void *state, bool keep) {
    movie *m = state;
    zt_status status = m->door->close(m->state, keep);
    free(m);
    return status;
}

static const char *const endings[] = {".mp4", ".mov", ".mkv", ".webm", ".gif", ".apng", NULL};
static const char *const options[] = {
    "codec", "crf", "bitrate", "preset", "pixel-format", "encoder-option", NULL};
const zt_sink zt_sink_movie = {.what = "a movie",
                               .module = "video",
                               .endings = endings,
                               .options = options,
                               .open = open_movie,
                               .wants = movie_wants,
                               .make = make_frame,
                               .write = write_frame,
                               .drop = drop_frame,
                               .spared = spared_tiles,
                               .close = close_movie};
