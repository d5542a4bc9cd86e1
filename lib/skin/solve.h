/* SPDX-License-Identifier: MIT */
/* Rounds of poses, weights and rest positions. */
#ifndef SPH_SKIN_SOLVE_H
#define SPH_SKIN_SOLVE_H

#include "skin/filter.h"

/* Takes problem->now and ->poses for the start, and leaves there what it comes to. `filter`: of the mixed mode. */
sph_status sph__solve(sph__problem *p, const sph_skin *skin, const sph_skin_options *options, const sph__filter *filter,
                      sph__progress *progress);

#endif
