/* Materials, by name or where they are used. */
#ifndef ZT_DESCRIPTION_MATERIALS_H
#define ZT_DESCRIPTION_MATERIALS_H

#include "description/reading.h"

typedef struct zt_material_name {
    const char *name;
    int32_t index;
} zt_material_name;

typedef struct zt_materials {
    zt_reading *reading;
    zt_material_name *names; /* sorted */
    int32_t name_count;
    int32_t white; /* the one of objects that name none, or -1 */
} zt_materials;

/* Reads the mapping of names to materials; `node` may be NULL. Makes room in the scene for as
 * many more as there may be objects. */
zt_status zt_materials_open(zt_materials *materials, zt_reading *reading, const zt_node *node,
                            int64_t object_count);

/* The index of the material that an object asks for by a name, by a mapping of its own, or by
 * nothing at all (`node` NULL): white. -1 after telling what is wrong. */
zt_status zt_materials_find(int32_t *index, zt_materials *materials, const zt_node *node);

#endif
