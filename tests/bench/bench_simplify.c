/* SPDX-License-Identifier: MIT */
/*
 * Levels of skinned meshes, by this library's method and by those that it is compared with.
 *
 *   bench_simplify [--csv] [--ratios P,P,...] [--influences k] [--samples N] [--measured N] [--time] RIG...
 *   bench_simplify --tiny
 *
 * RIG is a glTF. Every second frame is an example pose, the others are held out. For each method and number of vertices
 * (percent of the input's points) a row: the mean and the largest distance between the posed original and the posed
 * level, both ways, over example poses and over the others, as percent of the mean diagonal; and seconds of the
 * processor for all levels. --measured bounds the poses that are measured, evenly spread. --tiny: a built-in bent tube.
 */
#define _XOPEN_SOURCE 700

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <sphmesh/io.h>

#include "measure/mesh.h"

enum { MOST_RATIOS = 32, METHODS = 4 };

static const char *const NAMES[METHODS] = {"ours", "mohr-gleicher", "decoro-rusinkiewicz", "static"};

typedef struct settings {
    double ratios[MOST_RATIOS];
    int ratio_count;
    uint32_t influences, samples, measured, rounds;
    double tolerance;
    bool csv, time_only, all_frames;
} settings;

typedef struct distances {
    double mean, most;
} distances;

static sph_context *context;
static settings with = {
    .ratios = {50, 25, 10, 5, 1}, .ratio_count = 5, .influences = 4, .samples = 10000, .measured = 12};

static void die(const char *what)
{
    fprintf(stderr, "bench_simplify: %s: %s\n", what, sph_context_last_message(context));
    exit(1);
}

static void check(sph_status status, const char *what)
{
    if (status != SPH_OK) die(what);
}

static double seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static sph_skin_arrays arrays_of(const sph_skin *skin)
{
    sph_skin_arrays a = {.struct_size = sizeof a};
    check(sph_skin_get_arrays(skin, &a), "arrays");
    return a;
}

/* A tube along x, its right half turned by the second bone. */
static sph_skin *make_tube(void)
{
    enum { RINGS = 25, SIDES = 12, N = RINGS * SIDES, FRAMES = 8 };
    static float rest[N][3], weights[N][2];
    static uint32_t bones[N][2], triangles[2 * (RINGS - 1) * SIDES][3];
    static double transforms[FRAMES][2][12];
    sph_skin_arrays a = {.struct_size = sizeof a, .vertex_count = N, .bone_count = 2, .influence_count = 2};
    sph_skin *skin = NULL;
    size_t count = 0;
    for (uint32_t i = 0; i < N; ++i) {
        const double x = (i / SIDES) / 6.0 - 2, angle = 6.283185307 * (i % SIDES) / SIDES;
        const double share = x < -0.5 ? 0 : x > 0.5 ? 1 : x + 0.5;
        memcpy(rest[i], (float[3]){(float)x, (float)(0.4 * cos(angle)), (float)(0.4 * sin(angle))}, sizeof rest[i]);
        memcpy(weights[i], (float[2]){(float)(1 - share), (float)share}, sizeof weights[i]);
        memcpy(bones[i], (uint32_t[2]){0, 1}, sizeof bones[i]);
    }
    for (uint32_t i = 0; i + SIDES < N; ++i) {
        const uint32_t next = i % SIDES == SIDES - 1 ? i + 1 - SIDES : i + 1;
        memcpy(triangles[count++], (uint32_t[3]){i, i + SIDES, next}, sizeof triangles[0]);
        memcpy(triangles[count++], (uint32_t[3]){next, i + SIDES, next + SIDES}, sizeof triangles[0]);
    }
    for (int f = 0; f < FRAMES; ++f) {
        const double t = 0.2 * f, c = cos(t), s = sin(t);
        memcpy(transforms[f][0], (double[12]){1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, sizeof transforms[f][0]);
        memcpy(transforms[f][1], (double[12]){c, -s, 0, 0, s, c, 0, 0, 0, 0, 1, 0}, sizeof transforms[f][1]);
    }
    a.frame_count = FRAMES;
    a.rest = rest[0];
    a.weights = weights[0];
    a.bones = bones[0];
    a.transforms = transforms[0][0];
    a.triangle_count = count;
    a.triangles = triangles[0];
    check(sph_skin_create_from_arrays(context, &a, &skin), "tube");
    return skin;
}

static void build_mesh(sph__mesh *mesh, const sph_skin_arrays *a)
{
    check(sph__mesh_init(mesh, context, a->vertex_count, a->triangles, a->triangle_count), "mesh");
    memcpy(mesh->xyz, a->rest, 3 * (size_t)a->vertex_count * sizeof *mesh->xyz);
    sph__mesh_build(mesh);
}

/* From points and vertices of one surface to the other: the mean of the former, the most of both. */
static distances measure_way(const sph__mesh *from, const sph__mesh *to, uint32_t frame)
{
    distances d = {0, 0};
    uint32_t cursor = 0, guess = 0;
    double shift[2];
    sph__measure_shift(1, frame, 0, shift);
    for (uint32_t i = 0; i < with.samples; ++i) {
        sph__mesh_point p;
        double distance;
        sph__mesh_sample(from, i, with.samples, shift, &cursor, &p);
        distance = sph__mesh_distance(to, p.position, &guess);
        d.mean += distance / with.samples;
        d.most = fmax(d.most, distance);
    }
    for (uint32_t v = 0; v < from->vertex_count; ++v) {
        const double x[3] = {(double)from->xyz[3 * v], (double)from->xyz[3 * v + 1], (double)from->xyz[3 * v + 2]};
        d.most = fmax(d.most, sph__mesh_distance(to, x, &guess));
    }
    return d;
}

static distances measure_pose(sph__mesh *a, sph__mesh *b, uint32_t frame)
{
    distances there, back;
    sph__mesh_refit(a);
    sph__mesh_refit(b);
    there = measure_way(a, b, frame);
    back = measure_way(b, a, frame);
    return (distances){0.5 * (there.mean + back.mean), fmax(there.most, back.most)};
}

/* Over the frames first, first + 2, ...: the mean of the means, the most of the most, percent of the mean diagonal. */
static distances measure(const sph_skin *original, const sph_skin *level, uint32_t first)
{
    const sph_skin_arrays a = arrays_of(original), b = arrays_of(level);
    const uint32_t frames = (a.frame_count + 1 - first) / 2, step = frames > with.measured ? frames / with.measured : 1;
    distances all = {0, 0};
    sph_deformer *pose_a, *pose_b;
    sph__mesh mesh_a, mesh_b;
    double diagonals = 0;
    uint32_t count = 0;
    check(sph_deformer_create(original, NULL, &pose_a), "deformer");
    check(sph_deformer_create(level, NULL, &pose_b), "deformer");
    build_mesh(&mesh_a, &a);
    build_mesh(&mesh_b, &b);
    for (uint32_t i = 0; i < frames; i += step, ++count) {
        const double *pose = a.transforms + (first + 2 * (size_t)i) * 12 * a.bone_count;
        double low[3], high[3];
        distances d;
        check(sph_deformer_pose(pose_a, pose, 1, SPH_POSE_LINEAR, mesh_a.xyz, NULL), "pose");
        check(sph_deformer_pose(pose_b, pose, 1, SPH_POSE_LINEAR, mesh_b.xyz, NULL), "pose");
        d = measure_pose(&mesh_a, &mesh_b, i);
        diagonals += sph__mesh_diagonal(&mesh_a, low, high);
        all.mean += d.mean;
        all.most = fmax(all.most, d.most);
    }
    sph__mesh_free(&mesh_a);
    sph__mesh_free(&mesh_b);
    sph_deformer_destroy(pose_a);
    sph_deformer_destroy(pose_b);
    return (distances){100 * all.mean / diagonals, 100 * all.most * count / diagonals};
}

static sph_progressive *simplify(const sph_skin *skin, int32_t method, double *taken)
{
    const sph_skin_arrays a = arrays_of(skin);
    const size_t pose = 12 * (size_t)a.bone_count;
    const uint32_t count = with.all_frames ? a.frame_count : (a.frame_count + 1) / 2;
    double *poses = malloc((count + 1) * pose * sizeof *poses);
    sph_simplify_options o;
    sph_progressive *p;
    const double started = seconds();
    if (poses == NULL) die("memory");
    for (size_t j = 0; j < count; ++j)
        memcpy(poses + j * pose, a.transforms + (with.all_frames ? 1 : 2) * j * pose, pose * sizeof *poses);
    sph_simplify_options_init(&o, sizeof o);
    o.method = method;
    o.influence_limit = with.influences;
    if (with.rounds != 0) o.round_limit = with.rounds;
    if (with.tolerance > 0) o.tolerance = with.tolerance;
    o.pose_count = count;
    o.poses = poses;
    check(sph_progressive_create(skin, &o, &p), "simplify");
    *taken = seconds() - started;
    free(poses);
    return p;
}

static void print_row(const char *name, int method, const sph_progressive *p, const sph_skin *skin, double ratio,
                      double taken)
{
    const uint32_t all = sph_progressive_point_count(p), keep = (uint32_t)(all * ratio / 100 + 0.5);
    const uint32_t level = keep < all ? all - keep : 0, most = sph_progressive_collapse_count(p);
    sph_progressive_level l = {.struct_size = sizeof l};
    distances examples, others;
    sph_skin *reduced;
    check(sph_progressive_get_level(p, level < most ? level : most, &l), "level");
    check(sph_progressive_get_skin(p, l.collapse_count, &reduced), "level");
    examples = measure(skin, reduced, 0);
    others = measure(skin, reduced, 1);
    printf(with.csv
               ? "%s,%s,%g,%u,%u,%.4f,%.4f,%.4f,%.4f,%.3f\n"
               : "%-12s %-20s %5g %%  %6u vertices %6u triangles  examples %7.4f %7.3f  others %7.4f %7.3f  %7.2f s\n",
           name, NAMES[method], ratio, (unsigned)l.vertex_count, (unsigned)l.triangle_count, examples.mean,
           examples.most, others.mean, others.most, taken);
    fflush(stdout);
    sph_skin_destroy(reduced);
}

static void run(const char *name, const sph_skin *skin)
{
    for (int method = 0; method < METHODS; ++method) {
        double taken;
        sph_progressive *p = simplify(skin, method, &taken);
        if (with.time_only)
            printf("%-12s %-20s %u poses  %.2f s\n", name, NAMES[method], (unsigned)sph_progressive_pose_count(p),
                   taken);
        for (int r = 0; r < with.ratio_count && !with.time_only; ++r)
            print_row(name, method, p, skin, with.ratios[r], taken);
        sph_progressive_destroy(p);
    }
}

static void run_file(const char *path)
{
    const char *slash = strrchr(path, '/');
    sph_io_rig *rig;
    check(sph_io_open_rig(context, path, NULL, &rig), path);
    run(slash == NULL ? path : slash + 1, sph_io_rig_skin(rig));
    sph_io_rig_destroy(rig);
}

static void read_ratios(char *text)
{
    with.ratio_count = 0;
    for (char *part = strtok(text, ","); part != NULL && with.ratio_count < MOST_RATIOS; part = strtok(NULL, ","))
        with.ratios[with.ratio_count++] = atof(part);
}

int main(int argc, char **argv)
{
    sph_context_options o;
    int files = 0;
    bool tiny = false;
    sph_context_options_init(&o, sizeof o);
    o.thread_count = 1;
    check(sph_context_create(&o, &context), "context");
    for (int i = 1; i < argc; ++i) {
        const char *value = i + 1 < argc ? argv[i + 1] : "0";
        if (!strcmp(argv[i], "--csv"))
            with.csv = true;
        else if (!strcmp(argv[i], "--time"))
            with.time_only = true;
        else if (!strcmp(argv[i], "--all-frames"))
            with.all_frames = true;
        else if (!strcmp(argv[i], "--tiny"))
            tiny = true;
        else if (!strcmp(argv[i], "--ratios") && ++i < argc)
            read_ratios(argv[i]);
        else if (!strcmp(argv[i], "--influences"))
            ++i, with.influences = (uint32_t)atoi(value);
        else if (!strcmp(argv[i], "--samples"))
            ++i, with.samples = (uint32_t)atoi(value);
        else if (!strcmp(argv[i], "--measured"))
            ++i, with.measured = (uint32_t)atoi(value);
        else if (!strcmp(argv[i], "--rounds"))
            ++i, with.rounds = (uint32_t)atoi(value);
        else if (!strcmp(argv[i], "--tolerance"))
            ++i, with.tolerance = atof(value);
        else if (argv[i][0] != '-')
            ++files, run_file(argv[i]);
    }
    if (tiny) {
        sph_skin *tube = make_tube();
        run("tube", tube);
        sph_skin_destroy(tube);
    }
    if (!tiny && files == 0) fprintf(stderr, "bench_simplify: no rig; try --tiny\n");
    sph_context_destroy(context);
    return tiny || files > 0 ? 0 : 2;
}
