/* The classic integrator: the light seen along a batch of rays, in the model of the first
 * ray tracer (Whitted's mirrors, shadows and point lights, "An improved illumination model for
 * shaded display", CACM 23(6), 1980) with light fading by the square of the distance. */
#ifndef ZT_TRACER_CLASSIC_H
#define ZT_TRACER_CLASSIC_H

#include "tracer/isa.h"
#include "tracer/kernel.h"

/* Traces rays. For each hit:
 *     ambient * color
 *   + for each point light, each channel cut to 0..1:
 *         power / d^2 * |v . n| * color, none where the light is behind the surface or hidden
 *   + of each lamp with a size the same for one place on it (tracer/lamps.h), each channel cut
 *     likewise: their mean over many rays is what the lamp gives
 *   + reflectivity * what is seen along the mirrored ray, to the scene's depth
 * Nothing hit is black. The normal n faces the side that the ray came from. */
extern const zt_kernel ZT_KERNEL_NAME(zt_kernel);

#endif
