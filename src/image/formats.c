#include "image/formats.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/diag.h"
#include "base/text.h"

/* Measured at 1280x720: 8 bits with dithering are not smaller with zip:4, which takes twice as
 * long; floats are a quarter smaller with zip, which takes ten times as long. */
static const zt_compression png[] = {{"rle", 0, 0, 0}, {"zip", 0, 9, 4}, {0}};
static const zt_compression exr[] = {{"zip", 1, 9, 4},
                                     {"none", 0, 0, 0},
                                     {"rle", 0, 0, 0},
                                     {"zips", 1, 9, 4},
                                     {"piz", 0, 0, 0},
                                     {"pxr24", 0, 0, 0},
                                     {"b44", 0, 0, 0},
                                     {"b44a", 0, 0, 0},
                                     {"dwaa", 1, 100000, 45},
                                     {"dwab", 1, 100000, 45},
                                     {0}};
static const zt_compression tiff[] = {
    {"zip", 1, 9, 4}, {"none", 0, 0, 0}, {"lzw", 0, 0, 0}, {"packbits", 0, 0, 0}, {0}};
static const zt_compression jpeg[] = {{"jpeg", 1, 100, 95}, {0}};
static const zt_compression webp[] = {{"webp", 1, 100, 95}, {0}};

static const zt_image_format formats[] = {
    {{".png"}, {ZT_DEPTH_8, ZT_DEPTH_16}, 2, png, NULL, false, true, false},
    {{".exr"}, {ZT_DEPTH_FLOAT, ZT_DEPTH_HALF}, 2, exr, "rle", true, true, true},
    {{".tif", ".tiff"},
     {ZT_DEPTH_16, ZT_DEPTH_8, ZT_DEPTH_FLOAT},
     3,
     tiff,
     NULL,
     true,
     true,
     false},
    {{".jpg", ".jpeg"}, {ZT_DEPTH_8}, 1, jpeg, NULL, false, false, false},
    {{".webp"}, {ZT_DEPTH_8}, 1, webp, NULL, false, true, false},
    {{".hdr"}, {ZT_DEPTH_FLOAT}, 1, NULL, NULL, false, false, false},
    {{".dpx"},
     {ZT_DEPTH_10, ZT_DEPTH_8, ZT_DEPTH_12, ZT_DEPTH_16},
     4,
     NULL,
     NULL,
     false,
     true,
     false}};
enum { FORMAT_COUNT = sizeof formats / sizeof *formats, LIST_MAX = 160, TILE_MAX = 4096 };

const char *const zt_image_file_endings[] = {".png",  ".exr",  ".tif", ".tiff", ".jpg",
                                             ".jpeg", ".webp", ".hdr", ".dpx",  NULL};
const char *const zt_image_file_options[] = {"format-option", NULL};

static const char *const depth_names[ZT_DEPTH_COUNT] = {"8", "10", "12", "16", "half", "float"};

static void append(char list[LIST_MAX], const char *item) {
    size_t used = strlen(list);
    snprintf(list + used, LIST_MAX - used, "%s%s", used ? ", " : "", item);
}

static zt_status refuse(zt_listener listener, const zt_image_wishes *w, const char *option,
                        const char *value, const char *there_is) {
    zt_tell(listener, ZT_ERROR, "%s=%s makes no sense for a %s file; there is: %s", option,
            value, w->format->endings[0] + 1, there_is);
    return ZT_EARGUMENT;
}

static zt_status wish_depth(zt_image_wishes *w, const char *value, zt_listener listener) {
    char list[LIST_MAX] = "";
    w->depth = w->format->depths[0];
    for (int i = 0; value && i < w->format->depth_count; i++) {
        const char *name = depth_names[w->format->depths[i]];
        if (zt_text_equal(value, name)) {
            w->depth = w->format->depths[i];
            return ZT_OK;
        }
        append(list, name);
    }
    return value ? refuse(listener, w, "bits", value, list) : ZT_OK;
}

/* "dwaa" or "dwaa:45". */
static zt_status wish_compression(zt_image_wishes *w, const char *value, zt_listener listener) {
    const zt_compression *c = w->compression = w->format->compressions;
    char list[LIST_MAX] = "";
    w->level = c ? c->own : 0;
    if (!value && w->depth == ZT_DEPTH_FLOAT) value = w->format->of_floats;
    if (!value) return ZT_OK;
    const char *colon = strchr(value, ':');
    size_t length = colon ? (size_t)(colon - value) : strlen(value);
    for (; c && c->name; c++) {
        char item[48];
        double level = c->own;
        bool same = strlen(c->name) == length && strncmp(c->name, value, length) == 0;
        bool number = !colon || zt_text_number(&level, colon + 1, value + strlen(value));
        if (same && number && level == (int)level && (!colon || c->highest > 0) &&
            level >= c->lowest && level <= c->highest) {
            w->compression = c;
            w->level = (int)level;
            return ZT_OK;
        }
        snprintf(item, sizeof item, c->highest ? "%s:%d-%d" : "%s", c->name, c->lowest,
                 c->highest);
        append(list, item);
    }
    return refuse(listener, w, "compression", value, *list ? list : "none");
}

static zt_status wish_tile(zt_image_wishes *w, const char *value, zt_listener listener) {
    double side;
    w->tile = 0;
    if (!value || zt_text_equal(value, "none")) return ZT_OK;
    bool good = zt_text_number(&side, value, value + strlen(value)) && side == (int)side &&
                side >= 16 && side <= TILE_MAX && (int)side % 16 == 0;
    if (!good || !w->format->has_tiles)
        return refuse(listener, w, "tile", value,
                      w->format->has_tiles ? "none, or the side of a tile, 16 to 4096 and a "
                                             "multiple of 16"
                                           : "none");
    w->tile = (int)side;
    return ZT_OK;
}

static zt_status wish_parts(zt_image_wishes *w, const char *value, zt_listener listener) {
    w->parts = value && zt_text_equal(value, "layers");
    if (!value || zt_text_equal(value, "one") || (w->parts && w->format->has_layers))
        return ZT_OK;
    return refuse(listener, w, "parts", value, w->format->has_layers ? "one, layers" : "one");
}

/* What a format-option says of a key; NULL where none does. Of two the later counts. */
static const char *value_of(const zt_wish *options, const char *key) {
    const char *value = NULL;
    size_t length = strlen(key);
    for (; options && options->name; options++)
        if (zt_text_equal(options->name, "format-option") &&
            strncmp(options->value, key, length) == 0 && options->value[length] == '=')
            value = options->value + length + 1;
    return value;
}

/* Refuses the first format-option that is not "key=value" of a key that there is. */
static zt_status check_keys(const zt_wish *options, zt_listener listener) {
    static const char *const keys[] = {"bits", "compression", "tile", "parts"};
    for (; options && options->name; options++) {
        if (!zt_text_equal(options->name, "format-option")) continue;
        size_t length = strcspn(options->value, "=");
        bool known = false;
        for (int i = 0; i < 4 && options->value[length]; i++)
            known |= strlen(keys[i]) == length && strncmp(keys[i], options->value, length) == 0;
        if (known) continue;
        zt_tell(listener, ZT_ERROR,
                "format-option %s: must be bits, compression, tile or parts, such as bits=16",
                options->value);
        return ZT_EARGUMENT;
    }
    return ZT_OK;
}

zt_status zt_image_wish(zt_image_wishes *w, const char *name, const zt_wish *options,
                        zt_listener listener) {
    *w = (zt_image_wishes){0};
    for (int f = 0; f < FORMAT_COUNT; f++)
        for (const char *const *ending = formats[f].endings; *ending; ending++)
            if (zt_text_ends_with(name, *ending, true)) w->format = &formats[f];
    if (!w->format) {
        zt_tell(listener, ZT_ERROR, "no picture format has the ending of %s", name);
        return ZT_EUNSUPPORTED;
    }
    ZT_TRY(check_keys(options, listener));
    ZT_TRY(wish_depth(w, value_of(options, "bits"), listener));
    ZT_TRY(wish_compression(w, value_of(options, "compression"), listener));
    ZT_TRY(wish_tile(w, value_of(options, "tile"), listener));
    return wish_parts(w, value_of(options, "parts"), listener);
}

char *zt_image_wishes_text(const zt_image_wishes *w) {
    char text[LIST_MAX];
    int length = snprintf(text, sizeof text, "bits=%s", depth_names[w->depth]);
    const zt_compression *c = w->compression;
    if (c)
        length +=
            snprintf(text + length, sizeof text - (size_t)length,
                     c->highest ? ",compression=%s:%d" : ",compression=%s", c->name, w->level);
    if (w->tile)
        length += snprintf(text + length, sizeof text - (size_t)length, ",tile=%d", w->tile);
    if (w->parts) snprintf(text + length, sizeof text - (size_t)length, ",parts=layers");
    return strdup(text);
}
