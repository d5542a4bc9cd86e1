/* SPDX-License-Identifier: MIT */
/* Casts against the definition of the solid. */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "runner.h"
#include "solid.h"
#include "support.h"

static sph_context *context;
static uint64_t state;

static void setup(void)
{
    context = test_context();
    state = 20160301;
}

static void teardown(void)
{
    sph_context_destroy(context);
}

static double between(double low, double high)
{
    return low + (high - low) * test_random_unit(&state);
}

static uint32_t below(uint32_t count)
{
    return (uint32_t)(test_random(&state) % count);
}

static void random_unit(double out[3])
{
    double length;
    do {
        for (int k = 0; k < 3; ++k)
            out[k] = between(-1, 1);
        length = sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
    } while (length > 1 || length < 0.1);
    for (int k = 0; k < 3; ++k)
        out[k] /= length;
}

/* Spheres that are now and then degenerate in one way or another. */
static void random_spheres(test_solid *s, uint32_t count)
{
    s->sphere_count = count;
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t other = below(count);
        for (int k = 0; k < 3; ++k)
            s->centers[i][k] = (float)between(-1, 1);
        s->radii[i] = (float)between(0, 0.6);
        switch (below(12)) {
        case 0:
            s->radii[i] = 0;
            break;
        case 1:
            memcpy(s->centers[i], s->centers[other < i ? other : 0], sizeof s->centers[i]);
            break;
        case 2:
            s->radii[i] = s->radii[0];
            break;
        case 3:
            s->radii[i] = 3;
            break;
        case 4: /* nearly or wholly collinear */
            for (int k = 0; k < 3; ++k)
                s->centers[i][k] = s->centers[0][k] + 0.37f * (s->centers[i > 0 ? i - 1 : 0][k] - s->centers[0][k]) +
                                   (below(2) ? 1e-6f : 0) * (float)between(-1, 1);
            break;
        case 5:
            s->centers[i][2] = s->centers[0][2];
            break;
        default:
            break;
        }
    }
}

static void random_solid(test_solid *s, int kind)
{
    memset(s, 0, sizeof *s);
    if (kind == 0) random_spheres(s, 1);
    if (kind == 1) {
        random_spheres(s, 2);
        s->edge_count = 1;
        s->edges[0][1] = 1;
    }
    if (kind == 2) {
        random_spheres(s, 3);
        s->triangle_count = 1;
        s->triangles[0][1] = 1 + below(2);
        s->triangles[0][2] = 3 - s->triangles[0][1];
    }
    if (kind == 3) { /* any simplices, some of which name a sphere twice */
        random_spheres(s, 7);
        s->edge_count = 3;
        s->triangle_count = 2;
        for (uint32_t i = 0; i < 6; ++i) {
            s->edges[i / 2][i % 2] = below(7);
            s->triangles[i / 3][i % 3] = below(7);
        }
    }
}

static void scale_solid(test_solid *s, double scale, const double offset[3])
{
    for (uint32_t i = 0; i < s->sphere_count; ++i) {
        for (int k = 0; k < 3; ++k)
            s->centers[i][k] = (float)(s->centers[i][k] * scale + offset[k]);
        s->radii[i] = (float)(s->radii[i] * scale);
    }
}

/* A place on the boundary of one of the solid's interpolated spheres, and the direction from its centre. */
static void random_place(const test_solid *s, double radius, double x[3], double normal[3])
{
    const uint32_t *n = s->triangle_count ? s->triangles[0] : s->edges[0];
    const int count = s->triangle_count ? 3 : s->edge_count ? 2 : 1;
    double b[3] = {test_random_unit(&state), test_random_unit(&state), test_random_unit(&state)}, sum, r = 0;
    if (below(3) == 0) b[below(3)] = 0;
    sum = count == 3 ? b[0] + b[1] + b[2] : count == 2 ? b[0] + b[1] : b[0];
    x[0] = x[1] = x[2] = 0;
    for (int i = 0; i < count; ++i) {
        const double w = sum > 0 ? b[i] / sum : i == 0;
        for (int k = 0; k < 3; ++k)
            x[k] += w * s->centers[n[i]][k];
        r += w * s->radii[n[i]];
    }
    random_unit(normal);
    for (int k = 0; k < 3; ++k)
        x[k] += (r + radius) * normal[k];
}

static void random_sweep(const test_solid *s, double size, sph_sweep *sweep)
{
    double from[3], to[3], x[3], normal[3], d[3];
    sweep->radius = below(3) ? (float)(size * between(0, below(2) ? 0.05 : 1)) : 0;
    sweep->reserved0 = 0;
    random_place(s, sweep->radius, x, normal);
    random_unit(d);
    if (below(3) == 0) { /* nearly tangential */
        const double slope = d[0] * normal[0] + d[1] * normal[1] + d[2] * normal[2];
        for (int k = 0; k < 3; ++k)
            d[k] -= slope * (1 - between(-1e-3, 1e-3)) * normal[k];
    }
    for (int k = 0; k < 3; ++k) {
        from[k] = x[k] - size * between(0.3, 1.5) * d[k];
        to[k] = x[k] + size * between(0, 1) * d[k];
    }
    switch (below(10)) {
    case 0:
        memcpy(to, from, sizeof to);
        break; /* in place */
    case 1:
        memcpy(from, x, sizeof from);
        break;
    case 2: /* along an axis */
        to[0] = from[0];
        to[1] = from[1];
        break;
    case 3: /* from within */
        for (int k = 0; k < 3; ++k)
            from[k] = s->centers[0][k];
        break;
    case 4: /* through a centre */
        for (int k = 0; k < 3; ++k)
            to[k] = 2 * s->centers[0][k] - from[k];
        break;
    default:
        break;
    }
    for (int k = 0; k < 3; ++k) {
        sweep->from[k] = (float)from[k];
        sweep->to[k] = (float)to[k];
    }
}

/* A hit's own account: the point is on the sphere that its weights name, and touches what moves. */
static void check_contact(const test_solid *s, const sph_hit *hit, const double at[3], double radius, double slack)
{
    const sph_contact *c = &hit->contact;
    double sum = 0, length = 0, r = 0, center[3] = {0, 0, 0};
    ck_assert_uint_ge(c->kind, SPH_SIMPLEX_SPHERE);
    for (uint32_t i = 0; i < 3; ++i) {
        ck_assert_double_ge(c->weights[i], 0);
        sum += c->weights[i];
        if (c->spheres[i] == SPH_NO_SPHERE) {
            ck_assert_double_eq(c->weights[i], 0);
            continue;
        }
        ck_assert_uint_lt(c->spheres[i], s->sphere_count);
        r += c->weights[i] * s->radii[c->spheres[i]];
        for (int k = 0; k < 3; ++k)
            center[k] += c->weights[i] * s->centers[c->spheres[i]][k];
    }
    if (c->kind == SPH_SIMPLEX_EDGE) ck_assert_uint_eq(c->spheres[0], s->edges[c->simplex][0]);
    if (c->kind == SPH_SIMPLEX_TRIANGLE) ck_assert_uint_eq(c->spheres[0], s->triangles[c->simplex][0]);
    ck_assert_double_eq_tol(sum, 1, 1e-9);
    for (int k = 0; k < 3; ++k) {
        length += c->normal[k] * c->normal[k];
        ck_assert_double_eq_tol(c->point[k], center[k] + r * c->normal[k], slack);
        if (hit->depth == 0) ck_assert_double_eq_tol(at[k], c->point[k] + radius * c->normal[k], slack);
    }
    ck_assert_double_eq_tol(length, 1, 1e-9);
}

/*
 * The hit lies between those of spheres a little bigger and a little smaller. Not inlined: gcc 12 would take the
 * doubles that the sweep's floats were rounded from.
 */
__attribute__((noinline)) static void check_sweep(const sph_query *q, const test_solid *s, const sph_sweep *sweep,
                                                  double size)
{
    const double from[3] = {sweep->from[0], sweep->from[1], sweep->from[2]};
    const double to[3] = {sweep->to[0], sweep->to[1], sweep->to[2]}, slack = 3e-7 * (size + sweep->radius);
    const double first = test_solid_cast(s, from, to, sweep->radius + slack);
    const double last = test_solid_cast(s, from, to, sweep->radius - slack);
    double at[3];
    sph_hit hit;
    uint8_t any = 2;
    ck_assert_int_eq(sph_query_cast(q, sweep, 1, &hit), SPH_OK);
    ck_assert_int_eq(sph_query_cast_any(q, sweep, 1, &any), SPH_OK);
    ck_assert_uint_eq(any, hit.hit);
    if (!hit.hit) {
        ck_assert_msg(last > 1, "missed what is hit at %g", last);
        ck_assert_double_eq(hit.s, 1);
        ck_assert_uint_eq(hit.contact.spheres[0], SPH_NO_SPHERE);
        return;
    }
    ck_assert_msg(hit.s >= first - 1e-9 && hit.s <= last + 1e-9, "hit at %.9g, not between %.9g and %.9g (size %g)",
                  hit.s, first, last, size);
    for (int k = 0; k < 3; ++k)
        at[k] = from[k] + hit.s * (to[k] - from[k]);
    check_contact(s, &hit, at, sweep->radius, 10 * slack);
    if (hit.depth > 0) {
        ck_assert_double_eq(hit.s, 0);
        ck_assert_double_eq_tol(hit.depth, sweep->radius - test_solid_distance(s, from), slack);
    }
}

static const double SCALES[] = {1, 1e-3, 1e5, 1e-30, 1e30, 1e-38, 1e-41, 3e37};

START_TEST(casts_hit_what_the_definition_says)
{
    for (int turn = 0; turn < (_i % 4 == 3 ? 60 : 400); ++turn) {
        const double zero[3] = {0, 0, 0};
        test_solid s;
        sph_level *level;
        sph_query *q;
        double size;
        random_solid(&s, _i % 4);
        scale_solid(&s, turn % 4 == 0 ? SCALES[below(8)] : 1, zero);
        size = test_solid_size(&s);
        level = test_solid_level(context, &s);
        ck_assert_int_eq(sph_query_create(level, NULL, &q), SPH_OK);
        for (int i = 0; i < 2; ++i) {
            sph_sweep sweep;
            do
                random_sweep(&s, size, &sweep);
            while (!isfinite(sweep.from[0] + sweep.from[1] + sweep.from[2] + sweep.to[0] + sweep.to[1] + sweep.to[2]));
            check_sweep(q, &s, &sweep, size);
        }
        sph_query_destroy(q);
        sph_level_destroy(level);
    }
}
END_TEST

/* The textbook test of a ray and a triangle: barycentric coordinates by determinants. */
static double ray_triangle(const test_solid *s, const sph_sweep *w, double *margin)
{
    double e[3], f[3], d[3], o[3], n[3], det, t, u, v, m[3];
    for (int k = 0; k < 3; ++k) {
        e[k] = (double)s->centers[1][k] - s->centers[0][k];
        f[k] = (double)s->centers[2][k] - s->centers[0][k];
        d[k] = (double)w->to[k] - w->from[k];
        o[k] = (double)w->from[k] - s->centers[0][k];
    }
    for (int k = 0; k < 3; ++k) {
        n[k] = e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3];
        m[k] = d[(k + 1) % 3] * o[(k + 2) % 3] - d[(k + 2) % 3] * o[(k + 1) % 3];
    }
    det = -(n[0] * d[0] + n[1] * d[1] + n[2] * d[2]);
    t = (n[0] * o[0] + n[1] * o[1] + n[2] * o[2]) / det;
    u = -(f[0] * m[0] + f[1] * m[1] + f[2] * m[2]) / det;
    v = (e[0] * m[0] + e[1] * m[1] + e[2] * m[2]) / det;
    *margin = fmin(fmin(t, 1 - t), fmin(fmin(u, v), 1 - u - v));
    return t;
}

START_TEST(rays_hit_triangles_of_no_thickness_and_pass_beside_them)
{
    int hits = 0;
    for (int turn = 0; turn < 3000; ++turn) {
        test_solid s;
        sph_level *level;
        sph_query *q;
        sph_sweep w = {.radius = 0};
        sph_hit hit;
        double t, margin;
        memset(&s, 0, sizeof s);
        s.sphere_count = 3;
        s.triangle_count = 1;
        s.triangles[0][1] = 1;
        s.triangles[0][2] = 2;
        for (int k = 0; k < 9; ++k)
            s.centers[k / 3][k % 3] = (float)between(-1, 1);
        for (int k = 0; k < 3; ++k) {
            w.from[k] = (float)between(-2, 2);
            w.to[k] = (s.centers[0][k] + s.centers[1][k] + s.centers[2][k]) * 2 / 3 - w.from[k] + (float)between(-1, 1);
        }
        t = ray_triangle(&s, &w, &margin);
        level = test_solid_level(context, &s);
        ck_assert_int_eq(sph_query_create(level, NULL, &q), SPH_OK);
        ck_assert_int_eq(sph_query_cast(q, &w, 1, &hit), SPH_OK);
        if (margin > 1e-6) {
            ck_assert_uint_eq(hit.hit, 1);
            ck_assert_double_eq_tol(hit.s, t, 1e-9);
            ++hits;
        }
        if (margin < -1e-6) ck_assert_uint_eq(hit.hit, 0);
        sph_query_destroy(q);
        sph_level_destroy(level);
    }
    ck_assert_int_gt(hits, 500);
}
END_TEST

static const test_solid BALL = {.sphere_count = 1, .centers = {{0, 0, 0}}, .radii = {1}};

START_TEST(a_sphere_against_a_sphere_touches_where_the_radii_meet)
{
    const sph_sweep sweeps[4] = {{{-5, 0, 0}, {5, 0, 0}, 0.5f, 0},
                                 {{0, 0, 0.25f}, {9, 0, 0}, 0.5f, 0},
                                 {{-5, 1.6f, 0}, {5, 1.6f, 0}, 0.5f, 0},
                                 {{1e30f, 0, 0}, {-1e30f, 0, 0}, 0, 0}};
    sph_level *level = test_solid_level(context, &BALL);
    sph_query *q;
    sph_hit h[4];
    ck_assert_int_eq(sph_query_create(level, NULL, &q), SPH_OK);
    ck_assert_int_eq(sph_query_cast(q, sweeps, 4, h), SPH_OK);
    ck_assert_double_eq_tol(h[0].s, 0.35, 1e-12);
    ck_assert_double_eq_tol(h[0].contact.point[0], -1, 1e-12);
    ck_assert_double_eq_tol(h[0].contact.normal[0], -1, 1e-12);
    ck_assert_double_eq(h[0].depth, 0);
    ck_assert_uint_eq(h[0].contact.kind, SPH_SIMPLEX_SPHERE);
    ck_assert_double_eq(h[1].s, 0);
    ck_assert_double_eq_tol(h[1].depth, 1.25, 1e-12);
    ck_assert_double_eq_tol(h[1].contact.normal[2], 1, 1e-12);
    ck_assert_uint_eq(h[2].hit, 0);
    ck_assert_uint_eq(h[3].hit, 1);
    ck_assert_double_eq_tol(h[3].s, 0.5, 1e-9);
    sph_query_destroy(q);
    sph_level_destroy(level);
}
END_TEST

int main(void)
{
    Suite *s = suite_create("query_cast");
    TCase *tc = tcase_create("query_cast");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, casts_hit_what_the_definition_says, 0, 4);
    tcase_add_test(tc, rays_hit_triangles_of_no_thickness_and_pass_beside_them);
    tcase_add_test(tc, a_sphere_against_a_sphere_touches_where_the_radii_meet);
    return run_suite(s, tc);
}
