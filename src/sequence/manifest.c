/* Manifests: frames and what they were rendered with, kept in order, written and read. */
#include "sequence/manifest.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/diag.h"
#include "encode/aside.h"
#include "sequence/json.h"

enum { SAMPLES_MAX = 65536 };
static const int64_t frame_max = INT64_C(1) << 40;

struct zt_manifest {
    int width, height;
    zt_precision precision;
    zt_manifest_frame *frames; /* by rising number */
    size_t count, capacity;
};

static const char *const precisions[] = {[ZT_PRECISION_AUTO] = "auto",
                                         [ZT_PRECISION_SINGLE] = "single",
                                         [ZT_PRECISION_DOUBLE] = "double"};

zt_manifest *zt_manifest_create(int width, int height, zt_precision precision) {
    zt_manifest *manifest = calloc(1, sizeof *manifest);
    if (manifest)
        *manifest = (zt_manifest){.width = width, .height = height, .precision = precision};
    return manifest;
}

void zt_manifest_free(zt_manifest **slot) {
    if (*slot) free((*slot)->frames);
    free(*slot);
    *slot = NULL;
}

/* The place of the first frame that is not before this one. */
static size_t place_of(const zt_manifest *m, int64_t frame) {
    size_t low = 0, high = m->count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (m->frames[middle].frame < frame)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static zt_status make_room(zt_manifest *m) {
    if (m->count < m->capacity) return ZT_OK;
    size_t capacity = m->capacity ? 2 * m->capacity : 64;
    zt_manifest_frame *frames = reallocarray(m->frames, capacity, sizeof *frames);
    if (!frames) return ZT_EMEMORY;
    m->frames = frames;
    m->capacity = capacity;
    return ZT_OK;
}

zt_status zt_manifest_add(zt_manifest *m, const zt_manifest_frame *frame) {
    size_t place = place_of(m, frame->frame);
    if (place == m->count || m->frames[place].frame != frame->frame) {
        ZT_TRY(make_room(m));
        memmove(m->frames + place + 1, m->frames + place,
                (m->count - place) * sizeof *m->frames);
        m->count++;
    }
    m->frames[place] = *frame;
    return ZT_OK;
}

const zt_manifest_frame *zt_manifest_find(const zt_manifest *m, int64_t frame) {
    size_t place = place_of(m, frame);
    return place < m->count && m->frames[place].frame == frame ? &m->frames[place] : NULL;
}

void zt_manifest_range(int64_t *first, int64_t *last, const zt_manifest *m) {
    *first = m->frames[0].frame;
    *last = m->frames[m->count - 1].frame;
}

void zt_manifest_settings(zt_render_settings *settings, const zt_manifest *m) {
    if (settings->width == 0) {
        settings->width = m->width;
        settings->height = m->height;
    }
    if (settings->precision == ZT_PRECISION_AUTO) settings->precision = m->precision;
}

/* ---- writing --------------------------------------------------------------------------------
 */

static void print_frame(FILE *file, const zt_manifest_frame *f) {
    fprintf(file, "    {\"frame\": %" PRId64 ", ", f->frame);
    if (f->min == f->max) {
        fprintf(file, "\"samples\": %" PRId32 "}", f->max);
        return;
    }
    fprintf(file, "\"min\": %" PRId32 ", \"max\": %" PRId32 ", \"error\": ", f->min, f->max);
    zt_json_print_number(file, f->error);
    if (f->mean_max > 0) fprintf(file, ", \"mean_max\": %" PRId32, f->mean_max);
    putc('}', file);
}

static bool print(FILE *file, const zt_manifest *m, const char *description) {
    fputs("{\n  \"zoetrope\": 1,\n  \"description\": ", file);
    zt_json_print_text(file, description);
    fprintf(file, ",\n  \"size\": [%d, %d],\n  \"precision\": \"%s\",\n  \"frames\": [\n",
            m->width, m->height, precisions[m->precision]);
    for (size_t i = 0; i < m->count; i++) {
        print_frame(file, &m->frames[i]);
        fputs(i + 1 < m->count ? ",\n" : "\n", file);
    }
    fputs("  ]\n}\n", file);
    return fflush(file) == 0 && !ferror(file);
}

static zt_status write_file(const zt_manifest *m, const char *path, const char *description) {
    FILE *file = fopen(path, "w");
    if (!file) return ZT_EFILE;
    bool good = print(file, m, description);
    int why = errno;
    if (fclose(file) != 0 && good) return ZT_EFILE;
    errno = why;
    return good ? ZT_OK : ZT_EFILE;
}

zt_status zt_manifest_write(const zt_manifest *m, const char *path, const char *description,
                            zt_listener listener) {
    zt_aside aside;
    ZT_TRY(zt_aside_open(&aside, path, listener));
    zt_status status = write_file(m, aside.path, description);
    if (status == ZT_OK) return zt_aside_keep(&aside, listener);
    zt_tell(listener, ZT_ERROR, "cannot write %s: %s", path, strerror(errno));
    zt_aside_drop(&aside);
    return status;
}

/* ---- reading --------------------------------------------------------------------------------
 */

static zt_status read_precision(zt_manifest *m, zt_json *json) {
    char text[16];
    ZT_TRY(zt_json_text(json, text, sizeof text));
    for (int i = 0; i < 3; i++) {
        if (strcmp(text, precisions[i]) != 0) continue;
        m->precision = (zt_precision)i;
        return ZT_OK;
    }
    return zt_json_refuse(json, "\"precision\" must be \"auto\", \"single\" or \"double\"");
}

static zt_status read_size(zt_manifest *m, zt_json *json) {
    int64_t width, height;
    ZT_TRY(zt_json_mark(json, '['));
    ZT_TRY(zt_json_integer(json, &width, 1, ZT_IMAGE_SIDE_MAX));
    ZT_TRY(zt_json_mark(json, ','));
    ZT_TRY(zt_json_integer(json, &height, 1, ZT_IMAGE_SIDE_MAX));
    ZT_TRY(zt_json_mark(json, ']'));
    m->width = (int)width;
    m->height = (int)height;
    return ZT_OK;
}

/* What has been read of a frame, a bit for each key. */
enum {
    HAS_FRAME = 1,
    HAS_SAMPLES = 2,
    HAS_MIN = 4,
    HAS_MAX = 8,
    HAS_ERROR = 16,
    HAS_MEAN = 32
};

static zt_status read_frame_field(zt_manifest_frame *f, unsigned *has, zt_json *json) {
    static const char *const keys[] = {"frame", "samples",  "min", "max",
                                       "error", "mean_max", NULL};
    int64_t number = 0;
    int key;
    ZT_TRY(zt_json_key(json, &key, keys));
    if (*has & 1u << key) return zt_json_refuse(json, "\"%s\" is there twice", keys[key]);
    *has |= 1u << key;
    if (1 << key == HAS_ERROR) return zt_json_number(json, &f->error, 0, 1);
    if (1 << key == HAS_FRAME) return zt_json_integer(json, &f->frame, 0, frame_max);
    ZT_TRY(zt_json_integer(json, &number, 1, SAMPLES_MAX));
    if (1 << key == HAS_MEAN) {
        f->mean_max = (int32_t)number;
        return ZT_OK;
    }
    if (1 << key != HAS_MAX) f->min = (int32_t)number;
    if (1 << key != HAS_MIN) f->max = (int32_t)number;
    return ZT_OK;
}

static zt_status read_frame(zt_manifest *m, zt_json *json) {
    zt_manifest_frame f = {0};
    unsigned has = 0;
    bool more;
    ZT_TRY(zt_json_mark(json, '{'));
    do {
        ZT_TRY(read_frame_field(&f, &has, json));
        ZT_TRY(zt_json_more(json, &more, '}'));
    } while (more);
    if (has != (HAS_FRAME | HAS_SAMPLES) &&
        (has & ~(unsigned)HAS_MEAN) != (HAS_FRAME | HAS_MIN | HAS_MAX | HAS_ERROR))
        return zt_json_refuse(json, "a frame has \"frame\" and either \"samples\" or \"min\", "
                                    "\"max\" and \"error\"");
    if (f.min > f.max) return zt_json_refuse(json, "\"max\" is below \"min\"");
    if (m->count > 0 && f.frame <= m->frames[m->count - 1].frame)
        return zt_json_refuse(json, "frame %" PRId64 " comes after frame %" PRId64, f.frame,
                              m->frames[m->count - 1].frame);
    return zt_manifest_add(m, &f);
}

static zt_status read_frames(zt_manifest *m, zt_json *json) {
    bool more;
    ZT_TRY(zt_json_mark(json, '['));
    do {
        ZT_TRY(read_frame(m, json));
        ZT_TRY(zt_json_more(json, &more, ']'));
    } while (more);
    return ZT_OK;
}

enum { KEY_VERSION, KEY_DESCRIPTION, KEY_SIZE, KEY_PRECISION, KEY_FRAMES, KEY_COUNT };

static zt_status read_field(zt_manifest *m, int key, zt_json *json) {
    int64_t version;
    switch (key) {
    case KEY_VERSION:
        return zt_json_integer(json, &version, 1, 1);
    case KEY_DESCRIPTION:
        return zt_json_text(json, NULL, 0);
    case KEY_SIZE:
        return read_size(m, json);
    case KEY_PRECISION:
        return read_precision(m, json);
    default:
        return read_frames(m, json);
    }
}

static zt_status read_all(zt_manifest *m, zt_json *json) {
    static const char *const keys[] = {"zoetrope",  "description", "size",
                                       "precision", "frames",      NULL};
    unsigned has = 0;
    bool more;
    ZT_TRY(zt_json_mark(json, '{'));
    do {
        int key;
        ZT_TRY(zt_json_key(json, &key, keys));
        if (has & 1u << key) return zt_json_refuse(json, "\"%s\" is there twice", keys[key]);
        has |= 1u << key;
        ZT_TRY(read_field(m, key, json));
        ZT_TRY(zt_json_more(json, &more, '}'));
    } while (more);
    for (int key = 0; key < KEY_COUNT; key++)
        if (!(has & 1u << key)) return zt_json_refuse(json, "\"%s\" is missing", keys[key]);
    return zt_json_end(json);
}

zt_status zt_manifest_read(zt_manifest **out, const char *path, zt_listener listener) {
    zt_json json;
    *out = NULL;
    ZT_TRY(zt_json_open(&json, path, listener));
    zt_manifest *m = zt_manifest_create(0, 0, ZT_PRECISION_AUTO);
    zt_status status = m ? read_all(m, &json) : ZT_EMEMORY;
    zt_json_close(&json);
    if (status != ZT_OK) zt_manifest_free(&m);
    *out = m;
    return status;
}
