/* SPDX-License-Identifier: MIT */
/* sphmesh build: from an animation to the hierarchy of its sphere-meshes. */
#include <stdio.h>

#include "program.h"
#include "report.h"
#include "session.h"

static const char *const importance_choices[] = {"none", "curvature", NULL};
static const char *const radius_choices[] = {"constant", "per-frame", "zero", NULL};

static const char HELP[] = "Builds the hierarchy of animated sphere-meshes of an animated mesh.\n"
                           "\n"
                           "usage: sphmesh build INPUT... -o F.sphm [OPTION]...\n"
                           "\n"
                           "INPUT is one mesh (OBJ, PLY, OFF or STL), as a rule with a point cache, or one\n"
                           "per frame: s2.obj comes before s10.obj; 's*.obj' (in quotes) or s%d.obj will\n"
                           "do. A glTF or an Alembic (.abc) alone brings its own animation.\n"
                           "\n"
                           "  -o, --output F.sphm         where the hierarchy goes\n"
                           "      --cache C               the frames of the mesh: a PC2 or MDD point cache\n"
                           "      --clip NAME             one animation of a glTF; else all in a row\n"
                           "      --object NAME           one object of an Alembic; else all that is visible\n"
                           "      --space local|world     world: an Alembic as its scene places it (local)\n"
                           "      --fps N                 frames per second, of a glTF (30) or an Alembic\n"
                           "      --frames A:B:STEP       frames A, A+STEP, ... below B only (from 0)\n"
                           "      --up y|z                axis that points up in the input (y)\n"
                           "      --scale S               multiply positions (1)\n"
                           "      --weld                  unite vertices that coincide in all frames (seams)\n"
                           "      --importance HOW        none: by area; curvature: small parts live longer\n"
                           "                              (curvature)\n"
                           "      --radius HOW            constant: one per sphere; per-frame; zero: points,\n"
                           "                              which is QEM (constant)\n"
                           "      --radius-factor R       largest radius, in widths of its part (0.75)\n"
                           "      --temporal-coherence D  draw spheres to the middle of their parts (0)\n"
                           "      --width-directions N    directions that widths are taken over, 3-1024 (30)\n"
                           "      --memory-limit SIZE     keep to about 512M, 2G ... of memory\n"
                           "      --temporary-folder DIR  where the rest goes ($TMPDIR, else /var/tmp)\n"
                           "      --json                  figures as JSON on stdout\n"
                           "      --progress HOW          auto, bar, plain, json or none, on stderr (auto)\n"
                           "      --threads N             threads; 0: one per processor (0)\n"
                           "  -q, --quiet; -h, --help\n"
                           "\n"
                           "examples:\n"
                           "  sphmesh build horse.obj --cache horse.pc2 -o horse.sphm\n"
                           "  sphmesh build fox.glb --clip Run --fps 60 -o fox.sphm\n"
                           "  sphmesh build 'wolf/wolf_*.obj' --frames 0:20:2 -o wolf.sphm --json\n";

typedef struct build_options {
    common_options common;
    input_options input;
    const char *output;
    bool weld;
    int importance, radius;
    double radius_factor, temporal_coherence;
    uint32_t width_directions;
} build_options;

/* What there is to tell in the end. */
typedef struct build_figures {
    double load_s, init_s, decimate_s, save_s;
    uint32_t vertices, frames, welded;
    size_t triangles;
} build_figures;

static int parse(build_options *b, int argc, char **argv, arguments *paths)
{
    sph_hierarchy_options defaults;
    const option table[] = {{"output", 'o', OPTION_TEXT, &b->output, 0, 0, NULL},
                            INPUT_OPTIONS(b->input),
                            {"weld", 0, OPTION_FLAG, &b->weld, 0, 0, NULL},
                            {"importance", 0, OPTION_CHOICE, &b->importance, 0, 0, importance_choices},
                            {"radius", 0, OPTION_CHOICE, &b->radius, 0, 0, radius_choices},
                            {"radius-factor", 0, OPTION_NUMBER, &b->radius_factor, 0, 1e30, NULL},
                            {"temporal-coherence", 0, OPTION_NUMBER, &b->temporal_coherence, 0, 1e30, NULL},
                            {"width-directions", 0, OPTION_COUNT, &b->width_directions, 3, 1024, NULL},
                            MEMORY_OPTIONS(b->common.memory),
                            COMMON_OPTIONS(b->common)};
    int result;
    sph_hierarchy_options_init(&defaults, sizeof defaults);
    *b = (build_options){.input = INPUT_DEFAULTS,
                         .importance = defaults.importance,
                         .radius = defaults.radius_mode,
                         .radius_factor = defaults.radius_factor,
                         .temporal_coherence = defaults.temporal_coherence,
                         .width_directions = defaults.width_directions};
    result = options_parse("build", table, argc, argv, paths);
    if (result != DONE || b->common.help) return result;
    result = input_check("build", &b->input, paths);
    if (result != DONE) return result;
    if (b->common.memory.folder != NULL && b->common.memory.limit == 0)
        return usage_error("build", "--temporary-folder: it goes with --memory-limit");
    if (b->output == NULL) return usage_error("build", "-o is missing: where should the hierarchy go?");
    if (!name_ends(b->output, ".sphm")) return usage_error("build", "-o: '%s' does not end in .sphm", b->output);
    return DONE;
}

static sph_status load(session *s, const build_options *b, const arguments *paths, build_figures *figures,
                       sph_animation **out)
{
    sph_animation *welded = NULL;
    sph_status status;
    progress_start(&s->progress, "reading");
    status = input_open(s, &b->input, paths, &b->input.frames, out);
    if (status == SPH_OK && b->weld) {
        status = sph_animation_weld(*out, 0, NULL, &welded);
        if (status == SPH_OK) {
            figures->welded = sph_animation_vertex_count(*out) - sph_animation_vertex_count(welded);
            sph_animation_destroy(*out);
            *out = welded;
        }
    }
    figures->load_s = progress_end(&s->progress);
    if (status != SPH_OK) return status;
    figures->vertices = sph_animation_vertex_count(*out);
    figures->triangles = sph_animation_triangle_count(*out);
    figures->frames = sph_animation_frame_count(*out);
    return status;
}

static sph_status create(session *s, const build_options *b, const sph_animation *animation, build_figures *figures,
                         sph_hierarchy **out)
{
    sph_hierarchy_options o;
    sph_status status;
    double elapsed;
    sph_hierarchy_options_init(&o, sizeof o);
    o.importance = b->importance;
    o.radius_mode = b->radius;
    o.radius_factor = b->radius_factor;
    o.temporal_coherence = b->temporal_coherence;
    o.width_directions = b->width_directions;
    progress_start(&s->progress, "building");
    status = sph_hierarchy_create(animation, &o, out);
    elapsed = progress_end(&s->progress);
    figures->init_s = s->progress.decimation < 0 ? elapsed : s->progress.decimation;
    figures->decimate_s = elapsed - figures->init_s;
    return status;
}

static void print_json(const build_options *b, const sph_hierarchy *h, const build_figures *f)
{
    json j;
    json_start(&j, stdout, false);
    json_open(&j, NULL, '{');
    json_text(&j, "output", b->output);
    json_integer(&j, "bytes", file_size(b->output));
    json_integer(&j, "vertices", f->vertices);
    json_integer(&j, "welded", f->welded);
    json_integer(&j, "frames", f->frames);
    json_integer(&j, "triangles", f->triangles);
    json_number(&j, "bounding_diagonal", sph_hierarchy_bounding_diagonal(h));
    json_integer(&j, "collapses", sph_hierarchy_collapse_count(h));
    json_integer(&j, "first_forced", sph_hierarchy_first_forced(h));
    json_integer(&j, "spheres_min", coarsest_count(h));
    json_integer(&j, "evaluations", sph_hierarchy_evaluation_count(h));
    json_number(&j, "load_s", f->load_s);
    json_number(&j, "init_s", f->init_s);
    json_number(&j, "decimate_s", f->decimate_s);
    json_number(&j, "build_s", f->init_s + f->decimate_s);
    json_number(&j, "save_s", f->save_s);
    json_integer(&j, "peak_rss_bytes", peak_memory());
    json_close(&j, '}');
    json_finish(&j);
}

static void print_summary(const build_options *b, const sph_hierarchy *h, const build_figures *f)
{
    const uint32_t coarsest = coarsest_count(h), forced = sph_hierarchy_first_forced(h);
    printf("input:      %s vertices, %s triangles, %s frames", count_text(f->vertices), count_text(f->triangles),
           count_text(f->frames));
    if (b->weld) printf("; welding took %s vertices away", count_text(f->welded));
    printf("\nhierarchy:  from %s spheres to %s", count_text(f->vertices), count_text(coarsest));
    if (forced < sph_hierarchy_collapse_count(h))
        printf("; below %s it has to turn triangles over", count_text(f->vertices - forced));
    printf("\ntime:       %.2f s reading, %.2f s preparing, %.2f s decimating, %.2f s writing\n", f->load_s, f->init_s,
           f->decimate_s, f->save_s);
    printf("memory:     %s at most\n", size_text(peak_memory()));
    printf("wrote:      %s (%s)\n", b->output, size_text(file_size(b->output)));
    if (coarsest > 1)
        printf("hint:       every connected component keeps a sphere: %s here%s\n", count_text(coarsest),
               b->weld ? "" : "; --weld joins those that touch at seams");
}

static int build(session *s, const void *options, const arguments *paths)
{
    const build_options *b = options;
    build_figures figures = {0};
    sph_animation *animation = NULL;
    sph_hierarchy *hierarchy = NULL;
    const char *subject = NULL;
    sph_status status = load(s, b, paths, &figures, &animation);
    int result = DONE;
    if (status == SPH_OK) status = create(s, b, animation, &figures, &hierarchy);
    sph_animation_destroy(animation);
    if (status == SPH_OK && !interrupted()) {
        subject = b->output;
        progress_start(&s->progress, "writing");
        status = sph_io_save_hierarchy(s->context, hierarchy, b->output);
        figures.save_s = progress_end(&s->progress);
    } else if (status == SPH_OK) {
        status = SPH_E_CANCELLED;
    }
    if (status != SPH_OK)
        result = session_fail(s, status, subject);
    else if (s->json)
        print_json(b, hierarchy, &figures);
    else if (!s->quiet)
        print_summary(b, hierarchy, &figures);
    sph_hierarchy_destroy(hierarchy);
    return result;
}

static int run(int argc, char **argv)
{
    build_options b;
    arguments paths;
    return session_run(parse(&b, argc, argv, &paths), &build_command, &b.common, build, &b, &paths);
}

const subcommand build_command = {"build", "make the hierarchy of an animated mesh", HELP, run};
