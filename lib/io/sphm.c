/* SPDX-License-Identifier: MIT */
/* Hierarchies and levels as files. What a .sphm container holds is the core's affair; here are files and endings. */
#include <string.h>

#include "io/io.h"

/* The header of a container, as docs/formats.md has it. */
enum { HEADER_SIZE = 32, MAJOR_AT = 8, KIND_AT = 12, MAJOR_VERSION = 1 };
static const unsigned char MAGIC[8] = {0x89, 'S', 'P', 'H', '\r', '\n', 0x1A, '\n'};

static sph_status write_bytes(void *user, const void *bytes, size_t size)
{
    sph__io_output *output = user;
    sph__io_output_bytes(output, bytes, size);
    return output->status;
}

/* Finishes, commits and releases, with the status of what was written. */
static sph_status close_output(sph__io_output *output, sph_status status)
{
    if (status == SPH_OK) status = sph__io_output_finish(output);
    if (status == SPH_OK) status = sph__io_output_commit(output);
    sph__io_output_release(output);
    return status;
}

/* The core does not know the file's name. */
static sph_status name_file(sph_context *context, const char *path, sph_status status)
{
    if (status != SPH_E_FORMAT && status != SPH_E_VERSION) return status;
    return sph__io_fail(context, status, "%s: %s", sph__io_shown(path), sph_context_last_message(context));
}

static sph_status check_arguments(sph_context *context, const void *handle, const char *path, const char *function)
{
    if (context != NULL && handle != NULL && path != NULL) return SPH_OK;
    return sph__io_fail(context, SPH_E_INVALID, "%s: an argument is NULL", function);
}

static sph_status identify(sph_context *context, const char *path, const sph__io_map *map, int32_t *kind)
{
    const unsigned char *p = map->bytes;
    uint32_t found;
    if (map->size < HEADER_SIZE || memcmp(p, MAGIC, sizeof MAGIC) != 0)
        return sph__io_fail(context, SPH_E_FORMAT, "%s: byte 0: not a .sphm file", sph__io_shown(path));
    if ((p[MAJOR_AT] | p[MAJOR_AT + 1] << 8) > MAJOR_VERSION)
        return sph__io_fail(context, SPH_E_VERSION, "%s: byte %d: version %d, this library reads %d",
                            sph__io_shown(path), MAJOR_AT, p[MAJOR_AT] | p[MAJOR_AT + 1] << 8, MAJOR_VERSION);
    found =
        p[KIND_AT] | (uint32_t)p[KIND_AT + 1] << 8 | (uint32_t)p[KIND_AT + 2] << 16 | (uint32_t)p[KIND_AT + 3] << 24;
    if (found < SPH_IO_HIERARCHY || found > SPH_IO_IMPLICIT)
        return sph__io_fail(context, SPH_E_FORMAT, "%s: byte %d: neither a hierarchy, a level nor fields but %u",
                            sph__io_shown(path), KIND_AT, (unsigned)found);
    *kind = (int32_t)found;
    return SPH_OK;
}

sph_status sph_io_identify(sph_context *context, const char *path, int32_t *kind)
{
    SPH__IO_OWN(context, sph_context_memory_used);
    sph__io_map map;
    sph_status status = check_arguments(context, kind, path, "sph_io_identify");
    if (status == SPH_OK) status = sph__io_map_open(context, path, &map);
    if (status != SPH_OK) return status;
    status = identify(context, path, &map, kind);
    sph__io_map_close(&map);
    return status;
}

sph_status sph_io_save_hierarchy(sph_context *context, const sph_hierarchy *hierarchy, const char *path)
{
    SPH__IO_OWN(context, sph_context_memory_used);
    SPH__IO_OWN(hierarchy, sph_hierarchy_vertex_count);
    sph__io_output output;
    sph_status status = check_arguments(context, hierarchy, path, "sph_io_save_hierarchy");
    if (status == SPH_OK) status = sph__io_output_open(context, path, &output);
    if (status != SPH_OK) return status;
    return close_output(&output, sph_hierarchy_write(hierarchy, write_bytes, &output));
}

sph_status sph_io_load_hierarchy(sph_context *context, const char *path, sph_hierarchy **out)
{
    SPH__IO_OWN(context, sph_context_memory_used);
    sph__io_map map;
    sph_status status = check_arguments(context, out, path, "sph_io_load_hierarchy");
    if (out != NULL) *out = NULL;
    if (status == SPH_OK) status = sph__io_map_open(context, path, &map);
    if (status != SPH_OK) return status;
    status = name_file(context, path, sph_hierarchy_read(context, map.bytes, map.size, out));
    sph__io_map_close(&map);
    return status;
}

sph_status sph_io_save_implicit(sph_context *context, const sph_implicit *implicit, const char *path)
{
    SPH__IO_OWN(context, sph_context_memory_used);
    sph__io_output output;
    sph_status status = check_arguments(context, implicit, path, "sph_io_save_implicit");
    if (status == SPH_OK) status = sph__io_output_open(context, path, &output);
    if (status != SPH_OK) return status;
    return close_output(&output, sph_implicit_write(implicit, write_bytes, &output));
}

sph_status sph_io_load_implicit(sph_context *context, const char *path, sph_implicit **out)
{
    SPH__IO_OWN(context, sph_context_memory_used);
    sph__io_map map;
    sph_status status = check_arguments(context, out, path, "sph_io_load_implicit");
    if (out != NULL) *out = NULL;
    if (status == SPH_OK) status = sph__io_map_open(context, path, &map);
    if (status != SPH_OK) return status;
    status = name_file(context, path, sph_implicit_read(context, map.bytes, map.size, out));
    sph__io_map_close(&map);
    return status;
}

/* How a level is written under a name; NULL where it is not known. */
static sph__io_level_write_fn *find_writer(const char *path)
{
    static const struct {
        const char *ending;
        sph__io_level_write_fn *write;
    } WRITERS[] = {{"json", sph__io_level_json_write},
                   {"obj", sph__io_level_obj_write},
                   {"ply", sph__io_level_ply_write},
                   {"glb", sph__io_level_glb_write}};
    for (size_t i = 0; i < sizeof WRITERS / sizeof *WRITERS; ++i)
        if (sph__io_has_ending(path, WRITERS[i].ending)) return WRITERS[i].write;
    return NULL;
}

sph_status sph_io_save_level(sph_context *context, const sph_level *level, const char *path)
{
    SPH__IO_OWN(context, sph_context_memory_used);
    SPH__IO_OWN(level, sph_level_sphere_count);
    sph__io_output output;
    sph_level_arrays arrays = {.struct_size = sizeof arrays};
    sph__io_level_write_fn *write;
    sph_status status = check_arguments(context, level, path, "sph_io_save_level");
    if (status != SPH_OK) return status;
    write = find_writer(path);
    if (write == NULL && !sph__io_has_ending(path, "sphm"))
        return sph__io_fail(context, SPH_E_UNSUPPORTED, "%s: levels are saved as .sphm, .json, .obj, .ply or .glb",
                            sph__io_shown(path));
    status = sph_level_get_arrays(level, &arrays);
    if (status == SPH_OK) status = sph__io_output_open(context, path, &output);
    if (status != SPH_OK) return status;
    if (write == NULL)
        status = sph_level_write(level, write_bytes, &output);
    else
        write(&output, &arrays);
    return close_output(&output, status);
}

sph_status sph_io_load_level(sph_context *context, const char *path, sph_level **out)
{
    SPH__IO_OWN(context, sph_context_memory_used);
    sph__io_map map;
    sph_status status = check_arguments(context, out, path, "sph_io_load_level");
    if (out != NULL) *out = NULL;
    if (status == SPH_OK) status = sph__io_map_open(context, path, &map);
    if (status != SPH_OK) return status;
    if (sph__io_has_ending(path, "sphm") || (map.size >= sizeof MAGIC && memcmp(map.bytes, MAGIC, sizeof MAGIC) == 0))
        status = name_file(context, path, sph_level_read(context, map.bytes, map.size, out));
    else if (sph__io_has_ending(path, "json"))
        status = sph__io_level_json_read(context, path, &map, out);
    else
        status =
            sph__io_fail(context, SPH_E_UNSUPPORTED, "%s: levels are read from .sphm or .json", sph__io_shown(path));
    sph__io_map_close(&map);
    return status;
}
