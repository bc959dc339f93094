#include "sequence/verify.h"

#include <inttypes.h>

#include <zoetrope/aov.h>

#include "base/diag.h"
#include "base/hash.h"
#include "sequence/pacing.h"
#include "sequence/renderer.h"
#include "sequence/sums.h"

/* Whether it is finished, and known what it was. */
static const zt_manifest_frame *finished(const zt_verify_job *job, int64_t position) {
    if (job->wanted[position]) return NULL;
    const zt_manifest_frame *f = zt_manifest_find(job->known, job->frames[position]);
    bool known = f && zt_hash_equal(f->key, job->keys[position]) && zt_hash_is_known(f->pixels);
    return known ? f : NULL;
}

/* The name of its file, for words. */
static const char *file_of(const zt_verify_job *job, int64_t frame) {
    const zt_manifest *m = job->known;
    for (size_t i = 0; i < m->record_count; i++)
        if (m->records[i].kind == ZT_RECORD_IMAGE && m->records[i].first == frame)
            return m->records[i].file;
    return job->target;
}

static zt_status verify(int64_t *verified, const zt_verify_job *job, const zt_manifest_frame *f,
                        zt_image *image, zt_renderer *r, const zt_watcher *watcher) {
    zt_sampling own = r->sampling;
    ZT_TRY(zt_pacing_sampling(&r->sampling, r, f->frame));
    zt_status status = zt_renderer_take(r, f->frame, image, watcher); /* all of it */
    r->sampling = own;
    ZT_TRY(status);
    zt_hash checksum;
    ZT_TRY(zt_sums_of(&checksum, NULL, image));
    bool good = zt_hash_equal(checksum, f->pixels);
    *verified += good;
    if (good) return ZT_OK;
    zt_tell(r->listener, ZT_ERROR,
            "frame %" PRId64 " was rendered again, and is not what %s was made of; the file "
            "stays as it is",
            f->frame, file_of(job, f->frame));
    return ZT_OK;
}

static zt_status verify_some(int64_t *verified, const zt_verify_job *job, int64_t most,
                             zt_image *image, zt_renderer *r, const zt_watcher *watcher) {
    int64_t count = 0, seen = 0, taken = 0;
    for (int64_t i = 0; i < job->count; i++) count += finished(job, i) != NULL;
    if (most > count) most = count;
    for (int64_t i = 0; i < job->count; i++) {
        const zt_manifest_frame *f = finished(job, i);
        if (!f) continue;
        /* Each is the one in the middle of its part of the film. */
        if (taken == most || seen++ != (2 * taken + 1) * count / (2 * most)) continue;
        ZT_TRY(verify(verified, job, f, image, r, watcher));
        taken++;
    }
    return *verified == taken ? ZT_OK : ZT_EFILE;
}

zt_status zt_verify_frames(int64_t *verified, const zt_verify_job *job, int64_t most,
                           zt_renderer *r, const zt_watcher *watcher) {
    const zt_manifest *followed = r->followed;
    zt_image *image;
    *verified = 0;
    ZT_TRY(zt_image_create(&image, r->format.width, r->format.height));
    zt_status status = zt_image_add_aovs(image, r->aovs);
    zt_renderer_follow(r, job->known); /* with the samples that they took */
    if (status == ZT_OK) status = verify_some(verified, job, most, image, r, watcher);
    zt_renderer_follow(r, followed);
    zt_image_free(&image);
    return status;
}
