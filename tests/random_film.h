/* Random descriptions of short films of all kinds of things, lamps and lenses, a few of which
 * move: as text. cmocka.h comes first. */
#ifndef ZT_TESTS_RANDOM_FILM_H
#define ZT_TESTS_RANDOM_FILM_H

#include <stdarg.h>
#include <stdio.h>

#include "draw.h"

/* How a film takes its samples. */
typedef enum film_kind {
    FILM_EVEN,
    FILM_SIGNED,
    FILM_ADAPTIVE,
    FILM_EDGES,
    FILM_KINDS
} film_kind;

static const char *const film_kind_names[] = {"even", "signed", "adaptive", "edges"};

typedef struct film_text {
    draw draw;
    int calm; /* one in so many properties moves */
    size_t size;
    char text[1 << 15];
} film_text;

__attribute__((format(printf, 2, 3))) static inline void put(film_text *f, const char *format,
                                                             ...) {
    va_list arguments;
    va_start(arguments, format);
    int size = vsnprintf(f->text + f->size, sizeof f->text - f->size, format, arguments);
    va_end(arguments);
    assert_in_range(size, 0, sizeof f->text - f->size - 1);
    f->size += (size_t)size;
}

static inline bool one_in(film_text *f, int count) { return draw_below(&f->draw, count) == 0; }

/* So many numbers, in brackets where they are several. */
static inline void put_value(film_text *f, int count, double low, double high) {
    for (int i = 0; i < count; i++)
        put(f, "%s%.4f", i ? ", " : count > 1 ? "[" : "", draw_between(&f->draw, low, high));
    if (count > 1) put(f, "]");
}

/* A property, which may move, at once or little by little. */
static inline void put_moving(film_text *f, const char *name, int count, double low,
                              double high, int calm) {
    put(f, "%s: ", name);
    if (!one_in(f, calm)) {
        put_value(f, count, low, high);
        put(f, ", ");
        return;
    }
    put(f, "{ curve: %s, keys: { 0: ", one_in(f, 3) ? "hold" : "linear");
    put_value(f, count, low, high);
    put(f, ", %d: ", 2 + draw_below(&f->draw, 2));
    put_value(f, count, low, high);
    put(f, " } }, ");
}

static inline void put_property(film_text *f, const char *name, int count, double low,
                                double high) {
    put_moving(f, name, count, low, high, f->calm);
}

static inline void put_film(film_text *f, film_kind kind) {
    static const char *const filters[] = {"box", "box", "tent", "gaussian", "mitchell"};
    static const int samples[] = {1, 1, 4, 16}, least[] = {1, 2, 4, 7};
    put(f, "zoetrope: 1\nfilm: { size: [48, 32], rate: 4, duration: 5, reflections: %d, ",
        draw_below(&f->draw, 5));
    put(f, "filter: %s, ", kind == FILM_SIGNED ? "mitchell" : filters[draw_below(&f->draw, 5)]);
    double error = one_in(f, 2) ? 0.05 : 0.01;
    int most = 8 << draw_below(&f->draw, 2);
    if (kind == FILM_ADAPTIVE)
        put(f, "samples: { min: %d, max: %d, error: %g }", least[draw_below(&f->draw, 4)], most,
            error);
    else if (kind == FILM_EDGES)
        put(f, "quality: edges, samples: { max: %d, error: %g }", most, error);
    else
        put(f, "samples: %d", samples[draw_below(&f->draw, 4)]);
    if (one_in(f, 4)) put(f, ", seed: fixed");
    if (one_in(f, 8)) put(f, ", shutter: 180 deg");
    if (one_in(f, 8)) put(f, ", background: transparent");
    if (one_in(f, 6)) put(f, ", aovs: [Z, N, albedo, motion, id.object]");
    put(f, " }\ncamera: { ");
    put_moving(f, "position", 3, -0.5, 0.5, 30);
    put(f, "look_at: [0, 0, -5]");
    if (one_in(f, 6)) put(f, ", lens: orthographic, height: 6");
    if (one_in(f, 25)) put(f, ", aperture: 0.05, focus_distance: 5");
    put(f, " }\n");
}

enum { FILM_MATERIALS = 6 };

static inline void put_materials(film_text *f) {
    put(f, "materials:\n");
    for (int i = 0; i < FILM_MATERIALS; i++) {
        put(f, "  m%d: { ", i);
        if (one_in(f, 3)) put_property(f, "reflectivity", 1, 0, 1);
        if (one_in(f, 4)) {
            put(f, "pattern: %s, ", one_in(f, 2) ? "checker" : "stripes");
            put_property(f, "other_color", 3, 0, 1);
            put_property(f, "pattern_size", 1, 0.1, 1);
        }
        put_property(f, "color", 3, 0, 1);
        put(f, "}\n");
    }
}

static inline void put_lights(film_text *f) {
    static const char *const kinds[] = {"point", "point", "point", "disk_light",
                                        "rectangle_light"};
    put(f, "lights:\n  - ambient: { ");
    put_property(f, "intensity", 1, 0, 0.3);
    put(f, "}\n");
    for (int i = draw_below(&f->draw, 4); i >= 0; i--) {
        int kind = one_in(f, 4) ? draw_below(&f->draw, 5) : 0;
        put(f, "  - %s: { shadows: %s, ", kinds[kind], one_in(f, 5) ? "false" : "true");
        if (kind == 3 || (kind == 0 && one_in(f, 12))) put(f, "radius: 0.4, ");
        if (kind == 4) put(f, "width: 1, height: 0.5, ");
        if (kind >= 3) put_property(f, "rotation", 3, -180, 180);
        put_property(f, "position", 3, -5, 5);
        put_property(f, "color", 3, 0, 1);
        put_property(f, "intensity", 1, 1, 12);
        put(f, "}\n");
    }
}

/* Where a thing is: before the camera, seldom elsewhere. */
static inline void put_place(film_text *f, const char *name) {
    vec3 at = {draw_between(&f->draw, -4, 4), draw_between(&f->draw, -2, 2.5),
               draw_between(&f->draw, -9, -3)};
    if (one_in(f, 6)) at.z = draw_between(&f->draw, -3, 8);
    put(f, "%s: ", name);
    bool moves = one_in(f, f->calm);
    if (moves) put(f, "{ curve: %s, keys: { 0: ", one_in(f, 3) ? "hold" : "linear");
    put(f, "[%.4f, %.4f, %.4f]", at.x, at.y, at.z);
    if (moves)
        put(f, ", 3: [%.4f, %.4f, %.4f] } }", at.x + draw_between(&f->draw, -1, 1), at.y,
            at.z + draw_between(&f->draw, -1, 1));
    put(f, ", ");
}

/* A thing as an item of a list that stands in brackets or lines; "ball.ply" is there. */
static inline void put_object(film_text *f, double size) {
    static const char *const kinds[] = {"sphere",   "sphere", "box",     "box",
                                        "disk",     "torus",  "capsule", "cone",
                                        "cylinder", "mesh",   "mesh"};
    const char *kind = kinds[draw_below(&f->draw, 11)];
    double low = 0.2 * size, high = size;
    put(f, "{ %s: { material: m%d, ", kind, draw_below(&f->draw, FILM_MATERIALS));
    switch (*kind) {
    case 's':
        put_place(f, "center");
        put_property(f, "radius", 1, low, high);
        break;
    case 'b':
        put_place(f, "center");
        put_property(f, "size", 3, low, high);
        if (one_in(f, 2)) put_property(f, "rotation", 3, -90, 90);
        break;
    case 'd':
        put_place(f, "center");
        put_property(f, "normal", 3, 0.1, 1);
        put_property(f, "radius", 1, low, high);
        break;
    case 't':
        put_place(f, "center");
        put_property(f, "axis", 3, 0.1, 1);
        put_property(f, "radius", 1, low, high);
        put(f, "tube_radius: %.4f", low / 2);
        break;
    case 'm':
        put_place(f, "position");
        put(f, "file: ball.ply, smooth: %s, ", one_in(f, 2) ? "true" : "false");
        put_property(f, "rotation", 3, -90, 90);
        put_property(f, "scale", 1, low, high);
        break;
    default:
        put_place(f, "from");
        put_place(f, "to");
        put_property(f, "radius", 1, low / 2, high / 2);
    }
    put(f, " } }");
}

static inline void put_objects(film_text *f) {
    int count = one_in(f, 4) ? 36 + draw_below(&f->draw, 12) : 2 + draw_below(&f->draw, 8);
    double size = count > 20 ? 0.4 : 1;
    put(f, "objects:\n  - plane: { normal: [0, 1, 0], distance: -2, material: m0 }\n");
    /* Something always differs from frame to frame. */
    double x = draw_between(&f->draw, -3, 3);
    if (one_in(f, 2))
        put(f,
            "  - sphere: { radius: 0.15, material: m1, center: "
            "{ keys: { 0: [%.3f, 1.5, -6], 4: [%.3f, 1.2, -6] } } }\n",
            x, x + 0.5);
    else
        put(f,
            "  - sphere: { radius: 0.5, center: [%.3f, 0, -6], "
            "material: { color: { keys: { 0: red, 4: white } } } }\n",
            x);
    for (int i = 0; i < count; i++) {
        put(f, "  - ");
        put_object(f, size);
        put(f, "\n");
    }
    for (int i = draw_below(&f->draw, 3); i > 0; i--) {
        put(f, "  - group: { ");
        put_property(f, "position", 3, -0.5, 0.5);
        put_property(f, "rotation", 3, -10, 10);
        if (one_in(f, 3)) put(f, "scale: [1, 1.5, 0.7], ");
        put(f, "objects: [ ");
        put_object(f, size);
        put(f, ", ");
        put_object(f, size);
        put(f, " ] }\n");
    }
}

/* The same one for the same number. */
static inline void draw_film(film_text *f, uint64_t number, film_kind kind) {
    f->draw = (draw){number, 0};
    f->size = 0;
    f->calm = 40 + draw_below(&f->draw, 200);
    put_film(f, kind);
    put_materials(f);
    put_lights(f);
    put_objects(f);
}

#endif
