/* SPDX-License-Identifier: MIT */
/*
 * Spheres, tapered capsules and thick triangles against their definition: the convex hull of spheres has the support
 * function max(c_i.n + r_i), and the signed distance to a convex set is the greatest x.n - support(n) over all unit n.
 */
#include <check.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "level/primitive.h"
#include "runner.h"

typedef struct hull {
    int count;
    double centers[3][3], radii[3];
} hull;

/* --- random numbers --- */

static uint64_t state;

static double uniform(void)
{
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (double)(state >> 11) * 0x1p-53;
}

static void random_point(double scale, double x[3])
{
    for (int k = 0; k < 3; ++k)
        x[k] = scale * (2 * uniform() - 1);
}

/* --- hulls, ordinary and not --- */

static const hull SPECIAL[] = {
    {1, {{0, 0, 0}}, {1}},
    {1, {{0.5, 0, 0}}, {0}},
    {2, {{0, 0, 0}, {1, 0, 0}}, {0, 0}},                           /* a segment */
    {2, {{0, 0, 0}, {1, 0, 0}}, {0.3, 0.3}},                       /* a cylinder with caps */
    {2, {{0, 0, 0}, {1, 0, 0}}, {0.5, 0}},                         /* a drop */
    {2, {{0, 0, 0}, {1, 0, 0}}, {1, 0}},                           /* its tip touches the sphere from within */
    {2, {{0, 0, 0}, {0.2, 0, 0}}, {1, 0.3}},                       /* one contains the other */
    {2, {{0, 0, 0}, {0.2, 0, 0}}, {0.3, 1}},                       /* the other way round */
    {2, {{0.1, 0.2, 0.3}, {0.1, 0.2, 0.3}}, {0.4, 0.4}},           /* coincident */
    {2, {{0.1, 0.2, 0.3}, {0.1, 0.2, 0.3}}, {0, 0}},               /* a point twice */
    {3, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 0, 0}},             /* a flat triangle */
    {3, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0.2, 0.2, 0.2}},       /* of even thickness */
    {3, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0.5, 0.1, 0}},         /* tapered to a point */
    {3, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {1, 0, 0}},             /* tilt of length sqrt(2): no faces */
    {3, {{0, 0, 0}, {1, 0, 0}, {0.3, 0.1, 0}}, {0.4, 0.4, 0.1}},   /* the third within the capsule of two */
    {3, {{0, 0, 0}, {1, 0, 0}, {0.5, 0.2, 0}}, {0.1, 0.1, 0.8}},   /* the third contains both */
    {3, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {0.1, 0.5, 0.2}},       /* collinear */
    {3, {{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}}, {0, 0, 0}},           /* collinear and flat */
    {3, {{0, 0, 0}, {1, 0, 0}, {0.5, 1e-9, 0}}, {0.1, 0.2, 0.1}},  /* nearly so */
    {3, {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}}, {0.1, 0.3, 0.2}},       /* two coincide */
    {3, {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, {0.1, 0.3, 0.2}},       /* all coincide */
    {3, {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {0, 0, 0}},             /* a point */
    {3, {{0, 0, 0}, {1e-3, 0, 0}, {0, 1, 0}}, {1e-6, 1e-6, 1e-6}}, /* a sliver with a skin */
    {3, {{100, 100, 100}, {101, 100, 100}, {100, 101, 100}}, {0.2, 0.1, 0}}, /* far away */
};
enum { SPECIAL_COUNT = sizeof SPECIAL / sizeof SPECIAL[0], HULL_COUNT = SPECIAL_COUNT + 60 };

static void choose_hull(int index, hull *h)
{
    state = (uint64_t)index + 1;
    uniform();
    if (index < SPECIAL_COUNT) {
        *h = SPECIAL[index];
        return;
    }
    h->count = 1 + (int)(3 * uniform());
    for (int i = 0; i < h->count; ++i) {
        random_point(1, h->centers[i]);
        h->radii[i] = uniform() < 0.2 ? 0 : uniform() * (index % 3 + 0.3);
    }
}

static void set(const hull *h, sph__primitive *p)
{
    sph__primitive_set(p, h->count, h->centers, h->radii);
}

/* --- the definition --- */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double gap_along(const hull *h, const double x[3], const double n[3])
{
    double most = -DBL_MAX;
    for (int i = 0; i < h->count; ++i)
        most = fmax(most, dot(h->centers[i], n) + h->radii[i]);
    return dot(x, n) - most;
}

/* Over directions spread on the sphere, then around the best of them: never above the signed distance. */
static double distance_by_directions(const hull *h, const double x[3])
{
    double best = -DBL_MAX, direction[3] = {0, 0, 1}, width = 0.1;
    for (int i = 0; i < 4000; ++i) {
        const double z = 1 - (2 * i + 1) / 4000.0, r = sqrt(1 - z * z), a = 2.39996323 * i;
        const double n[3] = {r * cos(a), r * sin(a), z}, gap = gap_along(h, x, n);
        if (gap <= best) continue;
        best = gap;
        for (int k = 0; k < 3; ++k)
            direction[k] = n[k];
    }
    for (int i = 0; i < 3000; ++i, width *= 0.997) {
        double n[3], length, gap;
        random_point(width, n);
        for (int k = 0; k < 3; ++k)
            n[k] += direction[k];
        length = sqrt(dot(n, n));
        for (int k = 0; k < 3; ++k)
            n[k] /= length;
        gap = gap_along(h, x, n);
        if (gap <= best) continue;
        best = gap;
        for (int k = 0; k < 3; ++k)
            direction[k] = n[k];
    }
    return best;
}

static double distance_to_sphere_at(const hull *h, const double x[3], double b1, double b2)
{
    const double b[3] = {1 - b1 - b2, b1, b2};
    double d[3] = {x[0], x[1], x[2]}, radius = 0;
    for (int i = 0; i < h->count; ++i) {
        radius += b[i] * h->radii[i];
        for (int k = 0; k < 3; ++k)
            d[k] -= b[i] * h->centers[i][k];
    }
    return sqrt(dot(d, d)) - radius;
}

/* Over the interpolated spheres on a grid, then on ever finer grids around the best: never below the signed distance.
 */
static double distance_by_weights(const hull *h, const double x[3])
{
    enum { GRID = 60 };
    double best = DBL_MAX, at1 = 0.5, at2 = 0.5, width = 0.5;
    for (int round = 0; round < 24; ++round, width *= 0.4) {
        const double from1 = at1 - width, from2 = at2 - width;
        for (int i = 0; i <= (h->count > 1 ? GRID : 0); ++i)
            for (int j = 0; j <= (h->count > 2 ? GRID : 0); ++j) {
                double b1 = fmax(0, fmin(1, from1 + 2 * width * i / GRID)), d;
                double b2 = fmax(0, fmin(1 - b1, from2 + 2 * width * j / GRID));
                if (h->count < 3) b2 = 0;
                if (h->count < 2) b1 = 0;
                d = distance_to_sphere_at(h, x, b1, b2);
                if (d >= best) continue;
                best = d;
                at1 = b1;
                at2 = b2;
            }
    }
    return best;
}

static void check_distance(const hull *h, const sph__primitive *p, const double x[3])
{
    const double distance = sph__primitive_distance(p, x), above = distance_by_weights(h, x);
    const double below = distance_by_directions(h, x);
    ck_assert_double_le(distance, above + 1e-12);
    ck_assert_double_ge(distance, above - 1e-5);
    ck_assert_double_ge(distance, below - 1e-12);
    ck_assert_double_le(distance, below + 2e-3);
}

static void random_query(const hull *h, double x[3])
{
    random_point(uniform() < 0.5 ? 1 : 2.5, x);
    for (int k = 0; k < 3; ++k)
        x[k] += h->centers[0][k];
}

START_TEST(signed_distance_is_that_of_the_hull_of_spheres)
{
    hull h;
    sph__primitive p;
    choose_hull(_i, &h);
    set(&h, &p);
    for (int i = 0; i < 30; ++i) {
        double x[3];
        random_query(&h, x);
        check_distance(&h, &p, x);
    }
}
END_TEST

START_TEST(signed_distance_is_right_at_centres_and_between_them)
{
    hull h;
    sph__primitive p;
    choose_hull(_i, &h);
    set(&h, &p);
    for (int i = 0; i < h.count; ++i)
        for (int j = 0; j < h.count; ++j) {
            double x[3];
            for (int k = 0; k < 3; ++k)
                x[k] = 0.5 * (h.centers[i][k] + h.centers[j][k]);
            check_distance(&h, &p, x);
        }
}
END_TEST

START_TEST(the_closest_point_lies_on_the_boundary_along_the_normal)
{
    hull h;
    sph__primitive p;
    choose_hull(_i, &h);
    set(&h, &p);
    for (int i = 0; i < 300; ++i) {
        sph__contact c;
        double x[3], sum = 0, radius = 0, center[3] = {0};
        random_query(&h, x);
        if (i < h.count * h.count) /* centres, and half-way between two */
            for (int k = 0; k < 3; ++k)
                x[k] = 0.5 * (h.centers[i / h.count][k] + h.centers[i % h.count][k]);
        sph__primitive_closest(&p, x, &c);
        ck_assert_double_eq_tol(c.distance, sph__primitive_distance(&p, x), 1e-14);
        ck_assert_double_eq_tol(dot(c.normal, c.normal), 1, 1e-12);
        ck_assert_double_eq_tol(gap_along(&h, c.point, c.normal), 0, 1e-10); /* on the supporting plane: the boundary */
        for (int k = 0; k < 3; ++k)
            ck_assert_double_eq_tol(c.point[k] + c.distance * c.normal[k], x[k], 1e-9);
        for (int k = 0; k < h.count; ++k) {
            ck_assert_double_ge(c.weights[k], 0);
            sum += c.weights[k];
            radius += c.weights[k] * h.radii[k];
            for (int l = 0; l < 3; ++l)
                center[l] += c.weights[k] * h.centers[k][l];
        }
        ck_assert_double_eq_tol(sum, 1, 1e-12);
        for (int k = 0; k < 3; ++k)
            ck_assert_double_eq_tol(center[k] + radius * c.normal[k], c.point[k], 1e-12 * 200);
    }
}
END_TEST

/* Distance along a ray is convex: look for its least value, then for where it first falls below 0. */
static bool cast_by_bisection(const sph__primitive *p, const double o[3], const double d[3], double limit, double *s,
                              double *least)
{
    double low = 0, high = limit, x[3];
    for (int i = 0; i < 200; ++i) {
        const double a = low + (high - low) / 3, b = high - (high - low) / 3;
        double at_a, at_b;
        for (int k = 0; k < 3; ++k)
            x[k] = o[k] + a * d[k];
        at_a = sph__primitive_distance(p, x);
        for (int k = 0; k < 3; ++k)
            x[k] = o[k] + b * d[k];
        at_b = sph__primitive_distance(p, x);
        if (at_a < at_b)
            high = b;
        else
            low = a;
        *least = fmin(at_a, at_b);
    }
    high = 0.5 * (low + high);
    low = 0;
    for (int i = 0; i < 100; ++i) {
        const double middle = 0.5 * (low + high);
        for (int k = 0; k < 3; ++k)
            x[k] = o[k] + middle * d[k];
        if (sph__primitive_distance(p, x) < 0)
            high = middle;
        else
            low = middle;
    }
    *s = high;
    return *least < 0;
}

START_TEST(a_cast_hits_where_the_distance_first_vanishes)
{
    hull h;
    sph__primitive p;
    choose_hull(_i, &h);
    set(&h, &p);
    for (int i = 0; i < 400; ++i) {
        double o[3], to[3], d[3], s = -1, expected, least, x[3];
        bool hit;
        random_query(&h, o);
        random_query(&h, to);
        for (int k = 0; k < 3; ++k)
            d[k] = to[k] - o[k];
        if (i % 4 == 0) /* along an axis */
            d[0] = d[1] = 0;
        hit = sph__primitive_cast(&p, o, d, 1, &s);
        if (sph__primitive_distance(&p, o) < 0) {
            ck_assert(hit);
            ck_assert_double_eq(s, 0);
            continue;
        }
        if (cast_by_bisection(&p, o, d, 1, &expected, &least)) {
            if (least > -1e-9) continue; /* it barely grazes, or the limit ends at the boundary */
            ck_assert(hit);
            for (int k = 0; k < 3; ++k)
                x[k] = o[k] + s * d[k];
            ck_assert_double_eq_tol(sph__primitive_distance(&p, x), 0, 1e-8);
            ck_assert_double_eq_tol(s, expected, 1e-4);
        } else if (least > 1e-9) {
            ck_assert(!hit);
            ck_assert_double_eq(s, -1);
        }
    }
}
END_TEST

START_TEST(a_flat_triangle_stops_what_crosses_it_from_either_side)
{
    const hull h = {3, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 0, 0}};
    sph__primitive p;
    set(&h, &p);
    state = 7;
    for (int i = 0; i < 1000; ++i) {
        const double x = 1.4 * uniform() - 0.2, y = 1.4 * uniform() - 0.2, side = i % 2 == 0 ? 1 : -1;
        const double o[3] = {x, y, side * 0.5}, d[3] = {0, 0, -side};
        const bool inside = x > 0 && y > 0 && x + y < 1;
        double s = -1;
        ck_assert_int_eq(sph__primitive_cast(&p, o, d, 1, &s), inside);
        if (inside) ck_assert_double_eq_tol(s, 0.5, 1e-15);
        ck_assert_int_eq(sph__primitive_cast(&p, o, d, 0.49, &s), 0);
    }
}
END_TEST

START_TEST(the_box_holds_the_hull_tightly)
{
    hull h;
    sph__primitive p;
    double low[3], high[3];
    choose_hull(_i, &h);
    set(&h, &p);
    sph__primitive_bounds(&p, low, high);
    for (int k = 0; k < 3; ++k) {
        double n[3] = {0}, zero[3] = {0};
        n[k] = 1;
        ck_assert_double_eq_tol(high[k], -gap_along(&h, zero, n), 1e-12);
        n[k] = -1;
        ck_assert_double_eq_tol(low[k], gap_along(&h, zero, n), 1e-12);
    }
}
END_TEST

START_TEST(faces_touch_all_three_spheres)
{
    int with_faces = 0;
    for (int index = 0; index < HULL_COUNT; ++index) {
        hull h;
        sph__primitive p;
        choose_hull(index, &h);
        set(&h, &p);
        if (!p.has_faces) continue;
        ++with_faces;
        for (int side = -1; side <= 1; side += 2) {
            double corners[3][3], n[3];
            sph__primitive_face(&p, side, corners, n);
            ck_assert_double_eq_tol(dot(n, n), 1, 1e-12);
            for (int i = 0; i < 3; ++i) {
                double to[3];
                for (int k = 0; k < 3; ++k)
                    to[k] = corners[i][k] - h.centers[i][k];
                ck_assert_double_eq_tol(dot(to, n), h.radii[i], 1e-9);
                ck_assert_double_eq_tol(gap_along(&h, corners[i], n), 0, 1e-6);
            }
        }
    }
    ck_assert_int_gt(with_faces, 10);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("primitive");
    TCase *tc = tcase_create("all");
    tcase_add_loop_test(tc, signed_distance_is_that_of_the_hull_of_spheres, 0, HULL_COUNT);
    tcase_add_loop_test(tc, signed_distance_is_right_at_centres_and_between_them, 0, HULL_COUNT);
    tcase_add_loop_test(tc, the_closest_point_lies_on_the_boundary_along_the_normal, 0, HULL_COUNT);
    tcase_add_loop_test(tc, a_cast_hits_where_the_distance_first_vanishes, 0, HULL_COUNT);
    tcase_add_test(tc, a_flat_triangle_stops_what_crosses_it_from_either_side);
    tcase_add_loop_test(tc, the_box_holds_the_hull_tightly, 0, HULL_COUNT);
    tcase_add_test(tc, faces_touch_all_three_spheres);
    return run_suite(suite, tc);
}
