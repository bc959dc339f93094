/* Expressions of a description: their text becomes a formula. */
#ifndef ZT_DESCRIPTION_FORMULAS_H
#define ZT_DESCRIPTION_FORMULAS_H

#include "description/reading.h"

/* Compiles a text that begins with "=" for a property. Names are those of all things and of
 * variables that are numbers. What is wrong is told at its place. ZT_EUNSUPPORTED where nothing
 * can evaluate it, which is told; ZT_EMEMORY. */
zt_status zt_formula_read(zt_formula *formula, zt_reading *reading, const zt_node *node,
                          const zt_property *property);

#endif
