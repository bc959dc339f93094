/* A listener that remembers what it was told, for tests of messages. */
#ifndef ZT_TESTS_TOLD_H
#define ZT_TESTS_TOLD_H

#include <stdio.h>
#include <string.h>

#include <zoetrope/status.h>

typedef struct told {
    char lines[64 * 1024]; /* "12:7: error: text\n", without a place "error: text\n" */
    int error_count, warning_count, note_count;
    const char *file;  /* that every place must be in, or NULL */
    int foreign_count; /* messages about something else */
} told;

static void told_tell(void *user, const zt_message *message) {
    static const char *const severities[] = {"note", "warning", "error"};
    told *t = user;
    int *const counts[] = {&t->note_count, &t->warning_count, &t->error_count};
    ++*counts[message->severity];
    if (t->file && (!message->file || strcmp(message->file, t->file) != 0)) t->foreign_count++;
    size_t used = strlen(t->lines);
    char *end = t->lines + used;
    size_t left = sizeof t->lines - used;
    if (message->line > 0)
        snprintf(end, left, "%d:%d: %s: %s\n", message->line, message->column,
                 severities[message->severity], message->text);
    else
        snprintf(end, left, "%s: %s\n", severities[message->severity], message->text);
}

static inline zt_listener told_to(told *t) { return (zt_listener){told_tell, t}; }

#endif
