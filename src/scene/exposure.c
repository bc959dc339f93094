#include "scene/exposure.h"

zt_status zt_exposure_index(const uint16_t **moment_at, const zt_exposure *exposure,
                            zt_arena *arena) {
    uint16_t *at = ZT_PUSH(arena, uint16_t, ZT_TIME_CELLS);
    *moment_at = at;
    if (!at) return ZT_EMEMORY;
    int32_t moment = 0;
    for (int cell = 0; cell < ZT_TIME_CELLS; cell++) {
        double begin = (double)cell / ZT_TIME_CELLS;
        while (moment + 2 < exposure->moment_count && exposure->times[moment + 1] <= begin)
            moment++;
        at[cell] = (uint16_t)moment;
    }
    return ZT_OK;
}
