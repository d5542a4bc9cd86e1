/* SPDX-License-Identifier: MIT */
/*
 * How fast files are read: a point cache against read() of the same file, OBJ sequences, and a baked glTF. The files
 * are made in a temporary folder and removed again.
 *
 *   bench_io [--json] [--tiny] [--folder DIR] [--repeats N]
 *
 * Rates of parsing are by processor time on one thread, so that a busy machine matters little; those of the cache are
 * by the clock, and the two ways of reading take turns. --tiny runs everything once on next to nothing: its figures
 * mean nothing.
 */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "bench_io.h"

enum { REPEATS_MAX = 32, BUFFER = 1 << 20 };

static struct {
    bool json, tiny, first;
    int repeats;
    char folder[4096];
    sph_context *context;
} bench = {.repeats = 5, .first = true};

void bench_die(const char *what)
{
    const char *message = bench.context == NULL ? "" : sph_context_last_message(bench.context);
    fprintf(stderr, "bench_io: %s: %s\n", what, message[0] != '\0' ? message : strerror(errno));
    exit(EXIT_FAILURE);
}

static double wall(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double processor(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values, int count)
{
    qsort(values, (size_t)count, sizeof *values, compare);
    return values[count / 2];
}

/* One figure; `least` and `most` are targets, NAN: none. */
static void report(const char *key, double value, const char *unit, double least, double most, const char *what)
{
    const bool judged = !bench.tiny && !(isnan(least) && isnan(most));
    const bool good = !(value < least) && !(value > most);
    if (bench.json) {
        printf("%s\n  \"%s\": {\"value\": %.6g, \"unit\": \"%s\"", bench.first ? "{" : ",", key, value, unit);
        if (!isnan(least)) printf(", \"at_least\": %g", least);
        if (!isnan(most)) printf(", \"at_most\": %g", most);
        if (judged) printf(", \"good\": %s", good ? "true" : "false");
        putchar('}');
    } else {
        printf("%-26s %9.4g %-6s", key, value, unit);
        if (judged) printf(" %s %g%s", isnan(least) ? "<" : ">", isnan(least) ? most : least, good ? "" : "  MISSED");
        printf("   %s\n", what);
    }
    bench.first = false;
    fflush(stdout);
}

const char *bench_path(const char *name)
{
    static char paths[4][4200];
    static int next;
    next = (next + 1) % 4;
    snprintf(paths[next], sizeof paths[next], "%s/%s", bench.folder, name);
    return paths[next];
}

static double size_of(const char *path)
{
    struct stat found;
    if (stat(path, &found) != 0) bench_die(path);
    return (double)found.st_size;
}

static sph_animation *open_animation(const char *path, const char *cache, int32_t weld)
{
    sph_io_open_options o;
    sph_animation *animation;
    sph_io_open_options_init(&o, sizeof o);
    o.cache_path = cache;
    o.weld = weld;
    if (sph_io_open_animation(bench.context, &path, 1, &o, &animation) != SPH_OK) bench_die(path);
    return animation;
}

/* All frames one after the other, as everything that follows does. */
static void read_frames(const sph_animation *animation)
{
    const uint32_t n = sph_animation_vertex_count(animation);
    float *xyz = malloc(3 * sizeof(float) * n);
    double sum = 0; /* looked at, so that nothing can be left out */
    if (xyz == NULL) bench_die("memory");
    for (uint32_t f = 0; f < sph_animation_frame_count(animation); ++f) {
        if (sph_animation_read_frame(animation, f, xyz) != SPH_OK) bench_die("frame");
        sum += (double)xyz[3 * (f % n)];
    }
    if (!isfinite(sum)) bench_die("a position that is no number");
    free(xyz);
}

/* --- point caches --- */

/* Has the system forget the file, so that it comes from the disk. */
static void forget(const char *path)
{
    const int file = open(path, O_RDONLY);
    if (file < 0 || fsync(file) != 0 || posix_fadvise(file, 0, 0, POSIX_FADV_DONTNEED) != 0) bench_die(path);
    close(file);
}

static double read_plainly(const char *path)
{
    static char buffer[BUFFER];
    const double start = wall();
    const int file = open(path, O_RDONLY);
    ssize_t got;
    if (file < 0) bench_die(path);
    while ((got = read(file, buffer, sizeof buffer)) > 0) {
    }
    if (got < 0) bench_die(path);
    close(file);
    return wall() - start;
}

static double read_as_cache(const char *mesh, const char *cache)
{
    const double start = wall();
    sph_animation *animation = open_animation(mesh, cache, SPH_IO_WELD_NONE);
    read_frames(animation);
    sph_animation_destroy(animation);
    return wall() - start;
}

static void bench_cache(const char *ending)
{
    const uint32_t vertices = bench.tiny ? 500 : 30000, frames = bench.tiny ? 10 : 1000;
    double plain[2][REPEATS_MAX], ours[2][REPEATS_MAX], ratios[2][REPEATS_MAX], bytes;
    char key[64], name[32];
    const char *mesh = bench_path("cache.obj"), *cache;
    snprintf(name, sizeof name, "cache.%s", ending);
    cache = bench_path(name);
    bench_write_obj(mesh, vertices, 0, false);
    bench_write_cache(cache, vertices, frames);
    bytes = size_of(cache) / 1e6;
    for (int i = 0; i < bench.repeats; ++i)
        for (int warm = 0; warm < 2; ++warm) {
            if (warm == 0) forget(cache);
            plain[warm][i] = read_plainly(cache);
            if (warm == 0) forget(cache);
            ours[warm][i] = read_as_cache(mesh, cache);
            ratios[warm][i] = plain[warm][i] / ours[warm][i];
        }
    for (int warm = 0; warm < 2; ++warm) {
        const char *from = warm == 0 ? "disk" : "memory";
        snprintf(key, sizeof key, "%s_%s_read", ending, from);
        report(key, bytes / median(plain[warm], bench.repeats), "MB/s", NAN, NAN, "by read() alone");
        snprintf(key, sizeof key, "%s_%s_frames", ending, from);
        report(key, bytes / median(ours[warm], bench.repeats), "MB/s", NAN, NAN, "all frames, opening included");
        snprintf(key, sizeof key, "%s_%s_ratio", ending, from);
        report(key, median(ratios[warm], bench.repeats), "", warm == 0 ? 0.8 : NAN, NAN,
               "rate of frames by that of read(), in pairs");
    }
    unlink(cache);
    unlink(mesh);
}

/* --- OBJ sequences --- */

static void bench_sequence(const char *key, bool rich)
{
    const uint32_t vertices = bench.tiny ? 300 : 10000;
    double opened[REPEATS_MAX], whole[REPEATS_MAX], bytes = 0;
    uint32_t frames = 0;
    char name[64];
    const char *pattern;
    sph_animation *animation;
    for (; bytes < (bench.tiny ? 1e5 : 200e6); ++frames) {
        snprintf(name, sizeof name, "s%u.obj", (unsigned)frames);
        bench_write_obj(bench_path(name), vertices, frames, rich);
        bytes += size_of(bench_path(name));
    }
    pattern = bench_path("s%d.obj");
    for (int i = 0; i < bench.repeats; ++i) {
        const double start = processor();
        animation = open_animation(pattern, NULL, SPH_IO_WELD_NONE);
        opened[i] = processor() - start;
        read_frames(animation);
        whole[i] = processor() - start;
        sph_animation_destroy(animation);
    }
    snprintf(name, sizeof name, "%s_open", key);
    report(name, bytes / 1e6 / median(opened, bench.repeats), "MB/s", NAN, NAN,
           "opening: all files parsed and compared");
    report(key, bytes / 1e6 / median(whole, bench.repeats), "MB/s", 100, NAN,
           "opening and reading all frames: each file is parsed twice");
    while (frames-- > 0) {
        snprintf(name, sizeof name, "s%u.obj", (unsigned)frames);
        unlink(bench_path(name));
    }
}

/* --- glTF --- */

static void bench_gltf(void)
{
    const uint32_t vertices = bench.tiny ? 200 : 30000, joints = bench.tiny ? 4 : 40, frames = bench.tiny ? 5 : 100;
    double baked[REPEATS_MAX], welded[REPEATS_MAX];
    const char *path = bench_path("skin.glb");
    bench_write_glb(path, vertices, joints, frames);
    for (int i = 0; i < bench.repeats; ++i) {
        double start = processor();
        sph_animation *animation = open_animation(path, NULL, SPH_IO_WELD_NONE);
        if (sph_animation_frame_count(animation) != frames || sph_animation_vertex_count(animation) != vertices)
            bench_die("the glTF has other counts");
        read_frames(animation);
        baked[i] = processor() - start;
        sph_animation_destroy(animation);
        start = processor();
        animation = open_animation(path, NULL, SPH_IO_WELD_AUTO);
        read_frames(animation);
        welded[i] = processor() - start;
        sph_animation_destroy(animation);
    }
    report("gltf_bake", median(baked, bench.repeats), "s", NAN, 1, "opened, all frames of the skin baked");
    report("gltf_bake_weld", median(welded, bench.repeats), "s", NAN, NAN, "the same with seams united, the default");
    unlink(path);
}

static int usage(void)
{
    fputs("usage: bench_io [--json] [--tiny] [--folder DIR] [--repeats N]\n", stderr);
    return 2;
}

static int parse(int argc, char **argv)
{
    const char *base = getenv("TMPDIR");
    if (base == NULL) base = "/tmp";
    for (int i = 1; i < argc; ++i) {
        if (strcmp(argv[i], "--json") == 0)
            bench.json = true;
        else if (strcmp(argv[i], "--tiny") == 0)
            bench.tiny = true;
        else if (strcmp(argv[i], "--folder") == 0 && i + 1 < argc)
            base = argv[++i];
        else if (strcmp(argv[i], "--repeats") == 0 && i + 1 < argc)
            bench.repeats = atoi(argv[++i]);
        else
            return usage();
    }
    if (bench.repeats < 1 || bench.repeats > REPEATS_MAX) return usage();
    if (bench.tiny) bench.repeats = 1;
    snprintf(bench.folder, sizeof bench.folder, "%s/bench_io-XXXXXX", base);
    return mkdtemp(bench.folder) == NULL ? (bench_die(bench.folder), 1) : 0;
}

int main(int argc, char **argv)
{
    sph_context_options o;
    const int wrong = parse(argc, argv);
    if (wrong != 0) return wrong;
    sph_context_options_init(&o, sizeof o);
    o.thread_count = 1;
    if (sph_context_create(&o, &bench.context) != SPH_OK) bench_die("context");
    if (!bench.json)
        puts(bench.tiny
                 ? "tiny: these figures mean nothing"
                 : "caches of 1000 x 30 000 points, 200 MB of OBJ, a skin of 30 000 vertices, 40 joints, 100 frames");
    bench_cache("pc2");
    bench_cache("mdd");
    bench_sequence("obj", false);
    bench_sequence("obj_rich", true);
    bench_gltf();
    if (bench.json) puts("\n}");
    sph_context_destroy(bench.context);
    return rmdir(bench.folder) == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
