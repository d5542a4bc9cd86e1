/* SPDX-License-Identifier: MIT */
/* The minimiser's last step, which every way of storing quadrics shares: two unknowns in a box. */
#ifndef SPH_QUADRIC_MINIMIZER_H
#define SPH_QUADRIC_MINIMIZER_H

#include <math.h>
#include <stdbool.h>

/*
 * A frame does not fix its centre where det M <= SPH__DEGENERATE (trace M / 3)^3. Normals within 1.6 degrees of their
 * mean are that flat; so is a cylinder's side that tilts by 0.02 degrees. Far above the noise of 64-bit sums, and just
 * above that of an M stored with 32 bits, for which the axis of a cylinder is the worst case (some 3e-7).
 */
#define SPH__DEGENERATE 1e-6

/* Relative errors that coefficients have when M, N and b are kept with 64 or with 32 bits. */
#define SPH__NOISE_DOUBLE 1e-13
#define SPH__NOISE_FLOAT 1e-6

/*
 * g(lambda, r) = 1/2 mu lambda^2 + nu lambda r + 1/2 w2 r^2 - beta1 lambda - beta3 r
 *
 * What counts as zero depends on what cancelled, so each coefficient comes with a scale: the size of the terms it was
 * summed from. |nu| is at most sqrt(mu w2), and beta1 and beta3 at most the root of cost_scale times mu_scale or
 * w2_scale, so three scales serve. Scales left at 0 mean that nothing cancelled.
 */
typedef struct sph__box {
    double mu;         /* sum over D of d'M d */
    double nu;         /* sum over D of N.d */
    double w2;         /* W - sum over the other frames of N'M^-1 N */
    double beta1;      /* sum over D of (b - M u).d */
    double beta3;      /* B - sum over D of N.u - sum over the other frames of N'M^-1 b */
    double mu_scale;   /* sum over D of trace(M) |d|^2 */
    double w2_scale;   /* W + sum over the other frames of trace(M) |M^-1 N|^2; plain W will do */
    double cost_scale; /* c + sum over D of (1/2 u'M u + |b.u|) + sum over the other frames of 1/2 b'M^-1 b */
    double noise;      /* relative error of the scales: SPH__NOISE_DOUBLE or SPH__NOISE_FLOAT */
} sph__box;

typedef struct sph__box_minimum {
    double lambda; /* in [0, 1]; 0 where no frame is degenerate */
    double radius; /* in [0, radius_max], finite */
    double value;  /* g there */
} sph__box_minimum;

/*
 * The least g on [0, 1] x [0, radius_max]; `radius_max` may be 0 or INFINITY. Without degenerate frames lambda is 0 and
 * only w2 and beta3 count. Where g is least along a line (to within its noise), the point of smallest r is taken; where
 * lambda makes no difference it is 1/2. Whatever the input, the result is in the box.
 */
sph__box_minimum sph__box_minimize(const sph__box *box, bool any_degenerate, double radius_max);

/* Where 1/2 a x^2 - s x is least on [0, end]; never NaN, and finite also where `end` is not. */
static inline double sph__line_minimum(double a, double s, double end)
{
    double x;
    if (!(s > 0.0)) return 0.0;
    x = a > 0.0 ? s / a : end;
    if (!(x <= end)) x = end;
    return isfinite(x) ? x : 0.0;
}

/* M as 00 01 02 11 12 22. A matrix that is zero, or not finite, is degenerate. */
bool sph__is_degenerate(const double m[6]);

#endif
