/* All advice on an animation, in the order in which it is told. */
#include "keyframe/advice.h"

zt_status zt_animation_advise(const zt_animation *animation, zt_listener listener) {
    zt_advice_curves(animation, listener);
    ZT_TRY(zt_advice_camera(animation, listener));
    ZT_TRY(zt_advice_lamps(animation, listener));
    return zt_advice_shapes(animation, listener);
}
