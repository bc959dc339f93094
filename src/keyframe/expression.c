/* The door to Lua: expressions become functions of it, and are asked for their values. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "keyframe/expression_state.h"
#include "keyframe/expression_text.h"

struct zt_expression {
    zt_expression_program program;
    int item; /* the function's place in ZT_LUA_ITEMS; the vectors that it takes come next */
    int width;
    bool spread;
};

/* Compiling */

typedef struct compilation {
    zt_expression *expression;
    const char *pieces[3]; /* of the program, that Lua is still to read; ends with NULL */
    int piece, item, load_status;
} compilation;

static const char *next_piece(lua_State *L, void *user, size_t *size) {
    (void)L;
    compilation *c = user;
    const char *piece = c->pieces[c->piece++];
    *size = piece ? strlen(piece) : 0;
    return piece;
}

static bool is_vector_slot(const zt_expression_program *p, int slot) {
    return p->slots[slot].channel < 0 && p->references[p->slots[slot].reference].width > 1;
}

/* Compiles the compilation that is its first argument, and keeps the function and the vectors
 * that it takes in ZT_LUA_ITEMS, the second. */
static int load_program(lua_State *L) {
    compilation *c = lua_touserdata(L, 1);
    const zt_expression_program *p = &c->expression->program;
    c->load_status = lua_load(L, next_piece, c, "=", "t");
    if (c->load_status != LUA_OK) return lua_error(L);
    lua_rawseti(L, 2, ++c->item);
    c->expression->item = c->item;
    for (int i = 0; i < p->slot_count; i++)
        if (is_vector_slot(p, i)) {
            zt_lua_push_vector(L, p->references[p->slots[i].reference].width);
            lua_rawseti(L, 2, ++c->item);
        }
    return 0;
}

static zt_expression_token whole(const zt_expression_program *p) {
    const zt_expression_token *first = p->tokens, *last = &p->tokens[p->token_count - 1];
    return (zt_expression_token){first->column, last->column + last->length - first->column};
}

/* Says what Lua complains of, on top of its stack, in the words of an expression. */
static zt_status explain(const zt_expressions *e, const zt_expression_program *p, int status,
                         zt_expression_mistake *mistake) {
    if (status == LUA_ERRMEM && !e->over_limit) return ZT_EMEMORY;
    if (status == LUA_ERRMEM)
        return zt_expression_wrong(mistake, whole(p), "this takes more than %d MiB of memory",
                                   ZT_EXPRESSION_MEMORY_MAX / (1024 * 1024));
    int token = e->error_line - 2;
    zt_expression_token place = whole(p);
    if (token >= 0) place = p->tokens[token < p->token_count ? token : p->token_count - 1];
    const char *text = lua_tostring(e->lua, -1);
    if (text[0] == ':') text = strchr(text, ' ') + 1; /* ":line: text" */
    if (strstr(text, "expected")) /* Lua's grammar, in all its complaints and no others */
        return zt_expression_wrong(mistake, place, "%s",
                                   token < p->token_count ? "this does not fit here"
                                                          : "the expression breaks off here");
    /* In brackets at its end Lua names variables as the program calls them. */
    const char *end = strstr(text, " (");
    return zt_expression_wrong(mistake, place, "%.*s",
                               end ? (int)(end - text) : (int)strlen(text), text);
}

static zt_status compile_program(zt_expressions *e, zt_expression *x,
                                 zt_expression_mistake *mistake) {
    lua_State *L = e->lua;
    /* One line, so that token 0 is on the second: it names the time, frame and slots. */
    char header[32 + 5 * ZT_EXPRESSION_REFERENCES_MAX], *at = header;
    at += sprintf(at, "local t,frame");
    for (int i = 0; i < x->program.slot_count; i++) at += sprintf(at, ",_%d", i);
    sprintf(at, "=... return\n");
    compilation c = {
        .expression = x, .pieces = {header, x->program.body}, .item = e->item_count};
    zt_lua_limit(e, false);
    lua_pushcfunction(L, load_program);
    lua_pushlightuserdata(L, &c);
    lua_pushvalue(L, ZT_LUA_ITEMS);
    int status = lua_pcall(L, 2, 0, ZT_LUA_ON_ERROR);
    if (status == LUA_OK)
        e->item_count = c.item;
    else if (c.load_status == LUA_ERRMEM)
        status = LUA_ERRMEM; /* raised once more as an error like others */
    zt_status result = status == LUA_OK ? ZT_OK : explain(e, &x->program, status, mistake);
    lua_settop(L, ZT_LUA_BOTTOM);
    return result;
}

static zt_status compile_text(zt_expression *x, zt_expressions *e, const char *text,
                              const zt_expression_names *names,
                              zt_expression_mistake *mistake) {
    zt_arena scratch = {0};
    zt_status status = zt_expression_text_read(&x->program, text, e->words, names, &e->arena,
                                               &scratch, mistake);
    if (status == ZT_OK) status = compile_program(e, x, mistake);
    x->program.body = NULL; /* goes with the scratch */
    zt_arena_free(&scratch);
    return status;
}

static zt_status compile(const zt_expression **out, zt_expressions *e, const char *text,
                         int width, bool spread, const zt_expression_names *names,
                         zt_expression_mistake *mistake) {
    *out = NULL;
    if (width != ZT_EXPRESSION_SWITCH && (width < 1 || width > ZT_EXPRESSION_WIDTH_MAX))
        return ZT_EARGUMENT;
    mtx_lock(&e->lock);
    zt_expression *x = ZT_PUSH(&e->arena, zt_expression, 1);
    zt_status status = x ? compile_text(x, e, text, names, mistake) : ZT_EMEMORY;
    mtx_unlock(&e->lock);
    if (status != ZT_OK) return status;
    x->width = width;
    x->spread = spread;
    *out = x;
    return ZT_OK;
}

static const zt_expression_reference *references(const zt_expression *x, int *count) {
    *count = x->program.reference_count;
    return x->program.references;
}

/* Evaluating */

/* Pushes the function and what it takes; nothing is allocated. */
static void push_program(lua_State *L, const zt_expression *x, double time_s, double frame,
                         const double *values) {
    int item = x->item;
    lua_rawgeti(L, ZT_LUA_ITEMS, item);
    lua_pushnumber(L, time_s);
    lua_pushnumber(L, frame);
    for (int i = 0; i < x->program.slot_count; i++) {
        const zt_expression_slot *slot = &x->program.slots[i];
        const zt_expression_reference *reference = &x->program.references[slot->reference];
        const double *numbers = values + reference->first;
        if (is_vector_slot(&x->program, i)) {
            lua_rawgeti(L, ZT_LUA_ITEMS, ++item);
            memcpy(lua_touserdata(L, -1), numbers, (size_t)reference->width * sizeof *numbers);
        } else if (reference->width == ZT_EXPRESSION_SWITCH)
            lua_pushboolean(L, *numbers >= 0.5);
        else
            lua_pushnumber(L, numbers[slot->channel < 0 ? 0 : slot->channel]);
    }
}

static bool all_finite(const double *value, int width) {
    bool finite = true;
    for (int c = 0; c < width; c++) finite = finite && isfinite(value[c]);
    return finite;
}

/* Takes the result from the top of the stack. */
static zt_status take(double *value, lua_State *L, const zt_expression *x,
                      zt_expression_mistake *mistake) {
    zt_expression_token place = whole(&x->program);
    int type = lua_type(L, -1), width = x->width;
    bool is_switch = width == ZT_EXPRESSION_SWITCH;
    if (is_switch) width = 1;
    if (type == LUA_TNUMBER && (width == 1 || x->spread))
        for (int c = 0; c < width; c++) value[c] = lua_tonumber(L, -1);
    else if (type == LUA_TBOOLEAN && is_switch)
        *value = lua_toboolean(L, -1);
    else if (type == LUA_TUSERDATA && width > 1 && zt_lua_width(L, -1) == width)
        memcpy(value, lua_touserdata(L, -1), (size_t)width * sizeof *value);
    else if (type == LUA_TUSERDATA)
        return zt_expression_wrong(mistake, place, "this gives %d numbers instead of %d",
                                   zt_lua_width(L, -1), width);
    else
        return zt_expression_wrong(mistake, place, "this gives %s instead of %d number%s",
                                   zt_lua_kind(type), width, width == 1 ? "" : "s");
    if (!all_finite(value, width))
        return zt_expression_wrong(mistake, place, "the result is not finite");
    if (is_switch) *value = *value >= 0.5;
    return ZT_OK;
}

static zt_status eval(double *value, zt_expressions *e, const zt_expression *x, double time_s,
                      double frame, const double *values, zt_expression_mistake *mistake) {
    mtx_lock(&e->lock);
    lua_State *L = e->lua;
    zt_lua_limit(e, true);
    push_program(L, x, time_s, frame, values);
    int status = lua_pcall(L, 2 + x->program.slot_count, 1, ZT_LUA_ON_ERROR);
    zt_status result = status == LUA_OK ? take(value, L, x, mistake)
                                        : explain(e, &x->program, status, mistake);
    lua_settop(L, ZT_LUA_BOTTOM);
    mtx_unlock(&e->lock);
    return result;
}

ZT_MODULE_DOOR(zt_expression_door, expression) = {
    .open = zt_lua_open,
    .close = zt_lua_close,
    .compile = compile,
    .references = references,
    .eval = eval,
};
