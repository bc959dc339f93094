#include "encode/video_palette.h"

#include <stdio.h>
#include <stdlib.h>

#include <libavfilter/avfilter.h>
#include <libavfilter/buffersink.h>
#include <libavfilter/buffersrc.h>

typedef struct palette {
    AVFilterGraph *counting, *using; /* first the one, then the other */
    AVFilterContext *in, *colours_in, *out;
    AVFrame *colours;
    int width, height, format;
    int64_t next; /* frame's number: filters drop what stands still in time */
} palette;

static int add(AVFilterContext **made, AVFilterGraph *graph, const char *filter,
               const char *name, const char *options) {
    return avfilter_graph_create_filter(made, avfilter_get_by_name(filter), name, options, NULL,
                                        graph);
}

static int add_source(AVFilterContext **made, AVFilterGraph *graph, const char *name, int width,
                      int height, int format) {
    char options[128];
    snprintf(options, sizeof options, "video_size=%dx%d:pix_fmt=%d:time_base=1/1", width,
             height, format);
    return add(made, graph, "buffer", name, options);
}

static int build_counting(palette *p) {
    AVFilterContext *colours = NULL;
    p->counting = avfilter_graph_alloc();
    if (!p->counting) return AVERROR(ENOMEM);
    p->counting->nb_threads = 1;
    int error = add_source(&p->in, p->counting, "in", p->width, p->height, p->format);
    if (error >= 0) error = add(&colours, p->counting, "palettegen", "colours", NULL);
    if (error >= 0) error = add(&p->out, p->counting, "buffersink", "out", NULL);
    if (error >= 0) error = avfilter_link(p->in, 0, colours, 0);
    if (error >= 0) error = avfilter_link(colours, 0, p->out, 0);
    return error < 0 ? error : avfilter_graph_config(p->counting, NULL);
}

/* Ordered dithering: what stands still does not flicker, and is stored once. */
static int build_using(palette *p) {
    AVFilterContext *map = NULL;
    p->using = avfilter_graph_alloc();
    if (!p->using) return AVERROR(ENOMEM);
    p->using->nb_threads = 1;
    int error = add_source(&p->in, p->using, "in", p->width, p->height, p->format);
    if (error >= 0)
        error = add_source(&p->colours_in, p->using, "colours", p->colours->width,
                           p->colours->height, p->colours->format);
    if (error >= 0)
        error = add(&map, p->using, "paletteuse", "map", "dither=bayer:bayer_scale=3");
    if (error >= 0) error = add(&p->out, p->using, "buffersink", "out", NULL);
    if (error >= 0) error = avfilter_link(p->in, 0, map, 0);
    if (error >= 0) error = avfilter_link(p->colours_in, 0, map, 1);
    if (error >= 0) error = avfilter_link(map, 0, p->out, 0);
    return error < 0 ? error : avfilter_graph_config(p->using, NULL);
}

static void close_palette(void *state) {
    palette *p = state;
    if (!p) return;
    avfilter_graph_free(&p->counting);
    avfilter_graph_free(&p->using);
    av_frame_free(&p->colours);
    free(p);
}

static int open_palette(void **state, const AVFrame *first) {
    *state = NULL;
    palette *p = calloc(1, sizeof *p);
    if (!p) return AVERROR(ENOMEM);
    p->width = first->width;
    p->height = first->height;
    p->format = first->format;
    int error = build_counting(p);
    if (error >= 0)
        *state = p;
    else
        close_palette(p);
    return error;
}

static int give(palette *p, AVFrame *frame) {
    frame->pts = p->next++;
    return av_buffersrc_add_frame_flags(p->in, frame, AV_BUFFERSRC_FLAG_KEEP_REF);
}

static int count_colours(void *state, AVFrame *frame) { return give(state, frame); }

static int choose_colours(void *state) {
    palette *p = state;
    int error = av_buffersrc_close(p->in, p->next, 0);
    p->colours = av_frame_alloc();
    if (error >= 0 && !p->colours) error = AVERROR(ENOMEM);
    if (error >= 0) error = av_buffersink_get_frame(p->out, p->colours);
    if (error >= 0) error = build_using(p);
    if (error >= 0) p->colours->pts = 0;
    if (error >= 0)
        error =
            av_buffersrc_add_frame_flags(p->colours_in, p->colours, AV_BUFFERSRC_FLAG_KEEP_REF);
    if (error >= 0) error = av_buffersrc_close(p->colours_in, 1, 0);
    avfilter_graph_free(&p->counting);
    p->next = 0;
    return error;
}

static int use_colours(AVFrame **out, void *state, AVFrame *frame) {
    palette *p = state;
    *out = av_frame_alloc();
    if (!*out) return AVERROR(ENOMEM);
    int error = give(p, frame);
    if (error >= 0) error = av_buffersink_get_frame(p->out, *out);
    if (error < 0) av_frame_free(out);
    return error;
}

ZT_MODULE_DOOR(zt_video_palette_door, video_palette) = {
    open_palette, count_colours, choose_colours, use_colours, close_palette};
