/* An encoder, fresh for each piece of a film: what comes out of it depends on nothing before.
 */
#ifndef ZT_ENCODE_VIDEO_ENCODER_H
#define ZT_ENCODE_VIDEO_ENCODER_H

#include <libavformat/avformat.h>

#include "encode/video_codecs.h"

/* Pictures from one that stands alone to the next: two seconds, at most 250. */
int zt_video_gop_frames(AVRational rate);

/* Opens one by the choice. `first` is a frame like all that will come, with its tags; `muxer`
 * is what the packets are for. Times are frame numbers. Closing is needed after failures, too.
 */
zt_status zt_video_encoder_open(AVCodecContext **encoder, const zt_video_choice *choice,
                                const AVOutputFormat *muxer, const AVFrame *first,
                                AVRational rate, const zt_video_ear *ear);

/* Closes it, whatever it was given. `unused`: a frame where it was given none, else NULL. */
void zt_video_encoder_close(AVCodecContext **encoder, AVFrame *unused);

/* Takes a packet, whose contents stay the caller's. */
typedef zt_status (*zt_video_take)(void *user, AVPacket *packet);

/* Gives the encoder a picture, or NULL for the end, and what it has ready to `take`. `packet`
 * is for its use meanwhile. */
zt_status zt_video_encode(AVCodecContext *encoder, const AVFrame *frame, AVPacket *packet,
                          zt_video_take take, void *user, const zt_video_ear *ear);

#endif
