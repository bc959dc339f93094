#include "image/info.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/text.h"

enum { FRAME, RATE, KEY, SEED, TITLE, DESCRIPTION, VIEW, SETTINGS, BACKGROUND };

const char *const zt_info_names[ZT_INFO_COUNT] = {
    "zoetrope:frame", "zoetrope:rate",     "zoetrope:key",
    "zoetrope:seed",  "zoetrope:title",    "zoetrope:description",
    "zoetrope:view",  "zoetrope:settings", "zoetrope:background"};

static const char transparent[] = "transparent";

void zt_info_free(char *texts[ZT_INFO_COUNT]) {
    for (int i = 0; i < ZT_INFO_COUNT; i++) {
        free(texts[i]);
        texts[i] = NULL;
    }
}

zt_status zt_info_print(char *texts[ZT_INFO_COUNT], const zt_image *image) {
    const zt_image_info *info = &image->info;
    const char *own[ZT_INFO_COUNT] = {[TITLE] = info->title,
                                      [DESCRIPTION] = info->description,
                                      [VIEW] = info->view,
                                      [SETTINGS] = info->settings,
                                      [BACKGROUND] = image->transparent ? transparent : NULL};
    texts[FRAME] = zt_text_print("%" PRId64, info->frame);
    texts[RATE] = zt_text_print("%d/%d", info->rate.num, info->rate.den);
    texts[KEY] = zt_text_print("%016" PRIx64 "%016" PRIx64, info->key.high, info->key.low);
    texts[SEED] = zt_text_print("%" PRIu64, info->seed);
    bool all = texts[FRAME] && texts[RATE] && texts[KEY] && texts[SEED];
    for (int i = TITLE; i < ZT_INFO_COUNT; i++) {
        texts[i] = own[i] ? strdup(own[i]) : NULL;
        all &= !own[i] || texts[i];
    }
    if (!all) zt_info_free(texts);
    return all ? ZT_OK : ZT_EMEMORY;
}

/* Whether `text` is what printing the same makes: no sign, blank or digit more. */
static bool is_all(char *printed, const char *text) {
    bool same = printed && strcmp(printed, text) == 0;
    free(printed);
    return same;
}

static bool read_rate(zt_rate *rate, const char *text) {
    char *end;
    rate->num = (int32_t)strtol(text, &end, 10);
    rate->den = *end == '/' ? (int32_t)strtol(end + 1, NULL, 10) : 0;
    return rate->num > 0 && rate->den > 0 &&
           is_all(zt_text_print("%d/%d", rate->num, rate->den), text);
}

static bool read_numbers(zt_image_info *info, const char *const texts[ZT_INFO_COUNT]) {
    for (int i = FRAME; i < TITLE; i++)
        if (!texts[i]) return false;
    info->frame = strtoll(texts[FRAME], NULL, 10);
    info->seed = strtoull(texts[SEED], NULL, 10);
    return is_all(zt_text_print("%" PRId64, info->frame), texts[FRAME]) &&
           is_all(zt_text_print("%" PRIu64, info->seed), texts[SEED]) &&
           read_rate(&info->rate, texts[RATE]) && zt_hash_read(&info->key, texts[KEY]);
}

zt_status zt_info_read(zt_image *image, const char *const texts[ZT_INFO_COUNT]) {
    zt_image_info info = {.known = true};
    if (!read_numbers(&info, texts)) return ZT_OK;
    const char **places[ZT_INFO_COUNT] = {[TITLE] = &info.title,
                                          [DESCRIPTION] = &info.description,
                                          [VIEW] = &info.view,
                                          [SETTINGS] = &info.settings};
    for (int i = TITLE; i < BACKGROUND; i++) {
        if (!texts[i]) continue;
        *places[i] = zt_image_own_text(image, texts[i]);
        if (!*places[i]) return ZT_EMEMORY;
    }
    image->info = info;
    image->transparent = texts[BACKGROUND] && zt_text_equal(texts[BACKGROUND], transparent);
    return ZT_OK;
}

char *zt_info_join(char *const texts[ZT_INFO_COUNT]) {
    size_t size = 1;
    for (int i = 0; i < ZT_INFO_COUNT; i++)
        size += texts[i] ? strlen(zt_info_names[i]) + 3 + 2 * strlen(texts[i]) : 0;
    char *joined = malloc(size), *end = joined;
    for (int i = 0; joined && i < ZT_INFO_COUNT; i++) {
        if (!texts[i]) continue;
        end += sprintf(end, "%s: ", zt_info_names[i]);
        for (const char *c = texts[i]; *c; c++) {
            *end++ = *c;
            if (*c == '\n') *end++ = ' ';
        }
        *end++ = '\n';
    }
    if (joined) *end = '\0';
    return joined;
}

/* The text that begins at `from`, without the blanks behind its ends of lines. */
static char *unfold(const char *from) {
    char *text = malloc(strlen(from) + 1), *to = text;
    for (; text && *from && (*from != '\n' || from[1] == ' '); from++) {
        *to++ = *from;
        if (*from == '\n') from++;
    }
    if (text) *to = '\0';
    return text;
}

zt_status zt_info_split(char *texts[ZT_INFO_COUNT], const char *joined) {
    for (int i = 0; i < ZT_INFO_COUNT; i++) texts[i] = NULL;
    for (const char *line = joined; line; line = strchr(line, '\n')) {
        line += *line == '\n';
        for (int i = 0; i < ZT_INFO_COUNT; i++) {
            size_t length = strlen(zt_info_names[i]);
            if (texts[i] || strncmp(line, zt_info_names[i], length) != 0 ||
                strncmp(line + length, ": ", 2) != 0)
                continue;
            texts[i] = unfold(line + length + 2);
            if (texts[i]) continue;
            zt_info_free(texts);
            return ZT_EMEMORY;
        }
    }
    return ZT_OK;
}
