/* The door to Lua. The state has no library of Lua's: what it can call is here and in
 * functions.c. Vectors are userdata of doubles, never changed once made, and there are no
 * tables, so that nothing has an order that could differ from run to run. */
#include "keyframe/expression.h"

#include <assert.h>
#include <lua.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <threads.h>

#include "base/diag.h"
#include "keyframe/expression_text.h"
#include "keyframe/functions.h"

enum {
    /* What lies at the bottom of Lua's stack while the state is open. */
    ON_ERROR = 1, /* the function that notes where an error was raised */
    ITEMS,        /* a table of the compiled functions and their vectors */
    BOTTOM = ITEMS,
    WORDS_MAX = 64
};

struct zt_expressions {
    mtx_t lock;
    lua_State *lua;
    zt_arena arena;
    double fps, duration_s;
    size_t used, used_max; /* bytes that Lua holds, and may hold in this call */
    bool over_limit;       /* whether it asked for more in this call */
    int error_line;        /* of the last error; 0 where it is not known */
    int item_count;
    int word_count;
    const char *words[WORDS_MAX]; /* what the reader lets through; ends with NULL */
};

struct zt_expression {
    zt_expression_program program;
    int item; /* the function's place in ITEMS; the vectors that it takes come next */
    int width;
    bool spread;
};

/* Lua's memory, counted. */
static void *allocate(void *user, void *block, size_t old_size, size_t size) {
    zt_expressions *e = user;
    if (!block) old_size = 0; /* then it says what the block is for */
    if (size == 0) {
        free(block);
        e->used -= old_size;
        return NULL;
    }
    if (size > old_size && size - old_size > e->used_max - e->used) {
        e->over_limit = true;
        return NULL;
    }
    void *moved = realloc(block, size);
    if (moved) e->used += size - old_size;
    return moved;
}

/* What a call takes counts from where it starts: many expressions may be more than one call. */
static void limit_memory(zt_expressions *e) {
    e->used_max = e->used + ZT_EXPRESSION_MEMORY_MAX;
    e->over_limit = false;
}

/* Notes the line of an error, which is the number of a token (expression_text.h): Lua has put
 * it before its own messages, and the stack tells it for those of the functions here. */
static int on_error(lua_State *L) {
    zt_expressions *e = *(zt_expressions **)lua_getextraspace(L);
    const char *text = lua_tostring(L, 1);
    lua_Debug where;
    e->error_line = 0;
    if (text && text[0] == ':') e->error_line = (int)strtol(text + 1, NULL, 10);
    for (int level = 0; !e->error_line && lua_getstack(L, level, &where); level++)
        if (lua_getinfo(L, "l", &where) && where.currentline > 0)
            e->error_line = where.currentline;
    return 1;
}

__attribute__((format(printf, 2, 3))) static int fail(lua_State *L, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    lua_pushvfstring(L, format, arguments);
    va_end(arguments);
    return lua_error(L);
}

static void on_step_limit(lua_State *L, lua_Debug *where) {
    (void)where;
    fail(L, "this takes more than %d steps", (int)ZT_EXPRESSION_STEPS_MAX);
}

static const char *kind_of(int type) {
    switch (type) {
    case LUA_TNUMBER:
        return "a number";
    case LUA_TUSERDATA:
        return "a vector";
    case LUA_TBOOLEAN:
        return "true or false";
    case LUA_TFUNCTION:
        return "a function";
    default:
        return "nothing";
    }
}

/* Where the registry has the metatable of vectors. */
static const char vectors_key;

static double *push_vector(lua_State *L, int width) {
    double *numbers = lua_newuserdatauv(L, (size_t)width * sizeof *numbers, 0);
    lua_rawgetp(L, LUA_REGISTRYINDEX, &vectors_key);
    lua_setmetatable(L, -2);
    return numbers;
}

static int width_of(lua_State *L, int index) {
    return (int)(lua_rawlen(L, index) / sizeof(double));
}

/* Calls the zt_function in the upvalue. */
static int call_function(lua_State *L) {
    const zt_function *f = lua_touserdata(L, lua_upvalueindex(1));
    double numbers[ZT_OPERANDS_MAX];
    zt_call call = {.count = lua_gettop(L)};
    for (int i = 0; i < call.count && i < ZT_OPERANDS_MAX; i++) {
        int type = lua_type(L, i + 1);
        numbers[i] = lua_tonumber(L, i + 1);
        call.operands[i] = (zt_operand){&numbers[i], 0};
        if (type == LUA_TUSERDATA)
            call.operands[i] = (zt_operand){lua_touserdata(L, i + 1), width_of(L, i + 1)};
        else if (type != LUA_TNUMBER)
            return fail(L, "this is %s, and a number or a vector is needed", kind_of(type));
    }
    if (!zt_function_call(f, &call)) return fail(L, "%s", call.wrong);
    if (call.width)
        memcpy(push_vector(L, call.width), call.result, (size_t)call.width * sizeof(double));
    else
        lua_pushnumber(L, call.result[0]);
    return 1;
}

static int vectors_equal(lua_State *L) {
    const double *a = lua_touserdata(L, 1), *b = lua_touserdata(L, 2);
    int width = width_of(L, 1);
    bool equal = width == width_of(L, 2);
    for (int c = 0; equal && c < width; c++) equal = a[c] == b[c];
    lua_pushboolean(L, equal);
    return 1;
}

/* v.x, v.r or v[1]. */
static int vector_channel(lua_State *L) {
    int width = width_of(L, 1);
    double index = lua_tonumber(L, 2); /* 0 for what is no number */
    if (lua_type(L, 2) == LUA_TSTRING) {
        const char *name = lua_tostring(L, 2);
        index = 1 + zt_expression_channel(name, name + strlen(name));
    }
    if (!(index >= 1 && index <= width) || floor(index) != index)
        return fail(L, "the channels here go from 1 to %d", width);
    lua_pushnumber(L, ((const double *)lua_touserdata(L, 1))[(int)index - 1]);
    return 1;
}

/* Opening */

static void add_word(zt_expressions *e, const char *name) {
    assert(e->word_count + 1 < WORDS_MAX);
    e->words[e->word_count++] = name;
}

static void push_function(lua_State *L, const zt_function *function) {
    lua_pushlightuserdata(L, (void *)function);
    lua_pushcclosure(L, call_function, 1);
}

static void make_vectors(lua_State *L) {
    lua_newtable(L);
    for (int i = 0; i < zt_operator_count; i++) {
        push_function(L, &zt_operators[i]);
        lua_setfield(L, -2, zt_operators[i].name);
    }
    lua_pushcfunction(L, vectors_equal);
    lua_setfield(L, -2, "__eq");
    lua_pushcfunction(L, vector_channel);
    lua_setfield(L, -2, "__index");
    lua_pushliteral(L, "vector"); /* in Lua's own messages */
    lua_setfield(L, -2, "__name");
    lua_rawsetp(L, LUA_REGISTRYINDEX, &vectors_key);
}

/* Fills the new state; returns what stays at the bottom of its stack. */
static int populate(lua_State *L) {
    static const double pi = 3.14159265358979323846;
    zt_expressions *e = *(zt_expressions **)lua_getextraspace(L);
    const struct {
        const char *name;
        double value;
    } constants[] = {{"pi", pi}, {"tau", 2 * pi}, {"fps", e->fps}, {"duration", e->duration_s}};
    for (size_t i = 0; i < sizeof constants / sizeof *constants; i++) {
        add_word(e, constants[i].name);
        lua_pushnumber(L, constants[i].value);
        lua_setglobal(L, constants[i].name);
    }
    for (int i = 0; i < zt_function_count; i++) {
        add_word(e, zt_functions[i].name);
        push_function(L, &zt_functions[i]);
        lua_setglobal(L, zt_functions[i].name);
    }
    make_vectors(L);
    lua_pushcfunction(L, on_error);
    lua_newtable(L);
    return BOTTOM;
}

static void expressions_close(zt_expressions **slot) {
    zt_expressions *e = *slot;
    if (!e) return;
    if (e->lua) lua_close(e->lua);
    zt_arena_free(&e->arena);
    mtx_destroy(&e->lock);
    free(e);
    *slot = NULL;
}

static zt_status expressions_open(zt_expressions **out, zt_rate rate, double duration_s) {
    *out = NULL;
    zt_expressions *e = calloc(1, sizeof *e);
    if (!e) return ZT_EMEMORY;
    if (mtx_init(&e->lock, mtx_plain) != thrd_success) {
        free(e);
        return ZT_EMEMORY;
    }
    e->fps = (double)rate.num / rate.den;
    e->duration_s = duration_s;
    add_word(e, "t");
    add_word(e, "frame");
    add_word(e, "prop");
    limit_memory(e);
    e->lua = lua_newstate(allocate, e);
    if (e->lua) {
        *(zt_expressions **)lua_getextraspace(e->lua) = e;
        lua_pushcfunction(e->lua, populate);
    }
    /* Room for all that is pushed outside of protected calls: a program and what it takes. */
    if (!e->lua || lua_pcall(e->lua, 0, BOTTOM, 0) != LUA_OK ||
        !lua_checkstack(e->lua, ZT_EXPRESSION_REFERENCES_MAX + LUA_MINSTACK)) {
        expressions_close(&e);
        return ZT_EMEMORY;
    }
    *out = e;
    return ZT_OK;
}

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
 * that it takes in ITEMS, the second. */
static int load_program(lua_State *L) {
    compilation *c = lua_touserdata(L, 1);
    const zt_expression_program *p = &c->expression->program;
    c->load_status = lua_load(L, next_piece, c, "=", "t");
    if (c->load_status != LUA_OK) return lua_error(L);
    lua_rawseti(L, 2, ++c->item);
    c->expression->item = c->item;
    for (int i = 0; i < p->slot_count; i++)
        if (is_vector_slot(p, i)) {
            push_vector(L, p->references[p->slots[i].reference].width);
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
    limit_memory(e);
    lua_pushcfunction(L, load_program);
    lua_pushlightuserdata(L, &c);
    lua_pushvalue(L, ITEMS);
    int status = lua_pcall(L, 2, 0, ON_ERROR);
    if (status == LUA_OK)
        e->item_count = c.item;
    else if (c.load_status == LUA_ERRMEM)
        status = LUA_ERRMEM; /* raised once more as an error like others */
    zt_status result = status == LUA_OK ? ZT_OK : explain(e, &x->program, status, mistake);
    lua_settop(L, BOTTOM);
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
    lua_rawgeti(L, ITEMS, item);
    lua_pushnumber(L, time_s);
    lua_pushnumber(L, frame);
    for (int i = 0; i < x->program.slot_count; i++) {
        const zt_expression_slot *slot = &x->program.slots[i];
        const zt_expression_reference *reference = &x->program.references[slot->reference];
        const double *numbers = values + reference->first;
        if (is_vector_slot(&x->program, i)) {
            lua_rawgeti(L, ITEMS, ++item);
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
    else if (type == LUA_TUSERDATA && width > 1 && width_of(L, -1) == width)
        memcpy(value, lua_touserdata(L, -1), (size_t)width * sizeof *value);
    else if (type == LUA_TUSERDATA)
        return zt_expression_wrong(mistake, place, "this gives %d numbers instead of %d",
                                   width_of(L, -1), width);
    else
        return zt_expression_wrong(mistake, place, "this gives %s instead of %d number%s",
                                   kind_of(type), width, width == 1 ? "" : "s");
    if (!all_finite(value, width))
        return zt_expression_wrong(mistake, place, "the result is not finite");
    if (is_switch) *value = *value >= 0.5;
    return ZT_OK;
}

static zt_status eval(double *value, zt_expressions *e, const zt_expression *x, double time_s,
                      double frame, const double *values, zt_expression_mistake *mistake) {
    mtx_lock(&e->lock);
    lua_State *L = e->lua;
    limit_memory(e);
    lua_sethook(L, on_step_limit, LUA_MASKCOUNT, ZT_EXPRESSION_STEPS_MAX);
    push_program(L, x, time_s, frame, values);
    int status = lua_pcall(L, 2 + x->program.slot_count, 1, ON_ERROR);
    zt_status result = status == LUA_OK ? take(value, L, x, mistake)
                                        : explain(e, &x->program, status, mistake);
    lua_settop(L, BOTTOM);
    mtx_unlock(&e->lock);
    return result;
}

ZT_MODULE_DOOR(zt_expression_door, expression) = {
    .open = expressions_open,
    .close = expressions_close,
    .compile = compile,
    .references = references,
    .eval = eval,
};
