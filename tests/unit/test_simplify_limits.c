/* SPDX-License-Identifier: MIT */
/* Levels when memory or the host's patience ends, on any number of threads, and of input that is odd or wrong. */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "faults.h"
#include "runner.h"
#include "simplify_case.h"

/* All that a progressive mesh is made for. */
static sph_status use(const sph_progressive *p)
{
    const uint32_t level = sph_progressive_collapse_count(p) / 2;
    sph_progressive_level l = {.struct_size = sizeof l};
    sph_cursor *cursor = NULL;
    sph_skin *skin = NULL;
    float normals[3 * 200], attributes[2 * 200];
    sph_status status = sph_progressive_get_level(p, level, &l);
    ck_assert_uint_lt(l.vertex_count, 200);
    if (status == SPH_OK) status = sph_progressive_create_cursor(p, &cursor);
    if (status == SPH_OK) status = sph_progressive_get_skin(p, level, &skin);
    if (status == SPH_OK) status = sph_progressive_get_attributes(p, level, normals, attributes, NULL, NULL);
    sph_cursor_destroy(cursor);
    sph_skin_destroy(skin);
    return status;
}

static sph_status make_and_use(sph_context *context, const void *user)
{
    simplify_case c = make_tube(context, 8, 5);
    sph_simplify_options o;
    sph_progressive *p = NULL;
    sph_status status = SPH_E_NOMEM;
    (void)user;
    sph_simplify_options_init(&o, sizeof o);
    o.attributes = c.attributes;
    o.attribute_count = 2;
    o.normals = c.normals;
    o.influence_limit = 2;
    if (c.skin != NULL) {
        status = sph_progressive_create(c.skin, &o, &p);
        ck_assert((p != NULL) == (status == SPH_OK));
        if (status == SPH_OK) status = use(p);
    }
    sph_progressive_destroy(p);
    free_case(&c);
    return status;
}

/* _i: fails once, or from there on. */
START_TEST(every_allocation_may_fail)
{
    check_every_allocation((test_faults){.work = make_and_use, .least = 60, .sticky = _i});
}
END_TEST

static sph_status make(sph_context *context, const void *user)
{
    simplify_case c = make_tube(context, 40, 12);
    sph_progressive *p = NULL;
    const sph_status status = sph_progressive_create(c.skin, NULL, &p);
    (void)user;
    ck_assert((p != NULL) == (status == SPH_OK));
    sph_progressive_destroy(p);
    free_case(&c);
    return status;
}

START_TEST(every_report_of_progress_may_cancel)
{
    check_every_cancel((test_faults){.work = make, .least = 5});
}
END_TEST

/* FNV-1a of all points and all levels' figures. */
static uint64_t hash_of(const sph_progressive *p)
{
    const uint32_t k = sph_progressive_influence_count(p);
    uint64_t hash = UINT64_C(14695981039346656037);
    for (uint32_t i = 0; i < sph_progressive_point_count(p) + sph_progressive_collapse_count(p); ++i) {
        unsigned char bytes[12 + 8 * 32];
        float rest[3], weights[32];
        uint32_t bones[32];
        ck_assert_int_eq(sph_progressive_point(p, i, rest, bones, weights), SPH_OK);
        memcpy(bytes, rest, 12);
        memcpy(bytes + 12, bones, 4 * (size_t)k);
        memcpy(bytes + 12 + 4 * (size_t)k, weights, 4 * (size_t)k);
        for (size_t b = 0; b < 12 + 8 * (size_t)k; ++b)
            hash = (hash ^ bytes[b]) * UINT64_C(1099511628211);
    }
    for (uint32_t level = 0; level <= sph_progressive_collapse_count(p); ++level) {
        const sph_progressive_level l = figures_of(p, level);
        const double numbers[4] = {l.error, l.max_error, l.vertex_count, l.triangle_count};
        unsigned char bytes[sizeof numbers];
        memcpy(bytes, numbers, sizeof bytes);
        for (size_t b = 0; b < sizeof bytes; ++b)
            hash = (hash ^ bytes[b]) * UINT64_C(1099511628211);
    }
    return hash;
}

static uint64_t hash_with(sph_context *context)
{
    simplify_case c = make_tube(context, 40, 16);
    sph_progressive *p = simplify(c.skin, NULL);
    const uint64_t hash = hash_of(p);
    sph_progressive_destroy(p);
    free_case(&c);
    sph_context_destroy(context);
    return hash;
}

START_TEST(the_bits_are_the_same_on_any_number_of_threads_and_any_executor)
{
    const sph_executor reverse = test_executor_reverse(), scattered = test_executor_scattered();
    const uint64_t hash = hash_with(test_context_with_threads(1));
    ck_assert(hash_with(test_context_with_threads(2)) == hash);
    ck_assert(hash_with(test_context_with_threads(4)) == hash);
    ck_assert(hash_with(test_context_with_executor(&reverse)) == hash);
    ck_assert(hash_with(test_context_with_executor(&scattered)) == hash);
}
END_TEST

typedef struct refusal {
    const char *says;
    void (*spoil)(sph_simplify_options *o, simplify_case *c);
} refusal;

static double POSE[36];
static void unknown_method(sph_simplify_options *o, simplify_case *c)
{
    (void)c;
    o->method = 4;
}
static void flags(sph_simplify_options *o, simplify_case *c)
{
    (void)c;
    o->flags = 1;
}
static void influences(sph_simplify_options *o, simplify_case *c)
{
    (void)c;
    o->influence_limit = 33;
}
static void negative_border(sph_simplify_options *o, simplify_case *c)
{
    (void)c;
    o->border_weight = -1;
}
static void nan_tolerance(sph_simplify_options *o, simplify_case *c)
{
    (void)c;
    o->tolerance = (double)NAN;
}
static void no_rounds(sph_simplify_options *o, simplify_case *c)
{
    (void)c;
    o->round_limit = 0;
}
static void no_attributes(sph_simplify_options *o, simplify_case *c)
{
    (void)c;
    o->attribute_count = 2;
}
static void no_poses(sph_simplify_options *o, simplify_case *c)
{
    (void)c;
    o->pose_count = 2;
}
static void old(sph_simplify_options *o, simplify_case *c)
{
    (void)c;
    o->struct_size = 8;
}

static void nan_attribute(sph_simplify_options *o, simplify_case *c)
{
    c->attributes[7] = NAN;
    o->attributes = c->attributes;
    o->attribute_count = 2;
}

static void infinite_normal(sph_simplify_options *o, simplify_case *c)
{
    c->normals[8] = INFINITY;
    o->normals = c->normals;
}

static void nan_pose(sph_simplify_options *o, simplify_case *c)
{
    (void)c;
    POSE[13] = (double)NAN;
    o->poses = POSE;
    o->pose_count = 1;
}

static void huge_pose(sph_simplify_options *o, simplify_case *c)
{
    (void)c;
    memset(POSE, 0, sizeof POSE);
    POSE[3] = POSE[15] = POSE[27] = 1e30;
    o->poses = POSE;
    o->pose_count = 1;
}

static const refusal REFUSALS[] = {{"method 4", unknown_method},
                                   {"flags", flags},
                                   {"33", influences},
                                   {"border_weight is -1", negative_border},
                                   {"tolerance is", nan_tolerance},
                                   {"round_limit is 0", no_rounds},
                                   {"attributes is NULL", no_attributes},
                                   {"poses and pose_count", no_poses},
                                   {"not initialised", old},
                                   {"attribute 1 of vertex 3", nan_attribute},
                                   {"normal of vertex 2", infinite_normal},
                                   {"bone 1 in pose 0", nan_pose},
                                   {"example pose 0", huge_pose}};

START_TEST(what_is_wrong_is_refused_by_name)
{
    sph_context *context = test_context();
    simplify_case c = make_tube(context, 6, 5);
    sph_simplify_options o;
    sph_progressive *p = (sph_progressive *)(void *)&o;
    sph_simplify_options_init(&o, sizeof o);
    REFUSALS[_i].spoil(&o, &c);
    ck_assert_int_eq(sph_progressive_create(c.skin, &o, &p), SPH_E_INVALID);
    ck_assert_ptr_null(p);
    ck_assert_msg(strstr(sph_context_last_message(context), REFUSALS[_i].says) != NULL, "'%s' does not say '%s'",
                  sph_context_last_message(context), REFUSALS[_i].says);
    free_case(&c);
    sph_context_destroy(context);
}
END_TEST

START_TEST(levels_that_there_are_not_are_refused)
{
    sph_context *context = test_context();
    simplify_case c = make_tube(context, 6, 5);
    sph_progressive *p = simplify(c.skin, NULL);
    sph_progressive_level l = {.struct_size = sizeof l};
    const uint32_t last = sph_progressive_collapse_count(p);
    sph_skin *skin;
    uint32_t level = 77;
    ck_assert_int_eq(sph_progressive_get_level(p, last + 1, &l), SPH_E_INVALID);
    ck_assert_int_eq(sph_progressive_get_skin(p, last + 1, &skin), SPH_E_INVALID);
    ck_assert_int_eq(sph_progressive_get_skin(p, last, &skin), SPH_E_LIMIT); /* one point: no triangles */
    ck_assert_int_eq(sph_progressive_get_attributes(p, last + 1, NULL, NULL, NULL, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_progressive_point(p, sph_progressive_point_count(p) + last, NULL, NULL, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_progressive_find_error(p, -1, &level), SPH_E_INVALID);
    ck_assert_int_eq(sph_progressive_find_error(p, (double)NAN, &level), SPH_E_INVALID);
    l.struct_size = 3;
    ck_assert_int_eq(sph_progressive_get_level(p, 0, &l), SPH_E_INVALID);
    ck_assert_uint_eq(level, 77);
    ck_assert_int_eq(sph_progressive_find_error(p, INFINITY, &level), SPH_OK);
    ck_assert_uint_eq(level, last);
    ck_assert_int_eq(sph_progressive_find_vertices(p, 0, &level), SPH_OK);
    sph_progressive_destroy(p);
    free_case(&c);
    sph_context_destroy(context);
}
END_TEST

/* Random triangles between random points on random bones, some of them of no area or there twice. */
START_TEST(any_finite_mesh_has_levels_down_to_a_point_per_part)
{
    enum { N = 60, BONES = 5, FRAMES = 3, TRIANGLES = 90 };
    uint64_t state = 1 + (uint64_t)_i;
    float rest[N][3], weights[N][2];
    uint32_t bones[N][2], triangles[TRIANGLES][3];
    double transforms[FRAMES][BONES][12];
    sph_skin_arrays a = {.struct_size = sizeof a, .vertex_count = N, .bone_count = BONES, .influence_count = 2};
    sph_context *context = test_context();
    sph_progressive *p;
    sph_skin *skin;
    for (int v = 0; v < N; ++v) {
        const double share = _i % 3 == 0 ? 1 : test_random_unit(&state);
        for (int k = 0; k < 3; ++k)
            rest[v][k] = _i % 2 == 0 ? (float)(int)(4 * test_random_unit(&state)) : (float)test_random_unit(&state);
        memcpy(weights[v], (float[2]){(float)share, (float)(1 - share)}, sizeof weights[v]);
        for (int k = 0; k < 2; ++k)
            bones[v][k] = (uint32_t)(BONES * test_random_unit(&state));
    }
    for (int t = 0; t < TRIANGLES; ++t)
        for (int k = 0; k < 3; ++k)
            triangles[t][k] = (uint32_t)(N * test_random_unit(&state));
    for (int i = 0; i < FRAMES * BONES * 12; ++i)
        transforms[i / 12 / BONES][i / 12 % BONES][i % 12] = test_random_between(&state, -1, 1);
    a.rest = rest[0];
    a.weights = weights[0];
    a.bones = bones[0];
    a.frame_count = FRAMES;
    a.transforms = transforms[0][0];
    a.triangles = triangles[0];
    a.triangle_count = TRIANGLES;
    ck_assert_int_eq(sph_skin_create_from_arrays(context, &a, &skin), SPH_OK);
    p = simplify(skin, NULL);
    for (uint32_t level = 0; level <= sph_progressive_collapse_count(p); ++level) {
        const sph_progressive_level l = figures_of(p, level);
        sph_skin *reduced = NULL;
        ck_assert(isfinite(l.error) && isfinite(l.max_error));
        ck_assert_int_eq(sph_progressive_get_skin(p, level, &reduced), l.triangle_count > 0 ? SPH_OK : SPH_E_LIMIT);
        if (reduced != NULL) ck_assert_uint_eq(sph_skin_vertex_count(reduced), l.vertex_count);
        sph_skin_destroy(reduced);
    }
    ck_assert_uint_eq(figures_of(p, sph_progressive_collapse_count(p)).triangle_count, 0);
    sph_progressive_destroy(p);
    sph_skin_destroy(skin);
    sph_context_destroy(context);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("simplify_limits");
    TCase *tc = tcase_create("limits");
    tcase_add_loop_test(tc, every_allocation_may_fail, 0, 2);
    tcase_add_test(tc, every_report_of_progress_may_cancel);
    tcase_add_test(tc, the_bits_are_the_same_on_any_number_of_threads_and_any_executor);
    tcase_add_loop_test(tc, what_is_wrong_is_refused_by_name, 0, sizeof REFUSALS / sizeof *REFUSALS);
    tcase_add_test(tc, levels_that_there_are_not_are_refused);
    tcase_add_loop_test(tc, any_finite_mesh_has_levels_down_to_a_point_per_part, 0, 12);
    return run_suite(suite, tc);
}
