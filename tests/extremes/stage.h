/* A stage for a case: a scene put together by hand, and the rays to ask about. */
#ifndef ZT_TESTS_STAGE_H
#define ZT_TESTS_STAGE_H

#include "base/arena.h"
#include "draw.h"
#include "scenes.h"

enum { STAGE_RAYS_MAX = 4096, STAGE_MESHES_MAX = 4 };

typedef struct stage {
    test_scene s;
    zt_mesh meshes[STAGE_MESHES_MAX];
    zt_arena arena;                                           /* of the meshes' numbers */
    vec3 origins[STAGE_RAYS_MAX], directions[STAGE_RAYS_MAX]; /* relative to the camera */
    int ray_count, ray_limit; /* rays past the limit are not taken */
} stage;

/* An empty stage with a grey material, number 0, that mirrors half. */
void stage_begin(stage *s, int ray_limit);

/* Rays; all vectors in the scene's space. A direction need not be of length 1. */
void stage_ray(stage *s, vec3 origin, vec3 direction);
void stage_aim(stage *s, vec3 origin, vec3 target);

vec3 stage_direction(draw *d);              /* anywhere, of length 1 */
vec3 stage_within(draw *d, double radius);  /* a point of a ball */
vec3 stage_across(draw *d, vec3 direction); /* of length 1, at a right angle */
double stage_sign(draw *d);

/* One object of a shape, about `size` large, around `center`, turned anyhow. `thin` is the
 * smallest share of its size that one of its measures may be. */
zt_object *stage_object(stage *s, draw *d, zt_shape shape, vec3 center, double size,
                        double thin);

/* A group: members follow with it as their parent. */
int32_t stage_group(stage *s, int32_t parent, vec3 position, quat rotation, vec3 scale);

/* A mesh of given numbers, copied; its number. */
int32_t stage_mesh(stage *s, const vec3 *positions, int vertex_count, const uint32_t *triangles,
                   int triangle_count);
/* A closed ball of rings * sectors quads cut in two, with the ball's normals or without. */
int32_t stage_ball_mesh(stage *s, double radius, int rings, int sectors, bool normals);
zt_object *stage_mesh_object(stage *s, int32_t mesh, vec3 position);

/* Rays that the reference helps to aim, once all objects stand: */

typedef enum stage_way {
    STAGE_FROM_EYE,   /* from the camera into the balls around objects */
    STAGE_FROM_ASIDE, /* the same from anywhere, `distance` times an object's size away */
    STAGE_TANGENT,    /* along the surface, lifted off it by any share down to rounding */
    STAGE_FROM_ON,    /* from points of surfaces, as doubles can say them */
    STAGE_FROM_OFF,   /* from `distance` times an object's size off its surface */
    STAGE_FROM_INSIDE /* from within the balls around objects */
} stage_way;

void stage_shoot(stage *s, draw *d, stage_way way, double distance, int count);

#endif
