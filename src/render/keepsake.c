#include "render/keepsake.h"

#include <stddef.h>
#include <string.h>

#include "base/hash.h"
#include "render/work.h"

static_assert(sizeof(zt_keepsake_head) == 136, "there are no bytes between fields");

enum { CHECKED = offsetof(zt_keepsake_head, checksum) + sizeof(zt_hash) };

/* Changes whenever bytes, or what footprints and outlines say, become others. */
static zt_hash version_of(const char *arithmetic) {
    const uint64_t numbers[] = {4,        ZT_PICTURE_PARTS,     ZT_FOOTPRINT_STEPS,
                                ZT_BATCH, sizeof(zt_footprint), sizeof(zt_outline)};
    const zt_hash parts[] = {zt_hash_bytes(numbers, sizeof numbers),
                             zt_hash_bytes(arithmetic, strlen(arithmetic))};
    return zt_hash_bytes(parts, sizeof parts);
}

/* ---- both ways ------------------------------------------------------------------------------
 * Each kind of thing has one function that says what it consists of; it is written or read. */

typedef struct stream {
    unsigned char *to;         /* NULL: it is read, */
    const unsigned char *from; /* from here */
    size_t left;               /* of what is read */
    bool lacking;              /* there was too little */
} stream;

static void pass(stream *s, void *bytes, size_t size) {
    if (s->to) {
        memcpy(s->to, bytes, size);
        s->to += size;
    } else if (size <= s->left) {
        memcpy(bytes, s->from, size);
        s->from += size;
        s->left -= size;
    } else {
        s->lacking = true;
    }
}

/* Truths are bits of a number. */
static void pass_flags(stream *s, bool *const *flags, int count) {
    uint32_t bits = 0;
    for (int i = 0; s->to && i < count; i++) bits |= (uint32_t)*flags[i] << i;
    pass(s, &bits, sizeof bits);
    for (int i = 0; !s->to && i < count; i++) *flags[i] = bits >> i & 1;
}
#define PASS_FLAGS(s, ...)                                                                     \
    pass_flags(s, (bool *const[]){__VA_ARGS__},                                                \
               (int)(sizeof((bool *const[]){__VA_ARGS__}) / sizeof(bool *)))

static void pass_step(stream *s, zt_footstep *step) {
    pass(s, &step->origins, sizeof step->origins);
    pass(s, &step->directions, sizeof step->directions);
    if (step->ends) pass(s, &step->points, sizeof step->points);
}

static void pass_footprint(stream *s, zt_footprint *f) {
    bool *flags[2 + 3 * ZT_FOOTPRINT_STEPS] = {&f->doubtful, &f->restless};
    for (int i = 0; i < ZT_FOOTPRINT_STEPS; i++) {
        flags[2 + 3 * i] = &f->steps[i].there;
        flags[3 + 3 * i] = &f->steps[i].ends;
        flags[4 + 3 * i] = &f->steps[i].leaves;
    }
    pass_flags(s, flags, 2 + 3 * ZT_FOOTPRINT_STEPS);
    pass(s, &f->met, sizeof f->met);
    pass(s, &f->faced, sizeof f->faced);
    pass(s, &f->lit, sizeof f->lit);
    for (int i = 0; i < ZT_FOOTPRINT_STEPS; i++)
        if (f->steps[i].there) pass_step(s, &f->steps[i]);
}

static void pass_thing(stream *s, zt_outline_thing *t) {
    PASS_FLAGS(s, &t->moves, &t->unbounded, &t->round);
    pass(s, &t->box, sizeof t->box);
    pass(s, &t->stretch, sizeof t->stretch);
    pass(s, &t->shape, sizeof t->shape);
    pass(s, &t->looks, sizeof t->looks);
}

static void pass_lamp(stream *s, zt_outline_lamp *l) {
    PASS_FLAGS(s, &l->drawn, &l->shadows);
    pass(s, &l->bounds, sizeof l->bounds);
    pass(s, &l->place, sizeof l->place);
    pass(s, &l->power, sizeof l->power);
}

static void pass_outline(stream *s, zt_outline *o) {
    PASS_FLAGS(s, &o->ambient_moves, &o->blind, &o->faint);
    pass(s, &o->ambient, sizeof o->ambient);
    pass(s, &o->rest, sizeof o->rest);
    pass(s, &o->order, sizeof o->order);
    pass(s, &o->brightest, sizeof o->brightest);
    for (int32_t i = 0; i < o->thing_count; i++) pass_thing(s, &o->things[i]);
    for (int32_t i = 0; i < o->lamp_count; i++) pass_lamp(s, &o->lamps[i]);
}

static size_t pixel_count(const zt_picture *p) { return (size_t)p->width * (size_t)p->height; }

static size_t footprint_count(const zt_picture *p) {
    return (size_t)zt_tile_count(p->width, p->height) * ZT_PICTURE_PARTS;
}

/* Those of pictures that cover all without their A, which is 1. */
static void pass_pixels(stream *s, zt_picture *p, bool opaque) {
    enum { COLOR = 3 * sizeof(float) };
    const size_t count = pixel_count(p);
    float *restrict pixels = p->pixels;
    if (!opaque) {
        pass(s, pixels, count * 4 * sizeof *pixels);
    } else if (s->to) {
        for (size_t i = 0; i < count; i++) memcpy(s->to + i * COLOR, pixels + 4 * i, COLOR);
        s->to += count * COLOR;
    } else if (s->left >= count * COLOR) {
        for (size_t i = 0; i < count; i++) {
            memcpy(pixels + 4 * i, s->from + i * COLOR, COLOR);
            pixels[4 * i + 3] = 1;
        }
        s->from += count * COLOR;
        s->left -= count * COLOR;
    } else {
        s->lacking = true;
    }
}

/* What is said of a round before it: that there is one; what of it is so. */
enum { THERE = 1, STRANGE = 2, COVERS = 4 };

/* More samples than this are none that anybody took. */
enum { TAKEN_MAX = 1 << 20 };

/* How many samples met something is 0 in all where nobody asked. */
static void pass_sum(stream *s, zt_canvas_sum *sum, bool covers) {
    pass(s, &sum->r, offsetof(zt_canvas_sum, a));
    if (covers)
        pass(s, &sum->a, sizeof sum->a);
    else
        sum->a = 0;
    pass(s, &sum->square, sizeof sum->square);
    pass(s, &sum->taken, sizeof sum->taken);
    s->lacking |= !s->to && (sum->taken < 0 || sum->taken > TAKEN_MAX);
}

static uint8_t say_round(const zt_rounds *r, uint32_t number) {
    if (!number) return 0;
    const zt_round *round = &r->rounds[number];
    const bool covers = round->sum.a != 0 || (r->negative && r->negative[number].a != 0);
    return (uint8_t)(THERE | (round->strange ? STRANGE : 0) | (covers ? COVERS : 0));
}

static void pass_round(stream *s, zt_rounds *r, uint32_t number, uint8_t what) {
    zt_round *round = &r->rounds[number];
    pass_sum(s, &round->sum, what & COVERS);
    if (r->negative) pass_sum(s, &r->negative[number], what & COVERS);
    pass(s, &round->error, sizeof round->error);
    pass(s, &round->step, sizeof round->step);
    round->strange = what & STRANGE;
}

/* The rounds of a pixel: those that are read get the next numbers. */
static void pass_rounds(stream *s, zt_rounds *r, uint32_t *next) {
    for (;; next = &r->rounds[*next].next) {
        uint8_t what = s->to ? say_round(r, *next) : 0;
        pass(s, &what, sizeof what);
        if (!s->to) {
            s->lacking |= what && r->count == r->room;
            *next = what && !s->lacking ? r->count++ : 0;
        }
        if (!*next) return;
        pass_round(s, r, *next, what);
    }
}

static void pass_edges(stream *s, zt_picture *p) {
    pass(s, p->paths, pixel_count(p) * sizeof *p->paths);
    for (size_t i = 0; i < pixel_count(p) && !s->lacking; i++)
        pass_rounds(s, &p->rounds, &p->rounds.first[i]);
}

static void pass_all(stream *s, zt_picture *p, bool opaque) {
    pass_outline(s, &p->outline);
    for (size_t i = 0; i < footprint_count(p) && !s->lacking; i++)
        pass_footprint(s, &p->footprints[i]);
    pass_pixels(s, p, opaque);
    if (p->at_edges) pass_edges(s, p);
}

/* ---- writing --------------------------------------------------------------------------------
 */

size_t zt_keepsake_room(const zt_picture *p) {
    const size_t of_pixel = p->at_edges ? sizeof *p->paths + 1 : 0;
    const size_t of_round =
        1 + sizeof(zt_round) + (p->rounds.negative ? sizeof(zt_canvas_sum) : 0);
    return sizeof(zt_keepsake_head) + sizeof p->outline +
           (size_t)p->outline.thing_count * sizeof *p->outline.things +
           (size_t)p->outline.lamp_count * sizeof *p->outline.lamps +
           footprint_count(p) * sizeof *p->footprints +
           pixel_count(p) * (4 * sizeof(float) + of_pixel) +
           (p->at_edges ? zt_rounds_count(&p->rounds) * of_round : 0);
}

static bool is_opaque(const zt_picture *p) {
    size_t i = 0;
    while (i < pixel_count(p) && p->pixels[4 * i + 3] == 1) i++;
    return i == pixel_count(p);
}

void zt_keepsake_write(unsigned char *bytes, zt_keepsake_head *head, const zt_picture *picture,
                       const char *arithmetic) {
    zt_picture p = *picture; /* nothing in it changes */
    stream s = {.to = bytes + sizeof *head};
    head->version = version_of(arithmetic);
    head->checksum = (zt_hash){0, 0};
    head->view = p.view;
    head->frame_key = p.frame_key;
    head->width = p.width;
    head->height = p.height;
    head->thing_count = p.outline.thing_count;
    head->lamp_count = p.outline.lamp_count;
    head->opaque = is_opaque(&p);
    head->at_edges = p.at_edges;
    head->is_signed = p.at_edges && p.rounds.negative;
    head->round_count = p.at_edges ? zt_rounds_count(&p.rounds) : 0;
    pass_all(&s, &p, head->opaque);
    head->size = (uint64_t)(s.to - bytes);
    memcpy(bytes, head, sizeof *head);
}

void zt_keepsake_seal(unsigned char *bytes) {
    zt_keepsake_head head;
    memcpy(&head, bytes, sizeof head);
    head.checksum = zt_hash_bytes(bytes + CHECKED, (size_t)head.size - CHECKED);
    memcpy(bytes, &head, sizeof head);
}

/* ---- reading --------------------------------------------------------------------------------
 */

/* What is said of sizes is no more than there are bytes: as many of each as each takes at
 * least.
 */
bool zt_keepsake_knows(const zt_keepsake_head *h, uint64_t size, const char *arithmetic) {
    enum { LEAST = 60, LEAST_ROUND = 45, SIDE_MAX = ZT_IMAGE_SIDE_MAX };
    if (!zt_hash_equal(h->version, version_of(arithmetic)) || h->size != size) return false;
    if (h->width < 1 || h->height < 1 || h->width > SIDE_MAX || h->height > SIDE_MAX)
        return false;
    uint64_t pixels = (uint64_t)h->width * (uint64_t)h->height;
    return h->thing_count >= 0 && h->lamp_count >= 0 && h->opaque <= 1 && h->at_edges <= 1 &&
           h->is_signed <= 1 && h->round_count <= size / LEAST_ROUND &&
           (uint64_t)h->thing_count <= size / LEAST &&
           (uint64_t)h->lamp_count <= size / LEAST && pixels <= size / (3 * sizeof(float));
}

static bool make_outline(zt_picture *p, const zt_keepsake_head *h) {
    zt_arena_reset(&p->arena);
    p->outline = (zt_outline){.thing_count = h->thing_count, .lamp_count = h->lamp_count};
    p->outline.things = ZT_PUSH(&p->arena, zt_outline_thing, (size_t)h->thing_count);
    p->outline.lamps = ZT_PUSH(&p->arena, zt_outline_lamp, (size_t)h->lamp_count);
    return p->outline.things && p->outline.lamps;
}

/* Without rounds, but with room for those of the keepsake. */
static bool make_edges(zt_picture *p, const zt_keepsake_head *h) {
    if (zt_picture_open_edges(p, h->is_signed) != ZT_OK) return false;
    zt_rounds_reserve(&p->rounds, h->round_count);
    return true;
}

bool zt_keepsake_read(zt_picture *p, const unsigned char *bytes, uint64_t size,
                      const char *arithmetic) {
    zt_keepsake_head head;
    p->whole = false;
    if (size < sizeof head) return false;
    memcpy(&head, bytes, sizeof head);
    if (!zt_keepsake_knows(&head, size, arithmetic) ||
        !zt_hash_equal(head.checksum, zt_hash_bytes(bytes + CHECKED, (size_t)size - CHECKED)) ||
        zt_picture_open(p, head.width, head.height) != ZT_OK || !make_outline(p, &head) ||
        (head.at_edges && !make_edges(p, &head)))
        return false;
    p->at_edges = head.at_edges;
    stream s = {.from = bytes + sizeof head, .left = (size_t)size - sizeof head};
    pass_all(&s, p, head.opaque);
    p->view = head.view;
    p->frame_key = head.frame_key;
    p->whole = !s.lacking && s.left == 0;
    return p->whole;
}
