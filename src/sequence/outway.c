/* The way out: a ring of what was sent, which workers go through twice. Any of them makes an
 * image ready; one at a time writes the oldest that is. A worker that has done a piece of work
 * looks for the next by itself, so it is only woken for what is new.
 *
 * Images are made in the order in which they are sent, so that all before one that failed are
 * made or being made already: they are still written, and the files are those that writing one
 * after the other would have left. */
#include "sequence/outway.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <threads.h>

#include <zoetrope/aov.h>

#include "base/clock.h"
#include "base/diag.h"
#include "base/pool.h"
#include "encode/output.h"
#include "image/stamps.h"

/* An image to lend; it is free where nobody holds it. */
typedef struct slot {
    zt_image *image;
    int holder_count; /* the borrower, and each parcel that is not made yet */
} slot;

/* Something sent. */
typedef struct parcel {
    slot *slot;
    zt_image_info info;
    void *made; /* what will be written; NULL where there is nothing */
    bool ready; /* its turn to be written may come */
} parcel;

struct zt_outway {
    mtx_t mutex;
    cnd_t came; /* for workers: a parcel, or the end */
    cnd_t went; /* for those who lend and send */
    zt_output *output;
    zt_status (*look)(void *user, const zt_image *image); /* NULL: nobody does */
    void *user;
    int width, height;
    unsigned aovs;
    int capacity; /* of the ring, and of images */
    slot *slots;
    parcel *ring;                 /* parcel i is at i % capacity */
    int64_t sent, taken, written; /* how many parcels; written <= taken <= sent */
    int64_t end;                  /* the first that failed: from here on nothing is done */
    zt_status failure;            /* of that one */
    bool writing, closing;        /* a worker is; no more will be sent */
    double waited_s;
    zt_errand **workers;
    int worker_count;
};

static parcel *parcel_of(const zt_outway *way, int64_t index) {
    return &way->ring[index % way->capacity];
}

static void let_go(zt_outway *way, slot *slot) {
    if (--slot->holder_count == 0) cnd_broadcast(&way->went);
}

static void fail_at(zt_outway *way, int64_t index, zt_status status) {
    if (index >= way->end) return;
    way->end = index;
    way->failure = status;
    cnd_broadcast(&way->went);
}

/* Makes the next parcel ready, outside the lock. */
static void make_next(zt_outway *way) {
    int64_t index = way->taken++;
    parcel *next = parcel_of(way, index);
    next->made = NULL;
    if (index < way->end) {
        mtx_unlock(&way->mutex);
        zt_image image = *next->slot->image;
        image.info = next->info;
        void *made = NULL;
        zt_status status = way->look ? way->look(way->user, &image) : ZT_OK;
        if (status == ZT_OK)
            status = zt_output_make(&made, way->output, &image, image.info.frame);
        mtx_lock(&way->mutex);
        if (status == ZT_OK)
            next->made = made;
        else
            fail_at(way, index, status);
    }
    let_go(way, next->slot);
    next->ready = true;
}

/* Writes the oldest parcel, outside the lock, or drops it after a failure. */
static void write_oldest(zt_outway *way) {
    int64_t index = way->written;
    parcel *oldest = parcel_of(way, index);
    void *made = oldest->made;
    int64_t frame = oldest->info.frame;
    bool wanted = index < way->end;
    way->writing = true;
    mtx_unlock(&way->mutex);
    zt_status status = ZT_OK;
    if (wanted)
        status = zt_output_put(way->output, made, frame);
    else if (made)
        zt_output_drop(way->output, made);
    mtx_lock(&way->mutex);
    if (status != ZT_OK) fail_at(way, index, status);
    oldest->ready = false;
    way->writing = false;
    way->written++;
    cnd_broadcast(&way->went);
}

static bool may_write(const zt_outway *way) {
    return !way->writing && way->written < way->taken && parcel_of(way, way->written)->ready;
}

/* What is left when a worker goes is the work of one that will look again. */
static void work(void *user) {
    zt_outway *way = user;
    mtx_lock(&way->mutex);
    for (;;) {
        while (!may_write(way) && way->taken >= way->sent && !way->closing)
            cnd_wait(&way->came, &way->mutex);
        if (may_write(way))
            write_oldest(way);
        else if (way->taken < way->sent)
            make_next(way);
        else
            break;
    }
    mtx_unlock(&way->mutex);
}

static zt_status start(zt_outway *way, int thread_count) {
    way->slots = calloc((size_t)way->capacity, sizeof *way->slots);
    way->ring = calloc((size_t)way->capacity, sizeof *way->ring);
    way->workers = calloc((size_t)thread_count, sizeof(zt_errand *));
    if (!way->slots || !way->ring || !way->workers) return ZT_EMEMORY;
    for (; way->worker_count < thread_count; way->worker_count++) {
        zt_errand **worker = &way->workers[way->worker_count];
        ZT_TRY(zt_errand_open(worker, work, way));
        zt_errand_send(*worker);
    }
    return ZT_OK;
}

/* Makes the locks: all or none. */
static bool has_locks(zt_outway *way) {
    if (mtx_init(&way->mutex, mtx_plain) != thrd_success) return false;
    if (cnd_init(&way->came) == thrd_success) {
        if (cnd_init(&way->went) == thrd_success) return true;
        cnd_destroy(&way->came);
    }
    mtx_destroy(&way->mutex);
    return false;
}

zt_status zt_outway_open(zt_outway **out, int width, int height, unsigned aovs,
                         int thread_count) {
    *out = NULL;
    if (thread_count < 1) return ZT_EARGUMENT;
    zt_outway *way = calloc(1, sizeof *way);
    if (!way) return ZT_EMEMORY;
    *way = (zt_outway){.width = width,
                       .height = height,
                       .aovs = aovs,
                       .capacity = thread_count + 2,
                       .end = INT64_MAX};
    if (!has_locks(way)) {
        free(way);
        return ZT_EMEMORY;
    }
    zt_status status = start(way, thread_count);
    if (status == ZT_OK)
        *out = way;
    else
        zt_outway_close(&way);
    return status;
}

void zt_outway_lead(zt_outway *way, zt_output *output) { way->output = output; }

void zt_outway_show(zt_outway *way, zt_status (*look)(void *user, const zt_image *image),
                    void *user) {
    way->look = look;
    way->user = user;
}

/* A slot nobody holds, with or without an image, those with one first; or NULL. */
static slot *free_slot(zt_outway *way) {
    slot *empty = NULL;
    for (slot *s = way->slots; s < way->slots + way->capacity; s++) {
        if (s->holder_count == 0 && s->image) return s;
        if (!s->image && !empty) empty = s;
    }
    return empty;
}

static zt_status create_image(zt_image **out, const zt_outway *way) {
    zt_image *image;
    ZT_TRY(zt_image_create(&image, way->width, way->height));
    zt_status status = zt_image_add_aovs(image, way->aovs);
    if (status == ZT_OK) status = zt_image_add_stamps(image);
    if (status == ZT_OK)
        *out = image;
    else
        zt_image_free(&image);
    return status;
}

static void wait_for_room(zt_outway *way) {
    double since_s = zt_clock_s();
    cnd_wait(&way->went, &way->mutex);
    way->waited_s += zt_clock_s() - since_s;
}

zt_status zt_outway_lend(zt_image **image, zt_outway *way) {
    *image = NULL;
    slot *slot = NULL;
    mtx_lock(&way->mutex);
    while (way->failure == ZT_OK && !(slot = free_slot(way))) wait_for_room(way);
    zt_status status = way->failure;
    if (status == ZT_OK && !slot->image) status = create_image(&slot->image, way);
    if (status == ZT_OK) {
        slot->holder_count = 1;
        *image = slot->image;
    }
    mtx_unlock(&way->mutex);
    return status;
}

static slot *slot_of(const zt_outway *way, const zt_image *image) {
    slot *s = way->slots;
    while (s->image != image) s++;
    return s;
}

void zt_outway_release(zt_outway *way, zt_image *image) {
    mtx_lock(&way->mutex);
    let_go(way, slot_of(way, image));
    mtx_unlock(&way->mutex);
}

zt_status zt_outway_send(zt_outway *way, zt_image *image, const zt_image_info *info) {
    mtx_lock(&way->mutex);
    while (way->failure == ZT_OK && way->sent - way->written == way->capacity)
        wait_for_room(way);
    zt_status status = way->failure;
    if (status == ZT_OK) {
        slot *slot = slot_of(way, image);
        slot->holder_count++;
        *parcel_of(way, way->sent++) = (parcel){.slot = slot, .info = *info};
        cnd_signal(&way->came);
    }
    mtx_unlock(&way->mutex);
    return status;
}

double zt_outway_waited_s(const zt_outway *way) { return way->waited_s; }

zt_status zt_outway_close(zt_outway **out) {
    zt_outway *way = *out;
    if (!way) return ZT_OK;
    mtx_lock(&way->mutex);
    way->closing = true;
    cnd_broadcast(&way->came);
    mtx_unlock(&way->mutex);
    for (int i = 0; i < way->worker_count; i++) zt_errand_close(&way->workers[i]);
    for (int i = 0; way->slots && i < way->capacity; i++) zt_image_free(&way->slots[i].image);
    cnd_destroy(&way->went);
    cnd_destroy(&way->came);
    mtx_destroy(&way->mutex);
    free(way->workers);
    free(way->ring);
    free(way->slots);
    zt_status failure = way->failure;
    free(way);
    *out = NULL;
    return failure;
}
