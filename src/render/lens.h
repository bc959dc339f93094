/* The lens: from a place on the picture to a ray into the scene. */
#ifndef ZT_RENDER_LENS_H
#define ZT_RENDER_LENS_H

#include "base/arena.h"
#include "scene/exposure.h"
#include "tracer/kernel.h"

/* A camera made ready for a picture of a given size. Lives in the arena that it was made in. */
typedef struct zt_lens zt_lens;

/* How wide a pixel of the picture is, from top to bottom, at one moment; and the finest of all
 * moments, with how far from the first moment's camera rays begin. */
zt_pixel zt_lens_pixel(const zt_camera *camera, int height);
zt_pixel zt_lens_finest_pixel(const zt_exposure *exposure, int width, int height);

/* ZT_EMEMORY. */
zt_status zt_lens_prepare(zt_lens **lens, const zt_exposure *exposure, int width, int height,
                          zt_arena *arena);

/* Whether rays ask where in the opening of the lens they pass, and when. */
bool zt_lens_has_aperture(const zt_lens *lens);
bool zt_lens_moves(const zt_lens *lens);

/* Bounds of the directions of all rays through a part of the picture, ends included, as
 * zt_lens_rays makes them; false where they may begin elsewhere than at the camera's place, or
 * bounds are not known. */
bool zt_lens_bounds(vec3 *low, vec3 *high, const zt_lens *lens, int x0, int y0, int x1, int y1);

/* Makes the batch's rays the ones through the places (x[i], y[i]) of the picture, in pixels
 * from its top left corner, `count` of them; at their times, which are read where the lens
 * moves; and through the point of its opening that (u[i], v[i]) of the unit square stand for,
 * read where it has one; both NULL: through its middle. */
void zt_lens_rays(zt_rays *rays, const zt_lens *lens, const float *x, const float *y,
                  const float *u, const float *v, int count);

#endif
