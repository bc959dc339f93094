/* The pilot: a few frames rendered with few samples, to find out what frames cost. */
#ifndef ZT_SEQUENCE_PILOT_H
#define ZT_SEQUENCE_PILOT_H

#include "sequence/budget.h"
#include "sequence/renderer.h"

/* Sets the plan's power, costs and what is enough, in about a tenth of what its budget is for
 * all frames, or of adaptive sampling three tenths of what it is for one, if that is more.
 * Fails as rendering does. */
zt_status zt_pilot_run(zt_plan *plan, zt_renderer *renderer, const zt_watcher *watcher);

#endif
