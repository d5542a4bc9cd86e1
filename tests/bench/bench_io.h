/* SPDX-License-Identifier: MIT */
/* The files that bench_io reads. */
#ifndef SPH_BENCH_IO_H
#define SPH_BENCH_IO_H

#include <sphmesh/io.h>

void bench_die(const char *what) __attribute__((noreturn));
/* A name in the temporary folder; the last four answers stay. */
const char *bench_path(const char *name);
/* A tube that waves; `rich`: with texture coordinates and normals, and faces of v/t/n, as Blender writes them. */
void bench_write_obj(const char *path, uint32_t vertices, uint32_t frame, bool rich);
/* PC2, or MDD where the name ends so. */
void bench_write_cache(const char *path, uint32_t vertices, uint32_t frames);
/* A skin of a chain of joints, four of which move each vertex, with keys in all frames, at 30 per second. */
void bench_write_glb(const char *path, uint32_t vertices, uint32_t joints, uint32_t frames);

#endif
