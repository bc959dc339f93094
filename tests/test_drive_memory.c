/* Shows that reading and freezing what is driven survive the failure of every single
 * allocation: the status says so, and nothing is lost nor freed twice (under the tools that
 * look for that).
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "descriptions.h"

/* How many more allocations succeed; negative: all. */
static atomic_llong left = -1;
static atomic_bool failed;

static bool may(void) {
    long long now = atomic_load(&left);
    if (now < 0) return true;
    if (now > 0) atomic_store(&left, now - 1);
    if (now == 0) atomic_store(&failed, true);
    return now > 0;
}

/* Pieces of arenas, which rarely need a new chunk: the linker puts these in their place. */
void *__real_zt_arena_push_array(zt_arena *arena, size_t element_size, size_t count);
void *__wrap_zt_arena_push_array(zt_arena *arena, size_t element_size, size_t count);
char *__real_zt_arena_push_text(zt_arena *arena, const char *text, size_t length);
char *__wrap_zt_arena_push_text(zt_arena *arena, const char *text, size_t length);

void *__wrap_zt_arena_push_array(zt_arena *arena, size_t element_size, size_t count) {
    return may() ? __real_zt_arena_push_array(arena, element_size, count) : NULL;
}
char *__wrap_zt_arena_push_text(zt_arena *arena, const char *text, size_t length) {
    return may() ? __real_zt_arena_push_text(arena, text, length) : NULL;
}

#ifndef __SANITIZE_ADDRESS__ /* which has allocations of its own */
void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *old, size_t size);
void *__libc_memalign(size_t alignment, size_t size);

void *malloc(size_t size) { return may() ? __libc_malloc(size) : NULL; }
void *calloc(size_t count, size_t size) { return may() ? __libc_calloc(count, size) : NULL; }
void *realloc(void *old, size_t size) { return may() ? __libc_realloc(old, size) : NULL; }
void *aligned_alloc(size_t alignment, size_t size) {
    return may() ? __libc_memalign(alignment, size) : NULL;
}
#endif

static const char film_text[] =
    "zoetrope: 1\nfilm: { duration: 4 s }\n"
    "camera: { position: { orbit: { around: ball, radius: 5, period: 4 s } }, look_at: ball }\n"
    "variables: { big: 2 }\n"
    "lights:\n"
    "  - point: { position: { offset: { from: ball.center } }, intensity: \"= big + "
    "ball.radius\" "
    "}\n"
    "objects:\n"
    "  - sphere: { name: ball, radius: \"= 1 + t\", center: { follow: { ease: \"steps(3)\",\n"
    "              path: [[0, 0, 0], [1, 0, 0], [1, 1, 1]] } } }\n";

static zt_status read_and_freeze(void) {
    zt_animation *animation;
    zt_status status =
        zt_animation_read(&animation, "film.yaml", NULL, 0, (zt_listener){NULL, NULL});
    if (status != ZT_OK) {
        assert_null(animation);
        return status;
    }
    zt_arena arena = {0};
    zt_scene scene;
    status = zt_animation_freeze(&scene, animation, 1, &arena, (zt_listener){NULL, NULL});
    zt_arena_free(&arena);
    zt_animation_free(&animation);
    return status;
}

/* With none, one, two ... allocations. */
static void every_allocation_fails(void **state) {
    (void)state;
    write_bytes("film.yaml", film_text, sizeof film_text - 1);
    assert_int_equal(read_and_freeze(), ZT_OK); /* and Lua stays loaded */
    int count = 0;
    for (bool done = false; !done; count++) {
        atomic_store(&failed, false);
        atomic_store(&left, count);
        zt_status status = read_and_freeze();
        atomic_store(&left, -1);
        done = !atomic_load(&failed);
        /* Lua tries again after it has collected what it does not need. */
        if (status == ZT_OK && !done) continue;
        if (status != (done ? ZT_OK : ZT_EMEMORY) && !(status == ZT_EFILE && count < 100))
            fail_msg("%s after %d allocations", zt_status_text(status), count);
    }
    assert_true(count > 50);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_allocation_fails)};
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
