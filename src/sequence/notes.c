/* The manifest beside a target: read before the first frame, and added to, line by line, as
 * things are completed. A line is one write at the end of the file, so that what is there is
 * whole whenever the process ends, and processes that share it do not get in each other's way.
 */
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/diag.h"
#include "base/text.h"
#include "encode/aside.h"
#include "sequence/manifest.h"

static zt_status fail(const zt_notes *n) {
    zt_tell(n->listener, ZT_ERROR, "cannot write %s: %s", n->path, strerror(errno));
    return ZT_EFILE;
}

/* A line as text, of the caller to free; NULL when out of memory. */
static char *print(const zt_manifest_line *line, size_t *length) {
    char *text = NULL;
    FILE *stream = open_memstream(&text, length);
    if (!stream) return NULL;
    zt_manifest_print(stream, line);
    bool good = !ferror(stream);
    if (fclose(stream) == 0 && good) return text;
    free(text);
    return NULL;
}

char *zt_notes_wishes(const zt_output_option *wish) {
    char *text = NULL;
    size_t length;
    FILE *stream = open_memstream(&text, &length);
    if (!stream) return NULL;
    for (const char *gap = ""; wish && wish->name; wish++) {
        if (!wish->value) continue;
        fprintf(stream, "%s%s=%s", gap, wish->name, wish->value);
        gap = " ";
    }
    if (fclose(stream) == 0) return text;
    free(text);
    return NULL;
}

/* ---- without what does not count any more ---------------------------------------------------
 */

static bool print_all(FILE *file, const zt_manifest *m) {
    const zt_output_record *record = m->records, *end = record + m->record_count;
    fputs(m->header, file);
    for (size_t i = 0; i < m->frame_count; i++) { /* images come first, by frame as well */
        zt_manifest_line line = {.kind = ZT_LINE_FRAME, .frame = m->frames[i]};
        if (record < end && record->kind == ZT_RECORD_IMAGE &&
            record->first == line.frame.frame)
            line.record = *record++;
        zt_manifest_print(file, &line);
    }
    for (; record < end; record++)
        zt_manifest_print(file, &(zt_manifest_line){.kind = ZT_LINE_PIECE, .record = *record});
    for (size_t i = 0; i < m->split_count; i++)
        zt_manifest_print(file,
                          &(zt_manifest_line){.kind = ZT_LINE_SPLIT, .split = m->splits[i]});
    return fflush(file) == 0 && !ferror(file);
}

/* How many lines there would be: images are on those of their frames. */
static size_t live_count(const zt_manifest *m) {
    size_t count = 1 + m->frame_count + m->split_count;
    for (size_t i = 0; i < m->record_count; i++) count += m->records[i].kind != ZT_RECORD_IMAGE;
    return count;
}

/* Nobody sees half of it. */
static zt_status write_again(zt_notes *n) {
    zt_aside aside;
    ZT_TRY(zt_aside_open(&aside, n->path, n->listener));
    FILE *file = fopen(aside.path, "w");
    bool good = file && print_all(file, n->known);
    int why = errno;
    if (file && fclose(file) != 0 && good) {
        good = false;
        why = errno;
    }
    if (good) return zt_aside_keep(&aside, n->listener);
    zt_aside_drop(&aside);
    errno = why;
    return fail(n);
}

/* ---- adding ---------------------------------------------------------------------------------
 */

static zt_status append(zt_notes *n, const char *text, size_t length) {
    return write(n->file, text, length) == (ssize_t)length ? ZT_OK : fail(n);
}

/* A line begins anew, whatever an interruption left. */
static zt_status end_line(zt_notes *n) {
    char last = '\n';
    off_t size = lseek(n->file, 0, SEEK_END);
    if (size < 0 || (size > 0 && pread(n->file, &last, 1, size - 1) != 1)) return fail(n);
    return last == '\n' ? ZT_OK : append(n, "\n", 1);
}

static zt_status open_file(zt_notes *n) {
    const int flags = O_RDWR | O_APPEND | O_CLOEXEC;
    n->file = open(n->path, flags | O_CREAT | O_EXCL, 0666);
    n->made = n->file >= 0;
    if (n->file < 0 && errno == EEXIST)
        n->file = open(n->path, flags | (n->anew ? O_TRUNC : 0));
    if (n->file < 0) return fail(n);
    ZT_TRY(end_line(n));
    const char *header = n->known->header;
    return header && !n->made && strcmp(header, n->header) == 0
               ? ZT_OK
               : append(n, n->header, strlen(n->header));
}

static zt_status add(zt_notes *n, const char *text, size_t length) {
    mtx_lock(&n->mutex);
    zt_status status = n->file < 0 ? open_file(n) : ZT_OK;
    if (status == ZT_OK) status = append(n, text, length);
    mtx_unlock(&n->mutex);
    return status;
}

zt_status zt_notes_add(zt_notes *n, const zt_manifest_line *line) {
    size_t length;
    char *text = print(line, &length);
    zt_status status = text ? add(n, text, length) : ZT_EMEMORY;
    free(text);
    return status;
}

/* ---- opening, closing -----------------------------------------------------------------------
 */

static zt_status recall(zt_notes *n, bool anew, bool alone) {
    if (anew) {
        n->known = calloc(1, sizeof *n->known);
        return n->known ? ZT_OK : ZT_EMEMORY;
    }
    ZT_TRY(zt_manifest_recall(&n->known, n->path, n->listener));
    bool stale = n->known->line_count > 2 * live_count(n->known);
    return alone && stale && n->known->header ? write_again(n) : ZT_OK;
}

zt_status zt_notes_open(zt_notes *n, const char *target, const zt_manifest_line *header,
                        bool anew, bool alone, zt_listener listener) {
    size_t length;
    *n = (zt_notes){.file = -1, .anew = anew, .listener = listener};
    if (mtx_init(&n->mutex, mtx_plain) != thrd_success) return ZT_EMEMORY;
    n->path = zt_text_print("%s.manifest", target);
    n->header = print(header, &length);
    zt_status status = n->path && n->header ? recall(n, anew, alone) : ZT_EMEMORY;
    if (status != ZT_OK) (void)zt_notes_close(n, false);
    return status;
}

zt_status zt_notes_recall(zt_notes *n) {
    zt_manifest_free(&n->known);
    return zt_manifest_recall(&n->known, n->path, n->listener);
}

zt_status zt_notes_close(zt_notes *n, bool drop) {
    if (!n->path && !n->header) return ZT_OK;
    zt_status status = ZT_OK;
    if (n->file >= 0 && close(n->file) != 0) status = fail(n);
    if (drop && n->made) unlink(n->path);
    mtx_destroy(&n->mutex);
    zt_manifest_free(&n->known);
    free(n->path);
    free(n->header);
    *n = (zt_notes){.file = -1};
    return status;
}
