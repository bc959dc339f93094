/* The text of a description as nodes. The door to libyaml. */
#ifndef ZT_DESCRIPTION_DOCUMENT_H
#define ZT_DESCRIPTION_DOCUMENT_H

#include "base/arena.h"
#include "description/mistakes.h"
#include "description/node.h"

/* Owns its nodes and the text of the file; places point to that and to the path, which stays
 * the caller's. */
typedef struct zt_document {
    zt_arena arena;
    char *text;
    const zt_node *root;
} zt_document;

/* Reads a YAML 1.1 or 1.2 file in UTF-8: one document of mappings, lists and texts, with
 * anchors, aliases and merge keys ("<<"). Whatever the file holds, time and memory stay within
 * a small multiple of its size, and that is bounded. ZT_EFILE when it cannot be read;
 * ZT_EDESCRIPTION when there is nothing to go on with, both told. Smaller mistakes are told and
 * counted, and reading goes on. The caller frees the document in every case. */
zt_status zt_document_read(zt_document *document, const char *path, zt_mistakes *mistakes);
void zt_document_free(zt_document *document);

#endif
