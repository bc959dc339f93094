#include "tracer/accuracy.h"

#include <math.h>
#include <stdlib.h>

#include <zoetrope/precision.h>

/* A thing's place is known to within this many roundings of single precision of the largest
 * number in its arithmetic: subtraction from the camera, intersection and projection together
 * stay below. */
#define WRONG (16 * 0x1p-24)

/* What may be seen of that: an eighth of a pixel; and a sixty-fourth of the way to a lamp, by
 * which its light changes by a thirtieth. */
#define SEEN      (1.0 / 8)
#define SEEN_LAMP (1.0 / 64)

/* Solids that are stretched more are not met to 1e-6 any more, as tests/extremes measures. */
#define STRETCH_MAX 1000

/* Squares of larger numbers, or of smaller ones, leave the range of single precision. */
#define LARGEST 1e15
#define LEAST   1e-15

/* After so many mirrors the roundings of each have added up to what one surface's are. */
enum { MIRRORS_MAX = 64 };

/* Surfaces that are nearer to each other than what is wrong, and yet not the same as far as
 * double precision can tell. Looked for among so many at most. */
#define SAME 0x1p-44
enum { TWINS_MAX = 8192, SURFACES_MAX = 7, PAIRS_MAX = 20000 };

static zt_accuracy judge_one(const zt_extent *e, zt_pixel pixel) {
    double size = fmax(e->size, pixel.reach), near = fmax(e->near - pixel.reach, 0);
    zt_accuracy a = {.object = e->object,
                     .other = -1,
                     .wrong = WRONG * e->stretch * size,
                     .seen = SEEN * (pixel.width + pixel.angle * near),
                     .distance = near,
                     .number = size};
    if (!(e->stretch < STRETCH_MAX)) {
        a.reason = ZT_ACCURACY_STRETCH;
        a.number = e->stretch;
    } else if (!(size < LARGEST) || e->least < LEAST) {
        a.reason = ZT_ACCURACY_RANGE;
        a.number = e->least < LEAST ? e->least : size;
    } else if (a.wrong > a.seen) {
        a.reason = near * 2 > size ? ZT_ACCURACY_NARROW : ZT_ACCURACY_NEAR;
    } else if (a.wrong > SEEN_LAMP * e->lamp) {
        a.reason = ZT_ACCURACY_LAMP;
        a.other = e->lamp_light;
        a.seen = SEEN_LAMP * e->lamp;
        a.distance = e->lamp;
    }
    return a;
}

static bool boxes_meet(const zt_extent *a, const zt_extent *b, double room) {
    return a->low.x <= b->high.x + room && b->low.x <= a->high.x + room &&
           a->low.y <= b->high.y + room && b->low.y <= a->high.y + room &&
           a->low.z <= b->high.z + room && b->low.z <= a->high.z + room;
}

/* A surface that may have a twin: something as a whole, or one flat face of it. */
typedef struct twin {
    const zt_extent *of;
    bool flat;
    vec3 normal; /* of what is flat, as is the next */
    double distance;
    double rank; /* in the order in which twins are neighbors */
} twin;

/* Writes the surfaces of something: as many as the result says. Faces that may not
 * be there count where `perhaps` says so. */
static int surfaces_of(twin *out, const zt_extent *e, bool perhaps) {
    int count = 1;
    *out = e->flat ? (twin){e, true, e->normal, e->distance, fabs(e->distance)}
                   : (twin){.of = e, .rank = e->low.x};
    for (int i = 0; i < 3; i++) {
        if (!(e->faces & 1 << i) || (e->perhaps && !perhaps)) continue;
        vec3 normal = vec3_normalize(vec3_cross(vec3_normalize(e->ways[(i + 1) % 3]),
                                                vec3_normalize(e->ways[(i + 2) % 3])));
        double middle = vec3_dot(normal, e->middle), way = vec3_dot(normal, e->ways[i]);
        for (int end = -1; end <= 1; end += 2) {
            double distance = middle + end * way;
            out[count++] = (twin){e, true, normal, distance, fabs(distance)};
        }
    }
    return count;
}

/* How far apart two surfaces that lie along each other are; infinite where they do not. */
static double apart(const twin *p, const twin *q) {
    const zt_extent *a = p->of, *b = q->of;
    if (a == b || p->flat != q->flat) return INFINITY;
    double room = WRONG * fmax(a->size, b->size);
    if (!boxes_meet(a, b, room)) return INFINITY;
    if (p->flat) {
        double side = vec3_dot(p->normal, q->normal) < 0 ? -1 : 1;
        double turned = vec3_length(vec3_sub(p->normal, vec3_scale(q->normal, side)));
        double reach = fmin(fmax(a->size, b->size), LARGEST);
        return fabs(p->distance - side * q->distance) + turned * reach;
    }
    return fmax(vec3_max_abs(vec3_sub(a->low, b->low)),
                vec3_max_abs(vec3_sub(a->high, b->high)));
}

static int by_rank(const void *pa, const void *pb) {
    const twin *a = pa, *b = pb;
    if (a->flat != b->flat) return a->flat - b->flat;
    if (a->rank != b->rank) return a->rank < b->rank ? -1 : 1;
    return a->of->object < b->of->object ? -1 : a->of->object > b->of->object;
}

/* Looks for two surfaces that are as near to each other as `least` to `most` of their size;
 * where more pairs than PAIRS_MAX stand in line, as things on a floor do, says that there are
 * some only where `least` is 0. */
static bool find_twins(const zt_extent **one, const zt_extent **other, double *gap,
                       const zt_extent *extents, int32_t count, double least, double most) {
    twin sorted[TWINS_MAX];
    int32_t all = 0, pairs = 0;
    for (int32_t i = 0; i < count; i++) {
        if (all > TWINS_MAX - SURFACES_MAX) return false;
        all += surfaces_of(&sorted[all], &extents[i], least == 0);
    }
    if (all < 2) return false;
    qsort(sorted, (size_t)all, sizeof *sorted, by_rank);
    for (int32_t i = 0; i < all; i++)
        for (int32_t j = i + 1; j < all; j++) {
            const twin *a = &sorted[i], *b = &sorted[j];
            double size = fmax(a->of->size, b->of->size);
            if (a->flat != b->flat || b->rank - a->rank > most * size) break;
            if (++pairs > PAIRS_MAX) return least == 0;
            *gap = apart(a, b);
            *one = a->of;
            *other = b->of;
            if (*gap <= most * size && *gap >= least * size) return true;
        }
    return false;
}

bool zt_accuracy_twins(const zt_extent *extents, int32_t count, double most) {
    const zt_extent *one, *other;
    double gap;
    return find_twins(&one, &other, &gap, extents, count, 0, most);
}

zt_accuracy zt_accuracy_judge(const zt_extent *extents, int32_t count, const zt_scene *scene,
                              zt_pixel pixel) {
    bool mirrors = false;
    for (int32_t i = 0; i < scene->material_count; i++)
        mirrors |= scene->materials[i].reflectivity > 0;
    if (mirrors && scene->reflection_depth > MIRRORS_MAX)
        return (zt_accuracy){.reason = ZT_ACCURACY_MIRRORS, .object = -1, .other = -1};
    for (int32_t i = 0; i < count; i++) {
        zt_accuracy a = judge_one(&extents[i], pixel);
        if (a.reason != ZT_ACCURACY_FINE) return a;
    }
    const zt_extent *one, *other;
    double gap;
    if (!find_twins(&one, &other, &gap, extents, count, SAME, WRONG))
        return (zt_accuracy){.object = -1, .other = -1};
    double size = fmax(one->size, other->size);
    return (zt_accuracy){
        ZT_ACCURACY_TWIN, one->object, other->object, WRONG * size, gap, gap, size};
}

const char *zt_precision_name(zt_precision precision) {
    static const char *const names[] = {[ZT_PRECISION_AUTO] = "auto",
                                        [ZT_PRECISION_SINGLE] = "single",
                                        [ZT_PRECISION_DOUBLE] = "double"};
    return names[precision];
}
