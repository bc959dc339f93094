/* The one table of all that can be keyed: which thing owns it, its name, kind, range and its
 * place in the scene. Reading looks names up in it; freezing writes through it. A new
 * animatable property is one row in property.c. */
#ifndef ZT_KEYFRAME_PROPERTY_H
#define ZT_KEYFRAME_PROPERTY_H

#include <stdbool.h>
#include <stddef.h>

#include "scene/scene.h"

/* What a value is made of, and so how it is written and how it is interpolated. In a curve each
 * kind is zt_value_width() doubles. */
typedef enum zt_value_kind {
    ZT_VALUE_NUMBER,   /* 1 */
    ZT_VALUE_ANGLE,    /* 1: radians; written in degrees */
    ZT_VALUE_VECTOR,   /* 3 */
    ZT_VALUE_SCALE,    /* 3; one number written stands for all three */
    ZT_VALUE_COLOR,    /* 3: linear light */
    ZT_VALUE_ROTATION, /* 4: a unit quaternion w x y z */
    ZT_VALUE_VERTICES, /* 9: three points */
    ZT_VALUE_SWITCH    /* 1: 0 or 1; holds between keys */
} zt_value_kind;

/* Who has properties: the words of the description. */
typedef enum zt_owner {
    ZT_OWNER_CAMERA,
    ZT_OWNER_MATERIAL,
    ZT_OWNER_AMBIENT,
    ZT_OWNER_POINT,
    ZT_OWNER_DISK_LIGHT,
    ZT_OWNER_RECTANGLE_LIGHT,
    ZT_OWNER_PLANE,
    ZT_OWNER_SPHERE,
    ZT_OWNER_TRIANGLE,
    ZT_OWNER_DISK,
    ZT_OWNER_BOX,
    ZT_OWNER_CYLINDER,
    ZT_OWNER_CONE,
    ZT_OWNER_TORUS,
    ZT_OWNER_CAPSULE,
    ZT_OWNER_MESH,
    ZT_OWNER_GROUP,
    ZT_OWNER_COUNT
} zt_owner;

typedef enum zt_property_flag {
    ZT_PROPERTY_REQUIRED = 1, /* the owner makes no sense without it */
    ZT_PROPERTY_DIRECTION = 2 /* a vector of any length but zero */
} zt_property_flag;

typedef struct zt_property {
    zt_owner owner;
    const char *name;
    zt_value_kind kind;
    const char *unit; /* as written: "deg"; NULL for none */
    double min, max;  /* of each channel as written (degrees), both allowed; +-INFINITY */
    unsigned flags;   /* of zt_property_flag */
    size_t offset;    /* bytes within the owner's struct of the scene */
    const char *meaning;
} zt_property;

enum { ZT_VALUE_WIDTH_MAX = 9 };

extern const zt_property zt_properties[];
extern const int zt_property_count;

/* "camera", "plane" …: the word that the description uses. */
const char *zt_owner_name(zt_owner owner);

int zt_value_width(zt_value_kind kind);

/* The row of a property, or NULL. */
const zt_property *zt_property_find(zt_owner owner, const char *name);

/* Reads or writes a property of the owner's thing number `index` in a scene: of the camera (0),
 * or the index in materials, lights or objects. `value` holds zt_value_width(kind) doubles. */
void zt_property_get(double *value, const zt_property *property, const zt_scene *scene,
                     int32_t index);
void zt_property_set(const zt_property *property, zt_scene *scene, int32_t index,
                     const double *value);

/* Sets all properties of a thing to what they are when the description does not say: white,
 * unit sizes, no rotation. */
void zt_property_rest(zt_scene *scene, zt_owner owner, int32_t index);

#endif
