/* Shows that springs are the solutions of their equation, as exactly as a film of any length
 * needs, without a seam where damping becomes critical. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

#include "draw.h"
#include "keyframe/spring.h"
#include "real.h"

typedef struct motion {
    real x, w;
} motion;

/* The textbook's three solutions (e.g. S. S. Rao, "Mechanical Vibrations", section 2.6), for
 * speeds in units of the frequency. */
static motion reference(real frequency, real ratio, real time, motion m) {
    real angle = frequency * time, x = m.x, w = m.w;
    if (ratio == 1) {
        real e = REAL(exp)(-angle);
        return (motion){e * (x + (w + x) * angle), e * (w - (w + x) * angle)};
    }
    if (ratio < 1) {
        real s = REAL(sqrt)(1 - ratio * ratio), e = REAL(exp)(-ratio * angle);
        real a = x, b = (w + ratio * x) / s, c = REAL(cos)(s * angle), d = REAL(sin)(s * angle);
        return (motion){e * (a * c + b * d),
                        e * ((b * s - ratio * a) * c - (a * s + ratio * b) * d)};
    }
    real s = REAL(sqrt)(ratio * ratio - 1), slow = -1 / (ratio + s), fast = -(ratio + s);
    real b = (w - slow * x) / (fast - slow), a = x - b;
    real e_slow = REAL(exp)(slow * angle), e_fast = REAL(exp)(fast * angle);
    return (motion){a * e_slow + b * e_fast, a * slow * e_slow + b * fast * e_fast};
}

static double draw_ratio(draw *d) {
    switch (draw_below(d, 6)) {
    case 0:
        return 0;
    case 1:
        return 1;
    case 2:
        return 1 + (draw_below(d, 2) ? 1 : -1) * draw_magnitude(d, 1e-16, 1e-3);
    case 3:
        return draw_magnitude(d, 1e-12, 1);
    case 4:
        return draw_magnitude(d, 1, 1e6);
    default:
        return draw_between(d, 0, 2);
    }
}

/* Within 1e-9 of the amplitude for frequencies from 1e-6 to 1e9 and ratios from 0 to 1e6, at
 * times up to 5000 s, over one stretch of time and over ten that follow each other. */
static void springs_are_exact(void **state) {
    (void)state;
    if (!REAL_IS_QUAD) skip();
    draw d = {1, 0};
    double worst = 0;
    for (int round = 0; round < 40000; round++) {
        double frequency = draw_magnitude(&d, 1e-6, 1e9), ratio = draw_ratio(&d);
        zt_spring spring = zt_spring_make(frequency, ratio);
        double x = draw_between(&d, -1, 1), w = draw_between(&d, -1, 1);
        double t = draw_between(&d, 0, 1000);
        motion expected = {x, w};
        double amplitude = hypot(x, w);
        for (int k = 0; k < 1 + 9 * (round % 2); k++) {
            double next = t + draw_magnitude(&d, 1e-9, 400);
            zt_spring_step s = zt_spring_between(&spring, t, next);
            double x_next = s.x_x * x + s.x_w * w;
            w = s.w_x * x + s.w_w * w;
            x = x_next;
            expected = reference(frequency, ratio, (real)next - t, expected);
            t = next;
            double error = fmax(fabs((double)(x - expected.x)), fabs((double)(w - expected.w)));
            if (!(error <= 1e-9 * amplitude))
                fail_msg("frequency %g, ratio %.17g, until %g s: off by %g of %g", frequency,
                         ratio, t, error, amplitude);
            worst = fmax(worst, error / amplitude);
        }
    }
    printf("  spring: worst error %.2g of the amplitude\n", worst);
}

/* From a ratio just below 1 over 1 to just above there is no step. */
static void no_seam(void **state) {
    (void)state;
    double worst = 0;
    for (double angle = 1e-6; angle < 100; angle *= 1.3) {
        zt_spring critical = zt_spring_make(1, 1);
        zt_spring_step c = zt_spring_between(&critical, 0, angle);
        for (double off = 0x1p-53; off <= 1e-12; off *= 2)
            for (int side = -1; side <= 1; side += 2) {
                zt_spring spring = zt_spring_make(1, 1 + side * off);
                zt_spring_step s = zt_spring_between(&spring, 0, angle);
                worst = fmax(worst, fabs(s.x_x - c.x_x));
                worst = fmax(worst, fabs(s.x_w - c.x_w));
                worst = fmax(worst, fabs(s.w_w - c.w_w));
            }
    }
    printf("  spring: ratio 1 +- 1e-12 moves by at most %.2g\n", worst);
    assert_true(worst < 2e-12);
}

/* Energy, x^2 + w^2, falls or stays, from each moment to each later one, up to rounding. */
static void energy_never_grows(void **state) {
    (void)state;
    draw d = {2, 0};
    double worst = 0;
    for (int round = 0; round < 20000; round++) {
        zt_spring spring = zt_spring_make(draw_magnitude(&d, 1e-6, 1e9), draw_ratio(&d));
        double x = draw_between(&d, -1, 1), w = draw_between(&d, -1, 1), t = 0;
        for (int i = 0; i < 20; i++) {
            double energy = x * x + w * w, next = t + draw_magnitude(&d, 1e-9, 1e3);
            zt_spring_step s = zt_spring_between(&spring, t, next);
            double x_next = s.x_x * x + s.x_w * w;
            w = s.w_x * x + s.w_w * w;
            x = x_next;
            t = next;
            if (!(x * x + w * w <= energy * (1 + 1e-14) + 1e-300))
                fail_msg("energy %.17g became %.17g", energy, x * x + w * w);
            if (energy > 1e-200) worst = fmax(worst, (x * x + w * w) / energy - 1);
        }
    }
    printf("  spring: energy grows by at most %.2g\n", worst);
}

/* Whatever the numbers, what comes out is finite, and an end is reached. */
static void always_finite(void **state) {
    (void)state;
    const double frequencies[] = {1e-100, 1e-6, 1, 1e9, 1e100};
    const double ratios[] = {0, 1e-100, 1, 1 + 0x1p-52, 1e6, 1e100};
    const double times[] = {0, 5e-324, 1, 1e9, 1e300, 1.7976931348623157e308};
    for (int f = 0; f < 5; f++)
        for (int r = 0; r < 6; r++)
            for (int t = 0; t < 6; t++) {
                zt_spring spring = zt_spring_make(frequencies[f], ratios[r]);
                zt_spring_step s = zt_spring_between(&spring, -times[t], times[t]);
                assert_true(isfinite(s.x_x) && isfinite(s.x_w) && isfinite(s.w_x) &&
                            isfinite(s.w_w));
                if (times[t] == 0) assert_true(s.x_x == 1 && s.w_w == 1 && s.x_w == 0);
            }
}

/* A kilogram on 400 N/m swings at 20 rad/s; 12 N s/m damp it to three tenths. */
static void from_stiffness(void **state) {
    (void)state;
    zt_spring spring = zt_spring_of(400, 12, 1);
    assert_true(spring.frequency == 20 && spring.ratio == 0.3);
    spring = zt_spring_of(1e300, 0, 1e-300);
    assert_true(fabs(spring.frequency / 1e300 - 1) < 1e-15 && spring.ratio == 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(springs_are_exact),  cmocka_unit_test(no_seam),
        cmocka_unit_test(energy_never_grows), cmocka_unit_test(always_finite),
        cmocka_unit_test(from_stiffness),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
