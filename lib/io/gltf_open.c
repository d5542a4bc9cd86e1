/* SPDX-License-Identifier: MIT */
/* What the rest of libsphmesh-io sees of glTF: a file as frames, its clips, or its mesh at rest. */
#include <math.h>
#include <string.h>

#include "io/gltf.h"

void sph__io_gltf_close(sph__io_gltf *g)
{
    sph_context *context;
    if (g == NULL) return;
    context = g->context;
    for (uint32_t i = 0; i < g->clip_count; ++i)
        sph_context_release(context, g->clips[i].name);
    for (size_t i = 0; i < g->channel_count; ++i) {
        sph_context_release(context, g->channels[i].times);
        sph_context_release(context, g->channels[i].values);
    }
    sph_context_release(context, g->nodes);
    sph_context_release(context, g->order);
    sph_context_release(context, g->drawn);
    sph_context_release(context, g->globals);
    sph_context_release(context, g->bones);
    sph_context_release(context, g->palette);
    sph_context_release(context, g->skin_bones);
    sph_context_release(context, g->weights_rest);
    sph_context_release(context, g->weights);
    for (size_t i = 0; i < g->part_count; ++i)
        sph_context_release(context, g->parts[i].used);
    sph_context_release(context, g->parts);
    sph_context_release(context, g->positions);
    sph_context_release(context, g->morphed);
    sph_context_release(context, g->first_influence);
    sph_context_release(context, g->influences);
    sph_context_release(context, g->targets);
    sph_context_release(context, g->deltas);
    sph_context_release(context, g->clips);
    sph_context_release(context, g->runs);
    sph_context_release(context, g->channels);
    sph_context_release(context, g);
}

static sph_status create(sph__gltf_document *d, sph__io_gltf **out)
{
    *out = sph_context_allocate(d->context, 1, sizeof **out);
    if (*out == NULL) return sph__io_fail_memory(d->context, d->path);
    **out = (sph__io_gltf){.context = d->context};
    return SPH_OK;
}

/* The mesh's positions become those of the scene at rest, before nodes move them. */
static sph_status take_positions(sph__gltf_document *d, sph__io_gltf *g, sph__io_mesh *mesh)
{
    g->positions = mesh->positions;
    mesh->positions = NULL;
    mesh->vertex_capacity = 0;
    if (g->target_count == 0) return SPH_OK;
    return sph__gltf_allocate(d, g->vertex_count, 3 * sizeof(float), &g->morphed);
}

/* Mesh and nodes. The arrays of the mesh are made anew: what it holds is counted against the file's limit. */
static sph_status read_scene(sph__gltf_document *d, sph__io_gltf *g, sph__io_mesh *mesh)
{
    sph_status status;
    sph__io_mesh_release(mesh);
    status = sph__gltf_read_nodes(d, g);
    if (status == SPH_OK) status = sph__gltf_read_meshes(d, g, mesh);
    if (status == SPH_OK) status = take_positions(d, g, mesh);
    return status;
}

sph_status sph__gltf_open_scene(sph__gltf_document *d, double fps, const char *clip, sph__io_mesh *mesh,
                                sph__io_gltf **out)
{
    sph_status status = create(d, out);
    if (status == SPH_OK) status = read_scene(d, *out, mesh);
    if (status == SPH_OK) {
        (*out)->fps = fps;
        status = sph__gltf_read_clips(d, *out);
    }
    return status == SPH_OK ? sph__gltf_choose_clips(d, *out, clip) : status;
}

sph_status sph__io_gltf_open(const char *path, const sph__io_map *map, double fps, const char *clip, sph__io_mesh *mesh,
                             sph__io_gltf **out)
{
    sph__gltf_document d;
    sph_status status = sph__gltf_document_open(mesh->context, path, map, &d);
    *out = NULL;
    if (status != SPH_OK) return status;
    status = sph__gltf_open_scene(&d, fps, clip, mesh, out);
    sph__gltf_document_close(&d);
    if (status == SPH_OK) return SPH_OK;
    sph__io_gltf_close(*out);
    *out = NULL;
    return status;
}

uint32_t sph__io_gltf_frame_count(const sph__io_gltf *g)
{
    return g->frame_count;
}

void sph__gltf_pose_frame(sph__io_gltf *g, uint32_t frame)
{
    uint32_t i = 0;
    if (g->run_count == 0) {
        sph__gltf_pose(g, NULL, 0);
    } else {
        while (i + 1 < g->run_count && g->runs[i + 1].first_frame <= frame)
            ++i;
        sph__gltf_pose(g, &g->runs[i],
                       fmin((frame - g->runs[i].first_frame) / g->fps, g->clips[g->runs[i].clip].duration));
    }
}

void sph__io_gltf_read(sph__io_gltf *g, uint32_t frame, float *xyz)
{
    sph__gltf_pose_frame(g, frame);
    sph__gltf_skin(g, xyz);
}

sph_status sph__io_read_gltf(const char *path, const sph__io_map *map, sph__io_mesh *mesh, size_t *watched)
{
    sph__gltf_document d;
    sph__io_gltf *g = NULL;
    sph_status status = sph__gltf_document_open(mesh->context, path, map, &d);
    if (watched != NULL) *watched = 0;
    if (status != SPH_OK) return status;
    if ((status = create(&d, &g)) == SPH_OK) status = read_scene(&d, g, mesh);
    if (status == SPH_OK) {
        mesh->positions = sph_context_allocate(mesh->context, g->vertex_count, 3 * sizeof(float));
        if (mesh->positions == NULL) status = sph__io_fail_memory(mesh->context, path);
    }
    if (status == SPH_OK) {
        mesh->vertex_capacity = g->vertex_count;
        sph__gltf_pose(g, NULL, 0);
        sph__gltf_skin(g, mesh->positions);
    }
    sph__io_gltf_close(g);
    sph__gltf_document_close(&d);
    return status;
}

static sph_status list_clips(sph_context *context, const char *path, const sph__io_map *map, double fps,
                             sph_io_clip_fn *visit, void *user)
{
    sph__gltf_document d;
    sph__io_gltf *g = NULL;
    sph_status status = sph__gltf_document_open(context, path, map, &d);
    if (status != SPH_OK) return status;
    if ((status = create(&d, &g)) == SPH_OK) status = sph__gltf_read_clips(&d, g);
    for (uint32_t i = 0; status == SPH_OK && i < g->clip_count; ++i) {
        const sph_io_clip clip = {sizeof clip, sph__gltf_frames_of(&g->clips[i], fps), g->clips[i].name,
                                  g->clips[i].duration};
        visit(user, &clip);
    }
    sph__io_gltf_close(g);
    sph__gltf_document_close(&d);
    return status;
}

sph_status sph_io_list_clips(sph_context *context, const char *path, double fps, sph_io_clip_fn *visit, void *user)
{
    SPH__IO_OWN(context, sph_context_memory_used);
    sph__io_map map;
    sph__io_read_fn *read;
    sph_status status;
    if (context == NULL || path == NULL || visit == NULL || !isfinite(fps) || fps < 0)
        return sph_context_fail(context, SPH_E_INVALID,
                                "sph_io_list_clips: an argument is NULL, or the frames per second are no number");
    if ((status = sph__io_map_open(context, path, &map)) != SPH_OK) return status;
    status = sph__io_find_reader(context, path, &map, &read);
    if (status == SPH_OK && read == sph__io_read_gltf)
        status = list_clips(context, path, &map, fps == 0 ? SPH__IO_FPS : fps, visit, user);
    sph__io_map_close(&map);
    return status;
}
