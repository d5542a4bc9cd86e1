/* SPDX-License-Identifier: MIT */
#include "simplify/solve.h"

#include <math.h>
#include <string.h>

#include "numeric/numeric.h"

/* A direction in which the error grows so much less than in another leaves the position open. */
static const double OPEN = 1e-6;

/* The 4x4 form of the position with these weights, and its linear part. */
static void blend(const sph__form *form, const double *a, double h[SPH__FORM_SIZE], double linear[4])
{
    const double *pair = form->pairs;
    memset(h, 0, SPH__FORM_SIZE * sizeof *h);
    memset(linear, 0, 4 * sizeof *linear);
    for (uint32_t k = 0; k < form->count; ++k) {
        for (uint32_t l = 0; l <= k; ++l, pair += SPH__FORM_SIZE) {
            const double both = a[k] * a[l] * (l < k ? 2 : 1);
            if (both == 0) continue;
            for (int q = 0; q < SPH__FORM_SIZE; ++q)
                h[q] += both * pair[q];
        }
        for (int c = 0; c < 4; ++c)
            linear[c] += a[k] * form->linear[4 * (size_t)k + c];
    }
}

/* z' h z with z = (x, 1) */
static double apply(const double h[SPH__FORM_SIZE], const double x[3])
{
    double moved[3];
    sph__sym3_apply(h, x, moved);
    return sph__dot(x, moved) + 2 * (h[6] * x[0] + h[7] * x[1] + h[8] * x[2]) + h[9];
}

static double value(const sph__form *form, const double h[SPH__FORM_SIZE], const double linear[4], const double x[3])
{
    return apply(h, x) - 2 * (sph__dot(linear, x) + linear[3]) + form->constant;
}

double sph__form_error(const sph__form *form, const double x[3], const double *weights)
{
    double h[SPH__FORM_SIZE], linear[4];
    blend(form, weights, h, linear);
    return value(form, h, linear, x);
}

/* The best place on the edge. */
static void find_on_edge(const double h[SPH__FORM_SIZE], const double toward[3], const double edge[3], double x[3])
{
    double moved[3], bend, slope, way;
    sph__sym3_apply(h, edge, moved);
    bend = sph__dot(edge, moved);
    slope = sph__dot(edge, toward);
    way = bend > 0 ? slope / bend : 0.5;
    if (!(way > 0)) way = 0;
    if (way > 1) way = 1;
    for (int c = 0; c < 3; ++c)
        x[c] = way * edge[c];
}

void sph__solve_position(const sph__solver *solver, sph__trial *trial)
{
    double h[SPH__FORM_SIZE], linear[4], toward[3], x[3], error;
    sph__sym3_factor factor;
    blend(&solver->form, trial->weights, h, linear);
    for (int c = 0; c < 3; ++c)
        toward[c] = linear[c] - h[6 + c];
    if (sph__sym3_factorize(h, &factor) && factor.pivot[2] > OPEN * factor.pivot[0] &&
        factor.pivot[1] > OPEN * factor.pivot[0])
        sph__sym3_solve(&factor, toward, x);
    else
        find_on_edge(h, toward, solver->edge, x);
    error = value(&solver->form, h, linear, x);
    if (error < trial->error) {
        memcpy(trial->x, x, sizeof x);
        trial->error = error;
    }
    if (solver->half_step != NULL) solver->half_step(solver->user, 0, trial->error);
}

void sph__solve_weights(sph__solver *solver, const uint8_t *allowed, sph__trial *trial)
{
    const sph__form *form = &solver->form;
    const uint32_t count = form->count;
    double weights[SPH__SIMPLIFY_BONES], toward[SPH__SIMPLIFY_BONES], error;
    const double *pair = form->pairs;
    if (count < 2) return;
    for (uint32_t k = 0; k < count; ++k) {
        for (uint32_t l = 0; l <= k; ++l, pair += SPH__FORM_SIZE)
            solver->matrix[(size_t)k * count + l] = solver->matrix[(size_t)l * count + k] = apply(pair, trial->x);
        toward[k] = sph__dot(form->linear + 4 * (size_t)k, trial->x) + form->linear[4 * (size_t)k + 3];
    }
    memcpy(weights, trial->weights, count * sizeof *weights);
    sph__simplex_qp(solver->matrix, count, toward, count, allowed, weights, &solver->qp);
    error = sph__simplex_qp_value(solver->matrix, count, toward, count, weights) + form->constant;
    if (error < trial->error) {
        memcpy(trial->weights, weights, count * sizeof *weights);
        trial->error = error;
    }
    if (solver->half_step != NULL) solver->half_step(solver->user, 1, trial->error);
}

void sph__solve_both(sph__solver *solver, const uint8_t *allowed, sph__trial *trial)
{
    for (uint32_t round = 0; round < solver->round_limit; ++round) {
        const double before = trial->error;
        sph__solve_position(solver, trial);
        sph__solve_weights(solver, allowed, trial);
        if (!(before - trial->error > solver->tolerance * before)) return;
    }
}

/* The heaviest `limit` bones alone, equal ones by their place; false where there are no more than that. */
static bool keep_heaviest(uint32_t count, uint32_t limit, double *weights, uint8_t *kept)
{
    uint32_t used = 0;
    double sum = 0;
    for (uint32_t k = 0; k < count; ++k)
        used += weights[k] > 0;
    if (used <= limit) return false;
    memset(kept, 0, count);
    for (uint32_t i = 0; i < limit; ++i) {
        uint32_t best = count;
        for (uint32_t k = 0; k < count; ++k)
            if (!kept[k] && (best == count || weights[k] > weights[best])) best = k;
        kept[best] = 1;
    }
    for (uint32_t k = 0; k < count; ++k) {
        if (!kept[k]) weights[k] = 0;
        sum += weights[k];
    }
    for (uint32_t k = 0; k < count; ++k)
        weights[k] /= sum;
    return true;
}

void sph__solve_limited(sph__solver *solver, uint32_t limit, sph__trial *trial)
{
    uint8_t kept[SPH__SIMPLIFY_BONES];
    sph__solve_both(solver, NULL, trial);
    if (!keep_heaviest(solver->form.count, limit, trial->weights, kept)) return;
    trial->error = sph__form_error(&solver->form, trial->x, trial->weights);
    sph__solve_weights(solver, kept, trial);
    sph__solve_both(solver, kept, trial);
}
