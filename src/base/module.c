/* The linker remembers what is loaded and locks where it must: asking again is cheap. */
#include "base/module.h"

#include <dlfcn.h>
#include <stdio.h>

#include "base/diag.h"

const void *zt_module_door(const char *name, const char *needed_by, zt_listener listener) {
    char file[64], symbol[64];
    snprintf(file, sizeof file, "zoetrope-%s.so", name);
    snprintf(symbol, sizeof symbol, "zt_door_%s", name);
    /* All of it is bound now, so that what is missing is known here and not in the middle. */
    void *module = dlopen(file, RTLD_NOW | RTLD_LOCAL);
    const void *door = module ? dlsym(module, symbol) : NULL;
    if (!door)
        zt_tell(listener, ZT_ERROR, "%s cannot be had, as %s cannot be loaded: %s", needed_by,
                file, dlerror());
    return door;
}

bool zt_module_is_loaded(const char *name) {
    char file[64];
    snprintf(file, sizeof file, "zoetrope-%s.so", name);
    void *module = dlopen(file, RTLD_NOW | RTLD_NOLOAD);
    if (module) dlclose(module);
    return module != NULL;
}
