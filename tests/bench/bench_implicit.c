/* SPDX-License-Identifier: MIT */
/*
 * Implicit skinning, measured: volume and intersections of a tube that bends and twists, intersections of rigs frame by
 * frame, and frames per second beside those of Vaillant et al. 2013. By hand: bench_implicit [RIG.glb [FPS]]...
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <sphmesh/io.h>
#include <sphmesh/io_rig.h>
#include <sphmesh/sphmesh.h>

static const double PI = 3.14159265358979323846;

/* A chain of bones along x, each `LENGTH` long, in a tube of radius 1. */
typedef struct chain {
    uint32_t bones, sides, rings, vertex_count, triangle_count;
    float *rest, *weights;
    uint32_t *influences, *triangles, *parents;
    double *pivots;
} chain;
static const double LENGTH = 4;

static void *need(size_t count, size_t size)
{
    void *memory = calloc(count, size);
    if (memory == NULL) exit(EXIT_FAILURE);
    return memory;
}

static void check(sph_status status, const sph_context *context)
{
    if (status == SPH_OK) return;
    fprintf(stderr, "bench_implicit: %s\n", sph_context_last_message(context));
    exit(EXIT_FAILURE);
}

static void weigh(const chain *c, uint32_t v)
{
    const double x = (double)c->rest[3 * v] / LENGTH;
    const uint32_t joint = (uint32_t)fmin(fmax(floor(x + 0.5), 1), c->bones - 1); /* the nearest */
    const double u = fmin(fmax((x - joint) * LENGTH / 2 + 0.5, 0), 1);
    c->influences[2 * v] = joint - 1;
    c->influences[2 * v + 1] = joint;
    c->weights[2 * v + 1] = (float)(u * u * (3 - 2 * u));
    c->weights[2 * v] = 1 - c->weights[2 * v + 1];
}

static chain make_chain(uint32_t bones, uint32_t vertex_count)
{
    chain c = {.bones = bones};
    uint32_t at = 0;
    c.sides = (uint32_t)fmax(8, sqrt(vertex_count * 2 * PI / (LENGTH * bones)));
    c.rings = vertex_count / c.sides;
    c.vertex_count = c.rings * c.sides;
    c.triangle_count = 2 * (c.rings - 1) * c.sides;
    c.rest = need(c.vertex_count, 3 * sizeof *c.rest);
    c.weights = need(c.vertex_count, 2 * sizeof *c.weights);
    c.influences = need(c.vertex_count, 2 * sizeof *c.influences);
    c.triangles = need(c.triangle_count, 3 * sizeof *c.triangles);
    c.parents = need(bones, sizeof *c.parents);
    c.pivots = need(bones, 3 * sizeof *c.pivots);
    for (uint32_t v = 0; v < c.vertex_count; ++v) {
        const double angle = 2 * PI * (v % c.sides) / c.sides;
        c.rest[3 * v] = (float)(LENGTH * bones * (v / c.sides) / (c.rings - 1));
        c.rest[3 * v + 1] = (float)cos(angle);
        c.rest[3 * v + 2] = (float)sin(angle);
        weigh(&c, v);
    }
    for (uint32_t r = 0; r + 1 < c.rings; ++r)
        for (uint32_t s = 0; s < c.sides; ++s) {
            const uint32_t a = r * c.sides + s, b = r * c.sides + (s + 1) % c.sides;
            const uint32_t two[6] = {a, b, a + c.sides, b, b + c.sides, a + c.sides};
            memcpy(c.triangles + 3 * at, two, sizeof two);
            at += 2;
        }
    for (uint32_t b = 0; b < bones; ++b) {
        c.parents[b] = b - 1; /* of the first: none */
        c.pivots[3 * b] = LENGTH * b;
    }
    return c;
}

static void free_chain(const chain *c)
{
    free(c->rest);
    free(c->weights);
    free(c->influences);
    free(c->triangles);
    free(c->parents);
    free(c->pivots);
}

/* Each joint bends about z by `bend` and twists by `twist`, to alternate sides. */
static void pose_chain(const chain *c, double bend, double twist, double *transforms)
{
    memset(transforms, 0, 12 * sizeof *transforms);
    transforms[0] = transforms[5] = transforms[10] = 1;
    for (uint32_t b = 1; b < c->bones; ++b) {
        const double *m = transforms + 12 * (b - 1), p = LENGTH * b, angle = b % 2 == 0 ? -bend : bend;
        const double co = cos(angle), si = sin(angle), d = cos(twist), t = sin(twist);
        const double turn[9] = {co, -si * d, si * t, si, co * d, -co * t, 0, t, d};
        double *out = transforms + 12 * b;
        for (int r = 0; r < 3; ++r) {
            for (int k = 0; k < 3; ++k)
                out[4 * r + k] = m[4 * r] * turn[k] + m[4 * r + 1] * turn[3 + k] + m[4 * r + 2] * turn[6 + k];
            out[4 * r + 3] = m[4 * r + 3] + (m[4 * r] - out[4 * r]) * p;
        }
    }
}

static sph_skin *skin_of(sph_context *context, const chain *c)
{
    const sph_skin_arrays arrays = {.struct_size = sizeof arrays,
                                    .vertex_count = c->vertex_count,
                                    .bone_count = c->bones,
                                    .influence_count = 2,
                                    .rest = c->rest,
                                    .bones = c->influences,
                                    .weights = c->weights,
                                    .pivots = c->pivots,
                                    .triangle_count = c->triangle_count,
                                    .triangles = c->triangles};
    sph_skin *skin = NULL;
    check(sph_skin_create_from_arrays(context, &arrays, &skin), context);
    return skin;
}

static sph_tracker *tracker_of(sph_context *context, const sph_skin *skin, const uint32_t *parents, uint32_t flags)
{
    sph_implicit_options o;
    sph_tracker_options to;
    sph_implicit *implicit = NULL;
    sph_tracker *tracker = NULL;
    sph_implicit_options_init(&o, sizeof o);
    sph_tracker_options_init(&to, sizeof to);
    o.parents = parents;
    to.flags = flags;
    check(sph_implicit_create(skin, &o, &implicit), context);
    check(sph_tracker_create(implicit, skin, &to, &tracker), context);
    sph_implicit_destroy(implicit);
    return tracker;
}

/* Of an open tube, its ends closed by fans about the first ring's and the last ring's middles: these move rigidly. */
static double volume_of(const chain *c, const float *xyz)
{
    double sum = 0;
    for (uint32_t t = 0; t < c->triangle_count + 2 * (c->sides - 2); ++t) {
        const uint32_t fan = t - c->triangle_count, k = fan / 2 + 1,
                       base = fan % 2 == 0 ? 0 : c->vertex_count - c->sides;
        const uint32_t ends[3] = {base, base + (fan % 2 == 0 ? k + 1 : k), base + (fan % 2 == 0 ? k : k + 1)};
        const uint32_t *corner = t < c->triangle_count ? c->triangles + 3 * t : ends;
        const float *p = xyz + 3 * corner[0], *q = xyz + 3 * corner[1], *r = xyz + 3 * corner[2];
        for (int i = 0; i < 3; ++i)
            sum += (double)p[i] *
                   ((double)q[(i + 1) % 3] * (double)r[(i + 2) % 3] - (double)q[(i + 2) % 3] * (double)r[(i + 1) % 3]) /
                   6;
    }
    return sum;
}

static void print_fold(sph_context *context)
{
    const chain c = make_chain(2, 1500);
    sph_skin *skin = skin_of(context, &c);
    sph_tracker *tracker = tracker_of(context, skin, c.parents, 0);
    sph_deformer *deformer;
    float *xyz[3];
    const double rest = volume_of(&c, c.rest);
    check(sph_deformer_create(skin, NULL, &deformer), context);
    for (int m = 0; m < 3; ++m)
        xyz[m] = need(c.vertex_count, 3 * sizeof *xyz[m]);
    printf("tube of %u vertices: volume in %% of rest, intersecting pairs (LBS, DQS, ours)\n", c.vertex_count);
    for (int twist = 0; twist < 2; ++twist)
        for (int degrees = 0; degrees <= (twist ? 180 : 140); degrees += twist ? 30 : 20) {
            double transforms[24];
            uint64_t pairs[3];
            pose_chain(&c, twist ? 0 : degrees * PI / 180, twist ? degrees * PI / 180 : 0, transforms);
            for (int32_t m = 0; m < 3; ++m) {
                check(m < 2 ? sph_deformer_pose(deformer, transforms, 1, m, xyz[m], NULL)
                            : sph_tracker_pose(tracker, transforms, 1, xyz[m], NULL, NULL),
                      context);
                check(sph_mesh_intersections(context, c.vertex_count, xyz[m], c.triangle_count, c.triangles, pairs + m),
                      context);
            }
            printf("%s %3d   %6.2f %6.2f %6.2f   %4u %4u %4u\n", twist ? "twist" : "bend ", degrees,
                   100 * volume_of(&c, xyz[0]) / rest, 100 * volume_of(&c, xyz[1]) / rest,
                   100 * volume_of(&c, xyz[2]) / rest, (unsigned)pairs[0], (unsigned)pairs[1], (unsigned)pairs[2]);
        }
    for (int m = 0; m < 3; ++m)
        free(xyz[m]);
    sph_deformer_destroy(deformer);
    sph_tracker_destroy(tracker);
    sph_skin_destroy(skin);
    free_chain(&c);
}

static double seconds(clockid_t clock)
{
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* The least time of some frames: what else the machine does adds to it, and never takes away. */
static double fps_of(uint32_t threads, uint32_t bones, uint32_t vertices, uint32_t flags)
{
    sph_context_options co;
    sph_context *context;
    const chain c = make_chain(bones, vertices);
    double *transforms = need(bones, 12 * sizeof *transforms), best = INFINITY;
    float *xyz = need(c.vertex_count, 3 * sizeof *xyz);
    sph_skin *skin;
    sph_tracker *tracker;
    sph_context_options_init(&co, sizeof co);
    co.thread_count = threads;
    if (sph_context_create(&co, &context) != SPH_OK) exit(EXIT_FAILURE);
    skin = skin_of(context, &c);
    tracker = tracker_of(context, skin, c.parents, flags);
    for (int k = 0; k < 12; ++k) {
        const clockid_t clock = threads == 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC;
        double start;
        pose_chain(&c, 0.2 + 0.07 * k, 0.05 * k, transforms);
        start = seconds(clock);
        check(sph_tracker_pose(tracker, transforms, 1, xyz, NULL, NULL), context);
        best = fmin(best, seconds(clock) - start);
    }
    sph_tracker_destroy(tracker);
    sph_skin_destroy(skin);
    sph_context_destroy(context);
    free(transforms);
    free(xyz);
    free_chain(&c);
    return 1 / best;
}

static void print_speed(void)
{
    static const uint32_t SIZES[3][3] = {{4164, 67, 95}, {31750, 21, 15}, {172974, 23, 3}};
    printf("frames per second: vertices, bones, paper's; guarded, 1 and 2 threads; unguarded, 1 and 2 threads\n");
    for (int i = 0; i < 3; ++i) {
        printf("%6u %2u %3u  ", SIZES[i][0], SIZES[i][1], SIZES[i][2]);
        for (uint32_t k = 0; k < 4; ++k)
            printf(" %7.1f", fps_of(1 + k % 2, SIZES[i][1], SIZES[i][0], k < 2 ? 0 : SPH_TRACKER_UNGUARDED));
        printf("\n");
    }
}

/* Pairs of one frame by one method; 2: ours. */
static uint64_t pairs_of(sph_context *context, const sph_skin_arrays *a, const float *xyz)
{
    uint64_t pairs;
    check(sph_mesh_intersections(context, a->vertex_count, xyz, a->triangle_count, a->triangles, &pairs), context);
    return pairs;
}

static void print_rig(sph_context *context, const char *path, double fps)
{
    sph_io_open_rig_options o;
    sph_io_rig *rig;
    sph_io_rig_arrays parts = {.struct_size = sizeof parts};
    sph_skin_arrays a = {.struct_size = sizeof a};
    sph_deformer *deformer;
    sph_tracker *tracker;
    float *xyz;
    sph_io_open_rig_options_init(&o, sizeof o);
    o.fps = fps;
    check(sph_io_open_rig(context, path, &o, &rig), context);
    check(sph_io_rig_get_arrays(rig, &parts), context);
    check(sph_skin_get_arrays(sph_io_rig_skin(rig), &a), context);
    check(sph_deformer_create(sph_io_rig_skin(rig), NULL, &deformer), context);
    tracker = tracker_of(context, sph_io_rig_skin(rig), parts.parents, 0);
    xyz = need(a.vertex_count, 3 * sizeof *xyz);
    printf("%s: pairs per frame (LBS, DQS, ours), frames in which ours has more than DQS\n", path);
    for (uint32_t k = 0; k < a.clip_count; ++k) {
        uint64_t sums[3] = {0};
        uint32_t worse = 0;
        for (uint32_t f = a.clips[k].first_frame; f < a.clips[k].first_frame + a.clips[k].frame_count; ++f) {
            const double *transforms = a.transforms + (size_t)12 * a.bone_count * f;
            uint64_t now[3];
            for (int32_t m = 0; m < 3; ++m) {
                check(m < 2 ? sph_deformer_pose(deformer, transforms, 1, m, xyz, NULL)
                            : sph_tracker_pose(tracker, transforms, 1, xyz, NULL, NULL),
                      context);
                sums[m] += now[m] = pairs_of(context, &a, xyz);
            }
            worse += now[2] > now[1];
        }
        printf("  %-20s %4u frames  %8.1f %8.1f %8.1f   %u\n", a.clips[k].name, (unsigned)a.clips[k].frame_count,
               (double)sums[0] / a.clips[k].frame_count, (double)sums[1] / a.clips[k].frame_count,
               (double)sums[2] / a.clips[k].frame_count, (unsigned)worse);
    }
    free(xyz);
    sph_tracker_destroy(tracker);
    sph_deformer_destroy(deformer);
    sph_io_rig_destroy(rig);
}

int main(int argc, char **argv)
{
    sph_context *context;
    if (sph_context_create(NULL, &context) != SPH_OK) return EXIT_FAILURE;
    for (int i = 1; i < argc; i += 2)
        print_rig(context, argv[i], i + 1 < argc ? atof(argv[i + 1]) : 30);
    if (argc == 1) {
        print_fold(context);
        print_speed();
    }
    sph_context_destroy(context);
    return EXIT_SUCCESS;
}
