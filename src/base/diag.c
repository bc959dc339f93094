#include "base/diag.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { TEXT_MAX = 1024, LINE_MAX_SHOWN = 512 };

const char *zt_status_text(zt_status status) {
    switch (status) {
    case ZT_OK: return "done";
    case ZT_EDESCRIPTION: return "the description has mistakes";
    case ZT_EARGUMENT: return "wrong use";
    case ZT_EMEMORY: return "out of memory";
    case ZT_EFILE: return "a file could not be read or written";
    case ZT_EUNSUPPORTED: return "not supported";
    case ZT_ESTOPPED: return "stopped";
    }
    return "unknown status";
}

static void tell(zt_listener listener, zt_severity severity, const zt_place *place,
                 const char *format, va_list arguments) {
    if (!listener.tell) return;
    char text[TEXT_MAX], line[LINE_MAX_SHOWN];
    vsnprintf(text, sizeof text, format, arguments);
    zt_message message = {.severity = severity, .text = text};
    if (place) {
        message.file = place->file;
        message.line = place->line;
        message.column = place->column;
        message.length = place->length > 0 ? place->length : 1;
        if (place->source_line) {
            int shown = (int)strcspn(place->source_line, "\r\n");
            snprintf(line, sizeof line, "%.*s", shown, place->source_line);
            message.source_line = line;
        }
    }
    listener.tell(listener.user, &message);
}

void zt_tell(zt_listener listener, zt_severity severity, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    tell(listener, severity, NULL, format, arguments);
    va_end(arguments);
}

void zt_tell_at(zt_listener listener, zt_severity severity, const zt_place *place,
                const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    tell(listener, severity, place, format, arguments);
    va_end(arguments);
}

/* The line of blanks, caret and tildes below a source line. Tabs stay tabs, so that the caret
 * stands below its character whatever the width of a tab. */
static void mark(char *line, size_t size, const zt_message *message) {
    size_t used = 0;
    const char *source = message->source_line;
    for (int column = 1; column < message->column && used + 1 < size; column++) {
        line[used++] = *source == '\t' ? '\t' : ' ';
        if (*source) source++;
        while (((unsigned char)*source & 0xC0) == 0x80) source++; /* within a UTF-8 character */
    }
    for (int i = 0; i < message->length && used + 1 < size; i++) {
        if (i > 0 && !*source) break; /* never beyond the end of the line */
        line[used++] = i == 0 ? '^' : '~';
        if (*source) source++;
        while (((unsigned char)*source & 0xC0) == 0x80) source++;
    }
    line[used] = '\0';
}

size_t zt_message_format(char *buffer, size_t size, const zt_message *message) {
    static const char *const severities[] = {"note", "warning", "error"};
    const char *severity = severities[message->severity];
    int length;
    if (!message->file)
        length = snprintf(buffer, size, "zoetrope: %s: %s", severity, message->text);
    else if (message->line <= 0)
        length = snprintf(buffer, size, "%s: %s: %s", message->file, severity, message->text);
    else if (!message->source_line)
        length = snprintf(buffer, size, "%s:%d:%d: %s: %s", message->file, message->line,
                          message->column, severity, message->text);
    else {
        char marks[LINE_MAX_SHOWN];
        mark(marks, sizeof marks, message);
        length = snprintf(buffer, size, "%s:%d:%d: %s: %s\n%5d | %s\n      | %s", message->file,
                          message->line, message->column, severity, message->text,
                          message->line, message->source_line, marks);
    }
    return length > 0 ? (size_t)length : 0;
}
