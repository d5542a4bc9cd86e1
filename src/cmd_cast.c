/* SPDX-License-Identifier: MIT */
/* sphmesh cast: where rays and moving spheres hit a level. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "json.h"
#include "program.h"
#include "report.h"
#include "session.h"

static const char HELP[] = "Casts rays, or moving spheres, at a level in one pose.\n"
                           "\n"
                           "usage: sphmesh cast LEVEL --rays FILE [OPTION]...\n"
                           "\n"
                           "LEVEL is a .json or .sphm. FILE has one cast per line: the start, the end, and\n"
                           "if wanted the radius of a sphere that moves from one to the other:\n"
                           "  x y z  X Y Z  [radius]\n"
                           "Empty lines and what follows a # are skipped; '-' reads standard input.\n"
                           "\n"
                           "      --rays FILE             the casts\n"
                           "      --frame F               the pose: a frame; 2.5 is half way to frame 3 (0)\n"
                           "      --radius R              radius of lines that give none (0: rays)\n"
                           "      --json                  answers and figures as JSON on stdout\n"
                           "      --progress HOW          auto, bar, plain, json or none, on stderr (auto)\n"
                           "      --threads N             threads; 0: one per processor (0)\n"
                           "  -q, --quiet; -h, --help\n"
                           "\n"
                           "Prints one line per cast: s (where on the way, 0 to 1), the point of contact,\n"
                           "the surface normal there, the depth of a start inside, and the simplex that is\n"
                           "hit, as its spheres and their weights; or '-' where nothing is hit.\n"
                           "\n"
                           "example:\n"
                           "  echo '0 0 -9 0 0 9' | sphmesh cast horse-40.json --rays - --frame 12\n";

typedef struct cast_options {
    common_options common;
    const char *rays;
    double frame, radius;
} cast_options;

typedef struct sweep_list {
    sph_sweep *items;
    size_t count, capacity;
} sweep_list;

static int parse(cast_options *o, int argc, char **argv, arguments *paths)
{
    const option table[] = {{"rays", 0, OPTION_TEXT, &o->rays, 0, 0, NULL},
                            {"frame", 0, OPTION_NUMBER, &o->frame, 0, 4294967295.0, NULL},
                            {"radius", 0, OPTION_NUMBER, &o->radius, 0, 1e30, NULL},
                            COMMON_OPTIONS(o->common)};
    int result;
    *o = (cast_options){.rays = NULL};
    result = options_parse("cast", table, argc, argv, paths);
    if (result != DONE || o->common.help) return result;
    if (paths->count == 0) return usage_error("cast", "what at? A level, .json or .sphm, is missing");
    if (paths->count > 1) return usage_error("cast", "one level at a time, not also '%s'", paths->items[1]);
    if (!name_ends(paths->items[0], ".json") && !name_ends(paths->items[0], ".sphm"))
        return usage_error("cast", "'%s' does not end in .json or .sphm", paths->items[0]);
    return o->rays == NULL ? usage_error("cast", "--rays is missing: the file with the casts") : DONE;
}

/* One line into *sweep: 1 done, 0 nothing in it, -1 wrong. */
static int read_line(char *line, double radius, sph_sweep *sweep)
{
    float values[7] = {0, 0, 0, 0, 0, 0, (float)radius};
    int count = 0;
    line[strcspn(line, "#")] = '\0';
    for (const char *at = line;;) {
        char *end;
        at += strspn(at, " \t\r\n,;");
        if (*at == '\0') break;
        if (count == 7) return -1;
        values[count] = strtof(at, &end);
        if (end == at || !isfinite(values[count]) || (count == 6 && values[count] < 0)) return -1;
        ++count;
        at = end;
    }
    if (count == 0) return 0;
    *sweep = (sph_sweep){{values[0], values[1], values[2]}, {values[3], values[4], values[5]}, values[6], 0};
    return count >= 6 ? 1 : -1;
}

static int add_sweep(sweep_list *s, const sph_sweep *sweep)
{
    if (s->count == s->capacity) {
        const size_t capacity = s->capacity == 0 ? 256 : 2 * s->capacity;
        sph_sweep *items = realloc(s->items, capacity * sizeof *items);
        if (items == NULL) return failure("out of memory");
        s->items = items;
        s->capacity = capacity;
    }
    s->items[s->count++] = *sweep;
    return DONE;
}

static int read_sweeps(const cast_options *o, sweep_list *s)
{
    const bool is_input = strcmp(o->rays, "-") == 0;
    FILE *file = is_input ? stdin : fopen(o->rays, "r");
    char *line = NULL;
    size_t size = 0, number = 0;
    int result = DONE;
    if (file == NULL) return failure("%s: cannot be opened: %s", o->rays, strerror(errno));
    while (result == DONE && getline(&line, &size, file) >= 0) {
        sph_sweep sweep;
        const int found = read_line(line, o->radius, &sweep);
        ++number;
        if (found < 0)
            result = failure("%s:%zu: not 'x y z X Y Z' or 'x y z X Y Z radius'", o->rays, number);
        else if (found > 0)
            result = add_sweep(s, &sweep);
    }
    if (result == DONE && ferror(file)) result = failure("%s: cannot be read: %s", o->rays, strerror(errno));
    free(line);
    if (!is_input) fclose(file);
    return result;
}

static const char *kind_name(uint32_t kind)
{
    static const char *const NAMES[] = {"none", "sphere", "edge", "triangle"};
    return NAMES[kind <= SPH_SIMPLEX_TRIANGLE ? kind : 0];
}

static void print_vector(json *j, const char *name, const double x[3])
{
    json_open(j, name, '[');
    for (int k = 0; k < 3; ++k)
        json_number(j, NULL, x[k]);
    json_close(j, ']');
}

static void print_hit_json(json *j, const sph_hit *h)
{
    const sph_contact *c = &h->contact;
    json_open(j, NULL, '{');
    json_boolean(j, "hit", h->hit != 0);
    if (h->hit) {
        json_number(j, "s", h->s);
        json_number(j, "depth", h->depth);
        print_vector(j, "point", c->point);
        print_vector(j, "normal", c->normal);
        json_text(j, "kind", kind_name(c->kind));
        json_integer(j, "simplex", c->simplex);
        json_open(j, "spheres", '[');
        for (int k = 0; k < 3 && c->spheres[k] != SPH_NO_SPHERE; ++k)
            json_integer(j, NULL, c->spheres[k]);
        json_close(j, ']');
        json_open(j, "weights", '[');
        for (int k = 0; k < 3 && c->spheres[k] != SPH_NO_SPHERE; ++k)
            json_number(j, NULL, c->weights[k]);
        json_close(j, ']');
    }
    json_close(j, '}');
}

static void print_hit(const sph_hit *h)
{
    const sph_contact *c = &h->contact;
    if (!h->hit) {
        puts("-");
        return;
    }
    printf("s %.9g  point %.9g %.9g %.9g  normal %.6f %.6f %.6f  depth %.6g  %s", h->s, c->point[0], c->point[1],
           c->point[2], c->normal[0], c->normal[1], c->normal[2], h->depth, kind_name(c->kind));
    for (int k = 0; k < 3 && c->spheres[k] != SPH_NO_SPHERE; ++k)
        printf(" %u:%.4f", (unsigned)c->spheres[k], c->weights[k]);
    putchar('\n');
}

static void print(const session *s, const cast_options *o, const char *path, uint32_t spheres, const sph_hit *hits,
                  size_t count, double seconds)
{
    size_t hit_count = 0;
    json j;
    for (size_t i = 0; i < count; ++i)
        hit_count += hits[i].hit;
    if (!s->json) {
        for (size_t i = 0; i < count && !s->quiet; ++i)
            print_hit(&hits[i]);
        return;
    }
    json_start(&j, stdout, false);
    json_open(&j, NULL, '{');
    json_text(&j, "level", path);
    json_integer(&j, "spheres", spheres);
    json_number(&j, "frame", o->frame);
    json_integer(&j, "casts", count);
    json_integer(&j, "hits", hit_count);
    json_number(&j, "cast_s", seconds);
    json_integer(&j, "peak_rss_bytes", peak_memory());
    json_open(&j, "answers", '[');
    for (size_t i = 0; i < count; ++i)
        print_hit_json(&j, &hits[i]);
    json_close(&j, ']');
    json_close(&j, '}');
    json_finish(&j);
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int cast_at(session *s, const cast_options *o, const char *path, const sph_level *level,
                   const sweep_list *sweeps)
{
    sph_hit *hits = calloc(sweeps->count + 1, sizeof *hits);
    sph_query *query = NULL;
    double start;
    sph_status status = sph_query_create(level, NULL, &query);
    int result = DONE;
    if (status == SPH_OK) status = sph_query_pose_time(query, o->frame);
    start = now();
    if (hits == NULL)
        result = failure("out of memory");
    else if (status == SPH_OK)
        status = sph_query_cast(query, sweeps->items, sweeps->count, hits);
    if (result == DONE && status != SPH_OK) result = session_fail(s, status, NULL);
    if (result == DONE) print(s, o, path, sph_level_sphere_count(level), hits, sweeps->count, now() - start);
    sph_query_destroy(query);
    free(hits);
    return result;
}

static int cast(session *s, const void *options, const arguments *paths)
{
    const cast_options *o = options;
    sweep_list read = {0};
    sph_level *level = NULL;
    int result = load_level(s, paths->items[0], &level);
    if (result == DONE) result = read_sweeps(o, &read);
    if (result == DONE) result = cast_at(s, o, paths->items[0], level, &read);
    sph_level_destroy(level);
    free(read.items);
    return result;
}

static int run(int argc, char **argv)
{
    cast_options o;
    arguments paths;
    return session_run(parse(&o, argc, argv, &paths), &cast_command, &o.common, cast, &o, &paths);
}

const subcommand cast_command = {"cast", "cast rays and moving spheres at a level", HELP, run};
