/* Shows what the program does as a person meets it: what it prints where, how it ends, what it
 * leaves behind. Each test works in a new directory of its own. */
#include <fcntl.h>
#include <pty.h>
#include <setjmp.h>
#include <signal.h>
#include <spawn.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>

#include "files.h"

enum { TEXT_MAX = 16 * 1024, ARGUMENTS_MAX = 12 };

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

static void write_text(const char *path, const char *text) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static void read_text(char text[TEXT_MAX], const char *path) {
    FILE *file = fopen(path, "r");
    if (!file) fail_msg("%s is missing", path);
    text[fread(text, 1, TEXT_MAX - 1, file)] = '\0';
    fclose(file);
}

/* Starts the program with signals as a shell at a terminal leaves them. */
static pid_t start(const posix_spawn_file_actions_t *actions, const char *arguments) {
    char copy[512], *argv[ARGUMENTS_MAX] = {(char *)"zoetrope"};
    char *environment[] = {(char *)"TERM=xterm",
                           (char *)"ASAN_OPTIONS=allocator_may_return_null=1", NULL};
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
    assert_int_equal(
        posix_spawn(&pid, ZT_TEST_PROGRAM, actions, &attributes, argv, environment), 0);
    posix_spawnattr_destroy(&attributes);
    return pid;
}

static int finish(pid_t pid) {
    int status;
    assert_int_equal(waitpid(pid, &status, 0), pid);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
}

/* Runs the program with arguments that blanks divide. */
static run *zoetrope(const char *arguments) {
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

static void assert_contains(const char *text, const char *part) {
    if (!strstr(text, part)) fail_msg("\"%s\" is not in: %s", part, text);
}

static void zoetrope_succeeds(const char *arguments) {
    run *r = zoetrope(arguments);
    if (r->code != 0) fail_msg("zoetrope %s ended with %d: %s", arguments, r->code, r->err);
}

static int enter_directory(void **state) {
    char *directory = strdup("/tmp/zoetrope-cli-XXXXXX");
    if (!directory || !mkdtemp(directory) || chdir(directory) != 0) return -1;
    write_text("film.yaml", film);
    *state = directory;
    return 0;
}

static int leave_directory(void **state) {
    char *directory = *state;
    int failed = chdir("/") || nftw(directory, files_remove, 8, FTW_DEPTH | FTW_PHYS);
    free(directory);
    return failed;
}

/* Help and version are results: on standard output, successful. */
static void help_and_version(void **state) {
    (void)state;
    run *r = zoetrope("--version");
    assert_int_equal(r->code, 0);
    assert_string_equal(r->out, "zoetrope 0.1.0\n");
    r = zoetrope("--help");
    assert_int_equal(r->code, 0);
    assert_string_equal(r->err, "");
    const char *words[] = {"render", "frame", "preview", "check", "--size", "--version"};
    for (int i = 0; i < 6; i++) assert_contains(r->out, words[i]);
    r = zoetrope("check -h");
    assert_int_equal(r->code, 0);
    assert_contains(r->out, "zoetrope check FILE");
    assert_null(strstr(r->out, "--size")); /* which check does not take */
    r = zoetrope("render film.yaml --help");
    assert_int_equal(r->code, 0);
    assert_contains(r->out, "frames.####.png");
    r = zoetrope("");
    assert_int_equal(r->code, 2);
    assert_string_equal(r->out, "");
    assert_contains(r->err, "Usage: zoetrope");
}

/* Each misuse is told in a sentence that helps on, ends with 2, and leaves nothing behind. */
static void misuse(void **state) {
    (void)state;
    const struct {
        const char *arguments, *told;
    } cases[] = {
        {"rendr film.yaml", "did you mean render?"},
        {"film.yaml", "did you mean render film.yaml?"},
        {"paint film.yaml", "unknown command paint"},
        {"render film.yaml --sise=4x4", "did you mean --size?"},
        {"render film.yaml --sam 4", "did you mean --samples?"},
        {"render film.yaml -x", "unknown option -x"},
        {"render", "render needs FILE"},
        {"frame film.yaml", "frame needs FILE N"},
        {"frame film.yaml x", "x is not the number of a frame"},
        {"frame film.yaml 1x", "1x is not the number of a frame"},
        {"frame film.yaml 6", "no frame 6: the film has frames 0 to 5"},
        {"frame film.yaml 99999999999999999999", "is not the number of a frame"},
        {"render film.yaml other.yaml", "one word too many: other.yaml"},
        {"render film.yaml -- --quiet", "one word too many: --quiet"},
        {"check film.yaml --size=4x4", "check takes no --size"},
        {"frame film.yaml 1 --frames 1-2", "frame takes no --frames"},
        {"render film.yaml --quiet=yes", "--quiet takes no value"},
        {"render film.yaml -o", "--output needs a value"},
        {"render film.yaml --output=", "--output needs a value"},
        {"render film.yaml --size 640", "--size 640: must be"},
        {"render film.yaml --size 0x4", "--size 0x4: must be"},
        {"render film.yaml --size 4x4x4", "--size 4x4x4: must be"},
        {"render film.yaml --size 65537x4", "65536"},
        {"render film.yaml --threads 0", "--threads 0: must be a number from 1"},
        {"render film.yaml --samples -4", "--samples -4: must be a number from 1"},
        {"render film.yaml --samples 4.5", "--samples 4.5: must be a number from 1"},
        {"render film.yaml --frames 3-2", "--frames 3-2: must be"},
        {"render film.yaml --frames 3-", "--frames 3-: must be"},
        {"render film.yaml --frames -3", "--frames -3: must be"},
        {"render film.yaml --frames 4-6", "no frame 6: the film has frames 0 to 5"},
        {"render film.yaml --size 33x18 -o film.mp4", "33"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run *r = zoetrope(cases[i].arguments);
        if (r->code != 2) fail_msg("zoetrope %s ended with %d", cases[i].arguments, r->code);
        assert_contains(r->err, cases[i].told);
        assert_contains(r->err, "zoetrope: error: ");
        assert_string_equal(r->out, "");
    }
    assert_int_equal(entry_count("."), 1); /* film.yaml alone */
}

/* Mistakes in the description: all told, each with its place; 1; nothing written. */
static void mistakes(void **state) {
    (void)state;
    write_text("wrong.yaml", "zoetrope: 1\n"
                             "film: { size: [64, 36], rate: 24, duration: 1 s }\n"
                             "camera: { position: [0, 1, 6] }\n"
                             "objects:\n"
                             "  - sphere: { raduis: 1, center: [0, 0, 0] }\n"
                             "  - spere: { radius: 1, center: [0, 0, 0] }\n");
    const char *commands[] = {"render wrong.yaml", "frame wrong.yaml 0", "preview wrong.yaml",
                              "check wrong.yaml", "render wrong.yaml --quiet -o new/x.png"};
    for (int i = 0; i < 5; i++) {
        run *r = zoetrope(commands[i]);
        assert_int_equal(r->code, 1);
        assert_contains(r->err, "wrong.yaml:5:15: error: ");
        assert_contains(r->err, "\"radius\"");
        assert_contains(r->err, "wrong.yaml:6:5: error: ");
        assert_contains(r->err, "      |               ^~~~~~");
        assert_string_equal(r->out, "");
    }
    assert_int_equal(entry_count("."), 2);
}

/* What the world refuses is told with its name, and ends with 3. */
static void refusals(void **state) {
    (void)state;
    run *r = zoetrope("render missing.yaml");
    assert_int_equal(r->code, 3);
    assert_contains(r->err, "missing.yaml");
    r = zoetrope("frame film.yaml 0 -o film.yaml/image.png");
    assert_int_equal(r->code, 3);
    assert_contains(r->err, "film.yaml/image.png");
    r = zoetrope("render film.yaml -o film.xyz");
    assert_int_equal(r->code, 3);
    assert_contains(r->err, "film.xyz");
    assert_int_equal(entry_count("."), 1);
}

/* Check prints what is in the film, on standard output. */
static void check(void **state) {
    (void)state;
    run *r = zoetrope("check film.yaml");
    assert_int_equal(r->code, 0);
    assert_string_equal(r->err, "");
    assert_string_equal(r->out, "size       64 x 36\n"
                                "rate       6 frames a second\n"
                                "frames     6 (0 to 5)\n"
                                "duration   1 s\n"
                                "view       srgb\n"
                                "samples    1 a pixel\n"
                                "objects    1 plane, 1 sphere\n"
                                "triangles  0\n"
                                "lights     1 point\n"
                                "materials  1\n"
                                "moves      ball.center  smooth, 2 keys, 0 s to 1 s\n");
    assert_int_equal(entry_count("."), 1);
}

/* The n-th line of a text, without its newline; "" where there are not so many. */
static const char *line_of(char line[256], const char *text, int n) {
    for (; n > 0 && *text; n--) text += strcspn(text, "\n") + (strchr(text, '\n') != NULL);
    snprintf(line, 256, "%.*s", (int)strcspn(text, "\n"), text);
    return line;
}

/* Checksums show that --frames chooses frames without changing them, that --threads changes
 * nothing, that --size and --samples do, and that preview is a quarter of the size. */
static void settings(void **state) {
    (void)state;
    char all[TEXT_MAX], some[TEXT_MAX], a[256], b[256];
    zoetrope_succeeds("render film.yaml -o all.hash");
    read_text(all, "all.hash");
    assert_string_not_equal(line_of(a, all, 5), "");
    assert_string_equal(line_of(a, all, 6), "");
    assert_contains(line_of(a, all, 0), "64x36");

    zoetrope_succeeds("render --frames=2-3 film.yaml --output some.hash --threads 3");
    read_text(some, "some.hash");
    assert_string_equal(line_of(a, some, 0), line_of(b, all, 2));
    assert_string_equal(line_of(a, some, 1), line_of(b, all, 3));
    assert_string_equal(line_of(a, some, 2), "");
    assert_string_not_equal(line_of(a, all, 2), line_of(b, all, 3));
    zoetrope_succeeds("render film.yaml --frames 5 --threads 1 -osome.hash");
    read_text(some, "some.hash");
    assert_string_equal(line_of(a, some, 0), line_of(b, all, 5));
    assert_string_equal(line_of(a, some, 1), "");
    zoetrope_succeeds("-q frame film.yaml 4 -o one.hash");
    read_text(some, "one.hash");
    assert_string_equal(line_of(a, some, 0), line_of(b, all, 4));

    zoetrope_succeeds("render film.yaml --frames 0 --samples 2 -o some.hash");
    read_text(some, "some.hash");
    assert_string_not_equal(line_of(a, some, 0), line_of(b, all, 0));
    zoetrope_succeeds("render film.yaml --frames 0 --size 31x17 -o some.hash");
    read_text(some, "some.hash");
    assert_contains(line_of(a, some, 0), "31x17");
    zoetrope_succeeds("preview film.yaml --frames 0 -o some.hash");
    read_text(some, "some.hash");
    assert_contains(line_of(a, some, 0), "16x10"); /* 9 rows made even */
}

/* Where images go by default; what is told of it, and what is not when quiet. */
static void default_targets(void **state) {
    (void)state;
    run *r = zoetrope("render film.yaml");
    assert_int_equal(r->code, 0);
    assert_contains(r->err, "output/film.mp4: 6 frames in ");
    assert_null(strpbrk(r->err, "\r\033")); /* which are for terminals */
    assert_true(exists("output/film.mp4"));
    r = zoetrope("frame film.yaml 3 --quiet");
    assert_int_equal(r->code, 0);
    assert_string_equal(r->err, "");
    assert_string_equal(r->out, "");
    assert_true(exists("output/film.0003.png"));
    zoetrope_succeeds("preview ./film.yaml");
    assert_true(exists("output/film.preview.mp4"));
    assert_int_equal(entry_count("output"), 3);
    zoetrope_succeeds("render film.yaml -o stills/f.###.png");
    assert_true(exists("stills/f.000.png") && exists("stills/f.005.png"));
    assert_int_equal(entry_count("stills"), 6);
}

/* Standard streams that are closed or full: results that cannot be printed are told; images are
 * not mixed up with messages. */
static void closed_streams(void **state) {
    (void)state;
    char plain[TEXT_MAX], silent[TEXT_MAX], err[TEXT_MAX];
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 2, "err", O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_addclose(&actions, 1);
    assert_int_equal(finish(start(&actions, "check film.yaml")), 3);
    read_text(err, "err");
    assert_contains(err, "cannot write to standard output: ");
    assert_int_equal(finish(start(&actions, "--help")), 3);
    posix_spawn_file_actions_addopen(&actions, 1, "/dev/full", O_WRONLY, 0);
    assert_int_equal(finish(start(&actions, "check film.yaml")), 3);
    posix_spawn_file_actions_destroy(&actions);

    zoetrope_succeeds("render film.yaml -o plain.hash");
    posix_spawn_file_actions_init(&actions);
    for (int fd = 0; fd <= 2; fd++) posix_spawn_file_actions_addclose(&actions, fd);
    assert_int_equal(finish(start(&actions, "render film.yaml -o silent.hash")), 0);
    posix_spawn_file_actions_destroy(&actions);
    read_text(plain, "plain.hash");
    read_text(silent, "silent.hash");
    assert_string_equal(plain, silent);
}

/* How many frames a player gets out of a movie. */
static int decoded_frame_count(const char *path) {
    AVFormatContext *container = NULL;
    assert_int_equal(avformat_open_input(&container, path, NULL, NULL), 0);
    assert_true(avformat_find_stream_info(container, NULL) >= 0);
    const AVCodec *codec = NULL;
    int stream = av_find_best_stream(container, AVMEDIA_TYPE_VIDEO, -1, -1, &codec, 0);
    assert_true(stream >= 0);
    AVCodecContext *decoder = avcodec_alloc_context3(codec);
    avcodec_parameters_to_context(decoder, container->streams[stream]->codecpar);
    assert_int_equal(avcodec_open2(decoder, codec, NULL), 0);
    AVPacket *packet = av_packet_alloc();
    AVFrame *frame = av_frame_alloc();
    int count = 0;
    for (bool more = true; more;) {
        more = av_read_frame(container, packet) >= 0;
        assert_int_equal(avcodec_send_packet(decoder, more ? packet : NULL), 0);
        while (avcodec_receive_frame(decoder, frame) == 0) count++;
        av_packet_unref(packet);
    }
    av_frame_free(&frame);
    av_packet_free(&packet);
    avcodec_free_context(&decoder);
    avformat_close_input(&container);
    return count;
}

/* Renders a film of hours with standard error on a terminal, sends a signal once progress is
 * seen there, and returns the exit code and what the terminal showed. */
static int interrupt(char shown[TEXT_MAX], const char *arguments, int signal_number) {
    int terminal, its_end;
    assert_int_equal(openpty(&terminal, &its_end, NULL, NULL, NULL), 0);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, its_end, 2);
    posix_spawn_file_actions_addclose(&actions, its_end);
    posix_spawn_file_actions_addclose(&actions, terminal);
    pid_t pid = start(&actions, arguments);
    posix_spawn_file_actions_destroy(&actions);
    close(its_end);
    bool sent = false;
    size_t length = 0;
    for (ssize_t got; (got = read(terminal, shown + length, TEXT_MAX - 1 - length)) > 0;) {
        length += (size_t)got;
        shown[length] = '\0';
        if (!sent && strstr(shown, " left")) {
            sent = kill(pid, signal_number) == 0;
            kill(pid, signal_number); /* twice at once, as timeout(1) does */
        }
    }
    close(terminal);
    return finish(pid);
}

/* An interrupted film is closed properly: it plays, and holds as many frames as was said. */
static void interrupts(void **state) {
    (void)state;
    char shown[TEXT_MAX], text[sizeof film + 16];
    const char *at = strstr(film, "1 s");
    snprintf(text, sizeof text, "%.*s36000 s%s", (int)(at - film), film, at + 3);
    write_text("long.yaml", text);
    const int signals[] = {SIGINT, SIGTERM};
    for (int i = 0; i < 2; i++) {
        assert_int_equal(interrupt(shown, "render long.yaml -o long.mp4", signals[i]), 130);
        assert_contains(shown, "\r\033[K"); /* the line of progress was rewritten */
        const char *said = strstr(shown, "interrupted: long.mp4 has the first ");
        assert_non_null(said);
        int count = 0, total = 0;
        assert_int_equal(
            sscanf(said, "interrupted: long.mp4 has the first %d of %d", &count, &total), 2);
        assert_in_range(count, 1, total - 1);
        assert_int_equal(total, 36000 * 6);
        assert_int_equal(decoded_frame_count("long.mp4"), count);
        assert_int_equal(entry_count("."), 3); /* nothing unfinished is left */
        unlink("long.mp4");
        write_text("long.mp4", ""); /* to be replaced the second time */
    }
}

int main(void) {
#define IN_DIRECTORY(test)                                                                     \
    cmocka_unit_test_setup_teardown(test, enter_directory, leave_directory)
    const struct CMUnitTest tests[] = {
        IN_DIRECTORY(help_and_version), IN_DIRECTORY(misuse),         IN_DIRECTORY(mistakes),
        IN_DIRECTORY(refusals),         IN_DIRECTORY(check),          IN_DIRECTORY(settings),
        IN_DIRECTORY(default_targets),  IN_DIRECTORY(closed_streams), IN_DIRECTORY(interrupts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
