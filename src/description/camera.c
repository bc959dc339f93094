#include "description/camera.h"

#include "description/motion.h"

#define COUNT(array) (int)(sizeof(array) / sizeof *(array))

enum { BLADES_MAX = 64 };

/* Which lenses a key says something of. */
enum {
    PERSPECTIVE = 1 << ZT_LENS_PERSPECTIVE,
    ORTHOGRAPHIC = 1 << ZT_LENS_ORTHOGRAPHIC,
    FLAT = PERSPECTIVE | ORTHOGRAPHIC
};
static const struct {
    const char *name;
    unsigned lenses;
} lens_keys[] = {{"fov", PERSPECTIVE},
                 {"focal_length", PERSPECTIVE},
                 {"sensor_height", PERSPECTIVE},
                 {"height", ORTHOGRAPHIC},
                 {"aperture", FLAT},
                 {"f_number", PERSPECTIVE},
                 {"focus_distance", FLAT},
                 {"focus_on", FLAT},
                 {"blades", FLAT},
                 {"blade_rotation", FLAT}};

/* Two keys that say the same in other words. */
static void refuse_both(zt_mistakes *mistakes, const zt_fields *fields, const char *one,
                        const char *other) {
    const zt_node *node = zt_field(fields, other);
    if (node && zt_field(fields, one))
        zt_mistake(mistakes, &node->place, "a camera has either \"%s\" or \"%s\"", one, other);
}

/* A key that says nothing, for want of another one. */
static void doubt_alone(zt_mistakes *mistakes, const zt_fields *fields, const char *name,
                        bool has_other, const char *other) {
    const zt_node *node = zt_field(fields, name);
    if (node && !has_other)
        zt_doubt(mistakes, &node->place, "\"%s\" says nothing without %s", name, other);
}

/* What is said of the lens and does not matter. */
static void doubt_lens(zt_mistakes *mistakes, const zt_fields *fields,
                       const zt_camera *camera) {
    static const char *const lenses[ZT_LENS_KIND_COUNT] = {"a perspective", "an orthographic",
                                                           "an equirectangular"};
    for (int i = 0; i < COUNT(lens_keys); i++) {
        const zt_node *node = zt_field(fields, lens_keys[i].name);
        if (node && !(lens_keys[i].lenses >> camera->lens & 1))
            zt_doubt(mistakes, &node->place, "\"%s\" says nothing of %s lens",
                     lens_keys[i].name, lenses[camera->lens]);
    }
    if (camera->lens == ZT_LENS_EQUIRECTANGULAR) return;
    static const char an_opening[] = "\"aperture\" or \"f_number\"";
    const zt_node *fov = zt_field(fields, "fov"), *aperture = zt_field(fields, "aperture"),
                  *f_number = zt_field(fields, "f_number");
    bool perspective = camera->lens == ZT_LENS_PERSPECTIVE,
         opens = aperture || (f_number && perspective),
         focuses = zt_field(fields, "focus_distance") || zt_field(fields, "focus_on");
    if (perspective) {
        bool has_focal_length = zt_field(fields, "focal_length") != NULL;
        if (fov && camera->focal_length > 0)
            zt_doubt(mistakes, &fov->place, "\"fov\" says nothing beside \"focal_length\"");
        doubt_alone(mistakes, fields, "sensor_height", has_focal_length || f_number,
                    "\"focal_length\" or \"f_number\"");
    }
    doubt_alone(mistakes, fields, "focus_distance", opens, an_opening);
    doubt_alone(mistakes, fields, "focus_on", opens, an_opening);
    doubt_alone(mistakes, fields, "blades", opens, an_opening);
    doubt_alone(mistakes, fields, "blade_rotation", camera->blades > 0, "\"blades\"");
    if (zt_camera_opening(camera) > 0 && !focuses)
        zt_doubt(mistakes, aperture ? &aperture->place : &f_number->place,
                 "\"focus_distance\" or \"focus_on\" is missing: what is sharp is %g ahead",
                 camera->focus_distance);
}

static void read_blades(zt_camera *camera, zt_mistakes *mistakes, const zt_node *node) {
    int64_t number;
    if (!zt_read_integer(&number, mistakes, node, "blades", 0, BLADES_MAX)) return;
    if (number == 1 || number == 2)
        zt_mistake(mistakes, &node->place,
                   "\"blades\" is %d; an opening has at least 3 corners, or is round: 0",
                   (int)number);
    else
        camera->blades = (int32_t)number;
}

/* What of a lens does not move, and whether its keys go together. */
static void read_lens(zt_camera *camera, zt_mistakes *mistakes, const zt_fields *fields) {
    static const char *const lenses[ZT_LENS_KIND_COUNT] = {"perspective", "orthographic",
                                                           "equirectangular"};
    const zt_node *lens = zt_field(fields, "lens"), *blades = zt_field(fields, "blades");
    int choice;
    camera->focused = zt_field(fields, "focus_on") != NULL;
    if (lens && !zt_read_choice(&choice, mistakes, lens, "lens", lenses, COUNT(lenses))) return;
    if (lens) camera->lens = (zt_lens_kind)choice;
    if (blades) read_blades(camera, mistakes, blades);
    refuse_both(mistakes, fields, "aperture", "f_number");
    refuse_both(mistakes, fields, "focus_distance", "focus_on");
    doubt_lens(mistakes, fields, camera);
}

zt_status zt_camera_read(zt_reading *reading, const zt_node *node) {
    const char *names[ZT_FIELD_NAMES_MAX];
    zt_camera *camera = &reading->animation->rest.camera;
    int name_count = zt_motion_names(names, ZT_OWNER_CAMERA);
    names[name_count++] = "lens";
    names[name_count++] = "blades";
    zt_fields fields;
    ZT_TRY(zt_override_in(&node, reading, "camera", names, name_count));
    if (!zt_fields_open(&fields, &reading->mistakes, node, "camera", names, name_count))
        return ZT_OK;
    ZT_TRY(zt_motion_read(reading, &fields, ZT_OWNER_CAMERA, 0, "camera", &node->place));
    camera->aimed = zt_field(&fields, "look_at") != NULL;
    refuse_both(&reading->mistakes, &fields, "look_at", "rotation");
    read_lens(camera, &reading->mistakes, &fields);
    return ZT_OK;
}
