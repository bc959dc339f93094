/* Replay: the samples of a pixel once more, through the same calls that rendering makes, and
 * what each of their rays meets, by the tracer's probes. */
#include <zoetrope/replay.h>

#include <math.h>
#include <string.h>

#include "base/diag.h"
#include "keyframe/advice.h"
#include "keyframe/animation.h"
#include "render/canvas.h"
#include "render/samples.h"
#include "sequence/pacing.h"

/* What is here stays where it is, and what it points to is in the frame's memory. */
typedef struct replaying {
    zt_renderer *renderer;
    const zt_replay *replay;
    int64_t frame;
    int32_t column, row;
    zt_taking taking;
    const zt_scene *scene;     /* of the first moment: what does not move */
    vec3 eye;                  /* what space is relative to */
    const uint16_t *moment_at; /* where something moves */
    void *work;                /* the kernel's */
    zt_places *places;
    zt_rays *rays;
    zt_radiance *light;
    zt_replay_ray *path; /* as many as there may be */
    int32_t lamp_count;  /* of lights that are somewhere */
    vec3 *lamp_points;   /* for each light */
} replaying;

static zt_status push_parts(replaying *p, zt_arena *arena) {
    p->work = zt_arena_push(arena, zt_kernel_work_size());
    p->places = ZT_PUSH(arena, zt_places, 1);
    p->rays = ZT_PUSH(arena, zt_rays, 1);
    p->light = ZT_PUSH(arena, zt_radiance, 1);
    p->path = ZT_PUSH(arena, zt_replay_ray, (size_t)p->scene->reflection_depth + 1);
    p->lamp_points = ZT_PUSH(arena, vec3, (size_t)p->scene->light_count);
    bool all = p->work && p->places && p->rays && p->light && p->path && p->lamp_points;
    return all ? ZT_OK : ZT_EMEMORY;
}

/* Makes all ready, with the pixel and whom to tell given. */
static zt_status prepare(replaying *p) {
    zt_renderer *r = p->renderer;
    zt_sampling own = r->sampling;
    ZT_TRY(zt_pacing_sampling(&r->sampling, r, p->frame));
    zt_status status = zt_renderer_prepare(&p->taking, r, p->frame);
    r->sampling = own;
    ZT_TRY(status);
    p->scene = p->taking.exposure.moments;
    p->eye = p->scene->camera.position;
    for (int32_t i = 0; i < p->scene->light_count; i++)
        p->lamp_count += p->scene->lights[i].kind != ZT_LIGHT_AMBIENT;
    ZT_TRY(push_parts(p, &r->frame));
    if (p->taking.exposure.moment_count == 1) return ZT_OK;
    return zt_exposure_index(&p->moment_at, &p->taking.exposure, &r->frame);
}

static void set3(double to[3], vec3 from) { to[0] = from.x, to[1] = from.y, to[2] = from.z; }
static void set_point(double to[3], const replaying *p, vec3 relative) {
    set3(to, vec3_add(relative, p->eye));
}

static const char *object_name(const replaying *p, int32_t object) {
    return zt_advice_name_of_object(p->renderer->animation, object).text;
}

static const char *light_name(const replaying *p, int32_t light) {
    static const zt_owner owners[] = {[ZT_LIGHT_AMBIENT] = ZT_OWNER_AMBIENT,
                                      [ZT_LIGHT_POINT] = ZT_OWNER_POINT,
                                      [ZT_LIGHT_DISK] = ZT_OWNER_DISK_LIGHT,
                                      [ZT_LIGHT_RECTANGLE] = ZT_OWNER_RECTANGLE_LIGHT};
    return zt_advice_name_of(p->renderer->animation, owners[p->scene->lights[light].kind],
                             light)
        .text;
}

/* The moment before a time, and how far it is on the way to the next. */
static double find_moment(int32_t *moment, const replaying *p, double time) {
    *moment = 0;
    if (!p->moment_at) return 0;
    return zt_exposure_find(moment, &p->taking.exposure, p->moment_at, time);
}

static void ask(const replaying *p, zt_probe *probe) {
    const zt_ready *ready = &p->taking.ready;
    ready->kernel->probe(ready->tracer, probe, 1, p->work);
}

/* What is on the way from where a ray ended to a point of a lamp. */
static void find_hider(zt_replay_lamp *lamp, const replaying *p, const zt_probe *at,
                       vec3 point) {
    vec3 way = vec3_sub(point, at->mirror_origin);
    zt_probe probe = *at;
    probe.origin = at->mirror_origin;
    probe.direction = way;
    probe.source = at->mirror_source;
    probe.lamp_points = NULL;
    ask(p, &probe);
    if (probe.object < 0 || probe.distance >= vec3_length(way)) return;
    lamp->hider = object_name(p, probe.object);
    lamp->hider_triangle = probe.part;
    lamp->hider_distance = probe.distance;
}

/* Where the middle of a lamp is at a moment. */
static vec3 middle_of_lamp(const replaying *p, int32_t light, double time) {
    int32_t moment;
    double between = find_moment(&moment, p, time);
    const zt_scene *a = &p->taking.exposure.moments[moment], *b = between > 0 ? a + 1 : a;
    vec3 from = vec3_sub(a->lights[light].position, p->eye);
    vec3 to = vec3_sub(b->lights[light].position, p->eye);
    return vec3_add(from, vec3_scale(vec3_sub(to, from), between));
}

/* What a lamp gives the point where a ray ended. */
static zt_replay_lamp look_at_lamp(const replaying *p, const zt_probe *at, int32_t light) {
    vec3 point = at->lamp_points[light], middle = middle_of_lamp(p, light, at->time);
    bool looked = vec3_max_abs(vec3_sub(point, at->mirror_origin)) > 0;
    bool told = p->scene->light_count <= 64, lit = told && at->lit >> light & 1;
    zt_replay_lamp lamp = {.name = light_name(p, light), .hider_triangle = -1};
    const zt_light *l = &p->scene->lights[light];
    bool is_point = l->kind == ZT_LIGHT_POINT && l->radius == 0;
    set_point(lamp.point, p, looked && !is_point ? point : middle);
    if (looked && !lit && l->shadows) find_hider(&lamp, p, at, point);
    if (lit || (looked && !told && !lamp.hider))
        lamp.gift = ZT_GIFT_LIGHT;
    else if (lamp.hider)
        lamp.gift = ZT_GIFT_HIDDEN;
    else
        lamp.gift = vec3_dot(at->normal, vec3_sub(middle, at->mirror_origin)) <= 0
                        ? ZT_GIFT_BEHIND
                        : ZT_GIFT_NOTHING;
    return lamp;
}

/* Whether a thing mirrors at a moment. */
static bool is_mirror(const replaying *p, int32_t object, double time) {
    int32_t material = p->scene->objects[object].material, moment;
    double between = find_moment(&moment, p, time);
    const zt_scene *a = &p->taking.exposure.moments[moment], *b = between > 0 ? a + 1 : a;
    return (1 - between) * a->materials[material].reflectivity +
               between * b->materials[material].reflectivity >
           0;
}

/* Follows a sample's first ray as rendering does. */
static zt_status follow(int *ray_count, replaying *p, zt_probe probe) {
    zt_arena *arena = &p->renderer->frame;
    for (*ray_count = 0; *ray_count <= p->scene->reflection_depth;) {
        zt_replay_ray *ray = &p->path[*ray_count];
        zt_replay_lamp *lamps = (zt_replay_lamp *)ray->lamps; /* of the sample before */
        if (!lamps) lamps = ZT_PUSH(arena, zt_replay_lamp, (size_t)p->lamp_count);
        if (!lamps) return ZT_EMEMORY;
        probe.depth = (*ray_count)++;
        ask(p, &probe);
        *ray = (zt_replay_ray){
            .triangle = probe.part, .lamps = lamps, .lamp_count = p->lamp_count};
        set_point(ray->origin, p, probe.origin);
        set3(ray->direction, vec3_normalize(probe.direction));
        if (probe.object < 0) return ZT_OK;
        ray->hit = object_name(p, probe.object);
        ray->distance = probe.distance;
        set_point(ray->point, p, probe.point);
        set3(ray->normal, probe.normal);
        for (int32_t i = 0; i < p->scene->light_count; i++)
            if (p->scene->lights[i].kind != ZT_LIGHT_AMBIENT)
                *lamps++ = look_at_lamp(p, &probe, i);
        if (!is_mirror(p, probe.object, probe.time)) return ZT_OK;
        probe.origin = probe.mirror_origin;
        probe.direction = probe.mirror_direction;
        probe.source = probe.mirror_source;
    }
    return ZT_OK;
}

/* When, in the film. */
static double time_of(const replaying *p, double share) {
    const zt_film *film = &p->renderer->animation->film;
    double opening = film->shutter.open + share * (film->shutter.close - film->shutter.open);
    return zt_rate_time(film->rate, p->frame) + opening * film->rate.den / film->rate.num;
}

static zt_status take(replaying *p, int number) {
    const zt_taking *t = &p->taking;
    zt_places *places = p->places;
    zt_rays *rays = p->rays;
    zt_samples_key(places, &t->job, &p->column, &p->row, 1);
    zt_samples_take(places, rays, &t->job, &p->column, &p->row, 0, 1, number);
    zt_lens_rays(rays, t->lens, places->x, places->y, places->u, places->v, 1);
    t->ready.kernel->trace(p->light, t->ready.tracer, rays, p->work);
    bool timed = t->ready.moves || zt_lens_moves(t->lens);
    double opening = timed ? (double)rays->time[0] : 0;
    zt_replay_sample sample = {.number = t->job.sampling.max == 1 ? ZT_SAMPLE_MIDDLE : number,
                               .place = {(double)places->x[0], (double)places->y[0]},
                               .weight = t->job.warp ? (double)places->weight[0] : 1,
                               .timed = timed,
                               .opening = opening,
                               .time_s = time_of(p, opening),
                               .through_lens = zt_lens_has_aperture(t->lens),
                               .lens = {(double)places->u[0], (double)places->v[0]},
                               .light = {p->light->r[0], p->light->g[0], p->light->b[0]},
                               .rays = p->path};
    zt_probe probe = {.origin = {rays->ox[0], rays->oy[0], rays->oz[0]},
                      .direction = {rays->dx[0], rays->dy[0], rays->dz[0]},
                      .time = opening,
                      .key = rays->key[0],
                      .sample = rays->sample[0],
                      .lamp_points = p->lamp_points,
                      .source = -1};
    ZT_TRY(follow(&sample.ray_count, p, probe));
    ZT_TRY(zt_meshes_status(p->renderer->meshes));
    p->replay->sample(p->replay->user, &sample);
    return ZT_OK;
}

static bool in_picture(const zt_renderer *r, int column, int row) {
    return column >= 0 && row >= 0 && column < r->format.width && row < r->format.height;
}

zt_status zt_renderer_replay_sample(zt_renderer *r, int64_t frame, int column, int row,
                                    int number, const zt_replay *replay) {
    if (!in_picture(r, column, row) || number < 0) return ZT_EARGUMENT;
    replaying p = {r, replay, frame, column, row, .path = NULL};
    ZT_TRY(prepare(&p));
    return take(&p, number);
}

/* All samples of the pixel, and the mean of those that are finite. */
static zt_status take_all(double rgb[3], replaying *p, int count) {
    bool middle = count == 1 && p->taking.job.sampling.edges;
    zt_canvas_sum positive = {0}, negative = {0};
    for (int i = 0; i < count; i++) {
        ZT_TRY(take(p, middle ? ZT_SAMPLE_MIDDLE : i));
        const float light[3] = {p->light->r[0], p->light->g[0], p->light->b[0]};
        if (!isfinite(light[0]) || !isfinite(light[1]) || !isfinite(light[2])) continue;
        bool below = p->taking.job.warp && p->places->weight[0] < 0;
        zt_canvas_sum *sum = below ? &negative : &positive;
        sum->r += (double)light[0];
        sum->g += (double)light[1];
        sum->b += (double)light[2];
        sum->taken++;
    }
    double mean[4];
    zt_canvas_mean(mean, &positive, &negative);
    memcpy(rgb, mean, 3 * sizeof *rgb);
    return ZT_OK;
}

/* What rendering makes of the pixel, and of how many samples. */
static zt_status render(zt_replayed *result, zt_image *image, zt_renderer *r, int64_t frame,
                        size_t pixel, const zt_watcher *watcher) {
    ZT_TRY(zt_image_add_channel(image, "samples"));
    ZT_TRY(zt_renderer_frame(r, frame, image, watcher));
    for (int c = 0; c < 3; c++) result->pixel[c] = image->pixels[4 * pixel + (size_t)c];
    result->sample_count = (int)zt_image_channel(image, "samples")[pixel];
    return ZT_OK;
}

zt_status zt_renderer_replay(zt_replayed *result, zt_renderer *r, int64_t frame, int column,
                             int row, const zt_replay *replay, const zt_watcher *watcher) {
    if (!in_picture(r, column, row)) return ZT_EARGUMENT;
    zt_image *image;
    replaying p = {r, replay, frame, column, row, .path = NULL};
    size_t pixel = (size_t)row * (size_t)r->format.width + (size_t)column;
    ZT_TRY(zt_image_create(&image, r->format.width, r->format.height));
    zt_status status = render(result, image, r, frame, pixel, watcher);
    zt_image_free(&image);
    ZT_TRY(status);
    ZT_TRY(prepare(&p));
    return take_all(result->mean, &p, result->sample_count);
}
