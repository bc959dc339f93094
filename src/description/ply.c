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

#include "description/normals.h"
#include "description/ply_rows.h"
#include "description/triangulate.h"
#include "image/develop.h"

/* Further out, the square of a length would not fit a float. */
static const double coordinate_max = 1e18;
static const double color_max = 1e30;

typedef struct reader {
    zt_ply_rows rows;
    zt_ply_header header;
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

static zt_status survey_values(void *user, const zt_ply_property *property, int32_t count) {
    reader *r = user;
    if (property->role == ZT_PLY_CORNERS) {
        if (count > 2) r->most_triangles += count - 2;
        if (count > r->most_corners) r->most_corners = count;
    }
    return zt_ply_skip(&r->rows, property->type, count);
}

static zt_status survey(reader *r) {
    r->rows.at = r->header.data;
    for (zt_ply_element *e = r->header.elements; e; e = e->next) {
        e->data = r->rows.at;
        if (zt_ply_is_ascii(&r->rows) || e->has_list ||
            r->rows.source->end - r->rows.at < e->row_bytes * e->count)
            ZT_TRY(zt_ply_go_through(&r->rows, e, survey_values, r));
        else
            r->rows.at += e->row_bytes * e->count;
    }
    if (r->most_triangles == 0)
        return zt_ply_refuse(r->rows.source, NULL, 0, "no face has three corners");
    if (r->most_triangles > INT32_MAX)
        return zt_ply_refuse(r->rows.source, NULL, 0, "there are more than %d triangles",
                             INT32_MAX);
    return ZT_OK;
}

/* ---- vertices -------------------------------------------------------------------------------
 */

/* The number of a part of a normal: NaN, however text spells it, where it is not finite. */
static zt_status read_normal_part(reader *r, zt_ply_type type, double *value) {
    if (!zt_ply_is_ascii(&r->rows)) return zt_ply_read_number(&r->rows, type, value);
    const char *at = r->rows.at;
    *value = zt_ply_next_word(&r->rows) ? strtod(r->rows.last, NULL) : 0;
    if (!isfinite(*value)) return ZT_OK;
    r->rows.at = at;
    return zt_ply_read_number(&r->rows, type, value);
}

/* Integers are a display's color, the largest of their type being white; others are light. */
static zt_status read_color_part(reader *r, const zt_ply_property *property, double *value) {
    static const char *const names[] = {"red", "green", "blue"};
    ZT_TRY(zt_ply_read_number(&r->rows, property->type, value));
    if (!(fabs(*value) <= color_max))
        return ZT_PLY_REFUSE_ROW(&r->rows, "%s is %g, but must be at most %g",
                                 names[property->role - ZT_PLY_RED], *value, color_max);
    double most = property->type == ZT_PLY_UINT8    ? UINT8_MAX
                  : property->type == ZT_PLY_UINT16 ? UINT16_MAX
                                                    : 0;
    *value = fmax(*value, 0);
    if (most > 0) *value = zt_srgb_to_linear(fmin(*value / most, 1));
    return ZT_OK;
}

static zt_status read_coordinate(reader *r, const zt_ply_property *property, double *value) {
    ZT_TRY(zt_ply_read_number(&r->rows, property->type, value));
    if (!(fabs(*value) <= coordinate_max))
        return ZT_PLY_REFUSE_ROW(&r->rows, "%c is %g, but must lie between -%g and %g",
                                 "xyz"[property->role], *value, coordinate_max, coordinate_max);
    if (property->type == ZT_PLY_FLOAT) *value = (double)(float)*value; /* text may say more */
    return ZT_OK;
}

/* All of a row's numbers are there. */
static void finish_vertex(reader *r) {
    const double *v = r->vertex;
    int64_t at = 3 * (int64_t)r->rows.row;
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

static zt_status take_vertex_part(void *user, const zt_ply_property *property, int32_t count) {
    reader *r = user;
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
    ZT_TRY(zt_ply_read_number(&r->rows, type, &number));
    if (restart) *restart = number == -1;
    if (restart && *restart) return ZT_OK;
    int32_t vertex_count = r->header.vertex->count;
    if (!(number >= 0 && number < vertex_count) || number != floor(number))
        return ZT_PLY_REFUSE_ROW(&r->rows,
                                 "there is no vertex %.10g; they are counted from 0 to %d",
                                 number, vertex_count - 1);
    *corner = (uint32_t)number;
    return ZT_OK;
}

static zt_status take_polygon(void *user, const zt_ply_property *property, int32_t count) {
    reader *r = user;
    for (int32_t i = 0; i < count; i++)
        ZT_TRY(read_corner(r, property->type, &r->corners[i], NULL));
    if (count < 3) return ZT_OK; /* a point or a line */
    zt_triangulate(&r->triangulator, r->triangles + 3 * r->triangle_count, r->corners, count);
    r->triangle_count += count - 2;
    return ZT_OK;
}

/* A triangle for each corner and the two before it. Every other one would wind the wrong way
 * round but for taking the corner with the even number first. */
static zt_status take_strip(void *user, const zt_ply_property *property, int32_t count) {
    reader *r = user;
    uint32_t before[2] = {0};
    for (int32_t i = 0, length = 0; i < count; i++) {
        uint32_t corner = 0;
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

static zt_status read_rows(reader *r, const zt_ply_element *element, zt_ply_take *take) {
    r->rows.at = element->data;
    return zt_ply_go_through(&r->rows, element, take, r);
}

static zt_status read_triangles(reader *r, zt_arena *arena, zt_arena *scratch) {
    r->triangles = ZT_PUSH(arena, uint32_t, 3 * (size_t)r->most_triangles);
    r->corners = ZT_PUSH(scratch, uint32_t, (size_t)r->most_corners);
    if (!r->triangles || !r->corners) return ZT_EMEMORY;
    ZT_TRY(zt_triangulator_create(&r->triangulator, scratch, r->positions, r->most_corners));
    if (r->header.face) ZT_TRY(read_rows(r, r->header.face, take_polygon));
    if (r->header.strips) ZT_TRY(read_rows(r, r->header.strips, take_strip));
    if (r->triangle_count == 0)
        return zt_ply_refuse(r->rows.source, NULL, 0, "no strip has three corners");
    if (r->triangulator.given_up > 0)
        zt_tell_at(r->rows.source->listener, ZT_WARNING,
                   &(zt_place){.file = r->rows.source->path},
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

/* Whether three points span an area: of floats, exactly. */
static bool spans_area(const double a[3], const double b[3], const double c[3]) {
    double e[3], f[3];
    for (int axis = 0; axis < 3; axis++) {
        e[axis] = b[axis] - a[axis];
        f[axis] = c[axis] - a[axis];
    }
    return e[1] * f[2] != e[2] * f[1] || e[2] * f[0] != e[0] * f[2] ||
           e[0] * f[1] != e[1] * f[0];
}

/* Leaves out triangles without an area, of which there is nothing to see, unless all are so;
 * whether there were any. */
static bool leave_out_lines(reader *r, const float *positions) {
    int64_t kept = 0, lost = 0;
    for (int64_t i = 0; i < r->triangle_count; i++) {
        const uint32_t *of = r->triangles + 3 * i;
        double rounded[3][3];
        for (int k = 0; k < 3; k++)
            for (int axis = 0; axis < 3; axis++)
                rounded[k][axis] = (double)positions[3 * (int64_t)of[k] + axis];
        if (spans_area(rounded[0], rounded[1], rounded[2]))
            memmove(r->triangles + 3 * kept++, of, 3 * sizeof *of);
        else
            lost +=
                spans_area(r->positions + 3 * (int64_t)of[0], r->positions + 3 * (int64_t)of[1],
                           r->positions + 3 * (int64_t)of[2]);
    }
    bool some = kept > 0 && kept < r->triangle_count;
    if (some) r->triangle_count = kept;
    if (some && lost > 0)
        zt_tell_at(r->rows.source->listener, ZT_WARNING,
                   &(zt_place){.file = r->rows.source->path},
                   "triangles too fine for 24 binary digits around the model's middle: %lld; "
                   "they are left out",
                   (long long)lost);
    return some;
}

static zt_status write_mesh(reader *r, zt_mesh *mesh, zt_arena *arena) {
    int32_t vertex_count = r->header.vertex->count;
    /* One float more, for readers that load a vertex as four. */
    float *positions = ZT_PUSH(arena, float, 3 * (size_t)vertex_count + 1);
    if (!positions) return ZT_EMEMORY;
    double low[3], high[3], origin[3] = {0, 0, 0};
    if (!find_bounds(r, low, high))
        for (int axis = 0; axis < 3; axis++) origin[axis] = low[axis] / 2 + high[axis] / 2;
    for (int axis = 0; axis < 3; axis++)
        for (int64_t i = axis; i < 3 * (int64_t)vertex_count; i += 3)
            positions[i] = (float)(r->positions[i] - origin[axis]);
    if (leave_out_lines(r, positions)) find_bounds(r, low, high);
    for (int axis = 0; axis < 3; axis++) {
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
    reader r = {.rows = {.source = source, .header = &r.header}};
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
