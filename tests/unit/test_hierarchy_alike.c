/* SPDX-License-Identifier: MIT */
/* What keeps the collapses, if not every bit: on meshes of no symmetry, so that no two edges cost the same. */
#include <math.h>

#include "hierarchy_case.h"
#include "runner.h"

enum { SEEDS = 20 };

/* A soup on the grid of 1/1024, of which `copies` frames are taken in the order that `order` says, moved. */
static sph_animation *make_soup(uint64_t seed, unsigned frames, const unsigned *order, unsigned count,
                                const float *shift)
{
    sph_animation *soup = test_soup(context, 30, 70, frames, seed), *animation = NULL;
    float xyz[30][3];
    ck_assert_int_eq(sph_animation_create(context, 30, count, &animation), SPH_OK);
    for (unsigned f = 0; f < count; ++f) {
        ck_assert_int_eq(sph_animation_read_frame(soup, order[f], xyz[0]), SPH_OK);
        for (unsigned i = 0; i < 90; ++i) {
            float *x = &xyz[i / 3][i % 3];
            *x = (float)floor((double)*x * 1024) / 1024 + shift[i % 3];
        }
        ck_assert_int_eq(sph_animation_set_frame(animation, f, xyz[0], 0), SPH_OK);
    }
    ck_assert_int_eq(sph_animation_set_triangles(animation, sph_animation_triangles(soup), 70, 0), SPH_OK);
    sph_animation_destroy(soup);
    return animation;
}

static const float NOWHERE[3] = {0, 0, 0};
static const unsigned NATURAL[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};

/* The same collapses, at costs that agree to 32 bits or so. */
static void check_alike(const sph_hierarchy *a, const sph_hierarchy *b, double weight)
{
    ck_assert_uint_eq(sph_hierarchy_collapse_count(a), sph_hierarchy_collapse_count(b));
    for (uint32_t t = 0; t < sph_hierarchy_collapse_count(a); ++t) {
        sph_collapse x, y;
        ck_assert_int_eq(sph_hierarchy_collapse(a, t, &x), SPH_OK);
        ck_assert_int_eq(sph_hierarchy_collapse(b, t, &y), SPH_OK);
        ck_assert_msg(x.u == y.u && x.v == y.v, "collapse %u: (%u, %u) and (%u, %u)", t, x.u, x.v, y.u, y.v);
        ck_assert_double_eq_tol(x.cost * weight, y.cost, 1e-4 * x.cost * weight + 1e-6);
        ck_assert_double_eq_tol(x.error, y.error, 1e-4);
    }
}

/* That two animations have such hierarchies with the options of a seed. Destroys them. */
static void check_pair(sph_animation *a, sph_animation *b, int seed, double weight)
{
    const sph_hierarchy_options o = choose((unsigned)seed % CHOICES);
    sph_hierarchy *h = build(a, &o), *g = build(b, &o);
    check_alike(h, g, weight);
    sph_hierarchy_destroy(h);
    sph_hierarchy_destroy(g);
    sph_animation_destroy(a);
    sph_animation_destroy(b);
}

START_TEST(moving_the_whole_keeps_the_collapses)
{
    static const float FAR[3] = {16, -4, 8};
    sph_animation *here = make_soup(1000 + (uint64_t)_i, 3, NATURAL, 3, NOWHERE);
    sph_animation *there = make_soup(1000 + (uint64_t)_i, 3, NATURAL, 3, FAR);
    check_pair(here, there, _i, 1);
}
END_TEST

START_TEST(repeating_a_frame_multiplies_the_costs_alone)
{
    static const unsigned COPIES[] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    sph_animation *once = make_soup(2000 + (uint64_t)_i, 1, COPIES, 1, NOWHERE);
    sph_animation *often = make_soup(2000 + (uint64_t)_i, 1, COPIES, 10, NOWHERE);
    check_pair(once, often, _i, 10);
}
END_TEST

START_TEST(frames_may_come_in_any_order)
{
    static const unsigned ORDER[] = {4, 1, 9, 0, 7, 6, 2, 8, 3, 5};
    sph_animation *natural = make_soup(3000 + (uint64_t)_i, 10, NATURAL, 10, NOWHERE);
    sph_animation *shuffled = make_soup(3000 + (uint64_t)_i, 10, ORDER, 10, NOWHERE);
    check_pair(natural, shuffled, _i, 1);
}
END_TEST

/* One frame has one radius, however it is asked for. */
START_TEST(with_one_frame_radii_per_frame_are_the_constant_ones)
{
    sph_animation *animation = make_soup(4000 + (uint64_t)_i, 1, NATURAL, 1, NOWHERE);
    sph_hierarchy_options o = choose((unsigned)_i % 4 * MODES);
    sph_hierarchy *constant = build(animation, &o), *per_frame;
    o.radius_mode = SPH_RADIUS_PER_FRAME;
    per_frame = build(animation, &o);
    check_alike(constant, per_frame, 1);
    for (uint32_t node = 0; node < 30 + sph_hierarchy_collapse_count(constant); ++node) {
        float a[4], b[4];
        ck_assert_int_eq(sph_hierarchy_sphere(constant, node, a, a + 3), SPH_OK);
        ck_assert_int_eq(sph_hierarchy_sphere(per_frame, node, b, b + 3), SPH_OK);
        for (unsigned k = 0; k < 4; ++k)
            ck_assert_float_le(fabsf(a[k] - b[k]), 2e-3f);
    }
    sph_hierarchy_destroy(constant);
    sph_hierarchy_destroy(per_frame);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(a_radius_factor_of_zero_is_radius_zero)
{
    sph_animation *animation = make_soup(5000 + (uint64_t)_i, 10, NATURAL, 10, NOWHERE);
    sph_hierarchy_options o = default_options();
    sph_hierarchy *zero, *bounded;
    o.radius_mode = SPH_RADIUS_ZERO;
    zero = build(animation, &o);
    o.radius_factor = 0;
    for (o.radius_mode = 0; o.radius_mode < 2; ++o.radius_mode) {
        bounded = build(animation, &o);
        for (uint32_t node = 0; node < 30 + sph_hierarchy_collapse_count(bounded); ++node) {
            float radii[10];
            ck_assert_int_eq(sph_hierarchy_sphere(bounded, node, NULL, radii), SPH_OK);
            for (unsigned f = 0; f < 10; ++f)
                ck_assert_float_eq(radii[f], 0);
        }
        if (o.radius_mode == SPH_RADIUS_CONSTANT) check_alike(zero, bounded, 1);
        sph_hierarchy_destroy(bounded);
    }
    sph_hierarchy_destroy(zero);
    sph_animation_destroy(animation);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("hierarchy alike");
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, moving_the_whole_keeps_the_collapses, 0, SEEDS);
    tcase_add_loop_test(tc, repeating_a_frame_multiplies_the_costs_alone, 0, SEEDS);
    tcase_add_loop_test(tc, frames_may_come_in_any_order, 0, SEEDS);
    tcase_add_loop_test(tc, with_one_frame_radii_per_frame_are_the_constant_ones, 0, SEEDS);
    tcase_add_loop_test(tc, a_radius_factor_of_zero_is_radius_zero, 0, SEEDS);
    return run_suite(suite, tc);
}
