/* SPDX-License-Identifier: MIT */
/* One static frame, beside simplification by other libraries. */
#include <stdlib.h>

#include "bench.h"
#include "simplifiers.h"

enum { TARGET = 50, MOST = 64 };

typedef double simplify_fn(const float *xyz, uint32_t n, const uint32_t *triangles, size_t triangle_count,
                           uint32_t target, double (*clock)(void), uint32_t *left);

static simplify_fn *const OTHERS[] = {
#ifdef HAVE_OPENMESH
    bench_openmesh,
#else
    NULL,
#endif
#ifdef HAVE_CGAL
    bench_cgal,
#else
    NULL,
#endif
};
static const char *const FULL_NAMES[] = {"OpenMesh", "CGAL"};
static const char *const TIME_KEYS[] = {"openmesh_s", "cgal_s"};
static const char *const LEFT_KEYS[] = {"openmesh_vertices_left", "cgal_vertices_left"};
static const char *const RATIO_KEYS[] = {"openmesh_over_ours", "cgal_over_ours"};
static const double RATIOS[] = {8, 4};

static void compare(const sph_animation *animation, const float *xyz)
{
    const uint32_t n = sph_animation_vertex_count(animation);
    double ours[MOST], init[MOST], theirs[2][MOST], ratios[2][MOST];
    uint32_t left[2] = {0};
    size_t runs = bench.repeats < MOST ? bench.repeats : MOST;
    for (size_t i = 0; i < runs; ++i) {
        bench_times times;
        sph_hierarchy_destroy(bench_hierarchy(animation, &times));
        ours[i] = times.processor;
        init[i] = times.init;
        for (int k = 0; k < 2; ++k) {
            if (OTHERS[k] == NULL) continue;
            theirs[k][i] = OTHERS[k](xyz, n, sph_animation_triangles(animation),
                                     sph_animation_triangle_count(animation), TARGET, bench_processor, &left[k]);
            ratios[k][i] = theirs[k][i] / ours[i];
        }
    }
    bench_figure("build_s", bench_median(ours, runs), "s", '<', 0.5);
    bench_figure("init_s", bench_median(init, runs), "s", 0, 0);
    for (int k = 0; k < 2; ++k) {
        if (OTHERS[k] == NULL) {
            bench_note("%s: skipped, it was not there when this was built", FULL_NAMES[k]);
            continue;
        }
        bench_figure(TIME_KEYS[k], bench_median(theirs[k], runs), "s", 0, 0);
        bench_figure(LEFT_KEYS[k], left[k], "vertices", 0, 0);
        bench_figure(RATIO_KEYS[k], bench_median(ratios[k], runs), "times", '>', RATIOS[k]);
    }
}

void bench_rows_static(void)
{
    sph_context *context;
    sph_animation *torus, *held;
    float *xyz;
    uint32_t n;
    if (!bench_section("static",
                       "one frame of a bumpy torus of 100,000 vertices, the whole hierarchy; others to 50 vertices"))
        return;
    context = bench_context(1);
    torus = bench_torus(context, bench.tiny ? bench_shape_of(1000, 1) : (bench_shape){500, 200, 1});
    held = bench_hold(context, torus);
    n = sph_animation_vertex_count(held);
    xyz = calloc(n, 3 * sizeof *xyz);
    if (xyz == NULL || sph_animation_read_frame(held, 0, xyz) != SPH_OK) bench_die(context, "frame");
    compare(held, xyz);
    free(xyz);
    sph_animation_destroy(held);
    sph_animation_destroy(torus);
    sph_context_destroy(context);
}
