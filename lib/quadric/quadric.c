/* SPDX-License-Identifier: MIT */
#include <sphmesh/quadric.h>

#include <math.h>

#include "base/base.h"
#include "numeric/numeric.h"
#include "quadric/minimizer.h"

/* Coordinates are relative to the anchor: a nearly flat set of planes costs far less than its distance from the origin.
 */
typedef struct frame_terms {
    double m[6], n[3], b[3];
    double anchor[3]; /* the first plane's point */
    bool anchored;    /* otherwise everything is 0 */
} frame_terms;

typedef struct scalar_terms {
    double w, b, c; /* W, B, c: sums over the frames */
} scalar_terms;

struct sph_quadric {
    sph_context *context;
    frame_terms *frames;
    scalar_terms sums;
    uint32_t frame_count;
};

sph_status sph_quadric_create(sph_context *context, uint32_t frame_count, sph_quadric **out)
{
    SPH__OWN(context, SPH__CONTEXT);
    sph_quadric *quadric;
    if (out == NULL) return sph__fail(context, SPH_E_INVALID, "quadric: out is NULL");
    *out = NULL;
    if (context == NULL) return SPH_E_INVALID;
    if (frame_count == 0 || frame_count > INT32_MAX)
        return sph__fail(context, SPH_E_INVALID, "quadric: %u frames, not from 1 to 2^31 - 1", (unsigned)frame_count);
    quadric = sph__new(context, sizeof *quadric, SPH__QUADRIC);
    if (quadric == NULL) return sph__fail_memory(context);
    quadric->frames = sph__zalloc(context, frame_count, sizeof *quadric->frames);
    if (quadric->frames == NULL) {
        sph__free(context, quadric);
        return sph__fail_memory(context);
    }
    quadric->frame_count = frame_count;
    quadric->context = sph__context_retain(context);
    *out = quadric;
    return SPH_OK;
}

void sph_quadric_destroy(sph_quadric *quadric)
{
    SPH__OWN(quadric, SPH__QUADRIC);
    sph_context *context;
    if (quadric == NULL) return;
    context = quadric->context;
    sph__free(context, quadric->frames);
    sph__free(context, quadric);
    sph__context_release(context);
}

uint32_t sph_quadric_frame_count(const sph_quadric *quadric)
{
    SPH__OWN(quadric, SPH__QUADRIC);
    return quadric == NULL ? 0 : quadric->frame_count;
}

/* --- adding --- */

static bool is_finite_frame(const frame_terms *frame)
{
    return sph__is_finite3(frame->m) && sph__is_finite3(frame->m + 3) && sph__is_finite3(frame->n) &&
           sph__is_finite3(frame->b) && sph__is_finite3(frame->anchor);
}

static bool is_finite_sums(const scalar_terms *sums)
{
    return isfinite(sums->w) && isfinite(sums->b) && isfinite(sums->c);
}

/* Stores a frame and the sums as an addition would make them, unless they overflowed. */
static sph_status put_terms(sph_quadric *quadric, uint32_t index, const frame_terms *frame, const scalar_terms *sums)
{
    if (!is_finite_frame(frame) || !is_finite_sums(sums))
        return sph__fail(quadric->context, SPH_E_INVALID, "quadric: frame %u: numbers too large", (unsigned)index);
    quadric->frames[index] = *frame;
    quadric->sums = *sums;
    return SPH_OK;
}

static sph_status check_addition(const sph_quadric *quadric, uint32_t frame, const double point[3], double weight,
                                 const char *what)
{
    if (quadric == NULL) return SPH_E_INVALID;
    if (frame >= quadric->frame_count)
        return sph__fail(quadric->context, SPH_E_INVALID, "quadric: frame %u, but there are only %u", (unsigned)frame,
                         (unsigned)quadric->frame_count);
    if (point == NULL)
        return sph__fail(quadric->context, SPH_E_INVALID, "quadric: frame %u: the %s is NULL", (unsigned)frame, what);
    if (!sph__is_finite3(point))
        return sph__fail(quadric->context, SPH_E_INVALID, "quadric: frame %u: the %s is not finite", (unsigned)frame,
                         what);
    if (!(weight >= 0.0) || isinf(weight))
        return sph__fail(quadric->context, SPH_E_INVALID, "quadric: frame %u: weight %g", (unsigned)frame, weight);
    return SPH_OK;
}

static void anchor_at(frame_terms *frame, const double point[3])
{
    if (frame->anchored) return;
    memcpy(frame->anchor, point, sizeof frame->anchor);
    frame->anchored = true;
}

sph_status sph_quadric_add_plane(sph_quadric *quadric, uint32_t frame, const double point[3], const double normal[3],
                                 double weight)
{
    SPH__OWN(quadric, SPH__QUADRIC);
    const sph_status status = check_addition(quadric, frame, point, weight, "point");
    double unit[3], local[3], distance;
    frame_terms terms;
    scalar_terms sums;
    if (status != SPH_OK) return status;
    if (normal == NULL)
        return sph__fail(quadric->context, SPH_E_INVALID, "quadric: frame %u: the normal is NULL", (unsigned)frame);
    memcpy(unit, normal, sizeof unit);
    if (!sph__normalize(unit))
        return sph__fail(quadric->context, SPH_E_INVALID, "quadric: frame %u: the normal is zero or not finite",
                         (unsigned)frame);
    if (weight == 0.0) return SPH_OK;
    terms = quadric->frames[frame];
    sums = quadric->sums;
    anchor_at(&terms, point);
    sph__subtract(point, terms.anchor, local);
    distance = sph__dot(unit, local);
    sph__sym3_add_outer(2.0 * weight, unit, terms.m);
    sph__add_scaled(terms.n, 2.0 * weight, unit, terms.n);
    sph__add_scaled(terms.b, 2.0 * weight * distance, unit, terms.b);
    sums.w += 2.0 * weight;
    sums.b += 2.0 * weight * distance;
    sums.c += weight * distance * distance;
    return put_terms(quadric, frame, &terms, &sums);
}

sph_status sph_quadric_add_attachment(sph_quadric *quadric, uint32_t frame, const double center[3], double weight)
{
    SPH__OWN(quadric, SPH__QUADRIC);
    static const int diagonal[3] = {0, 3, 5};
    const sph_status status = check_addition(quadric, frame, center, weight, "center");
    double local[3];
    frame_terms terms;
    scalar_terms sums;
    if (status != SPH_OK) return status;
    if (weight == 0.0) return SPH_OK;
    terms = quadric->frames[frame];
    sums = quadric->sums;
    anchor_at(&terms, center);
    sph__subtract(center, terms.anchor, local);
    for (int i = 0; i < 3; ++i)
        terms.m[diagonal[i]] += 2.0 * weight;
    sph__add_scaled(terms.b, 2.0 * weight, local, terms.b);
    sums.c += weight * sph__dot(local, local);
    return put_terms(quadric, frame, &terms, &sums);
}

/* frame += other, moved to frame's anchor; what the move adds to B and c goes into `sums`. */
static void unite(frame_terms *frame, const frame_terms *other, scalar_terms *sums)
{
    double d[3], md[3];
    if (!other->anchored) return;
    anchor_at(frame, other->anchor);
    sph__subtract(other->anchor, frame->anchor, d);
    sph__sym3_apply(other->m, d, md);
    sums->b += sph__dot(other->n, d);
    sums->c += sph__dot(other->b, d) + 0.5 * sph__dot(d, md);
    for (int i = 0; i < 3; ++i) {
        frame->n[i] += other->n[i];
        frame->b[i] += other->b[i] + md[i];
    }
    for (int i = 0; i < 6; ++i)
        frame->m[i] += other->m[i];
}

sph_status sph_quadric_add(sph_quadric *quadric, const sph_quadric *other)
{
    SPH__OWN(quadric, SPH__QUADRIC);
    SPH__OWN(other, SPH__QUADRIC);
    scalar_terms sums;
    if (quadric == NULL) return SPH_E_INVALID;
    if (other == NULL) return sph__fail(quadric->context, SPH_E_INVALID, "quadric: the other one is NULL");
    if (other->frame_count != quadric->frame_count)
        return sph__fail(quadric->context, SPH_E_INVALID, "quadric: %u frames cannot be added to %u",
                         (unsigned)other->frame_count, (unsigned)quadric->frame_count);
    sums.w = quadric->sums.w + other->sums.w;
    sums.b = quadric->sums.b + other->sums.b;
    sums.c = quadric->sums.c + other->sums.c;
    /* First all sums, so that numbers too large leave the quadric as it was. */
    for (uint32_t f = 0; f < quadric->frame_count; ++f) {
        frame_terms united = quadric->frames[f];
        unite(&united, &other->frames[f], &sums);
        if (!is_finite_frame(&united) || !is_finite_sums(&sums))
            return sph__fail(quadric->context, SPH_E_INVALID, "quadric: frame %u: numbers too large", (unsigned)f);
    }
    for (uint32_t f = 0; f < quadric->frame_count; ++f) {
        const frame_terms copy = other->frames[f];
        scalar_terms ignored = {0};
        unite(&quadric->frames[f], &copy, &ignored);
    }
    quadric->sums = sums;
    return SPH_OK;
}

/* --- asking --- */

sph_status sph_quadric_evaluate(const sph_quadric *quadric, const double *centers, double radius, double *cost)
{
    SPH__OWN(quadric, SPH__QUADRIC);
    double sum;
    if (quadric == NULL) return SPH_E_INVALID;
    if (centers == NULL || cost == NULL)
        return sph__fail(quadric->context, SPH_E_INVALID, "quadric: %s is NULL", centers == NULL ? "centers" : "cost");
    if (!isfinite(radius)) return sph__fail(quadric->context, SPH_E_INVALID, "quadric: radius %g", radius);
    sum = radius * (0.5 * quadric->sums.w * radius - quadric->sums.b) + quadric->sums.c;
    for (uint32_t f = 0; f < quadric->frame_count; ++f) {
        const frame_terms *frame = &quadric->frames[f];
        double q[3], mq[3];
        if (!sph__is_finite3(centers + 3 * (size_t)f))
            return sph__fail(quadric->context, SPH_E_INVALID, "quadric: frame %u: the center is not finite",
                             (unsigned)f);
        if (!frame->anchored) continue;
        sph__subtract(centers + 3 * (size_t)f, frame->anchor, q);
        sph__sym3_apply(frame->m, q, mq);
        sum += 0.5 * sph__dot(q, mq) + radius * sph__dot(frame->n, q) - sph__dot(frame->b, q);
    }
    if (!isfinite(sum)) return sph__fail(quadric->context, SPH_E_INVALID, "quadric: numbers too large");
    *cost = sum;
    return SPH_OK;
}

/* Whether the planes fix the centre; if so, M in factors. */
static bool is_regular(const frame_terms *frame, sph__sym3_factor *factor)
{
    return !sph__is_degenerate(frame->m) && sph__sym3_factorize(frame->m, factor);
}

static void read_segment(const double *u, const double *v, uint32_t frame, double start[3], double d[3])
{
    static const double origin[3] = {0, 0, 0};
    memcpy(start, u == NULL ? origin : u + 3 * (size_t)frame, 3 * sizeof *start);
    sph__subtract(u == NULL ? origin : v + 3 * (size_t)frame, start, d);
}

/* The two-variable problem, and what it leaves out of the cost. */
typedef struct problem {
    sph__box box;
    double rest;
    uint32_t degenerate_frames;
} problem;

static void add_regular(problem *p, const frame_terms *frame, const sph__sym3_factor *factor)
{
    double mn[3], mb[3], bmb;
    sph__sym3_solve(factor, frame->n, mn);
    sph__sym3_solve(factor, frame->b, mb);
    bmb = sph__dot(frame->b, mb);
    p->box.w2 -= sph__dot(frame->n, mn);
    p->box.beta3 -= sph__dot(frame->n, mb);
    p->box.w2_scale += sph__sym3_trace(frame->m) * sph__dot(mn, mn);
    p->box.cost_scale += 0.5 * bmb;
    p->rest -= 0.5 * bmb;
}

/* `start` relative to the anchor */
static void add_degenerate(problem *p, const frame_terms *frame, const double start[3], const double d[3])
{
    double mu[3], md[3];
    ++p->degenerate_frames;
    if (!frame->anchored) return;
    sph__sym3_apply(frame->m, start, mu);
    sph__sym3_apply(frame->m, d, md);
    p->box.mu += sph__dot(d, md);
    p->box.nu += sph__dot(frame->n, d);
    p->box.beta1 += sph__dot(frame->b, d) - sph__dot(mu, d);
    p->box.beta3 -= sph__dot(frame->n, start);
    p->box.mu_scale += sph__sym3_trace(frame->m) * sph__dot(d, d);
    p->box.cost_scale += 0.5 * sph__dot(start, mu) + fabs(sph__dot(frame->b, start));
    p->rest += 0.5 * sph__dot(start, mu) - sph__dot(frame->b, start);
}

static problem collect(const sph_quadric *quadric, const double *u, const double *v)
{
    const scalar_terms *sums = &quadric->sums;
    problem p = {.box = {.w2 = sums->w,
                         .beta3 = sums->b,
                         .w2_scale = sums->w,
                         .cost_scale = sums->c,
                         .noise = SPH__NOISE_DOUBLE},
                 .rest = sums->c};
    for (uint32_t f = 0; f < quadric->frame_count; ++f) {
        const frame_terms *frame = &quadric->frames[f];
        sph__sym3_factor factor;
        if (is_regular(frame, &factor)) {
            add_regular(&p, frame, &factor);
        } else {
            double start[3], d[3];
            read_segment(u, v, f, start, d);
            sph__subtract(start, frame->anchor, start);
            add_degenerate(&p, frame, start, d);
        }
    }
    return p;
}

static void write_centers(const sph_quadric *quadric, const double *u, const double *v, const sph__box_minimum *at,
                          double *centers)
{
    for (uint32_t f = 0; f < quadric->frame_count; ++f) {
        const frame_terms *frame = &quadric->frames[f];
        double *center = centers + 3 * (size_t)f;
        sph__sym3_factor factor;
        double q[3], d[3];
        if (is_regular(frame, &factor)) {
            memcpy(q, frame->b, sizeof q);
            sph__add_scaled(q, -at->radius, frame->n, q);
            sph__sym3_solve(&factor, q, q);
            sph__add_scaled(q, 1.0, frame->anchor, q);
        } else {
            read_segment(u, v, f, q, d);
            sph__add_scaled(q, at->lambda, d, q);
        }
        memcpy(center, q, sizeof q);
    }
}

static sph_status check_segments(const sph_quadric *quadric, const double *u, const double *v)
{
    if ((u == NULL) != (v == NULL))
        return sph__fail(quadric->context, SPH_E_INVALID, "quadric: one end of the segment is NULL");
    for (uint32_t f = 0; u != NULL && f < quadric->frame_count; ++f) {
        double start[3], d[3];
        read_segment(u, v, f, start, d);
        if (!sph__is_finite3(start) || !sph__is_finite3(d))
            return sph__fail(quadric->context, SPH_E_INVALID, "quadric: frame %u: the segment is not finite",
                             (unsigned)f);
    }
    return SPH_OK;
}

sph_status sph_quadric_minimize(const sph_quadric *quadric, const double *u, const double *v, double radius_max,
                                sph_quadric_minimum *minimum, double *centers)
{
    SPH__OWN(quadric, SPH__QUADRIC);
    sph_status status;
    problem p;
    sph__box_minimum at;
    double cost;
    if (quadric == NULL) return SPH_E_INVALID;
    if (minimum == NULL) return sph__fail(quadric->context, SPH_E_INVALID, "quadric: minimum is NULL");
    if (!(radius_max >= 0.0))
        return sph__fail(quadric->context, SPH_E_INVALID, "quadric: radius_max %g is not >= 0", radius_max);
    if ((status = check_segments(quadric, u, v)) != SPH_OK) return status;
    p = collect(quadric, u, v);
    at = sph__box_minimize(&p.box, p.degenerate_frames > 0, radius_max);
    cost = at.value + p.rest;
    if (!isfinite(cost)) return sph__fail(quadric->context, SPH_E_INVALID, "quadric: numbers too large");
    if (centers != NULL) write_centers(quadric, u, v, &at, centers);
    *minimum = (sph_quadric_minimum){
        .radius = at.radius, .lambda = at.lambda, .cost = cost, .degenerate_frames = p.degenerate_frames};
    return SPH_OK;
}
