#include "description/document.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <yaml.h>

#include "description/nodes.h"

enum { FILE_SIZE_MAX = 256 << 20, READ_SIZE_MIN = 64 * 1024 };

/* Where the parser is. */
typedef struct reader {
    const zt_source *source;
    zt_mistakes *mistakes;
    const char *text;       /* the YAML, behind its byte order mark */
    size_t first_column;    /* characters before it in its first line */
    const char *line_start; /* of line number `line`, the last one asked for */
    size_t line;            /* from 0 */
} reader;

/* ---- the file -------------------------------------------------------------------------------
 */

/* All bytes of a file and a '\0', of the caller to free, whatever is returned. */
static zt_status read_bytes(char **bytes, size_t *size, FILE *file, const char *path,
                            zt_mistakes *mistakes) {
    size_t capacity = READ_SIZE_MIN, got = 0;
    *size = 0;
    do {
        *size += got;
        if (*size > FILE_SIZE_MAX) {
            zt_mistake(mistakes, &(zt_place){.file = path},
                       "the description is larger than %d MiB", FILE_SIZE_MAX >> 20);
            return ZT_EDESCRIPTION;
        }
        if (*size + 1 == capacity) capacity *= 2;
        char *grown = realloc(*bytes, capacity);
        if (!grown) return ZT_EMEMORY;
        *bytes = grown;
        got = fread(grown + *size, 1, capacity - *size - 1, file);
    } while (got > 0);
    (*bytes)[*size] = '\0';
    return ferror(file) ? ZT_EFILE : ZT_OK;
}

zt_status zt_source_read(zt_source *source, zt_arena *arena, const char *path,
                         zt_mistakes *mistakes) {
    char *bytes = NULL;
    size_t size = 0;
    FILE *file = fopen(path, "rb");
    zt_status status = file ? read_bytes(&bytes, &size, file, path, mistakes) : ZT_EFILE;
    if (status == ZT_EFILE)
        zt_tell_at(mistakes->listener, ZT_ERROR, &(zt_place){.file = path},
                   "the description cannot be read: %s", strerror(errno));
    if (file) fclose(file);
    if (status == ZT_OK) {
        *source = (zt_source){.file = zt_arena_push_text(arena, path, strlen(path)),
                              .text = zt_arena_push_text(arena, bytes, size),
                              .size = size};
        if (!source->file || !source->text) status = ZT_EMEMORY;
    }
    free(bytes);
    return status;
}

/* ---- places ---------------------------------------------------------------------------------
 */

/* The beginning of the next line, by libyaml's idea of a line's end, which takes the Unicode
 * characters U+0085, U+2028 and U+2029 for one too; NULL in the last line. */
static const char *next_line(const char *text) {
    for (;; text++) {
        text += strcspn(text, "\r\n\xC2\xE2");
        if (!*text) return NULL;
        if (*text == '\r') return text + (text[1] == '\n' ? 2 : 1);
        if (*text == '\n') return text + 1;
        if (strncmp(text, "\xC2\x85", 2) == 0) return text + 2;
        if (strncmp(text, "\xE2\x80\xA8", 3) == 0 || strncmp(text, "\xE2\x80\xA9", 3) == 0)
            return text + 3;
    }
}

static void rewind_to_first_line(reader *r) {
    r->line = 0;
    r->line_start = r->first_column ? r->source->text : r->text;
}

/* libyaml's marks count from 0, in characters, and rise from event to event. */
static zt_place place_at(reader *r, size_t line, size_t column) {
    if (line < r->line) rewind_to_first_line(r);
    if (line == 0) column += r->first_column;
    for (const char *next; r->line < line && (next = next_line(r->line_start)); r->line++)
        r->line_start = next;
    return (zt_place){.file = r->source->file,
                      .source_line = r->line == line ? r->line_start : NULL,
                      .line = (int)line + 1,
                      .column = (int)column + 1,
                      .length = 1};
}

static zt_place event_place(reader *r, const yaml_event_t *event) {
    yaml_mark_t start = event->start_mark, end = event->end_mark;
    zt_place place = place_at(r, start.line, start.column);
    if (end.line == start.line) place.length = (int)(end.column - start.column);
    return place;
}

/* Where a byte stands that libyaml cannot take for a character. */
static zt_place byte_place(reader *r, size_t offset) {
    const char *byte = r->text + offset, *start = r->text;
    size_t line = 0, column = 0;
    for (const char *next; (next = next_line(start)) && next <= byte; line++) start = next;
    for (const char *c = start; c < byte; c++) column += ((unsigned char)*c & 0xC0) != 0x80;
    return place_at(r, line, column);
}

/* ---- the events -----------------------------------------------------------------------------
 */

static zt_status take_event(reader *r, zt_nodes *nodes, const yaml_event_t *event) {
    zt_place place = event_place(r, event);
    zt_node_marks marks = {0};
    switch (event->type) {
    case YAML_DOCUMENT_START_EVENT:
        if (!zt_nodes_root(nodes)) return ZT_OK;
        zt_mistake(r->mistakes, &place, "a second document begins here; a file holds one");
        return ZT_EDESCRIPTION;
    case YAML_SCALAR_EVENT:
        marks.anchor = (const char *)event->data.scalar.anchor;
        marks.tag = (const char *)event->data.scalar.tag;
        return zt_nodes_text(nodes, &place, marks, (const char *)event->data.scalar.value,
                             event->data.scalar.length,
                             event->data.scalar.style != YAML_PLAIN_SCALAR_STYLE);
    case YAML_ALIAS_EVENT:
        return zt_nodes_alias(nodes, &place, (const char *)event->data.alias.anchor);
    case YAML_SEQUENCE_START_EVENT:
        marks.anchor = (const char *)event->data.sequence_start.anchor;
        marks.tag = (const char *)event->data.sequence_start.tag;
        return zt_nodes_begin(nodes, &place, marks, ZT_NODE_LIST);
    case YAML_MAPPING_START_EVENT:
        marks.anchor = (const char *)event->data.mapping_start.anchor;
        marks.tag = (const char *)event->data.mapping_start.tag;
        return zt_nodes_begin(nodes, &place, marks, ZT_NODE_MAPPING);
    case YAML_SEQUENCE_END_EVENT:
    case YAML_MAPPING_END_EVENT:
        place = place_at(r, event->end_mark.line, event->end_mark.column);
        return zt_nodes_end(nodes, place.line, place.column);
    default:
        return ZT_OK;
    }
}

/* Why libyaml could not go on. */
static zt_status tell_yaml_error(reader *r, const yaml_parser_t *yaml) {
    if (yaml->error == YAML_MEMORY_ERROR) return ZT_EMEMORY;
    bool unreadable = yaml->error == YAML_READER_ERROR;
    zt_place place = unreadable
                         ? byte_place(r, yaml->problem_offset)
                         : place_at(r, yaml->problem_mark.line, yaml->problem_mark.column);
    zt_mistake(r->mistakes, &place, "this is not YAML%s: %s", unreadable ? " in UTF-8" : "",
               yaml->problem ? yaml->problem : "unknown error");
    bool elsewhere = yaml->context_mark.index != yaml->problem_mark.index;
    if (yaml->context && elsewhere && !unreadable) {
        place = place_at(r, yaml->context_mark.line, yaml->context_mark.column);
        zt_mistake_note(r->mistakes, &place, "%s that begins here", yaml->context);
    }
    return ZT_EDESCRIPTION;
}

static zt_status take_events(reader *r, zt_nodes *nodes, yaml_parser_t *yaml) {
    for (yaml_event_type_t type = YAML_NO_EVENT; type != YAML_STREAM_END_EVENT;) {
        yaml_event_t event;
        if (!yaml_parser_parse(yaml, &event)) return tell_yaml_error(r, yaml);
        type = event.type;
        zt_status status = take_event(r, nodes, &event);
        yaml_event_delete(&event);
        ZT_TRY(status);
    }
    return ZT_OK;
}

zt_status zt_document_read(const zt_node **root, zt_arena *arena, const zt_source *source,
                           zt_mistakes *mistakes) {
    static const char byte_order_mark[] = "\xEF\xBB\xBF";
    reader r = {.source = source, .mistakes = mistakes, .text = source->text + source->first};
    for (const char *c = source->text; c < r.text; c++)
        r.first_column += ((unsigned char)*c & 0xC0) != 0x80;
    if (strncmp(r.text, byte_order_mark, sizeof byte_order_mark - 1) == 0)
        r.text += sizeof byte_order_mark - 1;
    rewind_to_first_line(&r);
    yaml_parser_t yaml;
    zt_nodes *nodes;
    ZT_TRY(zt_nodes_create(&nodes, arena, mistakes));
    zt_status status = ZT_EMEMORY;
    if (yaml_parser_initialize(&yaml)) {
        yaml_parser_set_encoding(&yaml, YAML_UTF8_ENCODING);
        yaml_parser_set_input_string(&yaml, (const unsigned char *)r.text,
                                     (size_t)(source->text + source->size - r.text));
        status = take_events(&r, nodes, &yaml);
        yaml_parser_delete(&yaml);
    }
    *root = zt_nodes_root(nodes);
    zt_nodes_free(&nodes);
    return status;
}
