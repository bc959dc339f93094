#include "encode/names.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <zoetrope/aov.h>
#include <zoetrope/output.h>

#include "base/diag.h"
#include "base/text.h"

enum { DIGITS_MAX = 20 };
static const char layer_place[] = "{layer}";

void zt_names_free(zt_names *names) {
    free(names->before);
    free(names->after);
    free(names->layers);
    *names = (zt_names){0};
}

static zt_status refuse(const char *target, const char *why, zt_listener listener) {
    zt_tell(listener, ZT_ERROR, "cannot use %s as a name for images: %s", target, why);
    return ZT_EARGUMENT;
}

/* The place of the frame number: a run of # or of @, or a %d, %04d. Returns its end and its
 * digits; NULL where `place` is something else. The text itself never goes to printf. */
static const char *read_place(const char *place, int *digits) {
    if (*place != '%') {
        size_t length = strspn(place, *place == '#' ? "#" : "@");
        *digits = length <= DIGITS_MAX ? (int)length : 0;
        return *digits ? place + length : NULL;
    }
    *digits = 1;
    place++;
    if (*place == '0') {
        char *end;
        long number = strspn(place, "0123456789") <= 3 ? strtol(place, &end, 10) : 0;
        if (number < 1 || number > DIGITS_MAX) return NULL;
        *digits = (int)number;
        place = end;
    }
    return *place == 'd' ? place + 1 : NULL;
}

/* Only the file's own name has a place for the number: directories are as they are. */
static zt_status read_pattern(zt_names *names, const char *target, zt_listener listener) {
    const char *slash = strrchr(target, '/');
    const char *place = strpbrk(slash ? slash : target, "#@%");
    if (place) {
        const char *end = read_place(place, &names->digits);
        if (!end)
            return refuse(target,
                          "the frame number is written as #### or @@@@ (one for each digit) "
                          "or %04d (%d: as many as needed), with 1 to 20 digits",
                          listener);
        if (strpbrk(end, "#@%"))
            return refuse(target, "it has more than one place for the frame number", listener);
        names->after = strdup(end);
        if (!names->after) return ZT_EMEMORY;
    }
    names->before = place ? strndup(target, (size_t)(place - target)) : strdup(target);
    return names->before ? ZT_OK : ZT_EMEMORY;
}

static void add_layer(zt_names *names, const char *layer) {
    for (int i = 0; i < names->count; i++)
        if (strcmp(names->layers[i], layer) == 0) return;
    snprintf(names->layers[names->count++], ZT_LAYER_NAME_MAX, "%s", layer);
}

static zt_status find_layers(zt_names *names, unsigned aovs) {
    zt_image *least;
    ZT_TRY(zt_image_create(&least, 1, 1));
    zt_status status = zt_image_add_aovs(least, aovs);
    names->layers = calloc((size_t)least->channel_count + 1, sizeof *names->layers);
    if (!names->layers) status = ZT_EMEMORY;
    names->count = 0;
    if (status == ZT_OK) add_layer(names, ZT_LAYER_COLOURS);
    for (int c = 0; status == ZT_OK && c < least->channel_count; c++) {
        char layer[ZT_LAYER_NAME_MAX];
        zt_layer_of(layer, least->channels[c].name);
        add_layer(names, layer);
    }
    zt_image_free(&least);
    return status;
}

zt_status zt_names_read(zt_names *names, const char *target, unsigned aovs,
                        zt_listener listener) {
    *names = (zt_names){.count = 1};
    zt_status status = read_pattern(names, target, listener);
    if (status == ZT_OK && strstr(target, layer_place)) status = find_layers(names, aovs);
    if (status != ZT_OK) zt_names_free(names);
    return status;
}

const char *zt_names_layer(const zt_names *names, int file) {
    return names->layers ? names->layers[file] : NULL;
}

/* `text`, which is freed, with `value` in each place of `place`. */
static char *put(char *text, const char *place, const char *value) {
    size_t from = 0;
    for (char *found; text && (found = strstr(text + from, place));) {
        char *next =
            zt_text_print("%.*s%s%s", (int)(found - text), text, value, found + strlen(place));
        from = (size_t)(found - text) + strlen(value);
        free(text);
        text = next;
    }
    return text;
}

char *zt_names_path(const zt_names *names, int64_t frame, int file) {
    char *path = names->after ? zt_text_print("%s%.*" PRId64 "%s", names->before, names->digits,
                                              frame, names->after)
                              : strdup(names->before);
    return names->layers ? put(path, layer_place, names->layers[file]) : path;
}

/* A name as a part of a file's: without what would lead elsewhere, be a place for something, or
 * hide the file. */
static char *as_part(const char *name) {
    char *part = strdup(*name ? name : "_");
    for (char *c = part; c && *c; c++)
        if (strchr("/\\#@%{}:", *c) || (unsigned char)*c < ' ' || (*c == '.' && c == part))
            *c = '_';
    return part;
}

zt_status zt_output_target(char **path, const char *target, const char *name,
                           const char *camera, zt_listener listener) {
    const struct {
        const char *place, *value;
    } places[] = {{"{name}", name}, {"{camera}", camera}};
    *path = strdup(target);
    for (int i = 0; i < 2; i++) {
        char *part = as_part(places[i].value);
        if (part && *path) *path = put(*path, places[i].place, part);
        free(part);
        if (!part || !*path) {
            free(*path);
            *path = NULL;
            return ZT_EMEMORY;
        }
    }
    for (const char *brace = *path; (brace = strchr(brace, '{')); brace++) {
        if (strncmp(brace, layer_place, strlen(layer_place)) == 0) continue;
        zt_tell(listener, ZT_ERROR, "no %.*s for %s: there is {name}, {camera} and {layer}",
                (int)strcspn(brace, "}") + 1, brace, target);
        free(*path);
        *path = NULL;
        return ZT_EARGUMENT;
    }
    return ZT_OK;
}
