/* Shows that rotations take the short way at constant speed, that smooth ones have no corner
 * and no flip, and that both are as exact as doubles can be. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "keyframe/rotation.h"
#include "keys.h"
#include "real.h"

static const double pi = 3.14159265358979323846;

static real4 exact(quat q) { return (real4){q.w, q.x, q.y, q.z}; }

/* How far a quaternion's length is from 1, in units in the last place of 1. */
static double length_error_ulp(quat q) {
    real4 e = exact(q);
    return (double)REAL(fabs)(REAL(sqrt)(real4_dot(e, e)) - 1) / 0x1p-52;
}

/* The rotation angle that takes a to b, at most pi, without loss for small ones. */
static double turn(quat a, quat b) {
    quat q = quat_mul(quat_conjugate(a), b);
    return 2 * atan2(vec3_length((vec3){q.x, q.y, q.z}), fabs(q.w));
}

/* The quaternion at `angle` from q on the sphere, in a direction drawn. */
static quat at_distance(draw *d, quat q, double angle) {
    quat other = draw_rotation(d);
    quat side = quat_add(other, quat_scale(q, -quat_dot(q, other)));
    return quat_normalize(
        quat_add(quat_scale(q, cos(angle)), quat_scale(quat_normalize(side), sin(angle))));
}

/* Slerp against a reference of higher precision, for separations from 1e-12 to pi - 1e-9. */
static void slerp_is_exact(void **state) {
    (void)state;
    if (!REAL_IS_QUAD) skip();
    draw d = {1, 0};
    double worst_angle = 0, worst_length = 0;
    for (int round = 0; round < 20000; round++) {
        quat a = draw_rotation(&d);
        double separation = draw_magnitude(&d, 1e-12, pi / 2);
        if (round % 2) separation = pi - draw_magnitude(&d, 1e-9, pi / 2);
        quat b = at_distance(&d, a, separation);
        double u = round % 7 ? draw_unit(&d) : draw_magnitude(&d, 1e-16, 1);
        quat q = zt_rotation_slerp(a, b, u);
        real4 expected = real4_slerp(real4_unit(exact(a)), real4_unit(exact(b)), u);
        double angle = (double)real4_angle(real4_unit(exact(q)), expected);
        worst_angle = fmax(worst_angle, angle);
        worst_length = fmax(worst_length, length_error_ulp(q));
    }
    printf("  slerp: worst angle error %.2g, worst length error %.2g ulp\n", worst_angle,
           worst_length);
    assert_true(worst_angle <= 1e-12);
    assert_true(worst_length <= 4);
}

/* ---- the arcs of smooth rotations ----------------------------------------------------------
 */

static real4 real4_mul(real4 a, real4 b) {
    return (real4){a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
                   a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
                   a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
                   a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

/* The unit quaternion of a half turn that is the vector part of v. */
static real4 real4_exp(real4 v) {
    real angle = REAL(sqrt)(real4_dot(v, v));
    real4 q = real4_scale(v, angle > 0 ? REAL(sin)(angle) / angle : 1);
    q.w = REAL(cos)(angle);
    return q;
}

static real4 real4_log(real4 q) {
    real4 v = {0, q.x, q.y, q.z};
    real sine = REAL(sqrt)(real4_dot(v, v));
    return sine > 0 ? real4_scale(v, REAL(atan2)(sine, q.w) / sine) : v;
}

/* The cubic Bezier curve of Kim, Kim and Shin from a to b. */
static real4 arc_reference(real4 a, real4 b, vec3 leave, vec3 arrive, real u) {
    real4 first = {0, (real)leave.x / 3, (real)leave.y / 3, (real)leave.z / 3};
    real4 last = {0, (real)arrive.x / 3, (real)arrive.y / 3, (real)arrive.z / 3};
    real4 whole = real4_mul((real4){a.w, -a.x, -a.y, -a.z}, b);
    real4 middle = real4_log(real4_mul(real4_mul(real4_exp(real4_scale(first, -1)), whole),
                                       real4_exp(real4_scale(last, -1))));
    real v = 1 - u;
    real4 q = real4_mul(a, real4_exp(real4_scale(first, 1 - v * v * v)));
    q = real4_mul(q, real4_exp(real4_scale(middle, 3 * u * u - 2 * u * u * u)));
    return real4_mul(q, real4_exp(real4_scale(last, u * u * u)));
}

/* Arcs against a reference of higher precision, for turns from 1e-12 to pi - 1e-9 that begin
 * and end at up to twice their mean speed, askew. */
static void arcs_are_exact(void **state) {
    (void)state;
    if (!REAL_IS_QUAD) skip();
    draw d = {9, 0};
    double worst_angle = 0, worst_length = 0;
    for (int round = 0; round < 20000; round++) {
        quat a = draw_rotation(&d), drawn = draw_rotation(&d);
        double separation = draw_magnitude(&d, 1e-12, pi / 2);
        if (round % 2) separation = pi - draw_magnitude(&d, 1e-9, pi / 2);
        vec3 step =
            vec3_scale(vec3_normalize((vec3){drawn.x, drawn.y, drawn.z}), separation / 2);
        quat b = quat_mul(a, zt_rotation_exp(step));
        vec3 speeds[2];
        for (int i = 0; i < 2; i++) {
            drawn = draw_rotation(&d);
            vec3 askew = vec3_scale((vec3){drawn.x, drawn.y, drawn.z}, separation / 8);
            speeds[i] = vec3_add(vec3_scale(step, draw_between(&d, 0, 1.75)), askew);
        }
        double u = round % 7 ? draw_unit(&d) : draw_magnitude(&d, 1e-16, 1);
        zt_rotation_arc arc = zt_rotation_arc_make(a, b, speeds[0], speeds[1]);
        quat q = zt_rotation_arc_eval(&arc, a, u);
        real4 expected =
            arc_reference(real4_unit(exact(a)), real4_unit(exact(b)), speeds[0], speeds[1], u);
        double angle = (double)real4_angle(real4_unit(exact(q)), expected);
        worst_angle = fmax(worst_angle, angle);
        worst_length = fmax(worst_length, length_error_ulp(q));
    }
    printf("  arcs: worst angle error %.2g, worst length error %.2g ulp\n", worst_angle,
           worst_length);
    assert_true(worst_angle <= 1e-12);
    assert_true(worst_length <= 4);
}

/* ---- as they are written -------------------------------------------------------------------
 */

static void assert_vec(vec3 found, vec3 expected, double tolerance) {
    if (vec3_length(vec3_sub(found, expected)) <= tolerance) return;
    fail_msg("(%.17g, %.17g, %.17g) is not (%.17g, %.17g, %.17g)", found.x, found.y, found.z,
             expected.x, expected.y, expected.z);
}

static vec3 turned(quat q, vec3 v) {
    xform m = xform_place((vec3){0, 0, 0}, q, (vec3){1, 1, 1});
    return xform_vector(&m, v);
}

/* Euler angles in all six orders, against turning a vector around one axis after the other. */
static void euler_orders(void **state) {
    (void)state;
    static const char *const orders[] = {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"};
    draw d = {6, 0};
    for (int i = 0; i < 6; i++) {
        assert_true(zt_rotation_order_is_sound(orders[i]));
        for (int round = 0; round < 100; round++) {
            vec3 angles = {draw_between(&d, -9, 9), draw_between(&d, -9, 9),
                           draw_between(&d, -9, 9)};
            vec3 v = {0.3, -0.5, 0.8}, expected = v;
            for (int k = 0; k < 3; k++) {
                double angle = (&angles.x)[orders[i][k] - 'x'], c = cos(angle), s = sin(angle);
                double *e = &expected.x, *p = &e[(orders[i][k] - 'x' + 1) % 3],
                       *q = &e[(orders[i][k] - 'x' + 2) % 3];
                double turned_p = c * *p - s * *q;
                *q = s * *p + c * *q;
                *p = turned_p;
            }
            assert_vec(turned(zt_rotation_euler(angles, orders[i]), v), expected, 1e-14);
        }
    }
    static const char *const wrong[] = {"", "xy", "xyzx", "xxy", "XYZ", "xyw", "zxz"};
    for (int i = 0; i < 7; i++) assert_false(zt_rotation_order_is_sound(wrong[i]));
}

/* Looking: -z points there, y is up, x is level; as a camera that is aimed looks, roll apart.
 */
static void looking(void **state) {
    (void)state;
    draw d = {7, 0};
    for (int round = 0; round < 2000; round++) {
        zt_camera camera = {.aimed = true};
        double *numbers[] = {&camera.look_at.x, &camera.look_at.y, &camera.look_at.z,
                             &camera.up.x,      &camera.up.y,      &camera.up.z};
        for (int i = 0; i < 6; i++) *numbers[i] = draw_between(&d, -1, 1);
        if (round % 10 == 0) camera.up = vec3_scale(camera.look_at, draw_between(&d, -2, 2));
        if (round % 100 == 1) camera.look_at = (vec3){0, 0, -1};
        xform expected = zt_camera_xform(&camera);
        quat q = zt_rotation_look(camera.look_at, camera.up, 0);
        assert_true(length_error_ulp(q) <= 4);
        assert_vec(turned(q, (vec3){1, 0, 0}), expected.x, 1e-14);
        assert_vec(turned(q, (vec3){0, 1, 0}), expected.y, 1e-14);
        assert_vec(turned(q, (vec3){0, 0, 1}), expected.z, 1e-14);
        double roll = draw_between(&d, -9, 9);
        q = zt_rotation_look(camera.look_at, camera.up, roll);
        assert_vec(turned(q, (vec3){0, 0, 1}), expected.z, 1e-14);
        assert_vec(
            turned(q, (vec3){1, 0, 0}),
            vec3_add(vec3_scale(expected.x, cos(roll)), vec3_scale(expected.y, sin(roll))),
            1e-14);
    }
    assert_vec(turned(zt_rotation_look((vec3){0}, (vec3){0, 1, 0}, pi / 2), (vec3){1, 0, 0}),
               (vec3){0, 1, 0}, 1e-15);
}

/* The angle between two rotations, told as exactly for 1e-150 as for nearly half a turn. */
static void angles_between(void **state) {
    (void)state;
    for (double angle = 1e-150; angle < 3; angle *= 1.7) {
        quat q = zt_rotation_of_turn((vec3){0, angle, 0});
        assert_true(fabs(zt_rotation_angle(quat_identity(), q) / angle - 1) < 1e-15);
        assert_true(fabs(zt_rotation_angle(quat_scale(q, -1), quat_identity()) / angle - 1) <
                    1e-15);
    }
    quat half = zt_rotation_of_turn((vec3){pi - 1e-9, 0, 0});
    assert_true(fabs(zt_rotation_angle(quat_identity(), half) - (pi - 1e-9)) < 1e-15);
    half = zt_rotation_of_turn((vec3){7 * pi, 0, 0});
    assert_true(fabs(zt_rotation_angle(quat_identity(), half) - pi) < 1e-15);
}

/* The velocity of a turn that moves, against what the rotation does in a moment; and back. */
static void velocities(void **state) {
    (void)state;
    draw d = {8, 0};
    for (int round = 0; round < 5000; round++) {
        vec3 turn = {draw_between(&d, -2, 2), draw_between(&d, -2, 2), draw_between(&d, -2, 2)};
        vec3 speed = {draw_between(&d, -2, 2), draw_between(&d, -2, 2),
                      draw_between(&d, -2, 2)};
        if (round % 2) turn = vec3_scale(turn, draw_magnitude(&d, 1e-12, 1));
        const double h = 1e-5;
        quat before = zt_rotation_of_turn(vec3_sub(turn, vec3_scale(speed, h)));
        quat after = zt_rotation_of_turn(vec3_add(turn, vec3_scale(speed, h)));
        vec3 step = zt_rotation_log(quat_mul(quat_conjugate(before), after));
        vec3 velocity = zt_rotation_velocity(turn, speed);
        assert_vec(velocity, vec3_scale(step, 1 / h), 1e-8);
        assert_vec(zt_rotation_turn_speed(turn, velocity), speed, 1e-13);
    }
}

/* ---- between them --------------------------------------------------------------------------
 */

static zt_curve make(zt_arena *arena, zt_curve_kind kind, int count, const double *times,
                     const quat *keys) {
    zt_curve curve;
    assert_int_equal(curve_through(&curve, arena, kind, ZT_VALUE_ROTATION, count, times,
                                   (const double *)keys),
                     ZT_OK);
    return curve;
}

/* Between any two neighbours the way is the short one, whatever signs the keys were given with,
 * and each key is met exactly, but for its sign. */
static void the_short_way(void **state) {
    (void)state;
    draw d = {2, 0};
    zt_arena arena = {0};
    enum { COUNT = 20 };
    for (int round = 0; round < 3000; round++) {
        zt_arena_reset(&arena);
        double times[COUNT];
        quat keys[COUNT];
        for (int k = 0; k < COUNT; k++) {
            times[k] = k + draw_unit(&d) / 2;
            keys[k] = quat_scale(draw_rotation(&d), draw_below(&d, 2) ? 1 : -1);
        }
        zt_curve curve = make(&arena, ZT_CURVE_LINEAR, COUNT, times, keys);
        for (int k = 0; k < COUNT; k++) {
            quat q = eval_quat(&curve, times[k]);
            bool same = memcmp(&q, &keys[k], sizeof q) == 0;
            q = quat_scale(q, -1);
            assert_true(same || memcmp(&q, &keys[k], sizeof q) == 0);
        }
        for (int k = 0; k + 1 < COUNT; k++) {
            double whole = turn(keys[k], keys[k + 1]);
            quat middle = eval_quat(&curve, (times[k] + times[k + 1]) / 2);
            assert_true(fabs(turn(keys[k], middle) - whole / 2) < 1e-12);
            assert_true(fabs(turn(middle, keys[k + 1]) - whole / 2) < 1e-12);
        }
    }
    zt_arena_free(&arena);
}

/* Half turns go the way that their angles say: 0, 180, 360 ... degrees go round and round, and
 * 0, -180 goes backwards. */
static void half_turns(void **state) {
    (void)state;
    zt_arena arena = {0};
    for (int direction = -1; direction <= 1; direction += 2)
        for (int axis = 0; axis < 3; axis++) {
            double times[9];
            quat keys[9];
            for (int k = 0; k < 9; k++) {
                double angle = direction * k * pi;
                times[k] = k;
                keys[k] = quat_euler_xyz((vec3){axis == 0 ? angle : 0, axis == 1 ? angle : 0,
                                                axis == 2 ? angle : 0});
            }
            zt_curve curve = make(&arena, ZT_CURVE_LINEAR, 9, times, keys);
            for (double t = 0.5; t < 8; t++) {
                quat expected = quat_euler_xyz((vec3){axis == 0 ? direction * t * pi : 0,
                                                      axis == 1 ? direction * t * pi : 0,
                                                      axis == 2 ? direction * t * pi : 0});
                assert_true(turn(eval_quat(&curve, t), expected) < 1e-12);
            }
        }
    zt_arena_free(&arena);
}

/* Smooth turns around one axis are the smooth curve of their angle, which never overshoots. */
static void one_axis_is_a_smooth_angle(void **state) {
    (void)state;
    draw d = {3, 0};
    zt_arena arena = {0};
    double worst = 0;
    for (int round = 0; round < 3000; round++) {
        zt_arena_reset(&arena);
        double times[8], angles[8], angle = 0, time = 0;
        quat keys[8], first = draw_rotation(&d);
        vec3 axis = vec3_normalize((vec3){first.x, first.y, first.z});
        for (int k = 0; k < 8; k++) {
            times[k] = time += draw_magnitude(&d, 1e-2, 1e2);
            angles[k] = angle += draw_between(&d, -3, 3);
            keys[k] = quat_mul(first, quat_axis_angle(axis, angle));
        }
        zt_curve numbers;
        assert_int_equal(
            curve_through(&numbers, &arena, ZT_CURVE_SMOOTH, ZT_VALUE_ANGLE, 8, times, angles),
            ZT_OK);
        zt_curve curve = make(&arena, ZT_CURVE_SMOOTH, 8, times, keys);
        for (int i = 0; i < 20; i++) {
            double t = draw_between(&d, times[0], times[7]);
            zt_curve_eval(&angle, &numbers, t);
            quat expected = quat_mul(first, quat_axis_angle(axis, angle));
            worst = fmax(worst, turn(eval_quat(&curve, t), expected));
        }
    }
    printf("  smooth rotation around one axis: worst error %.2g\n", worst);
    assert_true(worst < 1e-13);
    zt_arena_free(&arena);
}

/* Through keys turned in any way, at uneven times: unit length, no jump anywhere, no corner at
 * a key (nor of TCB's, with continuity 0), and no detour beyond what the keys are apart. */
static void smooth_has_no_corner_and_no_flip(void **state) {
    (void)state;
    draw d = {4, 0};
    zt_arena arena = {0};
    double corner = 0, step = 0, length = 0;
    for (int round = 0; round < 4000; round++) {
        zt_arena_reset(&arena);
        double times[6], time = 0;
        quat keys[6];
        for (int k = 0; k < 6; k++) {
            times[k] = time += draw_magnitude(&d, 0.1, 10);
            keys[k] = draw_rotation(&d);
            if (k && draw_below(&d, 4) == 0)
                keys[k] = at_distance(&d, keys[k - 1], draw_below(&d, 2) ? pi / 2 : 1e-9);
        }
        zt_curve curve = make(&arena, ZT_CURVE_SMOOTH, 6, times, keys);
        const double h = 1e-6;
        zt_curve tcb = make(&arena, ZT_CURVE_TCB, 6, times, keys);
        for (int i = 0; i < 8; i++) {
            const zt_curve *c = i % 2 ? &tcb : &curve;
            int k = 1 + i / 2;
            vec3 before = turning(c, times[k] - h, times[k]);
            vec3 after = turning(c, times[k], times[k] + h);
            corner = fmax(corner, vec3_length(vec3_sub(after, before)));
        }
        for (int k = 0; k < 5; k++) {
            quat last = eval_quat(&curve, times[k]);
            for (int i = 1; i <= 100; i++) {
                quat q = eval_quat(&curve, times[k] + (times[k + 1] - times[k]) * i / 100);
                step = fmax(step, turn(last, q));
                length = fmax(length, length_error_ulp(q));
                last = q;
            }
        }
    }
    printf("  smooth rotation: worst corner %.2g rad/s, worst hundredth of a step %.2g rad, "
           "worst length error %.2g ulp\n",
           corner, step, length);
    assert_true(corner < 0.02); /* accelerations reach some 1e3, times h, twice */
    assert_true(step < 0.15);   /* at twice to three times the mean speed of a half turn */
    assert_true(length <= 4);
    zt_arena_free(&arena);
}

/* Quaternions that are none, and times that are hardly apart, still give rotations. */
static void odd_keys(void **state) {
    (void)state;
    draw d = {5, 0};
    zt_arena arena = {0};
    for (int round = 0; round < 50000; round++) {
        zt_arena_reset(&arena);
        double times[5], time = 0;
        quat keys[5];
        for (int k = 0; k < 5; k++) {
            double spacing = draw_magnitude(&d, 1e-300, 1e300);
            times[k] = time = fmax(time + spacing, nextafter(time, INFINITY));
            keys[k] = (quat){draw_nasty(&d), draw_nasty(&d), draw_nasty(&d), draw_nasty(&d)};
        }
        for (zt_curve_kind kind = 0; kind < ZT_CURVE_KIND_COUNT; kind++) {
            zt_curve curve = make(&arena, kind, 5, times, keys);
            for (int i = 0; i < 20; i++) {
                int k = draw_below(&d, 4);
                quat q =
                    eval_quat(&curve, times[k] + draw_unit(&d) * (times[k + 1] - times[k]));
                if (!(length_error_ulp(q) <= 4))
                    fail_msg("kind %d (%.17g %.17g %.17g %.17g) is no rotation", kind, q.w, q.x,
                             q.y, q.z);
            }
        }
    }
    zt_arena_free(&arena);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(euler_orders),
        cmocka_unit_test(looking),
        cmocka_unit_test(angles_between),
        cmocka_unit_test(velocities),
        cmocka_unit_test(slerp_is_exact),
        cmocka_unit_test(arcs_are_exact),
        cmocka_unit_test(the_short_way),
        cmocka_unit_test(half_turns),
        cmocka_unit_test(one_axis_is_a_smooth_angle),
        cmocka_unit_test(smooth_has_no_corner_and_no_flip),
        cmocka_unit_test(odd_keys),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
