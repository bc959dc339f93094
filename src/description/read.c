/* The top of a description: its version, and all that is put together below. */
#include <zoetrope/animation.h>

#include <stdlib.h>
#include <string.h>

#include "description/camera.h"
#include "description/constraints.h"
#include "description/curves.h"
#include "description/document.h"
#include "description/film.h"
#include "description/motion.h"
#include "description/objects.h"

#define COUNT(array) (int)(sizeof(array) / sizeof *(array))

enum { LANGUAGE_VERSION = 1 };

/* Whether the description is written in another version of the language: then nothing else in
 * it is judged. */
static bool is_other_version(zt_mistakes *mistakes, const zt_node *root) {
    const zt_node *node = root->kind == ZT_NODE_MAPPING
                              ? zt_field(&(zt_fields){.mapping = root}, "zoetrope")
                              : NULL;
    int64_t version;
    if (!node || !zt_read_integer(&version, mistakes, node, "zoetrope", 0, INT32_MAX) ||
        version == LANGUAGE_VERSION)
        return false;
    zt_mistake(mistakes, &node->place,
               "this is version %d of the language; this program reads version %d",
               (int)version, LANGUAGE_VERSION);
    return true;
}

static void warn_of_nothing(const zt_reading *reading, const zt_node *root) {
    const zt_scene *rest = &reading->animation->rest;
    if (rest->object_count == 0)
        zt_tell_at(reading->mistakes.listener, ZT_WARNING, &root->place,
                   "there are no objects: the film will be black");
    else if (rest->light_count == 0)
        zt_tell_at(reading->mistakes.listener, ZT_WARNING, &root->place,
                   "there are no lights: the film will be black");
}

/* The names that the parts of a description share. */
static zt_status read_names(zt_reading *reading, const zt_fields *fields) {
    ZT_TRY(zt_names_open(&reading->timings, reading, zt_field(fields, "timings"), "timings",
                         "a mapping of names to lists of times"));
    ZT_TRY(zt_names_open(&reading->curves, reading, zt_field(fields, "curves"), "curves",
                         "a mapping of names to keys"));
    zt_curves_check(reading);
    return ZT_OK;
}

static zt_status read_root(zt_reading *reading, const zt_node *root, const char *directory) {
    static const char *const names[] = {"zoetrope", "film",    "camera", "materials", "lights",
                                        "objects",  "timings", "curves", "variables"};
    zt_mistakes *mistakes = &reading->mistakes;
    zt_fields fields;
    if (is_other_version(mistakes, root)) return ZT_OK;
    ZT_TRY(zt_variables_apply(reading, root));
    if (!zt_fields_open(&fields, mistakes, root, "description", names, COUNT(names)))
        return ZT_OK;
    if (!zt_field_required(&fields, mistakes, "zoetrope", &root->place))
        zt_mistake_note(mistakes, &root->place, "a description begins with \"zoetrope: %d\"",
                        LANGUAGE_VERSION);
    const zt_node *film = zt_field_required(&fields, mistakes, "film", &root->place);
    const zt_node *camera = zt_field_required(&fields, mistakes, "camera", &root->place);
    if (film) ZT_TRY(zt_film_read(reading, film, directory));
    ZT_TRY(read_names(reading, &fields));
    if (camera) ZT_TRY(zt_camera_read(reading, camera));
    ZT_TRY(zt_objects_read(reading, directory, zt_field(&fields, "materials"),
                           zt_field(&fields, "lights"), zt_field(&fields, "objects")));
    ZT_TRY(zt_motion_close(reading));
    zt_overrides_close(reading);
    ZT_TRY(zt_constraints_close(reading));
    if (mistakes->count == 0) warn_of_nothing(reading, root);
    return ZT_OK;
}

static zt_status read_all(zt_reading *reading, const char *path, const zt_override *overrides,
                          int override_count) {
    zt_arena *texts = &reading->animation->arena;
    zt_mistakes *mistakes = &reading->mistakes;
    zt_source source;
    const zt_node *root;
    ZT_TRY(zt_overrides_open(reading, overrides, override_count));
    ZT_TRY(zt_source_read(&source, texts, path, mistakes));
    ZT_TRY(zt_document_read(&root, reading->temporary, &source, mistakes));
    if (!root) {
        zt_mistake(mistakes, &(zt_place){.file = source.file}, "the description is empty");
        return ZT_OK;
    }
    const char *slash = strrchr(path, '/');
    const char *directory =
        zt_arena_push_text(reading->temporary, path, slash ? (size_t)(slash + 1 - path) : 0);
    if (!directory) return ZT_EMEMORY;
    return read_root(reading, root, directory);
}

zt_status zt_animation_read(zt_animation **out, const char *path, const zt_override *overrides,
                            int override_count, zt_listener listener) {
    *out = NULL;
    zt_arena temporary = {0};
    zt_reading reading = {.mistakes.listener = listener, .temporary = &temporary};
    zt_animation *animation = reading.animation = calloc(1, sizeof *animation);
    if (!animation) return ZT_EMEMORY;
    zt_film_rest(animation);
    zt_status status = read_all(&reading, path, overrides, override_count);
    zt_arena_free(&temporary);
    if (status == ZT_OK || status == ZT_EDESCRIPTION) {
        zt_status mistakes = zt_mistakes_close(&reading.mistakes, path);
        if (status == ZT_OK) status = mistakes;
    }
    if (status == ZT_EMEMORY) zt_tell(listener, ZT_ERROR, "not enough memory to read %s", path);
    if (status == ZT_OK)
        *out = animation;
    else
        zt_animation_free(&animation);
    return status;
}
