/* A film that grows: frames in their order become pieces, of which those that are there from
 * earlier runs are not made again. */
#ifndef ZT_ENCODE_VIDEO_GROWTH_H
#define ZT_ENCODE_VIDEO_GROWTH_H

#include "encode/aside.h"
#include "encode/video_alone.h"
#include "encode/video_check.h"
#include "encode/video_codecs.h"
#include "encode/video_part.h"
#include "encode/video_spool.h"

/* Zeroed, but for the files -1: nothing is open. */
typedef struct zt_video_growth {
    const zt_video_ear *ear;
    const zt_video_choice *choice; /* of the pieces */
    const zt_output_plan *plan;    /* NULL: none */
    AVFrame *like;                 /* borrowed: a frame like all that come */
    AVRational rate;
    zt_hash manner;          /* of how frames become packets */
    AVCodecContext *encoder; /* of the piece under way, or the next one; NULL: none yet */
    zt_video_alone *alone;   /* what encodes instead where pictures stand alone; else NULL */
    AVCodecParameters *parameters; /* of its packets */
    AVPacket *packet;
    zt_aside aside; /* of the file that grows */
    zt_video_part part;
    zt_video_spool spool;
    int64_t piece_frames; /* of each piece but the last one */
    int64_t *pieces; /* by their order in the film: which of the file's; -1: not there yet */
    int64_t piece_count, capacity;
    bool *kept;       /* by position of the plan: need not come */
    zt_hash film_key; /* of all frames and what the film says; zero: not known before */
    bool untouched;   /* the finished film is there and has all of that: nothing comes */
    int64_t next;     /* the position of the next frame that goes to the encoder */
    int64_t in_piece; /* frames of the piece under way that have */
    double render_s;  /* that these took */
    zt_video_sample samples[ZT_VIDEO_SAMPLE_COUNT];
} zt_video_growth;

/* What else decides what a film is. */
typedef struct zt_video_growth_words {
    const char *conversion; /* of light to the numbers of frames */
    zt_hash said;           /* the key of what the film says besides its frames */
} zt_video_growth_words;

/* Opens the encoder and the files beside `target`, takes what is there of earlier runs, and
 * what the finished film at `target` has of it. The choice, `like` and the format's plan are
 * borrowed; `encoder`, which may be one by that choice that is open already, or NULL, is not.
 */
zt_status zt_video_growth_open(zt_video_growth *growth, const char *target,
                               const zt_video_choice *choice, const zt_output_format *format,
                               AVFrame *like, AVCodecContext *encoder,
                               const zt_video_growth_words *words, const zt_video_ear *ear);

/* Takes the next frame that was not kept, which took `render_s` seconds; and its packet where
 * growth->alone has encoded it, else NULL. */
zt_status zt_video_growth_put(zt_video_growth *growth, AVFrame *frame, AVPacket *packet,
                              double render_s);

/* No more come: completes the piece under way, after what else is kept that follows. The film
 * has growth->next frames then. */
zt_status zt_video_growth_end(zt_video_growth *growth);

/* Those pieces in their order, of the caller to free, and how many. */
zt_status zt_video_growth_pieces(const zt_video_piece ***pieces, int64_t *count,
                                 const zt_video_growth *growth);

/* Whether there are pieces behind the frames that the film has. */
bool zt_video_growth_has_more(const zt_video_growth *growth);

/* Frees all. Files with something in them that a later run can use stay, if `keeps_pieces` and
 * `keeps_frames`. */
void zt_video_growth_close(zt_video_growth *growth, bool keeps_pieces, bool keeps_frames);

#endif
