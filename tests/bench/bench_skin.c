/* SPDX-License-Identifier: MIT */
/*
 * How well and how fast animations decompose.
 *
 *   bench_skin [INPUT [CACHE]] [--bones K]... [--mode mixed|animation|geometric] [--influences k] [--rings R]
 *              [--rounds N] [--tolerance T] [--trace] [--tiny]
 */
#define _XOPEN_SOURCE 700

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <sphmesh/io.h>

static sph_context *context;

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

static double started;
static void trace(void *user, uint32_t round, int32_t step, double energy)
{
    (void)user;
    printf("# %u %d %.9e %.2f\n", round, step, energy, seconds() - started);
}

int main(int argc, char **argv)
{
    const char *input = NULL, *cache = NULL;
    uint32_t bones[16], count = 0;
    sph_skin_options o;
    sph_io_open_options io;
    sph_animation *animation;
    sph_hierarchy *h;
    sph_context_options co;
    sph_skin_options_init(&o, sizeof o);
    sph_io_open_options_init(&io, sizeof io);
    sph_context_options_init(&co, sizeof co);
    co.thread_count = 1;
    sph_context_create(&co, &context);
    for (int i = 1; i < argc; ++i) {
        if (!strcmp(argv[i], "--bones")) bones[count++] = (uint32_t)atoi(argv[++i]);
        else if (!strcmp(argv[i], "--mode")) { ++i; o.mode = argv[i][0] == 'm' ? 0 : argv[i][0] == 'a' ? 1 : 2; }
        else if (!strcmp(argv[i], "--influences")) o.influence_limit = (uint32_t)atoi(argv[++i]);
        else if (!strcmp(argv[i], "--rings")) o.rings = (uint32_t)atoi(argv[++i]);
        else if (!strcmp(argv[i], "--rounds")) o.round_limit = (uint32_t)atoi(argv[++i]);
        else if (!strcmp(argv[i], "--rest")) o.rest_interval = (uint32_t)atoi(argv[++i]);
        else if (!strcmp(argv[i], "--tolerance")) o.tolerance = atof(argv[++i]);
        else if (!strcmp(argv[i], "--uniform")) o.flags |= SPH_SKIN_UNIFORM;
        else if (!strcmp(argv[i], "--minor")) o.minor_bone = atof(argv[++i]);
        else if (!strcmp(argv[i], "--trace")) o.step = trace;
        else if (input == NULL) input = argv[i];
        else cache = argv[i];
    }
    io.cache_path = cache;
    if (sph_io_open_animation(context, &input, 1, &io, &animation) != SPH_OK) die("open");
    if (sph_hierarchy_create(animation, NULL, &h) != SPH_OK) die("hierarchy");
    for (uint32_t b = 0; b < count; ++b) {
        sph_level *level;
        sph_skin *skin;
        sph_skin_error e;
        const sph_skin_source source = {animation, NULL, 0};
        if (sph_level_create(h, bones[b], &level) != SPH_OK) die("level");
        started = seconds();
        if (sph_skin_create(level, &source, 1, &o, &skin) != SPH_OK) die("skin");
        sph_skin_get_errors(skin, &e, NULL);
        printf("%u bones: rmse/bbd %.3e max/bbd %.3e sqrt(mse) %.3e  %.2f s\n", bones[b], e.rmse_percent / 100,
               e.max_percent / 100, sqrt(e.mse), seconds() - started);
        sph_skin_destroy(skin);
        sph_level_destroy(level);
    }
    return 0;
}
