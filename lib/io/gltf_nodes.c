/* SPDX-License-Identifier: MIT */
/* Nodes: their tree, which of them the scene draws, and skins. */
#include <string.h>

#include "io/gltf.h"


sph_status sph__gltf_push(sph__gltf_document *d, void *array, size_t *capacity, size_t count, size_t size)
{
    const size_t before = *capacity;
    void *memory;
    memcpy(&memory, array, sizeof memory);
    if (!sph__io_reserve(d->context, &memory, capacity, count + 1, size))
        return sph__io_fail_memory(d->context, d->path);
    memcpy(array, &memory, sizeof memory);
    if (*capacity - before > d->budget / size)
        return sph__io_fail(d->context, SPH_E_LIMIT, "%s: it would take far more memory than a file of its size should",
                            sph__io_shown(d->path));
    d->budget -= (*capacity - before) * size;
    return SPH_OK;
}

/* From the columns that files have. */
static sph__io_affine from_columns(const double c[16])
{
    sph__io_affine m;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column)
            m.m[4 * row + column] = c[4 * column + row];
    return m;
}

static sph_status read_transform(sph__gltf_document *d, uint32_t object, sph__gltf_node *node)
{
    static const double REST[10] = {0, 0, 0, 0, 0, 0, 1, 1, 1, 1};
    double columns[16];
    sph_status status = SPH_OK;
    memcpy(node->rest, REST, sizeof REST);
    node->has_matrix = sph__gltf_get(d, object, "matrix") != 0;
    if (node->has_matrix) {
        status = sph__gltf_get_numbers(d, object, "matrix", 16, columns);
        if (status == SPH_OK) node->matrix = from_columns(columns);
    }
    if (status == SPH_OK) status = sph__gltf_get_numbers(d, object, "translation", 3, node->rest);
    if (status == SPH_OK) status = sph__gltf_get_numbers(d, object, "rotation", 4, node->rest + 3);
    if (status == SPH_OK) status = sph__gltf_get_numbers(d, object, "scale", 3, node->rest + 7);
    return status;
}

static sph_status read_children(sph__gltf_document *d, sph__io_gltf *g, uint32_t index)
{
    const uint32_t object = d->lists[SPH__GLTF_NODES].values[index];
    uint32_t array, value, last = SPH__GLTF_NONE;
    sph_status status = sph__gltf_get_kind(d, object, "children", '[', &array);
    if (status != SPH_OK || array == 0) return status;
    value = array + 1;
    for (uint32_t i = 0; i < d->values[array].count; ++i, value = d->values[value].next) {
        uint32_t child;
        if ((status = sph__gltf_read_index(d, value, SPH__GLTF_NODES, &child)) != SPH_OK) return status;
        if (g->nodes[child].parent != SPH__GLTF_NONE)
            return sph__gltf_fail(d, value, "node %u is a child twice", (unsigned)child);
        g->nodes[child].parent = index;
        *(last == SPH__GLTF_NONE ? &g->nodes[index].first_child : &g->nodes[last].sibling) = child;
        last = child;
    }
    return SPH_OK;
}

/* Parents before children; what no root leads to goes round in a circle. */
static sph_status sort_nodes(sph__gltf_document *d, sph__io_gltf *g)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < g->node_count; ++i)
        if (g->nodes[i].parent == SPH__GLTF_NONE) g->order[count++] = i;
    for (uint32_t i = 0; i < count; ++i)
        for (uint32_t c = g->nodes[g->order[i]].first_child; c != SPH__GLTF_NONE; c = g->nodes[c].sibling)
            g->order[count++] = c;
    if (count == g->node_count) return SPH_OK;
    for (uint32_t i = 0; i < count; ++i)
        g->nodes[g->order[i]].weight_count = 1; /* not used yet: a mark */
    for (uint32_t i = 0; i < g->node_count; ++i)
        if (g->nodes[i].weight_count == 0)
            return sph__gltf_fail(d, d->lists[SPH__GLTF_NODES].values[i], "node %u is its own ancestor, or below one",
                                  (unsigned)i);
    return SPH_OK;
}

static void draw(sph__io_gltf *g, uint32_t root)
{
    uint32_t node = root;
    for (;;) {
        if (g->nodes[node].mesh != SPH__GLTF_NONE) g->drawn[g->drawn_count++] = node;
        if (g->nodes[node].first_child != SPH__GLTF_NONE) {
            node = g->nodes[node].first_child;
            continue;
        }
        while (node != root && g->nodes[node].sibling == SPH__GLTF_NONE)
            node = g->nodes[node].parent;
        if (node == root) return;
        node = g->nodes[node].sibling;
    }
}

/* The scene to show; a file without scenes shows all. */
static sph_status draw_scene(sph__gltf_document *d, sph__io_gltf *g)
{
    uint32_t index, scene, array, value;
    unsigned char *seen;
    sph_status status = sph__gltf_get_index(d, 0, "scene", SPH__GLTF_SCENES, &index);
    if (status != SPH_OK) return status;
    if (index == SPH__GLTF_NONE && d->lists[SPH__GLTF_SCENES].count == 0) {
        for (uint32_t i = 0; i < g->node_count; ++i)
            if (g->nodes[i].parent == SPH__GLTF_NONE) draw(g, i);
        return SPH_OK;
    }
    scene = d->lists[SPH__GLTF_SCENES].values[index == SPH__GLTF_NONE ? 0 : index];
    status = sph__gltf_get_kind(d, scene, "nodes", '[', &array);
    if (status != SPH_OK || array == 0) return status;
    if ((status = sph__gltf_allocate(d, g->node_count, 1, &seen)) != SPH_OK) return status;
    memset(seen, 0, g->node_count);
    value = array + 1;
    for (uint32_t i = 0; i < d->values[array].count && status == SPH_OK; ++i, value = d->values[value].next) {
        if ((status = sph__gltf_read_index(d, value, SPH__GLTF_NODES, &index)) != SPH_OK) break;
        if (seen[index] || g->nodes[index].parent != SPH__GLTF_NONE)
            status = sph__gltf_fail(d, value, "node %u is in the scene twice", (unsigned)index);
        else
            draw(g, index);
        seen[index] = 1;
    }
    sph_context_release(d->context, seen);
    return status;
}

/* Morph targets of a mesh: as many as its first primitive has. */
static sph_status count_targets(const sph__gltf_document *d, uint32_t mesh, uint32_t *count)
{
    const uint32_t object = d->lists[SPH__GLTF_MESHES].values[mesh];
    uint32_t array, targets;
    sph_status status = sph__gltf_get_kind(d, object, "primitives", '[', &array);
    *count = 0;
    if (status != SPH_OK || array == 0 || d->values[array].count == 0) return status;
    status = sph__gltf_get_kind(d, array + 1, "targets", '[', &targets);
    if (status == SPH_OK && targets != 0) *count = d->values[targets].count;
    return status;
}

/* Each node has weights of its own; the mesh's are the default. */
static sph_status read_weights(sph__gltf_document *d, sph__io_gltf *g)
{
    uint64_t total = 0;
    sph_status status = SPH_OK;
    for (uint32_t i = 0; i < g->node_count && status == SPH_OK; ++i) {
        sph__gltf_node *node = &g->nodes[i];
        node->first_weight = (uint32_t)total;
        node->weight_count = 0;
        if (node->mesh == SPH__GLTF_NONE) continue;
        status = count_targets(d, node->mesh, &node->weight_count);
        total += node->weight_count;
        if (total > INT32_MAX)
            return sph__io_fail(d->context, SPH_E_LIMIT, "%s: too many morph targets", sph__io_shown(d->path));
    }
    if (status != SPH_OK) return status;
    g->weight_count = (uint32_t)total;
    status = sph__gltf_allocate(d, total, sizeof *g->weights_rest, &g->weights_rest);
    if (status == SPH_OK) status = sph__gltf_allocate(d, total, sizeof *g->weights, &g->weights);
    for (uint32_t i = 0; i < g->node_count && status == SPH_OK; ++i) {
        const sph__gltf_node *node = &g->nodes[i];
        double *numbers = g->weights_rest + node->first_weight;
        if (node->weight_count == 0) continue;
        for (uint32_t t = 0; t < node->weight_count; ++t)
            numbers[t] = 0;
        status = sph__gltf_get_numbers(d, d->lists[SPH__GLTF_MESHES].values[node->mesh], "weights", node->weight_count,
                                       numbers);
        if (status == SPH_OK)
            status =
                sph__gltf_get_numbers(d, d->lists[SPH__GLTF_NODES].values[i], "weights", node->weight_count, numbers);
    }
    return status;
}

sph_status sph__gltf_read_nodes(sph__gltf_document *d, sph__io_gltf *g)
{
    const uint32_t count = d->lists[SPH__GLTF_NODES].count;
    sph_status status = sph__gltf_allocate(d, count, sizeof *g->nodes, &g->nodes);
    if (status == SPH_OK) status = sph__gltf_allocate(d, count, sizeof *g->order, &g->order);
    if (status == SPH_OK) status = sph__gltf_allocate(d, count, sizeof *g->drawn, &g->drawn);
    if (status == SPH_OK) status = sph__gltf_allocate(d, count, sizeof *g->globals, &g->globals);
    if (status != SPH_OK) return status;
    g->node_count = count;
    for (uint32_t i = 0; i < count; ++i)
        g->nodes[i] = (sph__gltf_node){.parent = SPH__GLTF_NONE,
                                       .first_child = SPH__GLTF_NONE,
                                       .sibling = SPH__GLTF_NONE,
                                       .matrix = sph__io_identity};
    for (uint32_t i = 0; i < count && status == SPH_OK; ++i) {
        const uint32_t object = d->lists[SPH__GLTF_NODES].values[i];
        status = read_transform(d, object, &g->nodes[i]);
        if (status == SPH_OK) status = sph__gltf_get_index(d, object, "mesh", SPH__GLTF_MESHES, &g->nodes[i].mesh);
        if (status == SPH_OK) status = sph__gltf_get_index(d, object, "skin", SPH__GLTF_SKINS, &g->nodes[i].skin);
        if (status == SPH_OK) status = read_children(d, g, i);
    }
    if (status == SPH_OK) status = sort_nodes(d, g);
    if (status == SPH_OK) status = draw_scene(d, g);
    return status == SPH_OK ? read_weights(d, g) : status;
}

sph_status sph__gltf_add_bone(sph__gltf_document *d, sph__io_gltf *g, const sph__gltf_bone *bone)
{
    sph_status status;
    if (g->bone_count == INT32_MAX)
        return sph__io_fail(d->context, SPH_E_LIMIT, "%s: too many joints", sph__io_shown(d->path));
    status = sph__gltf_push(d, &g->bones, &g->bone_capacity, g->bone_count, sizeof *g->bones);
    if (status != SPH_OK) return status;
    g->bones[g->bone_count] = *bone;
    ++g->bone_count;
    return SPH_OK;
}

static sph_status read_bones(sph__gltf_document *d, sph__io_gltf *g, uint32_t object, uint32_t joints)
{
    sph__gltf_accessor binds = {.count = 0};
    uint32_t index, value = joints + 1;
    sph_status status = sph__gltf_get_index(d, object, "inverseBindMatrices", SPH__GLTF_ACCESSORS, &index);
    if (status == SPH_OK && index != SPH__GLTF_NONE) status = sph__gltf_accessor_open(d, index, 16, &binds);
    if (status != SPH_OK) return status;
    if (index != SPH__GLTF_NONE && (binds.type != SPH__GLTF_F32 || binds.count < d->values[joints].count))
        return sph__gltf_fail(d, object, "%u matrices for %u joints, or none of floats", (unsigned)binds.count,
                              (unsigned)d->values[joints].count);
    for (uint32_t i = 0; i < d->values[joints].count && status == SPH_OK; ++i, value = d->values[value].next) {
        sph__gltf_bone bone = {.bind = sph__io_identity};
        status = sph__gltf_read_index(d, value, SPH__GLTF_NODES, &bone.node);
        if (index != SPH__GLTF_NONE) {
            float floats[16];
            double columns[16];
            sph__gltf_accessor_floats(&binds, i, floats);
            for (int c = 0; c < 16; ++c)
                columns[c] = (double)floats[c];
            bone.bind = from_columns(columns);
        }
        if (status == SPH_OK) status = sph__gltf_add_bone(d, g, &bone);
    }
    return status;
}

sph_status sph__gltf_read_skin(sph__gltf_document *d, sph__io_gltf *g, uint32_t skin, uint32_t *first, uint32_t *count)
{
    const uint32_t object = d->lists[SPH__GLTF_SKINS].values[skin];
    uint32_t joints;
    sph_status status = sph__gltf_get_kind(d, object, "joints", '[', &joints);
    if (status != SPH_OK) return status;
    if (joints == 0 || d->values[joints].count == 0)
        return sph__gltf_fail(d, object, "skin %u has no joints", (unsigned)skin);
    if (g->skin_bones == NULL) {
        const uint32_t skins = d->lists[SPH__GLTF_SKINS].count;
        status = sph__gltf_allocate(d, skins, sizeof *g->skin_bones, &g->skin_bones);
        if (status != SPH_OK) return status;
        for (uint32_t i = 0; i < skins; ++i)
            g->skin_bones[i] = SPH__GLTF_NONE;
    }
    *count = d->values[joints].count;
    if (g->skin_bones[skin] == SPH__GLTF_NONE) {
        const uint32_t begin = (uint32_t)g->bone_count;
        if ((status = read_bones(d, g, object, joints)) != SPH_OK) return status;
        g->skin_bones[skin] = begin;
    }
    *first = g->skin_bones[skin];
    return SPH_OK;
}
