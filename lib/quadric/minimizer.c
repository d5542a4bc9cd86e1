/* SPDX-License-Identifier: MIT */
#include "quadric/minimizer.h"

#include <stddef.h>

#include "numeric/numeric.h"

enum { SIDES = 4 };

static double value_at(const sph__box *box, double lambda, double r)
{
    return lambda * (0.5 * box->mu * lambda + box->nu * r - box->beta1) + r * (0.5 * box->w2 * r - box->beta3);
}

static sph__box_minimum point(const sph__box *box, double lambda, double r)
{
    return (sph__box_minimum){.lambda = lambda, .radius = r, .value = value_at(box, lambda, r)};
}

/* How far rounding may move g at this point: the mixed terms are at most the mean of these three. */
static double noise_at(const sph__box *box, const sph__box_minimum *at)
{
    return box->noise *
           (box->mu_scale * at->lambda * at->lambda + box->w2_scale * at->radius * at->radius + box->cost_scale);
}

/* `candidate`, if it is better than `preferred` by more than rounding explains. */
static sph__box_minimum clearly_better(const sph__box *box, sph__box_minimum preferred, sph__box_minimum candidate)
{
    return candidate.value < preferred.value - noise_at(box, &candidate) ? candidate : preferred;
}

/* The side on which lambda is fixed. */
static sph__box_minimum best_radius(const sph__box *box, double lambda, double radius_max, bool w2_vanishes)
{
    const sph__box_minimum best = point(box, lambda, sph__line_minimum(box->w2, box->beta3 - lambda * box->nu, radius_max));
    return w2_vanishes ? clearly_better(box, point(box, lambda, 0.0), best) : best;
}

/* The side on which r is fixed. */
static sph__box_minimum best_lambda(const sph__box *box, double r, bool mu_vanishes)
{
    const sph__box_minimum best = point(box, sph__line_minimum(box->mu, box->beta1 - box->nu * r, 1.0), r);
    return mu_vanishes ? clearly_better(box, point(box, 0.5, r), best) : best;
}

static size_t find_cheapest(const sph__box_minimum *points, size_t count)
{
    size_t best = 0;
    for (size_t i = 1; i < count; ++i)
        if (points[i].value < points[best].value) best = i;
    return best;
}

/* Of the points that cost as little as the cheapest, to within rounding, the one of smallest r. */
static sph__box_minimum find_smallest(const sph__box *box, const sph__box_minimum *points, size_t count)
{
    const sph__box_minimum cheapest = points[find_cheapest(points, count)];
    sph__box_minimum best = cheapest;
    for (size_t i = 0; i < count; ++i)
        if (points[i].radius < best.radius && points[i].value <= cheapest.value + noise_at(box, &cheapest))
            best = points[i];
    return best;
}

static sph__box_minimum minimize_with_segments(const sph__box *box, double radius_max)
{
    const bool mu_vanishes = !(box->mu > box->noise * box->mu_scale);
    const bool w2_vanishes = !(box->w2 > box->noise * box->w2_scale);
    /* The determinant and its scale, both divided by mu: products of three coefficients may underflow. */
    const double schur = box->w2 - box->nu * (box->nu / box->mu);
    const double schur_scale = box->w2 * (box->mu_scale / box->mu) + box->w2_scale;
    const bool singular = mu_vanishes || w2_vanishes || !(schur > 2.0 * box->noise * schur_scale);
    sph__box_minimum sides[SIDES];
    size_t count = 0;

    if (!singular) {
        /* By elimination, not by Cramer's rule: however wrong r is, this lambda is the best for it. */
        const double r = (box->beta3 - box->nu * (box->beta1 / box->mu)) / schur;
        const double lambda = (box->beta1 - box->nu * r) / box->mu;
        if (lambda >= 0.0 && lambda <= 1.0 && r >= 0.0 && r <= radius_max && isfinite(r)) return point(box, lambda, r);
    }
    sides[count++] = best_lambda(box, 0.0, mu_vanishes);
    sides[count++] = best_radius(box, 0.0, radius_max, w2_vanishes);
    sides[count++] = best_radius(box, 1.0, radius_max, w2_vanishes);
    if (isfinite(radius_max)) sides[count++] = best_lambda(box, radius_max, mu_vanishes);

    if (mu_vanishes || w2_vanishes) {
        const sph__box_minimum preferred = w2_vanishes ? sides[0] : best_radius(box, 0.5, radius_max, false);
        return clearly_better(box, preferred, sides[find_cheapest(sides, count)]);
    }
    /* A line of minima meets the box, if at all, first at r = 0 or at an end of lambda: at one of the sides' best. */
    return singular ? find_smallest(box, sides, count) : sides[find_cheapest(sides, count)];
}

sph__box_minimum sph__box_minimize(const sph__box *box, bool any_degenerate, double radius_max)
{
    sph__box scaled = *box;
    scaled.mu_scale = fmax(box->mu_scale, fabs(box->mu));
    scaled.w2_scale = fmax(box->w2_scale, fabs(box->w2));
    if (any_degenerate) return minimize_with_segments(&scaled, radius_max);
    return best_radius(&scaled, 0.0, radius_max, !(scaled.w2 > scaled.noise * scaled.w2_scale));
}

bool sph__is_degenerate(const double m[6])
{
    /* Scaled first: the cube of a small weight would underflow. */
    const double scale = 3.0 / sph__sym3_trace(m);
    double scaled[6];
    if (!(scale > 0.0)) return true;
    for (int i = 0; i < 6; ++i)
        scaled[i] = m[i] * scale;
    return !(sph__sym3_determinant(scaled) > SPH__DEGENERATE);
}
