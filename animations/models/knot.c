/* Writes the trefoil knot that the animations show as a binary little-endian PLY file, whose
 * name is the only argument: a round tube around the curve (sin t + 2 sin 2t, cos t - 2 cos 2t,
 * -sin 3t), 70,308 triangles, without a seam: it closes both ways over the same vertices. It
 * lies along the x y plane, turns into itself by 120 degrees around z, reaches 1 from that
 * axis, and 0.43 up and down. */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { ALONG = 567, AROUND = 62 }; /* quads of about the same length either way */

static const double tube_radius = 0.5; /* in the curve's own unit, */
static const double scale = 1 / 3.5;   /* in which it reaches 3 from the origin */

/* A number's four bytes, the least significant one first. */
static bool put(FILE *file, uint32_t bits) {
    unsigned char bytes[4] = {(unsigned char)bits, (unsigned char)(bits >> 8),
                              (unsigned char)(bits >> 16), (unsigned char)(bits >> 24)};
    return fwrite(bytes, sizeof bytes, 1, file) == 1;
}

static bool put_float(FILE *file, double number) {
    float single = (float)number;
    uint32_t bits;
    memcpy(&bits, &single, sizeof bits);
    return put(file, bits);
}

/* A ring of the tube. Its frame is made of the curve's direction and z, which is never along
 * the curve: |(x', y')|^2 = 17 + 8 cos 3t. So it closes, and hardly twists. */
static bool put_ring(FILE *file, int ring) {
    double turn = 2 * acos(-1.0), t = turn * ring / ALONG;
    double x = sin(t) + 2 * sin(2 * t), y = cos(t) - 2 * cos(2 * t), z = -sin(3 * t);
    double dx = cos(t) + 4 * cos(2 * t), dy = 4 * sin(2 * t) - sin(t), dz = -3 * cos(3 * t);
    double flat = hypot(dx, dy), length = hypot(flat, dz);
    double side_x = dy / flat, side_y = -dx / flat; /* to the right of the curve */
    double up_x = -dx * dz / (flat * length), up_y = -dy * dz / (flat * length);
    double up_z = flat / length;
    bool written = true;
    for (int i = 0; i < AROUND; i++) {
        double s = tube_radius * cos(turn * i / AROUND),
               u = tube_radius * sin(turn * i / AROUND);
        written &= put_float(file, scale * (x + s * side_x + u * up_x));
        written &= put_float(file, scale * (y + s * side_y + u * up_y));
        written &= put_float(file, scale * (z + u * up_z));
    }
    return written;
}

static bool put_triangle(FILE *file, int a, int b, int c) {
    return putc(3, file) != EOF && put(file, (uint32_t)a) && put(file, (uint32_t)b) &&
           put(file, (uint32_t)c);
}

/* The two triangles between two rings that are counterclockwise seen from outside. */
static bool put_quad(FILE *file, int ring, int i) {
    int here = ring * AROUND, ahead = (ring + 1) % ALONG * AROUND, next = (i + 1) % AROUND;
    return put_triangle(file, here + i, ahead + i, ahead + next) &&
           put_triangle(file, here + i, ahead + next, here + next);
}

static bool put_knot(FILE *file) {
    bool written = fprintf(file,
                           "ply\nformat binary_little_endian 1.0\ncomment a trefoil knot\n"
                           "element vertex %d\n"
                           "property float x\nproperty float y\nproperty float z\n"
                           "element face %d\nproperty list uchar int vertex_indices\n"
                           "end_header\n",
                           ALONG * AROUND, 2 * ALONG * AROUND) > 0;
    for (int ring = 0; ring < ALONG; ring++) written &= put_ring(file, ring);
    for (int ring = 0; ring < ALONG; ring++)
        for (int i = 0; i < AROUND; i++) written &= put_quad(file, ring, i);
    return written;
}

/* Written aside and renamed, so that there is never half a knot, nor one made of two that two
 * builds write at once. */
int main(int argument_count, char **arguments) {
    char aside[4096];
    if (argument_count != 2 || snprintf(aside, sizeof aside, "%s.%ld.ply", arguments[1],
                                        (long)getpid()) >= (int)sizeof aside) {
        fprintf(stderr, "usage: knot FILE\n");
        return EXIT_FAILURE;
    }
    FILE *file = fopen(aside, "wb");
    bool written = file && put_knot(file);
    if (file && fclose(file) != 0) written = false;
    if (!written || rename(aside, arguments[1]) != 0) {
        perror(arguments[1]);
        if (file) remove(aside);
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}
