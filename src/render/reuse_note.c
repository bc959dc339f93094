/* The footprints of tiles whose pixels take samples in rounds, from any thread. */
#include <threads.h>

#include "render/reuse.h"

void zt_reuse_watch(zt_rays *rays, zt_footprint *footprint, const zt_frame *f) {
    rays->footprint = footprint;
    rays->outline = &f->job->reuse->last.outline;
}

void zt_reuse_note(zt_frame *f, const zt_footprint *footprint, int column, int row) {
    zt_reuse *r = f->job->reuse;
    const int half = TILE_SIDE / 2, tile_columns = f->tile_columns;
    int tile = row / TILE_SIDE * tile_columns + column / TILE_SIDE;
    int part = row / half % 2 * 2 + column / half % 2;
    atomic_flag *lock = &r->locks[tile % ZT_REUSE_LOCKS];
    if (footprint->doubtful) atomic_store_explicit(&f->doubtful, true, memory_order_relaxed);
    while (atomic_flag_test_and_set_explicit(lock, memory_order_acquire)) thrd_yield();
    zt_footprint_join(&r->last.footprints[tile * ZT_PICTURE_PARTS + part], footprint);
    atomic_flag_clear_explicit(lock, memory_order_release);
}
