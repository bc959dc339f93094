/* Marks: points of all that may move, which go straight where the tracer's numbers do, and how
 * far they may be off. What sequence/chords.h is made of. */
#ifndef ZT_SEQUENCE_MARKS_H
#define ZT_SEQUENCE_MARKS_H

#include "sequence/chords.h"

enum { ZT_MARKS_MAX = 16 };

/* Where the camera is within the ball around a thing, or nearly touches it, some of it is taken
 * to be as far away as this share of the ball's radius. */
#define ZT_MARK_NEAREST (1.0 / 16)

/* No place is known better than to so many roundings. */
#define ZT_MARK_ROUNDINGS 0x1p-44

typedef enum zt_part_kind {
    ZT_PART_OBJECT, /* where an object is and how large */
    ZT_PART_LAMP,   /* the same of a light */
    ZT_PART_POWER,  /* its color times its intensity */
    ZT_PART_VALUE,  /* a property of a material, or a switch */
    ZT_PART_EYE,    /* the camera: where it is, */
    ZT_PART_VIEW,   /* what it looks at, */
    ZT_PART_OPENING /* and its aperture */
} zt_part_kind;

struct zt_part {
    zt_part_kind kind;
    int32_t index;
    int32_t by; /* of objects: the one, itself or a group around it, that has the track */
    int32_t first, count; /* marks */
    const zt_property *property;
    const xform *anchor; /* of planes with patterns in groups that move: places in the group */
    double reach;        /* of planes: how long their normals are taken to be */
    double most_allowed; /* at any moment that was looked at */
};

/* Colors and the like are measured by the largest that they were, since light is a sum over all
 * of the opening. */
static inline bool zt_part_is_relative(const zt_part *part) {
    return part->kind == ZT_PART_POWER || part->kind == ZT_PART_VALUE;
}

/* Writes the marks of an object: all of its points are means of these, so that none is off more
 * than they are. Returns how many there are: none of planes and groups. */
int zt_marks_of_object(vec3 *marks, const zt_object *object, const xform *world,
                       const zt_mesh *meshes);

/* The ball around points, about their mean: its radius. */
double zt_marks_ball(vec3 *center, const vec3 *points, int count);

/* A plane in the space relative to the origin: its unit normal, and how far it is along it. */
double zt_marks_plane(vec3 *normal, const zt_plane *plane, const xform *world);

/* Writes the marks of all parts, and what is allowed of them, from the glance's scene. */
void zt_marks_make(zt_glance *glance, const zt_chords *chords);

#endif
