#include "description/trial.h"

#include <stdio.h>
#include <string.h>

#include "keyframe/order.h"

/* "a.radius needs itself" or "a.radius needs b.radius, which needs a.radius". */
static void tell_cycle(void *user, const zt_animation *animation, const int32_t *tracks,
                       int32_t count) {
    enum { SHOWN_MAX = 8 };
    zt_mistakes *mistakes = user;
    char chain[800] = "";
    const zt_track *first = &animation->tracks[tracks[0]];
    for (int32_t i = 1; i < count && i <= SHOWN_MAX; i++) {
        size_t used = strlen(chain);
        snprintf(chain + used, sizeof chain - used, "%s, which needs ",
                 i == SHOWN_MAX ? "others" : zt_show(animation->tracks[tracks[i]].name).text);
    }
    zt_mistake(mistakes, &first->place, "%s needs %s%s", zt_show(first->name).text, chain,
               count > 1 ? zt_show(first->name).text : "itself");
    for (int32_t i = 1; i < count && i < SHOWN_MAX; i++)
        zt_mistake_note(mistakes, &animation->tracks[tracks[i]].place, "%s is here",
                        zt_show(animation->tracks[tracks[i]].name).text);
}

/* What freezing tells is a mistake in the description. */
static void count_mistake(void *user, const zt_message *message) {
    zt_place place = {message->file, message->source_line, message->line, message->column,
                      message->length};
    zt_mistake(user, &place, "%s", message->text);
}

/* All that is driven has its value of time 0 in the scene at rest, as keys have. */
static void settle(zt_animation *animation, const zt_scene *begin) {
    for (int32_t i = 0; i < animation->track_count; i++) {
        const zt_track *track = &animation->tracks[i];
        double value[ZT_VALUE_WIDTH_MAX];
        if (track->kind == ZT_TRACK_CURVE) continue;
        zt_property_get(value, track->property, begin, track->index);
        zt_property_set(track->property, &animation->rest, track->index, value);
    }
}

static zt_status try_frames(zt_reading *reading) {
    zt_animation *animation = reading->animation;
    const zt_film *film = &animation->film;
    const int64_t frames[3] = {0, film->frame_count / 2, film->frame_count - 1};
    zt_listener listener = {count_mistake, &reading->mistakes};
    zt_arena arena = {0};
    zt_status status = ZT_OK;
    for (int i = 0; i < 3 && status == ZT_OK; i++) {
        zt_scene scene;
        zt_arena_reset(&arena);
        status = zt_animation_freeze(&scene, animation, zt_rate_time(film->rate, frames[i]),
                                     &arena, listener);
        if (status == ZT_OK && i == 0) settle(animation, &scene);
    }
    zt_arena_free(&arena);
    return status;
}

zt_status zt_trial(zt_reading *reading) {
    zt_mistakes *mistakes = &reading->mistakes;
    ZT_TRY(zt_animation_sort(reading->animation, (zt_cycle_listener){tell_cycle, mistakes}));
    return mistakes->count == 0 ? try_frames(reading) : ZT_OK;
}
