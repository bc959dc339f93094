#include "cli/curves.h"

#include <inttypes.h>
#include <stdlib.h>

#include "cli/plot.h"

/* The properties to plot, of the caller to free. */
static zt_status choose(zt_subject **subjects, int *count, const zt_options *options,
                        const zt_animation *animation, zt_report *report) {
    int moving = zt_animation_contents(animation).track_count;
    *count = options->property_count > 0 ? options->property_count : moving;
    if (*count == 0) {
        zt_report_say(report, ZT_ERROR, "%s: nothing moves, so there is nothing to plot",
                      options->file);
        return ZT_EARGUMENT;
    }
    *subjects = calloc((size_t)*count, sizeof **subjects);
    if (!*subjects) return ZT_EMEMORY;
    zt_status status = ZT_OK;
    for (int i = 0; i < *count && status == ZT_OK; i++)
        if (options->property_count > 0)
            status = zt_subject_find(&(*subjects)[i], animation, options->properties[i],
                                     zt_report_listener(report));
        else
            (*subjects)[i] = zt_subject_of_movement(animation, i);
    return status;
}

zt_status zt_curves(const zt_options *options, const zt_animation *animation,
                    zt_report *report) {
    const zt_film *film = zt_animation_film(animation);
    int64_t last = options->all_frames ? film->frame_count - 1 : options->last;
    zt_subject *subjects = NULL;
    char *svg = NULL;
    int count;
    size_t length;
    char *target = zt_options_target(options);
    zt_status status =
        target ? choose(&subjects, &count, options, animation, report) : ZT_EMEMORY;
    if (status == ZT_OK)
        status = zt_plot_draw(&svg, &length, subjects, count, options->first, last,
                              zt_report_listener(report));
    if (status == ZT_OK)
        status = zt_drawing_write(target, svg, length, zt_report_listener(report));
    if (status == ZT_OK)
        zt_report_line(report, true, "%s: %d plot%s of frames %" PRId64 " to %" PRId64, target,
                       count, count == 1 ? "" : "s", options->first, last);
    free(svg);
    free(subjects);
    free(target);
    return status;
}
