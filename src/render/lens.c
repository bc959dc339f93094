#include "render/lens.h"

#include "tracer/isa.h"

double zt_lens_pixel(const zt_camera *camera, int height) {
    return 2 * tan(camera->fov / 2) / height;
}

zt_lens zt_lens_prepare(const zt_camera *camera, int width, int height) {
    xform axes = zt_camera_xform(camera);
    double step = zt_lens_pixel(camera, height);
    vec3 right = vec3_scale(axes.x, step), down = vec3_scale(axes.y, -step);
    vec3 half = vec3_add(vec3_scale(right, width / 2.0), vec3_scale(down, height / 2.0));
    return (zt_lens){vec3_scale(vec3_add(axes.z, half), -1), right, down};
}

ZT_CLONES void zt_lens_rays(zt_rays *restrict rays, const zt_lens *lens,
                            const float *restrict x, const float *restrict y, int count) {
    const zt_lens l = *lens;
    for (int i = 0; i < count; i++) {
        rays->ox[i] = rays->oy[i] = rays->oz[i] = 0;
        rays->dx[i] = l.corner.x + (double)x[i] * l.right.x + (double)y[i] * l.down.x;
        rays->dy[i] = l.corner.y + (double)x[i] * l.right.y + (double)y[i] * l.down.y;
        rays->dz[i] = l.corner.z + (double)x[i] * l.right.z + (double)y[i] * l.down.z;
    }
    rays->count = count;
}
