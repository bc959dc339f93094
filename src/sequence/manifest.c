/* What is known from the lines of a manifest. */
#include "sequence/manifest.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/diag.h"
#include "base/text.h"

static const int64_t size_max = INT64_C(1) << 30; /* ten times the longest film's */

void zt_manifest_free(zt_manifest **slot) {
    zt_manifest *m = *slot;
    if (!m) return;
    free(m->header);
    free(m->frames);
    free(m->records);
    free(m->splits);
    zt_arena_free(&m->arena);
    free(m);
    *slot = NULL;
}

/* ---- asking ---------------------------------------------------------------------------------
 */

static int by_frame(const void *a, const void *b) {
    const zt_manifest_frame *one = a, *other = b;
    return (one->frame > other->frame) - (one->frame < other->frame);
}

const zt_manifest_frame *zt_manifest_find(const zt_manifest *m, int64_t frame) {
    const zt_manifest_frame wanted = {.frame = frame};
    if (m->frame_count == 0) return NULL;
    return bsearch(&wanted, m->frames, m->frame_count, sizeof wanted, by_frame);
}

const zt_manifest_split *zt_manifest_split_of(const zt_manifest *m, zt_hash of, int64_t count) {
    for (size_t i = 0; i < m->split_count; i++) {
        const zt_manifest_split *s = &m->splits[i];
        if (zt_hash_equal(s->of, of) && s->count == count) return s;
    }
    return NULL;
}

double zt_manifest_time(const zt_manifest *m, int64_t frame) {
    const zt_manifest_frame *found = zt_manifest_find(m, frame);
    return found ? found->render_s : -1;
}

bool zt_manifest_key(zt_hash *key, const zt_manifest *m, int64_t frame) {
    const zt_manifest_frame *found = zt_manifest_find(m, frame);
    if (!found || !zt_hash_is_known(found->key)) return false;
    *key = found->key;
    return true;
}

void zt_manifest_range(int64_t *first, int64_t *last, const zt_manifest *m) {
    *first = m->frames[0].frame;
    *last = m->frames[m->frame_count - 1].frame;
}

void zt_manifest_settings(zt_render_settings *settings, const zt_manifest *m) {
    if (settings->width == 0) {
        settings->width = m->width;
        settings->height = m->height;
    }
    if (settings->precision == ZT_PRECISION_AUTO) settings->precision = m->precision;
}

/* ---- adding ---------------------------------------------------------------------------------
 */

/* Room for one more of a list. */
static zt_status make_room(void *list, size_t *room, size_t count, size_t size) {
    void **items = list;
    if (count < *room) return ZT_OK;
    size_t more = *room ? 2 * *room : 16;
    void *larger = reallocarray(*items, more, size);
    if (!larger) return ZT_EMEMORY;
    *items = larger;
    *room = more;
    return ZT_OK;
}

#define ADD(m, name, item)                                                                     \
    ZT_TRY(                                                                                    \
        make_room(&(m)->name##s, &(m)->name##_room, (m)->name##_count, sizeof *(m)->name##s)); \
    (m)->name##s[(m)->name##_count++] = (item)

/* Samples that were chosen for other pixels say nothing any more. */
static zt_status add_header(zt_manifest *m, const zt_manifest_line *l, const char *text) {
    bool other = m->width != l->width || m->height != l->height || m->precision != l->precision;
    for (size_t i = 0; other && i < m->frame_count; i++)
        m->frames[i].min = m->frames[i].max = 0;
    m->width = l->width;
    m->height = l->height;
    m->precision = l->precision;
    free(m->header);
    m->header = zt_text_print("%.*s\n", (int)strcspn(text, "\r\n"), text);
    return m->header ? ZT_OK : ZT_EMEMORY;
}

static zt_status add_line(zt_manifest *m, const zt_manifest_line *l, const char *text) {
    m->line_count++;
    if (l->kind == ZT_LINE_HEADER) return add_header(m, l, text);
    if (l->kind == ZT_LINE_FRAME) {
        ADD(m, frame, l->frame);
    }
    if (l->kind == ZT_LINE_SPLIT) {
        ADD(m, split, l->split);
    }
    if (l->record.count > 0) {
        ADD(m, record, l->record);
    }
    return ZT_OK;
}

static int by_thing(const void *a, const void *b) {
    const zt_output_record *one = a, *other = b;
    if (one->kind != other->kind) return one->kind < other->kind ? -1 : 1;
    return (one->first > other->first) - (one->first < other->first);
}

typedef int comparison(const void *, const void *);

/* Of equal things, those that came later are behind. */
static int by_order(const void *a, const void *b, void *user) {
    const void *one = *(const void *const *)a, *other = *(const void *const *)b;
    int order = (*(comparison **)user)(one, other);
    return order ? order : (one > other) - (one < other);
}

/* Sorts a list, and leaves of equal ones that which came last. */
static zt_status leave_last(void *list, size_t *count, size_t size, comparison *order) {
    char *items = list;
    void **sorted = malloc((*count + 1) * sizeof *sorted);
    char *left = malloc(*count * size + 1), *end = left;
    if (sorted && left) {
        for (size_t i = 0; i < *count; i++) sorted[i] = items + i * size;
        qsort_r(sorted, *count, sizeof *sorted, by_order, &order);
        for (size_t i = 0; i < *count; i++)
            if (i + 1 == *count || order(sorted[i], sorted[i + 1]) != 0) {
                memcpy(end, sorted[i], size);
                end += size;
            }
        *count = (size_t)(end - left) / size;
        if (*count) memcpy(items, left, *count * size);
    }
    zt_status status = sorted && left ? ZT_OK : ZT_EMEMORY;
    free(sorted);
    free(left);
    return status;
}

static zt_status sort(zt_manifest *m) {
    ZT_TRY(leave_last(m->frames, &m->frame_count, sizeof *m->frames, by_frame));
    return leave_last(m->records, &m->record_count, sizeof *m->records, by_thing);
}

/* ---- reading --------------------------------------------------------------------------------
 */

typedef struct reading {
    zt_manifest *manifest;
    const char *path;
    zt_listener listener;
    bool strict;
    int line_number, wrong_count, first_wrong;
} reading;

/* Whether a line that cannot be read ends too early, as those do whose writer was killed: in
 * the middle of a piece, and not behind its bracket. */
static bool is_cut(const zt_json *json) {
    const char *rest = json->at + strspn(json->at, "+-.0123456789abcdefABCDEFu\\");
    return *rest == '\0' && (json->at == json->text || json->at[-1] != '}');
}

static zt_status read_line(reading *r, const char *text, bool tells, bool *cut) {
    zt_json json;
    zt_manifest_line line;
    zt_manifest *m = r->manifest;
    ZT_TRY(zt_json_open_text(&json, text, r->path, tells ? r->listener : (zt_listener){0}));
    json.lines_before = r->line_number - 1;
    zt_status status = zt_manifest_parse(&line, &json, &m->arena);
    *cut = status == ZT_EFILE && is_cut(&json);
    if (status == ZT_OK && r->strict && !m->header && line.kind != ZT_LINE_HEADER)
        status = zt_json_refuse(&json, "a manifest begins with its header");
    zt_json_close(&json);
    return status == ZT_OK && !tells ? add_line(m, &line, text) : status;
}

static zt_status take_line(reading *r, char *text, size_t length) {
    bool cut;
    r->line_number++;
    for (size_t i = 0; i < length; i++)
        if (!text[i]) text[i] = 1; /* which is no JSON */
    if (text[length - 1] == '\n') text[length - 1] = '\0';
    if (text[strspn(text, " \t\r\n")] == '\0') return ZT_OK;
    zt_status status = read_line(r, text, false, &cut);
    if (status != ZT_EFILE || (cut && (r->manifest->header || !r->strict)))
        return status == ZT_EFILE ? ZT_OK : status;
    if (r->strict) return read_line(r, text, true, &cut);
    if (r->wrong_count++ == 0) r->first_wrong = r->line_number;
    return ZT_OK;
}

static zt_status refuse(const reading *r, const char *why) {
    zt_tell(r->listener, ZT_ERROR, "cannot read %s: %s", r->path, why);
    return ZT_EFILE;
}

static zt_status read_lines(reading *r, FILE *file) {
    struct stat there;
    if (fstat(fileno(file), &there) != 0) return refuse(r, strerror(errno));
    if (there.st_size > size_max) return refuse(r, strerror(EFBIG));
    char *line = NULL;
    size_t room = 0;
    zt_status status = ZT_OK;
    for (ssize_t length; status == ZT_OK && (length = getline(&line, &room, file)) > 0;)
        status = take_line(r, line, (size_t)length);
    if (status == ZT_OK && ferror(file)) status = refuse(r, strerror(errno));
    free(line);
    return status;
}

static zt_status read_file(reading *r) {
    FILE *file = fopen(r->path, "rb");
    if (!file) return !r->strict && errno == ENOENT ? ZT_OK : refuse(r, strerror(errno));
    zt_status status = read_lines(r, file);
    fclose(file);
    if (status == ZT_OK) status = sort(r->manifest);
    return status;
}

static zt_status read_manifest(zt_manifest **out, reading *r) {
    *out = r->manifest = calloc(1, sizeof **out);
    if (!*out) return ZT_EMEMORY;
    zt_status status = read_file(r);
    if (status == ZT_OK && r->strict && r->manifest->frame_count == 0)
        status = refuse(r, "it has no frames");
    if (status != ZT_OK) zt_manifest_free(out);
    return status;
}

zt_status zt_manifest_read(zt_manifest **out, const char *path, zt_listener listener) {
    return read_manifest(out, &(reading){.path = path, .listener = listener, .strict = true});
}

zt_status zt_manifest_recall(zt_manifest **out, const char *path, zt_listener listener) {
    reading r = {.path = path, .listener = listener};
    ZT_TRY(read_manifest(out, &r));
    if (r.wrong_count > 0)
        zt_tell(listener, ZT_WARNING,
                "%s: %d lines, the first of them line %d, cannot be read: what they told of is "
                "made again",
                path, r.wrong_count, r.first_wrong);
    return ZT_OK;
}
