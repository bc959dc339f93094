#include "sequence/split.h"

#include <stdlib.h>
#include <string.h>

#include "base/diag.h"
#include "base/hash.h"

enum { PARTS_MAX = 10000 }; /* that are noted */

static double cost_at(const double *costs, int64_t position) {
    return costs ? costs[position] : 1;
}

/* A frame belongs where its middle is. */
void zt_split_ends(int64_t *ends, int64_t count, const double *costs, int64_t frame_count) {
    double sum = 0, before = 0;
    for (int64_t i = 0; i < frame_count; i++) sum += cost_at(costs, i);
    if (!(sum > 0)) costs = NULL, sum = (double)frame_count;
    int64_t i = 0;
    for (int64_t p = 0; p < count; p++) {
        double end = sum * (double)(p + 1) / (double)count;
        for (; i < frame_count && before + cost_at(costs, i) / 2 < end; i++)
            before += cost_at(costs, i);
        ends[p] = p + 1 < count ? i : frame_count;
    }
}

/* What each frame took; of those that show the same as the one before, nothing. NULL, too,
 * where one is not known. */
static double *known_costs(const zt_manifest *known, const zt_frames *frames) {
    double *costs = malloc((size_t)frames->count * sizeof *costs);
    const zt_manifest_frame *before = NULL;
    for (int64_t i = 0; costs && i < frames->count; i++) {
        const zt_manifest_frame *f = zt_manifest_find(known, frames->numbers[i]);
        if (!f || f->render_s < 0) {
            free(costs);
            return NULL;
        }
        bool held = before && zt_hash_is_known(f->key) && zt_hash_equal(before->key, f->key);
        costs[i] = held ? 0 : f->render_s;
        before = f;
    }
    return costs;
}

/* What is divided: which frames, and what the film is, as far as three of them show. */
static zt_status find_name(zt_hash *name, const zt_frames *f, zt_renderer *r) {
    zt_hash parts[4] = {zt_hash_bytes(f->numbers, (size_t)f->count * sizeof *f->numbers)};
    const int64_t looked_at[] = {0, f->count / 2, f->count - 1};
    for (int i = 0; i < 3; i++)
        ZT_TRY(zt_renderer_key(&parts[i + 1], r, f->numbers[looked_at[i]]));
    *name = zt_hash_bytes(parts, sizeof parts);
    return ZT_OK;
}

static zt_status note_split(zt_notes *notes, zt_hash name, int64_t *ends, int64_t count,
                            const zt_frames *frames) {
    double *costs = known_costs(notes->known, frames);
    zt_split_ends(ends, count, costs, frames->count);
    free(costs);
    ZT_TRY(zt_notes_add(
        notes, &(zt_manifest_line){.kind = ZT_LINE_SPLIT, .split = {name, ends, count}}));
    return zt_notes_recall(notes); /* somebody may have been first */
}

static zt_status find_ends(int64_t *ends, int64_t count, const zt_frames *frames,
                           zt_notes *notes, zt_renderer *r) {
    zt_hash name;
    zt_split_ends(ends, count, NULL, frames->count);
    if (!notes || count > PARTS_MAX) return ZT_OK;
    ZT_TRY(find_name(&name, frames, r));
    const zt_manifest_split *split = zt_manifest_split_of(notes->known, name, count);
    if (!split) {
        ZT_TRY(note_split(notes, name, ends, count, frames));
        split = zt_manifest_split_of(notes->known, name, count);
    }
    if (split && split->ends[count - 1] == frames->count)
        memcpy(ends, split->ends, (size_t)count * sizeof *ends);
    return ZT_OK;
}

zt_status zt_split_take(zt_frames *frames, int64_t part, int64_t count, zt_notes *notes,
                        zt_renderer *r) {
    int64_t *ends = malloc((size_t)count * sizeof *ends);
    zt_status status = ends ? find_ends(ends, count, frames, notes, r) : ZT_EMEMORY;
    if (status == ZT_OK) {
        int64_t first = part > 1 ? ends[part - 2] : 0;
        frames->count = ends[part - 1] - first;
        memmove(frames->numbers, frames->numbers + first,
                (size_t)frames->count * sizeof *frames->numbers);
    }
    free(ends);
    return status;
}
