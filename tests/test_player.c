/* A browser plays what was written: Chromium, in a page, reports the size, the duration and the
 * colours of a test card. Skipped where there is no Chromium. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "files.h"
#include "movies.h"

enum { CARD = 32, WIDTH = PATCH_COLUMNS * CARD, HEIGHT = PATCH_COUNT / PATCH_COLUMNS * CARD };
enum { FRAME_COUNT = 24 };

/* Without a graphics card, Chromium converts by libyuv, whose factor from Cb to blue is at most
 * 2 where BT.709 has 2.11. */
enum { LIBYUV_BLUE = 15 };

static const char *browser(void) {
    static const char *const names[] = {"chromium", "chromium-browser", "google-chrome"};
    for (int i = 0; i < 3; i++) {
        char command[64];
        snprintf(command, sizeof command, "command -v %s >/dev/null 2>&1", names[i]);
        if (system(command) == 0) return names[i];
    }
    return NULL;
}

/* The card, for a second. */
static void write_film(const char *path) {
    const zt_output_format format = {.width = WIDTH,
                                     .height = HEIGHT,
                                     .rate = {24, 1},
                                     .view = ZT_VIEW_SRGB,
                                     .frame_count = FRAME_COUNT};
    zt_output *output = open_movie(path, &format);
    zt_image *card = test_card(CARD);
    for (int f = 0; f < FRAME_COUNT; f++)
        assert_int_equal(zt_output_write(output, card, f), ZT_OK);
    close_movie(&output);
    zt_image_free(&card);
}

/* The page plays a film to its end, draws it, and then logs what it has seen: the width, the
 * height, milliseconds, and R G B of the middle of each patch. */
static void write_page(const char *page, const char *film, bool is_image) {
    FILE *file = fopen(page, "w");
    assert_non_null(file);
    fprintf(
        file,
        "<!doctype html><body><%s id=f src=\"%s\"%s<script>\n"
        "const f = document.getElementById('f');\n"
        "function see(w, h, ms) {\n"
        "  const c = document.createElement('canvas'); c.width = w; c.height = h;\n"
        "  const g = c.getContext('2d'); g.drawImage(f, 0, 0);\n"
        "  let s = 'seen ' + w + ' ' + h + ' ' + ms;\n"
        "  for (let p = 0; p < %d; p++) {\n"
        "    const d = g.getImageData(p %% %d * %d + %d, Math.floor(p / %d) * %d + %d, 1, 1);\n"
        "    s += ' ' + d.data[0] + ' ' + d.data[1] + ' ' + d.data[2];\n"
        "  }\n"
        "  console.log(s + ' end');\n"
        "}\n",
        is_image ? "img" : "video muted autoplay", film, is_image ? ">" : "></video>",
        (int)PATCH_COUNT, (int)PATCH_COLUMNS, (int)CARD, (int)CARD / 2, (int)PATCH_COLUMNS,
        (int)CARD, (int)CARD / 2);
    fputs(is_image
              ? "f.onload = () => see(f.naturalWidth, f.naturalHeight, 0);\n"
              : "f.onended = () => see(f.videoWidth, f.videoHeight,\n"
                "                      Math.round(1000 * f.duration));\n"
                "f.onerror = () => console.log('seen nothing: ' + f.error.message + ' end');\n",
          file);
    fputs("</script></body>\n", file);
    assert_int_equal(fclose(file), 0);
}

/* What the page logs: Chromium runs until that is there, for a minute at most. */
static void show(char *text, size_t size, const char *page) {
    char command[1024];
    snprintf(command, sizeof command,
             "exec 2>/dev/null; : >log.txt; timeout -k 5 60 %s --headless --no-sandbox "
             "--disable-gpu "
             "--force-color-profile=srgb --user-data-dir=profile "
             "--allow-file-access-from-files --autoplay-policy=no-user-gesture-required "
             "--enable-logging=stderr file://$PWD/%s 2>>log.txt & browser=$!; "
             "while kill -0 $browser 2>/dev/null && ! grep -q 'seen .* end' log.txt; do "
             "sleep 0.1; done; kill $browser; wait $browser; grep 'seen .* end' log.txt",
             browser(), page);
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    text[fread(text, 1, size - 1, pipe)] = '\0';
    pclose(pipe);
}

/* Reads what is seen and compares it with what was sent. */
static void assert_seen(const char *film, bool is_image, int tolerance) {
    char text[16384], page[64];
    snprintf(page, sizeof page, "%s.html", film);
    write_film(film);
    write_page(page, film, is_image);
    show(text, sizeof text, page);
    const char *seen = strstr(text, "seen ");
    int width, height, ms, length;
    if (!seen || sscanf(seen, "seen %d %d %d%n", &width, &height, &ms, &length) != 3)
        fail_msg("%s: the page says: \"%s\"", film, text);
    assert_int_equal(width, WIDTH);
    assert_int_equal(height, HEIGHT);
    if (!is_image) assert_in_range(ms, 999, 1001);
    seen += length;
    for (int p = 0; p < PATCH_COUNT; p++)
        for (int c = 0; c < 3; c++) {
            int sent = (int)(255 * display_value((double)patches[p][c], ZT_VIEW_SRGB) + 0.5);
            int found = (int)strtol(seen, (char **)&seen, 10);
            if (abs(found - sent) > (c == 2 && !is_image ? LIBYUV_BLUE : tolerance))
                fail_msg("%s, patch %d, channel %d: %d instead of %d", film, p, c, found, sent);
        }
}

/* MP4 and WebM play as long as they should, MP4, WebM, GIF and APNG show the colours; those
 * that are no codes are dithered. */
static void plays(void **state) {
    (void)state;
    if (!browser()) skip();
    assert_seen("film.mp4", false, 4);
    assert_seen("film.webm", false, 4);
    assert_seen("film.gif", true, 4);
    assert_seen("film.apng", true, 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(plays)};
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
