/* From images of linear light to the frames that an encoder takes, and how far those that come
 * back are from them. */
#ifndef ZT_ENCODE_VIDEO_PIXELS_H
#define ZT_ENCODE_VIDEO_PIXELS_H

#include <libavutil/frame.h>

#include <zoetrope/output.h>

#include "encode/video_libav.h"

typedef struct zt_video_pixels zt_video_pixels;

/* For frames of `pixels`, by the format's view or its wish for a view of OpenColorIO. */
zt_status zt_video_pixels_open(zt_video_pixels **converter, const zt_output_format *format,
                               enum AVPixelFormat pixels, const zt_video_ear *ear);
void zt_video_pixels_close(zt_video_pixels **converter);

/* All that decides how an image's light becomes the numbers of a frame, as a text. */
const char *zt_video_pixels_manner(const zt_video_pixels *converter);

/* A frame of this size that shows nothing in particular, tagged; of the caller to free. */
zt_status zt_video_pixels_like(AVFrame **frame, const zt_video_pixels *converter, int width,
                               int height, const zt_video_ear *ear);

/* A new frame, of the caller to free, not to be written to: developed, converted, dithered,
 * tagged. Formats with alpha get the image's, and colours that are not multiplied by it; others
 * are opaque. From any thread, several at once. */
zt_status zt_video_pixels_convert(AVFrame **frame, const zt_video_pixels *converter,
                                  const zt_image *image, const zt_video_ear *ear);

/* How many tiles of images were not converted, since they were the same as before. */
int64_t zt_video_pixels_spared(const zt_video_pixels *converter);

/* The peak signal-to-noise ratio over all numbers of all components of `sent`, INFINITY where
 * they are the same; negative where the frames cannot be compared. */
double zt_video_psnr(const AVFrame *found, const AVFrame *sent);

#endif
