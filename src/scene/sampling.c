/* The names of what is asked of a picture. */
#include <zoetrope/sampling.h>

const char *zt_filter_name(zt_filter filter) {
    static const char *const names[ZT_FILTER_COUNT] = {[ZT_FILTER_BOX] = "box",
                                                       [ZT_FILTER_TENT] = "tent",
                                                       [ZT_FILTER_GAUSSIAN] = "gaussian",
                                                       [ZT_FILTER_MITCHELL] = "mitchell",
                                                       [ZT_FILTER_BLACKMAN_HARRIS] =
                                                           "blackman-harris"};
    return names[filter];
}
