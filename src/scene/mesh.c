#include "scene/mesh.h"

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
