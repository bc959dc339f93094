#include "render/lens.h"

zt_lens zt_lens_prepare(const zt_camera *camera, int width, int height) {
    xform axes = zt_camera_xform(camera);
    double step = 2 * tan(camera->fov / 2) / height; /* of a pixel, at distance 1 */
    vec3 right = vec3_scale(axes.x, step), down = vec3_scale(axes.y, -step);
    vec3 half = vec3_add(vec3_scale(right, width / 2.0), vec3_scale(down, height / 2.0));
    return (zt_lens){vec3_scale(vec3_add(axes.z, half), -1), right, down};
}

void zt_lens_ray(zt_batch *rays, int i, const zt_lens *lens, double x, double y) {
    double dx = lens->corner.x + x * lens->right.x + y * lens->down.x;
    double dy = lens->corner.y + x * lens->right.y + y * lens->down.y;
    double dz = lens->corner.z + x * lens->right.z + y * lens->down.z;
    double unit = 1 / sqrt(dx * dx + dy * dy + dz * dz);
    rays->ox[i] = rays->oy[i] = rays->oz[i] = 0;
    rays->dx[i] = (real)(dx * unit);
    rays->dy[i] = (real)(dy * unit);
    rays->dz[i] = (real)(dz * unit);
}
