/* The header of a PLY file: lines of words up to "end_header". Blanks around words, blank lines
 * and comments are free; lines end in LF, CR LF or CR. */
#include "description/ply_header.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/text.h"

enum { WORDS_MAX = 6, WORD_LENGTH_MAX = 1 << 20, SHOWN_MAX = 32 };

static const struct {
    const char *names[2];
    int size;
} types[] = {
    [ZT_PLY_INT8] = {{"char", "int8"}, 1},      [ZT_PLY_UINT8] = {{"uchar", "uint8"}, 1},
    [ZT_PLY_INT16] = {{"short", "int16"}, 2},   [ZT_PLY_UINT16] = {{"ushort", "uint16"}, 2},
    [ZT_PLY_INT32] = {{"int", "int32"}, 4},     [ZT_PLY_UINT32] = {{"uint", "uint32"}, 4},
    [ZT_PLY_FLOAT] = {{"float", "float32"}, 4}, [ZT_PLY_DOUBLE] = {{"double", "float64"}, 8},
};
enum { TYPE_COUNT = sizeof types / sizeof types[0] };

int zt_ply_type_size(zt_ply_type type) { return types[type].size; }

static zt_place place_of(const zt_ply_source *source, const char *at, size_t length) {
    zt_place place = {.file = source->path, .line = 1, .column = 1, .length = (int)length};
    place.source_line = source->bytes;
    for (const char *c = source->bytes; c < at; c++)
        if (*c == source->newline) {
            place.line++;
            place.source_line = c + 1;
        }
    for (const char *c = place.source_line; c < at; c++)
        if (((unsigned char)*c & 0xC0) != 0x80) place.column++; /* a UTF-8 letter begins */
    return place;
}

zt_status zt_ply_refuse(const zt_ply_source *source, const char *at, size_t length,
                        const char *format, ...) {
    char text[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    zt_place place = at ? place_of(source, at, length) : (zt_place){.file = source->path};
    zt_tell_at(source->listener, ZT_ERROR, &place, "%s", text);
    return ZT_EDESCRIPTION;
}

typedef struct word {
    const char *at;
    int length;
} word;

/* What messages show of a word, for "%.*s". */
#define SHOWN(word) (word).length < SHOWN_MAX ? (word).length : SHOWN_MAX, (word).at

typedef struct line {
    const char *next; /* the line behind it */
    int count;        /* WORDS_MAX for as many or more */
    word words[WORDS_MAX];
} line;

/* What is known while the lines go by. */
typedef struct parser {
    const zt_ply_source *source;
    zt_arena *scratch;
    zt_ply_header *header;
    bool has_format;
    zt_ply_element *element; /* the one whose properties are being named, or NULL */
    zt_ply_element **next_element;
    zt_ply_property **next_property;
} parser;

static bool is_word(word w, const char *text) {
    return strlen(text) == (size_t)w.length && memcmp(w.at, text, (size_t)w.length) == 0;
}

static line read_line(const zt_ply_source *source, const char *at) {
    line l = {0};
    const char *end = memchr(at, source->newline, (size_t)(source->end - at));
    l.next = end ? end + 1 : source->end;
    if (!end) end = source->end;
    while (l.count < WORDS_MAX) {
        while (at < end && (unsigned char)*at <= ' ') at++;
        const char *begin = at;
        while (at < end && (unsigned char)*at > ' ') at++;
        if (at == begin) break;
        int length = at - begin < WORD_LENGTH_MAX ? (int)(at - begin) : WORD_LENGTH_MAX;
        l.words[l.count++] = (word){begin, length};
    }
    return l;
}

static zt_status refuse_word(const parser *p, word w, const char *text) {
    return zt_ply_refuse(p->source, w.at, (size_t)w.length, "\"%.*s\" %s", SHOWN(w), text);
}

static zt_status expect_words(const parser *p, const line *l, int count, const char *form) {
    if (l->count == count) return ZT_OK;
    word w = l->words[l->count > count ? count : 0];
    return zt_ply_refuse(p->source, w.at, (size_t)w.length,
                         l->count > count
                             ? "\"%.*s\" is too much: the line should read \"%s\""
                             : "\"%.*s\" lacks something: the line should read \"%s\"",
                         SHOWN(w), form);
}

static zt_status read_format(parser *p, const line *l) {
    static const char *const formats[] = {[ZT_PLY_ASCII] = "ascii",
                                          [ZT_PLY_LITTLE_ENDIAN] = "binary_little_endian",
                                          [ZT_PLY_BIG_ENDIAN] = "binary_big_endian"};
    ZT_TRY(expect_words(p, l, 3, "format FORMAT 1.0"));
    if (p->has_format) return refuse_word(p, l->words[0], "stands here for the second time");
    if (!is_word(l->words[2], "1.0"))
        return refuse_word(p, l->words[2], "is no known version; there is only 1.0");
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++)
        if (is_word(l->words[1], formats[i])) {
            p->header->format = (zt_ply_format)i;
            p->has_format = true;
            return ZT_OK;
        }
    return refuse_word(p, l->words[1],
                       "is none of ascii, binary_little_endian and binary_big_endian");
}

static zt_status read_element(parser *p, const line *l) {
    ZT_TRY(expect_words(p, l, 3, "element NAME COUNT"));
    if (!p->has_format) return refuse_word(p, l->words[0], "stands before any \"format\" line");
    word name = l->words[1], count_word = l->words[2];
    double count;
    if (!zt_text_number(&count, count_word.at, count_word.at + count_word.length) ||
        !(count >= 0 && count <= INT32_MAX) || count != (int32_t)count)
        return refuse_word(p, count_word, "is no whole number from 0 to 2147483647");
    zt_ply_element *element = ZT_PUSH(p->scratch, zt_ply_element, 1);
    if (!element) return ZT_EMEMORY;
    element->at = name.at;
    element->name_length = name.length < SHOWN_MAX ? name.length : SHOWN_MAX;
    element->count = (int32_t)count;
    zt_ply_header *header = p->header;
    zt_ply_element **slot = is_word(name, "vertex")      ? &header->vertex
                            : is_word(name, "face")      ? &header->face
                            : is_word(name, "tristrips") ? &header->strips
                                                         : NULL;
    if (slot && *slot) return refuse_word(p, name, "stands here for the second time");
    if (slot) *slot = element;
    p->element = *p->next_element = element;
    p->next_element = &element->next;
    p->next_property = &element->properties;
    return ZT_OK;
}

static zt_status read_type(const parser *p, zt_ply_type *type, word w) {
    char wanted[SHOWN_MAX + 1];
    snprintf(wanted, sizeof wanted, "%.*s", w.length, w.at);
    zt_nearest nearest = zt_nearest_to(wanted);
    for (int i = 0; i < 2 * TYPE_COUNT; i++) {
        const char *name = types[i / 2].names[i % 2];
        *type = (zt_ply_type)(i / 2);
        if (is_word(w, name)) return ZT_OK;
        zt_nearest_try(&nearest, name);
    }
    return zt_ply_refuse(p->source, w.at, (size_t)w.length, "unknown type \"%.*s\"%s%s%s",
                         SHOWN(w), nearest.best ? "; did you mean \"" : "",
                         nearest.best ? nearest.best : "", nearest.best ? "\"?" : "");
}

/* What a color in other types means, nobody knows. */
static bool is_color_type(zt_ply_type type) {
    return type == ZT_PLY_UINT8 || type == ZT_PLY_UINT16 || type >= ZT_PLY_FLOAT;
}

static zt_ply_role role_of(const parser *p, const zt_ply_property *property, word name) {
    static const char *const names[ZT_PLY_VERTEX_ROLES] = {"x",  "y",   "z",     "nx",  "ny",
                                                           "nz", "red", "green", "blue"};
    if (p->element == p->header->vertex && !property->is_list)
        for (int role = 0; role < ZT_PLY_VERTEX_ROLES; role++)
            if ((role < ZT_PLY_RED || is_color_type(property->type)) &&
                is_word(name, names[role]))
                return (zt_ply_role)role;
    if ((p->element == p->header->face || p->element == p->header->strips) &&
        property->is_list && property->type < ZT_PLY_FLOAT &&
        (is_word(name, "vertex_indices") || is_word(name, "vertex_index")))
        return ZT_PLY_CORNERS;
    return ZT_PLY_SKIPPED;
}

static zt_status read_property(parser *p, const line *l) {
    bool is_list = l->count > 1 && is_word(l->words[1], "list");
    ZT_TRY(is_list ? expect_words(p, l, 5, "property list COUNT_TYPE TYPE NAME")
                   : expect_words(p, l, 3, "property TYPE NAME"));
    zt_ply_element *element = p->element;
    if (!element) return refuse_word(p, l->words[0], "stands before any element");
    zt_ply_property *property = ZT_PUSH(p->scratch, zt_ply_property, 1);
    if (!property) return ZT_EMEMORY;
    property->is_list = is_list;
    ZT_TRY(read_type(p, &property->type, l->words[l->count - 2]));
    if (is_list) ZT_TRY(read_type(p, &property->count_type, l->words[2]));
    if (property->count_type >= ZT_PLY_FLOAT)
        return refuse_word(p, l->words[2], "cannot count a list: that takes an integer type");
    word name = l->words[l->count - 1];
    property->role = role_of(p, property, name);
    unsigned role = 1u << property->role;
    if (property->role != ZT_PLY_SKIPPED && element->roles & role)
        return refuse_word(p, name, "stands here for the second time");
    element->roles |= role;
    element->has_list |= is_list;
    element->row_bytes += p->header->format == ZT_PLY_ASCII /* a letter and a blank */
                              ? 2
                              : types[is_list ? property->count_type : property->type].size;
    *p->next_property = property;
    p->next_property = &property->next;
    return ZT_OK;
}

static zt_status read_lines(parser *p, const char *at) {
    static const struct {
        const char *name;
        zt_status (*read)(parser *, const line *);
    } kinds[] = {
        {"format", read_format}, {"element", read_element}, {"property", read_property}};
    const zt_ply_source *source = p->source;
    while (at < source->end) {
        line l = read_line(source, at);
        at = p->header->data = l.next;
        word first = l.words[0];
        if (l.count == 0 || is_word(first, "comment") || is_word(first, "obj_info")) continue;
        if (is_word(first, "end_header")) return expect_words(p, &l, 1, "end_header");
        size_t kind = 0, kind_count = sizeof kinds / sizeof kinds[0];
        while (kind < kind_count && !is_word(first, kinds[kind].name)) kind++;
        if (kind < kind_count) ZT_TRY(kinds[kind].read(p, &l));
        /* Old exporters wrote their own name below the format. */
        else if (p->element || !p->has_format)
            return refuse_word(p, first, "begins no line of a PLY header");
    }
    return zt_ply_refuse(source, NULL, 0,
                         "the header does not end: there is no \"end_header\"");
}

/* Is there all that makes a mesh? */
static zt_status check_elements(const parser *p) {
    const zt_ply_source *source = p->source;
    const zt_ply_element *vertex = p->header->vertex, *face = p->header->face,
                         *strips = p->header->strips;
    if (!vertex) return zt_ply_refuse(source, NULL, 0, "there is no element \"vertex\"");
    for (int axis = ZT_PLY_X; axis <= ZT_PLY_Z; axis++)
        if (!(vertex->roles & 1u << axis))
            return zt_ply_refuse(source, vertex->at, (size_t)vertex->name_length,
                                 "vertices have no property \"%c\"", "xyz"[axis]);
    if (vertex->count == 0)
        return zt_ply_refuse(source, vertex->at, (size_t)vertex->name_length,
                             "there are no vertices");
    if ((!face || face->count == 0) && (!strips || strips->count == 0))
        return zt_ply_refuse(source, NULL, 0,
                             "there are %d points but no faces: nothing that could be rendered",
                             vertex->count);
    const zt_ply_element *with_corners[] = {face, strips};
    for (int i = 0; i < 2; i++)
        if (with_corners[i] && with_corners[i]->count > 0 &&
            !(with_corners[i]->roles & 1u << ZT_PLY_CORNERS))
            return zt_ply_refuse(source, with_corners[i]->at,
                                 (size_t)with_corners[i]->name_length,
                                 "%.*s has no list \"vertex_indices\" of integers",
                                 with_corners[i]->name_length, with_corners[i]->at);
    return ZT_OK;
}

/* Can the bytes behind the header hold what it promises? */
static zt_status check_sizes(const parser *p) {
    int64_t left = p->source->end - p->header->data;
    if (p->header->format == ZT_PLY_ASCII) left++; /* no blank behind the last number */
    for (const zt_ply_element *e = p->header->elements; e; e = e->next) {
        if (e->row_bytes > 0 && e->count > left / e->row_bytes)
            return zt_ply_refuse(p->source, e->at, (size_t)e->name_length,
                                 "the file is too short for %d of these", e->count);
        left -= e->count * e->row_bytes;
    }
    return ZT_OK;
}

zt_status zt_ply_header_read(zt_ply_header *header, zt_arena *scratch, zt_ply_source *source) {
    *header = (zt_ply_header){0};
    parser p = {.source = source,
                .scratch = scratch,
                .header = header,
                .next_element = &header->elements};
    const char *first_end = source->bytes;
    while (first_end < source->end && *first_end != '\n' && *first_end != '\r') first_end++;
    /* first_end[1] is there: at worst it is the '\0' behind the bytes. */
    source->newline = *first_end == '\r' && first_end[1] != '\n' ? '\r' : '\n';
    line first = read_line(source, source->bytes);
    if (first.count != 1 || !is_word(first.words[0], "ply"))
        return zt_ply_refuse(source, NULL, 0, "no PLY file: the first line is not \"ply\"");
    ZT_TRY(read_lines(&p, first.next));
    ZT_TRY(check_elements(&p));
    return check_sizes(&p);
}
