/* Oklab, a space in which equal steps look equal (B. Ottosson, "A perceptual color space for
 * image processing", 2020), from and to linear Rec. 709 light. */
#ifndef ZT_KEYFRAME_OKLAB_H
#define ZT_KEYFRAME_OKLAB_H

#include "base/vec.h"

static inline vec3 zt_oklab_from_light(vec3 c) {
    double l = cbrt(0.4122214708 * c.x + 0.5363325363 * c.y + 0.0514459929 * c.z);
    double m = cbrt(0.2119034982 * c.x + 0.6806995451 * c.y + 0.1073969566 * c.z);
    double s = cbrt(0.0883024619 * c.x + 0.2817188376 * c.y + 0.6299787005 * c.z);
    return (vec3){0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
                  1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
                  0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

/* The inverse of both matrices to the last digit, so that a colour comes back as it was.
 * Colours that no display has come back with a channel below 0. */
static inline vec3 zt_oklab_to_light(vec3 c) {
    double l = 0.99999999845051979 * c.x + 0.39633779217376786 * c.y + 0.2158037580607588 * c.z;
    double m =
        1.0000000088817609 * c.x - 0.10556134232365635 * c.y - 0.063854174771705907 * c.z;
    double s = 1.0000000546724108 * c.x - 0.089484182094965753 * c.y - 1.2914855378640917 * c.z;
    l = l * l * l, m = m * m * m, s = s * s * s;
    return (vec3){4.0767416613479943 * l - 3.3077115904081933 * m + 0.2309699287294279 * s,
                  -1.2684380040921761 * l + 2.6097574006633715 * m - 0.34131939631021962 * s,
                  -0.0041960865418371089 * l - 0.70341861445944964 * m +
                      1.7076147009309448 * s};
}

#endif
