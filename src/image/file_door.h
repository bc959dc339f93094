/* What the files behind the door to OpenImageIO share; all C++ that there is. No exception
 * leaves, nothing of it is seen outside. */
#ifndef ZT_IMAGE_FILE_DOOR_H
#define ZT_IMAGE_FILE_DOOR_H

#include <stdexcept>
#include <string>
#include <vector>

#include <OpenImageIO/imageio.h>

#include "image/file.h"

extern "C" {
#include "base/diag.h"
#include "image/info.h"
}

namespace zt {

/* Tells that a file cannot be written or read. ZT_EFILE. */
inline zt_status refuse(zt_listener listener, const char *what, const char *path,
                        const std::string &why) {
    zt_tell(listener, ZT_ERROR, "cannot %s %s: %s", what, path,
            why.empty() ? "OpenImageIO does not say why" : why.c_str());
    return ZT_EFILE;
}

/* Runs `body`; what it throws becomes a status. */
template <typename Body>
zt_status without_exceptions(zt_listener listener, const char *what, const char *path,
                             Body body) {
    try {
        return body();
    } catch (const std::bad_alloc &) {
        return ZT_EMEMORY;
    } catch (const std::exception &e) {
        return refuse(listener, what, path, e.what());
    } catch (...) {
        return refuse(listener, what, path, "");
    }
}

/* Several images are made at a time: none is shared out among threads of OpenImageIO or of
 * OpenEXR; whose own, started by the first of several files at a time, may wait for ever. */
inline void stay_on_thread() {
    static const bool set = OIIO::attribute("threads", 1) && OIIO::attribute("exr_threads", -1);
    (void)set;
}

/* What an image is of, as texts. */
struct Texts {
    char *all[ZT_INFO_COUNT] = {};
    ~Texts() { zt_info_free(all); }
};

/* What of an image goes into one part of a file: its first colours, R G B A, and channels, by
 * their numbers. Files but OpenEXR have just one. */
struct Part {
    OIIO::ImageSpec spec;
    int colour_count = 0;
    std::vector<int> channels;
};

/* What OpenImageIO is told of the file that is wished for. ZT_EMEMORY. */
zt_status make_parts(std::vector<Part> &parts, const zt_image *image,
                     const zt_image_wishes *wishes);

/* Reads a file, or `bytes` where that is not NULL; see zt_image_file_read(). */
zt_status read(zt_image **image, const char *path, const zt_bytes *bytes, zt_listener listener);

/* zt_color_open() of what is wished for. No exception leaves it. */
zt_status open_color(zt_color **color, const zt_color_wish *wish, zt_listener listener);

} // namespace zt
#endif
