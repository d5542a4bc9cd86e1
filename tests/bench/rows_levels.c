/* SPDX-License-Identifier: MIT */
/* Jumps to levels, and steps of a cursor. */
#include <stdio.h>

#include "bench.h"
#include "hierarchy/hierarchy.h"

/* Median processor time of a jump, in milliseconds. */
static double jump_time(const sph_hierarchy *h, uint32_t spheres)
{
    enum { RUNS = 31 };
    double times[RUNS];
    for (int i = 0; i < RUNS; ++i) {
        const double began = bench_processor();
        sph_level *level;
        if (sph_level_create(h, spheres, &level) != SPH_OK) bench_die(h->context, "level");
        times[i] = 1e3 * (bench_processor() - began);
        sph_level_destroy(level);
    }
    return bench_median(times, RUNS);
}

static void jumps(const sph_hierarchy *h, const char *frames)
{
    static const uint32_t COUNTS[] = {50, 100, 500, 1000};
    for (size_t i = 0; i < sizeof COUNTS / sizeof *COUNTS; ++i) {
        char key[64];
        if (COUNTS[i] > h->vertex_count || COUNTS[i] < h->vertex_count - h->collapse_count) continue;
        snprintf(key, sizeof key, "jump_to_%u_of_%s", (unsigned)COUNTS[i], frames);
        bench_figure(key, jump_time(h, COUNTS[i]), "ms", '<', 1);
    }
}

/* All simplices are born once and die once, but for those of the input and those that are left. */
static double changes(const sph_hierarchy *h, const sph_cursor *coarsest)
{
    const uint32_t n = h->vertex_count, nodes = n + h->collapse_count;
    const size_t edges = h->edge_starts[nodes], triangles = h->triangle_starts[nodes];
    const size_t born = edges - h->edge_starts[n] + triangles - h->triangle_starts[n];
    /* Wire edges are the only edges that can be counted at the end; one per component and more there are not. */
    const size_t died = edges + triangles - sph_cursor_edge_count(coarsest) - sph_cursor_triangle_count(coarsest);
    return (double)(born + died) + 3.0 * h->collapse_count;
}

static void steps(const sph_hierarchy *h)
{
    enum { RUNS = 9 };
    const uint32_t coarsest = h->vertex_count - h->collapse_count;
    double down[RUNS], up[RUNS], count;
    sph_cursor *cursor;
    if (sph_cursor_create(h, &cursor) != SPH_OK || sph_cursor_move(cursor, coarsest) != SPH_OK)
        bench_die(h->context, "cursor");
    count = changes(h, cursor);
    if (sph_cursor_move(cursor, h->vertex_count) != SPH_OK) bench_die(h->context, "cursor");
    for (int i = 0; i < RUNS; ++i) {
        const double began = bench_processor();
        double turned;
        if (sph_cursor_move(cursor, coarsest) != SPH_OK) bench_die(h->context, "cursor");
        turned = bench_processor();
        if (sph_cursor_move(cursor, h->vertex_count) != SPH_OK) bench_die(h->context, "cursor");
        down[i] = 1e6 * (turned - began) / count;
        up[i] = 1e6 * (bench_processor() - turned) / count;
    }
    sph_cursor_destroy(cursor);
    bench_figure("cursor_down_per_simplex", bench_median(down, RUNS), "us", '<', 2);
    bench_figure("cursor_up_per_simplex", bench_median(up, RUNS), "us", '<', 2);
}

void bench_rows_levels(void)
{
    bench_times times;
    sph_context *context;
    if (!bench_section("levels", "jumps to K spheres with all their frames, and a cursor over all levels; n = 10,000"))
        return;
    context = bench_context(1);
    for (uint32_t frames = 1; frames <= 175; frames += 174) {
        const uint32_t n = bench.tiny ? 300 : 10000, f = bench.tiny && frames > 1 ? 10 : frames;
        sph_animation *torus = bench_torus(context, bench_shape_of(n, f));
        sph_hierarchy *h = bench_hierarchy(torus, &times);
        char name[32];
        snprintf(name, sizeof name, "%u_frames", (unsigned)f);
        jumps(h, name);
        if (frames > 1) steps(h);
        sph_hierarchy_destroy(h);
        sph_animation_destroy(torus);
    }
    sph_context_destroy(context);
}
