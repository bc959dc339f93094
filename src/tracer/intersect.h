/* What a batch of rays meets, of all that a scene has. */
#ifndef ZT_TRACER_INTERSECT_H
#define ZT_TRACER_INTERSECT_H

#include "tracer/bundle.h"
#include "tracer/isa.h"
#include "tracer/tracer.h"

/* The nearest hit of each ray (origins, directions and count given) of a bundle: sets t, hit
 * and part; hit is -1 and t infinite where there is none. Of hits that are as near as roundings
 * can tell the first object's counts. Returns false where the bundle already says that there is
 * nothing to meet. */
bool ZT_KERNEL_NAME(zt_intersect)(zt_batch *rays, const zt_bundle *bundle,
                                  const zt_tracer *tracer);

/* Whether something lies between origin and t (given), and not at t itself as far as roundings
 * can tell: hit, given as -1, stays so where nothing does. */
void ZT_KERNEL_NAME(zt_occlude)(zt_batch *rays, const zt_bundle *bundle,
                                const zt_tracer *tracer);

/* False only where no ray of a bundle meets anything. Notes how far it had to look, so that
 * zt_occlude need not look again. */
bool ZT_KERNEL_NAME(zt_may_meet)(zt_bundle *bundle, const zt_tracer *tracer);

/* For one primitive that is not a mesh, and the group of lanes that begins with ray number
 * `first`: their nearest hits; with `any`, of shadow rays. */
void ZT_KERNEL_NAME(zt_meet_lanes)(zt_batch *rays, const zt_tracer *tracer, int32_t index,
                                   int first, bool any);

#endif
