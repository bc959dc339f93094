#include "sequence/hold.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/diag.h"
#include "base/text.h"
#include "encode/aside.h"

static zt_status fail(const zt_hold *h, const char *path) {
    zt_tell(h->listener, ZT_ERROR, "cannot write %s: %s", path, strerror(errno));
    return ZT_EFILE;
}

static zt_status open_lock(const zt_hold *h, zt_lock *lock) {
    lock->file = open(lock->path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (lock->file < 0 && errno == ENOENT) { /* its directory is missing */
        zt_aside aside;
        ZT_TRY(zt_aside_open(&aside, lock->path, h->listener));
        zt_aside_drop(&aside);
        lock->file = open(lock->path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    }
    return lock->file < 0 ? fail(h, lock->path) : ZT_OK;
}

static zt_status refuse(const zt_hold *h, const zt_lock *lock, const char *what) {
    char holder[320];
    ssize_t length = pread(lock->file, holder, sizeof holder - 1, 0);
    holder[length > 0 ? length : 0] = '\0';
    holder[strcspn(holder, "\n")] = '\0';
    zt_tell(h->listener, ZT_ERROR, "%s is being rendered by %s", what,
            *holder ? holder : "another process");
    return ZT_EFILE;
}

static zt_status say_holder(const zt_hold *h, const zt_lock *lock) {
    char host[256] = "", text[320];
    gethostname(host, sizeof host - 1);
    int length = snprintf(text, sizeof text, "process %ld on %s\n", (long)getpid(), host);
    bool good =
        ftruncate(lock->file, 0) == 0 && pwrite(lock->file, text, (size_t)length, 0) == length;
    return good ? ZT_OK : fail(h, lock->path);
}

/* `kind` is LOCK_EX or LOCK_SH. */
static zt_status take_lock(const zt_hold *h, zt_lock *lock, int kind, const char *what) {
    for (;;) {
        struct stat there;
        ZT_TRY(open_lock(h, lock));
        if (flock(lock->file, kind | LOCK_NB) != 0) {
            zt_status status =
                errno == EWOULDBLOCK ? refuse(h, lock, what) : fail(h, lock->path);
            close(lock->file);
            lock->file = -1;
            return status;
        }
        if (fstat(lock->file, &there) == 0 && there.st_nlink > 0) return say_holder(h, lock);
        close(lock->file); /* removed by the one that held it until now */
    }
}

/* How much of a path there is already, of which the rest are directories that it needs. */
static size_t existing_length(const char *path) {
    size_t length = 0;
    for (const char *slash = strchr(path, '/'); slash; slash = strchr(slash + 1, '/')) {
        char *directory = strndup(path, (size_t)(slash - path));
        bool there = !directory || !*directory || access(directory, F_OK) == 0;
        free(directory);
        if (!there) break;
        length = (size_t)(slash - path);
    }
    return length;
}

/* Directories that were made and in which nothing came are removed again. */
static void remove_empty(char *path, size_t existing) {
    for (char *slash = strrchr(path, '/'); slash && (size_t)(slash - path) > existing;
         slash = strrchr(path, '/')) {
        *slash = '\0';
        if (rmdir(path) != 0) return;
    }
}

/* The last one that shares it removes it. */
static void let_go(zt_lock *lock) {
    if (lock->path && lock->file >= 0) {
        if (flock(lock->file, LOCK_EX | LOCK_NB) == 0) unlink(lock->path);
        close(lock->file);
    }
    free(lock->path);
    *lock = (zt_lock){NULL, -1};
}

#define LINE                                                                                   \
    "{\"kind\": %d, \"written\": %" PRId64 ", \"count\": %" PRId64 ", \"key\": \"%016" PRIx64  \
    "%016" PRIx64 "\", \"bytes\": %" PRId64 ", \"checksum\": \"%016" PRIx64 "%016" PRIx64      \
    "\", \"time\": %.6f}\n"
#define LINE_READ                                                                              \
    "{\"kind\": %d, \"written\": %" SCNd64 ", \"count\": %" SCNd64 ", \"key\": \"%16" SCNx64   \
    "%16" SCNx64 "\", \"bytes\": %" SCNd64 ", \"checksum\": \"%16" SCNx64 "%16" SCNx64         \
    "\", \"time\": %lf%1[}]"

static zt_status add_record(zt_hold *h, const zt_output_record *record, int64_t *capacity) {
    if (h->record_count == *capacity) {
        int64_t more = *capacity ? 2 * *capacity : 64;
        zt_output_record *records = reallocarray(h->records, (size_t)more, sizeof *records);
        if (!records) return ZT_EMEMORY;
        h->records = records;
        *capacity = more;
    }
    h->records[h->record_count++] = *record;
    return ZT_OK;
}

/* Lines that are not whole are of things that need to be made again. */
static zt_status read_records(zt_hold *h) {
    FILE *file = fopen(h->done_path, "r");
    if (!file) return errno == ENOENT ? ZT_OK : fail(h, h->done_path);
    char *line = NULL, end[2];
    size_t size = 0;
    int64_t capacity = 0;
    zt_status status = ZT_OK;
    while (status == ZT_OK && getline(&line, &size, file) > 0) {
        zt_output_record r = {0};
        int kind;
        if (sscanf(line, LINE_READ, &kind, &r.first, &r.count, &r.key.high, &r.key.low,
                   &r.bytes, &r.checksum.high, &r.checksum.low, &r.render_s, end) == 10) {
            r.kind = (zt_record_kind)kind;
            status = add_record(h, &r, &capacity);
        }
    }
    free(line);
    fclose(file);
    return status;
}

static zt_status take_part(zt_hold *h, const char *target, int64_t part, int64_t part_count) {
    char *what =
        zt_text_print("part %" PRId64 " of %" PRId64 " of %s", part, part_count, target);
    h->part.path =
        zt_text_print("%s.%" PRId64 "-of-%" PRId64 ".lock", target, part, part_count);
    zt_status status =
        what && h->part.path ? take_lock(h, &h->part, LOCK_EX, what) : ZT_EMEMORY;
    free(what);
    return status;
}

zt_status zt_hold_open(zt_hold *h, const char *target, int64_t part, int64_t part_count,
                       zt_listener listener) {
    *h = (zt_hold){.whole.file = -1, .part.file = -1, .done = -1, .listener = listener};
    h->whole.path = zt_text_print("%s.lock", target);
    h->done_path = zt_text_print("%s.done", target);
    zt_status status = h->whole.path && h->done_path ? ZT_OK : ZT_EMEMORY;
    if (h->done_path) h->existing_length = existing_length(h->done_path);
    if (status == ZT_OK)
        status = take_lock(h, &h->whole, part_count > 0 ? LOCK_SH : LOCK_EX, target);
    if (status == ZT_OK && part_count > 0) status = take_part(h, target, part, part_count);
    if (status == ZT_OK) status = read_records(h);
    if (status != ZT_OK) (void)zt_hold_close(h);
    return status;
}

/* A line begins anew, whatever an interruption left. */
static zt_status open_done(zt_hold *h) {
    h->done = open(h->done_path, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (h->done < 0) return fail(h, h->done_path);
    char last = '\n';
    off_t size = lseek(h->done, 0, SEEK_END);
    bool good = size >= 0 && (size == 0 || pread(h->done, &last, 1, size - 1) == 1) &&
                (last == '\n' || write(h->done, "\n", 1) == 1);
    return good ? ZT_OK : fail(h, h->done_path);
}

zt_status zt_hold_record(void *user, const zt_output_record *r) {
    zt_hold *h = user;
    char text[320];
    if (h->done < 0) ZT_TRY(open_done(h));
    int length =
        snprintf(text, sizeof text, LINE, (int)r->kind, r->first, r->count, r->key.high,
                 r->key.low, r->bytes, r->checksum.high, r->checksum.low, r->render_s);
    return write(h->done, text, (size_t)length) == length ? ZT_OK : fail(h, h->done_path);
}

zt_status zt_hold_close(zt_hold *h) {
    zt_status status = ZT_OK;
    if (h->done_path && h->done >= 0 && close(h->done) != 0) status = fail(h, h->done_path);
    let_go(&h->part);
    let_go(&h->whole);
    if (h->done_path) remove_empty(h->done_path, h->existing_length);
    free(h->done_path);
    free(h->records);
    *h = (zt_hold){0};
    return status;
}
