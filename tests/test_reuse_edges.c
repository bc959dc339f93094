/* Pictures that take samples at edges, of which tiles are copied: what of a tile that nothing
 * touches might not be the same any more, as it has to be told from others, or depends on the
 * tile beside. Pixels that take more samples than they should, or fewer, have other bits, as
 * light is nowhere even. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "reel.h"

/* A pixel is one wide, and the middle of the picture at 0: where a column of tiles begins. */
static const double column_left = -8;

/* A wall that a near lamp lights. */
static void wall(test_scene *s) {
    scene_begin(s);
    s->scene.camera.lens = ZT_LENS_ORTHOGRAPHIC;
    s->scene.camera.height = REEL_HEIGHT;
    int32_t grey = scene_material(s, (vec3){0.5, 0.6, 0.7}, 0);
    scene_object(s, ZT_SHAPE_BOX, grey)->box =
        (zt_block){{0, 0, -21}, {200, 200, 2}, {1, 0, 0, 0}};
    scene_point_light(s, (vec3){7, 3, 30}, 2000)->shadows = false;
}

/* A lamp beside the camera, and a screen behind that, which shades the two columns of tiles at
 * the left and half of the next. */
static zt_light *shade(test_scene *s) {
    zt_light *lamp = scene_point_light(s, (vec3){0, 0, 180}, 20000);
    scene_object(s, ZT_SHAPE_BOX, 0)->box =
        (zt_block){{-100, 0, 80}, {200, 400, 1}, {1, 0, 0, 0}};
    return lamp;
}

/* A ball on the wall, in the first column of tiles, which will move. */
static zt_sphere *ball(test_scene *s) {
    scene_sphere(s, (vec3){-30, 3, -19}, 2, scene_material(s, (vec3){1, 0.1, 0.1}, 0));
    return &s->objects[s->scene.object_count - 1].sphere;
}

static void open(reel *r) {
    reel_open(r, NULL, 0);
    r->sampling = (zt_sampling){.min = 1, .max = 16, .error = 0.02, .edges = true};
}

/* Begins to copy, before the change. */
static void warm_up(reel *r, const zt_scene *scene) {
    for (int i = 0; i < 2; i++) reel_show(r, scene);
    assert_int_equal(reel_show(r, scene), REEL_TILES);
}

/* Of a lamp that is too dark to be one nobody knows any more where it was hidden. */
static void shadows_end_where_lamps_do(void **state) {
    (void)state;
    static test_scene s;
    reel r;
    wall(&s);
    zt_light *lamp = shade(&s);
    open(&r);
    warm_up(&r, &s.scene);
    lamp->intensity = 1e-44;
    reel_show(&r, &s.scene);
    reel_close(&r);
}

/* One lamp goes that lit nothing to be seen, and what the next one is hidden from is still told
 * by that one. */
static void lamps_keep_their_labels(void **state) {
    (void)state;
    static test_scene s;
    reel r;
    wall(&s);
    scene_point_light(&s, (vec3){0, 0, -50}, 20000); /* behind the wall */
    shade(&s);
    zt_sphere *moves = ball(&s);
    open(&r);
    warm_up(&r, &s.scene);
    s.lights[1] = s.lights[2];
    s.scene.light_count--;
    moves->center.y += 1;
    assert_in_range(reel_show(&r, &s.scene), REEL_TILES - 8, REEL_TILES - 1);
    reel_close(&r);
}

/* One thing goes that nobody saw, and the others are still told apart as before. */
static void things_keep_their_labels(void **state) {
    (void)state;
    static test_scene s;
    reel r;
    wall(&s);
    scene_sphere(&s, (vec3){0, 500, 60}, 1, 0);
    zt_object unseen = s.objects[1];
    s.objects[1] = s.objects[0];
    s.objects[0] = unseen;
    zt_sphere *moves = ball(&s);
    open(&r);
    warm_up(&r, &s.scene);
    s.objects[0].sphere.radius = 0;
    moves->center.y += 1;
    assert_in_range(reel_show(&r, &s.scene), REEL_TILES - 8, REEL_TILES - 1);
    reel_close(&r);
}

/* Dots lie across the border of two tiles: in the pixels at its left they miss the middles, in
 * those at its right they do not. A lid on the tile at the right hides them there; it goes, and
 * what was strange at the left is known. */
static void what_is_strange_depends_on_the_tile_beside(void **state) {
    (void)state;
    static test_scene s;
    reel r;
    wall(&s);
    int32_t dark = scene_material(&s, (vec3){0.1, 0.1, 0.1}, 0);
    for (int i = 0; i < 3; i++)
        scene_object(&s, ZT_SHAPE_BOX, dark)->box =
            (zt_block){{column_left + 0.2, 4.5 + 4 * i, -19.5}, {1, 0.4, 0.5}, {1, 0, 0, 0}};
    zt_object *lid = scene_object(&s, ZT_SHAPE_BOX, 0);
    lid->box = (zt_block){{column_left + 8, 8, -18}, {15.9, 15.9, 0.5}, {1, 0, 0, 0}};
    open(&r);
    warm_up(&r, &s.scene);
    for (int i = 0; i < 4; i++) {
        lid->box.center.z = i % 2 ? -18 : 40; /* behind the camera */
        assert_in_range(reel_show(&r, &s.scene), REEL_TILES - 4, REEL_TILES - 1);
    }
    reel_close(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shadows_end_where_lamps_do),
        cmocka_unit_test(lamps_keep_their_labels),
        cmocka_unit_test(things_keep_their_labels),
        cmocka_unit_test(what_is_strange_depends_on_the_tile_beside),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
