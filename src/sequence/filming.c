#include "sequence/filming.h"

#include <stdlib.h>
#include <string.h>

#include "sequence/keepsakes.h"
#include "sequence/pacing.h"

int zt_filming_by_frame(const void *a, const void *b) {
    const zt_manifest_frame *one = a, *other = b;
    return (one->frame > other->frame) - (one->frame < other->frame);
}

zt_manifest_frame *zt_filming_of(const zt_filming *m, int64_t frame) {
    const zt_manifest_frame wanted = {.frame = frame};
    return bsearch(&wanted, m->made, (size_t)m->frames.count, sizeof wanted,
                   zt_filming_by_frame);
}

static zt_status render_image(zt_filming *m, int64_t frame, zt_hash key) {
    zt_renderer *r = m->renderer;
    zt_manifest_frame *made = zt_filming_of(m, frame);
    zt_sampling sampling;
    ZT_TRY(zt_settings_of_frame(&m->settings, r, m->order, frame));
    ZT_TRY(zt_pacing_sampling(&sampling, r, frame));
    ZT_TRY(zt_renderer_frame(r, frame, m->last, m->watcher));
    m->last->info =
        (zt_image_info){.known = true,
                        .frame = frame,
                        .rate = r->format.rate,
                        .key = key,
                        .render_s = r->cost.render_s,
                        .seed = r->sampling.seed,
                        .title = m->order->title,
                        .description = m->order->description,
                        .view = r->format.color.wished ? "color" : zt_view_name(r->format.view),
                        .settings = m->settings.text};
    memcpy(m->last->info.world_to_camera, r->world_to_camera, sizeof r->world_to_camera);
    memcpy(m->last->info.world_to_ndc, r->world_to_ndc, sizeof r->world_to_ndc);
    made->key = key;
    made->render_s = r->cost.freeze_s + r->cost.prepare_s + r->cost.render_s;
    if (m->timed) {
        made->min = sampling.min;
        made->max = sampling.max;
        made->error = sampling.error;
        made->mean_max = sampling.mean_max;
        made->budget = m->order->budget;
    }
    m->fresh = true;
    return ZT_OK;
}

/* Has m->last show the frame of a position: as it is, from one that was kept, or rendered. */
static zt_status make_image(zt_filming *m, int64_t position) {
    int64_t frame = m->frames.numbers[position];
    zt_hash *key = &m->keys[position];
    if (!m->planned) ZT_TRY(zt_renderer_key(key, m->renderer, frame));
    bool equal = m->last && !m->timed && zt_hash_equal(m->last->info.key, *key);
    const zt_image *kept = m->again && !equal ? zt_again_find(m->again, position) : NULL;
    if (!equal) {
        if (m->last) zt_outway_release(m->way, m->last);
        m->last = NULL;
        ZT_TRY(zt_outway_lend(&m->last, m->way));
    }
    if (!equal && !kept) return render_image(m, frame, *key);
    if (kept) zt_again_copy(m->last, kept);
    zt_manifest_frame *made = zt_filming_of(m, frame);
    made->key = *key;
    made->render_s = zt_filming_of(m, m->last->info.frame)->render_s;
    m->result->held++;
    return ZT_OK;
}

/* What is fresh was rendered while the output was being opened, and is the first one. */
static zt_status make_and_send(zt_filming *m, int64_t position) {
    if (!m->fresh) ZT_TRY(make_image(m, position));
    zt_image_info info = m->last->info;
    info.frame = m->frames.numbers[position];
    if (m->fresh) {
        m->result->rendered++;
        zt_keepsakes_take(m->renderer->keepsakes, info.frame, info.key);
    }
    ZT_TRY(zt_outway_send(m->way, m->last, &info));
    return m->again ? zt_again_keep(m->again, position, m->last) : ZT_OK;
}

zt_status zt_filming_begin(zt_filming *m) { return make_image(m, 0); }

zt_status zt_filming_all(zt_filming *m) {
    if (m->planned) ZT_TRY(zt_again_open(&m->again, m->keys, m->wanted, m->frames.count));
    zt_outway_lead(m->way, m->output);
    for (int64_t i = 0; i < m->frames.count; i++) {
        if (m->wanted[i]) ZT_TRY(make_and_send(m, i));
        m->fresh = false;
        if (m->watcher && m->watcher->progress)
            m->watcher->progress(m->watcher->user, i + 1, m->frames.count,
                                 m->frames.numbers[i]);
    }
    return ZT_OK;
}

zt_status zt_filming_open(zt_filming *m, zt_status (*look)(void *user, const zt_image *image)) {
    const zt_renderer *r = m->renderer;
    ZT_TRY(zt_outway_open(&m->way, r->format.width, r->format.height, r->aovs,
                          zt_pool_thread_count(r->pool)));
    zt_outway_show(m->way, look, m);
    return ZT_OK;
}

zt_status zt_filming_close(zt_filming *m) {
    if (m->last) zt_outway_release(m->way, m->last);
    return zt_outway_close(&m->way);
}
