/* The triangles of a mesh in clusters of up to eight that lie close together: what the boxes of
 * a mesh's hierarchy hold, made so that one ray meets eight triangles at a time. */
#ifndef ZT_TRACER_CLUSTERS_H
#define ZT_TRACER_CLUSTERS_H

#include <stdalign.h>
#include <stdint.h>

#include <zoetrope/status.h>

#include "base/pool.h"
#include "tracer/bvh.h"

/* Corner 0, 1 and 2 of each triangle, by axis: corners[corner][axis][triangle]. Where there are
 * fewer than sixteen, the last one is there again. */
enum { ZT_CLUSTER = 16 };
typedef struct zt_cluster {
    alignas(64) float corners[3][3][ZT_CLUSTER];
    int32_t triangles[ZT_CLUSTER]; /* which of the mesh */
} zt_cluster;

typedef struct zt_clusters {
    zt_cluster *clusters;
    zt_bvh_box *boxes; /* one around each cluster */
    int32_t count;
} zt_clusters;

/* `positions` are three finite floats for each vertex, `triangles` three indices each. They
 * are shared out among the pool's threads (NULL: the caller's alone), which changes nothing; so
 * many are worth more than one. ZT_EMEMORY. */
enum { ZT_CLUSTERS_MANY = 10000 };
zt_status zt_clusters_build(zt_clusters *out, const float *positions, const uint32_t *triangles,
                            int32_t triangle_count, zt_pool *pool);
void zt_clusters_free(zt_clusters *clusters);

#endif
