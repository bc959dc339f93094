#include "tracer/pairing.h"

#include "base/diag.h"

static zt_hash hash_at(const zt_pairing_list *l, int32_t index) {
    return *(const zt_hash *)((const char *)l->first + (size_t)index * l->stride);
}

static bool same(const zt_pairing *p, int32_t before, int32_t now) {
    return zt_hash_equal(hash_at(&p->before, before), hash_at(&p->now, now));
}

/* Where a hash stands in the table, or would. */
static int32_t *slot_of(const zt_pairing_list *l, zt_hash hash) {
    uint32_t at = (uint32_t)hash.high & l->mask;
    while (l->table[at] >= 0 && !zt_hash_equal(hash_at(l, l->table[at]), hash))
        at = (at + 1) & l->mask;
    return &l->table[at];
}

static zt_status fill_table(zt_pairing_list *l, zt_arena *arena) {
    uint32_t size = 4;
    while (size < 2 * (uint32_t)(l->end - l->next)) size *= 2;
    l->mask = size - 1;
    l->table = ZT_PUSH(arena, int32_t, size);
    if (!l->table) return ZT_EMEMORY;
    for (uint32_t i = 0; i < size; i++) l->table[i] = -1;
    for (int32_t i = l->next; i < l->end; i++) *slot_of(l, hash_at(l, i)) = i;
    return ZT_OK;
}

zt_status zt_pairing_begin(zt_pairing *p, zt_arena *arena) {
    zt_pairing_list *a = &p->before, *b = &p->now;
    int32_t begin = 0, most = a->count < b->count ? a->count : b->count;
    while (begin < most && same(p, begin, begin)) begin++;
    a->end = a->count;
    b->end = b->count;
    while (a->end > begin && b->end > begin && same(p, a->end - 1, b->end - 1)) {
        a->end--;
        b->end--;
    }
    a->next = b->next = begin;
    ZT_TRY(fill_table(a, arena));
    ZT_TRY(fill_table(b, arena));
    a->next = b->next = 0;
    return ZT_OK;
}

/* How much further on in a list a hash is; 0: nowhere. */
static int32_t way_to(const zt_pairing_list *l, zt_hash hash) {
    int32_t at = *slot_of(l, hash);
    return at > l->next ? at - l->next : 0;
}

bool zt_pairing_next(int32_t *before, int32_t *now, zt_pairing *p) {
    zt_pairing_list *a = &p->before, *b = &p->now;
    bool both = a->next < a->count && b->next < b->count;
    bool gone = a->next < a->end, come = b->next < b->end;
    if (a->next == a->count && b->next == b->count) return false;
    if (gone && come && !same(p, a->next, b->next)) {
        int32_t to_before = way_to(a, hash_at(b, b->next)),
                to_now = way_to(b, hash_at(a, a->next));
        /* What is nowhere else is passed first; else the shorter way is gone. */
        if (to_before && (!to_now || to_before <= to_now))
            come = false;
        else if (to_now)
            gone = false;
    } else if (both && gone == come) {
        gone = come = true;
    }
    *before = gone ? a->next++ : -1;
    *now = come ? b->next++ : -1;
    return true;
}
