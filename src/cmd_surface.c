/* SPDX-License-Identifier: MIT */
/* sphmesh surface: the outer surface of a level as a mesh. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "numbered.h"
#include "program.h"
#include "report.h"
#include "session.h"

static const char HELP[] = "Makes closed triangle meshes of the outer surface of a level, frame by frame.\n"
                           "\n"
                           "usage: sphmesh surface LEVEL -o OUT [OPTION]...\n"
                           "\n"
                           "LEVEL is a level, .json or .sphm.\n"
                           "\n"
                           "  -o, --output OUT            .obj, .ply or .glb, all with normals\n"
                           "      --frame F               the frame; 0 is the first (0)\n"
                           "      --frames A:B:STEP       several frames, each to a file of its own that has\n"
                           "                              the frame's number: OUT-0012.ply, or in place of\n"
                           "                              a %d or %04d in OUT; a lone ':' is all frames\n"
                           "      --resolution N          cells along the longest side of the bounding box,\n"
                           "                              that of the largest frame (128)\n"
                           "      --memory MB             the most memory to take, in megabytes (1024)\n"
                           "      --json                  figures as JSON on stdout\n"
                           "      --progress HOW          auto, bar, plain, json or none, on stderr (auto)\n"
                           "      --threads N             threads; 0: one per processor (0)\n"
                           "  -q, --quiet; -h, --help\n"
                           "\n"
                           "Every edge has two triangles, which face outward. Cavities are left out. Each\n"
                           "frame has vertices and triangles of its own, so that several frames are no\n"
                           "animation of one mesh.\n"
                           "Radii below 0.56 cells count as that, so that thin sheets have two sides.\n"
                           "\n"
                           "examples:\n"
                           "  sphmesh surface horse-40.json --frame 12 --resolution 200 -o horse-40-12.ply\n"
                           "  sphmesh surface horse-40.json --frames ::4 -o horse.obj\n";

typedef struct surface_options {
    common_options common;
    frame_range frames;
    const char *output;
    uint32_t frame, resolution, memory;
} surface_options;

static int parse(surface_options *o, int argc, char **argv, arguments *paths)
{
    sph_surface_options defaults;
    const option table[] = {{"output", 'o', OPTION_TEXT, &o->output, 0, 0, NULL},
                            {"frame", 0, OPTION_COUNT, &o->frame, 0, UINT32_MAX, NULL},
                            {"frames", 0, OPTION_FRAMES, &o->frames, 0, 0, NULL},
                            {"resolution", 0, OPTION_COUNT, &o->resolution, 1, 4096, NULL},
                            {"memory", 0, OPTION_COUNT, &o->memory, 1, UINT32_MAX, NULL},
                            COMMON_OPTIONS(o->common)};
    int result;
    sph_surface_options_init(&defaults, sizeof defaults);
    *o = (surface_options){.frames = {.step = 1},
                           .frame = UINT32_MAX,
                           .resolution = defaults.resolution,
                           .memory = (uint32_t)(defaults.memory_limit >> 20)};
    result = options_parse("surface", table, argc, argv, paths);
    if (result != DONE || o->common.help) return result;
    if (paths->count != 1) return usage_error("surface", "one level is needed, not %zu", paths->count);
    if (o->frames.given && o->frame != UINT32_MAX)
        return usage_error("surface", "--frame and --frames: one of them");
    if (o->frame == UINT32_MAX) o->frame = 0;
    if (o->output == NULL) return usage_error("surface", "-o is missing: where should the surface go?");
    if (!name_ends(o->output, ".obj") && !name_ends(o->output, ".ply") &&
        !name_ends(o->output, ".glb"))
        return usage_error("surface", "-o: '%s' does not end in .obj, .ply or .glb", o->output);
    if (!name_ends(paths->items[0], ".json") && !name_ends(paths->items[0], ".sphm"))
        return usage_error("surface", "'%s' does not end in .json or .sphm", paths->items[0]);
    return DONE;
}

/* What has been made. */
typedef struct made {
    uint32_t files, frame; /* the first frame */
    uint64_t vertices, triangles, bytes;
    double cell;
    char *name; /* of the last file; freed by the one who has it */
} made;

static void print_json(const surface_options *o, const made *m)
{
    json j;
    json_start(&j, stdout, false);
    json_open(&j, NULL, '{');
    json_text(&j, "output", o->frames.given ? o->output : m->name);
    json_integer(&j, "frame", m->frame);
    json_integer(&j, "files", m->files);
    json_integer(&j, "resolution", o->resolution);
    json_number(&j, "cell", m->cell);
    json_integer(&j, "vertices", m->vertices);
    json_integer(&j, "triangles", m->triangles);
    json_integer(&j, "peak_rss_bytes", peak_memory());
    json_close(&j, '}');
    json_finish(&j);
}

static void print_summary(const surface_options *o, const made *m)
{
    printf("surface:    %s vertices, %s triangles%s; cells of %.3g\n", count_text(m->vertices), count_text(m->triangles),
           o->frames.given ? " in all" : "", m->cell);
    if (m->files == 1)
        printf("wrote:      %s (%s)\n", m->name, size_text(m->bytes));
    else
        printf("wrote:      %u files, the last %s (%s in all)\n", m->files, m->name, size_text(m->bytes));
}

static sph_status extract(const surface_options *o, const sph_level *level, uint32_t frame, sph_surface **out)
{
    sph_surface_options options;
    sph_surface_options_init(&options, sizeof options);
    options.resolution = o->resolution;
    options.first_frame = frame;
    options.frame_limit = 1;
    options.memory_limit = (uint64_t)o->memory << 20;
    return sph_surface_create(level, &options, out);
}

/* One frame; *subject is the file that a failure is about. */
static sph_status make_frame(session *s, const surface_options *o, const sph_level *level, uint32_t frame, char *name,
                             made *m, const char **subject)
{
    sph_surface *mesh = NULL;
    sph_status status = extract(o, level, frame, &mesh);
    if (status == SPH_OK && interrupted()) status = SPH_E_CANCELLED;
    if (status == SPH_OK) {
        *subject = name;
        status = sph_io_save_surface(s->context, mesh, 0, name);
    }
    if (status == SPH_OK) {
        ++m->files;
        m->vertices += sph_surface_vertex_count(mesh, 0);
        m->triangles += sph_surface_triangle_count(mesh, 0);
        m->bytes += file_size(name);
        m->cell = sph_surface_cell(mesh);
    }
    sph_surface_destroy(mesh);
    return status;
}

/* Frame by frame, so that no more than one is in memory. */
static int make_frames(session *s, const surface_options *o, const sph_level *level, const char *path, made *m)
{
    const uint32_t frames = sph_level_frame_count(level), step = o->frames.step;
    const uint32_t count = o->frames.given ? range_count(&o->frames, frames) : 1;
    const uint32_t first = o->frames.given ? o->frames.first : o->frame;
    const char *subject = path;
    sph_status status = SPH_OK;
    if (count == 0) return usage_error("surface", "--frames: the level has %u frames, none from %u on", frames, first);
    m->frame = first;
    progress_start(&s->progress, "extracting");
    for (uint32_t i = 0; i < count && status == SPH_OK; ++i) {
        const uint32_t frame = first + i * step;
        subject = path; /* no more the file of the frame before */
        free(m->name);
        m->name = o->frames.given ? numbered_name(o->output, frame, first + (count - 1) * step) : strdup(o->output);
        if (m->name == NULL)
            status = sph_context_fail(s->context, SPH_E_NOMEM, "out of memory");
        else
            status = make_frame(s, o, level, frame, m->name, m, &subject);
    }
    progress_end(&s->progress);
    return status == SPH_OK ? DONE : session_fail(s, status, subject);
}

static int surface(session *s, const void *options, const arguments *paths)
{
    const surface_options *o = options;
    const char *path = paths->items[0];
    made m = {0};
    sph_level *level = NULL;
    int result = load_level(s, path, &level);
    if (result != DONE) return result;
    result = make_frames(s, o, level, path, &m);
    if (result == DONE && s->json)
        print_json(o, &m);
    else if (result == DONE && !s->quiet)
        print_summary(o, &m);
    free(m.name);
    sph_level_destroy(level);
    return result;
}

static int run(int argc, char **argv)
{
    surface_options o;
    arguments paths;
    return session_run(parse(&o, argc, argv, &paths), &surface_command, &o.common, surface, &o, &paths);
}

const subcommand surface_command = {"surface", "make meshes of a level's outer surface", HELP, run};
