/* Arbitrary output variables: what an image tells besides its colours, by the names that
 * compositing programs know. */
#ifndef ZOETROPE_AOV_H
#define ZOETROPE_AOV_H

#include <zoetrope/image.h>
#include <zoetrope/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Bits. All but the last two tell of one ray through the middle of each pixel: of the first
 * thing that it meets, through the middle of the lens, in the middle of the shutter's opening.
 * They are not blended, so that a number is always one that is there. */
typedef enum zt_aov {
    ZT_AOV_Z = 1 << 0, /* "Z": how far ahead of the camera, along its view; below 0 behind it;
                          infinity where nothing is met */
    ZT_AOV_P = 1 << 1, /* "P.X" "P.Y" "P.Z": the place in the world; 0 where nothing is met */
    ZT_AOV_N = 1 << 2, /* "N.X" "N.Y" "N.Z": the shading normal there, unit, in the world,
                          towards the side that is seen; 0 where nothing is met */
    ZT_AOV_ALBEDO = 1 << 3, /* "albedo.R" "albedo.G" "albedo.B": the surface's own color there,
                               linear, of patterns and vertices, too; 0 where nothing is met */
    ZT_AOV_MOTION = 1 << 4, /* "motion.x" "motion.y": in pixels, to the right and upwards, where
                               the point that is met will be at the next frame, less where it is
                               now: forward vectors as Nuke's VectorBlur takes them (Foundry,
                               "Nuke Reference Guide": the next frame's x and y less this one's,
                               which count from the bottom left). What a mirror shows does not
                               count. 0 where nothing is met, and where the point will be behind
                               the camera */
    ZT_AOV_OBJECT = 1 << 5, /* "id.object": the object's number from 1 in the description's
                               order; 0 for none */
    ZT_AOV_MATERIAL = 1 << 6, /* "id.material": likewise */
    ZT_AOV_SAMPLES = 1 << 7,  /* "samples": how many samples the pixel took */
    ZT_AOV_ERROR = 1 << 8,    /* "error": its estimated standard error in linear light, the root
                                 of the mean square of red, green and blue, to which that of A
                                 adds in full where the background is transparent; -1 where
                                 there is no estimate, as where all take as many samples */
    ZT_AOV_ALL = (1 << 9) - 1
} zt_aov;

/* Finds the bits of "Z", "N", "id.object", ... or "all"; false for another name. */
bool zt_aov_find(unsigned *aovs, const char *name);

/* The names that there are, with commas between them, for messages. */
const char *zt_aov_names(void);

/* Adds their channels, in the order above. ZT_EMEMORY. */
zt_status zt_image_add_aovs(zt_image *image, unsigned aovs);

#ifdef __cplusplus
}
#endif
#endif
