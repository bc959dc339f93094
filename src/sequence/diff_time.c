/* How long it takes to render what differs. */
#include <zoetrope/diff.h>

#include "base/diag.h"
#include "sequence/renderer.h"

/* A picture that is a quarter as wide and high is told apart from nothing at least so small. */
enum { PART = 4, SMALL = 160 };

static void ask_manifest(zt_diff_time *time, const zt_diff *diff, const zt_manifest *manifest,
                         int width, int height) {
    zt_render_settings noted = {0};
    double sum_s = 0;
    if (manifest) zt_manifest_settings(&noted, manifest);
    if (noted.width != width || noted.height != height || diff->resettled) return;
    for (int64_t i = 0; i < diff->frame_count; i++) {
        double took_s = zt_manifest_time(manifest, diff->frames[i]);
        if (took_s < 0) continue;
        sum_s += took_s;
        time->known_count++;
    }
    if (time->known_count > 0)
        time->seconds = sum_s * (double)diff->frame_count / (double)time->known_count;
}

/* The time of a frame of the full size; preparing it takes as long for any size. */
static zt_status measure(double *seconds, zt_renderer *r, int64_t frame, double pixel_ratio,
                         const zt_watcher *watcher) {
    zt_image *image;
    ZT_TRY(zt_image_create(&image, r->format.width, r->format.height));
    zt_status status = zt_renderer_take(r, frame, image, watcher);
    *seconds = r->cost.freeze_s + r->cost.prepare_s + pixel_ratio * r->cost.render_s;
    zt_image_free(&image);
    return status;
}

static zt_status measure_two(zt_diff_time *time, const zt_diff *diff, zt_renderer *r,
                             double pixel_ratio, const zt_watcher *watcher) {
    const int64_t places[] = {diff->frame_count / 4, diff->frame_count * 3 / 4};
    double sum_s = 0;
    for (int i = 0; i < 2; i++) {
        double took_s;
        if (i > 0 && places[i] == places[0]) break;
        time->measured[i] = diff->frames[places[i]];
        ZT_TRY(measure(&took_s, r, time->measured[i], pixel_ratio, watcher));
        time->measured_count++;
        sum_s += took_s;
    }
    time->seconds = sum_s / time->measured_count * (double)diff->frame_count;
    return ZT_OK;
}

zt_status zt_diff_estimate(zt_diff_time *time, const zt_diff *diff, const zt_manifest *manifest,
                           const zt_animation *newer, const zt_render_settings *settings,
                           const zt_watcher *watcher, zt_listener listener) {
    *time = (zt_diff_time){0};
    const zt_film *film = zt_animation_film(newer);
    zt_render_settings smaller = *settings;
    int width = settings->width ? settings->width : film->width,
        height = settings->height ? settings->height : film->height;
    ask_manifest(time, diff, manifest, width, height);
    if (time->known_count > 0 || diff->frame_count == 0) return ZT_OK;
    time->measured_part = width >= PART * SMALL && height >= PART ? PART : 1;
    smaller.width = width / time->measured_part;
    smaller.height = height / time->measured_part;
    double ratio = (double)width * height / ((double)smaller.width * smaller.height);
    zt_renderer *renderer;
    ZT_TRY(zt_renderer_open(&renderer, newer, &smaller, listener));
    zt_status status = measure_two(time, diff, renderer, ratio, watcher);
    zt_renderer_close(&renderer);
    return status;
}
