/* This side of the door to OpenColorIO. */
#include "image/color.h"

#include "base/module.h"
#include "image/file.h"

zt_status zt_color_open(zt_color **color, const zt_color_wish *wish, zt_listener listener) {
    *color = NULL;
    if (!wish->wished) return ZT_OK;
    const zt_image_file_door *door =
        zt_module_door("image_file", "a view of OpenColorIO", listener);
    return door ? door->open_color(color, wish, listener) : ZT_EUNSUPPORTED;
}

void zt_color_close(zt_color **color) {
    if (*color) (*color)->close(*color);
    *color = NULL;
}
