/* Numbered images by a plan: what an earlier run has made is found again, whole or not, and
 * what it has not made is left alone. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "base/hash.h"
#include "files.h"
#include <zoetrope/aov.h>
#include <zoetrope/output.h>

enum { FRAMES = 3, RECORDS_MAX = 16 };
static const int64_t frames[FRAMES] = {9, -2, 4}; /* as they come */
static const zt_hash keys[FRAMES] = {{1, 2}, {0, 3}, {5, 0}};

/* What was completed, in turn. */
typedef struct records {
    zt_output_record items[RECORDS_MAX];
    int64_t count;
    zt_status answer;
} records;

static zt_status note(void *user, const zt_output_record *record) {
    records *all = user;
    assert_true(all->count < RECORDS_MAX);
    all->items[all->count++] = *record;
    return all->answer;
}

static zt_output_plan plan_of(records *before, records *now) {
    *now = (records){.answer = ZT_OK};
    return (zt_output_plan){.frames = frames,
                            .keys = keys,
                            .count = FRAMES,
                            .records = before ? before->items : NULL,
                            .record_count = before ? before->count : 0,
                            .completed = note,
                            .user = now};
}

static zt_status open_plan(zt_output **output, const char *target, const zt_output_plan *plan,
                           zt_view view, const char *wished, heard *h) {
    const zt_output_format format = {
        .width = 8, .height = 6, .rate = {24, 1}, .view = view, .plan = plan};
    const zt_output_option options[] = {{wished ? "format-option" : NULL, wished},
                                        {NULL, NULL}};
    return zt_output_open(output, target, &format, options, listener_of(h));
}

static zt_output *opened(const char *target, const zt_output_plan *plan) {
    heard h;
    zt_output *output;
    if (open_plan(&output, target, plan, ZT_VIEW_SRGB, NULL, &h) != ZT_OK)
        fail_msg("%s", h.text);
    return output;
}

static zt_status write_frame(zt_output *output, int i, bool known) {
    zt_image *image = picture(8, 6, i);
    image->info.known = known;
    image->info.rate = (zt_rate){24, 1};
    image->info.frame = frames[i];
    image->info.key = keys[i];
    zt_status status = zt_output_write(output, image, frames[i]);
    zt_image_free(&image);
    return status;
}

/* Which positions are wanted, as bits. */
static int wanted(zt_output *output) {
    int bits = 0;
    for (int i = 0; i < FRAMES; i++) bits |= zt_output_wants(output, i) << i;
    return bits;
}

static int wanted_of(const char *target, records *before, zt_view view, const char *wished) {
    heard h;
    records now;
    zt_output *output;
    const zt_output_plan plan = plan_of(before, &now);
    assert_int_equal(open_plan(&output, target, &plan, view, wished, &h), ZT_OK);
    int bits = wanted(output);
    assert_int_equal(zt_output_close(&output), ZT_OK);
    return bits;
}

/* A first run of all frames, which records each of them as it is on the disk. */
static records first_run(const char *target, bool known) {
    records now;
    const zt_output_plan plan = plan_of(NULL, &now);
    zt_output *output = opened(target, &plan);
    assert_int_equal(wanted(output), 7);
    for (int i = 0; i < FRAMES; i++) {
        assert_int_equal(now.count, i);
        assert_int_equal(write_frame(output, i, known), ZT_OK);
    }
    assert_int_equal(zt_output_close(&output), ZT_OK);
    assert_int_equal(now.count, FRAMES);
    return now;
}

static const char *const names[FRAMES] = {"/a.0009.png", "/a.-0002.png", "/a.0004.png"};

static const char *path_in(const char *directory, int i) {
    static char path[64];
    snprintf(path, sizeof path, "%s%s", directory, names[i]);
    return path;
}

static void edit(const char *path, long at, int byte) {
    FILE *file = fopen(path, "r+b");
    assert_non_null(file);
    assert_int_equal(fseek(file, at, at < 0 ? SEEK_END : SEEK_SET), 0);
    fputc(byte, file);
    fclose(file);
}

/* A record has the frame, a key of its own, and the size and the checksum of the file. */
static void records_tell_of_files(void **state) {
    (void)state;
    records made = first_run("tell/a.@@@@.png", true);
    for (int i = 0; i < FRAMES; i++) {
        const zt_output_record *r = &made.items[i];
        size_t size;
        char *bytes = file_bytes(path_in("tell", i), &size);
        zt_hash sum = zt_hash_bytes(bytes, size);
        assert_true(r->first == frames[i] && r->count == 1);
        assert_int_equal(r->bytes, size);
        assert_true(zt_hash_equal(r->checksum, sum));
        assert_true(r->key.high && r->key.low);
        assert_true(r->key.high != made.items[(i + 1) % FRAMES].key.high);
        free(bytes);
    }
    made = first_run("tell2/a.####.png", false); /* nobody knows what was seen: no key */
    for (int i = 0; i < FRAMES; i++)
        assert_true(!made.items[i].key.high && !made.items[i].key.low && made.items[i].bytes);
}

/* What is there whole is not wanted; what is gone, cut, longer or other by one bit is. */
static void whole_files_need_not_come(void **state) {
    (void)state;
    const char *const target = "whole/a.####.png";
    records made = first_run(target, true);
    assert_int_equal(wanted_of(target, &made, ZT_VIEW_SRGB, NULL), 0);
    assert_int_equal(wanted_of("elsewhere/a.####.png", &made, ZT_VIEW_SRGB, NULL), 7);

    edit(path_in("whole", 0), -3, 'x');
    assert_int_equal(wanted_of(target, &made, ZT_VIEW_SRGB, NULL), 1);
    assert_int_equal(remove(path_in("whole", 1)), 0);
    assert_int_equal(wanted_of(target, &made, ZT_VIEW_SRGB, NULL), 3);
    assert_int_equal(mkdir(path_in("whole", 1), 0777), 0);
    assert_int_equal(wanted_of(target, &made, ZT_VIEW_SRGB, NULL), 3);
    assert_int_equal(remove(path_in("whole", 1)), 0);
    edit(path_in("whole", 2), (long)made.items[2].bytes, 0);
    assert_int_equal(wanted_of(target, &made, ZT_VIEW_SRGB, NULL), 7);
    assert_int_equal(truncate(path_in("whole", 2), made.items[2].bytes), 0);
    assert_int_equal(wanted_of(target, &made, ZT_VIEW_SRGB, NULL), 3);
    assert_int_equal(truncate(path_in("whole", 2), made.items[2].bytes - 1), 0);
    assert_int_equal(wanted_of(target, &made, ZT_VIEW_SRGB, NULL), 7);
}

/* A frame that shows something else now, or is written in another way, is wanted; so is one of
 * which nothing is known, and one whose last record says something else. */
static void keys_decide(void **state) {
    (void)state;
    const char *const target = "keys/a.####.png";
    records made = first_run(target, true), now;
    assert_int_equal(wanted_of(target, &made, ZT_VIEW_RAW, NULL), 7);
    assert_int_equal(wanted_of(target, &made, ZT_VIEW_SRGB, "bits=16"), 7);
    assert_int_equal(wanted_of(target, &made, ZT_VIEW_SRGB, "compression=zip:5"), 7);
    assert_int_equal(wanted_of(target, &made, ZT_VIEW_SRGB, "bits=8"), 0); /* as it is */

    const zt_hash other[FRAMES] = {{1, 2}, {0, 4}, {0, 0}};
    zt_output_plan plan = plan_of(&made, &now);
    plan.keys = other;
    zt_output *output = opened(target, &plan);
    assert_int_equal(wanted(output), 6);
    assert_int_equal(zt_output_close(&output), ZT_OK);

    plan = plan_of(&made, &now);
    plan.overwrites = true;
    output = opened(target, &plan);
    assert_int_equal(wanted(output), 7);
    assert_int_equal(zt_output_close(&output), ZT_OK);

    made.items[made.count] = made.items[0]; /* the later ones count */
    made.items[made.count++].key.low ^= 1;
    assert_int_equal(wanted_of(target, &made, ZT_VIEW_SRGB, NULL), 1);
    made.items[made.count] = made.items[0];
    made.count++;
    assert_int_equal(wanted_of(target, &made, ZT_VIEW_SRGB, NULL), 0);
    made.items[made.count] = made.items[0]; /* a piece of a movie, not an image */
    made.items[made.count].key.low ^= 1;
    made.items[made.count++].kind = ZT_RECORD_PIECE;
    assert_int_equal(wanted_of(target, &made, ZT_VIEW_SRGB, NULL), 0);
    made.items[1].key = (zt_hash){0, 0};
    assert_int_equal(wanted_of(target, &made, ZT_VIEW_SRGB, NULL), 2);
    made.items[2].key = (zt_hash){0, 0}; /* two that are not known are not the same */
    plan = plan_of(&made, &now);
    plan.keys = other;
    output = opened(target, &plan);
    assert_int_equal(wanted(output), 6);
    assert_int_equal(zt_output_close(&output), ZT_OK);
}

/* A file that no record knows is not replaced, unless that is asked for; it stays as it is. */
static void strangers_stay(void **state) {
    (void)state;
    const char *const target = "strange/a.####.png";
    records made = first_run(target, true), now;
    made.items[2] = made.items[1];                          /* of the third, nothing is known */
    for (int i = 0; i < 2; i++) made.items[i].key.low ^= 1; /* of some other key will do */
    size_t size, size_now;
    char *bytes = file_bytes(path_in("strange", 2), &size);
    zt_output_plan plan = plan_of(&made, &now);
    zt_output *output;
    heard h;
    assert_int_equal(open_plan(&output, target, &plan, ZT_VIEW_SRGB, NULL, &h), ZT_EFILE);
    assert_null(output);
    assert_told(&h, "strange/a.0004.png");
    assert_told(&h, "--overwrite");
    char *bytes_now = file_bytes(path_in("strange", 2), &size_now);
    assert_int_equal(size_now, size);
    assert_memory_equal(bytes_now, bytes, size);
    free(bytes);
    free(bytes_now);
    assert_int_equal(entry_count("strange"), 3);

    plan.overwrites = true;
    output = opened(target, &plan);
    assert_int_equal(zt_output_close(&output), ZT_OK);
    plan.overwrites = false;
    plan.count = 2; /* a name that is not planned is nobody's business */
    output = opened(target, &plan);
    assert_int_equal(zt_output_close(&output), ZT_OK);
}

/* Whoever is told of what was completed may stop it: the image gets no name, and none follows.
 */
static void telling_may_fail(void **state) {
    (void)state;
    records now;
    const zt_output_plan plan = plan_of(NULL, &now);
    zt_output *output = opened("stop/a.####.png", &plan);
    now.answer = ZT_ESTOPPED;
    assert_int_equal(write_frame(output, 0, true), ZT_ESTOPPED);
    assert_int_equal(write_frame(output, 1, true), ZT_ESTOPPED);
    assert_int_equal(zt_output_close(&output), ZT_OK);
    assert_int_equal(now.count, 1);
    assert_int_equal(entry_count("stop"), 0);
}

static bool is_shown(const char *path, const zt_image *image, const char *channel) {
    heard h;
    zt_image *back;
    if (zt_image_read(&back, path, listener_of(&h)) != ZT_OK) fail_msg("%s", h.text);
    const float *sent = channel ? zt_image_channel(image, channel) : image->pixels,
                *seen = channel ? zt_image_channel(back, channel) : back->pixels;
    size_t size = (size_t)image->width * (size_t)image->height * sizeof(float);
    bool shown = seen && memcmp(seen, sent, channel ? size : 4 * size) == 0;
    bool alone = back->channel_count == (channel ? (*channel == 'Z' ? 1 : 3) : 0);
    zt_image_free(&back);
    return shown && alone;
}

/* Where a target has a place for it, each layer has a file, with just what belongs to it. All
 * of a frame's files are one record: it is there whole, or not at all. */
static void layers_have_files(void **state) {
    (void)state;
    const char *const target = "layers/{layer}/a.{layer}.####.exr";
    static const char *const paths[] = {"layers/rgba/a.rgba.0009.exr",
                                        "layers/depth/a.depth.0009.exr",
                                        "layers/N/a.N.0009.exr"};
    heard h;
    records made;
    zt_output *output;
    zt_output_plan plan = plan_of(NULL, &made);
    plan.count = 1;
    zt_output_format format = {
        .width = 8, .height = 6, .rate = {24, 1}, .plan = &plan, .aovs = ZT_AOV_Z | ZT_AOV_N};
    assert_int_equal(zt_output_open(&output, target, &format, NULL, listener_of(&h)), ZT_OK);
    zt_image *image = picture(8, 6, 0);
    assert_int_equal(zt_image_add_aovs(image, format.aovs), ZT_OK);
    for (int c = 0; c < image->channel_count; c++)
        for (int i = 0; i < 8 * 6; i++) image->channels[c].values[i] = (float)(100 * c + i);
    image->info = (zt_image_info){.known = true, .frame = 9, .rate = {24, 1}, .key = keys[0]};
    assert_int_equal(zt_output_write(output, image, 9), ZT_OK);
    assert_int_equal(zt_output_close(&output), ZT_OK);
    assert_true(is_shown(paths[0], image, NULL));
    assert_true(is_shown(paths[1], image, "Z"));
    assert_true(is_shown(paths[2], image, "N.Y"));
    zt_image_free(&image);

    assert_int_equal(made.count, 1);
    records before = made;
    plan.records = before.items;
    plan.record_count = 1;
    for (int i = -1; i < 6; i++) { /* untouched; each damaged, then gone */
        struct stat there;
        if (i >= 0 && i < 3) edit(paths[i], -3, 'x');
        if (i >= 3) assert_int_equal(remove(paths[i - 3]), 0);
        assert_int_equal(zt_output_open(&output, target, &format, NULL, listener_of(&h)),
                         ZT_OK);
        assert_int_equal(zt_output_wants(output, 0), i >= 0);
        assert_int_equal(zt_output_close(&output), ZT_OK);
        assert_int_equal(stat(paths[i < 2 ? 2 : 0], &there), i < 3 ? 0 : -1);
    }
    assert_int_equal(
        zt_output_open(&output, "layers/{layer}.####.png", &format, NULL, listener_of(&h)),
        ZT_EARGUMENT);
    assert_told(&h, "{layer}");
}

/* A strange file of any layer is left alone. */
static void strange_layers_stay(void **state) {
    (void)state;
    heard h;
    records now;
    zt_output *output;
    const zt_output_plan plan = plan_of(NULL, &now);
    const zt_output_format format = {
        .width = 8, .height = 6, .rate = {24, 1}, .plan = &plan, .aovs = ZT_AOV_Z};
    assert_int_equal(mkdir("odd", 0777), 0);
    FILE *file = fopen("odd/depth.0004.exr", "w");
    assert_non_null(file);
    fclose(file);
    assert_int_equal(
        zt_output_open(&output, "odd/{layer}.####.exr", &format, NULL, listener_of(&h)),
        ZT_EFILE);
    assert_told(&h, "odd/depth.0004.exr");
    assert_int_equal(entry_count("odd"), 1);
}

/* Names come into their places, as parts of a file's name: they lead nowhere else, and are no
 * places themselves. Other places are told. */
static void names_stay_inside(void **state) {
    static const struct {
        const char *target, *name, *camera, *path;
    } rows[] = {{"o/{name}.####.png", "film", "camera", "o/film.####.png"},
                {"{name}/{camera}/{name}.{layer}.exr", "a", "b", "a/b/a.{layer}.exr"},
                {"o/{name}.png", "../../etc/passwd", "c", "o/_._.._etc_passwd.png"},
                {"{name}/{camera}.png", "..", ".", "_./_.png"},
                {"{name}.{camera}.png", "a#b@c%d\\e:f\n", "{name}{layer}",
                 "a_b_c_d_e_f_._name__layer_.png"},
                {"{name}.png", "", "c", "_.png"},
                {"{name}.png", "/", "c", "_.png"},
                {"{name}.png", "N\xc3\xa4her", "c", "N\xc3\xa4her.png"},
                {"plain.png", "a", "b", "plain.png"}};
    (void)state;
    heard h;
    char *path;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        assert_int_equal(zt_output_target(&path, rows[i].target, rows[i].name, rows[i].camera,
                                          listener_of(&h)),
                         ZT_OK);
        assert_string_equal(path, rows[i].path);
        free(path);
    }
    assert_int_equal(zt_output_target(&path, "{shot}.png", "a", "b", listener_of(&h)),
                     ZT_EARGUMENT);
    assert_told(&h, "no {shot} for {shot}.png: there is {name}, {camera} and {layer}");
    assert_null(path);
}

static zt_status write_plain(zt_output *output) {
    zt_image *image = picture(8, 6, 0);
    zt_status status = zt_output_write(output, image, 4);
    zt_image_free(&image);
    return status;
}

/* What happens to the directory meanwhile: one that went is made again; what a link leads to is
 * not written into, but a directory is; a file in its place is told; and of nothing a half is
 * left. */
static void directories_change(void **state) {
    (void)state;
    heard h;
    zt_output *output;
    const zt_output_format format = {.width = 8, .height = 6, .rate = {24, 1}};
    assert_int_equal(zt_output_open(&output, "gone/a.####.png", &format, NULL, listener_of(&h)),
                     ZT_OK);
    assert_int_equal(rmdir("gone"), 0);
    assert_int_equal(write_plain(output), ZT_OK);
    assert_int_equal(zt_output_close(&output), ZT_OK);
    assert_int_equal(entry_count("gone"), 1);

    assert_int_equal(symlink("gone", "way"), 0);
    assert_int_equal(symlink("a.0004.png", "gone/b.0004.png"), 0);
    edit("gone/a.0004.png", 0, 'x');
    assert_int_equal(zt_output_open(&output, "way/b.####.png", &format, NULL, listener_of(&h)),
                     ZT_OK);
    assert_int_equal(write_plain(output), ZT_OK);
    assert_int_equal(zt_output_close(&output), ZT_OK);
    size_t size;
    char *bytes = file_bytes("gone/a.0004.png", &size);
    assert_int_equal(bytes[0], 'x');
    free(bytes);
    struct stat there;
    assert_true(lstat("gone/b.0004.png", &there) == 0 && S_ISREG(there.st_mode));
    assert_int_equal(entry_count("gone"), 2);

    assert_int_equal(zt_output_open(&output, "late/a.####.png", &format, NULL, listener_of(&h)),
                     ZT_OK);
    assert_int_equal(rmdir("late"), 0);
    assert_int_equal(rename("gone/b.0004.png", "late"), 0);
    assert_int_equal(write_plain(output), ZT_EFILE);
    assert_told(&h, "late/a.0004.png");
    assert_int_equal(zt_output_close(&output), ZT_OK);
    assert_true(lstat("late", &there) == 0 && S_ISREG(there.st_mode));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(records_tell_of_files), cmocka_unit_test(whole_files_need_not_come),
        cmocka_unit_test(keys_decide),           cmocka_unit_test(strangers_stay),
        cmocka_unit_test(telling_may_fail),      cmocka_unit_test(layers_have_files),
        cmocka_unit_test(strange_layers_stay),   cmocka_unit_test(names_stay_inside),
        cmocka_unit_test(directories_change),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
