#include "scene/mesh.h"

#include "base/hash.h"

double zt_mesh_winding(const zt_mesh *mesh, vec3 point) {
    const double pi = 3.14159265358979323846;
    double sum = 0; /* half solid angles */
    for (int32_t i = 0; i < mesh->triangle_count; i++) {
        vec3 a = vec3_sub(zt_mesh_corner(mesh, i, 0), point);
        vec3 b = vec3_sub(zt_mesh_corner(mesh, i, 1), point);
        vec3 c = vec3_sub(zt_mesh_corner(mesh, i, 2), point);
        double la = vec3_length(a), lb = vec3_length(b), lc = vec3_length(c);
        double volume = vec3_dot(a, vec3_cross(b, c));
        double rest =
            la * lb * lc + vec3_dot(a, b) * lc + vec3_dot(b, c) * la + vec3_dot(c, a) * lb;
        sum += atan2(volume, rest);
    }
    return sum / (2 * pi);
}

static zt_hash hash_of(const void *bytes, size_t size) {
    return bytes && size ? zt_hash_bytes(bytes, size) : (zt_hash){0};
}

/* Numbers of which it consists, side by side, without bytes between them. */
zt_hash zt_mesh_content(const zt_mesh *m) {
    const size_t points = (size_t)m->vertex_count * 3, corners = (size_t)m->triangle_count * 3;
    const double numbers[] = {m->origin.x, m->origin.y, m->origin.z, m->vertex_count,
                              m->triangle_count};
    const zt_hash parts[] = {zt_hash_bytes(numbers, sizeof numbers),
                             hash_of(m->positions, points * sizeof *m->positions),
                             hash_of(m->triangles, corners * sizeof *m->triangles),
                             hash_of(m->normals, points * sizeof *m->normals),
                             hash_of(m->colors, points * sizeof *m->colors)};
    return zt_hash_bytes(parts, sizeof parts);
}
