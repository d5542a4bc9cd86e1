/* SPDX-License-Identifier: MIT */
/* sphmesh surface: the outer surface of a level as a mesh. */
#include <stdio.h>
#include <stdlib.h>

#include "program.h"
#include "report.h"
#include "session.h"

static const char HELP[] = "Makes a closed triangle mesh of the outer surface of a level in one frame.\n"
                           "\n"
                           "usage: sphmesh surface LEVEL -o OUT [OPTION]...\n"
                           "\n"
                           "LEVEL is a level, .json or .sphm.\n"
                           "\n"
                           "  -o, --output OUT            .obj or .ply, both with normals\n"
                           "      --frame F               the frame; 0 is the first (0)\n"
                           "      --resolution N          cells along the longest side of the bounding box,\n"
                           "                              that of the largest frame (128)\n"
                           "      --memory MB             the most memory to take, in megabytes (1024)\n"
                           "      --json                  figures as JSON on stdout\n"
                           "      --progress HOW          auto, bar, plain, json or none, on stderr (auto)\n"
                           "      --threads N             threads; 0: one per processor (0)\n"
                           "  -q, --quiet; -h, --help\n"
                           "\n"
                           "Every edge has two triangles, which face outward. Cavities are left out.\n"
                           "Radii below 0.56 cells count as that, so that thin sheets have two sides.\n"
                           "\n"
                           "example:\n"
                           "  sphmesh surface horse-40.json --frame 12 --resolution 200 -o horse-40-12.ply\n";

typedef struct surface_options {
    common_options common;
    const char *output;
    uint32_t frame, resolution, memory;
} surface_options;

static int parse(surface_options *o, int argc, char **argv, arguments *paths)
{
    sph_surface_options defaults;
    const option table[] = {{"output", 'o', OPTION_TEXT, &o->output, 0, 0, NULL},
                            {"frame", 0, OPTION_COUNT, &o->frame, 0, UINT32_MAX, NULL},
                            {"resolution", 0, OPTION_COUNT, &o->resolution, 1, 4096, NULL},
                            {"memory", 0, OPTION_COUNT, &o->memory, 1, UINT32_MAX, NULL},
                            COMMON_OPTIONS(o->common)};
    int result;
    sph_surface_options_init(&defaults, sizeof defaults);
    *o = (surface_options){.resolution = defaults.resolution, .memory = (uint32_t)(defaults.memory_limit >> 20)};
    result = options_parse("surface", table, argc, argv, paths);
    if (result != DONE || o->common.help) return result;
    if (paths->count != 1) return usage_error("surface", "one level is needed, not %zu", paths->count);
    if (o->output == NULL) return usage_error("surface", "-o is missing: where should the surface go?");
    if (!name_ends(o->output, ".obj") && !name_ends(o->output, ".ply"))
        return usage_error("surface", "-o: '%s' does not end in .obj or .ply", o->output);
    if (!name_ends(paths->items[0], ".json") && !name_ends(paths->items[0], ".sphm"))
        return usage_error("surface", "'%s' does not end in .json or .sphm", paths->items[0]);
    return DONE;
}

static void print_json(const surface_options *o, const sph_surface *surface)
{
    json j;
    json_start(&j, stdout, false);
    json_open(&j, NULL, '{');
    json_text(&j, "output", o->output);
    json_integer(&j, "frame", o->frame);
    json_integer(&j, "resolution", o->resolution);
    json_number(&j, "cell", sph_surface_cell(surface));
    json_integer(&j, "vertices", sph_surface_vertex_count(surface, 0));
    json_integer(&j, "triangles", sph_surface_triangle_count(surface, 0));
    json_integer(&j, "peak_rss_bytes", peak_memory());
    json_close(&j, '}');
    json_finish(&j);
}

static sph_status extract(session *s, const surface_options *o, const sph_level *level, sph_surface **out)
{
    sph_surface_options options;
    sph_status status;
    sph_surface_options_init(&options, sizeof options);
    options.resolution = o->resolution;
    options.first_frame = o->frame;
    options.frame_limit = 1;
    options.memory_limit = (uint64_t)o->memory << 20;
    progress_start(&s->progress, "extracting");
    status = sph_surface_create(level, &options, out);
    progress_end(&s->progress);
    return status;
}

static int surface(session *s, const surface_options *o, const char *path)
{
    sph_level *level = NULL;
    sph_surface *mesh = NULL;
    const char *subject = path;
    sph_status status;
    int result = load_level(s, path, &level);
    if (result != DONE) return result;
    status = extract(s, o, level, &mesh);
    if (status == SPH_OK && interrupted()) status = SPH_E_CANCELLED;
    if (status == SPH_OK) {
        subject = o->output;
        status = sph_io_save_surface(s->context, mesh, 0, o->output);
    }
    if (status != SPH_OK) {
        result = session_fail(s, status, subject);
    } else if (s->json) {
        print_json(o, mesh);
    } else if (!s->quiet) {
        printf("surface:    %s vertices, %s triangles; cells of %.3g\n", count_text(sph_surface_vertex_count(mesh, 0)),
               count_text(sph_surface_triangle_count(mesh, 0)), sph_surface_cell(mesh));
        printf("wrote:      %s (%s)\n", o->output, size_text(file_size(o->output)));
    }
    sph_surface_destroy(mesh);
    sph_level_destroy(level);
    return result;
}

static int run(int argc, char **argv)
{
    surface_options o;
    arguments paths;
    session s;
    int result = parse(&o, argc, argv, &paths);
    if (result == DONE && o.common.help) {
        fputs(HELP, stdout);
    } else if (result == DONE && (result = session_open(&s, &o.common)) == DONE) {
        result = surface(&s, &o, paths.items[0]);
        session_close(&s);
    }
    free(paths.items);
    return result;
}

const subcommand surface_command = {"surface", "make a mesh of a level's outer surface", HELP, run};
