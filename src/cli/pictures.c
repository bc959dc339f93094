#include "cli/pictures.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PIECE_WIDTH = 192, PIECE_HEIGHT = 128, WHOLE_WIDTH = 720 };

const double zt_map_least = 1e-4, zt_map_most = 1;

/* Five colours of Matplotlib's "magma" (N. Smith and S. van der Walt, 2015). */
const char *const zt_map_stops[ZT_MAP_STOP_COUNT] = {"#000004", "#51127c", "#b73779", "#fc8961",
                                                     "#fcfdbf"};

/* ---- PNG in base64 -------------------------------------------------------------------------
 */

static char *base64(const unsigned char *bytes, size_t count) {
    static const char digits[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/=";
    char *text = malloc((count + 2) / 3 * 4 + 1), *to = text;
    for (size_t i = 0; text && i < count; i += 3) {
        size_t left = count - i < 3 ? count - i : 3;
        unsigned group = 0;
        for (size_t k = 0; k < 3; k++) group = group << 8 | (k < left ? bytes[i + k] : 0);
        for (size_t k = 0; k < 4; k++)
            *to++ = digits[k <= left ? group >> (18 - 6 * k) & 63 : 64];
    }
    if (text) *to = '\0';
    return text;
}

static zt_status read_base64(char **text, const char *path) {
    FILE *file = fopen(path, "rb");
    if (!file) return ZT_EFILE;
    unsigned char *bytes = NULL;
    size_t used = 0, capacity = 0;
    for (size_t got = 1; got > 0; used += got) {
        if (used == capacity) {
            unsigned char *more = realloc(bytes, capacity = 2 * capacity + 65536);
            if (!more) break;
            bytes = more;
        }
        got = fread(bytes + used, 1, capacity - used, file);
    }
    bool good = feof(file) && !ferror(file);
    fclose(file);
    *text = good ? base64(bytes, used) : NULL;
    free(bytes);
    return good ? *text ? ZT_OK : ZT_EMEMORY : ZT_EFILE;
}

/* An image file is made in a directory of its own, and goes away with it. */
static zt_status encode(char **text, const zt_image *image, zt_view view,
                        zt_listener listener) {
    char directory[] = "/tmp/zoetrope-XXXXXX", path[sizeof directory + 16];
    if (!mkdtemp(directory)) return ZT_EFILE;
    snprintf(path, sizeof path, "%s/picture.png", directory);
    zt_output_format format = {.width = image->width,
                               .height = image->height,
                               .rate = {1, 1},
                               .view = view,
                               .frame_count = 1};
    zt_output *output;
    zt_status status = zt_output_open(&output, path, &format, NULL, listener);
    if (status == ZT_OK) {
        status = zt_output_write(output, image, 0);
        zt_status closed = zt_output_close(&output);
        if (status == ZT_OK) status = closed;
    }
    if (status == ZT_OK) status = read_base64(text, path);
    unlink(path);
    rmdir(directory);
    return status;
}

/* ---- pieces --------------------------------------------------------------------------------
 */

static const float *pixel_at(const zt_image *image, int x, int y) {
    return image->pixels + 4 * ((size_t)y * (size_t)image->width + (size_t)x);
}

static float *own_pixel(zt_image *image, int x, int y) {
    return image->pixels + 4 * ((size_t)y * (size_t)image->width + (size_t)x);
}

static double difference(const zt_image *image, const zt_image *reference, int x, int y) {
    const float *a = pixel_at(image, x, y), *b = pixel_at(reference, x, y);
    double sum = 0;
    for (int c = 0; c < 3; c++) sum += fabs((double)a[c] - (double)b[c]);
    return sum / 3;
}

static int min_int(int a, int b) { return a < b ? a : b; }

/* The piece in which most is wrong, where pieces may begin at each half of their size. */
static void choose_piece(zt_pictures *p, const zt_image *image, const zt_image *reference) {
    p->frame_width = image->width;
    p->frame_height = image->height;
    p->width = min_int(PIECE_WIDTH, image->width);
    p->height = min_int(PIECE_HEIGHT, image->height);
    double worst = -1;
    for (int top = 0; top + p->height <= image->height; top += (p->height + 1) / 2)
        for (int left = 0; left + p->width <= image->width; left += (p->width + 1) / 2) {
            double sum = 0;
            for (int y = top; y < top + p->height; y++)
                for (int x = left; x < left + p->width; x++)
                    sum += difference(image, reference, x, y);
            if (sum <= worst) continue;
            worst = sum;
            p->x = left;
            p->y = top;
        }
}

static zt_status encode_piece(char **text, const zt_pictures *p, const zt_image *image) {
    zt_image *piece;
    zt_status status = zt_image_create(&piece, p->width, p->height);
    if (status != ZT_OK) return status;
    for (int y = 0; y < p->height; y++)
        memcpy(own_pixel(piece, 0, y), pixel_at(image, p->x, p->y + y),
               4 * sizeof(float) * (size_t)p->width);
    status = encode(text, piece, p->view, p->listener);
    zt_image_free(&piece);
    return status;
}

static void color_of(float *pixel, double error) {
    double share =
        log(fmax(error, zt_map_least) / zt_map_least) / log(zt_map_most / zt_map_least);
    double place = fmin(share, 1) * (ZT_MAP_STOP_COUNT - 1);
    int stop = min_int((int)place, ZT_MAP_STOP_COUNT - 2);
    long from = strtol(zt_map_stops[stop] + 1, NULL, 16),
         to = strtol(zt_map_stops[stop + 1] + 1, NULL, 16);
    for (int c = 0; c < 3; c++) {
        double a = (double)(from >> (16 - 8 * c) & 255), b = (double)(to >> (16 - 8 * c) & 255);
        pixel[c] = (float)((a + (place - stop) * (b - a)) / 255);
    }
}

static zt_status encode_map(char **text, const zt_pictures *p, const zt_image *image,
                            const zt_image *reference) {
    zt_image *map;
    zt_status status = zt_image_create(&map, p->width, p->height);
    if (status != ZT_OK) return status;
    for (int y = 0; y < p->height; y++)
        for (int x = 0; x < p->width; x++)
            color_of(own_pixel(map, x, y), difference(image, reference, p->x + x, p->y + y));
    status = encode(text, map, ZT_VIEW_RAW, p->listener);
    zt_image_free(&map);
    return status;
}

/* All of a frame, each pixel the mean of a square of them. */
static zt_status encode_whole(zt_pictures *p, const zt_image *image) {
    int step = (image->width + WHOLE_WIDTH - 1) / WHOLE_WIDTH;
    p->whole_width = image->width / step;
    p->whole_height = image->height / step > 0 ? image->height / step : 1;
    zt_image *whole;
    zt_status status = zt_image_create(&whole, p->whole_width, p->whole_height);
    if (status != ZT_OK) return status;
    for (int y = 0; y < p->whole_height; y++)
        for (int x = 0; x < p->whole_width; x++)
            for (int c = 0; c < 3; c++) {
                float sum = 0;
                for (int k = 0; k < step * step; k++)
                    sum += pixel_at(image, x * step + k % step,
                                    min_int(y * step + k / step, image->height - 1))[c];
                own_pixel(whole, x, y)[c] = sum / (float)(step * step);
            }
    status = encode(&p->whole.png, whole, p->view, p->listener);
    zt_image_free(&whole);
    return status;
}

/* ---- which ---------------------------------------------------------------------------------
 */

/* Even samples by powers of four; of those that look for themselves, the middle target. */
static bool is_kept(const zt_pictures *p, const zt_rung *rung) {
    int samples = rung->sampling.max;
    bool power = (samples & (samples - 1)) == 0 && (samples & 0x55555555) != 0;
    bool even = rung->kind == ZT_RUNG_SAMPLES;
    return p->count < ZT_PICTURES_MAX && !rung->other_precision && rung->reference == 0 &&
           (even ? power : rung->sampling.error == 0.01);
}

static zt_status keep(zt_pictures *p, const zt_rung *rung, const zt_image *image,
                      const zt_image *reference) {
    zt_status status = ZT_OK;
    if (!p->whole.png) {
        choose_piece(p, image, reference);
        status = encode_whole(p, reference);
        if (status == ZT_OK) status = encode_piece(&p->reference.png, p, reference);
    }
    zt_picture *picture = &p->pictures[p->count++];
    picture->rung = *rung;
    if (status == ZT_OK) status = encode_piece(&picture->png, p, image);
    if (status == ZT_OK) status = encode_map(&picture->map, p, image, reference);
    return status;
}

void zt_pictures_show(void *user, const zt_rung *rung, const zt_image *image,
                      const zt_image *reference) {
    zt_pictures *p = user;
    if (p->status == ZT_OK && is_kept(p, rung)) p->status = keep(p, rung, image, reference);
}

void zt_pictures_free(zt_pictures *p) {
    for (int i = 0; i < p->count; i++) {
        free(p->pictures[i].png);
        free(p->pictures[i].map);
    }
    free(p->reference.png);
    free(p->whole.png);
}
