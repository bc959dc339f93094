/* Numbered images, or a single one. With a plan, an image that is recorded and still there as
 * it was is not made again: what a record's key is made of is in key_of(). */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/diag.h"
#include "base/hash.h"
#include "base/text.h"
#include "encode/aside.h"
#include "encode/sink.h"
#include "image/file.h"

enum { DIGITS_MAX = 20 };

typedef struct stills {
    char *before,
        *after; /* the target around the place of the number; `after` NULL: no place */
    int digits; /* the least that are written */
    bool single_written;
    zt_view view;
    zt_image_wishes wishes;
    zt_color *color;                  /* of the wishes */
    const zt_output_plan *plan;       /* NULL: none */
    const zt_output_record **records; /* those of single images, by frame, later ones behind */
    int64_t record_count;
    char *manner; /* how images are written, for their keys */
    zt_listener listener;
} stills;

/* An image that is ready to be written. */
typedef struct still {
    zt_bytes bytes;
    zt_hash key;      /* of the record; zero: not known */
    zt_hash checksum; /* of the bytes, where there is a plan */
    double render_s;
} still;

static zt_status close_stills(void *state, bool keep) {
    (void)keep; /* each image was completed as it came */
    stills *images = state;
    free(images->before);
    free(images->after);
    free(images->records);
    free(images->manner);
    zt_color_close(&images->color);
    free(images);
    return ZT_OK;
}

static zt_status refuse(const stills *images, const char *target, const char *why) {
    zt_tell(images->listener, ZT_ERROR, "cannot use %s as a name for images: %s", target, why);
    return ZT_EARGUMENT;
}

/* The place of the frame number: a run of # or of @, or a %d, %04d. Returns its end and its
 * digits; NULL where `place` is something else. The text itself never goes to printf. */
static const char *read_place(const char *place, int *digits) {
    if (*place != '%') {
        size_t length = strspn(place, *place == '#' ? "#" : "@");
        *digits = length <= DIGITS_MAX ? (int)length : 0;
        return *digits ? place + length : NULL;
    }
    *digits = 1;
    place++;
    if (*place == '0') {
        char *end;
        long number = strspn(place, "0123456789") <= 3 ? strtol(place, &end, 10) : 0;
        if (number < 1 || number > DIGITS_MAX) return NULL;
        *digits = (int)number;
        place = end;
    }
    return *place == 'd' ? place + 1 : NULL;
}

/* Takes the target apart. Only the file's own name has a place: directories are as they are. */
static zt_status read_pattern(stills *images, const char *target) {
    const char *slash = strrchr(target, '/');
    const char *place = strpbrk(slash ? slash : target, "#@%");
    if (place) {
        const char *end = read_place(place, &images->digits);
        if (!end)
            return refuse(images, target,
                          "the frame number is written as #### or @@@@ (one for each digit) "
                          "or %04d (%d: as many as needed), with 1 to 20 digits");
        if (strpbrk(end, "#@%"))
            return refuse(images, target, "it has more than one place for the frame number");
        images->after = strdup(end);
        if (!images->after) return ZT_EMEMORY;
    }
    images->before = place ? strndup(target, (size_t)(place - target)) : strdup(target);
    return images->before ? ZT_OK : ZT_EMEMORY;
}

/* Shows that an image can be written, by making a file beside where they will be. */
static zt_status probe(const char *target, zt_listener listener) {
    zt_aside aside;
    ZT_TRY(zt_aside_open(&aside, target, listener));
    zt_aside_drop(&aside);
    return ZT_OK;
}

static zt_status refuse_several(const stills *images) {
    return refuse(images, images->before,
                  "there is more than one frame, and only one would be left; write #### where "
                  "the frame number goes");
}

/* The digits are counted without the sign. */
static char *path_of(const stills *images, int64_t frame) {
    if (!images->after) return strdup(images->before);
    return zt_text_print("%s%.*" PRId64 "%s", images->before, images->digits, frame,
                         images->after);
}

/* All that decides how the numbers of an image become the bytes of a file. */
static char *manner_of(const stills *images, const zt_output_format *format) {
    const zt_image_wishes *w = &images->wishes;
    const char *view = images->color ? images->color->manner : zt_view_name(format->view);
    return zt_text_print("%s depth %d compression %s:%d tile %d view %s rate %d/%d",
                         w->format->endings[0], (int)w->depth,
                         w->compression ? w->compression->name : "", w->level, w->tile, view,
                         format->rate.num, format->rate.den);
}

static bool is_known(zt_hash hash) { return hash.high || hash.low; }

static bool same(zt_hash a, zt_hash b) { return a.high == b.high && a.low == b.low; }

/* The key of a record: of what an image shows and how it is written. Zero where the first is
 * not known. */
static zt_status key_of(zt_hash *key, const stills *images, zt_hash shown) {
    *key = (zt_hash){0};
    if (!is_known(shown)) return ZT_OK;
    char *text =
        zt_text_print("%016" PRIx64 "%016" PRIx64 " %s", shown.high, shown.low, images->manner);
    if (!text) return ZT_EMEMORY;
    *key = zt_hash_bytes(text, strlen(text));
    free(text);
    return ZT_OK;
}

static int by_frame(const void *a, const void *b) {
    const zt_output_record *one = *(const zt_output_record *const *)a,
                           *other = *(const zt_output_record *const *)b;
    if (one->first != other->first) return one->first < other->first ? -1 : 1;
    return one < other ? -1 : one > other;
}

static zt_status sort_records(stills *images) {
    const zt_output_plan *plan = images->plan;
    if (plan->record_count < 1) return ZT_OK;
    images->records = calloc((size_t)plan->record_count, sizeof *images->records);
    if (!images->records) return ZT_EMEMORY;
    for (int64_t i = 0; i < plan->record_count; i++)
        if (plan->records[i].kind == ZT_RECORD_IMAGE)
            images->records[images->record_count++] = &plan->records[i];
    qsort(images->records, (size_t)images->record_count, sizeof *images->records, by_frame);
    return ZT_OK;
}

/* The last record of a frame; NULL where there is none. */
static const zt_output_record *record_of(const stills *images, int64_t frame) {
    int64_t low = 0, high = images->record_count; /* where the first of later frames is */
    while (low < high) {
        int64_t middle = low + (high - low) / 2;
        if (images->records[middle]->first <= frame)
            low = middle + 1;
        else
            high = middle;
    }
    return low > 0 && images->records[low - 1]->first == frame ? images->records[low - 1]
                                                               : NULL;
}

/* Refuses a plan that would replace what is not known to be of an earlier run. */
static zt_status check_strangers(const stills *images) {
    const zt_output_plan *plan = images->plan;
    for (int64_t i = 0; i < plan->count && !plan->overwrites; i++) {
        if (record_of(images, plan->frames[i])) continue;
        char *path = path_of(images, plan->frames[i]);
        if (!path) return ZT_EMEMORY;
        struct stat there;
        bool taken = lstat(path, &there) == 0;
        if (taken)
            zt_tell(images->listener, ZT_ERROR,
                    "%s exists, and is not known to be of an earlier run; with --overwrite it "
                    "is replaced",
                    path);
        free(path);
        if (taken) return ZT_EFILE;
    }
    return ZT_OK;
}

static zt_status follow_plan(stills *images, const zt_output_format *format) {
    images->plan = format->plan;
    if (!images->plan) return ZT_OK;
    images->manner = manner_of(images, format);
    if (!images->manner) return ZT_EMEMORY;
    ZT_TRY(sort_records(images));
    return check_strangers(images);
}

/* Whether a file is there with just these contents. One that cannot be read is not. */
static bool holds(const char *path, int64_t size, zt_hash checksum) {
    struct stat there;
    FILE *file = fopen(path, "rb");
    if (!file) return false;
    bool good = fstat(fileno(file), &there) == 0 && S_ISREG(there.st_mode) &&
                there.st_size == size && size > 0;
    unsigned char *bytes = good ? malloc((size_t)size) : NULL;
    good = bytes && fread(bytes, 1, (size_t)size, file) == (size_t)size &&
           same(zt_hash_bytes(bytes, (size_t)size), checksum);
    free(bytes);
    fclose(file);
    return good;
}

/* In doubt, an image is wanted: making it again is never wrong. */
static bool wants_still(void *state, int64_t position) {
    const stills *images = state;
    const zt_output_plan *plan = images->plan;
    zt_hash key;
    const zt_output_record *record = record_of(images, plan->frames[position]);
    if (plan->overwrites || !record || key_of(&key, images, plan->keys[position]) != ZT_OK ||
        !is_known(key) || !same(key, record->key))
        return true;
    char *path = path_of(images, plan->frames[position]);
    bool there = path && holds(path, record->bytes, record->checksum);
    free(path);
    return !there;
}

static zt_status open_stills(void **state, const char *target, const zt_output_format *format,
                             const zt_output_option *options, zt_listener listener) {
    stills *images = calloc(1, sizeof *images);
    if (!images) return ZT_EMEMORY;
    images->view = format->view;
    images->listener = listener;
    zt_status status = zt_image_wish(&images->wishes, target, options, listener);
    if (status == ZT_OK) status = read_pattern(images, target);
    if (status == ZT_OK && images->wishes.depth < ZT_DEPTH_HALF)
        status = zt_color_open(&images->color, &format->color, listener);
    images->wishes.color = images->color;
    if (status == ZT_OK && !images->after && format->frame_count > 1)
        status = refuse_several(images);
    if (status == ZT_OK) status = follow_plan(images, format);
    if (status == ZT_OK) status = zt_image_file_ready(listener);
    if (status == ZT_OK) status = probe(target, listener);
    if (status == ZT_OK)
        *state = images;
    else
        close_stills(images, false);
    return status;
}

static void drop_still(void *state, void *made) {
    (void)state;
    still *ready = made;
    free(ready->bytes.data);
    free(ready);
}

static zt_status encode_still(still *ready, const stills *images, const zt_image *image,
                              int64_t frame) {
    char *path = path_of(images, frame);
    if (!path) return ZT_EMEMORY;
    zt_status status = zt_image_file_encode(&ready->bytes, image, images->view, &images->wishes,
                                            path, images->listener);
    free(path);
    if (status != ZT_OK || !images->plan) return status;
    ready->checksum = zt_hash_bytes(ready->bytes.data, ready->bytes.size);
    ready->render_s = image->info.render_s;
    return key_of(&ready->key, images, image->info.known ? image->info.key : (zt_hash){0});
}

static zt_status make_still(void **made, void *state, const zt_image *image, int64_t frame) {
    still *ready = calloc(1, sizeof *ready);
    if (!ready) return ZT_EMEMORY;
    zt_status status = encode_still(ready, state, image, frame);
    if (status == ZT_OK)
        *made = ready;
    else
        drop_still(state, ready);
    return status;
}

static zt_status write_file(const stills *images, const zt_bytes *bytes, const char *path) {
    zt_aside aside;
    ZT_TRY(zt_aside_open(&aside, path, images->listener));
    zt_status status = zt_image_file_put(bytes, aside.path, images->listener);
    if (status == ZT_OK) return zt_aside_keep(&aside, images->listener);
    zt_aside_drop(&aside);
    return status;
}

/* Tells that an image was completed. */
static zt_status record(const stills *images, const still *ready, int64_t frame,
                        const char *path) {
    const zt_output_plan *plan = images->plan;
    if (!plan || !plan->completed) return ZT_OK;
    const zt_output_record record = {.kind = ZT_RECORD_IMAGE,
                                     .first = frame,
                                     .count = 1,
                                     .key = ready->key,
                                     .bytes = (int64_t)ready->bytes.size,
                                     .checksum = ready->checksum,
                                     .render_s = ready->render_s,
                                     .file = path};
    return plan->completed(plan->user, &record);
}

static zt_status write_still(void *state, void *made, int64_t frame) {
    stills *images = state;
    const still *ready = made;
    char *path = path_of(images, frame);
    zt_status status = path ? ZT_OK : ZT_EMEMORY;
    if (status == ZT_OK && !images->after && images->single_written)
        status = refuse_several(images);
    if (status == ZT_OK) status = write_file(images, &ready->bytes, path);
    if (status == ZT_OK) status = record(images, ready, frame, path);
    images->single_written = true;
    free(path);
    drop_still(state, made);
    return status;
}

const zt_sink zt_sink_stills = {.what = "images",
                                .endings = zt_image_file_endings,
                                .options = zt_image_file_options,
                                .open = open_stills,
                                .wants = wants_still,
                                .make = make_still,
                                .write = write_still,
                                .drop = drop_still,
                                .close = close_stills};
