/* The door to OpenImageIO: a module's table, and how images become files.
 *
 * Files are encoded in memory and not written here: on a full disk OpenImageIO's PNG writer
 * reports success, and libjpeg prints and ends the process. */
#include "image/file_door.h"

#include <algorithm>
#include <cfloat>
#include <memory>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/fmath.h>

extern "C" {
#include "base/module.h"
#include "image/develop.h"
}

namespace {

using zt::Part;
using Bytes = std::vector<unsigned char>;

const float half_max = 65504;

/* Rounds 16 bits to the nearest value of fewer, of which OpenImageIO takes the first ones. */
void round_bits(std::vector<uint16_t> &values, unsigned bits) {
    const uint32_t most = (1u << bits) - 1;
    for (uint16_t &value : values) {
        uint32_t code = (value * most + 32767) / 65535;
        value = uint16_t(code << (16 - bits) | code >> (2 * bits - 16));
    }
}

bool write_integers(OIIO::ImageOutput &output, const zt_image *image, zt_developing how) {
    const OIIO::ImageSpec &spec = output.spec();
    if (spec.nchannels == 4)
        how.alpha =
            spec.get_int_attribute("oiio:UnassociatedAlpha") ? ZT_ALPHA_DIVIDED : ZT_ALPHA_KEPT;
    size_t row_values = size_t(image->width) * size_t(spec.nchannels),
           value_count = size_t(image->height) * row_values;
    if (spec.format == OIIO::TypeDesc::UINT8) {
        std::vector<uint8_t> values(value_count);
        zt_develop_8(values.data(), row_values, image, &how, 0, image->height);
        return output.write_image(spec.format, values.data());
    }
    std::vector<uint16_t> values(value_count);
    zt_develop_16(values.data(), row_values * sizeof(uint16_t), image, &how, 0, image->height);
    int bits = spec.get_int_attribute("oiio:BitsPerSample", 16);
    if (bits < 16) round_bits(values, unsigned(bits));
    return output.write_image(spec.format, values.data());
}

/* Colours and channels, pixel by pixel, each in the type that it has in the file. */
bool write_floats(OIIO::ImageOutput &output, const zt_image *image, const Part &part) {
    const OIIO::ImageSpec &spec = part.spec;
    size_t colour_count = size_t(part.colour_count), pixel_bytes = spec.pixel_bytes(true),
           pixel_count = size_t(image->width) * size_t(image->height);
    OIIO::TypeDesc type = spec.channelformat(0);
    float most = type == OIIO::TypeDesc::HALF ? half_max : FLT_MAX;
    std::vector<float> colours(pixel_count * colour_count);
    float *colour = colours.data();
    for (const float *pixel = image->pixels; pixel < image->pixels + 4 * pixel_count;
         pixel += 4)
        for (size_t c = 0; c < colour_count; c++)
            *colour++ = OIIO::clamp(pixel[c], -most, most);
    if (part.channels.empty()) return output.write_image(OIIO::TypeDesc::FLOAT, colours.data());
    size_t colour_bytes = colour_count * type.size();
    Bytes stored(pixel_count * colour_bytes), bytes(pixel_count * pixel_bytes);
    if (!OIIO::convert_pixel_values(OIIO::TypeDesc::FLOAT, colours.data(), type, stored.data(),
                                    int(colours.size())))
        return false;
    for (size_t i = 0; i < pixel_count; i++) {
        unsigned char *to = bytes.data() + i * pixel_bytes;
        std::copy_n(stored.data() + i * colour_bytes, colour_bytes, to); /* may be of none */
        to += colour_bytes;
        for (int c : part.channels) {
            memcpy(to, image->channels[c].values + i, sizeof(float));
            to += sizeof(float);
        }
    }
    return output.write_image(OIIO::TypeDesc::UNKNOWN, bytes.data());
}

bool write_pixels(OIIO::ImageOutput &output, const zt_image *image, const zt_developing &how,
                  const Part &part) {
    bool integers =
        part.spec.format == OIIO::TypeDesc::UINT8 || part.spec.format == OIIO::TypeDesc::UINT16;
    return integers ? write_integers(output, image, how) : write_floats(output, image, part);
}

bool write_parts(OIIO::ImageOutput &output, const zt_image *image, const zt_developing &how,
                 const std::vector<Part> &parts, const char *path) {
    std::vector<OIIO::ImageSpec> specs;
    for (const Part &part : parts) specs.push_back(part.spec);
    if (!(specs.size() == 1 ? output.open(path, specs[0])
                            : output.open(path, int(specs.size()), specs.data())))
        return false;
    for (size_t p = 0; p < parts.size(); p++) {
        if (p > 0 && !output.open(path, specs[p], OIIO::ImageOutput::AppendSubimage))
            return false;
        if (!write_pixels(output, image, how, parts[p])) return false;
    }
    return output.close();
}

/* OpenImageIO 2.4 writes several parts only to what has a name: to a file in memory. */
bool write_named(Bytes &bytes, OIIO::ImageOutput &output, const zt_image *image,
                 const zt_developing &how, const std::vector<Part> &parts) {
    int file = memfd_create("parts", MFD_CLOEXEC);
    if (file < 0) return false;
    struct stat written;
    bool good = write_parts(output, image, how, parts,
                            ("/proc/self/fd/" + std::to_string(file)).c_str()) &&
                fstat(file, &written) == 0;
    if (good) bytes.resize(size_t(written.st_size));
    size_t done = 0;
    for (ssize_t count = 1; good && count > 0; done += size_t(count))
        count = std::max<ssize_t>(
            pread(file, bytes.data() + done, bytes.size() - done, off_t(done)), 0);
    close(file);
    return good && done == bytes.size();
}

zt_status encode(zt_bytes *made, const zt_image *image, zt_view view,
                 const zt_image_wishes *wishes, const char *path, zt_listener listener) {
    zt::stay_on_thread();
    std::vector<Part> parts;
    zt_status status = zt::make_parts(parts, image, wishes);
    if (status != ZT_OK) return status;
    const zt_developing how = {view, wishes->color, ZT_ALPHA_LEFT_OUT};
    Bytes bytes;
    OIIO::Filesystem::IOVecOutput memory(
        bytes); /* outlives `output`, which may write at its end */
    std::unique_ptr<OIIO::ImageOutput> output =
        OIIO::ImageOutput::create(wishes->format->endings[0] + 1);
    if (!output) return zt::refuse(listener, "write", path, OIIO::geterror());
    if (!(parts.size() > 1
              ? write_named(bytes, *output, image, how, parts)
              : output->set_ioproxy(&memory) && write_parts(*output, image, how, parts, path)))
        return zt::refuse(listener, "write", path, output->geterror());
    made->data = static_cast<unsigned char *>(malloc(bytes.size()));
    if (!made->data) return ZT_EMEMORY;
    memcpy(made->data, bytes.data(), bytes.size());
    made->size = bytes.size();
    return ZT_OK;
}

zt_status encode_guarded(zt_bytes *bytes, const zt_image *image, zt_view view,
                         const zt_image_wishes *wishes, const char *path,
                         zt_listener listener) {
    return zt::without_exceptions(listener, "write", path, [&] {
        return encode(bytes, image, view, wishes, path, listener);
    });
}

zt_status read_guarded(zt_image **image, const char *path, const zt_bytes *bytes,
                       zt_listener listener) {
    return zt::without_exceptions(listener, "read", path,
                                  [&] { return zt::read(image, path, bytes, listener); });
}

} // namespace

ZT_MODULE_DOOR(zt_image_file_door, image_file) = {encode_guarded, read_guarded, zt::open_color};
