/* Shows that a description becomes the scene and the curves that it says: every property of the
 * table in every way of writing it, exact times, and what holds where nothing is said. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "descriptions.h"

static const double pi = 3.14159265358979323846;

static void assert_near(const double *value, const double *expected, int count) {
    for (int i = 0; i < count; i++)
        if (!(fabs(value[i] - expected[i]) <= 1e-15))
            fail_msg("number %d is %.17g instead of %.17g", i, value[i], expected[i]);
}

/* ---- the table of properties ----------------------------------------------------------------
 */

typedef struct sample {
    const char *text;
    double value[9];
} sample;

/* Two values of each kind, within the ranges of all properties. */
static const sample samples[][2] = {
    [ZT_VALUE_NUMBER] = {{"0.25", {0.25}}, {"1e0", {1}}},
    [ZT_VALUE_ANGLE] = {{"60 deg", {3.14159265358979323846 / 3}}, {"0.5rad", {0.5}}},
    [ZT_VALUE_VECTOR] = {{"[1, -2, 3.5]", {1, -2, 3.5}}, {"[0, .5, -1e3]", {0, 0.5, -1000}}},
    [ZT_VALUE_SCALE] = {{"2", {2, 2, 2}}, {"[1, 0.5, 0]", {1, 0.5, 0}}},
    [ZT_VALUE_COLOR] = {{"[0.25, 2, 0]", {0.25, 2, 0}}, {"0.5", {0.5, 0.5, 0.5}}},
    [ZT_VALUE_ROTATION] = {{"[0, 180, 0]", {0, 0, 1, 0}},
                           {"{ axis: [0, 0, 5], angle: 60 }", {0.8660254037844386, 0, 0, 0.5}}},
    [ZT_VALUE_VERTICES] = {{"[[0, 1, 2], [3, 4, 5], [6, 7, 8]]", {0, 1, 2, 3, 4, 5, 6, 7, 8}},
                           {"[[9, 1, 2], [3, 4, 5], [6, 7, 0]]", {9, 1, 2, 3, 4, 5, 6, 7, 0}}},
    [ZT_VALUE_SWITCH] = {{"false", {0}}, {"yes", {1}}},
};

/* A description with one thing of an owner that has this property, and all that it must have.
 */
static void write_owner(char *text, size_t size, const zt_property *property,
                        const char *value) {
    static const char *const places[ZT_OWNER_COUNT] = {
        "camera: { %s }\n",
        "camera: {}\nmaterials:\n  spare: {}\n  thing: { %s }\n",
        "camera: {}\nlights:\n  - ambient: {}\n  - ambient: { name: thing, %s }\n",
        "camera: {}\nlights:\n  - ambient: {}\n  - point: { name: thing, %s }\n",
        "camera: {}\nlights:\n  - ambient: {}\n  - disk_light: { name: thing, %s }\n",
        "camera: {}\nlights:\n  - ambient: {}\n  - rectangle_light: { name: thing, %s }\n",
        [ZT_OWNER_MESH] = "camera: {}\nobjects:\n  - group: { objects: [] }\n"
                          "  - mesh: { file: one.ply, name: thing, %s }\n",
        [ZT_OWNER_GROUP] = "camera: {}\nobjects:\n  - group: { objects: [] }\n"
                           "  - group: { objects: [], name: thing, %s }\n"};
    char properties[1024];
    snprintf(properties, sizeof properties, "%s: %s", property->name, value);
    for (int i = 0; i < zt_property_count; i++) {
        const zt_property *other = &zt_properties[i];
        if (other->owner != property->owner || !(other->flags & ZT_PROPERTY_REQUIRED) ||
            other == property)
            continue;
        size_t used = strlen(properties);
        snprintf(properties + used, sizeof properties - used, ", %s: %s", other->name,
                 samples[other->kind][0].text);
    }
    int length = snprintf(text, size, "zoetrope: 1\nfilm: { duration: 2 s, rate: 24 }\n");
    char place[256];
    if (places[property->owner])
        snprintf(place, sizeof place, "%s", places[property->owner]);
    else
        snprintf(
            place, sizeof place,
            "camera: {}\nobjects:\n  - group: { objects: [] }\n  - %s: { name: thing, %%s }\n",
            zt_owner_name(property->owner));
    char *hole = strstr(place, "%s");
    *hole = '\0';
    snprintf(text + length, size - (size_t)length, "%s%s%s", place, properties, hole + 2);
}

/* Each property of the table, as a constant, is where the table says in the scene at rest. */
static void every_property_constant(void **state) {
    (void)state;
    write_model("one.ply");
    for (int i = 0; i < zt_property_count; i++)
        for (int s = 0; s < 2; s++) {
            const zt_property *property = &zt_properties[i];
            const sample *given = &samples[property->kind][s];
            char text[2048];
            write_owner(text, sizeof text, property, given->text);
            zt_animation *animation = animation_of(text);
            double value[ZT_VALUE_WIDTH_MAX];
            zt_property_get(value, property, &animation->rest,
                            property->owner == ZT_OWNER_CAMERA ? 0 : 1);
            assert_near(value, given->value, zt_value_width(property->kind));
            assert_int_equal(animation->track_count, 0);
            zt_animation_free(&animation);
        }
}

/* Each property of the table, with keys, becomes a track of its own that meets both keys, and
 * the scene at rest has the value of time 0. */
static void every_property_keyed(void **state) {
    (void)state;
    write_model("one.ply");
    for (int i = 0; i < zt_property_count; i++) {
        const zt_property *property = &zt_properties[i];
        const sample *given = samples[property->kind];
        int width = zt_value_width(property->kind);
        char text[2048], keys[512], name[64];
        snprintf(keys, sizeof keys, "{ keys: { 36: %s, 0 s: %s } }", given[1].text,
                 given[0].text);
        write_owner(text, sizeof text, property, keys);
        zt_animation *animation = animation_of(text);
        assert_int_equal(animation->track_count, 1);
        const zt_track *track = &animation->tracks[0];
        assert_ptr_equal(track->property, property);
        assert_int_equal(track->index, property->owner == ZT_OWNER_CAMERA ? 0 : 1);
        snprintf(name, sizeof name, "%s.%s",
                 property->owner == ZT_OWNER_CAMERA ? "camera" : "thing", property->name);
        assert_string_equal(track->name, name);
        assert_string_equal(zt_curve_label(&track->curve),
                            property->kind == ZT_VALUE_SWITCH ? "hold" : "smooth");
        assert_int_equal(track->curve.key_count, 2);
        assert_true(track->curve.times[0] == 0 && track->curve.times[1] == 1.5);
        double value[ZT_VALUE_WIDTH_MAX];
        zt_curve_eval(value, &track->curve, 0);
        assert_near(value, given[0].value, width);
        zt_curve_eval(value, &track->curve, 1.5);
        assert_near(value, given[1].value, width);
        zt_property_get(value, property, &animation->rest, track->index);
        assert_near(value, given[0].value, width);
        zt_animation_free(&animation);
    }
}

/* ---- times ----------------------------------------------------------------------------------
 */

/* Keys are at exactly the time that they say, and in its order, whatever their order and unit.
 */
static void key_times(void **state) {
    (void)state;
    zt_animation *animation = animation_of(
        "zoetrope: 1\nfilm: { duration: 4 s, rate: 30000/1001 }\n"
        "camera: { fov: { curve: linear, keys: { 1.001 s: 10, 29: 20, \"500 ms\": 30, -3: 40,\n"
        "                 -1e1 s: 50, 0.1s: 60, 1e5: 70 } } }\n");
    const zt_curve *curve = &animation->tracks[0].curve;
    const double times[] = {-10,   -3 * 1001 / 30000.,    0.1, 0.5, 29 * 1001 / 30000.,
                            1.001, 100000 * 1001. / 30000};
    const double degrees[] = {50, 40, 60, 30, 20, 10, 70};
    assert_string_equal(zt_curve_label(curve), "linear");
    assert_int_equal(curve->key_count, 7);
    for (int i = 0; i < 7; i++) {
        assert_true(curve->times[i] == times[i]);
        assert_near(&curve->values[i], &(double){degrees[i] * (pi / 180)}, 1);
    }
    zt_movement movement = zt_animation_movement(animation, 0);
    assert_string_equal(movement.name, "camera.fov");
    assert_string_equal(movement.driver, "linear");
    zt_animation_free(&animation);
}

/* A rate is the exact rational of what is written; a decimal that means one of television's
 * rates is pointed out. */
static void rates(void **state) {
    (void)state;
    static const struct {
        const char *text;
        int num, den;
        const char *warning;
    } cases[] = {{"24", 24, 1, NULL},
                 {"24.0", 24, 1, NULL},
                 {"30000/1001", 30000, 1001, NULL},
                 {"50/2", 25, 1, NULL},
                 {"12.5", 25, 2, NULL},
                 {"999999999", 999999999, 1, NULL},
                 {"29.97", 2997, 100, "30000/1001"},
                 {"23.976", 2997, 125, "24000/1001"},
                 {"23.98", 1199, 50, "24000/1001"},
                 {"59.94", 2997, 50, "60000/1001"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[256];
        snprintf(text, sizeof text,
                 "zoetrope: 1\nfilm: { duration: 1, rate: %s }\ncamera: {}\n"
                 "lights: [ambient: {}]\nobjects: [group: { objects: [] }]\n",
                 cases[i].text);
        static told t;
        zt_animation *animation;
        assert_int_equal(read_told(&t, &animation, text), ZT_OK);
        zt_rate rate = zt_animation_film(animation)->rate;
        assert_int_equal(rate.num, cases[i].num);
        assert_int_equal(rate.den, cases[i].den);
        assert_int_equal(t.warning_count, cases[i].warning != NULL);
        if (cases[i].warning) assert_non_null(strstr(t.lines, cases[i].warning));
        zt_animation_free(&animation);
    }
}

/* The frames are those whose times are before the end. */
static void frame_counts(void **state) {
    (void)state;
    static const struct {
        const char *duration, *rate;
        int64_t frame_count;
    } cases[] = {{"4 s", "24", 96},
                 {"96", "24", 96},
                 {"4 s", "30000/1001", 120},
                 {"1.001 s", "30000/1001", 30},
                 {"1.0011 s", "30000/1001", 31},
                 {"0.001 s", "24", 1},
                 {"41.7 ms", "24", 2},
                 {"100 ms", "30", 3},
                 {"100000000", "24", 100000000},
                 {"3600.1 s", "24000/1001", 86317}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[256];
        snprintf(text, sizeof text,
                 "zoetrope: 1\nfilm: { duration: %s, rate: %s }\ncamera: {}\n",
                 cases[i].duration, cases[i].rate);
        zt_animation *animation = animation_of(text);
        assert_int_equal(zt_animation_film(animation)->frame_count, cases[i].frame_count);
        zt_animation_free(&animation);
    }
}

/* ---- film and camera ------------------------------------------------------------------------
 */

/* What holds where the description does not say; and an empty stage is warned of. */
static void defaults(void **state) {
    (void)state;
    static told t;
    zt_animation *animation;
    assert_int_equal(read_told(&t, &animation,
                               "zoetrope: 1\nfilm: { duration: 1 s }\ncamera: {}\nlights:\n"),
                     ZT_OK);
    assert_int_equal(t.warning_count, 1);
    assert_non_null(strstr(t.lines, "no objects"));
    const zt_film *film = zt_animation_film(animation);
    assert_int_equal(film->width, 1280);
    assert_int_equal(film->height, 720);
    assert_int_equal(film->rate.num, 24);
    assert_int_equal(film->rate.den, 1);
    assert_int_equal(film->frame_count, 24);
    assert_int_equal(film->view, ZT_VIEW_SRGB);
    assert_int_equal(film->sampling.max, 1);
    const zt_scene *rest = &animation->rest;
    assert_int_equal(rest->reflection_depth, 4);
    assert_int_equal(rest->object_count + rest->light_count + rest->material_count, 0);
    assert_false(rest->camera.aimed);
    assert_near(&rest->camera.fov, &(double){40 * (pi / 180)}, 1);
    zt_animation_free(&animation);
}

static void film_and_camera(void **state) {
    (void)state;
    zt_animation *animation =
        animation_of("{\"zoetrope\": 1, \"film\": {\"size\": [65536, 1], \"duration\": \"1 "
                     "s\", \"view\": \"raw\","
                     "\"shading\": \"classic\", \"reflections\": 0, \"samples\": 16},"
                     "\"camera\": {\"position\": [1, 2, 3], \"look_at\": {\"keys\": {\"0\": "
                     "[4, 5, 6]}}}}\n");
    const zt_film *film = zt_animation_film(animation);
    assert_int_equal(film->width, 65536);
    assert_int_equal(film->height, 1);
    assert_int_equal(film->view, ZT_VIEW_RAW);
    assert_int_equal(film->sampling.max, 16);
    assert_int_equal(animation->rest.reflection_depth, 0);
    assert_true(animation->rest.camera.aimed);
    assert_near(&animation->rest.camera.look_at.x, (const double[]){4, 5, 6}, 3);
    zt_animation_free(&animation);
}

/* ---- values ---------------------------------------------------------------------------------
 */

/* The sRGB transfer function, IEC 61966-2-1, from display to light. */
static double decode(int code) {
    double v = code / 255.;
    return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

static void assert_color(const char *written, int r, int g, int b) {
    char text[256];
    snprintf(text, sizeof text, HEAD "lights: [ambient: { color: %s }]\n", written);
    zt_animation *animation = animation_of(text);
    assert_near(&animation->rest.lights[0].color.x,
                (const double[]){decode(r), decode(g), decode(b)}, 3);
    zt_animation_free(&animation);
}

/* Names and hexadecimal colors are what a display shows, and so decoded to light. The values
 * are those of CSS Color Module Level 4; where its names differ from X11's, they are among
 * these. */
static void display_colors(void **state) {
    (void)state;
    assert_color("\"#c8553d\"", 0xc8, 0x55, 0x3d);
    assert_color("'#C83'", 0xcc, 0x88, 0x33);
    assert_color("aliceblue", 240, 248, 255);
    assert_color("black", 0, 0, 0);
    assert_color("crimson", 220, 20, 60);
    assert_color("gray", 128, 128, 128);
    assert_color("grey", 128, 128, 128);
    assert_color("green", 0, 128, 0);
    assert_color("indigo", 75, 0, 130);
    assert_color("lime", 0, 255, 0);
    assert_color("Maroon", 128, 0, 0);
    assert_color("purple", 128, 0, 128);
    assert_color("rebeccapurple", 102, 51, 153);
    assert_color("white", 255, 255, 255);
    assert_color("yellowgreen", 154, 205, 50);
}

/* All 148 names of CSS are known. */
static void all_color_names(void **state) {
    (void)state;
    static const char names[] =
        "aliceblue antiquewhite aqua aquamarine azure beige bisque black "
        "blanchedalmond blue blueviolet brown burlywood cadetblue chartreuse chocolate "
        "coral cornflowerblue cornsilk crimson cyan darkblue darkcyan darkgoldenrod "
        "darkgray darkgreen darkgrey darkkhaki darkmagenta darkolivegreen darkorange "
        "darkorchid darkred darksalmon darkseagreen darkslateblue darkslategray "
        "darkslategrey darkturquoise darkviolet deeppink deepskyblue dimgray dimgrey "
        "dodgerblue firebrick floralwhite forestgreen fuchsia gainsboro ghostwhite "
        "gold goldenrod gray green greenyellow grey honeydew hotpink indianred indigo "
        "ivory khaki lavender lavenderblush lawngreen lemonchiffon lightblue "
        "lightcoral lightcyan lightgoldenrodyellow lightgray lightgreen lightgrey "
        "lightpink lightsalmon lightseagreen lightskyblue lightslategray "
        "lightslategrey lightsteelblue lightyellow lime limegreen linen magenta maroon "
        "mediumaquamarine mediumblue mediumorchid mediumpurple mediumseagreen "
        "mediumslateblue mediumspringgreen mediumturquoise mediumvioletred "
        "midnightblue mintcream mistyrose moccasin navajowhite navy oldlace olive "
        "olivedrab orange orangered orchid palegoldenrod palegreen paleturquoise "
        "palevioletred papayawhip peachpuff peru pink plum powderblue purple "
        "rebeccapurple red rosybrown royalblue saddlebrown salmon sandybrown seagreen "
        "seashell sienna silver skyblue slateblue slategray slategrey snow springgreen "
        "steelblue tan teal thistle tomato turquoise violet wheat white whitesmoke "
        "yellow yellowgreen";
    static char text[16 * 1024];
    int length = snprintf(text, sizeof text, HEAD "lights:\n");
    static char list[sizeof names];
    memcpy(list, names, sizeof names);
    int count = 0;
    for (char *name = strtok(list, " "); name; name = strtok(NULL, " "), count++)
        length += snprintf(text + length, sizeof text - (size_t)length,
                           "  - ambient: { color: %s }\n", name);
    assert_int_equal(count, 148);
    zt_animation *animation = animation_of(text);
    assert_int_equal(zt_animation_contents(animation).ambient_light_count, 148);
    zt_animation_free(&animation);
}

/* [x, y, z] turns around the fixed axes x, then y, then z, against the three matrices. */
static void rotation_order(void **state) {
    (void)state;
    double a = 30 * pi / 180, b = -50 * pi / 180, c = 110 * pi / 180;
    zt_animation *animation =
        animation_of(HEAD "objects: [group: { rotation: [30, -50 deg, 110], objects: [] }]\n");
    quat q = animation->rest.objects[0].placement.rotation;
    xform m = xform_place((vec3){0, 0, 0}, q, (vec3){1, 1, 1});
    vec3 v = {1, 2, 3};
    v = (vec3){v.x, cos(a) * v.y - sin(a) * v.z, sin(a) * v.y + cos(a) * v.z};
    v = (vec3){cos(b) * v.x + sin(b) * v.z, v.y, -sin(b) * v.x + cos(b) * v.z};
    v = (vec3){cos(c) * v.x - sin(c) * v.y, sin(c) * v.x + cos(c) * v.y, v.z};
    vec3 turned = xform_vector(&m, (vec3){1, 2, 3});
    for (int i = 0; i < 3; i++) assert_true(fabs((&turned.x)[i] - (&v.x)[i]) < 1e-14);
    zt_animation_free(&animation);
}

/* ---- things ---------------------------------------------------------------------------------
 */

/* Members come after their group, in the order of the text, and know it; tracks are named by
 * name or by kind and number. */
static void groups_and_names(void **state) {
    (void)state;
    zt_animation *animation = animation_of(
        HEAD "objects:\n"
             "  - sphere: { center: [0, 0, 0], radius: { keys: { 0: 1 } } }\n"
             "  - group:\n"
             "      name: outer\n"
             "      objects:\n"
             "        - group: { position: { keys: { 0: [0, 0, 0] } }, objects: [\n"
             "            sphere: { center: [0, 0, 0], radius: { keys: { 0: 1 } } } ] }\n"
             "        - plane: { normal: [0, 1, 0] }\n"
             "  - sphere: { center: [0, 0, 0], radius: 1,\n"
             "              material: { color: { keys: { 0: red } } } }\n");
    static const zt_shape shapes[] = {ZT_SHAPE_SPHERE, ZT_SHAPE_GROUP, ZT_SHAPE_GROUP,
                                      ZT_SHAPE_SPHERE, ZT_SHAPE_PLANE, ZT_SHAPE_SPHERE};
    static const int parents[] = {-1, -1, 1, 2, 1, -1};
    static const char *const names[] = {"sphere 1.radius", "group 2.position",
                                        "sphere 2.radius", "material 2.color"};
    assert_int_equal(animation->rest.object_count, 6);
    for (int i = 0; i < 6; i++) {
        assert_int_equal(animation->rest.objects[i].shape, shapes[i]);
        assert_int_equal(animation->rest.objects[i].parent, parents[i]);
        assert_int_equal(animation->rest.objects[i].material == -1,
                         shapes[i] == ZT_SHAPE_GROUP);
    }
    assert_int_equal(animation->track_count, 4);
    for (int i = 0; i < 4; i++) assert_string_equal(animation->tracks[i].name, names[i]);
    zt_animation_free(&animation);
}

/* Objects share materials by name, wherever it stands in the text, and one white where they
 * name none; an inline material is their own. */
static void materials(void **state) {
    (void)state;
    zt_animation *animation = animation_of(
        "objects:\n"
        "  - sphere: { center: [0, 0, 0], radius: 1, material: clay }\n"
        "  - sphere: { center: [0, 0, 0], radius: 1 }\n"
        "  - sphere: { center: [0, 0, 0], radius: 1, material: { reflectivity: 1 } }\n"
        "  - sphere: { center: [0, 0, 0], radius: 1 }\n"
        "  - plane: { normal: [0, 1, 0], material: clay }\n"
        "materials: { steel: {}, clay: { color: [0.5, 0.25, 0] } }\n" HEAD);
    const zt_scene *rest = &animation->rest;
    const zt_object *o = rest->objects;
    assert_int_equal(rest->material_count, 4);
    assert_near(&rest->materials[o[0].material].color.x, (const double[]){0.5, 0.25, 0}, 3);
    assert_int_equal(o[4].material, o[0].material);
    assert_near(&rest->materials[o[1].material].color.x, (const double[]){1, 1, 1}, 3);
    assert_int_equal(o[3].material, o[1].material);
    assert_true(rest->materials[o[2].material].reflectivity == 1);
    assert_int_not_equal(o[2].material, o[1].material);
    zt_animation_free(&animation);
}

/* A model is found beside the description and there once, however often it is used and whatever
 * files it is in. */
static void meshes(void **state) {
    (void)state;
    assert_int_equal(mkdir("deep", 0777), 0);
    write_model("deep/a.ply");
    write_model("deep/b.PLY");
    static const char text[] =
        HEAD "objects:\n  - mesh: { file: a.ply }\n  - mesh: { file: b.PLY, scale: 3 }\n"
             "  - mesh: { file: a.ply, position: [1, 2, 3] }\n";
    write_bytes("deep/film.yaml", text, sizeof text - 1);
    zt_animation *animation;
    assert_int_equal(zt_animation_read(&animation, "deep/film.yaml", NULL, 0, (zt_listener){0}),
                     ZT_OK);
    const zt_scene *rest = &animation->rest;
    assert_int_equal(rest->mesh_count, 1);
    for (int i = 0; i < 3; i++) assert_int_equal(rest->objects[i].mesh, 0);
    zt_contents contents = zt_animation_contents(animation);
    assert_int_equal(contents.mesh_count, 3);
    assert_int_equal(contents.mesh_triangle_count, 3);
    zt_animation_free(&animation);
}

/* Aliases repeat what an anchor names; "<<" takes in what a mapping does not say itself. */
static void aliases_and_merges(void **state) {
    (void)state;
    zt_animation *animation = animation_of(
        HEAD "lights:\n"
             "  - point: &lamp { position: &top [1, 2, 3], intensity: 5, color: red }\n"
             "  - point: { intensity: 7, <<: *lamp }\n"
             "  - point: { <<: [{ shadows: false, intensity: 9 }, *lamp], position: *top }\n");
    const zt_light *lights = animation->rest.lights;
    for (int i = 0; i < 3; i++) {
        assert_near(&lights[i].position.x, (const double[]){1, 2, 3}, 3);
        assert_near(&lights[i].color.x, (const double[]){1, 0, 0}, 3);
        assert_true(lights[i].intensity == 5 + 2 * i);
        assert_int_equal(lights[i].shadows, i < 2);
    }
    zt_animation_free(&animation);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_property_constant),
        cmocka_unit_test(every_property_keyed),
        cmocka_unit_test(key_times),
        cmocka_unit_test(rates),
        cmocka_unit_test(frame_counts),
        cmocka_unit_test(defaults),
        cmocka_unit_test(film_and_camera),
        cmocka_unit_test(display_colors),
        cmocka_unit_test(all_color_names),
        cmocka_unit_test(rotation_order),
        cmocka_unit_test(groups_and_names),
        cmocka_unit_test(materials),
        cmocka_unit_test(meshes),
        cmocka_unit_test(aliases_and_merges),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
