/* SPDX-License-Identifier: MIT */
/* sphmesh info: what a file is, and whether anything about it deserves attention. */
#include <stdio.h>

#include "contents.h"
#include "program.h"
#include "report.h"
#include "session.h"

static const char HELP[] = "Tells what a file is, an animated mesh, a hierarchy or a level, and what about\n"
                           "it deserves attention.\n"
                           "\n"
                           "usage: sphmesh info FILE... [OPTION]...\n"
                           "\n"
                           "FILE is a hierarchy or level (.sphm), a level (.json), or an animation, named\n"
                           "as for 'sphmesh build'.\n"
                           "\n"
                           "      --cache C               the frames of the mesh: a PC2 or MDD point cache\n"
                           "      --frames A:B:STEP       frames A, A+STEP, ... below B only (from 0)\n"
                           "      --clip NAME, --object NAME, --space local|world, --fps N, --up y|z,\n"
                           "      --scale S               as for 'sphmesh build'\n"
                           "      --json                  figures as JSON on stdout\n"
                           "      --progress HOW          auto, bar, plain, json or none, on stderr (auto)\n"
                           "      --threads N             threads; 0: one per processor (0)\n"
                           "  -q, --quiet; -h, --help\n"
                           "\n"
                           "examples:\n"
                           "  sphmesh info horse.obj --cache horse.pc2\n"
                           "  sphmesh info fox.glb\n"
                           "  sphmesh info walk.abc\n"
                           "  sphmesh info horse.sphm\n"
                           "  sphmesh info horse-40.json --json\n";

/* Counts of spheres that `info` tells the error for, where the hierarchy has them. */
static const uint32_t COUNTS[] = {1000, 500, 200, 100, 60, 40, 20, 10, 5};
enum { COUNT_COUNT = sizeof COUNTS / sizeof COUNTS[0] };

static int info_animation(session *s, const input_options *input, const arguments *paths)
{
    sph_animation_report r;
    sph_animation *a = NULL;
    double diagonal = 0;
    sph_status status, bad;
    json j;
    sph_animation_report_init(&r, sizeof r);
    progress_start(&s->progress, "checking");
    status = input_open(s, input, paths, &input->frames, &a);
    if (status == SPH_OK) status = sph_animation_check(a, &r);
    progress_end(&s->progress);
    if (status != SPH_OK) {
        sph_animation_destroy(a);
        return session_fail(s, status, NULL);
    }
    bad = sph_animation_bounding_diagonal(a, &diagonal); /* fails where positions are not finite: the check says it */
    if (s->json) {
        json_start(&j, stdout, false);
        json_open(&j, NULL, '{');
        json_text(&j, "kind", "animation");
        contents_print_format(s, input, paths, &j);
        json_integer(&j, "vertices", sph_animation_vertex_count(a));
        json_integer(&j, "triangles", sph_animation_triangle_count(a));
        json_integer(&j, "frames", sph_animation_frame_count(a));
        if (bad == SPH_OK)
            json_number(&j, "bounding_diagonal", diagonal);
        else
            json_null(&j, "bounding_diagonal");
        report_check_json(&j, &r);
        contents_print(s, input, paths, &j);
        json_close(&j, '}');
        json_finish(&j);
    } else if (!s->quiet) {
        contents_print_format(s, input, paths, NULL);
        printf("animation:  %s vertices, %s triangles, %s frames\n", count_text(sph_animation_vertex_count(a)),
               count_text(sph_animation_triangle_count(a)), count_text(sph_animation_frame_count(a)));
        if (bad == SPH_OK) printf("size:       bounding-box diagonal %.6g, mean over frames\n", diagonal);
        contents_print(s, input, paths, NULL);
        report_check(&r);
    }
    sph_animation_destroy(a);
    return DONE;
}

static void print_level_row(const sph_hierarchy *h, sph_cursor *cursor, uint32_t count, json *j)
{
    const double diagonal = sph_hierarchy_bounding_diagonal(h), error = level_error(h, count);
    const double percent = diagonal > 0 ? 100 * error / diagonal : 0;
    if (sph_cursor_move(cursor, count) != SPH_OK) return;
    if (j == NULL) {
        printf("%10s  %8zu  %9zu  %9.3f\n", count_text(count), sph_cursor_edge_count(cursor),
               sph_cursor_triangle_count(cursor), percent);
        return;
    }
    json_open(j, NULL, '{');
    json_integer(j, "spheres", count);
    json_integer(j, "edges", sph_cursor_edge_count(cursor));
    json_integer(j, "triangles", sph_cursor_triangle_count(cursor));
    json_number(j, "error", error);
    json_number(j, "error_percent", percent);
    json_close(j, '}');
}

/* The levels from fine to coarse, the coarsest always. */
static void print_levels(const sph_hierarchy *h, sph_cursor *cursor, json *j)
{
    const uint32_t least = coarsest_count(h);
    for (int i = 0; i < COUNT_COUNT; ++i)
        if (COUNTS[i] > least && COUNTS[i] <= sph_hierarchy_vertex_count(h)) print_level_row(h, cursor, COUNTS[i], j);
    print_level_row(h, cursor, least, j);
}

static void hierarchy_json(const sph_hierarchy *h, sph_cursor *cursor)
{
    json j;
    json_start(&j, stdout, false);
    json_open(&j, NULL, '{');
    json_text(&j, "kind", "hierarchy");
    json_integer(&j, "vertices", sph_hierarchy_vertex_count(h));
    json_integer(&j, "triangles", sph_cursor_triangle_count(cursor));
    json_integer(&j, "frames", sph_hierarchy_frame_count(h));
    json_integer(&j, "collapses", sph_hierarchy_collapse_count(h));
    json_integer(&j, "components", coarsest_count(h));
    json_integer(&j, "spheres_min", coarsest_count(h));
    json_integer(&j, "first_forced", sph_hierarchy_first_forced(h));
    json_number(&j, "bounding_diagonal", sph_hierarchy_bounding_diagonal(h));
    json_open(&j, "levels", '[');
    print_levels(h, cursor, &j);
    json_close(&j, ']');
    json_close(&j, '}');
    json_finish(&j);
}

static int info_hierarchy(session *s, const char *path)
{
    sph_hierarchy *h = NULL;
    sph_cursor *cursor = NULL;
    sph_status status = sph_io_load_hierarchy(s->context, path, &h);
    if (status == SPH_OK) status = sph_cursor_create(h, &cursor);
    if (status != SPH_OK) {
        sph_hierarchy_destroy(h);
        return session_fail(s, status, path);
    }
    if (s->json) {
        hierarchy_json(h, cursor);
    } else if (!s->quiet) {
        const uint32_t n = sph_hierarchy_vertex_count(h), forced = sph_hierarchy_first_forced(h);
        printf("hierarchy:  of %s vertices, %s triangles, %s frames\n", count_text(n),
               count_text(sph_cursor_triangle_count(cursor)), count_text(sph_hierarchy_frame_count(h)));
        printf("size:       bounding-box diagonal %.6g, mean over frames; file %s\n",
               sph_hierarchy_bounding_diagonal(h), size_text(file_size(path)));
        printf("levels:     from %s spheres to %s (one per component)", count_text(n), count_text(coarsest_count(h)));
        if (forced < sph_hierarchy_collapse_count(h))
            printf("; below %s triangles had to turn over", count_text(n - forced));
        puts("\n   spheres     edges  triangles  error, % of the diagonal");
        print_levels(h, cursor, NULL);
    }
    sph_cursor_destroy(cursor);
    sph_hierarchy_destroy(h);
    return DONE;
}

static void radius_range(const sph_level_arrays *a, double range[2])
{
    const size_t count = a->radii_per_frame ? (size_t)a->frame_count * a->sphere_count : a->sphere_count;
    range[0] = range[1] = (double)a->radii[0];
    for (size_t i = 1; i < count; ++i) {
        if ((double)a->radii[i] < range[0]) range[0] = (double)a->radii[i];
        if ((double)a->radii[i] > range[1]) range[1] = (double)a->radii[i];
    }
}

static int info_level(session *s, const char *path)
{
    sph_level_arrays a = {.struct_size = sizeof a};
    sph_level *level = NULL;
    double range[2];
    sph_status status = sph_io_load_level(s->context, path, &level);
    if (status == SPH_OK) status = sph_level_get_arrays(level, &a);
    if (status != SPH_OK) {
        sph_level_destroy(level);
        return session_fail(s, status, path);
    }
    radius_range(&a, range);
    if (s->json) {
        json j;
        json_start(&j, stdout, false);
        json_open(&j, NULL, '{');
        json_text(&j, "kind", "level");
        json_integer(&j, "spheres", a.sphere_count);
        json_integer(&j, "frames", a.frame_count);
        json_integer(&j, "edges", a.edge_count);
        json_integer(&j, "triangles", a.triangle_count);
        json_integer(&j, "labels", a.label_count);
        json_boolean(&j, "radii_per_frame", a.radii_per_frame != 0);
        json_number(&j, "radius_min", range[0]);
        json_number(&j, "radius_max", range[1]);
        json_close(&j, '}');
        json_finish(&j);
    } else if (!s->quiet) {
        printf("level:      %s spheres, %s edges, %s triangles, %s frames\n", count_text(a.sphere_count),
               count_text(a.edge_count), count_text(a.triangle_count), count_text(a.frame_count));
        printf("radii:      from %.4g to %.4g%s\n", range[0], range[1], a.radii_per_frame ? ", one per frame" : "");
        if (a.label_count > 0)
            printf("labels:     of %s vertices of the input\n", count_text(a.label_count));
        else
            puts("labels:     none: it does not say which vertices of its input a sphere stands for");
    }
    sph_level_destroy(level);
    return DONE;
}

/* A point cache without its mesh. */
static int info_cache(const session *s, const char *path, const sph_io_description *d)
{
    if (s->json) {
        json j;
        json_start(&j, stdout, false);
        json_open(&j, NULL, '{');
        json_text(&j, "kind", "cache");
        json_text(&j, "format", d->format);
        json_integer(&j, "points", d->point_count);
        json_integer(&j, "frames", d->frame_count);
        json_close(&j, '}');
        json_finish(&j);
    } else if (!s->quiet) {
        printf("cache:      %s, %s frames of %s points; its mesh is another file: sphmesh info MESH --cache %s\n",
               d->format, count_text(d->frame_count), count_text(d->point_count), path);
    }
    return DONE;
}

static int info(session *s, const void *options, const arguments *paths)
{
    const input_options *input = options;
    sph_io_description d = {.struct_size = sizeof d};
    const char *path = paths->items[0];
    int32_t kind = 0;
    sph_status status;
    if (paths->count == 1 && name_ends(path, ".json")) return info_level(s, path);
    if (paths->count == 1 && input->cache == NULL && sph_io_describe(s->context, path, &d) == SPH_OK &&
        d.point_count > 0)
        return info_cache(s, path, &d);
    if (paths->count > 1 || !name_ends(path, ".sphm")) return info_animation(s, input, paths);
    status = sph_io_identify(s->context, path, &kind);
    if (status != SPH_OK) return session_fail(s, status, path);
    return kind == SPH_IO_HIERARCHY ? info_hierarchy(s, path) : info_level(s, path);
}

static int run(int argc, char **argv)
{
    common_options common = {0};
    input_options input = INPUT_DEFAULTS;
    arguments paths;
    const option table[] = {INPUT_OPTIONS(input), COMMON_OPTIONS(common)};
    int parsed = options_parse("info", table, argc, argv, &paths);
    if (parsed == DONE && !common.help) parsed = input_check("info", &input, &paths);
    return session_run(parsed, &info_command, &common, info, &input, &paths);
}

const subcommand info_command = {"info", "tell what a file is and what deserves attention", HELP, run};
