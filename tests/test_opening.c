/* The first frame is rendered while the output is being opened: what cannot be written is
 * refused all the same, at once and with nothing left behind, and what comes of it is no other
 * film. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include "program.h"

/* An order of frames that take hours is refused within a minute, by one error, and nothing
 * comes to be. */
static void assert_refused_at_once(const char *program, const char *command, const char *target,
                                   int code, const char *told) {
    char arguments[256];
    snprintf(arguments, sizeof arguments, "%s --size 1920x1080 --samples 65536 -o %s", command,
             target);
    const int before = entry_count(".");
    tested_program = program;
    alarm(60);
    run *r = zoetrope(arguments);
    alarm(0);
    tested_program = ZT_TEST_PROGRAM;
    assert_contains(r->err, told);
    assert_int_equal(r->code, code);
    assert_null(strstr(strstr(r->err, "error: ") + 1, "error: "));
    assert_int_equal(entry_count("."), before);
}

/* What only an encoder or the disk knows. */
static void wrong_wishes(void **state) {
    (void)state;
    assert_refused_at_once(ZT_TEST_PROGRAM, "render film.yaml",
                           "film.mp4 --encoder-option aq-mode=seven", 2,
                           "encoder-option aq-mode=seven: ");
    assert_refused_at_once(ZT_TEST_PROGRAM, "frame film.yaml 3", "film.yaml/image.png", 3,
                           "cannot write film.yaml/image.png");
}

/* A program whose modules are gone. */
static void missing_modules(void **state) {
    (void)state;
    assert_int_equal(mkdir("alone", 0700), 0);
    assert_int_equal(system("cp " ZT_TEST_PROGRAM " alone/zoetrope"), 0);
    assert_refused_at_once("alone/zoetrope", "render film.yaml", "film.mp4", 3,
                           "a movie cannot be had, as zoetrope-video.so cannot be loaded: ");
    assert_refused_at_once(
        "alone/zoetrope", "render film.yaml", "film.####.png", 3,
        "image files cannot be had, as zoetrope-image_file.so cannot be loaded: ");
}

static int64_t size_of(const char *path) {
    struct stat there;
    return stat(path, &there) == 0 ? there.st_size : 0;
}

/* Of a run that was killed when an encoder had kept its first frame, which took long, and
 * nothing else was known: that frame is not wanted any more, and those behind it are as they
 * would be. */
static void first_frame_is_there(void **state) {
    (void)state;
    static const char command[] = "render film.yaml --size 320x180 --samples 256 -o ";
    char arguments[128];
    snprintf(arguments, sizeof arguments, "%swhole.mp4", command);
    zoetrope_succeeds(arguments);
    snprintf(arguments, sizeof arguments, "%sfilm.mp4", command);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
    pid_t pid = start(&actions, arguments);
    posix_spawn_file_actions_destroy(&actions);
    int status;
    while (size_of("film.mp4.part.frames") == 0 && waitpid(pid, &status, WNOHANG) == 0)
        nanosleep(&(struct timespec){0, 1000000}, NULL);
    assert_int_equal(kill(pid, SIGKILL), 0);
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_true(WIFSIGNALED(status));
    zoetrope_succeeds(arguments);
    assert_true(same_files("whole.mp4", "film.mp4"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        IN_DIRECTORY(wrong_wishes),
        IN_DIRECTORY(missing_modules),
        IN_DIRECTORY(first_frame_is_there),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
