/* Rotations, in all the ways in which they can be written. */
#ifndef ZT_DESCRIPTION_ROTATIONS_H
#define ZT_DESCRIPTION_ROTATIONS_H

#include "description/fields.h"
#include "keyframe/rotation.h"

typedef struct zt_written_rotation {
    quat rotation; /* of unit length; its sign is that of the angles it was made of */
    vec3 turn;     /* axis times radians; more than once round where one axis says so */
    bool has_axis; /* it was written as an axis and an angle */
} zt_written_rotation;

/* "[x, y, z]": angles around the fixed axes x, then y, then z, of the range in degrees; or
 *   { euler: [x, y, z], order: zyx }
 *   { axis: [x, y, z], angle: 40 deg }
 *   { quaternion: [w, x, y, z] }, of any length
 *   { direction: [x, y, z], up: [0, 1, 0] }: -z points along it. */
bool zt_read_rotation(zt_written_rotation *rotation, zt_mistakes *mistakes, const zt_node *node,
                      const char *what, zt_range range);

/* Whether a mapping has one of the keys that a rotation is written with. */
bool zt_is_rotation(const zt_node *mapping);

#endif
