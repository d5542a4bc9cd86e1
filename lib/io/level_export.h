/* SPDX-License-Identifier: MIT */
/* Levels for other tools: what its writers share. */
#ifndef SPH_LEVEL_EXPORT_H
#define SPH_LEVEL_EXPORT_H

#include "io/io.h"

/* What is to be written: the frames that were picked. */
typedef struct sph__io_export {
    sph_context *context;
    sph_level_arrays a;               /* of these frames only */
    uint32_t first_frame, frame_step; /* what the level calls them */
    const char *name;
    bool cover_solid;
    double gap;                   /* asked for; > 0 but for a level of no size */
    const sph_coverage *coverage; /* or NULL */
    sph_io_export_report *report; /* filled by the writers */
} sph__io_export;

typedef void sph__io_export_fn(sph__io_output *output, sph__io_export *e);
sph__io_export_fn sph__io_export_primitives, sph__io_export_ma;
sph__io_export_fn sph__io_export_glb; /* level_glb_extras.c */
/* Lists of spheres. */
sph__io_export_fn sph__io_export_srdf, sph__io_export_yaml, sph__io_export_urdf;

/* Sentences on the level and its coverage, each between `before` and `after`. */
void sph__io_export_notes(sph__io_output *output, const sph__io_export *e, const char *before, const char *after);
/* A double with all its digits. */
void sph__io_export_double(sph__io_output *output, double value);

/* Whether a simplex names a sphere twice: it is then less than it says. */
bool sph__io_export_is_flat(const uint32_t *simplex, uint32_t corners);
/* For each sphere whether an edge or a triangle has it; to be released; NULL when out of memory. */
bool *sph__io_export_used(const sph__io_export *e);

/* --- spheres in place of capsules and triangles (sphere_cover.c) --- */
typedef struct sph__io_ball {
    float center[3], radius;
} sph__io_ball;

typedef struct sph__io_balls {
    sph_context *context;
    sph__io_ball *items; /* without two of one centre; ascending by centre */
    size_t count, capacity;
    double gap; /* of the spheres found */
} sph__io_balls;

/* Of the first frame. Zeroes `balls` first; release it also after a failure. */
sph_status sph__io_cover_with_balls(const sph__io_export *e, sph__io_balls *balls);
void sph__io_balls_release(sph__io_balls *balls);

#endif
