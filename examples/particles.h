/* SPDX-License-Identifier: MIT */
/* What the simulation of particles.c and its pictures share. */
#ifndef PARTICLES_H
#define PARTICLES_H

#include <sphmesh/io.h>

/* What particles fall on: a level, or a mesh as a level of spheres of radius zero. */
typedef struct collider {
    const char *name;
    sph_level *level;
    sph_query *query;
    sph_level_arrays parts;
} collider;

/* Loads a level; with a cache, a mesh and its frames. Close it also after a failure. */
sph_status collider_open(collider *c, sph_context *context, const char *name, const char *path, const char *cache);
void collider_close(collider *c);

enum { FALLING, BOUNCED, LEAKED };

typedef struct particle {
    double place[3], velocity[3]; /* model units, and per frame */
    double born;                  /* in frames */
    int state;
    bool is_inside; /* the input, deeper than the tolerance, at the frame before */
} particle;

/* Rows of square tiles. */
typedef struct strip {
    const char *path; /* NULL: none is wanted */
    uint32_t columns, rows;
    unsigned char *rgb;
} strip;

/* A strip is empty until drawn; false: no memory. */
bool strip_create(strip *s, const char *path, uint32_t columns, uint32_t rows);
/* Draws what there is at a frame that the collider is posed at. `low` and `high`: the box to show. */
sph_status strip_draw(strip *s, uint32_t column, uint32_t row, sph_context *context, const collider *c, uint32_t frame,
                      const particle *particles, uint32_t count, float radius, const double low[3],
                      const double high[3]);
/* Writes the PNG file and gives the memory back; true: done, or nothing to do. */
bool strip_finish(strip *s);

static inline double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

#endif
