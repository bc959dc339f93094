/* Memory sorted by lifetime: pushed piece by piece, given back all at once. */
#ifndef ZT_BASE_ARENA_H
#define ZT_BASE_ARENA_H

#include <stddef.h>

typedef struct zt_arena_chunk zt_arena_chunk;

/* Zeroed is empty and ready. Owns its chunks. Not for two threads at once. */
typedef struct zt_arena {
    zt_arena_chunk *first, *current;
} zt_arena;

/* Zeroed memory aligned to 64 bytes, valid until the arena is reset or freed; NULL when out of
 * memory. A size of 0 gives a valid address. */
void *zt_arena_push(zt_arena *arena, size_t size);

/* `count` elements of a type; NULL when out of memory or when the size does not fit. */
#define ZT_PUSH(arena, type, count) ((type *)zt_arena_push_array(arena, sizeof(type), count))
void *zt_arena_push_array(zt_arena *arena, size_t element_size, size_t count);

/* A copy of `length` bytes of text, terminated; NULL when out of memory. */
char *zt_arena_push_text(zt_arena *arena, const char *text, size_t length);

/* Forgets all that was pushed, keeps the chunks for the next round. */
void zt_arena_reset(zt_arena *arena);
void zt_arena_free(zt_arena *arena);

#endif
