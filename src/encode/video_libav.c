#include "encode/video_libav.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <threads.h>

#include <libavutil/log.h>

#include "base/text.h"

/* There is one callback for the whole process. */
static thread_local char complaint[256];

static void hear_libav(void *context, int level, const char *format, va_list arguments) {
    (void)context;
    if (level > AV_LOG_ERROR) return;
    vsnprintf(complaint, sizeof complaint, format, arguments);
    complaint[strcspn(complaint, "\r\n")] = '\0';
}

/* SVT-AV1 prints past libav; its environment variable, where nobody has set it, keeps it from
 * telling of anything (less than fatal errors, which are 0). */
static once_flag listening_once = ONCE_FLAG_INIT;
static void listen(void) {
    av_log_set_callback(hear_libav);
    setenv("SVT_LOG", "-2", 0);
}

void zt_libav_listen(void) {
    call_once(&listening_once, listen);
    *complaint = '\0';
}

char *zt_video_url(const char *path) { return zt_text_print("file:%s", path); }

const char *zt_libav_complaint(void) { return complaint; }

zt_status zt_video_refuse(const zt_video_ear *ear, zt_status status, const char *format, ...) {
    char *why = NULL;
    va_list arguments;
    va_start(arguments, format);
    int length = vasprintf(&why, format, arguments);
    va_end(arguments);
    if (length < 0) return ZT_EMEMORY;
    zt_tell(ear->listener, ZT_ERROR, "cannot write %s: %s", ear->target, why);
    free(why);
    return status;
}

void zt_libav_tell(const zt_video_ear *ear, int error) {
    zt_video_refuse(ear, ZT_EFILE, "%s%s%s", av_err2str(error), *complaint ? ": " : "",
                    complaint);
}
