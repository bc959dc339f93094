/* An arena is a list of chunks; a push moves a mark in the current one. */
#include "base/arena.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { ALIGNMENT = 64, CHUNK_SIZE = 256 * 1024 };

struct zt_arena_chunk {
    zt_arena_chunk *next;
    size_t size, used; /* bytes of `data` */
    unsigned char *data;
};

static zt_arena_chunk *chunk_create(size_t size) {
    zt_arena_chunk *chunk = calloc(1, sizeof *chunk);
    if (!chunk) return NULL;
    chunk->size = size;
    chunk->data = aligned_alloc(ALIGNMENT, size);
    if (!chunk->data) {
        free(chunk);
        return NULL;
    }
    return chunk;
}

/* The next chunk with room for `size` bytes, which becomes the current one. Chunks kept from an
 * earlier round that are too small for this piece are passed over until the next reset. */
static zt_arena_chunk *chunk_with_room(zt_arena *arena, size_t size) {
    zt_arena_chunk *last = arena->current;
    for (zt_arena_chunk *c = last ? last : arena->first; c; c = c->next) {
        if (c->size - c->used >= size) return arena->current = c;
        last = c;
    }
    zt_arena_chunk *fresh = chunk_create(size > CHUNK_SIZE ? size : CHUNK_SIZE);
    if (!fresh) return NULL;
    if (last)
        last->next = fresh;
    else
        arena->first = fresh;
    return arena->current = fresh;
}

void *zt_arena_push(zt_arena *arena, size_t size) {
    if (size > SIZE_MAX - ALIGNMENT) return NULL;
    size_t rounded = (size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    if (rounded == 0) rounded = ALIGNMENT;
    zt_arena_chunk *chunk = chunk_with_room(arena, rounded);
    if (!chunk) return NULL;
    void *piece = chunk->data + chunk->used;
    chunk->used += rounded;
    return memset(piece, 0, rounded);
}

void *zt_arena_push_array(zt_arena *arena, size_t element_size, size_t count) {
    if (element_size && count > SIZE_MAX / element_size) return NULL;
    return zt_arena_push(arena, element_size * count);
}

char *zt_arena_push_text(zt_arena *arena, const char *text, size_t length) {
    char *copy = zt_arena_push(arena, length + 1);
    if (copy) memcpy(copy, text, length);
    return copy;
}

void zt_arena_reset(zt_arena *arena) {
    for (zt_arena_chunk *c = arena->first; c; c = c->next) c->used = 0;
    arena->current = arena->first;
}

void zt_arena_free(zt_arena *arena) {
    for (zt_arena_chunk *c = arena->first, *next; c; c = next) {
        next = c->next;
        free(c->data);
        free(c);
    }
    *arena = (zt_arena){0};
}
