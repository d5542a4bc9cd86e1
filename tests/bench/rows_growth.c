/* SPDX-License-Identifier: MIT */
/* How time grows with vertices and with frames. */
#include <stdio.h>

#include "bench.h"

enum { MOST = 16 };

/* Median processor nanoseconds per collapse and frame. */
static double unit_time(sph_context *context, bench_shape shape)
{
    sph_animation *torus = bench_torus(context, shape), *held = bench_hold(context, torus);
    double times[MOST];
    const size_t runs = bench.repeats < 3 ? bench.repeats : 3;
    for (size_t i = 0; i < runs; ++i) {
        bench_times t;
        sph_hierarchy *h = bench_hierarchy(held, &t);
        times[i] = 1e9 * t.processor / ((double)sph_hierarchy_collapse_count(h) * shape.frames);
        sph_hierarchy_destroy(h);
    }
    sph_animation_destroy(held);
    sph_animation_destroy(torus);
    return bench_median(times, runs);
}

static void grow(const char *what, const bench_shape *shapes, const uint32_t *sizes, size_t count)
{
    sph_context *context = bench_context(1);
    double least = 0, most = 0;
    char key[64];
    for (size_t i = 0; i < count; ++i) {
        const double t = unit_time(context, shapes[i]);
        snprintf(key, sizeof key, "per_collapse_and_frame_%u_%s", (unsigned)sizes[i], what);
        bench_figure(key, t, "ns", 0, 0);
        least = i == 0 || t < least ? t : least;
        most = i == 0 || t > most ? t : most;
    }
    snprintf(key, sizeof key, "most_over_least_by_%s", what);
    bench_figure(key, most / least, "times", '<', 1.25);
    sph_context_destroy(context);
}

void bench_rows_growth(void)
{
    static const uint32_t VERTICES[] = {5000, 10000, 20000, 50000, 100000, 200000}, FRAMES[] = {10, 30, 100, 300, 1000};
    static const uint32_t FEW_VERTICES[] = {300, 600}, FEW_FRAMES[] = {10, 20};
    const uint32_t *vertices = bench.tiny ? FEW_VERTICES : VERTICES, *frames = bench.tiny ? FEW_FRAMES : FRAMES;
    const size_t vertex_rows = bench.tiny ? 2 : 6, frame_rows = bench.tiny ? 2 : 5;
    bench_shape shapes[6];
    if (!bench_section("growth", "20 frames of more and more vertices, 5,000 vertices of more and more frames")) return;
    for (size_t i = 0; i < vertex_rows; ++i)
        shapes[i] = bench_shape_of(vertices[i], bench.tiny ? 8 : 20);
    grow("vertices", shapes, vertices, vertex_rows);
    for (size_t i = 0; i < frame_rows; ++i)
        shapes[i] = bench_shape_of(bench.tiny ? 300 : 5000, frames[i]);
    grow("frames", shapes, frames, frame_rows);
}
