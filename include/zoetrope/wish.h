/* A wish by name, as "crf" with "18". */
#ifndef ZOETROPE_WISH_H
#define ZOETROPE_WISH_H

#ifdef __cplusplus
extern "C" {
#endif

/* A list of them ends with one whose name is NULL; of two with one name the later counts. */
typedef struct zt_wish {
    const char *name, *value;
} zt_wish;

/* What is wished for; NULL where nothing is. `options` may be NULL. */
const char *zt_wish_value(const zt_wish *options, const char *name);

#ifdef __cplusplus
}
#endif
#endif
