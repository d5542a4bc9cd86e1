/* SPDX-License-Identifier: MIT */
/* What moves the vertices of a primitive: joints with weights, and morph targets. */
#include <math.h>
#include <stdio.h>

#include "io/gltf.h"

enum { SET_LIMIT = 64 };

/* JOINTS_n and WEIGHTS_n of a primitive, and the bones that the joints are. */
typedef struct binding {
    sph__gltf_accessor joints[SET_LIMIT], weights[SET_LIMIT];
    uint32_t set_count, first_bone, bone_count;
} binding;

static sph_status open_attribute(sph__gltf_document *d, uint32_t attributes, const char *name, uint32_t width,
                                 uint32_t vertex_count, bool *found, sph__gltf_accessor *a)
{
    uint32_t index;
    sph_status status = sph__gltf_get_index(d, attributes, name, SPH__GLTF_ACCESSORS, &index);
    *found = index != SPH__GLTF_NONE;
    if (status != SPH_OK || !*found) return status;
    if ((status = sph__gltf_accessor_open(d, index, width, a)) != SPH_OK) return status;
    if (a->count != vertex_count)
        return sph__gltf_fail(d, a->value, "%s has %u elements, POSITION %u", name, (unsigned)a->count,
                              (unsigned)vertex_count);
    return SPH_OK;
}

static sph_status open_sets(sph__gltf_document *d, uint32_t attributes, uint32_t vertex_count, binding *b)
{
    for (b->set_count = 0;; ++b->set_count) {
        char names[2][24];
        sph__gltf_accessor joints, weights;
        bool has_joints, has_weights;
        sph_status status;
        snprintf(names[0], sizeof names[0], "JOINTS_%u", (unsigned)b->set_count);
        snprintf(names[1], sizeof names[1], "WEIGHTS_%u", (unsigned)b->set_count);
        status = open_attribute(d, attributes, names[0], 4, vertex_count, &has_joints, &joints);
        if (status == SPH_OK) status = open_attribute(d, attributes, names[1], 4, vertex_count, &has_weights, &weights);
        if (status != SPH_OK) return status;
        if (!has_joints && !has_weights) return SPH_OK;
        if (has_joints != has_weights || (joints.type != SPH__GLTF_U8 && joints.type != SPH__GLTF_U16))
            return sph__gltf_fail(d, attributes, "%s and %s do not go together", names[0], names[1]);
        if (weights.type != SPH__GLTF_F32 && weights.type != SPH__GLTF_U8 && weights.type != SPH__GLTF_U16)
            return sph__gltf_fail(d, weights.value, "weights of type %d", weights.type);
        if (b->set_count == SET_LIMIT) return sph__gltf_fail(d, attributes, "more than %d sets of joints", SET_LIMIT);
        weights.normalized = true; /* as the format has it, whatever the file says */
        b->joints[b->set_count] = joints;
        b->weights[b->set_count] = weights;
    }
}

static sph_status add_influence(sph__gltf_document *d, sph__io_gltf *g, uint32_t bone, float weight)
{
    const sph_status status =
        sph__gltf_push(d, &g->influences, &g->influence_capacity, g->influence_count, sizeof *g->influences);
    if (status == SPH_OK) g->influences[g->influence_count++] = (sph__gltf_influence){bone, weight};
    return status;
}

static sph_status end_vertex(sph__gltf_document *d, sph__io_gltf *g, size_t vertex)
{
    const sph_status status =
        sph__gltf_push(d, &g->first_influence, &g->first_influence_capacity, vertex + 1, sizeof(size_t));
    if (status == SPH_OK) g->first_influence[vertex + 1] = g->influence_count;
    return status;
}

/*
 * In the order of the bones, and to a sum of one, so that copies of a vertex at a seam, whose influences may come in
 * another order, move to the same bits. The sum itself is taken in that order too.
 */
static void tidy(sph__gltf_influence *a, size_t count)
{
    double sum = 0;
    for (size_t i = 1; i < count; ++i) {
        const sph__gltf_influence moved = a[i];
        size_t k = i;
        for (; k > 0 && (a[k - 1].bone > moved.bone || (a[k - 1].bone == moved.bone && a[k - 1].weight > moved.weight));
             --k)
            a[k] = a[k - 1];
        a[k] = moved;
    }
    for (size_t i = 0; i < count; ++i)
        sum += (double)a[i].weight;
    for (size_t i = 0; i < count && sum != 1; ++i)
        a[i].weight = (float)((double)a[i].weight / sum);
}

static sph_status read_vertex(sph__gltf_document *d, sph__io_gltf *g, const binding *b, uint32_t vertex)
{
    const size_t first = g->influence_count;
    uint32_t joints[4];
    float weights[4];
    sph_status status = SPH_OK;
    for (uint32_t s = 0; s < b->set_count; ++s) {
        sph__gltf_accessor_integers(&b->joints[s], vertex, joints);
        sph__gltf_accessor_floats(&b->weights[s], vertex, weights);
        for (int i = 0; i < 4 && status == SPH_OK; ++i) {
            if (weights[i] == 0) continue;
            if (!(weights[i] > 0) || !isfinite(weights[i]))
                return sph__gltf_fail(d, b->weights[s].value, "vertex %u has weight %g", (unsigned)vertex,
                                      (double)weights[i]);
            if (joints[i] >= b->bone_count)
                return sph__gltf_fail(d, b->joints[s].value, "vertex %u has joint %u of a skin of %u", (unsigned)vertex,
                                      (unsigned)joints[i], (unsigned)b->bone_count);
            status = add_influence(d, g, b->first_bone + joints[i], weights[i]);
        }
    }
    if (status != SPH_OK) return status;
    if (g->influence_count > first) {
        tidy(g->influences + first, g->influence_count - first);
        return SPH_OK;
    }
    sph__gltf_accessor_integers(&b->joints[0], vertex, joints); /* no weights: all to its first joint */
    if (joints[0] >= b->bone_count)
        return sph__gltf_fail(d, b->joints[0].value, "vertex %u has joint %u of a skin of %u", (unsigned)vertex,
                              (unsigned)joints[0], (unsigned)b->bone_count);
    return add_influence(d, g, b->first_bone + joints[0], 1);
}

sph_status sph__gltf_read_influences(sph__gltf_document *d, sph__io_gltf *g, uint32_t primitive,
                                     const sph__gltf_node *node, const uint32_t *used, size_t used_count,
                                     uint32_t vertex_count)
{
    const size_t first = g->vertex_count - used_count;
    const uint32_t rigid = (uint32_t)g->bone_count;
    binding b = {.set_count = 0};
    sph_status status = SPH_OK;
    if (node->skin != SPH__GLTF_NONE) {
        status = open_sets(d, sph__gltf_get(d, primitive, "attributes"), vertex_count, &b);
        if (status == SPH_OK && b.set_count > 0)
            status = sph__gltf_read_skin(d, g, node->skin, &b.first_bone, &b.bone_count);
        if (status != SPH_OK) return status;
    }
    if (b.set_count == 0) {
        const sph__gltf_bone bone = {(uint32_t)(node - g->nodes), sph__io_identity};
        if ((status = sph__gltf_add_bone(d, g, &bone)) != SPH_OK) return status;
    }
    for (size_t i = 0; i < used_count && status == SPH_OK; ++i) {
        status = b.set_count > 0 ? read_vertex(d, g, &b, used[i]) : add_influence(d, g, rigid, 1);
        if (status == SPH_OK) status = end_vertex(d, g, first + i);
    }
    return status;
}

/* The moves of one target; vertices that stay need no room. */
static sph_status read_target(sph__gltf_document *d, sph__io_gltf *g, const sph__gltf_accessor *a, const uint32_t *used,
                              size_t used_count, size_t first)
{
    sph_status status = SPH_OK;
    for (size_t i = 0; i < used_count && status == SPH_OK; ++i) {
        sph__gltf_delta delta = {.vertex = (uint32_t)(first + i)};
        sph__gltf_accessor_floats(a, used[i], delta.xyz);
        if (delta.xyz[0] == 0 && delta.xyz[1] == 0 && delta.xyz[2] == 0) continue;
        status = sph__gltf_push(d, &g->deltas, &g->delta_capacity, g->delta_count, sizeof *g->deltas);
        if (status == SPH_OK) g->deltas[g->delta_count++] = delta;
    }
    return status;
}

sph_status sph__gltf_read_targets(sph__gltf_document *d, sph__io_gltf *g, uint32_t primitive,
                                  const sph__gltf_node *node, const uint32_t *used, size_t used_count,
                                  uint32_t vertex_count, size_t first)
{
    uint32_t array, value;
    sph_status status = sph__gltf_get_kind(d, primitive, "targets", '[', &array);
    if (status != SPH_OK) return status;
    if ((array == 0 ? 0 : d->values[array].count) != node->weight_count)
        return sph__gltf_fail(d, primitive, "primitives of one mesh have different numbers of morph targets");
    value = array + 1;
    for (uint32_t t = 0; t < node->weight_count && status == SPH_OK; ++t, value = d->values[value].next) {
        sph__gltf_target target = {node->first_weight + t, g->delta_count, 0};
        sph__gltf_accessor a;
        bool found;
        status = open_attribute(d, value, "POSITION", 3, vertex_count, &found, &a);
        if (status != SPH_OK || !found) continue;
        status = read_target(d, g, &a, used, used_count, first);
        target.count = g->delta_count - target.first;
        if (status == SPH_OK)
            status = sph__gltf_push(d, &g->targets, &g->target_capacity, g->target_count, sizeof *g->targets);
        if (status == SPH_OK) g->targets[g->target_count++] = target;
    }
    return status;
}
