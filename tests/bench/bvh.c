/* What looking for triangles costs on one core, without shading or anything else: millions of
 * rays a second into a knot of 70,000 triangles and one of a million, for rays of four kinds.
 * Embree's own triangles, asked for 1, 4, 8 and 16 rays at a time, are the floor to compare
 * with; they let rays through at vertices, which ours (tracer/bvh.h, tracer/triangles.h) do
 * not. Then what building takes, and hierarchies over boxes that are built for each frame.
 * Nothing is asserted: these are figures to read. Run by `./dev bench`. */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <embree3/rtcore.h>

#include "base/clock.h"
#include "base/random.h"
#include "tracer/bvh.h"
#include "tracer/clusters.h"
#include "tracer/triangles.h"

enum { WIDTH = 640, HEIGHT = 352, RAYS = WIDTH * HEIGHT, ROUNDS = 3 };

static void must(bool good, const char *what) {
    if (good) return;
    fprintf(stderr, "bench: %s failed\n", what);
    exit(1);
}

static void *get(size_t size) {
    void *memory = aligned_alloc(64, (size + 63) / 64 * 64);
    must(memory != NULL, "memory");
    return memory;
}

static double draw(uint64_t key) { return (double)(zt_random_mix(key) >> 11) * 0x1p-53; }

typedef struct mesh {
    float *positions;
    uint32_t *triangles;
    int32_t vertex_count, triangle_count;
} mesh;

/* A trefoil knot as animations/models/knot.c has it, of 2 along * around triangles. */
static mesh make_knot(int along, int around) {
    mesh m = {.vertex_count = along * around, .triangle_count = 2 * along * around};
    m.positions = get(((size_t)m.vertex_count * 3 + 1) * sizeof *m.positions);
    m.triangles = get((size_t)m.triangle_count * 3 * sizeof *m.triangles);
    double turn = 2 * acos(-1.0), scale = 1 / 3.5;
    for (int a = 0; a < along; a++) {
        double t = turn * a / along, dx = cos(t) + 4 * cos(2 * t), dy = 4 * sin(2 * t) - sin(t);
        double dz = -3 * cos(3 * t), flat = hypot(dx, dy), length = hypot(flat, dz);
        for (int i = 0; i < around; i++) {
            double s = .5 * cos(turn * i / around), u = .5 * sin(turn * i / around);
            float *p = m.positions + 3 * (a * around + i);
            double up = u / (flat * length);
            p[0] = (float)(scale * (sin(t) + 2 * sin(2 * t) + s * dy / flat - up * dx * dz));
            p[1] = (float)(scale * (cos(t) - 2 * cos(2 * t) - s * dx / flat - up * dy * dz));
            p[2] = (float)(scale * (-sin(3 * t) + u * flat / length));
            uint32_t here = (uint32_t)(a * around), next = (uint32_t)((i + 1) % around);
            uint32_t ahead = (uint32_t)((a + 1) % along * around), k = (uint32_t)i;
            const uint32_t quad[6] = {here + k, ahead + k,    ahead + next,
                                      here + k, ahead + next, here + next};
            memcpy(m.triangles + 6 * (a * around + i), quad, sizeof quad);
        }
    }
    return m;
}

/* Rays, and the triangles that they met. */
typedef struct rays {
    float *o[3], *d[3], *far;
    int32_t *triangle;
    int count;
} rays;

static rays new_rays(void) {
    rays r = {.triangle = get(RAYS * sizeof(int32_t)), .far = get(RAYS * sizeof(float))};
    for (int axis = 0; axis < 3; axis++) {
        r.o[axis] = get(RAYS * sizeof(float));
        r.d[axis] = get(RAYS * sizeof(float));
    }
    return r;
}

static void put_ray(rays *r, const double *o, const double *d, double far) {
    double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    for (int axis = 0; axis < 3; axis++) {
        r->o[axis][r->count] = (float)o[axis];
        r->d[axis][r->count] = (float)(d[axis] / length);
    }
    r->far[r->count++] = (float)far;
}

/* A picture of the knot, in tiles of 16 x 16 pixels made of blocks of 4 x 4. */
static rays primary_rays(void) {
    rays r = new_rays();
    const double eye[3] = {0, .2, 1.8};
    for (int k = 0; k < RAYS; k++) {
        int tile = k / 256, block = k / 16 % 16, in = k % 16;
        int x = tile % (WIDTH / 16) * 16 + block % 4 * 4 + in % 4;
        int y = tile / (WIDTH / 16) * 16 + block / 4 * 4 + in / 4;
        const double d[3] = {1.6 * (x + .5 - WIDTH / 2) / HEIGHT,
                             1.6 * (HEIGHT / 2 - y - .5) / HEIGHT, -1.4};
        put_ray(&r, eye, d, INFINITY);
    }
    return r;
}

/* From where primary rays met the mesh: mirrored, to a light, and anywhere. */
typedef struct next_rays {
    rays mirrored, to_light, anywhere;
} next_rays;

static next_rays rays_that_leave(const rays *r, const mesh *m) {
    next_rays next = {new_rays(), new_rays(), new_rays()};
    const double light[3] = {2, 3, 2.5};
    for (int k = 0; k < r->count; k++) {
        if (r->triangle[k] < 0) continue;
        double e[2][3], n[3] = {0}, p[3], d[3], to[3], any[3], d_n = 0, any_n = 0, length = 0,
                        far = 0;
        const uint32_t *t = m->triangles + 3 * r->triangle[k];
        for (int i = 0; i < 3; i++) {
            d[i] = (double)r->d[i][k];
            for (uint32_t j = 0; j < 2; j++)
                e[j][i] = (double)m->positions[3 * t[j + 1] + (uint32_t)i] -
                          (double)m->positions[3 * t[0] + (uint32_t)i];
        }
        for (int i = 0; i < 3; i++) {
            int a = (i + 1) % 3, b = (i + 2) % 3;
            n[i] = e[0][a] * e[1][b] - e[0][b] * e[1][a];
            length += n[i] * n[i];
        }
        for (int i = 0; i < 3; i++) {
            d_n += d[i] * (n[i] /= sqrt(length));
            far += n[i] * ((double)m->positions[3 * t[0] + (uint32_t)i] - (double)r->o[i][k]);
        }
        far /= d_n;
        for (int i = 0; i < 3; i++) {
            n[i] = d_n > 0 ? -n[i] : n[i]; /* against the ray */
            p[i] = (double)r->o[i][k] + far * d[i] + 1e-4 * n[i];
            any[i] = draw((uint64_t)(3 * k + i)) - .5;
            any_n += any[i] * n[i];
        }
        length = 0;
        for (int i = 0; i < 3; i++) {
            d[i] += 2 * fabs(d_n) * n[i];
            any[i] = any_n < 0 ? -any[i] : any[i];
            to[i] = light[i] - p[i];
            length += to[i] * to[i];
        }
        put_ray(&next.mirrored, p, d, INFINITY);
        put_ray(&next.to_light, p, to, sqrt(length));
        put_ray(&next.anywhere, p, any, INFINITY);
    }
    return next;
}

/* Looking with the widest instructions that this machine has. */
zt_bvh_look zt_bvh_look_single_base;
#if defined __x86_64__
zt_bvh_look zt_bvh_look_single_avx2, zt_bvh_look_single_avx512;
#endif

static void look(const zt_bvh *bvh, zt_bvh_rays *rays, zt_bvh_visit *visit, void *user) {
    zt_bvh_look *widest = zt_bvh_look_single_base;
#if defined __x86_64__
    if (__builtin_cpu_supports("avx2")) widest = zt_bvh_look_single_avx2;
    if (__builtin_cpu_supports("x86-64-v4")) widest = zt_bvh_look_single_avx512;
#endif
    widest(bvh, rays, visit, user);
}

/* A way to ask: for the rays first .. first + 255, the nearest triangle, or any. */
typedef struct way {
    void (*ask)(const struct way *way, rays *r, int first, bool any);
    RTCScene scene;
    const zt_bvh *bvh;
    const zt_clusters *clusters;
    bool coherent;
} way;

#define ASK_EMBREE(LANES)                                                                      \
    static void ask_##LANES(const way *w, rays *r, int first, bool any) {                      \
        struct RTCIntersectContext context;                                                    \
        rtcInitIntersectContext(&context);                                                     \
        if (w->coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;                  \
        int end = r->count - first < 256 ? r->count : first + 256;                             \
        for (int at = first; at < end; at += LANES) {                                          \
            struct RTCRayHit##LANES packet = {0};                                              \
            _Alignas(64) int valid[LANES];                                                     \
            memcpy(packet.ray.org_x, r->o[0] + at, sizeof packet.ray.org_x);                   \
            memcpy(packet.ray.org_y, r->o[1] + at, sizeof packet.ray.org_y);                   \
            memcpy(packet.ray.org_z, r->o[2] + at, sizeof packet.ray.org_z);                   \
            memcpy(packet.ray.dir_x, r->d[0] + at, sizeof packet.ray.dir_x);                   \
            memcpy(packet.ray.dir_y, r->d[1] + at, sizeof packet.ray.dir_y);                   \
            memcpy(packet.ray.dir_z, r->d[2] + at, sizeof packet.ray.dir_z);                   \
            memcpy(packet.ray.tfar, r->far + at, sizeof packet.ray.tfar);                      \
            memset(packet.ray.mask, 0xff, sizeof packet.ray.mask);                             \
            memset(packet.hit.geomID, 0xff, sizeof packet.hit.geomID);                         \
            memset(packet.hit.primID, 0xff, sizeof packet.hit.primID);                         \
            for (int lane = 0; lane < LANES; lane++) valid[lane] = -(at + lane < end);         \
            if (any)                                                                           \
                rtcOccluded##LANES(valid, w->scene, &context, &packet.ray);                    \
            else                                                                               \
                rtcIntersect##LANES(valid, w->scene, &context, &packet);                       \
            memcpy(r->triangle + at, packet.hit.primID, sizeof packet.hit.primID);             \
        }                                                                                      \
    }
ASK_EMBREE(4)
ASK_EMBREE(8)
ASK_EMBREE(16)

static void ask_1(const way *w, rays *r, int first, bool any) {
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (int k = first; k < first + 256 && k < r->count; k++) {
        struct RTCRayHit hit = {.ray = {.org_x = r->o[0][k],
                                        .org_y = r->o[1][k],
                                        .org_z = r->o[2][k],
                                        .dir_x = r->d[0][k],
                                        .dir_y = r->d[1][k],
                                        .dir_z = r->d[2][k],
                                        .tfar = r->far[k],
                                        .mask = ~0u},
                                .hit = {.geomID = RTC_INVALID_GEOMETRY_ID, .primID = ~0u}};
        if (any)
            rtcOccluded1(w->scene, &context, &hit.ray);
        else
            rtcIntersect1(w->scene, &context, &hit);
        r->triangle[k] = (int32_t)hit.hit.primID;
    }
}

typedef struct own {
    zt_bvh_rays rays;
    zt_leaning_rays leaning;
    int32_t triangle[ZT_BVH_RAYS];
    const zt_clusters *clusters;
    bool any;
} own;

ZT_CLONES static uint32_t meet(void *user, int32_t box, int first, uint32_t lanes) {
    const uint32_t all = lanes;
    own *b = user;
    for (int i = first; lanes; i++, lanes >>= 1)
        if ((lanes & 1) && zt_meet_cluster(&b->rays.far[i], &b->triangle[i],
                                           &b->clusters->clusters[box], &b->leaning, i))
            if (b->any) b->rays.far[i] = -1;
    return all;
}

ZT_CLONES static void ask_own(const way *w, rays *r, int first, bool any) {
    static own b;
    b.clusters = w->clusters;
    b.any = any;
    b.rays.count = r->count - first < ZT_BVH_RAYS ? r->count - first : ZT_BVH_RAYS;
    size_t size = (size_t)b.rays.count * sizeof(float);
    memcpy(b.rays.ox, r->o[0] + first, size);
    memcpy(b.rays.oy, r->o[1] + first, size);
    memcpy(b.rays.oz, r->o[2] + first, size);
    memcpy(b.rays.dx, r->d[0] + first, size);
    memcpy(b.rays.dy, r->d[1] + first, size);
    memcpy(b.rays.dz, r->d[2] + first, size);
    memcpy(b.rays.far, r->far + first, size);
    memset(b.triangle, 0xff, sizeof b.triangle);
    zt_lean_rays(&b.leaning, b.rays.ox, b.rays.oy, b.rays.oz, b.rays.dx, b.rays.dy, b.rays.dz,
                 b.rays.count);
    look(w->bvh, &b.rays, meet, &b);
    memcpy(r->triangle + first, b.triangle, size);
}

static void rate(const way *w, rays *r, bool any) {
    double best = INFINITY;
    for (int round = 0; round < ROUNDS; round++) {
        double begin = zt_clock_s();
        for (int first = 0; first < r->count; first += 256) w->ask(w, r, first, any);
        best = fmin(best, zt_clock_s() - begin);
    }
    printf(" %6.1f", r->count / best / 1e6);
}

static RTCScene build_embree(RTCDevice device, const mesh *m) {
    RTCScene scene = rtcNewScene(device);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               m->positions, 0, 12, (size_t)m->vertex_count);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               m->triangles, 0, 12, (size_t)m->triangle_count);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcCommitScene(scene);
    return scene;
}

static void rows(const char *name, rays *r, bool any, way *w) {
    static void (*const asks[])(const way *, rays *, int, bool) = {ask_1, ask_4, ask_8, ask_16,
                                                                   ask_own};
    printf("%-22s", name);
    for (int coherent = 0; coherent < 2; coherent++) {
        w->coherent = coherent;
        for (int k = coherent; k < 5 - coherent; k++) {
            w->ask = asks[k];
            rate(w, r, any);
        }
        printf(coherent ? "\n" : "  |");
    }
}

static void measure_mesh(int along, int around, RTCDevice device, zt_bvh_builder *builder) {
    mesh m = make_knot(along, around);
    zt_clusters clusters;
    zt_bvh *bvh = NULL;
    double begin = zt_clock_s();
    must(zt_clusters_build(&clusters, m.positions, m.triangles, m.triangle_count, NULL) ==
             ZT_OK,
         "making clusters");
    double clustered = zt_clock_s();
    must(zt_bvh_of_boxes(&bvh, builder, clusters.boxes, clusters.count) == ZT_OK,
         "building a hierarchy");
    double built = zt_clock_s();
    way w = {.scene = build_embree(device, &m), .bvh = bvh, .clusters = &clusters};
    printf("\n%d triangles; by one thread %.1f ms to make %d clusters, %.1f ms to build their "
           "hierarchy; Embree's own %.1f ms\n%22s scattered: 1    4      8     16   ours  | "
           "coherent: 4  8     16\n",
           m.triangle_count, 1e3 * (clustered - begin), clusters.count,
           1e3 * (built - clustered), 1e3 * (zt_clock_s() - built), "");
    rays primary = primary_rays();
    rows("primary, nearest", &primary, false, &w);
    next_rays next = rays_that_leave(&primary, &m);
    rows("mirrored, nearest", &next.mirrored, false, &w);
    rows("to a light, any", &next.to_light, true, &w);
    rows("anywhere, nearest", &next.anywhere, false, &w);
    rows("anywhere, any", &next.anywhere, true, &w);
    zt_bvh_free(&bvh);
    zt_clusters_free(&clusters);
    rtcReleaseScene(w.scene);
}

/* Balls, of which `radius` is 0.3 of their distance from each other. */
typedef struct crowd {
    zt_bvh_rays rays;
    zt_bvh_box *boxes;
    int32_t count;
    float radius;
} crowd;

static void place(crowd *c, uint64_t frame) {
    c->radius = .3f / cbrtf((float)c->count);
    for (int32_t k = 0; k < c->count; k++)
        for (int axis = 0; axis < 3; axis++) {
            float at = (float)draw((uint64_t)(3 * k + axis)) * 2 - 1;
            at += .01f * (float)draw(frame * 1000003 + (uint64_t)(3 * k + axis));
            c->boxes[k].low[axis] = at - c->radius;
            c->boxes[k].high[axis] = at + c->radius;
        }
}

ZT_CLONES static uint32_t meet_ball(void *user, int32_t box, int first, uint32_t lanes) {
    crowd *c = user;
    const zt_bvh_box *b = &c->boxes[box];
    zt_bvh_rays *r = &c->rays;
    float x = (b->low[0] + b->high[0]) / 2, y = (b->low[1] + b->high[1]) / 2;
    float z = (b->low[2] + b->high[2]) / 2;
    WIDE_LOOP
    for (int lane = 0; lane < ZT_BVH_LANES; lane++) {
        int i = first + lane;
        float ox = x - r->ox[i], oy = y - r->oy[i], oz = z - r->oz[i];
        float middle = ox * r->dx[i] + oy * r->dy[i] + oz * r->dz[i];
        float inside = c->radius * c->radius - (ox * ox + oy * oy + oz * oz - middle * middle);
        float t = middle - sqrtf(inside > 0 ? inside : 0);
        bool met = (lanes >> lane & 1) & (inside > 0) & (t > 0) & (t < r->far[i]);
        r->far[i] = met ? t : r->far[i];
    }
    return lanes;
}

static void measure_crowd(int32_t count, zt_bvh_builder *builder, const char *threads) {
    static crowd c;
    c.boxes = get((size_t)count * sizeof *c.boxes);
    c.count = count;
    rays primary = primary_rays();
    zt_bvh *bvh = NULL;
    double built = INFINITY, looked = INFINITY;
    for (int frame = 0; frame < 2 * ROUNDS; frame++) {
        place(&c, (uint64_t)frame);
        double begin = zt_clock_s();
        must(zt_bvh_of_boxes(&bvh, builder, c.boxes, count) == ZT_OK, "building a hierarchy");
        built = fmin(built, zt_clock_s() - begin);
        begin = zt_clock_s();
        for (int first = 0; first < RAYS; first += ZT_BVH_RAYS) {
            float *const to[] = {c.rays.ox, c.rays.oy, c.rays.oz,
                                 c.rays.dx, c.rays.dy, c.rays.dz};
            for (int axis = 0; axis < 3; axis++) {
                memcpy(to[axis], primary.o[axis] + first, sizeof c.rays.ox);
                memcpy(to[axis + 3], primary.d[axis] + first, sizeof c.rays.dx);
            }
            memcpy(c.rays.far, primary.far + first, sizeof c.rays.far);
            c.rays.count = ZT_BVH_RAYS;
            look(bvh, &c.rays, meet_ball, &c);
        }
        looked = fmin(looked, zt_clock_s() - begin);
    }
    printf("%7d balls: %6.2f ms to build by %s, %5.1f M primary rays/s\n", count, 1e3 * built,
           threads, RAYS / looked / 1e6);
    zt_bvh_free(&bvh);
    free(c.boxes);
}

int main(void) {
    zt_bvh_builder *one, *all;
    zt_bvh *bvh = NULL;
    const zt_bvh_box box = {{0, 0, 0}, {1, 1, 1}};
    double begin = zt_clock_s();
    must(zt_bvh_open(&one, 1, (zt_listener){0}) == ZT_OK, "memory");
    must(zt_bvh_of_boxes(&bvh, one, &box, 1) == ZT_OK, "the first hierarchy");
    printf("%.2f ms to load Embree and build the first hierarchy\n",
           1e3 * (zt_clock_s() - begin));
    RTCDevice device = rtcNewDevice("threads=1");
    must(device != NULL, "Embree");
    puts("millions of rays a second on one core, by rays asked for at a time");
    measure_mesh(567, 62, device, one);
    measure_mesh(2136, 234, device, one);
    puts("");
    measure_crowd(10000, one, "one thread");
    measure_crowd(100000, one, "one thread");
    /* How many threads build is of the whole process: the last one that starts says. */
    must(zt_bvh_open(&all, 0, (zt_listener){0}) == ZT_OK, "memory");
    measure_crowd(10000, all, "all cores");
    measure_crowd(100000, all, "all cores");
    zt_bvh_free(&bvh);
    zt_bvh_close(&one);
    zt_bvh_close(&all);
    rtcReleaseDevice(device);
    return 0;
}
