/* Image files by any format that OpenImageIO knows. The door to it is a module (base/module.h):
 * OpenImageIO brings some 250 libraries, and films without image files do without them. */
#ifndef ZT_IMAGE_FILE_H
#define ZT_IMAGE_FILE_H

#include <stddef.h>

#include <zoetrope/image.h>
#include <zoetrope/status.h>

#include "image/formats.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Loads the module, if that has not been done: so that a missing one is told before there is
 * anything to write. ZT_EUNSUPPORTED after telling. */
zt_status zt_image_file_ready(zt_listener listener);

/* A file's contents, of the caller to free. */
typedef struct zt_bytes {
    unsigned char *data;
    size_t size;
} zt_bytes;

/* Makes of `image` a file in the format that is wished for, in memory: R, G and B, integers
 * developed by the view, floats of linear light (what a half float cannot hold becomes its
 * largest number). A goes along where it is not 1 everywhere and the format has a place for it;
 * then integers are not multiplied by it, but in DPX; floats are, as in the image. OpenEXR has
 * the image's further channels, too, as floats. What the image is of, where that is known, goes
 * to attributes of OpenEXR, texts of PNG and the description of TIFF. `path` is for messages.
 * ZT_EFILE after telling why. From any thread. */
zt_status zt_image_file_encode(zt_bytes *bytes, const zt_image *image, zt_view view,
                               const zt_image_wishes *wishes, const char *path,
                               zt_listener listener);

/* Writes bytes to a file. ZT_EFILE after telling why. */
zt_status zt_image_file_put(const zt_bytes *bytes, const char *path, zt_listener listener);

/* Both in one. */
zt_status zt_image_file_write(const zt_image *image, zt_view view,
                              const zt_image_wishes *wishes, const char *path,
                              zt_listener listener);

/* Reads any image file into floats as they are stored (integers to 0..1, no transfer function
 * undone, grey as R = G = B, A = 1 where the file has none), and what they say they are of. The
 * caller frees the image.
 * ZT_EFILE after telling why; pictures of more than 2^28 pixels are refused, whatever the file
 * claims. */
zt_status zt_image_file_read(zt_image **image, const char *path, zt_listener listener);

/* The same of a file that is in memory. `path` is for messages, and its ending says what the
 * bytes are. */
zt_status zt_image_file_decode(zt_image **image, const zt_bytes *bytes, const char *path,
                               zt_listener listener);

/* The module's table: what the functions above are made of. */
typedef struct zt_image_file_door {
    zt_status (*encode)(zt_bytes *bytes, const zt_image *image, zt_view view,
                        const zt_image_wishes *wishes, const char *path, zt_listener listener);
    zt_status (*read)(zt_image **image, const char *path, const zt_bytes *bytes,
                      zt_listener listener); /* of the bytes, where they are not NULL */
    zt_status (*open_color)(zt_color **color, const zt_color_wish *wish, zt_listener listener);
} zt_image_file_door;

#ifdef __cplusplus
}
#endif
#endif
