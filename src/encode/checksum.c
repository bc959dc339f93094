/* Checksums instead of pictures: the basis of "still the same pictures".
 *
 * A line for each frame, all of one width:
 *
 *          42  1280x720   9f06b2a5a3e1c0d4c7b1f0e2d3a49586
 *
 * the frame's number in 12 places, its width (5, to the right) x its height (5, to the left),
 * and the XXH3 128-bit checksum, high half first, of its float pixels as they lie in memory. */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/diag.h"
#include "base/hash.h"
#include "base/text.h"
#include "encode/aside.h"
#include "encode/sink.h"

typedef struct checksum {
    FILE *file;
    zt_aside aside;
    zt_listener listener;
} checksum;

static zt_status refuse(checksum *sums) {
    zt_tell(sums->listener, ZT_ERROR, "cannot write %s: %s", sums->aside.target,
            strerror(errno));
    return ZT_EFILE;
}

static zt_status close_checksum(void *state, bool keep) {
    checksum *sums = state;
    zt_status status = ZT_OK;
    if (sums->file && fclose(sums->file) != 0 && keep) status = refuse(sums);
    if (keep && status == ZT_OK)
        status = zt_aside_keep(&sums->aside, sums->listener);
    else
        zt_aside_drop(&sums->aside);
    free(sums);
    return status;
}

static zt_status open_file(checksum *sums, const char *target) {
    ZT_TRY(zt_aside_open(&sums->aside, target, sums->listener));
    sums->file = fopen(sums->aside.path, "w");
    return sums->file ? ZT_OK : refuse(sums);
}

static zt_status open_checksum(void **state, const char *target, const zt_output_format *format,
                               const zt_output_option *options, zt_listener listener) {
    (void)format, (void)options;
    checksum *sums = calloc(1, sizeof *sums);
    if (!sums) return ZT_EMEMORY;
    sums->listener = listener;
    zt_status status = open_file(sums, target);
    if (status == ZT_OK)
        *state = sums;
    else
        close_checksum(sums, false);
    return status;
}

static zt_status make_line(void **made, void *state, const zt_image *image, int64_t frame) {
    (void)state;
    size_t pixel_count = (size_t)image->width * (size_t)image->height;
    zt_hash hash = zt_hash_bytes(image->pixels, pixel_count * 4 * sizeof *image->pixels);
    *made = zt_text_print("%12" PRId64 " %5dx%-5d %016" PRIx64 "%016" PRIx64 "\n", frame,
                          image->width, image->height, hash.high, hash.low);
    return *made ? ZT_OK : ZT_EMEMORY;
}

static void drop_line(void *state, void *made) {
    (void)state;
    free(made);
}

static zt_status write_line(void *state, void *made, int64_t frame) {
    (void)frame;
    checksum *sums = state;
    /* Flushed, so that a full disk is known now and not after hours of rendering. */
    bool good = fputs(made, sums->file) >= 0 && fflush(sums->file) == 0;
    free(made);
    return good ? ZT_OK : refuse(sums);
}

static const char *const endings[] = {".hash", NULL};
static const char *const no_options[] = {NULL};
const zt_sink zt_sink_checksum = {.what = "checksums",
                                  .endings = endings,
                                  .options = no_options,
                                  .open = open_checksum,
                                  .make = make_line,
                                  .write = write_line,
                                  .drop = drop_line,
                                  .close = close_checksum};
