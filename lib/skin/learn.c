/* SPDX-License-Identifier: MIT */
#include "skin/learn.h"

#include <math.h>

#include "numeric/simplex_qp.h"
#include "skin/kernel.h"

enum { BATCH = 64 /* blocks whose sums are held at once */, M = SPH__SIMPLEX_QP_MOST };

_Static_assert((int)M >= (int)SPH__SKIN_MOST_CANDIDATES, "a vertex has more candidates than a program variables");

/* Vertices that share their candidates. */
typedef struct block {
    uint32_t begin, end;
} block;

typedef struct learn_job {
    const sph__problem *p;
    const sph__learn_goal *goal;
    sph__influences *next;
    sph__learn_change *changes;
    const block *blocks;
    size_t first;
    double *scratch; /* [BATCH][scratch_size] */
    size_t scratch_size;
} learn_job;

/* One vertex' program. */
typedef struct program {
    uint32_t count;
    double energy[M * M], matrix[M * M], linear[M]; /* rows of `count` numbers; energy: where changes are told */
    double constant;                                /* of the goal */
    double before[M], w[M], kept[M];
    sph__simplex_qp_room room;
} program;

static void fill_matrices(const learn_job *j, size_t v, const double *lanes, program *q)
{
    const uint32_t count = q->count;
    const double share = j->goal->share == NULL ? 1 : j->goal->share[v];
    const double *smooth = j->goal->smooth == NULL ? NULL : j->goal->smooth + v * j->p->most;
    double pull = j->goal->gamma * j->p->total[v], most = 0;
    for (uint32_t a = 0; a < count; ++a)
        for (uint32_t b = 0; b <= a; ++b, lanes += SPH__SKIN_LANES) {
            const double sum =
                ((lanes[0] + lanes[1]) + (lanes[2] + lanes[3])) + ((lanes[4] + lanes[5]) + (lanes[6] + lanes[7]));
            q->matrix[a * count + b] = q->matrix[b * count + a] = share * sum;
            if (j->changes != NULL) q->energy[a * count + b] = q->energy[b * count + a] = sum;
            if (sum > most) most = sum;
        }
    /* Where the frames do not tell weights apart, those before stay. */
    if (smooth == NULL) pull = 1e-10 * most;
    q->constant = 0;
    for (uint32_t a = 0; a < count; ++a) {
        const double to = smooth == NULL ? q->before[a] : share * smooth[a] + (1 - share) * q->before[a];
        q->matrix[a * count + a] += pull;
        q->linear[a] = pull * to;
        q->constant += smooth == NULL ? pull * q->before[a] * q->before[a]
                                      : pull * (share * smooth[a] * smooth[a] +
                                                (1 - share) * q->before[a] * q->before[a]);
    }
}

static double goal_value(const program *q, const double *w)
{
    return sph__simplex_qp_value(q->matrix, q->count, q->linear, q->count, w);
}

static uint32_t support(const program *q, const double *w)
{
    uint32_t used = 0;
    for (uint32_t a = 0; a < q->count; ++a)
        used += w[a] > 0;
    return used;
}

/* Drops the least weights until `limit` are left. */
static void prune(program *q, uint32_t limit, uint8_t *allowed)
{
    double sum = 0;
    for (uint32_t used = support(q, q->w); used > limit; --used) {
        uint32_t least = q->count;
        for (uint32_t a = 0; a < q->count; ++a)
            if (q->w[a] > 0 && (least == q->count || q->w[a] < q->w[least])) least = a;
        q->w[least] = 0;
    }
    for (uint32_t a = 0; a < q->count; ++a) {
        allowed[a] = q->w[a] > 0;
        sum += q->w[a];
    }
    for (uint32_t a = 0; a < q->count; ++a)
        q->w[a] /= sum;
}

/* The least of the goal over all candidates, and where that takes too many bones, over those that matter most. */
static void solve(program *q, uint32_t limit)
{
    uint8_t allowed[M];
    memcpy(q->w, q->before, q->count * sizeof *q->w);
    sph__simplex_qp(q->matrix, q->count, q->linear, q->count, NULL, q->w, &q->room);
    if (support(q, q->w) <= limit) return;
    prune(q, limit, allowed);
    sph__simplex_qp(q->matrix, q->count, q->linear, q->count, allowed, q->w, &q->room);
    if (goal_value(q, q->w) <= goal_value(q, q->before)) return;
    /* The wrong ones went: the bones that there were can only do better than before. */
    memcpy(q->w, q->before, q->count * sizeof *q->w);
    for (uint32_t a = 0; a < q->count; ++a)
        allowed[a] = q->before[a] > 0;
    sph__simplex_qp(q->matrix, q->count, q->linear, q->count, allowed, q->w, &q->room);
}

static void unpack(const sph__problem *p, const sph__influences *from, size_t v, program *q)
{
    memset(q->before, 0, q->count * sizeof *q->before);
    for (uint32_t s = 0; s < from->count[v]; ++s)
        q->before[from->places[v * p->limit + s]] = from->weights[v * p->limit + s];
}

static void pack(const sph__problem *p, const program *q, sph__influences *to, size_t v)
{
    uint32_t count = 0;
    for (uint32_t a = 0; a < q->count && count < p->limit; ++a) {
        if (!(q->w[a] > 0)) continue;
        to->places[v * p->limit + count] = a;
        to->weights[v * p->limit + count++] = q->w[a];
    }
    to->count[v] = count;
}

static void report(const learn_job *j, size_t v, const program *q)
{
    sph__learn_change *c = &j->changes[v];
    c->before = sph__simplex_qp_value(q->energy, q->count, NULL, q->count, q->before);
    c->after = sph__simplex_qp_value(q->energy, q->count, NULL, q->count, q->w);
    c->goal_before = goal_value(q, q->before) + q->constant;
    c->goal_after = goal_value(q, q->w) + q->constant;
    c->distance = 0;
    for (uint32_t a = 0; a < q->count; ++a)
        c->distance += (q->w[a] - q->before[a]) * (q->w[a] - q->before[a]);
}

static void learn_block(const learn_job *j, const block *b, double *scratch)
{
    const sph__problem *p = j->p;
    const size_t count = p->sets[p->set[b->begin]].count, pairs = count * (count + 1) / 2;
    double *offsets = scratch, *sums = scratch + (size_t)p->most * 3 * SPH__SKIN_LANES;
    program *q = (program *)(sums + (size_t)(b->end - b->begin) * pairs * SPH__SKIN_LANES);
    sph__skin_kernel_residual_gram(p, b->begin, b->end, sums, offsets);
    q->count = (uint32_t)count;
    for (size_t v = b->begin; v < b->end; ++v) {
        unpack(p, &p->now, v, q);
        fill_matrices(j, v, sums + (v - b->begin) * pairs * SPH__SKIN_LANES, q);
        if (p->fixed != NULL && p->fixed[v])
            memcpy(q->w, q->before, count * sizeof *q->w);
        else
            solve(q, p->limit);
        pack(p, q, j->next, v);
        if (j->changes != NULL) report(j, v, q);
    }
}

static void learn_range(void *argument, size_t begin, size_t end)
{
    const learn_job *j = argument;
    for (size_t i = begin; i < end; ++i)
        learn_block(j, &j->blocks[j->first + i], j->scratch + i * j->scratch_size);
}

/* Few vertices at a time where they have many candidates: their sums should stay in the cache. */
static uint32_t block_size(const sph__problem *p)
{
    return p->most <= 16 ? SPH__SKIN_BLOCK : p->most <= 32 ? 4 : 2;
}

static block *make_blocks(const sph__problem *p, size_t *count)
{
    const uint32_t size = block_size(p);
    block *blocks = sph__alloc(p->context, p->n, sizeof *blocks);
    *count = 0;
    for (uint32_t v = 0; v < p->n && blocks != NULL;) {
        const uint32_t begin = v++;
        while (v < p->n && v - begin < size && p->set[v] == p->set[begin])
            ++v;
        blocks[(*count)++] = (block){begin, v};
    }
    return blocks;
}

sph_status sph__learn_weights(const sph__problem *p, const sph__learn_goal *goal, sph__influences *next,
                              sph__learn_change *changes)
{
    const size_t pairs = (size_t)p->most * (p->most + 1) / 2;
    learn_job j = {.p = p, .goal = goal, .next = next, .changes = changes};
    size_t count;
    block *blocks = make_blocks(p, &count);
    sph_status status = SPH_OK;
    j.blocks = blocks;
    j.scratch_size = ((size_t)p->most * 3 + block_size(p) * pairs) * SPH__SKIN_LANES + sizeof(program) / sizeof(double);
    j.scratch_size = (j.scratch_size + SPH__SKIN_LANES - 1) / SPH__SKIN_LANES * SPH__SKIN_LANES;
    j.scratch = sph__alloc(p->context, BATCH * j.scratch_size, sizeof *j.scratch);
    if (blocks == NULL || j.scratch == NULL) status = sph__fail_memory(p->context);
    for (; status == SPH_OK && j.first < count; j.first += BATCH) {
        const size_t left = count - j.first;
        sph__parallel_for(p->context, left < BATCH ? left : BATCH, 1, learn_range, &j);
    }
    sph__free(p->context, blocks);
    sph__free(p->context, j.scratch);
    return status;
}
