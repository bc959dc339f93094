/* A description being read: what its parts share. */
#ifndef ZT_DESCRIPTION_READING_H
#define ZT_DESCRIPTION_READING_H

#include "base/arena.h"
#include "description/fields.h"
#include "description/overrides.h"
#include "description/things.h"
#include "description/ways.h"
#include "keyframe/animation.h"

/* A mapping of names to what they stand for, to be looked up in. */
typedef struct zt_name {
    const char *text;
    int32_t entry;
} zt_name;
typedef struct zt_names {
    const zt_node *mapping; /* NULL where there are none */
    const zt_name *sorted;
} zt_names;

/* The scene's arrays have room for all that the text may hold before the first property is
 * read. */
typedef struct zt_reading {
    zt_mistakes mistakes;
    zt_animation *animation; /* what it becomes; `film` is read before everything else */
    zt_arena *temporary;     /* memory that lives as long as the reading */
    zt_names variables;      /* to values, with no further variables in them */
    zt_names timings;        /* to lists of times */
    zt_names curves;         /* to mappings with keys */
    zt_overrides overrides;
    zt_eases eases;
    int64_t used_key_count; /* keys that were met by "use" */
    zt_things things;
    zt_reference oriented; /* the rotation that the last path with "orient" turns */
    struct zt_track_link *first_track, *last_track;
    struct zt_pending *first_pending, *last_pending; /* constraints whose names are not known */
} zt_reading;

/* `mapping` may be NULL or empty; tells when it is something else. ZT_EMEMORY. */
zt_status zt_names_open(zt_names *names, zt_reading *reading, const zt_node *mapping,
                        const char *what, const char *expected);

/* What a name stands for, or NULL. */
const zt_node *zt_name_find(const zt_names *names, const char *text);

/* What the name that a node holds stands for, or NULL after telling: `what` is "timing". */
const zt_node *zt_named(zt_reading *reading, const zt_names *names, const zt_node *node,
                        const char *what);

/* Replaces every text "$name" below `root`, but for those in quotes, by what "variables" says
 * of it, and keeps these; a variable may use those before it. ZT_EDESCRIPTION when they stand
 * for too much to go on with; ZT_EMEMORY. */
zt_status zt_variables_apply(zt_reading *reading, const zt_node *root);

#endif
