#include "description/models.h"

#include <stdlib.h>
#include <string.h>

#include "description/normals.h"
#include "description/ply.h"

/* An object that shows a model. The first one of each model notes what all of them ask for. */
typedef struct zt_model_user {
    const zt_node *file;
    int32_t index;         /* of the object */
    bool decides;          /* it says itself whether it is smooth */
    const zt_node *colors; /* where it asks for the vertices' colors, or NULL */
    unsigned parts;        /* of zt_ply_part */
    bool needs_normals;    /* also where the file has none */
    struct zt_model_user *first, *next;
} user;

/* Whether a switch may ever be on: what moves may. */
static bool may_be_on(const zt_node *node, bool at_rest) {
    return node && (at_rest || node->kind != ZT_NODE_TEXT || node->text[0] == '=');
}

zt_status zt_models_note(zt_models *models, int32_t index, const zt_fields *fields,
                         const zt_node *file) {
    zt_mistakes *mistakes = &models->reading->mistakes;
    const zt_object *object = &models->reading->animation->rest.objects[index];
    const zt_node *smooth = zt_field(fields, "smooth"),
                  *colors = zt_field(fields, "vertex_colors");
    const char *name = zt_read_text(mistakes, file, "file");
    if (!name) return ZT_OK;
    if (!zt_text_ends_with(name, ".ply", true)) {
        zt_mistake(mistakes, &file->place,
                   "\"%s\" is not supported; models are read from .ply files",
                   zt_show(name).text);
        return ZT_OK;
    }
    user *u = ZT_PUSH(models->reading->temporary, user, 1);
    if (!u) return ZT_EMEMORY;
    *u = (user){.file = file, .index = index, .decides = smooth != NULL};
    u->needs_normals = may_be_on(smooth, object->smooth);
    if (may_be_on(colors, object->vertex_colors)) u->colors = colors;
    if (u->colors) u->parts |= ZT_PLY_COLORS;
    if (u->needs_normals || !smooth) u->parts |= ZT_PLY_NORMALS;
    if (models->last)
        models->last->next = u;
    else
        models->first = u;
    models->last = u;
    models->count++;
    return ZT_OK;
}

static int by_file(const void *pa, const void *pb) {
    const user *a = *(user *const *)pa, *b = *(user *const *)pb;
    int order = strcmp(a->file->text, b->file->text);
    return order ? order : (a->index > b->index) - (a->index < b->index);
}

/* Finds the first one of each model, and gathers what is asked of it there. */
static zt_status gather(zt_models *models) {
    user **sorted = ZT_PUSH(models->reading->temporary, user *, (size_t)models->count);
    if (!sorted) return ZT_EMEMORY;
    int32_t count = 0;
    for (user *u = models->first; u; u = u->next) sorted[count++] = u;
    qsort(sorted, (size_t)count, sizeof *sorted, by_file);
    for (int32_t i = 0; i < count; i++) {
        user *u = sorted[i], *before = i > 0 ? sorted[i - 1] : NULL;
        bool same = before && zt_text_equal(before->file->text, u->file->text);
        u->first = same ? before->first : u;
        u->first->parts |= u->parts;
        u->first->needs_normals |= u->needs_normals;
    }
    return ZT_OK;
}

/* The path of a file that is named relative to the description. */
static const char *path_of(const zt_models *models, const char *file) {
    const char *directory = *file == '/' ? "" : models->directory;
    size_t directory_length = strlen(directory), file_length = strlen(file);
    char *path = ZT_PUSH(models->reading->temporary, char, directory_length + file_length + 1);
    if (!path) return NULL;
    memcpy(path, directory, directory_length);
    memcpy(path + directory_length, file, file_length);
    return path;
}

/* Leaves the mesh empty where it cannot be read. *has_normals is whether the file has them. */
static zt_status read_model(zt_mesh *mesh, bool *has_normals, zt_models *models,
                            const user *first) {
    zt_reading *reading = models->reading;
    zt_arena *arena = &reading->animation->arena;
    if (zt_mistakes_full(&reading->mistakes) || models->refused_count == ZT_MISTAKES_TOLD_MAX)
        return ZT_OK;
    const zt_place *place = &first->file->place;
    const char *path = path_of(models, first->file->text);
    if (!path) return ZT_EMEMORY;
    zt_status status =
        zt_ply_read(mesh, arena, path, first->parts, place, reading->mistakes.listener);
    if (status == ZT_EMEMORY) return status;
    *has_normals = mesh->normals != NULL;
    if (status == ZT_OK)
        return first->needs_normals && !*has_normals ? zt_normals_make(mesh, arena) : ZT_OK;
    reading->mistakes.count++; /* told by the reader of the model */
    if (++models->refused_count == ZT_MISTAKES_TOLD_MAX)
        zt_mistake(&reading->mistakes, place,
                   "%d models cannot be read; no further ones are tried",
                   models->refused_count);
    return ZT_OK;
}

static bool same_bytes(const void *a, const void *b, int32_t count, size_t size) {
    if (!a || !b) return a == b;
    return memcmp(a, b, 3 * (size_t)count * size) == 0;
}

static bool same_vec3(vec3 a, vec3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

static bool same_mesh(const zt_mesh *a, const zt_mesh *b) {
    return a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count &&
           same_vec3(a->origin, b->origin) &&
           same_bytes(a->positions, b->positions, a->vertex_count, sizeof *a->positions) &&
           same_bytes(a->triangles, b->triangles, a->triangle_count, sizeof *a->triangles) &&
           same_bytes(a->normals, b->normals, a->vertex_count, sizeof *a->normals) &&
           same_bytes(a->colors, b->colors, a->vertex_count, sizeof *a->colors);
}

/* Whether the last mesh is the same as one before it, of another file: then its index; else its
 * own. */
static int32_t find_mesh(const zt_scene *rest, const bool *have_normals) {
    int32_t last = rest->mesh_count - 1, i = 0;
    while (i < last && (have_normals[i] != have_normals[last] ||
                        !same_mesh(&rest->meshes[i], &rest->meshes[last])))
        i++;
    return i;
}

zt_status zt_models_read(zt_models *models) {
    zt_reading *reading = models->reading;
    zt_scene *rest = &reading->animation->rest;
    size_t most = (size_t)models->count;
    zt_mesh *meshes = ZT_PUSH(&reading->animation->arena, zt_mesh, most);
    bool *have_normals = ZT_PUSH(reading->temporary, bool, most);
    if (!meshes || !have_normals) return ZT_EMEMORY;
    rest->meshes = meshes;
    ZT_TRY(gather(models));
    for (const user *u = models->first; u; u = u->next) {
        zt_object *object = &rest->objects[u->index];
        if (u->first == u) {
            object->mesh = rest->mesh_count++;
            ZT_TRY(read_model(&meshes[object->mesh], &have_normals[object->mesh], models, u));
            object->mesh = find_mesh(rest, have_normals);
            if (object->mesh < rest->mesh_count - 1) meshes[--rest->mesh_count] = (zt_mesh){0};
        } else
            object->mesh = rest->objects[u->first->index].mesh;
        const zt_mesh *mesh = &meshes[object->mesh];
        if (!u->decides) object->smooth = have_normals[object->mesh];
        if (u->colors && mesh->positions && !mesh->colors)
            zt_doubt(&reading->mistakes, &u->colors->place,
                     "the model gives its vertices no colors");
    }
    return ZT_OK;
}
