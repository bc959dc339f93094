#include "sequence/sums.h"

#include <stdlib.h>
#include <string.h>
#include <threads.h>

#include "base/hash.h"
#include "image/stamps.h"

/* The tiles of the image that was added up last with it. */
typedef struct tally {
    struct tally *next;
    int count, spared; /* tiles; of the last image, those that were known */
    uint64_t *stamps;
    zt_hash *tiles;
} tally;

struct zt_sums {
    mtx_t mutex;
    tally *idle; /* those that no thread has; the last one first */
    int64_t spared;
};

zt_status zt_sums_open(zt_sums **out) {
    zt_sums *s = *out = calloc(1, sizeof *s);
    if (!s) return ZT_EMEMORY;
    if (mtx_init(&s->mutex, mtx_plain) == thrd_success) return ZT_OK;
    free(s);
    *out = NULL;
    return ZT_EMEMORY;
}

static void free_tally(tally *t) {
    free(t->stamps);
    free(t->tiles);
    free(t);
}

void zt_sums_close(zt_sums **slot) {
    zt_sums *s = *slot;
    if (!s) return;
    for (tally *next; s->idle; s->idle = next) {
        next = s->idle->next;
        free_tally(s->idle);
    }
    mtx_destroy(&s->mutex);
    free(s);
    *slot = NULL;
}

static tally *create_tally(int count) {
    tally *t = calloc(1, sizeof *t);
    if (!t) return NULL;
    t->count = count;
    t->stamps = calloc((size_t)count, sizeof *t->stamps);
    t->tiles = calloc((size_t)count, sizeof *t->tiles);
    if (t->stamps && t->tiles) return t;
    free_tally(t);
    return NULL;
}

/* NULL when out of memory. */
static tally *take_tally(zt_sums *s, int count) {
    tally *t = NULL;
    if (s) {
        mtx_lock(&s->mutex);
        t = s->idle;
        if (t) s->idle = t->next;
        mtx_unlock(&s->mutex);
    }
    if (t && t->count == count) return t;
    if (t) free_tally(t);
    return create_tally(count);
}

static void give_tally(zt_sums *s, tally *t) {
    if (!s) {
        free_tally(t);
        return;
    }
    mtx_lock(&s->mutex);
    t->next = s->idle;
    s->idle = t;
    s->spared += t->spared;
    mtx_unlock(&s->mutex);
}

static zt_hash sum_tile(const zt_image *image, int left, int top) {
    float numbers[4 * ZT_STAMP_SIDE * ZT_STAMP_SIDE];
    size_t width = (size_t)(image->width - left), filled = 0;
    if (width > ZT_STAMP_SIDE) width = ZT_STAMP_SIDE;
    for (int y = top; y < top + ZT_STAMP_SIDE && y < image->height; y++) {
        size_t at = (size_t)y * (size_t)image->width + (size_t)left;
        memcpy(numbers + filled, image->pixels + 4 * at, 4 * width * sizeof *numbers);
        filled += 4 * width;
    }
    return zt_hash_bytes(numbers, filled * sizeof *numbers);
}

static zt_hash sum_tiles(tally *t, const zt_image *image) {
    int columns = zt_stamp_tiles(image->width);
    t->spared = t->count;
    for (int i = 0; i < t->count; i++) {
        uint64_t stamp = image->stamps ? image->stamps[i] : 0;
        if (stamp && stamp == t->stamps[i]) continue;
        t->tiles[i] = sum_tile(image, i % columns * ZT_STAMP_SIDE, i / columns * ZT_STAMP_SIDE);
        t->stamps[i] = stamp;
        t->spared--;
    }
    return zt_hash_bytes(t->tiles, (size_t)t->count * sizeof *t->tiles);
}

int64_t zt_sums_spared(const zt_sums *s) { return s->spared; }

zt_status zt_sums_of(zt_hash *checksum, zt_sums *sums, const zt_image *image) {
    zt_hash parts[1 + ZT_IMAGE_CHANNELS_MAX];
    size_t size = (size_t)image->width * (size_t)image->height * sizeof(float);
    tally *t = take_tally(sums, zt_stamp_tiles(image->width) * zt_stamp_tiles(image->height));
    if (!t) return ZT_EMEMORY;
    parts[0] = sum_tiles(t, image);
    give_tally(sums, t);
    for (int i = 0; i < image->channel_count; i++)
        parts[i + 1] = zt_hash_bytes(image->channels[i].values, size);
    *checksum = zt_hash_bytes(parts, (size_t)(1 + image->channel_count) * sizeof *parts);
    return ZT_OK;
}
