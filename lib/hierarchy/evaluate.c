/* SPDX-License-Identifier: MIT */
/* What it costs to collapse an edge. */
#include <math.h>

#include "hierarchy/build.h"
#include "quadric/minimizer.h"

sph__minimum sph__sums_minimize(const sph__sums *sums, double u_radius, double radius_max)
{
    /* g in the radius itself; the sums are in its difference from that of u. */
    const double w2 = sums->w - sums->nn, beta = sums->b - sums->nb;
    const double constant = sums->c - 0.5 * sums->bb + u_radius * (0.5 * w2 * u_radius + beta);
    const sph__box box = {.mu = sums->mu,
                          .nu = sums->nu,
                          .w2 = w2,
                          .beta1 = sums->b1 + sums->nu * u_radius,
                          .beta3 = beta + w2 * u_radius,
                          .mu_scale = sums->mu_scale,
                          .w2_scale = sums->w,
                          .cost_scale = sums->c + 0.5 * sums->bb,
                          .noise = SPH__NOISE_FLOAT};
    const sph__box_minimum found = sph__box_minimize(&box, sums->degenerate != 0, radius_max);
    const double cost = found.value + constant;
    return (sph__minimum){.lambda = found.lambda, .radius = found.radius, .cost = cost > 0 ? cost : 0};
}

double sph__evaluate(const sph__builder *b, uint32_t edge, sph__candidate *candidate)
{
    uint32_t nu, nv;
    sph__region u, v;
    sph__sums sums;
    sph__minimum minimum;
    double lower, upper;
    sph__edge_ends(b, edge, &nu, &nv);
    *candidate = (sph__candidate){.exact = 1};
    if (b->h->radii_per_frame) {
        candidate->exact = 0;
        return sph__per_frame_cost(b, nu, nv, NULL);
    }
    u = sph__region_of(b, nu);
    v = sph__region_of(b, nv);
    sph__kernel_sums(&u, &v, b->frames, b->stride, b->coherence, &sums);
    if (b->options.radius_mode == SPH_RADIUS_ZERO) {
        minimum = sph__sums_minimize(&sums, u.radius, 0);
    } else {
        const sph__slot *su = sph__slot_of(b, nu), *sv = sph__slot_of(b, nv);
        lower = b->radius_factor * (su->width > sv->width ? su->width : sv->width);
        minimum = sph__sums_minimize(&sums, u.radius, INFINITY);
        if (minimum.radius > lower) {
            upper = sph__union_width_bound(b, su, sv);
            minimum = sph__sums_minimize(&sums, u.radius, b->radius_factor * upper);
            candidate->exact = b->probe_frames == b->frames; /* then the bound is the width */
            candidate->width = candidate->exact ? upper : 0;
        }
    }
    candidate->lambda = minimum.lambda;
    candidate->radius = minimum.radius;
    return minimum.cost;
}

sph_status sph__evaluate_exactly(sph__builder *b, uint32_t edge, sph__candidate *candidate, double *cost)
{
    uint32_t nu, nv;
    sph__region u, v;
    sph__sums sums;
    sph__minimum minimum;
    sph_status status;
    sph__edge_ends(b, edge, &nu, &nv);
    candidate->exact = 1;
    if (b->h->radii_per_frame) {
        status = sph__union_frame_widths(b, &b->extents, sph__slot_of(b, nu), sph__slot_of(b, nv), b->union_widths);
        if (status != SPH_OK) return status;
        b->exact_edge = edge;
        *cost = sph__per_frame_cost(b, nu, nv, b->union_widths);
        return SPH_OK;
    }
    u = sph__region_of(b, nu);
    v = sph__region_of(b, nv);
    sph__kernel_sums(&u, &v, b->frames, b->stride, b->coherence, &sums);
    status = sph__union_width(b, &b->extents, sph__slot_of(b, nu), sph__slot_of(b, nv), &candidate->width);
    if (status != SPH_OK) return status;
    minimum = sph__sums_minimize(&sums, u.radius, b->radius_factor * candidate->width);
    candidate->lambda = minimum.lambda;
    candidate->radius = minimum.radius;
    *cost = minimum.cost;
    return SPH_OK;
}
