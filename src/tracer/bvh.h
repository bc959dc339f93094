/* Bounding volume hierarchies over boxes: which rays may meet what is in which box. Embree
 * builds them, a module that is loaded when the first one is built; rays look into them in
 * groups (tracer/look.c), which for boxes with anything in them is quicker than Embree's own
 * way.
 *
 * What is in a box, and where a ray meets it, is the caller's: rays are single precision in a
 * space of his choice and only tell where to look, so that what is met depends on nothing here.
 * Embree's own triangles are not used: near vertices rays get through between them. */
#ifndef ZT_TRACER_BVH_H
#define ZT_TRACER_BVH_H

#include <stdint.h>

#include <zoetrope/status.h>

/* Up to 256 rays o + t d that look from t = 0 to a little beyond `far`, by 2^-20 of it. The
 * largest component of d is between 2^-126 and 2^127. One that is not like that, has another
 * number but far that is not finite, or a far that is not positive, looks nowhere. */
enum { ZT_BVH_RAYS = 256, ZT_BVH_LANES = 16 };
typedef struct zt_bvh_rays {
    _Alignas(64) float ox[ZT_BVH_RAYS];
    _Alignas(64) float oy[ZT_BVH_RAYS];
    _Alignas(64) float oz[ZT_BVH_RAYS];
    _Alignas(64) float dx[ZT_BVH_RAYS];
    _Alignas(64) float dy[ZT_BVH_RAYS];
    _Alignas(64) float dz[ZT_BVH_RAYS];
    _Alignas(64) float far[ZT_BVH_RAYS];
    int count;
} zt_bvh_rays;

typedef struct zt_bvh_box {
    float low[3], high[3];
} zt_bvh_box;

/* The builder: Embree's device. Opening it starts nothing; threads that build, 0 for one a
 * core, are started by the first hierarchy; where there are several builders in a process, the
 * last one to start says how many. Hierarchies of one builder are built one at a time; looking
 * is legal from any number of threads. */
typedef struct zt_bvh_builder zt_bvh_builder;
zt_status zt_bvh_open(zt_bvh_builder **builder, int threads, zt_listener listener);
void zt_bvh_close(zt_bvh_builder **builder);       /* after all of its hierarchies */
int zt_bvh_threads(const zt_bvh_builder *builder); /* at least 1 */

/* Loads Embree and has it start, so that no hierarchy fails but for lack of memory; told where
 * that cannot be. */
zt_status zt_bvh_start(zt_bvh_builder *builder);

/* Over boxes, which need not outlive the call. *bvh is NULL or a hierarchy of the same builder,
 * which is then made over anew: what moves is built each frame and should allocate little.
 * Boxes with low > high, or with a number that is not finite, are left out. Where this fails,
 * the hierarchy is freed and *bvh NULL. */
typedef struct zt_bvh zt_bvh;
zt_status zt_bvh_of_boxes(zt_bvh **bvh, zt_bvh_builder *builder, const zt_bvh_box *boxes,
                          int32_t box_count);
void zt_bvh_free(zt_bvh **bvh);

/* What is called for boxes that rays may meet before their `far`, with those of the rays
 * first .. first + 15 whose bits are set in `lanes`: the lowest bit for ray number `first`, a
 * multiple of 16. It may make `far` of those rays less, 0 or negative to be done with a ray,
 * and returns which ones' it made; it may look into another hierarchy. */
typedef uint32_t zt_bvh_visit(void *user, int32_t box, int first, uint32_t lanes);

/* Looking (tracer/look.h): calls `visit` for boxes in about the order of distance, some of them
 * though no ray meets them.
 *
 * No box is passed by that a ray, its numbers taken as exact, touches before `far`, for origins
 * within 2^26 times the size of what all boxes make up (or 2^2 times their largest coordinate).
 * Boxes smaller than 2^-19 of that size are looked at as if they were that large, so that
 * giants and dwarfs should not share a hierarchy. Roundings of the numbers themselves are the
 * caller's to allow for, by larger boxes, or by moving origins near in double precision first.
 */
typedef void zt_bvh_look(const zt_bvh *bvh, zt_bvh_rays *rays, zt_bvh_visit *visit, void *user);

#endif
