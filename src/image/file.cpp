/* The door to OpenImageIO. The only C++ here: no exception leaves, nothing of it is seen
 * outside.
 *
 * Files are encoded in memory and written here: on a full disk OpenImageIO's PNG writer reports
 * success, and libjpeg prints and ends the process. */
#include "image/file.h"

#include <errno.h>
#include <memory>
#include <stdio.h>
#include <string.h>
#include <string>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/fmath.h>
#include <OpenImageIO/imageio.h>

extern "C" {
#include "base/diag.h"
#include "base/module.h"
#include "base/text.h"
#include "image/develop.h"
}

namespace {

using Bytes = std::vector<unsigned char>;

const float half_max = 65504;

/* As Exif writes it. Without it, the hour of writing goes into the file, and the same picture
 * is not the same file. */
const char *const date_unknown = "    :  :     :  :  ";

const OIIO::imagesize_t read_pixels_max = OIIO::imagesize_t(1) << 28;

zt_status refuse(zt_listener listener, const char *what, const char *path,
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

bool is_one_of(const std::string &ending, const char *a, const char *b) {
    return ending == a || ending == b;
}

/* What the ending asks for: type, compression, colour. The names are OpenImageIO's. */
OIIO::ImageSpec spec_for(const zt_image *image, const std::string &ending) {
    OIIO::ImageSpec spec(image->width, image->height, 3, OIIO::TypeDesc::UINT8);
    /* Both views make numbers that are meant for an sRGB display as they are. */
    spec.attribute("oiio:ColorSpace", "sRGB");
    if (ending == ".exr") {
        spec.set_format(OIIO::TypeDesc::HALF);
        spec.attribute("oiio:ColorSpace", "Linear");
        spec.attribute("compression", "zip");
        spec.attribute("DateTime", date_unknown);
    } else if (is_one_of(ending, ".tif", ".tiff")) {
        spec.set_format(OIIO::TypeDesc::UINT16);
        spec.attribute("compression", "zip");
        spec.attribute("tiff:zipquality", 4);
        spec.attribute("tiff:Predictor", 2); /* differences: a quarter of the size */
        /* With Exif, OpenImageIO 2.4 leaves its block as the file's first directory, and no one
         * can read the picture. */
        spec.attribute("tiff:write_exif", 0);
        spec.attribute("DateTime", date_unknown);
    } else if (is_one_of(ending, ".jpg", ".jpeg")) {
        spec.attribute("compression", "jpeg:95");
        spec.attribute("jpeg:subsampling", "4:4:4");
    } else {
        /* Differences to the left neighbour (8 is "none", 16 "sub"): a third of the time of
         * the default, for files that are a fifth larger. */
        spec.attribute("png:compressionLevel", 4);
        spec.attribute("png:filter", 16);
    }
    return spec;
}

bool write_pixels(OIIO::ImageOutput &output, const zt_image *image, zt_view view) {
    size_t row_count = size_t(image->height), row_values = size_t(image->width) * 3;
    OIIO::TypeDesc type = output.spec().format;
    if (type == OIIO::TypeDesc::UINT8) {
        std::vector<uint8_t> pixels(row_count * row_values);
        zt_develop_rgb8(pixels.data(), row_values, image, view, 0, image->height);
        return output.write_image(type, pixels.data());
    }
    if (type == OIIO::TypeDesc::UINT16) {
        std::vector<uint16_t> pixels(row_count * row_values);
        zt_develop_rgb16(pixels.data(), row_values * sizeof(uint16_t), image, view, 0,
                         image->height);
        return output.write_image(type, pixels.data());
    }
    std::vector<float> pixels(row_count * row_values);
    for (size_t i = 0; i < pixels.size(); i++)
        pixels[i] = OIIO::clamp(image->pixels[i / 3 * 4 + i % 3], -half_max, half_max);
    return output.write_image(OIIO::TypeDesc::FLOAT, pixels.data());
}

zt_status write_bytes(const Bytes &bytes, const char *path, zt_listener listener) {
    FILE *file = fopen(path, "wb");
    if (!file) return refuse(listener, "write", path, strerror(errno));
    bool good = fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
    int error = errno;
    if (fclose(file) != 0 && good) {
        good = false;
        error = errno;
    }
    return good ? ZT_OK : refuse(listener, "write", path, strerror(error));
}

zt_status write(const zt_image *image, zt_view view, const char *path, const char *name,
                zt_listener listener) {
    std::string ending;
    for (const char *const *known = zt_image_file_endings; *known; known++)
        if (zt_text_ends_with(name, *known, true)) ending = *known;
    if (ending.empty())
        return refuse(listener, "write", path, "no picture format has this name's ending");
    Bytes bytes;
    OIIO::Filesystem::IOVecOutput memory(
        bytes); /* outlives `output`, which may write at its end */
    std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(ending.substr(1));
    if (!output) return refuse(listener, "write", path, OIIO::geterror());
    if (!output->set_ioproxy(&memory) || !output->open(path, spec_for(image, ending)) ||
        !write_pixels(*output, image, view) || !output->close())
        return refuse(listener, "write", path, output->geterror());
    return write_bytes(bytes, path, listener);
}

/* Spreads `channel_count` numbers a pixel over R G B A. */
void spread(zt_image *image, const float *from, int channel_count) {
    size_t pixel_count = size_t(image->width) * size_t(image->height);
    bool grey = channel_count < 3, alpha = channel_count % 2 == 0;
    for (size_t i = 0; i < pixel_count; i++, from += channel_count) {
        float *to = image->pixels + 4 * i;
        for (int c = 0; c < 3; c++) to[c] = from[grey ? 0 : c];
        to[3] = alpha ? from[channel_count - 1] : 1;
    }
}

zt_status read(zt_image **image, const char *path, zt_listener listener) {
    OIIO::ImageSpec wishes;
    wishes.attribute("oiio:UnassociatedAlpha", 1); /* as they are stored */
    std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(path, &wishes);
    if (!input) return refuse(listener, "read", path, OIIO::geterror());
    const OIIO::ImageSpec spec = input->spec();
    if (spec.depth > 1 || spec.nchannels < 1 || spec.image_pixels() > read_pixels_max)
        return refuse(listener, "read", path, "not a picture of a size that can be read");
    int channel_count = spec.nchannels < 4 ? spec.nchannels : 4;
    std::vector<float> values(size_t(spec.image_pixels()) * size_t(channel_count));
    if (!input->read_image(0, 0, 0, channel_count, OIIO::TypeDesc::FLOAT, values.data()))
        return refuse(listener, "read", path, input->geterror());
    zt_status status = zt_image_create(image, spec.width, spec.height);
    if (status == ZT_EARGUMENT) return refuse(listener, "read", path, "it is too large");
    if (status != ZT_OK) return status;
    spread(*image, values.data(), channel_count);
    return ZT_OK;
}

zt_status write_guarded(const zt_image *image, zt_view view, const char *path, const char *name,
                        zt_listener listener) {
    return without_exceptions(listener, "write", path,
                              [&] { return write(image, view, path, name, listener); });
}

zt_status read_guarded(zt_image **image, const char *path, zt_listener listener) {
    return without_exceptions(listener, "read", path,
                              [&] { return read(image, path, listener); });
}

} // namespace

ZT_MODULE_DOOR(zt_image_file_door, image_file) = {write_guarded, read_guarded};
