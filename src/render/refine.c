/* In the first round each pixel takes as many samples as are asked for at least; in each round
 * that follows, as many again as it has. What is new in a round and what was there before are
 * independent halves, well spread each: by how much they differ says how far their mean may be
 * off. The pixels with the fewest samples come first, so that those which join late catch up.
 */
#include "render/refine.h"

#include <math.h>
#include <string.h>

#include "render/reuse.h"
#include "render/rounds.h"
#include "render/take.h"

/* Rounds ----------------------------------------------------------------------------------- */

enum { DECISIONS = 4096 }; /* of a task */

static void decide_task(void *user, int task, int worker) {
    (void)worker;
    const zt_round_job *j = user;
    const zt_frame *f = j->frame;
    zt_canvas *canvas = &f->work->canvas;
    int32_t end = min_int((task + 1) * DECISIONS, canvas->round_count);
    for (int32_t i = task * DECISIONS; i < end; i++) {
        const zt_slot *s = &canvas->slots[canvas->round[i]];
        int least =
            f->at_edges ? 1 << canvas->least[zt_canvas_pixel(canvas, s->column, s->row)] : 0;
        float wanted = zt_canvas_share(canvas, s->asked) * j->wanted;
        canvas->goes_on[i] = s->asked < f->job->sampling.max &&
                             (s->asked < least || zt_canvas_error(canvas, s) > wanted);
    }
}

/* Of the slots that wait, those with the fewest samples; returns how many these are. */
static int32_t begin_round(zt_canvas *canvas) {
    int32_t fewest = INT32_MAX, kept = 0, count = 0;
    for (int32_t i = 0; i < canvas->waiting_count; i++)
        fewest = min_int(fewest, canvas->waiting[i].asked);
    for (int32_t i = 0; i < canvas->waiting_count; i++) {
        zt_waiting w = canvas->waiting[i];
        bool now = w.asked == fewest;
        canvas->round[count] = w.slot;
        canvas->waiting[kept] = w;
        count += now;
        kept += !now;
    }
    canvas->waiting_count = kept;
    canvas->round_count = count;
    return fewest;
}

/* Those that go on, with so many samples, wait again; and the neighbours of strange ones do. */
static void end_round(zt_canvas *canvas, int32_t asked, bool may_be_strange) {
    for (int32_t i = 0; i < canvas->round_count; i++) {
        canvas->waiting[canvas->waiting_count] = (zt_waiting){canvas->round[i], asked};
        canvas->waiting_count += canvas->goes_on[i];
    }
    for (int32_t i = 0; may_be_strange && i < canvas->round_count; i++) {
        zt_slot *s = &canvas->slots[canvas->round[i]];
        int column = s->column, row = s->row;
        if (!s->strange) continue;
        s->strange = false;
        for (int y = max_int(row - 1, 0); y <= min_int(row + 1, canvas->height - 1); y++)
            for (int x = max_int(column - 1, 0); x <= min_int(column + 1, canvas->width - 1);
                 x++)
                zt_canvas_add(canvas, x, y);
    }
}

static void run(zt_pool *pool, int count, void (*task)(void *, int, int), void *user) {
    if (count == 1)
        task(user, 0, 0);
    else
        zt_pool_run(pool, count, task, user);
}

/* The image ---------------------------------------------------------------------------------*/

static void write_task(void *user, int task, int worker) {
    const zt_round_job *j = user;
    const zt_frame *f = j->frame;
    const zt_canvas *canvas = &f->work->canvas;
    int64_t *left_out = &f->work->threads[worker].count.left_out;
    float *kept = f->keeps && !f->at_edges ? f->job->reuse->last.pixels : NULL;
    int32_t end = min_int((task + 1) * DECISIONS, canvas->slot_count);
    for (int32_t i = task * DECISIONS; i < end; i++) {
        const zt_slot *s = &canvas->slots[i];
        if (s->hidden) continue;
        double mean[4];
        zt_canvas_mean(mean, &s->sum, j->is_signed ? &canvas->negative[i] : NULL);
        size_t at = 4 * zt_canvas_pixel(canvas, s->column, s->row);
        float *to = f->image->pixels + at;
        for (int k = 0; k < 4; k++) to[k] = (float)mean[k];
        if (!f->job->transparent) to[3] = 1;
        if (kept) memcpy(kept + at, to, 4 * sizeof *to);
        *left_out += zt_slot_left_out(canvas, i);
    }
}

static void write_channels(const zt_canvas *canvas, zt_image *image) {
    float *samples = zt_image_channel(image, "samples"),
          *error = zt_image_channel(image, "error");
    size_t count = (size_t)canvas->width * (size_t)canvas->height;
    for (size_t i = 0; samples && i < count; i++) samples[i] = 1;
    for (size_t i = 0; error && i < count; i++) error[i] = -1;
    for (int32_t i = 0; (samples || error) && i < canvas->slot_count; i++) {
        const zt_slot *s = &canvas->slots[i];
        size_t pixel = zt_canvas_pixel(canvas, s->column, s->row);
        float estimate = zt_canvas_error(canvas, s);
        if (samples) samples[pixel] = (float)s->asked;
        if (error) error[pixel] = estimate < 0 ? -1 : sqrtf(estimate);
    }
}

static int task_count(int32_t count, int32_t each) { return (count + each - 1) / each; }

static double pixels_of(const zt_canvas *canvas) {
    return (double)canvas->width * canvas->height;
}

/* How many samples the picture may take, in all, beyond each pixel's first ones. */
static double most_samples(const zt_frame *f) {
    int mean_max = f->job->sampling.mean_max;
    return mean_max > 0 ? mean_max * pixels_of(&f->work->canvas) : INFINITY;
}

zt_status zt_refine(zt_frame *f) {
    zt_canvas *canvas = &f->work->canvas;
    zt_round_job j = {.frame = f, .is_signed = zt_warp_is_signed(f->job->warp)};
    double taken = f->at_edges ? pixels_of(canvas) : 0;
    canvas->at_edges = f->at_edges;
    canvas->is_random = zt_render_is_random(f->job);
    while (canvas->waiting_count > 0) {
        j = zt_round_plan(f, begin_round(canvas));
        double more = (double)canvas->round_count * j.more;
        if (j.asked > 0 && taken + more > most_samples(f)) continue; /* they stay as they are */
        taken += more;
        if (f->rounds) zt_rounds_reserve(f->rounds, (size_t)canvas->round_count);
        run(f->pool, task_count(canvas->round_count, j.task_slots), zt_round_task, &j);
        if (f->stopped) return ZT_ESTOPPED;
        if (f->doubtful) return ZT_OK; /* all is rendered once more */
        run(f->pool, task_count(canvas->round_count, DECISIONS), decide_task, &j);
        end_round(canvas, j.asked + j.more, f->at_edges);
    }
    run(f->pool, task_count(canvas->slot_count, DECISIONS), write_task, &j);
    write_channels(canvas, f->image);
    return ZT_OK;
}

/* Whatever a pixel's samples come to, whether one beside it goes on may depend on it; then what
 * that one's samples come to; and so on, by a pixel each round but for the last. So where tiles
 * are copied, pixels are decided about anew as far as that from those that are rendered; and
 * for these, as far from them again, which are hidden. */
typedef struct beginning {
    zt_frame *frame;
    int reach;       /* pixels */
    int32_t *firsts; /* how many slots each tile has, and then its first one */
    bool adds;
} beginning;

/* Counts or adds the slots of a tile. */
static void begin_task(void *user, int tile, int worker) {
    (void)worker;
    const beginning *b = user;
    zt_frame *f = b->frame;
    zt_canvas *canvas = &f->work->canvas;
    const int left = tile % f->tile_columns * TILE_SIDE,
              top = tile / f->tile_columns * TILE_SIDE;
    int32_t slot = b->adds ? b->firsts[tile] : 0;
    bool shows = false,
         far = f->copies && zt_reuse_distance(f, left, top, 2 * b->reach + TILE_SIDE) >
                                2 * b->reach + TILE_SIDE;
    for (int i = 0; i < ZT_BATCH && !far; i++) {
        int x = left + f->work->column[i], y = top + f->work->row[i];
        if (x >= canvas->width || y >= canvas->height) continue;
        int distance = f->copies ? zt_reuse_distance(f, x, y, 2 * b->reach) : 0;
        if (distance > 2 * b->reach) continue;
        if (b->adds) zt_canvas_add_as(canvas, slot, x, y, distance > b->reach);
        shows |= distance <= b->reach;
        slot++;
    }
    if (!b->adds) b->firsts[tile] = slot;
    if (shows && b->adds && f->keeps) zt_reuse_stamp(f, tile);
}

void zt_refine_begin(zt_frame *f) {
    zt_canvas *canvas = &f->work->canvas;
    /* Nobody is in the round yet, and there are fewer tiles than pixels. */
    beginning b = {.frame = f, .reach = zt_round_count(f) - 1, .firsts = canvas->round};
    int32_t count = 0;
    run(f->pool, f->tile_count, begin_task, &b);
    for (int tile = 0; tile < f->tile_count; tile++) {
        int32_t own = b.firsts[tile];
        b.firsts[tile] = count;
        count += own;
    }
    b.adds = true;
    run(f->pool, f->tile_count, begin_task, &b);
    zt_canvas_added(canvas, count);
    /* The others would have taken a round, at least. */
    f->work->threads[0].count.rays.primary_avoided +=
        (int64_t)((pixels_of(canvas) - count) * zt_round_plan(f, 0).more);
}
