/* SPDX-License-Identifier: MIT */
/* sphmesh export: levels for other tools. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "numbered.h"
#include "program.h"
#include "report.h"
#include "session.h"

static const char HELP[] = "Writes a level (.json or .sphm) for other tools, says how far its mesh sticks\n"
                           "out of it, and inflates it where wanted until nothing does.\n"
                           "\n"
                           "usage: sphmesh export LEVEL -o OUT [OPTION]...\n"
                           "\n"
                           "  -o, --output OUT            .json: spheres, tapered capsules and thick\n"
                           "                              triangles, frame by frame; .glb: the same as\n"
                           "                              extras of a preview's nodes; .ma: medial mesh;\n"
                           "                              .srdf (MoveIt), .yaml (cuRobo), .urdf: spheres\n"
                           "      --frames A:B:STEP       frames (.json, .glb: all; others: the first); of\n"
                           "                              the others each gets a file of its own,\n"
                           "                              OUT-0012.ma, or in place of a %d in OUT\n"
                           "      --input INPUT           the animated mesh, a glob or a printf pattern:\n"
                           "                              say how far vertices stick out, in all frames\n"
                           "      --conservative          make radii so large that the level contains every\n"
                           "                              vertex of the input in every frame\n"
                           "      --input-frames A:B:STEP the frames of INPUT that the level was built from\n"
                           "      --cache C, --clip NAME, --fps N, --up y|z, --scale S\n"
                           "                              how to read INPUT, as for 'sphmesh build'\n"
                           "      --save-level L          also the level itself, as exported: .json, .sphm\n"
                           "      --gap PCT               spheres: as many as keep to the solid within PCT\n"
                           "                              % of its diagonal (2)\n"
                           "      --cover                 spheres: contain the solid, rather than lie in it;\n"
                           "                              --conservative means this too\n"
                           "      --name NAME             spheres: of what robot and link (sphmesh)\n"
                           "      --json                  figures as JSON on stdout\n"
                           "      --progress HOW          auto, bar, plain, json or none, on stderr (auto)\n"
                           "      --threads N             threads; 0: one per processor (0)\n"
                           "  -q, --quiet; -h, --help\n"
                           "\n"
                           "example:\n"
                           "  sphmesh export horse-40.json --input horse.obj --cache horse.pc2 \\\n"
                           "      --conservative --frames 12:13 -o horse.srdf\n";

typedef struct export_options {
    common_options common;
    input_options input;
    frame_range input_frames;
    const char *output, *mesh, *name, *save_level;
    double gap;
    bool conservative, cover;
} export_options;

/* What is told at the end. */
typedef struct outcome {
    sph_coverage before, after;
    sph_inflation inflation;
    sph_io_export_report report;
    double diagonal; /* of the input; 0: there was none */
    uint32_t files, first, step;
} outcome;

static bool is_list(const char *path)
{
    return name_ends(path, ".srdf") || name_ends(path, ".yaml") || name_ends(path, ".yml") || name_ends(path, ".urdf");
}

static bool holds_one_frame(const char *path)
{
    return is_list(path) || name_ends(path, ".ma");
}

static bool holds_level(const char *path)
{
    return name_ends(path, ".json") || name_ends(path, ".sphm");
}

static int check(const export_options *o, const arguments *paths)
{
    if (paths->count != 1) return usage_error("export", "one level is needed, not %zu", paths->count);
    if (!holds_level(paths->items[0]))
        return usage_error("export", "'%s' does not end in .json or .sphm", paths->items[0]);
    if (o->output == NULL) return usage_error("export", "-o is missing: where should it go?");
    if (!holds_one_frame(o->output) && !name_ends(o->output, ".json") && !name_ends(o->output, ".glb"))
        return usage_error("export", "-o: '%s' does not end in .json, .glb, .ma, .srdf, .yaml or .urdf", o->output);
    if (o->conservative && o->mesh == NULL)
        return usage_error("export", "--conservative: --input is missing: what should the level contain?");
    if (o->mesh == NULL && (o->input.cache != NULL || o->input_frames.given))
        return usage_error("export", "%s: it goes with --input", o->input.cache != NULL ? "--cache" : "--input-frames");
    if (!is_list(o->output) && (o->gap > 0 || o->cover || o->name != NULL))
        return usage_error("export", "%s: it goes with .srdf, .yaml and .urdf",
                           o->gap > 0 ? "--gap" : o->cover ? "--cover" : "--name");
    if (o->save_level != NULL && !holds_level(o->save_level))
        return usage_error("export", "--save-level: '%s' does not end in .json or .sphm", o->save_level);
    return o->input.scale == 0 ? usage_error("export", "--scale: 0 would leave nothing") : DONE;
}

static int parse(export_options *o, int argc, char **argv, arguments *paths)
{
    const option table[] = {{"output", 'o', OPTION_TEXT, &o->output, 0, 0, NULL},
                            {"input", 0, OPTION_TEXT, &o->mesh, 0, 0, NULL},
                            {"input-frames", 0, OPTION_FRAMES, &o->input_frames, 0, 0, NULL},
                            {"conservative", 0, OPTION_FLAG, &o->conservative, 0, 0, NULL},
                            {"cover", 0, OPTION_FLAG, &o->cover, 0, 0, NULL},
                            {"gap", 0, OPTION_NUMBER, &o->gap, 1e-6, 100, NULL},
                            {"name", 0, OPTION_TEXT, &o->name, 0, 0, NULL},
                            {"save-level", 0, OPTION_TEXT, &o->save_level, 0, 0, NULL},
                            INPUT_OPTIONS(o->input),
                            COMMON_OPTIONS(o->common)};
    int result;
    *o = (export_options){.input = INPUT_DEFAULTS, .input_frames = {.step = 1}};
    result = options_parse("export", table, argc, argv, paths);
    return result != DONE || o->common.help ? result : check(o, paths);
}

/* --- coverage --- */

/* Measures, and replaces *level by an inflated one where that is asked for. */
static sph_status cover_input(session *s, const export_options *o, sph_level **level, outcome *out)
{
    const arguments paths = {.items = (const char **)(uintptr_t)&o->mesh, .count = 1};
    sph_animation *animation = NULL;
    sph_level *inflated = NULL;
    sph_status status = input_open(s, &o->input, &paths, &o->input_frames, &animation);
    if (status == SPH_OK) status = sph_animation_bounding_diagonal(animation, &out->diagonal);
    if (status == SPH_OK) status = sph_coverage_measure(animation, *level, &out->before);
    out->after = out->before;
    if (status == SPH_OK && o->conservative) {
        progress_start(&s->progress, "inflating");
        status = sph_coverage_inflate(animation, *level, NULL, &out->inflation, &inflated);
        if (status == SPH_OK) {
            progress_start(&s->progress, "checking");
            status = sph_coverage_measure(animation, inflated, &out->after);
        }
        if (status == SPH_OK) {
            sph_level_destroy(*level);
            *level = inflated;
            inflated = NULL;
        }
    }
    sph_level_destroy(inflated);
    sph_animation_destroy(animation);
    return status;
}

/* --- files --- */

/* Diagonal of the box around the level's spheres in one frame. */
static double extent(const sph_level *level, uint32_t frame)
{
    sph_level_arrays a = {.struct_size = sizeof a};
    double low[3] = {0, 0, 0}, high[3] = {0, 0, 0}, sum = 0;
    if (sph_level_get_arrays(level, &a) != SPH_OK) return 0;
    for (size_t i = 0; i < 3 * (size_t)a.sphere_count; ++i) {
        const double c = a.centers[3 * (size_t)frame * a.sphere_count + i];
        const double r = a.radii[i / 3 + (a.radii_per_frame ? (size_t)frame * a.sphere_count : 0)];
        if (i < 3 || c - r < low[i % 3]) low[i % 3] = c - r;
        if (i < 3 || c + r > high[i % 3]) high[i % 3] = c + r;
    }
    for (int k = 0; k < 3; ++k)
        sum += (high[k] - low[k]) * (high[k] - low[k]);
    return sqrt(sum);
}

static sph_status write_one(session *s, const export_options *o, const sph_level *level, const char *path,
                            uint32_t frame, uint32_t count, outcome *out)
{
    sph_io_export_options e;
    sph_io_export_report r = {.struct_size = sizeof r};
    sph_status status;
    sph_io_export_options_init(&e, sizeof e);
    e.first_frame = frame;
    e.frame_step = out->step;
    e.frame_limit = count;
    e.cover_solid = o->cover || o->conservative;
    e.gap = o->gap / 100 * extent(level, frame);
    e.name = o->name;
    e.coverage = out->diagonal > 0 ? &out->after : NULL;
    status = sph_io_export_level(s->context, level, path, &e, &r);
    if (status != SPH_OK) return status;
    ++out->files;
    r.frame_count += out->report.frame_count;
    if (out->report.gap > r.gap) r.gap = out->report.gap;
    if (out->report.sphere_count > r.sphere_count) r.sphere_count = out->report.sphere_count;
    out->report = r;
    return SPH_OK;
}

static sph_status write_files(session *s, const export_options *o, const sph_level *level, uint32_t count,
                              outcome *out)
{
    const uint32_t last = out->first + (count - 1) * out->step;
    sph_status status = SPH_OK;
    if (!holds_one_frame(o->output) || (count == 1 && !name_is_pattern(o->output)))
        return write_one(s, o, level, o->output, out->first, count, out);
    for (uint32_t i = 0; i < count && status == SPH_OK; ++i) {
        const uint32_t frame = out->first + i * out->step;
        char *name = numbered_name(o->output, frame, last);
        status = sph_context_report_progress(s->context, "export", (double)i / count);
        if (name == NULL) status = sph_context_fail(s->context, SPH_E_NOMEM, "out of memory");
        if (status == SPH_OK) status = write_one(s, o, level, name, frame, 1, out);
        free(name);
    }
    return status;
}

/* --- what is told --- */

static void put_coverage(json *j, const char *name, const sph_coverage *c, double diagonal)
{
    json_open(j, name, '{');
    json_number(j, "distance", c->distance);
    json_number(j, "distance_percent", 100 * c->distance / diagonal);
    json_integer(j, "frame", c->frame);
    json_integer(j, "vertex", c->vertex);
    json_integer(j, "uncovered", c->uncovered_count);
    json_close(j, '}');
}

static void print_json(const export_options *o, const outcome *out)
{
    json j;
    json_start(&j, stdout, false);
    json_open(&j, NULL, '{');
    json_text(&j, "output", o->output);
    json_integer(&j, "files", out->files);
    json_integer(&j, "frames", out->report.frame_count);
    json_integer(&j, "spheres", out->report.sphere_count);
    json_integer(&j, "capsules", out->report.capsule_count);
    json_integer(&j, "triangles", out->report.triangle_count);
    json_number(&j, "gap", out->report.gap);
    if (out->diagonal > 0) {
        json_number(&j, "bounding_diagonal", out->diagonal);
        put_coverage(&j, "uncovered", &out->after, out->diagonal);
    }
    if (o->conservative) {
        put_coverage(&j, "uncovered_before", &out->before, out->diagonal);
        json_open(&j, "inflation", '{');
        json_integer(&j, "rounds", out->inflation.rounds);
        json_integer(&j, "grown", out->inflation.grown_count);
        json_number(&j, "max_growth", out->inflation.max_growth);
        json_number(&j, "mean_growth", out->inflation.mean_growth);
        json_number(&j, "volume_before", out->inflation.volume_before);
        json_number(&j, "volume_after", out->inflation.volume_after);
        json_close(&j, '}');
    }
    json_integer(&j, "peak_rss_bytes", peak_memory());
    json_close(&j, '}');
    json_finish(&j);
}

static void print_summary(const export_options *o, const outcome *out)
{
    const sph_inflation *n = &out->inflation;
    const double percent = out->diagonal > 0 ? 100 / out->diagonal : 0;
    if (is_list(o->output))
        printf("exported:   %s spheres; %s by up to %.3g\n", count_text(out->report.sphere_count),
               o->cover || o->conservative ? "they reach beyond the solid" : "the solid reaches beyond them",
               out->report.gap);
    else
        printf("exported:   %s frames of %s spheres alone, %s capsules, %s triangles\n",
               count_text(out->report.frame_count), count_text(out->report.sphere_count),
               count_text(out->report.capsule_count), count_text(out->report.triangle_count));
    if (out->diagonal > 0 && out->before.uncovered_count > 0)
        printf("uncovered:  %s%.4g, %.3f %% of the bounding-box diagonal, in frame %u at vertex %u\n",
               o->conservative ? "before: " : "at most ", out->before.distance, percent * out->before.distance,
               out->before.frame, out->before.vertex);
    if (o->conservative)
        printf("inflated:   radii by %.3f %% on average, %.3f %% at most; volume from %.4g to %.4g (x %.3f)\n",
               percent * n->mean_growth, percent * n->max_growth, n->volume_before, n->volume_after,
               n->volume_before > 0 ? n->volume_after / n->volume_before : 1);
    if (out->diagonal > 0 && out->after.uncovered_count == 0)
        printf("contained:  every vertex of the input, in every frame\n");
    if (out->files == 1)
        printf("wrote:      %s\n", o->output);
    else
        printf("wrote:      %u files for %s\n", out->files, o->output);
}

static int export_level(session *s, const void *options, const arguments *paths)
{
    const export_options *o = options;
    const char *path = paths->items[0];
    outcome out = {.before = {.struct_size = sizeof out.before},
                   .after = {.struct_size = sizeof out.after},
                   .inflation = {.struct_size = sizeof out.inflation},
                   .first = o->input.frames.first,
                   .step = o->input.frames.step};
    const char *subject = o->mesh;
    sph_level *level = NULL;
    sph_status status = SPH_OK;
    uint32_t count;
    int result = load_level(s, path, &level);
    if (result != DONE) return result;
    count = range_count(&o->input.frames, sph_level_frame_count(level));
    if (count == 0) {
        result = usage_error("export", "--frames: the level has %u frames, none from %u on",
                             sph_level_frame_count(level), out.first);
        sph_level_destroy(level);
        return result;
    }
    if (holds_one_frame(o->output) && !o->input.frames.given) count = 1;
    progress_start(&s->progress, "measuring");
    if (o->mesh != NULL) status = cover_input(s, o, &level, &out);
    if (status == SPH_OK) {
        subject = NULL;
        progress_start(&s->progress, "exporting");
        status = write_files(s, o, level, count, &out);
    }
    progress_end(&s->progress);
    if (status == SPH_OK && o->save_level != NULL) status = sph_io_save_level(s->context, level, o->save_level);
    if (status != SPH_OK)
        result = session_fail(s, status, subject);
    else if (s->json)
        print_json(o, &out);
    else if (!s->quiet)
        print_summary(o, &out);
    sph_level_destroy(level);
    return result;
}

static int run(int argc, char **argv)
{
    export_options o;
    arguments paths;
    return session_run(parse(&o, argc, argv, &paths), &export_command, &o.common, export_level, &o, &paths);
}

const subcommand export_command = {"export", "write a level for other tools", HELP, run};
