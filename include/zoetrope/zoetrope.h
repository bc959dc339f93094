/* Zoetrope: a description of an animation becomes a film.
 *
 *   zt_animation_read -> zt_renderer_open -> zt_film_render -> close all
 */
#ifndef ZOETROPE_H
#define ZOETROPE_H

#include <zoetrope/animation.h>
#include <zoetrope/aov.h>
#include <zoetrope/diff.h>
#include <zoetrope/drawing.h>
#include <zoetrope/explain.h>
#include <zoetrope/film.h>
#include <zoetrope/frames.h>
#include <zoetrope/hash.h>
#include <zoetrope/image.h>
#include <zoetrope/ladder.h>
#include <zoetrope/manifest.h>
#include <zoetrope/output.h>
#include <zoetrope/rate.h>
#include <zoetrope/renderer.h>
#include <zoetrope/replay.h>
#include <zoetrope/reproduce.h>
#include <zoetrope/stats.h>
#include <zoetrope/status.h>

#define ZT_VERSION "0.1.0"

#endif
