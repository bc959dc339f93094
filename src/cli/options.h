/* The command line: what a person asked for. */
#ifndef ZT_CLI_OPTIONS_H
#define ZT_CLI_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

#include <zoetrope/zoetrope.h>

#include "cli/commands.h"
#include "cli/report.h"

enum { ZT_SETS_MAX = 256, ZT_OUTPUT_OPTIONS_MAX = 64 };

typedef struct zt_options {
    zt_command command;
    const char *file;              /* the description; of diff the older one, of reproduce and
                                      encode images */
    const char *other;             /* of diff the newer one, of reproduce the description, which
                                      may be NULL */
    const char *target;            /* NULL: the command's own */
    const char *question;          /* of explain: "ball.center@37"; NULL: precisions */
    const char *frame_list;        /* as zt_frames_read takes it, not yet read; or NULL */
    int64_t part, part_count;      /* of the frames, as zt_film_order has it; 0: all */
    bool overwrites;               /* what is there, instead of going on with it */
    bool stats;                    /* are printed in the end */
    bool filters;                  /* of report: each of them */
    const char *const *properties; /* of curves: property_count names, none for all */
    int property_count;
    bool all_frames;             /* else first .. last, both included */
    int64_t first, last;         /* 0 <= first <= last */
    zt_render_settings settings; /* zero where not given */
    zt_budget budget;            /* likewise */
    const char *manifest;        /* to go by, or NULL */
    int64_t keep_bytes;          /* as in zt_film_order */
    int verify;                  /* how many of the images that are there; 0: none */
    const char *view;            /* a zt_view's name, or NULL */
    zt_rate rate;                /* of encode; zeros: as the images say */
    bool replays;                /* a pixel, instead of an image */
    int column, row;             /* of it */
    int sample;                  /* of it; -1: all */
    zt_output_option output_options[ZT_OUTPUT_OPTIONS_MAX + 1]; /* the last has no name */
    int output_option_count;
    bool quiet;
    zt_override sets[ZT_SETS_MAX]; /* what --set and others replace in the description */
    int set_count;
    char samples[96]; /* one of these: "{min: 4, max: 64, error: 0.002}" */
} zt_options;

typedef enum zt_request {
    ZT_REQUEST_RUN,   /* the options are complete */
    ZT_REQUEST_SHOWN, /* help or the version was asked for, and is printed */
    ZT_REQUEST_WRONG  /* told */
} zt_request;

/* Reads GNU-style arguments: options anywhere, "--size=4x4" as "--size 4x4", "-ofilm.mp4" as
 * "-o film.mp4", nothing but words after "--". `argv` ends with NULL; its words are moved to
 * its begin; its texts stay its own, and that of --set is cut at its "=".
 */
zt_request zt_options_read(zt_options *options, int argc, char **argv, zt_report *report);

/* The description's name without its directory and ending, of encode that of the images without
 * the place of their number; not terminated. */
const char *zt_options_name(int *length, const zt_options *options);

/* Whether the places for names in the target that was given are such; tells where not. */
bool zt_options_check_target(const zt_options *options, zt_report *report);

/* Where the images go: as told, or output/ and the description's name with an ending by the
 * command. Of the caller to free; NULL when out of memory. */
char *zt_options_target(const zt_options *options);

/* The frames that were asked for, in their order: the list, or first .. last, or all, of which
 * a part may be rendered. ZT_EARGUMENT after telling of frames that the film has not. The
 * caller frees them. */
zt_status zt_options_frames(zt_frames *frames, const zt_options *options, const zt_film *film,
                            zt_report *report);

#endif
