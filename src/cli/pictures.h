/* Pictures of a ladder, for a page: small pieces of its frames with maps of where they are
 * wrong, as PNG in base64. */
#ifndef ZT_CLI_PICTURES_H
#define ZT_CLI_PICTURES_H

#include "cli/findings.h"

enum { ZT_PICTURES_MAX = 10, ZT_MAP_STOP_COUNT = 5 };

typedef struct zt_picture {
    zt_rung rung;    /* a copy, without its means over frames; unused in the reference's */
    char *png, *map; /* owned; of the reference no map */
} zt_picture;

/* Zeroed but for the first: nothing has been shown yet. */
typedef struct zt_pictures {
    zt_listener listener;
    zt_view view;
    zt_picture pictures[ZT_PICTURES_MAX];
    int count;
    zt_picture reference, whole; /* of the same piece; and all of the frame, made smaller */
    int x, y, width, height;     /* of the piece, in the frame's pixels */
    int frame_width, frame_height, whole_width, whole_height;
    zt_status status; /* of what went wrong */
} zt_pictures;

/* What a ladder shows to: `user` is the zt_pictures. Keeps those that a page has room for. */
void zt_pictures_show(void *user, const zt_rung *rung, const zt_image *image,
                      const zt_image *reference);
void zt_pictures_free(zt_pictures *pictures);

/* Errors from least to most on a map have these colours, logarithms straight between them. */
extern const double zt_map_least, zt_map_most;
extern const char *const zt_map_stops[ZT_MAP_STOP_COUNT];

#endif
