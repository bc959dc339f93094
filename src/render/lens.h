/* The lens: from a place on the picture to a ray into the scene. */
#ifndef ZT_RENDER_LENS_H
#define ZT_RENDER_LENS_H

#include "scene/scene.h"
#include "tracer/kernel.h"

/* A camera made ready for a picture of a given size: the ray through the place (x, y), in
 * pixels from the top left corner, runs from the origin along corner + x right + y down. */
typedef struct zt_lens {
    vec3 corner, right, down;
} zt_lens;

/* The width of a pixel in the middle of the picture, at distance 1. */
double zt_lens_pixel(const zt_camera *camera, int height);

/* A perspective lens whose `fov` spans the height of the picture; pixels are square. */
zt_lens zt_lens_prepare(const zt_camera *camera, int width, int height);

/* Makes the batch's rays the ones through the places (x[i], y[i]), `count` of them. */
void zt_lens_rays(zt_rays *rays, const zt_lens *lens, const float *x, const float *y,
                  int count);

#endif
