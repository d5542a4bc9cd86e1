/* SPDX-License-Identifier: MIT */
/* A decomposition's tables and frames. */
#include "skin/problem.h"

#include <math.h>

#include "animation/animation.h"

void sph__problem_free(sph__problem *p)
{
    sph__free(p->context, p->data);
    sph__free(p->context, p->rest);
    sph__free(p->context, p->total);
    sph__free(p->context, p->vertex);
    sph__free(p->context, p->poses);
    sph__free(p->context, p->sets);
    sph__free(p->context, p->set_bones);
    sph__free(p->context, p->set_pairs);
    sph__free(p->context, p->set);
    sph__influences_free(p, &p->now);
    sph__free(p->context, p->still);
    sph__free(p->context, p->near_starts);
    sph__free(p->context, p->near);
    *p = (sph__problem){0};
}

sph_status sph__influences_allocate(const sph__problem *p, sph__influences *out)
{
    size_t slots;
    if (!sph__multiply_size(p->n, p->limit, &slots)) return sph__fail_memory(p->context);
    out->count = sph__zalloc(p->context, p->n, sizeof *out->count);
    out->places = sph__zalloc(p->context, slots, sizeof *out->places);
    out->weights = sph__zalloc(p->context, slots, sizeof *out->weights);
    return out->count == NULL || out->places == NULL || out->weights == NULL ? sph__fail_memory(p->context) : SPH_OK;
}

void sph__influences_free(const sph__problem *p, sph__influences *influences)
{
    sph__free(p->context, influences->count);
    sph__free(p->context, influences->places);
    sph__free(p->context, influences->weights);
    *influences = (sph__influences){0};
}

void sph__influences_copy(const sph__problem *p, const sph__influences *from, sph__influences *to)
{
    memcpy(to->count, from->count, p->n * sizeof *to->count);
    memcpy(to->places, from->places, (size_t)p->n * p->limit * sizeof *to->places);
    memcpy(to->weights, from->weights, (size_t)p->n * p->limit * sizeof *to->weights);
}

/* --- candidates --- */

/* A cell's bones into a set, rising; where they are too many its own and those nearest to it. */
static void choose(const sph__problem_input *in, uint32_t cell, sph__keyed *order, sph__candidates *set)
{
    const size_t begin = in->reach->starts[cell];
    uint32_t count = (uint32_t)(in->reach->starts[cell + 1] - begin);
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t bone = in->reach->bones[begin + i];
        double d2 = 0;
        for (int k = 0; k < 3; ++k) {
            const double d = in->pivots[3 * (size_t)bone + k] - in->pivots[3 * (size_t)cell + k];
            d2 += d * d;
        }
        if (bone == cell) d2 = 0;
        memcpy(&order[i].key, &d2, sizeof d2); /* not negative: the bits rise with the number */
        order[i].item = bone;
    }
    sph__sort(order, count);
    if (count > SPH__SKIN_MOST_CANDIDATES) count = SPH__SKIN_MOST_CANDIDATES;
    for (uint32_t i = 0; i < count; ++i)
        order[i].key = order[i].item;
    sph__sort(order, count);
    for (uint32_t i = 0; i < count; ++i)
        set->bones[i] = (uint32_t)order[i].item;
    set->count = count;
}

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

static sph_status make_sets(sph__problem *p, const sph__problem_input *in)
{
    size_t bones = 0, pairs = 0;
    sph__keyed *order;
    p->set_count = in->bones;
    for (uint32_t c = 0; c < in->bones; ++c) {
        const size_t count = least(in->reach->starts[c + 1] - in->reach->starts[c], SPH__SKIN_MOST_CANDIDATES);
        bones += count;
        pairs += count * (count + 1) / 2;
        if (count > p->most) p->most = (uint32_t)count;
    }
    p->sets = sph__zalloc(p->context, p->set_count, sizeof *p->sets);
    p->set_bones = sph__alloc(p->context, bones, sizeof *p->set_bones);
    p->set_pairs = sph__alloc(p->context, pairs, sizeof *p->set_pairs);
    order = sph__alloc(p->context, in->reach->most, sizeof *order);
    if (p->sets == NULL || p->set_bones == NULL || p->set_pairs == NULL || order == NULL) {
        sph__free(p->context, order);
        return sph__fail_memory(p->context);
    }
    bones = pairs = 0;
    for (uint32_t c = 0; c < in->bones; ++c) {
        sph__candidates *set = &p->sets[c];
        set->bones = p->set_bones + bones;
        set->pairs = p->set_pairs + pairs;
        choose(in, c, order, set);
        bones += set->count;
        pairs += (size_t)set->count * (set->count + 1) / 2;
    }
    sph__free(p->context, order);
    return SPH_OK;
}

/* --- pairs of bones that may move one vertex --- */

static uint32_t *place_of_pair(const sph__problem *p, uint64_t item)
{
    const sph__candidates *set = &p->sets[item >> 32];
    const uint32_t a = (uint32_t)item >> 16, b = (uint32_t)item & 0xffff;
    return &set->pairs[(size_t)a * (a + 1) / 2 + b];
}

static size_t list_pairs(const sph__problem *p, sph__keyed *keys)
{
    size_t count = 0;
    for (uint32_t s = 0; s < p->set_count; ++s) {
        const sph__candidates *set = &p->sets[s];
        for (uint32_t a = 0; a < set->count; ++a) {
            set->pairs[(size_t)a * (a + 1) / 2 + a] = set->bones[a];
            for (uint32_t b = 0; b < a; ++b)
                keys[count++] = (sph__keyed){(uint64_t)set->bones[a] << 32 | set->bones[b],
                                             (uint64_t)s << 32 | a << 16 | b};
        }
    }
    return count;
}

/* Numbers them, and tells each bone of those it shares vertices with. */
static sph_status number_pairs(sph__problem *p, size_t pair_slots)
{
    sph__keyed *keys = sph__alloc(p->context, pair_slots, sizeof *keys);
    size_t *fill;
    size_t count, different = 0;
    if (keys == NULL) return sph__fail_memory(p->context);
    count = list_pairs(p, keys);
    sph__sort(keys, count);
    for (size_t i = 0; i < count; ++i) {
        if (i == 0 || keys[i].key != keys[i - 1].key) {
            ++different;
            ++p->near_starts[(keys[i].key >> 32) + 1];
            ++p->near_starts[(uint32_t)keys[i].key + 1];
        }
        *place_of_pair(p, keys[i].item) = (uint32_t)(p->bones + different - 1);
    }
    p->pair_count = p->bones + different;
    p->near = sph__alloc(p->context, 2 * different, sizeof *p->near);
    fill = sph__alloc(p->context, p->bones, sizeof *fill);
    if (p->near == NULL || fill == NULL) {
        sph__free(p->context, keys);
        sph__free(p->context, fill);
        return sph__fail_memory(p->context);
    }
    for (uint32_t b = 0; b < p->bones; ++b) {
        fill[b] = p->near_starts[b];
        p->near_starts[b + 1] += p->near_starts[b];
    }
    different = 0;
    for (size_t i = 0; i < count; ++i) {
        const uint32_t a = (uint32_t)(keys[i].key >> 32), b = (uint32_t)keys[i].key;
        const uint32_t pair = (uint32_t)(p->bones + different);
        if (i > 0 && keys[i].key == keys[i - 1].key) continue;
        ++different;
        p->near[fill[a]++] = (sph__neighbour_pair){b, pair};
        p->near[fill[b]++] = (sph__neighbour_pair){a, pair};
    }
    sph__free(p->context, keys);
    sph__free(p->context, fill);
    return SPH_OK;
}

static sph_status make_pairs(sph__problem *p)
{
    size_t slots = 0;
    for (uint32_t s = 0; s < p->set_count; ++s)
        slots += (size_t)p->sets[s].count * (p->sets[s].count + 1) / 2;
    p->near_starts = sph__zalloc(p->context, (size_t)p->bones + 1, sizeof *p->near_starts);
    if (p->near_starts == NULL) return sph__fail_memory(p->context);
    return number_pairs(p, slots);
}

/* --- vertices and frames --- */

static sph_status order_vertices(sph__problem *p, const sph__problem_input *in)
{
    sph__keyed *keys = sph__alloc(p->context, p->n, sizeof *keys);
    if (keys == NULL) return sph__fail_memory(p->context);
    for (uint32_t v = 0; v < p->n; ++v)
        keys[v] = (sph__keyed){in->labels[v], v};
    sph__sort(keys, p->n);
    for (uint32_t v = 0; v < p->n; ++v) {
        p->vertex[v] = (uint32_t)keys[v].item;
        p->set[v] = (uint32_t)keys[v].key;
    }
    sph__free(p->context, keys);
    return SPH_OK;
}

static void find_origin(sph__problem *p, const float *rest)
{
    for (int k = 0; k < 3; ++k) {
        float low = rest[k], high = rest[k];
        for (size_t v = 1; v < p->n; ++v) {
            low = rest[3 * v + k] < low ? rest[3 * v + k] : low;
            high = rest[3 * v + k] > high ? rest[3 * v + k] : high;
        }
        p->origin[k] = 0.5 * ((double)low + (double)high);
    }
}

/*
 * Vertices without area would move as they like: each counts as 1e-6 of the mean at least. Where there is no area at
 * all they count alike.
 */
static void raise_areas(double *areas, uint32_t n)
{
    double sum = 0, floor_area;
    for (uint32_t v = 0; v < n; ++v)
        sum += areas[v];
    floor_area = sum > 0 ? 1e-6 * sum / n : 1;
    for (uint32_t v = 0; v < n; ++v)
        areas[v] = areas[v] > floor_area ? areas[v] : floor_area;
}

static void store_frame(sph__problem *p, uint32_t frame, const float *xyz, const double *areas)
{
    const uint32_t group = frame / SPH__SKIN_LANES, lane = frame % SPH__SKIN_LANES;
    for (size_t v = 0; v < p->n; ++v) {
        float *cell = p->data + ((size_t)group * p->n + v) * SPH__SKIN_CELL + lane;
        const float *x = xyz + 3 * (size_t)p->vertex[v];
        const float area = (float)areas[p->vertex[v]];
        for (int k = 0; k < 3; ++k)
            cell[k * SPH__SKIN_LANES] = (float)((double)x[k] - p->origin[k]);
        cell[3 * SPH__SKIN_LANES] = area;
        p->total[v] += (double)area;
    }
}

static sph_status read_frames(sph__problem *p, const sph__problem_input *in, sph__progress *progress)
{
    double *areas = sph__alloc(p->context, p->n, sizeof *areas);
    sph_status status = areas == NULL ? sph__fail_memory(p->context) : SPH_OK;
    uint32_t frame = 0;
    for (size_t s = 0; s < in->source_count && status == SPH_OK; ++s) {
        const sph_animation *animation = in->sources[s].animation;
        const float *xyz;
        float *scratch = NULL;
        status = sph__animation_scratch(animation, &scratch);
        for (uint32_t f = 0; f < animation->frame_count && status == SPH_OK; ++f, ++frame) {
            status = sph__progress_report(progress, "frames", (double)frame / p->frames);
            if (status == SPH_OK) status = sph__animation_frame(animation, f, scratch, &xyz);
            if (status == SPH_OK) status = sph__check_finite(p->context, f, xyz, p->n);
            if (status != SPH_OK) break;
            sph__cell_areas(in->sources[0].animation->triangles, in->sources[0].animation->triangle_count, xyz, p->n,
                            areas);
            if (in->uniform) memset(areas, 0, p->n * sizeof *areas);
            raise_areas(areas, p->n);
            store_frame(p, frame, xyz, areas);
            p->diagonal += sph__frame_diagonal(xyz, p->n) / p->frames;
        }
        sph__free(animation->context, scratch);
    }
    sph__free(p->context, areas);
    return status;
}

static void pose_at_rest(sph__problem *p)
{
    for (size_t i = 0; i < (size_t)p->groups * p->bones; ++i)
        for (int row = 0; row < 12; ++row)
            for (int lane = 0; lane < SPH__SKIN_LANES; ++lane)
                p->poses[i * SPH__SKIN_POSE + (size_t)row * SPH__SKIN_LANES + lane] = row % 5 == 0;
}

static sph_status allocate(sph__problem *p)
{
    size_t cells, poses;
    if (!sph__multiply_size(p->groups, p->n, &cells) || !sph__multiply_size(p->groups, p->bones, &poses))
        return sph__fail_memory(p->context);
    p->data = sph__zalloc(p->context, cells, SPH__SKIN_CELL * sizeof *p->data);
    p->poses = sph__alloc(p->context, poses, SPH__SKIN_POSE * sizeof *p->poses);
    p->rest = sph__alloc(p->context, p->n, 3 * sizeof *p->rest);
    p->total = sph__zalloc(p->context, p->n, sizeof *p->total);
    p->vertex = sph__alloc(p->context, p->n, sizeof *p->vertex);
    p->set = sph__alloc(p->context, p->n, sizeof *p->set);
    p->still = sph__zalloc(p->context, p->bones, sizeof *p->still);
    if (p->data == NULL || p->poses == NULL || p->rest == NULL || p->total == NULL || p->vertex == NULL ||
        p->set == NULL || p->still == NULL)
        return sph__fail_memory(p->context);
    return sph__influences_allocate(p, &p->now);
}

sph_status sph__problem_init(sph__problem *p, const sph__problem_input *in, sph__progress *progress)
{
    sph_status status;
    *p = (sph__problem){.context = in->context,
                        .n = in->n,
                        .bones = in->bones,
                        .frames = in->frames,
                        .groups = (in->frames + SPH__SKIN_LANES - 1) / SPH__SKIN_LANES,
                        .limit = in->limit,
                        .uniform = in->uniform};
    status = allocate(p);
    if (status == SPH_OK) status = make_sets(p, in);
    if (status == SPH_OK) status = make_pairs(p);
    if (status == SPH_OK) status = order_vertices(p, in);
    if (status != SPH_OK) return status;
    find_origin(p, in->rest);
    for (size_t v = 0; v < p->n; ++v)
        for (int k = 0; k < 3; ++k)
            p->rest[3 * v + k] = (double)in->rest[3 * (size_t)p->vertex[v] + k] - p->origin[k];
    pose_at_rest(p);
    return read_frames(p, in, progress);
}
