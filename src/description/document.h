/* The text of a description as nodes. The door to libyaml. */
#ifndef ZT_DESCRIPTION_DOCUMENT_H
#define ZT_DESCRIPTION_DOCUMENT_H

#include "base/arena.h"
#include "description/mistakes.h"
#include "description/node.h"

/* A text that may hold a description, and what it is called in messages. */
typedef struct zt_source {
    const char *file;
    const char *text; /* terminated */
    size_t size;      /* bytes */
    size_t first;     /* of them are no YAML, and only shown */
} zt_source;

/* Reads the file at `path`. Its text and its name go to the arena: places point to both.
 * ZT_EFILE when it cannot be read, which is told; ZT_EDESCRIPTION when it is too large. */
zt_status zt_source_read(zt_source *source, zt_arena *arena, const char *path,
                         zt_mistakes *mistakes);

/* Reads YAML 1.1 or 1.2 in UTF-8: one document of mappings, lists and texts, with anchors,
 * aliases and merge keys ("<<"). Whatever the text holds, time and memory stay within a small
 * multiple of its size, and that is bounded. `root` becomes the node around all others, in the
 * arena, or NULL where nothing is written. ZT_EDESCRIPTION when there is nothing to go on with,
 * which is told. Smaller mistakes are told and counted, and reading goes on. */
zt_status zt_document_read(const zt_node **root, zt_arena *arena, const zt_source *source,
                           zt_mistakes *mistakes);

#endif
