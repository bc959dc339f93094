/* The way out: images are made ready and written behind the rendering, on threads of their own,
 * a few at a time. */
#ifndef ZT_SEQUENCE_OUTWAY_H
#define ZT_SEQUENCE_OUTWAY_H

#include <zoetrope/image.h>
#include <zoetrope/output.h>

typedef struct zt_outway zt_outway;

/* Opens a way for images of a size with the channels of `aovs` (zt_aov). `thread_count`, at
 * least 1, make images ready; one of them at a time writes, in the order in which images were
 * sent. ZT_EMEMORY. */
zt_status zt_outway_open(zt_outway **way, int width, int height, unsigned aovs,
                         int thread_count);

/* Says where it leads to, before the first image is sent: an output, which nobody else uses
 * until the way is closed. */
void zt_outway_lead(zt_outway *way, zt_output *output);

/* Has `look` see each image that will be sent, with what is said of it, from any thread, before
 * it is made ready; where it fails, so does the image. Before the first one is sent. */
void zt_outway_show(zt_outway *way, zt_status (*look)(void *user, const zt_image *image),
                    void *user);

/* Lends an image to be filled, whose contents mean nothing but what its stamps say; waits while
 * too many are under way: thread_count + 2, those that the caller keeps counted. Fails with
 * what failed since. The caller releases it, once, sent or not. */
zt_status zt_outway_lend(zt_image **image, zt_outway *way);
void zt_outway_release(zt_outway *way, zt_image *image);

/* Sends an image that was lent; any number of times, each with what is to be said of it, the
 * frame's number among it. Nothing in it may change from then on. Waits, too. Fails with what
 * failed since, for this image or for one before. */
zt_status zt_outway_send(zt_outway *way, zt_image *image, const zt_image_info *info);

/* How long, in all, lending and sending had to wait for images to be written, seconds. For the
 * thread that lends and sends. */
double zt_outway_waited_s(const zt_outway *way);

/* Waits for all that was sent, and returns the first failure, in the order of sending: what was
 * sent before that is written, what was sent after it is not. */
zt_status zt_outway_close(zt_outway **way);

#endif
