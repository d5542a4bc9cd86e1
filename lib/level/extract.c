/* SPDX-License-Identifier: MIT */
/* Levels out of a hierarchy. */
#include "hierarchy/hierarchy.h"
#include "hierarchy/simplices.h"
#include "level/level.h"

enum { LEVEL_OPTIONS_V1 = offsetof(sph_level_options, labels) + sizeof(int32_t) };
_Static_assert(LEVEL_OPTIONS_V1 == 20, "a field of 0.1 moved");

static const sph_level_options DEFAULTS = {.struct_size = sizeof(sph_level_options), .labels = SPH_LABELS_VERTICES};

void sph_level_options_init(sph_level_options *options, size_t size)
{
    sph__options_init(options, size, &DEFAULTS, sizeof DEFAULTS, LEVEL_OPTIONS_V1);
}

/* The options over the defaults, with the number of frames resolved. */
static sph_status read_options(const sph_hierarchy *h, const sph_level_options *in, sph_level_options *o)
{
    sph_status status;
    *o = DEFAULTS;
    status = sph__options_read(h->context, "sph_level_options", in, o, sizeof *o, LEVEL_OPTIONS_V1);
    if (status != SPH_OK) return status;
    if (o->flags != 0) return sph__fail(h->context, SPH_E_INVALID, "sph_level_options: flags must be 0");
    if (o->labels < SPH_LABELS_VERTICES || o->labels > SPH_LABELS_NONE)
        return sph__fail(h->context, SPH_E_INVALID, "sph_level_options: labels %d is unknown", (int)o->labels);
    if (o->first_frame >= h->frame_count || o->frame_count > h->frame_count - o->first_frame)
        return sph__fail(h->context, SPH_E_INVALID, "%u frames from frame %u: the hierarchy has %u",
                         (unsigned)o->frame_count, (unsigned)o->first_frame, (unsigned)h->frame_count);
    if (o->frame_count == 0) o->frame_count = h->frame_count - o->first_frame;
    return SPH_OK;
}

/* From all frames of a sphere to all spheres of a frame, by so many frames that what is read stays in the cache. */
static void copy_spheres(const sph_hierarchy *h, const sph__simplices *simplices, size_t first, sph_level *level)
{
    enum { FRAMES = 16 };
    const size_t s = h->stride, count = level->sphere_count;
    for (size_t begin = 0; begin < level->frame_count; begin += FRAMES) {
        const size_t end = begin + FRAMES < level->frame_count ? begin + FRAMES : level->frame_count;
        for (size_t i = 0; i < count; ++i) {
            const size_t node = simplices->nodes[i];
            const float *row = h->centers + node * 3 * s + first;
            for (size_t f = begin; f < end; ++f) {
                float *center = level->centers + 3 * (f * count + i);
                center[0] = row[f];
                center[1] = row[s + f];
                center[2] = row[2 * s + f];
                if (h->radii_per_frame) level->radii[f * count + i] = h->radii[node * s + first + f];
            }
        }
    }
    for (size_t i = 0; i < count && !h->radii_per_frame; ++i)
        level->radii[i] = h->radii[simplices->nodes[i]];
}

/* For every vertex the sphere that holds it: from the youngest node down, each takes its parent's. */
static void make_labels(const sph_hierarchy *h, uint32_t end, uint32_t *places, sph_level *level)
{
    for (uint32_t node = end; node-- > 0;)
        if (!sph__node_alive(h->parents, node, end)) places[node] = places[h->parents[node]];
    memcpy(level->labels, places, h->vertex_count * sizeof *places);
}

/* Node numbers to their places. */
static void renumber(const sph__simplices *simplices, const uint32_t *from, uint32_t *to, size_t count)
{
    for (size_t i = 0; i < count; ++i)
        to[i] = simplices->places[from[i]];
}

static sph_status make_level(const sph_hierarchy *h, uint32_t end, const sph_level_options *o,
                             sph__simplices *simplices, sph_level **out)
{
    const sph_level_arrays sizes = {.sphere_count = simplices->node_count,
                                    .frame_count = o->frame_count,
                                    .radii_per_frame = h->radii_per_frame,
                                    .edge_count = simplices->edge_count,
                                    .triangle_count = simplices->triangle_count,
                                    .label_count = o->labels == SPH_LABELS_NONE ? 0 : h->vertex_count};
    const sph_status status = sph__level_allocate(h->context, &sizes, out);
    if (status != SPH_OK) return status;
    copy_spheres(h, simplices, o->first_frame, *out);
    renumber(simplices, simplices->edges, (*out)->edges, 2 * simplices->edge_count);
    renumber(simplices, simplices->triangles, (*out)->triangles, 3 * simplices->triangle_count);
    if (sizes.label_count != 0) make_labels(h, end, simplices->places, *out);
    return SPH_OK;
}

sph_status sph_level_extract(const sph_hierarchy *h, uint32_t sphere_count, const sph_level_options *options,
                             sph_level **out)
{
    SPH__OWN(h, SPH__HIERARCHY);
    sph__collapses collapses;
    sph__simplices simplices;
    sph_level_options o;
    uint32_t end;
    sph_status status;
    if (out == NULL) return SPH_E_INVALID;
    *out = NULL;
    if (h == NULL) return SPH_E_INVALID;
    status = read_options(h, options, &o);
    if (status != SPH_OK) return status;
    if (sphere_count > h->vertex_count || sphere_count < h->vertex_count - h->collapse_count)
        return sph__fail(h->context, SPH_E_INVALID, "%u spheres: the hierarchy has levels from %u to %u", sphere_count,
                         h->vertex_count - h->collapse_count, h->vertex_count);
    end = h->vertex_count + (h->vertex_count - sphere_count);
    collapses = sph__hierarchy_collapses(h);
    status = sph__simplices_jump(&collapses, end, &simplices);
    if (status != SPH_OK) return status;
    status = make_level(h, end, &o, &simplices, out);
    sph__simplices_free(h->context, &simplices);
    return status;
}

sph_status sph_level_create(const sph_hierarchy *h, uint32_t sphere_count, sph_level **out)
{
    SPH__OWN(h, SPH__HIERARCHY);
    return sph_level_extract(h, sphere_count, NULL, out);
}
