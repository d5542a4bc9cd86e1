/* SPDX-License-Identifier: MIT */
/* sphmesh measure: distances between an animated mesh and a level. */
#include <stdio.h>

#include "numbered.h"
#include "program.h"
#include "report.h"
#include "session.h"

static const char HELP[] = "Measures how far a level is from the animated mesh that it was made from.\n"
                           "\n"
                           "usage: sphmesh measure INPUT... --level L [OPTION]...\n"
                           "\n"
                           "INPUT is the animation, named as for 'sphmesh build'.\n"
                           "\n"
                           "  -l, --level L               a level, .json or .sphm\n"
                           "      --samples N             points per surface and frame (10000)\n"
                           "      --frames A:B:STEP       measure these frames only; for a level that was\n"
                           "                              built with --frames, give the same here\n"
                           "      --cache C               the frames of the mesh: a PC2 or MDD point cache\n"
                           "      --clip NAME, --object NAME, --space local|world, --fps N, --up y|z,\n"
                           "      --scale S               as for 'sphmesh build'\n"
                           "      --json                  figures as JSON on stdout\n"
                           "      --progress HOW          auto, bar, plain, json or none, on stderr (auto)\n"
                           "      --threads N             threads; 0: one per processor (0)\n"
                           "  -q, --quiet; -h, --help\n"
                           "\n"
                           "Surface 1 is the mesh, surface 2 the outer surface of the level's interpolated\n"
                           "spheres. M12 is the mean distance from 1 to 2, M21 from 2 to 1, H (Hausdorff)\n"
                           "the largest of all: means over frames, in % of the mean bounding-box diagonal.\n"
                           "\n"
                           "example:\n"
                           "  sphmesh measure horse.obj --cache horse.pc2 --level horse-40.json --frames ::4\n";

typedef struct measure_options {
    common_options common;
    input_options input;
    const char *level;
    uint32_t samples;
} measure_options;

static int parse(measure_options *m, int argc, char **argv, arguments *paths)
{
    sph_measure_options defaults;
    const option table[] = {{"level", 'l', OPTION_TEXT, &m->level, 0, 0, NULL},
                            {"samples", 0, OPTION_COUNT, &m->samples, 1, 100000000, NULL},
                            INPUT_OPTIONS(m->input),
                            COMMON_OPTIONS(m->common)};
    int result;
    sph_measure_options_init(&defaults, sizeof defaults);
    *m = (measure_options){.input = INPUT_DEFAULTS, .samples = defaults.samples};
    result = options_parse("measure", table, argc, argv, paths);
    if (result != DONE || m->common.help) return result;
    if (m->level == NULL) return usage_error("measure", "--level is missing: what should be measured?");
    if (!name_ends(m->level, ".json") && !name_ends(m->level, ".sphm"))
        return usage_error("measure", "--level: '%s' does not end in .json or .sphm", m->level);
    return input_check("measure", &m->input, paths);
}

/*
 * Opens the input so that its frames are the level's. A range picks frames of both; where the level has just as many
 * frames as the range, it was built from these, and the range picks frames of the input alone.
 */
static sph_status open_input(session *s, const measure_options *m, const arguments *paths, uint32_t level_frames,
                             sph_measure_options *o, sph_animation **out)
{
    const frame_range *r = &m->input.frames;
    sph_status status = input_open(s, &m->input, paths, NULL, out);
    uint32_t frames;
    if (status != SPH_OK || !r->given) return status;
    frames = sph_animation_frame_count(*out);
    if (frames != level_frames && range_count(r, frames) == level_frames) {
        sph_animation_destroy(*out);
        return input_open(s, &m->input, paths, r, out);
    }
    o->first_frame = r->first;
    o->frame_step = r->step;
    o->frame_limit = r->end == 0 ? 0 : range_count(r, r->end);
    return status;
}

static void print_json(const measure_options *m, const sph_distances *d, double diagonal, uint32_t spheres,
                       uint32_t frames, double seconds)
{
    json j;
    json_start(&j, stdout, false);
    json_open(&j, NULL, '{');
    json_text(&j, "level", m->level);
    json_integer(&j, "spheres", spheres);
    json_integer(&j, "frames", frames);
    json_integer(&j, "samples", m->samples);
    json_number(&j, "bounding_diagonal", diagonal);
    report_distances_json(&j, d, 100 / diagonal); /* in % */
    json_open(&j, "model_units", '{');
    report_distances_json(&j, d, 1);
    json_close(&j, '}');
    json_number(&j, "area1", d->area1);
    json_number(&j, "area2", d->area2);
    json_number(&j, "measure_s", seconds);
    json_integer(&j, "peak_rss_bytes", peak_memory());
    json_close(&j, '}');
    json_finish(&j);
}

static void print_summary(const sph_distances *d, double diagonal, uint32_t spheres, uint32_t frames, uint32_t samples)
{
    const double percent = 100 / diagonal;
    printf("level:      %s spheres, %s frames measured, %s points on each surface\n", count_text(spheres),
           count_text(frames), count_text(samples));
    printf("            %%      model units   (%% of the bounding-box diagonal, %.4g)\n", diagonal);
    printf("H     %10.3f   %10.4g   largest distance\n", percent * d->hausdorff, d->hausdorff);
    printf("M12   %10.3f   %10.4g   mean, mesh to level (largest %.3f %%)\n", percent * d->mean12, d->mean12,
           percent * d->max12);
    printf("M21   %10.3f   %10.4g   mean, level to mesh (largest %.3f %%)\n", percent * d->mean21, d->mean21,
           percent * d->max21);
}

static int measure_level(session *s, const measure_options *m, const arguments *paths, const sph_level *level)
{
    sph_measure_options o;
    sph_animation *animation = NULL;
    sph_distances mean;
    sph_status status;
    double diagonal = 0, seconds = 0;
    uint32_t frames;
    int result = DONE;
    sph_measure_options_init(&o, sizeof o);
    o.samples = m->samples;
    progress_start(&s->progress, "measuring");
    status = open_input(s, m, paths, sph_level_frame_count(level), &o, &animation);
    if (status == SPH_OK) status = sph_animation_bounding_diagonal(animation, &diagonal);
    if (status == SPH_OK && o.first_frame >= sph_animation_frame_count(animation)) {
        result = usage_error("measure", "--frames: there are %u frames, none from %u on",
                             sph_animation_frame_count(animation), o.first_frame);
        sph_animation_destroy(animation);
        return result;
    }
    progress_start(&s->progress, "measuring");
    if (status == SPH_OK) status = sph_measure_level(animation, level, &o, &mean, NULL);
    seconds = progress_end(&s->progress);
    if (status != SPH_OK) {
        sph_animation_destroy(animation);
        return session_fail(s, status, NULL);
    }
    frames = (sph_animation_frame_count(animation) - o.first_frame - 1) / o.frame_step + 1;
    if (o.frame_limit != 0 && o.frame_limit < frames) frames = o.frame_limit;
    if (s->json)
        print_json(m, &mean, diagonal, sph_level_sphere_count(level), frames, seconds);
    else if (!s->quiet)
        print_summary(&mean, diagonal, sph_level_sphere_count(level), frames, m->samples);
    sph_animation_destroy(animation);
    return result;
}

static int measure(session *s, const void *options, const arguments *paths)
{
    const measure_options *m = options;
    sph_level *level = NULL;
    int result = load_level(s, m->level, &level);
    if (result == DONE) result = measure_level(s, m, paths, level);
    sph_level_destroy(level);
    return result;
}

static int run(int argc, char **argv)
{
    measure_options m;
    arguments paths;
    return session_run(parse(&m, argc, argv, &paths), &measure_command, &m.common, measure, &m, &paths);
}

const subcommand measure_command = {"measure", "measure a level against the mesh that it was made from", HELP, run};
