/* SPDX-License-Identifier: MIT */
/* Operators on two field values, and the curves that steer them. */
#include <math.h>

#include "implicit/implicit.h"

enum { BISECTIONS = 60 };
static const double PI = 3.14159265358979323846;

/* Flat at 0 and at 1. */
static double kappa(double x)
{
    if (x <= 0) return 0;
    if (x >= 1) return 1;
    return 1 - exp(1 - 1 / (1 - exp(1 - 1 / x)));
}

/* From theta_1 at x = 0 to `end` at 1. */
static double ease(const sph_theta_curve *c, double end, double x, double exponent)
{
    return c->thetas[1] + (end - c->thetas[1]) * pow(kappa(x), exponent);
}

double sph__curve_at(const sph_theta_curve *c, double alpha)
{
    const double *a = c->angles;
    if (alpha <= a[0]) return c->thetas[0];
    if (alpha >= a[2]) return c->thetas[2];
    if (alpha < a[1]) return ease(c, c->thetas[0], (alpha - a[1]) / (a[0] - a[1]), c->exponents[0]);
    if (alpha > a[1]) return ease(c, c->thetas[2], (alpha - a[1]) / (a[2] - a[1]), c->exponents[1]);
    return c->thetas[1];
}

double sph_theta_curve_at(const sph_theta_curve *curve, double alpha)
{
    if (curve == NULL || isnan(alpha)) return NAN;
    return sph__curve_at(curve, alpha);
}

void sph_theta_curve_preset(sph_theta_curve *curve, int32_t operation)
{
    const double u = SPH__UNION_THETA;
    if (curve == NULL) return;
    if (operation == SPH_OPERATION_UNION)
        *curve = (sph_theta_curve){{0, PI / 4, PI / 2}, {u, u, u}, {1, 1}};
    else if (operation == SPH_OPERATION_BLEND)
        *curve = (sph_theta_curve){{0, PI / 4, PI / 2}, {u, 0, u}, {1, 1}};
    else if (operation == SPH_OPERATION_BULGE)
        *curve = (sph_theta_curve){{0, PI / 4, PI / 2}, {u, u / 2, 0}, {1, 1}};
}

/* --- the operators --- */

/* k(C) = slope C + offset, in two pieces. */
typedef struct line {
    double slope, offset;
} line;

static line piece(double tangent, bool inner)
{
    const line outer = {tangent, 0}, in = {0.5 * (7 - 5 * tangent), 1.75 * (tangent - 1)};
    return inner ? in : outer;
}

static double line_at(line l, double c)
{
    return l.slope * c + l.offset;
}

/* p(t), and its derivative. */
static double profile(double strength, double t, double *slope)
{
    const double e = t > 0 ? exp(1 - 1 / t) : 0;
    *slope = t > 0 ? strength * e * (1 - (1 - t) / (t * t)) : 0;
    return 1 - strength * (1 - t) * e;
}

/* (C - k) p(t) - sqrt(...), rising through 0 at the value; `large` and `small` are the two field values. */
static double excess(double strength, line l, double large, double small, double c)
{
    const double k = line_at(l, c), dx = large - k, dy = small - k;
    double slope;
    const double p = strength > 0 ? profile(strength, dx > 0 && dy > 0 ? dy / dx : 0, &slope) : 1;
    return (c - k) * p - sqrt(dx * dx + dy * dy);
}

/* The C between `low`, where the excess is not above 0, and `high`, where it is not below. */
static double find_value(double strength, line l, double large, double small, double low, double high)
{
    double below = excess(strength, l, large, small, low), above = excess(strength, l, large, small, high);
    for (int i = 0; i < BISECTIONS && high - low > 1e-16; ++i) {
        /* by the secant, which is nearly straight; every third time by halves, so that it ends */
        double c = above > below ? low - below * (high - low) / (above - below) : 0.5 * (low + high), e;
        if (i % 3 == 2 || !(c > low && c < high)) c = 0.5 * (low + high);
        e = excess(strength, l, large, small, c);
        if (e == 0) return c;
        if (e < 0) {
            low = c;
            below = e;
        } else {
            high = c;
            above = e;
        }
    }
    return 0.5 * (low + high);
}

/* Derivatives of the value by the larger and the smaller field, by the theorem of implicit functions. */
static void find_slopes(double strength, line l, double large, double small, double c, double slopes[2])
{
    const double k = line_at(l, c), dx = large - k, dy = small - k, r = sqrt(dx * dx + dy * dy);
    double p_slope = 0, t, p, by_c;
    if (!(dx > 0) || !(r > 0)) {
        slopes[0] = 1;
        slopes[1] = 0;
        return;
    }
    t = dy > 0 ? dy / dx : 0;
    p = strength > 0 ? profile(strength, t, &p_slope) : 1;
    by_c = (1 - l.slope) * p - (c - k) * p_slope * l.slope * (1 - t) / dx + l.slope * (dx + dy) / r;
    slopes[0] = (dx / r + (c - k) * p_slope * t / dx) / by_c;
    slopes[1] = (dy / r - (c - k) * p_slope / dx) / by_c;
}

double sph__compose(int32_t operation, double strength, double theta, double f1, double f2, double slopes[2])
{
    const bool first = f1 >= f2;
    const double large = first ? f1 : f2, small = first ? f2 : f1;
    const double tangent = theta >= SPH__UNION_THETA ? 1 : tan(theta);
    const double m = operation == SPH_OPERATION_BULGE ? strength : 0;
    double value = large, by[2] = {1, 0};
    if (operation != SPH_OPERATION_UNION && tangent < 1 && line_at(piece(tangent, large > 0.5), large) < small) {
        const double half = line_at(piece(tangent, false), 0.5); /* k(1/2) */
        /* at the C where k is the smaller field, the value of the equation is no longer below */
        const bool outer_end = small <= half;
        const line last = piece(tangent, !outer_end);
        const double end = (small - last.offset) / last.slope;
        bool inner = large > 0.5 || (!outer_end && excess(m, piece(tangent, false), large, small, 0.5) < 0);
        const double low = inner && large < 0.5 ? 0.5 : large, high = inner || outer_end ? end : 0.5;
        value = find_value(m, piece(tangent, inner), large, small, low, high > low ? high : low);
        find_slopes(m, piece(tangent, inner), large, small, value, by);
    }
    slopes[0] = by[first ? 0 : 1];
    slopes[1] = by[first ? 1 : 0];
    return value;
}

sph_status sph_operation_compose(int32_t operation, double strength, double theta, const double values[2],
                                 double *result, double slopes[2])
{
    double by[2];
    if (values == NULL || result == NULL || operation < SPH_OPERATION_UNION || operation > SPH_OPERATION_BULGE ||
        !(strength >= 0 && strength <= SPH_BULGE_LIMIT) || !(theta >= 0 && theta <= SPH__UNION_THETA + 1e-12) ||
        !(values[0] >= 0 && values[0] <= 1) || !(values[1] >= 0 && values[1] <= 1))
        return SPH_E_INVALID;
    *result = sph__compose(operation, strength, theta, values[0], values[1], by);
    if (slopes != NULL) memcpy(slopes, by, sizeof by);
    return SPH_OK;
}
