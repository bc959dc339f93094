/* Shows what is left when things around the program go away: standard streams, or the patience
 * of the person before it. */
#include <pty.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <time.h>

#include <cmocka.h>
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>

#include "program.h"

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
    if (openpty(&terminal, &its_end, NULL, NULL, NULL) != 0) {
        print_message("skipped: there are no pseudo-terminals here\n");
        skip();
    }
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

/* The film for as many seconds as `duration` says. */
static void write_longer(const char *path, const char *duration) {
    char text[sizeof film + 32];
    const char *at = strstr(film, "1 s"), *end = strstr(at + 3, "1 s"); /* it never rests */
    snprintf(text, sizeof text, "%.*s%s%.*s%s%s", (int)(at - film), film, duration,
             (int)(end - at - 3), at + 3, duration, end + 3);
    write_text(path, text);
}

/* Killed at any moment of what it takes, again and again, the same command ends with the same
 * file, and nothing is left beside it. */
static void kills(void **state) {
    (void)state;
    const char *const targets[] = {"film.mp4", "film.gif"};
    enum { KILLS = 8 };
    write_longer("longer.yaml", "16 s");
    for (int i = 0; i < 2; i++) {
        char whole[64], command[128];
        snprintf(whole, sizeof whole, "whole-%s", targets[i]);
        snprintf(command, sizeof command, "render longer.yaml --samples 256 -o %s", whole);
        struct timespec begun, done;
        clock_gettime(CLOCK_MONOTONIC, &begun);
        zoetrope_succeeds(command);
        clock_gettime(CLOCK_MONOTONIC, &done);
        double took_us = 1e6 * difftime(done.tv_sec, begun.tv_sec) +
                         1e-3 * (double)(done.tv_nsec - begun.tv_nsec);
        snprintf(command, sizeof command, "render longer.yaml --samples 256 -o %s", targets[i]);
        int killed_count = 0;
        for (int k = 0; k < KILLS; k++) { /* the first one long before it can be done */
            posix_spawn_file_actions_t actions;
            posix_spawn_file_actions_init(&actions);
            posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
            pid_t pid = start(&actions, command);
            posix_spawn_file_actions_destroy(&actions);
            usleep((useconds_t)(took_us * (k + 1) / (2 * KILLS)));
            kill(pid, SIGKILL);
            int status;
            assert_int_equal(waitpid(pid, &status, 0), pid);
            killed_count += WIFSIGNALED(status);
        }
        assert_true(killed_count > 0);
        zoetrope_succeeds(command);
        assert_true(same_files(whole, targets[i]));
        char part[80];
        snprintf(part, sizeof part, "%s.part", targets[i]);
        assert_false(exists(part));
    }
}

/* An interrupted film is closed properly: it plays, and holds as many frames as was said. */
static void interrupts(void **state) {
    (void)state;
    char shown[TEXT_MAX];
    write_longer("long.yaml", "36000 s");
    const int signals[] = {SIGINT, SIGTERM};
    for (int i = 0; i < 2; i++) {
        assert_int_equal(interrupt(shown, "render long.yaml -o long.mp4 --keep 0", signals[i]),
                         130);
        assert_contains(shown, "\r\033[K"); /* the line of progress was rewritten */
        const char *said = strstr(shown, "interrupted: long.mp4 has the first ");
        assert_non_null(said);
        int count = 0, total = 0;
        assert_int_equal(
            sscanf(said, "interrupted: long.mp4 has the first %d of %d", &count, &total), 2);
        assert_in_range(count, 1, total - 1);
        assert_int_equal(total, 36000 * 6);
        assert_int_equal(decoded_frame_count("long.mp4"), count);
        assert_int_equal(entry_count("."), 4); /* nothing unfinished is left: descriptions, the
                                                  film, its manifest */
        unlink("long.mp4");
        write_text("long.mp4", ""); /* to be replaced the second time */
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        IN_DIRECTORY(closed_streams),
        IN_DIRECTORY(kills),
        IN_DIRECTORY(interrupts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
