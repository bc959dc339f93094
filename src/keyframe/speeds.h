/* How fast a curve passes a key, from the steps on both of its sides. */
#ifndef ZT_KEYFRAME_SPEEDS_H
#define ZT_KEYFRAME_SPEEDS_H

enum { ZT_STEP_WIDTH_MAX = 9 };

/* The ways to a key and on from it, in any unit. Those of rotations are half turns in the key's
 * own frame, three wide. Times are positive. */
typedef struct zt_steps {
    int width;
    double before[ZT_STEP_WIDTH_MAX], after[ZT_STEP_WIDTH_MAX];
    double before_s, after_s;
} zt_steps;

/* How far the curve would go at the speed it arrives with in the time of the step before, and
 * at the speed it leaves with in the time of the step after. */
typedef struct zt_speeds {
    double arrive[ZT_STEP_WIDTH_MAX], leave[ZT_STEP_WIDTH_MAX];
} zt_speeds;

/* The same speed on both sides; at most twice that of the slower step, so that nothing
 * overshoots: M. Steffen, "A simple method for monotonic interpolation in one dimension", 1990.
 * Each channel by itself; or, for turns, their mean limited as a whole, and falling to rest as
 * the turning turns back, which is Steffen's again where all turns have one axis. */
void zt_speeds_smooth(zt_speeds *speeds, const zt_steps *steps);
void zt_speeds_smooth_turns(zt_speeds *speeds, const zt_steps *steps);

/* The same direction on both sides: centripetal Catmull-Rom (C. Yuksel, S. Schaefer and J.
 * Keyser, "Parameterization and applications of Catmull-Rom curves", 2011), which has no loops
 * between keys. Keys at the same place are a rest. */
void zt_speeds_catmull_rom(zt_speeds *speeds, const zt_steps *steps);

/* D. Kochanek and R. Bartels, "Interpolating splines with local tension, continuity, and bias
 * control", 1984, with the speed kept over steps of unequal time where continuity is 0. */
void zt_speeds_tcb(zt_speeds *speeds, const zt_steps *steps, double tension, double continuity,
                   double bias);

#endif
