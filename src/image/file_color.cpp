/* The door to OpenColorIO, as OpenImageIO has it. */
#include "image/file_door.h"

#include <cmath>
#include <cstdlib>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include <OpenImageIO/color.h>
#include <OpenImageIO/filesystem.h>

extern "C" {
#include "base/diag.h"
#include "base/hash.h"
#include "base/text.h"
}

namespace {

using Names = std::vector<std::string>;

struct Color : zt_color {
    OIIO::ColorProcessorHandle processor;
    std::string text;
};

zt_status refuse_config(zt_listener listener, const std::string &config,
                        const std::string &why) {
    zt_tell(listener, ZT_ERROR, "cannot use the colour configuration %s: %s", config.c_str(),
            why.empty() ? "OpenColorIO does not say why" : why.c_str());
    return ZT_EFILE;
}

/* Finds a name among those there are; the first of them is not always the usual one. */
zt_status choose(std::string &chosen, const char *wished, const char *usual, const Names &names,
                 const char *what, const std::string &of, zt_listener listener) {
    chosen = wished ? wished : usual ? usual : "";
    zt_nearest nearest = zt_nearest_to(chosen.c_str());
    std::string list;
    for (const std::string &name : names) {
        if (name == chosen) return ZT_OK;
        zt_nearest_try(&nearest, name.c_str());
        list += (list.empty() ? "" : ", ") + name;
    }
    std::string hint =
        nearest.best ? std::string("; did you mean \"") + nearest.best + "\"?" : ".";
    zt_tell(listener, ZT_ERROR, "the colour configuration has no %s \"%s\"%s%s There is: %s",
            what, chosen.c_str(), of.c_str(), hint.c_str(),
            list.empty() ? "none" : list.c_str());
    return ZT_EARGUMENT;
}

/* The space of linear Rec. 709 by the names that configurations give it; where none is known,
 * the one in which scenes are rendered. */
std::string space_of_light(const OIIO::ColorConfig &config) {
    static const char *const spaces[] = {
        "lin_rec709", "Linear Rec.709 (sRGB)",   "lin_rec709_scene",          "lin_rec709_srgb",
        "lin_srgb",   "Utility - Linear - sRGB", "Utility - Linear - Rec.709"};
    const Names names = config.getColorSpaceNames();
    for (const char *space : spaces)
        for (const std::string &name : names) {
            if (name == space) return name;
            for (const std::string &alias : config.getAliases(name))
                if (alias == space) return name;
        }
    return "scene_linear";
}

void apply(const zt_color *color, float *pixels, int count) {
    const OIIO::stride_t number = sizeof(float), pixel = 3 * number;
    static_cast<const Color *>(color)->processor->apply(pixels, count, 1, 3, number, pixel,
                                                        count * pixel);
}

void close(zt_color *color) { delete static_cast<Color *>(color); }

/* What becomes of colours all over the range: a lattice of them, and a ramp of greys. So
 * look-up tables in files of their own count, too. */
std::vector<float> samples_of(const zt_color *color) {
    enum { SIDE = 18, GREY_COUNT = 4096 };
    std::vector<float> samples;
    auto light = [](int step) { return step ? std::exp2(float(step) - 11) : 0.0f; };
    for (int i = 0; i < SIDE * SIDE * SIDE; i++)
        samples.insert(samples.end(),
                       {light(i % SIDE), light(i / SIDE % SIDE), light(i / SIDE / SIDE)});
    for (int i = 0; i < GREY_COUNT; i++)
        samples.insert(samples.end(), 3, std::exp2(float(i) / 256 - 10));
    color->apply(color, samples.data(), int(samples.size() / 3));
    return samples;
}

std::string hex_of(zt_hash hash) {
    char text[33];
    snprintf(text, sizeof text, "%016llx%016llx", (unsigned long long)hash.high,
             (unsigned long long)hash.low);
    return text;
}

zt_status open(zt_color **out, const zt_color_wish *wish, zt_listener listener) {
    const char *set = getenv("OCIO");
    std::string path = wish->config ? wish->config : set ? set : "", contents;
    if (path.empty()) {
        zt_tell(listener, ZT_ERROR,
                "no colour configuration: \"color\" names none, and $OCIO is not set");
        return ZT_EARGUMENT;
    }
    if (!OIIO::Filesystem::is_regular(path) ||
        !OIIO::Filesystem::read_text_file(path, contents))
        return refuse_config(listener, path, "the file cannot be read");
    OIIO::ColorConfig config(path);
    if (config.has_error()) return refuse_config(listener, path, config.geterror());
    std::string display, view;
    zt_status status = choose(display, wish->display, config.getDefaultDisplayName(),
                              config.getDisplayNames(), "display", "", listener);
    if (status == ZT_OK)
        status = choose(view, wish->view, config.getDefaultViewName(display),
                        config.getViewNames(display), "view",
                        " of the display \"" + display + "\"", listener);
    if (status != ZT_OK) return status;
    std::unique_ptr<Color> color(new Color);
    color->processor = config.createDisplayTransform(display, view, space_of_light(config));
    if (!color->processor) return refuse_config(listener, path, config.geterror());
    color->zt_color::apply = apply;
    color->zt_color::close = close;
    std::vector<float> samples = samples_of(color.get());
    color->text = "color " + hex_of(zt_hash_bytes(contents.data(), contents.size())) + " " +
                  hex_of(zt_hash_bytes(samples.data(), samples.size() * sizeof(float))) + " " +
                  display + ", " + view;
    color->manner = color->text.c_str();
    *out = color.release();
    return ZT_OK;
}

} // namespace

zt_status zt::open_color(zt_color **color, const zt_color_wish *wish, zt_listener listener) {
    const std::string what = wish->config ? wish->config : "$OCIO";
    try {
        return open(color, wish, listener);
    } catch (const std::bad_alloc &) {
        return ZT_EMEMORY;
    } catch (const std::exception &e) {
        return refuse_config(listener, what, e.what());
    } catch (...) {
        return refuse_config(listener, what, "");
    }
}
