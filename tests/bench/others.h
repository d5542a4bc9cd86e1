/* SPDX-License-Identifier: MIT */
/* The same questions to other libraries. */
#ifndef SPH_BENCH_OTHERS_H
#define SPH_BENCH_OTHERS_H

#include <sphmesh/query.h>

SPH_BEGIN_DECLS

typedef struct bench_mesh {
    uint32_t vertex_count;
    size_t triangle_count;
    const float *positions;    /* [vertex_count][3] */
    const uint32_t *triangles; /* [triangle_count][3] */
} bench_mesh;

/* Bullet: a sphere swept against a triangle mesh, or against a compound of hulls of spheres, one per simplex. */
void *bench_bullet_mesh(const bench_mesh *mesh);
void *bench_bullet_compound(const float *centers, const float *radii, const sph_level_arrays *level);
/* Returns the number of hits. */
size_t bench_bullet_cast(void *world, const sph_sweep *sweeps, size_t count);

/* Embree: rays against a triangle mesh. */
void *bench_embree_mesh(const bench_mesh *mesh);
size_t bench_embree_cast(void *scene, const sph_sweep *sweeps, size_t count);

SPH_END_DECLS

#endif
