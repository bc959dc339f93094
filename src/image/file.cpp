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
#include "image/info.h"
}

namespace {

using Bytes = std::vector<unsigned char>;

const float half_max = 65504;

/* As Exif writes it. Without it, the hour of writing goes into the file, and the same picture
 * is not the same file. */
const char *const date_unknown = "    :  :     :  :  ";

const char *const software = "Zoetrope 0.1.0";

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

/* By the first of its endings. */
bool is_format(const zt_image_wishes *w, const char *ending) {
    return strcmp(w->format->endings[0], ending) == 0;
}

/* What is particular to a format. The names are OpenImageIO's. */
void add_particulars(OIIO::ImageSpec &spec, const zt_image_wishes *w) {
    if (w->compression) spec.attribute("compression", compression_of(w));
    if (is_format(w, ".tif")) {
        spec.attribute("compression", w->compression->name);
        spec.attribute("tiff:zipquality", w->level);
        spec.attribute("tiff:Predictor", spec.format == OIIO::TypeDesc::FLOAT ? 3 : 2);
        /* With Exif, OpenImageIO 2.4 leaves its block as the file's first directory, and no one
         * can read the picture. */
        spec.attribute("tiff:write_exif", 0);
    } else if (is_format(w, ".jpg")) {
        spec.attribute("jpeg:subsampling", "4:4:4");
    } else if (is_format(w, ".png")) {
        /* Differences to the left neighbour (8 is "none", 16 "sub"): a third of the time of
         * the default, for files that are a fifth larger. */
        spec.attribute("png:compressionLevel", w->level);
        spec.attribute("png:filter", 16);
    }
    if (is_format(w, ".exr") || is_format(w, ".tif") || is_format(w, ".dpx") ||
        is_format(w, ".hdr"))
        spec.attribute("DateTime", date_unknown);
}

/* Whether the image has an A that says something or was asked for, and the format a place for
 * it. */
bool needs_alpha(const zt_image *image, const zt_image_wishes *w) {
    size_t value_count = size_t(image->width) * size_t(image->height) * 4;
    if (image->transparent) return w->format->has_alpha;
    for (size_t i = 3; w->format->has_alpha && i < value_count; i += 4)
        if (image->pixels[i] != 1) return true;
    return false;
}

/* Whether colours are stored as they are where a pixel is covered, not multiplied by A. Formats
 * that say which of the two it is have it so for integers; DPX does not say, and shows the
 * picture over black. */
bool unassociated(const zt_image_wishes *w) {
    return w->depth < ZT_DEPTH_HALF && !is_format(w, ".dpx");
}

/* R G B, A where it says something, and in OpenEXR all further channels, as float. */
void add_channels(OIIO::ImageSpec &spec, const zt_image *image, const zt_image_wishes *w) {
    if (needs_alpha(image, w)) {
        spec.nchannels = 4;
        spec.alpha_channel = 3;
        spec.channelnames.push_back("A");
        if (unassociated(w)) spec.attribute("oiio:UnassociatedAlpha", 1);
    }
    if (!is_format(w, ".exr") || image->channel_count == 0) return;
    spec.channelformats.assign(size_t(spec.nchannels), spec.format);
    for (int c = 0; c < image->channel_count; c++) {
        spec.channelnames.push_back(image->channels[c].name);
        spec.channelformats.push_back(OIIO::TypeDesc::FLOAT);
    }
    spec.nchannels += image->channel_count;
}

void add_matrix(OIIO::ImageSpec &spec, const char *name, const double *matrix) {
    float values[16];
    bool some = false;
    for (int i = 0; i < 16; i++) {
        values[i] = float(matrix[i]);
        some |= matrix[i] != 0;
    }
    if (some) spec.attribute(name, OIIO::TypeMatrix, values);
}

/* By OpenEXR's standard names. */
void add_standard(OIIO::ImageSpec &spec, const zt_image_info &info) {
    const int rate[2] = {info.rate.num, info.rate.den};
    spec.attribute("framesPerSecond", OIIO::TypeRational, rate);
    add_matrix(spec, "worldToCamera", info.world_to_camera);
    add_matrix(spec, "worldToNDC", info.world_to_ndc);
    spec.attribute("PixelAspectRatio", 1.0f);
    spec.attribute("renderTime", float(info.render_s));
}

struct Texts {
    char *all[ZT_INFO_COUNT] = {};
    ~Texts() { zt_info_free(all); }
};

/* As texts, each by its name; in TIFF, which has no place for those, as its one description. */
zt_status add_texts(OIIO::ImageSpec &spec, const zt_image_info &info, bool one) {
    Texts texts;
    zt_status status = zt_info_print(texts.all, &info);
    if (status != ZT_OK) return status;
    for (int i = 0; i < ZT_INFO_COUNT && !one; i++)
        if (texts.all[i]) spec.attribute(zt_info_names[i], texts.all[i]);
    if (!one) return ZT_OK;
    std::unique_ptr<char, decltype(&free)> joined(zt_info_join(texts.all), free);
    if (joined) spec.attribute("ImageDescription", joined.get());
    return joined ? ZT_OK : ZT_EMEMORY;
}

zt_status add_info(OIIO::ImageSpec &spec, const zt_image *image, const zt_image_wishes *w) {
    bool tiff = is_format(w, ".tif");
    if (!image->info.known || !(is_format(w, ".exr") || is_format(w, ".png") || tiff))
        return ZT_OK;
    spec.attribute("Software", software);
    if (is_format(w, ".exr")) add_standard(spec, image->info);
    return add_texts(spec, image->info, tiff);
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
    add_channels(spec, image, w);
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

/* Colours divided by A, where there is any. */
std::vector<float> divided(const zt_image *image) {
    size_t value_count = size_t(image->width) * size_t(image->height) * 4;
    std::vector<float> pixels(image->pixels, image->pixels + value_count);
    for (size_t i = 0; i < value_count; i += 4)
        for (size_t c = 0; c < 3 && pixels[i + 3] > 0; c++) pixels[i + c] /= pixels[i + 3];
    return pixels;
}

/* Puts A behind each three developed values. It is a share, which no view changes. */
template <typename Value>
std::vector<Value> with_alpha(const std::vector<Value> &colours, const zt_image *image,
                              Value most) {
    std::vector<Value> values(colours.size() / 3 * 4);
    for (size_t i = 0; i < values.size(); i++) {
        float alpha = image->pixels[i]; /* where i % 4 is 3 */
        values[i] = i % 4 < 3      ? colours[i / 4 * 3 + i % 4]
                    : !(alpha > 0) ? Value(0)
                    : alpha >= 1   ? most
                                   : Value(double(alpha) * most + 0.5);
    }
    return values;
}

bool write_integers(OIIO::ImageOutput &output, const zt_image *given, zt_view view) {
    const OIIO::ImageSpec &spec = output.spec();
    zt_image image = *given;
    std::vector<float> pixels;
    bool alpha = spec.nchannels == 4;
    if (alpha && spec.get_int_attribute("oiio:UnassociatedAlpha")) {
        pixels = divided(given);
        image.pixels = pixels.data();
    }
    size_t row_values = size_t(image.width) * 3,
           value_count = size_t(image.height) * row_values;
    if (spec.format == OIIO::TypeDesc::UINT8) {
        std::vector<uint8_t> values(value_count);
        zt_develop_rgb8(values.data(), row_values, &image, view, 0, image.height);
        if (alpha) values = with_alpha<uint8_t>(values, given, 255);
        return output.write_image(spec.format, values.data());
    }
    std::vector<uint16_t> values(value_count);
    zt_develop_rgb16(values.data(), row_values * sizeof(uint16_t), &image, view, 0,
                     image.height);
    if (alpha) values = with_alpha<uint16_t>(values, given, 65535);
    int bits = spec.get_int_attribute("oiio:BitsPerSample", 16);
    if (bits < 16) round_bits(values, unsigned(bits));
    return output.write_image(spec.format, values.data());
}

/* Colours and channels, pixel by pixel, each in the type that it has in the file. */
bool write_layers(OIIO::ImageOutput &output, const zt_image *image,
                  const std::vector<float> &colours, size_t colour_count) {
    const OIIO::ImageSpec &spec = output.spec();
    size_t colour_bytes = colour_count * spec.format.size();
    size_t pixel_bytes = spec.pixel_bytes(true);
    std::vector<unsigned char> stored(colours.size() * spec.format.size());
    if (!OIIO::convert_pixel_values(OIIO::TypeDesc::FLOAT, colours.data(), spec.format,
                                    stored.data(), int(colours.size())))
        return false;
    size_t pixel_count = colours.size() / colour_count;
    std::vector<unsigned char> bytes(pixel_count * pixel_bytes);
    for (size_t i = 0; i < pixel_count; i++) {
        unsigned char *to = bytes.data() + i * pixel_bytes;
        memcpy(to, stored.data() + i * colour_bytes, colour_bytes);
        to += colour_bytes;
        for (int c = 0; c < image->channel_count; c++, to += sizeof(float))
            memcpy(to, image->channels[c].values + i, sizeof(float));
    }
    return output.write_image(OIIO::TypeDesc::UNKNOWN, bytes.data());
}

bool write_floats(OIIO::ImageOutput &output, const zt_image *image) {
    const OIIO::ImageSpec &spec = output.spec();
    float most = spec.format == OIIO::TypeDesc::HALF ? half_max : FLT_MAX;
    bool layers = !spec.channelformats.empty();
    size_t colour_count =
        size_t(spec.nchannels) - (layers ? size_t(image->channel_count) : size_t(0));
    std::vector<float> pixels(size_t(image->width) * size_t(image->height) * colour_count);
    for (size_t i = 0; i < pixels.size(); i++)
        pixels[i] =
            OIIO::clamp(image->pixels[i / colour_count * 4 + i % colour_count], -most, most);
    if (layers) return write_layers(output, image, pixels, colour_count);
    return output.write_image(OIIO::TypeDesc::FLOAT, pixels.data());
}

bool write_pixels(OIIO::ImageOutput &output, const zt_image *image, zt_view view) {
    bool integers = output.spec().format == OIIO::TypeDesc::UINT8 ||
                    output.spec().format == OIIO::TypeDesc::UINT16;
    return integers ? write_integers(output, image, view) : write_floats(output, image);
}

zt_status encode(zt_bytes *made, const zt_image *image, zt_view view,
                 const zt_image_wishes *wishes, const char *path, zt_listener listener) {
    Bytes bytes;
    OIIO::Filesystem::IOVecOutput memory(
        bytes); /* outlives `output`, which may write at its end */
    std::unique_ptr<OIIO::ImageOutput> output =
        OIIO::ImageOutput::create(wishes->format->endings[0] + 1);
    if (!output) return refuse(listener, "write", path, OIIO::geterror());
    OIIO::ImageSpec spec = spec_for(image, wishes);
    zt_status status = add_info(spec, image, wishes);
    if (status != ZT_OK) return status;
    if (!output->set_ioproxy(&memory) || !output->open(path, spec) ||
        !write_pixels(*output, image, view) || !output->close())
        return refuse(listener, "write", path, output->geterror());
    made->data = static_cast<unsigned char *>(malloc(bytes.size()));
    if (!made->data) return ZT_EMEMORY;
    memcpy(made->data, bytes.data(), bytes.size());
    made->size = bytes.size();
    return ZT_OK;
}

/* Spreads `channel_count` numbers a pixel over R G B A; `alpha` of them is A, if it is one. */
void spread(zt_image *image, const float *from, int channel_count, int alpha) {
    size_t pixel_count = size_t(image->width) * size_t(image->height);
    bool grey = channel_count < 3, has_alpha = alpha >= 0 && alpha < channel_count;
    for (size_t i = 0; i < pixel_count; i++, from += channel_count) {
        float *to = image->pixels + 4 * i;
        for (int c = 0; c < 3; c++) to[c] = from[grey ? 0 : c];
        to[3] = has_alpha ? from[alpha] : 1;
    }
}

/* What the file says it is of. */
zt_status read_info(zt_image *image, const OIIO::ImageSpec &spec) {
    Texts split;
    std::string texts[ZT_INFO_COUNT];
    const char *found[ZT_INFO_COUNT];
    std::string joined = spec.get_string_attribute("ImageDescription");
    zt_status status = zt_info_split(split.all, joined.c_str());
    if (status != ZT_OK) return status;
    for (int i = 0; i < ZT_INFO_COUNT; i++) {
        texts[i] = spec.get_string_attribute(zt_info_names[i]);
        found[i] = texts[i].empty() ? split.all[i] : texts[i].c_str();
    }
    return zt_info_read(image, found);
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
    spread(*image, values.data(), channel_count, spec.alpha_channel);
    status = read_info(*image, spec);
    if (status != ZT_OK) zt_image_free(image);
    return status;
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
