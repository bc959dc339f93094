#include "sequence/settings.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <zoetrope/aov.h>

#include "base/diag.h"
#include "base/text.h"
#include "image/formats.h"
#include "sequence/json.h"
#include "sequence/pacing.h"

enum { SAMPLES_MAX = 65536, LIST_MAX = 1024 };

enum {
    KEY_VERSION,
    KEY_ARITHMETIC,
    KEY_SIZE,
    KEY_MIN,
    KEY_MAX,
    KEY_ERROR,
    KEY_MEAN_MAX,
    KEY_QUALITY,
    KEY_FILTER,
    KEY_FILTER_WIDTH,
    KEY_SEED,
    KEY_SEED_FIXED,
    KEY_PRECISION,
    KEY_VIEW,
    KEY_COLOR,
    KEY_AOVS,
    KEY_FORMAT,
    KEY_SET,
    KEY_COUNT
};

static const char *const keys[KEY_COUNT + 1] = {
    "zoetrope", "arithmetic", "size",         "min",  "max",        "error",     "mean_max",
    "quality",  "filter",     "filter_width", "seed", "seed_fixed", "precision", "view",
    "color",    "aovs",       "format",       "set",  NULL};

/* ---- writing -------------------------------------------------------------------------------
 */

static void print_key(FILE *file, int key) {
    fprintf(file, "%s\"%s\": ", key == KEY_VERSION ? "{" : ", ", keys[key]);
}

static void print_word(FILE *file, int key, const char *word) {
    print_key(file, key);
    zt_json_print_text(file, word);
}

static void print_integer(FILE *file, int key, int64_t number) {
    print_key(file, key);
    fprintf(file, "%" PRId64, number);
}

static void print_number(FILE *file, int key, double number) {
    print_key(file, key);
    zt_json_print_number(file, number);
}

/* An item of a list, which the first one begins. */
static void print_item(FILE *file, int key, bool *begun, const char *text) {
    if (*begun)
        fputs(", ", file);
    else
        print_key(file, key), putc('[', file);
    *begun = true;
    zt_json_print_text(file, text);
}

static void print_end(FILE *file, bool begun) {
    if (begun) putc(']', file);
}

static void print_sampling(FILE *file, const zt_sampling *s) {
    print_integer(file, KEY_MIN, s->min);
    print_integer(file, KEY_MAX, s->max);
    if (s->error > 0) print_number(file, KEY_ERROR, s->error);
    if (s->mean_max > 0) print_integer(file, KEY_MEAN_MAX, s->mean_max);
    if (s->edges) print_word(file, KEY_QUALITY, "edges");
    print_word(file, KEY_FILTER, zt_filter_name(s->filter));
    if (s->filter_width > 0) print_number(file, KEY_FILTER_WIDTH, s->filter_width);
    print_integer(file, KEY_SEED, s->seed);
    if (s->seed_fixed) print_integer(file, KEY_SEED_FIXED, 1);
}

/* Those that are asked for, of the names that there are. */
static void print_aovs(FILE *file, unsigned aovs) {
    bool begun = false;
    char names[LIST_MAX], *rest = NULL;
    snprintf(names, sizeof names, "%s", zt_aov_names());
    for (char *name = strtok_r(names, ", ", &rest); name; name = strtok_r(NULL, ", ", &rest)) {
        unsigned found;
        if (zt_aov_find(&found, name) && (found & ~aovs) == 0 && (found & (found - 1)) == 0)
            print_item(file, KEY_AOVS, &begun, name);
    }
    print_end(file, begun);
}

static void print_color(FILE *file, const zt_color_wish *color) {
    const char *const words[] = {color->config, color->display, color->view};
    bool begun = false;
    for (int i = 0; i < 3; i++) print_item(file, KEY_COLOR, &begun, words[i] ? words[i] : "");
    print_end(file, begun);
}

static void print(FILE *file, const zt_settings *s) {
    print_integer(file, KEY_VERSION, 1);
    print_word(file, KEY_ARITHMETIC, s->arithmetic);
    print_key(file, KEY_SIZE);
    fprintf(file, "[%d, %d]", s->width, s->height);
    print_sampling(file, &s->sampling);
    print_word(file, KEY_PRECISION, zt_precision_name(s->precision));
    print_word(file, KEY_VIEW, zt_view_name(s->view));
    if (s->color.wished) print_color(file, &s->color);
    print_aovs(file, s->aovs);
    if (s->format) print_word(file, KEY_FORMAT, s->format);
    bool begun = false;
    for (int i = 0; i < s->override_count; i++) {
        print_item(file, KEY_SET, &begun, s->overrides[i].name);
        print_item(file, KEY_SET, &begun, s->overrides[i].value);
    }
    print_end(file, begun);
    putc('}', file);
}

zt_status zt_settings_print(const char **out, const zt_settings *settings, zt_arena *arena) {
    char *text = NULL;
    size_t length = 0;
    *out = NULL;
    FILE *file = open_memstream(&text, &length);
    if (!file) return ZT_EMEMORY;
    print(file, settings);
    if (fclose(file) == 0) *out = zt_arena_push_text(arena, text, length);
    free(text);
    return *out ? ZT_OK : ZT_EMEMORY;
}

/* Nothing but the numbers of samples is a frame's own. */
static bool as_many(const zt_sampling *a, const zt_sampling *b) {
    return a->min == b->min && a->max == b->max && a->error == b->error &&
           a->mean_max == b->mean_max && a->edges == b->edges;
}

static zt_status print_of(const char **text, const zt_renderer *r, const zt_film_order *order,
                          const zt_sampling *sampling, zt_arena *arena) {
    char *format = NULL;
    zt_image_wishes wishes;
    if (zt_image_wish(&wishes, order->target, order->options, (zt_listener){0}) == ZT_OK &&
        !(format = zt_image_wishes_text(&wishes)))
        return ZT_EMEMORY;
    const zt_settings settings = {.width = r->format.width,
                                  .height = r->format.height,
                                  .sampling = *sampling,
                                  .precision = r->precision,
                                  .aovs = format ? r->aovs : 0, /* movies have none */
                                  .view = r->format.view,
                                  .color = r->format.color,
                                  .format = format,
                                  .overrides = order->overrides,
                                  .override_count = order->override_count,
                                  .arithmetic = zt_arithmetic};
    zt_status status = zt_settings_print(text, &settings, arena);
    free(format);
    return status;
}

zt_status zt_settings_of_film(const char **text, const zt_renderer *r,
                              const zt_film_order *order, zt_arena *arena) {
    return print_of(text, r, order, &r->sampling, arena);
}

zt_status zt_settings_of_frame(zt_settings_texts *texts, const zt_renderer *r,
                               const zt_film_order *order, int64_t frame) {
    zt_sampling sampling;
    ZT_TRY(zt_pacing_sampling(&sampling, r, frame));
    if (texts->text && as_many(&sampling, &texts->sampling)) return ZT_OK;
    texts->sampling = sampling;
    return print_of(&texts->text, r, order, &sampling, &texts->arena);
}

/* ---- reading -------------------------------------------------------------------------------
 */

typedef struct reading {
    zt_settings *s;
    zt_json json;
    zt_arena *arena;
    size_t length; /* of the whole text, which no part of it is longer than */
} reading;

static zt_status read_text(const char **text, reading *r) {
    char *room = ZT_PUSH(r->arena, char, r->length + 1);
    *text = room;
    return room ? zt_json_text(&r->json, room, r->length + 1) : ZT_EMEMORY;
}

static zt_status read_count(int *count, reading *r) {
    int64_t number;
    ZT_TRY(zt_json_integer(&r->json, &number, 1, SAMPLES_MAX));
    *count = (int)number;
    return ZT_OK;
}

/* A word by its place among `count` names. */
static zt_status read_name(int *choice, reading *r, int key, int count,
                           const char *(*name)(int choice)) {
    char text[64];
    ZT_TRY(zt_json_text(&r->json, text, sizeof text));
    for (*choice = 0; *choice < count; ++*choice)
        if (zt_text_equal(name(*choice), text)) return ZT_OK;
    return zt_json_refuse(&r->json, "there is no %s of this name", keys[key]);
}

static const char *name_filter(int filter) { return zt_filter_name((zt_filter)filter); }
static const char *name_precision(int p) { return zt_precision_name((zt_precision)p); }
static const char *name_view(int view) { return zt_view_name((zt_view)view); }
static const char *name_quality(int quality) { return quality ? "edges" : "even"; }

static zt_status read_size(reading *r) {
    int64_t width, height;
    ZT_TRY(zt_json_mark(&r->json, '['));
    ZT_TRY(zt_json_integer(&r->json, &width, 1, ZT_IMAGE_SIDE_MAX));
    ZT_TRY(zt_json_mark(&r->json, ','));
    ZT_TRY(zt_json_integer(&r->json, &height, 1, ZT_IMAGE_SIDE_MAX));
    r->s->width = (int)width;
    r->s->height = (int)height;
    return zt_json_mark(&r->json, ']');
}

/* Texts, `*count` of them and NULL behind. */
static zt_status read_list(const char ***list, int *count, reading *r) {
    bool more = true;
    *list = ZT_PUSH(r->arena, const char *, LIST_MAX + 1);
    if (!*list) return ZT_EMEMORY;
    ZT_TRY(zt_json_mark(&r->json, '['));
    for (*count = 0; more;) {
        if (*count == LIST_MAX) return zt_json_refuse(&r->json, "this list is too long");
        ZT_TRY(read_text(&(*list)[(*count)++], r));
        ZT_TRY(zt_json_more(&r->json, &more, ']'));
    }
    return ZT_OK;
}

static zt_status read_aovs(reading *r) {
    const char **names;
    int count;
    ZT_TRY(read_list(&names, &count, r));
    for (int i = 0; i < count; i++) {
        unsigned found;
        if (!zt_aov_find(&found, names[i]))
            return zt_json_refuse(&r->json, "there is no channel called %s", names[i]);
        r->s->aovs |= found;
    }
    return ZT_OK;
}

static zt_status read_color(reading *r) {
    const char **words;
    int count;
    ZT_TRY(read_list(&words, &count, r));
    if (count != 3) return zt_json_refuse(&r->json, "here must be three texts");
    for (int i = 0; i < 3; i++)
        if (!*words[i]) words[i] = NULL;
    r->s->color = (zt_color_wish){true, words[0], words[1], words[2]};
    return ZT_OK;
}

static zt_status read_overrides(reading *r) {
    const char **texts;
    int count;
    ZT_TRY(read_list(&texts, &count, r));
    if (count % 2) return zt_json_refuse(&r->json, "a name without a value");
    zt_override *overrides = ZT_PUSH(r->arena, zt_override, (size_t)count / 2);
    if (!overrides) return ZT_EMEMORY;
    for (int i = 0; i < count / 2; i++)
        overrides[i] = (zt_override){texts[2 * i], texts[2 * i + 1]};
    r->s->overrides = overrides;
    r->s->override_count = count / 2;
    return ZT_OK;
}

static zt_status read_choice(reading *r, int key) {
    zt_settings *s = r->s;
    int choice = 0;
    switch (key) {
    case KEY_QUALITY:
        ZT_TRY(read_name(&choice, r, key, 2, name_quality));
        s->sampling.edges = choice == 1;
        break;
    case KEY_FILTER:
        ZT_TRY(read_name(&choice, r, key, ZT_FILTER_COUNT, name_filter));
        s->sampling.filter = (zt_filter)choice;
        break;
    case KEY_PRECISION:
        ZT_TRY(read_name(&choice, r, key, ZT_PRECISION_DOUBLE + 1, name_precision));
        s->precision = (zt_precision)choice;
        break;
    default:
        ZT_TRY(read_name(&choice, r, key, ZT_VIEW_COUNT, name_view));
        s->view = (zt_view)choice;
    }
    return ZT_OK;
}

static zt_status read_field(reading *r, int key) {
    zt_sampling *s = &r->s->sampling;
    int64_t number = 0;
    switch (key) {
    case KEY_VERSION:
        return zt_json_integer(&r->json, &number, 1, 1);
    case KEY_ARITHMETIC:
        return read_text(&r->s->arithmetic, r);
    case KEY_SIZE:
        return read_size(r);
    case KEY_MIN:
        return read_count(&s->min, r);
    case KEY_MAX:
        return read_count(&s->max, r);
    case KEY_ERROR:
        return zt_json_number(&r->json, &s->error, 0, 1);
    case KEY_MEAN_MAX:
        return read_count(&s->mean_max, r);
    case KEY_FILTER_WIDTH:
        return zt_json_number(&r->json, &s->filter_width, 0.1, 16);
    case KEY_SEED:
        ZT_TRY(zt_json_integer(&r->json, &number, 0, UINT32_MAX));
        s->seed = (uint32_t)number;
        return ZT_OK;
    case KEY_SEED_FIXED:
        s->seed_fixed = true;
        return zt_json_integer(&r->json, &number, 1, 1);
    case KEY_COLOR:
        return read_color(r);
    case KEY_AOVS:
        return read_aovs(r);
    case KEY_FORMAT:
        return read_text(&r->s->format, r);
    case KEY_SET:
        return read_overrides(r);
    default:
        return read_choice(r, key);
    }
}

static zt_status read_all(reading *r) {
    static const unsigned needed = 1U << KEY_VERSION | 1U << KEY_ARITHMETIC | 1U << KEY_SIZE |
                                   1U << KEY_MIN | 1U << KEY_MAX | 1U << KEY_FILTER |
                                   1U << KEY_PRECISION | 1U << KEY_VIEW;
    unsigned has = 0;
    bool more;
    ZT_TRY(zt_json_mark(&r->json, '{'));
    do {
        int key;
        ZT_TRY(zt_json_key(&r->json, &key, keys));
        if (has & 1U << key)
            return zt_json_refuse(&r->json, "\"%s\" is there twice", keys[key]);
        has |= 1U << key;
        ZT_TRY(read_field(r, key));
        ZT_TRY(zt_json_more(&r->json, &more, '}'));
    } while (more);
    for (int key = 0; key < KEY_COUNT; key++)
        if (needed & ~has & 1U << key)
            return zt_json_refuse(&r->json, "\"%s\" is missing", keys[key]);
    if (r->s->sampling.min > r->s->sampling.max)
        return zt_json_refuse(&r->json, "\"max\" is below \"min\"");
    return zt_json_end(&r->json);
}

zt_status zt_settings_read(zt_settings *settings, const char *text, const char *path,
                           zt_arena *arena, zt_listener listener) {
    *settings = (zt_settings){0};
    reading r = {.s = settings, .arena = arena, .length = strlen(text)};
    ZT_TRY(zt_json_open_text(&r.json, text, path, listener));
    zt_status status = read_all(&r);
    zt_json_close(&r.json);
    return status;
}

zt_status zt_settings_options(const zt_wish **out, const zt_settings *settings,
                              zt_arena *arena) {
    const char *format = settings->format ? settings->format : "";
    zt_wish *options = ZT_PUSH(arena, zt_wish, strlen(format) + 2);
    char *rest = zt_arena_push_text(arena, format, strlen(format));
    *out = options;
    if (!options || !rest) return ZT_EMEMORY;
    for (char *option; (option = strsep(&rest, ",")); options++)
        if (*option) *options = (zt_wish){"format-option", option};
    return ZT_OK;
}
