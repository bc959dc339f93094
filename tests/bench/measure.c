#include "measure.h"

#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { PATH_SIZE = 512, COPIES_MAX = 8, ARGUMENTS_MAX = 48 };

static void tell(void *user, const zt_message *message) {
    (void)user;
    char text[2048];
    zt_message_format(text, sizeof text, message);
    fprintf(stderr, "%s\n", text);
}
const zt_listener to_stderr = {tell, NULL};

void must_be(bool good, const char *what) {
    if (good) return;
    fprintf(stderr, "bench: %s\n", what);
    exit(1);
}

void must(zt_status status, const char *what) {
    if (status != ZT_OK) fprintf(stderr, "bench: %s: ", what);
    must_be(status == ZT_OK, zt_status_text(status));
}

/* Time */

static double clock_s(clockid_t clock) {
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

spent spent_now(void) {
    return (spent){clock_s(CLOCK_MONOTONIC), clock_s(CLOCK_PROCESS_CPUTIME_ID)};
}
spent spent_less(spent a, spent b) { return (spent){a.wall_s - b.wall_s, a.cpu_s - b.cpu_s}; }
spent spent_since(spent start) { return spent_less(spent_now(), start); }
spent spent_per(spent a, double count) { return (spent){a.wall_s / count, a.cpu_s / count}; }

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values, int count) {
    qsort(values, (size_t)count, sizeof *values, compare);
    return (values[(count - 1) / 2] + values[count / 2]) / 2;
}

/* Threads that still look for work when theirs is done fall asleep. */
static void settle(void) { nanosleep(&(struct timespec){.tv_nsec = 2 * 1000 * 1000}, NULL); }

void race(runner *runners, int count, int rounds) {
    must_be(rounds <= ROUNDS_MAX, "too many rounds");
    double(*wall_s)[ROUNDS_MAX] = calloc((size_t)count, sizeof *wall_s);
    double(*cpu_s)[ROUNDS_MAX] = calloc((size_t)count, sizeof *cpu_s);
    must_be(wall_s && cpu_s, "out of memory");
    for (int round = rounds > 1 ? -1 : 0; round < rounds; round++)
        for (int i = 0; i < count; i++) {
            settle();
            spent s = runners[i].run(runners[i].user);
            if (round < 0) continue;
            wall_s[i][round] = s.wall_s;
            cpu_s[i][round] = s.cpu_s;
        }
    for (int i = 0; i < count; i++)
        runners[i].median = (spent){median(wall_s[i], rounds), median(cpu_s[i], rounds)};
    free(wall_s);
    free(cpu_s);
}

/* Programs */

static _Noreturn void become(char *const *arguments, int copy) {
    static char texts[ARGUMENTS_MAX][PATH_SIZE];
    char *own[ARGUMENTS_MAX + 1] = {NULL}, number[8];
    snprintf(number, sizeof number, "%d", copy);
    for (int i = 0; i < ARGUMENTS_MAX && arguments[i]; i++) {
        const char *mark = strstr(arguments[i], "%d");
        int before = mark ? (int)(mark - arguments[i]) : (int)strlen(arguments[i]);
        snprintf(texts[i], PATH_SIZE, "%.*s%s%s", before, arguments[i], mark ? number : "",
                 mark ? mark + 2 : "");
        own[i] = texts[i];
    }
    int silence = open("/dev/null", O_RDWR);
    for (int fd = 0; fd <= 2; fd++) dup2(silence, fd);
    signal(SIGINT, SIG_DFL);
    if (chdir(scratch()) == 0) execvp(own[0], own);
    _exit(127);
}

spent run_program(char *const *arguments, int copies) {
    pid_t children[COPIES_MAX];
    scratch();
    signal(SIGINT, SIG_IGN); /* ends the copies, and so us, with the scratch directory */
    fflush(NULL);
    double start = clock_s(CLOCK_MONOTONIC), cpu_s = 0;
    for (int i = 0; i < copies; i++) {
        children[i] = fork();
        must_be(children[i] >= 0, "no further process");
        if (children[i] == 0) become(arguments, i);
    }
    for (int i = 0; i < copies; i++) {
        int status;
        struct rusage usage;
        must_be(wait4(children[i], &status, 0, &usage) == children[i], "lost a process");
        if (status) fprintf(stderr, "bench: %s: ", arguments[0]);
        must_be(status == 0, "failed");
        cpu_s += (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
                 1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
    }
    signal(SIGINT, SIG_DFL);
    return (spent){clock_s(CLOCK_MONOTONIC) - start, cpu_s};
}

/* Films */

frames frames_open(const zt_animation *animation, zt_render_settings settings, int repeats) {
    frames f = {.repeats = repeats};
    settings.no_reuse = true; /* what is measured is rendering */
    must(zt_renderer_open(&f.renderer, animation, &settings, to_stderr), "a renderer");
    zt_output_format format = zt_renderer_format(f.renderer);
    must(zt_image_create(&f.image, format.width, format.height), "an image");
    return f;
}

void frames_close(frames *f) {
    zt_renderer_close(&f->renderer);
    zt_image_free(&f->image);
}

spent frames_run(void *user) {
    frames *f = user;
    if (f->isa)
        setenv("ZOETROPE_ISA", f->isa, 1);
    else
        unsetenv("ZOETROPE_ISA");
    spent start = spent_now();
    for (int i = 0; i < f->repeats; i++)
        must(zt_renderer_frame(f->renderer, f->next++, f->image, NULL), "a frame");
    return spent_per(spent_since(start), f->repeats);
}

const char documents_room[] =
    "lights:\n"
    "  - ambient: { intensity: 0.2 }\n"
    "  - point: { position: [2.5, 5, 4], intensity: 24 }\n"
    "  - point: { position: [-0.6, 3.6, 5.0], intensity: 7 }\n"
    "objects:\n"
    "  - plane: { normal: [0, 1, 0], distance: 0, material: mirror }\n"
    "  - plane: { normal: [1, 0, 0], distance: -3, material: mirror }\n"
    "  - plane: { normal: [0, 0, 1], distance: -3, material: matte }\n";

zt_animation *film_open(const char *name, const zt_override *overrides) {
    char path[PATH_SIZE];
    bool own = !strchr(name, '/');
    snprintf(path, sizeof path, "%s%s%s", own ? ZT_BENCH_SOURCE_DIR "/animations/" : "", name,
             own ? ".yaml" : "");
    int count = 0;
    while (overrides && overrides[count].name) count++;
    zt_animation *animation;
    must(zt_animation_read(&animation, path, overrides, count, to_stderr), path);
    return animation;
}

/* Files */

static char scratch_directory[PATH_SIZE];

static void remove_scratch(void) {
    DIR *directory = opendir(scratch_directory);
    for (struct dirent *entry; directory && (entry = readdir(directory));)
        unlinkat(dirfd(directory), entry->d_name, 0);
    if (directory) closedir(directory);
    rmdir(scratch_directory);
}

const char *scratch(void) {
    if (*scratch_directory) return scratch_directory;
    snprintf(scratch_directory, sizeof scratch_directory, "%s/zoetrope-bench-XXXXXX",
             access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp");
    must_be(mkdtemp(scratch_directory) != NULL, "no scratch directory");
    atexit(remove_scratch);
    return scratch_directory;
}

const char *scratch_path(const char *name) {
    static char paths[8][PATH_SIZE + 64];
    static int next;
    char *path = paths[next++ % 8];
    snprintf(path, sizeof paths[0], "%s/%s", scratch(), name);
    return path;
}

/* What is printed */

void print_title(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    printf("\n");
    vprintf(format, arguments);
    printf("\n");
    va_end(arguments);
}

void print_spent(const char *name, spent each) {
    printf("  %-38s %9.2f ms %9.2f ms of CPU", name, 1e3 * each.wall_s, 1e3 * each.cpu_s);
}

static const char *verdict(bool met) { return met ? "met" : "MISSED"; }

void print_ratio(double ratio, double reach) {
    printf("  x %-7.2f", ratio);
    if (reach > 0) printf(" at least %g: %s", reach, verdict(ratio >= reach));
    if (reach < 0) printf(" at most %g: %s", -reach, verdict(ratio <= -reach));
}

void print_limit(spent each, double limit_ms) {
    printf("  at most %g ms: %s", limit_ms, verdict(1e3 * each.wall_s <= limit_ms));
}

void print_end(void) {
    printf("\n");
    fflush(stdout);
}
