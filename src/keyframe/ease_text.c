/* Easings as text. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "base/text.h"
#include "keyframe/ease.h"

enum { WAYS = 3, ARGUMENTS_MAX = 4 };

#define WAYS_OF(family) family "-in", family "-out", family "-in-out"

static const char *const families[] = {
    WAYS_OF("sine"), WAYS_OF("quad"), WAYS_OF("cubic"), WAYS_OF("quart"),   WAYS_OF("quint"),
    WAYS_OF("expo"), WAYS_OF("circ"), WAYS_OF("back"),  WAYS_OF("elastic"), WAYS_OF("bounce")};

static const struct {
    const char *word;
    zt_ease ease;
} named[] = {
    {"ease", {ZT_EASE_BEZIER, .x1 = 0.25, .y1 = 0.1, .x2 = 0.25, .y2 = 1}},
    {"ease-in", {ZT_EASE_BEZIER, .x1 = 0.42, .y1 = 0, .x2 = 1, .y2 = 1}},
    {"ease-out", {ZT_EASE_BEZIER, .x1 = 0, .y1 = 0, .x2 = 0.58, .y2 = 1}},
    {"ease-in-out", {ZT_EASE_BEZIER, .x1 = 0.42, .y1 = 0, .x2 = 0.58, .y2 = 1}},
    {"step-start", {ZT_EASE_STEPS, .step_count = 1, .jump = ZT_EASE_JUMP_START}},
    {"step-end", {ZT_EASE_STEPS, .step_count = 1, .jump = ZT_EASE_JUMP_END}},
};

static const char *const functions[] = {"cubic-bezier", "steps", "linear"};

#define COUNT(array) (int)(sizeof(array) / sizeof *(array))

const char *zt_ease_word(int index) {
    if (index < COUNT(named)) return named[index].word;
    index -= COUNT(named);
    if (index < COUNT(functions)) return functions[index];
    index -= COUNT(functions);
    return index < COUNT(families) ? families[index] : NULL;
}

/* A piece of text. */
typedef struct span {
    const char *begin, *end;
} span;

static span trim(span s) {
    while (s.begin < s.end && strchr(" \t\r\n", *s.begin)) s.begin++;
    while (s.begin < s.end && strchr(" \t\r\n", s.end[-1])) s.end--;
    return s;
}

static bool is(span s, const char *word) {
    size_t length = strlen(word);
    return (size_t)(s.end - s.begin) == length && memcmp(s.begin, word, length) == 0;
}

/* Takes what is before the next separator out of `rest`; false when nothing is left. */
static bool next(span *piece, span *rest, const char *separators) {
    if (!rest->begin) return false;
    const char *p = rest->begin;
    while (p < rest->end && !strchr(separators, *p)) p++;
    *piece = trim((span){rest->begin, p});
    rest->begin = p < rest->end ? p + 1 : NULL;
    return true;
}

static bool number(double *value, span s) { return zt_text_number(value, s.begin, s.end); }

/* All of the arguments as numbers; -1 where one is none or there are too many. */
static int numbers(double values[ARGUMENTS_MAX], span arguments) {
    int count = 0;
    for (span piece; next(&piece, &arguments, ",");)
        if (count == ARGUMENTS_MAX || !number(&values[count++], piece)) return -1;
    return count;
}

static const char *parse_bezier(zt_ease *ease, span arguments) {
    double v[ARGUMENTS_MAX];
    if (numbers(v, arguments) != 4) return "cubic-bezier takes four numbers: x1, y1, x2, y2";
    if (!(v[0] >= 0 && v[0] <= 1 && v[2] >= 0 && v[2] <= 1))
        return "the times x1 and x2 of cubic-bezier must be from 0 to 1";
    *ease = (zt_ease){ZT_EASE_BEZIER, .x1 = v[0], .y1 = v[1], .x2 = v[2], .y2 = v[3]};
    return NULL;
}

static const char *parse_steps(zt_ease *ease, span arguments) {
    static const struct {
        const char *word;
        zt_ease_jump jump;
    } jumps[] = {{"jump-end", ZT_EASE_JUMP_END},     {"end", ZT_EASE_JUMP_END},
                 {"jump-start", ZT_EASE_JUMP_START}, {"start", ZT_EASE_JUMP_START},
                 {"jump-none", ZT_EASE_JUMP_NONE},   {"jump-both", ZT_EASE_JUMP_BOTH}};
    span piece;
    double count;
    next(&piece, &arguments, ",");
    if (!number(&count, piece) || count != floor(count) || !(count >= 1 && count <= 1e6))
        return "steps takes a whole number of steps from 1 to 1000000";
    int i = 0;
    if (next(&piece, &arguments, ","))
        while (i < COUNT(jumps) && !is(piece, jumps[i].word)) i++;
    if (i == COUNT(jumps) || next(&piece, &arguments, ","))
        return "after the number, steps takes jump-start, jump-end, jump-none or jump-both";
    if (jumps[i].jump == ZT_EASE_JUMP_NONE && count < 2)
        return "with jump-none, at least 2 steps are needed";
    *ease = (zt_ease){ZT_EASE_STEPS, .step_count = (int32_t)count, .jump = jumps[i].jump};
    return NULL;
}

/* One stop: a number and up to two percentages in any order. Returns how many times it has, -1
 * where it is none. */
static int parse_stop(double *way, double times[2], span text) {
    int time_count = 0;
    bool has_way = false;
    for (span piece; next(&piece, &text, " \t\r\n");) {
        if (piece.begin == piece.end) continue;
        if (piece.end[-1] != '%') {
            if (has_way || !number(way, piece)) return -1;
            has_way = true;
            continue;
        }
        piece.end--;
        if (time_count == 2 || !number(&times[time_count], piece)) return -1;
        times[time_count++] /= 100;
    }
    return has_way ? time_count : -1;
}

/* Fills in the times that were not given, which are NAN: 0 and 1 at the ends, evenly in
 * between. No time is before one that is given earlier. */
static void spread(zt_ease_stop *stops, int32_t count) {
    if (isnan(stops[0].time)) stops[0].time = 0;
    if (isnan(stops[count - 1].time)) stops[count - 1].time = fmax(1, stops[0].time);
    int32_t known = 0;
    double largest = stops[0].time;
    for (int32_t i = 1; i < count; i++) {
        if (isnan(stops[i].time)) continue;
        stops[i].time = largest = fmax(stops[i].time, largest);
        double begin = stops[known].time, step = (largest - begin) / (i - known);
        for (int32_t k = known + 1; k < i; k++) stops[k].time = begin + step * (k - known);
        known = i;
    }
}

static const char *parse_stops(zt_ease *ease, zt_arena *arena, span arguments) {
    size_t most = 2;
    for (const char *p = arguments.begin; p < arguments.end; p++) most += *p == ',' ? 2 : 0;
    zt_ease_stop *stops = ZT_PUSH(arena, zt_ease_stop, most);
    if (!stops) return "out of memory";
    int32_t count = 0;
    for (span piece; next(&piece, &arguments, ",");) {
        double way, times[2];
        int time_count = parse_stop(&way, times, piece);
        if (time_count < 0) return "each stop of linear is a number, and up to two percentages";
        stops[count++] = (zt_ease_stop){time_count > 0 ? times[0] : NAN, way};
        if (time_count == 2) stops[count++] = (zt_ease_stop){times[1], way};
    }
    spread(stops, count);
    *ease = (zt_ease){ZT_EASE_STOPS, .stop_count = count, .stops = stops};
    return NULL;
}

static const char *parse_family(zt_ease *ease, int index, span arguments) {
    double v[ARGUMENTS_MAX];
    int count = arguments.begin ? numbers(v, arguments) : 0;
    *ease = (zt_ease){(zt_ease_kind)(ZT_EASE_SINE + index / WAYS),
                      .way = (zt_ease_way)(index % WAYS), .overshoot = 1.70158, .amplitude = 1,
                      .period = 0.3};
    if (count == 0) return NULL;
    if (ease->kind == ZT_EASE_BACK) {
        if (count != 1) return "back takes one number, how far it overshoots";
        ease->overshoot = v[0];
        return NULL;
    }
    if (ease->kind != ZT_EASE_ELASTIC) return "this easing takes no numbers";
    if (count != 2 || !(v[0] >= 1) || !(v[1] > 0))
        return "elastic takes an amplitude of at least 1 and a period above 0";
    ease->amplitude = v[0];
    ease->period = v[1];
    return NULL;
}

const char *zt_ease_parse(zt_ease *ease, zt_arena *arena, const char *text) {
    span word = trim((span){text, text + strlen(text)}), arguments = {NULL, NULL};
    const char *open = memchr(word.begin, '(', (size_t)(word.end - word.begin));
    if (open) {
        if (word.end[-1] != ')') return "a closing bracket is missing";
        arguments = trim((span){open + 1, word.end - 1});
        word = trim((span){word.begin, open});
        if (is(word, "cubic-bezier")) return parse_bezier(ease, arguments);
        if (is(word, "steps")) return parse_steps(ease, arguments);
        if (is(word, "linear")) return parse_stops(ease, arena, arguments);
    }
    for (int i = 0; i < COUNT(families); i++)
        if (is(word, families[i])) return parse_family(ease, i, arguments);
    for (int i = 0; !open && i < COUNT(named); i++)
        if (is(word, named[i].word)) {
            *ease = named[i].ease;
            return NULL;
        }
    return "there is no such easing";
}
