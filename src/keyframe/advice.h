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
        20 * 1000 * 1000,    /* asked for how near to them, or within them, something is */
    ZT_ADVICE_TOLD_MAX = 100 /* of one kind */
};

/* ---- moments and scenes: advice_scene.c -----------------------------------------------------
 */

/* The moments at which a film is looked at: all frames and some between, or fewer, evenly
 * spread. */
int64_t zt_advice_moment_count(const zt_film *film, int64_t most);
double zt_advice_moment_s(const zt_film *film, int64_t index, int64_t count);

/* The scene of a moment. */
typedef struct zt_advice_moment {
    double time_s;
    const zt_scene *scene;
    xform *worlds;           /* room for those of all objects */
    int64_t *triangles_left; /* that may still be looked at, for all moments together */
} zt_advice_moment;

/* Shows a film's moments in their order, fewer where each of them is looked at from many
 * points. Fails as freezing does. */
typedef void zt_advice_look(void *user, const zt_advice_moment *moment);
zt_status zt_advice_each_moment(const zt_animation *animation, int32_t point_count,
                                zt_advice_look *look, void *user, zt_listener listener);

/* Whether the origin of `world`, the transform of an object's group, is within a solid, and
 * whether it is no further than `distance` from a surface. false where nothing can be said. */
bool zt_advice_within(const zt_advice_moment *moment, const zt_object *object,
                      const xform *world);
bool zt_advice_touches(const zt_advice_moment *moment, const zt_object *object,
                       const xform *world, double distance);

/* From when to when something is so: NAN before it was met. */
typedef struct zt_advice_span {
    double first_s, last_s;
} zt_advice_span;
static const zt_advice_span zt_advice_never = {NAN, NAN};
void zt_advice_met(zt_advice_span *span, double time_s);

/* "at 1 s (frame 24)" or "from ... to ...". */
typedef struct zt_advice_words {
    char text[160];
} zt_advice_words;
zt_advice_words zt_advice_when(const zt_film *film, zt_advice_span span);

/* What a thing is called, and where it stands, or NULL. */
typedef struct zt_advice_name {
    const char *text;
    const zt_place *place;
} zt_advice_name;
zt_advice_name zt_advice_name_of(const zt_animation *animation, zt_owner owner, int32_t index);
zt_advice_name zt_advice_name_of_object(const zt_animation *animation, int32_t object);

/* ---- the advice itself: what looks at scenes fails as freezing does -------------------------
 */

void zt_advice_curves(const zt_animation *animation, zt_listener listener);
zt_status zt_advice_camera(const zt_animation *animation, zt_listener listener);
zt_status zt_advice_lamps(const zt_animation *animation, zt_listener listener);
zt_status zt_advice_shapes(const zt_animation *animation, zt_listener listener);

#endif
