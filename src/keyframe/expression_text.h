/* The text of an expression, read into a program for Lua and what it refers to. No Lua here:
 * what is not on the short list of an expression's tokens never gets that far. */
#ifndef ZT_KEYFRAME_EXPRESSION_TEXT_H
#define ZT_KEYFRAME_EXPRESSION_TEXT_H

#include "base/arena.h"
#include "keyframe/expression.h"

/* Where a token stands in the text, in characters from 1. */
typedef struct zt_expression_token {
    int32_t column, length;
} zt_expression_token;

/* A value that the program takes besides the time and the frame: all of a reference, or one
 * channel of it. Slot i is the program's variable _i. */
typedef struct zt_expression_slot {
    int32_t reference;
    int32_t channel; /* counted from 0; -1 for all */
} zt_expression_slot;

typedef struct zt_expression_program {
    /* Lua's words for the tokens, one a line, so that the line of a complaint names the token.
     * Braces have become calls of vec, numbers exact, references _0, _1, ... */
    const char *body;
    const zt_expression_token *tokens;
    const zt_expression_reference *references;
    const zt_expression_slot *slots;
    int token_count, reference_count, slot_count;
} zt_expression_program;

/* `words` ends with NULL: what an expression can say besides Lua's words and the caller's
 * names. The program's body is pushed to `scratch`, all else to `arena`. ZT_EDESCRIPTION with
 * *mistake filled, or ZT_EMEMORY. */
zt_status zt_expression_text_read(zt_expression_program *program, const char *text,
                                  const char *const *words, const zt_expression_names *names,
                                  zt_arena *arena, zt_arena *scratch,
                                  zt_expression_mistake *mistake);

/* The number of the channel, from 0, that the name from `start` to `end` means (x y z w, r g b
 * a); -1 for none. */
int zt_expression_channel(const char *start, const char *end);

/* Fills a mistake: what is said in printf's words about a place. Returns ZT_EDESCRIPTION. */
__attribute__((format(printf, 3, 4))) zt_status
zt_expression_wrong(zt_expression_mistake *mistake, zt_expression_token place,
                    const char *format, ...);

#endif
