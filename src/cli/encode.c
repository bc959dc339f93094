#include "cli/encode.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/progress.h"
#include "cli/values.h"

/* A name with a number in it, and the numbers for which there are files. */
typedef struct pictures {
    char *directory;  /* "shots/", or "" */
    char *head;       /* "frames." */
    const char *tail; /* ".exr"; the options' own */
    int digits;       /* at least so many */
    int64_t *numbers; /* rising */
    int64_t count, room;
} pictures;

static void free_pictures(pictures *p) {
    free(p->directory);
    free(p->head);
    free(p->numbers);
}

/* The length of "####", "@@@@", "%d" or "%04d" at the begin of a text, or 0. */
static size_t wildcard(int *digits, const char *text) {
    size_t length = strspn(text, *text == '#' ? "#" : "@");
    *digits = (int)length;
    if (length > 0) return length;
    if (*text != '%') return 0;
    const char *rest = text + 1;
    int64_t number = 0;
    *digits = zt_value_digits(&number, &rest, 20) && text[1] == '0' ? (int)number : 1;
    return *rest == 'd' ? (size_t)(rest - text) + 1 : 0;
}

static zt_status read_pattern(pictures *p, const char *pattern, zt_report *report) {
    const char *slash = strrchr(pattern, '/'), *name = slash ? slash + 1 : pattern;
    const char *mark = name + strcspn(name, "#@%");
    size_t length = wildcard(&p->digits, mark);
    if (length == 0 || strpbrk(mark + length, "#@%")) {
        zt_report_say(report, ZT_ERROR,
                      "%s: must have the place of one number, such as frames.####.exr or "
                      "frames.%%04d.png",
                      pattern);
        return ZT_EARGUMENT;
    }
    p->tail = mark + length;
    p->directory = strndup(pattern, (size_t)(name - pattern));
    p->head = strndup(name, (size_t)(mark - name));
    return p->directory && p->head ? ZT_OK : ZT_EMEMORY;
}

/* Whether a file's name is one that the pattern makes of a number. */
static bool fits(int64_t *number, const pictures *p, const char *name) {
    size_t head = strlen(p->head);
    if (strncmp(name, p->head, head) != 0) return false;
    const char *begin = name + head, *rest = begin;
    if (!zt_value_digits(number, &rest, INT64_C(1) << 40) || strcmp(rest, p->tail) != 0)
        return false;
    return rest - begin == p->digits || (rest - begin > p->digits && *begin != '0');
}

static zt_status push(pictures *p, int64_t number) {
    if (p->count == p->room) {
        int64_t room = 2 * p->room + 64;
        int64_t *numbers = realloc(p->numbers, (size_t)room * sizeof *numbers);
        if (!numbers) return ZT_EMEMORY;
        p->numbers = numbers;
        p->room = room;
    }
    p->numbers[p->count++] = number;
    return ZT_OK;
}

static zt_status scan(pictures *p, zt_report *report) {
    const char *path = *p->directory ? p->directory : ".";
    DIR *directory = opendir(path);
    if (!directory) {
        zt_report_say(report, ZT_ERROR, "cannot read %s: %s", path, strerror(errno));
        return ZT_EFILE;
    }
    zt_status status = ZT_OK;
    errno = 0;
    for (struct dirent *entry; status == ZT_OK && (entry = readdir(directory));) {
        int64_t number;
        if (fits(&number, p, entry->d_name)) status = push(p, number);
    }
    if (status == ZT_OK && errno) {
        zt_report_say(report, ZT_ERROR, "cannot read %s: %s", path, strerror(errno));
        status = ZT_EFILE;
    }
    closedir(directory);
    return status;
}

static zt_status find_pictures(pictures *p, const char *pattern, zt_report *report) {
    zt_status status = read_pattern(p, pattern, report);
    if (status == ZT_OK) status = scan(p, report);
    if (status != ZT_OK) return status;
    if (p->count == 0) {
        zt_report_say(report, ZT_ERROR, "there are no files %s", pattern);
        return ZT_EFILE;
    }
    zt_frames frames = {p->numbers, p->count};
    zt_frames_sort(&frames);
    for (int64_t i = 1; i < p->count; i++) {
        int64_t first = p->numbers[i - 1] + 1, last = p->numbers[i] - 1;
        if (first == last)
            zt_report_say(report, ZT_WARNING, "%s: number %" PRId64 " is missing", pattern,
                          first);
        else if (first < last)
            zt_report_say(report, ZT_WARNING,
                          "%s: numbers %" PRId64 " to %" PRId64 " are missing", pattern, first,
                          last);
    }
    return ZT_OK;
}

/* Files for a display hold colours that are not multiplied by A; those of an image are. */
static void multiply_by_alpha(zt_image *image) {
    size_t pixel_count = (size_t)image->width * (size_t)image->height;
    for (float *pixel = image->pixels; pixel < image->pixels + 4 * pixel_count; pixel += 4)
        for (int c = 0; c < 3; c++) pixel[c] *= pixel[3];
}

static zt_status read_picture(zt_image **image, const pictures *p, int64_t number,
                              zt_report *report) {
    char *path = NULL;
    if (asprintf(&path, "%s%s%0*" PRId64 "%s", p->directory, p->head, p->digits, number,
                 p->tail) < 0)
        return ZT_EMEMORY;
    zt_status status = zt_image_read(image, path, zt_report_listener(report));
    free(path);
    if (status == ZT_OK && !(*image)->linear) multiply_by_alpha(*image);
    return status;
}

/* How light is shown: as was asked for, or as the film has it that the image is of. */
static zt_status find_look(zt_look **look, const zt_image *image, const zt_options *options) {
    int v = 0;
    if (!options->view) return zt_look_find(look, image, NULL);
    while (strcmp(zt_view_name((zt_view)v), options->view) != 0) v++; /* it is one of them */
    const zt_view view = (zt_view)v;
    return zt_look_find(look, image, &view);
}

/* The movie says of itself what the images say of theirs; else its title is their name: "film"
 * of "film.####.exr". Where they say nothing of a rate, there are 24 a second. */
static zt_status open_movie(zt_output **output, const char *target, int64_t count,
                            const zt_image *image, const zt_options *options,
                            zt_report *report) {
    const zt_image_info *info = &image->info;
    int length;
    const char *name = zt_options_name(&length, options);
    char *title = info->title ? strdup(info->title) : strndup(name, (size_t)length);
    zt_look *look = NULL;
    zt_status status = title ? find_look(&look, image, options) : ZT_EMEMORY;
    if (status == ZT_OK) {
        zt_output_format format = {.width = image->width,
                                   .height = image->height,
                                   .rate = info->known ? info->rate : (zt_rate){24, 1},
                                   .view = look->view,
                                   .color = look->color,
                                   .transparent = image->transparent,
                                   .frame_count = count,
                                   .settings = look->settings,
                                   .description = info->description};
        if (options->rate.num > 0) format.rate = options->rate;
        zt_output_option wishes[ZT_OUTPUT_OPTIONS_MAX + 2] = {{"title", title}};
        memcpy(wishes + 1, options->output_options, sizeof options->output_options);
        status = zt_output_open(output, target, &format, wishes, zt_report_listener(report));
    }
    zt_look_free(&look);
    free(title);
    return status;
}

/* Writes all; the first image has been read. */
static zt_status write_pictures(zt_output *output, const pictures *p, zt_image **image,
                                bool (*stopped)(void *user), zt_progress *progress) {
    for (int64_t i = 0; i < p->count; i++) {
        int width = (*image)->width, height = (*image)->height;
        if (i > 0) {
            zt_image_free(image);
            if (stopped(NULL)) return ZT_ESTOPPED;
            zt_status status = read_picture(image, p, p->numbers[i], progress->report);
            if (status != ZT_OK) return status;
        }
        if ((*image)->width != width || (*image)->height != height) {
            zt_report_say(progress->report, ZT_ERROR,
                          "image %" PRId64 " has %d x %d pixels, those before %d x %d",
                          p->numbers[i], (*image)->width, (*image)->height, width, height);
            return ZT_EFILE;
        }
        zt_status status = zt_output_write(output, *image, p->numbers[i]);
        if (status != ZT_OK) return status;
        zt_progress_frame(progress, i + 1, p->numbers[i]);
    }
    return ZT_OK;
}

static zt_status write_movie(const pictures *p, const char *target, const zt_options *options,
                             bool (*stopped)(void *user), zt_report *report) {
    zt_image *image = NULL;
    zt_output *output = NULL;
    zt_status status = read_picture(&image, p, p->numbers[0], report);
    if (status == ZT_OK) status = open_movie(&output, target, p->count, image, options, report);
    if (status == ZT_OK) {
        zt_progress progress = zt_progress_begin(report, p->count);
        status = write_pictures(output, p, &image, stopped, &progress);
        zt_status closed = zt_output_close(&output);
        if (closed != ZT_OK && status == ZT_OK) status = closed;
        if (status == ZT_OK) zt_progress_end(&progress, target);
        if (status != ZT_OK && progress.done_count > 0)
            zt_report_say(report, ZT_WARNING,
                          "%s has the first %" PRId64 " of %" PRId64 " images", target,
                          progress.done_count, p->count);
    }
    zt_image_free(&image);
    return status;
}

/* A file that is there may have taken long to render. */
static zt_status encode(const pictures *p, const char *target, const zt_options *options,
                        bool (*stopped)(void *user), zt_report *report) {
    if (!options->overwrites && access(target, F_OK) == 0) {
        zt_report_say(report, ZT_ERROR, "%s exists; with --overwrite it is replaced", target);
        return ZT_EFILE;
    }
    return write_movie(p, target, options, stopped, report);
}

zt_status zt_encode(const zt_options *options, bool (*stopped)(void *user), zt_report *report) {
    pictures p = {0};
    zt_status status = find_pictures(&p, options->file, report);
    char *target = zt_options_target(options);
    if (!target) status = ZT_EMEMORY;
    if (status == ZT_OK) status = encode(&p, target, options, stopped, report);
    free(target);
    free_pictures(&p);
    return status;
}
