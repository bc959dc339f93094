#include "sequence/again.h"

#include <stdlib.h>
#include <string.h>

#include "base/diag.h"
#include "image/stamps.h"

enum { IMAGES_MAX = 64 };
static const size_t bytes_max = (size_t)1 << 30;

/* ---- positions by their keys ----------------------------------------------------------------
 */

typedef struct place {
    zt_hash key;
    int64_t position, first; /* the first position with this key */
} place;

static int by_key(const void *pa, const void *pb) {
    const place *a = pa, *b = pb;
    if (a->key.high != b->key.high) return a->key.high < b->key.high ? -1 : 1;
    if (a->key.low != b->key.low) return a->key.low < b->key.low ? -1 : 1;
    return (a->position > b->position) - (a->position < b->position);
}

static int by_first(const void *pa, const void *pb) {
    const place *a = pa, *b = pb;
    if (a->first != b->first) return a->first < b->first ? -1 : 1;
    return (a->position > b->position) - (a->position < b->position);
}

/* Of the caller to free; NULL when out of memory. */
static place *sort_places(const zt_hash *keys, int64_t count) {
    place *places = malloc((size_t)count * sizeof *places);
    if (!places) return NULL;
    for (int64_t i = 0; i < count; i++) places[i] = (place){keys[i], i, i};
    qsort(places, (size_t)count, sizeof *places, by_key);
    for (int64_t i = 1; i < count; i++)
        if (zt_hash_equal(places[i].key, places[i - 1].key))
            places[i].first = places[i - 1].first;
    return places;
}

zt_status zt_again_group(int64_t *frames, zt_hash *keys, int64_t count) {
    place *places = sort_places(keys, count);
    int64_t *numbers = malloc((size_t)count * sizeof *numbers);
    if (places && numbers) {
        qsort(places, (size_t)count, sizeof *places, by_first);
        for (int64_t i = 0; i < count; i++) numbers[i] = frames[places[i].position];
        for (int64_t i = 0; i < count; i++) {
            frames[i] = numbers[i];
            keys[i] = places[i].key;
        }
    }
    zt_status status = places && numbers ? ZT_OK : ZT_EMEMORY;
    free(places);
    free(numbers);
    return status;
}

/* ---- images that are kept -------------------------------------------------------------------
 */

typedef struct kept {
    zt_image *image; /* NULL: none */
    zt_hash key;
    int64_t next; /* where it comes again */
} kept;

struct zt_again {
    const zt_hash *keys;
    const bool *wanted;
    int64_t count;
    int64_t *next; /* of each position, the next one that wants the same; -1: none */
    kept kept[IMAGES_MAX];
};

static zt_status find_next(zt_again *a) {
    place *places = sort_places(a->keys, a->count);
    a->next = malloc((size_t)a->count * sizeof *a->next);
    if (places && a->next) {
        int64_t later = -1; /* the last wanted one that was seen */
        for (int64_t i = a->count - 1; i >= 0; i--) {
            const place *p = &places[i];
            bool ends = i + 1 == a->count || !zt_hash_equal(p->key, p[1].key) ||
                        !zt_hash_is_known(p->key);
            if (ends) later = -1;
            a->next[p->position] = later;
            if (a->wanted[p->position]) later = p->position;
        }
    }
    zt_status status = places && a->next ? ZT_OK : ZT_EMEMORY;
    free(places);
    return status;
}

zt_status zt_again_open(zt_again **out, const zt_hash *keys, const bool *wanted,
                        int64_t count) {
    zt_again *a = calloc(1, sizeof *a);
    if (!a) return ZT_EMEMORY;
    *a = (zt_again){.keys = keys, .wanted = wanted, .count = count};
    zt_status status = find_next(a);
    if (status != ZT_OK) zt_again_close(&a);
    *out = a;
    return status;
}

static kept *kept_of(const zt_again *a, int64_t position) {
    for (int i = 0; i < IMAGES_MAX; i++) {
        const kept *k = &a->kept[i];
        if (k->image && zt_hash_equal(k->key, a->keys[position])) return (kept *)k;
    }
    return NULL;
}

const zt_image *zt_again_find(const zt_again *a, int64_t position) {
    const kept *k = kept_of(a, position);
    return k ? k->image : NULL;
}

static size_t plane_size(const zt_image *image) {
    return (size_t)image->width * (size_t)image->height * sizeof(float);
}

void zt_again_copy(zt_image *to, const zt_image *from) {
    size_t size = plane_size(from);
    memcpy(to->pixels, from->pixels, 4 * size);
    for (int i = 0; i < from->channel_count; i++)
        memcpy(to->channels[i].values, from->channels[i].values, size);
    zt_image_forget_stamps(to);
    to->transparent = from->transparent;
    to->info = from->info;
}

/* A place for an image: an empty one, or that of the image which comes last of all, if it comes
 * later than `next`. NULL where there is none. */
static kept *place_for(zt_again *a, const zt_image *image, int64_t next) {
    size_t room = bytes_max / (plane_size(image) * (size_t)(4 + image->channel_count));
    int count = room < IMAGES_MAX ? (int)room : IMAGES_MAX;
    kept *last = NULL;
    for (kept *k = a->kept; k < a->kept + count; k++) {
        if (!k->image) return k;
        if (k->next > next && (!last || k->next > last->next)) last = k;
    }
    return last;
}

static zt_status create_like(zt_image **out, const zt_image *image) {
    zt_status status = zt_image_create(out, image->width, image->height);
    for (int i = 0; i < image->channel_count && status == ZT_OK; i++)
        status = zt_image_add_channel(*out, image->channels[i].name);
    if (status != ZT_OK) zt_image_free(out);
    return status;
}

/* The image of the position before the next one that is wanted is there anyway. */
static bool is_next(const zt_again *a, int64_t position, int64_t next) {
    while (++position < next)
        if (a->wanted[position]) return false;
    return true;
}

zt_status zt_again_keep(zt_again *a, int64_t position, const zt_image *image) {
    int64_t next = a->next[position];
    kept *k = kept_of(a, position);
    if (next < 0) {
        if (k) zt_image_free(&k->image);
        if (k) *k = (kept){0};
        return ZT_OK;
    }
    if (!k && is_next(a, position, next)) return ZT_OK;
    if (!k) k = place_for(a, image, next);
    if (!k) return ZT_OK;
    if (!k->image) ZT_TRY(create_like(&k->image, image));
    if (!zt_hash_equal(k->key, a->keys[position])) zt_again_copy(k->image, image);
    k->key = a->keys[position];
    k->next = next;
    return ZT_OK;
}

void zt_again_close(zt_again **slot) {
    zt_again *a = *slot;
    if (!a) return;
    for (int i = 0; i < IMAGES_MAX; i++) zt_image_free(&a->kept[i].image);
    free(a->next);
    free(a);
    *slot = NULL;
}
