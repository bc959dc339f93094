/* What a person sees who is shown two pictures in turn. */
#ifndef ZT_IMAGE_FLIP_H
#define ZT_IMAGE_FLIP_H

#include <stdint.h>

#include "base/arena.h"
#include <zoetrope/status.h>

/* The mean over all pixels of FLIP for pictures of low dynamic range: P. Andersson, J. Nilsson,
 * T. Akenine-Möller, M. Oskarsson, K. Åström and M. D. Fairchild, "FLIP: a difference evaluator
 * for alternating images", 2020; seen as there, from 0.7 m, on a display 0.7 m and 3840 pixels
 * wide. `image` and `reference` are sRGB bytes, 3 a pixel. Memory is from the arena.
 * ZT_EMEMORY. */
zt_status zt_flip(double *mean, const uint8_t *image, const uint8_t *reference, int width,
                  int height, zt_arena *arena);

#endif
