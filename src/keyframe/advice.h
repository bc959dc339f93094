/* What advice is worked out from. */
#ifndef ZT_KEYFRAME_ADVICE_H
#define ZT_KEYFRAME_ADVICE_H

#include "keyframe/explain.h"

enum {
    ZT_ADVICE_MOMENTS_MAX = 10000,
    ZT_ADVICE_MOMENTS_PER_FRAME = 4,
    ZT_ADVICE_WORK_MAX =
        4 * 1000 * 1000, /* objects and tracks frozen while looking at scenes */
    ZT_ADVICE_TRIANGLES_MAX =
        20 * 1000 * 1000 /* asked whether the camera is within their mesh */
};

/* The moments at which a film is looked at: all frames and some between, or fewer, evenly
 * spread. */
int64_t zt_advice_moment_count(const zt_film *film, int64_t most);
double zt_advice_moment_s(const zt_film *film, int64_t index, int64_t count);

/* The advice on the camera. Fails as freezing does. */
zt_status zt_advice_camera(const zt_animation *animation, zt_listener listener);

#endif
