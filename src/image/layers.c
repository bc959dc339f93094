#include "image/layers.h"

#include <stdio.h>
#include <string.h>

void zt_layer_of(char layer[ZT_LAYER_NAME_MAX], const char *channel) {
    const char *dot = strrchr(channel, '.');
    if (strcmp(channel, "Z") == 0)
        snprintf(layer, ZT_LAYER_NAME_MAX, "depth");
    else
        snprintf(layer, ZT_LAYER_NAME_MAX, "%.*s",
                 (int)(dot ? (size_t)(dot - channel) : strlen(channel)), channel);
}
