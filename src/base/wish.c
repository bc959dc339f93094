#include <zoetrope/wish.h>

#include <stddef.h>

#include "base/text.h"

const char *zt_wish_value(const zt_wish *options, const char *name) {
    const char *value = NULL;
    for (; options && options->name; options++)
        if (zt_text_equal(options->name, name)) value = options->value;
    return value;
}
