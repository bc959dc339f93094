#include "keyframe/property.h"

#include <string.h>

#include "base/text.h"

#define NONE      INFINITY
#define REQUIRED  ZT_PROPERTY_REQUIRED
#define DIRECTION ZT_PROPERTY_DIRECTION

#define CAMERA(field)    offsetof(zt_camera, field)
#define MATERIAL(field)  offsetof(zt_material, field)
#define LIGHT(field)     offsetof(zt_light, field)
#define OBJECT(field)    offsetof(zt_object, field)
#define PLACEMENT(field) (offsetof(zt_object, placement) + offsetof(zt_placement, field))

/* clang-format off */
const zt_property zt_properties[] = {
    {ZT_OWNER_CAMERA, "position", ZT_VALUE_VECTOR, NULL, -NONE, NONE, 0, CAMERA(position), "where the eye is"},
    {ZT_OWNER_CAMERA, "look_at", ZT_VALUE_VECTOR, NULL, -NONE, NONE, 0, CAMERA(look_at), "the point in the middle of the picture"},
    {ZT_OWNER_CAMERA, "up", ZT_VALUE_VECTOR, NULL, -NONE, NONE, 0, CAMERA(up), "what is up in the picture, with look_at"},
    {ZT_OWNER_CAMERA, "rotation", ZT_VALUE_ROTATION, "deg", -NONE, NONE, 0, CAMERA(rotation), "instead of look_at: turned from looking along -z"},
    {ZT_OWNER_CAMERA, "roll", ZT_VALUE_ANGLE, "deg", -NONE, NONE, 0, CAMERA(roll), "turns it around its view; the picture turns clockwise"},
    {ZT_OWNER_CAMERA, "fov", ZT_VALUE_ANGLE, "deg", 1e-6, 179.9, 0, CAMERA(fov), "the angle that the picture's height spans"},
    {ZT_OWNER_CAMERA, "focal_length", ZT_VALUE_NUMBER, "mm", 0, NONE, 0, CAMERA(focal_length), "instead of fov: that of the lens in millimetres; 0 where fov counts"},
    {ZT_OWNER_CAMERA, "sensor_height", ZT_VALUE_NUMBER, "mm", 1e-6, NONE, 0, CAMERA(sensor_height), "how high the picture behind the lens is, in millimetres"},
    {ZT_OWNER_CAMERA, "height", ZT_VALUE_NUMBER, NULL, 1e-12, NONE, 0, CAMERA(height), "how much an orthographic lens shows from bottom to top"},
    {ZT_OWNER_CAMERA, "aperture", ZT_VALUE_NUMBER, NULL, 0, NONE, 0, CAMERA(aperture), "the radius of the opening; 0: all is sharp"},
    {ZT_OWNER_CAMERA, "f_number", ZT_VALUE_NUMBER, NULL, 0, NONE, 0, CAMERA(f_number), "instead of aperture: focal length by diameter, a unit of space being a metre; 0: none"},
    {ZT_OWNER_CAMERA, "focus_distance", ZT_VALUE_NUMBER, NULL, 1e-12, NONE, 0, CAMERA(focus_distance), "how far ahead all is sharp"},
    {ZT_OWNER_CAMERA, "focus_on", ZT_VALUE_VECTOR, NULL, -NONE, NONE, 0, CAMERA(focus_on), "instead of focus_distance: the point as far ahead as which all is sharp"},
    {ZT_OWNER_CAMERA, "blade_rotation", ZT_VALUE_ANGLE, "deg", -NONE, NONE, 0, CAMERA(blade_rotation), "turns the blades' corners, counterclockwise as the camera looks"},

    {ZT_OWNER_MATERIAL, "color", ZT_VALUE_COLOR, NULL, 0, NONE, 0, MATERIAL(color), "the share of light that is thrown back"},
    {ZT_OWNER_MATERIAL, "reflectivity", ZT_VALUE_NUMBER, NULL, 0, 1, 0, MATERIAL(reflectivity), "how much of what the mirror shows is added"},

    {ZT_OWNER_MATERIAL, "other_color", ZT_VALUE_COLOR, NULL, 0, NONE, 0, MATERIAL(other_color), "of a pattern: the color of every other cell"},
    {ZT_OWNER_MATERIAL, "pattern_size", ZT_VALUE_NUMBER, NULL, 1e-12, NONE, 0, MATERIAL(pattern_size), "how long a cell of the pattern is"},
    {ZT_OWNER_MATERIAL, "pattern_direction", ZT_VALUE_VECTOR, NULL, -NONE, NONE, DIRECTION, MATERIAL(pattern_direction), "across the stripes; any length"},

    {ZT_OWNER_AMBIENT, "color", ZT_VALUE_COLOR, NULL, 0, NONE, 0, LIGHT(color), "the light's color"},
    {ZT_OWNER_AMBIENT, "intensity", ZT_VALUE_NUMBER, NULL, 0, NONE, 0, LIGHT(intensity), "a factor to the color"},

    {ZT_OWNER_POINT, "position", ZT_VALUE_VECTOR, NULL, -NONE, NONE, REQUIRED, LIGHT(position), "where the light is"},
    {ZT_OWNER_POINT, "color", ZT_VALUE_COLOR, NULL, 0, NONE, 0, LIGHT(color), "the light's color"},
    {ZT_OWNER_POINT, "intensity", ZT_VALUE_NUMBER, NULL, 0, NONE, 0, LIGHT(intensity), "a factor to the color, at distance 1"},
    {ZT_OWNER_POINT, "shadows", ZT_VALUE_SWITCH, NULL, 0, 1, 0, LIGHT(shadows), "whether objects keep its light off"},
    {ZT_OWNER_POINT, "radius", ZT_VALUE_NUMBER, NULL, 0, NONE, 0, LIGHT(radius), "of the ball that shines, for soft shadows; 0: a point"},

    {ZT_OWNER_DISK_LIGHT, "position", ZT_VALUE_VECTOR, NULL, -NONE, NONE, REQUIRED, LIGHT(position), "the middle"},
    {ZT_OWNER_DISK_LIGHT, "rotation", ZT_VALUE_ROTATION, "deg", -NONE, NONE, 0, LIGHT(rotation), "turned from shining along -z"},
    {ZT_OWNER_DISK_LIGHT, "radius", ZT_VALUE_NUMBER, NULL, 0, NONE, REQUIRED, LIGHT(radius), "the radius"},
    {ZT_OWNER_DISK_LIGHT, "color", ZT_VALUE_COLOR, NULL, 0, NONE, 0, LIGHT(color), "the light's color"},
    {ZT_OWNER_DISK_LIGHT, "intensity", ZT_VALUE_NUMBER, NULL, 0, NONE, 0, LIGHT(intensity), "a factor to the color, at distance 1 straight ahead"},
    {ZT_OWNER_DISK_LIGHT, "shadows", ZT_VALUE_SWITCH, NULL, 0, 1, 0, LIGHT(shadows), "whether objects keep its light off"},

    {ZT_OWNER_RECTANGLE_LIGHT, "position", ZT_VALUE_VECTOR, NULL, -NONE, NONE, REQUIRED, LIGHT(position), "the middle"},
    {ZT_OWNER_RECTANGLE_LIGHT, "rotation", ZT_VALUE_ROTATION, "deg", -NONE, NONE, 0, LIGHT(rotation), "turned from shining along -z, with y up"},
    {ZT_OWNER_RECTANGLE_LIGHT, "width", ZT_VALUE_NUMBER, NULL, 0, NONE, REQUIRED, LIGHT(width), "how long it is along its x"},
    {ZT_OWNER_RECTANGLE_LIGHT, "height", ZT_VALUE_NUMBER, NULL, 0, NONE, REQUIRED, LIGHT(height), "how long it is along its y"},
    {ZT_OWNER_RECTANGLE_LIGHT, "color", ZT_VALUE_COLOR, NULL, 0, NONE, 0, LIGHT(color), "the light's color"},
    {ZT_OWNER_RECTANGLE_LIGHT, "intensity", ZT_VALUE_NUMBER, NULL, 0, NONE, 0, LIGHT(intensity), "a factor to the color, at distance 1 straight ahead"},
    {ZT_OWNER_RECTANGLE_LIGHT, "shadows", ZT_VALUE_SWITCH, NULL, 0, 1, 0, LIGHT(shadows), "whether objects keep its light off"},

    {ZT_OWNER_PLANE, "normal", ZT_VALUE_VECTOR, NULL, -NONE, NONE, REQUIRED | DIRECTION, OBJECT(plane.normal), "what is up from the plane; any length"},
    {ZT_OWNER_PLANE, "distance", ZT_VALUE_NUMBER, NULL, -NONE, NONE, 0, OBJECT(plane.distance), "from the origin to the plane, along the normal"},

    {ZT_OWNER_SPHERE, "center", ZT_VALUE_VECTOR, NULL, -NONE, NONE, REQUIRED, OBJECT(sphere.center), "the middle"},
    {ZT_OWNER_SPHERE, "radius", ZT_VALUE_NUMBER, NULL, 0, NONE, REQUIRED, OBJECT(sphere.radius), "the radius; 0 hides the sphere"},

    {ZT_OWNER_TRIANGLE, "vertices", ZT_VALUE_VERTICES, NULL, -NONE, NONE, REQUIRED, OBJECT(triangle.vertices), "the three corners"},

    {ZT_OWNER_DISK, "center", ZT_VALUE_VECTOR, NULL, -NONE, NONE, REQUIRED, OBJECT(disk.center), "the middle"},
    {ZT_OWNER_DISK, "normal", ZT_VALUE_VECTOR, NULL, -NONE, NONE, REQUIRED | DIRECTION, OBJECT(disk.normal), "what is up from the disk; any length"},
    {ZT_OWNER_DISK, "radius", ZT_VALUE_NUMBER, NULL, 0, NONE, REQUIRED, OBJECT(disk.radius), "the radius; 0 hides the disk"},

    {ZT_OWNER_BOX, "center", ZT_VALUE_VECTOR, NULL, -NONE, NONE, REQUIRED, OBJECT(box.center), "the middle"},
    {ZT_OWNER_BOX, "size", ZT_VALUE_SCALE, NULL, 0, NONE, REQUIRED, OBJECT(box.size), "how long the box is along x, y and z, or one number for all; 0 hides the box"},
    {ZT_OWNER_BOX, "rotation", ZT_VALUE_ROTATION, "deg", -NONE, NONE, 0, OBJECT(box.rotation), "angles around x, then y, then z, through the middle"},

    {ZT_OWNER_CYLINDER, "from", ZT_VALUE_VECTOR, NULL, -NONE, NONE, REQUIRED, OBJECT(tube.from), "the middle of one end"},
    {ZT_OWNER_CYLINDER, "to", ZT_VALUE_VECTOR, NULL, -NONE, NONE, REQUIRED, OBJECT(tube.to), "the middle of the other end"},
    {ZT_OWNER_CYLINDER, "radius", ZT_VALUE_NUMBER, NULL, 0, NONE, REQUIRED, OBJECT(tube.radius), "the radius; 0 hides the cylinder"},

    {ZT_OWNER_CONE, "from", ZT_VALUE_VECTOR, NULL, -NONE, NONE, REQUIRED, OBJECT(tube.from), "the middle of one end"},
    {ZT_OWNER_CONE, "to", ZT_VALUE_VECTOR, NULL, -NONE, NONE, REQUIRED, OBJECT(tube.to), "the middle of the other end, or the tip"},
    {ZT_OWNER_CONE, "radius", ZT_VALUE_NUMBER, NULL, 0, NONE, REQUIRED, OBJECT(tube.radius), "the radius at the first end"},
    {ZT_OWNER_CONE, "end_radius", ZT_VALUE_NUMBER, NULL, 0, NONE, 0, OBJECT(tube.end_radius), "the radius at the other end"},

    {ZT_OWNER_TORUS, "center", ZT_VALUE_VECTOR, NULL, -NONE, NONE, REQUIRED, OBJECT(torus.center), "the middle of the hole"},
    {ZT_OWNER_TORUS, "axis", ZT_VALUE_VECTOR, NULL, -NONE, NONE, DIRECTION, OBJECT(torus.axis), "what goes through the hole; any length"},
    {ZT_OWNER_TORUS, "radius", ZT_VALUE_NUMBER, NULL, 0, NONE, REQUIRED, OBJECT(torus.radius), "from the middle to the middle of the tube"},
    {ZT_OWNER_TORUS, "tube_radius", ZT_VALUE_NUMBER, NULL, 0, NONE, REQUIRED, OBJECT(torus.tube_radius), "the radius of the tube, at most the other one; 0 hides the torus"},

    {ZT_OWNER_CAPSULE, "from", ZT_VALUE_VECTOR, NULL, -NONE, NONE, REQUIRED, OBJECT(tube.from), "the middle of one round end"},
    {ZT_OWNER_CAPSULE, "to", ZT_VALUE_VECTOR, NULL, -NONE, NONE, REQUIRED, OBJECT(tube.to), "the middle of the other round end"},
    {ZT_OWNER_CAPSULE, "radius", ZT_VALUE_NUMBER, NULL, 0, NONE, REQUIRED, OBJECT(tube.radius), "the radius; 0 hides the capsule"},

    {ZT_OWNER_MESH, "position", ZT_VALUE_VECTOR, NULL, -NONE, NONE, 0, PLACEMENT(position), "where the model's origin is"},
    {ZT_OWNER_MESH, "rotation", ZT_VALUE_ROTATION, "deg", -NONE, NONE, 0, PLACEMENT(rotation), "angles around x, then y, then z"},
    {ZT_OWNER_MESH, "scale", ZT_VALUE_SCALE, NULL, -NONE, NONE, 0, PLACEMENT(scale), "a factor, or one for each axis; 0 hides the mesh"},
    {ZT_OWNER_MESH, "smooth", ZT_VALUE_SWITCH, NULL, 0, 1, 0, OBJECT(smooth), "whether light falls on it as on something round"},
    {ZT_OWNER_MESH, "vertex_colors", ZT_VALUE_SWITCH, NULL, 0, 1, 0, OBJECT(vertex_colors), "whether the model's own colors tint the material's"},

    {ZT_OWNER_GROUP, "position", ZT_VALUE_VECTOR, NULL, -NONE, NONE, 0, PLACEMENT(position), "where the group's origin is"},
    {ZT_OWNER_GROUP, "rotation", ZT_VALUE_ROTATION, "deg", -NONE, NONE, 0, PLACEMENT(rotation), "angles around x, then y, then z"},
    {ZT_OWNER_GROUP, "scale", ZT_VALUE_SCALE, NULL, -NONE, NONE, 0, PLACEMENT(scale), "a factor, or one for each axis; 0 hides the members"},
};
/* clang-format on */

const int zt_property_count = sizeof zt_properties / sizeof zt_properties[0];

const char *zt_owner_name(zt_owner owner) {
    static const char *const names[ZT_OWNER_COUNT] = {
        "camera", "material", "ambient",  "point", "disk_light", "rectangle_light",
        "plane",  "sphere",   "triangle", "disk",  "box",        "cylinder",
        "cone",   "torus",    "capsule",  "mesh",  "group"};
    return names[owner];
}

int zt_value_width(zt_value_kind kind) {
    switch (kind) {
    case ZT_VALUE_NUMBER:
    case ZT_VALUE_ANGLE:
    case ZT_VALUE_SWITCH:
        return 1;
    case ZT_VALUE_VECTOR:
    case ZT_VALUE_SCALE:
    case ZT_VALUE_COLOR:
        return 3;
    case ZT_VALUE_ROTATION:
        return 4;
    case ZT_VALUE_VERTICES:
        return 9;
    }
    return 0;
}

const zt_property *zt_property_find(zt_owner owner, const char *name) {
    for (int i = 0; i < zt_property_count; i++)
        if (zt_properties[i].owner == owner && zt_text_equal(zt_properties[i].name, name))
            return &zt_properties[i];
    return NULL;
}

/* The struct in the scene that an owner's properties are offsets into. */
static char *owner_struct(const zt_scene *scene, zt_owner owner, int32_t index) {
    switch (owner) {
    case ZT_OWNER_CAMERA:
        return (char *)&scene->camera;
    case ZT_OWNER_MATERIAL:
        return (char *)&scene->materials[index];
    case ZT_OWNER_AMBIENT:
    case ZT_OWNER_POINT:
    case ZT_OWNER_DISK_LIGHT:
    case ZT_OWNER_RECTANGLE_LIGHT:
        return (char *)&scene->lights[index];
    default:
        return (char *)&scene->objects[index];
    }
}

void zt_property_get(double *value, const zt_property *property, const zt_scene *scene,
                     int32_t index) {
    const char *field = owner_struct(scene, property->owner, index) + property->offset;
    if (property->kind == ZT_VALUE_SWITCH)
        *value = *(const bool *)field;
    else
        memcpy(value, field, (size_t)zt_value_width(property->kind) * sizeof *value);
}

void zt_property_set(const zt_property *property, zt_scene *scene, int32_t index,
                     const double *value) {
    char *field = owner_struct(scene, property->owner, index) + property->offset;
    if (property->kind == ZT_VALUE_SWITCH)
        *(bool *)field = *value >= 0.5;
    else
        memcpy(field, value, (size_t)zt_value_width(property->kind) * sizeof *value);
}

void zt_property_rest(zt_scene *scene, zt_owner owner, int32_t index) {
    static const zt_placement still = {{0, 0, 0}, {1, 0, 0, 0}, {1, 1, 1}};
    switch (owner) {
    case ZT_OWNER_CAMERA:
        scene->camera = (zt_camera){.up = {0, 1, 0},
                                    .rotation = {1, 0, 0, 0},
                                    .fov = 40 * (3.14159265358979323846 / 180),
                                    .sensor_height = 24,
                                    .height = 2,
                                    .focus_distance = 1};
        break;
    case ZT_OWNER_MATERIAL:
        scene->materials[index] = (zt_material){
            .color = {1, 1, 1}, .pattern_size = 1, .pattern_direction = {1, 0, 0}};
        break;
    case ZT_OWNER_AMBIENT:
    case ZT_OWNER_POINT:
    case ZT_OWNER_DISK_LIGHT:
    case ZT_OWNER_RECTANGLE_LIGHT:
        scene->lights[index] =
            (zt_light){.kind = (zt_light_kind)(ZT_LIGHT_AMBIENT + (owner - ZT_OWNER_AMBIENT)),
                       .color = {1, 1, 1},
                       .intensity = 1,
                       .rotation = still.rotation,
                       .shadows = true};
        break;
    default: {
        zt_object *object = &scene->objects[index];
        *object = (zt_object){.shape = (zt_shape)(ZT_SHAPE_PLANE + (owner - ZT_OWNER_PLANE)),
                              .parent = -1,
                              .material = -1,
                              .mesh = -1};
        if (owner == ZT_OWNER_MESH || owner == ZT_OWNER_GROUP) object->placement = still;
        if (owner == ZT_OWNER_BOX) object->box.rotation = still.rotation;
        if (owner == ZT_OWNER_TORUS) object->torus.axis = (vec3){0, 1, 0};
    }
    }
}
