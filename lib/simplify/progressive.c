/* SPDX-License-Identifier: MIT */
/* Making a progressive mesh, step by step; its memory. */
#include "simplify/simplify.h"

/* What all levels have in common: a skin of one vertex. */
static sph_status copy_frame(sph_progressive *p, const sph_skin *skin)
{
    const sph_skin_arrays sizes = {.vertex_count = 1,
                                   .bone_count = skin->bone_count,
                                   .influence_count = 1,
                                   .frame_count = skin->frame_count,
                                   .link_count = skin->link_count};
    const size_t bones = skin->bone_count;
    sph_status status = sph__skin_allocate(p->context, &sizes, &p->frame);
    if (status != SPH_OK) return status;
    memcpy(p->frame->transforms, skin->transforms, bones * skin->frame_count * 12 * sizeof *skin->transforms);
    memcpy(p->frame->pivots, skin->pivots, bones * 3 * sizeof *skin->pivots);
    memcpy(p->frame->radii, skin->radii, bones * sizeof *skin->radii);
    memcpy(p->frame->links, skin->links, skin->link_count * 2 * sizeof *skin->links);
    return sph__skin_set_clips(p->frame, skin->clips, skin->clip_count);
}

/* What a collapse fills in. */
static sph_status allocate_levels(sph__simplifier *b)
{
    sph_progressive *p = b->p;
    const size_t points = b->points, nodes = 2 * points;
    p->point_count = b->points;
    p->first_forced = SPH__NO_NODE;
    p->children = sph__alloc(b->context, points, 2 * sizeof *p->children);
    p->parents = sph__alloc(b->context, nodes, sizeof *p->parents);
    p->edge_starts = sph__alloc(b->context, nodes + 1, sizeof *p->edge_starts);
    p->triangle_starts = sph__alloc(b->context, nodes + 1, sizeof *p->triangle_starts);
    p->vertex_counts = sph__alloc(b->context, points, sizeof *p->vertex_counts);
    p->triangle_counts = sph__alloc(b->context, points, sizeof *p->triangle_counts);
    p->errors = sph__alloc(b->context, points, sizeof *p->errors);
    p->max_errors = sph__alloc(b->context, points, sizeof *p->max_errors);
    if (p->children == NULL || p->parents == NULL || p->edge_starts == NULL || p->triangle_starts == NULL ||
        p->vertex_counts == NULL || p->triangle_counts == NULL || p->errors == NULL || p->max_errors == NULL)
        return sph__fail_memory(b->context);
    b->births = (sph__births){.edge_starts = p->edge_starts, .triangle_starts = p->triangle_starts};
    return SPH_OK;
}

/* The triangles of points, and the wedges at their corners. */
static sph_status make_mesh(sph__simplifier *b)
{
    const size_t count = b->skin->triangle_count;
    uint32_t *triangles = sph__alloc(b->context, count, 3 * sizeof *triangles);
    sph_status status = SPH_OK;
    b->numbers = sph__alloc(b->context, count, sizeof *b->numbers);
    if (triangles == NULL || b->numbers == NULL) status = sph__fail_memory(b->context);
    for (size_t i = 0; i < 3 * count && status == SPH_OK; ++i)
        triangles[i] = b->point_of[b->skin->triangles[i]];
    if (status == SPH_OK)
        status = sph__connectivity_init(&b->mesh, b->context, b->points, triangles, count, NULL, 0, true, b->numbers);
    sph__free(b->context, triangles);
    return status;
}

static sph_status make_corners(sph__simplifier *b)
{
    sph_progressive *p = b->p;
    const size_t count = b->mesh.triangle_count;
    b->corners = sph__alloc(b->context, count, sizeof *b->corners);
    b->stamps = sph__zalloc(b->context, count, sizeof *b->stamps);
    b->wedge_count = b->n;
    if (b->corners == NULL || b->stamps == NULL ||
        !sph__reserve(b->context, (void **)&p->wedge_points, &b->point_capacity, b->n, sizeof *p->wedge_points) ||
        !sph__reserve(b->context, (void **)&p->wedge_sources, &b->source_capacity, b->n, sizeof *p->wedge_sources) ||
        !sph__reserve(b->context, (void **)&b->uses, &b->use_capacity, b->n, sizeof *b->uses))
        return sph__fail_memory(b->context);
    for (uint32_t v = 0; v < b->n; ++v) {
        p->wedge_points[v] = b->point_of[v];
        p->wedge_sources[v] = v;
        b->uses[v] = 0;
    }
    b->triangle_count = b->mesh.triangle_count;
    for (size_t t = 0; t < count; ++t)
        for (unsigned k = 0; k < 3; ++k) {
            const uint32_t wedge = b->wedge_of[b->skin->triangles[3 * (size_t)b->numbers[t] + k]];
            b->corners[t][k] = wedge;
            if (b->uses[wedge]++ == 0) ++b->vertex_count;
        }
    return SPH_OK;
}

/* Each room takes what an edge of most bones needs. */
static sph_status make_rooms(sph__simplifier *b)
{
    const size_t bones = 2 * (size_t)b->wide, pairs = bones * (bones + 1) / 2;
    for (int i = 0; i < SPH__SIMPLIFY_ROOMS; ++i) {
        sph__solver *s = &b->rooms[i];
        s->tolerance = b->o.tolerance;
        s->round_limit = b->o.round_limit;
        s->room = sph__alloc(b->context, sph__form_room((uint32_t)bones), sizeof *s->room);
        s->matrix = sph__alloc(b->context, bones * bones, sizeof *s->matrix);
        s->form.pairs = sph__alloc(b->context, pairs, SPH__FORM_SIZE * sizeof *s->form.pairs);
        s->form.linear = sph__alloc(b->context, bones, 4 * sizeof *s->form.linear);
        if (s->room == NULL || s->matrix == NULL || s->form.pairs == NULL || s->form.linear == NULL)
            return sph__fail_memory(b->context);
    }
    return SPH_OK;
}

static void free_simplifier(sph__simplifier *b)
{
    const sph_context *context = b->context;
    for (int i = 0; i < SPH__SIMPLIFY_ROOMS; ++i) {
        sph__free(context, b->rooms[i].room);
        sph__free(context, b->rooms[i].matrix);
        sph__free(context, b->rooms[i].form.pairs);
        sph__free(context, b->rooms[i].form.linear);
    }
    if (b->transforms != b->examples) sph__free(context, b->transforms);
    sph__free(context, b->examples);
    sph__free(context, b->point_of);
    sph__free(context, b->wedge_of);
    sph__connectivity_free(&b->mesh);
    sph__free(context, b->numbers);
    sph__free(context, b->corners);
    sph__free(context, b->stamps);
    sph__edge_queue_free(&b->queue);
    sph__births_free(&b->births, context);
    sph__free(context, b->centers);
    sph__free(context, b->blocks);
    sph__free(context, b->costs);
    sph__free(context, b->areas);
    sph__free(context, b->slot_of);
    sph__free(context, b->locked);
    sph__free(context, b->new_center);
    sph__free(context, b->zeros);
    sph__free(context, b->shown);
    sph__free(context, b->rest);
    sph__free(context, b->bones);
    sph__free(context, b->weights);
    sph__free(context, b->uses);
    sph__free(context, b->around);
    sph__free(context, b->moved);
    sph__free(context, b->fresh);
    sph__free(context, b->fresh_costs);
}

static sph_status list_roots(sph_progressive *p)
{
    const uint32_t count = p->point_count - p->collapse_count;
    p->roots = sph__alloc(p->context, count, sizeof *p->roots);
    if (p->roots == NULL) return sph__fail_memory(p->context);
    sph__list_roots(p->parents, p->point_count + p->collapse_count, p->roots, count);
    return SPH_OK;
}

static sph_status run_steps(sph__simplifier *b)
{
    sph_status status = copy_frame(b->p, b->skin);
    sph__progress_part(&b->progress, 0.1);
    if (status == SPH_OK) status = sph__progress_report(&b->progress, "quadrics", 0);
    if (status == SPH_OK) status = sph__simplify_weld(b);
    if (status == SPH_OK) status = sph__simplify_read_poses(b);
    if (status == SPH_OK) status = sph__simplify_make_points(b);
    if (status == SPH_OK) status = make_mesh(b);
    if (status == SPH_OK) status = make_corners(b);
    if (status == SPH_OK) status = allocate_levels(b);
    if (status == SPH_OK) status = make_rooms(b);
    if (status == SPH_OK) status = sph__simplify_make_leaves(b);
    if (status == SPH_OK) status = sph__simplify_decimate(b);
    if (status != SPH_OK) return status;
    b->p->edge_others = b->births.edges;
    b->p->triangle_others = b->births.triangles;
    b->births.edges = b->births.triangles = NULL;
    status = list_roots(b->p);
    return status == SPH_OK ? sph__progress_report(&b->progress, "decimation", 1) : status;
}

sph_status sph_progressive_create(const sph_skin *skin, const sph_simplify_options *options, sph_progressive **out)
{
    SPH__OWN(skin, SPH__SKIN);
    sph__simplifier b = {.skin = skin};
    sph_status status;
    if (out != NULL) *out = NULL;
    if (skin == NULL || out == NULL)
        return sph__fail(skin == NULL ? NULL : skin->context, SPH_E_INVALID,
                         "sph_progressive_create: an argument is NULL");
    b.context = skin->context;
    status = sph__simplify_read_options(skin, options, &b.o);
    if (status != SPH_OK) return status;
    b.p = sph__new(b.context, sizeof *b.p, SPH__PROGRESSIVE);
    if (b.p == NULL) return sph__fail_memory(b.context);
    b.p->context = sph__context_retain(skin->context);
    b.p->slots = b.o.influence_limit;
    b.wide = skin->bone_count < SPH__SIMPLIFY_WIDE ? skin->bone_count : SPH__SIMPLIFY_WIDE;
    if (b.wide < b.p->slots) b.wide = b.p->slots;
    b.p->attribute_count = b.o.attribute_count;
    b.p->value_count = b.o.attribute_count + (b.o.normals == NULL ? 0 : 3);
    b.n = skin->vertex_count;
    sph__edge_queue_init(&b.queue, skin->context);
    sph__progress_begin(&b.progress, b.context);
    status = run_steps(&b);
    free_simplifier(&b);
    if (status != SPH_OK) {
        sph_progressive_destroy(b.p);
        return status;
    }
    *out = b.p;
    return SPH_OK;
}

void sph_progressive_destroy(sph_progressive *p)
{
    SPH__OWN(p, SPH__PROGRESSIVE);
    sph_context *context;
    if (p == NULL) return;
    context = p->context;
    sph_skin_destroy(p->frame);
    sph__free(context, p->rest);
    sph__free(context, p->bones);
    sph__free(context, p->weights);
    sph__free(context, p->children);
    sph__free(context, p->parents);
    sph__free(context, p->roots);
    sph__free(context, p->edge_others);
    sph__free(context, p->triangle_others);
    sph__free(context, p->edge_starts);
    sph__free(context, p->triangle_starts);
    sph__free(context, p->vertex_counts);
    sph__free(context, p->triangle_counts);
    sph__free(context, p->errors);
    sph__free(context, p->max_errors);
    sph__free(context, p->values);
    sph__free(context, p->wedge_points);
    sph__free(context, p->wedge_sources);
    sph__free(context, p->triangle_wedges);
    sph__free(context, p->triangle_sources);
    sph__free(context, p);
    sph__context_release(context);
}
