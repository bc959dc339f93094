#include "render/guides.h"

#include <math.h>

#include "render/work.h"

/* The channels, NULL where the image has none of that name, and what they are made from. */
typedef struct guides {
    zt_frame frame;
    const zt_scene *scene; /* of the first moment: what does not move */
    const zt_passage *passage;
    zt_projection now, next;
    float *z, *p[3], *n[3], *albedo[3], *motion[2], *object, *material;
    vec3 from, ahead; /* where the camera is, in the middle of the opening, and its view */
} guides;

static bool find_channels(guides *g, const zt_image *image) {
    static const char *const places[] = {"P.X", "P.Y", "P.Z"},
                             *const normals[] = {"N.X", "N.Y", "N.Z"},
                             *const colors[] = {"albedo.R", "albedo.G", "albedo.B"},
                             *const ways[] = {"motion.x", "motion.y"};
    g->z = zt_image_channel(image, "Z");
    g->object = zt_image_channel(image, "id.object");
    g->material = zt_image_channel(image, "id.material");
    bool any = g->z || g->object || g->material;
    for (int i = 0; i < 3; i++) {
        g->p[i] = zt_image_channel(image, places[i]);
        g->n[i] = zt_image_channel(image, normals[i]);
        g->albedo[i] = zt_image_channel(image, colors[i]);
        any |= g->p[i] || g->n[i] || g->albedo[i];
    }
    for (int i = 0; i < 2; i++) {
        g->motion[i] = zt_image_channel(image, ways[i]);
        any |= g->motion[i] != NULL;
    }
    return any;
}

static void aim(zt_rays *rays, const zt_lens *lens, const float *x, const float *y, int count) {
    for (int i = 0; i < count; i++) rays->time[i] = 0.5f;
    zt_lens_rays(rays, lens, x, y, NULL, NULL, count);
}

static vec3 origin_of(const zt_rays *rays, int i) {
    return (vec3){rays->ox[i], rays->oy[i], rays->oz[i]};
}
static vec3 direction_of(const zt_rays *rays, int i) {
    return vec3_normalize((vec3){rays->dx[i], rays->dy[i], rays->dz[i]});
}

/* The ray through the middle of the picture runs along the view, whatever the lens. */
static void find_view(guides *g) {
    float x = (float)g->frame.image->width / 2, y = (float)g->frame.image->height / 2;
    zt_rays *rays = &g->frame.work->threads[0].rays;
    aim(rays, g->frame.job->lens, &x, &y, 1);
    g->from = origin_of(rays, 0);
    g->ahead = direction_of(rays, 0);
}

static void put3(float *const to[3], size_t pixel, vec3 v) {
    const double from[] = {v.x, v.y, v.z};
    for (int i = 0; i < 3; i++)
        if (to[i]) to[i][pixel] = (float)from[i];
}

/* Where a point on an object goes until the next frame. */
static void tell_motion(const guides *g, size_t pixel, int32_t object, vec3 at) {
    const double width = g->frame.image->width, height = g->frame.image->height;
    double x, y, next_x, next_y;
    vec3 next = zt_passage_carry(g->passage, object, at);
    bool seen = zt_project(&x, &y, &g->now, at) &&
                zt_project(&next_x, &next_y, &g->next, next) && isfinite(next_x + next_y);
    double right = seen ? next_x - x : 0, up = seen ? y - next_y : 0;
    if (g->now.lens == ZT_LENS_EQUIRECTANGULAR) right -= rint(right); /* the shorter way */
    if (g->motion[0]) g->motion[0][pixel] = (float)(right * width);
    if (g->motion[1]) g->motion[1][pixel] = (float)(up * height);
}

/* What a ray met, which began at `probe->origin`: the probe's own point is off the surface by
 * what further rays ask for, and of smooth meshes by more. */
static void tell(const guides *g, size_t pixel, const zt_probe *probe) {
    bool met = probe->object >= 0;
    vec3 at = vec3_add(probe->origin, vec3_scale(probe->direction, met ? probe->distance : 0));
    vec3 none = {0, 0, 0};
    if (g->z) g->z[pixel] = met ? (float)vec3_dot(vec3_sub(at, g->from), g->ahead) : INFINITY;
    put3(g->p, pixel, met ? vec3_add(at, g->scene->camera.position) : none);
    put3(g->n, pixel, met ? probe->normal : none);
    put3(g->albedo, pixel, met ? probe->color : none);
    if (met && (g->motion[0] || g->motion[1])) tell_motion(g, pixel, probe->object, at);
    for (int i = 0; i < 2 && !met; i++)
        if (g->motion[i]) g->motion[i][pixel] = 0;
    if (g->object) g->object[pixel] = (float)(probe->object + 1);
    if (g->material)
        g->material[pixel] = met ? (float)(g->scene->objects[probe->object].material + 1) : 0;
}

static void guide_tile(void *user, int index, int worker) {
    guides *g = user;
    zt_frame *f = &g->frame;
    if (zt_frame_stopped(f)) return;
    zt_render_thread *own = &f->work->threads[worker];
    int left = index % f->tile_columns * TILE_SIDE, top = index / f->tile_columns * TILE_SIDE;
    int width = min_int(TILE_SIDE, f->image->width - left),
        height = min_int(TILE_SIDE, f->image->height - top), count = width * height;
    for (int i = 0; i < count; i++) {
        int row = top + i / width;
        own->places.x[i] = (float)(left + i % width) + 0.5f;
        own->places.y[i] = (float)row + 0.5f;
    }
    aim(&own->rays, f->job->lens, own->places.x, own->places.y, count);
    zt_probe probes[ZT_BATCH];
    for (int i = 0; i < count; i++)
        probes[i] = (zt_probe){.origin = origin_of(&own->rays, i),
                               .direction = direction_of(&own->rays, i),
                               .time = 0.5,
                               .unlit = true,
                               .source = -1};
    f->job->scene->kernel->probe(f->job->scene->tracer, probes, count, own->kernel);
    for (int i = 0; i < count; i++)
        tell(g,
             (size_t)(top + i / width) * (size_t)f->image->width + (size_t)(left + i % width),
             &probes[i]);
}

zt_status zt_guides_render(zt_image *image, const zt_render_job *job,
                           const zt_exposure *exposure, const zt_passage *passage,
                           zt_render_work *work, zt_pool *pool) {
    int columns = (image->width + TILE_SIDE - 1) / TILE_SIDE;
    int rows = (image->height + TILE_SIDE - 1) / TILE_SIDE;
    guides g = {.frame = {.image = image,
                          .job = job,
                          .work = work,
                          .pool = pool,
                          .tile_columns = columns,
                          .tile_count = columns * rows},
                .scene = &exposure->moments[0],
                .passage = passage};
    if (!find_channels(&g, image)) return ZT_OK;
    if (g.motion[0] || g.motion[1]) {
        double aspect = (double)image->width / image->height;
        g.now = zt_camera_projection(&passage->now->camera, passage->origin, aspect);
        g.next = zt_camera_projection(&passage->next->camera, passage->origin, aspect);
    }
    find_view(&g);
    zt_pool_run(pool, g.frame.tile_count, guide_tile, &g);
    return g.frame.stopped ? ZT_ESTOPPED : ZT_OK;
}
