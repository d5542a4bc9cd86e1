/* SPDX-License-Identifier: MIT */
/* How much memory a build takes, each in a process of its own, and builds under a limit. */
#define _XOPEN_SOURCE 700

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"

typedef struct child_result {
    double peak, input, wall, processor; /* bytes, bytes, seconds */
    uint64_t hash;
    uint64_t file; /* bytes of the temporary file */
} child_result;

/* Takes the times of the parts no longer, but those of a build under a limit are not reported. */
static bool trim(void *spill, const char *stage, double fraction)
{
    (void)stage;
    (void)fraction;
    sph_io_spill_trim(spill);
    return true;
}

/* Context and spill of a child with a limit. */
static sph_context *limited_context(sph_context *plain, uint64_t limit, sph_io_spill **spill)
{
    sph_context_options o;
    sph_io_spill_options s;
    sph_context *context;
    sph_io_spill_options_init(&s, sizeof s);
    s.memory_limit = limit;
    s.folder = bench.folder;
    if (sph_io_spill_create(plain, &s, spill) != SPH_OK) bench_die(plain, "limit");
    sph_context_options_init(&o, sizeof o);
    o.thread_count = 1;
    sph_io_spill_get_allocator(*spill, &o.allocator);
    sph_io_spill_get_executor(*spill, &o.executor);
    o.progress = trim;
    o.progress_user = *spill;
    if (sph_context_create(&o, &context) != SPH_OK) bench_die(plain, "context");
    return context;
}

static sph_animation *child_input(sph_context *context, const char *input)
{
    bench_shape shape;
    sph_animation *animation;
    if (sscanf(input, "%" SCNu32 "x%" SCNu32 "x%" SCNu32, &shape.rings, &shape.sides, &shape.frames) == 3)
        return bench_torus(context, shape);
    animation = bench_samba(context);
    if (animation == NULL) bench_die(NULL, input);
    return animation;
}

/* Prints peak, input, wall, processor, hash, file. The hash is taken after the peak has been read. */
int bench_child(const char *input, const char *limit)
{
    const uint64_t bytes = strtoull(limit, NULL, 10);
    sph_context *plain = bench_context(1), *context = plain;
    sph_io_spill *spill = NULL;
    sph_io_spill_figures figures = {.struct_size = sizeof figures};
    sph_animation *animation;
    sph_hierarchy *hierarchy;
    bench_times times;
    double size, peak;
    if (bytes != 0) context = limited_context(plain, bytes, &spill);
    animation = child_input(context, input);
    size = 12.0 * sph_animation_vertex_count(animation) * sph_animation_frame_count(animation);
    hierarchy = bench_hierarchy(animation, &times);
    peak = bench_peak_resident();
    if (spill != NULL && sph_io_spill_get_figures(spill, &figures) != SPH_OK) bench_die(plain, "figures");
    printf("%.0f %.0f %.9g %.9g %" PRIu64 " %" PRIu64 "\n", peak, size, times.wall, times.processor,
           bench_hash(hierarchy), figures.file_bytes);
    sph_hierarchy_destroy(hierarchy);
    sph_animation_destroy(animation);
    if (spill != NULL) sph_context_destroy(context);
    sph_io_spill_destroy(spill);
    sph_context_destroy(plain);
    return 0;
}

static child_result run_child(const char *input, double limit)
{
    char command[4096];
    child_result r = {0};
    FILE *child;
    snprintf(command, sizeof command, "'%s' %s%s%s %s%s%s --child %s %.0f", bench.self,
             bench.data != NULL ? "--data '" : "", bench.data != NULL ? bench.data : "", bench.data != NULL ? "'" : "",
             bench.folder != NULL ? "--folder '" : "", bench.folder != NULL ? bench.folder : "",
             bench.folder != NULL ? "'" : "", input, limit);
    child = popen(command, "r");
    if (child == NULL || fscanf(child, "%lf %lf %lf %lf %" SCNu64 " %" SCNu64, &r.peak, &r.input, &r.wall, &r.processor,
                                &r.hash, &r.file) != 6)
        bench_die(NULL, command);
    if (pclose(child) != 0) bench_die(NULL, command);
    return r;
}

static void free_row(const char *name, const child_result *r)
{
    char key[96];
    snprintf(key, sizeof key, "peak_over_input_%s", name);
    bench_figure(key, r->peak / r->input, "times", '<', 4);
    snprintf(key, sizeof key, "peak_%s", name);
    bench_figure(key, r->peak / 1e6, "MB", 0, 0);
}

/* Beside the same build without a limit. */
static void limited_row(const char *name, const char *input, double limit, const child_result *whole)
{
    const child_result r = run_child(input, limit);
    char key[96];
    snprintf(key, sizeof key, "input_over_limit_%s", name);
    bench_figure(key, r.input / limit, "times", 0, 0);
    snprintf(key, sizeof key, "same_bits_%s", name);
    bench_figure(key, r.hash == whole->hash, "of 1", '>', 1);
    snprintf(key, sizeof key, "peak_over_limit_%s", name);
    bench_figure(key, r.peak / limit, "times", 0, 0);
    snprintf(key, sizeof key, "peak_beyond_limit_%s", name);
    bench_figure(key, (r.peak - limit) / 1e6, "MB", '<', 33.6);
    snprintf(key, sizeof key, "time_over_unlimited_%s", name);
    bench_figure(key, r.processor / whole->processor, "times", 0, 0);
    snprintf(key, sizeof key, "temporary_file_%s", name);
    bench_figure(key, (double)r.file / 1e6, "MB", 0, 0);
}

void bench_rows_memory(void)
{
    const bench_shape shape = bench.tiny ? bench_shape_of(1500, 64) : (bench_shape){355, 141, 500};
    char torus[64];
    child_result whole;
    if (!bench_section("memory", "peak resident memory of builds that pull their frames, each in a process of its own"))
        return;
    if (bench_peak_resident() == 0) {
        bench_note("skipped: the system does not tell how much is resident");
        return;
    }
    if (bench.data != NULL && !bench.tiny) {
        const child_result r = run_child("samba", 0);
        free_row("samba", &r);
    } else {
        bench_note("samba: skipped, SPHMESH_DATA is not set");
    }
    snprintf(torus, sizeof torus, "%ux%ux%u", (unsigned)shape.rings, (unsigned)shape.sides, (unsigned)shape.frames);
    whole = run_child(torus, 0);
    free_row("torus", &whole);
    limited_row("torus", torus, bench.tiny ? 16 << 20 : 96 << 20, &whole);
}
