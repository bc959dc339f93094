/* Mistakes in a description: told where they stand and counted, so that one run tells them all.
 */
#ifndef ZT_DESCRIPTION_MISTAKES_H
#define ZT_DESCRIPTION_MISTAKES_H

#include <stdbool.h>
#include <stdint.h>

#include "base/diag.h"
#include "base/hash.h"
#include "base/text.h"

enum { ZT_MISTAKES_TOLD_MAX = 100 };

/* The sentences of one kind that were told. */
typedef struct zt_sentences {
    int64_t untold_count; /* how many more were only counted */
    int count;            /* in `told` */
    zt_hash told[ZT_MISTAKES_TOLD_MAX];
} zt_sentences;

/* Zeroed but for the listener is ready. */
typedef struct zt_mistakes {
    zt_listener listener;
    int64_t count;  /* how often something was wrong */
    bool told_last; /* whether the last one was told, and so its notes */
    zt_sentences mistakes, doubts;
} zt_mistakes;

/* Tells a mistake; after ZT_MISTAKES_TOLD_MAX of them they are only counted. The same sentence
 * about the same place is told once: an alias leads there again and again. */
__attribute__((format(printf, 3, 4))) void
zt_mistake(zt_mistakes *mistakes, const zt_place *place, const char *format, ...);

/* A further place that has to do with the last mistake or doubt; told only if that one was. */
__attribute__((format(printf, 3, 4))) void
zt_mistake_note(zt_mistakes *mistakes, const zt_place *place, const char *format, ...);

/* Warns of what is legal and probably not meant, in the same way. Such notes follow as well. */
__attribute__((format(printf, 3, 4))) void
zt_doubt(zt_mistakes *mistakes, const zt_place *place, const char *format, ...);

/* Whether no further mistake will be told: then it is not worth much work to find its words. */
bool zt_mistakes_full(const zt_mistakes *mistakes);

/* Says how many more there were. ZT_EDESCRIPTION when there was any, else ZT_OK. */
zt_status zt_mistakes_close(const zt_mistakes *mistakes, const char *path);

/* A text as it is shown within a sentence: cut where it is long, never within a character. */
typedef struct zt_shown {
    char text[64];
} zt_shown;
zt_shown zt_show(const char *text);

/* "; did you mean "color"?", or nothing where nothing is near. */
typedef struct zt_suggestion {
    char text[96];
} zt_suggestion;
zt_suggestion zt_suggest(const zt_nearest *nearest);

#endif
