/* An image's file says how it was rendered: so it is once more. */
#include <zoetrope/reproduce.h>

#include <math.h>
#include <stdlib.h>

#include <zoetrope/aov.h>

#include "base/bits.h"
#include "base/diag.h"
#include "base/text.h"
#include "image/color.h"
#include "image/file.h"
#include "image/layers.h"
#include "sequence/renderer.h"
#include "sequence/settings.h"

struct zt_origin_memory {
    zt_arena arena;
    zt_settings settings;
    const zt_wish *options; /* of the output that it came from */
};

static zt_status read_origin(zt_origin *o, zt_listener listener) {
    struct zt_origin_memory *m = o->memory;
    ZT_TRY(zt_image_read(&o->image, o->path, listener));
    const zt_image_info *info = &o->image->info;
    if (!info->known || !info->settings) {
        zt_tell(listener, ZT_ERROR,
                "%s does not say how it was rendered; .exr, .png and .tif files of a film do",
                o->path);
        return ZT_EFILE;
    }
    ZT_TRY(zt_settings_read(&m->settings, info->settings, o->path, &m->arena, listener));
    ZT_TRY(zt_settings_options(&m->options, &m->settings, &m->arena));
    o->overrides = m->settings.overrides;
    o->override_count = m->settings.override_count;
    if (o->image->width == m->settings.width && o->image->height == m->settings.height)
        return ZT_OK;
    zt_tell(listener, ZT_ERROR, "%s was rendered with %d x %d pixels, and has %d x %d now",
            o->path, m->settings.width, m->settings.height, o->image->width, o->image->height);
    return ZT_EFILE;
}

zt_status zt_origin_read(zt_origin **out, const char *path, zt_listener listener) {
    *out = NULL;
    zt_origin *o = calloc(1, sizeof *o);
    if (!o) return ZT_EMEMORY;
    o->path = path;
    o->memory = calloc(1, sizeof *o->memory);
    zt_status status = o->memory ? read_origin(o, listener) : ZT_EMEMORY;
    if (status != ZT_OK) zt_origin_free(&o);
    *out = o;
    return status;
}

void zt_origin_free(zt_origin **slot) {
    if (!*slot) return;
    zt_image_free(&(*slot)->image);
    if ((*slot)->memory) zt_arena_free(&(*slot)->memory->arena);
    free((*slot)->memory);
    free(*slot);
    *slot = NULL;
}

typedef struct look_memory {
    zt_look look; /* comes first: it is what others see */
    zt_arena arena;
} look_memory;

/* What an image says of its settings; false where that is nothing that can be read. */
static bool read_settings(zt_settings *settings, const zt_image *image, zt_arena *arena) {
    return image->info.known && image->info.settings &&
           zt_settings_read(settings, image->info.settings, "", arena, (zt_listener){0}) ==
               ZT_OK;
}

zt_status zt_look_find(zt_look **out, const zt_image *image, const zt_view *view) {
    look_memory *m = calloc(1, sizeof *m);
    zt_settings settings;
    zt_status status = ZT_OK;
    *out = NULL;
    if (!m) return ZT_EMEMORY;
    bool known = read_settings(&settings, image, &m->arena);
    m->look.view = known ? settings.view : ZT_VIEW_SRGB;
    if (known) m->look.color = settings.color;
    if (view) {
        m->look.view = *view;
        m->look.color.wished = false;
    }
    if (known) {
        settings.format = NULL;
        settings.aovs = 0; /* a movie has none */
        settings.view = m->look.view;
        settings.color = m->look.color;
        status = zt_settings_print(&m->look.settings, &settings, &m->arena);
    }
    if (!image->linear) {
        m->look.view = ZT_VIEW_RAW;
        m->look.color.wished = false;
    }
    *out = &m->look;
    if (status != ZT_OK) zt_look_free(out);
    return status;
}

void zt_look_free(zt_look **look) {
    if (!*look) return;
    zt_arena_free(&((look_memory *)*look)->arena);
    free(*look);
    *look = NULL;
}

/* ---- comparing -----------------------------------------------------------------------------
 */

/* The numbers of one channel, `stride` apart. */
typedef struct plane {
    const char *channel;
    const float *was, *is;
    int stride;
} plane;

enum { PLANES_MAX = 4 + ZT_IMAGE_CHANNELS_MAX };

/* What both images have; 0 where the file has a channel that was not rendered, which is told.
 */
static int list_planes(plane planes[PLANES_MAX], const zt_origin *o, const zt_image *is,
                       zt_listener listener) {
    static const char *const colours[] = {"R", "G", "B", "A"};
    const zt_image *was = o->image;
    int count = 0;
    for (int c = 0; c < 4; c++)
        planes[count++] = (plane){colours[c], was->pixels + c, is->pixels + c, 4};
    for (int c = 0; c < was->channel_count; c++) {
        const char *name = was->channels[c].name;
        const float *rendered = zt_image_channel(is, name);
        planes[count++] = (plane){name, was->channels[c].values, rendered, 1};
        if (rendered) continue;
        zt_tell(listener, ZT_ERROR, "%s has a channel %s that it was not rendered with",
                o->path, name);
        return 0;
    }
    return count;
}

static double size_of(const zt_deviation *d) {
    double size = fabs(d->is - d->was);
    return isnan(size) ? INFINITY : size;
}

static void compare_pixel(zt_reproduction *r, const plane *planes, int count, int column,
                          int row, size_t pixel) {
    bool first = true;
    for (const plane *p = planes; p < planes + count; p++) {
        const float *was = p->was + pixel * (size_t)p->stride,
                    *is = p->is + pixel * (size_t)p->stride;
        if (zt_bits_equal(was, is, sizeof *is)) continue;
        const zt_deviation d = {column, row, p->channel, (double)*was, (double)*is};
        if (r->different_count == 0 && first) r->largest = d;
        if (size_of(&d) > size_of(&r->largest)) r->largest = d;
        if (first && r->first_count < ZT_DEVIATIONS_MAX) r->first[r->first_count++] = d;
        first = false;
    }
    r->different_count += !first;
}

static zt_status compare(zt_reproduction *r, const zt_origin *o, const zt_image *is,
                         zt_listener listener) {
    plane planes[PLANES_MAX];
    int width = o->image->width, height = o->image->height,
        count = list_planes(planes, o, is, listener);
    if (count == 0) return ZT_EFILE;
    r->pixel_count = (int64_t)width * height;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++)
            compare_pixel(r, planes, count, x, y, (size_t)y * (size_t)width + (size_t)x);
    return ZT_OK;
}

/* ---- rendering -----------------------------------------------------------------------------
 */

/* Compares with what comes of an image that is written as the file was. */
static zt_status compare_stored(zt_reproduction *r, const zt_origin *o, const zt_image *image,
                                const zt_image_wishes *wishes, zt_listener listener) {
    zt_bytes bytes;
    zt_image *stored = NULL;
    ZT_TRY(zt_image_file_encode(&bytes, image, o->memory->settings.view, wishes, o->path,
                                listener));
    zt_status status = zt_image_file_decode(&stored, &bytes, o->path, listener);
    free(bytes.data);
    if (status == ZT_OK) status = compare(r, o, stored, listener);
    zt_image_free(&stored);
    return status;
}

/* A file of one layer does not say which: it is the one from which it differs least. */
static zt_status compare_layers(zt_reproduction *r, const zt_origin *o, const zt_image *image,
                                zt_image_wishes *wishes) {
    for (int c = 0; c < image->channel_count && r->different_count > 0; c++) {
        char layer[ZT_LAYER_NAME_MAX];
        zt_reproduction other = *r;
        other.different_count = other.first_count = 0;
        zt_layer_of(layer, image->channels[c].name);
        wishes->layer = layer;
        zt_status status = compare_stored(&other, o, image, wishes, (zt_listener){0});
        if (status == ZT_EFILE) continue; /* it has other channels */
        ZT_TRY(status);
        if (other.different_count < r->different_count) *r = other;
    }
    return ZT_OK;
}

static zt_status compare_written(zt_reproduction *r, const zt_origin *o,
                                 const zt_renderer *renderer, const zt_image *image,
                                 zt_listener listener) {
    zt_image_wishes wishes;
    zt_color *color = NULL;
    ZT_TRY(zt_image_wish(&wishes, o->path, o->memory->options, listener));
    if (!o->image->linear) ZT_TRY(zt_color_open(&color, &renderer->format.color, listener));
    wishes.color = color;
    zt_status status = compare_stored(r, o, image, &wishes, listener);
    if (status == ZT_OK) status = compare_layers(r, o, image, &wishes);
    zt_color_close(&color);
    return status;
}

static zt_status render(zt_reproduction *r, zt_image *image, const zt_origin *o,
                        zt_renderer *renderer, const zt_watcher *watcher) {
    zt_hash key, was = o->image->info.key;
    renderer->sampling = o->memory->settings.sampling;
    renderer->aovs = o->memory->settings.aovs;
    ZT_TRY(zt_renderer_key(&key, renderer, o->image->info.frame));
    r->same_key = zt_hash_equal(key, was);
    ZT_TRY(zt_image_add_aovs(image, renderer->aovs));
    ZT_TRY(zt_renderer_take(renderer, o->image->info.frame, image, watcher));
    image->info = o->image->info;
    return ZT_OK;
}

static zt_status reproduce(zt_reproduction *r, const zt_origin *o, zt_renderer *renderer,
                           const zt_watcher *watcher, zt_listener listener) {
    zt_image *image = NULL;
    ZT_TRY(zt_image_create(&image, o->image->width, o->image->height));
    zt_status status = render(r, image, o, renderer, watcher);
    if (status == ZT_OK) status = compare_written(r, o, renderer, image, listener);
    zt_image_free(&image);
    return status;
}

zt_status zt_reproduce(zt_reproduction *r, const zt_origin *o, const zt_animation *animation,
                       int threads, const zt_watcher *watcher, zt_listener listener) {
    const zt_settings *s = &o->memory->settings;
    const zt_render_settings settings = {
        .width = s->width, .height = s->height, .threads = threads, .precision = s->precision};
    zt_renderer *renderer;
    *r = (zt_reproduction){.same_arithmetic = zt_text_equal(s->arithmetic, zt_arithmetic)};
    ZT_TRY(zt_renderer_open(&renderer, animation, &settings, listener));
    zt_status status = reproduce(r, o, renderer, watcher, listener);
    zt_renderer_close(&renderer);
    return status;
}
