#include "cli/explain.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LABEL_WIDTH = 10, NUMBER_WIDTH = 12 };

/* A line of a label and the numbers of a row, of which nothing rounds to minus zero. */
static void print_row(const char *label, const double *numbers, int count) {
    printf("%-*s", LABEL_WIDTH, label);
    for (int i = 0; i < count; i++)
        printf(" %*.6g", NUMBER_WIDTH, numbers[i] == 0 ? 0 : numbers[i]);
}

static void print_channels(const char *const *names, int count) {
    if (count == 1 && !*names[0]) return;
    printf("%*s", LABEL_WIDTH, "");
    for (int i = 0; i < count; i++) printf(" %*s", NUMBER_WIDTH, names[i]);
    putchar('\n');
}

static void print_place(zt_subject_place place) {
    if (place.line > 0) printf("  %s:%d:%d", place.file, place.line, place.column);
}

static void print_moment(const zt_film *film, double time_s) {
    double frame = time_s * film->rate.num / film->rate.den;
    if (fabs(frame - rint(frame)) < 1e-9 * fmax(1, fabs(frame))) frame = rint(frame);
    printf("frame %.*f, %.6g s", frame == rint(frame) ? 0 : 2, frame, time_s);
}

/* The numbers of a value, their unit, and what they mean. */
static void print_numbers(const char *label, const zt_subject *subject, const double *value) {
    zt_subject_words words = zt_subject_in_words(subject, value);
    print_row(label, value, subject->channel_count);
    if (*subject->unit) printf(" %s", subject->unit);
    if (*words.text) printf("  = %s", words.text);
}

static void print_value(const zt_subject *subject, const zt_explanation *e) {
    print_channels(subject->channels, subject->channel_count);
    print_numbers("value", subject, e->value);
    putchar('\n');
    if (e->cut)
        printf("%-*s it is rendered as if it were within %g and %g\n", LABEL_WIDTH, "",
               subject->least, subject->most);
}

static void print_velocity(const zt_subject *subject, const zt_explanation *e) {
    bool own = e->velocity_channels != subject->channels;
    if (own) print_channels(e->velocity_channels, e->velocity_count);
    print_row("velocity", e->velocity, e->velocity_count);
    printf(" %s%sa second%s\n", own ? "deg" : subject->unit, own || *subject->unit ? " " : "",
           e->velocity_exact ? "" : ", by a difference");
}

static void print_key(const zt_subject *subject, int index) {
    char label[24];
    zt_subject_key key = zt_subject_key_at(subject, index);
    snprintf(label, sizeof label, "key %d", index + 1);
    print_numbers(label, subject, key.value);
    fputs("  at ", stdout);
    print_moment(zt_animation_film(subject->film), key.time_s);
    print_place(key.place);
    putchar('\n');
}

static void print_way(const zt_subject *subject, const zt_explanation *e) {
    zt_subject_key key = {.ease = ""};
    if (e->key_before >= 0) key = zt_subject_key_at(subject, e->key_before);
    printf("%-*s ", LABEL_WIDTH, "way");
    if (key.way && e->key_after >= 0) {
        printf("%s", key.way);
        if (*key.ease) printf(", spread by %s", key.ease);
        printf(": u = %.6g of its time", e->u);
        if (e->s != e->u) printf(", s = %.6g of its curve", e->s);
    } else if (key.way)
        printf("%s, %.6g s after the last key", key.way, e->beyond_s);
    else
        printf("none: the moment is %s the keys", e->key_before < 0 ? "before" : "at or after");
    putchar('\n');
    if (!e->end) return;
    printf("%-*s %.6g s %s: %s", LABEL_WIDTH, "beyond", fabs(e->beyond_s),
           e->beyond_s < 0 ? "before the first key" : "after the last key", e->end);
    if (e->round != 0) printf(", round %.0f", e->round);
    putchar('\n');
}

static void print(const zt_subject *subject, const zt_explanation *e) {
    printf("%s at ", subject->name);
    print_moment(zt_animation_film(subject->film), e->time_s);
    printf(": %s\n", subject->meaning);
    printf("%-*s %s", LABEL_WIDTH, "driven by", subject->driver);
    if (subject->key_count > 0)
        printf(", %d key%s", subject->key_count, subject->key_count == 1 ? "" : "s");
    print_place(zt_subject_stands_at(subject));
    putchar('\n');
    print_value(subject, e);
    print_velocity(subject, e);
    if (subject->key_count == 0) return;
    if (e->key_before >= 0) print_key(subject, e->key_before);
    if (e->key_after >= 0) print_key(subject, e->key_after);
    print_way(subject, e);
}

zt_status zt_explain(const zt_animation *animation, const char *question, zt_report *report) {
    zt_listener listener = zt_report_listener(report);
    const char *at = strrchr(question, '@');
    if (!at || at == question || !at[1]) {
        zt_report_say(
            report, ZT_ERROR,
            "%s: ask for a property at a frame or a time, such as lamp.position@37 or "
            "lamp.position@1.5s",
            question);
        return ZT_EARGUMENT;
    }
    char *name = strndup(question, (size_t)(at - question));
    if (!name) return ZT_EMEMORY;
    zt_subject subject;
    zt_explanation explanation;
    double time_s;
    zt_status status = zt_subject_find(&subject, animation, name, listener);
    if (status == ZT_OK) status = zt_subject_time(&time_s, animation, at + 1, listener);
    if (status == ZT_OK) status = zt_subject_explain(&explanation, &subject, time_s, listener);
    if (status == ZT_OK) print(&subject, &explanation);
    free(name);
    return status;
}

static void print_frames(int64_t first, int64_t last, const zt_frame_choices *choices) {
    int indent = first == last ? printf("frame %" PRId64 ": ", first)
                               : printf("frames %" PRId64 " to %" PRId64 ": ", first, last);
    puts(choices->precision_text);
    if (*choices->motion_text) printf("%*s%s\n", indent, "", choices->motion_text);
}

/* ---- what frames need -----------------------------------------------------------------------
 */

static void print_sentence(void *user, const char *sentence) {
    printf("%*s%s\n", *(const int *)user, "", sentence);
}

/* Runs of frames that show the same: of each the first alone is rendered. */
static zt_status print_held(zt_renderer *renderer, int64_t first, int64_t last) {
    zt_hash held;
    zt_status status = zt_renderer_key(&held, renderer, first);
    int64_t since = first;
    for (int64_t frame = first + 1; frame <= last + 1 && status == ZT_OK; frame++) {
        zt_hash key = {0};
        if (frame <= last) status = zt_renderer_key(&key, renderer, frame);
        if (status != ZT_OK) break;
        if (frame <= last && zt_hash_equal(key, held)) continue;
        if (frame - since > 1)
            printf("frames %" PRId64 " to %" PRId64 " hold still: rendered once\n", since,
                   frame - 1);
        since = frame;
        held = key;
    }
    return status;
}

zt_status zt_explain_frames(const zt_animation *animation, int64_t first, int64_t last,
                            zt_report *report) {
    zt_render_settings settings = {0};
    zt_renderer *renderer;
    zt_frame_choices told, next;
    const int64_t from = first;
    zt_status status =
        zt_renderer_open(&renderer, animation, &settings, zt_report_listener(report));
    if (status == ZT_OK) status = zt_renderer_choices(&told, renderer, first);
    for (int64_t frame = first + 1; frame <= last && status == ZT_OK; frame++) {
        status = zt_renderer_choices(&next, renderer, frame);
        if (status != ZT_OK || next.cause == told.cause) continue;
        print_frames(first, frame - 1, &told);
        first = frame;
        told = next;
    }
    if (status == ZT_OK) {
        print_frames(first, last, &told);
        int indent = printf("frame %" PRId64 " needs\n", from) > 0 ? 4 : 0;
        status = zt_renderer_needs(renderer, from, print_sentence, &indent);
    }
    if (status == ZT_OK) status = print_held(renderer, from, last);
    zt_renderer_close(&renderer);
    return status;
}
