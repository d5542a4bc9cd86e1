/* SPDX-License-Identifier: MIT */
/* How time grows with vertices and with frames, and what a second thread brings. */
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

/* --- threads: wall time, as that is what a second one can save --- */

static void pair(const char *name, const sph_animation *(*input)(sph_context *, sph_animation **))
{
    sph_context *one = bench_context(1), *two = bench_context(2);
    sph_animation *animations[2][2];
    double ratios[MOST], walls[2][MOST], extra[MOST];
    const size_t runs = bench.repeats < MOST ? bench.repeats : MOST;
    bool same = true;
    char key[64];
    const sph_animation *a = input(one, animations[0]), *b = input(two, animations[1]);
    for (size_t i = 0; i < runs; ++i) {
        bench_times first, second;
        sph_hierarchy *x = bench_hierarchy(a, &first), *y = bench_hierarchy(b, &second);
        if (i == 0) same = bench_hash(x) == bench_hash(y);
        sph_hierarchy_destroy(x);
        sph_hierarchy_destroy(y);
        walls[0][i] = first.wall;
        walls[1][i] = second.wall;
        ratios[i] = first.wall / second.wall;
        extra[i] = second.processor / first.processor;
    }
    snprintf(key, sizeof key, "second_thread_%s", name);
    bench_figure(key, bench_median(ratios, runs), "times", '>', 1.6);
    snprintf(key, sizeof key, "wall_one_thread_%s", name);
    bench_figure(key, bench_median(walls[0], runs), "s", 0, 0);
    snprintf(key, sizeof key, "wall_two_threads_%s", name);
    bench_figure(key, bench_median(walls[1], runs), "s", 0, 0);
    snprintf(key, sizeof key, "processor_time_two_over_one_%s", name);
    bench_figure(key, bench_median(extra, runs), "times", 0, 0);
    snprintf(key, sizeof key, "same_bits_%s", name);
    bench_figure(key, same, "of 1", '>', 1);
    for (int k = 0; k < 2; ++k) {
        sph_animation_destroy(animations[k][0]);
        sph_animation_destroy(animations[k][1]);
    }
    sph_context_destroy(one);
    sph_context_destroy(two);
}

static const sph_animation *samba(sph_context *context, sph_animation **made)
{
    const char *name;
    made[0] = bench_samba_or_torus(context, &name);
    return made[1] = bench_hold(context, made[0]);
}

static const sph_animation *thousand_frames(sph_context *context, sph_animation **made)
{
    made[0] = bench_torus(context, bench.tiny ? bench_shape_of(300, 40) : bench_shape_of(5000, 1000));
    return made[1] = bench_hold(context, made[0]);
}

void bench_rows_threads(void)
{
    if (!bench_section("threads", "one thread against two, wall time: worth something on an idle machine only")) return;
    pair(bench.data != NULL && !bench.tiny ? "samba" : "torus", samba);
    pair("1000_frames", thousand_frames);
}
