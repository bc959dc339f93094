/* Layers: channels that belong together, and make a part or a file of their own. */
#ifndef ZT_IMAGE_LAYERS_H
#define ZT_IMAGE_LAYERS_H

#include <zoetrope/image.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { ZT_LAYER_NAME_MAX = 64 };

/* The layer of R G B A. */
#define ZT_LAYER_COLOURS "rgba"

/* The layer of a further channel, by the names that compositing programs show: "depth" of "Z",
 * "N" of "N.X", "id" of "id.object", else the channel's own. */
void zt_layer_of(char layer[ZT_LAYER_NAME_MAX], const char *channel);

#ifdef __cplusplus
}
#endif
#endif
