/* SPDX-License-Identifier: MIT */
/* Vertices that are one point: of one place in the rest pose, one group, and weights that agree. */
#include <math.h>

#include "animation/partition.h"
#include "simplify/simplify.h"

/* Weights of copies along a seam may have been rounded apart, to 8 bits each. */
static const float SAME_WEIGHT = 0.02F;
/* Vertices of one place that a vertex is compared with: more that differ from all of these stay apart. */
enum { COMPARED = 64 };

static float weight_of(const sph_skin *skin, size_t vertex, uint32_t bone)
{
    const size_t first = vertex * skin->influence_count;
    for (size_t i = first; i < first + skin->influence_count && skin->weights[i] > 0; ++i)
        if (skin->bones[i] == bone) return skin->weights[i];
    return 0;
}

static bool has_weights_of(const sph_skin *skin, size_t a, size_t b)
{
    const size_t first = a * skin->influence_count;
    for (size_t i = first; i < first + skin->influence_count && skin->weights[i] > 0; ++i)
        if (fabsf(skin->weights[i] - weight_of(skin, b, skin->bones[i])) > SAME_WEIGHT) return false;
    return true;
}

static bool moves_like(const sph__simplifier *b, size_t v, size_t other)
{
    if (b->o.groups != NULL && b->o.groups[v] != b->o.groups[other]) return false;
    return has_weights_of(b->skin, v, other) && has_weights_of(b->skin, other, v);
}

static bool has_values_of(const sph__simplifier *b, size_t v, size_t other)
{
    const size_t size = b->p->value_count;
    return size == 0 || memcmp(b->p->values + v * size, b->p->values + other * size, size * sizeof(float)) == 0;
}

/* The vertices of one place, in order: each finds the first that moves like it, and of those the first of its values.
 */
static void divide(sph__simplifier *b, const sph__keyed *members, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        const uint32_t v = (uint32_t)members[i].key;
        size_t tries = 0;
        for (size_t k = 0; k < i && tries < COMPARED; ++k) {
            const uint32_t other = (uint32_t)members[k].key;
            if (b->point_of[other] != other) continue;
            ++tries;
            if (!moves_like(b, v, other)) continue;
            b->point_of[v] = other;
            break;
        }
        tries = 0;
        for (size_t k = 0; k < i && tries < COMPARED && b->point_of[v] != v; ++k) {
            const uint32_t other = (uint32_t)members[k].key;
            if (b->wedge_of[other] != other || b->point_of[other] != b->point_of[v]) continue;
            ++tries;
            if (!has_values_of(b, v, other)) continue;
            b->wedge_of[v] = other;
            break;
        }
    }
}

/* From leaders to numbers without gaps. */
static void number_points(sph__simplifier *b)
{
    for (uint32_t v = 0; v < b->n; ++v)
        b->point_of[v] = b->point_of[v] == v ? b->points++ : b->point_of[b->point_of[v]];
}

static sph_status group(sph__simplifier *b, sph__partition *partition)
{
    sph__keyed *members = sph__alloc(b->context, b->n, sizeof *members);
    if (members == NULL) return sph__fail_memory(b->context);
    sph__partition_refine(partition, b->skin->rest, 0);
    for (uint32_t begin = 0; begin < partition->member_count;) {
        const uint32_t end = sph__group_end(partition, begin);
        for (uint32_t i = begin; i < end; ++i)
            members[i - begin] = (sph__keyed){partition->members[i] & ~SPH__GROUP_END, 0};
        sph__sort(members, end - begin);
        divide(b, members, end - begin);
        begin = end;
    }
    sph__free(b->context, members);
    return SPH_OK;
}

/* The values of the input's vertices. */
static sph_status copy_values(sph__simplifier *b)
{
    const size_t n = b->n, size = b->p->value_count, normal = b->o.normals == NULL ? 0 : 3, rest = b->o.attribute_count;
    size_t count;
    if (!sph__multiply_size(n, size, &count) ||
        !sph__reserve(b->context, (void **)&b->p->values, &b->value_capacity, count, sizeof(float)))
        return sph__fail_memory(b->context);
    for (size_t v = 0; v < n && size != 0; ++v) {
        float *values = b->p->values + v * size;
        if (normal != 0) memcpy(values, b->o.normals + 3 * v, 3 * sizeof *values);
        if (rest != 0) memcpy(values + normal, b->o.attributes + v * rest, rest * sizeof *values);
    }
    return SPH_OK;
}

sph_status sph__simplify_weld(sph__simplifier *b)
{
    sph__partition partition = {.context = NULL};
    sph_status status;
    b->point_of = sph__alloc(b->context, b->n, sizeof *b->point_of);
    b->wedge_of = sph__alloc(b->context, b->n, sizeof *b->wedge_of);
    if (b->point_of == NULL || b->wedge_of == NULL) return sph__fail_memory(b->context);
    for (uint32_t v = 0; v < b->n; ++v)
        b->point_of[v] = b->wedge_of[v] = v;
    status = copy_values(b);
    if (status == SPH_OK) status = sph__partition_init(&partition, b->context, b->n);
    if (status == SPH_OK) status = group(b, &partition);
    if (partition.context != NULL) sph__partition_free(&partition);
    if (status == SPH_OK) number_points(b);
    return status;
}
