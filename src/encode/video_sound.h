/* Sound from a file beside the pictures: copied where the container takes its codec, else
 * encoded; never longer than the film. */
#ifndef ZT_ENCODE_VIDEO_SOUND_H
#define ZT_ENCODE_VIDEO_SOUND_H

#include <libavformat/avformat.h>

#include "encode/video_codecs.h"

typedef struct zt_video_sound zt_video_sound;

/* Opens the file and adds a stream to `into`, whose head is not yet written. */
zt_status zt_video_sound_open(zt_video_sound **sound, const char *path, AVFormatContext *into,
                              const zt_container *kind, const zt_video_ear *ear);

/* Writes what sounds during the first `count` frames of this duration. */
zt_status zt_video_sound_write(zt_video_sound *sound, int64_t count, AVRational duration,
                               const zt_video_ear *ear);

/* No more frames come: writes the rest up to the end of the last one. */
zt_status zt_video_sound_finish(zt_video_sound *sound, const zt_video_ear *ear);

void zt_video_sound_close(zt_video_sound **sound);

#endif
