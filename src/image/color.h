/* A view of an OpenColorIO configuration, ready for use. OpenColorIO comes with OpenImageIO:
 * the door is color.cpp, in the module of image files. */
#ifndef ZT_IMAGE_COLOR_H
#define ZT_IMAGE_COLOR_H

#include <zoetrope/color.h>
#include <zoetrope/status.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct zt_color zt_color;
struct zt_color {
    /* Of `count` pixels, R G B each, linear light becomes numbers of the display, in place.
     * From any thread. */
    void (*apply)(const zt_color *color, float *pixels, int count);
    void (*close)(zt_color *color);
    const char *manner; /* all that decides the numbers, as a text: the names, and a hash of the
                           configuration and of what it does */
};

/* Opens what is wished for; NULL where nothing is. ZT_EFILE, ZT_EARGUMENT after telling what
 * there is instead; ZT_EUNSUPPORTED where there is no OpenColorIO. */
zt_status zt_color_open(zt_color **color, const zt_color_wish *wish, zt_listener listener);
void zt_color_close(zt_color **color);

#ifdef __cplusplus
}
#endif
#endif
