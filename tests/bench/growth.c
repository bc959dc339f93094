/* What a frame costs with ten times as much in the scene: triangles, moving spheres, instances.
 * The films are written here, in the documents' room; their things fill the same space,
 * whatever their number. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "bench.h"
#include "measure.h"

enum { ROUNDS = 5, FRAMES = 2 };

static double draw(uint64_t key, double low, double high) {
    return low + (high - low) * (double)(zt_random_mix(key) >> 11) * 0x1p-53;
}

static FILE *open_file(const char *name) {
    FILE *file = fopen(scratch_path(name), "wb");
    must_be(file != NULL, "cannot write a film");
    return file;
}

static void close_file(FILE *file) { must_be(fclose(file) == 0, "cannot write a film"); }

/* The room's objects follow, and those of the measurement behind them. */
static FILE *begin_film(void) {
    FILE *file = open_file("film.yaml");
    fprintf(file,
            "zoetrope: 1\n"
            "film: { size: [1280, 720], rate: 24, duration: 96, view: raw, reflections: 4 }\n"
            "camera: { position: [1.2, 2.4, 7.5], look_at: [-0.2, 1.3, 0], fov: 40 deg }\n"
            "materials:\n"
            "  mirror: { color: [0.6, 0.55, 0.5], reflectivity: 0.35 }\n"
            "  matte: { color: [0.75, 0.8, 0.95] }\n"
            "%s",
            documents_room);
    return file;
}

/* A place in the room for thing number `i`. */
static void draw_place(double place[3], int i) {
    uint64_t key = zt_random_key(4, (uint64_t)i);
    place[0] = draw(key, -2.5, 2.5);
    place[1] = draw(key + 1, 0.3, 2.7);
    place[2] = draw(key + 2, -2.5, 1.5);
}

/* The share of the room's space that a thing has, as a length. */
static double share(int count) { return cbrt(5 * 2.4 * 4 / count); }

static void write_spheres(int count) {
    FILE *file = begin_film();
    for (int i = 0; i < count; i++) {
        double p[3];
        draw_place(p, i);
        fprintf(file,
                "  - sphere: { radius: %.5f, material: matte, center: { curve: linear, keys: "
                "{ 0: [%.5f, %.5f, %.5f], 95: [%.5f, %.5f, %.5f] } } }\n",
                0.3 * share(count), p[0], p[1], p[2], p[0] + 0.1, p[1], p[2] + 0.1);
    }
    close_file(file);
}

static void write_instances(int count) {
    FILE *file = begin_film();
    for (int i = 0; i < count; i++) {
        double p[3];
        draw_place(p, i);
        fprintf(file,
                "  - mesh: { file: " ZT_BENCH_SOURCE_DIR
                "/animations/models/knot.ply, scale: %.5f, rotation: [%d, %d, 0], "
                "position: [%.5f, %.5f, %.5f], material: matte }\n",
                0.35 * share(count), i % 360, i * 7 % 360, p[0], p[1], p[2]);
    }
    close_file(file);
}

static void put(FILE *file, const void *data, size_t size) {
    must_be(fwrite(data, 1, size, file) == size, "cannot write a model");
}

/* A torus with waves on it: `around` by `across` pairs of triangles. */
static void write_model(uint32_t around, uint32_t across) {
    FILE *file = open_file("model.ply");
    fprintf(file,
            "ply\nformat binary_little_endian 1.0\nelement vertex %" PRIu32
            "\nproperty float x\nproperty float y\nproperty float z\nelement face %" PRIu32
            "\nproperty list uchar int vertex_indices\nend_header\n",
            around * across, 2 * around * across);
    double turn = 2 * acos(-1);
    for (uint32_t i = 0; i < around; i++)
        for (uint32_t j = 0; j < across; j++) {
            double u = turn * i / around, v = turn * j / across;
            double tube = 0.4 + 0.03 * sin(20 * u) * sin(8 * v), r = 1 + tube * cos(v);
            float p[3] = {(float)(r * cos(u)), (float)(r * sin(u)), (float)(tube * sin(v))};
            put(file, p, sizeof p);
        }
    for (uint32_t i = 0; i < around; i++)
        for (uint32_t j = 0; j < across; j++) {
            uint32_t next = (i + 1) % around, up = (j + 1) % across;
            uint32_t a = i * across + j, b = next * across + j, c = next * across + up,
                     d = i * across + up;
            uint32_t faces[2][3] = {{a, b, c}, {a, c, d}};
            for (int k = 0; k < 2; k++) {
                put(file, &(uint8_t){3}, 1);
                put(file, faces[k], sizeof faces[k]);
            }
        }
    close_file(file);
}

static void write_triangles(int count) {
    uint32_t across = (uint32_t)sqrt(count / 8.0);
    write_model((uint32_t)count / 2 / across, across);
    FILE *file = begin_film();
    fprintf(file, "  - mesh: { file: model.ply, scale: 1.1, rotation: [-30, 25, 0], "
                  "position: [0.2, 1.5, -0.2], material: matte }\n");
    close_file(file);
}

static const struct {
    const char *what;
    int few;
    void (*write)(int count);
} rows[] = {{"triangles in a mesh", 100000, write_triangles},
            {"moving spheres", 10000, write_spheres},
            {"instances of the knot", 100, write_instances}};

static frames open_grown(zt_animation **animation, void (*write)(int count), int count) {
    write(count);
    *animation = film_open(scratch_path("film.yaml"), NULL);
    return frames_open(*animation, (zt_render_settings){0}, FRAMES);
}

void bench_growth(void) {
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        zt_animation *animations[2];
        frames opened[2];
        runner runners[2];
        char names[2][64];
        for (int k = 0; k < 2; k++) {
            int count = k ? 10 * rows[i].few : rows[i].few;
            snprintf(names[k], sizeof names[k], "%d %s", count, rows[i].what);
            opened[k] = open_grown(&animations[k], rows[i].write, count);
            runners[k] = (runner){.name = names[k], .run = frames_run, .user = &opened[k]};
        }
        race(runners, 2, ROUNDS);
        print_title("growth: %s, in the room, 1 sample", rows[i].what);
        for (int k = 0; k < 2; k++) {
            print_spent(runners[k].name, runners[k].median);
            if (k) print_ratio(runners[1].median.wall_s / runners[0].median.wall_s, -2.5);
            print_end();
            frames_close(&opened[k]);
            zt_animation_free(&animations[k]);
        }
    }
}
