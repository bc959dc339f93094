/* The door to OpenImageIO. The only C++ here: no exception leaves, nothing of it is seen
 * outside.
 *
 * Files are encoded in memory and not written here: on a full disk OpenImageIO's PNG writer
 * reports success, and libjpeg prints and ends the process. */
#include "image/file.h"

#include <cfloat>
#include <memory>
#include <stdlib.h>
#include <string.h>
#include <string>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/fmath.h>
#include <OpenImageIO/imageio.h>

extern "C" {
#include "base/diag.h"
#include "base/module.h"
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

/* The name of a compression, with its level as OpenImageIO takes it. */
std::string compression_of(const zt_image_wishes *w) {
    std::string name = w->compression->name;
    return w->compression->highest ? name + ":" + std::to_string(w->level) : name;
}

/* What is particular to a format. The names are OpenImageIO's. */
void add_particulars(OIIO::ImageSpec &spec, const zt_image_wishes *w) {
    std::string format = w->format->endings[0];
    if (w->compression) spec.attribute("compression", compression_of(w));
    if (format == ".tif") {
        spec.attribute("compression", w->compression->name);
        spec.attribute("tiff:zipquality", w->level);
        spec.attribute("tiff:Predictor", spec.format == OIIO::TypeDesc::FLOAT ? 3 : 2);
        /* With Exif, OpenImageIO 2.4 leaves its block as the file's first directory, and no one
         * can read the picture. */
        spec.attribute("tiff:write_exif", 0);
    } else if (format == ".jpg") {
        spec.attribute("jpeg:subsampling", "4:4:4");
    } else if (format == ".png") {
        /* Differences to the left neighbour (8 is "none", 16 "sub"): a third of the time of
         * the default, for files that are a fifth larger. */
        spec.attribute("png:compressionLevel", w->level);
        spec.attribute("png:filter", 16);
    }
    if (format == ".exr" || format == ".tif" || format == ".dpx" || format == ".hdr")
        spec.attribute("DateTime", date_unknown);
}

OIIO::ImageSpec spec_for(const zt_image *image, const zt_image_wishes *w) {
    static const OIIO::TypeDesc::BASETYPE types[ZT_DEPTH_COUNT] = {
        OIIO::TypeDesc::UINT8,  OIIO::TypeDesc::UINT16, OIIO::TypeDesc::UINT16,
        OIIO::TypeDesc::UINT16, OIIO::TypeDesc::HALF,   OIIO::TypeDesc::FLOAT};
    OIIO::ImageSpec spec(image->width, image->height, 3, types[w->depth]);
    /* All views make numbers that are meant for an sRGB display as they are. */
    spec.attribute("oiio:ColorSpace", w->depth >= ZT_DEPTH_HALF ? "Linear" : "sRGB");
    if (w->depth == ZT_DEPTH_10 || w->depth == ZT_DEPTH_12)
        spec.attribute("oiio:BitsPerSample", w->depth == ZT_DEPTH_10 ? 10 : 12);
    spec.tile_width = spec.tile_height = w->tile;
    spec.tile_depth = w->tile ? 1 : 0;
    add_particulars(spec, w);
    return spec;
}

/* Rounds 16 bits to the nearest value of fewer, of which OpenImageIO takes the first ones. */
void round_bits(std::vector<uint16_t> &values, unsigned bits) {
    const uint32_t most = (1u << bits) - 1;
    for (uint16_t &value : values) {
        uint32_t code = (value * most + 32767) / 65535;
        value = uint16_t(code << (16 - bits) | code >> (2 * bits - 16));
    }
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
        int bits = output.spec().get_int_attribute("oiio:BitsPerSample", 16);
        if (bits < 16) round_bits(pixels, unsigned(bits));
        return output.write_image(type, pixels.data());
    }
    float most = type == OIIO::TypeDesc::HALF ? half_max : FLT_MAX;
    std::vector<float> pixels(row_count * row_values);
    for (size_t i = 0; i < pixels.size(); i++)
        pixels[i] = OIIO::clamp(image->pixels[i / 3 * 4 + i % 3], -most, most);
    return output.write_image(OIIO::TypeDesc::FLOAT, pixels.data());
}

zt_status encode(zt_bytes *made, const zt_image *image, zt_view view,
                 const zt_image_wishes *wishes, const char *path, zt_listener listener) {
    Bytes bytes;
    OIIO::Filesystem::IOVecOutput memory(
        bytes); /* outlives `output`, which may write at its end */
    std::unique_ptr<OIIO::ImageOutput> output =
        OIIO::ImageOutput::create(wishes->format->endings[0] + 1);
    if (!output) return refuse(listener, "write", path, OIIO::geterror());
    if (!output->set_ioproxy(&memory) || !output->open(path, spec_for(image, wishes)) ||
        !write_pixels(*output, image, view) || !output->close())
        return refuse(listener, "write", path, output->geterror());
    made->data = static_cast<unsigned char *>(malloc(bytes.size()));
    if (!made->data) return ZT_EMEMORY;
    memcpy(made->data, bytes.data(), bytes.size());
    made->size = bytes.size();
    return ZT_OK;
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

zt_status encode_guarded(zt_bytes *bytes, const zt_image *image, zt_view view,
                         const zt_image_wishes *wishes, const char *path,
                         zt_listener listener) {
    return without_exceptions(listener, "write", path, [&] {
        return encode(bytes, image, view, wishes, path, listener);
    });
}

zt_status read_guarded(zt_image **image, const char *path, zt_listener listener) {
    return without_exceptions(listener, "read", path,
                              [&] { return read(image, path, listener); });
}

} // namespace

ZT_MODULE_DOOR(zt_image_file_door, image_file) = {encode_guarded, read_guarded};
