/* Drawings: pictures made of lines and words, as SVG. */
#ifndef ZOETROPE_DRAWING_H
#define ZOETROPE_DRAWING_H

#include <stddef.h>

#include <zoetrope/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Writes a drawing, `length` bytes of SVG, to `target`: as it is where that ends in .svg, as
 * pixels, two for each unit of the drawing's size, where it ends in .png. The file has its name
 * only once it is complete; missing directories are made. ZT_EARGUMENT for other endings,
 * ZT_EFILE, ZT_EUNSUPPORTED where librsvg is not there; all of them told. */
zt_status zt_drawing_write(const char *target, const char *svg, size_t length,
                           zt_listener listener);

#ifdef __cplusplus
}
#endif
#endif
