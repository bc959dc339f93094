/* Opening an output, behind the rendering of the first frame: loading what a movie or images
 * need takes as long as rendering many a frame, and says whether they can be written at all. */
#ifndef ZT_SEQUENCE_OPENING_H
#define ZT_SEQUENCE_OPENING_H

#include <stdatomic.h>
#include <stdbool.h>

#include <zoetrope/output.h>
#include <zoetrope/renderer.h>

#include "base/pool.h"

/* What zt_output_open() takes, and who else says when to stop: the caller fills these in. */
typedef struct zt_opening {
    const char *target;
    const zt_output_format *format;
    const zt_output_option *options;
    zt_listener listener;
    const zt_watcher *watcher; /* may be NULL */
    zt_output *output;         /* what comes of it */
    zt_status status;          /* likewise */
    zt_errand *errand;         /* NULL: nothing is under way */
    atomic_bool refused;
} zt_opening;

/* Whether it takes a while, for loading a module. */
bool zt_opening_takes(const zt_opening *opening);

/* Begins to open it, on a thread of its own, where it takes a while; else opens it. Until
 * zt_opening_end(), it stays where it is, and all that it points to as it is; and no thread
 * starts, nor does another module load, before the linker is done. */
void zt_opening_begin(zt_opening *opening);

/* Stops what is rendered meanwhile when the output was refused. */
zt_watcher zt_opening_watcher(zt_opening *opening);

/* Waits, and gives what came of it: fails as zt_output_open() does. */
zt_status zt_opening_end(zt_output **output, zt_opening *opening);

#endif
