/* A browser plays what was written: Chromium, in a page, reports the size, the duration and the
 * colours of a test card. Skipped where there is no Chromium. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "files.h"
#include "movies.h"

enum { CARD = 32, WIDTH = PATCH_COLUMNS * CARD, HEIGHT = PATCH_COUNT / PATCH_COLUMNS * CARD };
enum { RATE = 24, FRAME_COUNT = 24, SECOND = 1000000 };

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

/* What is played, and how: images are counted frame by frame, films are played to their end.
 * Durations are in microseconds. */
typedef struct recording {
    const char *name;
    bool is_image;
    int duration, duration_tolerance;
    int tolerance; /* of a colour, in codes */
} recording;

/* The card, for a second. */
static void write_film(const char *path) {
    const zt_output_format format = {.width = WIDTH,
                                     .height = HEIGHT,
                                     .rate = {RATE, 1},
                                     .view = ZT_VIEW_SRGB,
                                     .frame_count = FRAME_COUNT};
    zt_output *output = open_movie(path, &format);
    zt_image *card = test_card(CARD);
    for (int f = 0; f < FRAME_COUNT; f++)
        assert_int_equal(zt_output_write(output, card, f), ZT_OK);
    close_movie(&output);
    zt_image_free(&card);
}

/* Once the frames are all there (completed), the track that has them may still be unknown
 * (ready). */
static const char count_frames[] =
    "async function count() {\n"
    "  await f.decode();\n"
    "  const data = await (await fetch(f.src)).arrayBuffer();\n"
    "  const type = 'image/' + f.src.split('.').pop();\n"
    "  const decoder = new ImageDecoder({data, type});\n"
    "  await decoder.tracks.ready;\n"
    "  await decoder.completed;\n"
    "  const frames = decoder.tracks.selectedTrack.frameCount;\n"
    "  let us = 0;\n"
    "  for (let i = 0; i < frames; i++) {\n"
    "    const {image} = await decoder.decode({frameIndex: i});\n"
    "    us += image.duration;\n"
    "    image.close();\n"
    "  }\n"
    "  see(f.naturalWidth, f.naturalHeight, frames, us);\n"
    "}\n"
    "count().catch(fail);\n";
static const char play_to_end[] =
    "f.onended = () => see(f.videoWidth, f.videoHeight, 0, Math.round(1e6 * f.duration));\n"
    "f.onerror = () => fail(f.error);\n";

/* The page plays a film to its end, or decodes each frame of an image, draws it, and then logs
 * what it has seen: the width, the height, the count of frames (0 of a film, whose page is not
 * told), microseconds, and R G B of the middle of each patch. */
static void write_page(const char *page, const recording *recording) {
    FILE *file = fopen(page, "w");
    assert_non_null(file);
    fprintf(
        file,
        "<!doctype html><body><%s id=f src=\"%s\"%s<script>\n"
        "const f = document.getElementById('f');\n"
        "function see(w, h, frames, us) {\n"
        "  const c = document.createElement('canvas'); c.width = w; c.height = h;\n"
        "  const g = c.getContext('2d'); g.drawImage(f, 0, 0);\n"
        "  let s = 'seen ' + w + ' ' + h + ' ' + frames + ' ' + us;\n"
        "  for (let p = 0; p < %d; p++) {\n"
        "    const d = g.getImageData(p %% %d * %d + %d, Math.floor(p / %d) * %d + %d, 1, 1);\n"
        "    s += ' ' + d.data[0] + ' ' + d.data[1] + ' ' + d.data[2];\n"
        "  }\n"
        "  console.log(s + ' end');\n"
        "}\n"
        "function fail(error) { console.log('seen nothing: ' + error.message + ' end'); }\n",
        recording->is_image ? "img" : "video muted autoplay", recording->name,
        recording->is_image ? ">" : "></video>", (int)PATCH_COUNT, (int)PATCH_COLUMNS,
        (int)CARD, (int)CARD / 2, (int)PATCH_COLUMNS, (int)CARD, (int)CARD / 2);
    fputs(recording->is_image ? count_frames : play_to_end, file);
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
static void assert_seen(const recording *recording) {
    const char *name = recording->name;
    char text[16384], page[64];
    snprintf(page, sizeof page, "%s.html", name);
    write_film(name);
    write_page(page, recording);
    show(text, sizeof text, page);
    const char *seen = strstr(text, "seen ");
    int width, height, frames, us, length;
    if (!seen ||
        sscanf(seen, "seen %d %d %d %d%n", &width, &height, &frames, &us, &length) != 4)
        fail_msg("%s: the page says: \"%s\"", name, text);
    assert_int_equal(width, WIDTH);
    assert_int_equal(height, HEIGHT);
    assert_int_equal(frames, recording->is_image ? FRAME_COUNT : 0);
    if (abs(us - recording->duration) > recording->duration_tolerance)
        fail_msg("%s: %d us instead of %d", name, us, recording->duration);
    seen += length;
    for (int p = 0; p < PATCH_COUNT; p++)
        for (int c = 0; c < 3; c++) {
            int sent = (int)(255 * display_value((double)patches[p][c], ZT_VIEW_SRGB) + 0.5);
            int found = (int)strtol(seen, (char **)&seen, 10);
            bool is_film_blue = c == 2 && !recording->is_image;
            if (abs(found - sent) > (is_film_blue ? LIBYUV_BLUE : recording->tolerance))
                fail_msg("%s, patch %d, channel %d: %d instead of %d", name, p, c, found, sent);
        }
}

/* MP4, WebM, GIF and APNG have the size, last as long as they should and show the colours;
 * those that are no codes are dithered. A GIF's hundredths of a second add up to the second
 * exactly; of each frame of an APNG, Chromium counts whole milliseconds only. */
static void plays(void **state) {
    (void)state;
    if (!browser()) skip();
    static const recording recordings[] = {
        {"film.mp4", false, SECOND, 1000, 4},
        {"film.webm", false, SECOND, 1000, 4},
        {"film.gif", true, SECOND, 0, 4},
        {"film.apng", true, FRAME_COUNT * (1000 / RATE) * 1000, 0, 1},
    };
    for (int i = 0; i < 4; i++) assert_seen(&recordings[i]);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(plays)};
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
