/* SPDX-License-Identifier: MIT */
/* sphmesh skin: an animation as a skinned mesh that engines open; the bones are the spheres of a level. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clips.h"
#include "program.h"
#include "report.h"
#include "rigging.h"

static const char HELP[] = "Rigs an animated mesh: a skinned, animated glTF whose bones are the spheres of\n"
                           "a level.\n"
                           "\n"
                           "usage: sphmesh skin INPUT... (--level L | --spheres K) -o RIG [OPTION]...\n"
                           "\n"
                           "INPUT is the animation, named as for 'sphmesh build' (--cache C, --frames\n"
                           "A:B:STEP, --clip NAME, --fps N, --up y|z, --scale S and so on as there).\n"
                           "\n"
                           "  -o, --output RIG            .glb, or .gltf with a .bin\n"
                           "  -l, --level L               a level of INPUT, or a hierarchy with --spheres\n"
                           "      --spheres K             K bones; without --level a hierarchy is built\n"
                           "      --influences N          most bones per vertex (4)\n"
                           "      --mode M                mixed: smooth weights, learned from the animation\n"
                           "                              where it tells; animation: of least error;\n"
                           "                              geometric: by the rest pose alone (mixed)\n"
                           "      --rounds N              most rounds (60 for animation, else 30)\n"
                           "      --tolerance X           stop when a round gains less than this (0.001)\n"
                           "      --max-error PCT         stop at an RMSE of PCT % of the diagonal\n"
                           "      --neighbourhood N       how many cells off a vertex's bones may be (1)\n"
                           "      --uniform               all vertices count alike, not by area\n"
                           "      --clips NAME=A:B,...    frames as clips (those of a glTF; else one of all)\n"
                           "      --weights W             float, u8 or u16 (float)\n"
                           "      --root R                center, heaviest, or the number of a bone (center)\n"
                           "      --flat                  bones as a list, not as a tree\n"
                           "      --single-root           one joint above all that does not move\n"
                           "      --json, --progress HOW, --threads N, -q, --quiet; -h, --help\n"
                           "\n"
                           "example:\n"
                           "  sphmesh skin horse.obj --cache horse.pc2 --spheres 22 -o horse.glb\n";

static const char *const mode_choices[] = {"mixed", "animation", "geometric", NULL};
static const char *const weight_choices[] = {"float", "u8", "u16", NULL};

typedef struct skin_options {
    common_options common;
    input_options input;
    rigging_options rig;
    const char *output, *clips, *root;
    int mode, weights;
    bool flat, single_root, uniform;
} skin_options;

static int read_root(skin_options *o)
{
    const char *text = o->root;
    char *end;
    unsigned long bone;
    if (text == NULL || strcmp(text, "center") == 0) return DONE;
    o->rig.joints.root = SPH_ROOT_HEAVIEST;
    if (strcmp(text, "heaviest") == 0) return DONE;
    bone = strtoul(text, &end, 10);
    if (text[0] < '0' || text[0] > '9' || *end != '\0' || bone >= UINT32_MAX)
        return usage_error("skin", "--root: '%s' is not center, heaviest or the number of a bone", text);
    o->rig.joints.root = SPH_ROOT_GIVEN;
    o->rig.joints.root_bone = (uint32_t)bone;
    return DONE;
}

static int check(skin_options *o, const arguments *paths)
{
    const char *level = o->rig.level;
    int result = input_check("skin", &o->input, paths);
    if (result != DONE) return result;
    if (o->output == NULL) return usage_error("skin", "-o is missing: where should the rig go?");
    if (!name_ends(o->output, ".glb") && !name_ends(o->output, ".gltf"))
        return usage_error("skin", "-o: '%s' does not end in .glb or .gltf", o->output);
    if (level == NULL && o->rig.spheres == 0)
        return usage_error("skin", "one of --level and --spheres is needed: what are the bones?");
    if (level != NULL && !name_ends(level, ".json") && !name_ends(level, ".sphm"))
        return usage_error("skin", "--level: '%s' does not end in .json or .sphm", level);
    o->rig.skin.mode = o->mode;
    o->rig.skin.flags = o->uniform ? SPH_SKIN_UNIFORM : 0;
    o->rig.joints.layout = o->flat ? SPH_SKELETON_FLAT : SPH_SKELETON_TREE;
    o->rig.joints.single_root = o->single_root;
    o->rig.file.weights = o->weights;
    return read_root(o);
}

static int parse(skin_options *o, int argc, char **argv, arguments *paths)
{
    rigging_options *r = &o->rig;
    const option table[] = {{"output", 'o', OPTION_TEXT, &o->output, 0, 0, NULL},
                            {"level", 'l', OPTION_TEXT, &r->level, 0, 0, NULL},
                            {"spheres", 0, OPTION_COUNT, &r->spheres, 1, UINT32_MAX, NULL},
                            {"influences", 0, OPTION_COUNT, &r->skin.influence_limit, 1, 256, NULL},
                            {"mode", 0, OPTION_CHOICE, &o->mode, 0, 0, mode_choices},
                            {"rounds", 0, OPTION_COUNT, &r->skin.round_limit, 0, 100000, NULL},
                            {"tolerance", 0, OPTION_NUMBER, &r->skin.tolerance, 0, 1, NULL},
                            {"max-error", 0, OPTION_NUMBER, &r->skin.error_limit, 0, 1e30, NULL},
                            {"neighbourhood", 0, OPTION_COUNT, &r->skin.rings, 0, 1000, NULL},
                            {"clips", 0, OPTION_TEXT, &o->clips, 0, 0, NULL},
                            {"weights", 0, OPTION_CHOICE, &o->weights, 0, 0, weight_choices},
                            {"root", 0, OPTION_TEXT, &o->root, 0, 0, NULL},
                            {"uniform", 0, OPTION_FLAG, &o->uniform, 0, 0, NULL},
                            {"flat", 0, OPTION_FLAG, &o->flat, 0, 0, NULL},
                            {"single-root", 0, OPTION_FLAG, &o->single_root, 0, 0, NULL},
                            INPUT_OPTIONS(o->input),
                            COMMON_OPTIONS(o->common)};
    int result;
    *o = (skin_options){.input = INPUT_DEFAULTS};
    sph_skin_options_init(&r->skin, sizeof r->skin);
    sph_skeleton_options_init(&r->joints, sizeof r->joints);
    sph_io_rig_options_init(&r->file, sizeof r->file);
    result = options_parse("skin", table, argc, argv, paths);
    return result != DONE || o->common.help ? result : check(o, paths);
}

static const char *clip_name(const sph_skin_clip *clip)
{
    return clip->name[0] == '\0' ? "all" : clip->name;
}

static void print_text(const skin_options *o, const rigging *r)
{
    const sph_skin_arrays *a = &r->arrays;
    printf("rig:        %s bones, %s influences per vertex at most (%s), %s vertices\n", count_text(a->bone_count),
           count_text(r->influences), mode_choices[o->mode], count_text(a->vertex_count));
    printf("            %-24s  %7s  %10s  %10s   %% of the diagonal\n", "clip", "frames", "RMSE", "max");
    for (uint32_t c = 0; c < a->clip_count; ++c) {
        const sph_skin_error error = rigging_clip_error(r, c);
        printf("            %-24s  %7s  %10.4f  %10.4f\n", clip_name(&a->clips[c]), count_text(a->clips[c].frame_count),
               error.rmse_percent, error.max_percent);
    }
    if (a->clip_count > 1)
        printf("            %-24s  %7s  %10.4f  %10.4f\n", "together", count_text(a->frame_count),
               r->error.rmse_percent, r->error.max_percent);
    printf("time:       ");
    if (r->hierarchy_s >= 0) printf("%.2f s for the hierarchy, ", r->hierarchy_s);
    printf("%.2f s for the rig\n", r->skin_s);
    printf("wrote:      %s (%s)\n", o->output, size_text(rigging_bytes(o->output)));
}

static void print_error(json *j, const sph_skin_error *error)
{
    json_number(j, "mse", error->mse);
    json_number(j, "rmse", error->rmse);
    json_number(j, "max", error->max);
    json_number(j, "rmse_percent", error->rmse_percent);
    json_number(j, "max_percent", error->max_percent);
    json_integer(j, "max_vertex", error->max_vertex);
    json_integer(j, "max_frame", error->max_frame);
}

static void print_json(const skin_options *o, const rigging *r)
{
    const sph_skin_arrays *a = &r->arrays;
    json j;
    json_start(&j, stdout, false);
    json_open(&j, NULL, '{');
    json_text(&j, "output", o->output);
    json_integer(&j, "vertices", a->vertex_count);
    json_integer(&j, "triangles", a->triangle_count);
    json_integer(&j, "frames", a->frame_count);
    json_integer(&j, "bones", a->bone_count);
    json_integer(&j, "joints", r->joint_count);
    json_integer(&j, "influences", r->influences);
    json_text(&j, "mode", mode_choices[o->mode]);
    print_error(&j, &r->error);
    json_number(&j, "bounding_diagonal", r->error.diagonal);
    json_open(&j, "clips", '[');
    for (uint32_t c = 0; c < a->clip_count; ++c) {
        const sph_skin_error error = rigging_clip_error(r, c);
        json_open(&j, NULL, '{');
        json_text(&j, "name", a->clips[c].name);
        json_integer(&j, "frames", a->clips[c].frame_count);
        print_error(&j, &error);
        json_open(&j, "rmse_percent_per_frame", '[');
        for (uint32_t f = 0; f < a->clips[c].frame_count; ++f)
            json_number(&j, NULL, r->frames[a->clips[c].first_frame + f].rmse_percent);
        json_close(&j, ']');
        json_close(&j, '}');
    }
    json_close(&j, ']');
    if (r->hierarchy_s >= 0) json_number(&j, "hierarchy_s", r->hierarchy_s);
    json_number(&j, "skin_s", r->skin_s);
    json_integer(&j, "bytes", rigging_bytes(o->output));
    json_integer(&j, "peak_rss_bytes", peak_memory());
    json_close(&j, '}');
    json_finish(&j);
}

static int skin(session *s, const void *options, const arguments *paths)
{
    const skin_options *o = options;
    sph_animation *whole = NULL;
    clips c = {0};
    rigging r = {0};
    int result = DONE;
    sph_status status;
    progress_start(&s->progress, "reading");
    status = input_open(s, &o->input, paths, &o->input.frames, &whole);
    progress_end(&s->progress);
    result = status == SPH_OK ? clips_open(s, &o->input, paths, o->clips, whole, &c) : session_fail(s, status, NULL);
    if (result == DONE) result = rigging_make(s, &o->rig, &c, &r);
    if (result == DONE) result = rigging_save(s, &o->rig, &r, o->output);
    if (result == DONE && s->json)
        print_json(o, &r);
    else if (result == DONE && !s->quiet)
        print_text(o, &r);
    rigging_free(&r);
    clips_close(&c);
    sph_animation_destroy(whole);
    return result;
}

static int run(int argc, char **argv)
{
    skin_options o;
    arguments paths;
    return session_run(parse(&o, argc, argv, &paths), &skin_command, &o.common, skin, &o, &paths);
}

const subcommand skin_command = {"skin", "rig an animation: bones, weights and clips as glTF", HELP, run};
