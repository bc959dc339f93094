/* Looks for bytes that harm the PLY reader, by libFuzzer:
 *
 *     clang -g -O1 -fsanitize=fuzzer,address,undefined -D_GNU_SOURCE -Iinclude -Isrc \
 *         tests/fuzz/ply.c src/description/{ply,ply_header,ply_rows,triangulate,normals}.c \
 *         src/image/develop.c src/base/{arena,diag,text}.c -lm -o /tmp/fuzz_ply
 *     /tmp/fuzz_ply -max_len=4096 -timeout=2 -rss_limit_mb=512 a_copy_of_some_models/
 */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include "description/ply.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

/* Indices of vertices, unit normals, light. */
static void check(const zt_mesh *mesh) {
    for (int64_t i = 0; i < 3 * (int64_t)mesh->triangle_count; i++)
        if (mesh->triangles[i] >= (uint32_t)mesh->vertex_count) abort();
    for (int64_t i = 0; i < mesh->vertex_count && mesh->normals; i++) {
        const float *n = mesh->normals + 3 * i;
        if (!(fabsf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-5f)) abort();
    }
    for (int64_t i = 0; i < 3 * (int64_t)mesh->vertex_count && mesh->colors; i++)
        if (!(mesh->colors[i] >= 0 && mesh->colors[i] < 1e31f)) abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    static int file = -1; /* in memory, written anew each time */
    if (file < 0) file = memfd_create("ply", MFD_CLOEXEC);
    char path[64];
    snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    if (ftruncate(file, 0) != 0 || pwrite(file, bytes, size, 0) != (ssize_t)size) abort();
    zt_arena arena = {0};
    zt_mesh mesh;
    if (zt_ply_read(&mesh, &arena, path, ZT_PLY_NORMALS | ZT_PLY_COLORS, NULL,
                    (zt_listener){0}) == ZT_OK)
        check(&mesh);
    zt_arena_free(&arena);
    return 0;
}
