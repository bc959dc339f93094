#include "judge.h"

#include <stdio.h>

static bool finite3(vec3 v) { return isfinite(v.x) && isfinite(v.y) && isfinite(v.z); }

static void worst(double *kept, real error) {
    double e = (double)error;
    if (!(e <= *kept) && !isnan(*kept)) *kept = e; /* no number stays */
}

void judge_count(const judge *j, int64_t *counter, const char *what, const ref_ray *ray,
                 ref_hit expected, const probe *a) {
    ++*counter;
    if (!j->verbose) return;
    printf("  %s %d, %s: %s: ray (%.17g %.17g %.17g) + t (%.17g %.17g %.17g) from %d/%d: "
           "object %d part %d t %.17g normal (%.9g %.9g %.9g), reference object %d part %d t "
           "%.17g, of shape %d\n",
           j->name, j->scene, j->how, what, (double)ray->o.x, (double)ray->o.y,
           (double)ray->o.z, (double)ray->d.x, (double)ray->d.y, (double)ray->d.z,
           ray->source_object, ray->source_part, a->object, a->part, a->t, a->normal.x,
           a->normal.y, a->normal.z, expected.object, expected.part, (double)expected.t,
           (int)j->ref->primitives[a->object < 0 ? expected.object : a->object].shape);
}

void judge_error(const judge *j, double *kept, real error, double most, const char *what,
                 const ref_ray *ray, ref_hit expected, const probe *a) {
    worst(kept, error);
    if (!((double)error <= most)) judge_count(j, &j->tally->beyond, what, ray, expected, a);
}

/* By how much changes within the tolerance move the place along a ray where it meets a face:
 * less by its slant than by its bend where the ray runs along it. */
static real uncertainty(const judge *j, const ref_primitive *p, int32_t part,
                        const ref_ray *ray, real t) {
    real3 at = real3_along(ray->o, t, ray->d), d = real3_unit(ray->d);
    ref_face face = ref_nearest_face(p, part, at);
    real off = j->tolerance * ref_scale(p, ray, t) + p->grain;
    real slant = real_abs(real3_dot(face.normal, d));
    real by_slant = off / slant, by_bend = 2 * REAL(sqrt)(2 * off / ref_curve(p, at, d));
    return real_min(by_slant, by_bend) / real3_length(ray->d);
}

/* How many faces of a primitive a ray may begin on. */
static int near_faces(const judge *j, const ref_primitive *p, const ref_ray *ray,
                      int32_t part) {
    ref_face faces[REF_FACES_MAX];
    int count = ref_faces(faces, p, part, ray->o), near = 0;
    for (int i = 0; i < count; i++)
        near += faces[i].distance <= j->tolerance * ref_scale(p, ray, 0);
    return near;
}

/* Whether an answer is the surface that the ray leaves, where it leaves it; not where it is
 * open to which side it does. */
static bool is_source(const judge *j, const ref_ray *ray, const probe *a) {
    if (a->object != ray->source_object) return false;
    const ref_primitive *p = &j->ref->primitives[a->object];
    if (p->shape == ZT_SHAPE_MESH) return a->part == ray->source_part;
    ref_face face = ref_nearest_face(p, a->part, ray->o);
    real turn = j->tolerance * (1 + face.twist + face.bend * ref_scale(p, ray, 0));
    bool flat = p->shape <= ZT_SHAPE_DISK && p->shape != ZT_SHAPE_SPHERE;
    if (!flat && real_abs(real3_dot(face.normal, real3_unit(ray->d))) <= turn) return false;
    if (near_faces(j, p, ray, a->part) > 1) return false;
    ref_hit far;
    bool sure;
    if (ref_first(&far, p, ray, 0, (real)INFINITY))
        return a->t < far.t / 2 && far.t > 4 * uncertainty(j, p, far.part, ray, far.t);
    ref_blocked(&sure, j->ref, ray, (real)INFINITY, j->tolerance, a->object);
    return sure;
}

/* Whether a primitive is met exactly where the first one is. */
static bool is_equal(const ref_primitive *p, const ref_ray *ray, ref_hit expected) {
    ref_hit hit;
    return expected.object >= 0 && ref_first(&hit, p, ray, 0, (real)INFINITY) &&
           hit.t == expected.t;
}

static void judge_distance(const judge *j, const ref_ray *ray, real scale, ref_hit expected,
                           const ref_face *face, const probe *a) {
    real slant = real_abs(real3_dot(face->normal, ray->d)) / real3_length(ray->d);
    real condition = scale / (expected.t * slant), error = real_abs(a->t - expected.t);
    /* Where the slant itself changes much within the tolerance, there is no first order. */
    if (condition * expected.t * j->tolerance * face->bend > slant / 4) return;
    worst(&j->tally->relative, error / expected.t);
    worst(&j->tally->condition, condition);
    worst(&j->tally->forward, error / expected.t / condition);
}

/* How far a normal is from that of the faces at a point, over how sensitive those are. */
static real normal_error(const judge *j, const ref_primitive *p, const probe *a, real scale,
                         real3 point) {
    ref_face faces[REF_FACES_MAX];
    real best = (real)INFINITY;
    int count = ref_faces(faces, p, a->part, point);
    for (int i = 0; i < count; i++) {
        if (faces[i].distance > j->tolerance * scale) continue;
        real3 n = faces[i].normal, normal = real3_of(a->normal);
        if (real3_dot(n, normal) < 0) n = real3_scale(n, -1);
        real error = real3_length(real3_sub(normal, n));
        best = real_min(best, error / (faces[i].twist + faces[i].bend * scale));
    }
    return best;
}

/* Where a face bends much within the tolerance, the normal may be that of the point that the
 * tracer found, or that of the one that it ought to have found. */
static void judge_normal(const judge *j, const ref_primitive *p, const ref_ray *ray, real scale,
                         ref_hit expected, const probe *a) {
    real error = normal_error(j, p, a, scale, real3_along(ray->o, a->t, ray->d));
    if (error > j->tolerance && expected.object == a->object)
        error = real_min(error,
                         normal_error(j, p, a, scale, real3_along(ray->o, expected.t, ray->d)));
    judge_error(j, &j->tally->normal, error, j->tolerance, "normal", ray, expected, a);
}

static void judge_mirror(const judge *j, const ref_ray *ray, ref_hit expected, const probe *a) {
    real3 d = real3_unit(ray->d), n = real3_of(a->normal);
    real3 mirrored = real3_unit(real3_along(d, -2 * real3_dot(d, n), n));
    real3 off = real3_sub(mirrored, real3_of(a->next_direction));
    judge_error(j, &j->tally->mirror, real3_length(off), j->tolerance, "mirror", ray, expected,
                a);
}

static void judge_missing(const judge *j, const ref_ray *ray, ref_hit expected,
                          const probe *a) {
    bool sure;
    if (expected.object < 0) return;
    ref_blocked(&sure, j->ref, ray, (real)INFINITY, j->tolerance, -1);
    if (!sure)
        j->tally->ties++;
    else if (j->closed)
        judge_count(j, &j->tally->leaks, "leak", ray, expected, a);
    else
        judge_count(j, &j->tally->missed, "missed", ray, expected, a);
}

/* Which surface: the nearest, or one that small changes make the nearest. */
static bool judge_surface(const judge *j, const ref_ray *ray, real scale, ref_hit expected,
                          real error, const probe *a) {
    bool none = expected.object < 0, sure, blocked;
    if (error > j->tolerance || is_source(j, ray, a)) {
        judge_count(j, none ? &j->tally->false_hits : &j->tally->wrong,
                    error > j->tolerance ? "not where it says" : "left surface hit", ray,
                    expected, a);
        return false;
    }
    const ref_primitive *p = &j->ref->primitives[a->object];
    ref_face face = ref_nearest_face(p, a->part, real3_of(a->point));
    real slant = real_abs(real3_dot(face.normal, ray->d)) / real3_length(ray->d);
    bool there = real_abs(a->t - expected.t) * slant <= 4 * j->tolerance * scale;
    if (there && a->object == expected.object) {
        judge_distance(j, ray, scale, expected, &face, a);
        return true;
    }
    if (there && j->strict && is_equal(p, ray, expected)) {
        judge_count(j, &j->tally->wrong, "not the first of equals", ray, expected, a);
        return false;
    }
    /* What is in front has to be so by more than the place of the answer is unsure. */
    real before = a->t - 2 * uncertainty(j, p, a->part, ray, a->t);
    blocked = ref_blocked(&sure, j->ref, ray, before, j->tolerance, -1);
    if (blocked && sure) {
        judge_count(j, j->closed ? &j->tally->leaks : &j->tally->wrong, "not the nearest", ray,
                    expected, a);
        return false;
    }
    j->tally->ties++;
    return true;
}

void judge_probe(const judge *j, const ref_ray *ray, ref_hit expected, const probe *a) {
    tally *t = j->tally;
    t->rays++;
    if (a->object < 0) {
        judge_missing(j, ray, expected, a);
        return;
    }
    t->hits++;
    if (!isfinite(a->t) || !finite3(a->point) || !finite3(a->normal) ||
        !finite3(a->next_direction)) {
        judge_count(j, &t->not_finite, "not finite", ray, expected, a);
        return;
    }
    const ref_primitive *p = &j->ref->primitives[a->object];
    real3 at = real3_along(ray->o, a->t, ray->d), point = real3_of(a->point);
    real scale = ref_scale(p, ray, a->t);
    real error = ref_nearest_face(p, a->part, at).distance / scale;
    real off = ref_nearest_face(p, a->part, point).distance;
    /* Along the ray as well, as far as that is not how the surface moves. */
    off = real_max(off, real3_length(real3_sub(point, at)) / 2) / scale;
    bool smooth = j->ref->scene->objects[a->object].smooth;
    bool lifted = p->shape == ZT_SHAPE_MESH;
    judge_error(j, &t->hit, error, j->tolerance, "distance", ray, expected, a);
    if (!smooth)
        judge_error(j, lifted ? &t->lift : &t->point, off, (lifted ? 8 : 1) * j->tolerance,
                    "point", ray, expected, a);
    if (!(a->t > 0)) {
        judge_count(j, &t->false_hits, "behind the ray", ray, expected, a);
        return;
    }
    if (!judge_surface(j, ray, scale, expected, error, a)) return;
    if (j->ref->scene->objects[p->object].smooth)
        judge_smooth(j, ray, expected, a);
    else
        judge_normal(j, p, ray, scale, expected, a);
    judge_mirror(j, ray, expected, a);
    if (j->lights) judge_lights(j, ray, scale, a);
}

bool tally_holds(const tally *t, double tolerance) {
    return t->hit <= tolerance && t->point <= tolerance && t->lift <= 8 * tolerance &&
           t->normal <= tolerance && t->mirror <= tolerance &&
           t->wrong + t->missed + t->false_hits + t->leaks + t->acne + t->beyond +
                   t->not_finite ==
               0;
}
