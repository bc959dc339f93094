/* What a scene asks for, and so what is left out: found once a frame from the exposure alone.
 * Exact: pictures are the same, bit by bit, as if nothing were left out. */
#ifndef ZT_SCENE_NEEDS_H
#define ZT_SCENE_NEEDS_H

#include "base/arena.h"
#include "scene/exposure.h"

typedef struct zt_needs {
    int32_t object_count;                                          /* groups left aside */
    int32_t mesh_count, pattern_count, mirror_count, moving_count; /* of these objects */
    int32_t mirror;       /* the first object that mirrors, or -1 */
    int32_t mirror_depth; /* of how many mirrors, one after the other, light can differ from
                             none: at most the scene's */
    double brightest;     /* no point has more light by itself, in any channel, at any moment */
    int32_t faint_depth;  /* from so many mirrors on light may be too faint to change a sum in
                             single precision; INT32_MAX: never */
    bool camera_moves, has_opening;
    const bool *shines;  /* of each light: it gives any light at some moment */
    const bool *shadows; /* of each light: and casts shadows then */
} zt_needs;

/* Arrays are the arena's. `everything`: as if nothing could be left out. ZT_EMEMORY. */
zt_status zt_needs_find(zt_needs *needs, const zt_exposure *exposure, bool everything,
                        zt_arena *arena);

/* Which lights never reach which objects. To be told; batches find it out for themselves. */
typedef enum zt_reaching {
    ZT_REACHES,       /* or it is not known that it does not */
    ZT_REACHES_AWAY,  /* it shines to its other side */
    ZT_REACHES_BEHIND /* a plane is between them */
} zt_reaching;

/* Of a light and an object at all moments; `plane` becomes the object that is between them.
 * `worlds` are those of zt_scene_worlds as seen from the origin, of one moment after the other.
 */
zt_reaching zt_needs_reaching(int32_t *plane, const zt_exposure *exposure, const xform *worlds,
                              int32_t light, int32_t object);

#endif
