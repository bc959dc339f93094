/* A film under way, and the rendering of its frames (sequence/film.c does what comes before).
 */
#ifndef ZT_SEQUENCE_FILMING_H
#define ZT_SEQUENCE_FILMING_H

#include <stdbool.h>

#include <zoetrope/film.h>

#include "sequence/again.h"
#include "sequence/hold.h"
#include "sequence/manifest.h"
#include "sequence/outway.h"
#include "sequence/renderer.h"
#include "sequence/settings.h"
#include "sequence/sums.h"

/* A film under way. */
typedef struct zt_filming {
    zt_renderer *renderer;
    const zt_film_order *order;
    const zt_watcher *watcher;
    zt_film_result *result;
    zt_frames frames;         /* in the order in which they come */
    zt_hash *keys;            /* likewise */
    bool *wanted;             /* likewise: those that are not there */
    zt_manifest_frame *made;  /* as they were rendered, by rising number */
    zt_output_option *wishes; /* the order's, but for what is not for these frames */
    bool still;               /* images of their own, not a file for all */
    bool remembers;           /* else it is made anew */
    bool planned;   /* keys are known before the first frame; else each when it is its turn */
    bool timed;     /* a budget decides the samples, and with them the keys, later */
    zt_frames rest; /* of those, what is left to be rendered */
    zt_hold hold;
    zt_notes notes;
    zt_output *output;
    zt_outway *way;
    zt_sums *sums;
    zt_again *again; /* NULL: no two frames are known to be equal */
    zt_image *last;  /* that was lent and filled; NULL: none */
    bool fresh;      /* it was rendered, and is not counted yet */
    zt_settings_texts settings;
} zt_filming;

/* What is noted of a frame. */
zt_manifest_frame *zt_filming_of(const zt_filming *m, int64_t frame);

/* The order that zt_filming_of() needs of `made`, for qsort(). */
int zt_filming_by_frame(const void *a, const void *b);

/* The way out, on which `look` sees each image; closing waits for what is still being written.
 */
zt_status zt_filming_open(zt_filming *m, zt_status (*look)(void *user, const zt_image *image));
zt_status zt_filming_close(zt_filming *m);

/* Renders the first frame before there is an output. If that does not want it, it was for
 * nothing. */
zt_status zt_filming_begin(zt_filming *m);

/* Renders all that is wanted, and sends it to the output. */
zt_status zt_filming_all(zt_filming *m);

#endif
