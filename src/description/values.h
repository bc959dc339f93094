/* Values of properties, each kind as it is written. */
#ifndef ZT_DESCRIPTION_VALUES_H
#define ZT_DESCRIPTION_VALUES_H

#include "description/fields.h"
#include "keyframe/property.h"

/* What a property may be, as written. */
zt_range zt_property_range(const zt_property *property);

/* Reads a value, zt_value_width() doubles, in the property's range. */
bool zt_read_value(double *value, zt_mistakes *mistakes, const zt_node *node,
                   const zt_property *property);

/* The same for differences and speeds of values: any numbers; of colors a list of three; of
 * rotations, which have another width, none of these. */
bool zt_read_difference(double *value, zt_mistakes *mistakes, const zt_node *node,
                        const char *what, zt_value_kind kind);

#endif
