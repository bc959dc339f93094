#include "keyframe/spring.h"

#include <math.h>

/* A sum of two doubles, the second one small beside the first: a phase of 1e12 radians needs
 * more digits than one double has. The sums and products are T. J. Dekker's, "A floating-point
 * technique for extending the available precision", 1971, with a fused multiplication. */
typedef struct twin {
    double high, low;
} twin;

static twin sum(double a, double b) {
    double s = a + b, t = s - a;
    return (twin){s, (a - (s - t)) + (b - t)};
}

static twin product(double a, double b) {
    double p = a * b;
    return (twin){p, fma(a, b, -p)};
}

zt_spring zt_spring_make(double frequency, double ratio) {
    twin square = product(ratio, ratio), one_less = sum(1, -square.high);
    double rest = one_less.low - square.low;
    double whole = one_less.high + rest, sign = whole < 0 ? -1 : 1;
    double root = sqrt(fabs(whole));
    double root_rest = 0;
    if (root > 0)
        root_rest = (fma(-root, root, sign * one_less.high) + sign * rest) / (2 * root);
    return (zt_spring){frequency, ratio, root, root_rest};
}

zt_spring zt_spring_of(double stiffness, double damping, double mass) {
    double k = sqrt(stiffness), m = sqrt(mass);
    return zt_spring_make(k / m, damping / (2 * k * m));
}

/* The angle that the undamped spring turns by. */
static twin angle_between(double frequency, double from_s, double to_s) {
    const double most = 1e300; /* no phase is left there, but nothing overflows either */
    if (!(frequency * (to_s - from_s) < most)) return (twin){most, 0};
    twin time = sum(to_s, -from_s);
    twin angle = product(frequency, time.high);
    return sum(angle.high, angle.low + frequency * time.low);
}

zt_spring_step zt_spring_between(const zt_spring *spring, double from_s, double to_s) {
    twin angle = angle_between(spring->frequency, from_s, to_s);
    double ratio = spring->ratio, root = spring->root;
    double decay, cosine = 1, sine = angle.high; /* sine is over root, which may vanish */
    if (ratio > 1) {
        /* The slower of two exponentials is drawn out, so that none overflows. */
        decay = exp(-angle.high / (ratio + root));
        double less = expm1(-2 * root * angle.high);
        cosine = 1 + less / 2;
        if (root > 0) sine = -less / (2 * root);
    } else {
        decay = exp(-ratio * angle.high);
        if (root > 0) {
            twin phase = product(angle.high, root);
            phase.low += angle.high * spring->root_rest + angle.low * root;
            double c = cos(phase.high), s = sin(phase.high);
            double c_low = cos(phase.low), s_low = sin(phase.low);
            cosine = c * c_low - s * s_low;
            sine = (s * c_low + c * s_low) / root;
        }
    }
    return (zt_spring_step){.x_x = decay * (cosine + ratio * sine),
                            .x_w = decay * sine,
                            .w_x = -decay * sine,
                            .w_w = decay * (cosine - ratio * sine)};
}
