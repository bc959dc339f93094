/* Which lights reach a point: against the reference, and where a coarse mesh passes for a
 * smooth thing against what that would do. */
#include "judge.h"

/* One light, from the very point that the tracer found. */
static void judge_light(const judge *j, const ref_ray *ray, int light, bool reached, real scale,
                        const probe *a) {
    const ref_primitive *p = &j->ref->primitives[a->object];
    real3 point = real3_of(a->point), way = real3_sub(j->ref->lights[light], point);
    ref_face face = ref_nearest_face(p, a->part, point);
    real side = real3_dot(face.normal, way);
    if (real3_dot(face.normal, ray->d) > 0) side = -side;
    ref_ray shadow = {point, way, a->object, a->part};
    ref_hit hit = {-1, -1, 0}, blocker;
    bool blocked = false, sure;
    if (side > 0 && j->ref->scene->lights[light].shadows)
        for (int32_t i = 0; i < j->ref->scene->object_count && !blocked; i++)
            if ((blocked = ref_first(&blocker, &j->ref->primitives[i], &shadow, 0, 1)))
                hit = blocker;
    if ((side > 0 && !blocked) == reached) return;
    real length = real3_length(way), turn = j->tolerance * (face.twist + face.bend * scale);
    real doubt = j->tolerance * (scale + length) + turn * length;
    /* Along the surface it is open which side the ray came from. */
    bool along = real_abs(real3_dot(face.normal, real3_unit(ray->d))) <= turn + j->tolerance;
    /* At a ridge the other side counts as well. */
    ref_face faces[REF_FACES_MAX];
    int face_count = ref_faces(faces, p, a->part, point), near = 0;
    for (int i = 0; i < face_count; i++) near += faces[i].distance <= j->tolerance * scale;
    if (along || real_abs(side) <= doubt || near > 1)
        sure = false;
    else if (side < 0)
        sure = true;
    else
        ref_blocked(&sure, j->ref, &shadow, 1, j->tolerance, -1);
    probe of_shadow = {.object = a->object, .part = a->part, .normal = a->normal};
    if (!sure)
        j->tally->ties++;
    else if (reached)
        judge_count(j, &j->tally->leaks, "light through a surface", &shadow, hit, &of_shadow);
    else
        judge_count(j, &j->tally->acne, "shadow of nothing", &shadow, hit, &of_shadow);
}

void judge_lights(const judge *j, const ref_ray *ray, real scale, const probe *a) {
    const zt_scene *scene = j->ref->scene;
    if (scene->objects[a->object].smooth) return;
    for (int32_t i = 0; i < scene->light_count; i++) {
        if (scene->lights[i].kind == ZT_LIGHT_POINT)
            judge_light(j, ray, i, (a->lights >> i) & 1, scale, a);
    }
}

/* What the normals of a mesh's corners say of a point of a triangle, to the eye's side. */
static real3 smooth_normal(const judge *j, const probe *a, const ref_ray *ray) {
    const zt_object *object = &j->ref->scene->objects[a->object];
    const zt_mesh *mesh = &j->ref->scene->meshes[object->mesh];
    const ref_triangle *t = &j->ref->primitives[a->object].triangles[a->part];
    affine place = affine_place(object->placement.position, object->placement.rotation,
                                real3_of(object->placement.scale));
    real3 sum = {0, 0, 0}, p = real3_along(ray->o, a->t, ray->d);
    for (int i = 0; i < 3; i++) {
        real3 b = t->v[(i + 1) % 3], c = t->v[(i + 2) % 3];
        real share = real3_dot(real3_cross(real3_sub(b, p), real3_sub(c, p)), t->normal);
        const float *n = mesh->normals + 3 * mesh->triangles[3 * a->part + i];
        sum = real3_along(sum, share, (real3){n[0], n[1], n[2]});
    }
    sum = real3_unit(affine_vector(&place, sum));
    return real3_dot(t->normal, ray->d) > 0 ? real3_scale(sum, -1) : sum;
}

/* Meant for convex meshes alone in a scene, turned and scaled alike in all directions: lit is
 * what the smooth normal turns to the light, whatever the triangles do; at most a hundredth
 * off. Where they show the eye another side than the normal does, nothing is asked. */
void judge_smooth(const judge *j, const ref_ray *ray, ref_hit expected, const probe *a) {
    real3 normal = smooth_normal(j, a, ray);
    if (real3_dot(normal, real3_unit(ray->d)) > -(real)0.02) return;
    /* The corners' normals are given in single precision. */
    const ref_primitive *p = &j->ref->primitives[a->object];
    real off = real3_length(real3_sub(normal, real3_of(a->normal))) - (real)2e-7;
    off /= 1 + ref_scale(p, ray, a->t) / p->triangles[a->part].smallest;
    judge_error(j, &j->tally->normal, off, j->tolerance, "normal", ray, expected, a);
    for (int32_t i = 0; i < j->ref->scene->light_count; i++) {
        if (j->ref->scene->lights[i].kind != ZT_LIGHT_POINT) continue;
        bool lit = (a->lights >> i) & 1;
        real3 way = real3_unit(real3_sub(j->ref->lights[i], real3_of(a->point)));
        real side = real3_dot(way, normal);
        ref_ray shadow = {real3_of(a->point), way, a->object, a->part};
        ref_hit none = {-1, -1, 0};
        if (side > (real)0.01 && !lit)
            judge_count(j, &j->tally->acne, "the terminator's artefact", &shadow, none, a);
        if (side < -(real)0.01 && lit)
            judge_count(j, &j->tally->leaks, "lit from behind", &shadow, none, a);
    }
}
