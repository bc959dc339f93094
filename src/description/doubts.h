/* What is legal in keys and probably not meant. */
#ifndef ZT_DESCRIPTION_DOUBTS_H
#define ZT_DESCRIPTION_DOUBTS_H

#include "description/keys.h"

/* Warns, each at its place: keys outside of the film or between its frames; two keys within a
 * frame that are far apart; a half turn, which could go either way; handles that are longer
 * than their way; numbers too large for it. `curve` is what became of the keys. */
void zt_doubts_tell(zt_reading *reading, const zt_property *property, const zt_keys *keys,
                    const zt_curve *curve);

#endif
