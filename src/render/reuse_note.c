/* The footprints of tiles whose pixels take samples in rounds, from any thread. */
#include <threads.h>

#include "render/reuse.h"

void zt_reuse_watch(zt_rays *rays, zt_footprint *footprint, const zt_frame *f) {
    rays->footprint = footprint;
    rays->outline = &f->job->reuse->last.outline;
}

static void join(zt_footprint *all, const zt_footprint *f) {
    for (int i = 0; i < ZT_FOOTPRINT_STEPS && f->steps[i].there; i++) {
        zt_footstep *to = &all->steps[i];
        const zt_footstep *from = &f->steps[i];
        zt_hold_box(&to->origins, &from->origins, !to->there);
        zt_hold_box(&to->directions, &from->directions, !to->there);
        if (from->ends) zt_hold_box(&to->points, &from->points, !to->ends);
        to->there = true;
        to->ends |= from->ends;
        to->leaves |= from->leaves;
    }
    all->met |= f->met;
    all->faced |= f->faced;
    all->lit |= f->lit;
    all->doubtful |= f->doubtful;
    all->restless |= f->restless;
}

void zt_reuse_note(zt_frame *f, const zt_footprint *footprint, int column, int row) {
    zt_reuse *r = f->job->reuse;
    const int half = TILE_SIDE / 2, tile_columns = f->tile_columns;
    int tile = row / TILE_SIDE * tile_columns + column / TILE_SIDE;
    int part = row / half % 2 * 2 + column / half % 2;
    atomic_flag *lock = &r->locks[tile % ZT_REUSE_LOCKS];
    if (footprint->doubtful) atomic_store_explicit(&f->doubtful, true, memory_order_relaxed);
    while (atomic_flag_test_and_set_explicit(lock, memory_order_acquire)) thrd_yield();
    join(&r->last.footprints[tile * ZT_REUSE_PARTS + part], footprint);
    atomic_flag_clear_explicit(lock, memory_order_release);
}
