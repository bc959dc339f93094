/* The camera's lens in a few words. */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/text.h"
#include "keyframe/animation.h"

__attribute__((format(printf, 2, 3))) static void say(zt_lens_words *words, const char *format,
                                                      ...) {
    size_t used = strlen(words->text);
    if (used > 0 && used < sizeof words->text)
        used += (size_t)snprintf(words->text + used, sizeof words->text - used, ", ");
    if (used >= sizeof words->text) return;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(words->text + used, sizeof words->text - used, format, arguments);
    va_end(arguments);
}

/* What a number of the camera does: that it moves; or what it is, after or before a word. */
static void say_number(zt_lens_words *words, const zt_animation *animation, const char *name,
                       double number, const char *format, const char *moving) {
    for (int32_t i = 0; i < animation->track_count; i++) {
        const zt_track *track = &animation->tracks[i];
        if (track->property->owner != ZT_OWNER_CAMERA ||
            !zt_text_equal(track->property->name, name))
            continue;
        say(words, "%s", moving);
        return;
    }
    if (!(number > 0)) return;
    char text[64];
    snprintf(text, sizeof text, "%s%.6g", format, number);
    say(words, "%s", text);
}

zt_lens_words zt_animation_lens(const zt_animation *animation) {
    const zt_camera *camera = &animation->rest.camera;
    zt_lens_words words = {""};
    if (camera->lens == ZT_LENS_EQUIRECTANGULAR) {
        say(&words, "equirectangular");
        return words;
    }
    if (camera->lens == ZT_LENS_ORTHOGRAPHIC) {
        say(&words, "orthographic");
        say_number(&words, animation, "height", camera->height, "height ",
                   "a height that moves");
    } else {
        say_number(&words, animation, "focal_length", camera->focal_length, "focal length ",
                   "a focal length that moves");
        say_number(&words, animation, "f_number", camera->f_number, "f/",
                   "an f-number that moves");
    }
    say_number(&words, animation, "aperture", camera->aperture, "opening ",
               "an opening that moves");
    if (camera->blades > 0) say(&words, "%d blades", (int)camera->blades);
    return words;
}
