/* This side of the door to image files. */
#include "image/file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/diag.h"
#include "base/module.h"

static zt_status open_door(const zt_image_file_door **door, zt_listener listener) {
    *door = zt_module_door("image_file", "image files", listener);
    return *door ? ZT_OK : ZT_EUNSUPPORTED;
}

zt_status zt_image_file_ready(zt_listener listener) {
    const zt_image_file_door *door;
    return open_door(&door, listener);
}

zt_status zt_image_file_encode(zt_bytes *bytes, const zt_image *image, zt_view view,
                               const zt_image_wishes *wishes, const char *path,
                               zt_listener listener) {
    const zt_image_file_door *door;
    *bytes = (zt_bytes){0};
    ZT_TRY(open_door(&door, listener));
    return door->encode(bytes, image, view, wishes, path, listener);
}

static zt_status refuse(const char *path, int error, zt_listener listener) {
    zt_tell(listener, ZT_ERROR, "cannot write %s: %s", path, strerror(error));
    return ZT_EFILE;
}

zt_status zt_image_file_put(const zt_bytes *bytes, const char *path, zt_listener listener) {
    FILE *file = fopen(path, "wb");
    if (!file) return refuse(path, errno, listener);
    bool good = fwrite(bytes->data, 1, bytes->size, file) == bytes->size;
    int error = errno;
    if (fclose(file) != 0 && good) {
        good = false;
        error = errno;
    }
    return good ? ZT_OK : refuse(path, error, listener);
}

zt_status zt_image_file_write(const zt_image *image, zt_view view,
                              const zt_image_wishes *wishes, const char *path,
                              zt_listener listener) {
    zt_bytes bytes;
    ZT_TRY(zt_image_file_encode(&bytes, image, view, wishes, path, listener));
    zt_status status = zt_image_file_put(&bytes, path, listener);
    free(bytes.data);
    return status;
}

zt_status zt_image_file_read(zt_image **image, const char *path, zt_listener listener) {
    const zt_image_file_door *door;
    *image = NULL;
    ZT_TRY(open_door(&door, listener));
    return door->read(image, path, NULL, listener);
}

zt_status zt_image_file_decode(zt_image **image, const zt_bytes *bytes, const char *path,
                               zt_listener listener) {
    const zt_image_file_door *door;
    *image = NULL;
    ZT_TRY(open_door(&door, listener));
    return door->read(image, path, bytes, listener);
}

zt_status zt_image_read(zt_image **image, const char *path, zt_listener listener) {
    return zt_image_file_read(image, path, listener);
}
