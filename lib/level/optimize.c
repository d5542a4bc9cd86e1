/* SPDX-License-Identifier: MIT */
/* Connectivity optimisation (section 4.3). */
#include <math.h>

#include "animation/animation.h"
#include "hierarchy/simplices.h"
#include "level/level.h"

/* For every sphere itself and its neighbours: the candidates of the vertices that it holds. */
typedef struct neighbourhood {
    size_t *starts;
    uint32_t *spheres; /* each sphere's own number first, the rest ascending */
} neighbourhood;

static size_t list_pairs(const sph_level *level, sph__keyed *pairs)
{
    size_t count = 0;
    for (size_t e = 0; e < level->edge_count; ++e)
        for (unsigned k = 0; k < 2; ++k)
            pairs[count++] = (sph__keyed){level->edges[2 * e + k], level->edges[2 * e + 1 - k]};
    for (size_t t = 0; t < level->triangle_count; ++t)
        for (unsigned k = 0; k < 3; ++k)
            for (unsigned o = 1; o < 3; ++o)
                pairs[count++] = (sph__keyed){level->triangles[3 * t + k], level->triangles[3 * t + (k + o) % 3]};
    return count;
}

static sph_status find_neighbours(const sph_level *level, neighbourhood *n)
{
    const size_t most = 2 * level->edge_count + 6 * level->triangle_count;
    sph__keyed *pairs = sph__alloc(level->context, most, sizeof *pairs);
    size_t count = 0, at = 0, pair_count;
    n->starts = sph__alloc(level->context, (size_t)level->sphere_count + 1, sizeof *n->starts);
    n->spheres = sph__alloc(level->context, most + level->sphere_count, sizeof *n->spheres);
    if (pairs == NULL || n->starts == NULL || n->spheres == NULL) {
        sph__free(level->context, pairs);
        return sph__fail_memory(level->context);
    }
    pair_count = list_pairs(level, pairs);
    sph__sort(pairs, pair_count);
    for (uint32_t s = 0; s < level->sphere_count; ++s) {
        n->starts[s] = count;
        n->spheres[count++] = s;
        for (; at < pair_count && pairs[at].key == s; ++at)
            if (pairs[at].item != s && n->spheres[count - 1] != pairs[at].item) n->spheres[count++] = (uint32_t)pairs[at].item;
    }
    n->starts[level->sphere_count] = count;
    sph__free(level->context, pairs);
    return SPH_OK;
}

/* What one pass over the frames accumulates: per vertex and candidate the sum of signed distances. */
typedef struct distance_sums {
    const sph_level *level;
    const neighbourhood *n;
    size_t *starts; /* [vertices + 1] into sums */
    double *sums;
    const float *xyz, *centers, *radii; /* of the frame at hand */
} distance_sums;

static void add_distances(void *argument, size_t begin, size_t end)
{
    const distance_sums *d = argument;
    for (size_t v = begin; v < end; ++v) {
        const uint32_t label = d->level->labels[v];
        const float *p = d->xyz + 3 * v;
        if (label == SPH_NO_SPHERE) continue;
        for (size_t i = d->n->starts[label], at = d->starts[v]; i < d->n->starts[label + 1]; ++i, ++at) {
            const uint32_t s = d->n->spheres[i];
            const float *q = d->centers + 3 * (size_t)s;
            const double x = (double)p[0] - q[0], y = (double)p[1] - q[1], z = (double)p[2] - q[2];
            d->sums[at] += sqrt(x * x + y * y + z * z) - d->radii[s];
        }
    }
}

static sph_status sum_distances(const sph_animation *animation, distance_sums *d)
{
    enum { GRAIN = 1024 };
    float *scratch;
    sph__progress progress;
    sph_status status = sph__animation_scratch(animation, &scratch);
    sph__progress_begin(&progress, animation->context);
    sph__progress_part(&progress, 1);
    for (uint32_t f = 0; f < animation->frame_count && status == SPH_OK; ++f) {
        status = sph__progress_report(&progress, "connectivity", (double)f / animation->frame_count);
        if (status == SPH_OK) status = sph__animation_frame(animation, f, scratch, &d->xyz);
        if (status == SPH_OK) status = sph__check_finite(animation->context, f, d->xyz, animation->vertex_count);
        if (status != SPH_OK) break;
        d->centers = sph__level_centers(d->level, f);
        d->radii = sph__level_radii(d->level, f);
        sph__parallel_for(animation->context, animation->vertex_count, GRAIN, add_distances, d);
    }
    sph__free(animation->context, scratch);
    return status;
}

/* The candidate of least sum; of equal ones the vertex's own, then the first. */
static void choose_labels(const distance_sums *d, uint32_t *labels)
{
    for (size_t v = 0; v < d->level->label_count; ++v) {
        const uint32_t label = d->level->labels[v];
        size_t best = d->starts[v];
        labels[v] = label;
        for (size_t i = d->starts[v]; i < d->starts[v + 1]; ++i)
            if (d->sums[i] < d->sums[best]) best = i;
        if (label != SPH_NO_SPHERE) labels[v] = d->n->spheres[d->n->starts[label] + (best - d->starts[v])];
    }
}

static sph_status relabel(const sph_level *level, const sph_animation *animation, uint32_t *labels)
{
    neighbourhood n = {0};
    distance_sums d = {.level = level, .n = &n};
    sph_status status = find_neighbours(level, &n);
    if (status == SPH_OK) {
        d.starts = sph__alloc(level->context, level->label_count + 1, sizeof *d.starts);
        if (d.starts == NULL) status = sph__fail_memory(level->context);
    }
    if (status == SPH_OK) {
        size_t count = 0;
        for (size_t v = 0; v < level->label_count; ++v) {
            const uint32_t label = level->labels[v];
            d.starts[v] = count;
            if (label != SPH_NO_SPHERE) count += n.starts[label + 1] - n.starts[label];
        }
        d.starts[level->label_count] = count;
        d.sums = sph__zalloc(level->context, count, sizeof *d.sums);
        if (d.sums == NULL) status = sph__fail_memory(level->context);
    }
    if (status == SPH_OK) status = sum_distances(animation, &d);
    if (status == SPH_OK) choose_labels(&d, labels);
    sph__free(level->context, n.starts);
    sph__free(level->context, n.spheres);
    sph__free(level->context, d.starts);
    sph__free(level->context, d.sums);
    return status;
}

/* The simplices dual to labels, being made. */
typedef struct dual {
    const sph_animation *animation;
    const uint32_t *labels;
    sph__keyed *keys; /* room for all pairs */
    uint32_t *edges, *triangles;
    size_t edge_count, triangle_count;
} dual;

static void add_pair(dual *d, size_t *count, uint32_t a, uint32_t b, uint64_t wire)
{
    if (a == b || a == SPH_NO_SPHERE || b == SPH_NO_SPHERE) return;
    d->keys[(*count)++] = (sph__keyed){a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a, wire};
}

static void make_dual_triangles(dual *d)
{
    size_t count = 0, kept = 0;
    for (size_t t = 0; t < d->animation->triangle_count; ++t) {
        const uint32_t *corner = d->animation->triangles + 3 * t;
        const uint32_t a = d->labels[corner[0]], b = d->labels[corner[1]], c = d->labels[corner[2]];
        if (a == b || b == c || c == a || a == SPH_NO_SPHERE || b == SPH_NO_SPHERE || c == SPH_NO_SPHERE) continue;
        d->triangles[3 * count] = a;
        d->triangles[3 * count + 1] = b;
        d->triangles[3 * count++ + 2] = c;
    }
    sph__order_triangles(d->triangles, count, d->keys);
    /* Same corners are neighbours once sorted by them; of both windings the first stays. */
    for (size_t i = 0; i < count; ++i) {
        const uint32_t *t = d->triangles + 3 * i;
        const uint32_t b = t[1] < t[2] ? t[1] : t[2], c = t[1] < t[2] ? t[2] : t[1];
        d->keys[i] = (sph__keyed){(uint64_t)t[0] << 32 | b, (uint64_t)c << 32 | i};
    }
    sph__sort(d->keys, count);
    for (size_t i = 0; i < count; ++i) {
        const bool same = i > 0 && d->keys[i].key == d->keys[i - 1].key && d->keys[i].item >> 32 == d->keys[i - 1].item >> 32;
        const uint32_t *t = d->triangles + 3 * (size_t)(uint32_t)d->keys[i].item;
        if (same) continue;
        memcpy(d->edges + 3 * kept++, t, 3 * sizeof *t); /* the edges' room serves while they are not made */
    }
    memcpy(d->triangles, d->edges, 3 * kept * sizeof *d->triangles);
    sph__order_triangles(d->triangles, kept, d->keys);
    d->triangle_count = kept;
}

/* All pairs; those of a triangle of the level sort first and hide the rest. */
static void make_dual_edges(dual *d)
{
    const sph_animation *a = d->animation;
    size_t count = 0;
    for (size_t i = 0; i < 3 * d->triangle_count; ++i)
        add_pair(d, &count, d->triangles[i], d->triangles[i % 3 == 2 ? i - 2 : i + 1], 0);
    for (size_t i = 0; i < 3 * a->triangle_count; ++i)
        add_pair(d, &count, d->labels[a->triangles[i]], d->labels[a->triangles[i % 3 == 2 ? i - 2 : i + 1]], 1);
    for (size_t e = 0; e < a->edge_count; ++e)
        add_pair(d, &count, d->labels[a->edges[2 * e]], d->labels[a->edges[2 * e + 1]], 1);
    sph__sort(d->keys, count);
    for (size_t i = 0; i < count; ++i) {
        if ((i > 0 && d->keys[i].key == d->keys[i - 1].key) || d->keys[i].item == 0) continue;
        d->edges[2 * d->edge_count] = (uint32_t)(d->keys[i].key >> 32);
        d->edges[2 * d->edge_count++ + 1] = (uint32_t)d->keys[i].key;
    }
}

static sph_status make_dual(const sph_level *level, dual *d)
{
    const sph_context *context = level->context;
    const size_t triangles = d->animation->triangle_count, edges = 3 * triangles + d->animation->edge_count;
    d->keys = sph__alloc(context, edges + 3 * triangles, sizeof *d->keys);
    d->edges = sph__alloc(context, edges, 2 * sizeof *d->edges);
    d->triangles = sph__alloc(context, triangles, 3 * sizeof *d->triangles);
    if (d->keys == NULL || d->edges == NULL || d->triangles == NULL) return sph__fail_memory(context);
    make_dual_triangles(d);
    make_dual_edges(d);
    return SPH_OK;
}

static sph_status check_match(const sph_level *level, const sph_animation *animation)
{
    if (level->labels == NULL)
        return sph__fail(level->context, SPH_E_INVALID, "the level has no labels: it was not made from a hierarchy");
    if (level->label_count != animation->vertex_count)
        return sph__fail(level->context, SPH_E_INVALID, "the level is of %zu vertices, the animation has %u",
                         level->label_count, animation->vertex_count);
    if (level->frame_count != animation->frame_count)
        return sph__fail(level->context, SPH_E_INVALID, "the level has %u frames, the animation has %u",
                         level->frame_count, animation->frame_count);
    return SPH_OK;
}

sph_status sph_level_optimize_connectivity(sph_level *level, const sph_animation *animation)
{
    SPH__OWN(level, SPH__LEVEL);
    SPH__OWN(animation, SPH__ANIMATION);
    dual d = {.animation = animation};
    uint32_t *labels = NULL;
    sph_status status;
    if (level == NULL || animation == NULL) return SPH_E_INVALID;
    status = check_match(level, animation);
    if (status != SPH_OK) return status;
    labels = sph__alloc(level->context, level->label_count, sizeof *labels);
    if (labels == NULL) return sph__fail_memory(level->context);
    d.labels = labels;
    status = relabel(level, animation, labels);
    if (status == SPH_OK) status = make_dual(level, &d);
    sph__free(level->context, d.keys);
    if (status != SPH_OK) {
        sph__free(level->context, labels);
        sph__free(level->context, d.edges);
        sph__free(level->context, d.triangles);
        return status;
    }
    sph__free(level->context, level->labels);
    sph__free(level->context, level->edges);
    sph__free(level->context, level->triangles);
    level->labels = labels;
    level->edges = d.edges;
    level->edge_count = d.edge_count;
    level->triangles = d.triangles;
    level->triangle_count = d.triangle_count;
    return SPH_OK;
}
