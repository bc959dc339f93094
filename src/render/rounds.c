#include "render/rounds.h"

#include <stdlib.h>
#include <string.h>

/* Those of a larger picture than this allows are not all kept: bytes. */
static const size_t bytes_max = (size_t)1 << 29;

enum { ROOM_LEAST = 4096 };

void zt_rounds_close(zt_rounds *r) {
    free(r->rounds);
    free(r->negative);
    free(r->first);
    free(r->spare);
    memset(r, 0, sizeof *r);
}

static bool give_room(void **list, size_t count, size_t size) {
    void *more = realloc(*list, count * size);
    if (more) *list = more;
    return more;
}

static bool make_room(zt_rounds *r, uint32_t room, bool is_signed) {
    bool good = give_room((void **)&r->rounds, room, sizeof *r->rounds) &&
                give_room((void **)&r->spare, room, sizeof *r->spare) &&
                (!is_signed || give_room((void **)&r->negative, room, sizeof *r->negative));
    if (good) r->room = room;
    return good;
}

zt_status zt_rounds_open(zt_rounds *r, int width, int height, bool is_signed) {
    size_t pixels = (size_t)width * (size_t)height;
    if (r->width != width || r->height != height || is_signed != (r->negative != NULL)) {
        zt_rounds_close(r);
        r->first = calloc(pixels, sizeof *r->first);
        if (!r->first || !make_room(r, ROOM_LEAST, is_signed)) {
            zt_rounds_close(r);
            return ZT_EMEMORY;
        }
        r->width = width;
        r->height = height;
    } else {
        memset(r->first, 0, pixels * sizeof *r->first);
    }
    r->count = 1; /* 0 is none */
    r->spare_count = 0;
    atomic_store(&r->taken, 0);
    return ZT_OK;
}

void zt_rounds_forget(zt_rounds *r, int column, int row) {
    uint32_t *first = &r->first[(size_t)row * (size_t)r->width + (size_t)column];
    for (uint32_t i = *first; i; i = r->rounds[i].next) r->spare[r->spare_count++] = i;
    *first = 0;
}

static uint32_t least_of(uint32_t a, uint32_t b) { return a < b ? a : b; }

/* Numbers that were taken are no longer there to take: the spare ones first, from the end. */
static void settle(zt_rounds *r) {
    uint32_t taken = atomic_exchange(&r->taken, 0), spare = least_of(taken, r->spare_count);
    r->spare_count -= spare;
    r->count += least_of(taken - spare, r->room - r->count);
}

size_t zt_rounds_count(const zt_rounds *r) {
    size_t there = r->room - r->count + r->spare_count, taken = atomic_load(&r->taken);
    return r->count - 1 - r->spare_count + (taken < there ? taken : there);
}

void zt_rounds_reserve(zt_rounds *r, size_t count) {
    settle(r);
    size_t wanted = (size_t)r->count + count;
    size_t most = bytes_max / (sizeof *r->rounds + sizeof *r->spare +
                               (r->negative ? sizeof *r->negative : 0));
    if (wanted <= r->room + (size_t)r->spare_count || r->room >= most) return;
    size_t room = wanted + wanted / 2;
    /* What does not get it stays as it is. */
    (void)make_room(r, (uint32_t)(room < most ? room : most), r->negative != NULL);
}

/* Of those that are taken in the round; 0: there is no more room. */
static uint32_t number_of(const zt_rounds *r, uint32_t i) {
    if (i < r->spare_count) return r->spare[r->spare_count - 1 - i];
    i -= r->spare_count;
    return i < r->room - r->count ? r->count + i : 0;
}

/* Where the number of a slot's next round is. */
static uint32_t *next_of(const zt_rounds *r, const zt_slot *s) {
    if (s->known) return &r->rounds[s->known].next;
    return &r->first[(size_t)s->row * (size_t)r->width + (size_t)s->column];
}

bool zt_rounds_recall(zt_canvas *canvas, int32_t slot, const zt_rounds *r) {
    zt_slot *s = &canvas->slots[slot];
    uint32_t next = s->known == ZT_ROUNDS_LOST ? 0 : *next_of(r, s);
    if (!next) return false;
    const zt_round *round = &r->rounds[next];
    s->sum = round->sum;
    s->strange = round->strange;
    s->known = next;
    size_t pixel = zt_canvas_pixel(canvas, s->column, s->row);
    canvas->error[pixel] = round->error;
    canvas->step[pixel] = round->step;
    if (canvas->negative) canvas->negative[slot] = r->negative[next];
    return true;
}

static void keep(zt_rounds *r, zt_canvas *canvas, int32_t slot, uint32_t number) {
    zt_slot *s = &canvas->slots[slot];
    if (!number) {
        s->known = ZT_ROUNDS_LOST;
        return;
    }
    size_t pixel = zt_canvas_pixel(canvas, s->column, s->row);
    r->rounds[number] = (zt_round){.sum = s->sum,
                                   .error = canvas->error[pixel],
                                   .step = canvas->step[pixel],
                                   .strange = s->strange};
    if (canvas->negative) r->negative[number] = canvas->negative[slot];
    *next_of(r, s) = number;
    s->known = number;
}

void zt_rounds_keep(zt_rounds *r, zt_canvas *canvas, const int32_t *slots, int count) {
    uint32_t wanted = 0, i;
    for (int k = 0; k < count; k++) wanted += canvas->slots[slots[k]].known != ZT_ROUNDS_LOST;
    /* All at once: it has to wait for all that was written before. */
    i = atomic_fetch_add_explicit(&r->taken, wanted, memory_order_relaxed);
    for (int k = 0; k < count; k++)
        if (canvas->slots[slots[k]].known != ZT_ROUNDS_LOST)
            keep(r, canvas, slots[k], number_of(r, i++));
}
