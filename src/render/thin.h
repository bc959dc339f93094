/* Thin things: what may be thinner on the picture than two pixels, and so fall between the
 * middles of pixels. Found by bounds, so that it does not depend on a ray that happens to meet
 * it. */
#ifndef ZT_RENDER_THIN_H
#define ZT_RENDER_THIN_H

#include <stdint.h>

#include "base/arena.h"
#include "scene/exposure.h"

/* The things of an exposure's first moment as a picture shows them. Lives in the arena that it
 * was made in; the exposure must be there as long. */
typedef struct zt_thin zt_thin;

/* ZT_EMEMORY. */
zt_status zt_thin_prepare(const zt_thin **thin, const zt_exposure *exposure, int width,
                          int height, zt_arena *arena);

/* Raises, in a plane of the picture, the numbers of the pixels that bounds of thin things
 * cover, `reach` pixels around included: to the logarithm of as many samples as meet what is so
 * thin for sure where it goes straight up or across through a pixel, or is smaller than one and
 * lies within it, from 4 to 64. Planes are
 * left out, and the parts of meshes, which count as a whole; nothing is found for an
 * equirectangular lens. */
void zt_thin_mark(uint8_t *least, const zt_thin *thin, int reach);

#endif
