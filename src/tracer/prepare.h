/* A scene is made ready for rays. */
#ifndef ZT_TRACER_PREPARE_H
#define ZT_TRACER_PREPARE_H

#include "tracer/tracer.h"

/* Makes the tracer of a precision, and the extents of its primitives, in the arena. Things that
 * are degenerate have nothing to hit and are left out. */
zt_status ZT_REAL_NAME(zt_prepare)(zt_tracer **tracer, zt_extents *extents,
                                   const zt_exposure *exposure, const zt_needs *needs,
                                   bool everything, zt_meshes *meshes, zt_arena *arena);

/* Tells what those who send rays must know of a tracer. */
void ZT_REAL_NAME(zt_prepare_ready)(zt_ready *ready, const zt_tracer *tracer);

/* Then what is asked by itself is told from what is asked through a hierarchy, which is built:
 * only once it is known that the tracer is wanted. */
zt_status ZT_REAL_NAME(zt_prepare_search)(zt_tracer *tracer, zt_meshes *meshes,
                                          zt_arena *arena);

/* The part of it that is the lamps. */
zt_status ZT_REAL_NAME(zt_prepare_lamps)(zt_tracer *tracer, const zt_exposure *exposure,
                                         const zt_needs *needs, zt_arena *arena);

/* What is known of lamps and of what may be in their way before any batch is. */
zt_status ZT_REAL_NAME(zt_prepare_reach)(zt_tracer *tracer, zt_arena *arena);

#endif
