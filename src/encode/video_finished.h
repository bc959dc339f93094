/* A film that is finished: how it is known again, so that one that nothing has changed of is
 * not made anew. */
#ifndef ZT_ENCODE_VIDEO_FINISHED_H
#define ZT_ENCODE_VIDEO_FINISHED_H

#include <stdbool.h>

#include "encode/video_codecs.h"

/* What a film says and sounds besides its frames: its kind, texts, `settings` among them, and
 * the contents of the file with the sound. */
zt_hash zt_video_said(const zt_video_choice *choice, const char *settings, const char *target);

/* A record of the finished film of all frames of the plan. ZT_EFILE, told, where it cannot be
 * read. */
zt_status zt_video_finished_record(zt_output_record *record, const char *path, zt_hash key,
                                   const zt_output_plan *plan, const zt_video_ear *ear);

/* Whether the film is there, to the bit, with which `key` was recorded last. */
bool zt_video_finished_is(const char *path, zt_hash key, const zt_output_plan *plan);

#endif
