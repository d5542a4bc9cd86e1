/* SPDX-License-Identifier: MIT */
/*
 * Welding with a tolerance. Vertices go in order of their index: each joins the lowest leader that it is close to in
 * all frames, or becomes a leader. Most groups of the partition are close to their lowest vertex altogether, which one
 * pass over the frames tells. The members of the others are gathered with all their frames, and leaders are looked up
 * in a grid over the frame in which the group is widest.
 */
#include <math.h>

#include "animation/weld.h"

static const char STAGE[] = "comparing close vertices";

/* Cells are a little wider than the tolerance: rounding must not put two close vertices two cells apart. */
static const double CELL_MARGIN = 1.001;

#define NONE UINT32_MAX

/* What a pass over the frames finds out about one group. */
typedef struct group {
    uint32_t begin, end;   /* in the partition's members, which are ascending here */
    uint32_t widest_frame; /* where its box has the most cells */
    double cells;
    bool compact; /* all members are close to the first in all frames seen */
} group;

/* The members of one group that is not compact, with their positions in all frames: [slot][F][3]. */
typedef struct cluster {
    sph__weld *weld;
    const uint32_t *members; /* of slot 0 ...; the partition's, so the last one is marked */
    const float *positions;
    uint32_t count, frame;
    uint32_t done; /* slots of all groups */
    double cell;
    size_t mask;
    uint32_t *heads; /* by hashed cell: the last leader put there; a slot */
    uint32_t *next;  /* by slot: the leader before it in its chain */
} cluster;

static uint32_t vertex_of(uint32_t member)
{
    return member & ~SPH__GROUP_END;
}

static bool close_by(const float *a, const float *b, double tolerance)
{
    return fabs((double)a[0] - b[0]) <= tolerance && fabs((double)a[1] - b[1]) <= tolerance &&
           fabs((double)a[2] - b[2]) <= tolerance;
}

/* --- groups that are compact --- */

static uint32_t sort_members(sph__partition *p)
{
    uint32_t groups = 0;
    for (uint32_t begin = 0, end; begin < p->member_count; begin = end, ++groups) {
        end = sph__group_end(p, begin);
        for (uint32_t i = begin; i < end; ++i)
            p->keys[i - begin] = vertex_of(p->members[i]);
        sph__sort_keys(p->keys, p->scratch, end - begin);
        for (uint32_t i = begin; i < end; ++i)
            p->members[i] = (uint32_t)p->keys[i - begin];
        p->members[end - 1] |= SPH__GROUP_END;
    }
    return groups;
}

static void measure_group(const sph__weld *weld, group *g, uint32_t frame, const float *xyz)
{
    const uint32_t *members = weld->partition.members;
    const float *first = xyz + 3 * (size_t)vertex_of(members[g->begin]);
    float low[3] = {first[0], first[1], first[2]}, high[3] = {first[0], first[1], first[2]};
    double cells = 1;
    for (uint32_t i = g->begin + 1; i < g->end; ++i) {
        const float *v = xyz + 3 * (size_t)vertex_of(members[i]);
        for (size_t k = 0; k < 3; ++k) {
            low[k] = v[k] < low[k] ? v[k] : low[k];
            high[k] = v[k] > high[k] ? v[k] : high[k];
        }
        if (g->compact && !close_by(first, v, weld->tolerance)) g->compact = false;
    }
    for (size_t k = 0; k < 3; ++k)
        cells *= 1 + ((double)high[k] - low[k]) / weld->tolerance;
    if (cells > g->cells) {
        g->cells = cells;
        g->widest_frame = frame;
    }
}

static sph_status measure_groups(sph__weld *weld, group *groups, uint32_t group_count)
{
    const sph__partition *p = &weld->partition;
    sph_status status = SPH_OK;
    for (uint32_t g = 0, begin = 0; g < group_count; ++g) {
        groups[g] = (group){.begin = begin, .end = sph__group_end(p, begin), .compact = true};
        begin = groups[g].end;
    }
    for (uint32_t f = 0; status == SPH_OK && f < weld->animation->frame_count; ++f) {
        const float *xyz;
        status = sph__weld_frame(weld, STAGE, f, &xyz);
        for (uint32_t g = 0; status == SPH_OK && g < group_count; ++g)
            measure_group(weld, &groups[g], f, xyz);
    }
    return status;
}

/* Settles the compact groups and closes the gaps they leave; returns how many groups remain. */
static uint32_t settle_compact(sph__weld *weld, group *groups, uint32_t group_count)
{
    sph__partition *p = &weld->partition;
    uint32_t kept = 0, written = 0;
    for (uint32_t g = 0; g < group_count; ++g) {
        const uint32_t first = vertex_of(p->members[groups[g].begin]);
        const uint32_t count = groups[g].end - groups[g].begin;
        if (groups[g].compact) {
            for (uint32_t i = groups[g].begin; i < groups[g].end; ++i)
                weld->leaders[vertex_of(p->members[i])] = first;
            continue;
        }
        memmove(p->members + written, p->members + groups[g].begin, count * sizeof *p->members);
        groups[kept] = groups[g];
        groups[kept].begin = written;
        groups[kept++].end = written += count;
    }
    p->member_count = written;
    return kept;
}

/* --- the others --- */

/* The cell of a slot in the frame that the grid is of, moved by (dx, dy, dz) cells, as a place in `heads`. */
static size_t cell_of(const cluster *c, uint32_t slot, int dx, int dy, int dz)
{
    const float *v = c->positions + ((size_t)slot * c->weld->animation->frame_count + c->frame) * 3;
    const double cell[3] = {floor(v[0] / c->cell) + dx, floor(v[1] / c->cell) + dy, floor(v[2] / c->cell) + dz};
    uint64_t hash = 0;
    for (size_t k = 0; k < 3; ++k) {
        const double positive = cell[k] + 0.0; /* -0 becomes 0 */
        uint64_t bits;
        memcpy(&bits, &positive, sizeof bits);
        hash = (hash ^ bits) * UINT64_C(0x9e3779b97f4a7c15);
        hash ^= hash >> 32;
    }
    return (size_t)hash & c->mask;
}

static bool close_in_all_frames(const cluster *c, uint32_t slot, uint32_t other)
{
    const size_t frames = c->weld->animation->frame_count;
    const float *a = c->positions + slot * frames * 3, *b = c->positions + other * frames * 3;
    for (size_t f = 0; f < frames; ++f)
        if (!close_by(b + 3 * f, a + 3 * f, c->weld->tolerance)) return false;
    return true;
}

/* The lowest leader that the slot is close to, or NONE. */
static uint32_t find_leader(const cluster *c, uint32_t slot)
{
    uint32_t best = NONE;
    for (int around = 0; around < 27; ++around) {
        const size_t place = cell_of(c, slot, around % 3 - 1, around / 3 % 3 - 1, around / 9 - 1);
        for (uint32_t leader = c->heads[place]; leader != NONE; leader = c->next[leader])
            if (leader < best && close_in_all_frames(c, slot, leader)) best = leader;
    }
    return best;
}

static sph_status lead_cluster(cluster *c)
{
    enum { SLOTS_PER_REPORT = 4096 };
    memset(c->heads, 0xff, (c->mask + 1) * sizeof *c->heads);
    for (uint32_t slot = 0; slot < c->count; ++slot) {
        const uint32_t leader = find_leader(c, slot);
        if (++c->done % SLOTS_PER_REPORT == 0) {
            const double fraction = (double)c->done / c->weld->partition.member_count;
            const sph_status status = sph__progress_report(&c->weld->progress, STAGE, fraction);
            if (status != SPH_OK) return status;
        }
        if (leader == NONE) {
            const size_t place = cell_of(c, slot, 0, 0, 0);
            c->next[slot] = c->heads[place];
            c->heads[place] = slot;
        } else {
            c->weld->leaders[vertex_of(c->members[slot])] = vertex_of(c->members[leader]);
        }
    }
    return SPH_OK;
}

/* Positions of the partition's members in all frames, [member][F][3]. */
static sph_status gather(sph__weld *weld, float *positions)
{
    const sph__partition *p = &weld->partition;
    const size_t frames = weld->animation->frame_count;
    for (uint32_t f = 0; f < frames; ++f) {
        const float *xyz;
        const sph_status status = sph__weld_frame(weld, STAGE, f, &xyz);
        if (status != SPH_OK) return status;
        for (uint32_t i = 0; i < p->member_count; ++i)
            memcpy(positions + (i * frames + f) * 3, xyz + 3 * (size_t)vertex_of(p->members[i]), 3 * sizeof *xyz);
    }
    return SPH_OK;
}

static sph_status lead_clusters(sph__weld *weld, const group *groups, uint32_t group_count, cluster *c,
                                const float *positions)
{
    const size_t frames = weld->animation->frame_count;
    sph_status status = SPH_OK;
    for (uint32_t g = 0; status == SPH_OK && g < group_count; ++g) {
        c->members = weld->partition.members + groups[g].begin;
        c->positions = positions + groups[g].begin * frames * 3;
        c->count = groups[g].end - groups[g].begin;
        c->frame = groups[g].widest_frame;
        for (c->mask = 15; c->mask < c->count; c->mask = 2 * c->mask + 1)
            continue;
        status = lead_cluster(c);
    }
    return status;
}

static sph_status settle_others(sph__weld *weld, const group *groups, uint32_t group_count)
{
    const sph_context *context = weld->animation->context;
    cluster c = {.weld = weld, .cell = weld->tolerance * CELL_MARGIN};
    const size_t frames = weld->animation->frame_count, members = weld->partition.member_count;
    sph_status status = SPH_OK;
    size_t count;
    float *positions = NULL;
    if (sph__multiply_size(frames, members, &count)) positions = sph__alloc(context, count, 3 * sizeof *positions);
    c.heads = sph__alloc(context, 2 * members + 16, sizeof *c.heads);
    c.next = sph__alloc(context, members, sizeof *c.next);
    if (positions == NULL || c.heads == NULL || c.next == NULL) status = sph__fail_memory(context);
    sph__progress_part(&weld->progress, 0.1);
    if (status == SPH_OK) status = gather(weld, positions);
    sph__progress_part(&weld->progress, 0.2);
    if (status == SPH_OK) status = lead_clusters(weld, groups, group_count, &c, positions);
    sph__free(context, positions);
    sph__free(context, c.heads);
    sph__free(context, c.next);
    return status;
}

sph_status sph__weld_within_tolerance(sph__weld *weld)
{
    const sph_context *context = weld->animation->context;
    uint32_t group_count = sort_members(&weld->partition);
    group *groups = sph__alloc(context, group_count, sizeof *groups);
    sph_status status;
    if (groups == NULL) return sph__fail_memory(context);
    sph__progress_part(&weld->progress, 0.2);
    status = measure_groups(weld, groups, group_count);
    if (status == SPH_OK) group_count = settle_compact(weld, groups, group_count);
    if (status == SPH_OK && group_count > 0)
        status = settle_others(weld, groups, group_count);
    else
        sph__progress_part(&weld->progress, 0.3); /* what it would have taken */
    sph__free(context, groups);
    return status;
}
