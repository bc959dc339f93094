#include "base/diag.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    TEXT_MAX = 6 * 1024, /* bytes: the longest path and a sentence around it */
    LINE_SHOWN = 120     /* characters of a long source line */
};

const char *zt_status_text(zt_status status) {
    switch (status) {
    case ZT_OK:
        return "done";
    case ZT_EDESCRIPTION:
        return "the description has mistakes";
    case ZT_EARGUMENT:
        return "wrong use";
    case ZT_EMEMORY:
        return "out of memory";
    case ZT_EFILE:
        return "a file could not be read or written";
    case ZT_EUNSUPPORTED:
        return "not supported";
    case ZT_ESTOPPED:
        return "stopped";
    }
    return "unknown status";
}

static void tell(zt_listener listener, zt_severity severity, const zt_place *place,
                 const char *format, va_list arguments) {
    if (!listener.tell) return;
    char text[TEXT_MAX];
    vsnprintf(text, sizeof text, format, arguments);
    zt_message message = {.severity = severity, .text = text};
    char *line = NULL;
    if (place) {
        message.file = place->file;
        message.line = place->line;
        message.column = place->column;
        message.length = place->length > 0 ? place->length : 1;
        /* Without the memory for its line, a message is still told. */
        if (place->source_line)
            line = strndup(place->source_line, strcspn(place->source_line, "\r\n"));
        message.source_line = line;
    }
    listener.tell(listener.user, &message);
    free(line);
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

/* Where the text is after `count` more of its UTF-8 characters, or at its end. */
static const char *skip_characters(const char *text, int count) {
    for (; count > 0 && *text; count--) {
        text++;
        while (((unsigned char)*text & 0xC0) == 0x80) text++;
    }
    return text;
}

/* The line of blanks, caret and tildes below a source line, `column` counted from 0. Tabs stay
 * tabs, so that the caret stands below its character whatever the width of a tab. */
static void mark(char marks[LINE_SHOWN + 1], const char *source, int column, int length) {
    int used = 0;
    for (; used < column && used < LINE_SHOWN - 1; used++) {
        marks[used] = *source == '\t' ? '\t' : ' ';
        source = skip_characters(source, 1);
    }
    marks[used++] = '^';
    source = skip_characters(source, 1);
    for (int i = 1; i < length && used < LINE_SHOWN && *source; i++) {
        marks[used++] = '~'; /* never beyond the end of the line */
        source = skip_characters(source, 1);
    }
    marks[used] = '\0';
}

/* A message with its source line: of a long one, the part around the marked column. */
static int format_with_source(char *buffer, size_t size, const zt_message *message,
                              const char *severity) {
    int column = message->column > 0 ? message->column - 1 : 0;
    int first = column < LINE_SHOWN / 2 ? 0 : column - LINE_SHOWN / 2;
    const char *shown = message->source_line;
    if (skip_characters(shown, LINE_SHOWN)[0] == '\0') first = 0;
    shown = skip_characters(shown, first);
    int shown_length = (int)(skip_characters(shown, LINE_SHOWN) - shown);
    char marks[LINE_SHOWN + 1];
    mark(marks, shown, column - first, message->length);
    int margin = snprintf(NULL, 0, "%5d", message->line);
    return snprintf(buffer, size, "%s:%d:%d: %s: %s\n%*d | %.*s\n%*s | %s", message->file,
                    message->line, message->column, severity, message->text, margin,
                    message->line, shown_length, shown, margin, "", marks);
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
    else
        length = format_with_source(buffer, size, message, severity);
    if (length < 0) length = 0;
    /* What a stranger wrote into a file must not command the terminal. */
    for (size_t i = 0; i < (size_t)length && i + 1 < size; i++)
        if (iscntrl((unsigned char)buffer[i]) && buffer[i] != '\n' && buffer[i] != '\t')
            buffer[i] = '?';
    return (size_t)length;
}
