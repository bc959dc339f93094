#include "encode/raster.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include <librsvg/rsvg.h>

#include "base/diag.h"

enum { SIDE_MAX = 30000 }; /* cairo's own limit is 32767 */

/* Draws into a surface of its own; NULL, with *why, where that fails. */
static cairo_surface_t *draw_surface(RsvgHandle *handle, double scale, GError **why) {
    double width, height;
    if (!rsvg_handle_get_intrinsic_size_in_pixels(handle, &width, &height)) return NULL;
    width *= scale, height *= scale;
    if (!(width >= 1 && width <= SIDE_MAX && height >= 1 && height <= SIDE_MAX)) return NULL;
    cairo_surface_t *surface =
        cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)width, (int)height);
    cairo_t *context = cairo_create(surface);
    cairo_set_source_rgb(context, 1, 1, 1);
    cairo_paint(context);
    RsvgRectangle all = {0, 0, width, height};
    bool good = rsvg_handle_render_document(handle, context, &all, why) &&
                cairo_status(context) == CAIRO_STATUS_SUCCESS;
    cairo_destroy(context);
    cairo_surface_flush(surface);
    if (good) return surface;
    cairo_surface_destroy(surface);
    return NULL;
}

static zt_status copy(zt_raster *raster, cairo_surface_t *surface) {
    raster->width = cairo_image_surface_get_width(surface);
    raster->height = cairo_image_surface_get_height(surface);
    size_t row = (size_t)raster->width * sizeof *raster->pixels;
    raster->pixels = malloc(row * (size_t)raster->height);
    if (!raster->pixels) return ZT_EMEMORY;
    const unsigned char *bytes = cairo_image_surface_get_data(surface);
    size_t stride = (size_t)cairo_image_surface_get_stride(surface);
    for (size_t y = 0; y < (size_t)raster->height; y++)
        memcpy((char *)raster->pixels + y * row, bytes + y * stride, row);
    return ZT_OK;
}

static zt_status draw(zt_raster *raster, const char *svg, size_t length, double scale,
                      zt_listener listener) {
    GError *why = NULL;
    cairo_surface_t *surface = NULL;
    RsvgHandle *handle = rsvg_handle_new_from_data((const guint8 *)svg, length, &why);
    if (handle) surface = draw_surface(handle, scale, &why);
    zt_status status = ZT_EFILE;
    if (surface)
        status = copy(raster, surface);
    else
        zt_tell(listener, ZT_ERROR, "the drawing cannot become pixels: %s",
                why ? why->message : "it has no size, or is too large");
    if (surface) cairo_surface_destroy(surface);
    if (handle) g_object_unref(handle);
    g_clear_error(&why);
    return status;
}

ZT_MODULE_DOOR(zt_raster_door, raster) = {draw};
