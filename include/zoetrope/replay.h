/* Replay: how the samples of one pixel come about, ray by ray. */
#ifndef ZOETROPE_REPLAY_H
#define ZOETROPE_REPLAY_H

#include <zoetrope/renderer.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What a lamp gives a point. */
typedef enum zt_replay_gift {
    ZT_GIFT_LIGHT,   /* it lights it */
    ZT_GIFT_HIDDEN,  /* something is in between */
    ZT_GIFT_BEHIND,  /* the surface looks the other way */
    ZT_GIFT_NOTHING, /* it has none to give, or none that shows on the material */
} zt_replay_gift;

/* A lamp, as the point where a ray ended sees it. Points and directions are in the world. */
typedef struct zt_replay_lamp {
    const char *name;
    zt_replay_gift gift;
    double point[3]; /* where on the lamp this sample looks for its light */
    /* Of what hides it: */
    const char *hider;
    int64_t hider_triangle; /* of a mesh, else -1 */
    double hider_distance;  /* from the point that is lit */
} zt_replay_lamp;

/* A ray of a sample's path. */
typedef struct zt_replay_ray {
    double origin[3], direction[3]; /* the direction is unit */
    const char *hit;                /* what it meets; NULL: nothing, and the rest is not set */
    int64_t triangle;               /* of a mesh, else -1 */
    double distance, point[3], normal[3]; /* the normal is unit, towards the ray */
    const zt_replay_lamp *lamps;          /* all but ambient lights */
    int lamp_count;
} zt_replay_ray;

typedef struct zt_replay_sample {
    int number;                /* -1: the one in the middle of its pixel */
    double place[2];           /* in the picture: pixels from its left and its top */
    double weight;             /* how it counts: 1, or -1 where the filter is negative */
    bool timed;                /* something moves while the shutter is open: */
    double time_s, opening;    /* when; and as a share of the opening */
    bool through_lens;         /* the lens has an opening: */
    double lens[2];            /* where in the unit square that stands for it */
    float light[3];            /* linear */
    const zt_replay_ray *rays; /* each is the mirror of the one before */
    int ray_count;
} zt_replay_sample;

/* Told of one sample after the other; all pointers are good during the call alone. */
typedef struct zt_replay {
    void (*sample)(void *user, const zt_replay_sample *sample);
    void *user;
} zt_replay;

typedef struct zt_replayed {
    int sample_count;
    double mean[3]; /* of the samples' light, weighted as rendering does */
    float pixel[3]; /* what rendering made of them */
} zt_replayed;

/* Renders a frame and then takes the samples of a pixel once more, by themselves and as
 * rendering did, to the last bit. ZT_EARGUMENT for a pixel that is not in the picture;
 * otherwise fails as rendering does. */
zt_status zt_renderer_replay(zt_replayed *result, zt_renderer *renderer, int64_t frame,
                             int column, int row, const zt_replay *replay,
                             const zt_watcher *watcher);

/* Takes one sample of a pixel alone, without rendering; any number that is not negative. */
zt_status zt_renderer_replay_sample(zt_renderer *renderer, int64_t frame, int column, int row,
                                    int number, const zt_replay *replay);

#ifdef __cplusplus
}
#endif
#endif
