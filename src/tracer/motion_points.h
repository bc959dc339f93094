/* The points where rays end on what moves, each at its ray's time. */
#ifndef ZT_TRACER_MOTION_POINTS_H
#define ZT_TRACER_MOTION_POINTS_H

#include "tracer/points.h"

/* Surfaces, but for those of meshes: the normals, and the positions corrected. */
void ZT_KERNEL_NAME(zt_find_moving)(zt_points *points, zt_origins *from,
                                    const zt_tracer *tracer);

/* The colors and reflectivities of what changes them, before those of a mesh's corners; and the
 * cells of patterns, once the positions and normals are right. */
void ZT_KERNEL_NAME(zt_change_colors)(zt_points *points, const zt_origins *from,
                                      const zt_tracer *tracer);
void ZT_KERNEL_NAME(zt_change_patterns)(zt_points *points, const zt_origins *from,
                                        const zt_tracer *tracer);

#endif
