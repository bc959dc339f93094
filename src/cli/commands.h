/* What the program offers: one table of commands, one of options. Reading, refusing and help go
 * by them. */
#ifndef ZT_CLI_COMMANDS_H
#define ZT_CLI_COMMANDS_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

typedef enum zt_command {
    ZT_COMMAND_RENDER,
    ZT_COMMAND_FRAME,
    ZT_COMMAND_PREVIEW,
    ZT_COMMAND_CHECK,
    ZT_COMMAND_EXPLAIN,
    ZT_COMMAND_CURVES,
    ZT_COMMAND_REPORT,
    ZT_COMMAND_ENCODE,
    ZT_COMMAND_DIFF,
    ZT_COMMAND_REPRODUCE,
    ZT_COMMAND_COUNT /* none of them */
} zt_command;

typedef struct zt_command_row {
    const char *name;
    const char *words; /* that it needs: "FILE N" */
    int word_count;
    int more_words; /* than those it needs, at most */
    const char *help;
    const char *target; /* where its images go by default, as help shows it; NULL: none */
    const char *forms;  /* of the target, for help */
    uint64_t takes;     /* a bit for each option */
} zt_command_row;

extern const zt_command_row zt_commands[ZT_COMMAND_COUNT];

typedef enum zt_option {
    ZT_OPTION_OUTPUT,
    ZT_OPTION_FRAMES,
    ZT_OPTION_FRAME,
    ZT_OPTION_CHUNK,
    ZT_OPTION_OVERWRITE,
    ZT_OPTION_VERIFY,
    ZT_OPTION_RATE,
    ZT_OPTION_SIZE,
    ZT_OPTION_SAMPLES,
    ZT_OPTION_ERROR,
    ZT_OPTION_QUALITY,
    ZT_OPTION_FILTER,
    ZT_OPTION_FILTERS,
    ZT_OPTION_TIME,
    ZT_OPTION_TIME_PER_FRAME,
    ZT_OPTION_MANIFEST,
    ZT_OPTION_PIXEL,
    ZT_OPTION_SAMPLE,
    ZT_OPTION_THREADS,
    ZT_OPTION_PRECISION,
    ZT_OPTION_AOVS,
    ZT_OPTION_VIEW,
    ZT_OPTION_STATS,
    ZT_OPTION_NO_REUSE,
    ZT_OPTION_CHECK_REUSE,
    ZT_OPTION_KEEP,
    ZT_OPTION_CODEC,
    ZT_OPTION_CRF,
    ZT_OPTION_BITRATE,
    ZT_OPTION_PRESET,
    ZT_OPTION_PIXEL_FORMAT,
    ZT_OPTION_ENCODER_OPTION,
    ZT_OPTION_FORMAT_OPTION,
    ZT_OPTION_COMMENT,
    ZT_OPTION_AUDIO,
    ZT_OPTION_SET,
    ZT_OPTION_QUIET,
    ZT_OPTION_HELP,
    ZT_OPTION_VERSION,
    ZT_OPTION_COUNT /* none of them */
} zt_option;

typedef struct zt_option_row {
    const char *name;
    char letter;         /* '\0': none */
    const char *example; /* of its value; NULL: takes none */
    const char *help;
} zt_option_row;

extern const zt_option_row zt_options_known[ZT_OPTION_COUNT];

/* Whether an option is passed on to the output, by the same name. */
bool zt_option_is_of_output(zt_option option);

/* The command of that name, or none. */
zt_command zt_command_find(const char *name);

/* The first command or option whose name begins so or is a few letters off, or none. */
zt_command zt_command_near(const char *name);
zt_option zt_option_near(const char *name);

/* Prints help for a command, or for the whole program where it is none. */
void zt_command_help(FILE *stream, zt_command command);

#endif
