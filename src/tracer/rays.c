/* How a batch of rays begins, and how those that hit nothing leave it. Compiled once for each
 * width of instructions and each precision (tracer/isa.h). */
#include "tracer/work.h"

/* Repeats the first ray up to a whole group of lanes, so that what is true of all rays is true
 * of all lanes, as their bounds are. */
static void pad(zt_work *restrict w, int count) {
    zt_batch *restrict rays = &w->rays;
    zt_origins *restrict from = &w->from;
    for (int i = count; i < zt_batch_padded(count); i++) {
        from->x[i] = from->x[0];
        from->y[i] = from->y[0];
        from->z[i] = from->z[0];
        from->near[i] = from->near[0];
        rays->dx[i] = rays->dx[0];
        rays->dy[i] = rays->dy[0];
        rays->dz[i] = rays->dz[0];
    }
    w->points.places = zt_range3(from->x, from->y, from->z, count);
    w->directions = zt_range3(rays->dx, rays->dy, rays->dz, count);
}

/* Makes the batch the first rays, with unit directions. */
static void begin(zt_work *restrict w, const zt_rays *restrict given) {
    zt_batch *restrict rays = &w->rays;
    zt_origins *restrict from = &w->from;
    w->rays.from = w->shadow.from = &w->from;
    rays->count = given->count;
    w->points.moved = false;
    int padded = zt_batch_padded(given->count);
    zt_ranging ox = ZT_RANGING, oy = ZT_RANGING, oz = ZT_RANGING;
    zt_ranging vx = ZT_RANGING, vy = ZT_RANGING, vz = ZT_RANGING;
    WIDE_LOOP for (int i = 0; i < padded; i++) {
        real x = (real)given->ox[i], y = (real)given->oy[i], z = (real)given->oz[i];
        real dx = (real)given->dx[i], dy = (real)given->dy[i], dz = (real)given->dz[i];
        real unit = 1 / real_sqrt(real_dot(dx, dy, dz, dx, dy, dz));
        from->x[i] = x;
        from->y[i] = y;
        from->z[i] = z;
        from->near[i] = real_max(real_max(real_abs(x), real_abs(y)), real_abs(z)) * TIE;
        from->source[i] = -1;
        dx *= unit;
        dy *= unit;
        dz *= unit;
        rays->dx[i] = dx;
        rays->dy[i] = dy;
        rays->dz[i] = dz;
        w->points.pixel[i] = i;
        w->points.weight[i] = 1;
        zt_range_add(&ox, x);
        zt_range_add(&oy, y);
        zt_range_add(&oz, z);
        zt_range_add(&vx, dx);
        zt_range_add(&vy, dy);
        zt_range_add(&vz, dz);
    }
    w->points.places = zt_ranges_end(&ox, &oy, &oz);
    w->directions = zt_ranges_end(&vx, &vy, &vz);
    if (padded > given->count) pad(w, given->count);
}

/* When each ray is: on its way from which moment to the next, and how far. */
static void begin_moments(zt_origins *from, const zt_tracer *tracer, const float *time,
                          int count) {
    for (int i = 0; i < zt_batch_padded(count); i++)
        from->between[i] =
            (real)zt_exposure_find(&from->moment[i], tracer->exposure, tracer->moment_at,
                                   i < count ? (double)time[i] : 0);
}

void ZT_KERNEL_NAME(zt_work_begin)(zt_work *w, const zt_tracer *tracer, const zt_rays *given) {
    begin(w, given);
    if (tracer->moves) begin_moments(&w->from, tracer, given->time, given->count);
    w->points.source = -1;
}

void ZT_KERNEL_NAME(zt_work_keep_hits)(zt_work *restrict w, const zt_tracer *tracer) {
    zt_batch *restrict rays = &w->rays;
    zt_origins *restrict from = &w->from;
    zt_points *restrict p = &w->points;
    int count = rays->count, padded = zt_batch_padded(count);
    WIDE_LOOP for (int i = 0; i < padded; i++) w->wanted[i] = rays->hit[i] >= 0;
    if (all_wanted(w, count)) return;
    rays->count = list_wanted(w->list, w->wanted, count);
    p->moved = true;
    padded = zt_batch_padded(rays->count);
    if (tracer->moves) move_moments(from, w->list, padded);
    /* Numbers in the list are no less than their places, so that moving down overwrites nothing
     * that is still wanted. */
    WIDE_LOOP for (int k = 0; k < padded; k++) {
        int32_t i = w->list[k];
        from->x[k] = from->x[i];
        from->y[k] = from->y[i];
        from->z[k] = from->z[i];
        rays->dx[k] = rays->dx[i];
        rays->dy[k] = rays->dy[i];
        rays->dz[k] = rays->dz[i];
        rays->t[k] = rays->t[i];
        rays->hit[k] = rays->hit[i];
        rays->part[k] = rays->part[i];
        p->pixel[k] = p->pixel[i];
        p->weight[k] = p->weight[i];
    }
}
