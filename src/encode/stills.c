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
#include "encode/names.h"
#include "encode/sink.h"
#include "image/file.h"

typedef struct stills {
    char *target;
    zt_names names;
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
    zt_hash key;      /* of the record; zero: not known */
    zt_hash checksum; /* of the files, where there is a plan */
    double render_s;
    int64_t size; /* of all files together */
    zt_bytes files[];
} still;

static zt_status close_stills(void *state, bool keep) {
    (void)keep; /* each image was completed as it came */
    stills *images = state;
    zt_names_free(&images->names);
    free(images->target);
    free(images->records);
    free(images->manner);
    zt_color_close(&images->color);
    free(images);
    return ZT_OK;
}

static zt_status refuse(const stills *images, const char *why) {
    zt_tell(images->listener, ZT_ERROR, "cannot use %s as a name for images: %s",
            images->target, why);
    return ZT_EARGUMENT;
}

/* Shows that images can be written, by making files beside where they will be. */
static zt_status probe(const stills *images) {
    for (int i = 0; i < images->names.count; i++) {
        zt_aside aside;
        char *path = zt_names_path(&images->names, 0, i);
        zt_status status = path ? zt_aside_open(&aside, path, images->listener) : ZT_EMEMORY;
        free(path);
        ZT_TRY(status);
        zt_aside_drop(&aside);
    }
    return ZT_OK;
}

static zt_status refuse_several(const stills *images) {
    return refuse(images,
                  "there is more than one frame, and only one would be left; write #### where "
                  "the frame number goes");
}

/* All that decides how the numbers of an image become the bytes of a file. */
static char *manner_of(const stills *images, const zt_output_format *format) {
    const char *view = images->color ? images->color->manner : zt_view_name(format->view);
    char *wishes = zt_image_wishes_text(&images->wishes);
    char *manner =
        wishes ? zt_text_print("%s %s view %s rate %d/%d", images->wishes.format->endings[0],
                               wishes, view, format->rate.num, format->rate.den)
               : NULL;
    free(wishes);
    return manner;
}

/* The key of a record: of what an image shows and how it is written. Zero where the first is
 * not known. */
static zt_status key_of(zt_hash *key, const stills *images, zt_hash shown) {
    *key = (zt_hash){0};
    if (!zt_hash_is_known(shown)) return ZT_OK;
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

static zt_status check_stranger(const stills *images, int64_t frame, int file) {
    struct stat there;
    char *path = zt_names_path(&images->names, frame, file);
    if (!path) return ZT_EMEMORY;
    bool taken = lstat(path, &there) == 0;
    if (taken)
        zt_tell(images->listener, ZT_ERROR,
                "%s exists, and is not known to be of an earlier run; with --overwrite it is "
                "replaced",
                path);
    free(path);
    return taken ? ZT_EFILE : ZT_OK;
}

/* Refuses a plan that would replace what is not known to be of an earlier run. */
static zt_status check_strangers(const stills *images) {
    const zt_output_plan *plan = images->plan;
    for (int64_t i = 0; i < plan->count && !plan->overwrites; i++)
        for (int f = 0; f < images->names.count && !record_of(images, plan->frames[i]); f++)
            ZT_TRY(check_stranger(images, plan->frames[i], f));
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

/* Adds a file to the checksum of those before it. That of one file is its own. */
static zt_hash joined(zt_hash before, const void *bytes, size_t size, int file) {
    zt_hash own = zt_hash_bytes(bytes, size), both[2] = {before, own};
    return file == 0 ? own : zt_hash_bytes(both, sizeof both);
}

/* Adds a file that is there to a size and a checksum. One that cannot be read is not there. */
static bool add_file(int64_t *size, zt_hash *checksum, const char *path, int index) {
    struct stat there;
    FILE *file = path ? fopen(path, "rb") : NULL;
    if (!file) return false;
    bool good = fstat(fileno(file), &there) == 0 && S_ISREG(there.st_mode) && there.st_size > 0;
    size_t length = good ? (size_t)there.st_size : 0;
    unsigned char *bytes = good ? malloc(length) : NULL;
    good = bytes && fread(bytes, 1, length, file) == length;
    if (good) *checksum = joined(*checksum, bytes, length, index);
    *size += (int64_t)length;
    free(bytes);
    fclose(file);
    return good;
}

/* Whether the files of a frame are there with just what was recorded. */
static bool is_whole(const stills *images, const zt_output_record *record) {
    int64_t size = 0;
    zt_hash checksum = {0};
    bool good = true;
    for (int i = 0; i < images->names.count && good && size < record->bytes; i++) {
        char *path = zt_names_path(&images->names, record->first, i);
        good = add_file(&size, &checksum, path, i);
        free(path);
    }
    return good && size == record->bytes && zt_hash_equal(checksum, record->checksum);
}

/* In doubt, an image is wanted: making it again is never wrong. */
static bool wants_still(void *state, int64_t position) {
    const stills *images = state;
    const zt_output_plan *plan = images->plan;
    zt_hash key;
    const zt_output_record *record = record_of(images, plan->frames[position]);
    if (plan->overwrites || !record || key_of(&key, images, plan->keys[position]) != ZT_OK ||
        !zt_hash_is_known(key) || !zt_hash_equal(key, record->key))
        return true;
    return !is_whole(images, record);
}

/* Only files that have places for all layers can be of some of them. */
static zt_status check_layers(const stills *images) {
    if (!images->names.layers || images->wishes.format->has_layers) return ZT_OK;
    return refuse(images, "only .exr files have the layers that {layer} stands for");
}

static zt_status open_stills(void **state, const char *target, const zt_output_format *format,
                             const zt_output_option *options, zt_listener listener) {
    stills *images = calloc(1, sizeof *images);
    if (!images) return ZT_EMEMORY;
    images->view = format->view;
    images->listener = listener;
    images->target = strdup(target);
    zt_status status = images->target ? ZT_OK : ZT_EMEMORY;
    if (status == ZT_OK) status = zt_image_wish(&images->wishes, target, options, listener);
    if (status == ZT_OK) status = zt_names_read(&images->names, target, format->aovs, listener);
    if (status == ZT_OK) status = check_layers(images);
    if (status == ZT_OK && images->wishes.depth < ZT_DEPTH_HALF)
        status = zt_color_open(&images->color, &format->color, listener);
    images->wishes.color = images->color;
    if (status == ZT_OK && !images->names.after && format->frame_count > 1)
        status = refuse_several(images);
    if (status == ZT_OK) status = follow_plan(images, format);
    if (status == ZT_OK) status = zt_image_file_ready(listener);
    if (status == ZT_OK) status = probe(images);
    if (status == ZT_OK)
        *state = images;
    else
        close_stills(images, false);
    return status;
}

static void drop_still(void *state, void *made) {
    const stills *images = state;
    still *ready = made;
    for (int i = 0; i < images->names.count; i++) free(ready->files[i].data);
    free(ready);
}

static zt_status encode_file(still *ready, const stills *images, const zt_image *image,
                             int64_t frame, int file) {
    zt_image_wishes wishes = images->wishes;
    zt_bytes *bytes = &ready->files[file];
    char *path = zt_names_path(&images->names, frame, file);
    if (!path) return ZT_EMEMORY;
    wishes.layer = zt_names_layer(&images->names, file);
    zt_status status =
        zt_image_file_encode(bytes, image, images->view, &wishes, path, images->listener);
    free(path);
    if (status != ZT_OK || !images->plan) return status;
    ready->checksum = joined(ready->checksum, bytes->data, bytes->size, file);
    ready->size += (int64_t)bytes->size;
    return ZT_OK;
}

static zt_status encode_still(still *ready, const stills *images, const zt_image *image,
                              int64_t frame) {
    for (int i = 0; i < images->names.count; i++)
        ZT_TRY(encode_file(ready, images, image, frame, i));
    if (!images->plan) return ZT_OK;
    ready->render_s = image->info.render_s;
    return key_of(&ready->key, images, image->info.known ? image->info.key : (zt_hash){0});
}

static zt_status make_still(void **made, void *state, const zt_image *image, int64_t frame) {
    const stills *images = state;
    still *ready =
        calloc(1, sizeof *ready + (size_t)images->names.count * sizeof *ready->files);
    if (!ready) return ZT_EMEMORY;
    zt_status status = encode_still(ready, images, image, frame);
    if (status == ZT_OK)
        *made = ready;
    else
        drop_still(state, ready);
    return status;
}

/* Tells that an image is complete. */
static zt_status record(const stills *images, const still *ready, int64_t frame,
                        const char *path) {
    const zt_output_plan *plan = images->plan;
    if (!plan || !plan->completed) return ZT_OK;
    const zt_output_record record = {.kind = ZT_RECORD_IMAGE,
                                     .first = frame,
                                     .count = 1,
                                     .key = ready->key,
                                     .bytes = ready->size,
                                     .checksum = ready->checksum,
                                     .render_s = ready->render_s,
                                     .file = path};
    return plan->completed(plan->user, &record);
}

/* It is told before the first file gets its name, or else one whose writer was killed just then
 * would be a stranger's. What is told of and is not there is only made again. */
static zt_status write_file(const stills *images, const still *ready, int64_t frame, int index,
                            const char *path) {
    zt_aside aside;
    ZT_TRY(zt_aside_open(&aside, path, images->listener));
    zt_status status = zt_image_file_put(&ready->files[index], aside.path, images->listener);
    if (status == ZT_OK && index == 0) status = record(images, ready, frame, path);
    if (status == ZT_OK) return zt_aside_keep(&aside, images->listener);
    zt_aside_drop(&aside);
    return status;
}

static zt_status write_files(stills *images, const still *ready, int64_t frame) {
    zt_status status = ZT_OK;
    for (int i = 0; i < images->names.count && status == ZT_OK; i++) {
        char *path = zt_names_path(&images->names, frame, i);
        status = path ? write_file(images, ready, frame, i, path) : ZT_EMEMORY;
        free(path);
    }
    return status;
}

static zt_status write_still(void *state, void *made, int64_t frame) {
    stills *images = state;
    zt_status status = ZT_OK;
    if (!images->names.after && images->single_written) status = refuse_several(images);
    if (status == ZT_OK) status = write_files(images, made, frame);
    images->single_written = true;
    drop_still(state, made);
    return status;
}

const zt_sink zt_sink_stills = {.what = "images",
                                .module = "image_file",
                                .endings = zt_image_file_endings,
                                .options = zt_image_file_options,
                                .open = open_stills,
                                .wants = wants_still,
                                .make = make_still,
                                .write = write_still,
                                .drop = drop_still,
                                .close = close_stills};
