/* Rays asked about one by one: what they meet, which lamps shine there, and how they go on.
 * Compiled once for each width of instructions and each precision (tracer/isa.h). */
#include "tracer/intersect.h"
#include "tracer/work.h"

static void begin_probes(zt_work *w, zt_rays *given, const zt_tracer *tracer,
                         const zt_probe *probes, int count) {
    *given = (zt_rays){.count = count};
    for (int i = 0; i < count; i++) {
        given->ox[i] = probes[i].origin.x;
        given->oy[i] = probes[i].origin.y;
        given->oz[i] = probes[i].origin.z;
        given->dx[i] = probes[i].direction.x;
        given->dy[i] = probes[i].direction.y;
        given->dz[i] = probes[i].direction.z;
        given->time[i] = (float)probes[i].time;
        given->key[i] = probes[i].key;
        given->sample[i] = probes[i].sample;
    }
    ZT_KERNEL_NAME(zt_work_begin)(w, tracer, given);
    for (int i = 0; i < count; i++) w->from.source[i] = probes[i].source;
}

static vec3 at(const real *x, const real *y, const real *z, int k) {
    return (vec3){(double)x[k], (double)y[k], (double)z[k]};
}

static void tell_hits(zt_probe *probes, const zt_work *w, const zt_tracer *tracer) {
    const zt_points *p = &w->points;
    for (int k = 0; k < p->count; k++) {
        zt_probe *probe = &probes[p->pixel[k]];
        const zt_primitive *primitive = &tracer->primitives[p->primitive[k]];
        probe->object = primitive->object;
        probe->part = primitive->kind == ZT_PRIMITIVE_MESH ? w->rays.part[k] : -1;
        probe->distance = (double)w->rays.t[k];
        probe->point = probe->mirror_origin = at(w->from.x, w->from.y, w->from.z, k);
        probe->normal = at(p->nx, p->ny, p->nz, k);
        probe->color = at(p->color_r, p->color_g, p->color_b, k);
        probe->mirror_source = w->from.source[k];
    }
}

static void tell_lamp(zt_probe *probes, const zt_work *w, const zt_lamp *lamp) {
    const zt_batch *shadow = &w->shadow;
    for (int k = 0; k < w->points.count; k++) {
        zt_probe *probe = &probes[w->points.pixel[k]];
        bool open = w->wanted[k] && shadow->hit[k] < 0;
        probe->lit |= (uint64_t)open << (lamp->light & 63);
        if (!probe->lamp_points) continue;
        vec3 from = at(w->from.x, w->from.y, w->from.z, k),
             way = at(shadow->dx, shadow->dy, shadow->dz, k);
        probe->lamp_points[lamp->light] = vec3_add(from, vec3_scale(way, (double)shadow->t[k]));
    }
}

static void probe_lamps(zt_probe *probes, zt_work *w, const zt_tracer *tracer,
                        const zt_rays *given) {
    for (int32_t i = 0; i < tracer->lamp_count; i++) {
        const zt_lamp *lamp = &tracer->lamps[i];
        zt_bundle bundle = zt_bundle_to(w->points.places, lamp->bounds, w->points.source);
        ZT_KERNEL_NAME(zt_work_shine)(w, tracer, i, true, given, probes->depth);
        if (lamp->shadows) ZT_KERNEL_NAME(zt_occlude)(&w->shadow, &bundle, tracer);
        tell_lamp(probes, w, lamp);
    }
}

void ZT_KERNEL_NAME(zt_work_probe)(const zt_tracer *tracer, zt_probe *probes, int count,
                                   void *memory) {
    zt_work *w = memory;
    zt_rays given;
    begin_probes(w, &given, tracer, probes, count);
    for (int i = 0; i < count; i++) {
        probes[i].object = probes[i].part = -1;
        probes[i].lit = 0;
    }
    zt_bundle bundle = {.origins = w->points.places, .directions = w->directions, .source = -1};
    ZT_KERNEL_NAME(zt_intersect)(&w->rays, &bundle, tracer);
    ZT_KERNEL_NAME(zt_work_keep_hits)(w, tracer);
    if (w->rays.count == 0) return;
    ZT_KERNEL_NAME(zt_points_find)(&w->points, &w->rays, tracer);
    ZT_KERNEL_NAME(zt_points_spread)(&w->points);
    tell_hits(probes, w, tracer);
    if (!probes->unlit) probe_lamps(probes, w, tracer, &given);
    for (int k = 0; k < w->points.count; k++) {
        mirror_ray(&w->rays, k, w->points.nx[k], w->points.ny[k], w->points.nz[k]);
        probes[w->points.pixel[k]].mirror_direction = at(w->rays.dx, w->rays.dy, w->rays.dz, k);
    }
}
