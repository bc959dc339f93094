/* Modules: the doors to libraries that are slow to load, each a shared object of its own that
 * is loaded when it is first used.
 *
 * The header of such a door declares a struct of function pointers and names it in
 * zt_module_door(); its source ends with ZT_MODULE_DOOR(), the one symbol that the module
 * exports; CMake builds it with zoetrope_module(). A module has a copy of its own of the floors
 * below it: those keep no state between calls, and memory may cross, as there is one heap. */
#ifndef ZT_BASE_MODULE_H
#define ZT_BASE_MODULE_H

#include <stdbool.h>

#include <zoetrope/status.h>

/* The table of calls of the module `name`, which is the file zoetrope-<name>.so in a directory
 * that the program was linked to look in; it stays loaded until the program ends. Legal from
 * several threads at once. NULL where it cannot be had: what is missing, and that `needed_by`
 * ("expressions") needs it, is then told. */
const void *zt_module_door(const char *name, const char *needed_by, zt_listener listener);

/* Whether it was not left out when the program was built; where it was, that is told, as by
 * zt_module_door(), if there is something that needs it. */
bool zt_module_is_built(const char *name, const char *needed_by, zt_listener listener);

/* Whether something has needed it so far. */
bool zt_module_is_loaded(const char *name);

#ifdef __cplusplus
#define ZT_MODULE_C extern "C"
#else
#define ZT_MODULE_C extern
#endif

/* Defines a module's table: ZT_MODULE_DOOR(zt_expression_door, expression) = {...}; */
#define ZT_MODULE_DOOR(type, name)                                                             \
    ZT_MODULE_C __attribute__((visibility("default"))) const type zt_door_##name;              \
    const type zt_door_##name

#endif
