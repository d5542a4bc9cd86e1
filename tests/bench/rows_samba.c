/* SPDX-License-Identifier: MIT */
/* The whole hierarchy of samba, beside a loop of its kernel alone. */
#include <math.h>
#include <stdlib.h>

#include "bench.h"
#include "kernel_loop.h"

enum { MOST = 64 };

static void measure(const char *name, const sph_animation *animation)
{
    double whole[MOST], init[MOST], decimate[MOST], loop[MOST], ratios[MOST];
    const size_t runs = bench.repeats < MOST ? bench.repeats : MOST;
    kernel_loop *kernel = kernel_loop_create(animation);
    double evaluations = 0;
    for (size_t i = 0; i < runs; ++i) {
        bench_times t;
        sph_hierarchy *h = bench_hierarchy(animation, &t);
        evaluations = (double)sph_hierarchy_evaluation_count(h);
        whole[i] = t.processor;
        init[i] = t.init;
        decimate[i] = t.decimate;
        loop[i] = kernel_loop_run(kernel, sph_hierarchy_evaluation_count(h));
        ratios[i] = whole[i] / loop[i];
        sph_hierarchy_destroy(h);
    }
    kernel_loop_destroy(kernel);
    if (name != NULL) bench_note("%s", name);
    bench_figure("vertices", sph_animation_vertex_count(animation), "", 0, 0);
    bench_figure("frames", sph_animation_frame_count(animation), "", 0, 0);
    bench_figure("evaluations", evaluations, "", 0, 0);
    bench_figure("build_s", bench_median(whole, runs), "s", '<', 0.6);
    bench_figure("init_s", bench_median(init, runs), "s", 0, 0);
    bench_figure("decimate_s", bench_median(decimate, runs), "s", 0, 0);
    bench_figure("kernel_loop_s", bench_median(loop, runs), "s", 0, 0);
    bench_figure("build_over_kernel_loop", bench_median(ratios, runs), "times", '<', 2);
}

void bench_rows_samba(void)
{
    sph_context *context;
    sph_animation *animation, *held;
    const char *name;
    if (!bench_section("samba",
                       "9971 vertices, 175 frames; the loop evaluates as many costs over blocks in random order"))
        return;
    context = bench_context(1);
    animation = bench_samba_or_torus(context, &name);
    held = bench_hold(context, animation);
    measure(name[0] == 's' ? NULL : "SPHMESH_DATA is not set: a torus of this size stands in for samba", held);
    sph_animation_destroy(held);
    sph_animation_destroy(animation);
    sph_context_destroy(context);
}
