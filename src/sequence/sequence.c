/* Many frames: while one is rendered, the one before is written behind it. */
#include "base/diag.h"
#include "sequence/renderer.h"

/* The frame that is being written, and how that went. */
typedef struct writing {
    zt_output *output;
    const zt_image *image;
    int64_t frame;
    zt_status status;
} writing;

static void write_frame(void *user) {
    writing *w = user;
    w->status = zt_output_write(w->output, w->image, w->frame);
}

static zt_status render_and_write(zt_renderer *r, int64_t first, int64_t last,
                                  zt_image *const *images, writing *w, zt_errand *writer,
                                  const zt_watcher *watcher) {
    for (int64_t frame = first; frame <= last; frame++) {
        zt_image *image = images[(frame - first) % 2];
        ZT_TRY(zt_renderer_frame(r, frame, image, watcher));
        zt_errand_wait(writer);
        ZT_TRY(w->status);
        w->image = image;
        w->frame = frame;
        zt_errand_send(writer);
        if (watcher && watcher->progress)
            watcher->progress(watcher->user, frame - first + 1, last - first + 1, frame);
    }
    zt_errand_wait(writer);
    return w->status;
}

zt_status zt_renderer_sequence(zt_renderer *r, int64_t first, int64_t last, zt_output *output,
                               const zt_watcher *watcher) {
    if (last < first) return ZT_EARGUMENT;
    zt_image *images[2] = {NULL, NULL};
    zt_errand *writer = NULL;
    writing w = {.output = output};
    zt_status status = zt_errand_open(&writer, write_frame, &w);
    for (int i = 0; i < 2 && status == ZT_OK; i++)
        status = zt_image_create(&images[i], r->format.width, r->format.height);
    if (status == ZT_OK) status = render_and_write(r, first, last, images, &w, writer, watcher);
    zt_errand_close(&writer); /* waits for what is still being written */
    if (status == ZT_ESTOPPED && w.status != ZT_OK) status = w.status;
    zt_image_free(&images[0]);
    zt_image_free(&images[1]);
    return status;
}
