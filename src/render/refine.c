/* In the first round each pixel takes as many samples as are asked for at least; in each round
 * that follows, as many again as it has. What is new in a round and what was there before are
 * independent halves, well spread each: by how much they differ says how far their mean may be
 * off. The pixels with the fewest samples come first, so that those which join late catch up.
 */
#include "render/refine.h"

#include <math.h>
#include <string.h>

#include "tracer/isa.h"

/* Samples of a pixel at least, and where edges cannot be told; so many that rays share a batch
 * with few others; rays that a thread takes at a time. */
enum { PAIR = 2, BLIND = 8, TOGETHER = 16, TASK_RAYS = 1024 };

/* What all slots of a round have in common. */
typedef struct round_job {
    zt_frame *frame;
    int32_t asked, more; /* samples so far, and now */
    int32_t group;       /* slots that share a batch */
    int32_t task_slots;  /* slots of a task */
    float wanted;        /* the squared error below which a pixel is left */
    bool is_signed;
} round_job;

/* Samples ---------------------------------------------------------------------------------- */

static inline double square3(float r, float g, float b) {
    return (double)r * (double)r + (double)g * (double)g + (double)b * (double)b;
}

/* Adds a sample of each pixel, from `first` in the batch on, to the sums. */
ZT_CLONES static int add_samples(struct zt_canvas_half *restrict sum,
                                 const zt_radiance *restrict light, int first, int count) {
    int left_out = 0;
    for (int i = 0; i < count; i++) {
        float r = light->r[first + i], g = light->g[first + i], b = light->b[first + i];
        bool finite = zt_finite3(r, g, b);
        sum->r[i] += finite ? (double)r : 0;
        sum->g[i] += finite ? (double)g : 0;
        sum->b[i] += finite ? (double)b : 0;
        sum->square[i] += finite ? square3(r, g, b) : 0;
        sum->taken[i] += finite;
        left_out += !finite;
    }
    return left_out;
}

/* Adds which of those samples met something. */
ZT_CLONES static void add_cover(struct zt_canvas_half *restrict sum,
                                const zt_radiance *restrict light, int first, int count) {
    for (int i = 0; i < count; i++) {
        bool finite = zt_finite3(light->r[first + i], light->g[first + i], light->b[first + i]);
        double a = finite ? (double)light->a[first + i] : 0;
        sum->a[i] += a;
        sum->square[i] += 3 * a;
    }
}

/* Moves the samples that count negatively out of a batch's light to the sums of those: what is
 * left there adds nothing, being no number. */
static int take_negative(struct zt_canvas_half *sum, zt_radiance *light, const float *weight,
                         int first, int count, bool transparent) {
    int moved = 0;
    for (int i = 0; i < count; i++) {
        float r = light->r[first + i], g = light->g[first + i], b = light->b[first + i];
        if (weight[first + i] > 0 || !zt_finite3(r, g, b)) continue;
        sum->r[i] += (double)r;
        sum->g[i] += (double)g;
        sum->b[i] += (double)b;
        sum->square[i] += square3(r, g, b);
        if (transparent) {
            sum->a[i] += (double)light->a[first + i];
            sum->square[i] += 3 * (double)light->a[first + i];
        }
        sum->taken[i]++;
        light->r[first + i] = NAN;
        moved++;
    }
    return moved;
}

/* Whether one of the pixels around sees the same in its middle. */
static bool is_known(const zt_canvas *canvas, const zt_slot *slot, uint32_t path) {
    for (int dy = -1; dy <= 1; dy++)
        for (int dx = -1; dx <= 1; dx++) {
            int x = slot->column + dx, y = slot->row + dy;
            if (x < 0 || y < 0 || x >= canvas->width || y >= canvas->height) continue;
            if (canvas->path[zt_canvas_pixel(canvas, x, y)] == path) return true;
        }
    return false;
}

/* A straight edge through a pixel has the middles of its neighbours on both sides: where a
 * sample sees what they do not, something is thin, and may go on beside the pixel. */
static void look_for_strange(zt_canvas *canvas, const int32_t *slots, const uint32_t *path,
                             int now, int count) {
    for (int i = 0; i < count; i++) {
        zt_slot *slot = &canvas->slots[slots[i]];
        uint32_t known = canvas->path[zt_canvas_pixel(canvas, slot->column, slot->row)];
        for (int k = 0; k < now && !slot->strange; k++) {
            uint32_t seen = path[k * count + i];
            if (seen == known) continue;
            slot->strange = !is_known(canvas, slot, seen);
            known = seen;
        }
    }
}

/* Exchanges rows, of `width` numbers of 32 bits, and columns. */
static void turn(void *numbers, int width, int height) {
    enum { SIZE = 4 };
    static_assert(sizeof(float) == SIZE, "a number is one of 32 bits");
    char *own = numbers, turned[SIZE * ZT_BATCH];
    for (int i = 0; i < width; i++)
        for (int k = 0; k < height; k++)
            memcpy(turned + SIZE * (i * height + k), own + SIZE * (k * width + i), SIZE);
    memcpy(own, turned, (size_t)width * (size_t)height * SIZE);
}

/* Traces `now` samples of each of `count` pixels: of those at edges, which have few others
 * nearby, with the samples of each side by side, so that rays that travel together stay close.
 */
static void trace(zt_frame *f, zt_render_thread *own, int count, int now) {
    if (f->at_edges) {
        turn(own->places.x, count, now);
        turn(own->places.y, count, now);
    }
    zt_frame_trace(f, own, now * count);
    if (f->at_edges) {
        turn(own->light.r, now, count);
        turn(own->light.g, now, count);
        turn(own->light.b, now, count);
        turn(own->light.path, now, count);
        if (f->job->transparent) turn(own->light.a, now, count);
    }
}

/* Samples number asked + done and on, `now` of each of the listed slots. */
static void take_samples(const round_job *j, zt_render_thread *own, const int32_t *slots,
                         int count, int done, int now) {
    zt_frame *f = j->frame;
    int first_half = j->asked ? 0 : j->more / 2;
    for (int k = 0; k < now; k++)
        zt_samples_take(&own->places, &own->rays, f->job, own->column, own->row, k * count,
                        count, j->asked + done + k);
    trace(f, own, count, now);
    if (f->at_edges) look_for_strange(&f->work->canvas, slots, own->light.path, now, count);
    for (int k = 0; k < now; k++) {
        int half = done + k >= first_half;
        if (j->is_signed)
            own->count.left_out -=
                take_negative(&own->sums.negative[half], &own->light, own->places.weight,
                              k * count, count, f->job->transparent);
        own->count.left_out +=
            add_samples(&own->sums.positive[half], &own->light, k * count, count);
        if (f->job->transparent)
            add_cover(&own->sums.positive[half], &own->light, k * count, count);
    }
}

static zt_canvas_sum sum_at(const struct zt_canvas_half *half, int i) {
    return (zt_canvas_sum){half->r[i], half->g[i],      half->b[i],
                           half->a[i], half->square[i], half->taken[i]};
}

static zt_canvas_sum both(zt_canvas_sum a, zt_canvas_sum b) {
    return (zt_canvas_sum){a.r + b.r, a.g + b.g,           a.b + b.b,
                           a.a + b.a, a.square + b.square, a.taken + b.taken};
}

/* What a slot has taken in the round becomes its own, and says how far off it is. */
static void finish_slot(zt_canvas *canvas, int32_t index, const round_job *j,
                        const zt_canvas_sums *sums, int i) {
    zt_slot *slot = &canvas->slots[index];
    zt_canvas_sum positive[2] = {both(slot->sum, sum_at(&sums->positive[0], i)),
                                 sum_at(&sums->positive[1], i)};
    zt_canvas_sum none = {0}, negative[2] = {none, none};
    if (j->is_signed) {
        negative[0] = both(canvas->negative[index], sum_at(&sums->negative[0], i));
        negative[1] = sum_at(&sums->negative[1], i);
        canvas->negative[index] = both(negative[0], negative[1]);
    }
    canvas->error[zt_canvas_pixel(canvas, slot->column, slot->row)] =
        zt_canvas_estimate(positive, negative);
    slot->sum = both(positive[0], positive[1]);
    slot->asked += j->more;
}

/* The samples of a round for slots that share batches. */
static void sample_group(const round_job *j, zt_render_thread *own, const int32_t *slots,
                         int count) {
    zt_canvas *canvas = &j->frame->work->canvas;
    for (int i = 0; i < count; i++) {
        own->column[i] = canvas->slots[slots[i]].column;
        own->row[i] = canvas->slots[slots[i]].row;
    }
    zt_samples_key(&own->places, j->frame->job, own->column, own->row, count);
    memset(own->sums.positive, 0, sizeof own->sums.positive);
    if (j->is_signed) memset(own->sums.negative, 0, sizeof own->sums.negative);
    own->rays.wants_path = j->frame->at_edges;
    own->rays.wants_cover = j->frame->job->transparent;
    int together = ZT_BATCH / count;
    for (int done = 0; done < j->more; done += together) {
        if (zt_frame_stopped(j->frame)) return;
        take_samples(j, own, slots, count, done, min_int(together, j->more - done));
    }
    for (int i = 0; i < count; i++) finish_slot(canvas, slots[i], j, &own->sums, i);
}

static void sample_task(void *user, int task, int worker) {
    const round_job *j = user;
    const zt_canvas *canvas = &j->frame->work->canvas;
    zt_render_thread *own = &j->frame->work->threads[worker];
    int32_t end = min_int((task + 1) * j->task_slots, canvas->round_count);
    for (int32_t i = task * j->task_slots; i < end; i += j->group) {
        if (zt_frame_stopped(j->frame)) return;
        sample_group(j, own, canvas->round + i, min_int(j->group, end - i));
    }
}

/* Rounds ----------------------------------------------------------------------------------- */

enum { DECISIONS = 4096 }; /* of a task */

static void decide_task(void *user, int task, int worker) {
    (void)worker;
    const round_job *j = user;
    const zt_frame *f = j->frame;
    zt_canvas *canvas = &f->work->canvas;
    int32_t end = min_int((task + 1) * DECISIONS, canvas->round_count);
    for (int32_t i = task * DECISIONS; i < end; i++) {
        const zt_slot *s = &canvas->slots[canvas->round[i]];
        int least =
            f->at_edges ? 1 << canvas->least[zt_canvas_pixel(canvas, s->column, s->row)] : 0;
        canvas->goes_on[i] =
            s->asked < f->job->sampling.max &&
            (s->asked < least || zt_canvas_error(canvas, s->column, s->row) > j->wanted);
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

static round_job plan_round(zt_frame *f, int32_t asked) {
    const zt_sampling *s = &f->job->sampling;
    round_job j = {.frame = f,
                   .asked = asked,
                   .wanted = (float)(s->error * s->error),
                   .is_signed = zt_warp_is_signed(f->job->warp)};
    int first = max_int(s->min, s->edges && !f->at_edges ? BLIND : PAIR);
    j.more = min_int(j.asked ? j.asked : first, s->max - j.asked);
    j.group = ZT_BATCH / min_int(j.more, TOGETHER);
    j.task_slots = j.group * max_int(1, TASK_RAYS / (j.group * j.more));
    return j;
}

/* The image ---------------------------------------------------------------------------------*/

static void write_task(void *user, int task, int worker) {
    (void)worker;
    const round_job *j = user;
    const zt_canvas *canvas = &j->frame->work->canvas;
    int32_t end = min_int((task + 1) * DECISIONS, canvas->slot_count);
    for (int32_t i = task * DECISIONS; i < end; i++) {
        const zt_slot *s = &canvas->slots[i];
        double mean[4];
        zt_canvas_mean(mean, &s->sum, j->is_signed ? &canvas->negative[i] : NULL);
        float *to = j->frame->image->pixels + 4 * zt_canvas_pixel(canvas, s->column, s->row);
        for (int k = 0; k < 4; k++) to[k] = (float)mean[k];
        if (!j->frame->job->transparent) to[3] = 1;
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
        float estimate = zt_canvas_error(canvas, s->column, s->row);
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
    round_job j = {.frame = f, .is_signed = zt_warp_is_signed(f->job->warp)};
    double taken = f->at_edges ? pixels_of(canvas) : 0;
    while (canvas->waiting_count > 0) {
        j = plan_round(f, begin_round(canvas));
        double more = (double)canvas->round_count * j.more;
        if (j.asked > 0 && taken + more > most_samples(f)) continue; /* they stay as they are */
        taken += more;
        run(f->pool, task_count(canvas->round_count, j.task_slots), sample_task, &j);
        if (f->stopped) return ZT_ESTOPPED;
        run(f->pool, task_count(canvas->round_count, DECISIONS), decide_task, &j);
        end_round(canvas, j.asked + j.more, f->at_edges);
    }
    run(f->pool, task_count(canvas->slot_count, DECISIONS), write_task, &j);
    write_channels(canvas, f->image);
    return ZT_OK;
}

/* The pixels of a tile get slots one after the other, and so do the tiles. */
static void begin_task(void *user, int task, int worker) {
    (void)worker;
    zt_frame *f = user;
    zt_canvas *canvas = &f->work->canvas;
    int x = task % f->tile_columns * TILE_SIDE, y = task / f->tile_columns * TILE_SIDE;
    int width = min_int(TILE_SIDE, canvas->width - x);
    int height = min_int(TILE_SIDE, canvas->height - y);
    int32_t slot = y * canvas->width + x * height;
    for (int i = 0; i < ZT_BATCH; i++)
        if (f->work->column[i] < width && f->work->row[i] < height)
            zt_canvas_add_as(canvas, slot++, x + f->work->column[i], y + f->work->row[i]);
}

void zt_refine_begin(zt_frame *f) {
    run(f->pool, f->tile_count, begin_task, f);
    zt_canvas_added_all(&f->work->canvas);
}
