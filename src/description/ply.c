/* The data of a PLY file become a mesh. They are gone through twice: a survey finds where each
 * element begins and how many triangles there will be, then the vertices are read, and then the
 * polygons, whichever come first in the file. */
#include "description/ply.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/text.h"
#include "description/normals.h"
#include "description/ply_header.h"
#include "description/triangulate.h"
#include "image/develop.h"

/* Further out, the square of a length would not fit a float. */
static const double coordinate_max = 1e18;
static const double color_max = 1e30;

typedef struct reader {
    const zt_ply_source *source;
    zt_ply_header header;
    const char *at;                /* the next byte of data */
    const char *last;              /* the first byte of the number that was read last */
    const zt_ply_element *element; /* being gone through, and which of its rows: */
    int32_t row;
    int64_t most_triangles; /* what the survey found: as many triangles or fewer, */
    int32_t most_corners;   /* and the corners of the largest polygon */
    double *positions;      /* of the vertices, x y z each, as the file has them */
    float *normals;         /* what becomes of those, zero where they are none; or NULL */
    float *colors;          /* likewise */
    double vertex[ZT_PLY_VERTEX_ROLES]; /* what was read of the row so far, by role, */
    int vertex_taken, vertex_parts;     /* how much that is, and will be */
    bool lacks_normals;                 /* some were none */
    uint32_t *corners;                  /* of the polygon being read */
    uint32_t *triangles;
    int64_t triangle_count; /* written so far */
    zt_triangulator triangulator;
} reader;

static bool is_ascii(const reader *r) { return r->header.format == ZT_PLY_ASCII; }

static zt_status refuse_end(const reader *r) {
    return zt_ply_refuse(r->source, NULL, 0, "the file ends within %.*s %d of %d",
                         r->element->name_length, r->element->at, r->row, r->element->count);
}

/* A mistake in the row being read: in its last number, where that is text. */
#define REFUSE_ROW(r, format, ...)                                                             \
    zt_ply_refuse((r)->source, is_ascii(r) ? (r)->last : NULL, (size_t)((r)->at - (r)->last),  \
                  "%.*s %d: " format, (r)->element->name_length, (r)->element->at, (r)->row,   \
                  __VA_ARGS__)

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

/* Goes behind the next piece of text between blanks; false at the end of the file. */
static bool next_word(reader *r) {
    const char *at = r->at;
    while (at < r->source->end && (unsigned char)*at <= ' ') at++;
    r->last = at;
    while ((unsigned char)*at > ' ') at++; /* the '\0' behind the bytes ends it at last */
    r->at = at;
    return at > r->last;
}

static zt_status ascii_number(reader *r, double *value) {
    if (!next_word(r)) return refuse_end(r);
    /* Most numbers are small and whole. */
    const char *c = r->last;
    int64_t whole = 0;
    while (*c >= '0' && *c <= '9' && c - r->last < 15) whole = 10 * whole + (*c++ - '0');
    *value = (double)whole;
    if (c < r->at && !zt_text_number(value, r->last, r->at))
        return REFUSE_ROW(r, "\"%.*s\" is no finite number",
                          r->at - r->last < 32 ? (int)(r->at - r->last) : 32, r->last);
    return ZT_OK;
}

static zt_status read_number(reader *r, zt_ply_type type, double *value) {
    if (is_ascii(r)) return ascii_number(r, value);
    int size = zt_ply_type_size(type);
    if (r->source->end - r->at < size) return refuse_end(r);
    *value = binary_number(r->at, type, r->header.format == ZT_PLY_BIG_ENDIAN);
    r->last = r->at;
    r->at += size;
    return ZT_OK;
}

static zt_status skip_values(reader *r, zt_ply_type type, int32_t count) {
    if (is_ascii(r)) {
        for (int32_t i = 0; i < count; i++)
            if (!next_word(r)) return refuse_end(r);
        return ZT_OK;
    }
    int64_t size = (int64_t)count * zt_ply_type_size(type);
    if (r->source->end - r->at < size) return refuse_end(r);
    r->at += size;
    return ZT_OK;
}

/* How many items a list has: never more than the file has bytes left for. */
static zt_status read_length(reader *r, const zt_ply_property *list, int32_t *length) {
    double number = 0;
    ZT_TRY(read_number(r, list->count_type, &number));
    if (!(number >= 0 && number <= INT32_MAX) || number != floor(number))
        return REFUSE_ROW(r, "a list cannot have %.10g items", number);
    int64_t item_size =
        is_ascii(r) ? 2 /* a blank and a digit */ : zt_ply_type_size(list->type);
    int64_t room = (r->source->end - r->at) / item_size;
    if ((int64_t)number > room)
        return REFUSE_ROW(r, "the file is too short for a list of %.10g items", number);
    *length = (int32_t)number;
    return ZT_OK;
}

/* Reads or skips a property's `count` values, of a list or one. */
typedef zt_status take_values(reader *r, const zt_ply_property *property, int32_t count);

/* Goes through an element's rows, from the reader's place on. */
static zt_status go_through(reader *r, const zt_ply_element *element, take_values *take) {
    r->element = element;
    if (!element->properties) return ZT_OK;
    for (r->row = 0; r->row < element->count; r->row++)
        for (const zt_ply_property *p = element->properties; p; p = p->next) {
            int32_t count = 1;
            if (p->is_list) ZT_TRY(read_length(r, p, &count));
            ZT_TRY(p->role == ZT_PLY_SKIPPED ? skip_values(r, p->type, count)
                                             : take(r, p, count));
        }
    return ZT_OK;
}

static zt_status survey_values(reader *r, const zt_ply_property *property, int32_t count) {
    if (property->role == ZT_PLY_CORNERS) {
        if (count > 2) r->most_triangles += count - 2;
        if (count > r->most_corners) r->most_corners = count;
    }
    return skip_values(r, property->type, count);
}

static zt_status survey(reader *r) {
    r->at = r->header.data;
    for (zt_ply_element *e = r->header.elements; e; e = e->next) {
        e->data = r->at;
        if (is_ascii(r) || e->has_list || r->source->end - r->at < e->row_bytes * e->count)
            ZT_TRY(go_through(r, e, survey_values));
        else
            r->at += e->row_bytes * e->count;
    }
    if (r->most_triangles == 0)
        return zt_ply_refuse(r->source, NULL, 0, "no face has three corners");
    if (r->most_triangles > INT32_MAX)
        return zt_ply_refuse(r->source, NULL, 0, "there are more than %d triangles", INT32_MAX);
    return ZT_OK;
}

/* ---- vertices -------------------------------------------------------------------------------
 */

/* The number of a part of a normal: NaN, however text spells it, where it is not finite. */
static zt_status read_normal_part(reader *r, zt_ply_type type, double *value) {
    if (!is_ascii(r)) return read_number(r, type, value);
    const char *at = r->at;
    *value = next_word(r) ? strtod(r->last, NULL) : 0;
    if (!isfinite(*value)) return ZT_OK;
    r->at = at;
    return ascii_number(r, value);
}

/* Integers are a display's color, the largest of their type being white; others are light. */
static zt_status read_color_part(reader *r, const zt_ply_property *property, double *value) {
    static const char *const names[] = {"red", "green", "blue"};
    ZT_TRY(read_number(r, property->type, value));
    if (!(fabs(*value) <= color_max))
        return REFUSE_ROW(r, "%s is %g, but must be at most %g",
                          names[property->role - ZT_PLY_RED], *value, color_max);
    double most = property->type == ZT_PLY_UINT8    ? UINT8_MAX
                  : property->type == ZT_PLY_UINT16 ? UINT16_MAX
                                                    : 0;
    *value = fmax(*value, 0);
    if (most > 0) *value = zt_srgb_to_linear(fmin(*value / most, 1));
    return ZT_OK;
}

static zt_status read_coordinate(reader *r, const zt_ply_property *property, double *value) {
    ZT_TRY(read_number(r, property->type, value));
    if (!(fabs(*value) <= coordinate_max))
        return REFUSE_ROW(r, "%c is %g, but must lie between -%g and %g", "xyz"[property->role],
                          *value, coordinate_max, coordinate_max);
    if (property->type == ZT_PLY_FLOAT) *value = (double)(float)*value; /* text may say more */
    return ZT_OK;
}

/* All of a row's numbers are there. */
static void finish_vertex(reader *r) {
    const double *v = r->vertex;
    int64_t at = 3 * (int64_t)r->row;
    r->vertex_taken = 0;
    memcpy(r->positions + at, v, 3 * sizeof *v);
    if (r->normals) {
        vec3 n = vec3_normalize((vec3){v[ZT_PLY_NX], v[ZT_PLY_NY], v[ZT_PLY_NZ]});
        bool good = isfinite(n.x) && isfinite(n.y) && isfinite(n.z) && vec3_max_abs(n) > 0;
        r->lacks_normals |= !good;
        if (good)
            memcpy(r->normals + at, (float[3]){(float)n.x, (float)n.y, (float)n.z},
                   3 * sizeof *r->normals);
    }
    for (int c = 0; c < 3 && r->colors; c++) r->colors[at + c] = (float)v[ZT_PLY_RED + c];
}

static zt_status take_vertex_part(reader *r, const zt_ply_property *property, int32_t count) {
    (void)count; /* these are no lists */
    double *value = &r->vertex[property->role];
    if (property->role <= ZT_PLY_Z)
        ZT_TRY(read_coordinate(r, property, value));
    else if (property->role <= ZT_PLY_NZ)
        ZT_TRY(read_normal_part(r, property->type, value));
    else
        ZT_TRY(read_color_part(r, property, value));
    if (++r->vertex_taken == r->vertex_parts) finish_vertex(r);
    return ZT_OK;
}

/* Room for what is wanted of the vertices and there; the rest is skipped. */
static zt_status make_room(reader *r, zt_arena *arena, zt_arena *scratch, unsigned parts) {
    zt_ply_element *vertex = r->header.vertex;
    size_t count = 3 * (size_t)vertex->count;
    const unsigned normals = 7u << ZT_PLY_NX, colors = 7u << ZT_PLY_RED;
    unsigned wanted = 7u << ZT_PLY_X;
    if (parts & ZT_PLY_NORMALS && (vertex->roles & normals) == normals) wanted |= normals;
    if (parts & ZT_PLY_COLORS && (vertex->roles & colors) == colors) wanted |= colors;
    for (zt_ply_property *p = vertex->properties; p; p = p->next)
        if (wanted & 1u << p->role)
            r->vertex_parts++;
        else
            p->role = ZT_PLY_SKIPPED;
    r->positions = ZT_PUSH(scratch, double, count);
    if (wanted & normals) r->normals = ZT_PUSH(arena, float, count);
    if (wanted & colors) r->colors = ZT_PUSH(arena, float, count);
    bool made =
        r->positions && !r->normals == !(wanted & normals) && !r->colors == !(wanted & colors);
    return made ? ZT_OK : ZT_EMEMORY;
}

/* ---- polygons -------------------------------------------------------------------------------
 */

/* A vertex's index; where `restart` is given, true there instead for -1. */
static zt_status read_corner(reader *r, zt_ply_type type, uint32_t *corner, bool *restart) {
    double number = 0;
    ZT_TRY(read_number(r, type, &number));
    if (restart) *restart = number == -1;
    if (restart && *restart) return ZT_OK;
    int32_t vertex_count = r->header.vertex->count;
    if (!(number >= 0 && number < vertex_count) || number != floor(number))
        return REFUSE_ROW(r, "there is no vertex %.10g; they are counted from 0 to %d", number,
                          vertex_count - 1);
    *corner = (uint32_t)number;
    return ZT_OK;
}

static zt_status take_polygon(reader *r, const zt_ply_property *property, int32_t count) {
    for (int32_t i = 0; i < count; i++)
        ZT_TRY(read_corner(r, property->type, &r->corners[i], NULL));
    if (count < 3) return ZT_OK; /* a point or a line */
    zt_triangulate(&r->triangulator, r->triangles + 3 * r->triangle_count, r->corners, count);
    r->triangle_count += count - 2;
    return ZT_OK;
}

/* A triangle for each corner and the two before it. Every other one would wind the wrong way
 * round but for taking the corner with the even number first. */
static zt_status take_strip(reader *r, const zt_ply_property *property, int32_t count) {
    uint32_t before[2] = {0};
    for (int32_t i = 0, length = 0; i < count; i++) {
        uint32_t corner;
        bool restart;
        ZT_TRY(read_corner(r, property->type, &corner, &restart));
        if (restart) {
            length = 0;
            continue;
        }
        if (length >= 2) {
            uint32_t *triangle = r->triangles + 3 * r->triangle_count++;
            triangle[0] = before[0];
            triangle[1] = before[1];
            triangle[2] = corner;
        }
        before[length++ % 2] = corner;
    }
    return ZT_OK;
}

static zt_status read_rows(reader *r, const zt_ply_element *element, take_values *take) {
    r->at = element->data;
    return go_through(r, element, take);
}

static zt_status read_triangles(reader *r, zt_arena *arena, zt_arena *scratch) {
    r->triangles = ZT_PUSH(arena, uint32_t, 3 * (size_t)r->most_triangles);
    r->corners = ZT_PUSH(scratch, uint32_t, (size_t)r->most_corners);
    if (!r->triangles || !r->corners) return ZT_EMEMORY;
    ZT_TRY(zt_triangulator_create(&r->triangulator, scratch, r->positions, r->most_corners));
    if (r->header.face) ZT_TRY(read_rows(r, r->header.face, take_polygon));
    if (r->header.strips) ZT_TRY(read_rows(r, r->header.strips, take_strip));
    if (r->triangle_count == 0)
        return zt_ply_refuse(r->source, NULL, 0, "no strip has three corners");
    if (r->triangulator.given_up > 0)
        zt_tell_at(r->source->listener, ZT_WARNING, &(zt_place){.file = r->source->path},
                   "polygons too intricate to be cut with care: %d; they may look wrong",
                   r->triangulator.given_up);
    return ZT_OK;
}

/* Bounds of the vertices that triangles use; true where all of these are floats as they are. */
static bool find_bounds(const reader *r, double low[3], double high[3]) {
    bool are_floats = true;
    for (int axis = 0; axis < 3; axis++) {
        low[axis] = INFINITY;
        high[axis] = -INFINITY;
    }
    for (int64_t i = 0; i < 3 * r->triangle_count; i++) {
        const double *p = r->positions + 3 * (int64_t)r->triangles[i];
        for (int axis = 0; axis < 3; axis++) {
            if (p[axis] < low[axis]) low[axis] = p[axis];
            if (p[axis] > high[axis]) high[axis] = p[axis];
            are_floats &= (double)(float)p[axis] == p[axis];
        }
    }
    return are_floats;
}

static zt_status write_mesh(const reader *r, zt_mesh *mesh, zt_arena *arena) {
    int32_t vertex_count = r->header.vertex->count;
    /* One float more, for readers that load a vertex as four. */
    float *positions = ZT_PUSH(arena, float, 3 * (size_t)vertex_count + 1);
    if (!positions) return ZT_EMEMORY;
    double low[3], high[3], origin[3] = {0, 0, 0};
    if (!find_bounds(r, low, high))
        for (int axis = 0; axis < 3; axis++) origin[axis] = low[axis] / 2 + high[axis] / 2;
    for (int axis = 0; axis < 3; axis++) {
        for (int64_t i = axis; i < 3 * (int64_t)vertex_count; i += 3)
            positions[i] = (float)(r->positions[i] - origin[axis]);
        /* Rounding keeps order: these are the bounds of the rounded positions. */
        low[axis] = origin[axis] + (double)(float)(low[axis] - origin[axis]);
        high[axis] = origin[axis] + (double)(float)(high[axis] - origin[axis]);
    }
    *mesh = (zt_mesh){.origin = {origin[0], origin[1], origin[2]},
                      .positions = positions,
                      .triangles = r->triangles,
                      .normals = r->normals,
                      .colors = r->colors,
                      .vertex_count = vertex_count,
                      .triangle_count = (int32_t)r->triangle_count,
                      .low = {low[0], low[1], low[2]},
                      .high = {high[0], high[1], high[2]}};
    return r->lacks_normals ? zt_normals_complete(r->normals, mesh) : ZT_OK;
}

static zt_status read_mesh(zt_mesh *mesh, zt_arena *arena, zt_arena *scratch,
                           zt_ply_source *source, unsigned parts) {
    reader r = {.source = source};
    ZT_TRY(zt_ply_header_read(&r.header, scratch, source));
    ZT_TRY(survey(&r));
    ZT_TRY(make_room(&r, arena, scratch, parts));
    ZT_TRY(read_rows(&r, r.header.vertex, take_vertex_part));
    ZT_TRY(read_triangles(&r, arena, scratch));
    return write_mesh(&r, mesh, arena);
}

/* All of a file's bytes, and a '\0' behind them. */
static zt_status read_file(zt_ply_source *source, zt_arena *scratch, int file) {
    struct stat about;
    if (fstat(file, &about) != 0) return ZT_EFILE;
    if (!S_ISREG(about.st_mode)) {
        errno = S_ISDIR(about.st_mode) ? EISDIR : EINVAL;
        return ZT_EFILE;
    }
    size_t size = (size_t)about.st_size, done = 0;
    char *bytes = ZT_PUSH(scratch, char, size + 1);
    if (!bytes) return ZT_EMEMORY;
    while (done < size) {
        ssize_t got = read(file, bytes + done, size - done);
        if (got < 0 && errno != EINTR) return ZT_EFILE;
        if (got == 0) break; /* it has become shorter meanwhile */
        if (got > 0) done += (size_t)got;
    }
    bytes[done] = '\0';
    source->bytes = bytes;
    source->end = bytes + done;
    return ZT_OK;
}

zt_status zt_ply_read(zt_mesh *mesh, zt_arena *arena, const char *path, unsigned parts,
                      const zt_place *place, zt_listener listener) {
    *mesh = (zt_mesh){0};
    zt_arena scratch = {0};
    zt_ply_source source = {.path = path, .listener = listener};
    /* Not to wait for someone to write, where the name is that of a pipe. */
    int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    zt_status status = file < 0 ? ZT_EFILE : read_file(&source, &scratch, file);
    if (status == ZT_EFILE)
        zt_tell_at(listener, ZT_ERROR, place, "cannot read %s: %s", path, strerror(errno));
    if (file >= 0) close(file);
    if (status == ZT_OK) status = read_mesh(mesh, arena, &scratch, &source, parts);
    if (status == ZT_EMEMORY)
        zt_tell_at(listener, ZT_ERROR, place, "not enough memory to read %s", path);
    if (status == ZT_EDESCRIPTION && place)
        zt_tell_at(listener, ZT_NOTE, place, "this mesh was asked for here");
    zt_arena_free(&scratch);
    return status;
}
