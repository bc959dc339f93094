/* Guides: what an image tells of the things in it besides their colours, from one ray through
 * the middle of each pixel. */
#ifndef ZT_RENDER_GUIDES_H
#define ZT_RENDER_GUIDES_H

#include "render/render.h"
#include "scene/passage.h"

/* Fills the channels that the image has of all that tell of that ray (zoetrope/aov.h); nothing
 * happens where it has none. The job and the exposure are those that the picture was rendered
 * from; the passage, read where motion is asked for, is in the same space, between the middles
 * of two openings. The same bits for any number of threads. ZT_ESTOPPED when asked to stop. */
zt_status zt_guides_render(zt_image *image, const zt_render_job *job,
                           const zt_exposure *exposure, const zt_passage *passage,
                           zt_render_work *work, zt_pool *pool);

#endif
