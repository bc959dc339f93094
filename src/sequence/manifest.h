/* The manifest: its lines, what has been read of one, and the one beside a target, which grows
 * as things are completed. */
#ifndef ZT_SEQUENCE_MANIFEST_H
#define ZT_SEQUENCE_MANIFEST_H

#include <stdbool.h>
#include <stdio.h>
#include <threads.h>

#include <zoetrope/manifest.h>

#include "base/arena.h"
#include "sequence/json.h"

/* A frame as it was rendered. */
typedef struct zt_manifest_frame {
    int64_t frame;
    zt_hash key, pixels; /* the content key; a checksum of its numbers. Zero: not known */
    double render_s;     /* negative: not known */
    int32_t min, max;    /* samples a pixel, as in zt_sampling; 0: those of the settings */
    double error;        /* 0 where min = max */
    int32_t mean_max;
    zt_budget budget; /* that chose them; zeros: not known */
} zt_manifest_frame;

/* How a list of frames was divided among processes: where each part ends. */
typedef struct zt_manifest_split {
    zt_hash of; /* of the frames, and of what they show */
    int64_t *ends;
    int64_t count;
} zt_manifest_split;

typedef enum zt_line_kind {
    ZT_LINE_HEADER,
    ZT_LINE_FRAME, /* and, where record.count is not 0, the image that it became */
    ZT_LINE_PIECE, /* of a movie, or all of one */
    ZT_LINE_SPLIT
} zt_line_kind;

typedef struct zt_manifest_line {
    zt_line_kind kind;
    int width, height; /* of the header: */
    zt_precision precision;
    const char *description, *written; /* not read again */
    zt_manifest_frame frame;
    zt_output_record record; /* its file is without directories */
    zt_manifest_split split;
} zt_manifest_line;

/* Prints a line with its end. */
void zt_manifest_print(FILE *file, const zt_manifest_line *line);

/* Reads the only line of a text; what is of any length is pushed. ZT_EFILE, told at its place;
 * ZT_EMEMORY. */
zt_status zt_manifest_parse(zt_manifest_line *line, zt_json *json, zt_arena *arena);

/* All that is known from the lines of a file. */
struct zt_manifest {
    zt_arena arena;
    int width, height; /* 0: there is no header */
    zt_precision precision;
    char *header;              /* the last one, as it is written; NULL: none */
    zt_manifest_frame *frames; /* by rising number, each once */
    zt_output_record *records; /* each once */
    zt_manifest_split *splits; /* as they came: the first one counts */
    size_t frame_count, frame_room, record_count, record_room, split_count, split_room;
    size_t line_count; /* that were read */
};

/* NULL where it has no such frame. */
const zt_manifest_frame *zt_manifest_find(const zt_manifest *manifest, int64_t frame);

/* NULL where nothing was divided so. */
const zt_manifest_split *zt_manifest_split_of(const zt_manifest *manifest, zt_hash of,
                                              int64_t count);

/* Reads it, whatever a line holds: those that are none say nothing, and are told in one
 * warning, but for lines that were cut short. A file that is not there is an empty manifest. */
zt_status zt_manifest_recall(zt_manifest **manifest, const char *path, zt_listener listener);

/* ---- the one beside a target ----------------------------------------------------------------
 */

typedef struct zt_notes {
    char *path;
    zt_manifest *known; /* of earlier runs */
    mtx_t mutex;
    int file;  /* -1: not opened, as nothing has been noted yet */
    bool anew; /* what was there is replaced by the first line */
    bool made; /* by this run */
    char *header;
    zt_listener listener;
} zt_notes;

/* How outputs are written, in words for the header: "codec=h265 crf=20". Of the caller to free;
 * NULL when out of memory. */
char *zt_notes_wishes(const zt_output_option *wish);

/* Of TARGET.manifest; `header` is that of this run. With `anew` what is there is not read, and
 * is replaced as soon as there is something to note. `alone`: no other process uses it, so that
 * it may be written again without what does not count any more. */
zt_status zt_notes_open(zt_notes *notes, const char *target, const zt_manifest_line *header,
                        bool anew, bool alone, zt_listener listener);

/* Adds a line, by one write, from any thread. */
zt_status zt_notes_add(zt_notes *notes, const zt_manifest_line *line);

/* Reads again what others may have added. */
zt_status zt_notes_recall(zt_notes *notes);

/* `drop`: removes the file, where this run made it. Nothing happens to zeros. */
zt_status zt_notes_close(zt_notes *notes, bool drop);

#endif
