/* What a property does, and why: for people who ask, for plots, and what is probably not meant.
 */
#ifndef ZOETROPE_EXPLAIN_H
#define ZOETROPE_EXPLAIN_H

#include <stdbool.h>
#include <stdint.h>

#include <zoetrope/animation.h>
#include <zoetrope/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Numbers that a value has at most. */
enum { ZT_SUBJECT_CHANNELS_MAX = 9 };

/* A property of one thing. Its texts are the animation's, which must outlive it; only the name
 * of what does not move is the text that zt_subject_find was given. */
typedef struct zt_subject {
    const char *name;            /* "ball.center" */
    const char *meaning;         /* "the middle" */
    const char *driver;          /* "constant", or as zt_movement.driver says */
    const char *unit;            /* of its numbers: "deg", or "" */
    const char *const *channels; /* "x" "y" "z"; "" of a single number */
    int channel_count;
    int key_count;      /* 0 where it has no keys */
    bool is_color;      /* linear light */
    double least, most; /* what each number may be; +-INFINITY */
    /* How the library finds it. */
    const zt_animation *film;
    const struct zt_property *property;
    int32_t index;
    int movement; /* its number; -1 of what does not move */
} zt_subject;

/* Where something stands in the description; line 0 where that is not known. */
typedef struct zt_subject_place {
    const char *file;
    int line, column;
} zt_subject_place;

/* Finds a property by its name. ZT_EARGUMENT where there is none: the nearest one is told. */
zt_status zt_subject_find(zt_subject *subject, const zt_animation *animation, const char *name,
                          zt_listener listener);

/* Movement number `index`, as zt_animation_movement counts them. */
zt_subject zt_subject_of_movement(const zt_animation *animation, int index);

/* Where the property stands; what does not move, where the thing does that has it. */
zt_subject_place zt_subject_stands_at(const zt_subject *subject);

/* The value at a time in seconds, `channel_count` numbers as a description writes them (angles
 * in degrees, rotations as quaternions w x y z); of keys, before it is kept within least and
 * most. ZT_EDESCRIPTION, told, where an expression has no value at this time; ZT_EMEMORY. */
zt_status zt_subject_eval(double *value, const zt_subject *subject, double time_s,
                          zt_listener listener);

/* The value as a person would say it: "#c8553d" of a colour (what a display shows), angles of a
 * rotation "[0, 45, 0] deg"; "" where the numbers say all. */
typedef struct zt_subject_words {
    char text[80];
} zt_subject_words;
zt_subject_words zt_subject_in_words(const zt_subject *subject, const double *value);

/* A key. */
typedef struct zt_subject_key {
    double time_s;
    double value[ZT_SUBJECT_CHANNELS_MAX];
    /* The kind of the way to the next key: "smooth". NULL of the last key, but of springs. */
    const char *way;
    char ease[80]; /* what spreads it over its time: "ease-in-out"; "" for nothing */
    zt_subject_place place;
} zt_subject_key;

zt_subject_key zt_subject_key_at(const zt_subject *subject, int key);

/* Reads a time: "37" is a frame, "1.5 s" and "500 ms" are times, "00:00:01:12" a timecode at
 * the film's rate, "25 %" a share of the film. ZT_EARGUMENT, told, where it is none of these.
 */
zt_status zt_subject_time(double *time_s, const zt_animation *animation, const char *text,
                          zt_listener listener);

/* What a property does at one moment. */
typedef struct zt_explanation {
    double time_s, frame;                  /* frames may be fractional */
    double value[ZT_SUBJECT_CHANNELS_MAX]; /* as zt_subject_eval gives it */
    bool cut;                              /* it is kept within least and most when rendered */
    /* The velocity just after the moment, a second: of each channel; of rotations the angular
     * velocity in degrees around the axes x, y, z of the space that it turns in. */
    double velocity[ZT_SUBJECT_CHANNELS_MAX];
    const char *const *velocity_channels;
    int velocity_count;
    bool velocity_exact; /* by a formula; else by a difference over a small time */
    /* Of a property with keys, else all zero. */
    int key_before, key_after; /* -1 where there is none: the moment is at or beyond an end */
    double u;                  /* share of the time between the two keys, 0..1 */
    double s;                  /* what easing, or solving a Bezier curve, makes of it */
    const char *end;           /* beyond the keys: "hold", "loop" ...; else NULL, and where a
                        spring swings on */
    double beyond_s;           /* how far past the last key, or (negative) before the first */
    double round;              /* of a loop: which repetition; 0 is the keys as given */
} zt_explanation;

/* Fails as zt_subject_eval does. */
zt_status zt_subject_explain(zt_explanation *explanation, const zt_subject *subject,
                             double time_s, zt_listener listener);

/* Tells as warnings, at their places, what is legal but probably not meant and shows only in
 * motion: values that leave their range between keys or become too large for a number, movement
 * between equal keys; a camera that looks along its up vector or is inside of something solid;
 * a light on a surface, or shut in by something solid that the camera is not in; transforms
 * that nearly flatten, tori without a hole, tubes without a length. Looks at every frame and
 * between frames, but at no more than 10,000 moments, evenly spread over longer films.
 * ZT_EDESCRIPTION, told, where an expression has no value at one of them; ZT_EMEMORY. */
zt_status zt_animation_advise(const zt_animation *animation, zt_listener listener);

#ifdef __cplusplus
}
#endif
#endif
