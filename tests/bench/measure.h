/* Measuring: what things cost in wall and processor time, in rounds, side by side. */
#ifndef ZT_BENCH_MEASURE_H
#define ZT_BENCH_MEASURE_H

#include <stdbool.h>
#include <stdint.h>

#include <zoetrope/zoetrope.h>

typedef struct spent {
    double wall_s, cpu_s; /* cpu: of all threads together */
} spent;

/* What this process has spent so far, and since such a moment. */
spent spent_now(void);
spent spent_since(spent start);
spent spent_less(spent a, spent b);
spent spent_per(spent a, double count);

/* Something that is measured: `run` does it once and says what it took. */
typedef struct runner {
    const char *name;
    spent (*run)(void *user);
    void *user;
    spent median; /* of wall and of processor time, each by itself */
} runner;

enum { ROUNDS_MAX = 32 };

/* Runs all of them in turn, `rounds` times, so that all see the same weather. With more than
 * one round another one comes before, which does not count. */
void race(runner *runners, int count, int rounds);

/* Runs a program, `copies` of it at the same time, in the scratch directory, without showing
 * what it says, until the last one ends. In its arguments %d stands for the number of the copy.
 * Does not return when it fails. */
spent run_program(char *const *arguments, int copies);

/* Frames of a film, rendered through the library. */
typedef struct frames {
    const char *isa; /* the width of instructions as ZOETROPE_ISA has it; NULL: the widest */
    zt_renderer *renderer;
    zt_image *image; /* the last one that was rendered */
    int64_t next;
    int repeats; /* frames in a round */
} frames;

frames frames_open(const zt_animation *animation, zt_render_settings settings, int repeats);
void frames_close(frames *f);
spent frames_run(void *user); /* of one frame; `user` is a `frames` */

/* A film of the project's, "fig1b", or one at a path. `overrides` end with an empty name and
 * may be NULL. */
zt_animation *film_open(const char *name, const zt_override *overrides);

/* The documents' room as text: its lights, and of its objects, which further ones may follow,
 * the walls, of materials "mirror" and "matte". */
extern const char documents_room[];

/* A directory that is removed in the end, in memory where the system has one there. The second
 * one gives the path of a file in it; valid for the next few calls. */
const char *scratch(void);
const char *scratch_path(const char *name);

/* Ends the program when something that has to work did not. */
void must(zt_status status, const char *what);
void must_be(bool good, const char *what);
extern const zt_listener to_stderr;

/* What is printed: a title; a name and times; and behind them how many times as much that is as
 * something else, which should be at least `reach`, or at most minus that where it is negative;
 * or that it should be at most so many milliseconds. 0 where nothing is asked. */
void print_title(const char *format, ...) __attribute__((format(printf, 1, 2)));
void print_spent(const char *name, spent each);
void print_ratio(double ratio, double reach);
void print_limit(spent each, double limit_ms);
void print_end(void);

#endif
