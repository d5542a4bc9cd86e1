/* SPDX-License-Identifier: MIT */
/*
 * Queries per second on one core.
 *
 *   bench_query [LEVEL.sphm|LEVEL.json] [--mesh INPUT [--cache CACHE]] [--spheres K] [--frame F] [--batch N]
 *               [--tree|--exhaustive] [--only NAME] [--json] [--tiny]
 *
 * Without a level, one of K spheres (default 40) is built from INPUT, or from a built-in animated torus. The mesh is
 * what other libraries are asked about. Casts are asked N at a time (default and most: 1000). --only measures what has
 * NAME in its name: rays, say.
 */
#define _XOPEN_SOURCE 700

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <sphmesh/io.h>

#include "others.h"

enum { QUERIES = 20000, PART = 1000, RINGS = 60, SIDES = 24, FRAMES = 24 };

static sph_context *context;
static bool json;
static int parts = QUERIES / PART; /* of the queries that are asked; one with --tiny */
static const char *separator = "", *only = "";

static void die(const char *what)
{
    fprintf(stderr, "bench_query: %s: %s\n", what, sph_context_last_message(context));
    exit(1);
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static uint64_t state = 1;

static double random_unit(void)
{
    uint64_t z = (state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) / 9007199254740992.0;
}

/* --- what to ask about --- */

static sph_animation *make_torus(void)
{
    enum { N = RINGS * SIDES };
    static float xyz[N][3];
    static uint32_t triangles[2 * N][3];
    sph_animation *animation;
    for (uint32_t i = 0; i < N; ++i) {
        const uint32_t ring = i / SIDES, side = i % SIDES, next = (ring + 1) % RINGS, up = (side + 1) % SIDES;
        const uint32_t corners[2][3] = {{i, next * SIDES + side, ring * SIDES + up},
                                        {next * SIDES + side, next * SIDES + up, ring * SIDES + up}};
        memcpy(triangles[2 * i], corners, sizeof corners);
    }
    if (sph_animation_create(context, N, FRAMES, &animation) != SPH_OK) die("torus");
    for (uint32_t f = 0; f < FRAMES; ++f) {
        for (uint32_t i = 0; i < N; ++i) {
            const double a = 2 * M_PI * (i / SIDES) / RINGS, b = 2 * M_PI * (i % SIDES) / SIDES;
            const double r = 0.25 + 0.1 * sin(3 * a), bend = 0.3 * sin(2 * a + 2 * M_PI * f / FRAMES);
            xyz[i][0] = (float)((1 + r * cos(b)) * cos(a));
            xyz[i][1] = (float)((1 + r * cos(b)) * sin(a));
            xyz[i][2] = (float)(r * sin(b) + bend);
        }
        if (sph_animation_set_frame(animation, f, xyz[0], 0) != SPH_OK) die("torus");
    }
    if (sph_animation_set_triangles(animation, triangles[0], 2 * N, 0) != SPH_OK) die("torus");
    return animation;
}

static sph_level *build_level(const sph_animation *animation, uint32_t spheres)
{
    sph_hierarchy *hierarchy;
    sph_level *level;
    if (sph_hierarchy_create(animation, NULL, &hierarchy) != SPH_OK) die("hierarchy");
    if (sph_level_create(hierarchy, spheres, &level) != SPH_OK) die("level");
    sph_hierarchy_destroy(hierarchy);
    return level;
}

static double diagonal(const float *xyz, size_t count, float low[3], float high[3])
{
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
        low[k] = INFINITY;
        high[k] = -INFINITY;
        for (size_t i = 0; i < count; ++i) {
            low[k] = fminf(low[k], xyz[3 * i + (size_t)k]);
            high[k] = fmaxf(high[k], xyz[3 * i + (size_t)k]);
        }
        sum += ((double)high[k] - low[k]) * ((double)high[k] - low[k]);
    }
    return sqrt(sum);
}

/* From random points of the box, a tenth wider, in random directions. */
static void make_sweeps(sph_sweep *sweeps, const float low[3], const float high[3], double length, double radius)
{
    for (size_t i = 0; i < QUERIES; ++i) {
        double d[3], norm;
        do {
            for (int k = 0; k < 3; ++k)
                d[k] = 2 * random_unit() - 1;
            norm = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        } while (norm > 1 || norm < 1e-3);
        for (int k = 0; k < 3; ++k) {
            sweeps[i].from[k] = low[k] + (float)((1.1 * random_unit() - 0.05)) * (high[k] - low[k]);
            sweeps[i].to[k] = sweeps[i].from[k] + (float)(d[k] / norm * length);
        }
        sweeps[i].radius = (float)radius;
        sweeps[i].reserved0 = 0;
    }
}

/* --- measuring --- */

typedef size_t run_fn(void *user, const sph_sweep *sweeps);

static sph_hit hits[QUERIES];
static sph_nearest nearest[QUERIES];
static uint8_t flags[QUERIES];

static size_t batch = PART;

static size_t run_cast(void *query, const sph_sweep *sweeps)
{
    size_t count = 0;
    for (size_t i = 0; i < PART; i += batch)
        if (sph_query_cast(query, sweeps + i, PART - i < batch ? PART - i : batch, hits + i) != SPH_OK) die("cast");
    for (size_t i = 0; i < PART; ++i)
        count += hits[i].hit;
    return count;
}

static size_t run_any(void *query, const sph_sweep *sweeps)
{
    size_t count = 0;
    if (sph_query_cast_any(query, sweeps, PART, flags) != SPH_OK) die("cast any");
    for (size_t i = 0; i < PART; ++i)
        count += flags[i];
    return count;
}

static size_t run_nearest(void *query, const sph_sweep *sweeps)
{
    size_t count = 0;
    if (sph_query_nearest(query, sweeps[0].from, sizeof *sweeps, PART, nearest) != SPH_OK) die("nearest");
    for (size_t i = 0; i < PART; ++i)
        count += nearest[i].distance <= 0;
    return count;
}

static size_t run_contains(void *query, const sph_sweep *sweeps)
{
    size_t count = 0;
    if (sph_query_contains(query, sweeps[0].from, sizeof *sweeps, PART, SPH_CAVITY_SOLID, flags) != SPH_OK)
        die("contains");
    for (size_t i = 0; i < PART; ++i)
        count += flags[i];
    return count;
}

#ifdef HAVE_BULLET
static size_t run_bullet(void *world, const sph_sweep *sweeps)
{
    return bench_bullet_cast(world, sweeps, PART);
}
#endif

#ifdef HAVE_EMBREE
static size_t run_embree(void *scene, const sph_sweep *sweeps)
{
    return bench_embree_cast(scene, sweeps, PART);
}
#endif

static void report(const char *name, double value, const char *unit, double share)
{
    if (json)
        printf("%s\"%s\":{\"value\":%.6g,\"unit\":\"%s\",\"hits\":%.4f}", separator, name, value, unit, share);
    else
        printf("%-28s %10.4g %-10s %5.1f %% hit\n", name, value, unit, 100 * share);
    separator = ",";
    fflush(stdout);
}

/* The best of some runs of each part: others may be using the machine. */
static void measure(const char *name, run_fn *run, void *user, const sph_sweep *sweeps)
{
    double best[QUERIES / PART], sum = 0;
    const double end = now() + (parts == 1 ? 0 : 0.6);
    size_t count;
    if (strstr(name, only) == NULL) return;
    for (int part = 0; part < parts; ++part)
        best[part] = INFINITY;
    do {
        count = 0;
        for (int part = 0; part < parts; ++part) {
            const double start = now();
            count += run(user, sweeps + part * PART);
            best[part] = fmin(best[part], now() - start);
        }
    } while (now() < end);
    for (int part = 0; part < parts; ++part)
        sum += best[part];
    report(name, parts * PART / sum * 1e-6, "M/s", (double)count / (parts * PART));
}

static void measure_pose(sph_query *query, uint32_t frames)
{
    double best = INFINITY;
    if (strstr("pose", only) == NULL) return;
    for (int round = 0; round < 20; ++round) {
        const double start = now();
        for (int i = 0; i < 100; ++i)
            if (sph_query_pose_time(query, frames > 1 ? fmod(0.37 * i, frames - 1) : 0) != SPH_OK) die("pose");
        best = fmin(best, (now() - start) / 100);
    }
    report("pose", best * 1e6, "us", 0);
}

static void measure_others(const bench_mesh *mesh, const sph_level_arrays *level, uint32_t frame,
                           const sph_sweep *const sweeps[4])
{
    (void)mesh;
    (void)level;
    (void)frame;
    (void)sweeps;
#ifdef HAVE_BULLET
    {
        const float *centers = level->centers + 3 * (size_t)frame * level->sphere_count;
        const float *radii = level->radii + (level->radii_per_frame ? (size_t)frame * level->sphere_count : 0);
        void *compound = bench_bullet_compound(centers, radii, level);
        measure("bullet_compound_long", run_bullet, compound, sweeps[0]);
        measure("bullet_compound_short", run_bullet, compound, sweeps[1]);
        if (mesh->triangle_count > 0) {
            void *world = bench_bullet_mesh(mesh);
            measure("bullet_mesh_long", run_bullet, world, sweeps[0]);
            measure("bullet_mesh_short", run_bullet, world, sweeps[1]);
            measure("bullet_mesh_rays", run_bullet, world, sweeps[2]);
        }
    }
#endif
#ifdef HAVE_EMBREE
    if (mesh->triangle_count > 0) {
        void *scene = bench_embree_mesh(mesh);
        measure("embree_mesh_rays_long", run_embree, scene, sweeps[2]);
        measure("embree_mesh_rays_short", run_embree, scene, sweeps[3]);
    }
#endif
}

static void measure_queries(sph_query *query, const sph_sweep *const sweeps[4])
{
    measure("sweeps_long", run_cast, query, sweeps[0]);
    measure("sweeps_short", run_cast, query, sweeps[1]);
    measure("rays_long", run_cast, query, sweeps[2]);
    measure("rays_short", run_cast, query, sweeps[3]);
    measure("sweeps_long_any", run_any, query, sweeps[0]);
    measure("nearest", run_nearest, query, sweeps[0]);
    measure("contains", run_contains, query, sweeps[0]);
}

static void bench(const sph_animation *animation, const sph_level *level, uint32_t frame, int32_t search)
{
    static sph_sweep sweeps[4][QUERIES];
    const sph_sweep *const all[4] = {sweeps[0], sweeps[1], sweeps[2], sweeps[3]};
    sph_level_arrays arrays = {.struct_size = sizeof arrays};
    bench_mesh mesh = {0};
    float low[3], high[3], *xyz = NULL;
    double size;
    sph_query *query;
    sph_query_options options;
    sph_query_options_init(&options, sizeof options);
    options.search = search;
    if (sph_level_get_arrays(level, &arrays) != SPH_OK) die("level");
    if (frame >= arrays.frame_count) frame = arrays.frame_count - 1;
    if (animation != NULL && frame < sph_animation_frame_count(animation)) {
        mesh.vertex_count = sph_animation_vertex_count(animation);
        mesh.triangle_count = sph_animation_triangle_count(animation);
        mesh.triangles = sph_animation_triangles(animation);
        mesh.positions = xyz = calloc(mesh.vertex_count, 3 * sizeof *xyz);
        if (xyz == NULL || sph_animation_read_frame(animation, frame, xyz) != SPH_OK) die("mesh");
        size = diagonal(xyz, mesh.vertex_count, low, high);
    } else {
        size = diagonal(arrays.centers + 3 * (size_t)frame * arrays.sphere_count, arrays.sphere_count, low, high);
    }
    make_sweeps(sweeps[0], low, high, size, 0.01 * size);
    make_sweeps(sweeps[1], low, high, 0.01 * size, 0.01 * size);
    make_sweeps(sweeps[2], low, high, size, 0);
    make_sweeps(sweeps[3], low, high, 0.01 * size, 0);
    if (sph_query_create(level, &options, &query) != SPH_OK) die("query");
    if (json)
        printf("{\"spheres\":%u,\"wire_edges\":%zu,\"triangles\":%zu,", arrays.sphere_count, arrays.edge_count,
               arrays.triangle_count);
    else
        printf("%u spheres, %zu wire edges, %zu triangles\n", arrays.sphere_count, arrays.edge_count,
               arrays.triangle_count);
    measure_pose(query, arrays.frame_count);
    if (sph_query_pose_frame(query, frame) != SPH_OK) die("pose");
    measure_queries(query, all);
    measure_others(&mesh, &arrays, frame, all);
    if (json) printf("}\n");
    sph_query_destroy(query);
    free(xyz);
}

int main(int argc, char **argv)
{
    const char *level_path = NULL, *mesh_path = NULL;
    uint32_t spheres = 40, frame = 0;
    int32_t search = SPH_SEARCH_AUTO;
    sph_io_open_options options;
    sph_animation *animation = NULL;
    sph_level *level = NULL;
    sph_io_open_options_init(&options, sizeof options);
    for (int i = 1; i < argc; ++i) {
        if (strcmp(argv[i], "--json") == 0)
            json = true;
        else if (strcmp(argv[i], "--tiny") == 0)
            parts = 1;
        else if (strcmp(argv[i], "--only") == 0 && i + 1 < argc)
            only = argv[++i];
        else if (strcmp(argv[i], "--tree") == 0)
            search = SPH_SEARCH_TREE;
        else if (strcmp(argv[i], "--exhaustive") == 0)
            search = SPH_SEARCH_EXHAUSTIVE;
        else if (strcmp(argv[i], "--mesh") == 0 && i + 1 < argc)
            mesh_path = argv[++i];
        else if (strcmp(argv[i], "--cache") == 0 && i + 1 < argc)
            options.cache_path = argv[++i];
        else if (strcmp(argv[i], "--spheres") == 0 && i + 1 < argc)
            spheres = (uint32_t)atoi(argv[++i]);
        else if (strcmp(argv[i], "--frame") == 0 && i + 1 < argc)
            frame = (uint32_t)atoi(argv[++i]);
        else if (strcmp(argv[i], "--batch") == 0 && i + 1 < argc && atoi(argv[i + 1]) > 0)
            batch = (size_t)atoi(argv[++i]);
        else if (argv[i][0] != '-')
            level_path = argv[i];
        else {
            fprintf(stderr, "bench_query: what is %s?\n", argv[i]);
            return 2;
        }
    }
    if (sph_context_create(NULL, &context) != SPH_OK) return 1;
    if (mesh_path != NULL && sph_io_open_animation(context, &mesh_path, 1, &options, &animation) != SPH_OK)
        die(mesh_path);
    if (level_path != NULL && sph_io_load_level(context, level_path, &level) != SPH_OK) die(level_path);
    if (animation == NULL && level == NULL) animation = make_torus();
    if (level == NULL) level = build_level(animation, spheres);
    bench(animation, level, frame, search);
    sph_level_destroy(level);
    sph_animation_destroy(animation);
    sph_context_destroy(context);
    return 0;
}
