/* SPDX-License-Identifier: MIT */
/*
 * Welding: a partition of the vertices is refined frame by frame, so that the frames need never be in memory at once;
 * with tolerance 0 that is the answer. What has to be compared pair by pair with a tolerance is in cluster.c.
 */
#include <math.h>

#include "animation/weld.h"

sph_status sph__weld_frame(sph__weld *weld, const char *stage, uint32_t frame, const float **xyz)
{
    const sph_animation *a = weld->animation;
    sph_status status = sph__progress_report(&weld->progress, stage, (double)frame / a->frame_count);
    if (status == SPH_OK) status = sph__animation_frame(a, frame, weld->scratch, xyz);
    if (status == SPH_OK) status = sph__check_finite(a->context, frame, *xyz, a->vertex_count);
    return status;
}

static sph_status find_groups(sph__weld *weld)
{
    const sph_animation *a = weld->animation;
    sph_status status = sph__partition_init(&weld->partition, a->context, a->vertex_count);
    for (uint32_t f = 0; status == SPH_OK && f < a->frame_count; ++f) {
        const float *xyz;
        status = sph__weld_frame(weld, "comparing vertices", f, &xyz);
        if (status == SPH_OK) sph__partition_refine(&weld->partition, xyz, weld->tolerance);
    }
    return status;
}

/* The lowest vertex of each group stands for it. */
static void lead_groups(sph__weld *weld)
{
    const sph__partition *p = &weld->partition;
    for (uint32_t begin = 0, end; begin < p->member_count; begin = end) {
        uint32_t lowest = UINT32_MAX;
        end = sph__group_end(p, begin);
        for (uint32_t i = begin; i < end; ++i) {
            const uint32_t vertex = p->members[i] & ~SPH__GROUP_END;
            lowest = vertex < lowest ? vertex : lowest;
        }
        for (uint32_t i = begin; i < end; ++i)
            weld->leaders[p->members[i] & ~SPH__GROUP_END] = lowest;
    }
}

/* Numbers the leaders in their order, and makes `leaders` the map from old to new. Leaders come before who they lead.
 */
static uint32_t number_leaders(uint32_t *leaders, uint32_t n)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < n; ++i)
        leaders[i] = leaders[i] == i ? count++ : leaders[leaders[i]];
    return count;
}

static sph_status copy_frames(sph__weld *weld, sph_animation *out)
{
    const sph_animation *a = weld->animation;
    for (uint32_t f = 0; f < a->frame_count; ++f) {
        float *to = out->positions + (size_t)f * out->vertex_count * 3;
        const float *xyz;
        uint32_t next = 0;
        const sph_status status = sph__weld_frame(weld, "copying frames", f, &xyz);
        if (status != SPH_OK) return status;
        for (uint32_t i = 0; i < a->vertex_count; ++i)
            if (weld->leaders[i] == next) memcpy(to + 3 * (size_t)next++, xyz + 3 * (size_t)i, 3 * sizeof *to);
    }
    return SPH_OK;
}

/* Maps one simplex into `row`; false where it names a vertex twice then. */
static bool map_simplex(const sph__weld *weld, const uint32_t *from, uint32_t corners, uint32_t *row)
{
    for (uint32_t k = 0; k < corners; ++k)
        row[k] = weld->leaders[from[k]];
    return !sph__names_vertex_twice(row, corners);
}

static sph_status map_simplices(const sph__weld *weld, const uint32_t *from, size_t count, uint32_t corners,
                                uint32_t **to, size_t *kept)
{
    uint32_t row[3];
    size_t left = 0, next = 0;
    for (size_t s = 0; s < count; ++s)
        left += map_simplex(weld, from + corners * s, corners, row);
    if (left == 0) return SPH_OK;
    *to = sph__alloc(weld->animation->context, left, corners * sizeof **to);
    if (*to == NULL) return sph__fail_memory(weld->animation->context);
    for (size_t s = 0; s < count; ++s)
        if (map_simplex(weld, from + corners * s, corners, row))
            memcpy(*to + corners * next++, row, corners * sizeof *row);
    *kept = left;
    return SPH_OK;
}

static sph_status build_welded(sph__weld *weld, uint32_t count, sph_animation **out)
{
    const sph_animation *a = weld->animation;
    sph_status status = sph_animation_create(a->context, count, a->frame_count, out);
    if (status != SPH_OK) return status;
    status = map_simplices(weld, a->triangles, a->triangle_count, 3, &(*out)->triangles, &(*out)->triangle_count);
    if (status == SPH_OK) status = map_simplices(weld, a->edges, a->edge_count, 2, &(*out)->edges, &(*out)->edge_count);
    if (status == SPH_OK) status = copy_frames(weld, *out);
    if (status == SPH_OK) status = sph__progress_report(&weld->progress, "copying frames", 1);
    if (status == SPH_OK) return SPH_OK;
    sph_animation_destroy(*out);
    *out = NULL;
    return status;
}

static sph_status run_weld(sph__weld *weld, uint32_t *map, sph_animation **out)
{
    const sph_animation *a = weld->animation;
    const uint32_t n = a->vertex_count;
    sph_status status = sph__animation_scratch(a, &weld->scratch);
    if (status != SPH_OK) return status;
    weld->leaders = sph__alloc(a->context, n, sizeof *weld->leaders);
    if (weld->leaders == NULL) return sph__fail_memory(a->context);
    for (uint32_t i = 0; i < n; ++i)
        weld->leaders[i] = i;
    sph__progress_part(&weld->progress, weld->tolerance > 0 ? 0.3 : 0.8);
    status = find_groups(weld);
    if (status == SPH_OK && weld->tolerance > 0) status = sph__weld_within_tolerance(weld);
    if (status == SPH_OK && weld->tolerance == 0) lead_groups(weld);
    sph__partition_free(&weld->partition);
    sph__progress_part(&weld->progress, 0.2);
    if (status == SPH_OK) status = build_welded(weld, number_leaders(weld->leaders, n), out);
    if (status == SPH_OK && map != NULL) memcpy(map, weld->leaders, n * sizeof *map);
    return status;
}

sph_status sph_animation_weld(const sph_animation *animation, float tolerance, uint32_t *map, sph_animation **out)
{
    SPH__OWN(animation, SPH__ANIMATION);
    sph__weld weld = {.animation = animation, .tolerance = tolerance};
    sph_status status;
    if (out != NULL) *out = NULL;
    if (animation == NULL) return SPH_E_INVALID;
    if (out == NULL) return sph__fail(animation->context, SPH_E_INVALID, "weld: out is NULL");
    if (!(tolerance >= 0) || !isfinite(tolerance))
        return sph__fail(animation->context, SPH_E_INVALID, "weld: the tolerance %g must be finite and not negative",
                         (double)tolerance);
    weld.partition.context = animation->context;
    sph__progress_begin(&weld.progress, animation->context);
    status = run_weld(&weld, map, out);
    sph__partition_free(&weld.partition);
    sph__free(animation->context, weld.leaders);
    sph__free(animation->context, weld.scratch);
    return status;
}
