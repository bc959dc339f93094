/* Roots of quartics without guesses: between two roots of the derivative a polynomial only
 * rises or only falls, so that each of its own roots has a bracket. */
#include "reference.h"

#define TINY ((real)1e-33L)

static real eval(const real *c, int degree, real s) {
    real sum = c[degree];
    for (int i = degree - 1; i >= 0; i--) sum = sum * s + c[i];
    return sum;
}

/* Where to begin: the same in double precision, which costs a fiftieth. Whatever comes out of
 * it, what follows holds it against the bracket. */
static real guess(const real *wide, int degree, real wide_low, real wide_high, bool rises) {
    double c[5], low = (double)wide_low, high = (double)wide_high, s = (low + high) / 2;
    for (int i = 0; i <= degree; i++) c[i] = (double)wide[i];
    for (int i = 0; i < 60; i++) {
        double value = c[degree], steep = 0;
        for (int k = degree - 1; k >= 0; k--) {
            steep = steep * s + value;
            value = value * s + c[k];
        }
        if ((value < 0) == rises)
            low = s;
        else
            high = s;
        double next = s - value / steep;
        if (!(next > low && next < high) || i % 16 == 15) next = (low + high) / 2;
        if (fabs(next - s) <= 0x1p-50 * fabs(s)) break;
        s = next;
    }
    return s > wide_low && s < wide_high ? (real)s : (wide_low + wide_high) / 2;
}

/* The root within a bracket: Newton's steps, halving where one would leave it. */
static real polish(const real *c, const real *slope, int degree, real low, real high) {
    bool rises = eval(c, degree, low) < 0;
    real s = guess(c, degree, low, high, rises);
    for (int i = 0; i < 240; i++) {
        real value = eval(c, degree, s);
        if (value == 0) return s;
        if ((value < 0) == rises)
            low = s;
        else
            high = s;
        real steep = eval(slope, degree - 1, s);
        real next = steep != 0 ? s - value / steep : low;
        /* Halving now and then keeps slow steps from lasting. */
        if (!(next > low && next < high) || i % 16 == 15) next = (low + high) / 2;
        if (next == s || high - low <= TINY * real_max(real_abs(low), real_abs(high)))
            return next;
        s = next;
    }
    return s;
}

/* Roots within [-limit, limit] of a polynomial, given by c[0] + c[1] s + ... */
static int solve(real *roots, const real *c, int degree, real limit) {
    if (degree == 1) {
        if (c[1] == 0) return 0;
        roots[0] = -c[0] / c[1];
        return real_abs(roots[0]) <= limit;
    }
    real slope[4], turns[4];
    for (int i = 0; i < degree; i++) slope[i] = c[i + 1] * (i + 1);
    int turn_count = solve(turns, slope, degree - 1, limit), count = 0;
    real low = -limit;
    for (int i = 0; i <= turn_count; i++) {
        real high = i < turn_count ? turns[i] : limit;
        real at_low = eval(c, degree, low), at_high = eval(c, degree, high);
        if (at_low == 0 && (count == 0 || roots[count - 1] != low))
            roots[count++] = low;
        else if ((at_low < 0) != (at_high < 0) && at_high != 0)
            roots[count++] = polish(c, slope, degree, low, high);
        low = high;
    }
    return count;
}

int ref_quartic(real roots[4], real a, real b, real c, real limit) {
    const real all[5] = {c, b, a, 0, 1};
    real found[8];
    int count = solve(found, all, 4, limit);
    for (int i = 0; i < count && i < 4; i++) roots[i] = found[i];
    return count < 4 ? count : 4;
}
