/* SPDX-License-Identifier: MIT */
/* Collapses by the error of the posed mesh, the cheapest first. */
#include <math.h>

#include "hierarchy/inversion.h"
#include "simplify/simplify.h"

/* What an edge becomes. */
typedef struct merge {
    double error;
    double rest[3], way; /* how far from u to v, for what is blended */
    uint32_t count, bones[SPH__SIMPLIFY_BONES];
    double weights[SPH__SIMPLIFY_BONES];
} merge;

static sph__posed posed_of(const sph__simplifier *b, uint32_t point)
{
    return (sph__posed){sph__block_of(b, point), sph__center_of(b, point), b->costs[b->slot_of[point]]};
}

/* Adds the weights of a point to those of the union; bones that are not among them yet come after. */
static void add_bones(const sph__simplifier *b, uint32_t point, uint32_t *bones, uint32_t *count, double *weights)
{
    const size_t first = (size_t)point * b->wide;
    for (uint32_t s = 0; s < b->wide && b->weights[first + s] > 0; ++s) {
        uint32_t at = 0;
        while (at < *count && bones[at] != b->bones[first + s])
            ++at;
        if (at == *count) bones[(*count)++] = b->bones[first + s];
        weights[at] = (double)b->weights[first + s];
    }
}

static void rest_of(const sph__simplifier *b, uint32_t point, double rest[3])
{
    for (int c = 0; c < 3; ++c)
        rest[c] = (double)b->rest[3 * (size_t)point + c];
}

/* How far along the edge, which begins at 0, a place is. */
static double way_along(const double edge[3], const double x[3])
{
    const double along = edge[0] * edge[0] + edge[1] * edge[1] + edge[2] * edge[2];
    double way = along > 0 ? (edge[0] * x[0] + edge[1] * x[1] + edge[2] * x[2]) / along : 0.5;
    return way > 0 ? (way < 1 ? way : 1) : 0;
}

/* The two ends, and their mean. */
static void make_trials(const sph__solver *solver, uint32_t count, const double *u, const double *v,
                        sph__trial trials[3])
{
    for (int i = 0; i < 3; ++i) {
        const double way = i == 2 ? 0.5 : i;
        for (int c = 0; c < 3; ++c)
            trials[i].x[c] = way * solver->edge[c];
        for (uint32_t k = 0; k < count; ++k)
            trials[i].weights[k] = u[k] + way * (v[k] - u[k]);
    }
}

/* The form of an edge: with all bones of its ends, or where the rest pose is looked at with the identity alone. */
static void make_form(const sph__simplifier *b, uint32_t u, uint32_t v, const merge *m, sph__solver *solver)
{
    static const uint32_t SINGLE = 0;
    const sph__posed pu = posed_of(b, u), pv = posed_of(b, v);
    const bool single = b->transform_count == 1;
    double anchor[3];
    rest_of(b, u, anchor);
    solver->form.count = single ? 1 : m->count;
    sph__kernel_form(&pu, &pv, b->stride, b->transforms, b->transform_count, single ? &SINGLE : m->bones, anchor,
                     solver->room, &solver->form);
}

/* Minimises; the trial is of the form's bones. Returns the way along the edge that other values go. */
static double minimise(const sph__simplifier *b, sph__solver *solver, uint32_t fixed, sph__trial trials[3],
                       sph__trial *best)
{
    int least = 0;
    for (int i = 0; i < 3; ++i) {
        trials[i].error = sph__form_error(&solver->form, trials[i].x, trials[i].weights);
        if (trials[i].error < trials[least].error) least = i;
    }
    if (fixed != 0) least = fixed == 1 ? 0 : 1;
    *best = trials[least];
    if (fixed != 0) return least;
    if (b->o.method == SPH_SIMPLIFY_SKINNED)
        sph__solve_limited(solver, b->wide, best);
    else
        sph__solve_position(solver, best);
    if (b->o.method == SPH_SIMPLIFY_POSITION) return least == 2 ? 0.5 : least;
    return way_along(solver->edge, best->x);
}

static void evaluate(const sph__simplifier *b, uint32_t edge, sph__solver *solver, merge *m)
{
    double at_u[SPH__SIMPLIFY_BONES] = {0}, at_v[SPH__SIMPLIFY_BONES] = {0}, rest_u[3], rest_v[3];
    const double one = 1;
    sph__trial trials[3], best;
    uint32_t u, v;
    sph__edge_ends(&b->mesh, edge, &u, &v);
    m->count = 0;
    add_bones(b, u, m->bones, &m->count, at_u);
    add_bones(b, v, m->bones, &m->count, at_v);
    rest_of(b, u, rest_u);
    rest_of(b, v, rest_v);
    for (int c = 0; c < 3; ++c)
        solver->edge[c] = rest_v[c] - rest_u[c];
    make_form(b, u, v, m, solver);
    if (b->transform_count == 1)
        make_trials(solver, 1, &one, &one, trials);
    else
        make_trials(solver, m->count, at_u, at_v, trials);
    m->way = minimise(b, solver, b->locked[u] ? 1 : b->locked[v] ? 2 : 0, trials, &best);
    m->error = best.error > 0 ? best.error : 0;
    for (int c = 0; c < 3; ++c)
        m->rest[c] = rest_u[c] + best.x[c];
    for (uint32_t k = 0; k < m->count; ++k)
        m->weights[k] = b->o.method == SPH_SIMPLIFY_SKINNED && b->transform_count > 1
                            ? best.weights[k]
                            : at_u[k] + m->way * (at_v[k] - at_u[k]);
}

static bool is_fixed(const sph__simplifier *b, uint32_t edge)
{
    uint32_t u, v;
    sph__edge_ends(&b->mesh, edge, &u, &v);
    return b->locked[u] && b->locked[v];
}

/* The errors of the fresh edges, each block in a room of its own. */
typedef struct task {
    sph__simplifier *b;
    size_t grain;
} task;

static void evaluate_range(void *argument, size_t begin, size_t end)
{
    const task *t = argument;
    sph__solver *solver = &t->b->rooms[begin / t->grain];
    for (size_t i = begin; i < end; ++i) {
        merge m;
        evaluate(t->b, t->b->fresh[i], solver, &m);
        t->b->fresh_costs[i] = m.error;
    }
}

static void push_fresh(sph__simplifier *b)
{
    task t = {b, (b->fresh_count + SPH__SIMPLIFY_ROOMS - 1) / SPH__SIMPLIFY_ROOMS};
    if (b->fresh_count == 0) return;
    sph__parallel_for(b->context, b->fresh_count, t.grain, evaluate_range, &t);
    for (size_t i = 0; i < b->fresh_count; ++i)
        sph__edge_queue_set(&b->queue, &b->mesh, b->fresh[i], b->fresh_costs[i]);
    b->fresh_count = 0;
}

static sph_status add_fresh(sph__simplifier *b, uint32_t edge)
{
    if (is_fixed(b, edge)) { /* it may have been in the queue before one end was united with what is locked */
        sph__edge_queue_take(&b->queue, &b->mesh, edge);
        return SPH_OK;
    }
    if (!sph__reserve(b->context, (void **)&b->fresh, &b->fresh_capacity, b->fresh_count + 1, sizeof *b->fresh) ||
        !sph__reserve(b->context, (void **)&b->fresh_costs, &b->fresh_cost_capacity, b->fresh_count + 1,
                      sizeof *b->fresh_costs))
        return sph__fail_memory(b->context);
    b->fresh[b->fresh_count++] = edge;
    return SPH_OK;
}

static sph_status fill_queue(sph__simplifier *b)
{
    enum { WAVE = 4096 };
    sph_status status = sph__edge_queue_reserve(&b->queue, &b->mesh);
    for (uint32_t e = 0; e < b->mesh.edge_count && status == SPH_OK; ++e) {
        status = add_fresh(b, e);
        if (status != SPH_OK || (b->fresh_count < WAVE && e + 1 < b->mesh.edge_count)) continue;
        status = sph__progress_report(&b->progress, "evaluation", (double)e / b->mesh.edge_count);
        if (status == SPH_OK) push_fresh(b);
    }
    if (status == SPH_OK) push_fresh(b);
    return status;
}

/* Whether the ends have a neighbour in common beyond the triangles that go: the surface would be pinched there. */
static bool pinches(sph__simplifier *b, uint32_t u, uint32_t v, uint32_t w)
{
    const uint32_t *u_edges = sph__edges_of(&b->mesh, u), *v_edges = sph__edges_of(&b->mesh, v);
    const uint32_t *triangles = sph__triangles_of(&b->mesh, u);
    uint32_t shared = 0;
    for (uint32_t i = 0; i < sph__edge_count_of(&b->mesh, u); ++i)
        b->mesh.nodes[sph__edge_other(&b->mesh, u_edges[i], u)].mark = w;
    for (uint32_t i = 0; i < sph__edge_count_of(&b->mesh, v); ++i)
        shared += b->mesh.nodes[sph__edge_other(&b->mesh, v_edges[i], v)].mark == w;
    for (uint32_t i = 0; i < sph__edge_count_of(&b->mesh, u); ++i)
        b->mesh.nodes[sph__edge_other(&b->mesh, u_edges[i], u)].mark = 0;
    for (uint32_t i = 0; i < sph__triangle_count_of(&b->mesh, u) && shared > 0; ++i) {
        uint32_t x[2];
        sph__triangle_others(&b->mesh, triangles[i], u, x);
        shared -= x[0] == v || x[1] == v;
    }
    return shared > 0;
}

/* A point of another, to the bit, as collapses see it and as it leaves the library. */
static void copy_point(sph__simplifier *b, uint32_t from, uint32_t to)
{
    sph_progressive *p = b->p;
    const size_t slots = p->slots, wide = b->wide;
    memcpy(p->rest + 3 * (size_t)to, p->rest + 3 * (size_t)from, 3 * sizeof *p->rest);
    memcpy(p->bones + to * slots, p->bones + from * slots, slots * sizeof *p->bones);
    memcpy(p->weights + to * slots, p->weights + from * slots, slots * sizeof *p->weights);
    memcpy(b->rest + 3 * (size_t)to, b->rest + 3 * (size_t)from, 3 * sizeof *b->rest);
    memcpy(b->bones + to * wide, b->bones + from * wide, wide * sizeof *b->bones);
    memcpy(b->weights + to * wide, b->weights + from * wide, wide * sizeof *b->weights);
}

/* The point w, as it will be. */
static void place_merged(sph__simplifier *b, uint32_t u, uint32_t v, uint32_t w, merge *m)
{
    b->locked[w] = b->locked[u] || b->locked[v];
    if (b->locked[w]) {
        copy_point(b, b->locked[u] ? u : v, w);
    } else {
        for (int c = 0; c < 3; ++c)
            b->rest[3 * (size_t)w + c] = (float)m->rest[c];
        sph__weights_order(m->bones, m->weights, m->count, b->wide, b->bones + (size_t)w * b->wide,
                           b->weights + (size_t)w * b->wide);
    }
    sph__simplify_place(b, w, b->new_center);
}

/* The point as it leaves the library, with no more bones than are asked for: pruned, and minimised again. Returns its
 * error. */
static double show_point(sph__simplifier *b, uint32_t w)
{
    sph_progressive *p = b->p;
    sph__solver *solver = &b->rooms[0];
    const sph__posed own = posed_of(b, w), none = {b->zeros, own.center, 0};
    uint32_t bones[SPH__SIMPLIFY_BONES];
    double rest[3];
    sph__trial trial = {.x = {0, 0, 0}};
    uint32_t count = 0;
    add_bones(b, w, bones, &count, trial.weights);
    rest_of(b, w, rest);
    trial.error = own.constant;
    if (count > p->slots && b->o.method == SPH_SIMPLIFY_SKINNED && !b->locked[w]) {
        for (int c = 0; c < 3; ++c)
            solver->edge[c] = 0;
        solver->form.count = count;
        sph__kernel_form(&own, &none, b->stride, b->transforms, b->transform_count, bones, rest, solver->room,
                         &solver->form);
        sph__solve_limited(solver, p->slots, &trial);
    }
    if (b->locked[w]) return trial.error;
    for (int c = 0; c < 3; ++c)
        p->rest[3 * (size_t)w + c] = (float)(rest[c] + trial.x[c]);
    sph__weights_order(bones, trial.weights, count, p->slots, p->bones + (size_t)w * p->slots,
                       p->weights + (size_t)w * p->slots);
    return trial.error > 0 ? trial.error : 0;
}

static void record_level(sph__simplifier *b, double worst, bool forced)
{
    sph_progressive *p = b->p;
    const uint32_t level = p->collapse_count;
    const double error = b->live_area > 0 && b->live_cost > 0 ? sqrt(b->live_cost / b->live_area) / b->scale : 0;
    p->vertex_counts[level] = b->vertex_count;
    p->triangle_counts[level] = b->triangle_count;
    p->errors[level] = level > 0 && p->errors[level - 1] > error ? p->errors[level - 1] : error;
    p->max_errors[level] = level > 0 && p->max_errors[level - 1] > worst ? p->max_errors[level - 1] : worst;
    if (forced && p->first_forced == SPH__NO_NODE) p->first_forced = level;
}

/* Quadrics and slots; w takes over that of u. */
static double unite_quadrics(sph__simplifier *b, uint32_t u, uint32_t v, uint32_t w)
{
    const sph__posed pu = posed_of(b, u), pv = posed_of(b, v);
    const uint32_t su = b->slot_of[u], sv = b->slot_of[v];
    double cost = sph__kernel_unite_posed(&pu, &pv, b->stride, b->new_center, sph__block_of(b, u));
    if (cost < 0) cost = 0;
    b->costs[su] = cost;
    b->areas[su] += b->areas[sv];
    b->slot_of[w] = su;
    memcpy(sph__center_of(b, w), b->new_center, 3 * b->stride * sizeof *b->new_center);
    b->live_cost -= b->shown[su] + b->shown[sv];
    b->live_cost += b->shown[su] = show_point(b, w);
    return b->areas[su] > 0 ? sqrt(b->shown[su] / b->areas[su]) / b->scale : 0;
}

static sph_status collapse(sph__simplifier *b, uint32_t u, uint32_t v, const merge *m, bool forced)
{
    sph_progressive *p = b->p;
    const uint32_t w = b->points + p->collapse_count;
    const double worst = unite_quadrics(b, u, v, w);
    sph_status status = sph__wedges_unite(b, u, v, w, m->way);
    if (status == SPH_OK) status = sph__connectivity_collapse(&b->mesh, u, v, w);
    if (status != SPH_OK) return status;
    sph__wedges_settle(b, w);
    sph__edge_queue_forget(&b->queue, &b->mesh);
    p->children[2 * (size_t)p->collapse_count] = u;
    p->children[2 * (size_t)p->collapse_count + 1] = v;
    p->parents[u] = p->parents[v] = w;
    p->parents[w] = SPH__NO_NODE;
    ++p->collapse_count;
    record_level(b, worst, forced);
    status = sph__births_add(&b->births, &b->mesh, w);
    if (status == SPH_OK) status = sph__wedges_record(b, w);
    for (uint32_t i = 0; i < sph__edge_count_of(&b->mesh, w) && status == SPH_OK; ++i)
        status = add_fresh(b, sph__edges_of(&b->mesh, w)[i]);
    if (status != SPH_OK) return status;
    push_fresh(b);
    sph__edge_queue_readmit(&b->queue, &b->mesh, w);
    return SPH_OK;
}

static sph_status step(sph__simplifier *b, bool *done)
{
    const uint32_t w = b->points + b->p->collapse_count;
    uint32_t edge = 0, u, v;
    const bool forced = !sph__edge_queue_top(&b->queue, &b->mesh, &edge);
    merge m;
    *done = forced && !sph__edge_queue_pop_refused(&b->queue, &edge);
    if (*done) return SPH_OK;
    if (!forced) sph__edge_queue_take(&b->queue, &b->mesh, edge);
    evaluate(b, edge, &b->rooms[0], &m);
    sph__edge_ends(&b->mesh, edge, &u, &v);
    place_merged(b, u, v, w, &m);
    if (!forced && (pinches(b, u, v, w) || sph__collapse_inverts(&b->mesh, b->centers, b->stride, u, v, b->new_center)))
        return sph__edge_queue_refuse(&b->queue, &b->mesh, edge, m.error);
    return collapse(b, u, v, &m, forced);
}

static sph_status record_start(sph__simplifier *b)
{
    sph_status status = SPH_OK;
    b->births.edge_starts[0] = b->births.triangle_starts[0] = 0;
    for (uint32_t i = 0; i < b->points && status == SPH_OK; ++i) {
        b->p->parents[i] = SPH__NO_NODE;
        status = sph__births_add(&b->births, &b->mesh, i);
        if (status == SPH_OK) status = sph__wedges_record(b, i);
    }
    record_level(b, 0, false);
    return status;
}

sph_status sph__simplify_decimate(sph__simplifier *b)
{
    sph_status status = record_start(b);
    sph__progress_part(&b->progress, 0.25);
    if (status == SPH_OK) status = fill_queue(b);
    sph__progress_part(&b->progress, 0.65);
    for (bool done = false; status == SPH_OK && !done;) {
        if (b->p->collapse_count % 64 == 0)
            status = sph__progress_report(&b->progress, "decimation", (double)b->p->collapse_count / b->points);
        if (status == SPH_OK) status = step(b, &done);
    }
    return status;
}
