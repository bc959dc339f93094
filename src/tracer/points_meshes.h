/* The points where rays end on meshes. */
#ifndef ZT_TRACER_POINTS_MESHES_H
#define ZT_TRACER_POINTS_MESHES_H

#include "tracer/points.h"

/* Of listed points, all of them on meshes: the flat normals, and the positions corrected; where
 * the corners have colors, these as well. */
void ZT_KERNEL_NAME(zt_find_on_meshes)(zt_points *points, zt_batch *rays,
                                       const zt_tracer *tracer, const int32_t *list, int count);

/* Once the normals face the rays: those of smooth meshes are bent, and the points lifted. */
void ZT_KERNEL_NAME(zt_smooth_on_meshes)(zt_points *points, zt_batch *rays,
                                         const zt_tracer *tracer, const int32_t *list,
                                         int count);

#endif
