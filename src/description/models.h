/* Models of meshes: each file is read once, however many objects show it, and of its vertices
 * no more than they ask for. */
#ifndef ZT_DESCRIPTION_MODELS_H
#define ZT_DESCRIPTION_MODELS_H

#include "description/reading.h"

typedef struct zt_models {
    zt_reading *reading;
    const char *directory; /* names are relative to it: "", or it ends in a slash */
    struct zt_model_user *first, *last; /* in the order of the description */
    int32_t count;
    int refused_count;
} zt_models;

/* Notes that a mesh, object number `index` of the scene, whose properties are read, shows the
 * model that "file" names. Mistakes are told and counted; ZT_EMEMORY. */
zt_status zt_models_note(zt_models *models, int32_t index, const zt_fields *fields,
                         const zt_node *file);

/* Reads all that were noted into the scene at rest, and makes objects smooth that do not say
 * whether they are and whose model has normals. Mistakes are told and counted; ZT_EMEMORY. */
zt_status zt_models_read(zt_models *models);

#endif
