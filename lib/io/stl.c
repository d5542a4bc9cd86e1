/* SPDX-License-Identifier: MIT */
/* STL, text and binary. Normals, attributes and names are not used. */
#include <string.h>

#include "io/bytes.h"
#include "io/stl.h"

enum { HEADER_SIZE = 80, FIRST_TRIANGLE = 84, TRIANGLE_SIZE = 50, NORMAL_SIZE = 12, TRIANGLE_LIMIT = INT32_MAX / 3 };

/* Bytes of a binary file by the count in its header; the file holds that at least. */
static uint64_t binary_size(const sph__io_map *map)
{
    return FIRST_TRIANGLE + (uint64_t)TRIANGLE_SIZE * sph__io_load_32(map->bytes + HEADER_SIZE, false);
}

/* Some binary files begin with "solid" too: the size tells, or a zero that no text has. */
static bool is_binary(const sph__io_map *map)
{
    sph__io_text text = sph__io_text_of(NULL, "", map);
    if (map->size >= FIRST_TRIANGLE && binary_size(map) == map->size) return true;
    if (!sph__io_skip_empty_lines(&text)) return false;
    if (!sph__io_take_any_case(&text, "solid")) return true;
    return memchr(map->bytes, '\0', map->size < FIRST_TRIANGLE ? map->size : FIRST_TRIANGLE) != NULL;
}

static sph_status read_binary(const char *path, const sph__io_map *map, sph__io_mesh *mesh)
{
    size_t count;
    sph_status status;
    if (map->size < FIRST_TRIANGLE)
        return sph__io_fail(mesh->context, SPH_E_FORMAT,
                            "%s: ends at byte %zu: neither an STL text, which begins with solid, nor the header of a "
                            "binary one",
                            sph__io_shown(path), map->size);
    if (binary_size(map) > map->size)
        return sph__io_fail(mesh->context, SPH_E_FORMAT,
                            "%s: ends at byte %zu: as a binary STL file of %u triangles it would have %llu",
                            sph__io_shown(path), map->size, (unsigned)sph__io_load_32(map->bytes + HEADER_SIZE, false),
                            (unsigned long long)binary_size(map));
    count = sph__io_load_32(map->bytes + HEADER_SIZE, false);
    if (count > TRIANGLE_LIMIT)
        return sph__io_fail(mesh->context, SPH_E_LIMIT, "%s: more than %d triangles", sph__io_shown(path),
                            TRIANGLE_LIMIT);
    status = sph__io_reserve_vertices(mesh, path, 3 * count);
    if (status != SPH_OK) return status;
    for (size_t i = 0; i < count; ++i)
        for (size_t j = 0; j < 9; ++j)
            mesh->positions[9 * i + j] =
                sph__io_load_float(map->bytes + FIRST_TRIANGLE + i * TRIANGLE_SIZE + NORMAL_SIZE + 4 * j, false);
    mesh->vertex_count = 3 * count;
    if (binary_size(map) < map->size)
        sph_context_log(mesh->context, SPH_LOG_WARNING,
                        "an STL file is longer than its header says; the rest is left out");
    return SPH_OK;
}

/* --- text --- */

static bool take(sph__io_text *t, const char *word)
{
    return sph__io_skip_empty_lines(t) && sph__io_take_any_case(t, word);
}

static bool take_numbers(sph__io_text *t, float xyz[3])
{
    for (unsigned i = 0; i < 3; ++i) {
        sph__io_skip_blanks(t);
        if (!sph__io_text_float(t, &xyz[i])) return false;
    }
    return true;
}

/* After the word "facet". */
static sph_status read_facet(sph__io_text *t, sph__io_mesh *mesh)
{
    float xyz[3];
    if (!take(t, "normal") || !take_numbers(t, xyz)) return sph__io_text_fail(t, "not \"normal\" and three numbers");
    if (!take(t, "outer") || !take(t, "loop")) return sph__io_text_fail(t, "not \"outer loop\"");
    for (unsigned i = 0; i < 3; ++i) {
        sph_status status;
        if (!take(t, "vertex") || !take_numbers(t, xyz))
            return sph__io_text_fail(t, "not \"vertex\" and three numbers");
        if ((status = sph__io_add_vertex(mesh, t->path, xyz)) != SPH_OK) return status;
    }
    if (!take(t, "endloop")) return sph__io_text_fail(t, "not \"endloop\" after three vertices");
    if (!take(t, "endfacet")) return sph__io_text_fail(t, "not \"endfacet\"");
    return SPH_OK;
}

/* Solids, one or more; the rest of the line of "solid" and of "endsolid" is a name. */
static sph_status read_text(sph__io_text *t, sph__io_mesh *mesh)
{
    if (!sph__io_skip_empty_lines(t)) return sph__io_text_fail(t, "an empty file");
    do {
        if (!take(t, "solid")) return sph__io_text_fail(t, "not \"solid\"");
        sph__io_next_line(t);
        while (take(t, "facet")) {
            const sph_status status = read_facet(t, mesh);
            if (status != SPH_OK) return status;
        }
        if (!take(t, "endsolid")) return sph__io_text_fail(t, "not \"facet\" or \"endsolid\"");
        sph__io_next_line(t);
    } while (sph__io_skip_empty_lines(t));
    return SPH_OK;
}

sph_status sph__io_read_stl(const char *path, const sph__io_map *map, sph__io_mesh *mesh, size_t *watched)
{
    sph__io_text text = sph__io_text_of(mesh->context, path, map);
    const bool binary = is_binary(map);
    sph_status status;
    sph__io_mesh_start(mesh, 0, binary);
    if (watched != NULL) *watched = 0; /* triangles of a sequence are those of the first mesh */
    status = binary ? read_binary(path, map, mesh) : read_text(&text, mesh);
    if (status != SPH_OK) return status;
    if (mesh->vertex_count == 0)
        return sph__io_fail(mesh->context, SPH_E_FORMAT, "%s: an STL file without triangles", sph__io_shown(path));
    return sph__stl_weld(path, mesh);
}
