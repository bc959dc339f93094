/* How many digits rays are computed with. */
#ifndef ZOETROPE_PRECISION_H
#define ZOETROPE_PRECISION_H

#ifdef __cplusplus
extern "C" {
#endif

typedef enum zt_precision {
    ZT_PRECISION_AUTO,   /* double for the frames whose numbers ask for it */
    ZT_PRECISION_SINGLE, /* 24 binary digits */
    ZT_PRECISION_DOUBLE  /* 53 binary digits */
} zt_precision;

/* What a precision is called: "auto", "single", "double". */
const char *zt_precision_name(zt_precision precision);

#ifdef __cplusplus
}
#endif
#endif
