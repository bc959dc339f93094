/* Shows that animations made elsewhere play back as they were recorded: glTF's samplers by the
 * formulas of its specification, a filmed camera and a captured walk at each of their keys. The
 * files are not the project's own; where they are absent, these tests are skipped. */
#include <ctype.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/xform.h"
#include "keyframe/rotation.h"
#include "keys.h"
#include "real.h"

/* All of a file with a zero after it, or NULL; of the caller to free. */
static char *read_all(const char *name) {
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", ZT_TEST_DATA_DIR, name);
    FILE *file = fopen(path, "rb");
    if (!file) return NULL;
    fseek(file, 0, SEEK_END);
    long size = ftell(file);
    rewind(file);
    char *bytes = calloc(1, (size_t)size + 1);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, (size_t)size, file), size);
    fclose(file);
    return bytes;
}

/* ---- as much of JSON as glTF needs here ----------------------------------------------------
 */

static const char *blanks(const char *p) {
    while (*p && (isspace((unsigned char)*p) || *p == ',' || *p == ':')) p++;
    return p;
}

static const char *past_text(const char *p) {
    for (p++; *p != '"'; p++)
        if (*p == '\\') p++;
    return p + 1;
}

static const char *past_value(const char *p) {
    p = blanks(p);
    if (*p == '"') return past_text(p);
    if (*p != '{' && *p != '[') return p + strcspn(p, ",]} \n\r\t");
    for (p = blanks(p + 1); *p != '}' && *p != ']'; p = blanks(p)) p = past_value(p);
    return p + 1;
}

/* The value below `json` by a path of names and indices, or NULL: "accessors 3 count". */
static const char *find(const char *json, const char *path) {
    for (; json && *path; path += strspn(path, " ")) {
        size_t length = strcspn(path, " ");
        int index = *blanks(json) == '[' ? atoi(path) : -1;
        const char *p = blanks(blanks(json) + 1), *found = NULL;
        while (!found && *p != '}' && *p != ']') {
            if (index < 0) {
                const char *name = p + 1, *value = blanks(past_text(p));
                if (strncmp(name, path, length) == 0 && name[length] == '"') found = value;
                p = blanks(past_value(value));
            } else {
                if (index-- == 0) found = p;
                p = blanks(past_value(p));
            }
        }
        json = found;
        path += length;
    }
    return json ? blanks(json) : NULL;
}

__attribute__((format(printf, 2, 3))) static const char *findf(const char *json,
                                                               const char *format, ...) {
    char path[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(path, sizeof path, format, arguments);
    va_end(arguments);
    return find(json, path);
}

static int int_at(const char *value, int otherwise) { return value ? atoi(value) : otherwise; }

/* ---- glTF ----------------------------------------------------------------------------------
 */

typedef struct sampler {
    int key_count, width;
    zt_curve_kind kind;
    float *times, *values; /* CUBICSPLINE: in-tangent, value, out-tangent of each key */
} sampler;

/* The floats of an accessor, of the caller to free. */
static float *read_floats(const char *json, const char *folder, int accessor, int count) {
    int view = int_at(findf(json, "accessors %d bufferView", accessor), -1);
    int offset = int_at(findf(json, "accessors %d byteOffset", accessor), 0) +
                 int_at(findf(json, "bufferViews %d byteOffset", view), 0);
    int buffer = int_at(findf(json, "bufferViews %d buffer", view), -1);
    assert_int_equal(int_at(findf(json, "accessors %d componentType", accessor), 0), 5126);
    const char *uri = findf(json, "buffers %d uri", buffer) + 1;
    char name[512];
    snprintf(name, sizeof name, "%s/%.*s", folder, (int)strcspn(uri, "\""), uri);
    char *bytes = read_all(name);
    assert_non_null(bytes);
    float *floats = calloc((size_t)count, sizeof *floats);
    assert_non_null(floats);
    memcpy(floats, bytes + offset, (size_t)count * sizeof *floats);
    free(bytes);
    return floats;
}

static sampler read_sampler(const char *json, const char *folder, int animation, int index) {
    const char *own = findf(json, "animations %d samplers %d", animation, index);
    const char *kind = find(own, "interpolation");
    int input = int_at(find(own, "input"), -1), output = int_at(find(own, "output"), -1);
    const char *type = findf(json, "accessors %d type", output);
    sampler s = {.key_count = int_at(findf(json, "accessors %d count", input), 0),
                 .width = type[4] - '0',
                 .kind = !kind || kind[1] == 'L' ? ZT_CURVE_LINEAR
                         : kind[1] == 'S'        ? ZT_CURVE_HOLD
                                                 : ZT_CURVE_HERMITE};
    int per_key = s.kind == ZT_CURVE_HERMITE ? 3 : 1;
    s.times = read_floats(json, folder, input, s.key_count);
    s.values = read_floats(json, folder, output, s.key_count * per_key * s.width);
    return s;
}

/* Quaternions are x, y, z, w in glTF. */
static int channel(const sampler *s, int c) { return s->width == 4 ? (c + 3) % 4 : c; }

/* A key's value. Quaternions are made unit ones, which the specification asks of files, and
 * which files of floats are not quite. */
static void gltf_value(real *value, const sampler *s, int k) {
    bool cubic = s->kind == ZT_CURVE_HERMITE;
    const float *p = s->values + (cubic ? 3 * k + 1 : k) * s->width;
    real length = 0;
    for (int c = 0; c < s->width; c++) length += (real)p[c] * p[c];
    for (int c = 0; c < s->width; c++)
        value[c] = s->width == 4 ? p[c] / REAL(sqrt)(length) : p[c];
}

/* The specification's appendix C, in higher precision. */
static void gltf_reference(real *value, const sampler *s, double t) {
    int k = 0, w = s->width;
    while (k + 2 < s->key_count && (double)s->times[k + 1] <= t) k++;
    real td = (real)s->times[k + 1] - s->times[k], u = ((real)t - s->times[k]) / td;
    real a[4], b[4], length = 0, u2 = u * u, u3 = u2 * u, dot = 0;
    gltf_value(a, s, k);
    gltf_value(b, s, k + 1);
    if (s->kind == ZT_CURVE_HERMITE) {
        const float *out = s->values + (3 * k + 2) * w, *in = out + w;
        for (int c = 0; c < w; c++)
            value[c] = (2 * u3 - 3 * u2 + 1) * a[c] + td * (u3 - 2 * u2 + u) * out[c] +
                       (3 * u2 - 2 * u3) * b[c] + td * (u3 - u2) * in[c];
        for (int c = 0; c < w; c++) length += value[c] * value[c];
        for (int c = 0; w == 4 && c < w; c++) value[c] /= REAL(sqrt)(length);
        return;
    }
    for (int c = 0; c < w; c++) dot += a[c] * b[c];
    if (s->kind == ZT_CURVE_HOLD || (w == 4 && REAL(fabs)(dot) >= 1)) {
        for (int c = 0; c < w; c++) value[c] = a[c];
    } else if (w != 4) {
        for (int c = 0; c < w; c++) value[c] = (1 - u) * a[c] + u * b[c];
    } else {
        real angle = REAL(acos)(REAL(fabs)(dot)), sign = dot < 0 ? -1 : 1;
        for (int c = 0; c < w; c++)
            value[c] = REAL(sin)(angle * (1 - u)) / REAL(sin)(angle) * a[c] +
                       sign * REAL(sin)(angle * u) / REAL(sin)(angle) * b[c];
    }
}

/* Builds a curve from a sampler; its numbers lie in `numbers`. */
static zt_curve curve_of_sampler(zt_arena *arena, const sampler *s) {
    int per_key = s->kind == ZT_CURVE_HERMITE ? 3 : 1;
    double *numbers = ZT_PUSH(arena, double, (size_t)(s->key_count * per_key * s->width));
    zt_key *keys = ZT_PUSH(arena, zt_key, (size_t)s->key_count);
    assert_non_null(numbers);
    assert_non_null(keys);
    for (int k = 0; k < s->key_count; k++) {
        double *own = numbers + k * per_key * s->width;
        for (int c = 0; c < per_key * s->width; c++) {
            int from = c / s->width * s->width + channel(s, c % s->width);
            own[c] = (double)s->values[k * per_key * s->width + from];
        }
        keys[k] = key((double)s->times[k], own, s->kind);
        if (s->kind != ZT_CURVE_HERMITE) continue;
        keys[k].before = own;
        keys[k].value = own + s->width;
        keys[k].after = own + 2 * s->width;
    }
    return curve_of(arena, &(zt_curve_spec){.value_kind = s->width == 4 ? ZT_VALUE_ROTATION
                                                                        : ZT_VALUE_VECTOR,
                                            .key_count = s->key_count,
                                            .keys = keys});
}

/* The largest difference to the specification over the sampler's time, but for signs. */
static double worst_difference(const sampler *s) {
    zt_arena arena = {0};
    zt_curve curve = curve_of_sampler(&arena, s);
    double worst = 0, first = (double)s->times[0], last = (double)s->times[s->key_count - 1];
    for (int i = 0; i < 1000; i++) {
        double t = first + (last - first) * i / 1000, value[4], dot = 0;
        real expected[4];
        zt_curve_eval(value, &curve, t);
        gltf_reference(expected, s, t);
        for (int c = 0; c < s->width; c++) dot += (double)expected[channel(s, c)] * value[c];
        double sign = s->width == 4 && dot < 0 ? -1 : 1;
        for (int c = 0; c < s->width; c++)
            worst = fmax(worst, fabs((double)(expected[channel(s, c)] - sign * value[c])));
    }
    zt_arena_free(&arena);
    return worst;
}

static void check_gltf(const char *folder, const char *file, int sampler_count) {
    char name[512];
    snprintf(name, sizeof name, "%s/%s", folder, file);
    char *json = read_all(name);
    if (!json) skip();
    int count = 0;
    double worst = 0;
    for (int animation = 0; findf(json, "animations %d", animation); animation++)
        for (int i = 0; findf(json, "animations %d samplers %d", animation, i); i++) {
            sampler s = read_sampler(json, folder, animation, i);
            worst = fmax(worst, worst_difference(&s));
            free(s.times);
            free(s.values);
            count++;
        }
    free(json);
    printf("  %s: %d samplers, worst difference %.2g\n", file, count, worst);
    assert_int_equal(count, sampler_count);
    assert_true(worst < 1e-12);
}

static void gltf_interpolation_test(void **state) {
    (void)state;
    check_gltf("gltf/khronos/InterpolationTest/glTF", "InterpolationTest.gltf", 9);
}
static void gltf_animated_cube(void **state) {
    (void)state;
    check_gltf("gltf/khronos/AnimatedCube/glTF", "AnimatedCube.gltf", 1);
}
static void gltf_animated_triangle(void **state) {
    (void)state;
    check_gltf("gltf/khronos/AnimatedTriangle/glTF", "AnimatedTriangle.gltf", 1);
}
static void gltf_box_animated(void **state) {
    (void)state;
    check_gltf("gltf/khronos/BoxAnimated/glTF", "BoxAnimated.gltf", 2);
}

/* ---- dense keys ----------------------------------------------------------------------------
 */

/* Rotations and positions over time, as they grow out of a file. */
typedef struct recording {
    int count;
    double *times;
    quat *rotations;
    vec3 *positions;
} recording;

static recording make_recording(int count) {
    recording r = {count, calloc((size_t)count, sizeof(double)),
                   calloc((size_t)count, sizeof(quat)), calloc((size_t)count, sizeof(vec3))};
    assert_non_null(r.times);
    assert_non_null(r.rotations);
    assert_non_null(r.positions);
    return r;
}

static void free_recording(recording *r) {
    free(r->times);
    free(r->rotations);
    free(r->positions);
}

/* Plays a recording as curves of a kind; the largest error at its keys. */
static double worst_at_keys(const recording *r, zt_curve_kind kind) {
    zt_arena arena = {0};
    zt_key *keys = ZT_PUSH(&arena, zt_key, (size_t)r->count);
    assert_non_null(keys);
    double worst = 0;
    for (int k = 0; k < r->count; k++)
        keys[k] = key(r->times[k], (const double *)&r->positions[k], kind);
    zt_curve_spec spec = {.value_kind = ZT_VALUE_VECTOR, .key_count = r->count, .keys = keys};
    zt_curve curve = curve_of(&arena, &spec);
    for (int k = 0; k < r->count; k++)
        worst =
            fmax(worst, vec3_length(vec3_sub(eval_vec(&curve, r->times[k]), r->positions[k])));
    for (int k = 0; k < r->count; k++) keys[k].value = (const double *)&r->rotations[k];
    spec.value_kind = ZT_VALUE_ROTATION;
    curve = curve_of(&arena, &spec);
    for (int k = 0; k < r->count; k++) {
        quat q = eval_quat(&curve, r->times[k]);
        worst = fmax(worst, zt_rotation_angle(q, zt_rotation_unit(r->rotations[k])));
        /* Just before the key, too: the way arrives there. A wall clock has no time that near.
         */
        if (r->times[0] < 1e9) q = eval_quat(&curve, nextafter(r->times[k], -INFINITY));
        worst = fmax(worst, zt_rotation_angle(q, zt_rotation_unit(r->rotations[k])));
    }
    zt_arena_free(&arena);
    return worst;
}

static void check_recording(const recording *r, const char *what) {
    double worst = 0;
    const zt_curve_kind kinds[] = {ZT_CURVE_LINEAR, ZT_CURVE_SMOOTH, ZT_CURVE_CATMULL_ROM};
    for (int i = 0; i < 3; i++) worst = fmax(worst, worst_at_keys(r, kinds[i]));
    printf("  %s: %d keys, worst error at a key %.2g\n", what, r->count, worst);
    assert_true(worst < 1e-9);
}

/* Twenty thousand poses of a camera that was carried round a desk. */
static void camera_track(void **state) {
    (void)state;
    char *text = read_all("curves/camera-track/tum_fr2_desk_groundtruth.txt");
    if (!text) skip();
    recording r = make_recording(30000);
    int count = 0;
    for (char *line = strtok(text, "\n"); line && count < r.count; line = strtok(NULL, "\n")) {
        double v[8];
        if (sscanf(line, "%lf %lf %lf %lf %lf %lf %lf %lf", v, v + 1, v + 2, v + 3, v + 4,
                   v + 5, v + 6, v + 7) != 8)
            continue;
        if (count && !(v[0] > r.times[count - 1])) continue;
        r.times[count] = v[0];
        r.positions[count] = (vec3){v[1], v[2], v[3]};
        r.rotations[count++] = (quat){v[7], v[4], v[5], v[6]};
    }
    r.count = count;
    assert_true(count > 2000);
    check_recording(&r, "camera track");
    for (int k = count; k-- > 0;) r.times[k] -= r.times[0];
    check_recording(&r, "camera track from 0 s");
    free_recording(&r);
    free(text);
}

/* Where a rotation by z, then x, then y axes of a joint's own takes a vector: as matrices that
 * BVH multiplies from the left. */
static vec3 turned_by_matrices(const char *order, const double angles[3], vec3 v) {
    for (int i = 2; i >= 0; i--) {
        double c = cos(angles[i]), s = sin(angles[i]);
        if (order[i] == 'X') v = (vec3){v.x, c * v.y - s * v.z, s * v.y + c * v.z};
        if (order[i] == 'Y') v = (vec3){c * v.x + s * v.z, v.y, c * v.z - s * v.x};
        if (order[i] == 'Z') v = (vec3){c * v.x - s * v.y, s * v.x + c * v.y, v.z};
    }
    return v;
}

/* Each joint of a captured walk; its angles become rotations as BVH means them. */
static void check_bvh(const char *name, const char *order, const char *fixed_order) {
    char *text = read_all(name);
    if (!text) skip();
    int channels = 0, frames = 0;
    for (const char *p = text; (p = strstr(p, "CHANNELS")); p++) channels += atoi(p + 8);
    const char *p = strstr(text, "Frames:");
    frames = atoi(p + 7);
    double *numbers = calloc((size_t)frames * (size_t)channels, sizeof *numbers);
    assert_non_null(numbers);
    double frame_s = strtod(strstr(text, "Frame Time:") + 11, (char **)&p);
    for (int i = 0; i < frames * channels; i++) numbers[i] = strtod(p, (char **)&p);
    double worst_matrix = 0, worst = 0;
    recording r = make_recording(frames);
    for (int joint = 0; joint < channels / 3 - 1; joint++) {
        for (int f = 0; f < frames; f++) {
            const double *own = numbers + f * channels;
            double angles[3];
            vec3 by_axis = {0};
            for (int i = 0; i < 3; i++) {
                angles[i] = own[3 + 3 * joint + i] * (3.14159265358979323846 / 180);
                (&by_axis.x)[order[i] - 'X'] = angles[i];
            }
            r.times[f] = f * frame_s;
            r.positions[f] = (vec3){own[0], own[1], own[2]};
            r.rotations[f] = zt_rotation_euler(by_axis, fixed_order);
            vec3 v = {0.3, -0.5, 0.8}, by_matrix = turned_by_matrices(order, angles, v);
            xform m = xform_place((vec3){0, 0, 0}, r.rotations[f], (vec3){1, 1, 1});
            worst_matrix =
                fmax(worst_matrix, vec3_length(vec3_sub(xform_vector(&m, v), by_matrix)));
        }
        worst = fmax(worst, worst_at_keys(&r, ZT_CURVE_LINEAR));
        worst = fmax(worst, worst_at_keys(&r, ZT_CURVE_SMOOTH));
    }
    printf("  %s: %d joints, %d keys each, worst error at a key %.2g, of Euler angles %.2g\n",
           name, channels / 3 - 1, frames, worst, worst_matrix);
    assert_true(worst < 1e-9);
    assert_true(worst_matrix < 1e-14);
    free_recording(&r);
    free(numbers);
    free(text);
}

static void captured_walk(void **state) {
    (void)state;
    check_bvh("curves/bvh/01_01.bvh", "ZYX", "xyz");
}
static void captured_other_order(void **state) {
    (void)state;
    check_bvh("curves/bvh/test_mocapbank.bvh", "ZXY", "yxz");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gltf_interpolation_test),
        cmocka_unit_test(gltf_animated_cube),
        cmocka_unit_test(gltf_animated_triangle),
        cmocka_unit_test(gltf_box_animated),
        cmocka_unit_test(camera_track),
        cmocka_unit_test(captured_walk),
        cmocka_unit_test(captured_other_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
