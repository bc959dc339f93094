#include "description/document.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <yaml.h>

#include "description/nodes.h"

enum { FILE_SIZE_MAX = 256 << 20, READ_SIZE_MIN = 64 * 1024 };

typedef struct source {
    zt_document *document;
    zt_mistakes *mistakes;
    const char *path;
    const char *text;       /* of the document, behind its byte order mark */
    const char *line_start; /* of line number `line`, the last one asked for */
    size_t line;            /* from 0 */
} source;

/* ---- the file -------------------------------------------------------------------------------
 */

static zt_status read_bytes(source *s, FILE *file, size_t *size) {
    size_t capacity = READ_SIZE_MIN, got = 0;
    *size = 0;
    do {
        *size += got;
        if (*size > FILE_SIZE_MAX) {
            zt_mistake(s->mistakes, &(zt_place){.file = s->path},
                       "the description is larger than %d MiB", FILE_SIZE_MAX >> 20);
            return ZT_EDESCRIPTION;
        }
        if (*size + 1 == capacity) capacity *= 2;
        char *grown = realloc(s->document->text, capacity);
        if (!grown) return ZT_EMEMORY;
        s->document->text = grown;
        got = fread(grown + *size, 1, capacity - *size - 1, file);
    } while (got > 0);
    s->document->text[*size] = '\0';
    return ferror(file) ? ZT_EFILE : ZT_OK;
}

static zt_status read_file(source *s, size_t *size) {
    FILE *file = fopen(s->path, "rb");
    zt_status status = file ? read_bytes(s, file, size) : ZT_EFILE;
    if (status == ZT_EFILE)
        zt_tell_at(s->mistakes->listener, ZT_ERROR, &(zt_place){.file = s->path},
                   "the description cannot be read: %s", strerror(errno));
    if (file) fclose(file);
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

/* libyaml's marks count from 0, in characters, and rise from event to event. */
static zt_place place_at(source *s, size_t line, size_t column) {
    if (line < s->line) {
        s->line = 0;
        s->line_start = s->text;
    }
    for (const char *next; s->line < line && (next = next_line(s->line_start)); s->line++)
        s->line_start = next;
    return (zt_place){.file = s->path,
                      .source_line = s->line == line ? s->line_start : NULL,
                      .line = (int)line + 1,
                      .column = (int)column + 1,
                      .length = 1};
}

static zt_place event_place(source *s, const yaml_event_t *event) {
    yaml_mark_t start = event->start_mark, end = event->end_mark;
    zt_place place = place_at(s, start.line, start.column);
    if (end.line == start.line) place.length = (int)(end.column - start.column);
    return place;
}

/* Where a byte stands that libyaml cannot take for a character. */
static zt_place byte_place(source *s, size_t offset) {
    const char *byte = s->text + offset, *start = s->text;
    size_t line = 0, column = 0;
    for (const char *next; (next = next_line(start)) && next <= byte; line++) start = next;
    for (const char *c = start; c < byte; c++) column += ((unsigned char)*c & 0xC0) != 0x80;
    return place_at(s, line, column);
}

/* ---- the events -----------------------------------------------------------------------------
 */

static zt_status take_event(source *s, zt_nodes *nodes, const yaml_event_t *event) {
    zt_place place = event_place(s, event);
    zt_node_marks marks = {0};
    switch (event->type) {
    case YAML_DOCUMENT_START_EVENT:
        if (!zt_nodes_root(nodes)) return ZT_OK;
        zt_mistake(s->mistakes, &place, "a second document begins here; a file holds one");
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
        return zt_nodes_end(nodes, (int)event->end_mark.line + 1,
                            (int)event->end_mark.column + 1);
    default:
        return ZT_OK;
    }
}

/* Why libyaml could not go on. */
static zt_status tell_yaml_error(source *s, const yaml_parser_t *yaml) {
    if (yaml->error == YAML_MEMORY_ERROR) return ZT_EMEMORY;
    bool unreadable = yaml->error == YAML_READER_ERROR;
    zt_place place = unreadable
                         ? byte_place(s, yaml->problem_offset)
                         : place_at(s, yaml->problem_mark.line, yaml->problem_mark.column);
    zt_mistake(s->mistakes, &place, "this is not YAML%s: %s", unreadable ? " in UTF-8" : "",
               yaml->problem ? yaml->problem : "unknown error");
    bool elsewhere = yaml->context_mark.index != yaml->problem_mark.index;
    if (yaml->context && elsewhere && !unreadable) {
        place = place_at(s, yaml->context_mark.line, yaml->context_mark.column);
        zt_mistake_note(s->mistakes, &place, "%s that begins here", yaml->context);
    }
    return ZT_EDESCRIPTION;
}

static zt_status take_events(source *s, zt_nodes *nodes, yaml_parser_t *yaml) {
    for (yaml_event_type_t type = YAML_NO_EVENT; type != YAML_STREAM_END_EVENT;) {
        yaml_event_t event;
        if (!yaml_parser_parse(yaml, &event)) return tell_yaml_error(s, yaml);
        type = event.type;
        zt_status status = take_event(s, nodes, &event);
        yaml_event_delete(&event);
        ZT_TRY(status);
    }
    s->document->root = zt_nodes_root(nodes);
    if (s->document->root) return ZT_OK;
    zt_mistake(s->mistakes, &(zt_place){.file = s->path}, "the description is empty");
    return ZT_EDESCRIPTION;
}

static zt_status parse(source *s, size_t size) {
    static const char byte_order_mark[] = "\xEF\xBB\xBF";
    bool marked = strncmp(s->document->text, byte_order_mark, sizeof byte_order_mark - 1) == 0;
    s->text = s->line_start = s->document->text + (marked ? sizeof byte_order_mark - 1 : 0);
    size -= (size_t)(s->text - s->document->text);
    yaml_parser_t yaml;
    zt_nodes *nodes;
    ZT_TRY(zt_nodes_create(&nodes, &s->document->arena, s->mistakes));
    zt_status status = ZT_EMEMORY;
    if (yaml_parser_initialize(&yaml)) {
        yaml_parser_set_encoding(&yaml, YAML_UTF8_ENCODING);
        yaml_parser_set_input_string(&yaml, (const unsigned char *)s->text, size);
        status = take_events(s, nodes, &yaml);
        yaml_parser_delete(&yaml);
    }
    zt_nodes_free(&nodes);
    return status;
}

zt_status zt_document_read(zt_document *document, const char *path, zt_mistakes *mistakes) {
    *document = (zt_document){0};
    source s = {.document = document, .mistakes = mistakes, .path = path};
    size_t size;
    ZT_TRY(read_file(&s, &size));
    return parse(&s, size);
}

void zt_document_free(zt_document *document) {
    zt_arena_free(&document->arena);
    free(document->text);
    *document = (zt_document){0};
}
