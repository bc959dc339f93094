/* The state of Lua that expressions run in, and what it may do and hold. */
#ifndef ZT_KEYFRAME_EXPRESSION_STATE_H
#define ZT_KEYFRAME_EXPRESSION_STATE_H

#include <lua.h>
#include <threads.h>

#include "base/arena.h"
#include "keyframe/expression.h"

enum {
    /* What lies at the bottom of Lua's stack while the state is open. */
    ZT_LUA_ON_ERROR = 1, /* the function that notes where an error was raised */
    ZT_LUA_ITEMS,        /* a table of the compiled functions and their vectors */
    ZT_LUA_BOTTOM = ZT_LUA_ITEMS,
    ZT_LUA_WORDS_MAX = 64
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
    const char *words[ZT_LUA_WORDS_MAX]; /* what the reader lets through; ends with NULL */
};

zt_status zt_lua_open(zt_expressions **out, zt_rate rate, double duration_s);
void zt_lua_close(zt_expressions **slot);

/* Before each call: how much memory and, where `steps` is so, how many steps it may take,
 * counted from here, as many expressions may be more than one call. */
void zt_lua_limit(zt_expressions *e, bool steps);

/* A vector of so many numbers on top of the stack, for the caller to fill; how many one has. */
double *zt_lua_push_vector(lua_State *L, int width);
int zt_lua_width(lua_State *L, int index);

/* "a number", for what is of one of Lua's types. */
const char *zt_lua_kind(int type);

#endif
