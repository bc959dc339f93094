/* What an image is of, as texts with names, for files that hold such: written and read again.
 */
#ifndef ZT_IMAGE_INFO_H
#define ZT_IMAGE_INFO_H

#include <zoetrope/image.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The least that must be read for an image to be known is what comes before the title. */
enum { ZT_INFO_COUNT = 9 };

/* "zoetrope:frame", and so on: rate, key, seed, title, description, view, settings,
 * background. */
extern const char *const zt_info_names[ZT_INFO_COUNT];

/* Makes the texts, of the caller to free; NULL of what is not known. ZT_EMEMORY; then there are
 * none. */
zt_status zt_info_print(char *texts[ZT_INFO_COUNT], const zt_image *image);

/* Fills the image's info, and whether it is transparent, from such texts, NULL where there is
 * none; it is not known where one that must be there is not, or makes no sense. ZT_EMEMORY. */
zt_status zt_info_read(zt_image *image, const char *const texts[ZT_INFO_COUNT]);

/* All in one text, of the caller to free: a line for each, "zoetrope:frame: 42"; lines after
 * the first of one text begin with a blank. NULL when out of memory. */
char *zt_info_join(char *const texts[ZT_INFO_COUNT]);

/* Takes such a text apart; whatever else stands in it is passed by. As from zt_info_print(). */
zt_status zt_info_split(char *texts[ZT_INFO_COUNT], const char *joined);

/* A copy of a text that goes when the image does; NULL when out of memory. */
const char *zt_image_own_text(zt_image *image, const char *text);

void zt_info_free(char *texts[ZT_INFO_COUNT]);

#ifdef __cplusplus
}
#endif
#endif
