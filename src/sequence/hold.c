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

static zt_status open_lock(zt_hold *h) {
    h->lock = open(h->lock_path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (h->lock < 0 && errno == ENOENT) { /* its directory is missing */
        zt_aside aside;
        ZT_TRY(zt_aside_open(&aside, h->lock_path, h->listener));
        zt_aside_drop(&aside);
        h->lock = open(h->lock_path, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    }
    return h->lock < 0 ? fail(h, h->lock_path) : ZT_OK;
}

static zt_status refuse(const zt_hold *h, const char *target) {
    char holder[320];
    ssize_t length = pread(h->lock, holder, sizeof holder - 1, 0);
    holder[length > 0 ? length : 0] = '\0';
    holder[strcspn(holder, "\n")] = '\0';
    zt_tell(h->listener, ZT_ERROR, "%s is being rendered by %s", target,
            *holder ? holder : "another process");
    return ZT_EFILE;
}

static zt_status say_holder(const zt_hold *h) {
    char host[256] = "", text[320];
    gethostname(host, sizeof host - 1);
    int length = snprintf(text, sizeof text, "process %ld on %s\n", (long)getpid(), host);
    bool good =
        ftruncate(h->lock, 0) == 0 && pwrite(h->lock, text, (size_t)length, 0) == length;
    return good ? ZT_OK : fail(h, h->lock_path);
}

static zt_status take_lock(zt_hold *h, const char *target) {
    for (;;) {
        struct stat there;
        ZT_TRY(open_lock(h));
        if (flock(h->lock, LOCK_EX | LOCK_NB) != 0) {
            zt_status status = errno == EWOULDBLOCK ? refuse(h, target) : fail(h, h->lock_path);
            close(h->lock);
            h->lock = -1;
            return status;
        }
        if (fstat(h->lock, &there) == 0 && there.st_nlink > 0) return say_holder(h);
        close(h->lock); /* removed by the one that held it until now */
    }
}

#define LINE                                                                                   \
    "{\"written\": %" PRId64 ", \"count\": %" PRId64 ", \"key\": \"%016" PRIx64 "%016" PRIx64  \
    "\", \"bytes\": %" PRId64 ", \"checksum\": \"%016" PRIx64 "%016" PRIx64 "\"}\n"
#define LINE_READ                                                                              \
    "{\"written\": %" SCNd64 ", \"count\": %" SCNd64 ", \"key\": \"%16" SCNx64 "%16" SCNx64    \
    "\", \"bytes\": %" SCNd64 ", \"checksum\": \"%16" SCNx64 "%16" SCNx64 "\"%1[}]"

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
        zt_output_record r;
        if (sscanf(line, LINE_READ, &r.first, &r.count, &r.key.high, &r.key.low, &r.bytes,
                   &r.checksum.high, &r.checksum.low, end) == 8)
            status = add_record(h, &r, &capacity);
    }
    free(line);
    fclose(file);
    return status;
}

zt_status zt_hold_open(zt_hold *h, const char *target, bool locks, zt_listener listener) {
    *h = (zt_hold){.lock = -1, .done = -1, .listener = listener};
    if (!locks) return ZT_OK;
    h->lock_path = zt_text_print("%s.lock", target);
    h->done_path = zt_text_print("%s.done", target);
    zt_status status = h->lock_path && h->done_path ? take_lock(h, target) : ZT_EMEMORY;
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
    int length = snprintf(text, sizeof text, LINE, r->first, r->count, r->key.high, r->key.low,
                          r->bytes, r->checksum.high, r->checksum.low);
    return write(h->done, text, (size_t)length) == length ? ZT_OK : fail(h, h->done_path);
}

zt_status zt_hold_close(zt_hold *h) {
    zt_status status = ZT_OK;
    if (h->done >= 0 && close(h->done) != 0) status = fail(h, h->done_path);
    if (h->lock >= 0) {
        unlink(h->lock_path);
        close(h->lock);
    }
    free(h->lock_path);
    free(h->done_path);
    free(h->records);
    *h = (zt_hold){.lock = -1, .done = -1};
    return status;
}
