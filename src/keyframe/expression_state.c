/* What Lua may do and hold. The state has no library of Lua's: what it can call is here and in
 * functions.c. Vectors are userdata of doubles, never changed once made, and there are no
 * tables, so that nothing has an order that could differ from run to run. */
#include "keyframe/expression_state.h"

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "keyframe/expression_text.h"
#include "keyframe/functions.h"

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

void zt_lua_limit(zt_expressions *e, bool steps) {
    e->used_max = e->used + ZT_EXPRESSION_MEMORY_MAX;
    e->over_limit = false;
    if (steps) lua_sethook(e->lua, on_step_limit, LUA_MASKCOUNT, ZT_EXPRESSION_STEPS_MAX);
}

const char *zt_lua_kind(int type) {
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

double *zt_lua_push_vector(lua_State *L, int width) {
    double *numbers = lua_newuserdatauv(L, (size_t)width * sizeof *numbers, 0);
    lua_rawgetp(L, LUA_REGISTRYINDEX, &vectors_key);
    lua_setmetatable(L, -2);
    return numbers;
}

int zt_lua_width(lua_State *L, int index) {
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
            call.operands[i] = (zt_operand){lua_touserdata(L, i + 1), zt_lua_width(L, i + 1)};
        else if (type != LUA_TNUMBER)
            return fail(L, "this is %s, and a number or a vector is needed", zt_lua_kind(type));
    }
    if (!zt_function_call(f, &call)) return fail(L, "%s", call.wrong);
    if (call.width)
        memcpy(zt_lua_push_vector(L, call.width), call.result,
               (size_t)call.width * sizeof(double));
    else
        lua_pushnumber(L, call.result[0]);
    return 1;
}

static int vectors_equal(lua_State *L) {
    const double *a = lua_touserdata(L, 1), *b = lua_touserdata(L, 2);
    int width = zt_lua_width(L, 1);
    bool equal = width == zt_lua_width(L, 2);
    for (int c = 0; equal && c < width; c++) equal = a[c] == b[c];
    lua_pushboolean(L, equal);
    return 1;
}

/* v.x, v.r or v[1]. */
static int vector_channel(lua_State *L) {
    int width = zt_lua_width(L, 1);
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
    assert(e->word_count + 1 < ZT_LUA_WORDS_MAX);
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
    return ZT_LUA_BOTTOM;
}

void zt_lua_close(zt_expressions **slot) {
    zt_expressions *e = *slot;
    if (!e) return;
    if (e->lua) lua_close(e->lua);
    zt_arena_free(&e->arena);
    mtx_destroy(&e->lock);
    free(e);
    *slot = NULL;
}

zt_status zt_lua_open(zt_expressions **out, zt_rate rate, double duration_s) {
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
    zt_lua_limit(e, false);
    e->lua = lua_newstate(allocate, e);
    if (e->lua) {
        *(zt_expressions **)lua_getextraspace(e->lua) = e;
        lua_pushcfunction(e->lua, populate);
    }
    /* Room for all that is pushed outside of protected calls: a program and what it takes. */
    if (!e->lua || lua_pcall(e->lua, 0, ZT_LUA_BOTTOM, 0) != LUA_OK ||
        !lua_checkstack(e->lua, ZT_EXPRESSION_REFERENCES_MAX + LUA_MINSTACK)) {
        zt_lua_close(&e);
        return ZT_EMEMORY;
    }
    *out = e;
    return ZT_OK;
}
