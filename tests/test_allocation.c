/* After its first frames a film allocates nothing more: memory is sorted by lifetime, and the
 * arenas of a frame are used again. All allocations of the process are counted. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include <zoetrope/renderer.h>

#include "descriptions.h"

#if defined __SANITIZE_ADDRESS__ /* has allocations of its own */
int main(void) { return 77; }
#else

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *old, size_t size);
void *__libc_memalign(size_t alignment, size_t size);

static atomic_llong allocation_count;

void *malloc(size_t size) {
    atomic_fetch_add(&allocation_count, 1);
    return __libc_malloc(size);
}
void *calloc(size_t count, size_t size) {
    atomic_fetch_add(&allocation_count, 1);
    return __libc_calloc(count, size);
}
void *realloc(void *old, size_t size) {
    atomic_fetch_add(&allocation_count, 1);
    return __libc_realloc(old, size);
}
void *aligned_alloc(size_t alignment, size_t size) {
    atomic_fetch_add(&allocation_count, 1);
    return __libc_memalign(alignment, size);
}

static const char film_text[] =
    "zoetrope: 1\n"
    "film: { size: [64, 48], duration: 24 }\n"
    "camera: { position: { keys: { 0: [0, 2, 6], 23: [1, 2, 5] } }, look_at: [0, 1, 0] }\n"
    "lights:\n"
    "  - ambient: { intensity: 0.2 }\n"
    "  - point: { position: { keys: { 0: [3, 4, 3], 23: [-3, 4, 3] } }, intensity: 20 }\n"
    "objects:\n"
    "  - plane: { normal: [0, 1, 0], material: { reflectivity: 0.5 } }\n"
    "  - group:\n"
    "      rotation: { keys: { 0: [0, 0, 0], 23: [0, 120, 0] } }\n"
    "      objects:\n"
    "        - sphere: { center: [1, 1, 0], radius: { keys: { 0: 0, 5: 0.5, 20: 0.6 } } }\n";

/* Freezing, preparing and rendering, on two threads. Things that appear (a radius of zero has
 * nothing to hit) cost no allocation either. */
static void test_steady_state(void **state) {
    (void)state;
    zt_animation *animation = animation_of(film_text);
    zt_renderer *renderer;
    zt_image *image;
    zt_render_settings settings = {.threads = 2};
    assert_int_equal(zt_renderer_open(&renderer, animation, &settings, (zt_listener){0}),
                     ZT_OK);
    assert_int_equal(zt_image_create(&image, 64, 48), ZT_OK);
    long long before = atomic_load(&allocation_count);
    assert_true(before > 0); /* they are counted */
    for (int64_t frame = 0; frame < 3; frame++)
        assert_int_equal(zt_renderer_frame(renderer, frame, image, NULL), ZT_OK);
    before = atomic_load(&allocation_count);
    for (int64_t frame = 3; frame < 24; frame++)
        assert_int_equal(zt_renderer_frame(renderer, frame, image, NULL), ZT_OK);
    assert_int_equal(atomic_load(&allocation_count) - before, 0);
    zt_image_free(&image);
    zt_renderer_close(&renderer);
    zt_animation_free(&animation);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_steady_state)};
    return cmocka_run_group_tests(tests, files_begin, files_end);
}

#endif
