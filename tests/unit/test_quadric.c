/* SPDX-License-Identifier: MIT */
/* Quadrics whose minimum can be found by hand, one per case. */
#include <math.h>

#include "quadric_case.h"
#include "runner.h"

typedef struct expected {
    double radius, lambda, cost;
    uint32_t degenerate_frames;
} expected;

/* Minimises; the cost of what comes out must be the one claimed, and `centers` make no difference. */
static void check_minimum(const sph_quadric *quadric, const double *u, const double *v, double radius_max,
                          expected wanted, double *centers)
{
    sph_quadric_minimum minimum, alone;
    double cost;
    ck_assert_int_eq(sph_quadric_minimize(quadric, u, v, radius_max, &minimum, centers), SPH_OK);
    ck_assert_int_eq(sph_quadric_minimize(quadric, u, v, radius_max, &alone, NULL), SPH_OK);
    ck_assert_int_eq(memcmp(&minimum, &alone, sizeof minimum), 0);
    ck_assert_double_eq_tol(minimum.radius, wanted.radius, 1e-12);
    ck_assert_double_eq_tol(minimum.lambda, wanted.lambda, 1e-12);
    ck_assert_double_eq_tol(minimum.cost, wanted.cost, 1e-12);
    ck_assert_uint_eq(minimum.degenerate_frames, wanted.degenerate_frames);
    ck_assert_uint_eq(minimum.reserved0, 0);
    ck_assert_int_eq(sph_quadric_evaluate(quadric, centers, minimum.radius, &cost), SPH_OK);
    ck_assert_double_eq_tol(cost, wanted.cost, 1e-12);
}

static void check_center(const double *center, double x, double y, double z)
{
    ck_assert_double_eq_tol(center[0], x, 1e-12);
    ck_assert_double_eq_tol(center[1], y, 1e-12);
    ck_assert_double_eq_tol(center[2], z, 1e-12);
}

static const double CENTER[3] = {10, -20, 30}, HALF[3] = {1, 2, 3};

START_TEST(regular_planes_of_a_cuboid_give_the_mean_half_width)
{
    sph_quadric *q = make_quadric(1);
    double centers[3];
    add_cuboid(q, 0, CENTER, HALF, 1);
    check_minimum(q, NULL, NULL, INFINITY, (expected){2, 0, 4, 0}, centers); /* 2 ((1-2)^2 + 0 + (3-2)^2) */
    check_center(centers, 10, -20, 30);
    check_minimum(q, NULL, NULL, 2.5, (expected){2, 0, 4, 0}, centers);
    sph_quadric_destroy(q);
}
END_TEST

START_TEST(regular_radius_is_clamped_at_the_bound)
{
    sph_quadric *q = make_quadric(1);
    double centers[3];
    add_cuboid(q, 0, CENTER, HALF, 1);
    check_minimum(q, NULL, NULL, 1.5, (expected){1.5, 0, 5.5, 0}, centers); /* 2 (0.25 + 0.25 + 2.25) */
    check_minimum(q, NULL, NULL, 0, (expected){0, 0, 28, 0}, centers);      /* 2 (1 + 4 + 9) */
    check_center(centers, 10, -20, 30);
    sph_quadric_destroy(q);
}
END_TEST

START_TEST(regular_radius_is_clamped_at_zero)
{
    sph_quadric *q = make_quadric(1);
    double centers[3];
    add_cuboid(q, 0, CENTER, HALF, -1);
    check_minimum(q, NULL, NULL, INFINITY, (expected){0, 0, 28, 0}, centers);
    check_center(centers, 10, -20, 30);
    sph_quadric_destroy(q);
}
END_TEST

START_TEST(regular_frames_share_one_radius)
{
    sph_quadric *q = make_quadric(2);
    const double small[3] = {1, 1, 1}, large[3] = {3, 3, 3}, elsewhere[3] = {0, 7, 0};
    double centers[6];
    add_cuboid(q, 0, CENTER, small, 1);
    add_cuboid(q, 1, elsewhere, large, 1);
    check_minimum(q, NULL, NULL, INFINITY, (expected){2, 0, 12, 0}, centers);
    check_center(centers, 10, -20, 30);
    check_center(centers + 3, 0, 7, 0);
    sph_quadric_destroy(q);
}
END_TEST

START_TEST(a_corner_that_any_radius_fits_gets_radius_zero)
{
    /* W2 = 0: the sphere may slide down the corner, touching all three planes. Far away, where rounding shows. */
    for (double far = 0; far < 1e7; far = far * 10 + 1) {
        sph_quadric *q = make_quadric(1);
        double centers[3];
        add_plane(q, 0, far + 1, far - 3, far, 1, 0, 0, 0.3);
        add_plane(q, 0, far, far + 1, far + 9, 0, 1, 0, 0.7);
        add_plane(q, 0, far + 4, far, far + 1, 0, 0, 1, 1.1);
        check_minimum(q, NULL, NULL, INFINITY, (expected){0, 0, 0, 0}, centers);
        check_center(centers, far + 1, far + 1, far + 1);
        check_minimum(q, NULL, NULL, 5, (expected){0, 0, 0, 0}, centers);
        sph_quadric_destroy(q);
    }
}
END_TEST

/*
 * Flat frames. In frame 0 the plane z = 0 faces up and the segment runs from z = u to z = v: it costs
 * (-u - lambda (v - u) - r)^2. In frame 1, where there is one, the plane is at z = `plane` and the segment is the
 * origin: (plane - r)^2.
 */
typedef struct flat_case {
    const char *name;
    uint32_t frame_count;
    double u, v, plane, radius_max;
    double lambda, radius, cost;
} flat_case;

static const flat_case FLAT[] = {
    {"kernel 0: inside", 2, 0, -2, 1, INFINITY, 0.5, 1, 0},
    {"kernel 0: side lambda = 0", 2, 0.5, 1.5, 3, INFINITY, 0, 1.25, 6.125},
    {"kernel 0: side lambda = 1", 2, 2, 1, 3, INFINITY, 1, 1, 8},
    {"kernel 0: side r = 0", 2, 1, -1, -1, INFINITY, 0.5, 0, 1},
    {"kernel 0: side r = R", 2, 0, -2, 3, 1, 0.5, 1, 4},
    {"kernel 0: corner (0, 0)", 2, 1, 2, 0.5, INFINITY, 0, 0, 1.25},
    {"kernel 0: corner (1, 0)", 2, 2, 1, -1, INFINITY, 1, 0, 2},
    {"kernel 0: corner (0, R)", 2, -3, -4, 3, 1, 0, 1, 8},
    {"kernel 0: corner (1, R)", 2, -3, -2, 3, 1, 1, 1, 5},
    {"kernel 0: R = 0", 2, 1, -3, 2, 0, 0.25, 0, 4},
    {"kernel 1: the line meets r = 0", 1, -1, 1, 0, INFINITY, 0.5, 0, 0},
    {"kernel 1: the line meets r = 0, upside down", 1, 1, -3, 0, 5, 0.25, 0, 0},
    {"kernel 1: the line first meets lambda = 1", 1, -2, -1, 0, INFINITY, 1, 1, 0},
    {"kernel 1: the line first meets lambda = 0", 1, -1, -2, 0, 5, 0, 1, 0},
    {"kernel 1: the line misses, corner (0, 0)", 1, 1, 2, 0, INFINITY, 0, 0, 1},
    {"kernel 1: the line misses, corner (1, 0)", 1, 2, 1, 0, 5, 1, 0, 1},
    {"kernel 1: the line misses, corner (1, R)", 1, -3, -2, 0, 1, 1, 1, 1},
    {"kernel 1: the line misses, corner (0, R)", 1, -2, -3, 0, 1, 0, 1, 1},
    {"kernel 1: segment in the plane", 1, -2, -2, 0, INFINITY, 0.5, 2, 0},
    {"kernel 1: segment in the plane, r = 0", 1, 2, 2, 0, INFINITY, 0.5, 0, 4},
    {"kernel 1: segment in the plane, r = R", 1, -2, -2, 0, 1, 0.5, 1, 1},
};

START_TEST(flat_frames_have_their_centers_on_the_segment)
{
    const flat_case *c = &FLAT[_i];
    sph_quadric *q = make_quadric(c->frame_count);
    const double u[6] = {-5, 1, c->u, 0, 0, 0}, v[6] = {3, 2, c->v, 0, 0, 0};
    double centers[6];
    /* Two planes of half the weight, so that the frame is flat for more reasons than having one plane only. */
    add_plane(q, 0, 3, -1, 0, 0, 0, 1, 0.5);
    add_plane(q, 0, -2, 8, 0, 0, 0, 1, 0.5);
    if (c->frame_count > 1) add_plane(q, 1, 4, 4, c->plane, 0, 0, 1, 1);
    check_minimum(q, u, v, c->radius_max, (expected){c->radius, c->lambda, c->cost, c->frame_count}, centers);
    check_center(centers, -5 + c->lambda * 8, 1 + c->lambda, c->u + c->lambda * (c->v - c->u));
    if (c->frame_count > 1) check_center(centers + 3, 0, 0, 0);
    sph_quadric_destroy(q);
}
END_TEST

START_TEST(no_planes_at_all_give_the_middle_of_the_segment)
{
    for (uint32_t frames = 1; frames <= 3; frames += 2) { /* kernel 2 */
        const double u[9] = {0, 0, 0, 1, 1, 1, 2, 2, 2}, v[9] = {2, 4, 6, 1, 1, 1, -2, -2, -2};
        double centers[9];
        sph_quadric *q = make_quadric(frames);
        check_minimum(q, u, v, INFINITY, (expected){0, 0.5, 0, frames}, centers);
        check_center(centers, 1, 2, 3);
        if (frames > 1) check_center(centers + 6, 0, 0, 0);
        check_minimum(q, NULL, NULL, 1, (expected){0, 0.5, 0, frames}, centers);
        check_center(centers, 0, 0, 0);
        sph_quadric_destroy(q);
    }
}
END_TEST

START_TEST(a_tube_is_fixed_across_and_free_along_its_axis)
{
    sph_quadric *q = make_quadric(1);
    const double u[3] = {0, 0, 1}, v[3] = {0, 0, 4};
    double centers[3];
    add_plane(q, 0, 1, 5, 3, 1, 0, 0, 1);
    add_plane(q, 0, -1, 2, 1, -1, 0, 0, 1);
    add_plane(q, 0, 8, 1, 3, 0, 1, 0, 1);
    add_plane(q, 0, 3, -1, 0, 0, -1, 0, 1);
    check_minimum(q, u, v, INFINITY, (expected){1, 0.5, 0, 1}, centers);
    check_center(centers, 0, 0, 2.5);
    sph_quadric_destroy(q);
}
END_TEST

START_TEST(regular_and_flat_and_empty_frames_mix)
{
    sph_quadric *q = make_quadric(3);
    const double half[3] = {2, 2, 2};
    const double u[9] = {99, 99, 99, 0, 0, 0, 1, 1, 1}, v[9] = {-99, 5, 1, 0, 0, -4, 5, 5, 5};
    double centers[9];
    add_cuboid(q, 0, CENTER, half, 1);    /* 6 (2 - r)^2 */
    add_plane(q, 1, 7, 7, 0, 0, 0, 1, 1); /* (4 lambda - r)^2 */
    check_minimum(q, u, v, INFINITY, (expected){2, 0.5, 0, 2}, centers);
    check_center(centers, 10, -20, 30);
    check_center(centers + 3, 0, 0, -2);
    check_center(centers + 6, 3, 3, 3);
    check_minimum(q, u, v, 1, (expected){1, 0.25, 6, 2}, centers);
    check_center(centers, 10, -20, 30);
    check_center(centers + 6, 2, 2, 2);
    sph_quadric_destroy(q);
}
END_TEST

START_TEST(an_attachment_makes_every_frame_regular)
{
    sph_quadric *q = make_quadric(2);
    const double place[3] = {3, 4, -1}, other[3] = {5, 6, 7};
    double centers[6];
    add_plane(q, 0, 0, 0, 0, 0, 0, 1, 1);
    ck_assert_int_eq(sph_quadric_add_attachment(q, 0, place, 1), SPH_OK);
    ck_assert_int_eq(sph_quadric_add_attachment(q, 1, other, 0.25), SPH_OK);
    check_minimum(q, NULL, NULL, INFINITY, (expected){1, 0, 0, 0}, centers); /* (-z - r)^2 + (z + 1)^2 */
    check_center(centers, 3, 4, -1);
    check_center(centers + 3, 5, 6, 7);
    check_minimum(q, NULL, NULL, 0, (expected){0, 0, 0.5, 0}, centers);
    check_center(centers, 3, 4, -0.5);
    sph_quadric_destroy(q);
}
END_TEST

START_TEST(the_sum_of_two_quadrics_is_that_of_their_planes)
{
    sph_quadric *all = make_quadric(3), *left = make_quadric(3), *right = make_quadric(3);
    uint64_t seed = 5;
    for (int i = 0; i < 60; ++i) {
        const uint32_t frame = i < 30 ? (uint32_t)i % 3 : (uint32_t)i % 2; /* in one of them, frame 2 stays empty */
        double point[3], normal[3];
        const double weight = test_random_unit(&seed);
        for (int j = 0; j < 3; ++j) {
            point[j] = 100 + test_random_unit(&seed);
            normal[j] = test_random_unit(&seed) - 0.5;
        }
        ck_assert_int_eq(sph_quadric_add_plane(all, frame, point, normal, weight), SPH_OK);
        ck_assert_int_eq(sph_quadric_add_plane(i < 30 ? right : left, frame, point, normal, weight), SPH_OK);
        if (i % 7 > 0) continue;
        ck_assert_int_eq(sph_quadric_add_attachment(all, frame, point, weight), SPH_OK);
        ck_assert_int_eq(sph_quadric_add_attachment(i < 30 ? right : left, frame, point, weight), SPH_OK);
    }
    ck_assert_int_eq(sph_quadric_add(left, right), SPH_OK);
    for (int i = 0; i < 20; ++i) {
        double centers[9], sum, together;
        for (int j = 0; j < 9; ++j)
            centers[j] = 100 + test_random_unit(&seed);
        ck_assert_int_eq(sph_quadric_evaluate(left, centers, 0.1 * i, &sum), SPH_OK);
        ck_assert_int_eq(sph_quadric_evaluate(all, centers, 0.1 * i, &together), SPH_OK);
        ck_assert_double_eq_tol(sum, together, 1e-12 * together);
        if (i != 9) continue;
        ck_assert_int_eq(sph_quadric_add(left, left), SPH_OK); /* itself: twice the cost */
        ck_assert_int_eq(sph_quadric_add(all, all), SPH_OK);
        ck_assert_int_eq(sph_quadric_evaluate(left, centers, 0.1 * i, &together), SPH_OK);
        ck_assert_double_eq_tol(2 * sum, together, 1e-12 * together);
    }
    sph_quadric_destroy(all);
    sph_quadric_destroy(left);
    sph_quadric_destroy(right);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("quadric");
    TCase *tests = tcase_create("quadric");
    tcase_add_checked_fixture(tests, setup, teardown);
    tcase_add_test(tests, regular_planes_of_a_cuboid_give_the_mean_half_width);
    tcase_add_test(tests, regular_radius_is_clamped_at_the_bound);
    tcase_add_test(tests, regular_radius_is_clamped_at_zero);
    tcase_add_test(tests, regular_frames_share_one_radius);
    tcase_add_test(tests, a_corner_that_any_radius_fits_gets_radius_zero);
    tcase_add_loop_test(tests, flat_frames_have_their_centers_on_the_segment, 0, (int)(sizeof FLAT / sizeof *FLAT));
    tcase_add_test(tests, no_planes_at_all_give_the_middle_of_the_segment);
    tcase_add_test(tests, a_tube_is_fixed_across_and_free_along_its_axis);
    tcase_add_test(tests, regular_and_flat_and_empty_frames_mix);
    tcase_add_test(tests, an_attachment_makes_every_frame_regular);
    tcase_add_test(tests, the_sum_of_two_quadrics_is_that_of_their_planes);
    suite_add_tcase(suite, tests);
    return run_all(suite);
}
