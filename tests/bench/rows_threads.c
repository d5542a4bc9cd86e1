/* SPDX-License-Identifier: MIT */
/* A second thread, by wall time, as that is what it can save; and what the machine's second processor has to give. */
#include <pthread.h>
#include <stdio.h>

#include "bench.h"

enum { MOST = 64 };

static void *build_alone(void *animation)
{
    bench_times times;
    sph_hierarchy_destroy(bench_hierarchy(animation, &times));
    return NULL;
}

/* Wall time of as many builds at once, each on a thread of its own that shares nothing with the other. */
static double time_builds(const sph_animation *const *animations, size_t count)
{
    pthread_t other;
    const double begin = bench_wall();
    if (count > 1 && pthread_create(&other, NULL, build_alone, (void *)animations[1]) != 0) bench_die(NULL, "thread");
    build_alone((void *)animations[0]);
    if (count > 1) pthread_join(other, NULL);
    return bench_wall() - begin;
}

/* No two threads can do more for one build than they do for two that have nothing to do with each other: processors that are
 * two threads of one core get less than twice as much done. */
static void limit(const char *name, const sph_animation *(*input)(sph_context *, sph_animation **))
{
    sph_context *contexts[2] = {bench_context(1), bench_context(1)};
    sph_animation *made[2][2];
    const sph_animation *animations[2] = {input(contexts[0], made[0]), input(contexts[1], made[1])};
    const size_t runs = bench.repeats < MOST ? bench.repeats : MOST;
    double ratios[MOST];
    char key[64];
    for (size_t i = 0; i < runs; ++i) {
        const double one = time_builds(animations, 1);
        ratios[i] = 2 * one / time_builds(animations, 2);
    }
    snprintf(key, sizeof key, "two_builds_at_once_%s", name);
    bench_figure(key, bench_median(ratios, runs), "times", 0, 0);
    for (int k = 0; k < 2; ++k) {
        sph_animation_destroy(made[k][0]);
        sph_animation_destroy(made[k][1]);
        sph_context_destroy(contexts[k]);
    }
}

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
    const char *name = bench.data != NULL && !bench.tiny ? "samba" : "torus";
    if (!bench_section("threads", "one thread against two, wall time: worth something on an idle machine only")) return;
    pair(name, samba);
    limit(name, samba);
    pair("1000_frames", thousand_frames);
    limit("1000_frames", thousand_frames);
}
