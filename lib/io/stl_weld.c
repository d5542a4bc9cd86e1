/* SPDX-License-Identifier: MIT */
/*
 * Corners become vertices: once, in the first mesh of a sequence. In the others nothing may decide anew what coincides,
 * as parts that touch in one frame would change the mesh.
 */
#include <stdio.h>
#include <string.h>

#include "io/stl.h"

#define NOBODY UINT32_MAX

/* The bits of a position, with one zero only. What is not finite is nothing special to them. */
static void read_key(const float *xyz, uint32_t key[3])
{
    for (unsigned i = 0; i < 3; ++i) {
        memcpy(&key[i], &xyz[i], sizeof key[i]);
        if (key[i] == UINT32_C(0x80000000)) key[i] = 0;
    }
}

static bool same(const float *a, const float *b)
{
    uint32_t key_a[3], key_b[3];
    read_key(a, key_a);
    read_key(b, key_b);
    return memcmp(key_a, key_b, sizeof key_a) == 0;
}

/* Every bit of the position moves every bit of this (the finisher of MurmurHash3, twice). */
static uint64_t hash(const float *xyz)
{
    uint32_t key[3];
    uint64_t h;
    read_key(xyz, key);
    h = ((uint64_t)key[0] << 32 | key[1]) * UINT64_C(0x9E3779B97F4A7C15);
    for (unsigned i = 0; i < 2; ++i) {
        h ^= h >> 33;
        h *= UINT64_C(0xFF51AFD7ED558CCD);
        h ^= i == 0 ? key[2] : h >> 33;
        h *= UINT64_C(0xC4CEB9FE1A85EC53);
    }
    return h ^ h >> 33;
}

/*
 * Numbers the different positions in the order of their first corners. `vertices` gets the number of each corner,
 * `firsts` the first corner of each number.
 */
static sph_status number_positions(const char *path, const sph__io_mesh *mesh, size_t corner_count, uint32_t *vertices,
                                   uint32_t *firsts, size_t *vertex_count)
{
    const float *xyz = mesh->positions;
    size_t slots = 64, count = 0;
    uint32_t *table;
    while (slots / 3 < corner_count / 2)
        slots *= 2;
    table = sph_context_allocate(mesh->context, slots, sizeof *table);
    if (table == NULL) return sph__io_fail_memory(mesh->context, path);
    memset(table, 0xFF, slots * sizeof *table);
    for (size_t c = 0; c < corner_count; ++c) {
        size_t slot = (size_t)hash(xyz + 3 * c) & (slots - 1);
        while (table[slot] != NOBODY && !same(xyz + 3 * c, xyz + 3 * (size_t)firsts[table[slot]]))
            slot = (slot + 1) & (slots - 1);
        if (table[slot] == NOBODY) {
            table[slot] = (uint32_t)count;
            firsts[count++] = (uint32_t)c;
        }
        vertices[c] = table[slot];
    }
    sph_context_release(mesh->context, table);
    *vertex_count = count;
    return SPH_OK;
}

/* Of a vertex's corners the first one gives its position. They come in order, so that none is overwritten too early. */
static void move_positions(sph__io_mesh *mesh, const uint32_t *firsts, size_t vertex_count)
{
    for (size_t v = 0; v < vertex_count; ++v)
        memmove(mesh->positions + 3 * v, mesh->positions + 3 * (size_t)firsts[v], 3 * sizeof *mesh->positions);
    mesh->vertex_count = vertex_count;
}

static sph_status weld_anew(const char *path, sph__io_mesh *mesh)
{
    const size_t corner_count = mesh->vertex_count;
    size_t vertex_count;
    sph_status status;
    sph_context_release(mesh->context, mesh->corners);
    mesh->corners = sph_context_allocate(mesh->context, corner_count, sizeof *mesh->corners);
    if (mesh->corners == NULL) return sph__io_fail_memory(mesh->context, path);
    status = number_positions(path, mesh, corner_count, mesh->triangles, mesh->corners, &vertex_count);
    if (status == SPH_OK) move_positions(mesh, mesh->corners, vertex_count);
    return status;
}

/*
 * Some corners of a vertex have come apart. Where that is all, it is the animation: a mouth that was closed. But where
 * such a corner now coincides with corners of another vertex, the triangles stand in another order.
 */
static sph_status check_order(const char *path, const sph__io_mesh *mesh, const uint32_t *vertices, size_t corner_count,
                              const unsigned char *apart, uint32_t *memory)
{
    uint32_t *numbers = memory, *owners = memory + corner_count; /* an owner: the vertex that a position belongs to */
    size_t count;
    const sph_status status = number_positions(path, mesh, corner_count, numbers, owners, &count);
    if (status != SPH_OK) return status;
    for (size_t i = 0; i < count; ++i)
        owners[i] = vertices[owners[i]];
    for (size_t c = 0; c < corner_count; ++c) {
        const uint32_t owner = owners[numbers[c]];
        if (owner == vertices[c] || !(apart[owner] || apart[vertices[c]])) continue;
        return sph__io_fail(mesh->context, SPH_E_FORMAT,
                            "%s: triangle %zu: its corners meet others than in the first mesh of the sequence: the "
                            "triangles are not the same, or in another order",
                            sph__io_shown(path), c / 3);
    }
    return SPH_OK;
}

static sph_status check_apart(const char *path, const sph__io_mesh *mesh, sph__io_mesh *to, size_t corner_count)
{
    const uint32_t *vertices = to->triangles, *firsts = to->corners;
    const float *xyz = mesh->positions;
    unsigned char *apart;
    uint32_t *memory;
    size_t c = 0;
    sph_status status = SPH_E_NOMEM;
    while (c < corner_count && same(xyz + 3 * c, xyz + 3 * (size_t)firsts[vertices[c]]))
        ++c;
    if (c == corner_count) return SPH_OK; /* all others are together still */
    apart = sph_context_allocate(mesh->context, to->vertex_count, 1);
    memory = sph_context_allocate(mesh->context, corner_count, 2 * sizeof *memory);
    if (apart != NULL && memory != NULL) {
        memset(apart, 0, to->vertex_count);
        for (; c < corner_count; ++c)
            apart[vertices[c]] |= !same(xyz + 3 * c, xyz + 3 * (size_t)firsts[vertices[c]]);
        status = check_order(path, mesh, vertices, corner_count, apart, memory);
    } else {
        status = sph__io_fail_memory(mesh->context, path);
    }
    sph_context_release(mesh->context, apart);
    sph_context_release(mesh->context, memory);
    if (status == SPH_OK && !to->apart) {
        char text[400];
        to->apart = true;
        snprintf(text, sizeof text,
                 "%s: corners that coincide in the first mesh of the sequence come apart: they stay one vertex",
                 sph__io_shown(path));
        sph_context_log(mesh->context, SPH_LOG_WARNING, text);
    }
    return status;
}

sph_status sph__stl_weld(const char *path, sph__io_mesh *mesh)
{
    const size_t corner_count = mesh->vertex_count;
    sph__io_mesh *to = mesh->to;
    sph_status status = sph__io_reserve_triangles(mesh, path, corner_count / 3);
    if (status != SPH_OK) return status;
    mesh->triangle_count = corner_count / 3;
    if (to == NULL || to->corners == NULL || to->triangle_count != mesh->triangle_count) return weld_anew(path, mesh);
    if ((status = check_apart(path, mesh, to, corner_count)) != SPH_OK) return status;
    memcpy(mesh->triangles, to->triangles, corner_count * sizeof *mesh->triangles);
    move_positions(mesh, to->corners, to->vertex_count);
    return SPH_OK;
}
