/* Shows that each kind of mistake is told in exactly the words, and at the place, that the
 * "# expect:" lines at the top of each file of tests/wrong say: all of them, in their order,
 * and nothing else. */
#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <unistd.h>

#include <cmocka.h>

#include <zoetrope/animation.h>

#include "told.h"

static const char begin[] = "# expect: ";

/* The expected lines of a file, as a listener hears them. */
static void read_expected(char *expected, size_t size, const char *path) {
    char line[1024];
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    *expected = '\0';
    while (fgets(line, sizeof line, file) && strncmp(line, begin, sizeof begin - 1) == 0) {
        size_t used = strlen(expected);
        assert_true(used + strlen(line) < size);
        memcpy(expected + used, line + sizeof begin - 1, strlen(line) - sizeof begin + 2);
    }
    fclose(file);
}

static void told_as_expected(void **state) {
    const char *path = *state;
    static char expected[64 * 1024];
    read_expected(expected, sizeof expected, path);
    if (!strstr(expected, "error: ")) fail_msg("%s expects no error", path);
    static told t;
    t = (told){.file = path};
    zt_animation *animation = (zt_animation *)state; /* must become NULL */
    assert_int_equal(zt_animation_read(&animation, path, NULL, 0, told_to(&t)),
                     ZT_EDESCRIPTION);
    assert_null(animation);
    assert_string_equal(t.lines, expected);
    assert_int_equal(t.foreign_count, 0);
}

static int is_description(const struct dirent *entry) {
    return strstr(entry->d_name, ".yaml") != NULL;
}

int main(void) {
    struct dirent **files;
    if (chdir(ZT_TEST_SOURCE_DIR "/tests/wrong") != 0) return 1;
    int count = scandir(".", &files, is_description, alphasort);
    if (count < 100) return 1; /* they have gone somewhere */
    struct CMUnitTest *tests = calloc((size_t)count, sizeof *tests);
    for (int i = 0; i < count; i++)
        tests[i] = (struct CMUnitTest){.name = files[i]->d_name,
                                       .test_func = told_as_expected,
                                       .initial_state = files[i]->d_name};
    int failed = _cmocka_run_group_tests("wrong", tests, (size_t)count, NULL, NULL);
    for (int i = 0; i < count; i++) free(files[i]);
    free(files);
    free(tests);
    return failed;
}
