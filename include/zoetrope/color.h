/* Views of OpenColorIO: the display transforms that a studio keeps in a configuration. */
#ifndef ZOETROPE_COLOR_H
#define ZOETROPE_COLOR_H

#include <stdbool.h>

/* A view that counts instead of a zt_view, by the names that the configuration gives. */
typedef struct zt_color_wish {
    bool wished;         /* else the rest says nothing */
    const char *config;  /* a file; NULL: the one that $OCIO names */
    const char *display; /* NULL: the configuration's own */
    const char *view;    /* NULL: the display's own */
} zt_color_wish;

#endif
