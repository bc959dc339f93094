#include "encode/video_codecs.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <libavutil/cpu.h>
#include <libavutil/opt.h>
#include <libavutil/pixdesc.h>

#include "base/text.h"

enum { LIST_MAX = 1024 };

/* Names for a message, and the one that may have been meant. */
typedef struct names {
    char list[LIST_MAX];
    zt_nearest nearest;
} names;

static void add_name(names *known, const char *name) {
    size_t length = strlen(known->list);
    snprintf(known->list + length, LIST_MAX - length, " %s", name);
    zt_nearest_try(&known->nearest, name);
}

/* "there is no preset "fsat" for h264; did you mean "fast"? There are ultrafast ..." */
static zt_status refuse_name(const zt_video_ear *ear, const char *what, const char *name,
                             const char *where, const names *known) {
    return zt_video_refuse(ear, ZT_EARGUMENT, "there is no %s \"%s\" for %s%s%s%s%s", what,
                           name, where, known->nearest.best ? "; did you mean \"" : "",
                           known->nearest.best ? known->nearest.best : "",
                           known->nearest.best ? "\"? There are" : "; there are", known->list);
}

static bool goes_into(const zt_codec *codec, const zt_container *container) {
    for (int i = 0; codec->endings[i]; i++)
        if (zt_text_equal(codec->endings[i], container->ending)) return true;
    return false;
}

static const AVCodec *encoder_of(const zt_codec *codec) {
    return avcodec_find_encoder_by_name(codec->encoder);
}

static zt_status refuse_container(const zt_codec *codec, const zt_video_choice *choice,
                                  const zt_video_ear *ear) {
    names known = {.nearest = zt_nearest_to("")};
    for (int i = 0; codec->endings[i]; i++) add_name(&known, codec->endings[i]);
    return zt_video_refuse(ear, ZT_EARGUMENT, "%s does not go into %s, but into%s", codec->name,
                           choice->container->ending, known.list);
}

static zt_status choose_codec(zt_video_choice *choice, const zt_video_ear *ear) {
    const char *wanted = zt_wish_value(choice->options, "codec");
    const char *name = wanted ? wanted : choice->container->codec;
    names known = {.nearest = zt_nearest_to(name)};
    for (int i = 0; zt_codecs[i].name; i++) {
        bool fits = goes_into(&zt_codecs[i], choice->container);
        if (encoder_of(&zt_codecs[i]) && fits) add_name(&known, zt_codecs[i].name);
        if (!zt_text_equal(zt_codecs[i].name, name)) continue;
        choice->codec = &zt_codecs[i];
        if (!fits) return refuse_container(&zt_codecs[i], choice, ear);
    }
    if (!choice->codec) {
        refuse_name(ear, "codec", name, choice->container->ending, &known);
        return ZT_EARGUMENT;
    }
    choice->encoder = encoder_of(choice->codec);
    if (choice->encoder) return ZT_OK;
    return zt_video_refuse(ear, ZT_EUNSUPPORTED,
                           "this FFmpeg has no %s, which %s needs; it can encode%s",
                           choice->codec->encoder, name, *known.list ? known.list : " nothing");
}

static bool has_alpha(enum AVPixelFormat pixels) {
    return av_pix_fmt_desc_get(pixels)->nb_components == 4;
}

static bool holds_alpha(const zt_video_choice *choice) {
    const char *not_in = choice->codec->opaque_in;
    return !not_in || !zt_text_equal(choice->container->ending, not_in);
}

/* The pixel format where none is asked for: of films with alpha the first one that has it, and
 * no fewer bits than the usual one. */
static const char *own_pixels(const zt_video_choice *choice, bool transparent) {
    const zt_codec *codec = choice->codec;
    const AVPixFmtDescriptor *usual = av_pix_fmt_desc_get(av_get_pix_fmt(codec->pixels[0]));
    for (const char *const *p = codec->pixels; transparent && holds_alpha(choice) && *p; p++) {
        enum AVPixelFormat pixels = av_get_pix_fmt(*p);
        if (has_alpha(pixels) &&
            av_pix_fmt_desc_get(pixels)->comp[0].depth >= usual->comp[0].depth)
            return *p;
    }
    return codec->pixels[0];
}

/* What becomes of the film's alpha, and of the one that was asked for. */
static zt_status check_alpha(const zt_video_choice *choice, bool transparent,
                             const zt_video_ear *ear) {
    const char *title = choice->codec->title, *ending = choice->container->ending;
    bool alpha = has_alpha(choice->pixels);
    if (alpha && !holds_alpha(choice))
        return zt_video_refuse(ear, ZT_EUNSUPPORTED, "%s has no place for the alpha of %s",
                               ending, title);
    if (transparent && !alpha)
        zt_tell(ear->listener, ZT_WARNING,
                "%s: %s without alpha: what is transparent becomes black", ear->target, title);
    return ZT_OK;
}

/* A format may be named without the "le" of its order of bytes, as FFmpeg has it. */
static zt_status choose_pixels(zt_video_choice *choice, bool transparent,
                               const zt_video_ear *ear) {
    const zt_codec *codec = choice->codec;
    const char *wanted = zt_wish_value(choice->options, "pixel-format");
    const char *name = wanted ? wanted : own_pixels(choice, transparent);
    choice->pixels = av_get_pix_fmt(name);
    names known = {.nearest = zt_nearest_to(name)};
    for (const char *const *p = codec->pixels; *p; p++) {
        if (choice->pixels != AV_PIX_FMT_NONE && av_get_pix_fmt(*p) == choice->pixels) {
            const zt_codec_store *stored = &codec->stored[p - codec->pixels];
            choice->stored = stored->codec ? stored : NULL;
            return check_alpha(choice, transparent, ear);
        }
        add_name(&known, *p);
    }
    return refuse_name(ear, "pixel format", name, codec->name, &known);
}

static zt_status choose_preset(zt_video_choice *choice, const zt_video_ear *ear) {
    const zt_codec *codec = choice->codec;
    const char *wanted = zt_wish_value(choice->options, "preset");
    if (wanted && !codec->presets)
        return zt_video_refuse(ear, ZT_EARGUMENT, "%s has no presets", codec->name);
    choice->preset = wanted ? wanted : codec->preset;
    if (!wanted) return ZT_OK;
    names known = {.nearest = zt_nearest_to(wanted)};
    for (const char *const *p = codec->presets; *p; p++) {
        if (zt_text_equal(*p, wanted)) return ZT_OK;
        add_name(&known, *p);
    }
    return refuse_name(ear, "preset", wanted, codec->name, &known);
}

static zt_status choose_crf(zt_video_choice *choice, const zt_video_ear *ear) {
    const zt_codec *codec = choice->codec;
    const char *wanted = zt_wish_value(choice->options, "crf");
    double number;
    choice->crf = wanted ? wanted : choice->bitrate ? NULL : codec->crf;
    if (!wanted) return ZT_OK;
    if (!codec->crf)
        return zt_video_refuse(ear, ZT_EARGUMENT, "%s has no crf: %s", codec->name,
                               codec->lossless ? "it loses nothing"
                                               : "how good it is follows from its profile");
    if (choice->bitrate)
        return zt_video_refuse(ear, ZT_EARGUMENT, "crf and bitrate do not go together");
    if (!zt_text_number(&number, wanted, wanted + strlen(wanted)) || number < 0 ||
        number > codec->crf_max)
        return zt_video_refuse(ear, ZT_EARGUMENT,
                               "crf %s: must be a number from 0 (best) to %d for %s", wanted,
                               codec->crf_max, codec->name);
    return ZT_OK;
}

/* "8M", "800k", "1500000": bits a second. */
static zt_status choose_bitrate(zt_video_choice *choice, const zt_video_ear *ear) {
    const char *wanted = zt_wish_value(choice->options, "bitrate");
    if (!wanted) return ZT_OK;
    if (!choice->codec->has_bitrate)
        return zt_video_refuse(ear, ZT_EARGUMENT, "%s takes no bitrate", choice->codec->name);
    const char *end = wanted + strlen(wanted);
    double factor = 1, number;
    if (end > wanted && (end[-1] == 'k' || end[-1] == 'M')) factor = *--end == 'k' ? 1e3 : 1e6;
    if (!zt_text_number(&number, wanted, end) || number * factor < 1000 ||
        number * factor > 2e9)
        return zt_video_refuse(ear, ZT_EARGUMENT,
                               "bitrate %s: must be bits a second, such as 8M or 800k, from 1k "
                               "to 2000M",
                               wanted);
    choice->bitrate = (int64_t)(number * factor);
    return ZT_OK;
}

static int multiple_of(int side, int step) { return side < step ? step : side / step * step; }

/* Formats that have one colour for several pixels need whole ones; encoders have a least size.
 */
static zt_status check_size(const zt_video_choice *choice, const zt_output_format *format,
                            const zt_video_ear *ear) {
    const zt_codec *codec = choice->codec;
    const AVPixFmtDescriptor *pixels = av_pix_fmt_desc_get(choice->pixels);
    int step_x = 1 << pixels->log2_chroma_w, step_y = 1 << pixels->log2_chroma_h;
    int width = multiple_of(format->width, step_x),
        height = multiple_of(format->height, step_y);
    if (format->width < codec->width_min || format->height < codec->height_min)
        return zt_video_refuse(
            ear, ZT_EARGUMENT, "%s has at least %dx%d pixels, and %dx%d is less", codec->name,
            codec->width_min, codec->height_min, format->width, format->height);
    if (width == format->width && height == format->height) return ZT_OK;
    return zt_video_refuse(ear, ZT_EARGUMENT,
                           "%s needs an even width%s, and %dx%d is not; %dx%d would be",
                           pixels->name, step_y > 1 ? " and height" : "", format->width,
                           format->height, width, height);
}

static zt_status check_rate(const zt_video_choice *choice, const zt_output_format *format,
                            const zt_video_ear *ear) {
    int max = choice->container->rate_max;
    if (!max || format->rate.num <= (int64_t)max * format->rate.den) return ZT_OK;
    return zt_video_refuse(ear, ZT_EARGUMENT,
                           "players show at most %d frames a second of a %s file, and this has "
                           "%d/%d",
                           max, choice->container->ending, format->rate.num, format->rate.den);
}

/* An encoder-option is "key=value". Returns its "="; NULL where that is missing. */
static const char *equals_of(const char *option) {
    const char *equals = strchr(option, '=');
    return equals && equals > option ? equals : NULL;
}

static void list_options(names *known, void *context) {
    const AVOption *o = NULL;
    while ((o = av_opt_next(context, o)))
        if (o->type != AV_OPT_TYPE_CONST && o->flags & AV_OPT_FLAG_ENCODING_PARAM &&
            o->flags & AV_OPT_FLAG_VIDEO_PARAM && !(o->flags & AV_OPT_FLAG_DEPRECATED))
            add_name(known, o->name);
}

static bool is_list(const char *name) { return zt_text_ends_with(name, "-params", false); }

/* What a row sets, on this machine. */
static char *own_value(const zt_codec *codec, const zt_codec_setting *s) {
    const char *more = av_get_cpu_flags() & AV_CPU_FLAG_AVX512 ? codec->avx512_params : NULL;
    return more && is_list(s->name) ? zt_text_print("%s:%s", s->value, more) : strdup(s->value);
}

/* A row's own setting of the same name stays in force where both are lists of parameters. */
static char *join_values(const zt_codec *codec, const char *name, const char *value) {
    const zt_codec_setting *s = codec->settings;
    while (s->name && !zt_text_equal(s->name, name)) s++;
    if (!s->name || !is_list(name)) return strdup(value);
    char *own = own_value(codec, s);
    char *joined = own ? zt_text_print("%s:%s", own, value) : NULL;
    free(own);
    return joined;
}

static zt_status apply_option(AVCodecContext *encoder, const zt_video_choice *choice,
                              const char *option, const zt_video_ear *ear) {
    const char *equals = equals_of(option);
    if (!equals)
        return zt_video_refuse(ear, ZT_EARGUMENT,
                               "encoder-option %s: must be a name and a value, such as "
                               "keyint_min=12",
                               option);
    char *name = strndup(option, (size_t)(equals - option));
    char *value = name ? join_values(choice->codec, name, equals + 1) : NULL;
    zt_status status = value ? ZT_OK : ZT_EMEMORY;
    if (value && av_opt_set(encoder, name, value, AV_OPT_SEARCH_CHILDREN) < 0) {
        status = ZT_EARGUMENT;
        names known = {.nearest = zt_nearest_to(name)};
        if (encoder->priv_data && choice->encoder->priv_class)
            list_options(&known, encoder->priv_data);
        const AVOption *found = av_opt_find(encoder, name, NULL, 0, AV_OPT_SEARCH_CHILDREN);
        if (found)
            zt_video_refuse(ear, status, "encoder-option %s: %s", option,
                            *zt_libav_complaint() ? zt_libav_complaint()
                                                  : "this value is not one of its own");
        else
            refuse_name(ear, "encoder-option", name, choice->codec->encoder, &known);
    }
    free(name);
    free(value);
    return status;
}

zt_status zt_video_configure(AVCodecContext *encoder, const zt_video_choice *choice,
                             const zt_video_ear *ear) {
    const zt_codec *codec = choice->codec;
    const char *pixels = av_get_pix_fmt_name(choice->pixels);
    encoder->thread_count = choice->thread_count;
    encoder->bit_rate = choice->bitrate;
    if (codec->tag && choice->container->has_boxes) encoder->codec_tag = codec->tag;
    for (const zt_codec_setting *s = codec->settings; s->name; s++) {
        if (s->pixels && !zt_text_equal(s->pixels, pixels)) continue;
        char *value = own_value(codec, s);
        if (!value) return ZT_EMEMORY;
        int error = av_opt_set(encoder, s->name, value, AV_OPT_SEARCH_CHILDREN);
        free(value);
        AV_TRY(ear, error);
    }
    if (choice->preset)
        AV_TRY(ear, av_opt_set(encoder, codec->preset_option, choice->preset,
                               AV_OPT_SEARCH_CHILDREN));
    if (choice->crf)
        AV_TRY(ear, av_opt_set(encoder, "crf", choice->crf, AV_OPT_SEARCH_CHILDREN));
    for (const zt_output_option *o = choice->options; o && o->name; o++)
        if (zt_text_equal(o->name, "encoder-option"))
            ZT_TRY(apply_option(encoder, choice, o->value, ear));
    return ZT_OK;
}

zt_status zt_video_choose(zt_video_choice *choice, const zt_output_format *format,
                          const zt_output_option *options, const zt_video_ear *ear) {
    *choice = (zt_video_choice){.options = options};
    for (int i = 0; zt_containers[i].ending; i++)
        if (zt_text_ends_with(ear->target, zt_containers[i].ending, true))
            choice->container = &zt_containers[i];
    if (!choice->container)
        return zt_video_refuse(ear, ZT_EUNSUPPORTED, "no movie has this ending");
    ZT_TRY(choose_codec(choice, ear));
    choice->thread_count = choice->codec->thread_count;
    if (choice->codec->threads_take_frames && format->frame_count > 0 &&
        format->frame_count < choice->thread_count)
        choice->thread_count = (int)format->frame_count;
    ZT_TRY(choose_pixels(choice, format->transparent, ear));
    ZT_TRY(choose_preset(choice, ear));
    ZT_TRY(choose_bitrate(choice, ear));
    ZT_TRY(choose_crf(choice, ear));
    ZT_TRY(check_rate(choice, format, ear));
    return check_size(choice, format, ear);
}

void zt_video_describe(char *text, size_t size, const zt_video_choice *choice) {
    char quality[48] = "", preset[48] = "";
    if (choice->crf) snprintf(quality, sizeof quality, ", crf %s", choice->crf);
    if (choice->bitrate)
        snprintf(quality, sizeof quality, ", %" PRId64 " bits a second", choice->bitrate);
    if (choice->preset) snprintf(preset, sizeof preset, ", preset %s", choice->preset);
    snprintf(text, size, "%s (%s), %s%s%s", choice->codec->title, choice->codec->encoder,
             av_get_pix_fmt_name(choice->pixels), quality, preset);
    for (const zt_output_option *o = choice->options; o && o->name; o++) {
        size_t length = strlen(text);
        if (zt_text_equal(o->name, "encoder-option"))
            snprintf(text + length, size - length, ", %s", o->value);
    }
}
