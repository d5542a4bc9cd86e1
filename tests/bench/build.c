/* SPDX-License-Identifier: MIT */
/* Contexts, and hierarchies made by the clock. */
#include <string.h>

#include "bench.h"

/* When decimation began, by the progress of the one build that is running. */
static double decimation_began;

static bool on_progress(void *user, const char *stage, double fraction)
{
    (void)user;
    (void)fraction;
    if (decimation_began < 0 && strcmp(stage, "decimation") == 0) decimation_began = bench_processor();
    return true;
}

sph_context *bench_context(uint32_t threads)
{
    sph_context_options o;
    sph_context *context;
    sph_context_options_init(&o, sizeof o);
    o.thread_count = threads;
    o.progress = on_progress;
    if (sph_context_create(&o, &context) != SPH_OK) bench_die(NULL, "context");
    return context;
}

sph_hierarchy *bench_hierarchy(const sph_animation *animation, bench_times *times)
{
    const double wall = bench_wall(), began = bench_processor();
    sph_hierarchy *hierarchy;
    double ended;
    decimation_began = -1;
    if (sph_hierarchy_create(animation, NULL, &hierarchy) != SPH_OK) bench_die(NULL, "hierarchy");
    ended = bench_processor();
    *times = (bench_times){.wall = bench_wall() - wall,
                           .processor = ended - began,
                           .init = decimation_began - began,
                           .decimate = ended - decimation_began};
    return hierarchy;
}

static sph_status add_bytes(void *user, const void *bytes, size_t size)
{
    uint64_t *hash = user;
    const unsigned char *p = bytes;
    for (size_t i = 0; i < size; ++i)
        *hash = (*hash ^ p[i]) * 0x100000001b3u; /* FNV-1a */
    return SPH_OK;
}

uint64_t bench_hash(const sph_hierarchy *hierarchy)
{
    uint64_t hash = 0xcbf29ce484222325u;
    if (sph_hierarchy_write(hierarchy, add_bytes, &hash) != SPH_OK) bench_die(NULL, "write");
    return hash;
}
