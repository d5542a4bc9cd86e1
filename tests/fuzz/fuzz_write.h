/* SPDX-License-Identifier: MIT */
/* Round trips: what the library writes it reads back as it was. */
#ifndef SPH_FUZZ_WRITE_H
#define SPH_FUZZ_WRITE_H

#include "fuzz.h"

/* As .sphm and .json, which come back bit for bit; and as the formats that hold less. */
void fuzz_save_level(sph_context *context, const sph_level *level);

/* In one of the formats for other tools, spheres inside or around the solid. */
void fuzz_export_level(sph_context *context, const sph_level *level, uint8_t choice);

/* As OBJ with a PC2 or an MDD cache: comes back bit for bit. */
void fuzz_save_animation(sph_context *context, const sph_animation *animation, bool mdd);

/* Makes a hierarchy of what `bytes` choose. */
typedef sph_status fuzz_build_fn(const sph_animation *animation, fuzz_bytes *bytes, sph_hierarchy **out);

/* Built again in a context whose memory is a file, the hierarchy has the same bytes. */
void fuzz_compare_spilled(const sph_animation *animation, const sph_hierarchy *hierarchy, fuzz_build_fn *build,
                          const fuzz_bytes *bytes);

#endif
