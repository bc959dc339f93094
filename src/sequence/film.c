/* A film: what a target lacks is rendered, behind which it is written; what it has is kept. */
#include <zoetrope/film.h>

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/diag.h"
#include "base/text.h"
#include "image/file.h"
#include "sequence/hold.h"
#include "sequence/outway.h"
#include "sequence/renderer.h"
#include "sequence/settings.h"

/* A film under way. */
typedef struct making {
    zt_renderer *renderer;
    const zt_watcher *watcher;
    zt_output *output;
    zt_film_result *result;
    zt_frames frames; /* in the order in which they come */
    zt_hash *keys;    /* likewise */
    bool forgets;
    bool planned; /* keys are known before the first frame; else each when it is its turn */
    bool timed;   /* a budget decides the samples, and with them the keys, later */
    zt_outway *way;
    zt_image *last; /* that was lent and filled; NULL: none */
    zt_image_info info;
    zt_settings_texts settings;
} making;

static bool same(zt_hash a, zt_hash b) { return a.high == b.high && a.low == b.low; }

static bool ends_with_any(const char *target, const char *const *endings) {
    while (*endings && !zt_text_ends_with(target, *endings, true)) endings++;
    return *endings;
}

static bool is_still(const char *target) {
    return ends_with_any(target, zt_image_file_endings);
}

/* Checksums are made anew. */
static bool is_remembered(const zt_film_order *order) {
    static const char *const made_anew[] = {".hash", NULL};
    return !order->forgets && !ends_with_any(order->target, made_anew);
}

static zt_status find_keys(making *m) {
    for (int64_t i = 0; i < m->frames.count && m->planned; i++) {
        if (m->watcher && m->watcher->stopped && m->watcher->stopped(m->watcher->user))
            return ZT_ESTOPPED;
        ZT_TRY(zt_renderer_key(&m->keys[i], m->renderer, m->frames.numbers[i]));
    }
    return ZT_OK;
}

/* Renders the image of a position, or leaves the last one where it shows the same. */
static zt_status make_image(making *m, const zt_film_order *order, int64_t position) {
    int64_t frame = m->frames.numbers[position];
    zt_renderer *r = m->renderer;
    if (!m->planned && !m->forgets) ZT_TRY(zt_renderer_key(&m->keys[position], r, frame));
    zt_hash key = m->keys[position];
    if (m->last && !m->timed && !m->forgets && same(m->info.key, key)) {
        m->info.frame = frame;
        m->result->held++;
        return ZT_OK;
    }
    if (m->last) zt_outway_release(m->way, m->last);
    m->last = NULL;
    ZT_TRY(zt_outway_lend(&m->last, m->way));
    ZT_TRY(zt_settings_of_frame(&m->settings, r, order, frame));
    ZT_TRY(zt_renderer_frame(r, frame, m->last, m->watcher));
    m->info = (zt_image_info){.known = !m->forgets,
                              .frame = frame,
                              .rate = r->format.rate,
                              .key = key,
                              .render_s = r->cost.render_s,
                              .seed = r->sampling.seed,
                              .title = order->title,
                              .description = order->description,
                              .settings = m->settings.text};
    memcpy(m->info.world_to_camera, r->world_to_camera, sizeof r->world_to_camera);
    memcpy(m->info.world_to_ndc, r->world_to_ndc, sizeof r->world_to_ndc);
    m->result->rendered++;
    return ZT_OK;
}

static zt_status make_all(making *m, const zt_film_order *order) {
    for (int64_t i = 0; i < m->frames.count; i++) {
        if (zt_output_wants(m->output, i)) {
            ZT_TRY(make_image(m, order, i));
            ZT_TRY(zt_outway_send(m->way, m->last, &m->info));
        } else {
            m->result->kept++;
        }
        if (m->watcher && m->watcher->progress)
            m->watcher->progress(m->watcher->user, i + 1, m->frames.count,
                                 m->frames.numbers[i]);
    }
    return ZT_OK;
}

/* Finds out how many samples there is time for. */
static zt_status take_budget(making *m, const zt_film_order *order) {
    const zt_frames *f = &m->frames;
    if (!m->timed) return ZT_OK;
    for (int64_t i = 1; i < f->count; i++) {
        if (f->numbers[i] == f->numbers[0] + i) continue;
        zt_tell(m->renderer->listener, ZT_ERROR,
                "a budget of time is for frames that follow each other, and %" PRId64
                " comes after %" PRId64,
                f->numbers[i], f->numbers[i - 1]);
        return ZT_EARGUMENT;
    }
    return zt_renderer_budget(m->renderer, f->numbers[0], f->numbers[f->count - 1],
                              &order->budget, m->watcher);
}

static zt_status render_into(making *m, const zt_film_order *order) {
    const zt_renderer *r = m->renderer;
    ZT_TRY(take_budget(m, order));
    ZT_TRY(zt_outway_open(&m->way, m->output, r->format.width, r->format.height, r->aovs,
                          zt_pool_thread_count(r->pool)));
    zt_status status = make_all(m, order);
    if (m->last) zt_outway_release(m->way, m->last);
    zt_status written = zt_outway_close(&m->way); /* waits for what is still being written */
    return written != ZT_OK ? written : status;
}

/* With what the target is known to hold. */
static zt_status render_held(making *m, const zt_film_order *order, zt_hold *hold) {
    zt_output_format format = m->renderer->format;
    zt_output_plan plan = {
        m->frames.numbers,  m->keys,           m->frames.count, hold->records,
        hold->record_count, order->overwrites, zt_hold_record,  hold};
    format.frame_count = m->frames.count;
    if (is_remembered(order)) format.plan = &plan;
    m->planned = format.plan && !m->timed;
    ZT_TRY(find_keys(m));
    ZT_TRY(zt_output_open(&m->output, order->target, &format, order->options,
                          m->renderer->listener));
    zt_status status = render_into(m, order);
    zt_status closed = zt_output_close(&m->output);
    return closed != ZT_OK ? closed : status;
}

/* A movie's frames rise. */
static zt_status copy_frames(making *m, const zt_film_order *order) {
    m->frames.count = order->frames->count;
    m->frames.numbers = calloc((size_t)m->frames.count, sizeof *m->frames.numbers);
    m->keys = calloc((size_t)m->frames.count, sizeof *m->keys);
    if (!m->frames.numbers || !m->keys) return ZT_EMEMORY;
    memcpy(m->frames.numbers, order->frames->numbers,
           (size_t)m->frames.count * sizeof *m->frames.numbers);
    if (!is_still(order->target)) zt_frames_sort(&m->frames);
    return ZT_OK;
}

zt_status zt_film_render(zt_film_result *result, zt_renderer *r, const zt_film_order *order,
                         const zt_watcher *watcher) {
    *result = (zt_film_result){0};
    if (order->frames->count < 1) return ZT_EARGUMENT;
    making m = {.renderer = r, .watcher = watcher, .result = result};
    m.forgets = order->forgets;
    m.timed = order->budget.film_s > 0 || order->budget.frame_s > 0;
    zt_hold hold = {0};
    zt_status status = copy_frames(&m, order);
    if (status == ZT_OK && is_remembered(order))
        status =
            zt_hold_open(&hold, order->target, order->part, order->part_count, r->listener);
    if (status == ZT_OK) status = render_held(&m, order, &hold);
    zt_status let_go = zt_hold_close(&hold);
    if (status == ZT_OK) status = let_go;
    zt_frames_free(&m.frames);
    zt_arena_free(&m.settings.arena);
    free(m.keys);
    return status;
}
