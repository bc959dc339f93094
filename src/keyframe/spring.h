/* A damped spring, x'' + 2 ratio frequency x' + frequency^2 x = 0, solved in closed form: any
 * moment can be asked for alone, at any stiffness. */
#ifndef ZT_KEYFRAME_SPRING_H
#define ZT_KEYFRAME_SPRING_H

/* A ratio below 1 swings, above 1 creeps, 1 comes to rest soonest. Made by zt_spring_make. */
typedef struct zt_spring {
    double frequency;       /* undamped, radians a second */
    double ratio;           /* of the damping to the critical one */
    double root, root_rest; /* sqrt(|1 - ratio^2|), as the sum of two doubles */
} zt_spring;

/* frequency > 0 and ratio >= 0, both at most 1e100. */
zt_spring zt_spring_make(double frequency, double ratio);

/* The same from newtons a metre, newton seconds a metre and kilograms, or any units that fit
 * together. stiffness and mass > 0, damping >= 0. */
zt_spring zt_spring_of(double stiffness, double damping, double mass);

/* What a stretch of time does to a spring: the position x, measured from rest, and the speed
 * w = x' / frequency, which is in the same unit, become
 *   x_x x + x_w w  and  w_x x + w_w w. */
typedef struct zt_spring_step {
    double x_x, x_w, w_x, w_w;
} zt_spring_step;

/* From one time to a later one, seconds. Both are taken to be exact, and so is their
 * difference: a stiff spring has gone round many times in between. */
zt_spring_step zt_spring_between(const zt_spring *spring, double from_s, double to_s);

#endif
