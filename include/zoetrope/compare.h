/* How far a picture is from the one that it should be. */
#ifndef ZOETROPE_COMPARE_H
#define ZOETROPE_COMPARE_H

#include <zoetrope/image.h>
#include <zoetrope/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Of linear light, over R, G and B of all pixels; a pixel with a number that is not finite
 * counts as black. */
typedef struct zt_difference {
    double rmse;         /* the root of the mean squared difference */
    double relative_mse; /* the mean of (a - b)^2 / (b^2 + 0.01) for a against b (Rousselle,
                            Knaus and Zwicker, "Adaptive sampling and reconstruction using
                            greedy error minimization", 2011) */
    double p999; /* the largest difference of a pixel's three, but for the 0.1 % of the pixels
                    where it is larger still */
    double not_finite; /* the share of the pixels */
    /* Of what a display shows: 8 bits, by the view. */
    double psnr_db; /* over R, G and B; INFINITY where both are the same */
    double ssim;    /* structural similarity of luma (Wang, Bovik, Sheikh and Simoncelli, "Image
                       quality assessment", 2004): 1 where both are the same */
    double flip;    /* the mean of FLIP (Andersson et al., "FLIP: a difference evaluator for
                       alternating images", 2020): 0 where both are the same, at most 1 */
} zt_difference;

/* Compares two images of one size. ZT_EARGUMENT where their sizes differ, ZT_EMEMORY. */
zt_status zt_compare(zt_difference *difference, const zt_image *image,
                     const zt_image *reference, zt_view view);

/* The flicker of the noise alone: the RMSE of how the error changes from one image to the next,
 * so that what moves in the references does not count. All four of one size, and finite. */
double zt_compare_flicker(const zt_image *image, const zt_image *reference,
                          const zt_image *next_image, const zt_image *next_reference);

/* The root of the mean squared difference alone. Both of one size, and finite. */
double zt_compare_rmse(const zt_image *image, const zt_image *reference);

#ifdef __cplusplus
}
#endif
#endif
