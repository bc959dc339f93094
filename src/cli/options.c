#include "cli/options.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/values.h"

enum { THREADS_MAX = 1024, VERIFY_MAX = 1000000, KEEP_BYTES = 2000000000 };

/* The arguments, sorted but not yet understood. */
typedef struct arguments {
    const char *values[ZT_OPTION_COUNT]; /* NULL: not given; "" where it takes no value */
    char **words; /* command, file and more, moved to the begin of argv; NULL after the last */
    int word_count;
    zt_options *options; /* takes each --set as it comes */
} arguments;

/* The option that an argument names, and what is attached to it ("=640x360"), or NULL. */
static zt_option find_option(char **value, char *argument) {
    *value = NULL;
    bool is_long = argument[1] == '-';
    size_t length = strcspn(argument, "=");
    for (int i = 0; i < ZT_OPTION_COUNT; i++) {
        const zt_option_row *row = &zt_options_known[i];
        if (is_long && strlen(row->name) + 2 == length &&
            strncmp(argument + 2, row->name, length - 2) == 0) {
            if (argument[length]) *value = argument + length + 1;
            return (zt_option)i;
        }
        if (!is_long && argument[1] == row->letter) {
            if (argument[2]) *value = argument + 2;
            return (zt_option)i;
        }
    }
    return ZT_OPTION_COUNT;
}

static void say_unknown_option(zt_report *report, const char *argument) {
    char name[32];
    snprintf(name, sizeof name, "%s", argument + strspn(argument, "-"));
    name[strcspn(name, "=")] = '\0';
    zt_option near = zt_option_near(name);
    if (near == ZT_OPTION_COUNT)
        zt_report_say(report, ZT_ERROR, "unknown option %s; zoetrope --help lists them",
                      argument);
    else
        zt_report_say(report, ZT_ERROR, "unknown option %s; did you mean --%s?", argument,
                      zt_options_known[near].name);
}

static void say_unknown_command(zt_report *report, const char *word) {
    zt_command near = zt_command_near(word);
    const char *ending = strrchr(word, '.');
    if (near < ZT_COMMAND_COUNT)
        zt_report_say(report, ZT_ERROR, "unknown command %s; did you mean %s?", word,
                      zt_commands[near].name);
    else if (ending && (strcmp(ending, ".yaml") == 0 || strcmp(ending, ".yml") == 0))
        zt_report_say(report, ZT_ERROR, "unknown command %s; did you mean render %s?", word,
                      word);
    else
        zt_report_say(report, ZT_ERROR, "unknown command %s; zoetrope --help lists them", word);
}

static bool add_set(zt_options *options, const char *name, const char *value,
                    zt_report *report) {
    if (options->set_count == ZT_SETS_MAX) {
        zt_report_say(report, ZT_ERROR, "more than %d times --set", ZT_SETS_MAX);
        return false;
    }
    options->sets[options->set_count++] = (zt_override){name, value};
    return true;
}

static bool take_set(zt_options *options, char *text, zt_report *report) {
    char *equals = strchr(text, '=');
    if (!equals || equals == text) {
        zt_report_say(report, ZT_ERROR,
                      "--set %s: must be a name and a value, such as lamp.intensity=40", text);
        return false;
    }
    *equals = '\0';
    return add_set(options, text, equals + 1, report);
}

/* An option that is the output's own; the last of the list stays without a name. */
static bool pass_on(zt_options *options, const char *name, const char *value,
                    zt_report *report) {
    if (options->output_option_count == ZT_OUTPUT_OPTIONS_MAX) {
        zt_report_say(report, ZT_ERROR, "more than %d options for the output",
                      ZT_OUTPUT_OPTIONS_MAX);
        return false;
    }
    options->output_options[options->output_option_count++] = (zt_output_option){name, value};
    return true;
}

/* Takes the option at argv[i] with its value; returns the index of the last one taken, or 0. */
static int take_option(arguments *sorted, int i, char **argv, zt_report *report) {
    char *value;
    zt_option option = find_option(&value, argv[i]);
    if (option == ZT_OPTION_COUNT) {
        say_unknown_option(report, argv[i]);
        return 0;
    }
    const zt_option_row *row = &zt_options_known[option];
    if (!row->example && value) {
        zt_report_say(report, ZT_ERROR, "--%s takes no value", row->name);
        return 0;
    }
    if (row->example && !value) value = argv[++i]; /* NULL after the last one */
    if (row->example && (!value || !*value)) {
        zt_report_say(report, ZT_ERROR, "--%s needs a value, such as --%s=%s", row->name,
                      row->name, row->example);
        return 0;
    }
    sorted->values[option] = row->example ? value : "";
    bool good = true;
    if (option == ZT_OPTION_SET) good = value && take_set(sorted->options, value, report);
    if (zt_option_is_of_output((zt_option)option))
        good = pass_on(sorted->options, row->name, value, report);
    return good ? i : 0;
}

static bool sort_arguments(arguments *sorted, int argc, char **argv, zt_report *report) {
    bool only_words = false;
    sorted->words = argv;
    for (int i = 1; i < argc; i++) {
        if (!only_words && strcmp(argv[i], "--") == 0) {
            only_words = true;
        } else if (only_words || argv[i][0] != '-' || !argv[i][1]) {
            argv[sorted->word_count++] = argv[i];
        } else {
            i = take_option(sorted, i, argv, report);
            if (i == 0) return false;
        }
    }
    argv[sorted->word_count] = NULL;
    return true;
}

/* Where images are made, what stands there is read when it is known how many frames the film
 * has. */
static bool read_frames(zt_options *options, const char *text, zt_report *report) {
    bool is_list =
        options->command == ZT_COMMAND_RENDER || options->command == ZT_COMMAND_PREVIEW;
    int64_t first, last;
    bool good = zt_value_range(&first, &last, text);
    if (is_list) options->frame_list = text;
    if (!good && !is_list)
        zt_report_say(report, ZT_ERROR,
                      "--frames %s: must be a range, such as 10-40, or one frame, such as 7",
                      text);
    if (!good) return is_list;
    options->first = first;
    options->last = last;
    options->all_frames = false;
    return true;
}

static bool read_frame(zt_options *options, const char *text, zt_report *report) {
    bool good = !strchr(text, '-') && zt_value_range(&options->first, &options->last, text);
    if (!good) zt_report_say(report, ZT_ERROR, "%s is not the number of a frame", text);
    options->all_frames = false;
    return good;
}

static bool read_words(zt_options *options, const arguments *sorted, zt_report *report) {
    const zt_command_row *command = &zt_commands[options->command];
    int expected = 1 + command->word_count;
    if (sorted->word_count < expected) {
        zt_report_say(report, ZT_ERROR, "%s needs %s", command->name, command->words);
        return false;
    }
    if (sorted->word_count - expected > command->more_words) {
        zt_report_say(report, ZT_ERROR, "one word too many: %s",
                      sorted->words[expected + command->more_words]);
        return false;
    }
    options->file = sorted->words[1];
    if (options->command == ZT_COMMAND_FRAME)
        return read_frame(options, sorted->words[2], report);
    if (options->command == ZT_COMMAND_EXPLAIN && sorted->words[2] && !options->all_frames) {
        zt_report_say(report, ZT_ERROR, "explain takes --frames or a property, not both");
        return false;
    }
    if (options->command == ZT_COMMAND_EXPLAIN) options->question = sorted->words[2];
    if (options->command == ZT_COMMAND_DIFF || options->command == ZT_COMMAND_REPRODUCE)
        options->other = sorted->words[2];
    options->properties = (const char *const *)sorted->words + 2;
    options->property_count = sorted->word_count - 2;
    return true;
}

/* Options that contradict each other, or say something only with another one. */
static bool fit_together(const char *const *values, zt_report *report) {
    static const zt_option exclusive[][2] = {{ZT_OPTION_TIME, ZT_OPTION_TIME_PER_FRAME},
                                             {ZT_OPTION_TIME, ZT_OPTION_SAMPLES},
                                             {ZT_OPTION_TIME, ZT_OPTION_MANIFEST},
                                             {ZT_OPTION_TIME, ZT_OPTION_PIXEL},
                                             {ZT_OPTION_TIME_PER_FRAME, ZT_OPTION_SAMPLES},
                                             {ZT_OPTION_TIME_PER_FRAME, ZT_OPTION_MANIFEST},
                                             {ZT_OPTION_TIME_PER_FRAME, ZT_OPTION_PIXEL},
                                             {ZT_OPTION_MANIFEST, ZT_OPTION_SAMPLES},
                                             {ZT_OPTION_PIXEL, ZT_OPTION_OUTPUT},
                                             {ZT_OPTION_PIXEL, ZT_OPTION_PRESET},
                                             {ZT_OPTION_NO_REUSE, ZT_OPTION_CHECK_REUSE}};
    for (size_t i = 0; i < sizeof exclusive / sizeof *exclusive; i++) {
        zt_option a = exclusive[i][0], b = exclusive[i][1];
        if (!values[a] || !values[b]) continue;
        zt_report_say(report, ZT_ERROR, "--%s and --%s do not go together",
                      zt_options_known[a].name, zt_options_known[b].name);
        return false;
    }
    if (values[ZT_OPTION_SAMPLE] && !values[ZT_OPTION_PIXEL]) {
        zt_report_say(report, ZT_ERROR, "--sample is one of a --pixel's");
        return false;
    }
    return true;
}

/* What is said of sampling stands in for the description's words; a number of samples by itself
 * does so for all of them. */
static bool set_sampling(zt_options *options, const char *const *values, zt_report *report) {
    const char *samples = values[ZT_OPTION_SAMPLES], *error = values[ZT_OPTION_ERROR],
               *quality = values[ZT_OPTION_QUALITY], *filter = values[ZT_OPTION_FILTER];
    char *text = options->samples;
    size_t size = sizeof options->samples;
    int64_t min = 0, max = 0;
    if (quality && !add_set(options, "film.quality", quality, report)) return false;
    if (filter && !add_set(options, "film.filter", filter, report)) return false;
    if (samples && !zt_value_samples(&min, &max, samples, error, report)) return false;
    if (!error && !quality) {
        options->settings.samples = (int)max;
        return true;
    }
    if (error && min)
        snprintf(text, size, "{min: %" PRId64 ", max: %" PRId64 ", error: %s}", min, max,
                 error);
    else if (error && max)
        snprintf(text, size, "{max: %" PRId64 ", error: %s}", max, error);
    else if (error)
        snprintf(text, size, "{error: %s}", error);
    else if (max)
        snprintf(text, size, "%" PRId64, max);
    return !*text || add_set(options, "film.samples", text, report);
}

/* What is said of how light is shown stands in for the description's word, where there is one.
 */
static bool set_view(zt_options *options, const char *view, zt_report *report) {
    options->view = view;
    return !view ||
           (zt_value_view(view, report) && (options->command == ZT_COMMAND_ENCODE ||
                                            add_set(options, "film.view", view, report)));
}

static bool read_values(zt_options *options, const arguments *sorted, zt_report *report) {
    const zt_command_row *command = &zt_commands[options->command];
    const char *const *values = sorted->values;
    for (int i = 0; i < ZT_OPTION_COUNT; i++)
        if (values[i] && !(command->takes >> i & 1)) {
            zt_report_say(report, ZT_ERROR, "%s takes no --%s", command->name,
                          zt_options_known[i].name);
            return false;
        }
    const char *frames = values[ZT_OPTION_FRAMES], *size = values[ZT_OPTION_SIZE],
               *threads = values[ZT_OPTION_THREADS], *precision = values[ZT_OPTION_PRECISION],
               *time = values[ZT_OPTION_TIME], *frame_time = values[ZT_OPTION_TIME_PER_FRAME],
               *pixel = values[ZT_OPTION_PIXEL], *sample = values[ZT_OPTION_SAMPLE],
               *chunk = values[ZT_OPTION_CHUNK], *rate = values[ZT_OPTION_RATE],
               *verify = values[ZT_OPTION_VERIFY], *keep = values[ZT_OPTION_KEEP],
               *aovs = values[ZT_OPTION_AOVS],
               *frame =
                   command == &zt_commands[ZT_COMMAND_EXPLAIN] ? values[ZT_OPTION_FRAME] : NULL;
    zt_render_settings *settings = &options->settings;
    options->target = values[ZT_OPTION_OUTPUT];
    options->quiet = values[ZT_OPTION_QUIET] != NULL;
    options->manifest = values[ZT_OPTION_MANIFEST];
    options->frame_list = values[ZT_OPTION_FRAME];
    options->overwrites = values[ZT_OPTION_OVERWRITE] != NULL;
    options->stats = values[ZT_OPTION_STATS] != NULL;
    settings->no_reuse = values[ZT_OPTION_NO_REUSE] != NULL;
    settings->check_reuse = values[ZT_OPTION_CHECK_REUSE] != NULL;
    options->replays = values[ZT_OPTION_PIXEL] != NULL;
    options->filters = values[ZT_OPTION_FILTERS] != NULL;
    options->sample = -1;
    options->keep_bytes = KEEP_BYTES;
    return fit_together(values, report) &&
           (!time ||
            zt_value_duration(&options->budget.film_s, ZT_OPTION_TIME, time, report)) &&
           (!frame_time || zt_value_duration(&options->budget.frame_s, ZT_OPTION_TIME_PER_FRAME,
                                             frame_time, report)) &&
           (!pixel || zt_value_pixel(&options->column, &options->row, pixel, report)) &&
           (!sample || zt_value_sample(&options->sample, sample, report)) &&
           (!frames || read_frames(options, frames, report)) &&
           (!frame || read_frame(options, frame, report)) &&
           (!chunk || zt_value_part(&options->part, &options->part_count, chunk, report)) &&
           (!verify ||
            zt_value_count(&options->verify, ZT_OPTION_VERIFY, verify, VERIFY_MAX, report)) &&
           (!keep || zt_value_bytes(&options->keep_bytes, ZT_OPTION_KEEP, keep, report)) &&
           (!aovs || zt_value_aovs(&settings->aovs, aovs, report)) &&
           set_view(options, values[ZT_OPTION_VIEW], report) &&
           (!rate || zt_value_rate(&options->rate, rate, report)) &&
           (!size || zt_value_size(settings, size, report)) &&
           (!precision || zt_value_precision(settings, precision, report)) &&
           set_sampling(options, values, report) &&
           (!threads || zt_value_count(&settings->threads, ZT_OPTION_THREADS, threads,
                                       THREADS_MAX, report));
}

static zt_request understand(zt_options *options, const arguments *sorted, zt_report *report) {
    const char *command = sorted->words[0];
    if (sorted->values[ZT_OPTION_VERSION]) {
        puts("zoetrope " ZT_VERSION);
        return ZT_REQUEST_SHOWN;
    }
    if (command) options->command = zt_command_find(command);
    if (command && options->command == ZT_COMMAND_COUNT) {
        say_unknown_command(report, command);
        return ZT_REQUEST_WRONG;
    }
    if (sorted->values[ZT_OPTION_HELP]) {
        zt_command_help(stdout, options->command);
        return ZT_REQUEST_SHOWN;
    }
    if (!command) {
        zt_command_help(stderr, ZT_COMMAND_COUNT);
        return ZT_REQUEST_WRONG;
    }
    bool good = read_values(options, sorted, report) && read_words(options, sorted, report) &&
                zt_options_check_target(options, report);
    return good ? ZT_REQUEST_RUN : ZT_REQUEST_WRONG;
}

zt_request zt_options_read(zt_options *options, int argc, char **argv, zt_report *report) {
    *options = (zt_options){.command = ZT_COMMAND_COUNT, .all_frames = true};
    arguments sorted = {.options = options};
    if (!sort_arguments(&sorted, argc, argv, report)) return ZT_REQUEST_WRONG;
    return understand(options, &sorted, report);
}
