#include "cli/tables.h"

#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

/* A column of numbers: its name in both forms, and where it is in a rung. */
typedef struct column {
    const char *name;
    size_t offset;
} column;

static const column columns[] = {
    {"samples_a_pixel", offsetof(zt_rung, samples)},
    {"frame_s", offsetof(zt_rung, frame_s)},
    {"freeze_s", offsetof(zt_rung, stages.freeze_s)},
    {"prepare_s", offsetof(zt_rung, stages.prepare_s)},
    {"render_s", offsetof(zt_rung, stages.render_s)},
    {"write_s", offsetof(zt_rung, stages.write_s)},
    {"cpu_s", offsetof(zt_rung, cpu_s)},
    {"primary_rays", offsetof(zt_rung, primary_rays)},
    {"shadow_rays", offsetof(zt_rung, shadow_rays)},
    {"mirror_rays", offsetof(zt_rung, mirror_rays)},
    {"shadow_rays_avoided", offsetof(zt_rung, shadow_rays_avoided)},
    {"mirror_rays_avoided", offsetof(zt_rung, mirror_rays_avoided)},
    {"batches", offsetof(zt_rung, batches)},
    {"short_batches", offsetof(zt_rung, short_batches)},
    {"peak_bytes", offsetof(zt_rung, peak_bytes)},
    {"rmse", offsetof(zt_rung, error.rmse)},
    {"relative_mse", offsetof(zt_rung, error.relative_mse)},
    {"p99_9", offsetof(zt_rung, error.p999)},
    {"psnr_db", offsetof(zt_rung, error.psnr_db)},
    {"ssim", offsetof(zt_rung, error.ssim)},
    {"flip", offsetof(zt_rung, error.flip)},
    {"flicker", offsetof(zt_rung, flicker)},
    {"not_finite_share", offsetof(zt_rung, error.not_finite)},
    {"samples_left_out", offsetof(zt_rung, left_out)},
};
enum { COLUMN_COUNT = sizeof columns / sizeof *columns };

static double value_of(const zt_rung *rung, const column *c) {
    double value;
    memcpy(&value, (const char *)rung + c->offset, sizeof value);
    return value;
}

static const char *kind_name(const zt_rung *rung) {
    static const char *const names[ZT_RUNG_KIND_COUNT] = {
        [ZT_RUNG_SAMPLES] = "even", [ZT_RUNG_ADAPTIVE] = "adaptive", [ZT_RUNG_EDGES] = "edges"};
    return names[rung->kind];
}

void zt_table_csv(FILE *out, const zt_findings *f) {
    fputs("kind,min,max,target,filter,precision,reference_error,rmse_is_known", out);
    for (int k = 0; k < COLUMN_COUNT; k++) fprintf(out, ",%s", columns[k].name);
    fputs("\r\n", out);
    for (int i = 0; i < f->ladder->rung_count; i++) {
        const zt_rung *rung = &f->ladder->rungs[i];
        const zt_sampling *s = &rung->sampling;
        fprintf(out, "%s,%d,%d,%g,%s,%s,%.6g,%s", kind_name(rung), s->min, s->max, s->error,
                zt_filter_name(s->filter), zt_precision_name(rung->precision),
                f->ladder->references[rung->reference].error,
                zt_ladder_knows(f->ladder, rung) ? "yes" : "no");
        for (int k = 0; k < COLUMN_COUNT; k++) {
            double value = value_of(rung, &columns[k]);
            if (isfinite(value))
                fprintf(out, ",%.6g", value);
            else
                fputc(',', out);
        }
        fputs("\r\n", out);
    }
}

/* ---- JSON ----------------------------------------------------------------------------------
 */

static void print_number(FILE *out, double value) {
    if (isfinite(value))
        fprintf(out, "%.6g", value);
    else
        fputs("null", out);
}

static void print_text(FILE *out, const char *text) {
    fputc('"', out);
    for (; *text; text++) {
        unsigned char byte = (unsigned char)*text;
        if (byte == '"' || byte == '\\')
            fprintf(out, "\\%c", byte);
        else if (byte < ' ')
            fprintf(out, "\\u%04x", byte);
        else
            fputc(byte, out);
    }
    fputc('"', out);
}

static void print_rung(FILE *out, const zt_findings *f, const zt_rung *rung) {
    const zt_sampling *s = &rung->sampling;
    fprintf(out,
            "    { \"kind\": \"%s\", \"min\": %d, \"max\": %d, \"target\": %g, \"filter\": "
            "\"%s\", \"precision\": \"%s\", \"reference\": %d, \"rmse_is_known\": %s",
            kind_name(rung), s->min, s->max, s->error, zt_filter_name(s->filter),
            zt_precision_name(rung->precision), rung->reference,
            zt_ladder_knows(f->ladder, rung) ? "true" : "false");
    for (int k = 0; k < COLUMN_COUNT; k++) {
        fprintf(out, ", \"%s\": ", columns[k].name);
        print_number(out, value_of(rung, &columns[k]));
    }
    fputs(" }", out);
}

static void print_references(FILE *out, const zt_ladder *ladder) {
    fputs("  \"references\": [\n", out);
    for (int i = 0; i < ladder->reference_count; i++) {
        const zt_ladder_reference *r = &ladder->references[i];
        fprintf(out,
                "    { \"filter\": \"%s\", \"samples\": %d, \"error\": %.6g, \"frame_s\": "
                "%.6g }%s\n",
                zt_filter_name(r->filter), r->samples, r->error, r->frame_s,
                i + 1 < ladder->reference_count ? "," : "");
    }
    fputs("  ],\n", out);
}

static void print_advice(FILE *out, const zt_findings *f) {
    fputs("  \"advice\": [\n", out);
    for (int i = 0; i < ZT_ADVICE_COUNT; i++) {
        const zt_advice *a = &f->advice[i];
        fprintf(out, "    { \"rmse\": %g, \"rung\": ", a->rmse);
        if (a->rung < 0) {
            fputs("null", out);
        } else {
            const zt_rung *rung = &f->ladder->rungs[a->rung];
            fprintf(out, "%d, \"setting\": \"%s\", \"frame_s\": %.6g, \"film_s\": %.6g",
                    a->rung, zt_words_of_setting(rung).text, rung->frame_s,
                    zt_findings_film_s(f, rung));
        }
        fprintf(out, " }%s\n", i + 1 < ZT_ADVICE_COUNT ? "," : "");
    }
    fputs("  ],\n", out);
}

/* Which of them were needed. */
static void print_libraries(FILE *out) {
    zt_library libraries[ZT_LIBRARY_COUNT];
    zt_libraries(libraries);
    fputs("  \"libraries\": {", out);
    for (int i = 0; i < ZT_LIBRARY_COUNT; i++)
        fprintf(out, "%s\"%s\": \"%s\"", i ? ", " : " ", libraries[i].name,
                !libraries[i].built   ? "not built"
                : libraries[i].loaded ? "loaded"
                                      : "not loaded");
    fputs(" },\n", out);
}

void zt_table_json(FILE *out, const zt_findings *f) {
    const zt_ladder *ladder = f->ladder;
    fputs("{\n  \"zoetrope\": \"" ZT_VERSION "\",\n  \"file\": ", out);
    print_text(out, f->file);
    fputs(",\n  \"frames\": [", out);
    for (int i = 0; i < f->frame_count; i++)
        fprintf(out, "%s%" PRId64, i ? ", " : "", f->frames[i]);
    fprintf(out, "],\n  \"width\": %d,\n  \"height\": %d,\n  \"threads\": %d,\n", ladder->width,
            ladder->height, ladder->threads);
    fputs("  \"slope_of_rmse_by_time\": ", out);
    print_number(out, f->slope_time);
    fputs(",\n  \"slope_of_rmse_by_samples\": ", out);
    print_number(out, f->slope_samples);
    fputs(",\n  \"knee_rung\": ", out);
    print_number(out, f->knee < 0 ? (double)NAN : f->knee);
    fputs(",\n  \"precision\": ", out);
    print_text(out, ladder->precision);
    fputs(",\n  \"left_out\": [", out);
    for (int i = 0; i < ladder->left_out_count; i++) {
        if (i) fputs(", ", out);
        print_text(out, ladder->left_out[i]);
    }
    fputs("],\n", out);
    print_references(out, ladder);
    print_advice(out, f);
    print_libraries(out);
    fputs("  \"rungs\": [\n", out);
    for (int i = 0; i < ladder->rung_count; i++) {
        print_rung(out, f, &ladder->rungs[i]);
        fputs(i + 1 < ladder->rung_count ? ",\n" : "\n", out);
    }
    fputs("  ]\n}\n", out);
}
