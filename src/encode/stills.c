/* Numbered images, or a single one. */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/diag.h"
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
    zt_listener listener;
} stills;

static zt_status close_stills(void *state, bool keep) {
    (void)keep; /* each image was completed as it came */
    stills *images = state;
    free(images->before);
    free(images->after);
    free(images);
    return ZT_OK;
}

static zt_status refuse(const stills *images, const char *target, const char *why) {
    zt_tell(images->listener, ZT_ERROR, "cannot use %s as a name for images: %s", target, why);
    return ZT_EARGUMENT;
}

/* The place of the frame number: a run of # or a %d, %04d. Returns its end and its digits; NULL
 * where `place` is something else. The text itself never goes to printf. */
static const char *read_place(const char *place, int *digits) {
    if (*place == '#') {
        size_t length = strspn(place, "#");
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
    const char *place = strpbrk(slash ? slash : target, "#%");
    if (place) {
        const char *end = read_place(place, &images->digits);
        if (!end)
            return refuse(images, target,
                          "the frame number is written as #### (a # for each digit) or %04d "
                          "(%d: as many as needed), with 1 to 20 digits");
        if (strpbrk(end, "#%"))
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

static zt_status open_stills(void **state, const char *target, const zt_output_format *format,
                             const zt_output_option *options, zt_listener listener) {
    stills *images = calloc(1, sizeof *images);
    if (!images) return ZT_EMEMORY;
    images->view = format->view;
    images->listener = listener;
    zt_status status = zt_image_wish(&images->wishes, target, options, listener);
    if (status == ZT_OK) status = read_pattern(images, target);
    if (status == ZT_OK && !images->after && format->frame_count > 1)
        status = refuse_several(images);
    if (status == ZT_OK) status = zt_image_file_ready(listener);
    if (status == ZT_OK) status = probe(target, listener);
    if (status == ZT_OK)
        *state = images;
    else
        close_stills(images, false);
    return status;
}

static char *path_of(const stills *images, int64_t frame) {
    if (!images->after) return strdup(images->before);
    return zt_text_print("%s%0*" PRId64 "%s", images->before, images->digits, frame,
                         images->after);
}

static zt_status make_still(void **made, void *state, const zt_image *image, int64_t frame) {
    const stills *images = state;
    zt_bytes *bytes = calloc(1, sizeof *bytes);
    char *path = path_of(images, frame);
    zt_status status = ZT_EMEMORY;
    if (bytes && path)
        status = zt_image_file_encode(bytes, image, images->view, &images->wishes, path,
                                      images->listener);
    free(path);
    if (status == ZT_OK)
        *made = bytes;
    else
        free(bytes);
    return status;
}

static void drop_still(void *state, void *made) {
    (void)state;
    zt_bytes *bytes = made;
    free(bytes->data);
    free(bytes);
}

static zt_status write_file(const stills *images, const zt_bytes *bytes, const char *path) {
    zt_aside aside;
    ZT_TRY(zt_aside_open(&aside, path, images->listener));
    zt_status status = zt_image_file_put(bytes, aside.path, images->listener);
    if (status == ZT_OK) return zt_aside_keep(&aside, images->listener);
    zt_aside_drop(&aside);
    return status;
}

static zt_status write_still(void *state, void *made, int64_t frame) {
    stills *images = state;
    char *path = path_of(images, frame);
    zt_status status = path ? ZT_OK : ZT_EMEMORY;
    if (status == ZT_OK && !images->after && images->single_written)
        status = refuse_several(images);
    if (status == ZT_OK) status = write_file(images, made, path);
    images->single_written = true;
    free(path);
    drop_still(state, made);
    return status;
}

const zt_sink zt_sink_stills = {.what = "images",
                                .endings = zt_image_file_endings,
                                .options = zt_image_file_options,
                                .open = open_stills,
                                .make = make_still,
                                .write = write_still,
                                .drop = drop_still,
                                .close = close_stills};
