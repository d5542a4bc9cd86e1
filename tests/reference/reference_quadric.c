/* SPDX-License-Identifier: MIT */
#include "reference_quadric.h"

#include <math.h>

typedef reference_real real;

static real dot(const real a[3], const real b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void multiply(real M[3][3], const real x[3], real out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = dot(M[i], x);
}

void reference_quadric_add_plane(struct reference_quadric *quadric, const real p[3], const real n[3], real weight)
{
    const real height = dot(n, p);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j)
            quadric->M[i][j] += 2 * weight * n[i] * n[j];
        quadric->N[i] += 2 * weight * n[i];
        quadric->b[i] += 2 * weight * height * n[i];
    }
    quadric->W += 2 * weight;
    quadric->B += 2 * weight * height;
    quadric->c += weight * height * height;
}

void reference_quadric_add_attachment(struct reference_quadric *quadric, const real center[3], real weight)
{
    for (int i = 0; i < 3; ++i) {
        quadric->M[i][i] += 2 * weight;
        quadric->b[i] += 2 * weight * center[i];
    }
    quadric->c += weight * dot(center, center);
}

void reference_quadric_add(struct reference_quadric *quadric, const struct reference_quadric *other,
                           const real origin[3])
{
    struct reference_quadric o = *other;
    real Md[3];
    multiply(o.M, origin, Md);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j)
            quadric->M[i][j] += o.M[i][j];
        quadric->N[i] += o.N[i];
        quadric->b[i] += o.b[i] + Md[i];
    }
    quadric->W += o.W;
    quadric->B += o.B + dot(o.N, origin);
    quadric->c += o.c + dot(o.b, origin) + dot(Md, origin) / 2;
}

real reference_quadric_evaluate(const struct reference_quadric *quadric, const real center[3], real radius)
{
    struct reference_quadric o = *quadric;
    real Mq[3];
    multiply(o.M, center, Mq);
    return dot(Mq, center) / 2 + radius * dot(o.N, center) - dot(o.b, center) + o.W * radius * radius / 2 -
           o.B * radius + o.c;
}

static real determinant(real M[3][3])
{
    return M[0][0] * (M[1][1] * M[2][2] - M[1][2] * M[2][1]) - M[0][1] * (M[1][0] * M[2][2] - M[1][2] * M[2][0]) +
           M[0][2] * (M[1][0] * M[2][1] - M[1][1] * M[2][0]);
}

bool reference_quadric_is_degenerate(const struct reference_quadric *quadric)
{
    struct reference_quadric o = *quadric;
    const real mean = (o.M[0][0] + o.M[1][1] + o.M[2][2]) / 3;
    return determinant(o.M) <= REFERENCE_SINGULAR * mean * mean * mean;
}

/* x = M^-1 y by Cramer's rule. */
static void solve(real M[3][3], const real y[3], real x[3])
{
    real A[3][3];
    real full;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            A[i][j] = M[i][j];
    full = determinant(A);
    for (int column = 0; column < 3; ++column) {
        for (int i = 0; i < 3; ++i)
            A[i][column] = y[i];
        x[column] = determinant(A) / full;
        for (int i = 0; i < 3; ++i)
            A[i][column] = M[i][column];
    }
}

/* g(lambda, r) = 1/2 mu lambda^2 + nu lambda r + 1/2 W r^2 - beta1 lambda - beta3 r: what is left of Q once the centres
 * of the regular frames are at their best for r. */
struct plane_problem {
    real mu, nu, W, beta1, beta3;
    real radius_max;
    bool mu_is_zero, W_is_zero, is_singular;
};

static void reduce(const struct reference_quadric *quadrics, size_t count, real (*u)[3], real (*v)[3],
                   struct plane_problem *p)
{
    real mu_scale = 0, W_total = 0;
    for (size_t f = 0; f < count; ++f) {
        struct reference_quadric q = quadrics[f];
        W_total += q.W;
        p->W += q.W;
        p->beta3 += q.B;
        if (reference_quadric_is_degenerate(&q)) {
            const real d[3] = {v[f][0] - u[f][0], v[f][1] - u[f][1], v[f][2] - u[f][2]};
            real Md[3];
            multiply(q.M, d, Md);
            p->mu += dot(d, Md);
            p->nu += dot(q.N, d);
            p->beta1 += dot(q.b, d) - dot(Md, u[f]);
            p->beta3 -= dot(q.N, u[f]);
            mu_scale += (q.M[0][0] + q.M[1][1] + q.M[2][2]) * dot(d, d);
        } else {
            real MN[3], Mb[3];
            solve(q.M, q.N, MN);
            solve(q.M, q.b, Mb);
            p->W -= dot(q.N, MN);
            p->beta3 -= dot(q.N, Mb);
        }
    }
    p->mu_is_zero = p->mu <= REFERENCE_ZERO * mu_scale;
    p->W_is_zero = p->W <= REFERENCE_ZERO * W_total;
    p->is_singular = p->mu_is_zero || p->W_is_zero || p->mu * p->W - p->nu * p->nu <= REFERENCE_ZERO * p->mu * p->W;
}

static real clamp(real x, real low, real high)
{
    return x < low ? low : x > high ? high : x;
}

static void keep_if_cheaper(const struct plane_problem *p, real lambda, real r, real *best, real out[2])
{
    const real g =
        p->mu * lambda * lambda / 2 + p->nu * lambda * r + p->W * r * r / 2 - p->beta1 * lambda - p->beta3 * r;
    if (g < *best) {
        *best = g;
        out[0] = lambda;
        out[1] = r;
    }
}

static void minimise_on_border(const struct plane_problem *p, real out[2])
{
    real best = HUGE_VALL;
    for (int side = 0; side < 2; ++side)
        keep_if_cheaper(p, side, clamp((p->beta3 - side * p->nu) / p->W, 0, p->radius_max), &best, out);
    for (int side = 0; side < 2; ++side) {
        const real r = side ? p->radius_max : 0;
        keep_if_cheaper(p, clamp((p->beta1 - p->nu * r) / p->mu, 0, 1), r, &best, out);
    }
}

/* Where the solutions of the singular system form a line that meets the box: its point of smallest r. */
static bool minimise_on_line(const struct plane_problem *p, real out[2])
{
    if (p->nu == 0) { /* lambda = beta1 / mu */
        out[0] = p->beta1 / p->mu;
        out[1] = 0;
    } else { /* mu lambda + nu r = beta1 */
        const real at0 = p->beta1 / p->nu, at1 = (p->beta1 - p->mu) / p->nu;
        const real low = at0 < at1 ? at0 : at1, high = at0 < at1 ? at1 : at0;
        if (high < 0) return false;
        out[1] = low > 0 ? low : 0;
        out[0] = clamp((p->beta1 - p->nu * out[1]) / p->mu, 0, 1);
    }
    return out[0] >= 0 && out[0] <= 1 && out[1] >= 0 && out[1] <= p->radius_max;
}

/* As |nu| is at most sqrt(mu W), it vanishes with either. Where lambda makes no difference it is 1/2, where r does, 0.
 */
static void minimise_on_box(const struct plane_problem *p, real out[2])
{
    if (p->mu_is_zero || p->W_is_zero) {
        out[0] = p->mu_is_zero ? 0.5L : clamp(p->beta1 / p->mu, 0, 1);
        out[1] = p->W_is_zero ? 0 : clamp(p->beta3 / p->W, 0, p->radius_max);
        return;
    }
    if (p->is_singular) {
        if (minimise_on_line(p, out)) return;
    } else {
        const real det = p->mu * p->W - p->nu * p->nu;
        out[0] = (p->W * p->beta1 - p->nu * p->beta3) / det;
        out[1] = (p->mu * p->beta3 - p->nu * p->beta1) / det;
        if (out[0] >= 0 && out[0] <= 1 && out[1] >= 0 && out[1] <= p->radius_max) return;
    }
    minimise_on_border(p, out);
}

void reference_quadric_minimise(const struct reference_quadric *quadrics, size_t count, real (*u)[3], real (*v)[3],
                                real radius_max, struct reference_minimum *minimum, real (*centers)[3])
{
    struct plane_problem p = {.radius_max = radius_max};
    real solution[2] = {0, 0};
    reduce(quadrics, count, u, v, &p);
    minimise_on_box(&p, solution);
    *minimum = (struct reference_minimum){.lambda = solution[0], .radius = solution[1]};
    for (size_t f = 0; f < count; ++f) {
        struct reference_quadric q = quadrics[f];
        if (reference_quadric_is_degenerate(&q)) {
            ++minimum->degenerate_frames;
            for (int i = 0; i < 3; ++i)
                centers[f][i] = u[f][i] + minimum->lambda * (v[f][i] - u[f][i]);
        } else {
            real right[3];
            for (int i = 0; i < 3; ++i)
                right[i] = q.b[i] - minimum->radius * q.N[i];
            solve(q.M, right, centers[f]);
        }
        minimum->cost += reference_quadric_evaluate(&q, centers[f], minimum->radius);
    }
    if (minimum->cost < 0) minimum->cost = 0; /* a sum of squares: below zero is rounding */
}
