/* A ladder of settings: frames rendered from coarse to fine against a reference, so that error
 * can be set against run time. */
#ifndef ZOETROPE_LADDER_H
#define ZOETROPE_LADDER_H

#include <zoetrope/compare.h>
#include <zoetrope/renderer.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum zt_rung_kind {
    ZT_RUNG_SAMPLES,  /* as many samples in each pixel */
    ZT_RUNG_ADAPTIVE, /* each pixel until its estimated error is below a target */
    ZT_RUNG_EDGES,    /* the same, but only where neighbours differ */
    ZT_RUNG_KIND_COUNT
} zt_rung_kind;

/* What each stage of a frame took, seconds of wall time; writing is that of a PNG file, and
 * goes on behind the rendering of the next frame. */
typedef struct zt_stage_times {
    double freeze_s, prepare_s, render_s, write_s;
} zt_stage_times;

/* One setting, and what it came to: means over all frames that were measured. */
typedef struct zt_rung {
    zt_rung_kind kind;
    zt_sampling sampling;
    zt_precision precision; /* that of its frames; of the last one where they differ */
    bool other_precision;   /* it was insisted on, and is not what the frames ask for */
    int reference;          /* which of the ladder's it is measured against */
    double samples;         /* a pixel, as they were taken */
    zt_stage_times stages;
    double frame_s; /* wall time of a frame: all stages but writing */
    double cpu_s;   /* of all threads, for a frame */
    double primary_rays, shadow_rays, mirror_rays;
    double shadow_rays_avoided, mirror_rays_avoided; /* as in zt_ray_stats */
    double batches, short_batches; /* as in zt_stats: bare and flat ones together */
    double peak_bytes;   /* the most memory of the process meanwhile, its largest value */
    double left_out;     /* samples of a frame that were not finite */
    zt_difference error; /* its rmse is the root of the mean square */
    double flicker;      /* as zt_compare_flicker; NAN where the film has a single frame */
} zt_rung;

/* What rungs are measured against: the mean of two halves with seeds of their own, each of half
 * the samples, in double precision. */
typedef struct zt_ladder_reference {
    zt_filter filter;
    int samples;    /* a pixel; 16 times those of the largest rung */
    double error;   /* its own RMSE, estimated: half of how far its two halves are apart */
    double frame_s; /* wall time of a frame */
} zt_ladder_reference;

enum { ZT_LEFT_OUT_MAX = 8, ZT_REFERENCES_MAX = ZT_FILTER_COUNT };

typedef struct zt_ladder {
    int width, height, threads;
    int samples;     /* a pixel, of the largest rung */
    int frame_count; /* that were rendered */
    zt_rung *rungs;  /* rung_count, kind by kind, the coarsest first */
    int rung_count;
    zt_ladder_reference
        references[ZT_REFERENCES_MAX]; /* the first is that of the film's own filter */
    int reference_count;
    char precision[320]; /* in which precision the first frame is rendered, and why */
    char motion[512];    /* how the shutter's opening is divided, and why; or "" */
    const char *left_out[ZT_LEFT_OUT_MAX]; /* what the first frame does without, in words */
    int left_out_count;
} zt_ladder;

typedef struct zt_ladder_settings {
    zt_render_settings render; /* samples: those of the largest rung; 0: 64 */
    const int64_t *frames;     /* frame_count, at least one; each is rendered with the next one,
                                  or, of the last of the film, the one before, for flicker */
    int frame_count;
    bool filters;         /* each filter too, and not the film's own alone */
    double frame_limit_s; /* no rung takes more samples than are rendered in so many seconds a
                             frame, as a few of them foretell; 0: no limit */
    /* Is shown the first frame of each rung, once it is measured; may be NULL. */
    void (*show)(void *user, const zt_rung *rung, const zt_image *image,
                 const zt_image *reference);
    void *user;
} zt_ladder_settings;

/* Renders and measures. The watcher's progress counts frames times samples a pixel. The caller
 * frees the ladder. Fails as rendering does. */
zt_status zt_ladder_climb(zt_ladder **ladder, const zt_animation *animation,
                          const zt_ladder_settings *settings, const zt_watcher *watcher,
                          zt_listener listener);
void zt_ladder_free(zt_ladder **ladder);

/* The exponent of y as a power of x: the slope of a straight line through the logarithms, by
 * least squares. NAN for fewer than two points. All positive. */
double zt_ladder_slope(const double *x, const double *y, int count);

/* Where y, falling, bends from steep to flat: the point furthest below the straight line from
 * the first to the last, in logarithms (Satopää, Albrecht, Irwin and Raghavan, "Finding a
 * 'kneedle' in a haystack", 2011); -1 where none is below by a tenth of a decade. x rises. */
int zt_ladder_knee(const double *x, const double *y, int count);

/* Whether a rung's error is known: it is well above its reference's own. */
bool zt_ladder_knows(const zt_ladder *ladder, const zt_rung *rung);

/* The rung of the film's own filter that takes the least time of those whose RMSE is known to
 * be no more than `rmse`; -1 where there is none, and where the reference is not that good. */
int zt_ladder_choose(const zt_ladder *ladder, double rmse);

#ifdef __cplusplus
}
#endif
#endif
