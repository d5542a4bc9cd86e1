/* SPDX-License-Identifier: MIT */
/* Internal door of the room "coverage": passes over an animation that look for vertices outside a level. */
#ifndef SPH_COVERAGE_INTERNAL_H
#define SPH_COVERAGE_INTERNAL_H

#include <sphmesh/coverage.h>

#include "animation/animation.h"
#include "level/solid.h"

/*
 * |x - c(b)| - r(b) for the weights b at which the primitive is nearest to x, plus what rounding may have taken off: x
 * is contained where this is 0 or less, whatever the weights are worth. `distance` gets |x - c(b)|, rounded up too.
 */
double sph__coverage_excess(const sph__primitive *primitive, const double x[3], double weights[3], double *distance);

/* One frame at a time. */
typedef struct sph__coverage_slot {
    uint32_t frame;
    float *xyz;
    sph__solid solid;
    /* what was found: */
    double largest; /* excess; 0 or less where all are contained */
    uint32_t vertex;
    uint64_t count;
    /* where the job collects: */
    double *raises;  /* [spheres]: what their radii lack if each vertex has to do with its corners alone */
    double *worst;   /* [primitives]: the largest excess nearest to each; 0: none */
    uint32_t *where; /* [primitives]: of which vertex */
} sph__coverage_slot;

typedef struct sph__coverage_job {
    const sph_context *context;
    const sph_animation *animation;
    const sph_level *level;
    double margin;
    bool collects;
    uint32_t slot_count;
    sph__coverage_slot *slots;
    sph__progress progress;
} sph__coverage_job;

/* What a pass does with each frame, in their order; the slot's solid is still posed. */
typedef sph_status sph__coverage_visit_fn(void *user, const sph__coverage_slot *slot);

/* That level and animation are there, and have as many frames. */
sph_status sph__coverage_check(const sph_context *context, const sph_animation *animation, const sph_level *level,
                               const char *function);
/* `context`, `animation`, `level`, `margin` and `collects` have been set. Free it also after a failure. */
sph_status sph__coverage_job_init(sph__coverage_job *job);
void sph__coverage_job_free(sph__coverage_job *job);
/* All frames; reports progress of the current part. */
sph_status sph__coverage_pass(sph__coverage_job *job, sph__coverage_visit_fn *visit, void *user);

/* --- the least growth (least_growth.c) --- */

/* sum of weights * radii of the spheres >= reach */
typedef struct sph__cover {
    uint32_t frame, spheres[3];
    double weights[3], reach;
    double multiplier; /* of the dual problem; >= 0 */
} sph__cover;

/*
 * Moves `radii`, which are where the multipliers of `covers` put them, to the least sum of squared growths that
 * satisfies all covers within `tolerance`, as far as `sweeps` go. `stride` is the number of radii per frame, 0 for
 * radii that are the same in all.
 */
void sph__least_growth(sph__cover *covers, size_t count, double *radii, size_t stride, uint32_t sweeps,
                       double tolerance);

/* --- volumes (volume.c) --- */

/* Means over frames, with radii as `before` has them and as the job's level has them. */
sph_status sph__coverage_volumes(sph__coverage_job *job, const sph_level *before, double *volume_before,
                                 double *volume_after);

#endif
