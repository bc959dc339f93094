/* A film: what a target lacks is rendered, behind which it is written; what it has is kept. */
#include <zoetrope/film.h>

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/diag.h"
#include "base/text.h"
#include "encode/output.h"
#include "image/file.h"
#include "image/stamps.h"
#include "sequence/filming.h"
#include "sequence/keepsakes.h"
#include "sequence/opening.h"
#include "sequence/pacing.h"
#include "sequence/split.h"
#include "sequence/verify.h"

static bool ends_with_any(const char *target, const char *const *endings) {
    while (*endings && !zt_text_ends_with(target, *endings, true)) endings++;
    return *endings;
}

static zt_status ask_to_go_on(const zt_filming *m) {
    const zt_watcher *w = m->watcher;
    return w && w->stopped && w->stopped(w->user) ? ZT_ESTOPPED : ZT_OK;
}

/* ---- what is noted --------------------------------------------------------------------------
 */

/* Something was completed: called by the output, in turn. */
static zt_status note_record(void *user, const zt_output_record *record) {
    zt_filming *m = user;
    zt_manifest_line line = {.kind = ZT_LINE_PIECE, .record = *record};
    if (record->kind == ZT_RECORD_IMAGE) {
        const char *slash = record->file ? strrchr(record->file, '/') : NULL;
        if (slash) line.record.file = slash + 1;
        line.kind = ZT_LINE_FRAME;
        line.frame = *zt_filming_of(m, record->first);
    }
    return zt_notes_add(&m->notes, &line);
}

/* An image goes out, by any thread. Of one of its own the output tells when it is complete. */
static zt_status note_image(void *user, const zt_image *image) {
    zt_filming *m = user;
    if (!m->remembers && !m->timed) return ZT_OK;
    zt_manifest_frame *made = zt_filming_of(m, image->info.frame);
    ZT_TRY(zt_sums_of(&made->pixels, m->sums, image));
    if (m->still && m->remembers) return ZT_OK;
    return zt_notes_add(&m->notes, &(zt_manifest_line){.kind = ZT_LINE_FRAME, .frame = *made});
}

/* ---- with a budget --------------------------------------------------------------------------
 */

/* Whether a frame has what this budget chose for it, by this way of sampling. */
static bool is_of_budget(const zt_filming *m, const zt_manifest_frame *f) {
    const zt_sampling *s = &m->renderer->sampling;
    const zt_budget *b = &m->order->budget;
    bool adaptive = s->min != s->max;
    return f && f->max > 0 && f->budget.film_s == b->film_s &&
           f->budget.frame_s == b->frame_s &&
           (adaptive ? f->min == s->min && f->error > 0 : f->min == f->max);
}

/* Finds out how many samples there is time for. */
static zt_status take_budget(zt_filming *m) {
    zt_budget left = m->order->budget;
    m->rest.numbers = calloc((size_t)m->frames.count, sizeof *m->rest.numbers);
    if (!m->rest.numbers) return ZT_EMEMORY;
    for (int64_t i = 0; i < m->frames.count; i++) {
        if (m->wanted[i])
            m->rest.numbers[m->rest.count++] = m->frames.numbers[i];
        else
            left.film_s -= fmax(zt_manifest_time(m->notes.known, m->frames.numbers[i]), 0);
    }
    const double least = 1e-3; /* of it, that is left whatever was spent */
    if (m->order->budget.film_s > 0)
        left.film_s = fmax(left.film_s, least * m->order->budget.film_s);
    if (m->rest.count == 0) return ZT_OK;
    return zt_renderer_budget(m->renderer, &m->rest, &left, m->watcher);
}

/* ---- before the first frame -----------------------------------------------------------------
 */

/* With a budget, those of frames that were rendered with it. */
static zt_status find_keys(zt_filming *m) {
    zt_renderer *r = m->renderer;
    const zt_manifest *followed = r->followed;
    zt_status status = ZT_OK;
    bool plans = m->remembers && !(m->timed && m->order->overwrites);
    for (int64_t i = 0; i < m->frames.count && plans && status == ZT_OK; i++) {
        const zt_manifest *known = m->notes.known;
        const zt_manifest_frame *found = zt_manifest_find(known, m->frames.numbers[i]);
        if (m->timed && !is_of_budget(m, found)) continue;
        if (m->timed) zt_renderer_follow(r, known);
        status = ask_to_go_on(m);
        if (status == ZT_OK) status = zt_renderer_key(&m->keys[i], r, m->frames.numbers[i]);
    }
    zt_renderer_follow(r, followed);
    return status;
}

/* Asks the output what it lacks. */
static zt_status find_wanted(zt_filming *m) {
    for (int64_t i = 0; i < m->frames.count; i++) {
        ZT_TRY(ask_to_go_on(m));
        m->wanted[i] = zt_output_wants(m->output, i);
        m->result->kept += !m->wanted[i];
    }
    return ZT_OK;
}

static zt_status make_film(zt_filming *m) {
    ZT_TRY(find_wanted(m));
    const zt_verify_job job = {m->frames.numbers, m->keys,        m->wanted,
                               m->frames.count,   m->notes.known, m->order->target};
    if (m->order->verify > 0 && m->remembers)
        ZT_TRY(zt_verify_frames(&m->result->verified, &job, m->order->verify, m->renderer,
                                m->watcher));
    if (m->timed) ZT_TRY(take_budget(m));
    return zt_filming_all(m);
}

/* A film's sound is that from its first frame on. */
static zt_status choose_wishes(zt_filming *m) {
    const zt_output_option *wish = m->order->options;
    size_t count = 0;
    while (wish && wish[count].name) count++;
    zt_output_option *next = m->wishes = calloc(count + 1, sizeof *m->wishes);
    if (!m->wishes) return ZT_EMEMORY;
    for (; wish && wish->name; wish++) {
        bool mute = zt_text_equal(wish->name, "audio") && m->frames.numbers[0] > 0;
        if (!mute) *next++ = *wish;
        if (mute && wish->value && !m->still)
            zt_tell(m->renderer->listener, ZT_WARNING,
                    "no sound: that of the film begins with frame 0");
    }
    return ZT_OK;
}

static zt_status begin(void *user) { return zt_filming_begin(user); }

/* Opens the output, and meanwhile renders the first frame, if nothing is known of earlier runs:
 * then it is wanted, but for what an encoder may have kept of one that was killed early. */
static zt_status open_and_begin(zt_filming *m, const zt_output_format *format) {
    zt_opening opening = {.target = m->order->target,
                          .format = format,
                          .options = m->wishes,
                          .listener = m->renderer->listener,
                          .watcher = m->watcher};
    const zt_watcher meanwhile = zt_opening_watcher(&opening);
    const zt_manifest *known = m->notes.known;
    if (zt_opening_takes(&opening) && !m->timed &&
        (m->order->overwrites || !known || known->record_count == 0)) {
        ZT_TRY(zt_renderer_start(m->renderer));
        opening.work = begin;
        opening.user = m;
        m->watcher = &meanwhile;
    }
    zt_status status = zt_opening_open(&m->output, &opening);
    m->watcher = opening.watcher;
    return status;
}

static zt_status make_into_output(zt_filming *m) {
    zt_output_format format = m->renderer->format;
    const zt_output_plan plan = {.frames = m->frames.numbers,
                                 .keys = m->keys,
                                 .count = m->frames.count,
                                 .records = m->notes.known ? m->notes.known->records : NULL,
                                 .record_count =
                                     m->notes.known ? (int64_t)m->notes.known->record_count : 0,
                                 .overwrites = m->order->overwrites,
                                 .completed = note_record,
                                 .user = m};
    m->planned = m->remembers && !m->timed;
    format.frame_count = m->frames.count;
    format.description = m->order->description;
    ZT_TRY(zt_settings_of_film(&format.settings, m->renderer, m->order, &m->settings.arena));
    if (m->remembers) format.plan = &plan;
    ZT_TRY(find_keys(m));
    if (m->planned && m->still)
        ZT_TRY(zt_again_group(m->frames.numbers, m->keys, m->frames.count));
    ZT_TRY(choose_wishes(m));
    ZT_TRY(zt_filming_open(m, note_image));
    zt_status status = open_and_begin(m, &format);
    if (status == ZT_OK) status = make_film(m);
    zt_status written = zt_filming_close(m);
    if (m->output) m->result->unconverted = zt_output_spared(m->output);
    m->result->unsummed = zt_sums_spared(m->sums);
    m->result->tiles = (m->result->rendered + m->result->held) * zt_stamp_tiles(format.width) *
                       zt_stamp_tiles(format.height);
    zt_status closed = zt_output_close(&m->output);
    if (written != ZT_OK) status = written;
    return closed != ZT_OK ? closed : status;
}

static zt_status take_part(zt_filming *m) {
    const zt_film_order *o = m->order;
    if (o->part_count > 0)
        ZT_TRY(zt_split_take(&m->frames, o->part, o->part_count,
                             m->remembers ? &m->notes : NULL, m->renderer));
    m->result->count = m->frames.count;
    if (m->frames.count == 0)
        zt_tell(m->renderer->listener, ZT_WARNING,
                "part %" PRId64 " of %" PRId64 " has no frames", o->part, o->part_count);
    return ZT_OK;
}

static zt_status push_lists(zt_filming *m) {
    size_t count = (size_t)m->frames.count;
    m->keys = calloc(count, sizeof *m->keys);
    m->wanted = calloc(count, sizeof *m->wanted);
    m->made = calloc(count, sizeof *m->made);
    if (!m->keys || !m->wanted || !m->made) return ZT_EMEMORY;
    for (size_t i = 0; i < count; i++)
        m->made[i] = (zt_manifest_frame){.frame = m->frames.numbers[i], .render_s = -1};
    qsort(m->made, count, sizeof *m->made, zt_filming_by_frame);
    return zt_sums_open(&m->sums);
}

static zt_status open_notes(zt_filming *m) {
    const zt_renderer *r = m->renderer;
    char *written = zt_notes_wishes(m->order->options);
    if (!written) return ZT_EMEMORY;
    const zt_manifest_line header = {.kind = ZT_LINE_HEADER,
                                     .width = r->format.width,
                                     .height = r->format.height,
                                     .precision = r->precision,
                                     .description = m->order->description,
                                     .written = written};
    bool alone = m->remembers && m->order->part_count == 0;
    zt_status status =
        zt_notes_open(&m->notes, m->order->target, &header, !m->remembers, alone, r->listener);
    free(written);
    return status;
}

static zt_status make(zt_filming *m) {
    const zt_film_order *o = m->order;
    m->frames.count = o->frames->count;
    m->frames.numbers = calloc((size_t)m->frames.count, sizeof *m->frames.numbers);
    if (!m->frames.numbers) return ZT_EMEMORY;
    memcpy(m->frames.numbers, o->frames->numbers,
           (size_t)m->frames.count * sizeof *m->frames.numbers);
    if (!m->still || m->timed) zt_frames_sort(&m->frames);
    /* Parts share a target only where each makes files of its own. */
    int64_t part = m->still ? o->part : 0, part_count = m->still ? o->part_count : 0;
    if (m->remembers)
        ZT_TRY(zt_hold_open(&m->hold, o->target, part, part_count, m->renderer->listener));
    if (m->remembers || m->timed) ZT_TRY(open_notes(m));
    ZT_TRY(take_part(m));
    if (m->frames.count == 0) return ZT_OK;
    ZT_TRY(push_lists(m));
    const zt_keepsakes_order kept = {.target = o->target,
                                     .frames = &m->frames,
                                     .part_count = part_count,
                                     .bytes_max = o->keep_bytes,
                                     .anew = o->overwrites};
    if (m->remembers && !m->timed)
        ZT_TRY(zt_keepsakes_open(&m->renderer->keepsakes, &kept, m->renderer));
    return make_into_output(m);
}

zt_status zt_film_render(zt_film_result *result, zt_renderer *r, const zt_film_order *order,
                         const zt_watcher *watcher) {
    static const char *const made_anew[] = {".hash", NULL};
    *result = (zt_film_result){0};
    if (order->frames->count < 1) return ZT_EARGUMENT;
    zt_filming m = {.renderer = r, .order = order, .watcher = watcher, .result = result};
    m.still = ends_with_any(order->target, zt_image_file_endings);
    m.remembers = !order->forgets && !ends_with_any(order->target, made_anew);
    m.timed = order->budget.film_s > 0 || order->budget.frame_s > 0;
    zt_status status = make(&m);
    zt_keepsakes_close(&r->keepsakes);
    bool nothing = status != ZT_OK && result->rendered == 0;
    zt_status noted =
        zt_notes_close(&m.notes, nothing && (!m.remembers || zt_hold_alone(&m.hold)));
    if (status == ZT_OK) status = noted;
    zt_hold_close(&m.hold);
    zt_again_close(&m.again);
    zt_sums_close(&m.sums);
    zt_frames_free(&m.frames);
    zt_frames_free(&m.rest);
    zt_arena_free(&m.settings.arena);
    free(m.wishes);
    free(m.made);
    free(m.wanted);
    free(m.keys);
    return status;
}
