#include "render/lens.h"

#include <math.h>

#include "tracer/isa.h"

/* The ray through the place (x, y), in pixels from the top left corner, runs from the origin
 * along corner + x right + y down. */
struct zt_lens {
    vec3 corner, right, down;
};

static double pixel_angle(const zt_camera *camera, int height) {
    return 2 * tan(camera->fov / 2) / height;
}

zt_pixel zt_lens_pixel(const zt_camera *camera, int height) {
    return (zt_pixel){0, pixel_angle(camera, height)};
}

zt_status zt_lens_prepare(zt_lens **out, const zt_exposure *exposure, int width, int height,
                          zt_arena *arena) {
    const zt_camera *camera = &exposure->moments[0].camera;
    zt_lens *lens = *out = ZT_PUSH(arena, zt_lens, 1);
    if (!lens) return ZT_EMEMORY;
    xform axes = zt_camera_xform(camera);
    double step = pixel_angle(camera, height);
    vec3 right = vec3_scale(axes.x, step), down = vec3_scale(axes.y, -step);
    vec3 half = vec3_add(vec3_scale(right, width / 2.0), vec3_scale(down, height / 2.0));
    *lens = (zt_lens){vec3_scale(vec3_add(axes.z, half), -1), right, down};
    return ZT_OK;
}

bool zt_lens_has_aperture(const zt_lens *lens) {
    (void)lens;
    return false;
}

bool zt_lens_moves(const zt_lens *lens) {
    (void)lens;
    return false;
}

ZT_CLONES void zt_lens_rays(zt_rays *restrict rays, const zt_lens *lens,
                            const float *restrict x, const float *restrict y,
                            const float *restrict u, const float *restrict v, int count) {
    const zt_lens l = *lens;
    (void)u, (void)v;
    for (int i = 0; i < count; i++) {
        rays->ox[i] = rays->oy[i] = rays->oz[i] = 0;
        rays->dx[i] = l.corner.x + (double)x[i] * l.right.x + (double)y[i] * l.down.x;
        rays->dy[i] = l.corner.y + (double)x[i] * l.right.y + (double)y[i] * l.down.y;
        rays->dz[i] = l.corner.z + (double)x[i] * l.right.z + (double)y[i] * l.down.z;
    }
    rays->count = count;
}
