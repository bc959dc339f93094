/* Image files by any format that OpenImageIO knows. The door to OpenImageIO. */
#ifndef ZT_IMAGE_FILE_H
#define ZT_IMAGE_FILE_H

#include <stdbool.h>

#include <zoetrope/image.h>
#include <zoetrope/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Whether the ending of `path` names a format that can be written. */
bool zt_image_file_accepts(const char *path);

/* Writes `image` to `path` in the format that the ending of `name` asks for (the two differ while
 * a file is written aside): 8 bits developed by the view for PNG, JPEG and 8-bit formats, half
 * floats of linear light for EXR, 16 bits developed for TIFF. ZT_EFILE after telling why. */
zt_status zt_image_file_write(const zt_image *image, zt_view view, const char *path,
                              const char *name, zt_listener listener);

/* Reads any image file into floats as they are stored (integers to 0..1, no transfer function
 * undone). The caller frees the image. */
zt_status zt_image_file_read(zt_image **image, const char *path, zt_listener listener);

#ifdef __cplusplus
}
#endif
#endif
