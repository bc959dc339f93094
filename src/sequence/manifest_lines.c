/* The lines of a manifest: JSON, one object each. */
#include <inttypes.h>
#include <string.h>

#include "base/diag.h"
#include "base/hash.h"
#include "sequence/manifest.h"

enum { VERSION = 1, SAMPLES_MAX = 65536, FILE_NAME_MAX = 256, SPLIT_MAX = 10000 };
static const int64_t frame_max = INT64_C(1) << 40, count_max = 100000000,
                     byte_max = INT64_C(1) << 53;
static const double seconds_max = 1e12;

static const char *const precisions[] = {[ZT_PRECISION_AUTO] = "auto",
                                         [ZT_PRECISION_SINGLE] = "single",
                                         [ZT_PRECISION_DOUBLE] = "double"};

/* ---- writing --------------------------------------------------------------------------------
 */

static void print_text(FILE *file, const char *key, const char *text) {
    fprintf(file, ", \"%s\": ", key);
    zt_json_print_text(file, text);
}

static void print_number(FILE *file, const char *key, double number) {
    fprintf(file, ", \"%s\": ", key);
    zt_json_print_number(file, number);
}

static void print_hash(FILE *file, const char *key, zt_hash hash) {
    fprintf(file, ", \"%s\": \"%016" PRIx64 "%016" PRIx64 "\"", key, hash.high, hash.low);
}

static void print_header(FILE *file, const zt_manifest_line *l) {
    fprintf(file, "{\"zoetrope\": %d", VERSION);
    print_text(file, "description", l->description ? l->description : "");
    fprintf(file, ", \"size\": [%d, %d], \"precision\": \"%s\"", l->width, l->height,
            precisions[l->precision]);
    print_text(file, "written", l->written ? l->written : "");
}

static void print_samples(FILE *file, const zt_manifest_frame *f) {
    if (f->min == f->max) {
        fprintf(file, ", \"samples\": %" PRId32, f->max);
    } else {
        fprintf(file, ", \"min\": %" PRId32 ", \"max\": %" PRId32, f->min, f->max);
        print_number(file, "error", f->error);
        if (f->mean_max > 0) fprintf(file, ", \"mean_max\": %" PRId32, f->mean_max);
    }
    if (f->budget.film_s > 0) print_number(file, "film_s", f->budget.film_s);
    if (f->budget.frame_s > 0) print_number(file, "frame_s", f->budget.frame_s);
}

static void print_frame(FILE *file, const zt_manifest_frame *f, const zt_output_record *r) {
    fprintf(file, "{\"frame\": %" PRId64, f->frame);
    if (f->max > 0) print_samples(file, f);
    if (zt_hash_is_known(f->key)) print_hash(file, "key", f->key);
    if (zt_hash_is_known(f->pixels)) print_hash(file, "tiles", f->pixels);
    if (f->render_s >= 0) print_number(file, "time", f->render_s);
    if (r->count == 0) return;
    print_text(file, "file", r->file ? r->file : "");
    fprintf(file, ", \"bytes\": %" PRId64, r->bytes);
    print_hash(file, "checksum", r->checksum);
    print_hash(file, "record", r->key);
}

static void print_piece(FILE *file, const zt_output_record *r) {
    fprintf(file, "{\"%s\": %" PRId64 ", \"count\": %" PRId64 ", \"bytes\": %" PRId64,
            r->kind == ZT_RECORD_PIECE ? "piece" : "film", r->first, r->count, r->bytes);
    print_hash(file, "checksum", r->checksum);
    print_hash(file, "record", r->key);
    print_number(file, "time", r->render_s);
}

static void print_split(FILE *file, const zt_manifest_split *s) {
    fprintf(file, "{\"split\": \"%016" PRIx64 "%016" PRIx64 "\", \"ends\": [", s->of.high,
            s->of.low);
    for (int64_t i = 0; i < s->count; i++)
        fprintf(file, "%s%" PRId64, i ? ", " : "", s->ends[i]);
    fputs("]", file);
}

void zt_manifest_print(FILE *file, const zt_manifest_line *line) {
    switch (line->kind) {
    case ZT_LINE_HEADER:
        print_header(file, line);
        break;
    case ZT_LINE_FRAME:
        print_frame(file, &line->frame, &line->record);
        break;
    case ZT_LINE_PIECE:
        print_piece(file, &line->record);
        break;
    case ZT_LINE_SPLIT:
        print_split(file, &line->split);
        break;
    }
    fputs("}\n", file);
}

/* ---- reading --------------------------------------------------------------------------------
 */

enum {
    KEY_VERSION,
    KEY_DESCRIPTION,
    KEY_SIZE,
    KEY_PRECISION,
    KEY_WRITTEN,
    KEY_FRAME,
    KEY_SAMPLES,
    KEY_MIN,
    KEY_MAX,
    KEY_ERROR,
    KEY_MEAN,
    KEY_FILM_S,
    KEY_FRAME_S,
    KEY_KEY,
    KEY_TILES,
    KEY_PIXELS, /* what they were before: not of tiles, and not asked for any more */
    KEY_TIME,
    KEY_FILE,
    KEY_BYTES,
    KEY_CHECKSUM,
    KEY_RECORD,
    KEY_PIECE,
    KEY_FILM,
    KEY_COUNT,
    KEY_SPLIT,
    KEY_ENDS,
    KEYS
};

static const char *const keys[KEYS + 1] = {
    "zoetrope", "description", "size",  "precision", "written", "frame",    "samples",
    "min",      "max",         "error", "mean_max",  "film_s",  "frame_s",  "key",
    "tiles",    "pixels",      "time",  "file",      "bytes",   "checksum", "record",
    "piece",    "film",        "count", "split",     "ends",    NULL};

#define BIT(key) (1u << KEY_##key)
#define HEADER   (BIT(VERSION) | BIT(DESCRIPTION) | BIT(SIZE) | BIT(PRECISION) | BIT(WRITTEN))
#define SAMPLES  (BIT(SAMPLES) | BIT(MIN) | BIT(MAX) | BIT(ERROR) | BIT(MEAN))
#define BUDGET   (BIT(FILM_S) | BIT(FRAME_S))
#define IMAGE    (BIT(FILE) | BIT(BYTES) | BIT(CHECKSUM) | BIT(RECORD))
#define FRAME                                                                                  \
    (BIT(FRAME) | SAMPLES | BUDGET | BIT(KEY) | BIT(TILES) | BIT(PIXELS) | BIT(TIME) | IMAGE)
#define PIECE (BIT(COUNT) | BIT(BYTES) | BIT(CHECKSUM) | BIT(RECORD) | BIT(TIME))
#define SPLIT (BIT(SPLIT) | BIT(ENDS))

static zt_status read_hash(zt_hash *hash, zt_json *json) {
    char text[40];
    ZT_TRY(zt_json_text(json, text, sizeof text));
    if (zt_hash_read(hash, text)) return ZT_OK;
    return zt_json_refuse(json, "here must be 32 hexadecimal digits in quotes");
}

static zt_status read_precision(zt_manifest_line *l, zt_json *json) {
    char text[16];
    ZT_TRY(zt_json_text(json, text, sizeof text));
    for (int i = 0; i < 3; i++) {
        if (strcmp(text, precisions[i]) != 0) continue;
        l->precision = (zt_precision)i;
        return ZT_OK;
    }
    return zt_json_refuse(json, "\"precision\" must be \"auto\", \"single\" or \"double\"");
}

static zt_status read_size(zt_manifest_line *l, zt_json *json) {
    int64_t width, height;
    ZT_TRY(zt_json_mark(json, '['));
    ZT_TRY(zt_json_integer(json, &width, 1, ZT_IMAGE_SIDE_MAX));
    ZT_TRY(zt_json_mark(json, ','));
    ZT_TRY(zt_json_integer(json, &height, 1, ZT_IMAGE_SIDE_MAX));
    ZT_TRY(zt_json_mark(json, ']'));
    l->width = (int)width;
    l->height = (int)height;
    return ZT_OK;
}

static zt_status read_samples(int32_t *samples, zt_json *json) {
    int64_t number;
    ZT_TRY(zt_json_integer(json, &number, 1, SAMPLES_MAX));
    *samples = (int32_t)number;
    return ZT_OK;
}

static zt_status read_file(zt_output_record *r, zt_json *json, zt_arena *arena) {
    char text[FILE_NAME_MAX];
    ZT_TRY(zt_json_text(json, text, sizeof text));
    r->file = zt_arena_push_text(arena, text, strlen(text));
    return r->file ? ZT_OK : ZT_EMEMORY;
}

/* The ends rise. */
static zt_status read_ends(zt_manifest_split *s, zt_json *json, zt_arena *arena) {
    int64_t ends[SPLIT_MAX], least = 0;
    bool more = true;
    ZT_TRY(zt_json_mark(json, '['));
    for (s->count = 0; more; s->count++) {
        if (s->count == SPLIT_MAX) return zt_json_refuse(json, "these are too many parts");
        ZT_TRY(zt_json_integer(json, &ends[s->count], least, count_max));
        least = ends[s->count];
        ZT_TRY(zt_json_more(json, &more, ']'));
    }
    s->ends = ZT_PUSH(arena, int64_t, (size_t)s->count);
    if (!s->ends) return ZT_EMEMORY;
    memcpy(s->ends, ends, (size_t)s->count * sizeof *ends);
    return ZT_OK;
}

static zt_status read_of_frame(zt_manifest_frame *f, int key, zt_json *json) {
    switch (key) {
    case KEY_FRAME:
        return zt_json_integer(json, &f->frame, 0, frame_max);
    case KEY_SAMPLES:
        ZT_TRY(read_samples(&f->max, json));
        f->min = f->max;
        return ZT_OK;
    case KEY_MIN:
        return read_samples(&f->min, json);
    case KEY_MAX:
        return read_samples(&f->max, json);
    case KEY_ERROR:
        return zt_json_number(json, &f->error, 0, 1);
    case KEY_MEAN:
        return read_samples(&f->mean_max, json);
    case KEY_FILM_S:
        return zt_json_number(json, &f->budget.film_s, 0, seconds_max);
    case KEY_FRAME_S:
        return zt_json_number(json, &f->budget.frame_s, 0, seconds_max);
    case KEY_KEY:
        return read_hash(&f->key, json);
    case KEY_TILES:
        return read_hash(&f->pixels, json);
    case KEY_PIXELS:
        return read_hash(&(zt_hash){0}, json);
    default: /* KEY_TIME, of pieces, too */
        return zt_json_number(json, &f->render_s, 0, seconds_max);
    }
}

static zt_status read_of_record(zt_output_record *r, int key, zt_json *json, zt_arena *arena) {
    switch (key) {
    case KEY_FILE:
        return read_file(r, json, arena);
    case KEY_CHECKSUM:
        return read_hash(&r->checksum, json);
    case KEY_RECORD:
        return read_hash(&r->key, json);
    case KEY_COUNT:
        return zt_json_integer(json, &r->count, 1, count_max);
    case KEY_PIECE:
    case KEY_FILM:
        r->kind = key == KEY_PIECE ? ZT_RECORD_PIECE : ZT_RECORD_FILM;
        return zt_json_integer(json, &r->first, 0, frame_max);
    default: /* KEY_BYTES */
        return zt_json_integer(json, &r->bytes, 0, byte_max);
    }
}

static zt_status read_field(zt_manifest_line *l, int key, zt_json *json, zt_arena *arena) {
    int64_t version;
    switch (key) {
    case KEY_VERSION:
        return zt_json_integer(json, &version, VERSION, VERSION);
    case KEY_DESCRIPTION:
    case KEY_WRITTEN:
        return zt_json_text(json, NULL, 0);
    case KEY_SIZE:
        return read_size(l, json);
    case KEY_PRECISION:
        return read_precision(l, json);
    case KEY_SPLIT:
        return read_hash(&l->split.of, json);
    case KEY_ENDS:
        return read_ends(&l->split, json, arena);
    default:
        return key < KEY_FILE ? read_of_frame(&l->frame, key, json)
                              : read_of_record(&l->record, key, json, arena);
    }
}

static zt_status finish_frame(zt_manifest_line *l, unsigned has, zt_json *json) {
    unsigned samples = has & SAMPLES, adaptive = BIT(MIN) | BIT(MAX) | BIT(ERROR);
    if (samples && samples != BIT(SAMPLES) && (samples & ~BIT(MEAN)) != adaptive)
        return zt_json_refuse(json, "a frame has either \"samples\" or \"min\", \"max\" and "
                                    "\"error\"");
    if (l->frame.min > l->frame.max) return zt_json_refuse(json, "\"max\" is below \"min\"");
    if ((has & IMAGE) && (has & IMAGE) != IMAGE)
        return zt_json_refuse(json, "an image has \"file\", \"bytes\", \"checksum\" and "
                                    "\"record\"");
    l->kind = ZT_LINE_FRAME;
    l->record.kind = ZT_RECORD_IMAGE;
    l->record.first = l->frame.frame;
    l->record.count = has & IMAGE ? 1 : 0;
    return ZT_OK;
}

/* What a line is shows by which keys it has. */
static zt_status finish(zt_manifest_line *l, unsigned has, zt_json *json) {
    l->record.render_s = l->frame.render_s > 0 ? l->frame.render_s : 0;
    if ((has & BIT(FRAME)) && !(has & ~FRAME)) return finish_frame(l, has, json);
    if (has == HEADER)
        l->kind = ZT_LINE_HEADER;
    else if (has == (PIECE | BIT(PIECE)) || has == (PIECE | BIT(FILM)))
        l->kind = ZT_LINE_PIECE;
    else if (has == SPLIT)
        l->kind = ZT_LINE_SPLIT;
    else
        return zt_json_refuse(json, "these keys make no line of a manifest: some are missing, "
                                    "or too many");
    return ZT_OK;
}

zt_status zt_manifest_parse(zt_manifest_line *line, zt_json *json, zt_arena *arena) {
    unsigned has = 0;
    bool more = true;
    *line = (zt_manifest_line){.frame.render_s = -1};
    ZT_TRY(zt_json_mark(json, '{'));
    while (more) {
        int key;
        ZT_TRY(zt_json_key(json, &key, keys));
        if (has & 1u << key) return zt_json_refuse(json, "\"%s\" is there twice", keys[key]);
        has |= 1u << key;
        ZT_TRY(read_field(line, key, json, arena));
        ZT_TRY(zt_json_more(json, &more, '}'));
    }
    ZT_TRY(finish(line, has, json));
    return zt_json_end(json);
}
