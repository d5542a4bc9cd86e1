/* SPDX-License-Identifier: MIT */
/* Which bone hangs on which: trees of every kind of link. */
#include <math.h>

#include "runner.h"
#include "skeleton_case.h"

static bool linked(uint32_t a, uint32_t b)
{
    for (size_t i = 0; i < link_count; ++i)
        if ((links[i][0] == a && links[i][1] == b) || (links[i][0] == b && links[i][1] == a)) return true;
    return false;
}

START_TEST(of_a_ring_the_link_that_moves_least_alike_is_left_out)
{
    static const double POINT[3] = {0.3, -0.2, 0.4};
    sph_skeleton_arrays a;
    sph_skeleton *skeleton;
    bone_count = link_count = 4;
    for (uint32_t i = 0; i < 4; ++i) {
        links[i][0] = i;
        links[i][1] = (i + 1) % 4;
    }
    /* 2 hangs on 1, 3 on 2, 0 on 3: nothing ties 0 to 1. */
    hinge(1, 2, POINT, NULL, 1);
    hinge(2, 3, pivots[2], NULL, 1);
    hinge(3, 0, pivots[3], NULL, 1);
    skeleton = make_rooted(1, &a);
    check_tree(&a, 1);
    ck_assert_uint_eq(a.parents[2], 1);
    ck_assert_uint_eq(a.parents[3], 2);
    ck_assert_uint_eq(a.parents[0], 3);
    check_point(a.positions + 6, POINT, 1e-11);
    sph_skeleton_destroy(skeleton);
}
END_TEST

/* Random links among parts: the tree has a link wherever there is one to have, and bridges of the nearest spheres. */
START_TEST(every_set_of_links_makes_one_tree)
{
    uint32_t part[MOST], parts = 0, bridges = 0;
    sph_skeleton_arrays a;
    sph_skeleton *skeleton;
    seed = 100 + (uint64_t)_i;
    bone_count = 1 + (uint32_t)(test_random(&seed) % MOST);
    link_count = bone_count < 2 ? 0 : test_random(&seed) % (2 * bone_count);
    for (size_t i = 0; i < link_count; ++i)
        do {
            links[i][0] = (uint32_t)(test_random(&seed) % bone_count);
            links[i][1] = (uint32_t)(test_random(&seed) % bone_count);
        } while (links[i][0] == links[i][1]);
    for (uint32_t b = 0; b < bone_count; ++b) {
        part[b] = b;
        radii[b] = uniform(0, 0.2);
    }
    for (uint32_t round = 0; round < bone_count; ++round)
        for (size_t i = 0; i < link_count; ++i) {
            const uint32_t p = part[links[i][0]], q = part[links[i][1]], least = p < q ? p : q;
            part[links[i][0]] = part[links[i][1]] = least;
        }
    for (uint32_t b = 0; b < bone_count; ++b)
        parts += part[b] == b;
    skeleton = make_with(NULL, &a);
    check_tree(&a, 1);
    for (uint32_t j = 0; j < bone_count; ++j)
        if (a.parents[j] != SPH_NO_JOINT && !linked(j, a.parents[j])) {
            ck_assert_uint_ne(part[j], part[a.parents[j]]);
            ++bridges;
        }
    ck_assert_uint_eq(bridges, parts - 1);
    sph_skeleton_destroy(skeleton);
}
END_TEST

START_TEST(parts_are_joined_where_their_spheres_are_nearest)
{
    static const double X[6] = {0, 1, 3, 4.5, 20, 7};
    sph_skeleton_arrays a;
    sph_skeleton *skeleton;
    bone_count = 6;
    link_count = 2; /* 0-1, 2-3; 4 is far, but large: nearer to 3 than 5 is */
    links[1][0] = 2;
    links[1][1] = 3;
    for (uint32_t b = 0; b < 6; ++b) {
        pivots[b][0] = X[b];
        pivots[b][1] = pivots[b][2] = 0;
    }
    radii[4] = 15;
    skeleton = make_rooted(0, &a);
    check_tree(&a, 1);
    ck_assert_uint_eq(a.parents[1], 0);
    ck_assert_uint_eq(a.parents[2], 1);
    ck_assert_uint_eq(a.parents[3], 2);
    ck_assert_uint_eq(a.parents[4], 3);
    ck_assert_uint_eq(a.parents[5], 4); /* within the large one */
    sph_skeleton_destroy(skeleton);
}
END_TEST

/* Against all pairs of ways (Floyd and Warshall). */
START_TEST(the_center_is_where_the_farthest_bone_is_nearest)
{
    double way[MOST][MOST], least = INFINITY, own = 0;
    sph_skeleton_arrays a;
    sph_skeleton *skeleton;
    seed = 500 + (uint64_t)_i;
    bone_count = MOST;
    link_count = MOST - 1;
    for (uint32_t b = 1; b < MOST; ++b) {
        links[b - 1][0] = (uint32_t)(test_random(&seed) % b);
        links[b - 1][1] = b;
    }
    for (uint32_t i = 0; i < MOST; ++i)
        for (uint32_t j = 0; j < MOST; ++j) {
            double d = 0;
            for (int k = 0; k < 3; ++k)
                d += pow(pivots[i][k] - pivots[j][k], 2);
            way[i][j] = i == j || linked(i, j) ? sqrt(d) : INFINITY;
        }
    for (int k = 0; k < MOST; ++k)
        for (int i = 0; i < MOST; ++i)
            for (int j = 0; j < MOST; ++j)
                way[i][j] = fmin(way[i][j], way[i][k] + way[k][j]);
    skeleton = make_with(NULL, &a);
    for (uint32_t i = 0; i < MOST; ++i) {
        double farthest = 0;
        for (uint32_t j = 0; j < MOST; ++j)
            farthest = fmax(farthest, way[i][j]);
        least = fmin(least, farthest);
        if (i == a.order[0]) own = farthest;
    }
    ck_assert_double_eq_tol(own, least, 1e-12);
    sph_skeleton_destroy(skeleton);
}
END_TEST

START_TEST(the_heaviest_bone_and_any_other_can_be_the_root)
{
    sph_skeleton_options o;
    sph_skeleton_arrays a;
    sph_skeleton *skeleton;
    bone_count = 3;
    link_count = 2;
    links[1][0] = 1;
    links[1][1] = 2;
    sph_skeleton_options_init(&o, sizeof o);
    o.root = SPH_ROOT_HEAVIEST;
    skeleton = make_with(&o, &a); /* bone 1 has two of the three vertices */
    ck_assert_uint_eq(a.parents[1], SPH_NO_JOINT);
    ck_assert_uint_eq(a.parents[0], 1);
    ck_assert_uint_eq(a.parents[2], 1);
    sph_skeleton_destroy(skeleton);
    skeleton = make_rooted(2, &a);
    ck_assert_uint_eq(a.parents[2], SPH_NO_JOINT);
    ck_assert_uint_eq(a.parents[1], 2);
    ck_assert_uint_eq(a.parents[0], 1);
    sph_skeleton_destroy(skeleton);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("skeleton trees");
    TCase *tc = tcase_create("trees");
    tcase_add_checked_fixture(tc, setup_skeleton, teardown);
    tcase_add_test(tc, of_a_ring_the_link_that_moves_least_alike_is_left_out);
    tcase_add_loop_test(tc, every_set_of_links_makes_one_tree, 0, 20);
    tcase_add_test(tc, parts_are_joined_where_their_spheres_are_nearest);
    tcase_add_loop_test(tc, the_center_is_where_the_farthest_bone_is_nearest, 0, 5);
    tcase_add_test(tc, the_heaviest_bone_and_any_other_can_be_the_root);
    return run_suite(suite, tc);
}
