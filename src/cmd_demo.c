/* SPDX-License-Identifier: MIT */
/* sphmesh demo: everything, on the built-in creature. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "creature.h"
#include "program.h"
#include "report.h"
#include "session.h"

static const char HELP[] = "Makes a walking creature, approximates it, measures the result, and leaves all\n"
                           "files to look at.\n"
                           "\n"
                           "usage: sphmesh demo [-o DIR] [OPTION]...\n"
                           "\n"
                           "  -o, --output DIR            folder for the files (sphmesh-demo)\n"
                           "      --frame-count N         frames of the creature's walk (48)\n"
                           "      --resolution N          of the creature, 32 to 200 (48: 8,000 vertices)\n"
                           "      --samples N             points per surface and frame to measure by (2000)\n"
                           "      --json                  figures as JSON on stdout\n"
                           "      --progress HOW          auto, bar, plain, json or none, on stderr (auto)\n"
                           "      --threads N             threads; 0: one per processor (0)\n"
                           "  -q, --quiet; -h, --help\n"
                           "\n"
                           "It writes the creature as creature.obj with the point cache creature.pc2, its\n"
                           "hierarchy creature.sphm, the hierarchy by plain quadric error metrics (spheres\n"
                           "of radius zero) creature-qem.sphm, and of both the levels with 60, 40, 20 and\n"
                           "10 spheres as .json and .obj. About 12 of the frames are measured. Last comes a\n"
                           "rig of 20 bones for engines, creature-rig.glb.\n"
                           "\n"
                           "example:\n"
                           "  sphmesh demo -o demo\n";

static const uint32_t COUNTS[] = {60, 40, 20, 10};
enum {
    COUNT_COUNT = sizeof COUNTS / sizeof COUNTS[0],
    PATH_SIZE = 4096,
    RIG_BONES = 20,
    RIG_FPS = 30,
    MEASURED_FRAMES = 12
};

typedef struct demo_options {
    common_options common;
    const char *folder;
    uint32_t frames, resolution, samples;
} demo_options;

/* The two ways that are compared. */
typedef struct method {
    const char *label, *hierarchy_name, *level_name;
    int32_t radius_mode;
    double build_s;
    sph_distances distances[COUNT_COUNT];
} method;

typedef struct demo {
    session *s;
    const demo_options *o;
    sph_animation *creature;
    double diagonal;
    method methods[2];
    sph_skin_error rig_error;
    double rig_s;
} demo;

/* Puts a path together; false, said, where it is too long. */
static bool join(char path[PATH_SIZE], const char *folder, const char *name)
{
    const int length = snprintf(path, PATH_SIZE, "%s/%s", folder, name);
    if (length > 0 && length < PATH_SIZE) return true;
    failure("%s: the name is too long", folder);
    return false;
}

static int make_folder(const char *folder)
{
    struct stat info;
    if (mkdir(folder, 0777) == 0) return DONE;
    if (errno == EEXIST && stat(folder, &info) == 0 && S_ISDIR(info.st_mode)) return DONE;
    return failure("%s: cannot make this folder: %s", folder, strerror(errno));
}

static int make_creature(demo *d)
{
    char obj[PATH_SIZE], pc2[PATH_SIZE];
    sph_status status;
    if (!join(obj, d->o->folder, "creature.obj") || !join(pc2, d->o->folder, "creature.pc2")) return FAILED;
    progress_start(&d->s->progress, "creature");
    status = creature_create(d->s->context, d->o->frames, d->o->resolution, &d->creature);
    if (status == SPH_OK) status = sph_animation_bounding_diagonal(d->creature, &d->diagonal);
    if (status == SPH_OK && interrupted()) status = SPH_E_CANCELLED;
    if (status == SPH_OK) status = sph_io_save_obj_pc2(d->s->context, d->creature, 0, 1, obj, pc2);
    progress_end(&d->s->progress);
    return status == SPH_OK ? DONE : session_fail(d->s, status, NULL);
}

static sph_status write_level(demo *d, const method *m, const sph_level *level, uint32_t count)
{
    static const char *const ENDINGS[] = {"json", "obj"};
    char name[64], path[PATH_SIZE];
    for (int i = 0; i < 2; ++i) {
        sph_status status;
        snprintf(name, sizeof name, "%s-%u.%s", m->level_name, count, ENDINGS[i]);
        if (!join(path, d->o->folder, name)) return SPH_E_INVALID;
        status = sph_io_save_level(d->s->context, level, path);
        if (status != SPH_OK) return status;
    }
    return SPH_OK;
}

/* Every so many frames one is measured, so that the demo is soon over. */
static uint32_t measured_step(const demo_options *o)
{
    return o->frames <= MEASURED_FRAMES ? 1 : o->frames / MEASURED_FRAMES;
}

static int make_level(demo *d, method *m, const sph_hierarchy *h, int index)
{
    sph_measure_options o;
    sph_level *level = NULL;
    sph_status status = sph_level_create(h, COUNTS[index], &level);
    sph_measure_options_init(&o, sizeof o);
    o.samples = d->o->samples;
    o.frame_step = measured_step(d->o);
    if (status == SPH_OK) status = write_level(d, m, level, COUNTS[index]);
    progress_start(&d->s->progress, "measuring");
    if (status == SPH_OK) status = sph_measure_level(d->creature, level, &o, &m->distances[index], NULL);
    progress_end(&d->s->progress);
    if (status == SPH_OK && interrupted()) status = SPH_E_CANCELLED;
    sph_level_destroy(level);
    return status == SPH_OK ? DONE : session_fail(d->s, status, NULL);
}

/* The level with RIG_BONES spheres as the bones of a rig. */
static int make_rig(demo *d, const sph_hierarchy *h)
{
    const sph_skin_source source = {.animation = d->creature, .name = "walk", .frames_per_second = RIG_FPS};
    char path[PATH_SIZE];
    sph_level *level = NULL;
    sph_skin *skin = NULL;
    sph_status status;
    if (!join(path, d->o->folder, "creature-rig.glb")) return FAILED;
    progress_start(&d->s->progress, "rigging");
    status = sph_level_create(h, RIG_BONES, &level);
    if (status == SPH_OK) status = sph_skin_create(level, &source, 1, NULL, &skin);
    if (status == SPH_OK) status = sph_skin_get_errors(skin, &d->rig_error, NULL);
    if (status == SPH_OK) status = sph_io_save_rig(d->s->context, skin, NULL, NULL, path);
    d->rig_s = progress_end(&d->s->progress);
    sph_skin_destroy(skin);
    sph_level_destroy(level);
    return status == SPH_OK ? DONE : session_fail(d->s, status, NULL);
}

static int run_method(demo *d, method *m)
{
    char path[PATH_SIZE];
    sph_hierarchy_options o;
    sph_hierarchy *h = NULL;
    sph_status status;
    int result;
    if (!join(path, d->o->folder, m->hierarchy_name)) return FAILED;
    sph_hierarchy_options_init(&o, sizeof o);
    o.radius_mode = m->radius_mode;
    progress_start(&d->s->progress, m->label);
    status = sph_hierarchy_create(d->creature, &o, &h);
    m->build_s = progress_end(&d->s->progress);
    if (status == SPH_OK && interrupted()) status = SPH_E_CANCELLED;
    if (status == SPH_OK) status = sph_io_save_hierarchy(d->s->context, h, path);
    result = status == SPH_OK ? DONE : session_fail(d->s, status, NULL);
    for (int i = 0; result == DONE && i < COUNT_COUNT; ++i)
        result = make_level(d, m, h, i);
    if (result == DONE && m == d->methods) result = make_rig(d, h);
    sph_hierarchy_destroy(h);
    return result;
}

static void print_table(const demo *d)
{
    const method *a = &d->methods[0], *b = &d->methods[1];
    const double percent = 100 / d->diagonal;
    printf("creature:   %s vertices, %s triangles, %s frames\n", count_text(sph_animation_vertex_count(d->creature)),
           count_text(sph_animation_triangle_count(d->creature)), count_text(d->o->frames));
    printf("built in:   %.2f s (sphere-mesh), %.2f s (QEM); peak memory %s\n\n", a->build_s, b->build_s,
           size_text(peak_memory()));
    printf("            %-28s%s\n", "sphere-mesh", "QEM (radius zero)");
    printf("%-12s%6s  %6s  %6s  %10s  %6s  %6s\n", "spheres", "H", "M12", "M21", "H", "M12", "M21");
    for (int i = 0; i < COUNT_COUNT; ++i) {
        const sph_distances *s = &a->distances[i], *q = &b->distances[i];
        printf("%-12u%6.2f  %6.3f  %6.3f  %10.2f  %6.3f  %6.3f\n", COUNTS[i], percent * s->hausdorff,
               percent * s->mean12, percent * s->mean21, percent * q->hausdorff, percent * q->mean12,
               percent * q->mean21);
    }
    printf("\nDistances in %% of the bounding-box diagonal, means over %u of the frames;\n"
           "H: the largest; M12: the mean from mesh to level; M21: from level to mesh.\n\n",
           (d->o->frames - 1) / measured_step(d->o) + 1);
    printf("In %s there are now:\n"
           "  creature.obj, creature.pc2            the creature and its point cache, for any 3D program\n"
           "  creature.sphm, creature-qem.sphm      the hierarchies\n"
           "  level-K.json, level-K.obj             sphere-meshes with K = 60, 40, 20, 10 spheres\n"
           "  qem-K.json, qem-K.obj                 the same by QEM\n"
           "  creature-rig.glb                      a rig of %d bones: RMSE %.3f %%, in %.2f s\n"
           "Next:\n"
           "  sphmesh info %s/creature.sphm\n"
           "  sphmesh level %s/creature.sphm --spheres 30 -o %s/level-30.json\n",
           d->o->folder, RIG_BONES, d->rig_error.rmse_percent, d->rig_s, d->o->folder, d->o->folder, d->o->folder);
}

static void print_json(const demo *d)
{
    static const char *const KEYS[] = {"sphere_mesh", "qem"};
    json j;
    json_start(&j, stdout, false);
    json_open(&j, NULL, '{');
    json_text(&j, "folder", d->o->folder);
    json_integer(&j, "vertices", sph_animation_vertex_count(d->creature));
    json_integer(&j, "triangles", sph_animation_triangle_count(d->creature));
    json_integer(&j, "frames", d->o->frames);
    json_integer(&j, "frames_measured", (d->o->frames - 1) / measured_step(d->o) + 1);
    json_integer(&j, "samples", d->o->samples);
    json_number(&j, "bounding_diagonal", d->diagonal);
    for (int k = 0; k < 2; ++k) {
        json_open(&j, KEYS[k], '{');
        json_number(&j, "build_s", d->methods[k].build_s);
        json_open(&j, "levels", '[');
        for (int i = 0; i < COUNT_COUNT; ++i) {
            json_open(&j, NULL, '{');
            json_integer(&j, "spheres", COUNTS[i]);
            report_distances_json(&j, &d->methods[k].distances[i], 100 / d->diagonal);
            json_close(&j, '}');
        }
        json_close(&j, ']');
        json_close(&j, '}');
    }
    json_open(&j, "rig", '{');
    json_integer(&j, "bones", RIG_BONES);
    json_number(&j, "rmse_percent", d->rig_error.rmse_percent);
    json_number(&j, "max_percent", d->rig_error.max_percent);
    json_number(&j, "rig_s", d->rig_s);
    json_close(&j, '}');
    json_integer(&j, "peak_rss_bytes", peak_memory());
    json_close(&j, '}');
    json_finish(&j);
}

static int show_all(session *s, const void *options, const arguments *paths)
{
    const demo_options *o = options;
    demo d = {.s = s,
              .o = o,
              .methods = {{.label = "sphere-mesh",
                           .hierarchy_name = "creature.sphm",
                           .level_name = "level",
                           .radius_mode = SPH_RADIUS_CONSTANT},
                          {.label = "QEM",
                           .hierarchy_name = "creature-qem.sphm",
                           .level_name = "qem",
                           .radius_mode = SPH_RADIUS_ZERO}}};
    int result;
    if (paths->count > 0)
        return usage_error("demo", "'%s' is one argument too many; the folder goes after -o", paths->items[0]);
    result = make_folder(o->folder);
    if (result == DONE) result = make_creature(&d);
    for (int k = 0; result == DONE && k < 2; ++k)
        result = run_method(&d, &d.methods[k]);
    if (result == DONE && s->json)
        print_json(&d);
    else if (result == DONE && !s->quiet)
        print_table(&d);
    sph_animation_destroy(d.creature);
    return result;
}

static int run(int argc, char **argv)
{
    demo_options o = {
        .folder = "sphmesh-demo", .frames = CREATURE_FRAMES, .resolution = CREATURE_RESOLUTION, .samples = 2000};
    const option table[] = {
        {"output", 'o', OPTION_TEXT, &o.folder, 0, 0, NULL},
        {"frame-count", 0, OPTION_COUNT, &o.frames, 1, CREATURE_FRAMES_MAX, NULL},
        {"resolution", 0, OPTION_COUNT, &o.resolution, CREATURE_RESOLUTION_MIN, CREATURE_RESOLUTION_MAX, NULL},
        {"samples", 0, OPTION_COUNT, &o.samples, 1, 100000000, NULL},
        COMMON_OPTIONS(o.common)};
    arguments rest;
    return session_run(options_parse("demo", table, argc, argv, &rest), &demo_command, &o.common, show_all, &o, &rest);
}

const subcommand demo_command = {"demo", "show it all on a built-in animated creature", HELP, run};
