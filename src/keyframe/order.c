#include "keyframe/order.h"

#include <stdlib.h>

/* What a track drives, for finding it. */
typedef struct driven {
    zt_reference reference;
    int32_t track;
} driven;

/* What the tracks wait for: needs[first[i]] .. needs[first[i + 1] - 1] of track i. */
typedef struct graph {
    const zt_animation *animation;
    zt_arena scratch;
    driven *driven; /* sorted */
    int32_t *first, *needs;
    int32_t track, need_count, need_room; /* while it is made */
    bool out_of_memory;
} graph;

static int by_property(const void *pa, const void *pb) {
    const zt_reference *a = &((const driven *)pa)->reference,
                       *b = &((const driven *)pb)->reference;
    if (a->property != b->property) return a->property < b->property ? -1 : 1;
    return (a->index > b->index) - (a->index < b->index);
}

/* ---- what tracks read -----------------------------------------------------------------------
 */

static void visit_formula(const zt_formula *formula, zt_reference_visitor visitor) {
    for (int32_t i = 0; i < formula->term_count; i++)
        if (formula->terms[i].reference.property)
            visitor.visit(visitor.user, formula->terms[i].reference);
}

static void visit_references(const zt_track *track, const zt_scene *rest,
                             zt_reference_visitor visitor) {
    const zt_reference own = {track->property, track->index};
    switch (track->kind) {
    case ZT_TRACK_FORMULA:
        visit_formula(&track->formula, visitor);
        break;
    case ZT_TRACK_ORBIT:
        zt_anchor_visit(&track->orbit.around, own, rest, visitor);
        break;
    case ZT_TRACK_OFFSET:
        visitor.visit(visitor.user, track->offset.from);
        break;
    case ZT_TRACK_LOOK_AT:
        zt_anchor_visit(&track->look_at.target, own, rest, visitor);
        if (track->look_at.from.property) visitor.visit(visitor.user, track->look_at.from);
        break;
    case ZT_TRACK_CURVE:
    case ZT_TRACK_FOLLOW:
    case ZT_TRACK_KIND_COUNT:
        break;
    }
}

/* Notes that the graph's current track needs the one that drives a reference, if there is one.
 */
static void add_need(void *user, zt_reference reference) {
    graph *g = user;
    driven wanted = {.reference = reference};
    const driven *found = bsearch(&wanted, g->driven, (size_t)g->animation->track_count,
                                  sizeof wanted, by_property);
    if (!found || g->out_of_memory) return;
    if (g->need_count == g->need_room) {
        int32_t room = g->need_room ? 2 * g->need_room : 64;
        int32_t *more =
            room > g->need_room ? realloc(g->needs, (size_t)room * sizeof *more) : NULL;
        g->out_of_memory = !more;
        if (!more) return;
        g->needs = more;
        g->need_room = room;
    }
    g->needs[g->need_count++] = found->track;
}

static zt_status make_graph(graph *g, const zt_animation *animation) {
    int32_t count = animation->track_count;
    *g = (graph){.animation = animation};
    g->driven = ZT_PUSH(&g->scratch, driven, (size_t)count);
    g->first = ZT_PUSH(&g->scratch, int32_t, (size_t)count + 1);
    if (!g->driven || !g->first) return ZT_EMEMORY;
    for (int32_t i = 0; i < count; i++)
        g->driven[i] = (driven){{animation->tracks[i].property, animation->tracks[i].index}, i};
    qsort(g->driven, (size_t)count, sizeof *g->driven, by_property);
    for (g->track = 0; g->track < count; g->track++) {
        visit_references(&animation->tracks[g->track], &animation->rest,
                         (zt_reference_visitor){add_need, g});
        g->first[g->track + 1] = g->need_count;
    }
    return g->out_of_memory ? ZT_EMEMORY : ZT_OK;
}

/* ---- the order ------------------------------------------------------------------------------
 */

/* Depth first, without recursion: chains may be as long as the description. */
typedef struct walk {
    int32_t *chain; /* of tracks, each of which waits for the next */
    int32_t *depth; /* by track: its place in the chain + 1; 0 new, -1 done */
    int32_t *next;  /* by track: the need that is looked at next */
    int32_t *order, order_count;
    bool cyclic;
} walk;

static void follow_needs(walk *w, const graph *g, int32_t track, zt_cycle_listener cycles) {
    int32_t length = 1;
    w->chain[0] = track;
    w->depth[track] = 1;
    while (length > 0) {
        int32_t last = w->chain[length - 1];
        if (w->next[last] == g->first[last + 1]) {
            w->order[w->order_count++] = last;
            w->depth[last] = -1;
            length--;
            continue;
        }
        int32_t need = g->needs[w->next[last]++];
        if (w->depth[need] == 0) {
            w->chain[length++] = need;
            w->depth[need] = length;
        } else if (w->depth[need] > 0) {
            int32_t begin = w->depth[need] - 1;
            w->cyclic = true;
            cycles.tell(cycles.user, g->animation, w->chain + begin, length - begin);
        }
    }
}

static zt_status sort_graph(zt_animation *animation, graph *g, zt_cycle_listener cycles) {
    size_t count = (size_t)animation->track_count;
    walk w = {.chain = ZT_PUSH(&g->scratch, int32_t, count),
              .depth = ZT_PUSH(&g->scratch, int32_t, count),
              .next = ZT_PUSH(&g->scratch, int32_t, count),
              .order = ZT_PUSH(&animation->arena, int32_t, count)};
    if (!w.chain || !w.depth || !w.next || !w.order) return ZT_EMEMORY;
    for (size_t i = 0; i < count; i++) w.next[i] = g->first[i];
    for (int32_t i = 0; i < animation->track_count; i++)
        if (w.depth[i] == 0) follow_needs(&w, g, i, cycles);
    if (w.cyclic) return ZT_EDESCRIPTION;
    animation->order = w.order;
    return ZT_OK;
}

zt_status zt_animation_sort(zt_animation *animation, zt_cycle_listener cycles) {
    graph g;
    zt_status status = make_graph(&g, animation);
    if (status == ZT_OK) status = sort_graph(animation, &g, cycles);
    free(g.needs);
    zt_arena_free(&g.scratch);
    return status;
}
