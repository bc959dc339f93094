/* What follows from options that have been read: names, targets, frames. */
#include <ctype.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/options.h"

const char *zt_options_name(int *length, const zt_options *options) {
    const char *slash = strrchr(options->file, '/');
    const char *name = slash ? slash + 1 : options->file;
    const char *dot = strrchr(name, '.');
    size_t end = dot && dot > name ? (size_t)(dot - name) : strlen(name);
    if (options->command == ZT_COMMAND_ENCODE) {
        end = strcspn(name, "#@%");
        while (end > 0 && ispunct((unsigned char)name[end - 1])) end--;
        if (end == 0) end = strlen(name = "images");
    }
    *length = (int)end;
    return name;
}

/* With names in its places. A film has one camera, which has no name. */
static zt_status fill_target(char **target, const zt_options *options, zt_listener listener) {
    int length;
    const char *name = zt_options_name(&length, options);
    char *own = strndup(name, (size_t)length);
    if (!own) return ZT_EMEMORY;
    zt_status status = zt_output_target(target, options->target, own, "camera", listener);
    free(own);
    return status;
}

bool zt_options_check_target(const zt_options *options, zt_report *report) {
    char *target = NULL;
    bool good =
        !options->target || fill_target(&target, options, zt_report_listener(report)) == ZT_OK;
    free(target);
    return good;
}

char *zt_options_target(const zt_options *options) {
    char *target = NULL;
    if (options->target) {
        zt_status status = fill_target(&target, options, (zt_listener){NULL, NULL});
        return status == ZT_OK ? target : NULL;
    }
    int length;
    const char *name = zt_options_name(&length, options);
    int printed = 0;
    switch (options->command) {
    case ZT_COMMAND_FRAME:
        printed =
            asprintf(&target, "output/%.*s.%04" PRId64 ".png", length, name, options->first);
        break;
    case ZT_COMMAND_CURVES:
        printed = asprintf(&target, "output/%.*s.curves.svg", length, name);
        break;
    case ZT_COMMAND_REPORT:
        printed = asprintf(&target, "output/%.*s.report.html", length, name);
        break;
    case ZT_COMMAND_PREVIEW:
        printed = asprintf(&target, "output/%.*s.preview.mp4", length, name);
        break;
    default:
        printed = asprintf(&target, "output/%.*s.mp4", length, name);
    }
    return printed < 0 ? NULL : target;
}

zt_status zt_options_frames(zt_frames *frames, const zt_options *options, const zt_film *film,
                            zt_report *report) {
    char range[64] = "0--1"; /* to the last one */
    if (!options->all_frames)
        snprintf(range, sizeof range, "%" PRId64 "-%" PRId64, options->first, options->last);
    const char *text = options->frame_list ? options->frame_list : range;
    return zt_frames_read(frames, text, film->frame_count, zt_report_listener(report));
}
