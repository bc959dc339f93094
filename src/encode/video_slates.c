#include "encode/video_slates.h"

#include <stdlib.h>
#include <string.h>
#include <threads.h>

#include "image/stamps.h"

struct zt_video_slates {
    mtx_t mutex;
    zt_video_slate **all;
    int count;
    int64_t turn, spared;
};

zt_status zt_video_slates_open(zt_video_slates **out) {
    zt_video_slates *s = *out = calloc(1, sizeof *s);
    if (!s) return ZT_EMEMORY;
    if (mtx_init(&s->mutex, mtx_plain) == thrd_success) return ZT_OK;
    free(s);
    *out = NULL;
    return ZT_EMEMORY;
}

static void free_slate(zt_video_slate *slate) {
    av_frame_free(&slate->frame);
    free(slate->stamps);
    free(slate);
}

void zt_video_slates_close(zt_video_slates **slates) {
    zt_video_slates *s = *slates;
    if (!s) return;
    for (int i = 0; i < s->count; i++) free_slate(s->all[i]);
    free(s->all);
    mtx_destroy(&s->mutex);
    free(s);
    *slates = NULL;
}

static zt_status fill_slate(zt_video_slate *slate, int width, int height,
                            enum AVPixelFormat pixels, const zt_video_ear *ear) {
    size_t tiles = (size_t)zt_stamp_tiles(width) * (size_t)zt_stamp_tiles(height);
    slate->stamps = calloc(tiles, sizeof *slate->stamps);
    AVFrame *frame = slate->frame = av_frame_alloc();
    if (!slate->stamps || !frame) return ZT_EMEMORY;
    frame->width = width;
    frame->height = height;
    frame->format = pixels;
    AV_TRY(ear, av_frame_get_buffer(frame, 0));
    /* Readers may look past the ends of lines: what is there must not depend on what memory
     * held. */
    for (int i = 0; i < AV_NUM_DATA_POINTERS && frame->buf[i]; i++)
        memset(frame->buf[i]->data, 0, frame->buf[i]->size);
    return ZT_OK;
}

static bool is_like(const AVFrame *frame, int width, int height, enum AVPixelFormat pixels) {
    return frame->width == width && frame->height == height && frame->format == (int)pixels;
}

/* Under the lock. */
static zt_status add_slate(zt_video_slates *s, zt_video_slate *slate) {
    zt_video_slate **all = reallocarray(s->all, (size_t)s->count + 1, sizeof(zt_video_slate *));
    if (!all) return ZT_EMEMORY;
    s->all = all;
    s->all[s->count++] = slate;
    return ZT_OK;
}

zt_status zt_video_slates_take(zt_video_slate **out, zt_video_slates *s, int width, int height,
                               enum AVPixelFormat pixels, const zt_video_ear *ear) {
    zt_video_slate *best = NULL;
    mtx_lock(&s->mutex);
    for (int i = 0; i < s->count; i++) {
        zt_video_slate *slate = s->all[i];
        if (!slate->taken && (!best || slate->turn > best->turn) &&
            is_like(slate->frame, width, height, pixels) && av_frame_is_writable(slate->frame))
            best = slate;
    }
    if (best) best->taken = true;
    mtx_unlock(&s->mutex);
    *out = best;
    if (best) return ZT_OK;
    zt_video_slate *slate = calloc(1, sizeof *slate);
    if (!slate) return ZT_EMEMORY;
    slate->taken = true;
    zt_status status = fill_slate(slate, width, height, pixels, ear);
    mtx_lock(&s->mutex);
    if (status == ZT_OK) status = add_slate(s, slate);
    mtx_unlock(&s->mutex);
    if (status == ZT_OK)
        *out = slate;
    else
        free_slate(slate);
    return status;
}

void zt_video_slates_give(zt_video_slates *s, zt_video_slate *slate) {
    mtx_lock(&s->mutex);
    slate->taken = false;
    slate->turn = ++s->turn;
    mtx_unlock(&s->mutex);
}

void zt_video_slates_spare(zt_video_slates *s, int64_t tiles) {
    mtx_lock(&s->mutex);
    s->spared += tiles;
    mtx_unlock(&s->mutex);
}

int64_t zt_video_slates_spared(const zt_video_slates *s) { return s->spared; }
