/* For tests that write files: a directory that goes away again, a full disk, what was told, and
 * what a library printed although it must not. cmocka.h comes first. */
#ifndef ZT_TESTS_FILES_H
#define ZT_TESTS_FILES_H

#include <dirent.h>
#include <ftw.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <zoetrope/image.h>
#include <zoetrope/status.h>

/* What a listener heard: how many errors, and the last one; before the first, what was said
 * last. */
typedef struct heard {
    int error_count;
    char text[2048];
} heard;

static inline void hear(void *user, const zt_message *message) {
    heard *h = user;
    if (message->severity == ZT_ERROR) h->error_count++;
    if (message->severity == ZT_ERROR || h->error_count == 0)
        snprintf(h->text, sizeof h->text, "%s", message->text);
}

static inline zt_listener listener_of(heard *h) {
    *h = (heard){0};
    return (zt_listener){hear, h};
}

/* Exactly one error was told, and it has these words in it. */
static inline void assert_told(const heard *h, const char *words) {
    if (h->error_count != 1 || !strstr(h->text, words))
        fail_msg("%d errors, the last one \"%s\", without \"%s\"", h->error_count, h->text,
                 words);
}

/* Setup and teardown of a group: its tests run in a directory of their own, with the standard
 * error kept in a file, which must be empty at the end: a library does not print. */
static char files_home[4096], files_directory[] = "/tmp/zoetrope-test-XXXXXX";
static int files_stderr;

static inline int files_begin(void **state) {
    (void)state;
    if (!getcwd(files_home, sizeof files_home) || !mkdtemp(files_directory)) return 1;
    if (chmod(files_directory, 0777) != 0 || chdir(files_directory) != 0) return 1;
    files_stderr = dup(2);
    return freopen("stderr.txt", "w", stderr) ? 0 : 1;
}

static inline int files_remove(const char *path, const struct stat *s, int kind,
                               struct FTW *ftw) {
    (void)s, (void)kind, (void)ftw;
    return remove(path);
}

static inline int files_end(void **state) {
    (void)state;
    fflush(stderr);
    dup2(files_stderr, 2);
    FILE *printed = fopen("stderr.txt", "r");
    bool silent = printed != NULL;
    for (int c; printed && (c = fgetc(printed)) != EOF; silent = false) fputc(c, stderr);
    if (printed) fclose(printed);
    bool gone = chdir(files_home) == 0 &&
                nftw(files_directory, files_remove, 8, FTW_DEPTH | FTW_PHYS) == 0;
    /* cmocka tells of a group's teardown that failed, but counts it for nothing. */
    if (!gone || !silent) exit(EXIT_FAILURE);
    return 0;
}

/* No file of this process grows beyond `size` bytes from here on, as on a full disk; 0: any. */
static inline void disk_has(rlim_t size) {
    signal(SIGXFSZ, SIG_IGN);
    struct rlimit limit;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
    limit.rlim_cur = size ? size : limit.rlim_max;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
}

static inline bool exists(const char *path) { return access(path, F_OK) == 0; }

/* How many entries a directory has, not counting . and .. */
static inline int entry_count(const char *path) {
    DIR *directory = opendir(path);
    assert_non_null(directory);
    int count = 0;
    for (struct dirent *e; (e = readdir(directory));)
        count += strcmp(e->d_name, ".") != 0 && strcmp(e->d_name, "..") != 0;
    closedir(directory);
    return count;
}

/* The whole file, of the caller to free, with a 0 behind it. */
static inline char *file_bytes(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    if (!file) fail_msg("no file %s", path);
    fseek(file, 0, SEEK_END);
    *size = (size_t)ftell(file);
    rewind(file);
    char *bytes = calloc(1, *size + 1);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    fclose(file);
    return bytes;
}

static inline bool same_files(const char *a, const char *b) {
    size_t a_size, b_size;
    char *a_bytes = file_bytes(a, &a_size), *b_bytes = file_bytes(b, &b_size);
    bool same = a_size == b_size && memcmp(a_bytes, b_bytes, a_size) == 0;
    free(a_bytes);
    free(b_bytes);
    return same;
}

/* A picture whose every pixel differs from its neighbours and from the other frames'. */
static inline zt_image *picture(int width, int height, int frame) {
    zt_image *image;
    assert_int_equal(zt_image_create(&image, width, height), ZT_OK);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            float *pixel = image->pixels + 4 * ((size_t)y * (size_t)width + (size_t)x);
            pixel[0] = ((float)x + 0.5f) / (float)width;
            pixel[1] = ((float)y + 0.5f) / (float)height;
            pixel[2] = (float)((x + y + frame) % 32) / 32;
        }
    return image;
}

#endif
