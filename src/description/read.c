/* The top of a description: version, film, camera, and all that is put together below. */
#include <zoetrope/animation.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "description/constraints.h"
#include "description/curves.h"
#include "description/document.h"
#include "description/motion.h"
#include "description/objects.h"
#include "description/times.h"

#define COUNT(array) (int)(sizeof(array) / sizeof *(array))

enum {
    LANGUAGE_VERSION = 1,
    REFLECTIONS_MAX = 1000,
    SAMPLES_MAX = 65536,
    FRAME_COUNT_MAX = 100 * 1000 * 1000
};

/* ---- film -----------------------------------------------------------------------------------
 */

static void read_size(zt_film *film, zt_mistakes *mistakes, const zt_node *node) {
    int64_t size[2];
    if (node->kind != ZT_NODE_LIST || node->count != 2) {
        zt_expected(mistakes, node, "size", "a list of width and height");
        return;
    }
    for (int i = 0; i < 2; i++)
        if (!zt_read_integer(&size[i], mistakes, node->items[i], "size", 1, ZT_IMAGE_SIDE_MAX))
            return;
    film->width = (int)size[0];
    film->height = (int)size[1];
}

/* The frames whose times are before the end; an end that is nearly a frame's time is meant so.
 */
static void read_duration(zt_film *film, zt_mistakes *mistakes, const zt_node *node) {
    zt_moment end;
    if (!zt_read_moment(&end, mistakes, node, "duration", film->rate)) return;
    if (end.unit == ZT_TIME_PERCENT) {
        zt_mistake(mistakes, &node->place, "\"duration\" cannot be a share of itself");
        return;
    }
    bool whole = end.unit == ZT_TIME_FRAMES;
    double frames = whole ? (double)end.frame
                          : end.number * (double)film->rate.num / (double)film->rate.den;
    double nearest = round(frames);
    frames = fabs(frames - nearest) <= 1e-6 ? nearest : ceil(frames);
    if (whole ? end.frame < 1 : end.number <= 0)
        zt_mistake(mistakes, &node->place, "\"duration\" is %s; a film has at least one frame",
                   zt_show(node->text).text);
    else if (frames > FRAME_COUNT_MAX)
        zt_mistake(mistakes, &node->place,
                   "\"duration\" is %s: %.0f frames; a film has at most %d",
                   zt_show(node->text).text, frames, FRAME_COUNT_MAX);
    else
        film->frame_count = frames < 1 ? 1 : (int64_t)frames;
}

static zt_status read_film(zt_reading *reading, const zt_node *node) {
    static const char *const names[] = {"size",    "rate",        "duration", "view",
                                        "shading", "reflections", "samples"};
    static const char *const views[] = {[ZT_VIEW_RAW] = "raw", [ZT_VIEW_SRGB] = "srgb"};
    static const char *const shadings[] = {"classic"};
    zt_mistakes *mistakes = &reading->mistakes;
    zt_film *film = &reading->animation->film;
    zt_fields fields;
    ZT_TRY(zt_override_in(&node, reading, "film", names, COUNT(names)));
    if (!zt_fields_open(&fields, mistakes, node, "film", names, COUNT(names))) return ZT_OK;
    const zt_node *size = zt_field(&fields, "size"), *rate = zt_field(&fields, "rate"),
                  *duration = zt_field_required(&fields, mistakes, "duration", &node->place),
                  *view = zt_field(&fields, "view"), *shading = zt_field(&fields, "shading"),
                  *reflections = zt_field(&fields, "reflections"),
                  *samples = zt_field(&fields, "samples");
    int choice;
    int64_t number;
    if (size) read_size(film, mistakes, size);
    if (rate) zt_read_rate(&film->rate, mistakes, rate, "rate");
    if (duration) read_duration(film, mistakes, duration);
    if (view && zt_read_choice(&choice, mistakes, view, "view", views, COUNT(views)))
        film->view = (zt_view)choice;
    if (shading)
        zt_read_choice(&choice, mistakes, shading, "shading", shadings, COUNT(shadings));
    if (reflections &&
        zt_read_integer(&number, mistakes, reflections, "reflections", 0, REFLECTIONS_MAX))
        reading->animation->rest.reflection_depth = (int32_t)number;
    if (samples && zt_read_integer(&number, mistakes, samples, "samples", 1, SAMPLES_MAX))
        film->samples = (int)number;
    return ZT_OK;
}

/* ---- camera ---------------------------------------------------------------------------------
 */

static zt_status read_camera(zt_reading *reading, const zt_node *node) {
    const char *names[ZT_FIELD_NAMES_MAX];
    int name_count = zt_motion_names(names, ZT_OWNER_CAMERA);
    zt_fields fields;
    ZT_TRY(zt_override_in(&node, reading, "camera", names, name_count));
    if (!zt_fields_open(&fields, &reading->mistakes, node, "camera", names, name_count))
        return ZT_OK;
    ZT_TRY(zt_motion_read(reading, &fields, ZT_OWNER_CAMERA, 0, "camera", &node->place));
    const zt_node *aim = zt_field(&fields, "look_at"),
                  *rotation = zt_field(&fields, "rotation");
    reading->animation->rest.camera.aimed = aim != NULL;
    if (aim && rotation)
        zt_mistake(&reading->mistakes, &rotation->place,
                   "a camera has either \"look_at\" or \"rotation\"");
    return ZT_OK;
}

/* ---- all of it ------------------------------------------------------------------------------
 */

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
    if (film) ZT_TRY(read_film(reading, film));
    ZT_TRY(read_names(reading, &fields));
    if (camera) ZT_TRY(read_camera(reading, camera));
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
    animation->film = (zt_film){.width = 1280,
                                .height = 720,
                                .rate = {24, 1},
                                .frame_count = 1,
                                .view = ZT_VIEW_SRGB,
                                .samples = 1};
    animation->rest.reflection_depth = 4;
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
