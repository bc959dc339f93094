/* The door to FFmpeg, a module that is loaded when a movie is opened (base/module.h): FFmpeg
 * brings some 130 libraries, and what writes no movie does without them. The files video*.c are
 * that door; each says what it does of it. */
#ifndef ZT_ENCODE_VIDEO_H
#define ZT_ENCODE_VIDEO_H

#include <stdbool.h>

#include <zoetrope/output.h>

#include "base/module.h"

/* The calls of a sink (encode/sink.h). */
typedef struct zt_video_door {
    zt_status (*open)(void **state, const char *target, const zt_output_format *format,
                      const zt_output_option *options, zt_listener listener);
    bool (*wants)(void *state, int64_t position);
    zt_status (*make)(void **made, void *state, const zt_image *image, int64_t frame);
    zt_status (*write)(void *state, void *made, int64_t frame);
    void (*drop)(void *state, void *made);
    int64_t (*spared)(void *state);
    zt_status (*close)(void *state, bool keep);
} zt_video_door;

#endif
