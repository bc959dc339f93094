/* An output is a small table of calls. Each kind of output gives one; output.c picks the one
 * that knows the target's ending. */
#ifndef ZT_ENCODE_SINK_H
#define ZT_ENCODE_SINK_H

#include <stdbool.h>

#include <zoetrope/output.h>

typedef struct zt_sink {
    const char *what;           /* for messages: "a movie" */
    const char *module;         /* that opening needs; NULL: none */
    const char *const *endings; /* that it accepts, each with its dot; NULL after the last */
    const char *const *options; /* that it knows, by name; NULL after the last */
    /* Makes *state; tells why not. Everything that can be refused is refused here; but that it
     * knows all options is seen to. */
    zt_status (*open)(void **state, const char *target, const zt_output_format *format,
                      const zt_output_option *options, zt_listener listener);
    /* zt_output_wants(), with a plan; NULL: all. */
    bool (*wants)(void *state, int64_t position);
    /* Makes of an image what will be written, without writing it: developed, converted,
     * compressed. From any thread, several at once, in any order. */
    zt_status (*make)(void **made, void *state, const zt_image *image, int64_t frame);
    /* Writes what was made, in turn, and frees it. After a failure, which is told, only `drop`
     * and `close` are called. */
    zt_status (*write)(void *state, void *made, int64_t frame);
    /* Frees what was made and will not be written. */
    void (*drop)(void *state, void *made);
    /* zt_output_spared(); NULL: none. */
    int64_t (*spared)(void *state);
    /* Frees the state. `keep`: complete the files and give them their names, and tell where
     * that fails; else remove what is unfinished, but for what is recorded. */
    zt_status (*close)(void *state, bool keep);
} zt_sink;

extern const zt_sink zt_sink_stills, zt_sink_movie, zt_sink_checksum;

#endif
