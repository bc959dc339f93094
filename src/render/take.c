#include "render/take.h"

#include <math.h>
#include <string.h>

#include "render/reuse.h"
#include "tracer/isa.h"

/* Samples of a pixel at least, and where edges cannot be told, or nearly all that are at one go
 * on to so many, which then travel together; so many that rays share a batch with few others;
 * rays that a thread takes at a time. */
enum { PAIR = 2, EIGHT = 8, TOGETHER = 16, TASK_RAYS = 1024 };

/* Nearly all go on so far where the error is to be below this. */
#define TINY 0x1p-7

int zt_render_first_samples(const zt_render_job *job) {
    const zt_sampling *s = &job->sampling;
    bool eight = s->edges && (!zt_render_is_at_edges(job) || s->error < TINY);
    return max_int(s->min, eight ? EIGHT : PAIR);
}

/* Samples of a slot in the round after it has taken `asked`. */
static int32_t more_of(const zt_frame *f, int32_t asked) {
    int first = zt_render_first_samples(f->job);
    return min_int(asked ? asked : first, f->job->sampling.max - asked);
}

zt_round_job zt_round_plan(zt_frame *f, int32_t asked) {
    const double error = f->job->sampling.error;
    zt_round_job j = {.frame = f,
                      .asked = asked,
                      .more = more_of(f, asked),
                      .wanted = (float)(error * error),
                      .is_signed = zt_warp_is_signed(f->job->warp)};
    j.group = ZT_BATCH / min_int(j.more, TOGETHER);
    j.task_slots = j.group * max_int(1, TASK_RAYS / (j.group * j.more));
    return j;
}

int zt_round_count(const zt_frame *f) {
    int count = 0;
    for (int32_t asked = 0; asked < f->job->sampling.max; asked += more_of(f, asked)) count++;
    return count;
}

static inline double square3(float r, float g, float b) {
    return (double)r * (double)r + (double)g * (double)g + (double)b * (double)b;
}

/* Adds a sample of each pixel, from `first` in the batch on, to the sums. */
ZT_CLONES static void add_samples(struct zt_canvas_half *restrict sum,
                                  const zt_radiance *restrict light, int first, int count) {
    for (int i = 0; i < count; i++) {
        float r = light->r[first + i], g = light->g[first + i], b = light->b[first + i];
        bool finite = zt_finite3(r, g, b);
        sum->r[i] += finite ? (double)r : 0;
        sum->g[i] += finite ? (double)g : 0;
        sum->b[i] += finite ? (double)b : 0;
        sum->square[i] += finite ? square3(r, g, b) : 0;
        sum->taken[i] += finite;
    }
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
static void take_negative(struct zt_canvas_half *sum, zt_radiance *light, const float *weight,
                          int first, int count, bool transparent) {
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
    }
}

/* Whether one of the pixels around sees the same in its middle. */
static bool is_known(const zt_frame *f, const zt_slot *slot, uint32_t path) {
    const zt_canvas *canvas = &f->work->canvas;
    for (int dy = -1; dy <= 1; dy++)
        for (int dx = -1; dx <= 1; dx++) {
            int x = slot->column + dx, y = slot->row + dy;
            if (x < 0 || y < 0 || x >= canvas->width || y >= canvas->height) continue;
            if (f->paths[zt_canvas_pixel(canvas, x, y)] == path) return true;
        }
    return false;
}

/* A straight edge through a pixel has the middles of its neighbours on both sides: where a
 * sample sees what they do not, something is thin, and may go on beside the pixel. */
static void look_for_strange(zt_frame *f, const int32_t *slots, const uint32_t *path, int now,
                             int count) {
    zt_canvas *canvas = &f->work->canvas;
    for (int i = 0; i < count; i++) {
        zt_slot *slot = &canvas->slots[slots[i]];
        uint32_t known = f->paths[zt_canvas_pixel(canvas, slot->column, slot->row)];
        for (int k = 0; k < now && !slot->strange; k++) {
            uint32_t seen = path[k * count + i];
            if (seen == known) continue;
            slot->strange = !is_known(f, slot, seen);
            known = seen;
        }
    }
}

/* Samples number asked + done and on, `now` of each of the listed slots. */
static void take_samples(const zt_round_job *j, zt_render_thread *own, const int32_t *slots,
                         int count, int done, int now) {
    zt_frame *f = j->frame;
    int first_half = j->asked ? 0 : j->more / 2;
    for (int k = 0; k < now; k++)
        zt_samples_take(&own->places, &own->rays, f->job, own->column, own->row, k * count,
                        count, j->asked + done + k);
    zt_frame_trace(f, own, count, now);
    if (f->at_edges) look_for_strange(f, slots, own->light.path, now, count);
    for (int k = 0; k < now; k++) {
        int half = done + k >= first_half;
        if (j->is_signed)
            take_negative(&own->sums.negative[half], &own->light, own->places.weight, k * count,
                          count, f->job->transparent);
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
static void finish_slot(zt_canvas *canvas, int32_t index, const zt_round_job *j,
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
    size_t pixel = zt_canvas_pixel(canvas, slot->column, slot->row);
    canvas->error[pixel] = zt_canvas_estimate(&canvas->step[pixel], positive, negative);
    slot->sum = both(positive[0], positive[1]);
    slot->asked += j->more;
}

/* Which of their samples were not finite, and are left out: of such tiles nothing is known. */
static bool has_left_out(const zt_canvas *canvas, const int32_t *slots, int count) {
    bool any = false;
    for (int i = 0; i < count; i++) any |= zt_slot_left_out(canvas, slots[i]) > 0;
    return any;
}

/* The samples of a round for slots that share batches. */
static void sample_group(const zt_round_job *j, zt_render_thread *own, const int32_t *slots,
                         int count) {
    zt_frame *f = j->frame;
    zt_canvas *canvas = &f->work->canvas;
    for (int i = 0; i < count; i++) {
        own->column[i] = canvas->slots[slots[i]].column;
        own->row[i] = canvas->slots[slots[i]].row;
    }
    zt_samples_key(&own->places, f->job, own->column, own->row, count);
    memset(own->sums.positive, 0, sizeof own->sums.positive);
    if (j->is_signed) memset(own->sums.negative, 0, sizeof own->sums.negative);
    own->rays.labels = f->at_edges ? &f->labels : NULL;
    own->rays.wants_cover = f->job->transparent;
    zt_footprint footprint = {0};
    if (f->keeps) zt_reuse_watch(&own->rays, &footprint, f);
    int together = ZT_BATCH / count;
    for (int done = 0; done < j->more; done += together) {
        if (zt_frame_stopped(f)) break;
        take_samples(j, own, slots, count, done, min_int(together, j->more - done));
    }
    own->rays.footprint = NULL;
    if (f->stopped) return;
    for (int i = 0; i < count; i++) finish_slot(canvas, slots[i], j, &own->sums, i);
    if (!f->keeps) return;
    footprint.restless |= has_left_out(canvas, slots, count);
    zt_reuse_note(f, &footprint, own->column[0], own->row[0]);
    if (f->rounds) zt_rounds_keep(f->rounds, canvas, slots, count);
}

/* Lists the slots whose round is not known from the frame before. */
static int32_t list_unknown(int32_t *list, const zt_round_job *j, zt_render_thread *own,
                            int32_t begin, int32_t end) {
    zt_canvas *canvas = &j->frame->work->canvas;
    const zt_rounds *rounds = j->frame->rounds;
    int32_t count = 0;
    for (int32_t i = begin; i < end; i++) {
        int32_t slot = canvas->round[i];
        list[count] = slot;
        if (rounds && zt_rounds_recall(canvas, slot, rounds))
            canvas->slots[slot].asked += j->more;
        else
            count++;
    }
    own->count.rays.primary_avoided += (int64_t)(end - begin - count) * j->more;
    return count;
}

/* How many of the listed slots share batches: where footprints are taken, those of one tile. */
static int group_size(const zt_round_job *j, const int32_t *list, int most) {
    const zt_slot *slots = j->frame->work->canvas.slots, *first = &slots[list[0]];
    int column = first->column / TILE_SIDE, row = first->row / TILE_SIDE;
    for (int i = 1; j->frame->keeps && i < most; i++) {
        const zt_slot *s = &slots[list[i]];
        if (s->column / TILE_SIDE != column || s->row / TILE_SIDE != row) return i;
    }
    return most;
}

void zt_round_task(void *user, int task, int worker) {
    const zt_round_job *j = user;
    const zt_canvas *canvas = &j->frame->work->canvas;
    zt_render_thread *own = &j->frame->work->threads[worker];
    int32_t begin = task * j->task_slots;
    int32_t end = min_int(begin + j->task_slots, canvas->round_count);
    int32_t list[TASK_RAYS];
    int32_t count = list_unknown(list, j, own, begin, end);
    for (int32_t i = 0, now; i < count; i += now) {
        if (zt_frame_stopped(j->frame)) return;
        now = group_size(j, list + i, min_int(j->group, count - i));
        sample_group(j, own, list + i, now);
    }
}
