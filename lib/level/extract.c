/* SPDX-License-Identifier: MIT */
/* Levels out of a hierarchy. */
#include "hierarchy/simplices.h"
#include "level/level.h"

static void copy_spheres(const sph_hierarchy *h, const sph__simplices *simplices, sph_level *level)
{
    const size_t s = h->stride, count = level->sphere_count;
    for (size_t i = 0; i < count; ++i) {
        const size_t node = simplices->nodes[i];
        const float *row = h->centers + node * 3 * s;
        for (size_t f = 0; f < h->frame_count; ++f) {
            float *center = level->centers + 3 * (f * count + i);
            center[0] = row[f];
            center[1] = row[s + f];
            center[2] = row[2 * s + f];
            if (h->radii_per_frame) level->radii[f * count + i] = h->radii[node * s + f];
        }
        if (!h->radii_per_frame) level->radii[i] = h->radii[node];
    }
}

/* For every vertex the sphere that holds it: from the youngest node down, each takes its parent's. */
static sph_status make_labels(const sph_hierarchy *h, uint32_t end, const sph__simplices *simplices, sph_level *level)
{
    uint32_t *places = sph__alloc(h->context, end, sizeof *places);
    if (places == NULL) return sph__fail_memory(h->context);
    for (uint32_t i = 0; i < level->sphere_count; ++i)
        places[simplices->nodes[i]] = i;
    for (uint32_t node = end; node-- > 0;)
        if (!sph__node_alive(h, node, end)) places[node] = places[h->parents[node]];
    memcpy(level->labels, places, h->vertex_count * sizeof *places);
    sph__free(h->context, places);
    return SPH_OK;
}

/* Node numbers to their places among `nodes`, ascending. */
static void renumber(const sph__simplices *simplices, const uint32_t *from, uint32_t *to, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        uint32_t low = 0, high = simplices->node_count;
        while (low < high) {
            const uint32_t middle = low + (high - low) / 2;
            if (simplices->nodes[middle] < from[i])
                low = middle + 1;
            else
                high = middle;
        }
        to[i] = low;
    }
}

sph_status sph_level_create(const sph_hierarchy *h, uint32_t sphere_count, sph_level **out)
{
    sph__simplices simplices;
    sph_level_arrays sizes;
    sph_level *level = NULL;
    uint32_t end;
    sph_status status;
    if (out == NULL) return SPH_E_INVALID;
    *out = NULL;
    if (h == NULL) return SPH_E_INVALID;
    if (sphere_count > h->vertex_count || sphere_count < h->vertex_count - h->collapse_count)
        return sph__fail(h->context, SPH_E_INVALID, "%u spheres: the hierarchy has levels from %u to %u", sphere_count,
                         h->vertex_count - h->collapse_count, h->vertex_count);
    end = h->vertex_count + (h->vertex_count - sphere_count);
    status = sph__simplices_jump(h, end, &simplices);
    if (status != SPH_OK) return status;
    sizes = (sph_level_arrays){.sphere_count = sphere_count,
                               .frame_count = h->frame_count,
                               .radii_per_frame = h->radii_per_frame,
                               .edge_count = simplices.edge_count,
                               .triangle_count = simplices.triangle_count,
                               .label_count = h->vertex_count};
    status = sph__level_allocate(h->context, &sizes, &level);
    if (status == SPH_OK) {
        copy_spheres(h, &simplices, level);
        renumber(&simplices, simplices.edges, level->edges, 2 * simplices.edge_count);
        renumber(&simplices, simplices.triangles, level->triangles, 3 * simplices.triangle_count);
        status = make_labels(h, end, &simplices, level);
    }
    sph__simplices_free(h->context, &simplices);
    if (status != SPH_OK) {
        sph_level_destroy(level);
        return status;
    }
    *out = level;
    return SPH_OK;
}
