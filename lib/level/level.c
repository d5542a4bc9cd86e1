/* SPDX-License-Identifier: MIT */
/* Levels made of the caller's arrays, and what every level can tell of itself. */
#include <math.h>

#include "level/level.h"

void sph_level_destroy(sph_level *level)
{
    SPH__OWN(level, SPH__LEVEL);
    sph_context *context;
    if (level == NULL) return;
    context = level->context;
    sph__free(context, level->centers);
    sph__free(context, level->radii);
    sph__free(context, level->edges);
    sph__free(context, level->triangles);
    sph__free(context, level->labels);
    sph__free(context, level);
    sph__context_release(context);
}

sph_status sph__level_allocate(sph_context *context, const sph_level_arrays *sizes, sph_level **out)
{
    sph_level *level;
    size_t spheres, coordinates, corners, ends;
    *out = NULL;
    if (!sph__multiply_size(sizes->sphere_count, sizes->frame_count, &spheres) ||
        !sph__multiply_size(spheres, 3, &coordinates) || !sph__multiply_size(sizes->triangle_count, 3, &corners) ||
        !sph__multiply_size(sizes->edge_count, 2, &ends))
        return sph__fail_memory(context);
    level = sph__new(context, sizeof *level, SPH__LEVEL);
    if (level == NULL) return sph__fail_memory(context);
    level->context = sph__context_retain(context);
    level->sphere_count = sizes->sphere_count;
    level->frame_count = sizes->frame_count;
    level->radii_per_frame = sizes->radii_per_frame;
    level->edge_count = sizes->edge_count;
    level->triangle_count = sizes->triangle_count;
    level->label_count = sizes->label_count;
    level->centers = sph__alloc(context, coordinates, sizeof *level->centers);
    level->radii = sph__alloc(context, sizes->radii_per_frame ? spheres : sizes->sphere_count, sizeof *level->radii);
    level->edges = sph__alloc(context, ends, sizeof *level->edges);
    level->triangles = sph__alloc(context, corners, sizeof *level->triangles);
    if (sizes->label_count != 0) level->labels = sph__alloc(context, sizes->label_count, sizeof *level->labels);
    if (level->centers == NULL || level->radii == NULL || level->edges == NULL || level->triangles == NULL ||
        (sizes->label_count != 0 && level->labels == NULL)) {
        sph_level_destroy(level);
        return sph__fail_memory(context);
    }
    *out = level;
    return SPH_OK;
}

static sph_status check_counts(const sph_context *context, const sph_level_arrays *a)
{
    if (a->struct_size != sizeof *a)
        return sph__fail(context, SPH_E_INVALID, "sph_level_arrays: struct_size is %u, not %zu",
                         (unsigned)a->struct_size, sizeof *a);
    if (a->sphere_count == 0 || a->frame_count == 0)
        return sph__fail(context, SPH_E_INVALID, "a level of %u spheres and %u frames: both must be above 0",
                         (unsigned)a->sphere_count, (unsigned)a->frame_count);
    if (a->radii_per_frame > 1)
        return sph__fail(context, SPH_E_INVALID, "radii_per_frame is %u, not 0 or 1", (unsigned)a->radii_per_frame);
    if (a->centers == NULL || a->radii == NULL || (a->edge_count != 0 && a->edges == NULL) ||
        (a->triangle_count != 0 && a->triangles == NULL) || (a->label_count != 0 && a->labels == NULL))
        return sph__fail(context, SPH_E_INVALID, "sph_level_arrays: an array is NULL");
    return SPH_OK;
}

static sph_status check_spheres(const sph_level *level)
{
    const size_t spheres = level->sphere_count, count = spheres * level->frame_count;
    for (size_t i = 0; i < 3 * count; ++i)
        if (!isfinite(level->centers[i]))
            return sph__fail(level->context, SPH_E_INVALID, "the centre of sphere %zu in frame %zu is not finite",
                             i / 3 % spheres, i / 3 / spheres);
    for (size_t i = 0; i < (level->radii_per_frame ? count : spheres); ++i)
        if (!isfinite(level->radii[i]) || level->radii[i] < 0)
            return sph__fail(level->context, SPH_E_INVALID, "the radius of sphere %zu in frame %zu is %g", i % spheres,
                             i / spheres, (double)level->radii[i]);
    return SPH_OK;
}

static sph_status check_indices(const sph_level *level)
{
    const uint32_t spheres = level->sphere_count;
    for (size_t i = 0; i < 2 * level->edge_count; ++i)
        if (level->edges[i] >= spheres)
            return sph__fail(level->context, SPH_E_INVALID, "edge %zu names sphere %u of %u", i / 2,
                             (unsigned)level->edges[i], (unsigned)spheres);
    for (size_t i = 0; i < 3 * level->triangle_count; ++i)
        if (level->triangles[i] >= spheres)
            return sph__fail(level->context, SPH_E_INVALID, "triangle %zu names sphere %u of %u", i / 3,
                             (unsigned)level->triangles[i], (unsigned)spheres);
    for (size_t i = 0; i < level->label_count; ++i)
        if (level->labels[i] >= spheres && level->labels[i] != SPH_NO_SPHERE)
            return sph__fail(level->context, SPH_E_INVALID, "label %zu names sphere %u of %u", i,
                             (unsigned)level->labels[i], (unsigned)spheres);
    return SPH_OK;
}

sph_status sph__level_check(const sph_level *level)
{
    const sph_status status = check_spheres(level);
    return status != SPH_OK ? status : check_indices(level);
}

static void copy(void *to, const void *from, size_t count, size_t size)
{
    if (count != 0) memcpy(to, from, count * size);
}

sph_status sph_level_create_from_arrays(sph_context *context, const sph_level_arrays *arrays, sph_level **out)
{
    SPH__OWN(context, SPH__CONTEXT);
    sph_level *level = NULL;
    sph_status status;
    size_t spheres;
    if (out != NULL) *out = NULL;
    if (context == NULL || arrays == NULL || out == NULL)
        return sph__fail(context, SPH_E_INVALID, "sph_level_create_from_arrays: an argument is NULL");
    if ((status = check_counts(context, arrays)) != SPH_OK) return status;
    if ((status = sph__level_allocate(context, arrays, &level)) != SPH_OK) return status;
    spheres = (size_t)arrays->sphere_count * arrays->frame_count; /* sph__level_allocate found that it fits */
    copy(level->centers, arrays->centers, 3 * spheres, sizeof(float));
    copy(level->radii, arrays->radii, arrays->radii_per_frame ? spheres : arrays->sphere_count, sizeof(float));
    copy(level->edges, arrays->edges, 2 * arrays->edge_count, sizeof(uint32_t));
    copy(level->triangles, arrays->triangles, 3 * arrays->triangle_count, sizeof(uint32_t));
    copy(level->labels, arrays->labels, arrays->label_count, sizeof(uint32_t));
    if ((status = sph__level_check(level)) != SPH_OK) {
        sph_level_destroy(level);
        return status;
    }
    *out = level;
    return SPH_OK;
}

sph_status sph_level_get_arrays(const sph_level *level, sph_level_arrays *arrays)
{
    SPH__OWN(level, SPH__LEVEL);
    if (level == NULL || arrays == NULL)
        return sph__fail(level == NULL ? NULL : level->context, SPH_E_INVALID,
                         "sph_level_get_arrays: an argument is NULL");
    if (arrays->struct_size != sizeof *arrays)
        return sph__fail(level->context, SPH_E_INVALID, "sph_level_arrays: struct_size is %u, not %zu",
                         (unsigned)arrays->struct_size, sizeof *arrays);
    *arrays = (sph_level_arrays){sizeof *arrays,        level->sphere_count, level->frame_count, level->radii_per_frame,
                                 level->centers,        level->radii,        level->edge_count,  level->edges,
                                 level->triangle_count, level->triangles,    level->label_count, level->labels};
    return SPH_OK;
}

uint32_t sph_level_sphere_count(const sph_level *level)
{
    SPH__OWN(level, SPH__LEVEL);
    return level == NULL ? 0 : level->sphere_count;
}

uint32_t sph_level_frame_count(const sph_level *level)
{
    SPH__OWN(level, SPH__LEVEL);
    return level == NULL ? 0 : level->frame_count;
}

const float *sph__level_centers(const sph_level *level, uint32_t frame)
{
    return level->centers + (size_t)frame * level->sphere_count * 3;
}

const float *sph__level_radii(const sph_level *level, uint32_t frame)
{
    return level->radii_per_frame ? level->radii + (size_t)frame * level->sphere_count : level->radii;
}
