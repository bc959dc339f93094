/* Opening an output while something else is done, such as rendering the first frame: loading
 * what a movie or images need takes as long as that, and says whether they can be written at
 * all. */
#ifndef ZT_SEQUENCE_OPENING_H
#define ZT_SEQUENCE_OPENING_H

#include <stdatomic.h>
#include <stdbool.h>

#include <zoetrope/output.h>
#include <zoetrope/renderer.h>

/* What zt_output_open() takes; what is done meanwhile, and who else says when that stops: the
 * caller fills these in. */
typedef struct zt_opening {
    const char *target;
    const zt_output_format *format;
    const zt_output_option *options;
    zt_listener listener;
    zt_status (*work)(void *user); /* on a thread of its own; NULL: nothing */
    void *user;
    const zt_watcher *watcher; /* may be NULL */
    zt_status worked;          /* what came of the work */
    atomic_bool refused;
} zt_opening;

/* Whether opening takes a while, for loading a module. */
bool zt_opening_takes(const zt_opening *opening);

/* For the work: stops it when the output is refused. */
zt_watcher zt_opening_watcher(zt_opening *opening);

/* Opens the output, and waits for the work, which is not done where there is no thread to be
 * had. Fails as zt_output_open() does, or else as the work did. Before the linker has loaded
 * the module, no thread starts and no other module is loaded. */
zt_status zt_opening_open(zt_output **output, zt_opening *opening);

#endif
