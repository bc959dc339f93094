#include "cli/page.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "cli/page_style.h"
#include "cli/svg.h"

enum { ANY_LENGTH = 100000 };

typedef struct page {
    FILE *out;
    const zt_findings *f;
    const zt_ladder *ladder;
    const zt_pictures *pictures;
    const char *name;
} page;

/* Colours of the stages, in their order. */
static const char *const stage_hues[] = {"#e69f00", "#009e73", "#0072b2", "#b9c0c8"};
static const char *const stage_names[] = {"freeze", "prepare", "render", "write"};

static void words(const page *p, const char *text) { zt_svg_words(p->out, text, ANY_LENGTH); }

/* ---- head ----------------------------------------------------------------------------------
 */

/* What Linux calls the processor; "" elsewhere. */
static void read_processor(char text[96]) {
    FILE *file = fopen("/proc/cpuinfo", "r");
    char line[256];
    *text = '\0';
    while (!*text && file && fgets(line, sizeof line, file))
        sscanf(line, "model name : %95[^\n]", text);
    if (file) fclose(file);
}

static void print_head(const page *p) {
    char processor[96];
    read_processor(processor);
    fputs("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
          "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
          "<link rel=\"icon\" href=\"data:,\">\n<title>",
          p->out);
    words(p, p->f->file);
    fprintf(p->out,
            ": error against run time</title>\n<style>\n%s%s</style>\n</head>\n<body>\n",
            page_style, page_style_of_figures);
    fputs("<header>\n<h1>Error against run time</h1>\n<p class=\"soft\">", p->out);
    words(p, p->f->file);
    fprintf(p->out, " · frame%s ", p->f->frame_count > 1 ? "s" : "");
    for (int i = 0; i < p->f->frame_count; i++)
        fprintf(p->out, "%s%" PRId64, i ? ", " : "", p->f->frames[i]);
    if (p->ladder->frame_count > p->f->frame_count)
        fputs(p->f->frame_count > 1 ? ", each with its neighbour" : " and its neighbour",
              p->out);
    fprintf(p->out, " · %d × %d · %d thread%s", p->ladder->width, p->ladder->height,
            p->ladder->threads, p->ladder->threads == 1 ? "" : "s");
    if (*processor) fputs(" of ", p->out);
    words(p, processor);
    fputs("</p>\n</header>\n<main>\n", p->out);
}

/* ---- advice --------------------------------------------------------------------------------
 */

static void print_first_advice(const page *p) {
    const zt_findings *f = p->f;
    fputs("<section class=\"advice\" aria-label=\"Recommendation\">\n", p->out);
    if (f->best < 0) {
        fprintf(p->out,
                "<p class=\"first\">Nothing on this ladder is known to be as good as RMSE %g."
                "</p>\n<p class=\"soft\">Its largest rung takes %d samples; the reference is "
                "itself off by %.2g.</p>\n",
                f->advice[0].rmse, p->ladder->samples, p->ladder->references[0].error);
    } else {
        const zt_advice *a = &f->advice[f->best];
        const zt_rung *rung = &p->ladder->rungs[a->rung];
        int64_t frames = zt_animation_film(f->animation)->frame_count;
        fprintf(p->out, "<p class=\"first\">For RMSE ≤ %g use <b>%s</b>: %s a frame", a->rmse,
                zt_words_of_rung(rung).text, zt_words_of_time(rung->frame_s).text);
        if (frames > 1)
            fprintf(p->out, ", %s for the film",
                    zt_words_of_time(zt_findings_film_s(f, rung)).text);
        fprintf(p->out,
                ".</p>\n<p class=\"soft\">In the description: <code>film: { %s }</code>"
                "</p>\n",
                zt_words_of_setting(rung).text);
    }
    fputs("</section>\n", p->out);
}

static void print_advice(const page *p) {
    print_first_advice(p);
    int64_t frames = zt_animation_film(p->f->animation)->frame_count;
    fprintf(p->out,
            "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"What to use for "
            "each error\">\n<table>\n<caption>The quickest setting on the ladder for each "
            "error</caption>\n<thead><tr><th scope=\"col\">RMSE at most</th>"
            "<th scope=\"col\" class=\"left\">use</th><th scope=\"col\">a frame</th>"
            "<th scope=\"col\">the film<small>%" PRId64 " frame%s</small></th>"
            "<th scope=\"col\">its RMSE</th><th scope=\"col\">its FLIP</th></tr></thead>\n"
            "<tbody>\n",
            frames, frames == 1 ? "" : "s");
    for (int i = 0; i < ZT_ADVICE_COUNT; i++) {
        const zt_advice *a = &p->f->advice[i];
        if (a->rung < 0) {
            fprintf(p->out,
                    "<tr class=\"faint\"><th scope=\"row\">%g</th><td class=\"left\" "
                    "colspan=\"5\">not reached on this ladder</td></tr>\n",
                    a->rmse);
            continue;
        }
        const zt_rung *rung = &p->ladder->rungs[a->rung];
        fprintf(p->out,
                "<tr><th scope=\"row\">%g</th><td class=\"left\">%s</td><td>%s</td><td>%s</td>"
                "<td>%s</td><td>%.4f</td></tr>\n",
                a->rmse, zt_words_of_rung(rung).text, zt_words_of_time(rung->frame_s).text,
                zt_words_of_time(zt_findings_film_s(p->f, rung)).text,
                zt_words_of_error(p->f, rung).text, rung->error.flip);
    }
    fputs("</tbody>\n</table>\n</div>\n", p->out);
}

/* ---- chart ---------------------------------------------------------------------------------
 */

static void print_slopes(const page *p) {
    const zt_findings *f = p->f;
    if (!isfinite(f->slope_time)) {
        fputs("Too few rungs are known well enough for a slope. ", p->out);
        return;
    }
    const zt_rung *from = &p->ladder->rungs[f->first_fitted],
                  *to = &p->ladder->rungs[f->first_fitted + f->fitted_count - 1];
    fprintf(p->out,
            "From %d to %d samples the error falls with time to the power of <b>−%.2f</b>, and "
            "with the number of samples to the power of <b>−%.2f</b>; for independent random "
            "samples, white noise, both would be −0.5. Twice the time leaves %.0f %% of the "
            "error. ",
            from->sampling.max, to->sampling.max, -f->slope_time, -f->slope_samples,
            100 * pow(2, f->slope_time));
    if (f->knee >= 0)
        fprintf(p->out,
                "The knee is at <b>%s</b>: up to there more time buys more than later. ",
                zt_words_of_rung(&p->ladder->rungs[f->knee]).text);
    else
        fputs("The line has no knee: each doubling of the time buys about the same share. ",
              p->out);
}

static void print_chart(const page *p, const char *wide, const char *narrow) {
    fprintf(p->out,
            "<h2>The chart</h2>\n<figure class=\"chart\">\n"
            "<div class=\"wide\" role=\"img\" aria-label=\"Error against run time, both axes "
            "logarithmic; the tables below have its numbers\">\n%s</div>\n"
            "<div class=\"narrow\" role=\"img\" aria-label=\"Error against run time, both axes "
            "logarithmic; the tables below have its numbers\">\n%s</div>\n<figcaption>",
            wide, narrow);
    print_slopes(p);
    fputs("Points that are hollow are too near the reference's own error to be known.<br>The "
          "same as ",
          p->out);
    const char *const endings[] = {".svg", ".png", ".csv", ".json"};
    const char *const names[] = {"SVG", "PNG", "CSV", "JSON"};
    for (int i = 0; i < 4; i++) {
        fputs(i == 0 ? "<a href=\"" : i == 3 ? " and <a href=\"" : ", <a href=\"", p->out);
        for (const char *c = p->name; *c; c++)
            if (strchr("\"&<>%#?", *c) || (unsigned char)*c <= ' ')
                fprintf(p->out, "%%%02X", (unsigned char)*c);
            else
                fputc(*c, p->out);
        fprintf(p->out, "%s\">%s</a>", endings[i], names[i]);
    }
    fputs(".</figcaption>\n</figure>\n", p->out);
}

/* ---- pictures ------------------------------------------------------------------------------
 */

static const zt_rung *rung_of(const page *p, const zt_picture *picture) {
    const zt_sampling *s = &picture->rung.sampling;
    for (int i = 0; i < p->ladder->rung_count; i++) {
        const zt_rung *rung = &p->ladder->rungs[i];
        if (rung->kind == picture->rung.kind && rung->sampling.max == s->max &&
            rung->sampling.error == s->error && rung->reference == picture->rung.reference &&
            rung->other_precision == picture->rung.other_precision)
            return rung;
    }
    return &picture->rung;
}

static void print_image(const page *p, const char *png, const char *alt, const char *of) {
    fprintf(p->out, "<img width=\"%d\" height=\"%d\" alt=\"%s%s\" src=\"data:image/png;base64,",
            p->pictures->width, p->pictures->height, alt, of);
    fputs(png ? png : "", p->out);
    fputs("\">\n", p->out);
}

static void print_figure(const page *p, const zt_picture *picture) {
    const zt_rung *rung = rung_of(p, picture);
    zt_words name = zt_words_of_rung(rung);
    fprintf(p->out, "<figure data-name=\"%s\">\n", name.text);
    print_image(p, picture->png, "A piece of the frame: ", name.text);
    print_image(p, picture->map, "Where it is wrong: ", name.text);
    fprintf(p->out,
            "<figcaption><b>%s</b> · %s · RMSE %s · FLIP %.4f</figcaption>\n</figure>\n",
            name.text, zt_words_of_time(rung->frame_s).text, zt_words_of_error(p->f, rung).text,
            rung->error.flip);
}

static void print_whole(const page *p) {
    const zt_pictures *s = p->pictures;
    fputs("<h2>The pictures</h2>\n", p->out);
    fprintf(p->out,
            "<p>Frame %" PRId64 ": the piece of %d × %d pixels in which most is wrong with the "
            "fewest samples, each pixel as a square, and below it a map of the error.</p>\n",
            p->f->frames[0], s->width, s->height);
    fprintf(p->out,
            "<div class=\"whole\"><img width=\"%d\" height=\"%d\" alt=\"The whole frame, from "
            "the reference\" src=\"data:image/png;base64,",
            s->whole_width, s->whole_height);
    fputs(s->whole.png ? s->whole.png : "", p->out);
    fprintf(p->out,
            "\"><i style=\"left:%.2f%%;top:%.2f%%;width:%.2f%%;height:%.2f%%\"></i></div>\n",
            100.0 * s->x / s->frame_width, 100.0 * s->y / s->frame_height,
            100.0 * s->width / s->frame_width, 100.0 * s->height / s->frame_height);
    fputs("<div class=\"scale\">", p->out);
    fprintf(p->out, "error %g<span style=\"background:linear-gradient(90deg", zt_map_least);
    for (int i = 0; i < ZT_MAP_STOP_COUNT; i++) fprintf(p->out, ",%s", zt_map_stops[i]);
    fprintf(p->out, ")\"></span>%g, by its logarithm</div>\n", zt_map_most);
}

static void print_pictures(const page *p) {
    const zt_pictures *s = p->pictures;
    if (s->count == 0) return;
    print_whole(p);
    fputs("<div class=\"stage\" id=\"stage\"><div class=\"choices\" role=\"group\" "
          "aria-label=\"Which picture\"></div><div class=\"pair\"><img alt=\"\"><img alt=\"\">"
          "</div><p class=\"soft\" aria-live=\"polite\"></p></div>\n"
          "<div class=\"pictures\" id=\"pictures\">\n",
          p->out);
    for (int i = 0; i < s->count; i++) print_figure(p, &s->pictures[i]);
    fputs("<figure data-name=\"reference\">\n", p->out);
    print_image(p, s->reference.png, "A piece of the frame: ", "the reference");
    fprintf(p->out,
            "<figcaption><b>the reference</b> · %d samples · off by %.2g itself</figcaption>\n"
            "</figure>\n</div>\n",
            p->ladder->references[0].samples, p->ladder->references[0].error);
}

/* ---- tables --------------------------------------------------------------------------------
 */

static bool begins_kind(const zt_ladder *ladder, int i) {
    const zt_rung *a = &ladder->rungs[i], *b = a - 1;
    return i > 0 && (a->kind != b->kind || a->other_precision != b->other_precision ||
                     a->reference != b->reference);
}

/* The rows of a table begin with the setting. */
static void begin_row(const page *p, int i) {
    const zt_rung *rung = &p->ladder->rungs[i];
    const char *faint = zt_ladder_knows(p->ladder, rung) ? "" : " faint";
    fprintf(p->out, "<tr class=\"%s%s\"><th scope=\"row\">%s</th>",
            begins_kind(p->ladder, i) ? "kind" : "", faint, zt_words_of_rung(rung).text);
}

static void begin_table(const page *p, const char *label) {
    fprintf(p->out,
            "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"%s\">\n"
            "<table>\n<thead><tr><th scope=\"col\">setting</th>",
            label);
}

static void end_table(const page *p) { fputs("</tbody>\n</table>\n</div>\n", p->out); }

static void print_cost(const page *p, int i) {
    const zt_rung *rung = &p->ladder->rungs[i];
    const double times[] = {rung->stages.freeze_s, rung->stages.prepare_s,
                            rung->stages.render_s, rung->stages.write_s};
    double sum = times[0] + times[1] + times[2] + times[3];
    double rays = rung->primary_rays + rung->shadow_rays + rung->mirror_rays;
    begin_row(p, i);
    fprintf(p->out, "<td>%.3g</td><td><div class=\"bar\" aria-hidden=\"true\">", rung->samples);
    for (int s = 0; s < 4; s++)
        fprintf(p->out, "<i style=\"width:%.2f%%;background:%s\"></i>", 100 * times[s] / sum,
                stage_hues[s]);
    fputs("</div></td>", p->out);
    for (int s = 0; s < 4; s++) fprintf(p->out, "<td>%s</td>", zt_words_of_time(times[s]).text);
    fprintf(p->out, "<td>%s</td><td>%s</td><td>%.3g</td><td>%.3g</td><td>%s</td></tr>\n",
            zt_words_of_time(rung->frame_s).text, zt_words_of_time(rung->cpu_s).text,
            rays / 1e6, rays / rung->frame_s / 1e6, zt_words_of_bytes(rung->peak_bytes).text);
}

static void print_costs(const page *p) {
    fputs("<h2>Where the time goes</h2>\n<p class=\"key soft\">", p->out);
    for (int s = 0; s < 4; s++)
        fprintf(p->out, "<i style=\"background:%s\"></i>%s", stage_hues[s], stage_names[s]);
    fputs("</p>\n<p class=\"soft\">Writing, here a PNG file, goes on behind the rendering of "
          "the next frame, and is not in the time of a frame.</p>\n",
          p->out);
    begin_table(p, "What each rung costs");
    fputs("<th scope=\"col\">samples<small>a pixel</small></th>"
          "<th scope=\"col\" class=\"left\">stages</th>",
          p->out);
    for (int s = 0; s < 4; s++) fprintf(p->out, "<th scope=\"col\">%s</th>", stage_names[s]);
    fputs("<th scope=\"col\">time<small>a frame</small></th>"
          "<th scope=\"col\">CPU<small>all threads</small></th>"
          "<th scope=\"col\">rays<small>millions</small></th>"
          "<th scope=\"col\">rays<small>millions / s</small></th>"
          "<th scope=\"col\">memory<small>at its peak</small></th></tr></thead>\n<tbody>\n",
          p->out);
    for (int i = 0; i < p->ladder->rung_count; i++) print_cost(p, i);
    end_table(p);
}

static void print_error(const page *p, int i) {
    const zt_rung *rung = &p->ladder->rungs[i];
    begin_row(p, i);
    fprintf(p->out, "<td>%s</td><td>%s</td><td>%.2g</td><td>%.2g</td>",
            zt_words_of_time(rung->frame_s).text, zt_words_of_error(p->f, rung).text,
            rung->error.relative_mse, rung->error.p999);
    if (isfinite(rung->error.psnr_db))
        fprintf(p->out, "<td>%.1f</td>", rung->error.psnr_db);
    else
        fputs("<td>the same</td>", p->out);
    fprintf(p->out, "<td>%.5f</td><td>%.4f</td>", rung->error.ssim, rung->error.flip);
    if (isfinite(rung->flicker))
        fprintf(p->out, "<td>%.2g</td>", rung->flicker);
    else
        fputs("<td>one frame</td>", p->out);
    fprintf(p->out, "<td>%.3g %%</td></tr>\n", 100 * rung->error.not_finite);
}

static void print_errors(const page *p) {
    fputs("<h2>What is wrong</h2>\n", p->out);
    begin_table(p, "How far each rung is off");
    fputs("<th scope=\"col\">time<small>a frame</small></th><th scope=\"col\">RMSE</th>"
          "<th scope=\"col\">relative MSE</th>"
          "<th scope=\"col\">99.9 %<small>of pixels below</small></th>"
          "<th scope=\"col\">PSNR<small>dB</small></th><th scope=\"col\">SSIM</th>"
          "<th scope=\"col\">FLIP</th><th scope=\"col\">flicker</th>"
          "<th scope=\"col\">not finite</th></tr></thead>\n<tbody>\n",
          p->out);
    for (int i = 0; i < p->ladder->rung_count; i++) print_error(p, i);
    end_table(p);
}

/* ---- what else is to be said ---------------------------------------------------------------
 */

static void print_left_out(const page *p) {
    fputs("<h2>What was left out for this scene</h2>\n<p>Frame ", p->out);
    fprintf(p->out, "%" PRId64 ": ", p->f->frames[0]);
    words(p, p->ladder->precision);
    if (*p->ladder->motion) fputs(".<br>", p->out);
    words(p, p->ladder->motion);
    fputs(".</p>\n<ul>\n", p->out);
    for (int i = 0; i < p->ladder->left_out_count; i++)
        fprintf(p->out, "<li>%s</li>\n", p->ladder->left_out[i]);
    fputs("</ul>\n", p->out);
}

static void print_method(const page *p) {
    const zt_ladder *ladder = p->ladder;
    fputs("<h2>How it was measured</h2>\n", p->out);
    for (int i = 0; i < ladder->reference_count; i++)
        fprintf(
            p->out,
            "<p>The reference%s%s has %d samples a pixel in double precision, 16 times those "
            "of the largest rung, with seeds of its own; it took %s a frame. Its own error "
            "is estimated at <b>%.2g</b>, half of how far its two independent halves are "
            "apart. An error below 2.2 times that is not claimed, only bounded: ≤.</p>\n",
            i > 0 ? ", filter " : "", i > 0 ? zt_filter_name(ladder->references[i].filter) : "",
            ladder->references[i].samples, zt_words_of_time(ladder->references[i].frame_s).text,
            ladder->references[i].error);
    fputs(
        "<p>RMSE, relative MSE (with 0.01 added to the square of the reference) and the 99.9th "
        "percentile of the pixels' errors are of linear light, which is 1 where a display is "
        "white. PSNR, SSIM (Wang et al. 2004) and FLIP (Andersson et al. 2020) are of the 8 "
        "bits that a display shows; 0 of FLIP is the same, 1 as different as can be. Flicker "
        "is the RMSE of how the error changes from a frame to its neighbour, so that what "
        "moves does not count. Short frames are rendered several times, and the median "
        "counts. Time is that of freezing, preparing and rendering a frame, on the wall.</p>\n",
        p->out);
}

void zt_page_print(FILE *out, const zt_findings *findings, const zt_pictures *pictures,
                   const char *wide, const char *narrow, const char *name) {
    page p = {out, findings, findings->ladder, pictures, name};
    print_head(&p);
    print_advice(&p);
    print_chart(&p, wide, narrow);
    print_pictures(&p);
    print_costs(&p);
    print_errors(&p);
    print_left_out(&p);
    print_method(&p);
    fprintf(out,
            "</main>\n<footer>zoetrope %s</footer>\n<script>\n%s</script>\n</body>\n"
            "</html>\n",
            ZT_VERSION, page_script);
}
