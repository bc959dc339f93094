#include "keyframe/functions.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/random.h"
#include "base/vec.h"

static const double pi = 3.14159265358979323846;

/* What is no number goes through all of these, so that the caller hears of it. */
static double sign(double x) { return x > 0 ? 1 : x < 0 ? -1 : x; }
static double fract(double x) { return x - floor(x); }
static double deg(double x) { return x * (180 / pi); }
static double rad(double x) { return x * (pi / 180); }
static double least(double a, double b) { return a < b || isnan(a) ? a : b; }
static double most(double a, double b) { return a > b || isnan(a) ? a : b; }
static double clamp(double x, double low, double high) {
    return x < low ? low : x > high ? high : x;
}
static double mix(double a, double b, double u) { return a * (1 - u) + b * u; }
static double step(double edge, double x) { return x < edge ? 0 : x >= edge ? 1 : NAN; }

static double smoothstep(double a, double b, double x) {
    if (a == b) return step(a, x);
    double u = clamp((x - a) / (b - a), 0, 1);
    return u * u * (3 - 2 * u);
}

static double remap(double x, double a, double b, double c, double d) {
    return mix(c, d, (x - a) / (b - a));
}

static double mod(double x, double y) {
    double m = fmod(x, y);
    return m != 0 && (m < 0) != (y < 0) ? m + y : m;
}

/* As Lua has them for numbers. */
static double add(double a, double b) { return a + b; }
static double subtract(double a, double b) { return a - b; }
static double multiply(double a, double b) { return a * b; }
static double divide(double a, double b) { return a / b; }
static double divide_whole(double a, double b) { return floor(a / b); }
static double power(double a, double b) { return b == 2 ? a * a : pow(a, b); }
static double negate(double a) { return -a; }

/* A function of a fixed number of arguments, as an expression calls it. */
#define CALL(name, ...)                                                                        \
    static double call_##name(const double *a, int count) {                                    \
        (void)count;                                                                           \
        return name(__VA_ARGS__);                                                              \
    }
CALL(sin, a[0])
CALL(cos, a[0])
CALL(tan, a[0])
CALL(asin, a[0])
CALL(acos, a[0])
CALL(atan, a[0])
CALL(atan2, a[0], a[1])
CALL(sqrt, a[0])
CALL(exp, a[0])
CALL(log, a[0])
CALL(fabs, a[0])
CALL(sign, a[0])
CALL(floor, a[0])
CALL(ceil, a[0])
CALL(round, a[0])
CALL(fract, a[0])
CALL(deg, a[0])
CALL(rad, a[0])
CALL(clamp, a[0], a[1], a[2])
CALL(mix, a[0], a[1], a[2])
CALL(step, a[0], a[1])
CALL(smoothstep, a[0], a[1], a[2])
CALL(remap, a[0], a[1], a[2], a[3], a[4])
CALL(mod, a[0], a[1])
CALL(add, a[0], a[1])
CALL(subtract, a[0], a[1])
CALL(multiply, a[0], a[1])
CALL(divide, a[0], a[1])
CALL(divide_whole, a[0], a[1])
CALL(power, a[0], a[1])
CALL(negate, a[0])

static double call_min(const double *a, int count) {
    double found = a[0];
    for (int i = 1; i < count; i++) found = least(found, a[i]);
    return found;
}

static double call_max(const double *a, int count) {
    double found = a[0];
    for (int i = 1; i < count; i++) found = most(found, a[i]);
    return found;
}

/* A further number goes into the key by its bits; zero has one sign only. */
static uint64_t key_of(uint64_t key, double number) {
    uint64_t bits;
    number += 0.0;
    memcpy(&bits, &number, sizeof bits);
    return zt_random_key(key, bits);
}

static double unit_of(uint64_t key) { return (double)(key >> 11) * 0x1p-53; }

static double call_random(const double *a, int count) {
    uint64_t key = 0;
    for (int i = 0; i < count; i++) key = key_of(key, a[i]);
    return unit_of(key);
}

/* The polynomial is Perlin's ("Improving Noise", 2002). */
static double call_noise(const double *a, int count) {
    uint64_t seed = key_of(0, count > 1 ? a[1] : 0);
    double cell = floor(a[0]), u = a[0] - cell;
    double before = 2 * unit_of(key_of(seed, cell)) - 1;
    double after = 2 * unit_of(key_of(seed, cell + 1)) - 1;
    return mix(before, after, u * u * u * (u * (u * 6 - 15) + 10));
}

__attribute__((format(printf, 2, 3))) static bool wrong(zt_call *call, const char *format,
                                                        ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(call->wrong, sizeof call->wrong, format, arguments);
    va_end(arguments);
    return false;
}

static bool whole_vec(zt_call *call) {
    call->width = 0;
    for (int i = 0; i < call->count; i++) {
        const zt_operand *part = &call->operands[i];
        int width = part->width ? part->width : 1;
        if (call->width + width > ZT_CHANNELS_MAX)
            return wrong(call, "a vector has %d numbers at most", ZT_CHANNELS_MAX);
        memcpy(call->result + call->width, part->numbers, (size_t)width * sizeof(double));
        call->width += width;
    }
    return call->width >= 2 || wrong(call, "a vector has 2 numbers at least");
}

/* For the functions below: vectors alone, and of one width. */
static bool are_vectors(zt_call *call, const char *name) {
    int width = call->operands[0].width;
    for (int i = 0; i < call->count; i++) {
        int other = call->operands[i].width;
        if (!other) return wrong(call, "%s takes vectors, not numbers", name);
        if (other != width)
            return wrong(call, "%s of vectors of %d and %d numbers", name, width, other);
    }
    return true;
}

static bool whole_dot(zt_call *call) {
    if (!are_vectors(call, "dot")) return false;
    const zt_operand *a = &call->operands[0], *b = &call->operands[1];
    call->width = 0;
    call->result[0] = 0;
    for (int c = 0; c < a->width; c++) call->result[0] += a->numbers[c] * b->numbers[c];
    return true;
}

static bool whole_cross(zt_call *call) {
    const double *a = call->operands[0].numbers, *b = call->operands[1].numbers;
    if (!are_vectors(call, "cross")) return false;
    if (call->operands[0].width != 3) return wrong(call, "cross takes vectors of 3 numbers");
    vec3 product = vec3_cross((vec3){a[0], a[1], a[2]}, (vec3){b[0], b[1], b[2]});
    memcpy(call->result, &product, sizeof product);
    call->width = 3;
    return true;
}

/* The largest magnitude among the channels, and the length as a multiple of it: neither
 * overflows nor vanishes on the way. */
static double relative_length(const zt_operand *v, double *largest) {
    double sum = 0;
    *largest = 0;
    for (int c = 0; c < v->width; c++) *largest = most(*largest, fabs(v->numbers[c]));
    for (int c = 0; c < v->width && *largest != 0; c++) {
        double u = v->numbers[c] / *largest;
        sum += u * u;
    }
    return sqrt(sum);
}

static bool whole_length(zt_call *call) {
    if (!are_vectors(call, "length")) return false;
    double largest, relative = relative_length(&call->operands[0], &largest);
    call->result[0] = relative * largest;
    call->width = 0;
    return true;
}

static bool whole_normalize(zt_call *call) {
    if (!are_vectors(call, "normalize")) return false;
    const zt_operand *v = &call->operands[0];
    double largest, relative = relative_length(v, &largest);
    for (int c = 0; c < v->width; c++)
        call->result[c] = largest != 0 ? v->numbers[c] / largest / relative : 0;
    call->width = v->width;
    return true;
}

static bool call_each(const zt_function *f, zt_call *call) {
    double a[ZT_OPERANDS_MAX];
    call->width = 0;
    for (int i = 0; i < call->count; i++) {
        int width = call->operands[i].width;
        if (width && call->width && width != call->width)
            return wrong(call, "vectors of %d and %d numbers do not go together", call->width,
                         width);
        if (width) call->width = width;
    }
    for (int c = 0; c == 0 || c < call->width; c++) {
        for (int i = 0; i < call->count; i++)
            a[i] = call->operands[i].numbers[call->operands[i].width ? c : 0];
        call->result[c] = f->each(a, call->count);
    }
    return true;
}

bool zt_function_call(const zt_function *f, zt_call *call) {
    if (call->count < f->least || call->count > f->most)
        return f->least == f->most
                   ? wrong(call, "wrong number of values for %s: %d instead of %d", f->name,
                           call->count, f->least)
                   : wrong(call, "wrong number of values for %s: %d instead of %d to %d",
                           f->name, call->count, f->least, f->most);
    return f->whole ? f->whole(call) : call_each(f, call);
}

enum { ANY = ZT_OPERANDS_MAX };

const zt_function zt_functions[] = {
    {"sin", 1, 1, call_sin, NULL},
    {"cos", 1, 1, call_cos, NULL},
    {"tan", 1, 1, call_tan, NULL},
    {"asin", 1, 1, call_asin, NULL},
    {"acos", 1, 1, call_acos, NULL},
    {"atan", 1, 1, call_atan, NULL},
    {"atan2", 2, 2, call_atan2, NULL},
    {"sqrt", 1, 1, call_sqrt, NULL},
    {"exp", 1, 1, call_exp, NULL},
    {"log", 1, 1, call_log, NULL},
    {"abs", 1, 1, call_fabs, NULL},
    {"sign", 1, 1, call_sign, NULL},
    {"floor", 1, 1, call_floor, NULL},
    {"ceil", 1, 1, call_ceil, NULL},
    {"round", 1, 1, call_round, NULL},
    {"fract", 1, 1, call_fract, NULL},
    {"deg", 1, 1, call_deg, NULL},
    {"rad", 1, 1, call_rad, NULL},
    {"min", 2, ANY, call_min, NULL},
    {"max", 2, ANY, call_max, NULL},
    {"clamp", 3, 3, call_clamp, NULL},
    {"mix", 3, 3, call_mix, NULL},
    {"step", 2, 2, call_step, NULL},
    {"smoothstep", 3, 3, call_smoothstep, NULL},
    {"remap", 5, 5, call_remap, NULL},
    {"mod", 2, 2, call_mod, NULL},
    {"noise", 1, 2, call_noise, NULL},
    {"random", 1, ANY, call_random, NULL},
    {"vec", 1, ANY, NULL, whole_vec},
    {"dot", 2, 2, NULL, whole_dot},
    {"cross", 2, 2, NULL, whole_cross},
    {"length", 1, 1, NULL, whole_length},
    {"normalize", 1, 1, NULL, whole_normalize},
};
const int zt_function_count = sizeof zt_functions / sizeof zt_functions[0];

const zt_function zt_operators[] = {
    {"__add", 2, 2, call_add, NULL},           {"__sub", 2, 2, call_subtract, NULL},
    {"__mul", 2, 2, call_multiply, NULL},      {"__div", 2, 2, call_divide, NULL},
    {"__idiv", 2, 2, call_divide_whole, NULL}, {"__mod", 2, 2, call_mod, NULL},
    {"__pow", 2, 2, call_power, NULL},         {"__unm", 2, 2, call_negate, NULL},
};
const int zt_operator_count = sizeof zt_operators / sizeof zt_operators[0];
