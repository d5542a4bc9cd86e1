/* SPDX-License-Identifier: MIT */
/* One call of sph_skin_create(), in parts. */
#ifndef SPH_SKIN_JOB_H
#define SPH_SKIN_JOB_H

#include "level/level.h"
#include "skin/filter.h"
#include "skin/problem.h"

typedef struct sph__skin_job {
    const sph_level *level;
    const sph_skin_source *sources;
    size_t source_count;
    sph_skin_options options;
    sph__progress progress;
    sph__reach reach;
    uint32_t *labels; /* [n]: cells */
    uint8_t *fixed;   /* [n], in the problem's order */
    sph__problem problem;
    sph__filter filter;
    sph_skin *skin;
} sph__skin_job;

/* Reads and checks the caller's options, but for the arrays among them (options.c). */
sph_status sph__skin_read_options(sph__skin_job *job, const sph_skin_options *in);
/* The arrays among the options, once the counts are known. */
sph_status sph__skin_check_arrays(const sph__skin_job *job, uint32_t frame_count);

/* Cells, weights and poses that the solver starts from (start.c). */
sph_status sph__skin_find_cells(sph__skin_job *job);
sph_status sph__skin_start_weights(sph__skin_job *job);
sph_status sph__skin_start_poses(sph__skin_job *job);

/* Between skin and problem (start.c). */
void sph__skin_load_weights(sph__problem *p, const sph_skin *skin);

#endif
