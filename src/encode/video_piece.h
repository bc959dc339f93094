/* Pieces of films as bytes: clusters of Matroska, which make a film that plays when they follow
 * its head, whichever of them and however many.
 *
 * A piece begins with a picture that stands alone, and no other piece's refers into it, so that
 * its packets join with any before and behind. Packets' times are frame numbers here, counted
 * from the piece's first frame. */
#ifndef ZT_ENCODE_VIDEO_PIECE_H
#define ZT_ENCODE_VIDEO_PIECE_H

#include <libavformat/avformat.h>

#include <zoetrope/hash.h>

/* Writing one. Zeroed: none is. */
typedef struct zt_piece_muxer {
    AVFormatContext *muxer;
    AVRational rate;
    int64_t first; /* the position of its first frame in the film */
    int64_t count; /* packets that were put */
    uint8_t *head; /* of the film */
    int head_size;
    int file;
    int64_t at; /* where the next bytes go in that file */
} zt_piece_muxer;

/* All give 0, or an error of libav's. Begins a piece at `first` of packets like `parameters`,
 * which goes into `file` from `at` on. The film's head is made, but not written. */
int zt_piece_begin(zt_piece_muxer *piece, const AVCodecParameters *parameters, AVRational rate,
                   int64_t first, int file, int64_t at);

/* Packets come in the order of decoding, `pts` set. What is ready is written. */
int zt_piece_put(zt_piece_muxer *piece, AVPacket *packet);

/* Writes the rest: the piece ends at piece->at. */
int zt_piece_finish(zt_piece_muxer *piece);

/* Frees it, finished or not. */
void zt_piece_close(zt_piece_muxer *piece);

/* Reading one. Zeroed: nothing is open. */
typedef struct zt_piece_reader {
    AVFormatContext *container;
    AVStream *stream;
    AVPacket *packet; /* that was read last */
    AVRational rate;
    int64_t first;
    const uint8_t *head; /* borrowed */
    int head_size;
    int file;
    int64_t at, end, read; /* bytes of the file; how much of the head is read */
} zt_piece_reader;

/* Opens the bytes begin .. end of a file, after `head`. They may be anything. */
int zt_piece_open(zt_piece_reader *reader, const uint8_t *head, int head_size, AVRational rate,
                  int64_t first, int file, int64_t begin, int64_t end);

/* Reads the next packet. AVERROR_EOF after the last one. */
int zt_piece_next(zt_piece_reader *reader);
void zt_piece_end(zt_piece_reader *reader);

/* The checksum of packets, one after the other, as files hold them: the same in all kinds of
 * them. Begins with zeros. */
zt_hash zt_packet_checksum(zt_hash before, const AVPacket *packet, int64_t number);

/* What an encoder says of itself in all its packets' name is written in several ways: as `from`
 * has it. */
int zt_piece_describe_as(AVCodecParameters *parameters, const AVCodecParameters *from);

#endif
