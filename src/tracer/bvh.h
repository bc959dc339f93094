/* Bounding volume hierarchies over triangles and over boxes. The door to Embree, a module that
 * is loaded when the first hierarchy is built.
 *
 * What a hierarchy finds is where to look: rays are single precision in a space of the caller's
 * choice, and the caller works out distances himself. */
#ifndef ZT_TRACER_BVH_H
#define ZT_TRACER_BVH_H

#include <stdbool.h>
#include <stdint.h>

#include <zoetrope/status.h>

#include "base/diag.h"

/* Up to 256 rays o + t d, d of any length, that look from t = 0 to `far`; a ray whose far is
 * negative looks nowhere. */
enum { ZT_BVH_RAYS = 256 };
typedef struct zt_bvh_rays {
    _Alignas(64) float ox[ZT_BVH_RAYS];
    _Alignas(64) float oy[ZT_BVH_RAYS];
    _Alignas(64) float oz[ZT_BVH_RAYS];
    _Alignas(64) float dx[ZT_BVH_RAYS];
    _Alignas(64) float dy[ZT_BVH_RAYS];
    _Alignas(64) float dz[ZT_BVH_RAYS];
    _Alignas(64) float far[ZT_BVH_RAYS];
    _Alignas(64) int32_t triangle[ZT_BVH_RAYS]; /* what is found, or -1 */
    int count;
} zt_bvh_rays;

typedef struct zt_bvh_box {
    float low[3], high[3];
} zt_bvh_box;

/* The builder: Embree's device. Opening it starts nothing; threads that build, 0 for one a
 * core, are started by the first hierarchy. */
typedef struct zt_bvh_builder zt_bvh_builder;
zt_status zt_bvh_open(zt_bvh_builder **builder, int threads, zt_listener listener);
void zt_bvh_close(zt_bvh_builder **builder); /* after all of its hierarchies */

typedef struct zt_bvh zt_bvh;

/* Over the triangles of a mesh: `positions` (vertex_count * 3, and one float more that may be
 * read) and `triangles` (triangle_count * 3 indices) must outlive it. */
zt_status zt_bvh_of_triangles(zt_bvh **out, zt_bvh_builder *builder, const float *positions,
                              int32_t vertex_count, const uint32_t *triangles,
                              int32_t triangle_count);

/* Over boxes, which must outlive it. *bvh is NULL or one of the same builder's over boxes,
 * which is then made over anew: what moves is built each frame and should allocate little. */
zt_status zt_bvh_of_boxes(zt_bvh **bvh, zt_bvh_builder *builder, const zt_bvh_box *boxes,
                          int32_t box_count);
void zt_bvh_free(zt_bvh **bvh);

/* How the rays run: close together from about one place, or anyhow. */
typedef enum zt_bvh_kind { ZT_BVH_COHERENT, ZT_BVH_SCATTERED } zt_bvh_kind;

/* The nearest triangle of each ray before `far`: sets `triangle`, and `far` to about its
 * distance. Watertight at edges that triangles share. */
void zt_bvh_nearest(const zt_bvh *bvh, zt_bvh_rays *rays, zt_bvh_kind kind);

/* Whether there is a triangle before `far`: sets `triangle` to one of them or to -1. */
void zt_bvh_any(const zt_bvh *bvh, zt_bvh_rays *rays, zt_bvh_kind kind);

/* Calls `visit` for boxes that rays may meet before their `far`, with the numbers of those
 * rays; never passes by one that a ray meets by more than the roundings of its own arithmetic.
 * The visitor may make `far` of those rays less, negative to be done with a ray. Boxes come in
 * about the order of distance, and any number of times. */
typedef void zt_bvh_visit(void *user, int32_t box, const int32_t *numbers, int count);
void zt_bvh_look(const zt_bvh *bvh, zt_bvh_rays *rays, zt_bvh_kind kind, zt_bvh_visit *visit,
                 void *user);

#endif
