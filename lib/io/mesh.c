/* SPDX-License-Identifier: MIT */
/* Meshes that grow while a file is read. */
#include "io/reader.h"

static sph_status grow(const sph__io_mesh *mesh, const char *path, void **memory, size_t *capacity, size_t need,
                       size_t size, const char *what)
{
    if (need > SPH__IO_INDEX_LIMIT)
        return sph__io_fail(mesh->context, SPH_E_LIMIT, "%s: more than 2^31 - 1 %s", sph__io_shown(path), what);
    if (!sph__io_reserve(mesh->context, memory, capacity, need, size)) return sph__io_fail_memory(mesh->context, path);
    return SPH_OK;
}

sph_status sph__io_reserve_vertices(sph__io_mesh *mesh, const char *path, size_t need)
{
    void *memory = mesh->positions;
    const sph_status status =
        grow(mesh, path, &memory, &mesh->vertex_capacity, need, 3 * sizeof *mesh->positions, "vertices");
    mesh->positions = memory;
    return status;
}

sph_status sph__io_reserve_triangles(sph__io_mesh *mesh, const char *path, size_t need)
{
    void *memory = mesh->triangles;
    const sph_status status =
        grow(mesh, path, &memory, &mesh->triangle_capacity, need, 3 * sizeof *mesh->triangles, "triangles");
    mesh->triangles = memory;
    return status;
}

sph_status sph__io_add_edge(sph__io_mesh *mesh, const char *path, uint32_t a, uint32_t b)
{
    void *memory = mesh->edges;
    const sph_status status =
        grow(mesh, path, &memory, &mesh->edge_capacity, mesh->edge_count + 1, 2 * sizeof *mesh->edges, "edges");
    mesh->edges = memory;
    if (status != SPH_OK) return status;
    mesh->edges[2 * mesh->edge_count] = a;
    mesh->edges[2 * mesh->edge_count + 1] = b;
    ++mesh->edge_count;
    return SPH_OK;
}

void sph__io_mesh_release(sph__io_mesh *mesh)
{
    sph_context_release(mesh->context, mesh->positions);
    sph_context_release(mesh->context, mesh->triangles);
    sph_context_release(mesh->context, mesh->edges);
    sph_context_release(mesh->context, mesh->corners);
    *mesh = (sph__io_mesh){.context = mesh->context};
}
