/* SPDX-License-Identifier: MIT */
/* sphmesh level: one level of detail out of a hierarchy. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "program.h"
#include "report.h"
#include "session.h"

static const char HELP[] = "Takes one level of detail out of a hierarchy: K animated spheres, and the edges\n"
                           "and triangles between them.\n"
                           "\n"
                           "usage: sphmesh level F.sphm (--spheres K | --max-error PCT) -o OUT [OPTION]...\n"
                           "\n"
                           "  -o, --output OUT            .json (for scripts), .obj or .ply (frame 0),\n"
                           "                              .glb (plays in any viewer) or .sphm (compact)\n"
                           "      --spheres K             the level with K spheres\n"
                           "      --max-error PCT         the fewest spheres whose error is at most PCT % of\n"
                           "                              the bounding-box diagonal\n"
                           "      --optimize-connectivity choose edges and triangles anew, by which spheres\n"
                           "                              the surface is nearest to\n"
                           "      --json                  figures as JSON on stdout\n"
                           "      --progress HOW          auto, bar, plain, json or none, on stderr (auto)\n"
                           "      --threads N             threads; 0: one per processor (0)\n"
                           "  -q, --quiet; -h, --help\n"
                           "\n"
                           "The error is the root mean square distance between the spheres and the planes\n"
                           "that they stand for: a quick guide that 'sphmesh info F.sphm' lists, not the\n"
                           "measured distance of 'sphmesh measure'.\n"
                           "\n"
                           "examples:\n"
                           "  sphmesh level horse.sphm --spheres 40 -o horse-40.json\n"
                           "  sphmesh level horse.sphm --max-error 0.5 --optimize-connectivity -o horse.obj\n";

typedef struct level_options {
    common_options common;
    const char *output;
    uint32_t spheres;
    double max_error;
    bool optimize;
} level_options;

static int parse(level_options *l, int argc, char **argv, arguments *paths)
{
    const option table[] = {{"output", 'o', OPTION_TEXT, &l->output, 0, 0, NULL},
                            {"spheres", 0, OPTION_COUNT, &l->spheres, 1, UINT32_MAX, NULL},
                            {"max-error", 0, OPTION_NUMBER, &l->max_error, 0, 1e30, NULL},
                            {"optimize-connectivity", 0, OPTION_FLAG, &l->optimize, 0, 0, NULL},
                            COMMON_OPTIONS(l->common)};
    int result;
    *l = (level_options){.max_error = -1};
    result = options_parse("level", table, argc, argv, paths);
    if (result != DONE || l->common.help) return result;
    if (paths->count != 1) return usage_error("level", "one hierarchy (.sphm) is needed, not %zu", paths->count);
    if ((l->spheres > 0) == (l->max_error >= 0))
        return usage_error("level", "one of --spheres and --max-error is needed, and not both");
    return output_check_level("level", l->output);
}

/* The vertices of the hierarchy's input, frame by frame. */
typedef struct leaf_frames {
    float *xyz;
    uint32_t vertex_count;
} leaf_frames;

static sph_status read_leaf_frame(void *user, uint32_t frame, float *xyz)
{
    const leaf_frames *l = user;
    const size_t size = (size_t)3 * l->vertex_count;
    memcpy(xyz, l->xyz + size * frame, size * sizeof *xyz);
    return SPH_OK;
}

/* The spheres of the finest level are the input's vertices, so that the hierarchy alone tells of its input. */
static bool read_leaves(const sph_hierarchy *h, leaf_frames *l)
{
    const uint32_t n = sph_hierarchy_vertex_count(h), frames = sph_hierarchy_frame_count(h);
    float *centers = malloc((size_t)3 * frames * sizeof *centers);
    l->vertex_count = n;
    l->xyz = (uint64_t)n * frames > SIZE_MAX / 12 ? NULL : malloc((size_t)3 * n * frames * sizeof *l->xyz);
    for (uint32_t i = 0; i < n && centers != NULL && l->xyz != NULL; ++i) {
        sph_hierarchy_sphere(h, i, centers, NULL);
        for (uint32_t f = 0; f < frames; ++f)
            memcpy(l->xyz + 3 * ((size_t)f * n + i), centers + (size_t)3 * f, 3 * sizeof *centers);
    }
    if (centers == NULL) {
        free(l->xyz);
        l->xyz = NULL;
    }
    free(centers);
    return l->xyz != NULL;
}

/* Gives the animation the triangles and edges of the finest level. */
static sph_status copy_simplices(const sph_hierarchy *h, sph_animation *animation)
{
    sph_cursor *cursor = NULL;
    uint32_t *edges = NULL, *triangles = NULL;
    sph_status status = sph_cursor_create(h, &cursor);
    if (status != SPH_OK) return status;
    edges = malloc((sph_cursor_edge_count(cursor) + 1) * 2 * sizeof *edges);
    triangles = malloc((sph_cursor_triangle_count(cursor) + 1) * 3 * sizeof *triangles);
    status = edges == NULL || triangles == NULL ? SPH_E_NOMEM : sph_cursor_read(cursor, NULL, edges, triangles);
    if (status == SPH_OK)
        status = sph_animation_set_triangles(animation, triangles, sph_cursor_triangle_count(cursor), 0);
    if (status == SPH_OK) status = sph_animation_set_edges(animation, edges, sph_cursor_edge_count(cursor), 0);
    free(edges);
    free(triangles);
    sph_cursor_destroy(cursor);
    return status;
}

static sph_status optimize(session *s, const sph_hierarchy *h, sph_level *level)
{
    sph_animation *animation = NULL;
    leaf_frames leaves = {0};
    const sph_frame_source source = {.user = &leaves, .read_frame = read_leaf_frame};
    sph_status status;
    if (!read_leaves(h, &leaves)) return sph_context_fail(s->context, SPH_E_NOMEM, "out of memory");
    status = sph_animation_create_from_source(s->context, leaves.vertex_count, sph_hierarchy_frame_count(h), &source,
                                              &animation);
    if (status == SPH_OK) status = copy_simplices(h, animation);
    if (status == SPH_OK) {
        progress_start(&s->progress, "optimising");
        status = sph_level_optimize_connectivity(level, animation);
        progress_end(&s->progress);
    }
    sph_animation_destroy(animation);
    free(leaves.xyz);
    return status;
}

/* How many spheres: DONE with *count, or what went wrong, said. */
static int choose_count(session *s, const level_options *l, const char *path, const sph_hierarchy *h, uint32_t *count)
{
    const uint32_t least = coarsest_count(h), most = sph_hierarchy_vertex_count(h);
    sph_status status;
    *count = l->spheres;
    if (l->max_error >= 0) {
        status = sph_hierarchy_count_for_error(h, l->max_error / 100 * sph_hierarchy_bounding_diagonal(h), count);
        return status == SPH_OK ? DONE : session_fail(s, status, path);
    }
    if (*count < least || *count > most)
        return usage_error("level", "--spheres: %u is not from %u to %u, which is what %s has", *count, least, most,
                           path);
    return DONE;
}

static void print_json(const level_options *l, const sph_level_arrays *a, double error, double diagonal)
{
    json j;
    json_start(&j, stdout, false);
    json_open(&j, NULL, '{');
    json_text(&j, "output", l->output);
    json_integer(&j, "spheres", a->sphere_count);
    json_integer(&j, "frames", a->frame_count);
    json_integer(&j, "edges", a->edge_count);
    json_integer(&j, "triangles", a->triangle_count);
    json_number(&j, "error", error);
    json_number(&j, "error_percent", diagonal > 0 ? 100 * error / diagonal : 0);
    json_number(&j, "bounding_diagonal", diagonal);
    json_integer(&j, "peak_rss_bytes", peak_memory());
    json_close(&j, '}');
    json_finish(&j);
}

static int write_level(session *s, const level_options *l, const sph_hierarchy *h, uint32_t count)
{
    sph_level_arrays a = {.struct_size = sizeof a};
    sph_level *level = NULL;
    const double error = level_error(h, count), diagonal = sph_hierarchy_bounding_diagonal(h);
    sph_status status = sph_level_create(h, count, &level);
    int result = DONE;
    if (status == SPH_OK && l->optimize) status = optimize(s, h, level);
    if (status == SPH_OK) status = sph_level_get_arrays(level, &a);
    if (status == SPH_OK && interrupted()) status = SPH_E_CANCELLED;
    if (status == SPH_OK) status = sph_io_save_level(s->context, level, l->output);
    if (status != SPH_OK) {
        result = session_fail(s, status, l->output);
    } else if (s->json) {
        print_json(l, &a, error, diagonal);
    } else if (!s->quiet) {
        printf("level:      %s spheres, %s edges, %s triangles; error %.3g %% of the bounding-box diagonal\n",
               count_text(a.sphere_count), count_text(a.edge_count), count_text(a.triangle_count),
               diagonal > 0 ? 100 * error / diagonal : 0);
        printf("wrote:      %s (%s)\n", l->output, size_text(file_size(l->output)));
    }
    sph_level_destroy(level);
    return result;
}

static int level(session *s, const void *options, const arguments *paths)
{
    const level_options *l = options;
    const char *path = paths->items[0];
    sph_hierarchy *hierarchy = NULL;
    uint32_t count;
    int result;
    int32_t kind = SPH_IO_HIERARCHY;
    sph_status status = sph_io_identify(s->context, path, &kind);
    if (status == SPH_OK && kind == SPH_IO_LEVEL)
        return failure("%s: holds one level, not a hierarchy to take levels from", path);
    if (status == SPH_OK) status = sph_io_load_hierarchy(s->context, path, &hierarchy);
    if (status != SPH_OK) return session_fail(s, status, path);
    result = choose_count(s, l, path, hierarchy, &count);
    if (result == DONE) result = write_level(s, l, hierarchy, count);
    sph_hierarchy_destroy(hierarchy);
    return result;
}

static int run(int argc, char **argv)
{
    level_options l;
    arguments paths;
    return session_run(parse(&l, argc, argv, &paths), &level_command, &l.common, level, &l, &paths);
}

const subcommand level_command = {"level", "take one level of detail out of a hierarchy", HELP, run};
