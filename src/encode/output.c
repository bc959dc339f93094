/* An output: one of the sinks, and the rules that hold for all of them. */
#include <zoetrope/output.h>

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/diag.h"
#include "base/text.h"
#include "encode/output.h"
#include "encode/sink.h"

static const zt_sink *const sinks[] = {&zt_sink_movie, &zt_sink_stills, &zt_sink_checksum};
enum { SINK_COUNT = sizeof sinks / sizeof *sinks, LIST_MAX = 256 };

struct zt_output {
    const zt_sink *sink;
    void *state;
    zt_output_format format;
    zt_listener listener;
    bool written;       /* at least one image */
    int64_t last_frame; /* of those */
    zt_status failure;  /* the first one; nothing is written after it */
};

static const zt_sink *sink_of(const char *target) {
    for (int s = 0; s < SINK_COUNT; s++)
        for (const char *const *ending = sinks[s]->endings; *ending; ending++)
            if (zt_text_ends_with(target, *ending, true)) return sinks[s];
    return NULL;
}

const char *zt_output_module(const char *target) {
    const zt_sink *sink = sink_of(target);
    return sink ? sink->module : NULL;
}

static void append(char list[LIST_MAX], const char *separator, const char *text) {
    size_t length = strlen(list);
    snprintf(list + length, LIST_MAX - length, "%s%s", separator, text);
}

/* Says which endings there are, and which one may have been meant. */
static zt_status refuse_target(const char *target, zt_listener listener) {
    const char *slash = strrchr(target, '/'), *dot = strrchr(slash ? slash : target, '.');
    zt_nearest nearest = zt_nearest_to(dot ? dot : "");
    char list[LIST_MAX] = "";
    for (int s = 0; s < SINK_COUNT; s++) {
        append(list, s ? "; " : "", sinks[s]->what);
        for (const char *const *ending = sinks[s]->endings; *ending; ending++) {
            append(list, " ", *ending);
            zt_nearest_try(&nearest, *ending);
        }
    }
    if (nearest.best)
        zt_tell(listener, ZT_ERROR,
                "no output is named %s; did you mean \"%s\"? The ending decides: %s", target,
                nearest.best, list);
    else
        zt_tell(listener, ZT_ERROR, "no output is named %s. The ending decides: %s", target,
                list);
    return ZT_EUNSUPPORTED;
}

/* Options of the film, which all outputs know; those that cannot hold such a thing leave it
 * out.
 */
static const char *const of_film[] = {"title", "comment", "audio", NULL};

/* Whether it is one of the names; `nearest` sees the others. */
static bool is_known(const char *name, const char *const *names, zt_nearest *nearest) {
    for (; *names; names++) {
        if (zt_text_equal(*names, name)) return true;
        zt_nearest_try(nearest, *names);
    }
    return false;
}

/* Refuses the first option that the sink does not know. */
static zt_status check_options(const char *target, const zt_sink *sink,
                               const zt_output_option *options, zt_listener listener) {
    for (; options && options->name; options++) {
        zt_nearest nearest = zt_nearest_to(options->name);
        if (is_known(options->name, sink->options, &nearest) ||
            is_known(options->name, of_film, &nearest))
            continue;
        zt_tell(listener, ZT_ERROR, "cannot write %s: there is no option \"%s\" for %s%s%s%s",
                target, options->name, sink->what, nearest.best ? "; did you mean \"" : "",
                nearest.best ? nearest.best : "", nearest.best ? "\"?" : "");
        return ZT_EARGUMENT;
    }
    return ZT_OK;
}

static zt_status check_format(const zt_output_format *format, zt_listener listener) {
    bool size_legal = format->width >= 1 && format->width <= ZT_IMAGE_SIDE_MAX &&
                      format->height >= 1 && format->height <= ZT_IMAGE_SIDE_MAX;
    if (size_legal && format->rate.num > 0 && format->rate.den > 0) return ZT_OK;
    zt_tell(listener, ZT_ERROR, "no output can have %dx%d pixels at %d/%d frames a second",
            format->width, format->height, format->rate.num, format->rate.den);
    return ZT_EARGUMENT;
}

zt_status zt_output_open(zt_output **out, const char *target, const zt_output_format *format,
                         const zt_output_option *options, zt_listener listener) {
    *out = NULL;
    ZT_TRY(check_format(format, listener));
    const zt_sink *sink = sink_of(target);
    if (!sink) return refuse_target(target, listener);
    ZT_TRY(check_options(target, sink, options, listener));
    zt_output *output = calloc(1, sizeof *output);
    if (!output) return ZT_EMEMORY;
    *output = (zt_output){.sink = sink, .format = *format, .listener = listener};
    zt_status status = sink->open(&output->state, target, format, options, listener);
    if (status == ZT_OK)
        *out = output;
    else
        free(output);
    return status;
}

static zt_status check_size(const zt_output *output, const zt_image *image) {
    const zt_output_format *format = &output->format;
    if (image->width == format->width && image->height == format->height) return ZT_OK;
    zt_tell(output->listener, ZT_ERROR, "an image of %dx%d pixels came to an output of %dx%d",
            image->width, image->height, format->width, format->height);
    return ZT_EARGUMENT;
}

static zt_status check_order(const zt_output *output, int64_t frame) {
    if (output->format.plan || !output->written || frame > output->last_frame) return ZT_OK;
    zt_tell(output->listener, ZT_ERROR,
            "frame %" PRId64 " came after frame %" PRId64 "; frames come in rising order",
            frame, output->last_frame);
    return ZT_EARGUMENT;
}

bool zt_output_wants(zt_output *output, int64_t position) {
    const zt_sink *sink = output->sink;
    return !output->format.plan || !sink->wants || sink->wants(output->state, position);
}

zt_status zt_output_make(void **made, zt_output *output, const zt_image *image, int64_t frame) {
    ZT_TRY(check_size(output, image));
    return output->sink->make(made, output->state, image, frame);
}

void zt_output_drop(zt_output *output, void *made) { output->sink->drop(output->state, made); }

zt_status zt_output_put(zt_output *output, void *made, int64_t frame) {
    if (output->failure == ZT_OK) output->failure = check_order(output, frame);
    if (output->failure != ZT_OK) {
        zt_output_drop(output, made);
        return output->failure;
    }
    output->failure = output->sink->write(output->state, made, frame);
    output->written = true;
    output->last_frame = frame;
    return output->failure;
}

zt_status zt_output_write(zt_output *output, const zt_image *image, int64_t frame) {
    void *made = NULL;
    if (output->failure == ZT_OK) output->failure = zt_output_make(&made, output, image, frame);
    if (output->failure != ZT_OK) return output->failure;
    return zt_output_put(output, made, frame);
}

int64_t zt_output_spared(const zt_output *output) {
    const zt_sink *sink = output->sink;
    return sink->spared ? sink->spared(output->state) : 0;
}

zt_status zt_output_close(zt_output **output) {
    if (!*output) return ZT_OK;
    bool some = (*output)->written || (*output)->format.plan;
    bool keep = some && (*output)->failure == ZT_OK;
    zt_status status = (*output)->sink->close((*output)->state, keep);
    free(*output);
    *output = NULL;
    return status;
}
