#include "sequence/reuse_check.h"

#include <inttypes.h>

#include "base/bits.h"
#include "base/diag.h"
#include "render/guides.h"

/* The first number that differs, or -1. */
static int64_t find_difference(const float *a, const float *b, int64_t count) {
    if (zt_bits_equal(a, b, (size_t)count * sizeof *a)) return -1;
    for (int64_t i = 0; i < count; i++)
        if (!zt_bits_equal(&a[i], &b[i], sizeof *a)) return i;
    return -1;
}

static zt_status tell(const zt_renderer *r, int64_t frame, const char *channel, int64_t pixel,
                      float copied, float rendered) {
    zt_tell(r->listener, ZT_ERROR,
            "frame %" PRId64 ": with tiles copied, %s of pixel (%" PRId64 ", %" PRId64
            ") is %.9g; rendered it is %.9g",
            frame, channel, pixel % r->format.width, pixel / r->format.width, (double)copied,
            (double)rendered);
    return ZT_EUNSUPPORTED;
}

static zt_status compare(const zt_renderer *r, int64_t frame, const zt_image *image,
                         const zt_image *other) {
    static const char *const colors[] = {"R", "G", "B", "A"};
    int64_t count = (int64_t)image->width * image->height;
    int64_t at = find_difference(image->pixels, other->pixels, 4 * count);
    if (at >= 0)
        return tell(r, frame, colors[at % 4], at / 4, image->pixels[at], other->pixels[at]);
    for (int i = 0; i < image->channel_count; i++) {
        const float *a = image->channels[i].values, *b = other->channels[i].values;
        at = find_difference(a, b, count);
        if (at >= 0) return tell(r, frame, image->channels[i].name, at, a[at], b[at]);
    }
    return ZT_OK;
}

zt_status zt_reuse_check(zt_renderer *r, const zt_taking *taking, int64_t frame,
                         const zt_image *image) {
    zt_render_job job = taking->job;
    zt_render_count count;
    zt_image *other;
    job.reuse = NULL;
    ZT_TRY(zt_image_create(&other, image->width, image->height));
    zt_status status = ZT_OK;
    for (int i = 0; i < image->channel_count && status == ZT_OK; i++)
        status = zt_image_add_channel(other, image->channels[i].name);
    if (status == ZT_OK) status = zt_render(other, &count, &job, r->work, r->pool);
    if (status == ZT_OK)
        status = zt_guides_render(other, &job, &taking->exposure, &taking->passage, r->work,
                                  r->pool);
    if (status == ZT_OK) status = zt_meshes_status(r->meshes);
    if (status == ZT_OK) status = compare(r, frame, image, other);
    zt_image_free(&other);
    return status;
}
