/* This side of the door to image files. */
#include "image/file.h"

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

zt_status zt_image_file_write(const zt_image *image, zt_view view,
                              const zt_image_wishes *wishes, const char *path,
                              zt_listener listener) {
    const zt_image_file_door *door;
    ZT_TRY(open_door(&door, listener));
    return door->write(image, view, wishes, path, listener);
}

zt_status zt_image_file_read(zt_image **image, const char *path, zt_listener listener) {
    const zt_image_file_door *door;
    *image = NULL;
    ZT_TRY(open_door(&door, listener));
    return door->read(image, path, listener);
}
