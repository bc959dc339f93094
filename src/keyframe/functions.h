/* What an expression can call and reckon with, of numbers and vectors. Pure and without Lua;
 * the same bits wherever the C library's own functions give the same. */
#ifndef ZT_KEYFRAME_FUNCTIONS_H
#define ZT_KEYFRAME_FUNCTIONS_H

#include <stdbool.h>

enum { ZT_OPERANDS_MAX = 16, ZT_CHANNELS_MAX = 16 };

/* A number, or a vector of 2 to ZT_CHANNELS_MAX of them. */
typedef struct zt_operand {
    const double *numbers;
    int width; /* 0 for one number that is no vector */
} zt_operand;

/* A call: what goes in and what comes out. */
typedef struct zt_call {
    zt_operand operands[ZT_OPERANDS_MAX];
    int count;
    int width; /* of the result, 0 for a number */
    double result[ZT_CHANNELS_MAX];
    char wrong[96]; /* why the call makes no sense */
} zt_call;

/* Of its two ways to be called, a function has one. */
typedef struct zt_function {
    const char *name;
    int least, most; /* operands */
    /* Of each channel alone; what has no value gives NaN or infinity. A number beside vectors
     * stands for each of its channels. */
    double (*each)(const double *a, int count);
    /* Of whole vectors; fills width and result, or fills `wrong` and returns false. */
    bool (*whole)(zt_call *call);
} zt_function;

/* sin cos tan asin acos atan atan2(y,x) sqrt exp log(x) abs sign floor ceil round fract deg
 * rad, as in C; angles are radians, deg(x) of them are degrees and rad(x) the way back. min
 * max, of 2 to 16; clamp(x,low,high); mix(a,b,u), exact at both ends; step(edge,x): 0 before
 *   the edge, else 1; smoothstep(a,b,x): 0 before a, 1 after b, a cubic without a corner
 * between; remap(x,a,b,c,d): takes a .. b to c .. d; mod(x,y): of the sign of y, as Lua's %.
 * noise(x[,seed]): smooth value noise in -1 .. 1: a random value at each whole number, between
 *   them a polynomial of degree five, so that speed and acceleration have no jump.
 * random(key, ...): from 0 to below 1, a function of its keys alone.
 * vec(...): a vector of all numbers that its operands hold. dot(a,b), cross(a,b) of three and
 *   three, length(a), normalize(a): of vectors of any magnitude; zero stays zero. */
extern const zt_function zt_functions[];
extern const int zt_function_count;

/* Lua's operators where a vector is among their two operands (a minus before one gets it
 * twice), by the names of their events: "__add" ... */
extern const zt_function zt_operators[];
extern const int zt_operator_count;

/* Calls a function; false, with `wrong` filled, where the operands are not what it takes. */
bool zt_function_call(const zt_function *function, zt_call *call);

#endif
