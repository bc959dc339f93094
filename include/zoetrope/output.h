/* Where images go: numbered stills, a movie, checksums. */
#ifndef ZOETROPE_OUTPUT_H
#define ZOETROPE_OUTPUT_H

#include <stdbool.h>
#include <stdint.h>

#include <zoetrope/color.h>
#include <zoetrope/hash.h>
#include <zoetrope/image.h>
#include <zoetrope/rate.h>
#include <zoetrope/status.h>
#include <zoetrope/wish.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct zt_output zt_output;

/* Something that an output has completed and can find again. */
typedef enum zt_record_kind {
    ZT_RECORD_IMAGE, /* an image of numbered ones, with its final name */
    ZT_RECORD_PIECE, /* some frames of a movie, encoded so that they stand alone */
    ZT_RECORD_FILM   /* a movie under its final name, complete */
} zt_record_kind;

typedef struct zt_output_record {
    zt_record_kind kind;
    int64_t first; /* an image: its frame's number; else the position of the first frame, as
                      frames come, from 0 */
    int64_t count; /* of frames; 1 of an image */
    zt_hash key;   /* of what decides the bytes: all of its frames' keys, and how they are
                      written */
    int64_t bytes; /* the size of the file, or files; of a piece, where it ends in the file that
                      grows */
    zt_hash checksum; /* of the file, or files; of a piece, of what is in it */
    double render_s;  /* seconds of wall time that its frames took to render, added up */
    const char *file; /* of an image: its file, for readers: nothing is opened by it. NULL:
                         none, or not known */
} zt_output_record;

/* What is to come, and what there is of it. The caller's, until the output is closed. */
typedef struct zt_output_plan {
    const int64_t *frames; /* by position: the order in which they come */
    const zt_hash *keys;   /* likewise: of what each will show; zero: not known before */
    int64_t count;
    const zt_output_record *records; /* of earlier runs, in any order; the later ones count */
    int64_t record_count;
    bool overwrites; /* files that are not known from the records, and whatever the records say
                      */
    /* Is told of each thing that was completed, in turn, from any thread, so that it can be
     * found again after an interruption: just before it gets its name, so that nothing has one
     * that is not known. May be NULL. */
    zt_status (*completed)(void *user, const zt_output_record *record);
    void *user;
} zt_output_plan;

/* What an output is told before the first image. */
typedef struct zt_output_format {
    int width, height;
    zt_rate rate;
    zt_view view;
    zt_color_wish color; /* counts instead of the view; its texts are for opening alone */
    int64_t frame_count; /* how many will come; 0 where that is not known */
    const zt_output_plan
        *plan; /* NULL: frames come as they do, and what is there is replaced */
    /* What the film says of itself in files that have place for it; NULL: nothing. Not needed
     * once the output is open. */
    const char *settings;    /* as in zt_image_info, but for what is each frame's own */
    const char *description; /* the name of its file */
    unsigned aovs;           /* bits of zt_aov that images have, for the {layer} of a target */
    bool transparent; /* the images' A says something: movies have it where their codec can */
} zt_output_format;

/* A wish for how an output is written. All know, and leave out where they cannot hold it,
 *
 * - title, comment: texts for the container's metadata, where the settings are, too;
 * - audio: a file with sound, which is copied or encoded, and ends with the film.
 *
 * A movie knows
 *
 * - codec: h264, h265, av1, vp9, prores, prores4444, dnxhr, ffv1, gif, apng, where the
 * container takes it;
 * - crf: a constant quality on the codec's own scale, 0 is the best; or bitrate: bits a second,
 *   "8M", "800k";
 * - preset: how much time the encoder takes for a frame: of h264 and h265 ultrafast, superfast,
 *   veryfast (where nothing is wished for), faster, fast, medium, slow, slower, veryslow,
 *   placebo; of av1 13 to 0, of vp9 8 to 0;
 * - pixel-format: as FFmpeg calls it, "yuv420p10le"; those with an "a" have alpha, as
 *   transparent films have by themselves where the codec can;
 * - encoder-option: "key=value" for the encoder itself; any number of times.
 */
typedef zt_wish zt_output_option;

/* Puts names into the places that a target has for them, {name} and {camera}; {layer}, of which
 * images know, stays. What of a name would lead elsewhere or be a place itself becomes "_". The
 * caller frees the path. ZT_EARGUMENT for another place, told; ZT_EMEMORY. */
zt_status zt_output_target(char **path, const char *target, const char *name,
                           const char *camera, zt_listener listener);

/* Opens an output, chosen by the name of `target`. `options` end with one whose name is NULL,
 * and may be NULL; of two with one name the later counts.
 *
 * - film.mp4: a movie, H.264 where no codec is wished for; also .mov .mkv, .webm (VP9), .gif,
 * .apng.
 * - frames.####.png, frames.%04d.exr, frames.@@@@.tif: numbered images, also .tif .tiff .jpg
 * .jpeg; one # for each digit, and more digits where the number needs them.
 * - {layer}.####.exr, shots/{layer}/####.exr: of each frame a file for colours, "rgba", and one
 * for each layer of format->aovs: "depth", "P", "N", ...; "id" has all that begin with it.
 * - image.png: one image; a second one is refused.
 * - film.hash: a line for each frame, with its number, its size, and the XXH3 128-bit checksum
 * of its float pixels, in fixed columns.
 *
 * All that can be refused is refused here, before the first image is made: unknown names and
 * options, odd sizes for a movie, a directory that cannot be written, a disk that is clearly
 * too full. Missing directories are made. Nothing appears under its final name before it is
 * complete. */
zt_status zt_output_open(zt_output **output, const char *target, const zt_output_format *format,
                         const zt_output_option *options, zt_listener listener);

/* Whether the image at a position of the plan has to come: it has not, where what is recorded
 * of it, with the same key, is there whole. True without a plan. Those that need not come must
 * not. May take as long as reading a file. */
bool zt_output_wants(zt_output *output, int64_t position);

/* Writes the image of `frame`; with a plan they come in its order, else in rising order. The
 * image stays the caller's. */
zt_status zt_output_write(zt_output *output, const zt_image *image, int64_t frame);

/* Completes the files, gives them their names, and frees the output. What was written so far is
 * kept, so an interrupted film plays; when an earlier write failed or nothing was written, the
 * unfinished file is removed instead.
 *
 * A movie is then read back: how many frames, at which times, their size, codec and tags, and
 * three of them decoded and compared. What came of it is told as a note. A movie that is not as
 * it should be is ZT_EFILE; it stays beside the target as "film.mp4.part". */
zt_status zt_output_close(zt_output **output);

#ifdef __cplusplus
}
#endif
#endif
