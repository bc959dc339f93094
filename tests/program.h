/* For tests that run the program as a person does: in a new directory that holds film.yaml, six
 * frames of 64 x 36 pixels. cmocka.h comes first. */
#ifndef ZT_TESTS_PROGRAM_H
#define ZT_TESTS_PROGRAM_H

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "files.h"

enum { TEXT_MAX = 16 * 1024, ARGUMENTS_MAX = 24 };

/* What a run of the program came to. */
typedef struct run {
    int code; /* its exit code, or 1000 + the signal that ended it */
    char out[TEXT_MAX], err[TEXT_MAX];
} run;

static const char film[] = "zoetrope: 1\n"
                           "film: { size: [64, 36], rate: 6, duration: 1 s }\n"
                           "camera: { position: [0, 1, 6], look_at: [0, 1, 0], fov: 40 deg }\n"
                           "materials:\n"
                           "  clay: { color: \"#c8553d\" }\n"
                           "lights:\n"
                           "  - point: { position: [2, 4, 2], intensity: 30 }\n"
                           "objects:\n"
                           "  - plane: { normal: [0, 1, 0], distance: 0, material: clay }\n"
                           "  - sphere:\n"
                           "      name: ball\n"
                           "      material: clay\n"
                           "      radius: 1\n"
                           "      center: { keys: { 0 s: [-2, 1, 0], 1 s: [2, 1, 0] } }\n";

static inline void write_text(const char *path, const char *text) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static inline void read_text(char text[TEXT_MAX], const char *path) {
    FILE *file = fopen(path, "r");
    if (!file) fail_msg("%s is missing", path);
    text[fread(text, 1, TEXT_MAX - 1, file)] = '\0';
    fclose(file);
}

/* Another one may be tested for a while. */
static const char *tested_program = ZT_TEST_PROGRAM;

/* Starts the program with signals as a shell at a terminal leaves them. */
static inline pid_t start(const posix_spawn_file_actions_t *actions, const char *arguments) {
    char copy[512], *argv[ARGUMENTS_MAX] = {(char *)"zoetrope"};
    char *environment[] = {
        (char *)"TERM=xterm", (char *)"ASAN_OPTIONS=allocator_may_return_null=1",
        (char *)"LSAN_OPTIONS=print_suppressions=0:suppressions=" ZT_TEST_SOURCE_DIR
                "/tests/leaks.txt",
        NULL};
    snprintf(copy, sizeof copy, "%s", arguments);
    char *rest = NULL;
    int count = 1;
    for (char *word = strtok_r(copy, " ", &rest); word; word = strtok_r(NULL, " ", &rest)) {
        assert_in_range(count, 1, ARGUMENTS_MAX - 2);
        argv[count++] = word;
    }
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
    sigset_t defaults;
    sigemptyset(&defaults);
    sigaddset(&defaults, SIGINT);
    sigaddset(&defaults, SIGTERM);
    posix_spawnattr_setsigdefault(&attributes, &defaults);
    pid_t pid;
    assert_int_equal(posix_spawn(&pid, tested_program, actions, &attributes, argv, environment),
                     0);
    posix_spawnattr_destroy(&attributes);
    return pid;
}

static inline int finish(pid_t pid) {
    int status;
    assert_int_equal(waitpid(pid, &status, 0), pid);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
}

/* Runs the program with arguments that blanks divide. */
static inline run *zoetrope(const char *arguments) {
    static run result;
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 1, ".out", O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_addopen(&actions, 2, ".err", O_WRONLY | O_CREAT | O_TRUNC, 0600);
    result.code = finish(start(&actions, arguments));
    posix_spawn_file_actions_destroy(&actions);
    read_text(result.out, ".out");
    read_text(result.err, ".err");
    unlink(".out");
    unlink(".err");
    return &result;
}

static inline void assert_contains(const char *text, const char *part) {
    if (!strstr(text, part)) fail_msg("\"%s\" is not in: %s", part, text);
}

static inline void zoetrope_succeeds(const char *arguments) {
    run *r = zoetrope(arguments);
    if (r->code != 0) fail_msg("zoetrope %s ended with %d: %s", arguments, r->code, r->err);
}

static inline int enter_directory(void **state) {
    char *directory = strdup("/tmp/zoetrope-cli-XXXXXX");
    if (!directory || !mkdtemp(directory) || chdir(directory) != 0) return -1;
    write_text("film.yaml", film);
    *state = directory;
    return 0;
}

static inline int leave_directory(void **state) {
    char *directory = *state;
    int failed = chdir("/") || nftw(directory, files_remove, 8, FTW_DEPTH | FTW_PHYS);
    free(directory);
    return failed;
}

/* Arguments that cannot be, what is told of them, and how that ends. */
typedef struct refusal {
    const char *arguments, *told;
    int code;
} refusal;

/* Each of them is refused so, with an error and nothing on standard output. */
static inline void assert_refused(const refusal *cases, size_t count) {
    for (const refusal *c = cases; c < cases + count; c++) {
        run *r = zoetrope(c->arguments);
        if (r->code != c->code)
            fail_msg("zoetrope %s ended with %d: %s", c->arguments, r->code, r->err);
        assert_contains(r->err, c->told);
        assert_contains(r->err, "zoetrope: error: ");
        assert_string_equal(r->out, "");
    }
}

/* The n-th line of a text, without its newline; "" where there are not so many. */
static inline const char *line_of(char line[256], const char *text, int n) {
    for (; n > 0 && *text; n--) text += strcspn(text, "\n") + (strchr(text, '\n') != NULL);
    snprintf(line, 256, "%.*s", (int)strcspn(text, "\n"), text);
    return line;
}

/* A test that has such a directory. */
#define IN_DIRECTORY(test)                                                                     \
    cmocka_unit_test_setup_teardown(test, enter_directory, leave_directory)

#endif
