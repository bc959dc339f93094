#include "description/mistakes.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { SENTENCE_MAX = 1024, SHOWN_MAX = 48 };

static bool told_before(const zt_sentences *sentences, zt_hash hash) {
    for (int i = 0; i < sentences->count; i++)
        if (zt_hash_equal(sentences->told[i], hash)) return true;
    return false;
}

/* Tells a sentence, unless it was told about this place before or there are too many. */
static void tell(zt_mistakes *mistakes, zt_sentences *sentences, zt_severity severity,
                 const zt_place *place, const char *format, va_list arguments) {
    mistakes->told_last = false;
    if (sentences->count == ZT_MISTAKES_TOLD_MAX) {
        sentences->untold_count++;
        return;
    }
    char text[SENTENCE_MAX], key[SENTENCE_MAX + 32];
    vsnprintf(text, sizeof text, format, arguments);
    int length = snprintf(key, sizeof key, "%d:%d:%s", place->line, place->column, text);
    zt_hash hash = zt_hash_bytes(key, (size_t)length);
    if (told_before(sentences, hash)) return;
    sentences->told[sentences->count++] = hash;
    mistakes->told_last = true;
    zt_tell_at(mistakes->listener, severity, place, "%s", text);
}

void zt_mistake(zt_mistakes *mistakes, const zt_place *place, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    mistakes->count++;
    tell(mistakes, &mistakes->mistakes, ZT_ERROR, place, format, arguments);
    va_end(arguments);
}

void zt_doubt(zt_mistakes *mistakes, const zt_place *place, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    tell(mistakes, &mistakes->doubts, ZT_WARNING, place, format, arguments);
    va_end(arguments);
}

void zt_mistake_note(zt_mistakes *mistakes, const zt_place *place, const char *format, ...) {
    if (!mistakes->told_last) return;
    char text[SENTENCE_MAX];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    zt_tell_at(mistakes->listener, ZT_NOTE, place, "%s", text);
}

bool zt_mistakes_full(const zt_mistakes *mistakes) {
    return mistakes->mistakes.count == ZT_MISTAKES_TOLD_MAX;
}

zt_status zt_mistakes_close(const zt_mistakes *mistakes, const char *path) {
    zt_place place = {.file = path};
    if (mistakes->mistakes.untold_count > 0)
        zt_tell_at(mistakes->listener, ZT_NOTE, &place, "mistakes that are not shown: %lld",
                   (long long)mistakes->mistakes.untold_count);
    if (mistakes->doubts.untold_count > 0)
        zt_tell_at(mistakes->listener, ZT_NOTE, &place, "warnings that are not shown: %lld",
                   (long long)mistakes->doubts.untold_count);
    return mistakes->count > 0 ? ZT_EDESCRIPTION : ZT_OK;
}

zt_shown zt_show(const char *text) {
    zt_shown shown = {""};
    size_t length = strnlen(text, SHOWN_MAX + 1);
    bool cut = length > SHOWN_MAX;
    if (cut)
        for (length = SHOWN_MAX; length > 0 && ((unsigned char)text[length] & 0xC0) == 0x80;)
            length--;
    snprintf(shown.text, sizeof shown.text, "%.*s%s", (int)length, text, cut ? "..." : "");
    return shown;
}

zt_suggestion zt_suggest(const zt_nearest *nearest) {
    zt_suggestion suggestion = {""};
    if (nearest->best)
        snprintf(suggestion.text, sizeof suggestion.text, "; did you mean \"%s\"?",
                 zt_show(nearest->best).text);
    return suggestion;
}
