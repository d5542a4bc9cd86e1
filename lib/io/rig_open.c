/* SPDX-License-Identifier: MIT */
/* The skinned mesh of a glTF as a skin, with its joints. */
#include <math.h>
#include <string.h>

#include "io/gltf.h"
#include "io/rig_open.h"

/* Poses of bones over all frames. */
enum { POSE_LIMIT = 1 << 24 };

/* What is gathered for the skin, and freed once it is there. */
typedef struct gathering {
    sph_io_rig *rig;
    sph__gltf_document *d;
    sph__io_gltf *g;
    sph__io_mesh mesh;
    sph_io_open_rig_options options;
    float *rest, *weights;
    uint32_t *bones, *links;
    double *transforms, *pivots;
    sph_skin_clip *clips;
    uint32_t clip_count, influence_count;
    size_t link_count;
    double share; /* of the call's progress */
} gathering;

static void release(gathering *a)
{
    sph_context *context = a->mesh.context;
    sph_context_release(context, a->rest);
    sph_context_release(context, a->weights);
    sph_context_release(context, a->bones);
    sph_context_release(context, a->links);
    sph_context_release(context, a->transforms);
    sph_context_release(context, a->pivots);
    sph_context_release(context, a->clips);
    sph__io_mesh_release(&a->mesh);
}

static sph_status allocate(gathering *a, size_t count, size_t size, void *out)
{
    void *memory = sph_context_allocate(a->mesh.context, count, size);
    if (memory == NULL) return sph__io_fail_memory(a->mesh.context, a->d->path);
    memcpy(out, &memory, sizeof memory);
    return SPH_OK;
}

/* Names of the bones' nodes, each once, as bones may share them. */
static sph_status read_names(gathering *a)
{
    sph_io_rig *rig = a->rig;
    sph_status status = allocate(a, a->g->node_count, sizeof *rig->node_names, &rig->node_names);
    if (status == SPH_OK) status = allocate(a, rig->bone_count, sizeof *rig->names, &rig->names);
    if (status != SPH_OK) return status;
    rig->name_count = a->g->node_count;
    memset(rig->node_names, 0, rig->name_count * sizeof *rig->node_names);
    for (uint32_t b = 0; b < rig->bone_count && status == SPH_OK; ++b) {
        const uint32_t node = a->g->bones[b].node;
        uint32_t name;
        if (rig->node_names[node] == NULL) {
            status = sph__gltf_get_kind(a->d, a->d->lists[SPH__GLTF_NODES].values[node], "name", '"', &name);
            if (status == SPH_OK && name != 0)
                status = sph__gltf_copy_text(a->d, name, &rig->node_names[node]);
            else if (status == SPH_OK && (rig->node_names[node] = sph__io_copy_string(rig->context, "")) == NULL)
                status = sph__io_fail_memory(rig->context, a->d->path);
        }
        rig->names[b] = rig->node_names[node];
    }
    return status;
}

/* Who hangs on whom: nodes in their order, parents first, pass on the nearest bone above them. */
static sph_status find_parents(gathering *a)
{
    const sph__io_gltf *g = a->g;
    sph_io_rig *rig = a->rig;
    uint32_t *own = NULL, *above = NULL;
    sph_status status = allocate(a, g->node_count, sizeof *own, &own);
    if (status != SPH_OK) return status;
    status = allocate(a, g->node_count, sizeof *above, &above);
    for (uint32_t i = 0; i < g->node_count && status == SPH_OK; ++i)
        own[i] = SPH_NO_JOINT;
    for (uint32_t b = rig->bone_count; b-- > 0 && status == SPH_OK;)
        own[g->bones[b].node] = b;
    for (uint32_t i = 0; i < g->node_count && status == SPH_OK; ++i) {
        const uint32_t node = g->order[i], parent = g->nodes[node].parent;
        above[node] = parent == SPH__GLTF_NONE      ? SPH_NO_JOINT
                      : own[parent] != SPH_NO_JOINT ? own[parent]
                                                    : above[parent];
    }
    for (uint32_t b = 0; b < rig->bone_count && status == SPH_OK; ++b) {
        rig->nodes[b] = g->bones[b].node;
        rig->parents[b] = above[g->bones[b].node];
        if (rig->parents[b] == SPH_NO_JOINT) continue;
        a->links[2 * a->link_count] = b;
        a->links[2 * a->link_count++ + 1] = rig->parents[b];
    }
    sph_context_release(a->mesh.context, own);
    sph_context_release(a->mesh.context, above);
    return status;
}

/* Where the joint is in the rest pose: the point that its inverse bind matrix takes to its origin. */
static void find_pivot(const double m[12], double pivot[3])
{
    double columns[3][3], determinant = 0; /* of the cofactors */
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) {
            const int i = (r + 1) % 3, k = (r + 2) % 3, j = (c + 1) % 3, l = (c + 2) % 3;
            columns[c][r] = m[4 * i + j] * m[4 * k + l] - m[4 * i + l] * m[4 * k + j];
        }
    for (int r = 0; r < 3; ++r)
        determinant += m[4 * r] * columns[0][r];
    for (int c = 0; c < 3; ++c) {
        const double x = -(columns[c][0] * m[3] + columns[c][1] * m[7] + columns[c][2] * m[11]) / determinant;
        pivot[c] = isfinite(x) ? x : 0; /* a joint that takes all to a plane is nowhere */
    }
}

static sph_status gather_bones(gathering *a)
{
    const size_t count = a->g->bone_count;
    sph_io_rig *rig = a->rig;
    sph_status status;
    rig->bone_count = (uint32_t)count;
    status = allocate(a, count, sizeof *rig->nodes, &rig->nodes);
    if (status == SPH_OK) status = allocate(a, count, sizeof *rig->parents, &rig->parents);
    if (status == SPH_OK) status = allocate(a, count, 12 * sizeof(double), &rig->inverse_bind);
    if (status == SPH_OK) status = allocate(a, count, 12 * sizeof(double), &rig->joints_rest);
    if (status == SPH_OK) status = allocate(a, count, 3 * sizeof(double), &a->pivots);
    if (status == SPH_OK) status = allocate(a, count, 2 * sizeof(uint32_t), &a->links);
    if (status == SPH_OK) status = read_names(a);
    if (status == SPH_OK) status = find_parents(a);
    for (size_t b = 0; b < count && status == SPH_OK; ++b) {
        const sph__gltf_bone *bone = &a->g->bones[b];
        memcpy(rig->inverse_bind + 12 * b, bone->bind.m, sizeof bone->bind.m);
        memcpy(rig->joints_rest + 12 * b, a->g->globals[bone->node].m, sizeof bone->bind.m);
        find_pivot(bone->bind.m, a->pivots + 3 * b);
    }
    return status;
}

/* The scene must be at rest. */
static sph_status gather_vertices(gathering *a)
{
    const sph__io_gltf *g = a->g;
    const size_t n = g->vertex_count;
    size_t k = 1;
    sph_status status;
    for (size_t v = 0; v < n; ++v)
        if (g->first_influence[v + 1] - g->first_influence[v] > k)
            k = g->first_influence[v + 1] - g->first_influence[v];
    a->influence_count = (uint32_t)k;
    status = sph__gltf_allocate(a->d, n, 3 * sizeof *a->rest, &a->rest);
    if (status == SPH_OK) status = sph__gltf_allocate(a->d, n, k * sizeof *a->weights, &a->weights);
    if (status == SPH_OK) status = sph__gltf_allocate(a->d, n, k * sizeof *a->bones, &a->bones);
    if (status != SPH_OK) return status;
    memcpy(a->rest, sph__gltf_morph(a->g), 3 * n * sizeof *a->rest);
    for (size_t v = 0; v < n; ++v)
        for (size_t s = 0; s < k; ++s) {
            const size_t i = g->first_influence[v] + s;
            const bool used = i < g->first_influence[v + 1];
            a->weights[v * k + s] = used ? g->influences[i].weight : 0;
            a->bones[v * k + s] = used ? g->influences[i].bone : 0;
        }
    return status;
}

/* How many of the frames first, first + step, ... below `end` are below `limit`. */
static uint32_t count_below(const sph_io_open_rig_options *o, uint32_t end, uint32_t limit)
{
    const uint32_t stop = end < limit ? end : limit;
    return stop <= o->first_frame ? 0 : (stop - o->first_frame - 1) / o->frame_step + 1;
}

/* Which frames, and which of them belong to which clip. */
static sph_status choose_frames(gathering *a)
{
    const sph__io_gltf *g = a->g;
    const sph_io_open_rig_options *o = &a->options;
    const uint32_t end = o->end_frame == 0 ? g->frame_count : o->end_frame;
    sph_status status;
    if (o->first_frame >= g->frame_count || end > g->frame_count)
        return sph__io_fail(a->mesh.context, SPH_E_INVALID, "%s: frames %u to before %u are asked for, but there %s %u",
                            sph__io_shown(a->d->path), (unsigned)o->first_frame, (unsigned)end,
                            g->frame_count == 1 ? "is" : "are", (unsigned)g->frame_count);
    a->rig->frame_count = count_below(o, end, end);
    if ((uint64_t)a->rig->frame_count * g->bone_count > POSE_LIMIT)
        return sph__io_fail(a->mesh.context, SPH_E_LIMIT, "%s: %u frames of %zu bones are more than %d poses of bones",
                            sph__io_shown(a->d->path), (unsigned)a->rig->frame_count, g->bone_count, POSE_LIMIT);
    if ((status = allocate(a, g->run_count, sizeof *a->clips, &a->clips)) != SPH_OK) return status;
    for (uint32_t r = 0; r < g->run_count; ++r) {
        const sph__gltf_run *run = &g->runs[r];
        const uint32_t first = count_below(o, end, run->first_frame);
        const uint32_t last = count_below(o, end, run->first_frame + run->frame_count);
        if (last == first) continue;
        a->clips[a->clip_count++] =
            (sph_skin_clip){g->clips[run->clip].name, first, last - first, g->fps / o->frame_step};
        for (size_t c = run->first_channel; c < run->first_channel + run->channel_count; ++c)
            if (g->channels[c].path == SPH__GLTF_WEIGHTS) a->rig->morphs = 1;
    }
    if (a->rig->morphs)
        sph_context_log(a->mesh.context, SPH_LOG_WARNING,
                        "a clip of a glTF moves morph targets, which a skin does not know of: they stay at rest");
    return SPH_OK;
}

static sph_status gather_frames(gathering *a)
{
    const size_t count = a->g->bone_count;
    sph_io_rig *rig = a->rig;
    sph_status status = choose_frames(a);
    if (status == SPH_OK) status = allocate(a, rig->frame_count * count, 12 * sizeof(double), &rig->joints);
    if (status == SPH_OK) status = allocate(a, rig->frame_count * count, 12 * sizeof(double), &a->transforms);
    for (uint32_t f = 0; f < rig->frame_count && status == SPH_OK; ++f) {
        status = sph_context_report_progress(rig->context, "reading poses", a->share * f / rig->frame_count);
        sph__gltf_pose_frame(a->g, a->options.first_frame + f * a->options.frame_step);
        for (size_t b = 0; b < count; ++b) {
            const size_t at = 12 * (f * count + b);
            memcpy(rig->joints + at, a->g->globals[a->g->bones[b].node].m, sizeof a->g->palette->m);
            memcpy(a->transforms + at, a->g->palette[b].m, sizeof a->g->palette->m);
        }
    }
    return status;
}

static sph_status make_skin(gathering *a)
{
    const sph_skin_arrays arrays = {.struct_size = sizeof arrays,
                                    .vertex_count = (uint32_t)a->g->vertex_count,
                                    .bone_count = a->rig->bone_count,
                                    .influence_count = a->influence_count,
                                    .frame_count = a->rig->frame_count,
                                    .clip_count = a->clip_count,
                                    .rest = a->rest,
                                    .bones = a->bones,
                                    .weights = a->weights,
                                    .transforms = a->transforms,
                                    .clips = a->clips,
                                    .pivots = a->pivots,
                                    .triangle_count = a->mesh.triangle_count,
                                    .triangles = a->mesh.triangles,
                                    .link_count = a->link_count,
                                    .links = a->links};
    return sph_skin_create_from_arrays(a->mesh.context, &arrays, &a->rig->skin);
}

static sph_status gather(gathering *a)
{
    sph_status status;
    sph__gltf_pose(a->g, NULL, 0);
    status = gather_vertices(a);
    if (status == SPH_OK) status = gather_bones(a);
    if (status == SPH_OK) status = gather_frames(a);
    if (status == SPH_OK) status = make_skin(a);
    if (status != SPH_OK) return status;
    a->rig->edge_count = a->mesh.edge_count;
    a->rig->edges = a->mesh.edges;
    a->mesh.edges = NULL;
    return SPH_OK;
}

sph_status sph__io_rig_read(sph__gltf_document *d, const sph_io_open_rig_options *options, double share,
                            sph__io_gltf **scene, sph_io_rig **out)
{
    gathering a = {.mesh.context = d->context, .d = d, .options = *options, .share = share};
    sph_status status = SPH_OK;
    *out = a.rig = sph_context_allocate(d->context, 1, sizeof *a.rig);
    *scene = NULL;
    if (a.rig == NULL) return sph__io_fail_memory(d->context, d->path);
    *a.rig = (sph_io_rig){.context = d->context};
    SPH__IO_SET_MARK(a.rig, SPH__IO_RIG);
    status = sph__gltf_open_scene(d, a.options.fps, a.options.clip, &a.mesh, &a.g);
    *scene = a.g;
    if (status == SPH_OK) status = gather(&a);
    release(&a);
    return status;
}

sph_status sph__io_rig_map(sph_context *context, const char *path, sph__io_map *map, sph__gltf_document *d)
{
    sph__io_read_fn *read;
    sph_status status = sph__io_map_open(context, path, map);
    *d = (sph__gltf_document){.context = context};
    if (status != SPH_OK) return status;
    status = sph__io_find_reader(context, path, map, &read);
    if (status == SPH_OK && read != sph__io_read_gltf)
        status = sph__io_fail(context, SPH_E_UNSUPPORTED, "%s is no glTF: only these hold rigs that are read",
                              sph__io_shown(path));
    if (status == SPH_OK) status = sph__gltf_document_open(context, path, map, d);
    if (status != SPH_OK) sph__io_map_close(map);
    return status;
}

sph_status sph_io_open_rig(sph_context *context, const char *path, const sph_io_open_rig_options *options,
                           sph_io_rig **out)
{
    SPH__IO_OWN(context, sph_context_memory_used);
    sph_io_open_rig_options chosen;
    sph__io_gltf *scene = NULL;
    sph__gltf_document d;
    sph_io_rig *rig = NULL;
    sph__io_map map;
    sph_status status;
    if (out != NULL) *out = NULL;
    if (context == NULL || path == NULL || out == NULL)
        return sph_context_fail(context, SPH_E_INVALID, "sph_io_open_rig: an argument is NULL");
    if ((status = sph__io_rig_read_options(context, options, &chosen)) != SPH_OK) return status;
    if ((status = sph__io_rig_map(context, path, &map, &d)) != SPH_OK) return status;
    status = sph__io_rig_read(&d, &chosen, 1, &scene, &rig);
    sph__io_gltf_close(scene);
    sph__gltf_document_close(&d);
    sph__io_map_close(&map);
    if (status != SPH_OK) {
        sph_io_rig_destroy(rig);
        return status;
    }
    *out = rig;
    return SPH_OK;
}
