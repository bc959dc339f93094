#include "cli/commands.h"

#include <assert.h>
#include <limits.h>
#include <string.h>

#define BIT(option) (UINT64_C(1) << ZT_OPTION_##option)
#define ANYWHERE    (BIT(SET) | BIT(QUIET) | BIT(HELP) | BIT(VERSION))
#define OF_OUTPUT                                                                              \
    (BIT(CODEC) | BIT(CRF) | BIT(BITRATE) | BIT(PRESET) | BIT(PIXEL_FORMAT) |                  \
     BIT(ENCODER_OPTION) | BIT(FORMAT_OPTION) | BIT(COMMENT) | BIT(AUDIO))
#define MOVIE (OF_OUTPUT | BIT(VIEW))
#define ONE_FRAME                                                                              \
    (ANYWHERE | MOVIE | BIT(OUTPUT) | BIT(OVERWRITE) | BIT(SIZE) | BIT(SAMPLES) |              \
     BIT(THREADS) | BIT(PRECISION) | BIT(STATS))
#define FINISHED                                                                               \
    (ONE_FRAME | BIT(ERROR) | BIT(QUALITY) | BIT(FILTER) | BIT(TIME) | BIT(TIME_PER_FRAME) |   \
     BIT(MANIFEST) | BIT(AOVS))
#define REUSE (BIT(NO_REUSE) | BIT(CHECK_REUSE) | BIT(KEEP))

static const char images[] =
    "  film.mp4         a movie, H.264; also .mov .mkv, .webm (VP9), .gif, .apng\n"
    "  frames.####.png  numbered images; also frames.%04d.png; also .exr .tif .jpg\n"
    "  image.png        one image\n"
    "  film.hash        a line with a checksum for each frame\n";
static const char drawings[] = "  curves.svg       a drawing\n"
                               "  curves.png       the same as an image\n";

static const char reports[] =
    "  report.html      a page; report.svg, .png, .csv and .json come beside it\n";

const zt_command_row zt_commands[ZT_COMMAND_COUNT] = {
    [ZT_COMMAND_RENDER] = {"render", "FILE", 1, 0,
                           "All frames become a movie, or numbered images", "output/NAME.mp4",
                           images, FINISHED | BIT(FRAMES) | BIT(CHUNK) | BIT(VERIFY) | REUSE},
    [ZT_COMMAND_FRAME] = {"frame", "FILE N", 2, 0, "Frame N alone becomes an image",
                          "output/NAME.NNNN.png", images, FINISHED | BIT(PIXEL) | BIT(SAMPLE)},
    [ZT_COMMAND_PREVIEW] = {"preview", "FILE", 1, 0,
                            "A quick movie: a quarter of the size, one sample a pixel",
                            "output/NAME.preview.mp4", images,
                            ONE_FRAME | BIT(FRAMES) | BIT(CHUNK) | REUSE},
    [ZT_COMMAND_CHECK] = {"check", "FILE", 1, 0,
                          "Tells mistakes, what is probably not meant, what FILE holds", NULL,
                          NULL, ANYWHERE},
    [ZT_COMMAND_EXPLAIN] = {"explain", "FILE [NAME@TIME]", 1, 1,
                            "Tells what a property does at a frame, and why: "
                            "ball.center@37; or what is chosen for frames",
                            NULL, NULL, ANYWHERE | BIT(FRAMES) | BIT(FRAME)},
    [ZT_COMMAND_CURVES] = {"curves", "FILE [NAME...]", 1, INT_MAX,
                           "Plots properties over time, or all that move: ball.center",
                           "output/NAME.curves.svg", drawings,
                           ANYWHERE | BIT(OUTPUT) | BIT(FRAMES)},
    [ZT_COMMAND_REPORT] = {"report", "FILE", 1, 0,
                           "Sets error against run time, from a sample a pixel to many",
                           "output/NAME.report.html", reports,
                           ANYWHERE | BIT(OUTPUT) | BIT(FRAME) | BIT(SIZE) | BIT(SAMPLES) |
                               BIT(FILTERS) | BIT(TIME_PER_FRAME) | BIT(THREADS) |
                               BIT(PRECISION)},
    [ZT_COMMAND_ENCODE] = {"encode", "FRAMES", 1, 0,
                           "Images that are there, NAME.####.exr, become a movie",
                           "output/NAME.mp4", images,
                           (ANYWHERE & ~BIT(SET)) | MOVIE | BIT(OUTPUT) | BIT(OVERWRITE) |
                               BIT(RATE)},
    [ZT_COMMAND_DIFF] = {"diff", "OLD NEW", 2, 0,
                         "Tells which frames change, because of what, and how long they take",
                         NULL, NULL,
                         ANYWHERE | BIT(OUTPUT) | BIT(SIZE) | BIT(SAMPLES) | BIT(THREADS) |
                             BIT(PRECISION)},
    [ZT_COMMAND_REPRODUCE] = {"reproduce", "IMAGE [FILE]", 1, 1,
                              "Renders the frame of an .exr, .png or .tif again, and compares",
                              NULL, NULL, (ANYWHERE & ~BIT(SET)) | BIT(THREADS)},
};

const zt_option_row zt_options_known[ZT_OPTION_COUNT] = {
    [ZT_OPTION_OUTPUT] = {"output", 'o', "TARGET", "where the results go"},
    [ZT_OPTION_FRAMES] = {"frames", 0, "10-40",
                          "only these frames, or one (7); the first is 0; where images are "
                          "made also 1-100x5, 100-1, 1-100:10, -24--1, with commas between"},
    [ZT_OPTION_FRAME] = {"frame", 0, "10,40",
                         "the frames to measure; the middle one by default"},
    [ZT_OPTION_CHUNK] = {"chunk", 0, "3/8", "of the frames, the third of eight equal parts"},
    [ZT_OPTION_OVERWRITE] = {"overwrite", 0, NULL, "render again what is there already"},
    [ZT_OPTION_VERIFY] = {"verify", 0, "N",
                          "of the images that are there already, render N again and compare"},
    [ZT_OPTION_RATE] = {"rate", 0, "30000/1001",
                        "frames a second, instead of what the images say, or 24"},
    [ZT_OPTION_SIZE] = {"size", 0, "640x360", "pixels, instead of the description's size"},
    [ZT_OPTION_SAMPLES] = {"samples", 0, "N",
                           "samples a pixel, instead of the description's; 4-64 with --error"},
    [ZT_OPTION_ERROR] = {"error", 0, "0.002",
                         "a pixel that is better takes no more samples; linear light"},
    [ZT_OPTION_QUALITY] = {"quality", 0, "edges",
                           "or even: one sample a pixel, and more at edges alone"},
    [ZT_OPTION_FILTER] = {"filter", 0, "gaussian",
                          "or box, tent, mitchell, blackman-harris, of samples"},
    [ZT_OPTION_FILTERS] = {"filters", 0, NULL, "measure each filter, not the film's own alone"},
    [ZT_OPTION_TIME] = {"time", 0, "20min",
                        "choose samples so that all frames take about as long: ms s min h"},
    [ZT_OPTION_TIME_PER_FRAME] = {"time-per-frame", 0, "2s",
                                  "choose samples so that each frame takes about as long"},
    [ZT_OPTION_MANIFEST] =
        {"manifest", 0, "FILE",
         "samples and size as they were: TARGET.manifest of a run with --time"},
    [ZT_OPTION_PIXEL] = {"pixel", 0, "200,120",
                         "print how this pixel's samples come about, and no image"},
    [ZT_OPTION_SAMPLE] = {"sample", 0, "3", "of the pixel, this one alone"},
    [ZT_OPTION_THREADS] = {"threads", 0, "N",
                           "instead of one a core; the images stay the same"},
    [ZT_OPTION_PRECISION] = {"precision", 0, "double",
                             "or single, of all rays, instead of what each frame asks for"},
    [ZT_OPTION_STATS] = {"stats", 0, NULL, "print in the end what was traced and what was not"},
    [ZT_OPTION_NO_REUSE] = {"no-reuse", 0, NULL,
                            "copy nothing from the frame before, nor from before an edit"},
    [ZT_OPTION_CHECK_REUSE] = {"check-reuse", 0, NULL,
                               "render frames both ways, and fail where a bit differs"},
    [ZT_OPTION_KEEP] =
        {"keep", 0, "2GB",
         "how much of the disk frames may take that are kept for later edits; 0: "
         "none"},
    [ZT_OPTION_AOVS] = {"aovs", 0, "Z,N",
                        "channels that .exr images have besides R G B A, or all"},
    [ZT_OPTION_VIEW] = {"view", 0, "filmic",
                        "or srgb, rec709, raw: how linear light is shown where it is for a "
                        "display"},
    [ZT_OPTION_CODEC] = {"codec", 0, "h265",
                         "of a movie: h264 h265 av1 vp9 prores prores4444 dnxhr ffv1 utvideo"},
    [ZT_OPTION_CRF] = {"crf", 0, "18", "how good a movie is, 0 the best, on its codec's scale"},
    [ZT_OPTION_BITRATE] = {"bitrate", 0, "8M", "bits a second of a movie, instead of --crf"},
    [ZT_OPTION_PRESET] = {"preset", 0, "medium",
                          "how long a movie's encoder takes, by its own names or numbers"},
    [ZT_OPTION_PIXEL_FORMAT] =
        {"pixel-format", 0, "yuv420p10",
         "of a movie, by FFmpeg's names; with an a, such as yuva444p10, it has alpha"},
    [ZT_OPTION_ENCODER_OPTION] = {"encoder-option", 0, "K=V",
                                  "for the movie's encoder itself; any number of times"},
    [ZT_OPTION_FORMAT_OPTION] = {"format-option", 0, "K=V",
                                 "of image files: bits=16, compression=dwaa:45, tile=64"},
    [ZT_OPTION_COMMENT] = {"comment", 0, "TEXT", "in the movie's metadata"},
    [ZT_OPTION_AUDIO] = {"audio", 0, "track.wav", "the movie's sound, instead of the film's"},
    [ZT_OPTION_SET] = {"set", 0, "NAME=40",
                       "in place of what FILE says: lamp.intensity=40; any number of times"},
    [ZT_OPTION_QUIET] = {"quiet", 'q', NULL, "print nothing but errors"},
    [ZT_OPTION_HELP] = {"help", 'h', NULL, "print this"},
    [ZT_OPTION_VERSION] = {"version", 0, NULL, "print the version"},
};

bool zt_option_is_of_output(zt_option option) { return OF_OUTPUT >> option & 1; }

zt_command zt_command_find(const char *name) {
    int i = 0;
    while (i < ZT_COMMAND_COUNT && strcmp(name, zt_commands[i].name) != 0) i++;
    return (zt_command)i;
}

/* How many letters must be put in, left out or changed (Levenshtein 1966). */
static size_t distance(const char *wanted, const char *known) {
    enum { KNOWN_MAX = 15 };
    size_t row[KNOWN_MAX + 1], length = strlen(known);
    assert(length <= KNOWN_MAX);
    for (size_t j = 0; j <= length; j++) row[j] = j;
    for (; *wanted; wanted++) {
        size_t corner = row[0]++;
        for (size_t j = 1; j <= length; j++) {
            size_t best = corner + (*wanted != known[j - 1]);
            corner = row[j];
            if (row[j - 1] + 1 < best) best = row[j - 1] + 1;
            if (corner + 1 < best) best = corner + 1;
            row[j] = best;
        }
    }
    return row[length];
}

static bool is_near(const char *wanted, const char *known) {
    if (!*wanted) return false;
    return strncmp(wanted, known, strlen(wanted)) == 0 ||
           distance(wanted, known) <= strlen(known) / 3;
}

zt_command zt_command_near(const char *name) {
    int i = 0;
    while (i < ZT_COMMAND_COUNT && !is_near(name, zt_commands[i].name)) i++;
    return (zt_command)i;
}

zt_option zt_option_near(const char *name) {
    int i = 0;
    while (i < ZT_OPTION_COUNT && !is_near(name, zt_options_known[i].name)) i++;
    return (zt_option)i;
}

static void print_option(FILE *stream, const zt_option_row *row) {
    char name[32];
    snprintf(name, sizeof name, "--%s %s", row->name, row->example ? row->example : "");
    if (row->letter)
        fprintf(stream, "  -%c, ", row->letter);
    else
        fputs("      ", stream);
    fprintf(stream, "%-18s  %s\n", name, row->help);
}

static void print_summary(FILE *stream) {
    fputs("Usage: zoetrope COMMAND FILE [OPTION]...\n\n"
          "Makes a film of FILE, the description of an animation.\n\nCommands:\n",
          stream);
    for (int i = 0; i < ZT_COMMAND_COUNT; i++)
        fprintf(stream, "  %-7s %-16s  %s\n", zt_commands[i].name, zt_commands[i].words,
                zt_commands[i].help);
}

void zt_command_help(FILE *stream, zt_command command) {
    const zt_command_row *row = command < ZT_COMMAND_COUNT ? &zt_commands[command] : NULL;
    if (row)
        fprintf(stream, "Usage: zoetrope %s %s [OPTION]...\n\n%s.\n", row->name, row->words,
                row->help);
    else
        print_summary(stream);
    fputs("\nOptions:\n", stream);
    for (int i = 0; i < ZT_OPTION_COUNT; i++)
        if (!row || row->takes >> i & 1) print_option(stream, &zt_options_known[i]);
    if (!row)
        fputs("\n\"zoetrope COMMAND --help\" tells more of a command.\n", stream);
    else if (row->target)
        fprintf(stream,
                "\nTARGET is %s where none is given, NAME being that of FILE. It may be\n%s",
                row->target, row->forms);
}
