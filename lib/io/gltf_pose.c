/* SPDX-License-Identifier: MIT */
/* A pose: nodes at a time, then the bones, then morphed and skinned vertices. */
#include <math.h>
#include <string.h>

#include "io/gltf.h"

enum { VERTEX_BLOCK = 1024 };

/* Of translation, rotation (normalised here) and scale. */
static sph__io_affine compose(const double p[10])
{
    const double length = sqrt(p[3] * p[3] + p[4] * p[4] + p[5] * p[5] + p[6] * p[6]);
    const double s = length > 0 ? 1 / length : 0;
    const double x = p[3] * s, y = p[4] * s, z = p[5] * s, w = length > 0 ? p[6] * s : 1;
    const double *scale = p + 7;
    return (sph__io_affine){
        {(1 - 2 * (y * y + z * z)) * scale[0], 2 * (x * y - z * w) * scale[1], 2 * (x * z + y * w) * scale[2], p[0],
         2 * (x * y + z * w) * scale[0], (1 - 2 * (x * x + z * z)) * scale[1], 2 * (y * z - x * w) * scale[2], p[1],
         2 * (x * z - y * w) * scale[0], 2 * (y * z + x * w) * scale[1], (1 - 2 * (x * x + y * y)) * scale[2], p[2]}};
}

static void apply_channels(sph__io_gltf *g, const sph__gltf_run *run, double time)
{
    static const size_t PLACES[] = {0, 3, 7};
    for (size_t i = 0; i < run->channel_count; ++i) {
        const sph__gltf_channel *c = &g->channels[run->first_channel + i];
        sph__gltf_node *node = &g->nodes[c->node];
        sph__gltf_sample(c, time,
                         c->path == SPH__GLTF_WEIGHTS ? g->weights + node->first_weight : node->now + PLACES[c->path]);
    }
}

void sph__gltf_pose(sph__io_gltf *g, const sph__gltf_run *run, double time)
{
    for (uint32_t i = 0; i < g->node_count; ++i)
        memcpy(g->nodes[i].now, g->nodes[i].rest, sizeof g->nodes[i].now);
    for (uint32_t i = 0; i < g->weight_count; ++i)
        g->weights[i] = g->weights_rest[i];
    if (run != NULL) apply_channels(g, run, time);
    for (uint32_t i = 0; i < g->node_count; ++i) {
        const sph__gltf_node *node = &g->nodes[g->order[i]];
        const sph__io_affine local = node->has_matrix ? node->matrix : compose(node->now);
        g->globals[g->order[i]] = node->parent == SPH__GLTF_NONE ? local : sph__io_multiply(&g->globals[node->parent], &local);
    }
    for (size_t i = 0; i < g->bone_count; ++i)
        g->palette[i] = sph__io_multiply(&g->globals[g->bones[i].node], &g->bones[i].bind);
}

const float *sph__gltf_morph(sph__io_gltf *g)
{
    if (g->target_count == 0) return g->positions;
    memcpy(g->morphed, g->positions, 3 * sizeof(float) * g->vertex_count);
    for (size_t t = 0; t < g->target_count; ++t) {
        const sph__gltf_target *target = &g->targets[t];
        const double weight = g->weights[target->weight];
        const sph__gltf_delta *delta = g->deltas + target->first;
        if (weight == 0) continue;
        for (size_t i = 0; i < target->count; ++i, ++delta)
            for (int k = 0; k < 3; ++k) {
                float *x = &g->morphed[3 * (size_t)delta->vertex + k];
                *x = (float)((double)*x + weight * (double)delta->xyz[k]);
            }
    }
    return g->morphed;
}

typedef struct skinning {
    const sph__io_gltf *g;
    const float *from;
    float *to;
} skinning;

static void transform(const double *restrict m, const float *from, float *to)
{
    const double x = (double)from[0], y = (double)from[1], z = (double)from[2];
    to[0] = (float)(m[0] * x + m[1] * y + m[2] * z + m[3]);
    to[1] = (float)(m[4] * x + m[5] * y + m[6] * z + m[7]);
    to[2] = (float)(m[8] * x + m[9] * y + m[10] * z + m[11]);
}

static void skin_vertices(void *argument, size_t begin, size_t end)
{
    const skinning *s = argument;
    const sph__io_gltf *g = s->g;
    for (size_t v = begin; v < end; ++v) {
        const sph__gltf_influence *i = g->influences + g->first_influence[v];
        const sph__gltf_influence *last = g->influences + g->first_influence[v + 1];
        double blended[12] = {0};
        if (last - i == 1) { /* its weight is 1 */
            transform(g->palette[i->bone].m, s->from + 3 * v, s->to + 3 * v);
            continue;
        }
        for (; i < last; ++i) {
            const double *restrict m = g->palette[i->bone].m, weight = (double)i->weight;
            for (int k = 0; k < 12; ++k)
                blended[k] += weight * m[k];
        }
        transform(blended, s->from + 3 * v, s->to + 3 * v);
    }
}

void sph__gltf_skin(sph__io_gltf *g, float *xyz)
{
    skinning s = {g, sph__gltf_morph(g), xyz};
    sph_context_parallel_for(g->context, g->vertex_count, VERTEX_BLOCK, skin_vertices, &s);
}
