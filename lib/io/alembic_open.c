/* SPDX-License-Identifier: MIT */
/* What the rest of libsphmesh-io sees of Alembic: an archive as frames, or its meshes in the first of them. */
#include <string.h>

#include "io/alembic.h"
#include "io/reader.h"

struct sph__io_abc {
    sph__abc_file file;
    sph__abc_objects objects;
    sph__abc_xform *xforms; /* above the chosen meshes; parents come first */
    size_t xform_count, xform_capacity;
    uint32_t *xform_of; /* of each object: the transform that it is or that is next above it */
    sph__abc_mesh *meshes;
    size_t mesh_count, mesh_capacity;
    sph__abc_frames frames;
};

void sph__io_abc_close(sph__io_abc *a)
{
    sph_context *context;
    if (a == NULL) return;
    context = a->file.context;
    sph__abc_frames_release(&a->file, &a->frames);
    sph_context_release(context, a->objects.items);
    sph_context_release(context, a->xforms);
    sph_context_release(context, a->xform_of);
    sph_context_release(context, a->meshes);
    sph__abc_file_close(&a->file);
    sph_context_release(context, a);
}

/* One more element at the end of an array; NULL when out of memory. */
static void *push(const sph__io_abc *a, void *array, size_t *count, size_t *capacity, size_t size)
{
    void *memory;
    memcpy(&memory, array, sizeof memory);
    if (!sph__io_reserve(a->file.context, &memory, capacity, *count + 1, size)) return NULL;
    memcpy(array, &memory, sizeof memory);
    return (char *)memory + size * (*count)++;
}

/* The transforms above an object, those farthest above first. */
static sph_status add_xforms(sph__io_abc *a, uint32_t object)
{
    uint32_t chain[SPH__ABC_DEPTH_MAX], depth = 0, above = SPH__ABC_NONE;
    for (uint32_t i = object; i != SPH__ABC_NONE && depth < SPH__ABC_DEPTH_MAX; i = a->objects.items[i].parent)
        chain[depth++] = i;
    while (depth-- > 0) {
        const uint32_t i = chain[depth];
        if (a->xform_of[i] == SPH__ABC_NONE && a->objects.items[i].kind == SPH__ABC_XFORM) {
            const uint32_t number = (uint32_t)a->xform_count;
            sph__abc_xform *x;
            sph_status status = sph__abc_charge(&a->file, 1, 2 * sizeof *x);
            if (status != SPH_OK) return status;
            x = push(a, &a->xforms, &a->xform_count, &a->xform_capacity, sizeof *x);
            if (x == NULL) return sph__io_fail_memory(a->file.context, a->file.path);
            status = sph__abc_read_xform(&a->file, &a->objects, i, x);
            if (status != SPH_OK) return status;
            x->parent = x->roots ? SPH__ABC_NONE : above;
            a->xform_of[i] = number;
        } else if (a->xform_of[i] == SPH__ABC_NONE) {
            a->xform_of[i] = above;
        }
        above = a->xform_of[i];
    }
    return SPH_OK;
}

static sph_status add_meshes(sph__io_abc *a)
{
    for (uint32_t i = 0; i < a->objects.count; ++i) {
        sph__abc_mesh *m;
        sph_status status;
        if (!a->objects.items[i].chosen) continue;
        if ((status = sph__abc_charge(&a->file, 1, 2 * sizeof *m)) != SPH_OK) return status;
        m = push(a, &a->meshes, &a->mesh_count, &a->mesh_capacity, sizeof *m);
        if (m == NULL) return sph__io_fail_memory(a->file.context, a->file.path);
        status = sph__abc_read_mesh(&a->file, &a->objects, i, m);
        if (status == SPH_OK) status = add_xforms(a, i);
        if (status != SPH_OK) return status;
        m->xform = a->xform_of[i];
    }
    return SPH_OK;
}

static sph_status read_objects(sph__io_abc *a, const char *object)
{
    sph__abc_file *f = &a->file;
    sph_status status = sph__abc_read_objects(f, &a->objects);
    if (status == SPH_OK) status = sph__abc_choose(f, &a->objects, object);
    if (status != SPH_OK) return status;
    a->xform_of = sph_context_allocate(f->context, a->objects.count, sizeof *a->xform_of);
    if (a->xform_of == NULL) return sph__io_fail_memory(f->context, f->path);
    for (size_t i = 0; i < a->objects.count; ++i)
        a->xform_of[i] = SPH__ABC_NONE;
    return add_meshes(a);
}

/*
 * Transforms that are above all chosen meshes, without anything between them and the archive that moves: what they do
 * is to place the whole in its scene, in units and axes of the scene. Where something is below them only at times they
 * stay.
 */
static void leave_placement_out(sph__io_abc *a)
{
    uint32_t shared[SPH__ABC_DEPTH_MAX], depth = 0, common;
    for (size_t i = 0; i < a->xform_count; ++i)
        if (a->xforms[i].switches) return;
    for (uint32_t x = a->meshes[0].xform; x != SPH__ABC_NONE && depth < SPH__ABC_DEPTH_MAX; x = a->xforms[x].parent)
        shared[depth++] = x;
    for (common = depth; common > 0 && !sph__abc_xform_moves(&a->xforms[shared[common - 1]]);)
        --common; /* shared[common] and on do not move */
    for (size_t i = 1; i < a->mesh_count; ++i) {
        uint32_t chain[SPH__ABC_DEPTH_MAX], length = 0, same = 0;
        for (uint32_t x = a->meshes[i].xform; x != SPH__ABC_NONE && length < SPH__ABC_DEPTH_MAX;
             x = a->xforms[x].parent)
            chain[length++] = x;
        while (same < length && same < depth && chain[length - 1 - same] == shared[depth - 1 - same])
            ++same;
        if (depth - same > common) common = depth - same;
    }
    for (uint32_t i = common; i < depth; ++i)
        a->xforms[shared[i]].placement = true;
}

static sph_status find_frames(sph__io_abc *a, double fps)
{
    sph__abc_file *f = &a->file;
    sph_status status = sph__abc_frames_start(f, &a->frames);
    if (status != SPH_OK) return status;
    for (size_t i = 0; i < a->mesh_count; ++i)
        sph__abc_frames_add(&a->frames, &a->meshes[i].positions);
    for (size_t i = 0; i < a->xform_count; ++i) {
        sph__abc_frames_add(&a->frames, &a->xforms[i].values);
        sph__abc_frames_add(&a->frames, &a->xforms[i].inherits);
    }
    return sph__abc_frames_finish(f, &a->frames, fps, sph__abc_time(&f->samplings[a->meshes[0].positions.sampling], 0));
}

static sph_status read_faces(sph__io_abc *a, sph__io_mesh *mesh)
{
    size_t vertices = 0;
    for (size_t i = 0; i < a->mesh_count; ++i) {
        sph__abc_mesh *m = &a->meshes[i];
        sph_status status;
        m->first_vertex = vertices;
        if (m->vertex_count > SPH__IO_INDEX_LIMIT - vertices)
            return sph__io_fail(a->file.context, SPH_E_LIMIT, "%s: more than 2^31 - 1 vertices",
                                sph__io_shown(a->file.path));
        vertices += m->vertex_count;
        if ((status = sph__abc_read_faces(&a->file, &a->objects, m, mesh)) != SPH_OK) return status;
    }
    if (vertices == 0)
        return sph__io_fail(a->file.context, SPH_E_FORMAT, "%s: its meshes have no vertices",
                            sph__io_shown(a->file.path));
    mesh->vertex_count = vertices;
    return SPH_OK;
}

/* Where a transform mirrors a mesh in the first frame, its triangles are turned, so that they face outward again. */
static sph_status turn_mirrored(sph__io_abc *a, sph__io_mesh *mesh)
{
    const sph_status status =
        sph__abc_pose(&a->file, a->xforms, a->xform_count, sph__abc_frame_time(&a->file, &a->frames, 0));
    for (size_t i = 0; status == SPH_OK && i < a->mesh_count; ++i) {
        const sph__abc_mesh *m = &a->meshes[i];
        uint32_t *t = mesh->triangles + 3 * m->first_triangle;
        if (m->xform == SPH__ABC_NONE || !(sph__io_determinant(a->xforms[m->xform].global.m) < 0)) continue;
        for (size_t k = 0; k < m->triangle_count; ++k, t += 3) {
            const uint32_t second = t[1];
            t[1] = t[2];
            t[2] = second;
        }
    }
    return status;
}

sph_status sph__io_abc_open(const char *path, const sph__io_map *map, double fps, const char *object, bool world,
                            sph__io_mesh *mesh, sph__io_abc **out)
{
    sph_context *context = mesh->context;
    sph__io_abc *a = sph_context_allocate(context, 1, sizeof *a);
    sph_status status;
    *out = NULL;
    if (a == NULL) return sph__io_fail_memory(context, path);
    *a = (sph__io_abc){.file.context = context};
    sph__io_mesh_start(mesh, 0, true);
    status = sph__abc_file_open(context, path, map, &a->file);
    if (status == SPH_OK) status = read_objects(a, object);
    if (status == SPH_OK && !world) leave_placement_out(a);
    if (status == SPH_OK) status = find_frames(a, fps);
    if (status == SPH_OK) status = read_faces(a, mesh);
    if (status == SPH_OK) status = turn_mirrored(a, mesh);
    if (status == SPH_OK)
        *out = a;
    else
        sph__io_abc_close(a);
    return status;
}

uint32_t sph__io_abc_frame_count(const sph__io_abc *a)
{
    return a->frames.count;
}

sph_status sph__io_abc_read(sph__io_abc *a, uint32_t frame, float *xyz)
{
    static const sph__io_affine NO_MATRIX = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
    const double time = sph__abc_frame_time(&a->file, &a->frames, frame);
    sph_status status = sph__abc_pose(&a->file, a->xforms, a->xform_count, time);
    for (size_t i = 0; i < a->mesh_count && status == SPH_OK; ++i) {
        const sph__abc_mesh *m = &a->meshes[i];
        status = sph__abc_read_positions(&a->file, m, time,
                                         m->xform == SPH__ABC_NONE ? &NO_MATRIX : &a->xforms[m->xform].global,
                                         xyz + 3 * m->first_vertex);
    }
    return status;
}

sph_status sph__io_read_abc(const char *path, const sph__io_map *map, sph__io_mesh *mesh, size_t *watched)
{
    sph__io_abc *a;
    sph_status status = sph__io_abc_open(path, map, 0, NULL, false, mesh, &a);
    if (watched != NULL) *watched = 0;
    if (status == SPH_OK) status = sph__io_reserve_vertices(mesh, path, mesh->vertex_count);
    if (status == SPH_OK) status = sph__io_abc_read(a, 0, mesh->positions);
    sph__io_abc_close(a);
    return status;
}
