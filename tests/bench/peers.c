#include "peers.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "keyframe/animation.h"
#include "measure.h"

/* POV-Ray's lights fade as 2 / (1 + (d / f)^2): with f small, as 1 / d^2 times a constant. */
#define FADE_DISTANCE 0.001

static vec3 ambient_of(const zt_scene *scene) {
    vec3 sum = {0, 0, 0};
    for (int32_t i = 0; i < scene->light_count; i++) {
        const zt_light *light = &scene->lights[i];
        if (light->kind == ZT_LIGHT_AMBIENT)
            sum = vec3_add(sum, vec3_scale(light->color, light->intensity));
    }
    return sum;
}

/* The triangles of a mesh in the world; `write` is called for each with its corners. */
typedef void write_triangle(FILE *file, const vec3 corners[3], const char *texture);

static void write_mesh(FILE *file, const zt_scene *scene, const zt_object *object,
                       write_triangle *write, const char *texture) {
    const zt_mesh *mesh = &scene->meshes[object->mesh];
    const zt_placement *p = &object->placement;
    xform place = xform_place(p->position, p->rotation, p->scale);
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        vec3 corners[3];
        for (int i = 0; i < 3; i++)
            corners[i] = xform_point(&place, zt_mesh_corner(mesh, t, i));
        write(file, corners, texture);
    }
}

/* POV-Ray */

static void pov_vector(FILE *file, const char *before, vec3 v, const char *after) {
    fprintf(file, "%s<%.9g, %.9g, %.9g>%s", before, v.x, v.y, v.z, after);
}

static void pov_triangle(FILE *file, const vec3 corners[3], const char *texture) {
    (void)texture;
    pov_vector(file, "triangle { ", corners[0], ", ");
    pov_vector(file, "", corners[1], ", ");
    pov_vector(file, "", corners[2], " }\n");
}

static void pov_object(FILE *file, const zt_scene *scene, const zt_object *object) {
    const zt_material *material = &scene->materials[object->material];
    vec3 n = object->plane.normal;
    switch (object->shape) {
    case ZT_SHAPE_PLANE:
        pov_vector(file, "plane { ", n, "");
        fprintf(file, ", %.9g", object->plane.distance);
        break;
    case ZT_SHAPE_SPHERE:
        pov_vector(file, "sphere { ", object->sphere.center, "");
        fprintf(file, ", %.9g", object->sphere.radius);
        break;
    case ZT_SHAPE_MESH:
        fprintf(file, "mesh {\n");
        write_mesh(file, scene, object, pov_triangle, NULL);
        break;
    default:
        must_be(false, "no peer's scene can hold this object");
    }
    pov_vector(file, " pigment { color rgb ", material->color, " }");
    pov_vector(file, " finish { ambient rgb ", ambient_of(scene), " diffuse 1");
    fprintf(file, " reflection { %.9g } } }\n", material->reflectivity);
}

static void write_povray(FILE *file, const zt_scene *scene, int width, int height) {
    xform camera = zt_camera_xform(&scene->camera);
    double y = 2 * tan(scene->camera.fov / 2), x = y * width / height;
    fprintf(file,
            "#version 3.7;\nglobal_settings { assumed_gamma 1 ambient_light rgb 1 "
            "max_trace_level %" PRId32 " }\ncamera { perspective",
            scene->reflection_depth + 1);
    pov_vector(file, " location ", camera.shift, "");
    pov_vector(file, " direction ", vec3_scale(camera.z, -1), "");
    pov_vector(file, " right ", vec3_scale(camera.x, x), "");
    pov_vector(file, " up ", vec3_scale(camera.y, y), " }\n");
    for (int32_t i = 0; i < scene->light_count; i++) {
        const zt_light *light = &scene->lights[i];
        if (light->kind != ZT_LIGHT_POINT) continue;
        double power = light->intensity / (2 * FADE_DISTANCE * FADE_DISTANCE);
        pov_vector(file, "light_source { ", light->position, "");
        pov_vector(file, " color rgb ", vec3_scale(light->color, power), "");
        fprintf(file, " fade_distance %g fade_power 2 }\n", FADE_DISTANCE);
    }
    for (int32_t i = 0; i < scene->object_count; i++)
        pov_object(file, scene, &scene->objects[i]);
}

/* Tachyon. Its space is left-handed: z is turned over. */

static void tachyon_vector(FILE *file, const char *before, vec3 v, const char *after) {
    fprintf(file, "%s %.9g %.9g %.9g%s", before, v.x, v.y, -v.z, after);
}

static void tachyon_triangle(FILE *file, const vec3 corners[3], const char *texture) {
    tachyon_vector(file, "TRI V0", corners[0], "");
    tachyon_vector(file, " V1", corners[1], "");
    tachyon_vector(file, " V2", corners[2], " ");
    fprintf(file, "%s\n", texture);
}

static void tachyon_object(FILE *file, const zt_scene *scene, const zt_object *object) {
    char texture[32];
    snprintf(texture, sizeof texture, "material%" PRId32, object->material);
    vec3 n = object->plane.normal;
    switch (object->shape) {
    case ZT_SHAPE_PLANE:
        tachyon_vector(file, "PLANE CENTER",
                       vec3_scale(n, object->plane.distance / vec3_dot(n, n)), "");
        tachyon_vector(file, " NORMAL", n, "");
        break;
    case ZT_SHAPE_SPHERE:
        tachyon_vector(file, "SPHERE CENTER", object->sphere.center, "");
        fprintf(file, " RAD %.9g", object->sphere.radius);
        break;
    case ZT_SHAPE_MESH:
        write_mesh(file, scene, object, tachyon_triangle, texture);
        return;
    default:
        must_be(false, "no peer's scene can hold this object");
    }
    fprintf(file, " %s\n", texture);
}

static void write_tachyon(FILE *file, const zt_scene *scene, int width, int height) {
    xform camera = zt_camera_xform(&scene->camera);
    fprintf(file,
            "BEGIN_SCENE\nRESOLUTION %d %d\nCAMERA ZOOM %.9g ASPECTRATIO 1 ANTIALIASING 0 "
            "RAYDEPTH %" PRId32,
            width, height, 1 / (2 * tan(scene->camera.fov / 2)), scene->reflection_depth + 1);
    tachyon_vector(file, " CENTER", camera.shift, "");
    tachyon_vector(file, " VIEWDIR", vec3_scale(camera.z, -1), "");
    tachyon_vector(file, " UPDIR", camera.y, "");
    /* Its rays go through the lower left corners of pixels: they are moved to the middle. */
    double pixel = 2 * tan(scene->camera.fov / 2) / height;
    fprintf(file, " FRUSTUM %.9g %.9g %.9g %.9g END_CAMERA\nBACKGROUND 0 0 0\n",
            -(width + 1) * pixel / 2, (width - 1) * pixel / 2, -(height + 1) * pixel / 2,
            (height - 1) * pixel / 2);
    for (int32_t i = 0; i < scene->light_count; i++) {
        const zt_light *light = &scene->lights[i];
        if (light->kind != ZT_LIGHT_POINT) continue;
        tachyon_vector(file, "LIGHT CENTER", light->position, " RAD 0");
        fprintf(file, " ATTENUATION CONSTANT 0 LINEAR 0 QUADRATIC %.9g COLOR %.9g %.9g %.9g\n",
                1 / light->intensity, light->color.x, light->color.y, light->color.z);
    }
    for (int32_t i = 0; i < scene->material_count; i++) {
        const zt_material *material = &scene->materials[i];
        fprintf(file,
                "TEXDEF material%" PRId32 " AMBIENT %.9g DIFFUSE 1 SPECULAR %.9g OPACITY 1 "
                "COLOR %.9g %.9g %.9g TEXFUNC 0\n",
                i, ambient_of(scene).x, material->reflectivity, material->color.x,
                material->color.y, material->color.z);
    }
    for (int32_t i = 0; i < scene->object_count; i++)
        tachyon_object(file, scene, &scene->objects[i]);
    fprintf(file, "END_SCENE\n");
}

/* The first frame, given to `use` with a file of the scratch directory. */
typedef void use_scene(FILE *file, const zt_scene *scene, int a, int b);

static void with_scene(const char *film, const char *name, use_scene *use, int a, int b) {
    zt_animation *animation = film_open(film, NULL);
    zt_arena arena = {0};
    zt_scene scene;
    must(zt_animation_freeze(&scene, animation, 0, &arena, to_stderr), film);
    FILE *file = fopen(scratch_path(name), "w");
    must_be(file != NULL, "cannot write a peer's scene");
    use(file, &scene, a, b);
    must_be(fclose(file) == 0, "cannot write a peer's scene");
    zt_arena_free(&arena);
    zt_animation_free(&animation);
}

void write_peers(const char *film, int width, int height) {
    char name[64];
    snprintf(name, sizeof name, "%s.pov", film);
    with_scene(film, name, write_povray, width, height);
    snprintf(name, sizeof name, "%s.tachyon", film);
    with_scene(film, name, write_tachyon, width, height);
}

static void write_camera(FILE *file, const zt_scene *scene, int count, int unused) {
    (void)unused;
    xform camera = zt_camera_xform(&scene->camera);
    for (int i = 0; i < count; i++) { /* no newline in the end, or one frame more is made */
        tachyon_vector(file, i ? "\n" : "", vec3_scale(camera.z, -1), "");
        tachyon_vector(file, "", camera.y, "");
        tachyon_vector(file, "", camera.shift, "");
    }
}

void write_peer_camera(const char *film, int count) {
    char name[64];
    snprintf(name, sizeof name, "%s.%d.cam", film, count);
    with_scene(film, name, write_camera, count, 0);
}
