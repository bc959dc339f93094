/* Image files become images. */
#include "image/file_door.h"

#include <memory>
#include <string.h>

#include <OpenImageIO/filesystem.h>

namespace {

using zt::refuse;
using zt::Texts;

const uint64_t read_values_max = uint64_t(1) << 30;

/* Fills R G B A from the first channels of each pixel, and returns how many of them are no
 * further ones. */
int spread(zt_image *image, const std::vector<float> &values, const OIIO::ImageSpec &spec) {
    const float *from = values.data();
    size_t pixel_count = size_t(image->width) * size_t(image->height);
    bool grey = spec.nchannels < 3, has_alpha = spec.alpha_channel >= 0;
    for (size_t i = 0; i < pixel_count; i++, from += spec.nchannels) {
        float *to = image->pixels + 4 * i;
        for (int c = 0; c < 3; c++) to[c] = from[grey ? 0 : c];
        to[3] = has_alpha ? from[spec.alpha_channel] : 1;
    }
    return spec.channelnames[0] != "R" ? 0 : spec.alpha_channel == 3 ? 4 : 3;
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

/* Adds the channel of a file's part as a further one. */
zt_status add_channel(zt_image *image, const std::vector<float> &values, int channel,
                      const OIIO::ImageSpec &spec) {
    if (image->channel_count == ZT_IMAGE_CHANNELS_MAX) return ZT_OK;
    const char *name = zt_image_own_text(image, spec.channelnames[size_t(channel)].c_str());
    zt_status status = name ? zt_image_add_channel(image, name) : ZT_EMEMORY;
    if (status != ZT_OK) return status;
    float *to = zt_image_channel(image, name);
    size_t stride = size_t(spec.nchannels), count = values.size() / stride;
    for (size_t i = 0; i < count; i++) to[i] = values[i * stride + size_t(channel)];
    return ZT_OK;
}

bool read_values(std::vector<float> &values, OIIO::ImageInput &input, int part) {
    const OIIO::ImageSpec spec = input.spec();
    values.resize(size_t(spec.image_pixels()) * size_t(spec.nchannels));
    return input.read_image(part, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, values.data());
}

/* Whether a part behind the first one is of the same picture: not another page, or eye. */
bool goes_along(const OIIO::ImageSpec &spec, const zt_image *image) {
    bool colours = false;
    for (const std::string &name : spec.channelnames) colours |= name == "R";
    return !colours && spec.width == image->width && spec.height == image->height &&
           spec.depth == 1 && spec.nchannels <= ZT_IMAGE_CHANNELS_MAX;
}

zt_status read_parts(zt_image *image, OIIO::ImageInput &input, const char *path,
                     zt_listener listener) {
    std::vector<float> values;
    const OIIO::ImageSpec first = input.spec();
    if (!read_values(values, input, 0)) return refuse(listener, "read", path, input.geterror());
    int colour_count = spread(image, values, first);
    zt_status status = read_info(image, first);
    bool exr = strcmp(input.format_name(), "openexr") == 0;
    for (int c = colour_count; status == ZT_OK && exr && c < first.nchannels; c++)
        status = add_channel(image, values, c, first);
    for (int part = 1; status == ZT_OK && exr && input.seek_subimage(part, 0); part++) {
        const OIIO::ImageSpec spec = input.spec();
        if (!goes_along(spec, image)) continue;
        if (!read_values(values, input, part))
            return refuse(listener, "read", path, input.geterror());
        for (int c = 0; status == ZT_OK && c < spec.nchannels; c++)
            status = add_channel(image, values, c, spec);
    }
    return status;
}

/* Opens the file; of `memory`, where that is given, by the path's ending. NULL, and why. */
std::unique_ptr<OIIO::ImageInput> open(std::string &why, const char *path,
                                       OIIO::Filesystem::IOProxy *memory) {
    OIIO::ImageSpec wishes, got;
    wishes.attribute("oiio:UnassociatedAlpha", 1); /* as they are stored */
    const char *dot = strrchr(path, '.');
    std::unique_ptr<OIIO::ImageInput> input =
        memory ? OIIO::ImageInput::create(dot ? dot + 1 : path, false, &wishes, memory)
               : OIIO::ImageInput::open(path, &wishes);
    if (!input) why = OIIO::geterror();
    if (!input || !memory || (input->set_ioproxy(memory) && input->open(path, got, wishes)))
        return input;
    why = input->geterror();
    return nullptr;
}

} // namespace

zt_status zt::read(zt_image **image, const char *path, const zt_bytes *bytes,
                   zt_listener listener) {
    stay_on_thread();
    std::string why;
    OIIO::Filesystem::IOMemReader memory(bytes ? bytes->data : nullptr,
                                         bytes ? bytes->size : 0);
    std::unique_ptr<OIIO::ImageInput> input = open(why, path, bytes ? &memory : nullptr);
    if (!input) return refuse(listener, "read", path, why);
    const OIIO::ImageSpec spec = input->spec();
    if (spec.depth > 1 || spec.nchannels < 1 || spec.image_pixels() > read_values_max / 4 ||
        uint64_t(spec.image_pixels()) * uint64_t(spec.nchannels) > read_values_max)
        return refuse(listener, "read", path, "not a picture of a size that can be read");
    zt_status status = zt_image_create(image, spec.width, spec.height);
    if (status == ZT_EARGUMENT) return refuse(listener, "read", path, "it is too large");
    if (status != ZT_OK) return status;
    (*image)->linear = spec.format.is_floating_point();
    status = read_parts(*image, *input, path, listener);
    if (status != ZT_OK) zt_image_free(image);
    return status;
}
