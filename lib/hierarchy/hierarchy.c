/* SPDX-License-Identifier: MIT */
#include <math.h>

#include "hierarchy/build.h"

enum { OPTIONS_V1 = offsetof(sph_hierarchy_options, importance_frame_stride) + sizeof(size_t), VERTEX_LIMIT = 1 << 30 };
_Static_assert(sizeof(void *) != 8 || OPTIONS_V1 == 56, "a field of 0.1 moved");

static const sph_hierarchy_options DEFAULTS = {.struct_size = sizeof(sph_hierarchy_options),
                                               .importance = SPH_IMPORTANCE_CURVATURE,
                                               .radius_mode = SPH_RADIUS_CONSTANT,
                                               .radius_factor = 0.75,
                                               .width_directions = 30,
                                               .orientation = SPH_ORIENTATION_OUTWARD};

void sph_hierarchy_options_init(sph_hierarchy_options *options, size_t size)
{
    sph__options_init(options, size, &DEFAULTS, sizeof DEFAULTS, OPTIONS_V1);
}

static sph_status check_options(const sph_context *context, const sph_hierarchy_options *o)
{
    if (o->flags != 0) return sph__fail(context, SPH_E_INVALID, "flags must be 0");
    if (o->importance < SPH_IMPORTANCE_NONE || o->importance > SPH_IMPORTANCE_CALLER)
        return sph__fail(context, SPH_E_INVALID, "importance %d is unknown", (int)o->importance);
    if (o->radius_mode < SPH_RADIUS_CONSTANT || o->radius_mode > SPH_RADIUS_ZERO)
        return sph__fail(context, SPH_E_INVALID, "radius_mode %d is unknown", (int)o->radius_mode);
    if (o->orientation < SPH_ORIENTATION_OUTWARD || o->orientation > SPH_ORIENTATION_AS_GIVEN)
        return sph__fail(context, SPH_E_INVALID, "orientation %d is unknown", (int)o->orientation);
    if (!(o->radius_factor >= 0) || isinf(o->radius_factor))
        return sph__fail(context, SPH_E_INVALID, "radius_factor must be finite and >= 0");
    if (!(o->temporal_coherence >= 0) || isinf(o->temporal_coherence))
        return sph__fail(context, SPH_E_INVALID, "temporal_coherence must be finite and >= 0");
    if (o->width_directions < 3 || o->width_directions > 1024)
        return sph__fail(context, SPH_E_INVALID, "width_directions %u is not from 3 to 1024", o->width_directions);
    if ((o->importance == SPH_IMPORTANCE_CALLER) != (o->importance_weights != NULL))
        return sph__fail(context, SPH_E_INVALID, "importance_weights belong to SPH_IMPORTANCE_CALLER, and to it alone");
    return SPH_OK;
}

static sph_status allocate_hierarchy(sph__builder *b)
{
    const size_t nodes = 2 * (size_t)b->n - 1, collapses = b->n - (size_t)1;
    sph_hierarchy *h = sph__new(b->context, sizeof *h, SPH__HIERARCHY);
    if (h == NULL) return sph__fail_memory(b->context);
    b->h = h;
    h->context = sph__context_retain(b->animation->context);
    h->vertex_count = b->n;
    h->frame_count = b->frames;
    h->stride = (uint32_t)b->stride;
    h->radii_per_frame = b->options.radius_mode == SPH_RADIUS_PER_FRAME;
    h->first_forced = SPH__NO_NODE;
    h->centers = sph__alloc(b->context, nodes, b->node_floats * sizeof *h->centers);
    h->radii = sph__alloc(b->context, nodes, (h->radii_per_frame ? b->stride : 1) * sizeof *h->radii);
    h->children = sph__alloc(b->context, collapses, 2 * sizeof *h->children);
    h->parents = sph__alloc(b->context, nodes, sizeof *h->parents);
    h->costs = sph__alloc(b->context, collapses, sizeof *h->costs);
    h->errors = sph__alloc(b->context, collapses, sizeof *h->errors);
    h->forced = sph__alloc(b->context, collapses, sizeof *h->forced);
    h->edge_starts = sph__alloc(b->context, nodes + 1, sizeof *h->edge_starts);
    h->triangle_starts = sph__alloc(b->context, nodes + 1, sizeof *h->triangle_starts);
    if (h->centers == NULL || h->radii == NULL || h->children == NULL || h->parents == NULL || h->costs == NULL ||
        h->errors == NULL || h->forced == NULL || h->edge_starts == NULL || h->triangle_starts == NULL)
        return sph__fail_memory(b->context);
    for (uint32_t v = 0; v < b->n; ++v) h->parents[v] = SPH__NO_NODE;
    b->births = (sph__births){.edge_starts = h->edge_starts, .triangle_starts = h->triangle_starts};
    return SPH_OK;
}

/* What blocks and the centres of collapses may take, in sizes of the input, where leaves can do without blocks. */
#define BLOCK_SHARE 2.1
/* Blocks of leaves that are no larger than this, in bytes, are all kept: other things take more. */
enum { SMALL_BLOCK = 1024 };

static sph_status allocate_builder(sph__builder *b)
{
    size_t block_size;
    b->slots = sph__zalloc(b->context, b->n + (size_t)SPH__GUESS_SLOTS, sizeof *b->slots);
    b->next_member = sph__alloc(b->context, b->n, sizeof *b->next_member);
    b->leaf_rows = b->h->radii_per_frame || b->single ? SPH__BLOCK_ROWS : SPH__LEAF_ROWS;
    block_size = (SPH__BLOCK_ROWS + (b->h->radii_per_frame ? (size_t)SPH__FRAME_ROWS : 0)) * b->stride;
    sph__slabs_init(&b->slabs, b->context, block_size, b->n);
    sph__blocks_init(&b->blocks, &b->slabs, b->slots, block_size);
    sph__blocks_init(&b->leaf_blocks, &b->slabs, b->slots, b->leaf_rows * b->stride);
    b->block_budget = (size_t)((double)b->n * b->node_floats * sizeof(float) * BLOCK_SHARE);
    if (b->leaf_rows * b->stride * sizeof(float) <= SMALL_BLOCK) b->block_budget = SIZE_MAX;
    sph__limit_leaves(b);
    sph__edge_queue_init(&b->queue, b->animation->context);
    if (b->slots == NULL || b->next_member == NULL)
        return sph__fail_memory(b->context);
    return SPH_OK;
}

static void free_builder(sph__builder *b)
{
    const sph_context *context = b->context;
    sph__free(context, b->cells);
    sph__free(context, b->wire);
    sph__free(context, b->cell_starts);
    sph__free(context, b->vertex_cells);
    sph__free(context, b->importance);
    sph__free(context, b->directions);
    sph__free(context, b->next_member);
    sph__free(context, b->direction_rows);
    sph__free(context, b->probes);
    sph__free(context, b->probe_bounds);
    sph__free(context, b->cell_open);
    sph__extents_free(b, &b->extents);
    if (b->slabs.context != NULL) {
        sph__blocks_free(&b->blocks);
        sph__blocks_free(&b->leaf_blocks);
        sph__slabs_free(&b->slabs);
    }
    sph__free(context, b->slots);
    sph__free(context, b->rows);
    sph__free(context, b->costs);
    sph__free(context, b->means);
    sph__guesses_destroy(b);
    sph__connectivity_free(&b->mesh);
    sph__free(context, b->candidates);
    sph__free(context, b->parabolas);
    sph__edge_queue_free(&b->queue);
    sph__free(context, b->new_center);
    sph__free(context, b->new_block);
    sph__free(context, b->new_radii);
    sph__free(context, b->union_widths);
    sph__births_free(&b->births, context);
}

static sph_status run_steps(sph__builder *b)
{
    sph_status status = allocate_hierarchy(b);
    if (status == SPH_OK) status = allocate_builder(b);
    sph__progress_part(&b->progress, 0.1);
    if (status == SPH_OK) status = sph__load_frames(b);
    if (status == SPH_OK) status = sph__make_cells(b);
    if (status == SPH_OK)
        status = sph__connectivity_init(&b->mesh, b->context, b->n, b->cells, b->cell_count, b->wire, b->wire_count, false, NULL);
    sph__free(b->context, b->cells);
    b->cells = NULL;
    sph__progress_part(&b->progress, 0.05);
    if (status == SPH_OK) status = sph__progress_report(&b->progress, "importance", 0);
    if (status == SPH_OK) status = sph__make_importance(b);
    sph__progress_part(&b->progress, 0.05);
    if (status == SPH_OK) status = sph__progress_report(&b->progress, "quadrics", 0);
    if (status == SPH_OK) status = sph__make_leaves(b);
    if (status == SPH_OK && b->h->radii_per_frame) status = sph__per_frame_start(b);
    if (status == SPH_OK) status = sph__make_widths(b);
    if (status == SPH_OK) status = sph__births_add_leaves(&b->births, &b->mesh, b->n);
    if (status == SPH_OK) status = sph__decimate(b);
    if (status != SPH_OK) return status;
    b->h->edge_others = b->births.edges;
    b->h->triangle_others = b->births.triangles;
    b->births.edges = b->births.triangles = NULL;
    if (b->h->first_forced == SPH__NO_NODE) b->h->first_forced = b->h->collapse_count;
    sph__restore_size(b);
    status = sph__hierarchy_list_roots(b->h);
    return status != SPH_OK ? status : sph__progress_report(&b->progress, "decimation", 1);
}

sph_status sph_hierarchy_create(const sph_animation *animation, const sph_hierarchy_options *options,
                                sph_hierarchy **out)
{
    SPH__OWN(animation, SPH__ANIMATION);
    sph__builder b = {0};
    sph_status status;
    if (out == NULL) return SPH_E_INVALID;
    *out = NULL;
    if (animation == NULL) return SPH_E_INVALID;
    b.context = animation->context;
    b.animation = animation;
    b.options = DEFAULTS;
    status = sph__options_read(b.context, "sph_hierarchy_options", options, &b.options, sizeof b.options, OPTIONS_V1);
    if (status == SPH_OK) status = check_options(b.context, &b.options);
    if (status != SPH_OK) return status;
    b.n = animation->vertex_count;
    b.frames = animation->frame_count;
    if (b.n > VERTEX_LIMIT) return sph__fail(b.context, SPH_E_INVALID, "%u vertices are more than 2^30", b.n);
    b.radius_factor = b.options.radius_factor;
    /* Beyond this nothing changes but the rounding, until products of three overflow. */
    b.coherence = fmin(b.options.temporal_coherence, 1e12);
    b.single = b.frames == 1 && b.options.radius_mode != SPH_RADIUS_PER_FRAME && !(b.coherence > 0);
    b.stride = b.single ? 1 : ((size_t)b.frames + SPH__LANES - 1) / SPH__LANES * SPH__LANES;
    b.node_floats = 3 * b.stride;
    b.direction_count = b.options.width_directions;
    sph__progress_begin(&b.progress, b.context);
    status = run_steps(&b);
    free_builder(&b);
    if (status != SPH_OK) {
        sph_hierarchy_destroy(b.h);
        return status;
    }
    *out = b.h;
    return SPH_OK;
}

void sph_hierarchy_destroy(sph_hierarchy *h)
{
    SPH__OWN(h, SPH__HIERARCHY);
    sph_context *context;
    if (h == NULL) return;
    context = h->context;
    sph__free(context, h->centers);
    sph__free(context, h->radii);
    sph__free(context, h->children);
    sph__free(context, h->parents);
    sph__free(context, h->roots);
    sph__free(context, h->costs);
    sph__free(context, h->errors);
    sph__free(context, h->forced);
    sph__free(context, h->edge_starts);
    sph__free(context, h->edge_others);
    sph__free(context, h->triangle_starts);
    sph__free(context, h->triangle_others);
    sph__free(context, h);
    sph__context_release(context);
}

uint32_t sph_hierarchy_vertex_count(const sph_hierarchy *h)
{
    SPH__OWN(h, SPH__HIERARCHY);
    return h == NULL ? 0 : h->vertex_count;
}

uint32_t sph_hierarchy_frame_count(const sph_hierarchy *h)
{
    SPH__OWN(h, SPH__HIERARCHY);
    return h == NULL ? 0 : h->frame_count;
}

uint32_t sph_hierarchy_collapse_count(const sph_hierarchy *h)
{
    SPH__OWN(h, SPH__HIERARCHY);
    return h == NULL ? 0 : h->collapse_count;
}

double sph_hierarchy_bounding_diagonal(const sph_hierarchy *h)
{
    SPH__OWN(h, SPH__HIERARCHY);
    return h == NULL ? 0 : h->bounding_diagonal;
}

uint64_t sph_hierarchy_evaluation_count(const sph_hierarchy *h)
{
    SPH__OWN(h, SPH__HIERARCHY);
    return h == NULL ? 0 : h->evaluations;
}

uint32_t sph_hierarchy_first_forced(const sph_hierarchy *h)
{
    SPH__OWN(h, SPH__HIERARCHY);
    return h == NULL ? 0 : h->first_forced;
}

static sph_collapse collapse_at(const sph_hierarchy *h, uint32_t index)
{
    return (sph_collapse){.u = h->children[2 * (size_t)index],
                          .v = h->children[2 * (size_t)index + 1],
                          .node = h->vertex_count + index,
                          .forced = h->forced[index],
                          .cost = h->costs[index],
                          .error = h->errors[index]};
}

sph_status sph_hierarchy_collapse(const sph_hierarchy *h, uint32_t index, sph_collapse *collapse)
{
    SPH__OWN(h, SPH__HIERARCHY);
    if (h == NULL || collapse == NULL) return SPH_E_INVALID;
    if (index >= h->collapse_count)
        return sph__fail(h->context, SPH_E_INVALID, "collapse %u of %u", index, h->collapse_count);
    *collapse = collapse_at(h, index);
    return SPH_OK;
}

sph_status sph_hierarchy_read_collapses(const sph_hierarchy *h, uint32_t first, uint32_t count, sph_collapse *collapses)
{
    SPH__OWN(h, SPH__HIERARCHY);
    if (h == NULL) return SPH_E_INVALID;
    if (collapses == NULL && count > 0) return sph__fail(h->context, SPH_E_INVALID, "collapses: NULL");
    if (first > h->collapse_count || count > h->collapse_count - first)
        return sph__fail(h->context, SPH_E_INVALID, "%u collapses from %u on, of %u", count, first, h->collapse_count);
    for (uint32_t i = 0; i < count; ++i) collapses[i] = collapse_at(h, first + i);
    return SPH_OK;
}

sph_status sph_hierarchy_sphere(const sph_hierarchy *h, uint32_t node, float *centers, float *radii)
{
    SPH__OWN(h, SPH__HIERARCHY);
    const float *rows;
    if (h == NULL) return SPH_E_INVALID;
    if (node >= sph__node_count(h))
        return sph__fail(h->context, SPH_E_INVALID, "node %u of %u", node, sph__node_count(h));
    rows = h->centers + (size_t)node * 3 * h->stride;
    for (uint32_t f = 0; f < h->frame_count; ++f) {
        for (unsigned k = 0; k < 3 && centers != NULL; ++k) centers[3 * (size_t)f + k] = rows[k * h->stride + f];
        if (radii != NULL) radii[f] = h->radii_per_frame ? h->radii[(size_t)node * h->stride + f] : h->radii[node];
    }
    return SPH_OK;
}

sph_status sph_hierarchy_count_for_error(const sph_hierarchy *h, double max_error, uint32_t *sphere_count)
{
    SPH__OWN(h, SPH__HIERARCHY);
    uint32_t low = 0, high;
    if (h == NULL || sphere_count == NULL) return SPH_E_INVALID;
    if (!(max_error >= 0)) return sph__fail(h->context, SPH_E_INVALID, "max_error must be >= 0");
    high = h->collapse_count;
    while (low < high) { /* the first collapse whose error is too large */
        const uint32_t middle = low + (high - low) / 2;
        if (h->errors[middle] <= max_error)
            low = middle + 1;
        else
            high = middle;
    }
    *sphere_count = h->vertex_count - low;
    return SPH_OK;
}

sph_status sph__hierarchy_list_roots(sph_hierarchy *h)
{
    h->root_count = h->vertex_count - h->collapse_count;
    h->roots = sph__alloc(h->context, h->root_count, sizeof *h->roots);
    if (h->roots == NULL) return sph__fail_memory(h->context);
    sph__list_roots(h->parents, sph__node_count(h), h->roots, h->root_count);
    return SPH_OK;
}

sph__collapses sph__hierarchy_collapses(const sph_hierarchy *h)
{
    return (sph__collapses){.context = h->context,
                            .vertex_count = h->vertex_count,
                            .collapse_count = h->collapse_count,
                            .root_count = h->root_count,
                            .children = h->children,
                            .parents = h->parents,
                            .roots = h->roots,
                            .edge_starts = h->edge_starts,
                            .edge_others = h->edge_others,
                            .triangle_starts = h->triangle_starts,
                            .triangle_others = h->triangle_others};
}

sph_status sph_cursor_create(const sph_hierarchy *h, sph_cursor **out)
{
    SPH__OWN(h, SPH__HIERARCHY);
    sph__collapses collapses;
    if (out == NULL) return SPH_E_INVALID;
    *out = NULL;
    if (h == NULL) return SPH_E_INVALID;
    collapses = sph__hierarchy_collapses(h);
    return sph__cursor_create(&collapses, out);
}
