/* SPDX-License-Identifier: MIT */
/* sphmesh render: pictures of levels and of the meshes that they stand for. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "picture.h"
#include "program.h"
#include "report.h"
#include "scene.h"

static const char HELP[] = "Draws levels and meshes. Spheres are red, edges yellow, triangles blue.\n"
                           "\n"
                           "usage: sphmesh render LEVEL|INPUT... -o OUT.png [OPTION]...\n"
                           "\n"
                           "The tiles: INPUT, if there is one (named as for 'sphmesh build'), then each\n"
                           "LEVEL (.json, .sphm), in each frame; at one scale and from the same side.\n"
                           "\n"
                           "  -o, --output OUT.png        where the picture goes\n"
                           "      --levels K,K,...        levels of a hierarchy given as LEVEL\n"
                           "      --overlay INPUT         draw this mesh as of glass over the levels\n"
                           "      --bones RIG.glb         colour INPUT by the bones of this rig of it\n"
                           "      --frames A:B:STEP       the frames to draw (the first only)\n"
                           "      --input-frames A:B:STEP frames of INPUT that levels were built from (all)\n"
                           "      --columns N             tiles in a row (the frames; else all)\n"
                           "      --size N | WxH          pixels of one tile (360)\n"
                           "      --view NAME             corner, front, side, back or top (corner)\n"
                           "      --azimuth DEG           or from where, around the y axis (0: from +z)\n"
                           "      --elevation DEG         and how far above the horizon\n"
                           "      --zoom Z                nearer (1: the mean box over frames fits)\n"
                           "      --center X,Y,Z          what is in the middle of a tile (that box)\n"
                           "      --follow                ... or each frame's own box\n"
                           "      --focal MM              perspective, as a lens on 35 mm film (0: none)\n"
                           "      --flat                  no shadows and no ground\n"
                           "      --samples N             rays along the side of a pixel, 1 to 8 (3)\n"
                           "      --cache C, --clip NAME, --fps N, --up y|z, --scale S\n"
                           "                              of INPUT, as for 'sphmesh build'\n"
                           "      --json, --progress HOW, --threads N, -q, --quiet; -h, --help\n"
                           "\n"
                           "example:\n"
                           "  sphmesh render horse.sphm --levels 46,20,10 --frames ::12 -o horse.png\n";

enum { MOST_TILES = 4096, MOST_PIXELS = 1 << 28, LEAST_SIZE = 16, MOST_SIZE = 8192 };

enum { VIEW_CORNER, VIEW_FRONT, VIEW_SIDE, VIEW_BACK, VIEW_TOP };
static const char *const view_choices[] = {"corner", "front", "side", "back", "top", NULL};
static const double VIEWS[][2] = {{35, 15}, {0, 0}, {90, 0}, {180, 0}, {0, 90}};

typedef struct render_options {
    common_options common;
    scene_options scene;
    camera_aim aim;
    const char *output, *levels, *size, *centre;
    frame_range frames;
    uint32_t columns, samples, width, height;
    int view;
    bool follow, flat;
} render_options;

/* Tiles of the picture: each figure in each frame, one after the other. */
typedef struct sheet {
    uint32_t frames, tiles, columns, rows;
} sheet;

/* "46,20,10" */
static bool read_counts(const char *text, scene_options *o)
{
    for (o->count_count = 0; o->count_count < SCENE_COUNTS; ++text) {
        char *end;
        const unsigned long long value = *text >= '0' && *text <= '9' ? strtoull(text, &end, 10) : 0;
        if (value == 0 || value > UINT32_MAX) return false;
        o->counts[o->count_count++] = (uint32_t)value;
        text = end;
        if (*text != ',') return *text == '\0';
    }
    return false;
}

/* "360" or "480x360" */
static bool read_size(const char *text, render_options *o)
{
    unsigned long width, height;
    char *end;
    if (*text < '0' || *text > '9') return false;
    width = height = strtoul(text, &end, 10);
    if (*end == 'x' && end[1] >= '0' && end[1] <= '9') height = strtoul(end + 1, &end, 10);
    if (*end != '\0' || width < LEAST_SIZE || width > MOST_SIZE || height < LEAST_SIZE || height > MOST_SIZE)
        return false;
    o->width = (uint32_t)width;
    o->height = (uint32_t)height;
    return true;
}

/* "0.5,1,-2" */
static bool read_place(const char *text, double place[3])
{
    for (int k = 0; k < 3; ++k) {
        char *end;
        place[k] = strtod(text, &end);
        if (end == text || *text == ' ' || !isfinite(place[k]) || *end != (k < 2 ? ',' : '\0')) return false;
        text = end + 1;
    }
    return true;
}

static int check_texts(render_options *o)
{
    if (o->levels != NULL && !read_counts(o->levels, &o->scene))
        return usage_error("render", "--levels: '%s' is not a list of up to %d numbers of spheres, as in 46,20,10",
                           o->levels, SCENE_COUNTS);
    if (o->size != NULL && !read_size(o->size, o))
        return usage_error("render", "--size: '%s' is not a number of pixels from %d to %d, nor two as in 480x360",
                           o->size, LEAST_SIZE, MOST_SIZE);
    o->aim.has_centre = o->centre != NULL;
    if (o->centre != NULL && !read_place(o->centre, o->aim.centre))
        return usage_error("render", "--center: '%s' is not a place, as in 0.5,1,-2", o->centre);
    if (o->follow && o->centre != NULL) return usage_error("render", "--follow and --center: give one of the two");
    return DONE;
}

static int check_paths(const render_options *o, const arguments *paths)
{
    arguments meshes = *paths;
    meshes.count = 0;
    for (size_t i = 0; i < paths->count; ++i)
        meshes.count += !scene_is_level(paths->items[i]);
    if (paths->count == 0) return usage_error("render", "nothing to draw: name levels, or a mesh");
    if (o->output == NULL) return usage_error("render", "-o is missing: where should the picture go?");
    if (!name_ends(o->output, ".png")) return usage_error("render", "-o: '%s' does not end in .png", o->output);
    if (o->scene.overlay != NULL && scene_is_level(o->scene.overlay))
        return usage_error("render", "--overlay: '%s' is a level; a mesh goes here", o->scene.overlay);
    if (o->scene.overlay != NULL && meshes.count == paths->count)
        return usage_error("render", "--overlay: there is no level to draw it over");
    if (o->scene.bones != NULL && meshes.count == 0)
        return usage_error("render", "--bones: there is no mesh to colour");
    if (meshes.count == 0 && o->scene.overlay == NULL)
        return o->scene.input.cache == NULL ? DONE
                                            : usage_error("render", "--cache: there is no mesh that it could move");
    meshes.count += meshes.count == 0;
    return input_check("render", &o->scene.input, &meshes);
}

static int parse(render_options *o, int argc, char **argv, arguments *paths)
{
    input_options *input = &o->scene.input;
    const option table[] = {{"output", 'o', OPTION_TEXT, &o->output, 0, 0, NULL},
                            {"levels", 0, OPTION_TEXT, &o->levels, 0, 0, NULL},
                            {"overlay", 0, OPTION_TEXT, &o->scene.overlay, 0, 0, NULL},
                            {"bones", 0, OPTION_TEXT, &o->scene.bones, 0, 0, NULL},
                            {"frames", 0, OPTION_FRAMES, &o->frames, 0, 0, NULL},
                            {"input-frames", 0, OPTION_FRAMES, &input->frames, 0, 0, NULL},
                            {"columns", 0, OPTION_COUNT, &o->columns, 1, MOST_TILES, NULL},
                            {"size", 0, OPTION_TEXT, &o->size, 0, 0, NULL},
                            {"view", 0, OPTION_CHOICE, &o->view, 0, 0, view_choices},
                            {"azimuth", 0, OPTION_NUMBER, &o->aim.azimuth, -360, 360, NULL},
                            {"elevation", 0, OPTION_NUMBER, &o->aim.elevation, -90, 90, NULL},
                            {"zoom", 0, OPTION_NUMBER, &o->aim.zoom, 1e-3, 1e3, NULL},
                            {"center", 0, OPTION_TEXT, &o->centre, 0, 0, NULL},
                            {"focal", 0, OPTION_NUMBER, &o->aim.focal, 0, 1e4, NULL},
                            {"follow", 0, OPTION_FLAG, &o->follow, 0, 0, NULL},
                            {"flat", 0, OPTION_FLAG, &o->flat, 0, 0, NULL},
                            {"samples", 0, OPTION_COUNT, &o->samples, 1, 8, NULL},
                            {"cache", 0, OPTION_TEXT, &input->cache, 0, 0, NULL},
                            {"clip", 0, OPTION_TEXT, &input->clip, 0, 0, NULL},
                            {"fps", 0, OPTION_NUMBER, &input->fps, 1e-3, 1e6, NULL},
                            {"up", 0, OPTION_CHOICE, &input->up, 0, 0, up_choices},
                            {"scale", 0, OPTION_NUMBER, &input->scale, -1e30, 1e30, NULL},
                            COMMON_OPTIONS(o->common)};
    int result;
    *o = (render_options){.scene = {.input = INPUT_DEFAULTS},
                          .frames = {.end = 1, .step = 1},
                          .aim = {.azimuth = NAN, .elevation = NAN, .zoom = 1},
                          .samples = 3,
                          .width = 360,
                          .height = 360};
    result = options_parse("render", table, argc, argv, paths);
    if (result != DONE || o->common.help) return result;
    if (isnan(o->aim.azimuth)) o->aim.azimuth = VIEWS[o->view][0];
    if (isnan(o->aim.elevation)) o->aim.elevation = VIEWS[o->view][1];
    result = check_texts(o);
    return result == DONE ? check_paths(o, paths) : result;
}

/* Frames of the range that all figures have. */
static uint32_t count_frames(const scene *sc, const frame_range *r)
{
    uint32_t end = r->end == 0 ? UINT32_MAX : r->end;
    for (size_t i = 0; i < sc->figure_count; ++i)
        if (sc->figures[i].frame_count < end) end = sc->figures[i].frame_count;
    return r->first >= end ? 0 : (end - r->first - 1) / r->step + 1;
}

static int lay_out(const render_options *o, const scene *sc, sheet *sh)
{
    uint64_t tiles, pixels;
    sh->frames = count_frames(sc, &o->frames);
    if (sh->frames == 0) return failure("--frames: not everything that is to be drawn has frame %u", o->frames.first);
    tiles = (uint64_t)sh->frames * sc->figure_count;
    if (tiles > MOST_TILES)
        return failure("%zu figures in %u frames: too many for one picture", sc->figure_count, sh->frames);
    sh->tiles = (uint32_t)tiles;
    sh->columns = o->columns != 0 ? o->columns : sh->frames > 1 ? sh->frames : sh->tiles;
    if (sh->columns > sh->tiles) sh->columns = sh->tiles;
    sh->rows = (sh->tiles - 1) / sh->columns + 1;
    pixels = (uint64_t)sh->columns * sh->rows * o->width * o->height;
    if (pixels <= MOST_PIXELS) return DONE;
    return failure("%u by %u tiles of %u by %u pixels: the picture is too large", sh->columns, sh->rows, o->width,
                   o->height);
}

/* The camera for a frame: it stays where it is, but goes along with the figures where it should. */
static void aim(const render_options *o, const scene *sc, uint32_t frame, camera *c)
{
    camera_aim a = o->aim;
    if (o->follow && frame < sc->middle_count) {
        memcpy(a.centre, &sc->middles[3 * (size_t)frame], sizeof a.centre);
        a.centre[1] = (sc->mean.low[1] + sc->mean.high[1]) / 2;
        a.has_centre = true;
    }
    camera_set(c, &a, &sc->mean, o->width, o->height);
}

static sph_status draw_tile(session *s, const render_options *o, scene *sc, const sheet *sh, uint32_t i, picture *p)
{
    const uint32_t frame = o->frames.first + i % sh->frames * o->frames.step;
    figure *f = &sc->figures[i / sh->frames];
    const bool is_glazed = sc->overlay.query != NULL && f->animation == NULL;
    camera c;
    tile t = {.figure = f,
              .overlay = is_glazed ? &sc->overlay : NULL,
              .camera = &c,
              .left = i % sh->columns * o->width,
              .top = i / sh->columns * o->height,
              .width = o->width,
              .height = o->height,
              .samples = o->samples,
              .has_shadows = !o->flat,
              .ground = sc->ground,
              .scale = box_diagonal(&sc->mean)};
    sph_status status = figure_pose(f, frame);
    if (status == SPH_OK && is_glazed) status = figure_pose(&sc->overlay, frame);
    if (status != SPH_OK) return status;
    aim(o, sc, frame, &c);
    return picture_draw(p, s->context, &t, (double)i / sh->tiles, 1.0 / sh->tiles);
}

static void tell(const session *s, const render_options *o, const picture *p, const scene *sc, const sheet *sh)
{
    json j;
    if (s->json) {
        json_start(&j, stdout, false);
        json_open(&j, NULL, '{');
        json_text(&j, "output", o->output);
        json_integer(&j, "levels", sc->figure_count - (sc->figures[0].animation != NULL));
        json_integer(&j, "meshes", sc->figures[0].animation != NULL);
        json_integer(&j, "frames", sh->frames);
        json_integer(&j, "columns", sh->columns);
        json_integer(&j, "rows", sh->rows);
        json_integer(&j, "width", p->width);
        json_integer(&j, "height", p->height);
        json_close(&j, '}');
        json_finish(&j);
    } else if (!s->quiet) {
        printf("picture:    %u by %u pixels, %u by %u tiles\n", p->width, p->height, sh->columns, sh->rows);
        printf("wrote:      %s (%s)\n", o->output, size_text(file_size(o->output)));
    }
}

static int draw_all(session *s, const render_options *o, scene *sc)
{
    picture p = {0};
    sheet sh = {0};
    sph_status status = SPH_OK;
    int result = lay_out(o, sc, &sh);
    if (result != DONE) return result;
    p.width = sh.columns * o->width;
    p.height = sh.rows * o->height;
    p.rgb = malloc((size_t)3 * p.width * p.height);
    if (p.rgb == NULL) return failure("out of memory");
    memset(p.rgb, 255, (size_t)3 * p.width * p.height);
    progress_start(&s->progress, "drawing");
    for (uint32_t i = 0; i < sh.tiles && status == SPH_OK; ++i)
        status = draw_tile(s, o, sc, &sh, i, &p);
    progress_end(&s->progress);
    if (status == SPH_OK && interrupted()) status = SPH_E_CANCELLED;
    if (status != SPH_OK)
        result = session_fail(s, status, NULL);
    else if ((result = picture_save(&p, o->output)) == DONE)
        tell(s, o, &p, sc, &sh);
    free(p.rgb);
    return result;
}

static int render(session *s, const void *options, const arguments *paths)
{
    const render_options *o = options;
    scene sc;
    int result = scene_open(s, &o->scene, paths, &sc);
    if (result == DONE) result = draw_all(s, o, &sc);
    scene_close(s, &sc);
    return result;
}

static int run(int argc, char **argv)
{
    render_options o;
    arguments paths;
    return session_run(parse(&o, argc, argv, &paths), &render_command, &o.common, render, &o, &paths);
}

const subcommand render_command = {"render", "draw levels and meshes as a picture", HELP, run};
