#include "description/ply_rows.h"

#include <math.h>
#include <string.h>

#include "base/text.h"

static zt_status refuse_end(const zt_ply_rows *r) {
    return zt_ply_refuse(r->source, NULL, 0, "the file ends within %.*s %d of %d",
                         r->element->name_length, r->element->at, r->row, r->element->count);
}

/* The value of a type's bytes, the most significant one last or first. */
static double binary_number(const char *at, zt_ply_type type, bool big_endian) {
    int size = zt_ply_type_size(type);
    uint64_t bits = 0;
    for (int i = 0; i < size; i++)
        bits = bits << 8 | (unsigned char)at[big_endian ? i : size - 1 - i];
    uint32_t bits32 = (uint32_t)bits;
    float single;
    double number = 0;
    switch (type) {
    case ZT_PLY_INT8:
        return (int8_t)bits;
    case ZT_PLY_INT16:
        return (int16_t)bits;
    case ZT_PLY_INT32:
        return (int32_t)bits;
    case ZT_PLY_UINT8:
    case ZT_PLY_UINT16:
    case ZT_PLY_UINT32:
        return bits32;
    case ZT_PLY_FLOAT:
        memcpy(&single, &bits32, sizeof single);
        return (double)single;
    case ZT_PLY_DOUBLE:
        memcpy(&number, &bits, sizeof number);
        break;
    }
    return number;
}

bool zt_ply_next_word(zt_ply_rows *r) {
    const char *at = r->at;
    while (at < r->source->end && (unsigned char)*at <= ' ') at++;
    r->last = at;
    while ((unsigned char)*at > ' ') at++; /* the '\0' behind the bytes ends it at last */
    r->at = at;
    return at > r->last;
}

static zt_status ascii_number(zt_ply_rows *r, double *value) {
    if (!zt_ply_next_word(r)) return refuse_end(r);
    /* Most numbers are small and whole. */
    const char *c = r->last;
    int64_t whole = 0;
    while (*c >= '0' && *c <= '9' && c - r->last < 15) whole = 10 * whole + (*c++ - '0');
    *value = (double)whole;
    if (c < r->at && !zt_text_number(value, r->last, r->at))
        return ZT_PLY_REFUSE_ROW(r, "\"%.*s\" is no finite number",
                                 r->at - r->last < 32 ? (int)(r->at - r->last) : 32, r->last);
    return ZT_OK;
}

zt_status zt_ply_read_number(zt_ply_rows *r, zt_ply_type type, double *value) {
    if (zt_ply_is_ascii(r)) return ascii_number(r, value);
    int size = zt_ply_type_size(type);
    if (r->source->end - r->at < size) return refuse_end(r);
    *value = binary_number(r->at, type, r->header->format == ZT_PLY_BIG_ENDIAN);
    r->last = r->at;
    r->at += size;
    return ZT_OK;
}

zt_status zt_ply_skip(zt_ply_rows *r, zt_ply_type type, int32_t count) {
    if (zt_ply_is_ascii(r)) {
        for (int32_t i = 0; i < count; i++)
            if (!zt_ply_next_word(r)) return refuse_end(r);
        return ZT_OK;
    }
    int64_t size = (int64_t)count * zt_ply_type_size(type);
    if (r->source->end - r->at < size) return refuse_end(r);
    r->at += size;
    return ZT_OK;
}

/* How many items a list has: never more than the file has bytes left for. */
static zt_status read_length(zt_ply_rows *r, const zt_ply_property *list, int32_t *length) {
    double number = 0;
    ZT_TRY(zt_ply_read_number(r, list->count_type, &number));
    if (!(number >= 0 && number <= INT32_MAX) || number != floor(number))
        return ZT_PLY_REFUSE_ROW(r, "a list cannot have %.10g items", number);
    int64_t item_size =
        zt_ply_is_ascii(r) ? 2 /* a blank and a digit */ : zt_ply_type_size(list->type);
    int64_t room = (r->source->end - r->at) / item_size;
    if ((int64_t)number > room)
        return ZT_PLY_REFUSE_ROW(r, "the file is too short for a list of %.10g items", number);
    *length = (int32_t)number;
    return ZT_OK;
}

zt_status zt_ply_go_through(zt_ply_rows *r, const zt_ply_element *element, zt_ply_take *take,
                            void *user) {
    r->element = element;
    if (!element->properties) return ZT_OK;
    for (r->row = 0; r->row < element->count; r->row++)
        for (const zt_ply_property *p = element->properties; p; p = p->next) {
            int32_t count = 1;
            if (p->is_list) ZT_TRY(read_length(r, p, &count));
            ZT_TRY(p->role == ZT_PLY_SKIPPED ? zt_ply_skip(r, p->type, count)
                                             : take(user, p, count));
        }
    return ZT_OK;
}
