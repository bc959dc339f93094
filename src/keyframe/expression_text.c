/* One walk over the text: each token is put into Lua's words as soon as it is read. */
#include "keyframe/expression_text.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/diag.h"

enum {
    WORD_MAX = 24,  /* bytes that a token of one byte becomes at most, its newline counted */
    NAME_MAX = 255, /* bytes of a name of the caller's */
    SHOWN_MAX = 60, /* bytes of the text within a message */
    DEPTH_MAX = 100 /* brackets within brackets; Lua's own limit is near 200 */
};

typedef struct reader {
    const char *at; /* the next byte to be read */
    const char *counted;
    int column; /* of `counted` */
    const char *const *words;
    const zt_expression_names *names;
    char *body_end; /* of what is written of the body */
    zt_expression_token *tokens;
    int token_count;
    zt_expression_reference references[ZT_EXPRESSION_REFERENCES_MAX];
    zt_expression_slot slots[ZT_EXPRESSION_REFERENCES_MAX];
    int reference_count, slot_count, value_count;
    struct {
        char sign;
        zt_expression_token place;
    } open[DEPTH_MAX]; /* the brackets that are not closed yet */
    int depth;
    zt_expression_mistake *mistake;
} reader;

zt_status zt_expression_wrong(zt_expression_mistake *mistake, zt_expression_token place,
                              const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(mistake->text, sizeof mistake->text, format, arguments);
    va_end(arguments);
    mistake->column = place.column;
    mistake->length = place.length;
    return ZT_EDESCRIPTION;
}

static bool is_digit(char c) { return c >= '0' && c <= '9'; }
static bool is_name_start(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || (c & 0x80);
}

static const char *skip_space(const char *at) { return at + strspn(at, " \t\n\r"); }
static const char *skip_digits(const char *at) { return at + strspn(at, "0123456789"); }
static const char *skip_name(const char *at) {
    while (is_name_start(*at) || is_digit(*at)) at++;
    return at;
}

static int count_characters(const char *start, const char *end) {
    int count = 0;
    for (; start < end; start++) count += ((unsigned char)*start & 0xC0) != 0x80;
    return count;
}

/* Places are asked for from left to right. */
static zt_expression_token place_of(reader *r, const char *start, const char *end) {
    r->column += count_characters(r->counted, start);
    r->counted = start;
    int length = count_characters(start, end);
    return (zt_expression_token){r->column, length > 0 ? length : 1}; /* 0: no UTF-8 */
}

/* How many bytes of a piece of the text fit into a message. */
static int shown(const char *start, const char *end) {
    ptrdiff_t length = end - start;
    if (length > SHOWN_MAX)
        for (length = SHOWN_MAX; length > 1 && ((unsigned char)start[length] & 0xC0) == 0x80;)
            length--;
    return (int)length;
}

/* Writes the token from r->at to `end` as Lua shall read it, and goes on behind it. */
__attribute__((format(printf, 3, 4))) static void emit(reader *r, const char *end,
                                                       const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    size_t room = (size_t)(end - r->at) * WORD_MAX + 1;
    r->body_end += vsnprintf(r->body_end, room, format, arguments);
    va_end(arguments);
    *r->body_end++ = '\n';
    r->tokens[r->token_count++] = place_of(r, r->at, end);
    r->at = end;
}

/* In hexadecimal with an exponent and no point: exact, a float for Lua even where it is whole,
 * and the same under any locale. */
static zt_status read_number(reader *r) {
    const char *end = skip_digits(r->at);
    if (*end == '.') end = skip_digits(end + 1);
    if (*end == 'e' || *end == 'E') {
        const char *exponent = end + 1 + (end[1] == '+' || end[1] == '-');
        if (is_digit(*exponent)) end = skip_digits(exponent);
    }
    double value;
    if (!zt_text_number(&value, r->at, end))
        return zt_expression_wrong(r->mistake, place_of(r, r->at, end),
                                   "%.*s is no number that can be kept", shown(r->at, end),
                                   r->at);
    int exponent;
    uint64_t mantissa = (uint64_t)ldexp(frexp(value, &exponent), 53);
    emit(r, end, "0x%" PRIx64 "p%d", mantissa, exponent - 53);
    return ZT_OK;
}

int zt_expression_channel(const char *start, const char *end) {
    static const char letters[] = "xyzwrgba";
    const char *found = end - start == 1 ? strchr(letters, *start) : NULL;
    return found ? (int)(found - letters) % 4 : -1;
}

static zt_status no_channel(reader *r, const char *start, const char *end, int width) {
    zt_expression_token place = place_of(r, start, end);
    if (width == 1) return zt_expression_wrong(r->mistake, place, "a number has no channels");
    if (width > 1)
        return zt_expression_wrong(r->mistake, place, "there are %d channels, and no \"%.*s\"",
                                   width, shown(start, end), start);
    return zt_expression_wrong(r->mistake, place,
                               "\"%.*s\" is no channel: these are x y z w, r g b a",
                               shown(start, end), start);
}

/* The channel that is asked for right behind a reference of `width` numbers, as ".x" or "[1]",
 * or -1; *end moves behind it. */
static zt_status read_channel_of(int *channel, reader *r, const char **end, int width) {
    *channel = -1;
    const char *start = *end;
    if (*start == '.' && is_name_start(start[1])) {
        *end = skip_name(start + 1);
        *channel = zt_expression_channel(start + 1, *end);
        if (*channel < 0 || *channel >= width || width == 1)
            return no_channel(r, start + 1, *end, width);
    } else if (*start == '[') {
        /* Only a plain number; what must be reckoned first is left to Lua. */
        const char *digit = skip_space(start + 1), *close = skip_space(skip_digits(digit));
        if (!is_digit(*digit) || *close != ']') return ZT_OK;
        *end = close + 1;
        double index = 0;
        if (!zt_text_number(&index, digit, skip_digits(digit)) || !(index >= 1) ||
            index > width || width == 1)
            return no_channel(r, digit, skip_digits(digit), width);
        *channel = (int)index - 1;
    }
    return ZT_OK;
}

/* The width of what the caller calls by a name; 0 where there is nothing. */
static int find(const reader *r, const char *start, const char *end, int32_t *id) {
    char name[NAME_MAX + 1];
    if (!r->names || end - start > NAME_MAX) return 0;
    snprintf(name, sizeof name, "%.*s", (int)(end - start), start);
    return r->names->find(r->names->user, name, id);
}

/* Whether a name is among words that end with NULL. */
static bool is_among(const char *const *words, const char *start, const char *end) {
    size_t length = (size_t)(end - start);
    for (const char *const *word = words; *word; word++)
        if (strlen(*word) == length && memcmp(*word, start, length) == 0) return true;
    return false;
}

static zt_status unknown(reader *r, const char *start, const char *end) {
    const char *dot = memrchr(start, '.', (size_t)(end - start));
    if (dot && is_among(r->words, start, dot))
        return zt_expression_wrong(r->mistake, place_of(r, dot + 1, end),
                                   "\"%.*s\" has no channels", shown(start, dot), start);
    if (dot && zt_expression_channel(dot + 1, end) >= 0) end = dot;
    char name[NAME_MAX + 1];
    snprintf(name, sizeof name, "%.*s", (int)(end - start > NAME_MAX ? NAME_MAX : end - start),
             start);
    zt_nearest nearest = zt_nearest_to(name);
    for (const char *const *word = r->words; *word; word++) zt_nearest_try(&nearest, *word);
    if (r->names && r->names->suggest) r->names->suggest(r->names->user, &nearest);
    zt_expression_token place = place_of(r, start, end);
    if (!nearest.best)
        return zt_expression_wrong(r->mistake, place, "nothing is called \"%.*s\"",
                                   shown(start, end), start);
    return zt_expression_wrong(r->mistake, place,
                               "nothing is called \"%.*s\"; did you mean \"%.60s\"?",
                               shown(start, end), start, nearest.best);
}

/* The slot of a channel of what the caller knows as `id`: an earlier one, or a new one; -1
 * where there are too many. */
static int slot_for(reader *r, int32_t id, int width, int channel, zt_expression_token place) {
    int reference = 0, slot = 0;
    while (reference < r->reference_count && r->references[reference].id != id) reference++;
    while (slot < r->slot_count &&
           (r->slots[slot].reference != reference || r->slots[slot].channel != channel))
        slot++;
    if (slot == ZT_EXPRESSION_REFERENCES_MAX) return -1;
    if (reference == r->reference_count) {
        r->references[r->reference_count++] =
            (zt_expression_reference){id, width, r->value_count, place.column, place.length};
        r->value_count += width == ZT_EXPRESSION_SWITCH ? 1 : width;
    }
    if (slot == r->slot_count)
        r->slots[r->slot_count++] = (zt_expression_slot){reference, channel};
    return slot;
}

/* A name of the caller's from `start` to `end`, or the longest part of it up to a dot that is
 * one; a channel may follow. The token itself goes on to `token_end` where the name is in
 * quotes. */
static zt_status read_reference(reader *r, const char *start, const char *end,
                                const char *token_end) {
    int32_t id = -1;
    int width = 0, channel;
    const char *cut = end;
    while (cut && (width = find(r, start, cut, &id)) == 0)
        cut = memrchr(start, '.', (size_t)(cut - start));
    if (!cut) return unknown(r, start, end);
    zt_expression_token place = place_of(r, r->at, token_end);
    int channels = width == ZT_EXPRESSION_SWITCH ? 1 : width;
    ZT_TRY(read_channel_of(&channel, r, &cut, channels));
    if (token_end > end) {
        if (cut < end) return unknown(r, start, end);
        cut = token_end;
        if (channel < 0) ZT_TRY(read_channel_of(&channel, r, &cut, channels));
    }
    int slot = slot_for(r, id, width, channel, place);
    if (slot < 0)
        return zt_expression_wrong(r->mistake, place, "there are more than %d other properties",
                                   ZT_EXPRESSION_REFERENCES_MAX);
    emit(r, cut, "_%d", slot);
    return ZT_OK;
}

/* prop("a name"), with either kind of quotes. */
static zt_status read_prop(reader *r, const char *end) {
    const char *bracket = skip_space(end), *quote = bracket, *close = NULL;
    if (*bracket == '(') quote = skip_space(bracket + 1);
    if (*quote == '"' || *quote == '\'') close = strchr(quote + 1, *quote);
    const char *last = close ? skip_space(close + 1) : NULL;
    if (*bracket != '(' || !last || *last != ')')
        return zt_expression_wrong(
            r->mistake, place_of(r, r->at, end),
            "prop takes one name in quotes, as in prop(\"key light.position\")");
    return read_reference(r, quote + 1, close, last + 1);
}

static zt_status read_name(reader *r) {
    static const char *const lua_words[] = {"and", "or", "not", "true", "false", NULL};
    const char *end = skip_name(r->at);
    if (is_among(lua_words, r->at, end)) {
        emit(r, end, "%.*s", (int)(end - r->at), r->at);
        return ZT_OK;
    }
    if (end - r->at == 4 && memcmp(r->at, "prop", 4) == 0) return read_prop(r, end);
    const char *chain_end = end;
    while (*chain_end == '.' && is_name_start(chain_end[1]))
        chain_end = skip_name(chain_end + 1);
    if (chain_end > end || !is_among(r->words, r->at, end))
        return read_reference(r, r->at, chain_end, chain_end);
    int32_t id;
    if (find(r, r->at, end, &id) != 0)
        return zt_expression_wrong(r->mistake, place_of(r, r->at, end),
                                   "\"%.*s\" is a word of all expressions and cannot be another"
                                   " name as well",
                                   shown(r->at, end), r->at);
    emit(r, end, "%.*s", (int)(end - r->at), r->at);
    return ZT_OK;
}

static zt_status close_bracket(reader *r) {
    static const char pairs[] = "()[]{}";
    if (!r->depth || r->open[r->depth - 1].sign != strchr(pairs, *r->at)[-1])
        return zt_expression_wrong(r->mistake, place_of(r, r->at, r->at + 1),
                                   "there is no open bracket that this \"%c\" closes", *r->at);
    r->depth--;
    emit(r, r->at + 1, "%.1s", *r->at == '}' ? ")" : r->at);
    return ZT_OK;
}

static zt_status open_bracket(reader *r) {
    zt_expression_token place = place_of(r, r->at, r->at + 1);
    if (r->depth == DEPTH_MAX)
        return zt_expression_wrong(r->mistake, place, "brackets are more than %d deep",
                                   DEPTH_MAX);
    r->open[r->depth].sign = *r->at;
    r->open[r->depth++].place = place;
    bool brace = *r->at == '{';
    emit(r, r->at + 1, "%.*s", brace ? 4 : 1, brace ? "vec(" : r->at);
    return ZT_OK;
}

/* Signs that an expression does not have, and what to do instead. */
static zt_status wrong_sign(reader *r) {
    static const struct {
        const char *sign, *hint;
    } hints[] = {{"--", "; put a space between the two"},
                 {"!=", "; write ~="},
                 {"!", "; write not"},
                 {"&&", "; write and"},
                 {"||", "; write or"},
                 {"=", "; write =="},
                 {"\"", "; names in quotes belong into prop(...)"},
                 {"'", "; names in quotes belong into prop(...)"}};
    for (size_t i = 0; i < sizeof hints / sizeof *hints; i++) {
        size_t length = strlen(hints[i].sign);
        if (strncmp(r->at, hints[i].sign, length) == 0)
            return zt_expression_wrong(r->mistake, place_of(r, r->at, r->at + length),
                                       "%s has no place in an expression%s", hints[i].sign,
                                       hints[i].hint);
    }
    return zt_expression_wrong(r->mistake, place_of(r, r->at, r->at + 1),
                               "%c has no place in an expression", *r->at);
}

static zt_status read_sign(reader *r) {
    static const char doubles[][3] = {"==", "~=", "<=", ">=", "//"};
    for (size_t i = 0; i < sizeof doubles / sizeof *doubles; i++)
        if (strncmp(r->at, doubles[i], 2) == 0) {
            emit(r, r->at + 2, "%s", doubles[i]);
            return ZT_OK;
        }
    if (strchr("([{", *r->at)) return open_bracket(r);
    if (strchr(")]}", *r->at)) return close_bracket(r);
    if (!strchr("+-*/%^<>,", *r->at) || strncmp(r->at, "--", 2) == 0) return wrong_sign(r);
    if (*r->at == ',' && r->depth == 0)
        return zt_expression_wrong(r->mistake, place_of(r, r->at, r->at + 1),
                                   "a vector is written in braces: {x, y, z}");
    emit(r, r->at + 1, "%c", *r->at);
    return ZT_OK;
}

static zt_status read_token(reader *r) {
    char c = *r->at;
    if (is_digit(c) || (c == '.' && is_digit(r->at[1]))) return read_number(r);
    if (is_name_start(c)) return read_name(r);
    if (c != '.' || !is_name_start(r->at[1])) return read_sign(r);
    const char *end = skip_name(r->at + 1);
    if (zt_expression_channel(r->at + 1, end) < 0) return no_channel(r, r->at + 1, end, 0);
    emit(r, end, "%.*s", (int)(end - r->at), r->at);
    return ZT_OK;
}

static const void *copy(zt_arena *arena, const void *from, size_t size, int count) {
    void *to = zt_arena_push_array(arena, size, (size_t)count);
    return to ? memcpy(to, from, size * (size_t)count) : NULL;
}

static zt_status read_all(reader *r) {
    while (*(r->at = skip_space(r->at))) ZT_TRY(read_token(r));
    *r->body_end = '\0';
    if (r->depth)
        return zt_expression_wrong(r->mistake, r->open[r->depth - 1].place,
                                   "this \"%c\" is never closed", r->open[r->depth - 1].sign);
    if (r->token_count == 0)
        return zt_expression_wrong(r->mistake, (zt_expression_token){1, 1},
                                   "an expression is missing");
    return ZT_OK;
}

zt_status zt_expression_text_read(zt_expression_program *program, const char *text,
                                  const char *const *words, const zt_expression_names *names,
                                  zt_arena *arena, zt_arena *scratch,
                                  zt_expression_mistake *mistake) {
    size_t length = strlen(text);
    if (length > ZT_EXPRESSION_LENGTH_MAX)
        return zt_expression_wrong(mistake, (zt_expression_token){1, 1},
                                   "an expression of more than %d KiB is too long",
                                   ZT_EXPRESSION_LENGTH_MAX / 1024);
    char *body = zt_arena_push(scratch, length * WORD_MAX + 1);
    zt_expression_token *tokens = ZT_PUSH(scratch, zt_expression_token, length);
    if (!body || !tokens) return ZT_EMEMORY;
    reader r = {.at = text,
                .counted = text,
                .column = 1,
                .words = words,
                .names = names,
                .body_end = body,
                .tokens = tokens,
                .mistake = mistake};
    ZT_TRY(read_all(&r));
    *program = (zt_expression_program){
        body,
        copy(arena, tokens, sizeof *tokens, r.token_count),
        copy(arena, r.references, sizeof *r.references, r.reference_count),
        copy(arena, r.slots, sizeof *r.slots, r.slot_count),
        r.token_count,
        r.reference_count,
        r.slot_count};
    return program->tokens && program->references && program->slots ? ZT_OK : ZT_EMEMORY;
}
