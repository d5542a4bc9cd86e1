/* SPDX-License-Identifier: MIT */
/* sphmesh simplify: levels of detail of a rigged glTF. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "program.h"
#include "report.h"
#include "session.h"

static const char HELP[] = "Makes levels of detail of a rigged mesh: fewer vertices on the same bones, which\n"
                           "follow the poses of its clips.\n"
                           "\n"
                           "usage: sphmesh simplify RIG (--ratio P | --vertices N | --triangles N |\n"
                           "                             --max-error PCT) -o OUT.glb [OPTION]...\n"
                           "\n"
                           "RIG is a .glb or .gltf, of 'sphmesh skin' or of anybody. Skins, clips, nodes,\n"
                           "materials and images stay; normals, texture coordinates and the like are kept.\n"
                           "\n"
                           "  -o, --output OUT.glb        the level; of several, all in one file by MSFT_lod,\n"
                           "                              after the mesh as it is, and OUT-1.glb, OUT-2.glb,\n"
                           "                              ...: each alone\n"
                           "      --ratio P[,P...]        levels of P % of the vertices\n"
                           "      --vertices N[,N...]     levels of at most N vertices, as engines count them\n"
                           "      --triangles N[,N...]    levels of at most N triangles\n"
                           "      --max-error PCT[,...]   the coarsest levels whose error is at most PCT % of\n"
                           "                              the bounding box's diagonal (root mean square)\n"
                           "      --influences N          most bones per vertex (as many as the rig has)\n"
                           "      --poses N               most frames that levels are made for, evenly\n"
                           "                              spread; 0: all (64)\n"
                           "      --clip NAME             frames of one animation only; all are kept\n"
                           "      --fps N                 frames per second that clips are taken at (30)\n"
                           "      --method M              skinned: rest positions and weights are optimised;\n"
                           "                              position, pulled-back, rest: older methods, to\n"
                           "                              compare with (skinned)\n"
                           "      --json                  figures as JSON on stdout\n"
                           "      --progress HOW          auto, bar, plain, json or none, on stderr (auto)\n"
                           "      --threads N             threads; 0: one per processor (0)\n"
                           "  -q, --quiet; -h, --help\n"
                           "\n"
                           "examples:\n"
                           "  sphmesh simplify fox.glb --ratio 50,25,10 -o fox-lod.glb\n"
                           "  sphmesh simplify robot.glb --triangles 2000 --influences 4 -o robot-2k.glb\n";

static const char *const method_choices[] = {"skinned", "position", "pulled-back", "rest", NULL};

enum { LEVELS_MOST = 16 };

typedef struct simplify_options {
    common_options common;
    const char *output, *clip, *lists[4]; /* ratio, vertices, triangles, max-error */
    double fps, values[LEVELS_MOST];
    uint32_t influences, poses, value_count;
    int method, by; /* which of the lists */
} simplify_options;

enum { BY_RATIO, BY_VERTICES, BY_TRIANGLES, BY_ERROR };
static const char *const LIST_NAMES[] = {"--ratio", "--vertices", "--triangles", "--max-error"};

static int read_list(simplify_options *o)
{
    const char *text = o->lists[o->by];
    const double most = o->by == BY_RATIO ? 100 : o->by == BY_ERROR ? 1e6 : UINT32_MAX;
    for (;; ++text) {
        char *end;
        const double value = strtod(text, &end);
        const bool whole = o->by == BY_RATIO || o->by == BY_ERROR || value == floor(value);
        if (end == text || (*end != ',' && *end != '\0') || !(value >= 0 && value <= most) || !whole ||
            (o->by != BY_ERROR && value == 0))
            return usage_error("simplify", "%s: '%s' is not a list of %s", LIST_NAMES[o->by], o->lists[o->by],
                               o->by == BY_RATIO   ? "percentages"
                               : o->by == BY_ERROR ? "numbers that are not negative"
                                                   : "whole numbers above 0");
        if (o->value_count == LEVELS_MOST) return usage_error("simplify", "more than %d levels", LEVELS_MOST);
        o->values[o->value_count++] = value;
        if (*end == '\0') return DONE;
        text = end;
    }
}

static int parse(simplify_options *o, int argc, char **argv, arguments *paths)
{
    const option table[] = {{"output", 'o', OPTION_TEXT, &o->output, 0, 0, NULL},
                            {"ratio", 0, OPTION_TEXT, &o->lists[BY_RATIO], 0, 0, NULL},
                            {"vertices", 0, OPTION_TEXT, &o->lists[BY_VERTICES], 0, 0, NULL},
                            {"triangles", 0, OPTION_TEXT, &o->lists[BY_TRIANGLES], 0, 0, NULL},
                            {"max-error", 0, OPTION_TEXT, &o->lists[BY_ERROR], 0, 0, NULL},
                            {"influences", 0, OPTION_COUNT, &o->influences, 1, 32, NULL},
                            {"poses", 0, OPTION_COUNT, &o->poses, 0, INT32_MAX, NULL},
                            {"clip", 0, OPTION_TEXT, &o->clip, 0, 0, NULL},
                            {"fps", 0, OPTION_NUMBER, &o->fps, 1e-3, 1e6, NULL},
                            {"method", 0, OPTION_CHOICE, &o->method, 0, 0, method_choices},
                            COMMON_OPTIONS(o->common)};
    int result, given = 0;
    *o = (simplify_options){.poses = 64};
    result = options_parse("simplify", table, argc, argv, paths);
    if (result != DONE || o->common.help) return result;
    if (paths->count != 1) return usage_error("simplify", "one rig is needed, not %zu", paths->count);
    if (!name_ends(paths->items[0], ".glb") && !name_ends(paths->items[0], ".gltf"))
        return usage_error("simplify", "'%s' does not end in .glb or .gltf", paths->items[0]);
    if (o->output == NULL) return usage_error("simplify", "-o is missing: where should the levels go?");
    if (!name_ends(o->output, ".glb")) return usage_error("simplify", "-o: '%s' does not end in .glb", o->output);
    for (int i = 0; i < 4; ++i)
        if (o->lists[i] != NULL) {
            o->by = i;
            ++given;
        }
    if (given != 1) return usage_error("simplify", "one of --ratio, --vertices, --triangles and --max-error is needed");
    return read_list(o);
}

/* The levels of a rig, and the files they go to. */
typedef struct levels {
    sph_io_rig_levels *all;
    const sph_progressive *progressive;
    uint32_t numbers[LEVELS_MOST + 1]; /* the input, then those that are asked for, coarser and coarser */
    uint32_t count;
    char *names[LEVELS_MOST + 1]; /* of the files; the first is the output itself */
} levels;

static sph_status open_levels(session *s, const simplify_options *o, const char *path, levels *l)
{
    sph_io_open_rig_options rig;
    sph_simplify_options options;
    sph_status status;
    sph_io_open_rig_options_init(&rig, sizeof rig);
    sph_simplify_options_init(&options, sizeof options);
    rig.clip = o->clip;
    rig.fps = o->fps;
    options.method = o->method;
    options.influence_limit = o->influences;
    options.pose_limit = o->poses;
    status = sph_io_open_rig_levels(s->context, path, &rig, &options, &l->all);
    l->progressive = sph_io_rig_levels_progressive(l->all);
    return status;
}

static sph_status find_level(const simplify_options *o, const levels *l, double value, uint32_t *level)
{
    sph_progressive_level input = {.struct_size = sizeof input};
    const double diagonal = sph_progressive_bounding_diagonal(l->progressive);
    const sph_status status = sph_progressive_get_level(l->progressive, 0, &input);
    if (status != SPH_OK) return status;
    if (o->by == BY_ERROR) return sph_progressive_find_error(l->progressive, value / 100 * diagonal, level);
    if (o->by == BY_TRIANGLES) return sph_progressive_find_triangles(l->progressive, (uint32_t)value, level);
    if (o->by == BY_RATIO) value = fmax(1, floor(value / 100 * input.vertex_count + 0.5));
    return sph_progressive_find_vertices(l->progressive, (uint32_t)value, level);
}

static int by_number(const void *a, const void *b)
{
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* In order, each once; the input itself is no level to be asked for. */
static sph_status find_levels(const simplify_options *o, levels *l)
{
    uint32_t found[LEVELS_MOST];
    for (uint32_t i = 0; i < o->value_count; ++i) {
        const sph_status status = find_level(o, l, o->values[i], &found[i]);
        if (status != SPH_OK) return status;
    }
    qsort(found, o->value_count, sizeof *found, by_number);
    l->numbers[0] = 0;
    l->count = 0;
    for (uint32_t i = 0; i < o->value_count; ++i)
        if (i == 0 || found[i] != found[i - 1]) l->numbers[1 + l->count++] = found[i];
    return SPH_OK;
}

static bool name_files(const simplify_options *o, levels *l)
{
    const size_t stem = strlen(o->output) - strlen(".glb");
    l->names[0] = strdup(o->output);
    for (uint32_t i = 1; i <= l->count && l->count > 1; ++i) {
        l->names[i] = malloc(stem + 16);
        if (l->names[i] == NULL) return false;
        memcpy(l->names[i], o->output, stem);
        snprintf(l->names[i] + stem, 16, "-%u.glb", (unsigned)i);
    }
    return l->names[0] != NULL;
}

static sph_status save_levels(session *s, const simplify_options *o, levels *l)
{
    sph_status status = SPH_OK;
    if (!name_files(o, l)) return sph_context_fail(s->context, SPH_E_NOMEM, "out of memory");
    if (l->count == 1) return sph_io_rig_levels_save(l->all, l->numbers + 1, 1, l->names[0]);
    for (uint32_t i = 1; i <= l->count && status == SPH_OK; ++i)
        status = sph_io_rig_levels_save(l->all, l->numbers + i, 1, l->names[i]);
    if (status != SPH_OK) return status;
    return l->numbers[1] == 0 ? sph_io_rig_levels_save(l->all, l->numbers + 1, l->count, l->names[0])
                              : sph_io_rig_levels_save(l->all, l->numbers, l->count + 1, l->names[0]);
}

static sph_progressive_level level_of(const levels *l, uint32_t number)
{
    sph_progressive_level level = {.struct_size = sizeof level};
    (void)sph_progressive_get_level(l->progressive, number, &level);
    return level;
}

static void print_json(const simplify_options *o, const levels *l)
{
    const double diagonal = sph_progressive_bounding_diagonal(l->progressive);
    const sph_progressive_level input = level_of(l, 0);
    json j;
    json_start(&j, stdout, false);
    json_open(&j, NULL, '{');
    json_text(&j, "output", l->names[0]);
    json_text(&j, "method", method_choices[o->method]);
    json_integer(&j, "vertices", input.vertex_count);
    json_integer(&j, "points", input.point_count);
    json_integer(&j, "triangles", input.triangle_count);
    json_integer(&j, "influences", sph_progressive_influence_count(l->progressive));
    json_integer(&j, "poses", sph_progressive_pose_count(l->progressive));
    json_number(&j, "bounding_diagonal", diagonal);
    json_open(&j, "levels", '[');
    for (uint32_t i = 1; i <= l->count; ++i) {
        const sph_progressive_level level = level_of(l, l->numbers[i]);
        const char *name = l->names[l->count == 1 ? 0 : i];
        json_open(&j, NULL, '{');
        json_text(&j, "file", name);
        json_integer(&j, "vertices", level.vertex_count);
        json_integer(&j, "points", level.point_count);
        json_integer(&j, "triangles", level.triangle_count);
        json_number(&j, "error_percent", 100 * level.error / diagonal);
        json_number(&j, "max_error_percent", 100 * level.max_error / diagonal);
        json_boolean(&j, "forced", level.forced != 0);
        json_integer(&j, "bytes", file_size(name));
        json_close(&j, '}');
    }
    json_close(&j, ']');
    json_integer(&j, "bytes", file_size(l->names[0]));
    json_integer(&j, "peak_rss_bytes", peak_memory());
    json_close(&j, '}');
    json_finish(&j);
}

static void print_text(const levels *l)
{
    const double diagonal = sph_progressive_bounding_diagonal(l->progressive);
    const sph_progressive_level input = level_of(l, 0);
    printf("rig:        %s vertices, %s triangles, %s poses\n", count_text(input.vertex_count),
           count_text(input.triangle_count), count_text(sph_progressive_pose_count(l->progressive)));
    for (uint32_t i = 1; i <= l->count; ++i) {
        const sph_progressive_level level = level_of(l, l->numbers[i]);
        const char *name = l->names[l->count == 1 ? 0 : i];
        printf("level %u:    %s vertices, %s triangles, %.3g %% off (%.3g %% at most): %s (%s)%s\n", (unsigned)i,
               count_text(level.vertex_count), count_text(level.triangle_count),
               diagonal > 0 ? 100 * level.error / diagonal : 0, diagonal > 0 ? 100 * level.max_error / diagonal : 0,
               name, size_text(file_size(name)), level.forced ? ", with triangles turned over" : "");
    }
    if (l->count > 1) printf("together:   %s (%s)\n", l->names[0], size_text(file_size(l->names[0])));
}

static int simplify(session *s, const void *options, const arguments *paths)
{
    const simplify_options *o = options;
    levels l = {.count = 0};
    int result = DONE;
    sph_status status;
    progress_start(&s->progress, "simplifying");
    status = open_levels(s, o, paths->items[0], &l);
    progress_end(&s->progress);
    if (status == SPH_OK && interrupted()) status = SPH_E_CANCELLED;
    if (status == SPH_OK) status = find_levels(o, &l);
    if (status == SPH_OK) status = save_levels(s, o, &l);
    if (status != SPH_OK)
        result = session_fail(s, status, NULL);
    else if (s->json)
        print_json(o, &l);
    else if (!s->quiet)
        print_text(&l);
    for (uint32_t i = 0; i <= LEVELS_MOST; ++i)
        free(l.names[i]);
    sph_io_rig_levels_destroy(l.all);
    return result;
}

static int run(int argc, char **argv)
{
    simplify_options o;
    arguments paths;
    return session_run(parse(&o, argc, argv, &paths), &simplify_command, &o.common, simplify, &o, &paths);
}

const subcommand simplify_command = {"simplify", "levels of detail of a rigged glTF", HELP, run};
