/* What stands in the scene: materials, lights and objects. */
#ifndef ZT_DESCRIPTION_OBJECTS_H
#define ZT_DESCRIPTION_OBJECTS_H

#include "description/reading.h"

/* Reads what the description says below these words, each NULL where it is not there, into the
 * scene at rest. Names of models are relative to `directory`, which is "" or ends in a slash.
 * Mistakes are told and counted; ZT_EMEMORY is all that can fail. */
zt_status zt_objects_read(zt_reading *reading, const char *directory, const zt_node *materials,
                          const zt_node *lights, const zt_node *objects);

#endif
