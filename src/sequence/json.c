#include "sequence/json.h"

#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/diag.h"
#include "base/text.h"

static const size_t size_max = (size_t)1 << 30; /* ten times the longest film's */

/* All of a stream, of the caller to free; NULL, with errno, where that fails. */
static char *read_stream(FILE *file, size_t *length) {
    char *text = NULL;
    size_t capacity = 0;
    for (*length = 0; !feof(file);) {
        if (capacity - *length < 2) {
            capacity = capacity ? 2 * capacity : 1 << 16;
            char *larger = capacity <= size_max ? realloc(text, capacity) : NULL;
            if (!larger) {
                errno = capacity <= size_max ? ENOMEM : EFBIG;
                break;
            }
            text = larger;
        }
        *length += fread(text + *length, 1, capacity - *length - 1, file);
        if (ferror(file)) break;
    }
    if (feof(file)) {
        text[*length] = '\0';
        return text;
    }
    free(text);
    return NULL;
}

zt_status zt_json_open(zt_json *json, const char *path, zt_listener listener) {
    *json = (zt_json){.path = path, .listener = listener};
    FILE *file = fopen(path, "rb");
    size_t length = 0;
    if (file) json->text = read_stream(file, &length);
    if (!json->text) zt_tell(listener, ZT_ERROR, "cannot read %s: %s", path, strerror(errno));
    if (file) fclose(file);
    if (!json->text) return ZT_EFILE;
    json->at = json->taken = json->text;
    if (strlen(json->text) == length) return ZT_OK;
    zt_tell(listener, ZT_ERROR, "cannot read %s: it is no text", path);
    zt_json_close(json);
    return ZT_EFILE;
}

void zt_json_close(zt_json *json) {
    free(json->text);
    *json = (zt_json){0};
}

zt_status zt_json_refuse(zt_json *json, const char *format, ...) {
    char text[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    const char *line = json->taken;
    while (line > json->text && line[-1] != '\n') line--;
    zt_place place = {.file = json->path, .source_line = line, .line = 1, .length = 1};
    for (const char *c = json->text; c < line; c++) place.line += *c == '\n';
    place.column = (int)(json->taken - line) + 1;
    zt_tell_at(json->listener, ZT_ERROR, &place, "%s", text);
    return ZT_EFILE;
}

/* The next piece begins here. */
static const char *begin(zt_json *json) {
    json->at += strspn(json->at, " \t\r\n");
    return json->taken = json->at;
}

zt_status zt_json_mark(zt_json *json, char mark) {
    if (*begin(json) != mark) return zt_json_refuse(json, "here must be a %c", mark);
    json->at++;
    return ZT_OK;
}

zt_status zt_json_more(zt_json *json, bool *more, char closing) {
    char mark = *begin(json);
    if (mark != ',' && mark != closing)
        return zt_json_refuse(json, "here must be a comma or a %c", closing);
    json->at++;
    *more = mark == ',';
    return ZT_OK;
}

zt_status zt_json_text(zt_json *json, char *text, size_t size) {
    size_t length = 0;
    if (*begin(json) != '"') return zt_json_refuse(json, "here must be a text in quotes");
    for (json->at++; *json->at != '"'; json->at++) {
        if ((unsigned char)*json->at < 32)
            return zt_json_refuse(json, "this text has no end on its line");
        if (*json->at == '\\' && json->at[1]) json->at++; /* what is quoted is itself */
        if (text && length + 1 < size) text[length++] = *json->at;
    }
    json->at++;
    if (text && size) text[length] = '\0';
    return ZT_OK;
}

zt_status zt_json_key(zt_json *json, int *key, const char *const *names) {
    char text[32];
    ZT_TRY(zt_json_text(json, text, sizeof text));
    zt_nearest nearest = zt_nearest_to(text);
    for (*key = 0; names[*key] && !zt_text_equal(names[*key], text); ++*key)
        zt_nearest_try(&nearest, names[*key]);
    if (!names[*key])
        return nearest.best
                   ? zt_json_refuse(json, "unknown key; did you mean \"%s\"?", nearest.best)
                   : zt_json_refuse(json, "unknown key");
    const char *taken = json->taken;
    ZT_TRY(zt_json_mark(json, ':'));
    json->taken = taken;
    return ZT_OK;
}

zt_status zt_json_number(zt_json *json, double *number, double low, double high) {
    const char *text = begin(json), *end = text + strspn(text, "+-.0123456789eE");
    if (!zt_text_number(number, text, end) || *number < low || *number > high)
        return zt_json_refuse(json, "here must be a number from %g to %g", low, high);
    json->at = end;
    return ZT_OK;
}

zt_status zt_json_integer(zt_json *json, int64_t *number, int64_t low, int64_t high) {
    const char *text = begin(json), *end = text + strspn(text, "0123456789");
    bool good = end > text && end - text <= 18 && !strchr(".eE", *end ? *end : ' ');
    if (good) *number = strtoll(text, NULL, 10);
    if (!good || *number < low || *number > high)
        return zt_json_refuse(json, "here must be a whole number from %" PRId64 " to %" PRId64,
                              low, high);
    json->at = end;
    return ZT_OK;
}

zt_status zt_json_end(zt_json *json) {
    return *begin(json) ? zt_json_refuse(json, "here must be the end") : ZT_OK;
}
