/* SPDX-License-Identifier: MIT */
#include "numeric/simplex_qp.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

typedef struct problem {
    const double *h, *b;
    uint32_t stride, count;
    double *w;
    sph__simplex_qp_room *room;
    uint32_t free_count; /* variables not held at 0, in room->free */
    double scale;        /* largest diagonal entry or |b| */
} problem;

double sph__simplex_qp_value(const double *h, uint32_t stride, const double *b, uint32_t count, const double *w)
{
    double value = 0;
    for (uint32_t i = 0; i < count; ++i) {
        double row = 0;
        if (w[i] == 0) continue;
        for (uint32_t k = 0; k < count; ++k)
            row += h[(size_t)i * stride + k] * w[k];
        value += w[i] * (row - (b == NULL ? 0 : 2 * b[i]));
    }
    return value;
}

/* The Cholesky factor of H over the free variables; the ridge makes it definite whatever the rounding. */
static bool factorize(const problem *p, double ridge)
{
    for (uint32_t i = 0; i < p->free_count; ++i) {
        const double *row = p->h + (size_t)p->room->free[i] * p->stride;
        double *l = p->room->factor[i];
        for (uint32_t k = 0; k <= i; ++k) {
            const double *other = p->room->factor[k];
            double sum = row[p->room->free[k]];
            for (uint32_t q = 0; q < k; ++q)
                sum -= l[q] * other[q];
            if (k < i) {
                l[k] = sum / other[k];
                continue;
            }
            sum += ridge;
            if (!(sum > 0)) return false;
            l[k] = sqrt(sum);
        }
    }
    return true;
}

static void substitute(const problem *p, double *x)
{
    for (uint32_t i = 0; i < p->free_count; ++i) {
        const double *l = p->room->factor[i];
        for (uint32_t k = 0; k < i; ++k)
            x[i] -= l[k] * x[k];
        x[i] /= l[i];
    }
    for (uint32_t i = p->free_count; i-- > 0;) {
        for (uint32_t k = i + 1; k < p->free_count; ++k)
            x[i] -= p->room->factor[k][i] * x[k];
        x[i] /= p->room->factor[i][i];
    }
}

/* The minimum over the free variables under sum = 1 alone, in room->target. */
static bool find_target(const problem *p)
{
    double *one = p->room->one, *target = p->room->target, sum_one = 0, sum = 0;
    double ridge = 1e-13 * p->scale;
    bool done = factorize(p, ridge);
    for (int tries = 0; !done && tries < 4; ++tries)
        done = factorize(p, ridge *= 100);
    if (!done) return false;
    for (uint32_t i = 0; i < p->free_count; ++i) {
        one[i] = 1;
        target[i] = p->b == NULL ? 0 : p->b[p->room->free[i]];
    }
    substitute(p, one);
    if (p->b != NULL) substitute(p, target);
    for (uint32_t i = 0; i < p->free_count; ++i) {
        sum_one += one[i];
        sum += target[i];
    }
    if (!(sum_one > 0)) return false;
    for (uint32_t i = 0; i < p->free_count; ++i)
        target[i] += (1 - sum) / sum_one * one[i];
    return true;
}

/* Goes towards the target until a variable is 0, which is held there; its place, or free_count where all went well. */
static uint32_t go(problem *p)
{
    const double *target = p->room->target;
    uint32_t *free = p->room->free, blocking = p->free_count;
    double step = 1;
    for (uint32_t i = 0; i < p->free_count; ++i) {
        const double from = p->w[free[i]];
        if (target[i] > 0 || from - target[i] <= 0) continue;
        if (blocking < p->free_count && !(from < step * (from - target[i]))) continue;
        step = from / (from - target[i]);
        blocking = i;
    }
    for (uint32_t i = 0; i < p->free_count; ++i)
        p->w[free[i]] += step * (target[i] - p->w[free[i]]);
    if (blocking == p->free_count) return blocking;
    p->w[free[blocking]] = 0;
    free[blocking] = free[--p->free_count];
    return blocking;
}

/* The variable held at 0 along which the value falls most, or `count`. */
static uint32_t find_entering(const problem *p, const uint8_t *allowed)
{
    double slope[SPH__SIMPLEX_QP_MOST], mean = 0, least;
    uint32_t best = p->count;
    for (uint32_t i = 0; i < p->count; ++i) {
        const double *row = p->h + (size_t)i * p->stride;
        double sum = p->b == NULL ? 0 : -p->b[i];
        for (uint32_t f = 0; f < p->free_count; ++f)
            sum += row[p->room->free[f]] * p->w[p->room->free[f]];
        slope[i] = sum;
        mean += p->w[i] * sum;
    }
    least = -1e-12 * p->scale;
    for (uint32_t i = 0; i < p->count; ++i) {
        if (p->w[i] > 0 || (allowed != NULL && !allowed[i]) || !(slope[i] - mean < least)) continue;
        least = slope[i] - mean;
        best = i;
    }
    return best;
}

static void make_sum_one(double *w, uint32_t count)
{
    double sum = 0;
    for (uint32_t i = 0; i < count; ++i)
        sum += w[i];
    for (uint32_t i = 0; i < count && sum > 0; ++i)
        w[i] /= sum;
}

uint32_t sph__simplex_qp(const double *h, uint32_t stride, const double *b, uint32_t count, const uint8_t *allowed,
                         double *w, sph__simplex_qp_room *room)
{
    problem p = {.h = h, .b = b, .stride = stride, .count = count, .w = w, .room = room};
    const uint32_t limit = 16 + 8 * count;
    uint32_t steps = 0, entered = count;
    for (uint32_t i = 0; i < count; ++i) {
        p.scale = fmax(p.scale, h[(size_t)i * stride + i]);
        if (b != NULL) p.scale = fmax(p.scale, fabs(b[i]));
        if (w[i] > 0) room->free[p.free_count++] = i;
    }
    if (!(p.scale > 0)) return 0; /* flat */
    while (steps < limit && find_target(&p)) {
        const uint32_t before = p.free_count;
        const uint32_t last = entered < count ? room->free[before - 1] : count;
        ++steps;
        go(&p);
        if (p.free_count < before) {
            /* What has just entered leaves at once only where rounding had called it in. */
            if (last < count && w[last] == 0) break;
            entered = count;
            continue;
        }
        entered = find_entering(&p, allowed);
        if (entered == count) break;
        room->free[p.free_count++] = entered;
    }
    make_sum_one(w, count);
    return steps;
}
