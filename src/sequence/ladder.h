/* Parts of the ladder. */
#ifndef ZT_SEQUENCE_LADDER_H
#define ZT_SEQUENCE_LADDER_H

#include <zoetrope/ladder.h>

#include "scene/exposure.h"

/* Lists the ladder's references, those of `samples` samples at most, and its rungs, of a film
 * that is sampled so and in this precision; `both`: in the other one too. ZT_EMEMORY. */
zt_status zt_ladder_plan(zt_ladder *ladder, const zt_sampling *film, zt_precision precision,
                         bool both, bool filters);

/* Puts into words what an exposure does without. */
void zt_ladder_say_left_out(zt_ladder *ladder, const zt_exposure *exposure);

#endif
