/* Which frames, and in which order: the language of render farms. */
#ifndef ZOETROPE_FRAMES_H
#define ZOETROPE_FRAMES_H

#include <stdbool.h>
#include <stdint.h>

#include <zoetrope/status.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct zt_frames {
    int64_t *numbers; /* each once; owned */
    int64_t count;    /* at least 1 */
} zt_frames;

/* Reads ranges with commas between them, of a film of so many frames; negative numbers count
 * from its end, -1 is the last frame.
 *
 * - 7: one frame
 * - 1-100, 100-1: all of them, in this order
 * - 1-100x5: every fifth, 1, 6, 11 ...
 * - 1-100:10: all of them, every tenth first, then those between, so that what is there early
 *   covers the whole range
 *
 * A frame that is named again is not rendered again. ZT_EARGUMENT after telling what is wrong
 * and where; frames that the film has not are wrong. ZT_EMEMORY. The caller frees them. */
zt_status zt_frames_read(zt_frames *frames, const char *text, int64_t film_frame_count,
                         zt_listener listener);
void zt_frames_free(zt_frames *frames);

/* Puts them in rising order, as a movie asks for. */
void zt_frames_sort(zt_frames *frames);

#ifdef __cplusplus
}
#endif
#endif
