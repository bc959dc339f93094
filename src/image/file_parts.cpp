/* What OpenImageIO is told of a file: its type of numbers, channels, parts, and attributes. The
 * names are OpenImageIO's. */
#include "image/file_door.h"

#include <algorithm>
#include <memory>
#include <stdlib.h>
#include <string.h>

#include "image/layers.h"

namespace {

using zt::Part;
using zt::Texts;

/* As Exif writes it. Without it, the hour of writing goes into the file, and the same picture
 * is not the same file. */
const char *const date_unknown = "    :  :     :  :  ";

const char *const software = "Zoetrope 0.1.0";

/* The name of a compression, with its level as OpenImageIO takes it. */
std::string compression_of(const zt_image_wishes *w) {
    std::string name = w->compression->name;
    return w->compression->highest ? name + ":" + std::to_string(w->level) : name;
}

/* By the first of its endings. */
bool is_format(const zt_image_wishes *w, const char *ending) {
    return strcmp(w->format->endings[0], ending) == 0;
}

/* What is particular to a format. */
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
        /* Differences to the left neighbour (8 is "none", 16 "sub"), of which runs, or what
         * zlib finds. */
        bool runs = strcmp(w->compression->name, "rle") == 0;
        spec.attribute("compression", runs ? "rle" : "default");
        spec.attribute("png:compressionLevel", runs ? 1 : w->level);
        spec.attribute("png:filter", 16);
    }
    if (is_format(w, ".exr") || is_format(w, ".tif") || is_format(w, ".dpx") ||
        is_format(w, ".hdr"))
        spec.attribute("DateTime", date_unknown);
}

/* Whether A goes along: where it says something or was asked for, and the format has a place
 * for it; in OpenEXR always, as some programs take none for 0. */
bool needs_alpha(const zt_image *image, const zt_image_wishes *w) {
    size_t value_count = size_t(image->width) * size_t(image->height) * 4;
    if (image->transparent || is_format(w, ".exr")) return w->format->has_alpha;
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

void add_matrix(OIIO::ImageSpec &spec, const char *name, const double *matrix) {
    float values[16];
    bool some = false;
    for (int i = 0; i < 16; i++) {
        values[i] = float(matrix[i]);
        some |= matrix[i] != 0;
    }
    if (some) spec.attribute(name, OIIO::TypeMatrix, values);
}

/* Hours, minutes, seconds and frames in binary-coded decimals (SMPTE ST 12-1), for whole rates
 * that it counts, from 0 up to 24 hours. */
void add_timecode(OIIO::ImageSpec &spec, const zt_image_info &info) {
    const int64_t rate = info.rate.num, second = info.frame / rate;
    if (info.rate.den != 1 || rate > 30 || info.frame < 0 || second >= 24 * 3600) return;
    const int64_t fields[4] = {info.frame % rate, second % 60, second / 60 % 60, second / 3600};
    uint32_t code[2] = {0, 0};
    for (int i = 0; i < 4; i++)
        code[0] |= uint32_t(fields[i] / 10 << 4 | fields[i] % 10) << 8 * i;
    spec.attribute("smpte:TimeCode", OIIO::TypeTimeCode, code);
}

/* By OpenEXR's standard names. */
void add_standard(OIIO::ImageSpec &spec, const zt_image_info &info) {
    const int rate[2] = {info.rate.num, info.rate.den};
    spec.attribute("framesPerSecond", OIIO::TypeRational, rate);
    add_timecode(spec, info);
    add_matrix(spec, "worldToCamera", info.world_to_camera);
    add_matrix(spec, "worldToNDC", info.world_to_ndc);
    spec.attribute("renderTime", float(info.render_s));
}

/* What the header of DPX has a place for. */
void add_film(OIIO::ImageSpec &spec, const zt_image_info &info) {
    spec.attribute("dpx:FrameRate", float(info.rate.num) / float(info.rate.den));
    if (info.frame >= 0 && info.frame <= INT32_MAX)
        spec.attribute("dpx:FramePosition", int(info.frame));
    add_timecode(spec, info);
}

/* As texts, each by its name; in TIFF, which has no place for those, as its one description. */
zt_status add_texts(OIIO::ImageSpec &spec, const zt_image *image, bool one) {
    Texts texts;
    zt_status status = zt_info_print(texts.all, image);
    if (status != ZT_OK) return status;
    for (int i = 0; i < ZT_INFO_COUNT && !one; i++)
        if (texts.all[i]) spec.attribute(zt_info_names[i], texts.all[i]);
    if (!one) return ZT_OK;
    std::unique_ptr<char, decltype(&free)> joined(zt_info_join(texts.all), free);
    if (joined) spec.attribute("ImageDescription", joined.get());
    return joined ? ZT_OK : ZT_EMEMORY;
}

zt_status add_info(OIIO::ImageSpec &spec, const zt_image *image, const zt_image_wishes *w) {
    const zt_image_info &info = image->info;
    bool exr = is_format(w, ".exr"), tiff = is_format(w, ".tif"), dpx = is_format(w, ".dpx");
    if (!info.known || !(exr || tiff || dpx || is_format(w, ".png"))) return ZT_OK;
    spec.attribute("Software", software);
    if (exr) add_standard(spec, info);
    if (dpx) add_film(spec, info);
    return dpx ? ZT_OK : add_texts(spec, image, tiff);
}

/* All views make numbers that are meant for an sRGB display as they are; floats are linear, of
 * Rec. 709's primaries and white (ITU-R BT.709-6). */
void add_colour_space(OIIO::ImageSpec &spec, const zt_image_wishes *w) {
    static const float primaries[8] = {0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f};
    spec.attribute("oiio:ColorSpace", w->depth >= ZT_DEPTH_HALF ? "Linear" : "sRGB");
    if (!is_format(w, ".exr")) return;
    spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), primaries);
    spec.attribute("colorInteropID", "lin_rec709_scene");
    spec.attribute("PixelAspectRatio", 1.0f);
}

/* All but the channels. */
zt_status make_spec(OIIO::ImageSpec &spec, const zt_image *image, const zt_image_wishes *w) {
    static const OIIO::TypeDesc::BASETYPE types[ZT_DEPTH_COUNT] = {
        OIIO::TypeDesc::UINT8,  OIIO::TypeDesc::UINT16, OIIO::TypeDesc::UINT16,
        OIIO::TypeDesc::UINT16, OIIO::TypeDesc::HALF,   OIIO::TypeDesc::FLOAT};
    spec = OIIO::ImageSpec(image->width, image->height, 0, types[w->depth]);
    if (w->depth == ZT_DEPTH_10 || w->depth == ZT_DEPTH_12)
        spec.attribute("oiio:BitsPerSample", w->depth == ZT_DEPTH_10 ? 10 : 12);
    spec.tile_width = spec.tile_height = w->tile;
    spec.tile_depth = w->tile ? 1 : 0;
    add_colour_space(spec, w);
    add_particulars(spec, w);
    return add_info(spec, image, w);
}

void add_channel(Part &part, const char *name, OIIO::TypeDesc type) {
    part.spec.channelnames.push_back(name);
    part.spec.channelformats.push_back(type);
    part.spec.nchannels++;
}

void add_colours(Part &part, const zt_image *image, const zt_image_wishes *w) {
    static const char *const names[4] = {"R", "G", "B", "A"};
    part.colour_count = needs_alpha(image, w) ? 4 : 3;
    for (int c = 0; c < part.colour_count; c++) add_channel(part, names[c], part.spec.format);
    if (part.colour_count < 4) return;
    part.spec.alpha_channel = 3;
    if (unassociated(w)) part.spec.attribute("oiio:UnassociatedAlpha", 1);
}

/* The part of a layer: a new one, where each has its own. */
Part &part_of(std::vector<Part> &parts, const std::string &layer, const OIIO::ImageSpec &common,
              const zt_image_wishes *w) {
    for (Part &part : parts)
        if (!w->parts || part.spec.get_string_attribute("oiio:subimagename") == layer)
            return part;
    Part part;
    part.spec = common;
    if (w->parts) part.spec.attribute("oiio:subimagename", layer);
    parts.push_back(part);
    return parts.back();
}

} // namespace

/* Further channels are floats, whatever the colours are. */
zt_status zt::make_parts(std::vector<Part> &parts, const zt_image *image,
                         const zt_image_wishes *w) {
    OIIO::ImageSpec common;
    zt_status status = make_spec(common, image, w);
    if (status != ZT_OK) return status;
    if (!w->layer || strcmp(w->layer, ZT_LAYER_COLOURS) == 0)
        add_colours(part_of(parts, ZT_LAYER_COLOURS, common, w), image, w);
    for (int c = 0; c < image->channel_count && is_format(w, ".exr"); c++) {
        char layer[ZT_LAYER_NAME_MAX];
        zt_layer_of(layer, image->channels[c].name);
        if (w->layer && strcmp(w->layer, layer) != 0) continue;
        Part &part = part_of(parts, layer, common, w);
        add_channel(part, image->channels[c].name, OIIO::TypeDesc::FLOAT);
        part.channels.push_back(c);
    }
    for (Part &part : parts) { /* one type for all is told once */
        const std::vector<OIIO::TypeDesc> &types = part.spec.channelformats;
        if (std::count(types.begin(), types.end(), types[0]) != int64_t(types.size())) continue;
        part.spec.format = types[0];
        part.spec.channelformats.clear();
    }
    return ZT_OK;
}
