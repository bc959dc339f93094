#include "render/lens.h"

#include "tracer/isa.h"

zt_lens zt_lens_prepare(const zt_camera *camera, int width, int height) {
    xform axes = zt_camera_xform(camera);
    double step = 2 * tan(camera->fov / 2) / height; /* of a pixel, at distance 1 */
    vec3 right = vec3_scale(axes.x, step), down = vec3_scale(axes.y, -step);
    vec3 half = vec3_add(vec3_scale(right, width / 2.0), vec3_scale(down, height / 2.0));
    return (zt_lens){vec3_scale(vec3_add(axes.z, half), -1), right, down};
}

ZT_CLONES void zt_lens_rays(zt_batch *restrict rays, const zt_lens *lens,
                            const float *restrict x, const float *restrict y, int count) {
    const zt_lens l = *lens;
    for (int i = 0; i < count; i++) {
        double dx = l.corner.x + (double)x[i] * l.right.x + (double)y[i] * l.down.x;
        double dy = l.corner.y + (double)x[i] * l.right.y + (double)y[i] * l.down.y;
        double dz = l.corner.z + (double)x[i] * l.right.z + (double)y[i] * l.down.z;
        double unit = 1 / sqrt(dx * dx + dy * dy + dz * dz);
        rays->ox[i] = rays->oy[i] = rays->oz[i] = 0;
        rays->dx[i] = (real)(dx * unit);
        rays->dy[i] = (real)(dy * unit);
        rays->dz[i] = (real)(dz * unit);
    }
    rays->count = count;
}
