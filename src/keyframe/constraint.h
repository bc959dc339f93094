/* Constraints: values that follow from where other things are, or from a path. All are given
 * in the space of the numbers that they drive: that of the group that the driven thing is in.
 */
#ifndef ZT_KEYFRAME_CONSTRAINT_H
#define ZT_KEYFRAME_CONSTRAINT_H

#include <stdbool.h>
#include <stdint.h>

#include "keyframe/ease.h"
#include "keyframe/path.h"
#include "keyframe/property.h"

/* A property of one thing of the scene, as zt_property_get takes it. */
typedef struct zt_reference {
    const zt_property *property; /* NULL where there is none */
    int32_t index;
} zt_reference;

/* The property that says where a thing is: its position, its center, the vertices, of which it
 * is the middle, or where it begins: then it is in the middle between "from" and "to". NULL for
 * owners that are nowhere in particular. */
const zt_property *zt_place_property(zt_owner owner);

/* A point: where a thing is, with its groups, or one that stays. */
typedef struct zt_anchor {
    zt_reference thing; /* its zt_place_property(), or none: then `point` */
    vec3 point;
} zt_anchor;

/* Once round in `period_s`, which is negative for the other way and not 0, counterclockwise
 * seen from the tip of `axis`, of unit length. At time 0 it stands `phase` radians on from the
 * x axis made perpendicular to the axis; of an axis that is x, from y. */
typedef struct zt_orbit {
    zt_anchor around;
    double radius, period_s, phase;
    vec3 axis;
} zt_orbit;

/* The path from its begin at from_s to its end at to_s, which is later, at constant speed, or
 * spread by an ease; before and after, its ends. A rotation that follows looks ahead with -z
 * and its y upright, and leans into bends: by `bank` radians in the narrowest one, by less in
 * others (zt_path_bend). */
typedef struct zt_follow {
    const zt_path *path;
    double from_s, to_s;
    const zt_ease *ease; /* or NULL */
    vec3 up;
    double bank;
} zt_follow;

/* Another property of the same kind, and something added to it: to rotations, a turn around
 * their own axes. */
typedef struct zt_offset {
    zt_reference from;
    double by[ZT_VALUE_WIDTH_MAX];
} zt_offset;

/* The target itself for vectors. Rotations turn -z there from `from`, the own place, with y as
 * near to `up` as can be, and are rolled as zt_rotation_look() does. */
typedef struct zt_look_at {
    zt_anchor target;
    zt_reference from;
    vec3 up;
    double roll;
} zt_look_at;

/* Write the value of `driven`, from what the scene holds. false where there is none: within a
 * group whose members have no size. */
bool zt_orbit_eval(double *value, const zt_orbit *orbit, zt_reference driven,
                   const zt_scene *scene, double time_s);
void zt_follow_eval(double *value, const zt_follow *follow, zt_reference driven, double time_s);
void zt_offset_eval(double *value, const zt_offset *offset, const zt_scene *scene);
bool zt_look_at_eval(double *value, const zt_look_at *look_at, zt_reference driven,
                     const zt_scene *scene);

/* Who is shown the properties that a value depends on. */
typedef struct zt_reference_visitor {
    void (*visit)(void *user, zt_reference reference);
    void *user;
} zt_reference_visitor;

/* All that an anchor reads of a scene for `driven`; the scene at rest tells the groups. */
void zt_anchor_visit(const zt_anchor *anchor, zt_reference driven, const zt_scene *rest,
                     zt_reference_visitor visitor);

#endif
