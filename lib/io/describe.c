/* SPDX-License-Identifier: MIT */
/* What files are, before anything of them is read. */
#include "io/io.h"

static sph_status describe(sph_context *context, const char *path, const sph__io_map *map, sph_io_description *out)
{
    sph__io_cache cache = {.map = *map};
    sph_status status = SPH_OK;
    out->format = sph__io_format_name(path, map);
    if (out->format == NULL)
        return sph__io_fail(context, SPH_E_UNSUPPORTED, "%s: not a format that is known", sph__io_shown(path));
    if (sph__io_cache_name(path, map) != out->format) return SPH_OK;
    status = sph__io_cache_interpret(context, path, &cache);
    out->point_count = cache.vertex_count;
    out->frame_count = cache.frame_count;
    return status;
}

sph_status sph_io_describe(sph_context *context, const char *path, sph_io_description *out)
{
    SPH__IO_OWN(context, sph_context_memory_used);
    sph_io_description found = {.struct_size = sizeof found};
    sph__io_names names = {.context = context};
    sph__io_map map = {NULL, 0};
    sph_status status;
    if (context == NULL || path == NULL || out == NULL)
        return sph_context_fail(context, SPH_E_INVALID, "sph_io_describe: an argument is NULL");
    status = sph__io_expand(&names, &path, 1);
    if (status == SPH_OK) status = sph__io_map_open(context, names.names[0], &map);
    if (status == SPH_OK) status = describe(context, names.names[0], &map, &found);
    found.file_count = (uint32_t)names.count;
    sph__io_map_close(&map);
    sph__io_names_release(&names);
    if (status == SPH_OK) *out = found;
    return status;
}
