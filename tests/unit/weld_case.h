/* SPDX-License-Identifier: MIT */
/* What the tests of welding share: meshes taken apart. */
#ifndef SPH_TEST_WELD_CASE_H
#define SPH_TEST_WELD_CASE_H

#include "support.h"

/* All frames, one behind the other; to be freed. */
float *read_all(const sph_animation *a);
/* Every triangle with three vertices of its own. */
sph_animation *taken_apart(const sph_animation *a);

#endif
