/* SPDX-License-Identifier: MIT */
/*
 * Leaves of up to 16 primitives that stay near each other, each of two twigs of up to 8: halves are halved again where
 * the boxes of both, of some frames together, have the least surface. There are no more leaves than the primitives
 * fill.
 */
#include <float.h>

#include "query/query.h"

enum { LEAF = SPH__QUERY_LEAF, TWIG = LEAF / 2, FRAMES = 4 /* at most, that are looked at */ };

typedef struct plan {
    uint32_t count, frames;
    sph__box *boxes; /* [frames][count] */
    sph__keyed *sorted;
    double *ahead;        /* surfaces of the first ones */
    uint32_t *order, *by; /* primitives; in the order that is being tried */
} plan;

typedef struct range {
    uint32_t begin, end;
} range;

/* The boxes of all frames take up a primitive; returns half their surface. */
static double take(const plan *p, sph__box boxes[FRAMES], uint32_t primitive)
{
    double sum = 0;
    for (uint32_t f = 0; f < p->frames; ++f) {
        double side[3];
        sph__box_grow(&boxes[f], &p->boxes[(size_t)f * p->count + primitive]);
        for (int k = 0; k < 3; ++k)
            side[k] = (double)boxes[f].high[k] - boxes[f].low[k];
        sum += side[0] * side[1] + side[1] * side[2] + side[2] * side[0];
    }
    return sum;
}

/* Sorts a range by the middles of boxes. */
static void sort_range(plan *p, range r, uint32_t frame, int axis)
{
    for (uint32_t i = r.begin; i < r.end; ++i) {
        const sph__box *box = &p->boxes[(size_t)frame * p->count + p->order[i]];
        p->sorted[i - r.begin] =
            (sph__keyed){sph__query_rank(box->low[axis] + box->high[axis]) << 32 | p->order[i], p->order[i]};
    }
    sph__sort(p->sorted, r.end - r.begin);
    for (uint32_t i = r.begin; i < r.end; ++i)
        p->by[i] = (uint32_t)p->sorted[i - r.begin].item;
}

static uint32_t leaves_of(uint32_t count, uint32_t size)
{
    return (count + size - 1) / size;
}

/* The best place to part what has been sorted; its cost goes to *least if it is below that. False: it is not. */
static bool part(plan *p, range r, uint32_t size, double *least, uint32_t *middle)
{
    const uint32_t count = r.end - r.begin;
    sph__box boxes[2][FRAMES];
    bool is_better = false;
    for (uint32_t f = 0; f < FRAMES; ++f)
        boxes[0][f] = boxes[1][f] = sph__box_empty();
    for (uint32_t i = 0; i < count; ++i)
        p->ahead[i] = take(p, boxes[0], p->by[r.begin + i]);
    for (uint32_t i = count - 1; i > 0; --i) {
        const double cost = take(p, boxes[1], p->by[r.begin + i]) * (count - i) + p->ahead[i - 1] * i;
        if (leaves_of(i, size) + leaves_of(count - i, size) > leaves_of(count, size) || cost >= *least) continue;
        *least = cost;
        *middle = r.begin + i;
        is_better = true;
    }
    return is_better;
}

/* Puts a range into the order in which it is to be parted, into leaves of this size in the end, and says where. */
static uint32_t halve(plan *p, range r, uint32_t size, uint32_t *best)
{
    uint32_t middle = r.begin + size;
    double least = DBL_MAX;
    memcpy(best + r.begin, p->order + r.begin, (r.end - r.begin) * sizeof *best);
    for (uint32_t f = 0; f < p->frames; ++f)
        for (int axis = 0; axis < 3; ++axis) {
            sort_range(p, r, f, axis);
            if (part(p, r, size, &least, &middle))
                memcpy(best + r.begin, p->by + r.begin, (r.end - r.begin) * sizeof *best);
        }
    memcpy(p->order + r.begin, best + r.begin, (r.end - r.begin) * sizeof *best);
    return middle;
}

static void part_all(plan *p, sph_query *q, uint32_t *best)
{
    range stack[SPH__QUERY_MANY_LEAVES + 1]; /* they do not overlap */
    int top = 0;
    stack[top++] = (range){0, p->count};
    while (top > 0) {
        const range r = stack[--top];
        uint32_t middle;
        if (r.end - r.begin <= LEAF) {
            middle = r.end - r.begin > TWIG ? halve(p, r, TWIG, best) : r.end;
            q->twigs[2 * q->leaf_count] = (uint16_t)r.begin;
            q->twigs[2 * q->leaf_count + 1] = (uint16_t)middle;
            q->twigs[2 * ++q->leaf_count] = (uint16_t)r.end;
            continue;
        }
        middle = halve(p, r, LEAF, best);
        stack[top++] = (range){middle, r.end};
        stack[top++] = (range){r.begin, middle};
    }
}

sph_status sph__query_leaves_build(sph_query *q, uint32_t *order)
{
    const uint32_t count = q->primitive_count;
    plan p = {.count = count, .frames = q->frame_count < FRAMES ? q->frame_count : FRAMES, .order = order};
    uint32_t *best = sph__alloc(q->context, count, sizeof *best);
    bool done;
    p.boxes = sph__alloc(q->context, (size_t)count * FRAMES, sizeof *p.boxes);
    p.sorted = sph__alloc(q->context, count, sizeof *p.sorted);
    p.ahead = sph__alloc(q->context, count, sizeof *p.ahead);
    p.by = sph__alloc(q->context, count, sizeof *p.by);
    done = best != NULL && p.boxes != NULL && p.sorted != NULL && p.ahead != NULL && p.by != NULL;
    for (uint32_t f = 0; done && f < p.frames; ++f) {
        sph_query_pose_frame(q, (uint32_t)((uint64_t)f * q->frame_count / p.frames));
        memcpy(p.boxes + (size_t)f * count, q->solid.boxes, count * sizeof *p.boxes);
    }
    if (done) part_all(&p, q, best);
    sph__free(q->context, best);
    sph__free(q->context, p.boxes);
    sph__free(q->context, p.sorted);
    sph__free(q->context, p.ahead);
    sph__free(q->context, p.by);
    if (done) q->leaf_bounds = sph__zalloc(q->context, q->leaf_count, sizeof *q->leaf_bounds);
    return done && q->leaf_bounds != NULL ? SPH_OK : sph__fail_memory(q->context);
}

/* Nothing meets one that has no primitives. */
static void set_twig(sph_query *q, uint32_t twig)
{
    static const sph__box NOWHERE = {{1e15f, 1e15f, 1e15f}, {1e15f, 1e15f, 1e15f}};
    sph__box box = sph__box_empty();
    for (uint32_t i = q->twigs[twig]; i < q->twigs[twig + 1]; ++i)
        sph__box_grow(&box, &q->solid.boxes[i]);
    q->twig_boxes[twig] = q->twigs[twig] < q->twigs[twig + 1] ? box : NOWHERE;
}

void sph__query_leaves_pose(sph_query *q)
{
    for (uint32_t leaf = 0; leaf < q->leaf_count; ++leaf) {
        const uint32_t begin = q->twigs[2 * leaf], count = q->twigs[2 * leaf + 2] - begin;
        sph__query_leaf *bounds = &q->leaf_bounds[leaf];
        bounds->all = (1u << count) - 1;
        for (size_t row = 0; row < SPH__QUERY_ROWS; ++row)
            memcpy(bounds->rows[row], q->bounds.rows + row * q->bounds.stride + begin, count * sizeof(float));
        set_twig(q, 2 * leaf);
        set_twig(q, 2 * leaf + 1);
    }
}
