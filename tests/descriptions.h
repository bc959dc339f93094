/* For tests that read descriptions: a text becomes an animation. cmocka.h comes first; the
 * tests run in a directory of their own (files.h). */
#ifndef ZT_TESTS_DESCRIPTIONS_H
#define ZT_TESTS_DESCRIPTIONS_H

#include "files.h"
#include "keyframe/animation.h"
#include "told.h"

#define HEAD "zoetrope: 1\nfilm: { duration: 1 s }\ncamera: { position: [0, 0, 5] }\n"

static inline void write_bytes(const char *path, const char *bytes, size_t size) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

/* A model of one triangle. */
static inline void write_model(const char *path) {
    static const char ply[] = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                              "property float y\nproperty float z\nelement face 1\n"
                              "property list uchar int vertex_indices\nend_header\n"
                              "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    write_bytes(path, ply, sizeof ply - 1);
}

/* Reads a text as a description; what was told is in `t`. */
static inline zt_status read_told(told *t, zt_animation **animation, const char *text) {
    write_bytes("film.yaml", text, strlen(text));
    *t = (told){.file = "film.yaml"};
    return zt_animation_read(animation, "film.yaml", NULL, 0, told_to(t));
}

/* The animation of a text without mistakes, of the caller to free. */
static inline zt_animation *animation_of(const char *text) {
    static told t;
    zt_animation *animation;
    if (read_told(&t, &animation, text) != ZT_OK) fail_msg("%s in\n%s", t.lines, text);
    return animation;
}

/* The film of "film: { duration: 1 s, ... }". */
static inline zt_film film_of_words(const char *words) {
    char text[512];
    snprintf(text, sizeof text,
             "zoetrope: 1\nfilm: { duration: 1 s%s }\ncamera: { position: [0, 0, 5] }\n",
             words);
    zt_animation *animation = animation_of(text);
    zt_film film = *zt_animation_film(animation);
    zt_animation_free(&animation);
    return film;
}

#endif
