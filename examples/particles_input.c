/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "particles.h"

/* A mesh as a level: its vertices are spheres of radius zero, its triangles thick triangles without thickness. */
static sph_status level_of_mesh(sph_context *context, const sph_animation *mesh, sph_level **out)
{
    const uint32_t n = sph_animation_vertex_count(mesh), frames = sph_animation_frame_count(mesh);
    float *centers = sph_context_allocate(context, (size_t)n * frames, 3 * sizeof *centers);
    float *radii = sph_context_allocate(context, n, sizeof *radii);
    sph_status status = SPH_OK;
    if (centers == NULL || radii == NULL) status = sph_context_fail(context, SPH_E_NOMEM, "out of memory");
    for (uint32_t f = 0; f < frames && status == SPH_OK; ++f)
        status = sph_animation_read_frame(mesh, f, centers + 3 * (size_t)f * n);
    if (status == SPH_OK) {
        const sph_level_arrays a = {.struct_size = sizeof a,
                                    .sphere_count = n,
                                    .frame_count = frames,
                                    .centers = centers,
                                    .radii = radii,
                                    .triangle_count = sph_animation_triangle_count(mesh),
                                    .triangles = sph_animation_triangles(mesh)};
        memset(radii, 0, n * sizeof *radii);
        status = sph_level_create_from_arrays(context, &a, out);
    }
    sph_context_release(context, centers);
    sph_context_release(context, radii);
    return status;
}

sph_status collider_open(collider *c, sph_context *context, const char *name, const char *path, const char *cache)
{
    sph_animation *mesh = NULL;
    sph_status status;
    c->name = name;
    c->parts.struct_size = sizeof c->parts;
    if (cache == NULL) {
        status = sph_io_load_level(context, path, &c->level);
    } else {
        sph_io_open_options o;
        sph_io_open_options_init(&o, sizeof o);
        o.cache_path = cache;
        status = sph_io_open_animation(context, &path, 1, &o, &mesh);
        if (status == SPH_OK) status = level_of_mesh(context, mesh, &c->level);
        sph_animation_destroy(mesh);
    }
    if (status == SPH_OK) status = sph_level_get_arrays(c->level, &c->parts);
    return status == SPH_OK ? sph_query_create(c->level, NULL, &c->query) : status;
}

void collider_close(collider *c)
{
    sph_query_destroy(c->query);
    sph_level_destroy(c->level);
}
