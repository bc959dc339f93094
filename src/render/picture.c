#include "render/picture.h"

#include <stdlib.h>

#include "base/diag.h"
#include "base/pages.h"
#include "render/work.h"

void zt_picture_close(zt_picture *p) {
    free(p->pixels);
    free(p->footprints);
    free(p->paths);
    zt_rounds_close(&p->rounds);
    zt_arena_free(&p->arena);
    *p = (zt_picture){0};
}

zt_status zt_picture_open(zt_picture *p, int width, int height) {
    if (p->width == width && p->height == height) return ZT_OK;
    zt_picture_close(p);
    p->pixels = zt_pages_alloc(4 * (size_t)width * (size_t)height * sizeof *p->pixels);
    p->footprints =
        calloc((size_t)zt_tile_count(width, height) * ZT_PICTURE_PARTS, sizeof *p->footprints);
    if (!p->pixels || !p->footprints) {
        zt_picture_close(p);
        return ZT_EMEMORY;
    }
    p->width = width;
    p->height = height;
    return ZT_OK;
}

zt_status zt_picture_open_edges(zt_picture *p, bool is_signed) {
    if (!p->paths) p->paths = calloc((size_t)p->width * (size_t)p->height, sizeof *p->paths);
    if (!p->paths) return ZT_EMEMORY;
    return zt_rounds_open(&p->rounds, p->width, p->height, is_signed);
}
