/* Shows that each kind of way between two keys is the curve that its inventors describe. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "keyframe/rotation.h"
#include "keys.h"
#include "real.h"

static const double pi = 3.14159265358979323846;

enum { COUNT = 6 };

/* Keys with values of up to four channels and tangents, drawn. */
typedef struct drawn {
    double times[COUNT], values[COUNT][4], before[COUNT][4], after[COUNT][4];
    zt_key keys[COUNT];
} drawn;

static void draw_keys(drawn *k, draw *d, zt_curve_kind kind) {
    draw_times(d, k->times, COUNT, 0.1, 10);
    for (int i = 0; i < COUNT; i++) {
        for (int c = 0; c < 4; c++) {
            k->values[i][c] = draw_between(d, -1, 1);
            k->before[i][c] = draw_between(d, -1, 1);
            k->after[i][c] = draw_between(d, -1, 1);
        }
        k->keys[i] = (zt_key){.time_s = k->times[i],
                              .value = k->values[i],
                              .kind = kind,
                              .before = k->before[i],
                              .after = k->after[i]};
    }
}

static int way_at(const double *times, double t) {
    int i = 0;
    while (i + 2 < COUNT && times[i + 1] <= t) i++;
    return i;
}

/* The formula of the glTF 2.0 specification, appendix C.5, "Cubic Spline Interpolation". */
static real gltf_cubic(const drawn *k, int i, int c, double time) {
    real td = (real)k->times[i + 1] - k->times[i], t = ((real)time - k->times[i]) / td;
    real t2 = t * t, t3 = t2 * t;
    return (2 * t3 - 3 * t2 + 1) * k->values[i][c] + td * (t3 - 2 * t2 + t) * k->after[i][c] +
           (-2 * t3 + 3 * t2) * k->values[i + 1][c] + td * (t3 - t2) * k->before[i + 1][c];
}

/* Hermite ways are glTF's: channels by themselves, quaternions made unit again, whatever signs
 * the keys have. */
static void hermite(void **state) {
    (void)state;
    draw d = {1, 0};
    zt_arena arena = {0};
    double worst = 0;
    for (int round = 0; round < 3000; round++) {
        zt_arena_reset(&arena);
        drawn k;
        draw_keys(&k, &d, ZT_CURVE_HERMITE);
        bool turns = round % 2;
        for (int i = 0; turns && i < COUNT; i++) {
            quat q = draw_rotation(&d);
            memcpy(k.values[i], &q, sizeof q);
        }
        zt_value_kind kind = turns ? ZT_VALUE_ROTATION : ZT_VALUE_VECTOR;
        zt_curve curve = curve_of(
            &arena, &(zt_curve_spec){.value_kind = kind, .key_count = COUNT, .keys = k.keys});
        for (int j = 0; j < 10; j++) {
            double t = draw_between(&d, k.times[0], k.times[COUNT - 1]), value[4];
            int i = way_at(k.times, t), width = turns ? 4 : 3;
            real expected[4], length = 0;
            for (int c = 0; c < width; c++) expected[c] = gltf_cubic(&k, i, c, t);
            for (int c = 0; c < width; c++) length += expected[c] * expected[c];
            length = turns ? REAL(sqrt)(length) : 1;
            if (length < (real)0.01) continue; /* through zero, where there is no rotation */
            zt_curve_eval(value, &curve, t);
            for (int c = 0; c < width; c++)
                worst = fmax(worst, fabs((double)(expected[c] / length - value[c])));
        }
    }
    printf("  hermite: worst error %.2g\n", worst);
    assert_true(worst < 2e-13);
    zt_arena_free(&arena);
}

/* Barry and Goldman's pyramid, "A recursive evaluation algorithm for a class of Catmull-Rom
 * splines", 1988, with centripetal knots. */
static void catmull_rom_reference(real p[3], const double (*points)[4], int i, real u) {
    real knots[4] = {0}, q[4][3];
    for (int k = 0; k < 4; k++) {
        real length = 0;
        for (int c = 0; c < 3; c++) {
            q[k][c] = points[i - 1 + k][c];
            if (k) length += (q[k][c] - q[k - 1][c]) * (q[k][c] - q[k - 1][c]);
        }
        if (k) knots[k] = knots[k - 1] + REAL(sqrt)(REAL(sqrt)(length));
    }
    real t = knots[1] + u * (knots[2] - knots[1]);
    for (int level = 1; level <= 3; level++)
        for (int k = 0; k + level < 4; k++) {
            /* The last level blends over the middle way only. */
            real low = knots[level == 3 ? 1 : k], high = knots[level == 3 ? 2 : k + level];
            for (int c = 0; c < 3; c++)
                q[k][c] = ((high - t) * q[k][c] + (t - low) * q[k + 1][c]) / (high - low);
        }
    for (int c = 0; c < 3; c++) p[c] = q[0][c];
}

/* Catmull-Rom ways between inner keys are the centripetal ones, at even speed of the parameter.
 */
static void catmull_rom(void **state) {
    (void)state;
    draw d = {2, 0};
    zt_arena arena = {0};
    double worst = 0;
    for (int round = 0; round < 3000; round++) {
        zt_arena_reset(&arena);
        drawn k;
        draw_keys(&k, &d, ZT_CURVE_CATMULL_ROM);
        zt_curve curve = curve_of(&arena, &(zt_curve_spec){.value_kind = ZT_VALUE_VECTOR,
                                                           .key_count = COUNT,
                                                           .keys = k.keys});
        for (int j = 0; j < 10; j++) {
            double t = draw_between(&d, k.times[1], k.times[COUNT - 2]), value[3];
            int i = way_at(k.times, t);
            real u = ((real)t - k.times[i]) / ((real)k.times[i + 1] - k.times[i]), expected[3];
            catmull_rom_reference(expected, (const double(*)[4])k.values, i, u);
            zt_curve_eval(value, &curve, t);
            for (int c = 0; c < 3; c++)
                worst = fmax(worst, fabs((double)(expected[c] - value[c])));
        }
    }
    printf("  catmull-rom: worst error %.2g\n", worst);
    assert_true(worst < 1e-13);
    /* Two keys are a straight line, and keys at one place a rest, without a step. */
    const double line[2][3] = {{0, 0, 0}, {1, 2, 3}};
    const zt_key two[] = {key(0, line[0], ZT_CURVE_CATMULL_ROM),
                          key(1, line[1], ZT_CURVE_HOLD)};
    zt_curve curve = curve_of(
        &arena, &(zt_curve_spec){.value_kind = ZT_VALUE_VECTOR, .key_count = 2, .keys = two});
    assert_near(eval_vec(&curve, 0.3).z, 0.9, 1e-15);
    const zt_key same[] = {
        key(0, line[0], ZT_CURVE_CATMULL_ROM), key(1, line[0], ZT_CURVE_CATMULL_ROM),
        key(2, line[1], ZT_CURVE_CATMULL_ROM), key(3, line[1], ZT_CURVE_HOLD)};
    curve = curve_of(
        &arena, &(zt_curve_spec){.value_kind = ZT_VALUE_VECTOR, .key_count = 4, .keys = same});
    assert_true(eval_vec(&curve, 0.5).x == 0 && eval_vec(&curve, 2.5).z == 3);
    assert_near(eval_vec(&curve, 1.5).y, 1, 1e-15);
    zt_arena_free(&arena);
}

/* Kochanek and Bartels' tangents, as sums over the four points of a way. */
static void tcb(void **state) {
    (void)state;
    draw d = {3, 0};
    zt_arena arena = {0};
    double worst = 0;
    for (int round = 0; round < 3000; round++) {
        zt_arena_reset(&arena);
        drawn k;
        draw_keys(&k, &d, ZT_CURVE_TCB);
        for (int i = 0; i < COUNT; i++) {
            k.times[i] = k.keys[i].time_s = i; /* the paper's even steps */
            k.keys[i].tension = draw_between(&d, -1, 1);
            k.keys[i].continuity = draw_between(&d, -1, 1);
            k.keys[i].bias = draw_between(&d, -1, 1);
        }
        zt_curve curve = curve_of(&arena, &(zt_curve_spec){.value_kind = ZT_VALUE_NUMBER,
                                                           .key_count = COUNT,
                                                           .keys = k.keys});
        for (int i = 1; i + 2 < COUNT; i++) {
            const zt_key *a = &k.keys[i], *b = a + 1;
            real p0 = a[-1].value[0], p1 = a->value[0], p2 = b->value[0], p3 = b[1].value[0];
            real at = a->tension, ac = a->continuity, ab = a->bias;
            real bt = b->tension, bc = b->continuity, bb = b->bias;
            real leave = (1 - at) * (1 + ac) * (1 + ab) / 2 * (p1 - p0) +
                         (1 - at) * (1 - ac) * (1 - ab) / 2 * (p2 - p1);
            real arrive = (1 - bt) * (1 - bc) * (1 + bb) / 2 * (p2 - p1) +
                          (1 - bt) * (1 + bc) * (1 - bb) / 2 * (p3 - p2);
            real u = draw_unit(&d), v = 1 - u;
            real expected = (1 + 2 * u) * v * v * p1 + u * v * v * leave +
                            u * u * (3 - 2 * u) * p2 - u * u * v * arrive;
            worst = fmax(worst, fabs((double)(expected - eval1(&curve, i + (double)u))));
        }
    }
    printf("  tcb: worst error %.2g\n", worst);
    assert_true(worst < 1e-14);
    zt_arena_free(&arena);
}

/* A point of a curve of handles: where its time is, found by halving; then its value. */
static real handles_reference(const real t[4], const real v[4], real time) {
    real low = 0, high = 1;
    for (int i = 0; i < 110; i++) {
        real s = (low + high) / 2, r = 1 - s;
        real at =
            r * r * r * t[0] + 3 * r * r * s * t[1] + 3 * r * s * s * t[2] + s * s * s * t[3];
        if (at < time)
            low = s;
        else
            high = s;
    }
    real s = (low + high) / 2, r = 1 - s;
    return r * r * r * v[0] + 3 * r * r * s * v[1] + 3 * r * s * s * v[2] + s * s * s * v[3];
}

/* Handles in time and value, as F-curves have them; too long ones reach to the other key. */
static void bezier(void **state) {
    (void)state;
    draw d = {4, 0};
    zt_arena arena = {0};
    double worst = 0;
    for (int round = 0; round < 2000; round++) {
        zt_arena_reset(&arena);
        drawn k;
        draw_keys(&k, &d, ZT_CURVE_BEZIER);
        for (int i = 0; i < COUNT; i++) {
            k.keys[i].before_s = draw_magnitude(&d, 1e-3, 20);
            k.keys[i].after_s = draw_magnitude(&d, 1e-3, 20);
        }
        zt_curve curve = curve_of(&arena, &(zt_curve_spec){.value_kind = ZT_VALUE_NUMBER,
                                                           .key_count = COUNT,
                                                           .keys = k.keys});
        for (int i = 0; i + 1 < COUNT; i++) {
            const zt_key *a = &k.keys[i], *b = a + 1;
            real h = (real)b->time_s - a->time_s;
            real f = a->after_s > h ? h / a->after_s : 1,
                 g = b->before_s > h ? h / b->before_s : 1;
            real t[] = {a->time_s, a->time_s + f * a->after_s, b->time_s - g * b->before_s,
                        b->time_s};
            real v[] = {a->value[0], a->value[0] + f * a->after[0],
                        b->value[0] + g * b->before[0], b->value[0]};
            double time = a->time_s + draw_unit(&d) * (b->time_s - a->time_s);
            real expected = handles_reference(t, v, time);
            /* Where time nearly stands still, the handles' own rounding decides. */
            double error = fabs((double)(expected - eval1(&curve, time)));
            double slope =
                fabs((double)(handles_reference(t, v, time + (real)1e-15) - expected));
            worst = fmax(worst, error / (1 + slope / 1e-15));
        }
    }
    printf("  bezier: worst error %.2g\n", worst);
    assert_true(worst < 2e-14);
    zt_arena_free(&arena);
}

/* Without handles, Bezier ways are smooth ones. */
static void bezier_without_handles(void **state) {
    (void)state;
    draw d = {5, 0};
    zt_arena arena = {0};
    for (int turns = 0; turns < 2; turns++) {
        drawn k;
        draw_keys(&k, &d, ZT_CURVE_SMOOTH);
        zt_curve_spec spec = {.value_kind = turns ? ZT_VALUE_ROTATION : ZT_VALUE_COLOR,
                              .key_count = COUNT,
                              .keys = k.keys};
        for (int i = 0; i < COUNT; i++) k.keys[i].before = k.keys[i].after = NULL;
        zt_curve smooth = curve_of(&arena, &spec);
        for (int i = 0; i < COUNT; i++) k.keys[i].kind = ZT_CURVE_BEZIER;
        zt_curve other = curve_of(&arena, &spec);
        for (int j = 0; j < 1000; j++) {
            double t = draw_between(&d, k.times[0], k.times[COUNT - 1]), a[4], b[4];
            zt_curve_eval(a, &smooth, t);
            zt_curve_eval(b, &other, t);
            for (int c = 0; c < 3 + turns; c++) assert_near(a[c], b[c], 1e-14);
        }
    }
    zt_arena_free(&arena);
}

/* A rotation's handles are turns: four that make a quarter circle at even speed, and one that
 * holds the begin still. */
static void bezier_of_rotations(void **state) {
    (void)state;
    zt_arena arena = {0};
    const double from[] = {1, 0, 0, 0}, to[] = {cos(pi / 4), 0, sin(pi / 4), 0};
    const double third[] = {0, pi / 6, 0}, back[] = {0, -pi / 6, 0}, none[] = {0, 0, 0};
    zt_key keys[] = {{.value = from, .kind = ZT_CURVE_BEZIER, .after = third, .after_s = 1},
                     {.time_s = 3, .value = to, .before = back, .before_s = 1}};
    zt_curve_spec spec = {.value_kind = ZT_VALUE_ROTATION, .key_count = 2, .keys = keys};
    zt_curve curve = curve_of(&arena, &spec);
    for (double t = 0; t <= 3; t += 0.125)
        assert_near(2 * atan2(eval_quat(&curve, t).y, eval_quat(&curve, t).w), t * pi / 6,
                    1e-15);
    keys[0].after = none;
    curve = curve_of(&arena, &spec);
    assert_true(vec3_length(turning(&curve, 0, 1e-6)) < 1e-6);
    assert_near(vec3_length(turning(&curve, 3 - 1e-6, 3)), pi / 6, 1e-6);
    zt_arena_free(&arena);
}

/* Eases spread a way over its time, whatever its kind; what they overshoot, the value
 * overshoots. */
static void eases(void **state) {
    (void)state;
    zt_arena arena = {0};
    zt_ease back, steps;
    assert_null(zt_ease_parse(&back, &arena, "back-in-out"));
    assert_null(zt_ease_parse(&steps, &arena, "steps(4)"));
    const double values[][3] = {{0, 5, -1}, {2, 5, -2}, {4, 5, 8}};
    zt_key keys[] = {key(0, values[0], ZT_CURVE_LINEAR), key(2, values[1], ZT_CURVE_LINEAR),
                     key(3, values[2], ZT_CURVE_LINEAR)};
    keys[0].ease = &back;
    keys[1].ease = &steps;
    zt_curve_spec spec = {.value_kind = ZT_VALUE_VECTOR, .key_count = 3, .keys = keys};
    zt_curve curve = curve_of(&arena, &spec);
    for (double t = 0.125; t < 2; t += 0.125) {
        vec3 v = eval_vec(&curve, t);
        double way = zt_ease_eval(&back, t / 2);
        assert_near(v.x, 2 * way, 1e-15);
        assert_near(v.z, -1 - way, 1e-15);
        assert_true(v.y == 5);
    }
    assert_true(eval_vec(&curve, 0.5).x < 0 && eval_vec(&curve, 1.5).x > 2);
    assert_true(eval_vec(&curve, 2.3).z == 0.5 && eval_vec(&curve, 2.9).z == 5.5);
    /* A curved way goes on past its end on its own polynomial. */
    for (int i = 0; i < 3; i++) keys[i].kind = ZT_CURVE_CATMULL_ROM;
    zt_curve eased = curve_of(&arena, &spec);
    for (int i = 0; i < 3; i++) keys[i].ease = NULL;
    zt_curve plain = curve_of(&arena, &spec);
    double way = zt_ease_eval(&back, 0.4);
    assert_near(eval_vec(&eased, 0.8).x, eval_vec(&plain, 2 * way).x, 1e-14);
    /* Rotations turn past their end, too. */
    const double from[] = {1, 0, 0, 0}, to[] = {cos(0.5), sin(0.5), 0, 0};
    zt_key turn[] = {key(0, from, ZT_CURVE_LINEAR), key(1, to, ZT_CURVE_HOLD)};
    turn[0].ease = &back;
    zt_curve turning_curve = curve_of(
        &arena,
        &(zt_curve_spec){.value_kind = ZT_VALUE_ROTATION, .key_count = 2, .keys = turn});
    for (double t = 0.1; t < 1; t += 0.1) {
        quat q = eval_quat(&turning_curve, t);
        assert_near(2 * atan2(q.x, q.w), zt_ease_eval(&back, t), 1e-15);
    }
    assert_string_equal(zt_curve_label(&turning_curve), "eased");
    assert_string_equal(zt_curve_label(&curve), "mixed");
    assert_string_equal(zt_curve_label(&plain), "catmull-rom");
    zt_arena_free(&arena);
}

/* Every key says how it goes on: a held way between two others, which end and begin at rest. */
static void mixed(void **state) {
    (void)state;
    zt_arena arena = {0};
    const double v[] = {0, 1, 3, 2};
    const zt_key keys[] = {key(0, &v[0], ZT_CURVE_SMOOTH), key(1, &v[1], ZT_CURVE_HOLD),
                           key(2, &v[2], ZT_CURVE_LINEAR), key(3, &v[3], ZT_CURVE_SMOOTH)};
    zt_curve curve = curve_of(
        &arena, &(zt_curve_spec){.value_kind = ZT_VALUE_ANGLE, .key_count = 4, .keys = keys});
    assert_near(eval1(&curve, 0.25), 0.25 * 0.25 * 2.5, 1e-15);
    assert_true(eval1(&curve, 1.5) == 1 && eval1(&curve, 1.999) == 1);
    assert_true(eval1(&curve, 2.5) == 2.5 && eval1(&curve, 9) == 2);
    zt_arena_free(&arena);
}

/* ---- spaces --------------------------------------------------------------------------------
 */

/* As turns, two rounds are two rounds, and 300 degrees are not taken for -60. */
static void turns(void **state) {
    (void)state;
    zt_arena arena = {0};
    const double none[] = {0, 0, 0}, rounds[] = {0, 4 * pi, 0}, most[] = {0, 300 * pi / 180, 0};
    zt_key keys[] = {key(0, none, ZT_CURVE_LINEAR), key(4, rounds, ZT_CURVE_HOLD)};
    zt_curve_spec spec = {
        .value_kind = ZT_VALUE_ROTATION, .space = ZT_SPACE_TURNS, .key_count = 2, .keys = keys};
    zt_curve curve = curve_of(&arena, &spec);
    for (double t = 0; t <= 4; t += 0.25)
        assert_true(zt_rotation_angle(eval_quat(&curve, t),
                                      quat_axis_angle((vec3){0, 1, 0}, t * pi)) < 1e-14);
    keys[1].value = most;
    curve = curve_of(&arena, &spec);
    assert_true(zt_rotation_angle(eval_quat(&curve, 2),
                                  quat_axis_angle((vec3){0, 1, 0}, 150 * pi / 180)) < 1e-14);
    zt_arena_free(&arena);
}

/* Ottosson's example code in higher precision, with its inverse by Cramer's rule. */
static void solve(real x[3], const double m[3][3], const real b[3]) {
    real columns[4][3];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) columns[j][i] = m[i][j];
        columns[3][i] = b[i];
    }
    real determinants[4];
    for (int without = 0; without < 4; without++) {
        const real *c[3];
        for (int j = 0; j < 3; j++) c[j] = columns[j == without ? 3 : j];
        determinants[without] = c[0][0] * (c[1][1] * c[2][2] - c[1][2] * c[2][1]) -
                                c[1][0] * (c[0][1] * c[2][2] - c[0][2] * c[2][1]) +
                                c[2][0] * (c[0][1] * c[1][2] - c[0][2] * c[1][1]);
    }
    for (int j = 0; j < 3; j++) x[j] = determinants[j] / determinants[3];
}

static void oklab_mix(real light[3], const double a[3], const double b[3], real u) {
    static const double m1[3][3] = {{0.4122214708, 0.5363325363, 0.0514459929},
                                    {0.2119034982, 0.6806995451, 0.1073969566},
                                    {0.0883024619, 0.2817188376, 0.6299787005}};
    static const double m2[3][3] = {{0.2104542553, 0.7936177850, -0.0040720468},
                                    {1.9779984951, -2.4285922050, 0.4505937099},
                                    {0.0259040371, 0.7827717662, -0.8086757660}};
    real lab[3] = {0}, cones[3];
    for (int end = 0; end < 2; end++) {
        const double *c = end ? b : a;
        for (int i = 0; i < 3; i++)
            cones[i] = REAL(cbrt)((real)m1[i][0] * c[0] + (real)m1[i][1] * c[1] +
                                  (real)m1[i][2] * c[2]);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) lab[i] += (end ? u : 1 - u) * m2[i][j] * cones[j];
    }
    solve(cones, m2, lab);
    for (int i = 0; i < 3; i++) cones[i] = cones[i] * cones[i] * cones[i];
    solve(light, m1, cones);
}

/* Colours by way of Oklab, exact at their keys. */
static void oklab(void **state) {
    (void)state;
    draw d = {6, 0};
    zt_arena arena = {0};
    double worst = 0;
    for (int round = 0; round < 2000; round++) {
        zt_arena_reset(&arena);
        double colors[2][3], value[3];
        for (int i = 0; i < 6; i++) colors[i / 3][i % 3] = draw_between(&d, 0, 2);
        const zt_key keys[] = {key(0, colors[0], ZT_CURVE_LINEAR),
                               key(1, colors[1], ZT_CURVE_HOLD)};
        zt_curve curve = curve_of(&arena, &(zt_curve_spec){.value_kind = ZT_VALUE_COLOR,
                                                           .space = ZT_SPACE_OKLAB,
                                                           .key_count = 2,
                                                           .keys = keys});
        double u = draw_unit(&d);
        real expected[3];
        oklab_mix(expected, colors[0], colors[1], u);
        zt_curve_eval(value, &curve, u);
        for (int c = 0; c < 3; c++) worst = fmax(worst, fabs((double)(expected[c] - value[c])));
        zt_curve_eval(value, &curve, 1);
        assert_memory_equal(value, colors[1], sizeof value);
    }
    printf("  oklab: worst error %.2g\n", worst);
    assert_true(worst < 5e-14);
    zt_arena_free(&arena);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hermite),
        cmocka_unit_test(catmull_rom),
        cmocka_unit_test(tcb),
        cmocka_unit_test(bezier),
        cmocka_unit_test(bezier_without_handles),
        cmocka_unit_test(bezier_of_rotations),
        cmocka_unit_test(eases),
        cmocka_unit_test(mixed),
        cmocka_unit_test(turns),
        cmocka_unit_test(oklab),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
