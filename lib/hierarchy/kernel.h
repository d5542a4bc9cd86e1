/* SPDX-License-Identifier: MIT */
/*
 * The loops over frames. All take rows of `stride` floats (a multiple of SPH__LANES, padded with zeros), allocate nothing
 * and cannot fail. A block goes through memory as the loops do: eight frames of all its rows, then the next eight.
 *
 * A region's quadric is kept relative to its own animated sphere (q0, r0): the value there is its cost, and the gradient
 * there is almost nothing. That, rather than an anchor at a vertex, is what lets 32 bits hold the matrices.
 */
#ifndef SPH_HIERARCHY_KERNEL_H
#define SPH_HIERARCHY_KERNEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Frames per vector: rows are padded to a multiple of it. */
enum { SPH__LANES = 8 };

/* Rows of a block. */
enum { SPH__M00, SPH__M01, SPH__M02, SPH__M11, SPH__M12, SPH__M22, SPH__N0, SPH__N1, SPH__N2, SPH__B0, SPH__B1, SPH__B2,
       SPH__BLOCK_ROWS,
       SPH__LEAF_ROWS = SPH__B0 };

/* The place of a row's frame in a block of `rows` rows. */
static inline size_t sph__block_place(size_t rows, size_t row, size_t frame)
{
    return (frame / SPH__LANES * rows + row) * SPH__LANES + frame % SPH__LANES;
}

/* One region as the kernels see it. */
typedef struct sph__region {
    const float *block;    /* rows of the quadric */
    const float *center;   /* x, y, z rows of the sphere's centre, which is the origin of the quadric */
    const float *mean;     /* x, y, z and area rows of temporal coherence; NULL without it */
    double radius;         /* of the sphere; its offset in r */
    double w, b, c;        /* scalars of the quadric relative to the sphere */
    const struct sph__region *next; /* NULL, or what is read after this one: it is asked for meanwhile */
    int leaf;              /* 1: the b rows are zero and not there: the block has SPH__LEAF_ROWS rows */
} sph__region;

/* Of a single frame, what a region has is one cache line: its block, and the centre and radius of its sphere. */
enum { SPH__SINGLE_CENTER = SPH__BLOCK_ROWS, SPH__SINGLE_RADIUS = SPH__SINGLE_CENTER + 3, SPH__SINGLE_ROWS };
_Static_assert(SPH__SINGLE_ROWS * sizeof(float) == 64, "a region is a cache line");

/* What a pass over the frames of the united quadric yields; all relative to the sphere of u. */
typedef struct sph__sums {
    double b, c;       /* scalars B and c of the union */
    double w;          /* W of the union */
    double nn, nb, bb; /* sums over regular frames of N'M^-1 N, N'M^-1 b, b'M^-1 b */
    double mu, nu, b1; /* sums over degenerate frames of d'M d, N.d, b.d */
    double mu_scale;   /* sum over degenerate frames of trace(M) |d|^2 */
    uint32_t degenerate;
} sph__sums;

/* Where the united quadric is least: lambda, radius (absolute) and cost. */
typedef struct sph__minimum {
    double lambda, radius, cost;
} sph__minimum;

void sph__kernel_sums(const sph__region *u, const sph__region *v, size_t frames, size_t stride, double coherence,
                      sph__sums *sums);

/* The sums of `count` pairs, up to eight, of regions of one frame, without coherence; their blocks are cache lines as above.
 * There are eight of them: what those behind `count` are makes no difference. */
void sph__kernel_pair_sums(const sph__region us[SPH__LANES], const sph__region vs[SPH__LANES], size_t count,
                           sph__sums *sums);
/* What the two functions below do, of such regions. */
void sph__kernel_single_center(const sph__region *u, const sph__region *v, double lambda, double radius,
                               float center[3]);
void sph__kernel_single_unite(const sph__region *u, const sph__region *v, const float center[3], double radius,
                              float rows[SPH__SINGLE_ROWS], double *w, double *b, double *c);

/* The centres of the united sphere: three rows. */
void sph__kernel_centers(const sph__region *u, const sph__region *v, size_t stride, double coherence, double lambda,
                         double radius, float *center);

/*
 * Writes the united quadric relative to the sphere (center, radius). `block` may be that of u or v if it is no leaf. The scalars come from
 * sums of the same two regions without coherence terms.
 */
void sph__kernel_unite(const sph__region *u, const sph__region *v, size_t stride, const float *center, double radius,
                       float *block, double *w, double *b, double *c);

/* Whether the sum over frames of sqrt(area * area') n.n' of triangle (p, q, before) and (p, q, after) is below zero. */
bool sph__kernel_inverts(const float *p, const float *q, const float *before, const float *after, size_t stride);

/* Whether that is below zero for one of eight triangles of one frame that share a corner: its place before and after, and
 * their other corners, each the first three of four floats, aligned to them. */
bool sph__kernel_any_inversion(const float *const p[SPH__LANES], const float *const q[SPH__LANES], const float before[3],
                               const float after[3]);

/* The signed volume of the tetrahedron (o, p, q, r), and the area of (p, q, r), each summed over frames. */
void sph__kernel_volume(const float *o, const float *p, const float *q, const float *r, size_t stride, double sums[2]);
/* The same of eight triangles of one frame; o, p, q and r of each. */
void sph__kernel_volumes(float corners[4][3][SPH__LANES], double sums[SPH__LANES][2]);

/* mean and area rows of the union */
void sph__kernel_unite_means(const float *u, const float *v, size_t stride, float *out);

#endif
