/* SPDX-License-Identifier: MIT */
/* What the tests of files with a rig share: a folder, an input, and the file that it is saved to. */
#ifndef SPH_TEST_RIG_CASE_H
#define SPH_TEST_RIG_CASE_H

#include "rig.h"
#include "support.h"

extern sph_context *context;
extern rig_input input;
extern sph_skin_arrays skin;
extern const char *path; /* rig.glb in the folder of the test */

/* The fixture. */
void setup(void);
void teardown(void);

/* Saves the input; what its skin holds stays in `skin` until the handle that is returned is destroyed. */
sph_skin *save(int32_t kind, uint32_t single_root, int32_t weights);

#endif
