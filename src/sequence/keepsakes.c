#include "sequence/keepsakes.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/diag.h"
#include "base/text.h"
#include "keyframe/animation.h"
#include "render/keepsake.h"
#include "render/reuse.h"

/* How much longer than one core takes to make and find its keepsake a frame must take all of
 * them; and what that is: so much for each, and for each byte that it has room for, in seconds;
 * and how many these are for a pixel at least. A quarter of it is finding. */
static const double worth = 3, file_s = 2e-4, byte_s = 1e-9, pixel_bytes = 21;
/* How long it may wait for the disk in all: so many seconds, and a share of the time for
 * rendering. */
static const double grace_s = 1, patience = 0.03;
/* One is given up for another frame's that takes so much longer. */
static const double dearer = 1.25;

typedef struct entry {
    int64_t frame;
    uint64_t size;
    double render_s;
    zt_hash view, key;
} entry;

struct zt_keepsakes {
    zt_renderer *renderer;
    char *directory;
    const zt_frames *frames;
    bool shared;
    uint64_t most, size; /* bytes that there may be, and are */
    entry *entries;      /* by rising frame */
    size_t count, room;
    double expected_s;           /* the next frame takes, by the last one */
    double rendered_s, waited_s; /* in all; the latter for the errand */
    zt_picture picture;          /* what is copied from */
    bool offered;                /* for the frame that is being rendered */
    unsigned char *found, *made; /* bytes that are read, and that are written by the errand */
    size_t found_room, made_room;
    zt_errand *errand;
    int64_t made_frame;
    uint64_t made_size, made_total; /* bytes; and with all others */
    atomic_bool making;             /* the errand is not done */
    int failure;                    /* why it could not be done: errno */
    bool told;
};

/* ---- what there is --------------------------------------------------------------------------
 */

/* The first entry that is not of a frame before. */
static size_t place_of(const zt_keepsakes *k, int64_t frame) {
    size_t low = 0, high = k->count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (k->entries[middle].frame < frame)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static entry *find(const zt_keepsakes *k, int64_t frame) {
    size_t at = place_of(k, frame);
    return at < k->count && k->entries[at].frame == frame ? &k->entries[at] : NULL;
}

static void forget(zt_keepsakes *k, entry *e) {
    k->size -= e->size;
    k->count--;
    memmove(e, e + 1, (size_t)(k->entries + k->count - e) * sizeof *e);
}

/* In the place of one of the same frame. */
static zt_status remember(zt_keepsakes *k, const entry *new) {
    entry *old = find(k, new->frame);
    if (old) {
        k->size = k->size - old->size + new->size;
        *old = *new;
        return ZT_OK;
    }
    if (k->count == k->room) {
        size_t room = k->room ? 2 * k->room : 64;
        entry *larger = reallocarray(k->entries, room, sizeof *larger);
        if (!larger) return ZT_EMEMORY;
        k->entries = larger;
        k->room = room;
    }
    entry *at = k->entries + place_of(k, new->frame);
    memmove(at + 1, at, (size_t)(k->entries + k->count - at) * sizeof *at);
    *at = *new;
    k->count++;
    k->size += new->size;
    return ZT_OK;
}

/* The path of a frame's file, of the caller to free; NULL when out of memory. */
static char *path_of(const zt_keepsakes *k, int64_t frame, const char *ending) {
    return zt_text_print("%s/%" PRId64 "%s", k->directory, frame, ending);
}

static void drop(zt_keepsakes *k, entry *e) {
    char *path = path_of(k, e->frame, "");
    if (path) unlink(path);
    free(path);
    forget(k, e);
}

static entry *cheapest(const zt_keepsakes *k, const entry *but) {
    entry *least = NULL;
    for (size_t i = 0; i < k->count; i++) {
        entry *e = &k->entries[i];
        if (e != but && (!least || e->render_s < least->render_s)) least = e;
    }
    return least;
}

/* Makes room for a frame's, which takes so long to render; false where the others are dearer.
 */
static bool make_room(zt_keepsakes *k, int64_t frame, uint64_t size, double render_s) {
    for (;;) {
        const entry *old = find(k, frame);
        if (k->size - (old ? old->size : 0) + size <= k->most) return true;
        entry *least = cheapest(k, old);
        if (!least || least->render_s * dearer > render_s) return false;
        drop(k, least);
    }
}

/* ---- files ----------------------------------------------------------------------------------
 */

static bool read_all(int file, void *bytes, size_t size) {
    for (char *at = bytes; size > 0;) {
        ssize_t got = read(file, at, size);
        if (got <= 0) return false;
        at += got;
        size -= (size_t)got;
    }
    return true;
}

static bool write_all(int file, const void *bytes, size_t size) {
    for (const char *at = bytes; size > 0;) {
        ssize_t put = write(file, at, size);
        if (put <= 0) return false;
        at += put;
        size -= (size_t)put;
    }
    return true;
}

static bool read_head(zt_keepsake_head *head, int directory, const char *name) {
    struct stat there;
    int file = openat(directory, name, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    bool good = file >= 0 && fstat(file, &there) == 0 && S_ISREG(there.st_mode) &&
                read_all(file, head, sizeof *head) &&
                zt_keepsake_knows(head, (uint64_t)there.st_size, zt_arithmetic);
    if (file >= 0) close(file);
    return good;
}

/* Whether this run may remove a frame's: where others share the target, of its own frames. */
static bool is_own(const zt_keepsakes *k, int64_t frame) {
    bool own = !k->shared;
    for (int64_t i = 0; i < k->frames->count && !own; i++) own = k->frames->numbers[i] == frame;
    return own;
}

/* What is called by a number is a keepsake, or was to be one. */
static zt_status look_at(zt_keepsakes *k, int directory, const char *name, bool all_go) {
    char *end;
    zt_keepsake_head head;
    int64_t frame = strtoll(name, &end, 10);
    bool named = name[0] >= '0' && name[0] <= '9' && (!*end || zt_text_equal(end, ".part"));
    if (!named || !is_own(k, frame)) return ZT_OK;
    bool good = !*end && !all_go && frame < k->renderer->animation->film.frame_count &&
                read_head(&head, directory, name) && head.frame == frame;
    if (!good) {
        unlinkat(directory, name, 0);
        return ZT_OK;
    }
    return remember(k, &(entry){frame, head.size, head.render_s, head.view, head.key});
}

static zt_status look_around(zt_keepsakes *k, bool all_go) {
    DIR *directory = opendir(k->directory);
    if (!directory) return ZT_OK; /* there is none yet */
    zt_status status = ZT_OK;
    for (struct dirent *d; status == ZT_OK && (d = readdir(directory));)
        status = look_at(k, dirfd(directory), d->d_name, all_go);
    closedir(directory);
    if (all_go) rmdir(k->directory); /* where it is empty */
    return status;
}

/* Whether the disk has as much free as there is then. */
static bool has_room(const zt_keepsakes *k) {
    struct statvfs disk;
    return statvfs(k->directory, &disk) == 0 &&
           (double)disk.f_bavail * (double)disk.f_frsize > (double)k->made_total;
}

/* Over the older one, which takes an eighth of the time that a new file does. Returns errno
 * where it fails. */
static int write_file(const zt_keepsakes *k, const char *path, const char *aside) {
    if (rename(path, aside) != 0 && errno != ENOENT) return errno;
    int failure = 0, file = open(aside, O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (file < 0) return errno;
    errno = ENOSPC; /* where nothing else is to blame */
    if (!has_room(k) || !write_all(file, k->made, k->made_size) ||
        ftruncate(file, (off_t)k->made_size) != 0)
        failure = errno;
    if (close(file) != 0 && !failure) failure = errno;
    if (!failure && rename(aside, path) != 0) failure = errno;
    if (failure) unlink(aside);
    return failure;
}

/* Behind the rendering. Nobody sees half of it. */
static void write_made(void *user) {
    zt_keepsakes *k = user;
    char *path = path_of(k, k->made_frame, ""), *aside = path_of(k, k->made_frame, ".part");
    zt_keepsake_seal(k->made);
    mkdir(k->directory, 0777); /* if it is not there */
    k->failure = path && aside ? write_file(k, path, aside) : ENOMEM;
    free(path);
    free(aside);
    atomic_store(&k->making, false);
}

/* ---- before and after a frame ---------------------------------------------------------------
 */

/* How long a frame must take for one with room for so many bytes. */
static double least_s(double bytes) { return worth * (file_s + byte_s * bytes); }

/* Grows memory whose contents mean nothing. */
static bool grow(unsigned char **bytes, size_t *room, size_t size) {
    if (*room >= size) return true;
    free(*bytes);
    *bytes = malloc(size);
    *room = *bytes ? size : 0;
    return *bytes;
}

static bool read_keepsake(zt_keepsakes *k, const entry *e) {
    char *path = path_of(k, e->frame, "");
    int file = path ? open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK) : -1;
    bool good = file >= 0 && grow(&k->found, &k->found_room, e->size) &&
                read_all(file, k->found, e->size) &&
                zt_keepsake_read(&k->picture, k->found, e->size, zt_arithmetic);
    if (file >= 0) close(file);
    free(path);
    return good;
}

void zt_keepsakes_offer(zt_keepsakes *k, const zt_render_job *job, int64_t frame) {
    if (!k) return;
    const zt_output_format *format = &k->renderer->format;
    zt_reuse *reuse = k->renderer->reuse;
    entry *e = find(k, frame);
    k->offered = e && zt_hash_equal(e->view, job->view) && read_keepsake(k, e);
    if (e && !k->offered) drop(k, e);
    reuse->kept = k->offered ? &k->picture : NULL;
    reuse->keeps = !k->told &&
                   k->expected_s >= least_s(pixel_bytes * format->width * format->height) &&
                   !zt_reuse_hindrance(job); /* of use */
}

/* Hands the picture over to the errand, if there is room for it. */
static zt_status make(zt_keepsakes *k, const zt_picture *picture, zt_keepsake_head *head) {
    if (!grow(&k->made, &k->made_room, zt_keepsake_room(picture))) return ZT_EMEMORY;
    zt_keepsake_write(k->made, head, picture, zt_arithmetic);
    if (!make_room(k, head->frame, head->size, head->render_s)) return ZT_OK;
    ZT_TRY(
        remember(k, &(entry){head->frame, head->size, head->render_s, head->view, head->key}));
    if (!k->errand) ZT_TRY(zt_errand_open(&k->errand, write_made, k));
    k->made_size = head->size;
    k->made_total = k->size;
    atomic_store(&k->making, true);
    zt_errand_send(k->errand);
    return ZT_OK;
}

/* Waits for what is under way, and tells of it where it failed. */
static void settle(zt_keepsakes *k) {
    double begun_s = zt_clock_s();
    if (k->errand) zt_errand_wait(k->errand);
    k->waited_s += zt_clock_s() - begun_s;
    if (!k->failure || k->told) return;
    entry *e = find(k, k->made_frame);
    if (e) forget(k, e);
    zt_tell(k->renderer->listener, ZT_WARNING,
            "cannot write %s/%" PRId64 ": %s: no more frames are kept for later edits",
            k->directory, k->made_frame, strerror(k->failure));
    k->told = true;
}

void zt_keepsakes_take(zt_keepsakes *k, int64_t frame, zt_hash key) {
    if (!k) return;
    zt_renderer *r = k->renderer;
    const zt_frame_cost *cost = &r->cost;
    const zt_picture *last = &r->reuse->last;
    const entry *old = find(k, frame);
    double render_s = cost->own_s;
    r->reuse->kept = NULL;
    if (k->offered) {
        render_s = fmax(render_s, old->render_s);
        r->stats.found++;
        r->stats.found_tiles += cost->tiles;
        r->stats.found_copied += cost->tiles_copied;
    }
    k->expected_s = render_s;
    k->rendered_s += cost->own_s;
    bool fresh = k->offered && zt_hash_equal(old->key, key);
    if (fresh || !r->reuse->keeps || !last->whole) return;
    if (render_s < least_s((double)zt_keepsake_room(last))) return;
    if (atomic_load(&k->making) && k->waited_s > grace_s + patience * k->rendered_s) return;
    settle(k);
    if (k->failure) return;
    k->made_frame = frame;
    zt_keepsake_head head = {.frame = frame, .render_s = render_s, .key = key};
    if (make(k, last, &head) != ZT_OK) k->failure = ENOMEM;
}

/* ---- opening, closing -----------------------------------------------------------------------
 */

static zt_status begin(zt_keepsakes *k, const zt_keepsakes_order *order) {
    k->directory = zt_text_print("%s.keepsakes", order->target);
    if (!k->directory) return ZT_EMEMORY;
    ZT_TRY(look_around(k, order->anew || order->bytes_max == 0));
    for (entry *e; k->size > k->most && (e = cheapest(k, NULL));) drop(k, e);
    return ZT_OK;
}

zt_status zt_keepsakes_open(zt_keepsakes **out, const zt_keepsakes_order *order,
                            zt_renderer *r) {
    *out = NULL;
    if (!r->reuse && order->bytes_max > 0) return ZT_OK;
    zt_keepsakes *k = calloc(1, sizeof *k);
    if (!k) return ZT_EMEMORY;
    int64_t shares = order->part_count > 0 ? order->part_count : 1;
    k->renderer = r;
    k->frames = order->frames;
    k->shared = order->part_count > 0;
    k->most = (uint64_t)(order->bytes_max / shares);
    k->expected_s = INFINITY; /* nothing is known yet */
    zt_status status = begin(k, order);
    if (status == ZT_OK && order->bytes_max > 0)
        *out = k;
    else
        zt_keepsakes_close(&k);
    return status;
}

void zt_keepsakes_close(zt_keepsakes **slot) {
    zt_keepsakes *k = *slot;
    if (!k) return;
    settle(k);
    zt_errand_close(&k->errand);
    if (k->renderer->reuse) {
        k->renderer->reuse->kept = NULL;
        k->renderer->reuse->keeps = false;
    }
    k->renderer->stats.keepsakes = (int64_t)k->count;
    k->renderer->stats.keepsake_bytes = (int64_t)k->size;
    if (k->directory) rmdir(k->directory); /* where it is empty */
    zt_picture_close(&k->picture);
    free(k->directory);
    free(k->entries);
    free(k->found);
    free(k->made);
    free(k);
    *slot = NULL;
}
