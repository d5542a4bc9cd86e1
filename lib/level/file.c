/* SPDX-License-Identifier: MIT */
/* Levels in `.sphm` containers. */
#include "base/container.h"
#include "level/level.h"

enum { META_COUNT = 6 };

static const uint32_t META = SPH__TAG('M', 'E', 'T', 'A'), CENTERS = SPH__TAG('C', 'E', 'N', 'T'),
                      RADII = SPH__TAG('R', 'A', 'D', 'I'), EDGES = SPH__TAG('E', 'D', 'G', 'E'),
                      TRIANGLES = SPH__TAG('T', 'R', 'I', 'A'), LABELS = SPH__TAG('L', 'A', 'B', 'L');

static size_t center_count(const sph_level *level)
{
    return (size_t)level->sphere_count * level->frame_count * 3;
}

static size_t radius_count(const sph_level *level)
{
    return level->radii_per_frame ? (size_t)level->sphere_count * level->frame_count : level->sphere_count;
}

sph_status sph_level_write(const sph_level *level, sph_write_fn *write, void *user)
{
    SPH__OWN(level, SPH__LEVEL);
    if (level == NULL || write == NULL)
        return sph__fail(level == NULL ? NULL : level->context, SPH_E_INVALID, "sph_level_write: an argument is NULL");
    {
        const uint64_t meta[META_COUNT] = {level->sphere_count, level->frame_count,    level->radii_per_frame,
                                           level->edge_count,   level->triangle_count, level->label_count};
        const sph__chunk chunks[] = {{META, 8, meta, META_COUNT, 0, 0},
                                     {CENTERS, 4, level->centers, center_count(level), 0, 0},
                                     {RADII, 4, level->radii, radius_count(level), 0, 0},
                                     {EDGES, 4, level->edges, 2 * level->edge_count, 0, 0},
                                     {TRIANGLES, 4, level->triangles, 3 * level->triangle_count, 0, 0},
                                     {LABELS, 4, level->labels, level->label_count, 0, 0}};
        return sph__container_write(level->context, SPH__CONTAINER_LEVEL, chunks, sizeof chunks / sizeof *chunks, write,
                                    user);
    }
}

/* The counts, which must be those of the chunks: then no allocation is larger than the container. */
static sph_status read_meta(const sph__container *c, sph_level_arrays *a)
{
    uint64_t meta[META_COUNT], spheres;
    size_t centers, radii, edges, triangles, labels;
    sph_status status = sph__container_copy(c, META, 8, META_COUNT, meta);
    if (status != SPH_OK || (status = sph__container_count(c, CENTERS, 4, &centers)) != SPH_OK ||
        (status = sph__container_count(c, RADII, 4, &radii)) != SPH_OK ||
        (status = sph__container_count(c, EDGES, 4, &edges)) != SPH_OK ||
        (status = sph__container_count(c, TRIANGLES, 4, &triangles)) != SPH_OK ||
        (status = sph__container_count(c, LABELS, 4, &labels)) != SPH_OK)
        return status;
    if (meta[0] == 0 || meta[0] > UINT32_MAX || meta[1] == 0 || meta[1] > UINT32_MAX || meta[2] > 1)
        return sph__fail(c->context, SPH_E_FORMAT, "byte %zu: the counts are out of range",
                         sph__container_byte(c, META, 8, 0));
    spheres = meta[0] * meta[1]; /* of two 32-bit numbers */
    if (centers % 3 != 0 || centers / 3 != spheres || radii != (meta[2] ? spheres : meta[0]) || edges % 2 != 0 ||
        edges / 2 != meta[3] || triangles % 3 != 0 || triangles / 3 != meta[4] || labels != meta[5])
        return sph__fail(c->context, SPH_E_FORMAT, "byte %zu: the counts are not those of the chunks",
                         sph__container_byte(c, META, 8, 0));
    *a = (sph_level_arrays){.struct_size = sizeof *a,
                            .sphere_count = (uint32_t)meta[0],
                            .frame_count = (uint32_t)meta[1],
                            .radii_per_frame = (uint32_t)meta[2],
                            .edge_count = edges / 2,
                            .triangle_count = triangles / 3,
                            .label_count = labels};
    return SPH_OK;
}

static sph_status read_chunks(const sph__container *c, sph_level *level)
{
    sph_status status = sph__container_copy(c, CENTERS, 4, center_count(level), level->centers);
    if (status == SPH_OK) status = sph__container_copy(c, RADII, 4, radius_count(level), level->radii);
    if (status == SPH_OK) status = sph__container_copy(c, EDGES, 4, 2 * level->edge_count, level->edges);
    if (status == SPH_OK) status = sph__container_copy(c, TRIANGLES, 4, 3 * level->triangle_count, level->triangles);
    if (status == SPH_OK) status = sph__container_copy(c, LABELS, 4, level->label_count, level->labels);
    return status;
}

sph_status sph_level_read(sph_context *context, const void *bytes, size_t size, sph_level **out)
{
    SPH__OWN(context, SPH__CONTEXT);
    sph__container container;
    sph_level_arrays sizes;
    sph_level *level = NULL;
    sph_status status;
    if (out != NULL) *out = NULL;
    if (context == NULL || bytes == NULL || out == NULL)
        return sph__fail(context, SPH_E_INVALID, "sph_level_read: an argument is NULL");
    status = sph__container_open(context, bytes, size, SPH__CONTAINER_LEVEL, &container);
    if (status == SPH_OK) status = read_meta(&container, &sizes);
    if (status == SPH_OK) status = sph__level_allocate(context, &sizes, &level);
    if (status == SPH_OK) status = read_chunks(&container, level);
    if (status == SPH_OK) {
        status = sph__level_check(level);
        if (status == SPH_E_INVALID) status = SPH_E_FORMAT; /* the message stays */
    }
    if (status != SPH_OK) {
        sph_level_destroy(level);
        return status;
    }
    *out = level;
    return SPH_OK;
}
