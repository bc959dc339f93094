#include "render/edges.h"

#include <math.h>
#include <string.h>

#include "tracer/isa.h"

/* Samples at least, as logarithms: where only what is seen differs, and where its color does,
 * too, by the least of what counts, or more; how many steps of that there are; and rows of a
 * task. */
enum { PATH_LEAST = 1, COLOR_LEAST = 2, LEVELS = 3, BAND = 16 };

/* Marks the pixels of a row of which one of the eight neighbours saw something else. Rows above
 * and below the picture are its own. */
ZT_CLONES static void mark_paths(uint8_t *restrict mark, const uint32_t *restrict above,
                                 const uint32_t *restrict row, const uint32_t *restrict below,
                                 int width) {
    for (int x = 1; x < width - 1; x++) {
        uint32_t own = row[x];
        uint32_t differs = (own ^ row[x - 1]) | (own ^ row[x + 1]) | (own ^ above[x - 1]) |
                           (own ^ above[x]) | (own ^ above[x + 1]) | (own ^ below[x - 1]) |
                           (own ^ below[x]) | (own ^ below[x + 1]);
        mark[x] = differs ? PATH_LEAST : 0;
    }
    for (int x = 0; x<width; x += width> 1 ? width - 1 : 1)
        for (int near = x > 0 ? x - 1 : 0; near <= x + 1 && near < width; near++)
            if (row[near] != row[x] || above[near] != row[x] || below[near] != row[x])
                mark[x] = PATH_LEAST;
}

/* Marks the pixels of a row whose color, or A, is off the line between those of their
 * neighbours: a step, of which a pixel may hold any part, bends it by as much. A slope does
 * not, and its middle is its mean. The larger the step, the more samples there are to be before
 * it is believed that the pixel has no part of it. */
ZT_CLONES static void mark_colors(uint8_t *restrict mark, const float *restrict above,
                                  const float *restrict row, const float *restrict below,
                                  int width, const float allowed[LEVELS]) {
    enum { CHUNK = 256 };
    int32_t bent[4 * CHUNK] = {0};
    for (int first = 1; first < width - 1; first += CHUNK) {
        int count = min_int(CHUNK, width - 1 - first);
        const float *own = row + 4 * first, *up = above + 4 * first, *down = below + 4 * first;
        for (int i = 0; i < 4 * count; i++) {
            float across = fabsf(own[i - 4] - 2 * own[i] + own[i + 4]);
            float along = fabsf(up[i] - 2 * own[i] + down[i]);
            float most = across > along ? across : along;
            bent[i] = (most > allowed[0]) + (most > allowed[1]) + (most > allowed[2]);
        }
        for (int i = 0; i < count; i++) {
            const int32_t *own_bent = &bent[4 * i];
            int32_t level =
                max_int(max_int(own_bent[0], own_bent[1]), max_int(own_bent[2], own_bent[3]));
            mark[first + i] = level ? (uint8_t)(COLOR_LEAST - 1 + level) : mark[first + i];
        }
    }
}

typedef struct edges {
    zt_frame *frame;
    float allowed[LEVELS]; /* in colors, before there are more samples at least */
    int reach;             /* pixels by which the filter reaches beyond its own */
} edges;

/* Where the filter stays within the pixel. */
static void raise_row(uint8_t *restrict least, const uint8_t *restrict edge, int width) {
    for (int x = 0; x < width; x++) least[x] = least[x] < edge[x] ? edge[x] : least[x];
}

static void mark_band(void *user, int task, int worker) {
    (void)worker;
    const edges *e = user;
    zt_canvas *canvas = &e->frame->work->canvas;
    const float *pixels = e->frame->image->pixels;
    const uint32_t *paths = e->frame->paths;
    int last = canvas->height - 1;
    for (int y = task * BAND; y < min_int((task + 1) * BAND, canvas->height); y++) {
        size_t row = zt_canvas_pixel(canvas, 0, y);
        size_t above = zt_canvas_pixel(canvas, 0, max_int(y - 1, 0));
        size_t below = zt_canvas_pixel(canvas, 0, min_int(y + 1, last));
        uint8_t *mark = canvas->edge + row;
        memset(mark, 0, (size_t)canvas->width);
        mark_paths(mark, paths + above, paths + row, paths + below, canvas->width);
        if (y > 0 && y < last)
            mark_colors(mark, pixels + 4 * above, pixels + 4 * row, pixels + 4 * below,
                        canvas->width, e->allowed);
        if (e->reach == 0) raise_row(canvas->least + row, mark, canvas->width);
    }
}

/* What is marked within the filter's reach asks for samples. */
static void spread_band(void *user, int task, int worker) {
    (void)worker;
    const edges *e = user;
    zt_canvas *canvas = &e->frame->work->canvas;
    int width = canvas->width, reach = e->reach;
    for (int y = task * BAND; y < min_int((task + 1) * BAND, canvas->height); y++) {
        uint8_t *least = canvas->least + zt_canvas_pixel(canvas, 0, y);
        int last = min_int(y + reach, canvas->height - 1);
        for (int from = max_int(y - reach, 0); from <= last; from++) {
            const uint8_t *edge = canvas->edge + zt_canvas_pixel(canvas, 0, from);
            for (int x = 0; x < width; x++) {
                uint8_t wanted = least[x];
                for (int k = max_int(x - reach, 0); k <= min_int(x + reach, width - 1); k++)
                    wanted = edge[k] > wanted ? edge[k] : wanted;
                least[x] = wanted;
            }
        }
    }
}

static bool any_wants(const zt_canvas *canvas, int x, int y, int width, int height) {
    uint64_t any = 0;
    for (int row = y; row < y + height; row++) {
        uint64_t bytes[TILE_SIDE / 8] = {0};
        memcpy(bytes, canvas->least + zt_canvas_pixel(canvas, x, row), (size_t)width);
        any |= bytes[0] | bytes[1];
    }
    return any;
}

static void add_tile(zt_canvas *canvas, const zt_frame *f, int x, int y) {
    int width = min_int(TILE_SIDE, canvas->width - x);
    int height = min_int(TILE_SIDE, canvas->height - y);
    if (!any_wants(canvas, x, y, width, height)) return;
    for (int i = 0; i < ZT_BATCH; i++) {
        int column = f->work->column[i], row = f->work->row[i];
        if (column < width && row < height &&
            canvas->least[zt_canvas_pixel(canvas, x + column, y + row)])
            zt_canvas_add(canvas, x + column, y + row);
    }
}

void zt_edges_find(zt_frame *f) {
    zt_canvas *canvas = &f->work->canvas;
    const zt_sampling *s = &f->job->sampling;
    int bands = (canvas->height + BAND - 1) / BAND;
    const float error = (float)s->error;
    edges e = {f, {error / 2, 2 * error, 8 * error}, (int)ceil((zt_filter_width(s) - 1) / 2)};
    memset(canvas->least, 0, (size_t)canvas->width * (size_t)canvas->height);
    if (f->job->thin) zt_thin_mark(canvas->least, f->job->thin, e.reach);
    zt_pool_run(f->pool, bands, mark_band, &e);
    if (e.reach > 0) zt_pool_run(f->pool, bands, spread_band, &e);
    for (int tile = 0; tile < f->tile_count; tile++)
        add_tile(canvas, f, tile % f->tile_columns * TILE_SIDE,
                 tile / f->tile_columns * TILE_SIDE);
}
