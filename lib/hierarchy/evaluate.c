/* SPDX-License-Identifier: MIT */
/* What it costs to collapse an edge. */
#include <math.h>

#include "hierarchy/build.h"
#include "quadric/minimizer.h"

/* Frames without a centre of their own, or nothing that fixes the radius. */
static sph__minimum minimize_box(const sph__sums *sums, double u_radius, double radius_max)
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
                          .w2_scale = fmax(sums->w, -w2 / SPH__NOISE_FLOAT), /* W2 >= 0: what is below is noise */
                          .cost_scale = sums->c + 0.5 * sums->bb,
                          .noise = SPH__NOISE_FLOAT};
    const sph__box_minimum found = sph__box_minimize(&box, sums->degenerate != 0, radius_max);
    const double cost = found.value + constant;
    return (sph__minimum){.lambda = found.lambda, .radius = found.radius, .cost = cost > 0 ? cost : 0};
}

/* All others, which are nearly all, come down to a parabola. */
static inline bool find_parabola(const sph__sums *sums, double u_radius, sph__parabola *parabola)
{
    const double w2 = sums->w - sums->nn, beta = sums->b - sums->nb;
    *parabola = (sph__parabola){0};
    if (sums->degenerate != 0 || !(w2 > SPH__NOISE_FLOAT * sums->w)) return false;
    parabola->w2 = w2;
    parabola->beta3 = beta + w2 * u_radius;
    parabola->constant = sums->c - 0.5 * sums->bb + u_radius * (0.5 * w2 * u_radius + beta);
    return true;
}

static inline sph__minimum minimize_parabola(const sph__parabola *parabola, double radius_max)
{
    const double w2 = parabola->w2, beta3 = parabola->beta3;
    const double radius = sph__line_minimum(w2, beta3, radius_max);
    const double cost = radius * (0.5 * w2 * radius - beta3) + parabola->constant;
    return (sph__minimum){.radius = radius, .cost = cost > 0 ? cost : 0};
}

static inline sph__minimum minimize(const sph__sums *sums, double u_radius, double radius_max, sph__parabola *parabola)
{
    return find_parabola(sums, u_radius, parabola) ? minimize_parabola(parabola, radius_max)
                                                   : minimize_box(sums, u_radius, radius_max);
}

sph__minimum sph__sums_minimize(const sph__sums *sums, double u_radius, double radius_max)
{
    sph__parabola parabola;
    return minimize(sums, u_radius, radius_max, &parabola);
}

static float round_down(double x)
{
    const float near = (float)x;
    return (double)near > x ? nextafterf(near, 0) : near;
}

double sph__evaluate_sums(const sph__builder *b, const sph__sums *sums, double u_radius, const sph__slot *su,
                          const sph__slot *sv, sph__candidate *candidate, sph__parabola *parabola)
{
    sph__minimum minimum;
    *candidate = (sph__candidate){.width = 0};
    if (b->options.radius_mode == SPH_RADIUS_ZERO) {
        minimum = minimize(sums, u_radius, 0, parabola);
    } else {
        const double lower = b->radius_factor * (su->width > sv->width ? su->width : sv->width);
        minimum = minimize(sums, u_radius, (double)INFINITY, parabola);
        if (minimum.radius > lower) {
            const double upper = sph__union_width_bound(b, su, sv);
            minimum = parabola->w2 > 0 ? minimize_parabola(parabola, b->radius_factor * upper)
                                       : minimize_box(sums, u_radius, b->radius_factor * upper);
            candidate->width = b->probe_frames == b->frames ? round_down(upper) : -1; /* then the bound is the width */
        }
    }
    candidate->lambda = minimum.lambda;
    candidate->radius = (float)minimum.radius;
    return minimum.cost;
}

double sph__evaluate_regions(const sph__builder *b, const sph__region *u, const sph__region *v, const sph__slot *su,
                             const sph__slot *sv, sph__candidate *candidate, sph__parabola *parabola)
{
    sph__sums sums;
    sph__kernel_sums(u, v, b->frames, b->stride, b->coherence, &sums);
    return sph__evaluate_sums(b, &sums, u->radius, su, sv, candidate, parabola);
}

/* Regions and parabolas are made where they stay: to copy what was just written waits for all of it. */
static double evaluate_pair(const sph__builder *b, uint32_t edge, uint32_t nu, uint32_t nv, uint32_t next,
                            sph__candidate *candidate)
{
    const sph__region v = sph__region_of(b, nv), following = sph__region_of(b, next);
    sph__region u = sph__region_of(b, nu);
    sph__parabola own, *parabola = b->parabolas != NULL ? &b->parabolas[edge] : &own;
    u.next = next != nu && following.block != NULL ? &following : NULL;
    return sph__evaluate_regions(b, &u, &v, sph__slot_of(b, nu), sph__slot_of(b, nv), candidate, parabola);
}

double sph__evaluate(const sph__builder *b, uint32_t edge, uint32_t next, sph__candidate *candidate)
{
    uint32_t u, v;
    sph__edge_ends(&b->mesh, edge, &u, &v);
    if (!b->h->radii_per_frame) return evaluate_pair(b, edge, u, v, next == SPH__NO_NODE ? u : next, candidate);
    *candidate = (sph__candidate){.width = -1};
    return sph__per_frame_cost(b, u, v, NULL);
}

/* From its sums, where they are needed: both ends have blocks then. */
static sph__minimum minimize_edge(const sph__builder *b, uint32_t edge, double radius_max)
{
    uint32_t nu, nv;
    sph__region u, v;
    sph__sums sums;
    if (sph__is_parabola(b, edge)) return minimize_parabola(&b->parabolas[edge], radius_max);
    sph__edge_ends(&b->mesh, edge, &nu, &nv);
    u = sph__region_of(b, nu);
    v = sph__region_of(b, nv);
    sph__kernel_sums(&u, &v, b->frames, b->stride, b->coherence, &sums);
    return sph__sums_minimize(&sums, u.radius, radius_max);
}

sph_status sph__evaluate_exactly(const sph__builder *b, sph__extents *extents, uint32_t edge, sph__candidate *candidate,
                                 double *cost)
{
    uint32_t u, v;
    sph__minimum minimum;
    double width;
    sph_status status;
    sph__edge_ends(&b->mesh, edge, &u, &v);
    status = sph__union_width(b, extents, sph__slot_of(b, u), sph__slot_of(b, v), &width);
    if (status != SPH_OK) return status;
    minimum = minimize_edge(b, edge, b->radius_factor * width);
    candidate->width = round_down(width);
    candidate->lambda = minimum.lambda;
    candidate->radius = (float)minimum.radius;
    *cost = minimum.cost;
    return SPH_OK;
}
