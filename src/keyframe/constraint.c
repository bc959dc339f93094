#include "keyframe/constraint.h"

#include <string.h>

#include "base/text.h"
#include "keyframe/rotation.h"

static const double tau = 2 * 3.14159265358979323846;

/* ---- where things are -----------------------------------------------------------------------
 */

const zt_property *zt_place_property(zt_owner owner) {
    static const char *const names[] = {"position", "center", "vertices", "from"};
    const zt_property *property = NULL;
    for (int i = 0; i < 4 && !property; i++) property = zt_property_find(owner, names[i]);
    return property;
}

/* Of what reaches from one point to another, the property of the other one; else NULL. */
static const zt_property *other_end(zt_reference thing) {
    return thing.property->offset == offsetof(zt_object, tube.from) &&
                   zt_text_equal(thing.property->name, "from")
               ? zt_property_find(thing.property->owner, "to")
               : NULL;
}

/* The group whose space a thing's numbers are in; -1 for the world. */
static int32_t group_of(zt_reference thing, const zt_scene *scene) {
    bool is_object = thing.property && thing.property->owner >= ZT_OWNER_PLANE;
    return is_object ? scene->objects[thing.index].parent : -1;
}

/* The innermost group that both are in, or are themselves: groups come before their members. */
static int32_t common_group(int32_t a, int32_t b, const zt_scene *scene) {
    while (a != b)
        if (a > b)
            a = scene->objects[a].parent;
        else
            b = scene->objects[b].parent;
    return a;
}

/* From the space within a group to that around `end`'s members, which is further out. */
static xform outwards(int32_t group, int32_t end, const zt_scene *scene) {
    xform m = xform_identity();
    for (; group != end; group = scene->objects[group].parent) {
        const zt_placement *p = &scene->objects[group].placement;
        xform own = xform_place(p->position, p->rotation, p->scale);
        m = xform_mul(&own, &m);
    }
    return m;
}

static vec3 own_place(zt_reference thing, const zt_scene *scene) {
    double v[ZT_VALUE_WIDTH_MAX], end[3];
    const zt_property *other = other_end(thing);
    zt_property_get(v, thing.property, scene, thing.index);
    /* Divided first: the sum could be too large. */
    if (other) {
        zt_property_get(end, other, scene, thing.index);
        return (vec3){v[0] / 2 + end[0] / 2, v[1] / 2 + end[1] / 2, v[2] / 2 + end[2] / 2};
    }
    if (thing.property->kind != ZT_VALUE_VERTICES) return (vec3){v[0], v[1], v[2]};
    return (vec3){v[0] / 3 + v[3] / 3 + v[6] / 3, v[1] / 3 + v[4] / 3 + v[7] / 3,
                  v[2] / 3 + v[5] / 3 + v[8] / 3};
}

/* The anchor in the space of the driven numbers, by way of the innermost group around both, so
 * that nothing is lost in spaces that they share. */
static bool place_of(vec3 *place, const zt_anchor *anchor, zt_reference driven,
                     const zt_scene *scene) {
    *place = anchor->point;
    if (!anchor->thing.property) return true;
    *place = own_place(anchor->thing, scene);
    int32_t from = group_of(anchor->thing, scene), to = group_of(driven, scene);
    int32_t common = common_group(from, to, scene);
    if (from != common) {
        xform out = outwards(from, common, scene);
        *place = xform_point(&out, *place);
    }
    if (to != common) {
        xform out = outwards(to, common, scene), in = xform_inverse(&out);
        *place = xform_point(&in, *place);
    }
    return isfinite(place->x) && isfinite(place->y) && isfinite(place->z);
}

static void visit_groups(int32_t group, int32_t end, const zt_scene *rest,
                         zt_reference_visitor visitor) {
    static const char *const names[] = {"position", "rotation", "scale"};
    for (; group != end; group = rest->objects[group].parent)
        for (int i = 0; i < 3; i++)
            visitor.visit(visitor.user,
                          (zt_reference){zt_property_find(ZT_OWNER_GROUP, names[i]), group});
}

void zt_anchor_visit(const zt_anchor *anchor, zt_reference driven, const zt_scene *rest,
                     zt_reference_visitor visitor) {
    if (!anchor->thing.property) return;
    const zt_property *other = other_end(anchor->thing);
    visitor.visit(visitor.user, anchor->thing);
    if (other) visitor.visit(visitor.user, (zt_reference){other, anchor->thing.index});
    int32_t from = group_of(anchor->thing, rest), to = group_of(driven, rest);
    int32_t common = common_group(from, to, rest);
    visit_groups(from, common, rest, visitor);
    visit_groups(to, common, rest, visitor);
}

/* ---- values ---------------------------------------------------------------------------------
 */

static void write_vector(double *value, vec3 v) {
    memcpy(value, (double[3]){v.x, v.y, v.z}, 3 * sizeof *value);
}

static void write_quat(double *value, quat q) {
    memcpy(value, (double[4]){q.w, q.x, q.y, q.z}, 4 * sizeof *value);
}

/* Cosine and sine of so many turns, exact at quarters. */
static void turned(double *c, double *s, double turns) {
    double quarter = floor(4 * turns + 0.5), rest = (turns - quarter / 4) * tau;
    int quadrant = (int)(quarter - 4 * floor(quarter / 4));
    double x = cos(rest), y = sin(rest);
    *c = quadrant == 0 ? x : quadrant == 1 ? -y : quadrant == 2 ? -x : y;
    *s = quadrant == 0 ? y : quadrant == 1 ? x : quadrant == 2 ? -y : -x;
}

bool zt_orbit_eval(double *value, const zt_orbit *orbit, zt_reference driven,
                   const zt_scene *scene, double time_s) {
    vec3 center, a = orbit->axis;
    if (!place_of(&center, &orbit->around, driven, scene)) return false;
    vec3 right = {a.y * a.y + a.z * a.z, -a.x * a.y, -a.x * a.z}; /* x, less its part along a */
    if (vec3_max_abs(right) < 1e-6)                               /* y, in the same way */
        right = (vec3){-a.y * a.x, a.x * a.x + a.z * a.z, -a.y * a.z};
    right = vec3_normalize(right);
    double c, s;
    /* Whole rounds go first, and exactly. */
    turned(&c, &s, fmod(time_s, orbit->period_s) / orbit->period_s + orbit->phase / tau);
    vec3 way = vec3_add(vec3_scale(right, c), vec3_scale(vec3_cross(a, right), s));
    write_vector(value, vec3_add(center, vec3_scale(way, orbit->radius)));
    return true;
}

void zt_follow_eval(double *value, const zt_follow *follow, zt_reference driven,
                    double time_s) {
    double u = (time_s - follow->from_s) / (follow->to_s - follow->from_s);
    u = u < 0 ? 0 : u > 1 ? 1 : u;
    if (follow->ease) u = zt_ease_eval(follow->ease, u);
    double distance = u * follow->path->length;
    if (driven.property->kind != ZT_VALUE_ROTATION) {
        write_vector(value, zt_path_point(follow->path, distance));
        return;
    }
    double lean = zt_path_bend(follow->path, distance, follow->up) * follow->bank;
    write_quat(value,
               zt_rotation_look(zt_path_direction(follow->path, distance), follow->up, lean));
}

void zt_offset_eval(double *value, const zt_offset *offset, const zt_scene *scene) {
    const zt_property *from = offset->from.property;
    zt_property_get(value, from, scene, offset->from.index);
    if (from->kind == ZT_VALUE_ROTATION) {
        quat a = {value[0], value[1], value[2], value[3]};
        quat b = {offset->by[0], offset->by[1], offset->by[2], offset->by[3]};
        write_quat(value, zt_rotation_unit(quat_mul(a, b)));
        return;
    }
    for (int c = 0; c < zt_value_width(from->kind); c++) value[c] += offset->by[c];
}

bool zt_look_at_eval(double *value, const zt_look_at *look_at, zt_reference driven,
                     const zt_scene *scene) {
    vec3 target;
    if (!place_of(&target, &look_at->target, driven, scene)) return false;
    if (driven.property->kind != ZT_VALUE_ROTATION) {
        write_vector(value, target);
        return true;
    }
    vec3 direction = vec3_sub(target, own_place(look_at->from, scene));
    write_quat(value, zt_rotation_look(direction, look_at->up, look_at->roll));
    return true;
}
