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
    *length = 0;
    do {
        if (capacity - *length < 2) {
            capacity = capacity ? 2 * capacity : 1 << 16;
            char *larger = capacity <= size_max ? realloc(text, capacity) : NULL;
            if (!larger) {
                free(text);
                errno = capacity <= size_max ? ENOMEM : EFBIG;
                return NULL;
            }
            text = larger;
        }
        *length += fread(text + *length, 1, capacity - *length - 1, file);
    } while (!feof(file) && !ferror(file));
    text[*length] = '\0';
    if (!ferror(file)) return text;
    free(text);
    return NULL;
}

/* Takes what has been read as the text, of the reader to free. */
static zt_status begin_with(zt_json *json, char *text, size_t length) {
    json->at = json->taken = json->text = text;
    if (strlen(text) == length) return ZT_OK;
    zt_tell(json->listener, ZT_ERROR, "cannot read %s: it is no text", json->path);
    zt_json_close(json);
    return ZT_EFILE;
}

zt_status zt_json_open(zt_json *json, const char *path, zt_listener listener) {
    *json = (zt_json){.path = path, .listener = listener};
    FILE *file = fopen(path, "rb");
    size_t length = 0;
    char *text = file ? read_stream(file, &length) : NULL;
    if (!text) zt_tell(listener, ZT_ERROR, "cannot read %s: %s", path, strerror(errno));
    if (file) fclose(file);
    return text ? begin_with(json, text, length) : ZT_EFILE;
}

zt_status zt_json_open_text(zt_json *json, const char *text, const char *path,
                            zt_listener listener) {
    *json = (zt_json){.path = path, .listener = listener};
    char *copy = strdup(text);
    return copy ? begin_with(json, copy, strlen(copy)) : ZT_EMEMORY;
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
    zt_place place = {
        .file = json->path, .source_line = line, .line = json->lines_before + 1, .length = 1};
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

/* Four hexadecimal digits; -1 where there are none. */
static long read_hex(const char *text) {
    if (strspn(text, "0123456789abcdefABCDEF") < 4) return -1;
    char digits[5] = {text[0], text[1], text[2], text[3], '\0'};
    return strtol(digits, NULL, 16);
}

/* The letter behind "\\u", of which there are two beyond 16 bits (UTF-16); moves to its last
 * digit. False where it is none. */
static bool read_letter(unsigned long *letter, zt_json *json) {
    long code = read_hex(json->at + 1), low = -1;
    if (code < 1 || (code & 0xFC00) == 0xDC00) return false;
    json->at += 4;
    *letter = (unsigned long)code;
    if ((code & 0xFC00) != 0xD800) return true;
    if (json->at[1] == '\\' && json->at[2] == 'u') low = read_hex(json->at + 3);
    if ((low & ~0x3FFL) != 0xDC00) return false;
    json->at += 6;
    *letter = 0x10000 + (((unsigned long)code & 0x3FF) << 10) + ((unsigned long)low & 0x3FF);
    return true;
}

/* A letter in UTF-8, of 1 to 4 bytes; returns how many. */
static int put_letter(char bytes[4], unsigned long letter) {
    static const unsigned char leads[] = {0, 0xC0, 0xE0, 0xF0};
    int more = letter < 0x80 ? 0 : letter < 0x800 ? 1 : letter < 0x10000 ? 2 : 3;
    for (int i = more; i > 0; i--, letter >>= 6) bytes[i] = (char)(0x80 | (letter & 0x3F));
    bytes[0] = (char)(leads[more] | letter);
    return more + 1;
}

/* The letter that stands next, moved to its last byte. */
static bool take_letter(char bytes[4], int *count, zt_json *json) {
    static const char escapes[] = "bfnrt", meant[] = "\b\f\n\r\t";
    unsigned long letter;
    *count = 1;
    bytes[0] = *json->at;
    if (*json->at != '\\') return (unsigned char)*json->at >= 32;
    const char *escape = strchr(escapes, bytes[0] = *++json->at);
    if (!*json->at) return false;
    if (escape) bytes[0] = meant[escape - escapes]; /* all others are themselves, but "u" */
    if (*json->at != 'u') return true;
    if (!read_letter(&letter, json)) return false;
    *count = put_letter(bytes, letter);
    return true;
}

zt_status zt_json_text(zt_json *json, char *text, size_t size) {
    size_t length = 0;
    if (*begin(json) != '"') return zt_json_refuse(json, "here must be a text in quotes");
    for (json->at++; *json->at != '"'; json->at++) {
        char bytes[4];
        int count;
        if (!take_letter(bytes, &count, json))
            return zt_json_refuse(json, "this text has no end on its line, or no letter behind "
                                        "a backslash");
        for (int i = 0; i < count; i++)
            if (text && length + 1 < size) text[length++] = bytes[i];
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

/* ---- writing -------------------------------------------------------------------------------
 */

/* The letter that a text in UTF-8 begins with, moved behind it; a byte that is no such text is
 * taken for a letter of Latin-1. */
static unsigned long next_letter(const unsigned char **text) {
    const unsigned char *t = *text;
    int more = t[0] >= 0xF0 ? 3 : t[0] >= 0xE0 ? 2 : t[0] >= 0xC2 ? 1 : 0;
    unsigned long letter = more ? t[0] & (0x3FU >> more) : t[0];
    for (int i = 1; i <= more; i++) {
        if ((t[i] & 0xC0) != 0x80) more = 0;
        letter = more ? letter << 6 | (t[i] & 0x3F) : t[0];
    }
    if (letter > 0x10FFFF || (letter & ~0x7FFUL) == 0xD800) {
        more = 0;
        letter = t[0];
    }
    *text = t + more + 1;
    return letter;
}

void zt_json_print_text(FILE *file, const char *text) {
    putc('"', file);
    for (const unsigned char *t = (const unsigned char *)text; *t;) {
        unsigned long letter = next_letter(&t);
        if (letter == '"' || letter == '\\')
            fprintf(file, "\\%c", (int)letter);
        else if (letter >= 32 && letter < 127)
            putc((int)letter, file);
        else if (letter < 0x10000)
            fprintf(file, "\\u%04lx", letter);
        else
            fprintf(file, "\\u%04lx\\u%04lx", 0xD800 + ((letter - 0x10000) >> 10),
                    0xDC00 + ((letter - 0x10000) & 0x3FF));
    }
    putc('"', file);
}

void zt_json_print_number(FILE *file, double number) {
    char text[32];
    int digits = 3;
    do snprintf(text, sizeof text, "%.*g", digits, number);
    while (digits++ < 17 && strtod(text, NULL) != number);
    fputs(text, file);
}
