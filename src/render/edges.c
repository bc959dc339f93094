#include "render/edges.h"

#include <math.h>
#include <string.h>

#include "tracer/isa.h"

enum { EDGE_LEAST = 2, BAND = 16 }; /* an edge's 2^2 samples at least; rows of a task */

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
        mark[x] |= differs ? 1 : 0;
    }
    for (int x = 0; x<width; x += width> 1 ? width - 1 : 1)
        for (int near = x > 0 ? x - 1 : 0; near <= x + 1 && near < width; near++)
            mark[x] |= row[near] != row[x] || above[near] != row[x] || below[near] != row[x];
}

/* Marks the pixels of a row whose color is off the line between those of their neighbours: a
 * step of twice the error, of which a pixel may hold any part, bends it by as much. A slope
 * does not, and its middle is its mean. */
ZT_CLONES static void mark_colors(uint8_t *restrict mark, const float *restrict above,
                                  const float *restrict row, const float *restrict below,
                                  int width, float allowed) {
    for (int x = 1; x < width - 1; x++) {
        const float *own = row + 4 * x, *up = above + 4 * x, *down = below + 4 * x;
        float most = 0;
        for (int k = 0; k < 3; k++) {
            float across = fabsf(own[k - 4] - 2 * own[k] + own[k + 4]);
            float along = fabsf(up[k] - 2 * own[k] + down[k]);
            most = across > most ? across : most;
            most = along > most ? along : most;
        }
        mark[x] |= most > allowed;
    }
}

typedef struct edges {
    zt_frame *frame;
    float allowed;
    int reach; /* pixels by which the filter reaches beyond its own */
} edges;

static void mark_band(void *user, int task, int worker) {
    (void)worker;
    const edges *e = user;
    zt_canvas *canvas = &e->frame->work->canvas;
    const float *pixels = e->frame->image->pixels;
    int last = canvas->height - 1;
    for (int y = task * BAND; y < min_int((task + 1) * BAND, canvas->height); y++) {
        size_t row = zt_canvas_pixel(canvas, 0, y);
        size_t above = zt_canvas_pixel(canvas, 0, max_int(y - 1, 0));
        size_t below = zt_canvas_pixel(canvas, 0, min_int(y + 1, last));
        uint8_t *mark = canvas->edge + row;
        memset(mark, 0, (size_t)canvas->width);
        mark_paths(mark, canvas->path + above, canvas->path + row, canvas->path + below,
                   canvas->width);
        if (y > 0 && y < last)
            mark_colors(mark, pixels + 4 * above, pixels + 4 * row, pixels + 4 * below,
                        canvas->width, e->allowed);
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
        for (int from = max_int(y - reach, 0); from <= min_int(y + reach, canvas->height - 1);
             from++) {
            const uint8_t *mark = canvas->edge + zt_canvas_pixel(canvas, 0, from);
            for (int x = 0; x < width; x++) {
                bool any = false;
                for (int k = max_int(x - reach, 0); k <= min_int(x + reach, width - 1); k++)
                    any |= mark[k];
                least[x] = any && least[x] < EDGE_LEAST ? EDGE_LEAST : least[x];
            }
        }
    }
}

/* Blocks of four pixels in a row, of which most want nothing, by their bytes. */
static void add_tile(zt_canvas *canvas, const zt_frame *f, int x, int y) {
    for (int i = 0; i < ZT_BATCH; i += 4) {
        int column = x + f->work->column[i], row = y + f->work->row[i];
        if (column >= canvas->width || row >= canvas->height) continue;
        const uint8_t *least = canvas->least + zt_canvas_pixel(canvas, column, row);
        int count = min_int(4, canvas->width - column);
        uint32_t bytes = 0;
        memcpy(&bytes, least, (size_t)count);
        for (int k = 0; bytes && k < count; k++)
            if (least[k]) zt_canvas_add(canvas, column + k, row);
    }
}

void zt_edges_find(zt_frame *f) {
    zt_canvas *canvas = &f->work->canvas;
    const zt_sampling *s = &f->job->sampling;
    int bands = (canvas->height + BAND - 1) / BAND;
    edges e = {f, (float)(2 * s->error), (int)ceil((zt_filter_width(s) - 1) / 2)};
    memset(canvas->least, 0, (size_t)canvas->width * (size_t)canvas->height);
    zt_pool_run(f->pool, bands, mark_band, &e);
    zt_pool_run(f->pool, bands, spread_band, &e);
    for (int tile = 0; tile < f->tile_count; tile++)
        add_tile(canvas, f, tile % f->tile_columns * TILE_SIDE,
                 tile / f->tile_columns * TILE_SIDE);
}
