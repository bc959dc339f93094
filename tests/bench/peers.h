/* Scenes for other ray tracers, written from the very numbers that Zoetrope renders: the same
 * camera, surfaces, colors, lights and mirrors. */
#ifndef ZT_BENCH_PEERS_H
#define ZT_BENCH_PEERS_H

/* Writes the first frame of a film to the scratch directory: FILM.pov for POV-Ray 3.7, and
 * FILM.tachyon for Tachyon 0.99. Flat triangles, planes, spheres, point and ambient lights;
 * anything else ends the program. */
void write_peers(const char *film, int width, int height);

/* As many frames of the same camera, for Tachyon's -camfile: FILM.COUNT.cam. */
void write_peer_camera(const char *film, int count);

#endif
