#include <zoetrope/frames.h>

#include <ctype.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/diag.h"

/* As many as a film may have. */
#define FRAMES_MAX INT64_C(100000000)

/* What stands between two commas. */
typedef struct range {
    int64_t first, last, step;
    bool spread; /* all of them, but those at the steps first */
} range;

typedef struct reading {
    const char *text, *at;
    int64_t film_frame_count;
    zt_listener listener;
} reading;

static zt_status refuse(const reading *r, const char *why) {
    zt_tell(r->listener, ZT_ERROR, "frames %s: at \"%s\": %s", r->text, r->at, why);
    return ZT_EARGUMENT;
}

static void skip_blanks(reading *r) {
    while (isspace((unsigned char)*r->at)) r->at++;
}

static bool accept(reading *r, char letter) {
    skip_blanks(r);
    if (*r->at != letter) return false;
    r->at++;
    return true;
}

static zt_status read_number(int64_t *number, reading *r) {
    skip_blanks(r);
    const char *begin = r->at;
    bool negative = accept(r, '-');
    int64_t value = 0;
    if (!isdigit((unsigned char)*r->at)) {
        r->at = begin;
        return refuse(r, "a frame's number belongs here");
    }
    for (; isdigit((unsigned char)*r->at); r->at++)
        if (value <= FRAMES_MAX) value = 10 * value + (*r->at - '0');
    *number = negative ? -value : value;
    return ZT_OK;
}

static zt_status read_frame(int64_t *frame, reading *r) {
    const char *begin = r->at;
    ZT_TRY(read_number(frame, r));
    if (*frame < 0) *frame += r->film_frame_count;
    if (*frame >= 0 && *frame < r->film_frame_count) return ZT_OK;
    zt_tell(r->listener, ZT_ERROR,
            "frames %s: there is no frame %.*s: the film has frames 0 to %" PRId64, r->text,
            (int)(r->at - begin), begin, r->film_frame_count - 1);
    return ZT_EARGUMENT;
}

static zt_status read_range(range *out, reading *r) {
    *out = (range){.step = 1};
    ZT_TRY(read_frame(&out->first, r));
    out->last = out->first;
    if (!accept(r, '-')) return ZT_OK;
    ZT_TRY(read_frame(&out->last, r));
    out->spread = accept(r, ':');
    if (!out->spread && !accept(r, 'x')) return ZT_OK;
    ZT_TRY(read_number(&out->step, r));
    return out->step >= 1 ? ZT_OK : refuse(r, "the step must be at least 1");
}

static int64_t length_of(const range *r) { return llabs(r->last - r->first) + 1; }

/* Adds first + offset, and so on by steps. */
static void push_steps(zt_frames *frames, const range *r, int64_t offset) {
    int64_t way = r->last < r->first ? -1 : 1;
    for (int64_t i = offset; i < length_of(r); i += r->step)
        frames->numbers[frames->count++] = r->first + way * i;
}

/* The steps' own frames come first, then those halfway to the next ones, and so on: the offsets
 * in the order of van der Corput's sequence, their bits reversed. */
static void push_range(zt_frames *frames, const range *r) {
    int bits = 0;
    if (!r->spread) {
        push_steps(frames, r, 0);
        return;
    }
    while ((INT64_C(1) << bits) < r->step && (INT64_C(1) << bits) < length_of(r)) bits++;
    for (int64_t i = 0; i < INT64_C(1) << bits; i++) {
        int64_t offset = 0;
        for (int b = 0; b < bits; b++) offset |= (i >> b & 1) << (bits - 1 - b);
        if (offset < r->step) push_steps(frames, r, offset);
    }
}

/* ---- each once ------------------------------------------------------------------------------
 */

typedef struct place {
    int64_t number, position;
} place;

static int by_number(const void *pa, const void *pb) {
    const place *a = pa, *b = pb;
    if (a->number != b->number) return a->number < b->number ? -1 : 1;
    return (a->position > b->position) - (a->position < b->position);
}

static int by_position(const void *pa, const void *pb) {
    const place *a = pa, *b = pb;
    return (a->position > b->position) - (a->position < b->position);
}

/* Leaves the first of those that are there twice. */
static zt_status leave_once(zt_frames *frames) {
    place *places = malloc((size_t)frames->count * sizeof *places);
    int64_t count = 0;
    if (!places) return ZT_EMEMORY;
    for (int64_t i = 0; i < frames->count; i++) places[i] = (place){frames->numbers[i], i};
    qsort(places, (size_t)frames->count, sizeof *places, by_number);
    for (int64_t i = 0; i < frames->count; i++)
        if (i == 0 || places[i].number != places[i - 1].number) places[count++] = places[i];
    qsort(places, (size_t)count, sizeof *places, by_position);
    for (int64_t i = 0; i < count; i++) frames->numbers[i] = places[i].number;
    frames->count = count;
    free(places);
    return ZT_OK;
}

static zt_status read_ranges(zt_frames *frames, reading *r) {
    int64_t room = 0;
    do {
        range next;
        ZT_TRY(read_range(&next, r));
        room += length_of(&next);
        if (room > FRAMES_MAX) return refuse(r, "these are too many frames");
        int64_t *numbers = realloc(frames->numbers, (size_t)room * sizeof *numbers);
        if (!numbers) return ZT_EMEMORY;
        frames->numbers = numbers;
        push_range(frames, &next);
    } while (accept(r, ','));
    if (*r->at)
        return refuse(r, "frames are written as 7, 1-100, 1-100x5 or 1-100:10, with commas "
                         "between them");
    return leave_once(frames);
}

zt_status zt_frames_read(zt_frames *frames, const char *text, int64_t film_frame_count,
                         zt_listener listener) {
    reading r = {text, text, film_frame_count, listener};
    *frames = (zt_frames){0};
    zt_status status = read_ranges(frames, &r);
    if (status != ZT_OK) zt_frames_free(frames);
    return status;
}

void zt_frames_free(zt_frames *frames) {
    free(frames->numbers);
    *frames = (zt_frames){0};
}

static int rising(const void *pa, const void *pb) {
    const int64_t *a = pa, *b = pb;
    return (*a > *b) - (*a < *b);
}

void zt_frames_sort(zt_frames *frames) {
    qsort(frames->numbers, (size_t)frames->count, sizeof *frames->numbers, rising);
}
