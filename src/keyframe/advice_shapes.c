/* Advice on shapes that lose what they are: transforms that nearly flatten, tori without a
 * hole, tubes without a length. */
#include <math.h>

#include "keyframe/advice.h"

/* How many times as much a transform may stretch one way as another: beyond it, none of the
 * digits of single precision are left. */
static const double condition_max = 1e6;

/* The worst of an object, and when; 0 for nothing amiss. */
typedef struct finding {
    double number, time_s;
} finding;

typedef struct findings {
    const zt_scene *rest;
    finding *worst;     /* of each object */
    double *conditions; /* of what each group makes of its members, at the moment looked at */
} findings;

/* ---- transforms -----------------------------------------------------------------------------
 */

/* Turns two columns until they are at right angles (Hestenes, "Inversion of matrices by
 * biorthogonalization and related results", 1958). */
static void make_orthogonal(vec3 *a, vec3 *b) {
    double aa = vec3_dot(*a, *a), bb = vec3_dot(*b, *b), ab = vec3_dot(*a, *b);
    if (fabs(ab) <= 1e-16 * sqrt(aa) * sqrt(bb)) return;
    double zeta = (bb - aa) / (2 * ab);
    double t = copysign(1 / (fabs(zeta) + hypot(1, zeta)), zeta);
    double c = 1 / hypot(1, t), s = c * t;
    vec3 turned = vec3_sub(vec3_scale(*a, c), vec3_scale(*b, s));
    *b = vec3_add(vec3_scale(*a, s), vec3_scale(*b, c));
    *a = turned;
}

/* How long a vector of length 1 becomes at most, against how short; INFINITY where one
 * vanishes. */
static double condition(xform m) {
    enum { SWEEPS = 8 };
    double most = fmax(vec3_max_abs(m.x), fmax(vec3_max_abs(m.y), vec3_max_abs(m.z)));
    if (!(most > 0) || isinf(most)) return INFINITY;
    m.x = vec3_scale(m.x, 1 / most);
    m.y = vec3_scale(m.y, 1 / most);
    m.z = vec3_scale(m.z, 1 / most);
    for (int i = 0; i < SWEEPS; i++) {
        make_orthogonal(&m.x, &m.y);
        make_orthogonal(&m.y, &m.z);
        make_orthogonal(&m.z, &m.x);
    }
    double x = vec3_length(m.x), y = vec3_length(m.y), z = vec3_length(m.z);
    return fmax(x, fmax(y, z)) / fmin(x, fmin(y, z));
}

/* Of a group or mesh and all around it; 0 where that was looked at further out already, and
 * where a scale of 0 hides it. */
static double transform_amiss(findings *f, int32_t index, const zt_object *object,
                              const xform *world) {
    const zt_placement *p = &object->placement;
    xform own = xform_place(p->position, p->rotation, p->scale);
    double found = condition(xform_mul(world, &own));
    f->conditions[index] = found;
    bool outer = object->parent >= 0 && f->conditions[object->parent] > condition_max;
    return found > condition_max && !isinf(found) && !outer ? found : 0;
}

/* ---- shapes ---------------------------------------------------------------------------------
 */

/* The radius of a torus whose tube was made as wide (zt_animation_freeze); not where it is
 * written so. */
static double torus_amiss(const zt_torus *torus, const zt_torus *rest) {
    bool meant = rest->tube_radius == rest->radius;
    return torus->tube_radius == torus->radius && !meant ? torus->radius : 0;
}

static double tube_amiss(const zt_tube *tube) {
    vec3 way = vec3_sub(tube->to, tube->from);
    return vec3_max_abs(way) == 0 && fmax(tube->radius, tube->end_radius) > 0 ? 1 : 0;
}

static void look(void *user, const zt_advice_moment *moment) {
    findings *f = user;
    const zt_scene *scene = moment->scene;
    zt_scene_worlds(moment->worlds, scene, (vec3){0, 0, 0});
    for (int32_t i = 0; i < scene->object_count; i++) {
        const zt_object *object = &scene->objects[i];
        double number = 0;
        if (object->shape == ZT_SHAPE_GROUP || object->shape == ZT_SHAPE_MESH)
            number = transform_amiss(f, i, object, &moment->worlds[i]);
        else if (object->shape == ZT_SHAPE_TORUS)
            number = torus_amiss(&object->torus, &f->rest->objects[i].torus);
        else if (object->shape == ZT_SHAPE_CYLINDER || object->shape == ZT_SHAPE_CONE)
            number = tube_amiss(&object->tube);
        if (number > f->worst[i].number) f->worst[i] = (finding){number, moment->time_s};
    }
}

/* ---- all of it ------------------------------------------------------------------------------
 */

static void tell(const finding *worst, const zt_animation *animation, int32_t object,
                 zt_listener listener) {
    zt_advice_name name = zt_advice_name_of_object(animation, object);
    zt_moment_words when = zt_moment_in_words(animation->film.rate, worst->time_s);
    zt_shape shape = animation->rest.objects[object].shape;
    if (shape == ZT_SHAPE_TORUS)
        zt_tell_at(listener, ZT_WARNING, name.place,
                   "the tube of %s is as wide as its hole, or wider, at %s: it is kept at %g, "
                   "the radius",
                   name.text, when.text, worst->number);
    else if (shape == ZT_SHAPE_CYLINDER || shape == ZT_SHAPE_CONE)
        zt_tell_at(listener, ZT_WARNING, name.place,
                   "%s has no length at %s: there is nothing to see", name.text, when.text);
    else
        zt_tell_at(listener, ZT_WARNING, name.place,
                   "%s, with the groups around it, stretches %.3g times as much one way as "
                   "another at %s; beyond %g, shapes lose their digits",
                   name.text, worst->number, when.text, condition_max);
}

zt_status zt_advice_shapes(const zt_animation *animation, zt_listener listener) {
    size_t count = (size_t)animation->rest.object_count;
    zt_arena arena = {0};
    findings f = {&animation->rest, ZT_PUSH(&arena, finding, count),
                  ZT_PUSH(&arena, double, count)};
    zt_status status = f.worst && f.conditions ? ZT_OK : ZT_EMEMORY;
    if (status == ZT_OK) status = zt_advice_each_moment(animation, 1, look, &f, listener);
    int told = 0;
    for (int32_t i = 0; status == ZT_OK && i < animation->rest.object_count; i++)
        if (f.worst[i].number > 0 && told++ < ZT_ADVICE_TOLD_MAX)
            tell(&f.worst[i], animation, i, listener);
    zt_arena_free(&arena);
    return status;
}
