/* SPDX-License-Identifier: MIT */
/* Trees of joints: hinges found in closed form, motion that stays the same, and trees of every kind of link. */
#include <check.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "runner.h"
#include "support.h"

enum { MOST = 40, FRAMES = 12 };

static sph_context *context;
static uint64_t seed;
static uint32_t bone_count, links[3 * MOST][2];
static double transforms[FRAMES][MOST][12], packed[FRAMES * MOST * 12], pivots[MOST][3], radii[MOST];
static size_t link_count;

static double uniform(double low, double high)
{
    return low + (high - low) * test_random_unit(&seed);
}

/* --- rigid motions --- */

static void turn(const double axis[3], double angle, double t[12])
{
    const double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    const double u[3] = {axis[0] / length, axis[1] / length, axis[2] / length}, c = cos(angle), s = sin(angle);
    const double r[9] = {
        c + u[0] * u[0] * (1 - c),        u[0] * u[1] * (1 - c) - u[2] * s, u[0] * u[2] * (1 - c) + u[1] * s,
        u[1] * u[0] * (1 - c) + u[2] * s, c + u[1] * u[1] * (1 - c),        u[1] * u[2] * (1 - c) - u[0] * s,
        u[2] * u[0] * (1 - c) - u[1] * s, u[2] * u[1] * (1 - c) + u[0] * s, c + u[2] * u[2] * (1 - c)};
    for (int i = 0; i < 9; ++i)
        t[4 * (i / 3) + i % 3] = r[i];
    t[3] = t[7] = t[11] = 0;
}

/* About a line through `p`. */
static void turn_about(const double p[3], const double axis[3], double angle, double t[12])
{
    turn(axis, angle, t);
    for (int r = 0; r < 3; ++r)
        t[4 * r + 3] = p[r] - t[4 * r] * p[0] - t[4 * r + 1] * p[1] - t[4 * r + 2] * p[2];
}

static void any_motion(double t[12])
{
    const double axis[3] = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    turn(axis, uniform(0, 3), t);
    for (int r = 0; r < 3; ++r)
        t[4 * r + 3] = uniform(-2, 2);
}

static void product(const double a[12], const double b[12], double out[12])
{
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 4; ++c) {
            out[4 * r + c] = c == 3 ? a[4 * r + 3] : 0;
            for (int k = 0; k < 3; ++k)
                out[4 * r + c] += a[4 * r + k] * b[4 * k + c];
        }
}

/* --- skins: only bones matter here --- */

static void setup(void)
{
    context = test_context();
    seed = 11;
    bone_count = 2;
    link_count = 1;
    memset(transforms, 0, sizeof transforms);
    memset(radii, 0, sizeof radii);
    links[0][0] = 0;
    links[0][1] = 1;
    for (int b = 0; b < MOST; ++b)
        for (int k = 0; k < 3; ++k)
            pivots[b][k] = uniform(-1, 1);
    for (int f = 0; f < FRAMES; ++f)
        for (int b = 0; b < MOST; ++b)
            any_motion(transforms[f][b]);
}

static void teardown(void)
{
    sph_context_destroy(context);
}

static sph_skin *make_skin_in(sph_context *own)
{
    static const uint32_t TRIANGLE[3] = {0, 1, 2};
    static const float WEIGHTS[3] = {1, 1, 1}, REST[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const uint32_t second = bone_count > 1, bones[3] = {0, second, second};
    const sph_skin_arrays arrays = {.struct_size = sizeof arrays,
                                    .vertex_count = 3,
                                    .bone_count = bone_count,
                                    .influence_count = 1,
                                    .frame_count = FRAMES,
                                    .rest = REST,
                                    .bones = bones,
                                    .weights = WEIGHTS,
                                    .transforms = packed,
                                    .pivots = pivots[0],
                                    .radii = radii,
                                    .triangle_count = 1,
                                    .triangles = TRIANGLE,
                                    .link_count = link_count,
                                    .links = links[0]};
    sph_skin *skin = NULL;
    for (uint32_t f = 0; f < FRAMES; ++f)
        memcpy(packed + 12 * (size_t)f * bone_count, transforms[f], bone_count * sizeof transforms[f][0]);
    (void)sph_skin_create_from_arrays(own, &arrays, &skin);
    return skin;
}

static sph_skeleton *make_with(const sph_skeleton_options *options, sph_skeleton_arrays *a)
{
    sph_skin *skin = make_skin_in(context);
    sph_skeleton *skeleton = NULL;
    ck_assert_msg(sph_skeleton_create(skin, options, &skeleton) == SPH_OK, "%s", sph_context_last_message(context));
    sph_skin_destroy(skin);
    a->struct_size = sizeof *a;
    ck_assert_int_eq(sph_skeleton_get_arrays(skeleton, a), SPH_OK);
    return skeleton;
}

static sph_skeleton *make_rooted(uint32_t root, sph_skeleton_arrays *a)
{
    sph_skeleton_options o;
    sph_skeleton_options_init(&o, sizeof o);
    o.root = SPH_ROOT_GIVEN;
    o.root_bone = root;
    return make_with(&o, a);
}

static void check_point(const double *p, const double *expected, double tolerance)
{
    for (int k = 0; k < 3; ++k)
        ck_assert_msg(fabs(p[k] - expected[k]) <= tolerance, "axis %d: %.17g, not %.17g", k, p[k], expected[k]);
}

/* Bone `b` is bone `a`, turned about `point` in every frame; about one axis, or about another in each. */
static void hinge(uint32_t a, uint32_t b, const double point[3], const double *axis, double angle)
{
    for (int f = 0; f < FRAMES; ++f) {
        const double any[3] = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
        double t[12];
        turn_about(point, axis == NULL ? any : axis, uniform(-angle, angle), t);
        product(transforms[f][a], t, transforms[f][b]);
    }
}

/* --- where joints are --- */

START_TEST(a_ball_joint_is_where_both_bones_turn)
{
    static const double POINT[3] = {0.3, -0.2, 0.4};
    sph_skeleton_arrays a;
    sph_skeleton *skeleton;
    radii[0] = radii[1] = 1; /* within reach */
    hinge(0, 1, POINT, NULL, _i == 0 ? 1.5 : 0.01);
    skeleton = make_rooted(0, &a);
    check_point(a.positions + 3, POINT, _i == 0 ? 1e-12 : 1e-9);
    check_point(a.positions, pivots[0], 0);
    ck_assert_uint_eq(a.parents[1], 0);
    ck_assert_uint_eq(a.parents[0], SPH_NO_JOINT);
    ck_assert_double_le(a.gaps[1], 1e-12);
    /* In the frame of its parent the joint only turns: its place there is that at rest. */
    for (int f = 0; f < FRAMES; ++f) {
        double locals[24];
        ck_assert_int_eq(sph_skeleton_get_locals(skeleton, packed + (size_t)24 * (unsigned)f, locals), SPH_OK);
        for (int k = 0; k < 3; ++k)
            ck_assert_double_eq_tol(locals[12 + 4 * k + 3], a.rest[12 + 4 * k + 3], 1e-11);
    }
    sph_skeleton_destroy(skeleton);
}
END_TEST

START_TEST(a_hinge_s_joint_is_on_its_axis_nearest_to_where_the_spheres_meet)
{
    static const double POINT[3] = {0.3, 0.1, 0.4}, AXIS[3] = {0.6, 0, 0.8};
    double meeting[3], along = 0, expected[3];
    sph_skeleton_arrays a;
    sph_skeleton *skeleton;
    radii[0] = 0.1;
    radii[1] = 0.3;
    for (int k = 0; k < 3; ++k)
        meeting[k] = pivots[0][k] + 0.25 * (pivots[1][k] - pivots[0][k]);
    for (int k = 0; k < 3; ++k)
        along += AXIS[k] * (meeting[k] - POINT[k]);
    for (int k = 0; k < 3; ++k)
        expected[k] = POINT[k] + along * AXIS[k];
    hinge(0, 1, POINT, AXIS, 1);
    skeleton = make_rooted(1, &a);
    check_point(a.positions, expected, 1e-10);
    sph_skeleton_destroy(skeleton);
}
END_TEST

START_TEST(bones_that_move_as_one_meet_where_their_spheres_do)
{
    sph_skeleton_arrays a;
    sph_skeleton *skeleton;
    double middle[3];
    for (int k = 0; k < 3; ++k)
        middle[k] = (pivots[0][k] + pivots[1][k]) / 2;
    for (int f = 0; f < FRAMES; ++f)
        memcpy(transforms[f][1], transforms[f][0], sizeof transforms[f][0]);
    skeleton = make_rooted(0, &a);
    check_point(a.positions + 3, middle, 1e-15);
    ck_assert_double_le(a.gaps[1], 0);
    sph_skeleton_destroy(skeleton);
}
END_TEST

/* Without a weight against it, such noise throws the joint far off: the turn is 0.002, the noise 0.003. */
START_TEST(noise_of_bones_that_hardly_turn_does_not_throw_their_joint_off)
{
    static const double POINT[3] = {0.1, 0.1, 0.1};
    double middle[3], off = 0, link = 0;
    sph_skeleton_arrays a;
    sph_skeleton *skeleton;
    hinge(0, 1, POINT, NULL, 0.002);
    for (int f = 0; f < FRAMES; ++f)
        for (int r = 0; r < 3; ++r)
            transforms[f][1][4 * r + 3] += uniform(-0.003, 0.003);
    for (int k = 0; k < 3; ++k)
        middle[k] = (pivots[0][k] + pivots[1][k]) / 2;
    skeleton = make_rooted(0, &a);
    for (int k = 0; k < 3; ++k) {
        off += pow(a.positions[3 + k] - middle[k], 2);
        link += pow(pivots[1][k] - pivots[0][k], 2);
    }
    ck_assert_double_le(sqrt(off), 0.5 * sqrt(link));
    sph_skeleton_destroy(skeleton);
}
END_TEST

START_TEST(a_joint_is_no_farther_off_than_the_spheres_reach)
{
    static const double FAR[3] = {500, -200, 300};
    double middle[3], off = 0, link = 0;
    sph_skeleton_arrays a;
    sph_skeleton *skeleton;
    radii[0] = radii[1] = 0.25;
    hinge(0, 1, FAR, NULL, 1);
    for (int k = 0; k < 3; ++k)
        middle[k] = (pivots[0][k] + pivots[1][k]) / 2;
    skeleton = make_rooted(0, &a);
    for (int k = 0; k < 3; ++k) {
        off += pow(a.positions[3 + k] - middle[k], 2);
        link += pow(pivots[1][k] - pivots[0][k], 2);
    }
    ck_assert_double_eq_tol(sqrt(off), sqrt(link) + 0.5, 1e-9);
    sph_skeleton_destroy(skeleton);
}
END_TEST

/* The joint's gap is the least that any place near it has: compared with places all around it. */
START_TEST(no_place_beside_a_joint_is_moved_more_alike)
{
    sph_skeleton_arrays a;
    sph_skeleton *skeleton;
    radii[0] = radii[1] = 100; /* within reach */
    skeleton = make_rooted(0, &a);
    for (int n = 0; n < 200; ++n) {
        double sum = 0, p[3];
        for (int k = 0; k < 3; ++k)
            p[k] = a.positions[3 + k] + (n == 0 ? 0 : uniform(-0.1, 0.1));
        for (int f = 0; f < FRAMES; ++f)
            for (int r = 0; r < 3; ++r) {
                double d = 0;
                for (int c = 0; c < 4; ++c)
                    d += (transforms[f][0][4 * r + c] - transforms[f][1][4 * r + c]) * (c == 3 ? 1 : p[c]);
                sum += d * d / FRAMES;
            }
        if (n == 0)
            ck_assert_double_eq_tol(sqrt(sum), a.gaps[1], 1e-12);
        else /* the weight of the meeting place costs a little */
            ck_assert_double_ge(sqrt(sum), 0.8 * a.gaps[1]);
    }
    sph_skeleton_destroy(skeleton);
}
END_TEST

/* --- trees --- */

static void check_tree(const sph_skeleton_arrays *a, uint32_t roots)
{
    bool seen[MOST + 1] = {false};
    uint32_t found = 0;
    for (uint32_t i = 0; i < a->joint_count; ++i) {
        const uint32_t j = a->order[i], parent = a->parents[j];
        ck_assert_uint_lt(j, a->joint_count);
        ck_assert(!seen[j]);
        seen[j] = true;
        if (parent == SPH_NO_JOINT)
            ++found;
        else
            ck_assert(parent < a->joint_count && seen[parent]);
    }
    ck_assert_uint_eq(found, roots);
}

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

/* --- poses --- */

static void use_random_links(void)
{
    bone_count = 17;
    link_count = 30;
    for (size_t i = 0; i < link_count; ++i) {
        links[i][0] = (uint32_t)(i % 17);
        links[i][1] = (uint32_t)((i * 5 + 3) % 17);
    }
}

/* 0: a tree; 1: with a root above it; 2: a list; 3: with a root. 4 to 7: transforms that also scale and shear. */
START_TEST(poses_relative_to_parents_are_the_same_poses)
{
    sph_skeleton_options o;
    sph_skeleton_arrays a;
    sph_skeleton *skeleton;
    use_random_links();
    for (int f = 0; f < FRAMES; ++f)
        for (uint32_t b = 0; b < bone_count && _i >= 4; ++b)
            for (int e = 0; e < 12; ++e)
                transforms[f][b][e] += uniform(-0.2, 0.2);
    sph_skeleton_options_init(&o, sizeof o);
    o.layout = _i & 2 ? SPH_SKELETON_FLAT : SPH_SKELETON_TREE;
    o.single_root = _i & 1;
    skeleton = make_with(&o, &a);
    ck_assert_uint_eq(a.joint_count, bone_count + (_i & 1));
    check_tree(&a, (_i & 3) == 2 ? bone_count : 1);
    if (_i & 1) ck_assert_uint_eq(a.order[0], bone_count);
    for (int f = 0; f < FRAMES; ++f) {
        double locals[18 * 12], back[17 * 12], worlds[18][12];
        ck_assert_int_eq(sph_skeleton_get_locals(skeleton, packed + (size_t)f * 12 * bone_count, locals), SPH_OK);
        for (uint32_t i = 0; i < a.joint_count; ++i) {
            /* By hand: what a reader of the tree makes of it. */
            const uint32_t j = a.order[i], parent = a.parents[j];
            double skinning[12];
            if (parent == SPH_NO_JOINT)
                memcpy(worlds[j], locals + 12 * (size_t)j, sizeof worlds[j]);
            else
                product(worlds[parent], locals + 12 * (size_t)j, worlds[j]);
            product(worlds[j], a.inverse_bind + 12 * (size_t)j, skinning);
            for (int e = 0; e < 12; ++e) {
                const double expected = j < bone_count ? transforms[f][j][e] : e % 5 == 0;
                ck_assert_double_eq_tol(skinning[e], expected, 1e-12);
            }
        }
        ck_assert_int_eq(sph_skeleton_get_transforms(skeleton, locals, back), SPH_OK);
        for (uint32_t e = 0; e < 12 * bone_count; ++e)
            ck_assert_double_eq_tol(back[e], packed[(size_t)f * 12 * bone_count + e], 1e-12);
    }
    sph_skeleton_destroy(skeleton);
}
END_TEST

START_TEST(at_rest_the_joints_are_where_they_are_and_not_turned)
{
    sph_skeleton_arrays a;
    sph_skeleton *skeleton;
    double still[17 * 12] = {0}, back[17 * 12];
    use_random_links();
    skeleton = make_with(NULL, &a);
    ck_assert_int_eq(sph_skeleton_get_transforms(skeleton, a.rest, back), SPH_OK);
    for (uint32_t b = 0; b < bone_count; ++b) {
        for (int k = 0; k < 3; ++k)
            still[12 * b + 5 * (unsigned)k] = 1;
        for (int e = 0; e < 12; ++e)
            ck_assert_double_eq_tol(back[12 * b + (unsigned)e], still[12 * b + (unsigned)e], 1e-14);
        for (int k = 0; k < 3; ++k)
            ck_assert_double_eq(a.inverse_bind[12 * b + 4 * (unsigned)k + 3], -a.positions[3 * b + (unsigned)k]);
    }
    sph_skeleton_destroy(skeleton);
}
END_TEST

START_TEST(a_joint_takes_along_what_hangs_on_it)
{
    static const double AXIS[3] = {0, 0, 1};
    sph_skeleton_arrays a;
    sph_skeleton *skeleton;
    double locals[3 * 12], out[3 * 12], expected[12], bent[12], t[12];
    bone_count = 3;
    link_count = 2;
    links[1][0] = 1;
    links[1][1] = 2;
    skeleton = make_rooted(0, &a);
    memcpy(locals, a.rest, sizeof locals);
    turn(AXIS, 0.5, t);
    product(locals + 12, t, bent);
    memcpy(locals + 12, bent, sizeof bent);
    ck_assert_int_eq(sph_skeleton_get_transforms(skeleton, locals, out), SPH_OK);
    turn_about(a.positions + 3, AXIS, 0.5, expected);
    for (int e = 0; e < 12; ++e) {
        ck_assert_double_eq_tol(out[e], e % 5 == 0, 1e-15);
        ck_assert_double_eq_tol(out[12 + e], expected[e], 1e-14);
        ck_assert_double_eq_tol(out[24 + e], expected[e], 1e-14);
    }
    sph_skeleton_destroy(skeleton);
}
END_TEST

/* --- the handle --- */

START_TEST(threads_and_executors_do_not_change_a_bit)
{
    sph_skeleton_arrays a, other;
    sph_skeleton *skeleton;
    use_random_links();
    skeleton = make_with(NULL, &a);
    for (int i = 0; i < 3; ++i) {
        const sph_executor executor = i == 0 ? test_executor_reverse() : test_executor_threads();
        sph_context *own = i == 2 ? test_context_with_threads(1) : test_context_with_executor(&executor);
        sph_skin *skin = make_skin_in(own);
        sph_skeleton *again = NULL;
        ck_assert_int_eq(sph_skeleton_create(skin, NULL, &again), SPH_OK);
        other.struct_size = sizeof other;
        ck_assert_int_eq(sph_skeleton_get_arrays(again, &other), SPH_OK);
        ck_assert_mem_eq(a.parents, other.parents, bone_count * sizeof *a.parents);
        ck_assert_mem_eq(a.positions, other.positions, bone_count * 3 * sizeof *a.positions);
        ck_assert_mem_eq(a.gaps, other.gaps, bone_count * sizeof *a.gaps);
        sph_skin_destroy(skin);
        sph_context_destroy(own);
        sph_skeleton_destroy(again);
    }
    sph_skeleton_destroy(skeleton);
}
END_TEST

static void check_refused(const sph_skin *skin, const sph_skeleton_options *o, const char *message)
{
    sph_skeleton *skeleton = (sph_skeleton *)context;
    ck_assert_int_eq(sph_skeleton_create(skin, o, &skeleton), SPH_E_INVALID);
    ck_assert_ptr_null(skeleton);
    ck_assert_msg(strstr(sph_context_last_message(context), message) != NULL, "%s", sph_context_last_message(context));
}

START_TEST(bad_options_and_poses_are_refused_by_name)
{
    sph_skin *skin = make_skin_in(context);
    sph_skeleton_options good, o;
    sph_skeleton_arrays a = {.struct_size = 4};
    sph_skeleton *skeleton;
    double locals[24];
    sph_skeleton_options_init(&good, sizeof good);
    o = good, o.layout = 2, check_refused(skin, &o, "layout is 2");
    o = good, o.root = -1, check_refused(skin, &o, "root is -1");
    o = good, o.root = SPH_ROOT_GIVEN, o.root_bone = 2, check_refused(skin, &o, "root_bone is 2");
    o = good, o.single_root = 2, check_refused(skin, &o, "single_root is 2");
    o = good, o.flags = 1, check_refused(skin, &o, "flags");
    ck_assert_int_eq(sph_skeleton_create(NULL, NULL, &skeleton), SPH_E_INVALID);
    ck_assert_int_eq(sph_skeleton_create(skin, NULL, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_skeleton_create(skin, NULL, &skeleton), SPH_OK);
    ck_assert_int_eq(sph_skeleton_get_arrays(skeleton, &a), SPH_E_INVALID);
    ck_assert_int_eq(sph_skeleton_get_arrays(NULL, &a), SPH_E_INVALID);
    ck_assert_int_eq(sph_skeleton_get_locals(skeleton, NULL, locals), SPH_E_INVALID);
    ck_assert_int_eq(sph_skeleton_get_transforms(skeleton, locals, NULL), SPH_E_INVALID);
    packed[17] = NAN;
    ck_assert_int_eq(sph_skeleton_get_locals(skeleton, packed, locals), SPH_E_INVALID);
    ck_assert_msg(strstr(sph_context_last_message(context), "bone 1") != NULL, "%s", sph_context_last_message(context));
    memset(packed, 0, sizeof packed);
    ck_assert_int_eq(sph_skeleton_get_locals(skeleton, packed, locals), SPH_E_INVALID);
    ck_assert_msg(strstr(sph_context_last_message(context), "inverted") != NULL, "%s",
                  sph_context_last_message(context));
    sph_skeleton_destroy(skeleton);
    sph_skeleton_destroy(NULL);
    sph_skin_destroy(skin);
}
END_TEST

/* Numbers whose squares are beyond double precision, pivots at one place, and a single bone still make a tree. */
START_TEST(extreme_skins_make_finite_trees)
{
    sph_skeleton_arrays a;
    sph_skeleton *skeleton;
    use_random_links();
    for (uint32_t b = 0; b < bone_count; ++b) {
        transforms[0][b][3] = _i == 0 ? 1e300 * b : 0;
        for (int k = 0; k < 3 && _i == 1; ++k)
            pivots[b][k] = 1;
    }
    if (_i == 2) bone_count = 1, link_count = 0;
    skeleton = make_with(NULL, &a);
    check_tree(&a, 1);
    for (uint32_t i = 0; i < 3 * bone_count; ++i)
        ck_assert(isfinite(a.positions[i]));
    sph_skeleton_destroy(skeleton);
}
END_TEST

START_TEST(every_allocation_may_fail)
{
    use_random_links();
    link_count = 5; /* several parts */
    for (size_t at = 1;; ++at) {
        test_faulty faulty = {0};
        const sph_allocator allocator = test_faulty_allocator(&faulty);
        sph_context *own = test_context_with_allocator(&allocator);
        sph_skin *skin = make_skin_in(own);
        sph_skeleton_options o;
        sph_skeleton *skeleton = NULL;
        sph_status status;
        double locals[17 * 12], out[17 * 12];
        sph_skeleton_options_init(&o, sizeof o);
        o.root = _i == 0 ? SPH_ROOT_CENTER : SPH_ROOT_HEAVIEST;
        faulty.fail_at = faulty.calls + at;
        status = sph_skeleton_create(skin, &o, &skeleton);
        if (status == SPH_OK) status = sph_skeleton_get_locals(skeleton, packed, locals);
        if (status == SPH_OK) status = sph_skeleton_get_transforms(skeleton, locals, out);
        sph_skeleton_destroy(skeleton);
        sph_skin_destroy(skin);
        sph_context_destroy(own);
        ck_assert_uint_eq(faulty.live_blocks, 0);
        ck_assert(!faulty.misused);
        if (status == SPH_OK) {
            ck_assert_uint_gt(at, 15);
            break;
        }
        ck_assert_int_eq(status, SPH_E_NOMEM);
    }
}
END_TEST

START_TEST(progress_does_not_fall_and_may_cancel)
{
    size_t calls = 1;
    use_random_links();
    link_count = 5;
    for (size_t cancel = 0; cancel <= calls; ++cancel) {
        test_progress progress = {.cancel_at = cancel};
        sph_context *own = test_context_with_progress(test_progress_callback, &progress);
        sph_skin *skin = make_skin_in(own);
        sph_skeleton *skeleton = NULL;
        ck_assert_int_eq(sph_skeleton_create(skin, NULL, &skeleton), cancel == 0 ? SPH_OK : SPH_E_CANCELLED);
        ck_assert(!progress.fell);
        ck_assert((skeleton != NULL) == (cancel == 0));
        if (cancel == 0) calls = progress.calls;
        sph_skeleton_destroy(skeleton);
        sph_skin_destroy(skin);
        sph_context_destroy(own);
    }
    ck_assert_uint_gt(calls, 2);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("skeleton");
    TCase *tc = tcase_create("joints");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_add_loop_test(tc, a_ball_joint_is_where_both_bones_turn, 0, 2);
    tcase_add_test(tc, a_hinge_s_joint_is_on_its_axis_nearest_to_where_the_spheres_meet);
    tcase_add_test(tc, bones_that_move_as_one_meet_where_their_spheres_do);
    tcase_add_test(tc, noise_of_bones_that_hardly_turn_does_not_throw_their_joint_off);
    tcase_add_test(tc, a_joint_is_no_farther_off_than_the_spheres_reach);
    tcase_add_test(tc, no_place_beside_a_joint_is_moved_more_alike);
    tcase_add_test(tc, of_a_ring_the_link_that_moves_least_alike_is_left_out);
    tcase_add_loop_test(tc, every_set_of_links_makes_one_tree, 0, 20);
    tcase_add_test(tc, parts_are_joined_where_their_spheres_are_nearest);
    tcase_add_loop_test(tc, the_center_is_where_the_farthest_bone_is_nearest, 0, 5);
    tcase_add_test(tc, the_heaviest_bone_and_any_other_can_be_the_root);
    tcase_add_loop_test(tc, poses_relative_to_parents_are_the_same_poses, 0, 8);
    tcase_add_test(tc, at_rest_the_joints_are_where_they_are_and_not_turned);
    tcase_add_test(tc, a_joint_takes_along_what_hangs_on_it);
    tcase_add_test(tc, threads_and_executors_do_not_change_a_bit);
    tcase_add_test(tc, bad_options_and_poses_are_refused_by_name);
    tcase_add_loop_test(tc, extreme_skins_make_finite_trees, 0, 3);
    tcase_add_loop_test(tc, every_allocation_may_fail, 0, 2);
    tcase_add_test(tc, progress_does_not_fall_and_may_cancel);
    return run_suite(suite, tc);
}
