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
    *h = (zt_hold){.whole.file = -1, .part.file = -1, .listener = listener};
    h->whole.path = zt_text_print("%s.lock", target);
    zt_status status = h->whole.path ? ZT_OK : ZT_EMEMORY;
    if (status == ZT_OK) h->existing_length = existing_length(h->whole.path);
    if (status == ZT_OK)
        status = take_lock(h, &h->whole, part_count > 0 ? LOCK_SH : LOCK_EX, target);
    if (status == ZT_OK && part_count > 0) status = take_part(h, target, part, part_count);
    if (status != ZT_OK) zt_hold_close(h);
    return status;
}

bool zt_hold_alone(const zt_hold *h) {
    return h->whole.path && flock(h->whole.file, LOCK_EX | LOCK_NB) == 0;
}

void zt_hold_close(zt_hold *h) {
    char *path = h->whole.path ? strdup(h->whole.path) : NULL;
    let_go(&h->part);
    let_go(&h->whole);
    if (path) remove_empty(path, h->existing_length);
    free(path);
    *h = (zt_hold){0};
}
