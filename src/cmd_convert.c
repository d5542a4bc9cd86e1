/* SPDX-License-Identifier: MIT */
/* sphmesh convert: any animation that is read, as a mesh with a point cache. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "program.h"
#include "report.h"
#include "session.h"

static const char HELP[] = "Writes an animated mesh as OBJ with a point cache, whatever it comes from.\n"
                           "\n"
                           "usage: sphmesh convert INPUT... -o OUT [OPTION]...\n"
                           "\n"
                           "INPUT is the animation, named as for 'sphmesh build'.\n"
                           "\n"
                           "  -o, --output OUT            OUT.obj: the mesh, and its frames as OUT.pc2;\n"
                           "                              OUT.pc2, OUT.mdd: the frames, and OUT.obj\n"
                           "      --cache C               the frames of the mesh: a PC2 or MDD point cache\n"
                           "      --frames A:B:STEP       frames A, A+STEP, ... below B only (from 0)\n"
                           "      --up y|z, --scale S     as for 'sphmesh build'\n"
                           "      --clip NAME             one animation of a glTF; else all in a row\n"
                           "      --object NAME, --space local|world\n"
                           "                              of an Alembic, as for 'sphmesh build'\n"
                           "      --fps N                 frames per second: a glTF is baked at it (30), an\n"
                           "                              Alembic taken (its samples), and OUT.mdd has its\n"
                           "                              times by it (30)\n"
                           "      --weld                  unite vertices that coincide in all frames (seams)\n"
                           "      --json                  figures as JSON on stdout\n"
                           "      --progress HOW          auto, bar, plain, json or none, on stderr (auto)\n"
                           "      --threads N             threads; 0: one per processor (0)\n"
                           "  -q, --quiet; -h, --help\n"
                           "\n"
                           "examples:\n"
                           "  sphmesh convert 'scan/s*.ply' -o scan.obj\n"
                           "  sphmesh convert walk.abc --object body -o body.obj\n"
                           "  sphmesh convert wolf_%d.stl --up z --scale 0.01 -o wolf.mdd\n";

typedef struct convert_options {
    common_options common;
    input_options input;
    const char *output;
    bool weld;
    bool mdd;
    char *mesh, *cache; /* what is written; free() */
} convert_options;

static int name_outputs(convert_options *c)
{
    const bool is_mesh = name_ends(c->output, ".obj");
    c->mdd = name_ends(c->output, ".mdd");
    if (!is_mesh && !c->mdd && !name_ends(c->output, ".pc2"))
        return usage_error("convert", "-o: '%s' does not end in .obj, .pc2 or .mdd", c->output);
    c->mesh = name_with_ending(c->output, is_mesh ? c->output + strlen(c->output) - 4 : ".obj");
    c->cache = name_with_ending(c->output, is_mesh ? ".pc2" : c->output + strlen(c->output) - 4);
    return c->mesh == NULL || c->cache == NULL ? failure("out of memory") : DONE;
}

static int parse(convert_options *c, int argc, char **argv, arguments *paths)
{
    const option table[] = {{"output", 'o', OPTION_TEXT, &c->output, 0, 0, NULL},
                            INPUT_OPTIONS(c->input),
                            {"weld", 0, OPTION_FLAG, &c->weld, 0, 0, NULL},
                            COMMON_OPTIONS(c->common)};
    int result;
    *c = (convert_options){.input = INPUT_DEFAULTS};
    result = options_parse("convert", table, argc, argv, paths);
    if (result != DONE || c->common.help) return result;
    result = input_check("convert", &c->input, paths);
    if (result != DONE) return result;
    if (c->output == NULL) return usage_error("convert", "-o is missing: where should the mesh go?");
    return name_outputs(c);
}

static sph_status open_input(session *s, const convert_options *c, const arguments *paths, sph_animation **out)
{
    sph_animation *welded = NULL;
    sph_status status;
    progress_start(&s->progress, "reading");
    status = input_open(s, &c->input, paths, &c->input.frames, out);
    if (status == SPH_OK && c->weld) {
        status = sph_animation_weld(*out, 0, NULL, &welded);
        if (status == SPH_OK) {
            sph_animation_destroy(*out);
            *out = welded;
        }
    }
    progress_end(&s->progress);
    return status;
}

static void print_json(const convert_options *c, const sph_animation *animation)
{
    json j;
    json_start(&j, stdout, false);
    json_open(&j, NULL, '{');
    json_text(&j, "mesh", c->mesh);
    json_text(&j, "cache", c->cache);
    json_integer(&j, "vertices", sph_animation_vertex_count(animation));
    json_integer(&j, "triangles", sph_animation_triangle_count(animation));
    json_integer(&j, "edges", sph_animation_edge_count(animation));
    json_integer(&j, "frames", sph_animation_frame_count(animation));
    json_integer(&j, "bytes", file_size(c->mesh) + file_size(c->cache));
    json_integer(&j, "peak_rss_bytes", peak_memory());
    json_close(&j, '}');
    json_finish(&j);
}

static int convert(session *s, const void *options, const arguments *paths)
{
    const convert_options *c = options;
    sph_animation *animation = NULL;
    int result = DONE;
    sph_status status = open_input(s, c, paths, &animation);
    if (status == SPH_OK && interrupted()) status = SPH_E_CANCELLED;
    if (status == SPH_OK) {
        progress_start(&s->progress, "writing");
        status = c->mdd ? sph_io_save_obj_mdd(s->context, animation, 0, c->input.fps > 0 ? c->input.fps : 30, c->mesh, c->cache)
                        : sph_io_save_obj_pc2(s->context, animation, 0, 1, c->mesh, c->cache);
        progress_end(&s->progress);
    }
    if (status != SPH_OK) {
        result = session_fail(s, status, NULL);
    } else if (s->json) {
        print_json(c, animation);
    } else if (!s->quiet) {
        printf("animation:  %s vertices, %s triangles, %s frames\n", count_text(sph_animation_vertex_count(animation)),
               count_text(sph_animation_triangle_count(animation)), count_text(sph_animation_frame_count(animation)));
        printf("wrote:      %s (%s), %s (%s)\n", c->mesh, size_text(file_size(c->mesh)), c->cache,
               size_text(file_size(c->cache)));
    }
    sph_animation_destroy(animation);
    return result;
}

static int run(int argc, char **argv)
{
    convert_options c;
    arguments paths;
    const int result = session_run(parse(&c, argc, argv, &paths), &convert_command, &c.common, convert, &c, &paths);
    free(c.mesh);
    free(c.cache);
    return result;
}

const subcommand convert_command = {"convert", "write any animation as OBJ with a point cache", HELP, run};
