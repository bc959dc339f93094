/* Pairs: things of two animations that are the same one to a person, and how they differ. */
#ifndef ZT_SEQUENCE_PAIRS_H
#define ZT_SEQUENCE_PAIRS_H

#include "base/arena.h"
#include "keyframe/animation.h"

/* Ways in which a pair differs, a bit for each: the rows that its owner has in the property
 * table, in their order, and then these. */
enum {
    ZT_WAY_MATERIAL = 24, /* of an object: which one it has */
    ZT_WAY_GROUP,         /* which one it is in */
    ZT_WAY_FILE,          /* what a mesh's file holds */
    ZT_WAY_PATTERN,
    ZT_WAY_LENS,
    ZT_WAY_BLADES,
    ZT_WAY_ALONE, /* only one of the two is there */
    ZT_WAY_ORDER, /* how many of its kind come before it */
    ZT_WAY_COUNT
};

typedef struct zt_pair {
    const zt_thing *older, *newer; /* one of them may be NULL */
    bool other_model;              /* of meshes: their files do not hold the same */
} zt_pair;

typedef struct zt_pairs {
    const zt_animation *older, *newer;
    zt_pair *all;
    int32_t count;
    /* Which pair a material or an object belongs to. */
    const int32_t *older_materials, *newer_materials, *older_objects, *newer_objects;
} zt_pairs;

/* Things of one kind and name are a pair; those that are left, of one kind and number are: they
 * were renamed. All is in the arena. ZT_EMEMORY. */
zt_status zt_pairs_make(zt_pairs *pairs, const zt_animation *older, const zt_animation *newer,
                        zt_arena *arena);

/* Adds to `ways`, for each pair, in what it differs at one moment. */
void zt_pairs_compare(uint32_t *ways, const zt_pairs *pairs, const zt_scene *older,
                      const zt_scene *newer);

/* What a person calls such a way: "ball.center", "lamp (new)"; NULL when out of memory. */
const char *zt_pairs_name(const zt_pairs *pairs, int32_t pair, int way, zt_arena *arena);

#endif
