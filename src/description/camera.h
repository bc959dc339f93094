/* The camera as it is written, and its lens. */
#ifndef ZT_DESCRIPTION_CAMERA_H
#define ZT_DESCRIPTION_CAMERA_H

#include "description/reading.h"

/* Reads "camera"; keys that do not matter to its lens are doubted. ZT_EMEMORY. */
zt_status zt_camera_read(zt_reading *reading, const zt_node *node);

#endif
