/* A path in space, measured along its length, for things that follow it at constant speed. */
#ifndef ZT_KEYFRAME_PATH_H
#define ZT_KEYFRAME_PATH_H

#include "base/vec.h"
#include "keyframe/curve.h"

enum { ZT_PATH_MARKS = 16 };

/* Arrays belong to an arena; a curve that is the caller's must live as long. */
typedef struct zt_path {
    const zt_curve *curve;
    bool closed; /* ends where it begins, so that it can be followed round and round */
    int32_t way_count;
    double length;
    double narrowest; /* how far it turns in its narrowest bend, radians */
    const double
        *lengths; /* from the begin to each mark, ZT_PATH_MARKS a way, and to the end */
} zt_path;

/* The centripetal Catmull-Rom curve through at least two points; a closed one comes back to the
 * first. ZT_EARGUMENT where there are fewer, or where the length is no finite number. */
zt_status zt_path_through(zt_path *path, zt_arena *arena, const vec3 *points,
                          int32_t point_count, bool closed);

/* The shape of a curve of vectors: its points and the ways between them; held ones count as
 * straight, and when it is where does not matter. ZT_EARGUMENT for other kinds of value, a
 * single key, springs, and a length that is no finite number. */
zt_status zt_path_make(zt_path *path, zt_arena *arena, const zt_curve *curve);

/* Where one is after a distance. Before the begin and after the end one stands there, but on a
 * closed path one goes round and round. */
vec3 zt_path_point(const zt_path *path, double distance);

/* The unit vector along the path; zero where all of it is one point. */
vec3 zt_path_direction(const zt_path *path, double distance);

/* How narrow the bend is there, from -1 to 1, against the path's narrowest one: positive to the
 * left, seen with `up` upwards. It never jumps, since it looks a little behind and ahead. */
double zt_path_bend(const zt_path *path, double distance, vec3 up);

#endif
