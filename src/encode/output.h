/* An output whose images are made by several threads: zt_output_write() in its two steps; and
 * what opening one takes. */
#ifndef ZT_ENCODE_OUTPUT_H
#define ZT_ENCODE_OUTPUT_H

#include <zoetrope/output.h>

/* Makes of an image what will be written; from any thread, several at once, in any order. */
zt_status zt_output_make(void **made, zt_output *output, const zt_image *image, int64_t frame);

/* Writes what was made, in turn, as zt_output_write() asks for, and frees it whatever happens.
 */
zt_status zt_output_put(zt_output *output, void *made, int64_t frame);

/* Frees what was made and will not be written. */
void zt_output_drop(zt_output *output, void *made);

/* How many tiles of images were not converted, since they were the same as before; once none is
 * being made any more. */
int64_t zt_output_spared(const zt_output *output);

/* The module that opening an output for `target` loads (base/module.h), or NULL. */
const char *zt_output_module(const char *target);

#endif
