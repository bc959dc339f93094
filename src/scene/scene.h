/* The scene: what rays can meet during one shutter opening. Arrays of plain numbers and
 * indices; no names, no curves, no pointers between things, -1 for none. The time wing writes
 * it, the light wing reads it; this struct is all they share.
 *
 * Lengths are in the description's unit, angles in radians, colours in linear Rec. 709 light.
 * The system of axes is right-handed; y is up by default. */
#ifndef ZT_SCENE_SCENE_H
#define ZT_SCENE_SCENE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/quat.h"
#include "base/vec.h"
#include "base/xform.h"
#include "scene/mesh.h"

typedef enum zt_shape {
    ZT_SHAPE_PLANE,
    ZT_SHAPE_SPHERE,
    ZT_SHAPE_TRIANGLE,
    ZT_SHAPE_DISK,
    ZT_SHAPE_BOX,
    ZT_SHAPE_CYLINDER,
    ZT_SHAPE_CONE,
    ZT_SHAPE_TORUS,
    ZT_SHAPE_CAPSULE,
    ZT_SHAPE_MESH,
    ZT_SHAPE_GROUP, /* nothing to hit: it only moves its members */
    ZT_SHAPE_COUNT
} zt_shape;

/* Points p with normal . p = distance * |normal|. A normal of zero: nothing to hit. */
typedef struct zt_plane {
    vec3 normal;
    double distance;
} zt_plane;

typedef struct zt_sphere {
    vec3 center;
    double radius;
} zt_sphere;

typedef struct zt_triangle {
    vec3 vertices[3];
} zt_triangle;

/* Flat; the normal has any length but zero. */
typedef struct zt_disk {
    vec3 center, normal;
    double radius;
} zt_disk;

/* A block: `size` is the whole length along each axis, before it is rotated. */
typedef struct zt_block {
    vec3 center, size;
    quat rotation;
} zt_block;

/* Points around the way between two ends. Of a cylinder, closed by disks, `radius` alone
 * counts; of a cone, closed likewise, it is the radius at `from`, and `end_radius` that at
 * `to`; a capsule is all points no further than `radius` from the way. */
typedef struct zt_tube {
    vec3 from, to;
    double radius, end_radius;
} zt_tube;

/* A tube of radius `tube_radius`, at most `radius`, around a circle across `axis`. */
typedef struct zt_torus {
    vec3 center, axis;
    double radius, tube_radius;
} zt_torus;

/* Scale, then rotate, then move. */
typedef struct zt_placement {
    vec3 position;
    quat rotation;
    vec3 scale;
} zt_placement;

/* Members come after their group: parent < own index. The index of an object settles ties
 * between equal hits. */
typedef struct zt_object {
    zt_shape shape;
    int32_t parent;     /* the group that it is in, or -1 */
    int32_t material;   /* -1 in groups */
    int32_t mesh;       /* of ZT_SHAPE_MESH, else -1 */
    bool smooth;        /* shaded by the mesh's normals, where it has any */
    bool vertex_colors; /* the mesh's colors, where it has any, tint the material's */
    union {
        zt_plane plane;
        zt_sphere sphere;
        zt_triangle triangle;
        zt_disk disk;
        zt_block box;
        zt_tube tube; /* of ZT_SHAPE_CYLINDER, ZT_SHAPE_CONE and ZT_SHAPE_CAPSULE */
        zt_torus torus;
        zt_placement placement; /* of ZT_SHAPE_MESH and ZT_SHAPE_GROUP */
    };
} zt_object;

typedef enum zt_pattern { ZT_PATTERN_NONE, ZT_PATTERN_CHECKER, ZT_PATTERN_STRIPES } zt_pattern;

/* A pattern changes between `color` and `other_color` in cells `size` long, in the space that
 * the object's numbers are given in (a mesh's: its model's): cubes that begin at its origin, or
 * slabs across `direction`. A mesh, box or group moves its pattern with it. */
typedef struct zt_material {
    vec3 color;
    double reflectivity;
    zt_pattern pattern;
    vec3 other_color;
    double pattern_size;
    vec3 pattern_direction; /* of stripes; any length but zero */
} zt_material;

typedef enum zt_light_kind {
    ZT_LIGHT_AMBIENT,
    ZT_LIGHT_POINT,
    ZT_LIGHT_DISK,
    ZT_LIGHT_RECTANGLE
} zt_light_kind;

/* All but ambient lights are somewhere. A point light with a radius is a ball that shines alike
 * from all of its surface; disks and rectangles shine to one side, along their own -z, and do
 * so less the further from there. All give, where they are faced from afar, intensity / d^2. */
typedef struct zt_light {
    zt_light_kind kind;
    vec3 color;
    double intensity;
    vec3 position; /* the middle */
    bool shadows;
    double radius;        /* of points (0: a point indeed) and disks */
    quat rotation;        /* of disks and rectangles */
    double width, height; /* of rectangles: along their own x and y */
} zt_light;

/* How far from its position a light reaches in space; 0: it is a point, or nowhere. */
double zt_light_reach(const zt_light *light);

typedef enum zt_lens_kind {
    ZT_LENS_PERSPECTIVE,
    ZT_LENS_ORTHOGRAPHIC,
    ZT_LENS_EQUIRECTANGULAR, /* all around: the picture's middle is ahead */
    ZT_LENS_KIND_COUNT
} zt_lens_kind;

/* Looks along its own -z with +y up; `aimed` ones turn towards look_at instead of by rotation.
 * Either way it is then rolled around its view, counterclockwise seen from behind. */
typedef struct zt_camera {
    vec3 position, look_at, up;
    quat rotation;
    bool aimed;
    double roll;
    zt_lens_kind lens;
    double fov;           /* the vertical opening, where there is no focal length */
    double focal_length;  /* millimetres; 0: `fov` counts */
    double sensor_height; /* millimetres */
    double height;        /* of an orthographic picture, in the unit of space */
    /* The opening that light comes through: its radius in the unit of space; or, where there is
     * an f-number, what follows from it and the focal length, a unit being a metre. 0: a
     * pinhole, all is sharp. */
    double aperture, f_number;
    double focus_distance; /* along the view; of `focused` ones that of the point focus_on */
    vec3 focus_on;
    bool focused;
    int32_t blades; /* of the aperture: a regular polygon's corners; below 3: round */
    double blade_rotation;
} zt_camera;

typedef struct zt_scene {
    zt_camera camera;
    const zt_mesh *meshes; /* the film's, the same in each of its scenes */
    zt_material *materials;
    zt_light *lights;
    zt_object *objects;
    int32_t mesh_count, material_count, light_count, object_count;
    int32_t reflection_depth; /* how many mirrors a ray may meet, one after the other */
} zt_scene;

/* Whether two are equal to the last bit in each of their fields. */
bool zt_camera_equal(const zt_camera *a, const zt_camera *b);
bool zt_material_equal(const zt_material *a, const zt_material *b);
bool zt_light_equal(const zt_light *a, const zt_light *b);
bool zt_object_equal(const zt_object *a, const zt_object *b);

/* Whether two objects of one shape have the same numbers, to the last bit, that say where they
 * are. */
bool zt_object_stays(const zt_object *a, const zt_object *b);

/* The transform of each object's group, all groups above included, written to `worlds`
 * (object_count of them): from the space that the object's numbers are given in to the world
 * as seen from `origin`. That is taken off before anything is added up, so that what is near it
 * keeps all digits of its place, however far from the world's own origin it stands. */
void zt_scene_worlds(xform *worlds, const zt_scene *scene, vec3 origin);

/* The camera's axes in the world: x right, y up, z against the view; `shift` is its position.
 */
xform zt_camera_xform(const zt_camera *camera);

/* Half of what the picture shows from bottom to top: in the unit of space of an orthographic
 * lens, else of a perspective one at a distance of 1. */
double zt_camera_half_height(const zt_camera *camera);

/* Millimetres, of a perspective lens: as given, or that of `fov` on such a sensor. */
double zt_camera_focal_length(const zt_camera *camera);

/* The radius of the opening, in the unit of space; of blades, that of the circle that their
 * corners are on. 0: a pinhole. */
double zt_camera_opening(const zt_camera *camera);

/* How far ahead of the camera a point is, along its view; below 0 behind it. */
double zt_camera_depth(const zt_camera *camera, vec3 point);

/* How far ahead all is sharp; never behind, nor nearer than a millionth of the opening. */
double zt_camera_focus(const zt_camera *camera);

/* How a camera sees, for points relative to some origin. */
typedef struct zt_projection {
    zt_lens_kind lens;
    xform camera;      /* to how far to the right, up and ahead a point is */
    double wide, high; /* what the picture shows: of perspective at a distance of 1 */
} zt_projection;

/* Of a picture so many times wider than high. */
zt_projection zt_camera_projection(const zt_camera *camera, vec3 origin, double aspect);

/* Where on the picture a point is, 0..1 from the left and from the top; beyond that where it is
 * outside. False where the camera cannot show it, as behind it. */
bool zt_project(double *x, double *y, const zt_projection *projection, vec3 point);

/* The same as matrices, as zt_image_info has them: to the camera, and to the picture, the
 * latter all zeros of an equirectangular lens, which has none. */
void zt_camera_matrices(double to_camera[16], double to_picture[16], const zt_camera *camera,
                        double aspect);

#endif
