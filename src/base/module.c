/* The linker remembers what is loaded and locks where it must: asking again is cheap. */
#include "base/module.h"

#include <dlfcn.h>
#include <stdio.h>

#include "base/diag.h"
#include "base/text.h"

typedef struct left_out {
    const char *module, *library, *option;
} left_out;

/* What CMake was told to leave out. */
static const left_out *find_left_out(const char *name) {
    static const left_out all[] = {
#if defined ZOETROPE_WITHOUT_OPENIMAGEIO
        {"image_file", "OpenImageIO", "OPENIMAGEIO"},
#endif
#if defined ZOETROPE_WITHOUT_FFMPEG
        {"video", "FFmpeg", "FFMPEG"},
        {"video_palette", "FFmpeg", "FFMPEG"},
#endif
#if defined ZOETROPE_WITHOUT_EMBREE
        {"embree", "Embree", "EMBREE"},
#endif
#if defined ZOETROPE_WITHOUT_LUA
        {"expression", "Lua", "LUA"},
#endif
#if defined ZOETROPE_WITHOUT_RSVG
        {"raster", "librsvg", "RSVG"},
#endif
        {NULL, NULL, NULL}
    };
    for (const left_out *l = all; l->module; l++)
        if (zt_text_equal(l->module, name)) return l;
    return NULL;
}

bool zt_module_is_built(const char *name, const char *needed_by, zt_listener listener) {
    const left_out *l = find_left_out(name);
    if (l && needed_by)
        zt_tell(listener, ZT_ERROR,
                "%s cannot be had: this program was built without %s (ZOETROPE_WITH_%s=OFF)",
                needed_by, l->library, l->option);
    return !l;
}

const void *zt_module_door(const char *name, const char *needed_by, zt_listener listener) {
    char file[64], symbol[64];
    snprintf(file, sizeof file, "zoetrope-%s.so", name);
    snprintf(symbol, sizeof symbol, "zt_door_%s", name);
    if (!zt_module_is_built(name, needed_by, listener)) return NULL;
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
