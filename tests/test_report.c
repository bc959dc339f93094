/* Shows that a report is complete and hangs together: the page with its chart, pictures and
 * tables, and the files beside it; and that a browser loads it without a complaint, at the
 * width of a desk and of a telephone. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "image/file.h"
#include "program.h"

static char *text_of(const char *path) {
    size_t size;
    return file_bytes(path, &size);
}

static int count_of(const char *text, const char *part) {
    int count = 0;
    for (; (text = strstr(text, part)); text += strlen(part)) count++;
    return count;
}

static void make_report(void) {
    run *r = zoetrope("report film.yaml --samples 8 --frame 2 -o made/r.html");
    if (r->code != 0) fail_msg("%s", r->err);
    assert_contains(r->err, "made/r.html: ");
    assert_contains(r->err, "for the film");
    assert_string_equal(r->out, "");
}

/* Six rungs of even samples, five each of adaptive ones and of edges, two in the other
 * precision. */
enum { RUNGS = 6 + 5 + 5 + 2 };

/* The page says all that it should, holds its pictures itself, and asks for nothing else. */
static void page(void **state) {
    (void)state;
    make_report();
    char *html = text_of("made/r.html");
    const char *words[] = {"<!DOCTYPE html>\n<html lang=\"en\">",
                           "<title>film.yaml: error against run time</title>",
                           "frame 2 and its neighbour",
                           "64 × 36",
                           "RMSE ≤ ",
                           "a frame",
                           "for the film",
                           "film: { ",
                           "to the power of",
                           "white noise",
                           "fitted: slope",
                           "the reference's own error",
                           "128 samples", /* of the reference */
                           "single precision: its roundings stay below what can be seen",
                           "Embree: there are no meshes",
                           "edges, error 0.005",
                           "8 samples",
                           "href=\"r.csv\"",
                           "Andersson et al. 2020",
                           "</html>"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) assert_contains(html, words[i]);
    assert_null(strstr(html, "nan"));
    assert_null(strstr(html, ">inf"));
    /* Three counts, one target each of two kinds: picture and map; the reference, the whole. */
    assert_int_equal(count_of(html, "src=\"data:image/png;base64,iVBOR"), 2 * 4 + 2);
    assert_int_equal(count_of(html, "<svg "), 2);
    assert_int_equal(count_of(html, "src=\""), count_of(html, "src=\"data:"));
    assert_int_equal(count_of(html, "http"), count_of(html, "http://www.w3.org/2000/svg"));
    assert_int_equal(count_of(html, "<img"), count_of(html, " alt=\""));
    assert_true(strlen(html) < 5 * 1000 * 1000);
    free(html);
}

/* A row for each rung, each of as many columns as the first; the same rungs as JSON. */
static void tables(void **state) {
    (void)state;
    make_report();
    char *csv = text_of("made/r.csv"), *json = text_of("made/r.json");
    assert_true(strncmp(csv, "kind,min,max,target,filter,precision,", 37) == 0);
    int rows = 0, columns = -1;
    for (char *line = csv, *end; (end = strstr(line, "\r\n")); line = end + 2, rows++) {
        int commas = 0;
        for (char *c = line; c < end; c++) commas += *c == ',';
        if (columns < 0) columns = commas;
        assert_int_equal(commas, columns);
    }
    assert_int_equal(rows, 1 + RUNGS);
    assert_int_equal(count_of(json, "\"kind\": "), RUNGS);
    const char *words[] = {"\"shadow_rays_avoided\":",
                           "\"mirror_rays_avoided\":",
                           "\"short_batches\":",
                           "\"libraries\": { \"OpenImageIO\": \"loaded\"",
                           "\"frames\": [2]",
                           "\"slope_of_rmse_by_samples\": -",
                           "\"slope_of_rmse_by_time\": ",
                           "\"file\": \"film.yaml\"",
                           "\"samples\": 128",
                           "\"setting\": \""};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) assert_contains(json, words[i]);
    assert_null(strstr(json, "nan"));
    assert_null(strstr(json, "inf,"));
    free(csv);
    free(json);
}

/* The chart is a drawing as it is, and as pixels, two for each of its units. */
static void chart(void **state) {
    (void)state;
    make_report();
    char *svg = text_of("made/r.svg");
    int width = 0, height = 0;
    assert_int_equal(sscanf(svg,
                            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" "
                            "height=\"%d\"",
                            &width, &height),
                     2);
    assert_contains(svg, "RMSE of linear light");
    assert_true(count_of(svg, "<circle") >= RUNGS);
    free(svg);
    zt_image *image;
    assert_int_equal(zt_image_file_read(&image, "made/r.png", (zt_listener){0}), ZT_OK);
    assert_int_equal(image->width, 2 * width);
    assert_int_equal(image->height, 2 * height);
    zt_image_free(&image);
}

static void misuse(void **state) {
    (void)state;
    const struct {
        const char *arguments, *told;
        int code;
    } cases[] = {
        {"report film.yaml -o r.pdf", "ends in .html", 2},
        {"report film.yaml -o .html", "ends in .html", 2},
        {"report film.yaml --frame 6", "6", 2},
        {"report film.yaml --frames 0-3", "report takes no --frames", 2},
        {"report film.yaml --samples 5000", "at most 4096", 2},
        {"report none.yaml", "none.yaml", 3},
        {"report film.yaml --samples 1 --frame 0 -o film.yaml/r.html", "film.yaml/r", 3},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run *r = zoetrope(cases[i].arguments);
        if (r->code != cases[i].code)
            fail_msg("zoetrope %s ended with %d: %s", cases[i].arguments, r->code, r->err);
        assert_contains(r->err, cases[i].told);
    }
    assert_int_equal(entry_count("."), 1); /* the description alone */
}

/* By default the middle frame, and beside the other results. */
static void defaults(void **state) {
    (void)state;
    zoetrope_succeeds("report film.yaml -q --samples=1 --size=16x8 --precision=double");
    char *html = text_of("output/film.report.html");
    assert_contains(html, "frame 3 and its neighbour");
    assert_contains(html, "double precision, as asked for");
    free(html);
    zoetrope_succeeds(
        "report film.yaml --samples=4 --size=16x8 --frame=0,2 --filters -o f.html");
    html = text_of("f.html");
    assert_contains(html, "frames 0, 2, each with its neighbour");
    assert_contains(html, "4 samples, blackman-harris filter");
    free(html);
}

/* ---- in a browser --------------------------------------------------------------------------
 */

static const char *const browsers[] = {"/usr/bin/chromium", "/usr/bin/chromium-browser",
                                       "/usr/bin/google-chrome"};

static const char *find_browser(void) {
    for (size_t i = 0; i < sizeof browsers / sizeof *browsers; i++)
        if (access(browsers[i], X_OK) == 0) return browsers[i];
    return NULL;
}

/* Loads a page; what it became is in dom.html, and what the browser told in told.txt. */
static void load(const char *browser, const char *path) {
    char command[1024];
    snprintf(command, sizeof command,
             "HOME=. timeout 200 %s --headless --no-sandbox --disable-gpu "
             "--user-data-dir=profile --host-resolver-rules='MAP * ~NOTFOUND' "
             "--enable-logging=stderr --window-size=1400,900 --virtual-time-budget=2000 "
             "--dump-dom \"file://$PWD/%s\" > dom.html 2> told.txt",
             browser, path);
    int code = system(command);
    if (code != 0) fail_msg("%s ended with %d", browser, code);
}

/* The report's page with something added at its end, in a frame of its own that is so wide: a
 * browser's window cannot be as narrow as a telephone. What the page posts becomes the title.
 */
static void load_added(const char *browser, const char *before, const char *middle,
                       const char *after, int width) {
    char *html = text_of("made/r.html"), *text;
    assert_true(asprintf(&text, "%s%s%s%s", html, before, middle, after) > 0);
    FILE *file = fopen("made/p.html", "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
    free(text);
    free(html);
    assert_true(asprintf(&text,
                         "<title>nothing</title><script>onmessage=function(e){document.title="
                         "e.data}</script><iframe src=\"p.html\" width=\"%d\" height=\"900\" "
                         "style=\"border:0\"></iframe>",
                         width) > 0);
    write_text("made/frame.html", text);
    free(text);
    load(browser, "made/frame.html");
}

/* The script has run, nothing was complained about, nothing reaches beyond the window, and the
 * JSON beside the page is JSON; a page that is wrong is complained about. */
static void browser(void **state) {
    (void)state;
    const char *program = find_browser();
    if (!program) skip();
    make_report();
    char *json = text_of("made/r.json");
    for (int i = 0; i < 2; i++) {
        int width = i == 0 ? 1280 : 400, inner = 0, outer = 0, rungs = 0, buttons = 0;
        load_added(program, "<script>var r=", json,
                   ";parent.postMessage(document.documentElement.className+' '+innerWidth+' '+"
                   "document.documentElement.scrollWidth+' '+r.rungs.length+' '+"
                   "document.querySelectorAll('button').length+' '+"
                   "getComputedStyle(document.querySelector('.narrow')).display,'*')</script>",
                   width);
        char *dom = text_of("dom.html"), *told = text_of("told.txt");
        if (strstr(told, "CONSOLE")) fail_msg("%s", told);
        char *title = strstr(dom, "<title>live "), display[16];
        if (!title) fail_msg("%s", dom);
        assert_int_equal(sscanf(title, "<title>live %d %d %d %d %15[a-z]", &inner, &outer,
                                &rungs, &buttons, display),
                         5);
        assert_int_equal(inner, width);
        assert_true(outer <= width);
        assert_int_equal(rungs, RUNGS);
        assert_int_equal(buttons, 5);
        assert_string_equal(display, i == 0 ? "none" : "block");
        free(dom);
        free(told);
    }
    load_added(program, "<script>", "no.such.thing", "</script>", 1280);
    char *told = text_of("told.txt");
    assert_contains(told, "CONSOLE");
    free(told);
    free(json);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        IN_DIRECTORY(page),   IN_DIRECTORY(tables),   IN_DIRECTORY(chart),
        IN_DIRECTORY(misuse), IN_DIRECTORY(defaults), IN_DIRECTORY(browser),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
