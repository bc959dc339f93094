/* The names of what images tell besides their colours. */
#include <zoetrope/aov.h>

#include <string.h>

enum { WIDTH_MAX = 3 };

static const struct {
    zt_aov aov;
    const char *name, *channels[WIDTH_MAX];
} rows[] = {{ZT_AOV_Z, "Z", {"Z"}},
            {ZT_AOV_P, "P", {"P.X", "P.Y", "P.Z"}},
            {ZT_AOV_N, "N", {"N.X", "N.Y", "N.Z"}},
            {ZT_AOV_ALBEDO, "albedo", {"albedo.R", "albedo.G", "albedo.B"}},
            {ZT_AOV_MOTION, "motion", {"motion.x", "motion.y"}},
            {ZT_AOV_OBJECT, "id.object", {"id.object"}},
            {ZT_AOV_MATERIAL, "id.material", {"id.material"}},
            {ZT_AOV_SAMPLES, "samples", {"samples"}},
            {ZT_AOV_ERROR, "error", {"error"}}};

enum { COUNT = sizeof rows / sizeof *rows };

bool zt_aov_find(unsigned *aovs, const char *name) {
    *aovs = strcmp(name, "all") == 0 ? ZT_AOV_ALL : 0;
    for (int i = 0; i < COUNT; i++)
        if (strcmp(name, rows[i].name) == 0) *aovs = rows[i].aov;
    return *aovs != 0;
}

const char *zt_aov_names(void) {
    return "Z, P, N, albedo, motion, id.object, id.material, samples, error, all";
}

zt_status zt_image_add_aovs(zt_image *image, unsigned aovs) {
    for (int i = 0; i < COUNT; i++) {
        if (!(aovs & rows[i].aov)) continue;
        for (int k = 0; k < WIDTH_MAX && rows[i].channels[k]; k++) {
            zt_status status = zt_image_add_channel(image, rows[i].channels[k]);
            if (status != ZT_OK) return status;
        }
    }
    return ZT_OK;
}
