#include "tracer/accuracy.h"

#include <math.h>
#include <string.h>

#include <zoetrope/precision.h>

/* What may be seen of a thing's being off: an eighth of a pixel; and a sixty-fourth of the way
 * to a lamp, by which its light changes by a thirtieth. */
#define SEEN      (1.0 / 8)
#define SEEN_LAMP (1.0 / 64)

/* The sides of what is stretched, and of cones, are not told apart where it is thinner than so
 * many times what is wrong. */
#define THIN 64

/* What a precision holds. */
typedef struct digits {
    double wrong; /* a thing's place is known to within this share of the largest number in its
                     arithmetic: subtraction from the camera, intersection and projection
                     together stay below 16 roundings */
    double stretch;        /* what is stretched more has no digits left (tests/extremes) */
    double askew;          /* nor has what is more so: where a rounding becomes 1e-6; in double
                              precision nothing that was drawn came near to where it matters */
    double largest, least; /* squares of larger numbers, or of smaller ones, leave the range */
    int32_t mirrors; /* after so many the roundings of each add up to what one surface's are */
} digits;
#define WRONG (16 * 0x1p-24)
static const digits single_digits = {WRONG, 1e3, 0x1p24 * 1e-6, 1e15, 1e-15, 64},
                    double_digits = {16 * 0x1p-53, 1e12, INFINITY, 1e40, 1e-40, INT32_MAX};

/* Surfaces that are nearer to each other than what is wrong, and yet not the same as far as
 * double precision can tell. Looked for among so many at most. */
#define SAME 0x1p-44
enum { TWINS_MAX = 8192, SURFACES_MAX = 7, PAIRS_MAX = 20000 };

static zt_accuracy judge_one(const zt_extent *e, zt_pixel pixel, const digits *d) {
    double size = fmax(e->size, pixel.reach), near = fmax(e->near - pixel.reach, 0);
    double wrong = d->wrong * e->stretch * size, grain = near > 0 ? e->grain : 0;
    zt_accuracy a = {.object = e->object,
                     .other = -1,
                     .wrong = wrong + grain,
                     .seen = SEEN * (pixel.width + pixel.angle * near),
                     .distance = near,
                     .number = grain > wrong ? grain / ZT_GRAIN : size};
    if (!(e->stretch < d->stretch) || e->askew > d->askew) {
        a.reason = ZT_ACCURACY_STRETCH;
        a.number = e->stretch;
    } else if (!(size < d->largest) || e->least < d->least) {
        a.reason = ZT_ACCURACY_RANGE;
        a.number = e->least < d->least ? e->least : size;
    } else if (a.wrong > a.seen) {
        a.reason = near * 2 > a.number ? ZT_ACCURACY_NARROW : ZT_ACCURACY_NEAR;
    } else if (a.wrong > SEEN_LAMP * e->lamp) {
        a.reason = ZT_ACCURACY_LAMP;
        a.other = e->lamp_light;
        a.seen = SEEN_LAMP * e->lamp;
        a.distance = e->lamp;
    } else if (d->wrong * size * THIN > e->thin) {
        a.reason = ZT_ACCURACY_THIN;
        a.wrong = d->wrong * size;
        a.distance = 2 * e->thin;
        a.number = size;
    }
    return a;
}

static inline double larger(double a, double b) { return a > b ? a : b; }

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
} twin;

/* Where it stands in a line of those that are all flat, or all not: twins are neighbors. */
typedef struct place {
    double rank, size, low, high; /* the last two along x, as what is first told apart by */
    int32_t twin;
    bool perhaps; /* it may not be there */
} place;

typedef struct line {
    place *places;
    int32_t count;
} line;

struct zt_twins {
    twin *all;
    int32_t count;
    line lines[2];        /* of what is not flat; of what is */
    bool many, many_sure; /* too many to look for twins; also of those that are there for sure
                           */
};

static int face_count(const zt_extent *e) { return 2 * __builtin_popcount((unsigned)e->faces); }

/* Finds out how many there are, or that they are many. */
static int32_t count_surfaces(zt_twins *t, const zt_extent *extents, int32_t count) {
    int32_t all = 0, sure = 0;
    for (int32_t i = 0; i < count; i++) {
        t->many |= all > TWINS_MAX - SURFACES_MAX;
        t->many_sure |= sure > TWINS_MAX - SURFACES_MAX;
        if (t->many_sure) return 0;
        all += 1 + face_count(&extents[i]);
        sure += 1 + (extents[i].perhaps ? 0 : face_count(&extents[i]));
    }
    return t->many ? sure : all;
}

static void add_twin(zt_twins *t, twin it, bool perhaps) {
    line *l = &t->lines[it.flat];
    double rank = it.flat ? fabs(it.distance) : it.of->low.x + 0.0; /* no -0 */
    l->places[l->count++] =
        (place){rank, it.of->size, it.of->low.x, it.of->high.x, t->count, perhaps};
    t->all[t->count++] = it;
}

static void add_surfaces(zt_twins *t, const zt_extent *e) {
    add_twin(t, (twin){e, e->flat, e->normal, e->distance}, false);
    if (e->faces == 0 || (e->perhaps && t->many)) return;
    vec3 along[3];
    for (int i = 0; i < 3; i++) along[i] = vec3_normalize(e->ways[i]);
    for (int i = 0; i < 3; i++) {
        if (!(e->faces & 1 << i)) continue;
        vec3 normal = vec3_normalize(vec3_cross(along[(i + 1) % 3], along[(i + 2) % 3]));
        double middle = vec3_dot(normal, e->middle), way = vec3_dot(normal, e->ways[i]);
        for (int end = -1; end <= 1; end += 2)
            add_twin(t, (twin){e, true, normal, middle + end * way}, e->perhaps);
    }
}

/* Digits of a number's bits, turned so that they rise with it. */
enum { DIGIT_BITS = 11, DIGITS = 6, DIGIT_VALUES = 1 << DIGIT_BITS };
static inline uint32_t digit_of(double rank, int digit) {
    uint64_t bits;
    memcpy(&bits, &rank, sizeof bits);
    bits ^= bits >> 63 ? UINT64_MAX : UINT64_C(1) << 63;
    return (uint32_t)(bits >> digit * DIGIT_BITS) & (DIGIT_VALUES - 1);
}

/* By rising rank, those of equal rank in the order in which they were: by one digit after the
 * other, the last one first, in a tenth of the time that comparing takes. */
static void sort(line *l, place *spare) {
    for (int digit = 0; digit < DIGITS; digit++) {
        int32_t begin[DIGIT_VALUES + 1] = {0};
        for (int32_t i = 0; i < l->count; i++) begin[digit_of(l->places[i].rank, digit) + 1]++;
        for (int i = 0; i < DIGIT_VALUES; i++) begin[i + 1] += begin[i];
        for (int32_t i = 0; i < l->count; i++)
            spare[begin[digit_of(l->places[i].rank, digit)]++] = l->places[i];
        memcpy(l->places, spare, (size_t)l->count * sizeof *spare);
    }
}

zt_status zt_twins_make(zt_twins **out, const zt_extent *extents, int32_t count,
                        zt_arena *arena) {
    zt_twins *t = *out = ZT_PUSH(arena, zt_twins, 1);
    if (!t) return ZT_EMEMORY;
    size_t room = (size_t)count_surfaces(t, extents, count);
    if (t->many_sure) return ZT_OK;
    place *places = ZT_PUSH(arena, place, 3 * room);
    t->all = ZT_PUSH(arena, twin, room);
    if (!places || !t->all) return ZT_EMEMORY;
    for (size_t i = 0; i < 2; i++) t->lines[i].places = places + i * room;
    for (int32_t i = 0; i < count; i++) add_surfaces(t, &extents[i]);
    for (int i = 0; i < 2; i++) sort(&t->lines[i], places + 2 * room);
    return ZT_OK;
}

/* How far apart two surfaces that lie along each other are; infinite where they do not. */
static double apart(const twin *p, const twin *q, double size) {
    const zt_extent *a = p->of, *b = q->of;
    if (a == b || !boxes_meet(a, b, WRONG * size)) return INFINITY;
    if (p->flat) {
        double side = vec3_dot(p->normal, q->normal) < 0 ? -1 : 1;
        double turned = vec3_length(vec3_sub(p->normal, vec3_scale(q->normal, side)));
        double reach = fmin(size, single_digits.largest);
        return fabs(p->distance - side * q->distance) + turned * reach;
    }
    return fmax(vec3_max_abs(vec3_sub(a->low, b->low)),
                vec3_max_abs(vec3_sub(a->high, b->high)));
}

/* Looks for two surfaces that are as near to each other as `least` to `most` of their size;
 * where more pairs than PAIRS_MAX stand in line, as things on a floor do, says that there are
 * some only where `least` is 0. Then surfaces count that may not be there. */
static bool find_twins(const zt_extent **one, const zt_extent **other, double *gap,
                       const zt_twins *t, double least, double most) {
    bool perhaps = least == 0;
    int32_t pairs = 0;
    if (perhaps ? t->many : t->many_sure) return false;
    for (const line *l = t->lines; l < t->lines + 2; l++)
        for (const place *a = l->places; a < l->places + l->count; a++)
            for (const place *b = a + 1; b < l->places + l->count; b++) {
                if ((a->perhaps || b->perhaps) && !perhaps) continue;
                double size = larger(a->size, b->size);
                if (b->rank - a->rank > most * size) break;
                if (++pairs > PAIRS_MAX) return perhaps;
                double room = WRONG * size;
                if (a->low > b->high + room || b->low > a->high + room) continue;
                *gap = apart(&t->all[a->twin], &t->all[b->twin], size);
                *one = t->all[a->twin].of;
                *other = t->all[b->twin].of;
                if (*gap <= most * size && *gap >= least * size) return true;
            }
    return false;
}

bool zt_twins_within(const zt_twins *twins, double most) {
    const zt_extent *one, *other;
    double gap;
    return find_twins(&one, &other, &gap, twins, 0, most);
}

zt_accuracy zt_accuracy_judge(const zt_extents *extents, const zt_scene *scene, zt_pixel pixel,
                              zt_precision precision) {
    const bool single = precision == ZT_PRECISION_SINGLE;
    const digits *d = single ? &single_digits : &double_digits;
    bool mirrors = false;
    for (int32_t i = 0; i < scene->material_count; i++)
        mirrors |= scene->materials[i].reflectivity > 0;
    if (mirrors && scene->reflection_depth > d->mirrors)
        return (zt_accuracy){.reason = ZT_ACCURACY_MIRRORS, .object = -1, .other = -1};
    for (int32_t i = 0; i < extents->count; i++) {
        zt_accuracy a = judge_one(&extents->all[i], pixel, d);
        if (a.reason != ZT_ACCURACY_FINE) return a;
    }
    const zt_extent *one, *other;
    double gap;
    if (!single || !find_twins(&one, &other, &gap, extents->twins, SAME, WRONG))
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
