/* SPDX-License-Identifier: MIT */
/* The simplification of one static mesh by other libraries. */
#ifndef SPH_BENCH_SIMPLIFIERS_H
#define SPH_BENCH_SIMPLIFIERS_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Seconds of processor time of simplifying to `target` vertices by quadric error metrics, making the library's mesh not
 * counted; *left: how many vertices remain. `clock` tells processor time.
 */
double bench_openmesh(const float *xyz, uint32_t n, const uint32_t *triangles, size_t triangle_count, uint32_t target,
                      double (*clock)(void), uint32_t *left);
double bench_cgal(const float *xyz, uint32_t n, const uint32_t *triangles, size_t triangle_count, uint32_t target,
                  double (*clock)(void), uint32_t *left);

#ifdef __cplusplus
}
#endif

#endif
