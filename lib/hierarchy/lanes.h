/* SPDX-License-Identifier: MIT */
/*
 * Vectors of eight frames. The width is a constant of the results, never of the machine: sums go lane by lane and are
 * combined by one fixed tree, so that every instruction set gives the same bits.
 */
#ifndef SPH_HIERARCHY_LANES_H
#define SPH_HIERARCHY_LANES_H

#include <stddef.h>
#include <stdint.h>

#include "hierarchy/kernel.h"

typedef float sph__v8f __attribute__((vector_size(32), may_alias));
typedef float sph__v4f __attribute__((vector_size(16), may_alias));
typedef double sph__v8d __attribute__((vector_size(64)));
typedef int64_t sph__v8i __attribute__((vector_size(64)));
typedef uint64_t sph__v8u __attribute__((vector_size(64)));

#define SPH__INLINE static inline __attribute__((always_inline))

#if defined(SPH_HAVE_CLONES)
#  define SPH__CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#  define SPH__CLONES
#endif

/*
 * Macros and pointers, not functions of vectors: in a clone, clang refuses to pass a vector to a function that is compiled
 * for another instruction set, inlined or not. Each is written the way that gcc finds the instruction for: it would
 * convert wide vectors by halves, and compare them lane by lane where the machine's vectors are narrower.
 */
#define sph__widen(x) \
    __extension__({ \
        const sph__v8f x_ = (x); \
        (sph__v8d){(double)x_[0], (double)x_[1], (double)x_[2], (double)x_[3], \
                   (double)x_[4], (double)x_[5], (double)x_[6], (double)x_[7]}; \
    })
#define sph__narrow(x) __builtin_convertvector((sph__v8d)(x), sph__v8f)
#define sph__load(row, i) sph__widen(*(const sph__v8f *)((row) + (i)))
#define sph__store(row, i, value) ((void)(*(sph__v8f *)((row) + (i)) = sph__narrow(value)))
/* `a` where x > y, else `b`. */
#define sph__where(x, y, a, b) \
    __extension__({ \
        const sph__v8d x_ = (x), y_ = (y), a_ = (a), b_ = (b); \
        sph__v8d r_; \
        sph__pick(&x_, &y_, &a_, &b_, &r_); \
        r_; \
    })
#define sph__root(x) \
    __extension__({ \
        const sph__v8d x_ = (x); \
        sph__v8d r_; \
        for (size_t l_ = 0; l_ < SPH__LANES; ++l_) r_[l_] = sqrt(x_[l_]); \
        r_; \
    })
/* What keeps gcc from unrolling these loops before it looks for vectors in them: it would take lane by lane then. */
#if defined(__clang__)
#  define SPH__LANE_LOOP
#else
#  define SPH__LANE_LOOP _Pragma("GCC unroll 1")
#endif

SPH__INLINE void sph__pick(const sph__v8d *x, const sph__v8d *y, const sph__v8d *a, const sph__v8d *b, sph__v8d *r)
{
    const double *px = (const double *)x, *py = (const double *)y, *pa = (const double *)a, *pb = (const double *)b;
    double *pr = (double *)r;
    SPH__LANE_LOOP
    for (size_t l = 0; l < SPH__LANES; ++l) pr[l] = px[l] > py[l] ? pa[l] : pb[l];
}

/* *least = x < *least ? x : *least, lane by lane. */
SPH__INLINE void sph__smaller(const sph__v8d *x, sph__v8d *least)
{
    const sph__v8d before = *least;
    sph__pick(&before, x, x, &before, least);
}

SPH__INLINE void sph__larger(const sph__v8d *x, sph__v8d *most)
{
    const sph__v8d before = *most;
    sph__pick(x, &before, x, &before, most);
}

SPH__INLINE bool sph__is_zero(const sph__v8d *x)
{
    const sph__v8i bits = (sph__v8i)*x;
    return ((bits[0] | bits[1]) | (bits[2] | bits[3]) | (bits[4] | bits[5]) | (bits[6] | bits[7])) == 0;
}

/* Eight rows of eight, turned. */
SPH__INLINE void sph__transpose(const sph__v8f a[SPH__LANES], sph__v8f out[SPH__LANES])
{
    sph__v8f pairs[SPH__LANES], fours[SPH__LANES];
    for (size_t i = 0; i < SPH__LANES; i += 2) {
        pairs[i] = __builtin_shufflevector(a[i], a[i + 1], 0, 8, 1, 9, 4, 12, 5, 13);
        pairs[i + 1] = __builtin_shufflevector(a[i], a[i + 1], 2, 10, 3, 11, 6, 14, 7, 15);
    }
    for (size_t i = 0; i < SPH__LANES; i += 4)
        for (size_t k = 0; k < 2; ++k) {
            fours[i + 2 * k] = __builtin_shufflevector(pairs[i + k], pairs[i + k + 2], 0, 1, 8, 9, 4, 5, 12, 13);
            fours[i + 2 * k + 1] = __builtin_shufflevector(pairs[i + k], pairs[i + k + 2], 2, 3, 10, 11, 6, 7, 14, 15);
        }
    for (size_t k = 0; k < 4; ++k) {
        out[k] = __builtin_shufflevector(fours[k], fours[k + 4], 0, 1, 2, 3, 8, 9, 10, 11);
        out[k + 4] = __builtin_shufflevector(fours[k], fours[k + 4], 4, 5, 6, 7, 12, 13, 14, 15);
    }
}

/* The sum of the lanes of a variable. */
#define sph__sum(v) sph__sum_lanes(&(v))

SPH__INLINE double sph__sum_lanes(const sph__v8d *v)
{
    return (((*v)[0] + (*v)[1]) + ((*v)[2] + (*v)[3])) + (((*v)[4] + (*v)[5]) + ((*v)[6] + (*v)[7]));
}

/* The same of doubles in memory. */
SPH__INLINE double sph__sum_doubles(const double x[SPH__LANES])
{
    return ((x[0] + x[1]) + (x[2] + x[3])) + ((x[4] + x[5]) + (x[6] + x[7]));
}

#endif
