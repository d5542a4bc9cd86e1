/* SPDX-License-Identifier: MIT */
/* sphmesh pose: the vertices of a rig in the poses of its clips. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "posing.h"
#include "program.h"
#include "report.h"
#include "session.h"

static const char HELP[] = "Poses a rigged mesh: the vertices of a skinned glTF in the frames of its clips.\n"
                           "\n"
                           "usage: sphmesh pose RIG -o OUT [OPTION]...\n"
                           "\n"
                           "RIG is a .glb or .gltf, of 'sphmesh skin' or of anybody.\n"
                           "\n"
                           "  -o, --output OUT            OUT.pc2, OUT.mdd: the frames, and OUT.obj;\n"
                           "                              OUT.glb: the frames as morph targets;\n"
                           "                              OUT.obj, OUT.ply: one frame, with normals\n"
                           "      --method M              lbs: linear blend skinning, as engines have it;\n"
                           "                              dqs: dual quaternions, which keep the volume\n"
                           "                              where joints twist (lbs)\n"
                           "      --implicit              correct the pose by the solids of the rig's parts;\n"
                           "                              the method, now dqs, is where it starts from\n"
                           "      --operation O           at joints: union, blend or bulge (union)\n"
                           "      --fields F              take them from a .sphm; --save-fields F: keep them\n"
                           "      --exact, --unguarded    without tables; without looking for intersections\n"
                           "      --beside                also OUT-lbs and OUT-dqs, the plain results\n"
                           "      --pairs                 count intersecting triangles, before and after\n"
                           "      --clip NAME             one animation of the file; else all in a row\n"
                           "      --fps N                 frames per second (30)\n"
                           "      --frames A:B:STEP       frames A, A+STEP, ... below B only (from 0)\n"
                           "      --frame F               the frame of an .obj or .ply; 0 is the first (0)\n"
                           "      --json                  figures as JSON on stdout\n"
                           "      --progress HOW          auto, bar, plain, json or none, on stderr (auto)\n"
                           "      --threads N             threads; 0: one per processor (0)\n"
                           "  -q, --quiet; -h, --help\n"
                           "\n"
                           "Vertices along seams stay apart, as the file has them. Morph targets stay at\n"
                           "rest. A rig without clips has one frame, its pose at rest.\n"
                           "\n"
                           "examples:\n"
                           "  sphmesh pose fox.glb --clip Run --implicit --beside -o run.glb\n"
                           "  sphmesh pose fox.glb --clip Run --frame 12 -o fox-12.obj\n";

static const char *const method_choices[] = {"lbs", "dqs", NULL};
static const char *const operation_choices[] = {"union", "blend", "bulge", NULL};

typedef struct pose_options {
    common_options common;
    frame_range frames;
    const char *output, *clip;
    double fps;
    uint32_t frame;
    int method;
    correction correct;
    bool beside;
    bool single, mdd, glb;
    char *mesh, *cache; /* what is written; free(); `cache` NULL: only the mesh */
} pose_options;

static int name_outputs(pose_options *o)
{
    o->mdd = name_ends(o->output, ".mdd");
    o->single = name_ends(o->output, ".obj") || name_ends(o->output, ".ply");
    o->glb = name_ends(o->output, ".glb");
    if (!o->single && !o->mdd && !o->glb && !name_ends(o->output, ".pc2"))
        return usage_error("pose", "-o: '%s' does not end in .pc2, .mdd, .glb, .obj or .ply", o->output);
    if (o->single && o->frames.given)
        return usage_error("pose", "--frames: an .obj or .ply has one, which is --frame; .pc2 and .mdd have many");
    if (!o->single && o->frame != UINT32_MAX)
        return usage_error("pose", "--frame: of an .obj or .ply; of the others it is --frames");
    o->mesh = o->single || o->glb ? strdup(o->output) : name_with_ending(o->output, ".obj");
    o->cache = o->single || o->glb ? NULL : strdup(o->output);
    return o->mesh == NULL || (!o->single && !o->glb && o->cache == NULL) ? failure("out of memory") : DONE;
}

static int parse(pose_options *o, int argc, char **argv, arguments *paths)
{
    const option table[] = {{"output", 'o', OPTION_TEXT, &o->output, 0, 0, NULL},
                            {"method", 0, OPTION_CHOICE, &o->method, 0, 0, method_choices},
                            {"implicit", 0, OPTION_FLAG, &o->correct.wanted, 0, 0, NULL},
                            {"operation", 0, OPTION_CHOICE, &o->correct.operation, 0, 0, operation_choices},
                            {"fields", 0, OPTION_TEXT, &o->correct.fields, 0, 0, NULL},
                            {"save-fields", 0, OPTION_TEXT, &o->correct.save_fields, 0, 0, NULL},
                            {"exact", 0, OPTION_FLAG, &o->correct.exact, 0, 0, NULL},
                            {"unguarded", 0, OPTION_FLAG, &o->correct.unguarded, 0, 0, NULL},
                            {"beside", 0, OPTION_FLAG, &o->beside, 0, 0, NULL},
                            {"pairs", 0, OPTION_FLAG, &o->correct.pairs, 0, 0, NULL},
                            {"clip", 0, OPTION_TEXT, &o->clip, 0, 0, NULL},
                            {"fps", 0, OPTION_NUMBER, &o->fps, 1e-3, 1e6, NULL},
                            {"frames", 0, OPTION_FRAMES, &o->frames, 0, 0, NULL},
                            {"frame", 0, OPTION_COUNT, &o->frame, 0, INT32_MAX, NULL},
                            COMMON_OPTIONS(o->common)};
    int result;
    *o = (pose_options){.frames = {.step = 1}, .frame = UINT32_MAX, .method = -1};
    result = options_parse("pose", table, argc, argv, paths);
    if (result != DONE || o->common.help) return result;
    if (paths->count != 1) return usage_error("pose", "one rig is needed, not %zu", paths->count);
    if (!name_ends(paths->items[0], ".glb") && !name_ends(paths->items[0], ".gltf"))
        return usage_error("pose", "'%s' does not end in .glb or .gltf", paths->items[0]);
    if (o->output == NULL) return usage_error("pose", "-o is missing: where should the mesh go?");
    if (o->method < 0) o->method = o->correct.wanted ? SPH_POSE_DUAL_QUATERNION : SPH_POSE_LINEAR;
    if (!o->correct.wanted && (o->beside || o->correct.pairs || o->correct.exact || o->correct.unguarded ||
                               o->correct.fields != NULL || o->correct.save_fields != NULL))
        return usage_error("pose", "--beside, --pairs, --exact, --unguarded, --fields and --save-fields go with "
                                   "--implicit");
    return name_outputs(o);
}

static sph_status open_rig(session *s, const pose_options *o, const char *path, posing *p)
{
    sph_io_open_rig_options options;
    sph_status status;
    sph_io_open_rig_options_init(&options, sizeof options);
    options.clip = o->clip;
    options.fps = o->fps;
    options.first_frame = o->frames.first;
    options.end_frame = o->frames.end;
    options.frame_step = o->frames.step;
    if (o->single) {
        options.first_frame = o->frame == UINT32_MAX ? 0 : o->frame;
        options.end_frame = options.first_frame + 1;
    }
    p->parts.struct_size = sizeof p->parts;
    p->skin.struct_size = sizeof p->skin;
    p->method = o->method;
    status = sph_io_open_rig(s->context, path, &options, &p->rig);
    if (status == SPH_OK) status = sph_io_rig_get_arrays(p->rig, &p->parts);
    if (status == SPH_OK) status = sph_skin_get_arrays(sph_io_rig_skin(p->rig), &p->skin);
    if (status == SPH_OK) status = sph_deformer_create(sph_io_rig_skin(p->rig), NULL, &p->deformer);
    return status == SPH_OK && o->correct.wanted ? posing_correct(s, p, &o->correct) : status;
}

/* What is written: corrected, or by one method alone. */
typedef struct written {
    posing *p;
    bool corrected;
    int32_t method;
    const char *mesh, *cache;
} written;

static sph_status pose_frame(const written *w, uint32_t frame, float *xyz, float *normals)
{
    return w->corrected ? posing_frame(w->p, frame, xyz, normals) : posing_blend(w->p, w->method, frame, xyz, normals);
}

static sph_status read_frame(void *user, uint32_t frame, float *xyz)
{
    return pose_frame(user, frame, xyz, NULL);
}

static double rate_of(const posing *p)
{
    return p->skin.clip_count > 0 && p->skin.clips[0].frames_per_second > 0 ? p->skin.clips[0].frames_per_second : 30;
}

static sph_status save_frames(session *s, const pose_options *o, written *w)
{
    posing *p = w->p;
    const sph_frame_source source = {w, read_frame, NULL};
    sph_animation *animation = NULL;
    sph_status status =
        sph_animation_create_from_source(s->context, p->skin.vertex_count, p->skin.frame_count, &source, &animation);
    if (status == SPH_OK) status = sph_animation_set_triangles(animation, p->skin.triangles, p->skin.triangle_count, 0);
    if (status == SPH_OK) status = sph_animation_set_edges(animation, p->parts.edges, p->parts.edge_count, 0);
    if (status == SPH_OK)
        status = o->mdd ? sph_io_save_obj_mdd(s->context, animation, 0, rate_of(p), w->mesh, w->cache)
                        : sph_io_save_obj_pc2(s->context, animation, 0, 1, w->mesh, w->cache);
    sph_animation_destroy(animation);
    return status;
}

static sph_status save_morphs(session *s, const written *w)
{
    posing *p = w->p;
    sph_status status;
    float *all = posing_frames(s, p, w->corrected && p->tracker != NULL, w->method, &status);
    const sph_io_frames frames = {.struct_size = sizeof frames,
                                  .vertex_count = p->skin.vertex_count,
                                  .frame_count = p->skin.frame_count,
                                  .positions = all,
                                  .triangle_count = p->skin.triangle_count,
                                  .triangles = p->skin.triangles,
                                  .frames_per_second = rate_of(p),
                                  .name = p->skin.clip_count > 0 ? p->skin.clips[0].name : NULL};
    if (status == SPH_OK) status = sph_io_save_frames_glb(s->context, &frames, w->mesh);
    sph_context_release(s->context, all);
    return status;
}

static sph_status save_frame(session *s, const written *w)
{
    const posing *p = w->p;
    const size_t n = p->skin.vertex_count;
    float *xyz = sph_context_allocate(s->context, n, 6 * sizeof *xyz), *normals = xyz == NULL ? NULL : xyz + 3 * n;
    sph_status status = xyz == NULL ? sph_context_fail(s->context, SPH_E_NOMEM, "out of memory") : SPH_OK;
    if (p->skin.triangle_count == 0) normals = NULL;
    if (status == SPH_OK) status = pose_frame(w, 0, xyz, normals);
    if (status == SPH_OK)
        status = sph_io_save_mesh(s->context, p->skin.vertex_count, xyz, normals, p->skin.triangle_count,
                                  p->skin.triangles, w->mesh);
    sph_context_release(s->context, xyz);
    return status;
}

static sph_status save(session *s, const pose_options *o, written *w)
{
    return o->single ? save_frame(s, w) : o->glb ? save_morphs(s, w) : save_frames(s, o, w);
}

/* "name-lbs.obj" of "name.obj"; free() it. NULL: out of memory. */
static char *beside_name(const char *name, const char *method)
{
    const char *ending = strrchr(name, '.');
    const size_t length = strlen(name) + strlen(method) + 2;
    char *out = malloc(length);
    if (out != NULL) snprintf(out, length, "%.*s-%s%s", (int)(ending - name), name, method, ending);
    return out;
}

/* The plain results of both methods. */
static sph_status save_beside(session *s, const pose_options *o, posing *p)
{
    sph_status status = SPH_OK;
    for (int32_t m = SPH_POSE_LINEAR; m <= SPH_POSE_DUAL_QUATERNION && status == SPH_OK; ++m) {
        char *mesh = beside_name(o->mesh, method_choices[m]);
        char *cache = o->cache == NULL ? NULL : beside_name(o->cache, method_choices[m]);
        written w = {p, false, m, mesh, cache};
        if (mesh == NULL || (o->cache != NULL && cache == NULL))
            status = sph_context_fail(s->context, SPH_E_NOMEM, "out of memory");
        if (status == SPH_OK) status = save(s, o, &w);
        free(mesh);
        free(cache);
    }
    return status;
}

/* Bones of the vertex that has most. */
static uint32_t most_influences(const sph_skin_arrays *a)
{
    uint32_t most = 1;
    for (size_t i = 0; i < (size_t)a->vertex_count * a->influence_count; ++i)
        if (a->weights[i] > 0 && i % a->influence_count >= most) most = (uint32_t)(i % a->influence_count) + 1;
    return most;
}

static void add_correction(json *j, const pose_options *o, const posing *p)
{
    uint32_t fields = 0;
    for (uint32_t b = 0; b < p->skin.bone_count; ++b) {
        sph_implicit_part part = {.struct_size = sizeof part};
        if (sph_implicit_get_part(p->implicit, b, &part) == SPH_OK && part.sample_count > 0) ++fields;
    }
    json_open(j, "implicit", '{');
    json_text(j, "operation", operation_choices[o->correct.operation]);
    json_integer(j, "fields", fields);
    json_integer(j, "joints", sph_implicit_joint_count(p->implicit));
    json_open(j, "frames", '[');
    for (uint32_t f = 0; f < p->skin.frame_count; ++f) {
        const sph_tracker_report *r = p->reports + f;
        json_open(j, NULL, '{');
        json_integer(j, "moved", r->moved);
        json_integer(j, "contacts", r->contacts);
        json_integer(j, "held_back", r->held_back);
        json_number(j, "farthest", r->farthest);
        if (o->correct.pairs) json_integer(j, "pairs_before", r->pairs_before);
        if (o->correct.pairs) json_integer(j, "pairs_after", r->pairs_after);
        json_close(j, '}');
    }
    json_close(j, ']');
    json_close(j, '}');
}

static void print_json(const pose_options *o, const posing *p)
{
    const sph_skin_arrays *a = &p->skin;
    json j;
    json_start(&j, stdout, false);
    json_open(&j, NULL, '{');
    json_text(&j, "mesh", o->mesh);
    if (o->cache != NULL) json_text(&j, "cache", o->cache);
    json_text(&j, "method", method_choices[o->method]);
    if (p->tracker != NULL) add_correction(&j, o, p);
    json_integer(&j, "vertices", a->vertex_count);
    json_integer(&j, "triangles", a->triangle_count);
    json_integer(&j, "frames", a->frame_count);
    json_integer(&j, "bones", a->bone_count);
    json_integer(&j, "influences", most_influences(a));
    json_open(&j, "clips", '[');
    for (uint32_t c = 0; c < a->clip_count; ++c) {
        json_open(&j, NULL, '{');
        json_text(&j, "name", a->clips[c].name);
        json_integer(&j, "first_frame", a->clips[c].first_frame);
        json_integer(&j, "frames", a->clips[c].frame_count);
        json_close(&j, '}');
    }
    json_close(&j, ']');
    json_boolean(&j, "moves_morph_targets", p->parts.morphs != 0);
    json_integer(&j, "bytes", file_size(o->mesh) + (o->cache == NULL ? 0 : file_size(o->cache)));
    json_integer(&j, "peak_rss_bytes", peak_memory());
    json_close(&j, '}');
    json_finish(&j);
}

static void print_correction(const pose_options *o, const posing *p)
{
    uint64_t contacts = 0, held_back = 0, before = 0, after = 0;
    for (uint32_t f = 0; f < p->skin.frame_count; ++f) {
        contacts += p->reports[f].contacts;
        held_back += p->reports[f].held_back;
        before += p->reports[f].pairs_before;
        after += p->reports[f].pairs_after;
    }
    printf("contacts:   %s vertices in all frames, %s held back\n", count_text(contacts), count_text(held_back));
    if (o->correct.pairs)
        printf("pairs:      %s triangles intersected before, %s after\n", count_text(before), count_text(after));
}

static void print_text(const pose_options *o, const posing *p)
{
    const sph_skin_arrays *a = &p->skin;
    printf("rig:        %s vertices, %s triangles, %s bones, %s influences per vertex at most\n",
           count_text(a->vertex_count), count_text(a->triangle_count), count_text(a->bone_count),
           count_text(most_influences(a)));
    printf("posed:      %s frames by %s%s\n", count_text(a->frame_count),
           o->method == SPH_POSE_LINEAR ? "linear blend skinning" : "dual quaternions",
           p->tracker == NULL ? "" : ", corrected by implicit skinning");
    if (p->tracker != NULL) print_correction(o, p);
    printf("wrote:      %s (%s)", o->mesh, size_text(file_size(o->mesh)));
    if (o->cache != NULL) printf(", %s (%s)", o->cache, size_text(file_size(o->cache)));
    putchar('\n');
}

static int pose(session *s, const void *options, const arguments *paths)
{
    const pose_options *o = options;
    const char *path = paths->items[0];
    posing p = {.rig = NULL};
    int result = DONE;
    sph_status status;
    progress_start(&s->progress, "reading");
    status = open_rig(s, o, path, &p);
    progress_end(&s->progress);
    if (status == SPH_OK && interrupted()) status = SPH_E_CANCELLED;
    if (status == SPH_OK) {
        progress_start(&s->progress, "posing");
        written w = {&p, true, p.method, o->mesh, o->cache};
        status = save(s, o, &w);
        if (status == SPH_OK && o->beside) status = save_beside(s, o, &p);
        progress_end(&s->progress);
    }
    if (status != SPH_OK)
        result = session_fail(s, status, NULL);
    else if (s->json)
        print_json(o, &p);
    else if (!s->quiet)
        print_text(o, &p);
    posing_close(s, &p);
    return result;
}

static int run(int argc, char **argv)
{
    pose_options o;
    arguments paths;
    const int result = session_run(parse(&o, argc, argv, &paths), &pose_command, &o.common, pose, &o, &paths);
    free(o.mesh);
    free(o.cache);
    return result;
}

const subcommand pose_command = {"pose", "pose the mesh of a rigged glTF", HELP, run};
