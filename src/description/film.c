/* What a description says of the film as a whole: its pictures, and when they are taken. */
#include "description/film.h"

#include <zoetrope/aov.h>

#include <math.h>
#include <string.h>

#include "description/times.h"

#define COUNT(array) (int)(sizeof(array) / sizeof *(array))

enum { REFLECTIONS_MAX = 1000, SAMPLES_MAX = 65536, FRAME_COUNT_MAX = 100 * 1000 * 1000 };

/* Where adaptive sampling says nothing else: samples a pixel, of which there are at least so
 * many more at most than at least; and the error that refined edges may have where they take a
 * hundred: with fewer they are held to less (zt_canvas_share), so that a picture's is far
 * below what a display of 8 bits can tell apart. */
enum { MIN_SAMPLES = 4, MAX_SAMPLES = 64, MAX_PER_MIN = 4 };
#define EDGES_ERROR 0.01

/* A smaller error is none that can be estimated. */
#define ERROR_LEAST 1e-6

/* What moves may be off by a quarter of a pixel, or by what is said, but a number of moments
 * has to do. */
#define CHORD_ERROR 0.25
#define CHORD_LEAST 0.01

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

/* "shutter: 180 deg", or a mapping of "angle", "phase", which become shares of the time of a
 * frame, a turn of 360 degrees, and "error". */
static void read_shutter(zt_shutter *shutter, zt_mistakes *mistakes, const zt_node *node) {
    static const char *const names[] = {"angle", "phase", "error"};
    const double turn = 2 * 3.14159265358979323846;
    const zt_range open = {0, 3600, "deg"}, any = {-3600, 3600, "deg"},
                   pixels = {CHORD_LEAST, 16, NULL};
    double angle = 0, phase = 0;
    if (node->kind != ZT_NODE_MAPPING) {
        zt_read_angle(&angle, mistakes, node, "shutter", open);
    } else {
        zt_fields fields;
        zt_fields_open(&fields, mistakes, node, "shutter", names, COUNT(names));
        const zt_node *width = zt_field_required(&fields, mistakes, "angle", &node->place),
                      *begin = zt_field(&fields, "phase"), *error = zt_field(&fields, "error");
        if (width) zt_read_angle(&angle, mistakes, width, "angle", open);
        if (begin) zt_read_angle(&phase, mistakes, begin, "phase", any);
        if (error) zt_read_number(&shutter->error, mistakes, error, "error", pixels);
    }
    shutter->open = phase / turn;
    shutter->close = (phase + angle) / turn;
}

/* Whether something is written as a number, so that a number is meant. */
static bool is_number(const zt_node *node) {
    double number;
    const char *unit;
    return zt_read_quantity(&number, &unit, node);
}

/* "samples: 64": as many for all, or where edges are refined, as many at most. */
static void read_count(zt_sampling *sampling, zt_mistakes *mistakes, const zt_node *node) {
    int64_t count;
    if (!is_number(node))
        zt_expected(mistakes, node, "samples",
                    "a whole number, or \"min\", \"max\" and \"error\"");
    else if (zt_read_integer(&count, mistakes, node, "samples", 1, SAMPLES_MAX))
        sampling->max = (int)count;
    if (!sampling->edges) sampling->min = sampling->max;
}

/* "samples: { min: 4, max: 256, error: 0.002 }": as many as the error asks for. */
static void read_samples(zt_sampling *sampling, zt_mistakes *mistakes, const zt_node *node) {
    static const char *const names[] = {"min", "max", "error"};
    if (node->kind != ZT_NODE_MAPPING) {
        read_count(sampling, mistakes, node);
        return;
    }
    zt_fields fields;
    zt_fields_open(&fields, mistakes, node, "samples", names, COUNT(names));
    const zt_node *min_node = zt_field(&fields, "min"), *max_node = zt_field(&fields, "max"),
                  *error = sampling->edges
                               ? zt_field(&fields, "error")
                               : zt_field_required(&fields, mistakes, "error", &node->place);
    int64_t min = sampling->edges ? 1 : MIN_SAMPLES, max = MAX_SAMPLES;
    if (error)
        zt_read_number(&sampling->error, mistakes, error, "error",
                       (zt_range){ERROR_LEAST, 1, NULL});
    bool read = !min_node || zt_read_integer(&min, mistakes, min_node, "min", 1, SAMPLES_MAX);
    if (max < min * MAX_PER_MIN) max = min * MAX_PER_MIN;
    if (max > SAMPLES_MAX) max = SAMPLES_MAX;
    read &= !max_node || zt_read_integer(&max, mistakes, max_node, "max", 1, SAMPLES_MAX);
    if (!read) return;
    if (min_node && max_node && max < min) {
        zt_mistake(mistakes, &max_node->place, "\"max\" is %s, and \"min\" is %s",
                   zt_show(max_node->text).text, zt_show(min_node->text).text);
        zt_mistake_note(mistakes, &min_node->place, "\"min\" stands here");
    }
    sampling->max = (int)max;
    sampling->min = (int)(min < max ? min : max);
}

/* "filter: gaussian", or a mapping of "kind" and "width" from end to end. */
static void read_filter(zt_sampling *sampling, zt_mistakes *mistakes, const zt_node *node) {
    static const char *const names[] = {"kind", "width"};
    const char *filters[ZT_FILTER_COUNT];
    for (int f = 0; f < ZT_FILTER_COUNT; f++) filters[f] = zt_filter_name((zt_filter)f);
    const zt_node *kind = node;
    int choice;
    if (node->kind == ZT_NODE_MAPPING) {
        zt_fields fields;
        zt_fields_open(&fields, mistakes, node, "filter", names, COUNT(names));
        const zt_node *width = zt_field(&fields, "width");
        kind = zt_field_required(&fields, mistakes, "kind", &node->place);
        if (width)
            zt_read_number(&sampling->filter_width, mistakes, width, "width",
                           (zt_range){0.1, 16, NULL});
    }
    if (kind && zt_read_choice(&choice, mistakes, kind, "filter", filters, COUNT(filters)))
        sampling->filter = (zt_filter)choice;
}

/* "seed: 7", or "seed: fixed". */
static void read_seed(zt_sampling *sampling, zt_mistakes *mistakes, const zt_node *node) {
    int64_t number;
    if (node->kind == ZT_NODE_TEXT && zt_text_equal(node->text, "fixed"))
        sampling->seed_fixed = true;
    else if (!is_number(node))
        zt_expected(mistakes, node, "seed", "a whole number or \"fixed\"");
    else if (zt_read_integer(&number, mistakes, node, "seed", 0, UINT32_MAX))
        sampling->seed = (uint32_t)number;
}

static void read_sampling(zt_sampling *sampling, zt_mistakes *mistakes,
                          const zt_fields *fields) {
    static const char *const qualities[] = {"even", "edges"};
    const zt_node *samples = zt_field(fields, "samples"), *filter = zt_field(fields, "filter"),
                  *quality = zt_field(fields, "quality"), *seed = zt_field(fields, "seed");
    int choice;
    if (quality &&
        zt_read_choice(&choice, mistakes, quality, "quality", qualities, COUNT(qualities)))
        sampling->edges = choice == 1;
    if (sampling->edges)
        *sampling =
            (zt_sampling){.min = 1, .max = MAX_SAMPLES, .error = EDGES_ERROR, .edges = true};
    if (samples) read_samples(sampling, mistakes, samples);
    if (sampling->min == sampling->max) sampling->error = 0; /* all have as many */
    if (filter) read_filter(sampling, mistakes, filter);
    if (seed) read_seed(sampling, mistakes, seed);
}

static void read_aov(unsigned *aovs, zt_mistakes *mistakes, const zt_node *node) {
    unsigned found;
    if (node->kind == ZT_NODE_TEXT && zt_aov_find(&found, node->text))
        *aovs |= found;
    else
        zt_expected(mistakes, node, "aovs", zt_aov_names());
}

/* "aovs: [Z, N]", or one name alone. */
static void read_aovs(unsigned *aovs, zt_mistakes *mistakes, const zt_node *node) {
    if (node->kind != ZT_NODE_LIST) read_aov(aovs, mistakes, node);
    for (int32_t i = 0; node->kind == ZT_NODE_LIST && i < node->count; i++)
        read_aov(aovs, mistakes, node->items[i]);
}

/* A file's name, beside the description where it is not from the root. NULL where it is none,
 * which is told. Whether the file is there and of use is for those to say who need it. */
static zt_status read_path(const char **path, zt_reading *reading, const zt_node *node,
                           const char *what, const char *directory) {
    *path = NULL;
    const char *name = zt_read_text(&reading->mistakes, node, what);
    if (!name) return ZT_OK;
    if (*name == '/') directory = "";
    size_t directory_length = strlen(directory), length = directory_length + strlen(name);
    char *whole = ZT_PUSH(&reading->animation->arena, char, length + 1);
    if (!whole) return ZT_EMEMORY;
    memcpy(whole, directory, directory_length);
    memcpy(whole + directory_length, name, length - directory_length + 1);
    *path = whole;
    return ZT_OK;
}

static zt_status read_name(const char **name, zt_reading *reading, const zt_node *node,
                           const char *what) {
    const char *text = zt_read_text(&reading->mistakes, node, what);
    if (!text) return ZT_OK;
    *name = zt_arena_push_text(&reading->animation->arena, text, strlen(text));
    return *name ? ZT_OK : ZT_EMEMORY;
}

/* "color: { config: studio.ocio, display: sRGB, view: Film }", each of them or none. */
static zt_status read_color(zt_reading *reading, const zt_node *node, const zt_node *film_view,
                            const char *directory) {
    static const char *const names[] = {"config", "display", "view"};
    zt_color_wish *color = &reading->animation->film.color;
    zt_mistakes *mistakes = &reading->mistakes;
    zt_fields fields;
    if (!zt_fields_open(&fields, mistakes, node, "color", names, COUNT(names))) return ZT_OK;
    const zt_node *config = zt_field(&fields, "config"),
                  *display = zt_field(&fields, "display"), *view = zt_field(&fields, "view");
    if (film_view) {
        zt_mistake(mistakes, &node->place, "a film has \"view\" or \"color\", not both");
        zt_mistake_note(mistakes, &film_view->place, "\"view\" stands here");
    }
    color->wished = true;
    if (config) ZT_TRY(read_path(&color->config, reading, config, "config", directory));
    if (display) ZT_TRY(read_name(&color->display, reading, display, "display"));
    return view ? read_name(&color->view, reading, view, "view") : ZT_OK;
}

zt_status zt_film_read(zt_reading *reading, const zt_node *node, const char *directory) {
    static const char *const names[] = {
        "size",    "rate", "duration", "view",  "shading", "reflections", "samples", "filter",
        "quality", "seed", "shutter",  "audio", "aovs",    "background",  "color"};
    const char *views[ZT_VIEW_COUNT];
    for (int v = 0; v < ZT_VIEW_COUNT; v++) views[v] = zt_view_name((zt_view)v);
    static const char *const shadings[] = {"classic"};
    static const char *const backgrounds[] = {"opaque", "transparent"};
    zt_mistakes *mistakes = &reading->mistakes;
    zt_film *film = &reading->animation->film;
    zt_fields fields;
    ZT_TRY(zt_override_in(&node, reading, "film", names, COUNT(names)));
    if (!zt_fields_open(&fields, mistakes, node, "film", names, COUNT(names))) return ZT_OK;
    const zt_node *size = zt_field(&fields, "size"), *rate = zt_field(&fields, "rate"),
                  *duration = zt_field_required(&fields, mistakes, "duration", &node->place),
                  *view = zt_field(&fields, "view"), *shading = zt_field(&fields, "shading"),
                  *reflections = zt_field(&fields, "reflections"),
                  *shutter = zt_field(&fields, "shutter"), *audio = zt_field(&fields, "audio"),
                  *aovs = zt_field(&fields, "aovs"),
                  *background = zt_field(&fields, "background"),
                  *color = zt_field(&fields, "color");
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
    if (shutter) read_shutter(&film->shutter, mistakes, shutter);
    if (aovs) read_aovs(&film->aovs, mistakes, aovs);
    if (background && zt_read_choice(&choice, mistakes, background, "background", backgrounds,
                                     COUNT(backgrounds)))
        film->transparent = choice == 1;
    read_sampling(&film->sampling, mistakes, &fields);
    if (color) ZT_TRY(read_color(reading, color, view, directory));
    return audio ? read_path(&film->audio, reading, audio, "audio", directory) : ZT_OK;
}

void zt_film_rest(zt_animation *animation) {
    animation->film = (zt_film){.width = 1280,
                                .height = 720,
                                .rate = {24, 1},
                                .frame_count = 1,
                                .view = ZT_VIEW_SRGB,
                                .sampling = {.min = 1, .max = 1},
                                .shutter = {.error = CHORD_ERROR}};
    animation->rest.reflection_depth = 4;
}
