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
    uint32_t kept;       /* rows of the factor that are right */
    double scale;        /* largest diagonal entry or |b| */
    double ridge;
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

/*
 * The Cholesky factor of H over the free variables, from row `kept` on, with the inverse of its diagonal there; the ridge
 * makes it definite whatever the rounding.
 */
static bool factorize(problem *p, double ridge)
{
    for (uint32_t i = p->kept; i < p->free_count; ++i) {
        const double *row = p->h + (size_t)p->room->free[i] * p->stride;
        double *l = p->room->factor[i];
        double rest = row[p->room->free[i]] + ridge;
        for (uint32_t k = 0; k < i; ++k) {
            const double *other = p->room->factor[k];
            double sum = row[p->room->free[k]];
            for (uint32_t q = 0; q < k; ++q)
                sum -= l[q] * other[q];
            l[k] = sum * other[k];
            rest -= l[k] * l[k];
        }
        if (!(rest > 0)) {
            p->kept = 0;
            return false;
        }
        l[i] = 1 / sqrt(rest);
    }
    p->kept = p->free_count;
    return true;
}

/* Two right-hand sides at once. */
static void substitute(const problem *p, double *x, double *y)
{
    for (uint32_t i = 0; i < p->free_count; ++i) {
        const double *l = p->room->factor[i];
        double a = x[i], b = y[i];
        for (uint32_t k = 0; k < i; ++k) {
            a -= l[k] * x[k];
            b -= l[k] * y[k];
        }
        x[i] = a * l[i];
        y[i] = b * l[i];
    }
    for (uint32_t i = p->free_count; i-- > 0;) {
        const double *l = p->room->factor[i];
        const double a = x[i] *= l[i], b = y[i] *= l[i];
        for (uint32_t k = 0; k < i; ++k) {
            x[k] -= l[k] * a;
            y[k] -= l[k] * b;
        }
    }
}

/* Half the gradient at w along variable i. */
static double slope_at(const problem *p, uint32_t i)
{
    const double *row = p->h + (size_t)i * p->stride;
    double sum = p->b == NULL ? 0 : -p->b[i];
    for (uint32_t f = 0; f < p->free_count; ++f)
        sum += row[p->room->free[f]] * p->w[p->room->free[f]];
    return sum;
}

/*
 * The minimum over the free variables under sum = 1 alone, in room->target. It is found as a step from w, so that what
 * rounding spoils is a part of the step and not of w.
 */
static bool find_target(problem *p)
{
    double *one = p->room->one, *target = p->room->target, sum_one = 0, sum = 0, mean = 0;
    bool done = factorize(p, p->ridge);
    for (int tries = 0; !done && tries < 4; ++tries)
        done = factorize(p, p->ridge *= 100);
    if (!done) return false;
    for (uint32_t i = 0; i < p->free_count; ++i) {
        one[i] = 1;
        target[i] = -slope_at(p, p->room->free[i]);
        mean += target[i] / p->free_count;
    }
    for (uint32_t i = 0; i < p->free_count; ++i)
        target[i] -= mean;
    substitute(p, one, target);
    for (uint32_t i = 0; i < p->free_count; ++i) {
        sum_one += one[i];
        sum += target[i];
    }
    if (!(sum_one > 0)) return false;
    for (uint32_t i = 0; i < p->free_count; ++i)
        target[i] += p->w[p->room->free[i]] - sum / sum_one * one[i];
    return true;
}

static void make_sum_one(double *w, uint32_t count)
{
    double sum = 0;
    for (uint32_t i = 0; i < count; ++i)
        sum += w[i];
    for (uint32_t i = 0; i < count && sum > 0; ++i)
        w[i] /= sum;
}

/* Goes towards the target until a variable is 0, which is then held there. */
static void go(problem *p)
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
    if (blocking < p->free_count) {
        p->w[free[blocking]] = 0;
        free[blocking] = free[--p->free_count];
        if (p->kept > blocking) p->kept = blocking;
    }
    make_sum_one(p->w, p->count); /* far targets lose digits of the sum */
}

/*
 * The variable held at 0 along which the value falls most, or `count`; in *uneven how far the slopes of the free ones are
 * apart: 0 at the minimum over them.
 */
static uint32_t find_entering(const problem *p, const uint8_t *allowed, double *uneven)
{
    double slope[SPH__SIMPLEX_QP_MOST], mean = 0, least;
    uint32_t best = p->count;
    for (uint32_t i = 0; i < p->count; ++i) {
        slope[i] = slope_at(p, i);
        mean += p->w[i] * slope[i];
    }
    least = -1e-12 * p->scale;
    *uneven = 0;
    for (uint32_t i = 0; i < p->count; ++i) {
        if (p->w[i] > 0) {
            *uneven = fmax(*uneven, fabs(slope[i] - mean));
            continue;
        }
        if ((allowed != NULL && !allowed[i]) || !(slope[i] - mean < least)) continue;
        least = slope[i] - mean;
        best = i;
    }
    return best;
}

uint32_t sph__simplex_qp(const double *h, uint32_t stride, const double *b, uint32_t count, const uint8_t *allowed,
                         double *w, sph__simplex_qp_room *room)
{
    problem p = {.h = h, .b = b, .stride = stride, .count = count, .w = w, .room = room};
    const uint32_t limit = 16 + 8 * count;
    uint32_t steps = 0, entered = count, repeats = 0;
    bool closing = false;
    for (uint32_t i = 0; i < count; ++i) {
        p.scale = fmax(p.scale, h[(size_t)i * stride + i]);
        if (b != NULL) p.scale = fmax(p.scale, fabs(b[i]));
        if (w[i] > 0) room->free[p.free_count++] = i;
    }
    if (!(p.scale > 0)) return 0; /* flat */
    p.ridge = 1e-13 * p.scale;
    while (steps < limit && find_target(&p)) {
        const uint32_t before = p.free_count;
        const uint32_t last = entered < count ? room->free[before - 1] : count;
        double uneven;
        ++steps;
        go(&p);
        if (p.free_count < before) {
            /* What has just entered leaves at once only where rounding had called it in: nothing enters any more. */
            if (last < count && w[last] == 0) closing = true;
            entered = count;
            continue;
        }
        entered = find_entering(&p, allowed, &uneven);
        if (uneven > 1e-10 * p.scale && repeats < 2) { /* the system was near to singular: once more from here */
            entered = count;
            ++repeats;
            continue;
        }
        repeats = 0;
        if (entered == count || closing) break;
        room->free[p.free_count++] = entered;
    }
    return steps;
}
