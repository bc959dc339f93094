/* Whether a precision is enough for a frame: the roundings of each thing's arithmetic against
 * what can be seen of them. */
#ifndef ZT_TRACER_ACCURACY_H
#define ZT_TRACER_ACCURACY_H

#include <stdbool.h>
#include <stdint.h>

#include <zoetrope/precision.h>
#include <zoetrope/status.h>

#include "base/arena.h"
#include "base/vec.h"
#include "scene/scene.h"

typedef enum zt_accuracy_reason {
    ZT_ACCURACY_FINE,
    ZT_ACCURACY_NEAR,    /* the camera is near its surface, seen against its size */
    ZT_ACCURACY_NARROW,  /* far away in a narrow view */
    ZT_ACCURACY_LAMP,    /* a lamp is near its surface */
    ZT_ACCURACY_TWIN,    /* another surface nearly lies on it */
    ZT_ACCURACY_RANGE,   /* its numbers are too large or too small */
    ZT_ACCURACY_MIRRORS, /* too many mirrors, one after the other */
    ZT_ACCURACY_STRETCH, /* it is stretched too much */
    ZT_ACCURACY_THIN     /* it is too thin, against its numbers */
} zt_accuracy_reason;

/* The first thing found that asks for more than a precision. */
typedef struct zt_accuracy {
    zt_accuracy_reason reason;
    int32_t object, other; /* indices in the scene; other: light or object, or -1 */
    double wrong;          /* how far off the precision may be, in the unit of space */
    double seen;           /* what may be seen of that, likewise */
    double distance;       /* to the camera, lamp or other surface, or how thin, likewise */
    double number; /* the largest in its arithmetic; what is out of range; how many times
                      more one way than another it is stretched */
} zt_accuracy;

/* How wide a pixel is at a distance d: width + angle d. And how far from the camera its rays
 * may begin: within the lens's opening, anywhere on an orthographic picture, where the camera
 * moves to. */
typedef struct zt_pixel {
    double width, angle, reach;
} zt_pixel;

/* By which share of its distance to the world's origin, or to that of a group around it,
 * doubles round a thing's place. */
#define ZT_GRAIN 0x1p-52

/* One surface as it was made ready, in the space relative to the camera, in double precision.
 */
typedef struct zt_extent {
    int32_t object;
    bool flat;       /* a plane, disk or triangle: of points p with normal . p = distance */
    vec3 normal;     /* unit; of flat ones */
    double distance; /* likewise */
    vec3 low, high;  /* bounds; infinite for planes */
    /* Of what is not flat but has flat faces: its middle, the ways from there to the middles of
     * its faces, and a bit for each way on both ends of which there is a face; `perhaps` says
     * that only the bounds of a mesh are known. */
    vec3 middle, ways[3];
    int faces;
    bool perhaps;
    double size;  /* the largest number in its arithmetic */
    double least; /* its smallest size that counts; infinite for planes */
    double thin;  /* of what groups stretch half of its smallest measure, of cones half of their
                     height; else infinite */
    double askew; /* by how much roundings grow on the way through its own space, whose axes
                     stand askew in groups that stretch and turn: the length of an axis times
                     that of its row of the inverse, 1 where they are at right angles */
    double grain; /* by how much doubles round its place, wherever the camera is */
    double near;  /* how far away the surface is from the camera, at least about */
    double stretch; /* how many times more roundings than a sphere's it has */
    double lamp;    /* how far away the nearest lamp is; infinite where there is none */
    int32_t lamp_light;
} zt_extent;

/* Surfaces that may lie on each other, in the order in which to look for them. */
typedef struct zt_twins zt_twins;

/* Of extents that stay where they are as long; in the arena. ZT_EMEMORY. */
zt_status zt_twins_make(zt_twins **twins, const zt_extent *extents, int32_t count,
                        zt_arena *arena);

/* Whether two surfaces lie on each other: as near as `most` of their size. */
bool zt_twins_within(const zt_twins *twins, double most);

/* Of all primitives of a tracer. */
typedef struct zt_extents {
    const zt_extent *all;
    int32_t count;
    zt_twins *twins;
} zt_extents;

/* FINE where the precision, single or double, is enough. */
zt_accuracy zt_accuracy_judge(const zt_extents *extents, const zt_scene *scene, zt_pixel pixel,
                              zt_precision precision);

#endif
