/* Films that are edited and rendered again: frames are kept for it beside the target, tiles
 * that the edit cannot affect are copied from there, with the bits of rendering; as much is
 * kept as there is room for; and whatever happened to what was kept, the film is right. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <dirent.h>
#include <sys/stat.h>

#include "program.h"

#define TARGET "f.##.png"
#define KEPT   TARGET ".keepsakes"
#define RENDER "render film.yaml -o " TARGET " --samples 96 --threads 1 --stats --check-reuse"

/* The camera moves, so that nothing is copied from the frame before; %s: more things, and what
 * the small ball is like. */
static void write_film(const char *things, const char *material, int frames) {
    char text[2048];
    snprintf(
        text, sizeof text,
        "zoetrope: 1\n"
        "film: { size: [128, 64], rate: 6, duration: %d }\n"
        "camera: { position: { keys: { 0: [0, 1, 6], 6: [1, 1, 6] } }, look_at: [0, 1, 0] }\n"
        "materials:\n"
        "  clay: { color: \"#c8553d\" }\n"
        "  small: { color: %s }\n"
        "lights:\n"
        "  - point: { position: [2, 4, 2], intensity: 30 }\n"
        "objects:\n%s"
        "  - plane: { normal: [0, 1, 0], material: clay }\n"
        "  - sphere: { center: [-1, 1, 0], radius: 1, material: clay }\n"
        "  - sphere: { center: [3, 0.2, 0.5], radius: 0.2, material: small }\n",
        frames, material, things);
    write_text("film.yaml", text);
}

/* Renders what is missing, of which so many frames had been kept, and so many are kept then; at
 * least so many of a hundred of their tiles are copied. */
static const run *render(const char *arguments, int found, int least, int kept) {
    run *r = zoetrope(arguments);
    if (r->code != 0) fail_msg("it ended with %d: %s", r->code, r->err);
    if (strstr(r->err, "cannot")) fail_msg("%s", r->err);
    const char *line = strstr(r->out, "keepsakes");
    double share = 0;
    int was = 0, is = 0;
    if (line &&
        !sscanf(
            line,
            "keepsakes of %d frames as they were before: %lf %% of their tiles copied; %d in",
            &was, &share, &is))
        sscanf(line, "keepsakes %d in", &is);
    if (was != found || share < least || is != kept)
        fail_msg("%d found, %g %% copied, %d kept:\n%s", was, share, is, r->out);
    return r;
}

/* How many files a directory has, and how many bytes they hold. */
static int count_files(const char *path, int64_t *size) {
    int count = 0;
    DIR *directory = opendir(path);
    *size = 0;
    if (!directory) return 0;
    for (struct dirent *d; (d = readdir(directory));) {
        struct stat there;
        assert_int_equal(fstatat(dirfd(directory), d->d_name, &there, 0), 0);
        if (!S_ISREG(there.st_mode)) continue;
        count++;
        *size += there.st_size;
    }
    closedir(directory);
    return count;
}

static const char ball[] =
    "  - sphere: { center: [2.4, 0.2, 0.5], radius: 0.2, material: small }\n";

/* A colour, a thing that comes before all others, and goes: most is copied each time, and then
 * nothing is rendered at all; as without the frames that were kept. */
static void edits_are_cheap(void **state) {
    (void)state;
    write_film("", "red", 6);
    render(RENDER, 0, 0, 6);
    write_film("", "blue", 6);
    render(RENDER, 6, 70, 6);
    write_film(ball, "blue", 6);
    render(RENDER, 6, 70, 6);
    write_film("", "blue", 6);
    render(RENDER, 6, 70, 6);
    render(RENDER, 0, 0, 6); /* all is there */
    assert_int_equal(unlink("f.03.png"), 0);
    render(RENDER, 1, 100, 6);
    write_film("", "blue", 4);
    render(RENDER, 0, 0, 4);
    int64_t size;
    assert_int_equal(count_files(KEPT, &size), 4);
}

/* How many primary rays a run traced. */
static int64_t traced(const run *r) {
    const char *at = r->code == 0 ? strstr(r->out, "primary rays") : NULL;
    int64_t count = 0;
    assert_non_null(at);
    for (at += strspn(at, "primary rays"); (*at >= '0' && *at <= '9') || *at == ','; at++)
        if (*at != ',') count = 10 * count + (*at - '0');
    assert_true(count > 0);
    return count;
}

/* At edges likewise; and with a lower error only those samples are taken that are new. */
static void edges_are_kept(void **state) {
    (void)state;
#define EDGES                                                                                  \
    "render film.yaml -o " TARGET " --set film.quality=edges --threads 1 --stats "             \
    "--check-reuse "
    write_film("", "red", 6);
    render(EDGES "--samples 64-256 --error 0.0003", 0, 0, 6);
    write_film("", "blue", 6);
    render(EDGES "--samples 64-256 --error 0.0003", 6, 70, 6);
    write_film(ball, "blue", 6);
    render(EDGES "--samples 64-256 --error 0.0003", 6, 70, 6);
    int64_t new = traced(render(EDGES "--samples 64-256 --error 0.0002", 6, 100, 6)),
            all = traced(
                zoetrope("render film.yaml -o x.hash --set film.quality=edges --threads 1 "
                         "--stats --samples 64-256 --error 0.0002"));
    assert_in_range(new, 1, all / 2);
    render(EDGES "--samples 128-256 --error 0.0002", 0, 0, 6);
}

/* Another size, other samples: nothing fits any more, and it is replaced. */
static void other_settings_replace_what_was_kept(void **state) {
    (void)state;
    int64_t size, larger;
    write_film("", "red", 6);
    render(RENDER, 0, 0, 6);
    count_files(KEPT, &size);
    render(RENDER " --size 160x80", 0, 0, 6);
    assert_int_equal(count_files(KEPT, &larger), 6);
    assert_true(larger > size);
    render(RENDER " --size 160x80 --overwrite", 0, 0, 6);
    write_film("", "green", 6);
    render("render film.yaml -o " TARGET
           " --samples 96 --threads 1 --size 160x80 --stats --no-reuse",
           0, 0, 0);
    write_film("", "blue", 6);
    render(RENDER " --size 160x80", 6, 70, 6); /* those of the red one */
}

/* Movies are encoded again by pieces: their frames that did not change are copied as a whole.
 */
static void movies_and_previews(void **state) {
    (void)state;
    write_film("", "red", 6);
    render("preview film.yaml -o p.mp4 --samples 96 --threads 1 --size 128x64 --stats", 0, 0,
           6);
    write_film("", "blue", 6);
    render("preview film.yaml -o p.mp4 --samples 96 --threads 1 --size 128x64 --stats "
           "--check-reuse",
           6, 70, 6);
    assert_int_equal(unlink("p.mp4"), 0);
    render("preview film.yaml -o p.mp4 --samples 96 --threads 1 --size 128x64 --stats", 6, 100,
           6);
}

/* There is never more than there may be. */
static void room_is_bounded(void **state) {
    (void)state;
    int64_t size, all;
    char arguments[256];
    write_film("", "red", 6);
    render(RENDER, 0, 0, 6);
    count_files(KEPT, &all);
    write_film("", "blue", 6);
    snprintf(arguments, sizeof arguments, RENDER " --keep %.6fMB", 0.6e-6 * (double)all);
    zoetrope_succeeds(arguments); /* which of them stay the clock says */
    assert_int_equal(count_files(KEPT, &size), 3);
    assert_true(size <= all * 6 / 10);
    write_film("", "red", 6);
    render(RENDER " --keep 0", 0, 0, 0);
    assert_int_equal(access(KEPT, F_OK), -1);
    render("render film.yaml -o x.hash --samples 96 --threads 1 --stats", 0, 0, 0);
    assert_int_equal(access("x.hash.keepsakes", F_OK), -1);
    const refusal wrong[] = {{"render film.yaml --keep 2", "so many bytes", 2},
                             {"render film.yaml --keep -1GB", "so many bytes", 2},
                             {"render film.yaml --keep 1e9TB", "so many bytes", 2},
                             {"frame film.yaml 1 --keep 1GB", "takes no --keep", 2}};
    assert_refused(wrong, sizeof wrong / sizeof *wrong);
}

/* A frame whose random numbers change with whatever it holds is not worth keeping. */
static void noise_is_not_kept(void **state) {
    (void)state;
    write_film("", "red", 6);
#define FOCUS                                                                                  \
    "--samples 96 --threads 1 --stats --set camera.aperture=0.1 --set camera.focus_distance=6"
    render("render film.yaml -o " TARGET " " FOCUS, 0, 0, 0);
    render("render film.yaml -o " TARGET " " FOCUS " --set film.seed=fixed", 0, 0, 6);
}

static void damage(const char *name, int64_t at, int64_t end) {
    struct stat there;
    int file = open(name, O_WRONLY);
    assert_true(file >= 0 && fstat(file, &there) == 0);
    if (at >= 0) assert_int_equal(pwrite(file, "damage", 6, at), 6);
    if (end >= 0) assert_int_equal(ftruncate(file, end), 0);
    assert_int_equal(close(file), 0);
}

/* What is damaged, cut short, of others or no file at all is as good as not there; what is not
 * called as keepsakes are stays. */
static void damage_costs_its_frame(void **state) {
    (void)state;
    write_film("", "red", 6);
    render(RENDER, 0, 0, 6);
    damage(KEPT "/0", 5000, -1); /* found when it is wanted */
    damage(KEPT "/1", 3, -1);    /* and at once */
    damage(KEPT "/2", -1, 100);
    damage(KEPT "/3", -1, 0);
    assert_int_equal(rename(KEPT "/5", KEPT "/4"), 0); /* of another frame */
    write_text(KEPT "/7.part", "half");
    write_text(KEPT "/notes", "mine");
    write_text(KEPT "/99999999999999999999", "?");
    write_film("", "blue", 6);
    render(RENDER, 0, 0, 6);
    assert_int_equal(access(KEPT "/7.part", F_OK), -1);
    assert_int_equal(access(KEPT "/notes", F_OK), 0);
    write_film("", "red", 6);
    render(RENDER, 6, 70, 6);
    write_film("", "blue", 6);
    render(RENDER " --keep 0", 0, 0, 0);
    assert_int_equal(access(KEPT "/notes", F_OK), 0);
    assert_int_equal(access(KEPT "/0", F_OK), -1);
}

/* Where nothing can be kept the film is made all the same, and it is told once. */
static void what_cannot_be_kept_is_told(void **state) {
    (void)state;
    write_film("", "red", 6);
    write_text(KEPT, "in the way");
    run *r = zoetrope(RENDER);
    assert_int_equal(r->code, 0);
    assert_contains(r->err, "no more frames are kept for later edits");
    assert_null(strstr(strstr(r->err, "no more") + 1, "no more"));
    assert_null(strstr(r->out, "keepsakes"));
    assert_int_equal(access("f.05.png", F_OK), 0);
}

/* Parts of a film that share a target keep their own frames, and leave each other's alone. */
static void parts_keep_their_own(void **state) {
    (void)state;
    int64_t size;
    write_film("", "red", 6);
    render(RENDER " --chunk 1/2", 0, 0, 3);
    render(RENDER " --chunk 2/2", 0, 0, 3);
    assert_int_equal(count_files(KEPT, &size), 6);
    write_film("", "blue", 6);
    zoetrope_succeeds(RENDER " --chunk 2/2"); /* which are divided by what they took */
    zoetrope_succeeds("render film.yaml -o " TARGET
                      " --samples 96 --no-reuse --chunk 1/2 --keep 0");
    int kept = count_files(KEPT, &size);
    assert_in_range(kept, 1, 5);
    write_film("", "green", 6);
    render(RENDER, kept, 70, 6);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        IN_DIRECTORY(edits_are_cheap),
        IN_DIRECTORY(edges_are_kept),
        IN_DIRECTORY(other_settings_replace_what_was_kept),
        IN_DIRECTORY(movies_and_previews),
        IN_DIRECTORY(room_is_bounded),
        IN_DIRECTORY(noise_is_not_kept),
        IN_DIRECTORY(damage_costs_its_frame),
        IN_DIRECTORY(what_cannot_be_kept_is_told),
        IN_DIRECTORY(parts_keep_their_own),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
