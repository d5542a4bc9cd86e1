/* SPDX-License-Identifier: MIT */
/* sphmesh render: pictures of levels. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "picture.h"
#include "program.h"
#include "report.h"
#include "session.h"

static const char HELP[] = "Draws levels: what spheres alone touch red, edges yellow, triangles blue.\n"
                           "\n"
                           "usage: sphmesh render LEVEL... -o OUT.png [OPTION]...\n"
                           "\n"
                           "Each LEVEL (.json or .sphm) is a row of the picture, each frame a column, all\n"
                           "seen from the same side and at the same scale.\n"
                           "\n"
                           "  -o, --output OUT.png        where the picture goes\n"
                           "      --frames A:B:STEP       the frames to draw (the first only)\n"
                           "      --size N                pixels along the side of one tile (360)\n"
                           "      --azimuth DEG           side to look from, around the y axis; 0: +z (35)\n"
                           "      --elevation DEG         and how far above the horizon (15)\n"
                           "      --json                  figures as JSON on stdout\n"
                           "      --progress HOW          auto, bar, plain, json or none, on stderr (auto)\n"
                           "      --threads N             threads; 0: one per processor (0)\n"
                           "  -q, --quiet; -h, --help\n"
                           "\n"
                           "example:\n"
                           "  sphmesh render horse-40.json horse-20.json --frames ::12 -o horse.png\n";

enum { MOST_TILES = 4096, MOST_PIXELS = 1 << 28 };

typedef struct render_options {
    common_options common;
    const char *output;
    frame_range frames;
    uint32_t size;
    double azimuth, elevation;
} render_options;

typedef struct scene {
    const sph_level **levels;
    size_t level_count;
    uint32_t columns;
    const render_options *options;
    picture_view view;
} scene;

static int parse(render_options *o, int argc, char **argv, arguments *paths)
{
    const option table[] = {{"output", 'o', OPTION_TEXT, &o->output, 0, 0, NULL},
                            {"frames", 0, OPTION_FRAMES, &o->frames, 0, 0, NULL},
                            {"size", 0, OPTION_COUNT, &o->size, 16, 8192, NULL},
                            {"azimuth", 0, OPTION_NUMBER, &o->azimuth, -360, 360, NULL},
                            {"elevation", 0, OPTION_NUMBER, &o->elevation, -90, 90, NULL},
                            COMMON_OPTIONS(o->common)};
    int result;
    *o = (render_options){.frames = {.end = 1, .step = 1}, .size = 360, .azimuth = 35, .elevation = 15};
    result = options_parse("render", table, argc, argv, paths);
    if (result != DONE || o->common.help) return result;
    if (paths->count == 0) return usage_error("render", "no level: what should be drawn?");
    if (o->output == NULL) return usage_error("render", "-o is missing: where should the picture go?");
    if (!name_ends(o->output, ".png")) return usage_error("render", "-o: '%s' does not end in .png", o->output);
    for (size_t i = 0; i < paths->count; ++i)
        if (!name_ends(paths->items[i], ".json") && !name_ends(paths->items[i], ".sphm"))
            return usage_error("render", "'%s' does not end in .json or .sphm", paths->items[i]);
    return DONE;
}

/* Frames of the range that all levels have. */
static uint32_t count_columns(const scene *s)
{
    const frame_range *r = &s->options->frames;
    uint32_t end = r->end == 0 ? UINT32_MAX : r->end;
    for (size_t i = 0; i < s->level_count; ++i)
        if (sph_level_frame_count(s->levels[i]) < end) end = sph_level_frame_count(s->levels[i]);
    return r->first >= end ? 0 : (end - r->first - 1) / r->step + 1;
}

/* A ball around the spheres of all tiles, so that the scale does not depend on the side that is looked at. */
static void aim(scene *s)
{
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, sum = 0;
    for (size_t i = 0; i < s->level_count; ++i) {
        sph_level_arrays a = {.struct_size = sizeof a};
        if (sph_level_get_arrays(s->levels[i], &a) != SPH_OK) continue;
        for (uint32_t c = 0; c < s->columns; ++c) {
            const size_t first = (size_t)(s->options->frames.first + c * s->options->frames.step) * a.sphere_count;
            for (size_t j = 0; j < 3 * (size_t)a.sphere_count; ++j) {
                const double r = a.radii[(a.radii_per_frame ? first : 0) + j / 3], x = a.centers[3 * first + j];
                low[j % 3] = fmin(low[j % 3], x - r);
                high[j % 3] = fmax(high[j % 3], x + r);
            }
        }
    }
    for (int k = 0; k < 3; ++k) {
        s->view.middle[k] = (low[k] + high[k]) / 2;
        sum += (high[k] - low[k]) * (high[k] - low[k]);
    }
    s->view.reach = sum > 0 ? sqrt(sum) / 2 : 1;
    picture_turn(&s->view, s->options->azimuth, s->options->elevation);
}

static sph_status draw(session *s, const scene *sc, picture *p)
{
    sph_status status = SPH_OK;
    for (size_t i = 0; i < sc->level_count && status == SPH_OK; ++i) {
        sph_query *query = NULL;
        status = sph_query_create(sc->levels[i], NULL, &query);
        for (uint32_t c = 0; c < sc->columns && status == SPH_OK; ++c) {
            const double done = (double)(i * sc->columns + c) / (double)(sc->level_count * sc->columns);
            status = sph_context_report_progress(s->context, "render", done);
            if (status == SPH_OK)
                status = sph_query_pose_frame(query, sc->options->frames.first + c * sc->options->frames.step);
            if (status == SPH_OK)
                status = picture_draw(p, s->context, query, &sc->view, c * sc->options->size,
                                      (uint32_t)i * sc->options->size, sc->options->size);
        }
        sph_query_destroy(query);
    }
    return status;
}

static void tell(const session *s, const render_options *o, const picture *p, const scene *sc)
{
    json j;
    if (s->json) {
        json_start(&j, stdout, false);
        json_open(&j, NULL, '{');
        json_text(&j, "output", o->output);
        json_integer(&j, "levels", sc->level_count);
        json_integer(&j, "frames", sc->columns);
        json_integer(&j, "width", p->width);
        json_integer(&j, "height", p->height);
        json_close(&j, '}');
        json_finish(&j);
    } else if (!s->quiet) {
        printf("picture:    %u by %u pixels, %zu levels by %u frames\n", p->width, p->height, sc->level_count,
               sc->columns);
        printf("wrote:      %s (%s)\n", o->output, size_text(file_size(o->output)));
    }
}

static int draw_all(session *s, const render_options *o, scene *sc)
{
    picture p = {0};
    sph_status status;
    int result = DONE;
    sc->options = o;
    sc->columns = count_columns(sc);
    if (sc->columns == 0) return failure("--frames: not all levels have frame %u", o->frames.first);
    if (sc->level_count * sc->columns > MOST_TILES || sc->level_count * sc->columns > MOST_PIXELS / o->size / o->size)
        return failure("%zu levels by %u frames of %u pixels: the picture is too large", sc->level_count, sc->columns,
                       o->size);
    p.width = sc->columns * o->size;
    p.height = (uint32_t)sc->level_count * o->size;
    p.rgb = malloc((size_t)3 * p.width * p.height);
    if (p.rgb == NULL) return failure("out of memory");
    memset(p.rgb, 255, (size_t)3 * p.width * p.height);
    aim(sc);
    progress_start(&s->progress, "drawing");
    status = draw(s, sc, &p);
    progress_end(&s->progress);
    if (status == SPH_OK && interrupted()) status = SPH_E_CANCELLED;
    if (status != SPH_OK)
        result = session_fail(s, status, NULL);
    else if ((result = picture_save(&p, o->output)) == DONE)
        tell(s, o, &p, sc);
    free(p.rgb);
    return result;
}

static int render(session *s, const render_options *o, const arguments *paths)
{
    sph_level **levels = calloc(paths->count, sizeof *levels);
    scene sc = {.levels = (const sph_level **)levels, .level_count = paths->count};
    int result = levels == NULL ? failure("out of memory") : DONE;
    for (size_t i = 0; i < paths->count && result == DONE; ++i)
        result = load_level(s, paths->items[i], &levels[i]);
    if (result == DONE) result = draw_all(s, o, &sc);
    for (size_t i = 0; i < paths->count && levels != NULL; ++i)
        sph_level_destroy(levels[i]);
    free(levels);
    return result;
}

static int run(int argc, char **argv)
{
    render_options o;
    arguments paths;
    session s;
    int result = parse(&o, argc, argv, &paths);
    if (result == DONE && o.common.help) {
        fputs(HELP, stdout);
    } else if (result == DONE && (result = session_open(&s, &o.common)) == DONE) {
        result = render(&s, &o, &paths);
        session_close(&s);
    }
    free(paths.items);
    return result;
}

const subcommand render_command = {"render", "draw levels as a picture", HELP, run};
