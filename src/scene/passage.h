/* The passage from one frame to the next: where what is seen in one will be in the other. */
#ifndef ZT_SCENE_PASSAGE_H
#define ZT_SCENE_PASSAGE_H

#include <zoetrope/status.h>

#include "base/arena.h"
#include "scene/scene.h"

/* Two scenes of one film, and for each object the ways to and from the space that its numbers
 * are given in. Space is relative to `origin`. Arrays belong to the arena that they were made
 * in. */
typedef struct zt_passage {
    const zt_scene *now, *next;
    vec3 origin;
    const xform *back, *forth; /* to that space now, and from there at the next frame */
    const bool *stays;         /* whether nothing of the object differs */
} zt_passage;

/* ZT_EMEMORY. */
zt_status zt_passage_prepare(zt_passage *passage, const zt_scene *now, const zt_scene *next,
                             vec3 origin, zt_arena *arena);

/* Where a point on an object goes. It is taken along by groups, and by the object's own
 * numbers: it keeps its share of the way along and around it, of its radius, and of its tube's;
 * what is round does not turn around its own axis, which takes the shortest turn. Not finite
 * where the object has no size at one of the two. */
vec3 zt_passage_carry(const zt_passage *passage, int32_t object, vec3 point);

#endif
