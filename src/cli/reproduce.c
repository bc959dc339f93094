#include "cli/reproduce.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The path of a file beside the image, of the caller to free; NULL when out of memory. */
static char *beside(const char *image, const char *name) {
    const char *slash = strrchr(image, '/');
    char *path = NULL;
    int length = slash ? (int)(slash + 1 - image) : 0;
    return asprintf(&path, "%.*s%s", length, image, name) < 0 ? NULL : path;
}

/* Where the description is, of the caller to free: as it was called, or beside the image, by
 * that or by its name alone. */
static zt_status find_description(char **path, const zt_options *options, const char *name,
                                  zt_report *report) {
    *path = NULL;
    if (options->other || (name && access(name, R_OK) == 0)) {
        *path = strdup(options->other ? options->other : name);
        return *path ? ZT_OK : ZT_EMEMORY;
    }
    const char *slash = name ? strrchr(name, '/') : NULL;
    const char *const names[] = {name && *name != '/' ? name : NULL, slash ? slash + 1 : NULL};
    for (int i = 0; i < 2; i++) {
        if (!names[i]) continue;
        *path = beside(options->file, names[i]);
        if (!*path) return ZT_EMEMORY;
        if (access(*path, R_OK) == 0) return ZT_OK;
        free(*path);
        *path = NULL;
    }
    if (name)
        zt_report_say(report, ZT_ERROR,
                      "%s is of %s, which is neither there nor beside it; say where it is: "
                      "zoetrope reproduce %s FILE",
                      options->file, name, options->file);
    else
        zt_report_say(report, ZT_ERROR,
                      "%s does not say of what description it is; say it: zoetrope reproduce "
                      "%s FILE",
                      options->file, options->file);
    return ZT_EFILE;
}

static void print_deviation(const zt_deviation *d) {
    printf("pixel %d,%d: %s was %.9g, and is %.9g\n", d->column, d->row, d->channel, d->was,
           d->is);
}

static void print_difference(const zt_reproduction *r, const char *path,
                             const char *description) {
    printf("%" PRId64 " of %" PRId64 " pixels differ\n", r->different_count, r->pixel_count);
    for (int i = 0; i < r->first_count; i++) print_deviation(&r->first[i]);
    if (r->different_count > r->first_count) puts("...");
    printf("the largest difference, %.3g, is at ", r->largest.is - r->largest.was);
    print_deviation(&r->largest);
    if (!r->same_arithmetic)
        puts("it was rendered by a version of the program, or on an architecture, that "
             "computes other pixels");
    else if (!r->same_key)
        printf("what is rendered differs: %s, or what it refers to, has changed since\n",
               description);
    else
        printf("what is rendered is the same: %s has changed, or the machine that rendered it "
               "computes otherwise\n",
               path);
}

static zt_status render_again(bool *differs, const zt_options *options, const zt_origin *origin,
                              const char *description, bool (*stopped)(void *user),
                              zt_report *report) {
    zt_listener listener = zt_report_listener(report);
    zt_animation *animation;
    zt_reproduction r;
    const zt_watcher watcher = {.stopped = stopped};
    zt_status status = zt_animation_read(&animation, description, origin->overrides,
                                         origin->override_count, listener);
    if (status != ZT_OK) return status;
    status = zt_reproduce(&r, origin, animation, options->settings.threads, &watcher, listener);
    zt_animation_free(&animation);
    if (status != ZT_OK) return status;
    *differs = r.different_count > 0;
    printf("%s, frame %" PRId64 " of %s: ", options->file, origin->image->info.frame,
           description);
    if (*differs)
        print_difference(&r, options->file, description);
    else
        puts(r.same_key ? "identical" : "identical pixels, though what is rendered differs");
    return zt_report_finish(report);
}

zt_status zt_reproduce_image(bool *differs, const zt_options *options,
                             bool (*stopped)(void *user), zt_report *report) {
    zt_origin *origin;
    char *description = NULL;
    *differs = false;
    zt_status status = zt_origin_read(&origin, options->file, zt_report_listener(report));
    if (status != ZT_OK) return status;
    status = find_description(&description, options, origin->image->info.description, report);
    if (status == ZT_OK)
        status = render_again(differs, options, origin, description, stopped, report);
    free(description);
    zt_origin_free(&origin);
    return status;
}
