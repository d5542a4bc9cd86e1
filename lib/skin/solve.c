/* SPDX-License-Identifier: MIT */
#include "skin/solve.h"

#include <math.h>

#include "skin/learn.h"

/*
 * Steps ahead go this much of the last round's change further; more after each that lowers the energy, less after one
 * that does not.
 */
static const double FIRST_REACH = 0.5, MOST_REACH = 8, LONGER = 1.3, SHORTER = 0.5;

enum { SWEEPS = 4, WINDOW = 5 /* rounds over which progress is judged */ };

typedef struct solver {
    sph__problem *p;
    const sph_skin *skin;
    const sph_skin_options *options;
    const sph__filter *filter;
    double *smooth, *share;    /* of the mixed mode: [n][most], [n] */
    sph__learn_change *changes; /* [n] */
    sph__influences next;   /* room for the weights step */
    sph__influences before; /* of the round before, with its rest pose: where a step ahead comes from */
    double *rest_before;
    sph__influences here; /* while a step ahead is tried: where to go back to */
    double *rest_here, *poses_here;
    bool has_before;
    double reach;
    double energy[2]; /* as of the last step: weighted by area, and plain */
    double past[WINDOW]; /* energies of the last rounds */
    uint32_t round;
} solver;

static double rmse(const solver *s)
{
    return sqrt(s->energy[1] / ((double)s->p->n * s->p->frames));
}

static sph_status tell(solver *s, int32_t step)
{
    sph_status status = SPH_OK;
    if (s->options->step == NULL && step != SPH_SKIN_STEP_START) return SPH_OK; /* the round's end is enough */
    status = sph__problem_energy(s->p, &s->p->now, s->energy);
    if (status == SPH_OK && s->options->step != NULL)
        s->options->step(s->options->step_user, s->round, step, s->energy[0]);
    return status;
}

static size_t pose_count(const sph__problem *p)
{
    return (size_t)p->groups * p->bones * SPH__SKIN_POSE;
}

/* --- steps ahead --- */

/* Weights of one vertex, `reach` times the way from `before` to now beyond now: none below 0, no more than allowed. */
static void extrapolate(const solver *s, size_t v)
{
    const sph__problem *p = s->p;
    double w[SPH__SKIN_MOST_CANDIDATES] = {0}, sum = 0;
    const size_t at = v * p->limit;
    uint32_t count = 0;
    for (uint32_t i = 0; i < p->now.count[v]; ++i)
        w[p->now.places[at + i]] += (1 + s->reach) * p->now.weights[at + i];
    for (uint32_t i = 0; i < s->before.count[v]; ++i)
        w[s->before.places[at + i]] -= s->reach * s->before.weights[at + i];
    for (uint32_t i = 0; i < p->now.count[v]; ++i) { /* no bone comes back that was dropped */
        const uint32_t place = p->now.places[at + i];
        if (!(w[place] > 0)) continue;
        p->now.places[at + count] = place;
        p->now.weights[at + count++] = w[place];
        sum += w[place];
    }
    p->now.count[v] = count;
    for (uint32_t i = 0; i < count; ++i)
        p->now.weights[at + i] /= sum;
}

static sph_status fit_poses(solver *s, int32_t step)
{
    sph_status status = sph__fit_poses(s->p, s->skin, s->options->minor_bone, SWEEPS, false);
    return status == SPH_OK ? tell(s, step) : status;
}

/* Tries a step ahead with the poses that belong to it; *taken says whether it stayed. */
static sph_status go_ahead(solver *s, bool *taken)
{
    sph__problem *p = s->p;
    const double best[2] = {s->energy[0], s->energy[1]};
    sph_status status;
    sph__influences_copy(p, &p->now, &s->here);
    memcpy(s->rest_here, p->rest, p->n * 3 * sizeof *p->rest);
    memcpy(s->poses_here, p->poses, pose_count(p) * sizeof *p->poses);
    for (size_t v = 0; v < p->n; ++v) {
        if (p->fixed != NULL && p->fixed[v]) continue;
        extrapolate(s, v);
        for (size_t i = 3 * v; i < 3 * v + 3; ++i)
            p->rest[i] += s->reach * (p->rest[i] - s->rest_before[i]);
    }
    sph__influences_copy(p, &s->here, &s->before);
    memcpy(s->rest_before, s->rest_here, p->n * 3 * sizeof *p->rest);
    status = sph__fit_poses(p, s->skin, s->options->minor_bone, SWEEPS, false);
    if (status == SPH_OK) status = sph__problem_energy(p, &p->now, s->energy);
    if (status != SPH_OK) return status;
    *taken = s->energy[0] <= best[0];
    if (*taken) {
        s->reach = fmin(s->reach * LONGER, MOST_REACH);
        if (s->options->step != NULL)
            s->options->step(s->options->step_user, s->round, SPH_SKIN_STEP_AHEAD, s->energy[0]);
        return SPH_OK;
    }
    s->reach *= SHORTER;
    sph__influences_copy(p, &s->here, &p->now);
    memcpy(p->rest, s->rest_here, p->n * 3 * sizeof *p->rest);
    memcpy(p->poses, s->poses_here, pose_count(p) * sizeof *p->poses);
    memcpy(s->energy, best, sizeof best);
    return SPH_OK;
}

/* --- rounds --- */

/* The weights before, in the places of the candidates. */
static void copy_rows(const sph__problem *p, double *rows)
{
    memset(rows, 0, (size_t)p->n * p->most * sizeof *rows);
    for (size_t v = 0; v < p->n; ++v)
        for (uint32_t s = 0; s < p->now.count[v]; ++s)
            rows[v * p->most + p->now.places[v * p->limit + s]] = p->now.weights[v * p->limit + s];
}

/* How far each vertex is to learn from the animation: where it gains much and its weights need not change much. */
static void find_shares(const sph__problem *p, const sph__learn_change *changes, double *share)
{
    double most_gain = 0, most_distance = 0;
    for (size_t v = 0; v < p->n; ++v) {
        most_gain = fmax(most_gain, changes[v].before - changes[v].after);
        most_distance = fmax(most_distance, changes[v].distance);
    }
    for (size_t v = 0; v < p->n; ++v) {
        const double gain = most_gain > 0 ? fmax(0, changes[v].before - changes[v].after) / most_gain : 0;
        const double distance = most_distance > 0 ? changes[v].distance / most_distance : 0;
        share[v] = gain + distance > 0 ? 0.8 * gain / (gain + distance) : 0;
    }
}

static sph_status learn_mixed(solver *s)
{
    sph__learn_goal goal = {.gamma = s->options->smoothness * s->p->diagonal * s->p->diagonal, .smooth = s->smooth};
    sph_status status = SPH_OK;
    if (s->filter->starts != NULL)
        status = sph__filter_apply(s->filter, s->p, s->smooth);
    else
        copy_rows(s->p, s->smooth);
    if (status == SPH_OK) status = sph__learn_weights(s->p, &goal, &s->next, s->changes);
    if (status != SPH_OK) return status;
    find_shares(s->p, s->changes, s->share);
    goal.share = s->share;
    return sph__learn_weights(s->p, &goal, &s->next, NULL);
}

static sph_status learn_weights(solver *s)
{
    const sph__learn_goal goal = {0};
    const bool mixed = s->options->mode == SPH_SKIN_MIXED;
    const sph_status status = mixed ? learn_mixed(s) : sph__learn_weights(s->p, &goal, &s->next, NULL);
    const sph__influences before = s->p->now;
    if (status != SPH_OK) return status;
    s->p->now = s->next;
    s->next = before;
    return tell(s, SPH_SKIN_STEP_WEIGHTS);
}

static sph_status fit_rest(solver *s)
{
    sph__fit_rest(s->p);
    return tell(s, SPH_SKIN_STEP_REST);
}

static sph_status run_round(solver *s)
{
    const uint32_t interval = s->options->rest_interval;
    bool ahead = false;
    sph_status status = SPH_OK;
    if (s->has_before) status = go_ahead(s, &ahead);
    if (!s->has_before) {
        sph__influences_copy(s->p, &s->p->now, &s->before);
        memcpy(s->rest_before, s->p->rest, s->p->n * 3 * sizeof *s->p->rest);
        s->has_before = s->options->mode != SPH_SKIN_MIXED;
    }
    if (status == SPH_OK && !ahead) status = fit_poses(s, SPH_SKIN_STEP_TRANSFORMS);
    if (status == SPH_OK && s->options->mode != SPH_SKIN_GEOMETRIC) status = learn_weights(s);
    if (status == SPH_OK && interval != 0 && s->round % interval == interval - 1) status = fit_rest(s);
    if (status == SPH_OK && s->options->step == NULL) status = sph__problem_energy(s->p, &s->p->now, s->energy);
    return status;
}

static sph_status allocate_mixed(solver *s)
{
    size_t rows;
    if (s->options->mode != SPH_SKIN_MIXED) return SPH_OK;
    if (!sph__multiply_size(s->p->n, s->p->most, &rows)) return sph__fail_memory(s->p->context);
    s->smooth = sph__zalloc(s->p->context, rows, sizeof *s->smooth);
    s->share = sph__zalloc(s->p->context, s->p->n, sizeof *s->share);
    s->changes = sph__zalloc(s->p->context, s->p->n, sizeof *s->changes);
    return s->smooth == NULL || s->share == NULL || s->changes == NULL ? sph__fail_memory(s->p->context) : SPH_OK;
}

static sph_status allocate(solver *s)
{
    sph__problem *p = s->p;
    sph_status status = sph__influences_allocate(p, &s->next);
    if (status == SPH_OK) status = sph__influences_allocate(p, &s->before);
    if (status == SPH_OK) status = sph__influences_allocate(p, &s->here);
    s->rest_before = sph__alloc(p->context, p->n, 3 * sizeof *s->rest_before);
    s->rest_here = sph__alloc(p->context, p->n, 3 * sizeof *s->rest_here);
    s->poses_here = sph__alloc(p->context, pose_count(p), sizeof *s->poses_here);
    if (status == SPH_OK && (s->rest_before == NULL || s->rest_here == NULL || s->poses_here == NULL))
        status = sph__fail_memory(p->context);
    return status == SPH_OK ? allocate_mixed(s) : status;
}

sph_status sph__solve(sph__problem *p, const sph_skin *skin, const sph_skin_options *options, const sph__filter *filter,
                      sph__progress *progress)
{
    solver s = {.p = p, .skin = skin, .options = options, .filter = filter, .reach = FIRST_REACH};
    sph_status status = allocate(&s);
    if (status == SPH_OK) status = tell(&s, SPH_SKIN_STEP_START);
    for (; s.round < options->round_limit && status == SPH_OK; ++s.round) {
        const double before = s.past[s.round % WINDOW];
        s.past[s.round % WINDOW] = s.energy[0];
        status = sph__progress_report(progress, "skinning", (double)s.round / options->round_limit);
        if (status == SPH_OK) status = run_round(&s);
        if (options->error_limit > 0 && rmse(&s) <= 0.01 * options->error_limit * p->diagonal) break;
        /* More than it should, or less: bones that became minor can raise it, and then it falls again. */
        if (s.round >= WINDOW && fabs(sqrt(before) - sqrt(s.energy[0])) <= WINDOW * options->tolerance * sqrt(before)) break;
    }
    sph__influences_free(p, &s.next);
    sph__influences_free(p, &s.before);
    sph__influences_free(p, &s.here);
    sph__free(p->context, s.smooth);
    sph__free(p->context, s.share);
    sph__free(p->context, s.changes);
    sph__free(p->context, s.rest_before);
    sph__free(p->context, s.rest_here);
    sph__free(p->context, s.poses_here);
    return status;
}
