/* SPDX-License-Identifier: MIT */
/*
 * How well, and in how much processor time, an animation decomposes over the spheres of its levels.
 *
 *   bench_skin [--cache CACHE] [--bones K,K,...] [--mode mixed|animation|geometric] [--influences k] [--rings R]
 *              [--rounds N] [--rest N] [--tolerance T] [--minor S] [--uniform] [--error PERCENT] [--trace] [INPUT...]
 *   bench_skin --tiny
 *
 * Prints a row for each number of bones: the root mean squared distance over vertices and frames, the largest, and the
 * root of Eq. 13, all as fractions of the mean diagonal of the bounding box; how rough the weights are (the mean over
 * edges of the sum of squared differences, by 10000); and seconds on one thread. --tiny decomposes a built-in torus.
 */
#define _XOPEN_SOURCE 700

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <sphmesh/io.h>

enum { MOST_ROWS = 16, RINGS = 24, SIDES = 10, FRAMES = 12 };

static sph_context *context;
static double started;

static void die(const char *what)
{
    fprintf(stderr, "bench_skin: %s: %s\n", what, sph_context_last_message(context));
    exit(1);
}

static double seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void trace(void *user, uint32_t round, int32_t step, double energy)
{
    static const char *const NAMES[] = {"start", "transforms", "weights", "rest", "ahead"};
    (void)user;
    printf("# round %u %s %.9e %.2f s\n", round, NAMES[step], energy, seconds() - started);
}

static sph_animation *make_torus(void)
{
    enum { N = RINGS * SIDES };
    static float xyz[N][3];
    static uint32_t triangles[2 * N][3];
    sph_animation *animation;
    if (sph_animation_create(context, N, FRAMES, &animation) != SPH_OK) die("animation");
    for (uint32_t i = 0; i < N; ++i) {
        const uint32_t ring = i / SIDES, side = i % SIDES, next = (ring + 1) % RINGS, up = (side + 1) % SIDES;
        memcpy(triangles[2 * i], (uint32_t[3]){i, next * SIDES + side, ring * SIDES + up}, sizeof triangles[0]);
        memcpy(triangles[2 * i + 1], (uint32_t[3]){next * SIDES + side, next * SIDES + up, ring * SIDES + up},
               sizeof triangles[0]);
    }
    for (uint32_t f = 0; f < FRAMES; ++f) {
        for (uint32_t i = 0; i < N; ++i) {
            const double a = 6.283185307 * (i / SIDES) / RINGS, b = 6.283185307 * (i % SIDES) / SIDES;
            const double r = 2 + 0.5 * cos(b);
            xyz[i][0] = (float)(r * cos(a));
            xyz[i][1] = (float)(r * sin(a) + 0.1 * f * cos(a));
            xyz[i][2] = (float)(0.5 * sin(b) + 0.5 * sin(0.5 * f) * cos(2 * a));
        }
        sph_animation_set_frame(animation, f, xyz[0], 0);
    }
    sph_animation_set_triangles(animation, triangles[0], sizeof triangles / sizeof *triangles, 0);
    return animation;
}

/* A vertex' weights are sorted by size and not by bone: every pair is compared. */
static double roughness(const sph_skin *skin)
{
    sph_skin_arrays a = {.struct_size = sizeof a};
    const uint32_t k = sph_skin_influence_count(skin);
    double sum = 0;
    sph_skin_get_arrays(skin, &a);
    for (size_t i = 0; i < 3 * a.triangle_count; ++i) {
        const size_t one = (size_t)a.triangles[i] * k, other = (size_t)a.triangles[i % 3 == 2 ? i - 2 : i + 1] * k;
        for (uint32_t s = 0; s < k; ++s) {
            sum += (double)a.weights[one + s] * (double)a.weights[one + s] +
                   (double)a.weights[other + s] * (double)a.weights[other + s];
            for (uint32_t t = 0; t < k; ++t)
                if (a.bones[one + s] == a.bones[other + t])
                    sum -= 2 * (double)a.weights[one + s] * (double)a.weights[other + t];
        }
    }
    return 1e4 * sum / (double)(a.triangle_count ? 3 * a.triangle_count : 1);
}

static void print_row(const sph_hierarchy *hierarchy, const sph_animation *animation, uint32_t bones,
                      const sph_skin_options *options)
{
    const sph_skin_source source = {animation, NULL, 0};
    sph_level *level;
    sph_skin *skin;
    sph_skin_error e;
    double taken;
    if (sph_level_create(hierarchy, bones, &level) != SPH_OK) die("level");
    started = seconds();
    if (sph_skin_create(level, &source, 1, options, &skin) != SPH_OK) die("skin");
    taken = seconds() - started;
    if (sph_skin_get_errors(skin, &e, NULL) != SPH_OK) die("errors");
    printf("%3u bones  rmse %.3e  max %.3e  sqrt(mse) %.3e  roughness %7.1f  %6.2f s\n", bones, e.rmse_percent / 100,
           e.max_percent / 100, sqrt(e.mse), roughness(skin), taken);
    sph_skin_destroy(skin);
    sph_level_destroy(level);
}

static uint32_t read_list(char *text, uint32_t *list)
{
    uint32_t count = 0;
    for (char *part = strtok(text, ","); part != NULL && count < MOST_ROWS; part = strtok(NULL, ","))
        list[count++] = (uint32_t)strtoul(part, NULL, 10);
    return count;
}

/* True where the argument has a value, which is taken. */
static bool read_option(const char *name, char *value, sph_skin_options *o)
{
    if (!strcmp(name, "--influences")) o->influence_limit = (uint32_t)atoi(value);
    else if (!strcmp(name, "--rings")) o->rings = (uint32_t)atoi(value);
    else if (!strcmp(name, "--rounds")) o->round_limit = (uint32_t)atoi(value);
    else if (!strcmp(name, "--rest")) o->rest_interval = (uint32_t)atoi(value);
    else if (!strcmp(name, "--tolerance")) o->tolerance = atof(value);
    else if (!strcmp(name, "--minor")) o->minor_bone = atof(value);
    else if (!strcmp(name, "--error")) o->error_limit = atof(value);
    else if (!strcmp(name, "--mode"))
        o->mode = value[0] == 'a' ? SPH_SKIN_ANIMATION : value[0] == 'g' ? SPH_SKIN_GEOMETRIC : SPH_SKIN_MIXED;
    else return false;
    return true;
}

int main(int argc, char **argv)
{
    const char **inputs = calloc((size_t)argc, sizeof *inputs);
    uint32_t bones[MOST_ROWS] = {10}, rows = 1;
    size_t count = 0;
    sph_skin_options o;
    sph_io_open_options io;
    sph_context_options with;
    sph_animation *animation;
    sph_hierarchy *hierarchy;
    bool tiny = false;
    sph_skin_options_init(&o, sizeof o);
    sph_io_open_options_init(&io, sizeof io);
    sph_context_options_init(&with, sizeof with);
    with.thread_count = 1;
    for (int i = 1; i < argc; ++i) {
        if (!strcmp(argv[i], "--uniform")) o.flags |= SPH_SKIN_UNIFORM;
        else if (!strcmp(argv[i], "--trace")) o.step = trace;
        else if (!strcmp(argv[i], "--tiny")) tiny = true;
        else if (argv[i][0] != '-') inputs[count++] = argv[i];
        else if (i + 1 < argc && !strcmp(argv[i], "--cache")) io.cache_path = argv[++i];
        else if (i + 1 < argc && !strcmp(argv[i], "--bones")) rows = read_list(argv[++i], bones);
        else if (i + 1 < argc && read_option(argv[i], argv[i + 1], &o)) ++i;
        else count = 0, i = argc, tiny = false;
    }
    if (inputs == NULL || (count == 0 && !tiny)) {
        fprintf(stderr, "bench_skin: no input, or an option that is not known; try --tiny\n");
        return 2;
    }
    if (sph_context_create(&with, &context) != SPH_OK) die("context");
    if (tiny) animation = make_torus();
    else if (sph_io_open_animation(context, inputs, count, &io, &animation) != SPH_OK) die("input");
    if (sph_hierarchy_create(animation, NULL, &hierarchy) != SPH_OK) die("hierarchy");
    for (uint32_t r = 0; r < rows; ++r)
        print_row(hierarchy, animation, bones[r], &o);
    sph_hierarchy_destroy(hierarchy);
    sph_animation_destroy(animation);
    sph_context_destroy(context);
    free(inputs);
    return 0;
}
