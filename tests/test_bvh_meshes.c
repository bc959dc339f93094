/* Clusters hold each triangle of a mesh; and rays at the very corners and edges of closed
 * meshes all meet a triangle, the same one whatever the hierarchy over the clusters is like.
 * ZT_TEST_RAYS=100000000 aims that many rays at corners and edges instead of ten million. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "draw.h"
#include "looking.h"
#include "tracer/clusters.h"
#include "tracer/triangles.h"

/* Closed meshes, which contain `center`, or a ring around it when they have one. */
typedef struct closed_mesh {
    const char *name;
    float *positions;
    uint32_t *triangles;
    int32_t vertex_count, triangle_count;
    double ring;
} closed_mesh;

static closed_mesh new_mesh(const char *name, int32_t vertex_count, int32_t triangle_count) {
    return (closed_mesh){name,
                         malloc((size_t)vertex_count * 3 * sizeof(float)),
                         malloc((size_t)triangle_count * 3 * sizeof(uint32_t)),
                         vertex_count,
                         triangle_count,
                         0};
}

static void free_mesh(closed_mesh *m) {
    free(m->positions);
    free(m->triangles);
}

static void put_vertex(closed_mesh *m, int32_t k, double x, double y, double z) {
    m->positions[3 * k] = (float)x;
    m->positions[3 * k + 1] = (float)y;
    m->positions[3 * k + 2] = (float)z;
}

static void put_triangle(closed_mesh *m, int32_t k, int32_t a, int32_t b, int32_t c) {
    m->triangles[3 * k] = (uint32_t)a;
    m->triangles[3 * k + 1] = (uint32_t)b;
    m->triangles[3 * k + 2] = (uint32_t)c;
}

/* A ball of radius 1 around (shift, shift, shift), with fans of `sectors` at its poles. */
static closed_mesh ball(const char *name, int rings, int sectors, double shift) {
    closed_mesh m = new_mesh(name, (rings - 1) * sectors + 2, 2 * (rings - 1) * sectors);
    int32_t north = (rings - 1) * sectors, south = north + 1, k = 0;
    put_vertex(&m, north, shift, shift, shift + 1);
    put_vertex(&m, south, shift, shift, shift - 1);
    for (int r = 1; r < rings; r++)
        for (int s = 0; s < sectors; s++) {
            double down = acos(-1.0) * r / rings, turn = 2 * acos(-1.0) * s / sectors;
            put_vertex(&m, (r - 1) * sectors + s, shift + sin(down) * cos(turn),
                       shift + sin(down) * sin(turn), shift + cos(down));
        }
    for (int s = 0; s < sectors; s++) {
        int32_t next = (s + 1) % sectors, last = (rings - 2) * sectors;
        put_triangle(&m, k++, north, s, next);
        put_triangle(&m, k++, south, last + next, last + s);
        for (int r = 0; r + 2 < rings; r++) {
            int32_t upper = r * sectors, lower = upper + sectors;
            put_triangle(&m, k++, upper + s, lower + s, lower + next);
            put_triangle(&m, k++, upper + s, lower + next, upper + next);
        }
    }
    return m;
}

/* A ring of radius 1 around z whose tube has a radius of 0.3. */
static closed_mesh torus(int along, int around) {
    closed_mesh m = new_mesh("ring", along * around, 2 * along * around);
    m.ring = 1;
    for (int a = 0; a < along; a++)
        for (int b = 0; b < around; b++) {
            double s = 2 * acos(-1.0) * a / along, t = 2 * acos(-1.0) * b / around;
            double r = 1 + .3 * cos(t);
            put_vertex(&m, a * around + b, r * cos(s), r * sin(s), .3 * sin(t));
            int32_t next_a = (a + 1) % along * around, next_b = (b + 1) % around;
            int32_t k = 2 * (a * around + b);
            put_triangle(&m, k, a * around + b, next_a + b, next_a + next_b);
            put_triangle(&m, k + 1, a * around + b, next_a + next_b, a * around + next_b);
        }
    return m;
}

/* Rays into the clusters of a mesh, and the triangles that they meet. */
typedef struct shot {
    const zt_clusters *clusters;
    zt_bvh_rays rays;
    zt_leaning_rays leaning;
    int32_t triangle[ZT_BVH_RAYS];
} shot;

static uint32_t meet(void *user, int32_t box, int first, uint32_t lanes) {
    const uint32_t all = lanes;
    shot *s = user;
    for (int i = first; lanes; i++, lanes >>= 1)
        if (lanes & 1)
            zt_meet_cluster(&s->rays.far[i], &s->triangle[i], &s->clusters->clusters[box],
                            &s->leaning, i);
    return all;
}

/* At corners, edges and now and then the inside of triangles, from within. */
static void aim(shot *s, const closed_mesh *m, draw *d, double shift) {
    s->rays.count = ZT_BVH_RAYS;
    for (int i = 0; i < ZT_BVH_RAYS; i++) {
        double turn = draw_between(d, 0, 2 * acos(-1.0)), inner = m->ring ? .1 : .5;
        double from[3] = {m->ring * cos(turn), m->ring * sin(turn), 0}, weight[3] = {1, 0, 0};
        if (draw_below(d, 2)) weight[0] = 1 - (weight[1] = draw_unit(d));
        if (draw_below(d, 8) == 0) weight[0] -= (weight[2] = draw_unit(d) * weight[0]);
        const uint32_t *t = m->triangles + 3 * draw_below(d, m->triangle_count);
        float *const o[3] = {s->rays.ox, s->rays.oy, s->rays.oz};
        float *const way[3] = {s->rays.dx, s->rays.dy, s->rays.dz};
        for (int axis = 0; axis < 3; axis++) {
            double to = 0;
            for (int k = 0; k < 3; k++)
                to += weight[k] * (double)m->positions[3 * t[k] + (uint32_t)axis];
            o[axis][i] = (float)(shift + from[axis] + draw_between(d, -inner, inner));
            way[axis][i] = (float)(to - (double)o[axis][i]);
        }
        s->rays.far[i] = INFINITY;
        s->triangle[i] = -1;
    }
    zt_lean_rays(&s->leaning, s->rays.ox, s->rays.oy, s->rays.oz, s->rays.dx, s->rays.dy,
                 s->rays.dz, ZT_BVH_RAYS);
}

static int64_t ray_count(void) {
    const char *asked = getenv("ZT_TEST_RAYS");
#ifdef __SANITIZE_ADDRESS__
    return asked ? atoll(asked) : 1000000;
#else
    return asked ? atoll(asked) : 10000000;
#endif
}

static void shoot_closed(closed_mesh mesh, double shift, int64_t rays) {
    static shot s;
    draw d = {.key = 3};
    zt_clusters clusters;
    zt_bvh *bvh = NULL;
    assert_int_equal(
        zt_clusters_build(&clusters, mesh.positions, mesh.triangles, mesh.triangle_count, NULL),
        ZT_OK);
    assert_int_equal(zt_bvh_of_boxes(&bvh, builder, clusters.boxes, clusters.count), ZT_OK);
    s.clusters = &clusters;
    int64_t through = 0, shots = 0;
    for (; shots < rays; shots += ZT_BVH_RAYS) {
        aim(&s, &mesh, &d, shift);
        look(bvh, &s.rays, meet, &s);
        for (int i = 0; i < ZT_BVH_RAYS; i++) through += s.triangle[i] < 0;
        /* A convex body is met where was aimed, and not behind. */
        for (int i = 0; i < ZT_BVH_RAYS && !mesh.ring; i++) through += !(s.rays.far[i] < 1.01f);
    }
    print_message("%-6s %7d triangles: %lld rays at corners and edges, %lld got through\n",
                  mesh.name, mesh.triangle_count, (long long)shots, (long long)through);
    assert_int_equal(through, 0);
    zt_bvh_free(&bvh);
    zt_clusters_free(&clusters);
    free_mesh(&mesh);
}

static void no_ray_gets_through_a_closed_mesh(void **state) {
    (void)state;
    int64_t share = ray_count() / 5;
    shoot_closed(ball("ball", 8, 12, 0), 0, share);
    shoot_closed(ball("ball", 100, 200, 0), 0, share);
    shoot_closed(ball("afar", 60, 100, 100), 100, share);
    shoot_closed(ball("fan", 3, 1000, 0), 0, share);
    shoot_closed(torus(300, 100), 0, share);
}

/* Each triangle twice, the second time in another place of the list: what a ray meets is what
 * looking at all of them finds, however many threads have built the hierarchy. */
static void triangles_are_met_by_index(void **state) {
    (void)state;
    static shot s, all;
    closed_mesh m = torus(60, 30);
    int32_t count = m.triangle_count;
    m.triangles = realloc(m.triangles, (size_t)count * 6 * sizeof(uint32_t));
    assert_non_null(m.triangles);
    for (int32_t k = 0; k < count; k++)
        memcpy(m.triangles + 3 * (count + k), m.triangles + 3 * ((int64_t)k * 7 % count),
               3 * sizeof(uint32_t));
    m.triangle_count = 2 * count;
    zt_clusters clusters;
    assert_int_equal(
        zt_clusters_build(&clusters, m.positions, m.triangles, m.triangle_count, NULL), ZT_OK);
    s.clusters = all.clusters = &clusters;
    const int threads[] = {1, 2, 4};
    for (int k = 0; k < 3; k++) {
        zt_bvh_builder *own;
        zt_bvh *bvh = NULL;
        draw d = {.key = 4};
        assert_int_equal(zt_bvh_open(&own, threads[k], (zt_listener){0}), ZT_OK);
        assert_int_equal(zt_bvh_of_boxes(&bvh, own, clusters.boxes, clusters.count), ZT_OK);
        for (int round = 0; round < 40; round++) {
            aim(&s, &m, &d, 0);
            all = s;
            look(bvh, &s.rays, meet, &s);
            for (int32_t box = 0; box < clusters.count; box++)
                for (int first = 0; first < ZT_BVH_RAYS; first += ZT_BVH_LANES)
                    meet(&all, box, first, 0xffff);
            assert_memory_equal(s.triangle, all.triangle, sizeof s.triangle);
            assert_memory_equal(s.rays.far, all.rays.far, sizeof s.rays.far);
            for (int i = 0; i < ZT_BVH_RAYS; i++) {
                assert_in_range(s.triangle[i], 0, m.triangle_count - 1);
                if (count % 7) assert_true(s.triangle[i] < count); /* the first of the two */
            }
        }
        zt_bvh_free(&bvh);
        zt_bvh_close(&own);
    }
    zt_clusters_free(&clusters);
    free_mesh(&m);
}

/* Each triangle is in one cluster, once but for filling up, and within its box. */
static void clusters_hold_each_triangle(void **state) {
    (void)state;
    closed_mesh m = torus(50, 21);
    for (int32_t k = 0; k < m.triangle_count / 2; k++) /* half of them in one place */
        memcpy(m.triangles + 3 * k, m.triangles, 3 * sizeof(uint32_t));
    zt_clusters c;
    assert_int_equal(zt_clusters_build(&c, m.positions, m.triangles, m.triangle_count, NULL),
                     ZT_OK);
    int32_t *cluster_of = malloc((size_t)m.triangle_count * sizeof *cluster_of);
    memset(cluster_of, 0xff, (size_t)m.triangle_count * sizeof *cluster_of);
    for (int32_t k = 0; k < c.count; k++)
        for (int i = 0; i < ZT_CLUSTER; i++) {
            int32_t triangle = c.clusters[k].triangles[i];
            assert_in_range(triangle, 0, m.triangle_count - 1);
            assert_true(cluster_of[triangle] == -1 || cluster_of[triangle] == k);
            cluster_of[triangle] = k;
            for (int corner = 0; corner < 3; corner++)
                for (int axis = 0; axis < 3; axis++) {
                    float at = c.clusters[k].corners[corner][axis][i];
                    uint32_t vertex = m.triangles[3 * triangle + corner];
                    assert_true(at == m.positions[3 * vertex + (uint32_t)axis]);
                    assert_true(at >= c.boxes[k].low[axis] && at <= c.boxes[k].high[axis]);
                }
        }
    for (int32_t k = 0; k < m.triangle_count; k++) assert_true(cluster_of[k] >= 0);
    assert_true(c.count < m.triangle_count / 5);
    free(cluster_of);
    zt_clusters_free(&c);
    assert_int_equal(zt_clusters_build(&c, m.positions, m.triangles, 0, NULL), ZT_OK);
    assert_int_equal(c.count, 0);
    zt_clusters_free(&c);
    free_mesh(&m);
}

/* However many threads make them. */
static void clusters_are_the_same_for_any_threads(void **state) {
    (void)state;
    closed_mesh m = torus(200, 101);
    zt_clusters alone, together;
    zt_pool *pool;
    assert_int_equal(zt_pool_open(&pool, 3), ZT_OK);
    assert_int_equal(
        zt_clusters_build(&alone, m.positions, m.triangles, m.triangle_count, NULL), ZT_OK);
    assert_int_equal(
        zt_clusters_build(&together, m.positions, m.triangles, m.triangle_count, pool), ZT_OK);
    zt_pool_close(&pool);
    assert_int_equal(alone.count, together.count);
    size_t count = (size_t)alone.count;
    assert_memory_equal(alone.clusters, together.clusters, count * sizeof *alone.clusters);
    assert_memory_equal(alone.boxes, together.boxes, count * sizeof *alone.boxes);
    zt_clusters_free(&alone);
    zt_clusters_free(&together);
    free_mesh(&m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(clusters_hold_each_triangle),
        cmocka_unit_test(clusters_are_the_same_for_any_threads),
        cmocka_unit_test(triangles_are_met_by_index),
        cmocka_unit_test(no_ray_gets_through_a_closed_mesh),
    };
    return cmocka_run_group_tests(tests, open_builder, close_builder);
}
