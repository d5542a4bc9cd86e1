/* SPDX-License-Identifier: MIT */
/* What must hold of any rig that was read, and of the file that it is saved as. */
#ifndef SPH_FUZZ_RIG_H
#define SPH_FUZZ_RIG_H

#include <sphmesh/io.h>

/* Looks at everything in the rig, poses it, saves it and reads it again. */
void fuzz_use_rig(sph_context *context, const sph_io_rig *rig);

/* Looks at a skin, hangs its bones on one another, and poses it both ways. */
void fuzz_use_skin(const sph_skin *skin);

/* Saves a skin as .glb and reads it back: the same vertices and triangles, and clip by clip as many frames. */
void fuzz_save_skin(sph_context *context, const sph_skin *skin);

#endif
