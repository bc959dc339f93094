/* Where something cannot hold, and where the boundary lies: as measured by runs of the cases
 * around it with 60 scenes each. */
#include <string.h>

#include "table.h"

/* A solid is met in a space of its own, a mesh in its model's. Where groups stretch and turn by
 * turns, all of what takes a ray there is large and nearly parallel, and roundings grow with
 * how large. In single precision 1e-6 holds to axes that differ by 1e4 (stretched by 1e2 and
 * 1e-2), or one that is flattened to 1e-2; in double precision 1e-12 holds for all solids
 * measured. */
#define ASKEW "stretched and turned by more than single precision holds"

/* Of a flat cone the two faces of its rim are nearer to each other than roundings of the way
 * there: at 1e-2 of its width and a thousand times that away one ray in 40,000 misses it in
 * single precision, at 1e-4 one in 200 (both traced in double by auto). */
#define FLAT "thinner than what single precision tells apart at its distance"

const limit limits[] = {
    /* 17 of 512 rays, 5e-10 of the mesh's size further on; a solid's own surface is left out
     * exactly, a mesh's is escaped by an offset, which is along a normal that this has not.
     * Models have none: reading leaves them out. */
    {"zero area", PROBE_DOUBLE, "a mesh's triangle without area is met again when it is left"},
    {"edges of 1e20", PROBE_SINGLE, "a light of 1e40 is more than single precision holds"},
    {"stretched 1e4", PROBE_SINGLE, ASKEW},
    {"stretched 1e6", PROBE_SINGLE, ASKEW},
    {"sheared 1e6", PROBE_SINGLE, ASKEW},
    {"flattened 1e-3", PROBE_SINGLE, ASKEW},
    {"flattened 1e-6", PROBE_SINGLE, ASKEW},
    {"flattened 1e-12", PROBE_SINGLE, ASKEW},
    {"flat 1e-2, far", PROBE_SINGLE, FLAT},
    {"flat 1e-4, far", PROBE_SINGLE, FLAT},
    {"flat 1e-6, far", PROBE_SINGLE, FLAT},
    {"nasty", PROBE_SINGLE, ASKEW},
    {0},
};

const limit *limit_find(const char *name, probe_precision precision) {
    for (const limit *l = limits; l->name; l++)
        if (strcmp(l->name, name) == 0 && l->precision == precision) return l;
    return NULL;
}
