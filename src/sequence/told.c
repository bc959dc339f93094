/* What frames need and what was left out of them, in words and numbers. */
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <zoetrope/stats.h>

#include "base/diag.h"
#include "base/module.h"
#include "keyframe/advice.h"
#include "sequence/renderer.h"

/* ---- numbers -------------------------------------------------------------------------------
 */

zt_stats zt_renderer_stats(const zt_renderer *r) { return r->stats; }

void zt_libraries(zt_library libraries[ZT_LIBRARY_COUNT]) {
    static const struct {
        const char *name, *what, *module;
    } known[ZT_LIBRARY_COUNT] = {{"OpenImageIO", "image files", "image_file"},
                                 {"FFmpeg", "movies", "video"},
                                 {"Embree", "meshes and crowds", "embree"},
                                 {"Lua", "expressions", "expression"},
                                 {"librsvg", "drawings as images", "raster"}};
    for (int i = 0; i < ZT_LIBRARY_COUNT; i++)
        libraries[i] = (zt_library){known[i].name, known[i].what,
                                    zt_module_is_built(known[i].module, NULL, (zt_listener){0}),
                                    zt_module_is_loaded(known[i].module)};
}

/* ---- sentences -----------------------------------------------------------------------------
 */

typedef struct teller {
    void (*say)(void *user, const char *sentence);
    void *user;
    const zt_animation *animation;
    const zt_exposure *exposure;
    const zt_needs *needs;
} teller;

__attribute__((format(printf, 2, 3))) static void say(const teller *t, const char *format,
                                                      ...) {
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    t->say(t->user, text);
}

static const char *object_name(const teller *t, int32_t object) {
    return zt_advice_name_of_object(t->animation, object).text;
}

/* Lights are counted by their kinds there. */
static const char *light_name(const teller *t, int32_t light) {
    static const zt_owner owners[] = {[ZT_LIGHT_AMBIENT] = ZT_OWNER_AMBIENT,
                                      [ZT_LIGHT_POINT] = ZT_OWNER_POINT,
                                      [ZT_LIGHT_DISK] = ZT_OWNER_DISK_LIGHT,
                                      [ZT_LIGHT_RECTANGLE] = ZT_OWNER_RECTANGLE_LIGHT};
    zt_owner owner = owners[t->exposure->moments->lights[light].kind];
    return zt_advice_name_of(t->animation, owner, light).text;
}

static const char *many(int32_t count) { return count == 1 ? "" : "s"; }

static void tell_mirrors(const teller *t) {
    const zt_needs *n = t->needs;
    const int32_t depth = t->exposure->moments->reflection_depth;
    if (n->mirror_count == 0)
        say(t, "no mirrors: secondary rays left out");
    else if (depth == 0)
        say(t, "%s mirrors, but no ray may meet a mirror: secondary rays left out",
            object_name(t, n->mirror));
    else if (n->mirror_depth == 0)
        say(t, "%s mirrors nothing, as all there is lies behind it: secondary rays left out",
            object_name(t, n->mirror));
    else
        say(t, "%" PRId32 " mirror%s: rays go on after at most %" PRId32 " of them",
            n->mirror_count, many(n->mirror_count), n->mirror_depth);
    if (n->mirror_depth > 0 && n->faint_depth < depth)
        say(t,
            "after %" PRId32 " mirrors, rays that are too faint to change a sum are left out",
            n->faint_depth + 1);
}

/* Names of things as a list; after a few, how many there are besides. */
typedef struct listing {
    char text[256];
    int count;
} listing;

static void list(listing *l, const char *name) {
    enum { LISTED = 3 };
    size_t length = strlen(l->text);
    if (l->count++ < LISTED)
        snprintf(l->text + length, sizeof l->text - length, "%s\"%s\"", length ? ", " : "",
                 name);
}

static void tell_reaching(const teller *t, const xform *worlds, int32_t light) {
    const zt_scene *scene = t->exposure->moments;
    listing behind = {0}, away = {0};
    int32_t plane = -1;
    for (int32_t i = 0; i < scene->object_count; i++) {
        if (scene->objects[i].shape == ZT_SHAPE_GROUP) continue;
        zt_reaching reaching = zt_needs_reaching(&plane, t->exposure, worlds, light, i);
        if (reaching != ZT_REACHES)
            list(reaching == ZT_REACHES_AWAY ? &away : &behind, object_name(t, i));
    }
    const listing *both[] = {&behind, &away};
    for (int i = 0; i < 2; i++) {
        char more[32] = "";
        if (both[i]->count > 3) snprintf(more, sizeof more, " and %d more", both[i]->count - 3);
        if (both[i]->count > 0)
            say(t, "%s never reaches %s%s%s: its shadow rays left out", light_name(t, light),
                both[i]->text, more, i ? ", to which it does not shine" : "");
    }
}

static zt_status tell_lights(const teller *t, zt_arena *arena) {
    const zt_exposure *e = t->exposure;
    const zt_scene *scene = e->moments;
    size_t count = (size_t)scene->object_count;
    xform *worlds = ZT_PUSH(arena, xform, count * (size_t)e->moment_count);
    if (!worlds) return ZT_EMEMORY;
    for (int32_t m = 0; m < e->moment_count; m++)
        zt_scene_worlds(worlds + (size_t)m * count, &e->moments[m], (vec3){0, 0, 0});
    int32_t lamps = 0;
    for (int32_t i = 0; i < scene->light_count; i++) {
        if (scene->lights[i].kind == ZT_LIGHT_AMBIENT) continue;
        lamps++;
        if (!t->needs->shines[i])
            say(t, "%s gives no light: its rays left out", light_name(t, i));
        else if (!t->needs->shadows[i])
            say(t, "%s casts no shadows: its shadow rays left out", light_name(t, i));
        else
            tell_reaching(t, worlds, i);
    }
    if (lamps == 0) say(t, "no lamps: shadow rays left out");
    return ZT_OK;
}

static void tell_rest(const teller *t) {
    const zt_needs *n = t->needs;
    if (n->moving_count > 0)
        say(t, "%" PRId32 " of %" PRId32 " object%s move%s while the shutter is open",
            n->moving_count, n->object_count, many(n->object_count),
            n->moving_count == 1 ? "s" : "");
    else if (t->exposure->moment_count == 1)
        say(t, "nothing moves while the shutter is open: times of rays left out");
    if (!n->has_opening) say(t, "a pinhole: places on the lens left out");
    if (n->pattern_count == 0) say(t, "no patterns: left out");
    if (n->mesh_count == 0)
        say(t, "no meshes: left out");
    else
        say(t, "%" PRId32 " mesh%s: built when a ray first comes near", n->mesh_count,
            n->mesh_count == 1 ? "" : "es, each");
}

int32_t zt_renderer_unmet(const zt_renderer *r,
                          void (*say_it)(void *user, const char *sentence), void *user) {
    const teller t = {.say = say_it, .user = user, .animation = r->animation};
    const zt_scene *rest = &r->animation->rest;
    int32_t count = 0;
    for (int32_t i = 0; r->stats.frames > 0 && i < rest->object_count; i++) {
        const zt_object *o = &rest->objects[i];
        if (o->shape != ZT_SHAPE_MESH || zt_meshes_met(r->meshes, o->mesh)) continue;
        count++;
        if (say_it) say(&t, "mesh \"%s\" is never met: not built", object_name(&t, i));
    }
    return count;
}

zt_status zt_renderer_needs(zt_renderer *r, int64_t frame,
                            void (*say_it)(void *user, const char *sentence), void *user) {
    zt_taking taking;
    ZT_TRY(zt_renderer_prepare(&taking, r, frame));
    teller t = {say_it, user, r->animation, &taking.exposure, &taking.ready.needs};
    tell_mirrors(&t);
    ZT_TRY(tell_lights(&t, &r->frame));
    tell_rest(&t);
    const char *hindrance = zt_reuse_hindrance(&taking.job);
    if (hindrance) say(&t, "%s", hindrance);
    return ZT_OK;
}
