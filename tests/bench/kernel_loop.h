/* SPDX-License-Identifier: MIT */
/* The baseline of decimation: nothing but costs of edges, over blocks in memory, in random order. */
#ifndef SPH_BENCH_KERNEL_LOOP_H
#define SPH_BENCH_KERNEL_LOOP_H

#include <sphmesh/animation.h>

typedef struct kernel_loop kernel_loop;

/* A region with a block for each vertex, of the planes around it, and all edges in a random order. */
kernel_loop *kernel_loop_create(const sph_animation *animation);
/* Evaluates so many costs; returns seconds of processor time. */
double kernel_loop_run(kernel_loop *loop, uint64_t evaluations);
void kernel_loop_destroy(kernel_loop *loop);

#endif
