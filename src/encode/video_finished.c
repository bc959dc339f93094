#include "encode/video_finished.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <libavutil/pixdesc.h>

#include "base/hash.h"

enum { BLOCK = 1 << 20 };

static zt_hash mix(zt_hash before, const void *bytes, size_t size) {
    const zt_hash both[] = {before, zt_hash_bytes(bytes, size)};
    return zt_hash_bytes(both, sizeof both);
}

/* Of a regular file, by blocks; `*size` is its length. False where it cannot be read. */
static bool read_file(zt_hash *checksum, int64_t *size, const char *path) {
    struct stat there;
    FILE *file = fopen(path, "rb");
    unsigned char *block = malloc(BLOCK);
    bool good = file && block && fstat(fileno(file), &there) == 0 && S_ISREG(there.st_mode);
    *checksum = (zt_hash){0};
    *size = 0;
    for (size_t count; good && (count = fread(block, 1, BLOCK, file)) > 0;) {
        *checksum = mix(*checksum, block, count);
        *size += (int64_t)count;
    }
    good = good && !ferror(file);
    free(block);
    if (file) fclose(file);
    return good;
}

zt_hash zt_video_said(const zt_video_choice *choice, const char *settings, const char *target) {
    const char *const texts[] = {choice->container->ending,
                                 choice->codec->name,
                                 av_get_pix_fmt_name(choice->pixels),
                                 settings,
                                 zt_wish_value(choice->options, "title"),
                                 zt_wish_value(choice->options, "comment")};
    zt_hash said = {0};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        said = mix(said, texts[i], texts[i] ? strlen(texts[i]) + 1 : 0);
    const char *sound = zt_wish_value(choice->options, "audio");
    zt_hash heard = {0};
    int64_t size = 0;
    if (sound && strcmp(sound, target) != 0) (void)read_file(&heard, &size, sound);
    return mix(said, &heard, sizeof heard);
}

zt_status zt_video_finished_record(zt_output_record *record, const char *path, zt_hash key,
                                   const zt_output_plan *plan, const zt_video_ear *ear) {
    *record = (zt_output_record){.kind = ZT_RECORD_FILM, .count = plan->count, .key = key};
    if (read_file(&record->checksum, &record->bytes, path)) return ZT_OK;
    return zt_libav_refuse(ear, AVERROR(errno));
}

bool zt_video_finished_is(const char *path, zt_hash key, const zt_output_plan *plan) {
    const zt_output_record *last = NULL;
    for (int64_t i = 0; i < plan->record_count; i++)
        if (plan->records[i].kind == ZT_RECORD_FILM) last = &plan->records[i];
    zt_hash checksum;
    int64_t size;
    if (!zt_hash_is_known(key) || !last || last->count != plan->count ||
        !zt_hash_equal(last->key, key))
        return false;
    return read_file(&checksum, &size, path) && size == last->bytes &&
           zt_hash_equal(checksum, last->checksum);
}
