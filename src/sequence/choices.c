/* What was chosen for a frame, in words: its precision, and how its time is divided. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>

#include "base/diag.h"
#include "base/random.h"
#include "keyframe/advice.h"
#include "sequence/renderer.h"

/* ---- precision ------------------------------------------------------------------------------
 */

/* What asks for more than a precision. */
static void say_why(char *text, size_t size, const zt_accuracy *a, zt_precision precision,
                    const zt_scene *scene, const zt_animation *animation) {
    const char *digits = zt_precision_name(precision);
    const char *name = a->object < 0 ? "" : zt_advice_name_of_object(animation, a->object).text;
    switch (a->reason) {
    case ZT_ACCURACY_NEAR:
        snprintf(text, size,
                 "the camera is %.3g from %s, whose numbers reach %.4g; %s precision would "
                 "be off by %.2g, and %.2g can be seen",
                 a->distance, name, a->number, digits, a->wrong, a->seen);
        break;
    case ZT_ACCURACY_NARROW:
        snprintf(text, size,
                 "%s is %.3g from the camera, in a view so narrow that %.2g can be seen; %s "
                 "precision would be off by %.2g",
                 name, a->distance, a->seen, digits, a->wrong);
        break;
    case ZT_ACCURACY_LAMP:
        snprintf(text, size,
                 "%s is %.3g from %s, whose numbers reach %.4g; %s precision would be off "
                 "by %.2g",
                 zt_advice_name_of(animation, ZT_OWNER_POINT, a->other).text, a->distance, name,
                 a->number, digits, a->wrong);
        break;
    case ZT_ACCURACY_TWIN:
        snprintf(text, size,
                 "%s and %s are %.3g apart and their numbers reach %.4g; %s precision would "
                 "be off by %.2g",
                 name, zt_advice_name_of_object(animation, a->other).text, a->distance,
                 a->number, digits, a->wrong);
        break;
    case ZT_ACCURACY_RANGE:
        snprintf(text, size, "of %s a number is %.3g, whose square %s precision cannot hold",
                 name, a->number, digits);
        break;
    case ZT_ACCURACY_STRETCH:
        snprintf(text, size,
                 "%s is stretched %.3g times more one way than another, and %s precision "
                 "has too few digits for it",
                 name, a->number, digits);
        break;
    case ZT_ACCURACY_THIN:
        snprintf(text, size,
                 "%s is %.3g thin and its numbers reach %.4g; %s precision would be off by "
                 "%.2g",
                 name, a->distance, a->number, digits, a->wrong);
        break;
    case ZT_ACCURACY_MIRRORS:
        snprintf(text, size,
                 "rays may meet %" PRId32 " mirrors one after the other, and the roundings of "
                 "%s precision would add up",
                 scene->reflection_depth, digits);
        break;
    case ZT_ACCURACY_FINE:
        snprintf(text, size, "its roundings stay below what can be seen");
        break;
    }
}

/* What asks for more than the precision that was chosen. */
static const zt_accuracy *lack_of(const zt_ready *ready) {
    return ready->precision == ZT_PRECISION_SINGLE ? &ready->accuracy : &ready->beyond;
}

static void say_precision(zt_frame_choices *choices, const zt_renderer *r,
                          const zt_ready *ready, const zt_scene *scene) {
    const bool lacks = lack_of(ready)->reason != ZT_ACCURACY_FINE;
    const bool asked = r->precision != ZT_PRECISION_AUTO;
    char why[256];
    say_why(why, sizeof why, lacks ? lack_of(ready) : &ready->accuracy,
            lacks ? ready->precision : ZT_PRECISION_SINGLE, scene, r->animation);
    const bool silent = r->precision == ZT_PRECISION_DOUBLE && !lacks;
    choices->precision = ready->precision;
    snprintf(choices->precision_text, sizeof choices->precision_text, "%s precision%s%s%s",
             zt_precision_name(ready->precision), asked ? ", as asked for" : "",
             silent  ? ""
             : lacks ? ", though "
                     : ": ",
             silent ? "" : why);
}

/* ---- motion ---------------------------------------------------------------------------------
 */

static const char *name_of(const zt_animation *animation, zt_part_thing thing) {
    return zt_advice_name_of(animation, thing.owner, thing.index).text;
}

/* "ball is at most 0.2 px off its way". */
static void say_off(char *text, size_t size, const zt_division *d,
                    const zt_animation *animation) {
    const char *name = name_of(animation, d->worst);
    if (d->worst.is_place)
        snprintf(text, size, "%s is at most %.2g px off its way", name,
                 d->off * animation->film.shutter.error);
    else
        snprintf(text, size, "%s is at most %.2g %% off", name, d->off * ZT_CHORD_SHARE * 100);
}

static void say_motion(char *text, size_t size, const zt_division *d,
                       const zt_animation *animation) {
    const zt_shutter *shutter = &animation->film.shutter;
    char off[128] = "all goes straight on", because[128] = "", steps[128] = "";
    *text = '\0';
    if (shutter->close <= shutter->open) return;
    if (d->off > 0) say_off(off, sizeof off, d, animation);
    if (d->asked)
        snprintf(because, sizeof because, ", because of %s", name_of(animation, d->most));
    if (d->stepping >= 0)
        snprintf(steps, sizeof steps, "; %s changes at once",
                 animation->tracks[d->stepping].name);
    double degrees = (shutter->close - shutter->open) * 360;
    if (d->moment_count == 1)
        snprintf(text, size, "%.4g degrees open: nothing moves", degrees);
    else
        snprintf(text, size, "%.4g degrees open: %" PRId32 " moments%s; %s%s%s", degrees,
                 d->moment_count, because, off, steps,
                 d->off > 1 ? "; that is more than can be met" : "");
}

/* ---- both -----------------------------------------------------------------------------------
 */

static uint64_t add_thing(uint64_t key, zt_part_thing thing) {
    return zt_random_key(zt_random_key(key, thing.owner), (uint64_t)thing.index);
}

/* What the sentences are about; of moments, about how many. */
static int64_t cause_of(const zt_ready *ready, const zt_division *d) {
    uint64_t key = 0;
    for (int i = 0; i < 2; i++) {
        const zt_accuracy *a = i ? &ready->beyond : &ready->accuracy;
        key = zt_random_key(zt_random_key(key, a->reason), (uint64_t)a->object);
        key = zt_random_key(key, (uint64_t)a->other);
    }
    key = zt_random_key(key, (uint64_t)ilogb(d->moment_count));
    if (d->asked) key = add_thing(key, d->most);
    if (d->off > 0) key = add_thing(key, d->worst);
    key = zt_random_key(key, d->off > 1);
    return (int64_t)zt_random_key(key, (uint64_t)d->stepping);
}

void zt_renderer_say(zt_frame_choices *choices, const zt_renderer *r, const zt_ready *ready,
                     const zt_exposure *exposure, const zt_division *division) {
    say_precision(choices, r, ready, exposure->moments);
    say_motion(choices->motion_text, sizeof choices->motion_text, division, r->animation);
    choices->moment_count = exposure->moment_count;
    choices->cause = cause_of(ready, division);
}

void zt_renderer_doubt(zt_renderer *r, const zt_ready *ready, const zt_exposure *exposure,
                       const zt_division *division, int64_t frame) {
    bool single = ready->precision == ZT_PRECISION_SINGLE;
    const zt_accuracy *a = lack_of(ready);
    char why[256];
    if (a->reason != ZT_ACCURACY_FINE && !r->told_precision) {
        say_why(why, sizeof why, a, ready->precision, exposure->moments, r->animation);
        zt_tell(r->listener, ZT_WARNING, "frame %" PRId64 " asks for %s precision: %s", frame,
                single ? "double" : "more than double", why);
        r->told_precision = true;
    }
    if (division->off > 1 && !r->told_motion) {
        say_off(why, sizeof why, division, r->animation);
        zt_tell(r->listener, ZT_WARNING,
                "frame %" PRId64 " asks for more than its %" PRId32 " moments: %s", frame,
                division->moment_count, why);
        r->told_motion = true;
    }
}
