/* Where images go: numbered stills, a movie, checksums. */
#ifndef ZOETROPE_OUTPUT_H
#define ZOETROPE_OUTPUT_H

#include <stdbool.h>
#include <stdint.h>

#include <zoetrope/image.h>
#include <zoetrope/rate.h>
#include <zoetrope/status.h>
#include <zoetrope/wish.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct zt_output zt_output;

/* What an output is told before the first image. */
typedef struct zt_output_format {
    int width, height;
    zt_rate rate;
    zt_view view;
    int64_t frame_count; /* how many will come; 0 where that is not known */
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
 * - pixel-format: as FFmpeg calls it, "yuv420p10le"; those with an "a" have alpha, which else
 * is left out;
 * - encoder-option: "key=value" for the encoder itself; any number of times.
 */
typedef zt_wish zt_output_option;

/* Opens an output, chosen by the name of `target`. `options` end with one whose name is NULL,
 * and may be NULL; of two with one name the later counts.
 *
 * - film.mp4: a movie, H.264 where no codec is wished for; also .mov .mkv, .webm (VP9), .gif,
 * .apng.
 * - frames.####.png, frames.%04d.exr: numbered images, also .tif .tiff .jpg .jpeg; one # for
 * each digit, and more digits where the number needs them.
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

/* Writes the image of `frame`; frames come in rising order. The image stays the caller's. */
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
