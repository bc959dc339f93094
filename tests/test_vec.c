/* Shows that vectors, rotations, transforms and random numbers are what mathematics says. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/random.h"
#include "base/xform.h"

static const double pi = 3.14159265358979323846;

static void assert_vec(vec3 found, vec3 expected, double tolerance) {
    if (vec3_max_abs(vec3_sub(found, expected)) <= tolerance) return;
    fail_msg("(%.17g, %.17g, %.17g) is not (%.17g, %.17g, %.17g)", found.x, found.y, found.z,
             expected.x, expected.y, expected.z);
}

/* Lengths are right where their squares would overflow or vanish. */
static void vectors_of_any_magnitude(void **state) {
    (void)state;
    const double magnitudes[] = {1, 1e-300, 1e-160, 1e160, 1e300};
    for (int i = 0; i < 5; i++) {
        double m = magnitudes[i];
        vec3 v = {2 * m, -3 * m, 6 * m};
        assert_true(fabs(vec3_length(v) / (7 * m) - 1) < 1e-15);
        assert_vec(vec3_normalize(v), (vec3){2.0 / 7, -3.0 / 7, 6.0 / 7}, 1e-15);
    }
    assert_true(vec3_length((vec3){0, 0, 0}) == 0);
    assert_vec(vec3_normalize((vec3){0, 0, 0}), (vec3){0, 0, 0}, 0);
    assert_true(isinf(vec3_length((vec3){1, -INFINITY, 0})));
    assert_true(isnan(vec3_length((vec3){NAN, NAN, NAN})));
    assert_vec(vec3_cross((vec3){1, 0, 0}, (vec3){0, 1, 0}), (vec3){0, 0, 1}, 0);
}

/* Quaternions turn counterclockwise, multiply as matrices do, and Euler angles go x, y, z. */
static void rotations(void **state) {
    (void)state;
    const vec3 one = {1, 1, 1}, here = {0, 0, 0};
    quat quarter = quat_axis_angle((vec3){0, 0, 1}, pi / 2);
    xform m = xform_place(here, quarter, one);
    assert_vec(xform_vector(&m, (vec3){1, 0, 0}), (vec3){0, 1, 0}, 1e-15);

    /* y goes to z around x, which goes to x around y, which goes to y around z. */
    m = xform_place(here, quat_euler_xyz((vec3){pi / 2, pi / 2, pi / 2}), one);
    assert_vec(xform_vector(&m, (vec3){0, 1, 0}), (vec3){0, 1, 0}, 1e-15);
    m = xform_place(here, quat_euler_xyz((vec3){pi / 2, pi / 2, 0}), one);
    assert_vec(xform_vector(&m, (vec3){0, 1, 0}), (vec3){1, 0, 0}, 1e-15);

    quat a = quat_axis_angle(vec3_normalize((vec3){1, 2, 3}), 0.7);
    quat b = quat_axis_angle(vec3_normalize((vec3){-2, 1, 0.5}), 2.1);
    xform of_a = xform_place(here, a, one), of_b = xform_place(here, b, one);
    xform of_product = xform_place(here, quat_mul(a, b), one);
    xform product = xform_mul(&of_a, &of_b);
    assert_vec(of_product.x, product.x, 1e-15);
    assert_vec(of_product.y, product.y, 1e-15);
    assert_vec(of_product.z, product.z, 1e-15);
    assert_true(fabs(xform_determinant(&of_a) - 1) < 1e-15);

    quat back = quat_mul(quat_conjugate(a), a);
    assert_true(fabs(quat_dot(back, quat_identity()) - 1) < 1e-15);
    assert_true(quat_normalize((quat){0, 0, 0, 0}).w == 1);
    assert_true(fabs(quat_normalize((quat){0, 0, -5, 0}).y + 1) < 1e-15);
}

/* Scale, then rotate, then move; and a product means the right factor first. */
static void placing(void **state) {
    (void)state;
    quat quarter = quat_axis_angle((vec3){0, 0, 1}, pi / 2);
    xform m = xform_place((vec3){10, 20, 30}, quarter, (vec3){2, 3, 4});
    assert_vec(xform_point(&m, (vec3){1, 1, 1}), (vec3){10 - 3, 20 + 2, 30 + 4}, 1e-14);
    xform shift = xform_identity();
    shift.shift = (vec3){1, 0, 0};
    xform both = xform_mul(&m, &shift);
    assert_vec(xform_point(&both, (vec3){0, 0, 0}), xform_point(&m, (vec3){1, 0, 0}), 1e-14);
}

/* A normal stays across its surface and on its outer side, in mirrors and in flattenings too.
 */
static void normals(void **state) {
    (void)state;
    quat turn = quat_axis_angle(vec3_normalize((vec3){1, 1, 0}), 1);
    const vec3 scales[] = {{1, 2, 3}, {-1, 2, 3}, {-1, -2, 3}, {-1, -2, -3}};
    vec3 n = vec3_normalize((vec3){1, 2, -1});
    vec3 s = vec3_cross(n, (vec3){0, 1, 0}), t = vec3_cross(n, s);
    for (int i = 0; i < 4; i++) {
        xform m = xform_place((vec3){5, 6, 7}, turn, scales[i]);
        vec3 moved = xform_normal(&m, n);
        assert_true(fabs(vec3_dot(moved, xform_vector(&m, s))) < 1e-14);
        assert_true(fabs(vec3_dot(moved, xform_vector(&m, t))) < 1e-14);
        assert_true(vec3_dot(moved, xform_vector(&m, n)) > 0.1); /* n itself goes outwards */
    }
    xform flat = xform_place((vec3){0, 0, 0}, quat_identity(), (vec3){1, 0, 1});
    assert_vec(vec3_normalize(xform_normal(&flat, (vec3){0.6, 0.8, 0})), (vec3){0, 1, 0}, 0);
}

/* The first numbers of SplitMix64 with seed 0, as its authors' program prints them. */
static void random_numbers(void **state) {
    (void)state;
    assert_true(zt_random_key(0, 0) == UINT64_C(0xE220A8397B1DCDAF));
    assert_true(zt_random_key(0, 1) == UINT64_C(0x6E789E6AA1B965F4));
    assert_true(zt_random_key(0, 2) == UINT64_C(0x06C45D188009454F));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vectors_of_any_magnitude),
        cmocka_unit_test(rotations),
        cmocka_unit_test(placing),
        cmocka_unit_test(normals),
        cmocka_unit_test(random_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
