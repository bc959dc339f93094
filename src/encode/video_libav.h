/* What all of the door's files need of libav: its complaints, heard and told as ours. */
#ifndef ZT_ENCODE_VIDEO_LIBAV_H
#define ZT_ENCODE_VIDEO_LIBAV_H

#include <libavutil/error.h>

#include <zoetrope/status.h>

#include "base/diag.h"

/* Whom a refusal is told to, and of which file. */
typedef struct zt_video_ear {
    const char *target;
    zt_listener listener;
} zt_video_ear;

/* Hears libav's complaints from here on, instead of its printing them; forgets older ones. */
void zt_libav_listen(void);

/* Tells "cannot write film.mp4: ..." and returns `status`. */
__attribute__((format(printf, 3, 4))) zt_status
zt_video_refuse(const zt_video_ear *ear, zt_status status, const char *format, ...);

/* Tells a failure of libav, by its number and what it complained of. */
void zt_libav_tell(const zt_video_ear *ear, int error);

/* Tells it, unless it is a lack of memory, and returns the status that it comes to. */
static inline zt_status zt_libav_refuse(const zt_video_ear *ear, int error) {
    if (error == AVERROR(ENOMEM)) return ZT_EMEMORY;
    zt_libav_tell(ear, error);
    return ZT_EFILE;
}

/* What libav last complained of in this thread; "" for nothing. */
const char *zt_libav_complaint(void);

/* A file's name as libav takes it: never for a protocol. Of the caller to free; NULL when out
 * of memory. */
char *zt_video_url(const char *path);

/* Hands a failure of libav up as a status, after telling it. */
#define AV_TRY(ear, call)                                                                      \
    do {                                                                                       \
        int av_try_error = (call);                                                             \
        if (av_try_error < 0) return zt_libav_refuse(ear, av_try_error);                       \
    } while (0)

#endif
