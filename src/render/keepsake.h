/* Keepsakes: pictures as bytes, with what their rays touched, for copying tiles from them in a
 * later run, when the description has been edited.
 *
 * All numbers as they are in memory, one after the other: a head, the outline, the footprints,
 * R G B of all pixels, and A where there are some that do not cover all; and of a picture at
 * edges what the middles saw, how many rounds each pixel took, and these. What another version
 * wrote is unknown, and so is what has been damaged. */
#ifndef ZT_RENDER_KEEPSAKE_H
#define ZT_RENDER_KEEPSAKE_H

#include "render/picture.h"

/* Without bytes between its fields. */
typedef struct zt_keepsake_head {
    zt_hash version;  /* of the bytes, and of the arithmetic */
    zt_hash checksum; /* of all that follows it */
    uint64_t size;    /* of all */
    zt_hash key;      /* the frame's content key; as given, and so are: */
    int64_t frame;
    double render_s; /* how long it takes to render by itself */
    zt_hash view;    /* of zt_picture, and so is all that follows */
    uint64_t frame_key;
    int32_t width, height;
    int32_t thing_count, lamp_count;
    uint64_t opaque; /* 1: there are no A, which are 1; or 0; and so are: */
    uint32_t at_edges, is_signed;
    uint64_t round_count;
} zt_keepsake_head;

/* At most so many bytes, of a picture that is whole. */
size_t zt_keepsake_room(const zt_picture *picture);

/* Puts a picture into `bytes`, and what there is to know of it into `head`, of which key, frame
 * and render_s are given, and `arithmetic`, a text. Its size is head->size. The checksum, which
 * takes its time, is zt_keepsake_seal()'s. */
void zt_keepsake_write(unsigned char *bytes, zt_keepsake_head *head, const zt_picture *picture,
                       const char *arithmetic);
void zt_keepsake_seal(unsigned char *bytes);

/* Whether this is the head of a keepsake of so many bytes, which may be whole. */
bool zt_keepsake_knows(const zt_keepsake_head *head, uint64_t size, const char *arithmetic);

/* Makes the picture of a keepsake whole again. False, the picture then not being whole, where
 * that is damaged, or there is no memory. */
bool zt_keepsake_read(zt_picture *picture, const unsigned char *bytes, uint64_t size,
                      const char *arithmetic);

#endif
