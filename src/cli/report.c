#include "cli/report.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

zt_report zt_report_create(void) {
    const char *term = getenv("TERM"), *no_color = getenv("NO_COLOR");
    bool terminal = isatty(STDERR_FILENO) && term && strcmp(term, "dumb") != 0;
    return (zt_report){.terminal = terminal, .colors = terminal && !(no_color && *no_color)};
}

/* Takes a line of progress away, so that something else can be written in its place. */
static void clear_line(zt_report *report) {
    if (report->line_open) fputs("\r\033[K", stderr);
    report->line_open = false;
}

/* The severity, where it stands in a message, in its colour. */
static void print_colored(const char *text, zt_severity severity) {
    static const struct {
        const char *word, *color;
    } looks[] = {{"note:", "\033[1;36m"}, {"warning:", "\033[1;35m"}, {"error:", "\033[1;31m"}};
    const char *word = looks[severity].word, *at = strstr(text, word);
    int before = at ? (int)(at - text) : 0;
    int length = at ? (int)strlen(word) : 0;
    fprintf(stderr, "%.*s%s%.*s\033[0m%s\n", before, text, looks[severity].color, length,
            text + before, text + before + length);
}

static void tell(void *user, const zt_message *message) {
    zt_report *report = user;
    char small[1024], *text = small;
    size_t length = zt_message_format(small, sizeof small, message);
    if (length >= sizeof small) {
        char *large = malloc(length + 1);
        if (large) zt_message_format(text = large, length + 1, message);
    }
    flockfile(stderr); /* images are written on a thread of their own, which may tell, too */
    if (message->severity == ZT_ERROR) report->error_count++;
    if (message->severity == ZT_ERROR || !report->quiet) {
        clear_line(report);
        if (report->colors)
            print_colored(text, message->severity);
        else
            fprintf(stderr, "%s\n", text);
    }
    funlockfile(stderr);
    if (text != small) free(text);
}

zt_listener zt_report_listener(zt_report *report) { return (zt_listener){tell, report}; }

void zt_report_say(zt_report *report, zt_severity severity, const char *format, ...) {
    char *text = NULL;
    va_list arguments;
    va_start(arguments, format);
    int length = vasprintf(&text, format, arguments);
    va_end(arguments);
    zt_message message = {.severity = severity,
                          .text = length < 0 ? zt_status_text(ZT_EMEMORY) : text};
    tell(report, &message);
    if (length >= 0) free(text);
}

void zt_report_line(zt_report *report, bool last, const char *format, ...) {
    if (report->quiet) return;
    bool stays = last || !report->terminal;
    flockfile(stderr);
    clear_line(report);
    va_list arguments;
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    if (stays) fputc('\n', stderr);
    report->line_open = !stays;
    funlockfile(stderr);
}

/* Prints "3 planes" where there are some, after the separator. */
static void list(const char **separator, int64_t count, const char *one, const char *many) {
    if (count == 0) return;
    printf("%s%" PRId64 " %s", *separator, count, count == 1 ? one : many);
    *separator = ", ";
}

static void print_film(const zt_film *film) {
    double rate = (double)film->rate.num / film->rate.den;
    printf("size       %d x %d\n", film->width, film->height);
    if (film->rate.den == 1)
        printf("rate       %d frames a second\n", film->rate.num);
    else
        printf("rate       %d/%d = %.6g frames a second\n", film->rate.num, film->rate.den,
               rate);
    printf("frames     %" PRId64 " (0 to %" PRId64 ")\n", film->frame_count,
           film->frame_count - 1);
    printf("duration   %.6g s\n", zt_rate_time(film->rate, film->frame_count));
    if (film->color.wished)
        printf("view       %s, %s of %s\n",
               film->color.display ? film->color.display : "the usual display",
               film->color.view ? film->color.view : "its usual view",
               film->color.config ? film->color.config : "$OCIO");
    else
        printf("view       %s\n", zt_view_name(film->view));
    if (film->sampling.min == film->sampling.max)
        printf("samples    %d a pixel\n", film->sampling.max);
    else
        printf("samples    %d to %d a pixel, to an error of %g%s\n", film->sampling.min,
               film->sampling.max, film->sampling.error,
               film->sampling.edges ? ", at edges" : "");
}

static void print_things(const zt_contents *c) {
    const char *objects = "", *lights = "";
    printf("objects    ");
    list(&objects, c->plane_count, "plane", "planes");
    list(&objects, c->sphere_count, "sphere", "spheres");
    list(&objects, c->triangle_count, "triangle", "triangles");
    list(&objects, c->disk_count, "disk", "disks");
    list(&objects, c->box_count, "box", "boxes");
    list(&objects, c->cylinder_count, "cylinder", "cylinders");
    list(&objects, c->cone_count, "cone", "cones");
    list(&objects, c->torus_count, "torus", "tori");
    list(&objects, c->capsule_count, "capsule", "capsules");
    list(&objects, c->mesh_count, "mesh", "meshes");
    list(&objects, c->group_count, "group", "groups");
    puts(*objects ? "" : "none");
    printf("triangles  %" PRId64 "\n", c->triangle_count + c->mesh_triangle_count);
    printf("lights     ");
    list(&lights, c->ambient_light_count, "ambient", "ambient");
    list(&lights, c->point_light_count, "point", "point");
    list(&lights, c->disk_light_count, "disk", "disk");
    list(&lights, c->rectangle_light_count, "rectangle", "rectangle");
    puts(*lights ? "" : "none");
    printf("materials  %d\n", c->material_count);
}

/* How many letters a text in UTF-8 has. */
static int letter_count(const char *text) {
    int count = 0;
    for (; *text; text++) count += ((unsigned char)*text & 0xC0) != 0x80;
    return count;
}

/* A name, filled up to `width` letters; one that a stranger wrote does not command the
 * terminal. */
static void print_name(const char *name, int width) {
    int blank_count = width - letter_count(name);
    for (; *name; name++) putchar(iscntrl((unsigned char)*name) ? '?' : *name);
    printf("%*s", blank_count, "");
}

static void print_movements(const zt_animation *animation, int count) {
    int width = 0;
    for (int i = 0; i < count; i++) {
        int letters = letter_count(zt_animation_movement(animation, i).name);
        if (letters > width) width = letters;
    }
    for (int i = 0; i < count; i++) {
        zt_movement m = zt_animation_movement(animation, i);
        fputs(i == 0 ? "moves      " : "           ", stdout);
        print_name(m.name, width);
        printf("  %s", m.driver);
        if (m.key_count > 0) printf(", %d key%s", m.key_count, m.key_count == 1 ? "" : "s");
        if (m.key_count > 0 || m.last_s > m.first_s)
            printf(", %.6g s to %.6g s", m.first_s, m.last_s);
        putchar('\n');
    }
    if (count == 0) puts("moves      nothing");
}

void zt_report_contents(const zt_animation *animation) {
    zt_contents contents = zt_animation_contents(animation);
    zt_lens_words lens = zt_animation_lens(animation);
    print_film(zt_animation_film(animation));
    if (*lens.text) printf("lens       %s\n", lens.text);
    print_things(&contents);
    print_movements(animation, contents.track_count);
}

zt_status zt_report_finish(zt_report *report) {
    int refused = fflush(stdout) != 0 ? errno : ferror(stdout) ? EIO : 0;
    if (refused == 0) return ZT_OK;
    zt_report_say(report, ZT_ERROR, "cannot write to standard output: %s", strerror(refused));
    return ZT_EFILE;
}
