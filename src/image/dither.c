/* The mask is made by void-and-cluster (Robert Ulichney, "The void-and-cluster method for
 * dither array generation", 1993): points are put one after another where the most room is, so
 * that the first ones of any number lie evenly and without a pattern, and what dithering adds
 * is fine grain, without the coarse that eyes see. Owns the mask, 4 KB, made at the first use
 * in some 2 ms. */
#include "image/dither.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>
#include <threads.h>

#include "base/wide.h"

enum { SIDE = ZT_DITHER_SIDE, COUNT = SIDE * SIDE, REACH = 10, FIRST_COUNT = COUNT / 10 };

/* How near points are to a place: the sum of a bell over them, of which so many pixels are a
 * standard deviation. In whole numbers, which add up to the same in any order. */
#define BELL_WIDTH 1.9

typedef struct points {
    bool there[COUNT];
    uint32_t nearness[COUNT]; /* below 2^20 */
} points;

static uint8_t mask[COUNT];
/* For rows that are y - REACH from a point: its share at a place in column c of the mask, where
 * its own is p, is [y][SIDE + c - p]. */
static uint32_t bell[2 * REACH + 1][2 * SIDE];

static void make_bell(void) {
    for (int y = -REACH; y <= REACH; y++)
        for (int x = -REACH; x <= REACH; x++) {
            uint32_t *share = &bell[y + REACH][(SIDE + x) & (SIDE - 1)];
            share[0] = share[SIDE] = (uint32_t)lround(
                32768 * exp(-(double)(x * x + y * y) / (2 * BELL_WIDTH * BELL_WIDTH)));
        }
}

/* Puts a point, or takes it away. The mask goes on beyond its edges as it begins. */
ZT_CLONES static void toggle(points *p, int place) {
    const uint32_t sign = p->there[place] ? UINT32_MAX : 1; /* -1 */
    p->there[place] = !p->there[place];
    for (int y = -REACH; y <= REACH; y++) {
        uint32_t *row = p->nearness + ((place / SIDE + y) & (SIDE - 1)) * SIDE;
        const uint32_t *shares = bell[y + REACH] + SIDE - place % SIDE;
        for (int x = 0; x < SIDE; x++) row[x] += sign * shares[x];
    }
}

/* The place without a point that is the furthest from them, or the point that is the nearest to
 * the others. */
ZT_CLONES static int find(const points *p, bool point) {
    const uint32_t flip = point ? (1U << 20) - 1 : 0;
    uint32_t best = UINT32_MAX;
    for (uint32_t i = 0; i < COUNT; i++) {
        uint32_t rank = (p->nearness[i] ^ flip) << 12 | i;
        rank |= p->there[i] == point ? 0 : UINT32_MAX;
        best = rank < best ? rank : best;
    }
    return (int)(best % COUNT);
}

/* Points by Martin Roberts' sequence ("The unreasonable effectiveness of quasirandom
 * sequences", 2018), then those that are too near to others moved to where there is room. */
static void begin(points *p) {
    const double plastic = 1.32471795724474602596;
    for (int i = 0, count = 0; count < FIRST_COUNT; i++) {
        double x = fmod(0.5 + i / plastic, 1), y = fmod(0.5 + i / (plastic * plastic), 1);
        int place = (int)(y * SIDE) * SIDE + (int)(x * SIDE);
        if (p->there[place]) continue;
        toggle(p, place);
        count++;
    }
    for (int from = -1, to = -2; from != to;) {
        from = find(p, true);
        toggle(p, from);
        to = find(p, false);
        toggle(p, to);
    }
}

static void make_mask(void) {
    static points first, p;
    make_bell();
    begin(&first);
    p = first;
    for (int rank = FIRST_COUNT - 1; rank >= 0; rank--) {
        int place = find(&p, true);
        mask[place] = (uint8_t)(rank * 256 / COUNT);
        toggle(&p, place);
    }
    p = first;
    for (int rank = FIRST_COUNT; rank < COUNT; rank++) {
        int place = find(&p, false);
        mask[place] = (uint8_t)(rank * 256 / COUNT);
        toggle(&p, place);
    }
}

const uint8_t *zt_dither_row(int y) {
    static once_flag made = ONCE_FLAG_INIT;
    call_once(&made, make_mask);
    return mask + (y & (SIDE - 1)) * SIDE;
}

ZT_CLONES static void code_piece(uint16_t *restrict codes, const float *restrict numbers,
                                 int count, float scale, const uint8_t *restrict row) {
    for (int i = 0; i < count; i++)
        codes[i] = (uint16_t)zt_dither_code(scale * numbers[i], row[i]);
}

void zt_dither_line(uint16_t *codes, const float *numbers, int first, int count, float scale,
                    const uint8_t *row) {
    uint8_t nearest[SIDE];
    if (!row) memset(nearest, 128, sizeof nearest);
    for (int i = 0; i < count;) {
        int at = (first + i) & (SIDE - 1), some = count - i < SIDE - at ? count - i : SIDE - at;
        code_piece(codes + i, numbers + i, some, scale, (row ? row : nearest) + at);
        i += some;
    }
}
