/* What the rounds of pixels came to that take further samples, kept from frame to frame. A
 * pixel's first round, its second and so on are always of the same samples, whatever decides
 * that it takes them: so what they came to holds as long as nothing does change that their rays
 * touched. */
#ifndef ZT_RENDER_ROUNDS_H
#define ZT_RENDER_ROUNDS_H

#include <stdatomic.h>

#include "render/canvas.h"

/* A pixel after one of its rounds. */
typedef struct zt_round {
    zt_canvas_sum sum; /* of the samples that count positively, of all rounds so far */
    float error, step; /* as in zt_canvas */
    uint32_t next;     /* the number of its next round that is kept, or 0 */
    bool strange;      /* as in zt_slot */
} zt_round;

/* Zeros are closed. Rounds have numbers from 1 on, those of a pixel lead from one to the next.
 */
typedef struct zt_rounds {
    zt_round *rounds;
    zt_canvas_sum *negative; /* likewise of samples that count negatively; or NULL */
    uint32_t *first;         /* plane: the number of a pixel's first round, or 0 */
    uint32_t *spare;         /* numbers that were given back */
    uint32_t count, spare_count, room;
    atomic_uint taken; /* numbers since the last zt_rounds_reserve */
    int width, height;
} zt_rounds;

/* The number of a slot's last round where that is not kept: nor are those that follow. */
#define ZT_ROUNDS_LOST UINT32_MAX

/* Has it keep none, of pictures of a size. ZT_EMEMORY. */
zt_status zt_rounds_open(zt_rounds *rounds, int width, int height, bool is_signed);
void zt_rounds_close(zt_rounds *rounds); /* leaves zeros */

/* A pixel's are given back. */
void zt_rounds_forget(zt_rounds *rounds, int column, int row);

/* Before each round over the picture: so many may be kept in it, as long as there is room. */
void zt_rounds_reserve(zt_rounds *rounds, size_t count);

/* How many are kept, of all pixels. */
size_t zt_rounds_count(const zt_rounds *rounds);

/* The slot takes its next round from those that are kept; false where that one is not. From any
 * thread, as is the next. */
bool zt_rounds_recall(zt_canvas *canvas, int32_t slot, const zt_rounds *rounds);

/* The rounds that some slots have just taken are kept. */
void zt_rounds_keep(zt_rounds *rounds, zt_canvas *canvas, const int32_t *slots, int count);

#endif
