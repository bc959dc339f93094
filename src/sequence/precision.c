/* In which precision a frame is rendered, in words. */
#include <inttypes.h>
#include <stdio.h>

#include "base/diag.h"
#include "keyframe/advice.h"
#include "sequence/renderer.h"

/* What asks for double precision. */
static void say_why(char *text, size_t size, const zt_accuracy *a, const zt_scene *scene,
                    const zt_animation *animation) {
    const char *name = a->object < 0 ? "" : zt_advice_name_of_object(animation, a->object).text;
    switch (a->reason) {
    case ZT_ACCURACY_NEAR:
        snprintf(text, size,
                 "the camera is %.3g from %s, whose numbers reach %.4g; single precision would "
                 "be off by %.2g, and %.2g can be seen",
                 a->distance, name, a->number, a->wrong, a->seen);
        break;
    case ZT_ACCURACY_NARROW:
        snprintf(
            text, size,
            "%s is %.3g from the camera, in a view so narrow that %.2g can be seen; single "
            "precision would be off by %.2g",
            name, a->distance, a->seen, a->wrong);
        break;
    case ZT_ACCURACY_LAMP:
        snprintf(text, size,
                 "%s is %.3g from %s, whose numbers reach %.4g; single precision would be off "
                 "by %.2g",
                 zt_advice_name_of(animation, ZT_OWNER_POINT, a->other).text, a->distance, name,
                 a->number, a->wrong);
        break;
    case ZT_ACCURACY_TWIN:
        snprintf(
            text, size,
            "%s and %s are %.3g apart and their numbers reach %.4g; single precision would "
            "be off by %.2g",
            name, zt_advice_name_of_object(animation, a->other).text, a->distance, a->number,
            a->wrong);
        break;
    case ZT_ACCURACY_RANGE:
        snprintf(text, size,
                 "of %s a number is %.3g, whose square single precision cannot hold", name,
                 a->number);
        break;
    case ZT_ACCURACY_STRETCH:
        snprintf(text, size,
                 "%s is stretched %.3g times more one way than another, and single precision "
                 "has no digits left for it",
                 name, a->number);
        break;
    case ZT_ACCURACY_MIRRORS:
        snprintf(text, size,
                 "rays may meet %" PRId32 " mirrors one after the other, and the roundings of "
                 "single precision would add up",
                 scene->reflection_depth);
        break;
    case ZT_ACCURACY_FINE:
        snprintf(text, size, "its roundings stay below what can be seen");
        break;
    }
}

void zt_renderer_say_precision(zt_frame_precision *choice, const zt_renderer *r,
                               const zt_ready *ready, const zt_scene *scene) {
    const zt_accuracy *a = &ready->accuracy;
    char why[256];
    say_why(why, sizeof why, a, scene, r->animation);
    if (r->precision == ZT_PRECISION_DOUBLE)
        snprintf(choice->text, sizeof choice->text, "double precision, as asked for");
    else if (r->precision == ZT_PRECISION_SINGLE)
        snprintf(choice->text, sizeof choice->text, "single precision, as asked for%s%s",
                 a->reason == ZT_ACCURACY_FINE ? ": " : ", though ", why);
    else
        snprintf(choice->text, sizeof choice->text, "%s precision: %s",
                 ready->precision == ZT_PRECISION_SINGLE ? "single" : "double", why);
    choice->precision = ready->precision;
    int64_t things = (int64_t)scene->object_count + scene->light_count + 1;
    choice->cause = ((int64_t)a->reason * things + a->object + 1) * things + a->other + 1;
}

void zt_renderer_doubt(zt_renderer *r, const zt_ready *ready, const zt_scene *scene,
                       int64_t frame) {
    bool single = ready->precision == ZT_PRECISION_SINGLE;
    if (!single || ready->accuracy.reason == ZT_ACCURACY_FINE || r->told_precision) return;
    char why[256];
    say_why(why, sizeof why, &ready->accuracy, scene, r->animation);
    zt_tell(r->listener, ZT_WARNING, "frame %" PRId64 " asks for double precision: %s", frame,
            why);
    r->told_precision = true;
}
