/* The places of meshes that move. Compiled once for each precision. */
#include "base/diag.h"
#include "tracer/motion.h"

/* As tracer/shapes.c has it: out of the mesh's space, `origin` left out. */
static xform place_of(const zt_object *o, const xform *world, const zt_mesh *mesh) {
    const zt_placement *p = &o->placement;
    xform own = xform_place(p->position, p->rotation, p->scale);
    xform place = xform_mul(world, &own);
    place.shift = xform_point(&place, mesh->origin);
    return place;
}

zt_status ZT_REAL_NAME(zt_prepare_mesh_motion)(bool *there, zt_making *m,
                                               zt_placed_mesh *placed, const zt_course *c) {
    const zt_exposure *e = c->exposure;
    const zt_mesh *mesh = &e->moments->meshes[m->object->mesh];
    const int32_t i = m->primitive->object;
    vec3 half = vec3_scale(vec3_sub(mesh->high, mesh->low), 0.5);
    vec3 low = {INFINITY, INFINITY, INFINITY}, high = vec3_scale(low, -1);
    vec3 middle = vec3_sub(vec3_add(mesh->low, half), mesh->origin);
    bool moves = false;
    xform *places = ZT_PUSH(c->arena, xform, (size_t)e->moment_count);
    if (!places) return ZT_EMEMORY;
    for (int32_t k = 0; k < e->moment_count; k++) {
        xform *place = &places[k];
        *place = place_of(&e->moments[k].objects[i], &zt_course_worlds(c, k)[i], mesh);
        moves |= !xform_equal(place, places);
        double reaches[3], longest = 0;
        for (int axis = 0; axis < 3; axis++) {
            vec3 r = zt_xform_row(place, axis);
            reaches[axis] = fabs(r.x) * half.x + fabs(r.y) * half.y + fabs(r.z) * half.z;
            longest = fmax(longest, vec3_max_abs(r));
        }
        vec3 at = xform_point(place, middle), reach = {reaches[0], reaches[1], reaches[2]};
        low = vec3_min(low, vec3_sub(at, reach));
        high = vec3_max(high, vec3_add(at, reach));
        *there &= finite3(at) && finite3(reach);
        placed->extent = real_max(placed->extent, (real)(vec3_max_abs(place->shift) +
                                                         3 * longest * (double)placed->inner));
    }
    if (!moves || !*there) return ZT_OK;
    ZT_REAL_NAME(zt_set_bounds)(m, low, high);
    placed->places = places;
    return ZT_OK;
}
