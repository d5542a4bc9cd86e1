/* SPDX-License-Identifier: MIT */
/* Hierarchies: options, what is refused, and what holds of the hierarchy of any input. */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "awkward.h"
#include "runner.h"
#include "support.h"

static const unsigned FRAMES[] = {1, 7, 8, 9, 40};
enum { FRAME_CHOICES = sizeof FRAMES / sizeof *FRAMES, MODES = 3 };

static sph_context *context;

static void setup(void)
{
    context = test_context();
    ck_assert_ptr_nonnull(context);
}

static void teardown(void)
{
    sph_context_destroy(context);
}

static sph_hierarchy_options default_options(void)
{
    sph_hierarchy_options options;
    sph_hierarchy_options_init(&options, sizeof options);
    return options;
}

static sph_hierarchy *build(const sph_animation *animation, const sph_hierarchy_options *options)
{
    sph_hierarchy *h = NULL;
    const sph_status status = sph_hierarchy_create(animation, options, &h);
    ck_assert_msg(status == SPH_OK, "%s", sph_context_last_message(context));
    return h;
}

/* --- options --- */

START_TEST(options_have_the_documented_defaults)
{
    const sph_hierarchy_options o = default_options();
    ck_assert_uint_eq(o.struct_size, sizeof o);
    ck_assert_uint_eq(o.flags, 0);
    ck_assert_int_eq(o.importance, SPH_IMPORTANCE_CURVATURE);
    ck_assert_int_eq(o.radius_mode, SPH_RADIUS_CONSTANT);
    ck_assert_double_eq(o.radius_factor, 0.75);
    ck_assert_double_eq(o.temporal_coherence, 0);
    ck_assert_uint_eq(o.width_directions, 30);
    ck_assert_int_eq(o.orientation, SPH_ORIENTATION_OUTWARD);
    ck_assert_ptr_null(o.importance_weights);
    ck_assert_uint_eq(o.importance_frame_stride, 0);
}
END_TEST

START_TEST(a_newer_callers_options_are_read_and_its_settings_refused)
{
    struct {
        sph_hierarchy_options known;
        uint64_t newer;
    } o;
    sph_animation *animation = test_cube(context, 2);
    sph_hierarchy *h;
    memset(&o, 0xff, sizeof o);
    sph_hierarchy_options_init(&o.known, sizeof o);
    ck_assert_uint_eq(o.known.struct_size, sizeof o);
    ck_assert_uint_eq(o.newer, 0);
    ck_assert_double_eq(o.known.radius_factor, 0.75);
    sph_hierarchy_destroy(build(animation, &o.known));
    o.newer = 1;
    ck_assert_int_eq(sph_hierarchy_create(animation, &o.known, &h), SPH_E_VERSION);
    ck_assert_ptr_null(h);
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(options_that_are_too_small_or_raw_are_refused)
{
    sph_hierarchy_options o = {0};
    sph_animation *animation = test_cube(context, 2);
    sph_hierarchy *h = (sph_hierarchy *)&o;
    ck_assert_int_eq(sph_hierarchy_create(animation, &o, &h), SPH_E_INVALID);
    ck_assert_ptr_null(h);
    for (uint32_t size = 0; size < sizeof o; ++size) {
        o = default_options();
        o.struct_size = size;
        ck_assert_int_eq(sph_hierarchy_create(animation, &o, &h), SPH_E_INVALID);
        memset(&o, 0x5a, sizeof o);
        sph_hierarchy_options_init(&o, size); /* does not write beyond */
        for (size_t i = size; i < sizeof o; ++i)
            ck_assert_uint_eq(((unsigned char *)&o)[i], 0x5a);
    }
    sph_hierarchy_options_init(NULL, sizeof o);
    sph_animation_destroy(animation);
}
END_TEST

static const float WEIGHT = 1;

static const struct {
    const char *named; /* in the message */
    size_t offset;
    size_t size;
    int32_t integer;
    double real;
} BAD_OPTIONS[] = {
    {"flags", offsetof(sph_hierarchy_options, flags), 4, 1, 0},
    {"importance", offsetof(sph_hierarchy_options, importance), 4, -1, 0},
    {"importance", offsetof(sph_hierarchy_options, importance), 4, 3, 0},
    {"importance", offsetof(sph_hierarchy_options, importance), 4, INT32_MIN, 0},
    {"importance_weights", offsetof(sph_hierarchy_options, importance), 4, SPH_IMPORTANCE_CALLER, 0},
    {"radius_mode", offsetof(sph_hierarchy_options, radius_mode), 4, -1, 0},
    {"radius_mode", offsetof(sph_hierarchy_options, radius_mode), 4, 3, 0},
    {"orientation", offsetof(sph_hierarchy_options, orientation), 4, -1, 0},
    {"orientation", offsetof(sph_hierarchy_options, orientation), 4, 2, 0},
    {"width_directions", offsetof(sph_hierarchy_options, width_directions), 4, 2, 0},
    {"width_directions", offsetof(sph_hierarchy_options, width_directions), 4, 0, 0},
    {"width_directions", offsetof(sph_hierarchy_options, width_directions), 4, 1025, 0},
    {"width_directions", offsetof(sph_hierarchy_options, width_directions), 4, -1, 0},
    {"radius_factor", offsetof(sph_hierarchy_options, radius_factor), 8, 0, -1e-300},
    {"radius_factor", offsetof(sph_hierarchy_options, radius_factor), 8, 0, (double)NAN},
    {"radius_factor", offsetof(sph_hierarchy_options, radius_factor), 8, 0, (double)INFINITY},
    {"temporal_coherence", offsetof(sph_hierarchy_options, temporal_coherence), 8, 0, -1},
    {"temporal_coherence", offsetof(sph_hierarchy_options, temporal_coherence), 8, 0, (double)NAN},
    {"temporal_coherence", offsetof(sph_hierarchy_options, temporal_coherence), 8, 0, (double)INFINITY},
};
enum { BAD_OPTION_COUNT = sizeof BAD_OPTIONS / sizeof *BAD_OPTIONS };

START_TEST(a_bad_option_is_refused_and_the_message_names_it)
{
    sph_hierarchy_options o = default_options();
    sph_animation *animation = test_cube(context, 2);
    sph_hierarchy *h = (sph_hierarchy *)&o;
    const void *value = BAD_OPTIONS[_i].size == 4 ? (const void *)&BAD_OPTIONS[_i].integer : &BAD_OPTIONS[_i].real;
    memcpy((char *)&o + BAD_OPTIONS[_i].offset, value, BAD_OPTIONS[_i].size);
    ck_assert_int_eq(sph_hierarchy_create(animation, &o, &h), SPH_E_INVALID);
    ck_assert_ptr_null(h);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), BAD_OPTIONS[_i].named));
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(weights_without_their_mode_are_refused)
{
    sph_hierarchy_options o = default_options();
    sph_animation *animation = awkward(context, AWKWARD_SINGLE_VERTEX, 1);
    sph_hierarchy *h;
    o.importance_weights = &WEIGHT;
    ck_assert_int_eq(sph_hierarchy_create(animation, &o, &h), SPH_E_INVALID);
    o.importance = SPH_IMPORTANCE_CALLER;
    sph_hierarchy_destroy(build(animation, &o));
    sph_animation_destroy(animation);
}
END_TEST

START_TEST(null_and_numbers_out_of_range_are_answered)
{
    sph_animation *animation = test_cube(context, 2);
    sph_hierarchy *h = (sph_hierarchy *)animation;
    sph_collapse collapse;
    uint32_t count = 77;
    ck_assert_int_eq(sph_hierarchy_create(NULL, NULL, &h), SPH_E_INVALID);
    ck_assert_ptr_null(h);
    ck_assert_int_eq(sph_hierarchy_create(animation, NULL, NULL), SPH_E_INVALID);
    ck_assert_uint_eq(sph_hierarchy_vertex_count(NULL) + sph_hierarchy_frame_count(NULL), 0);
    ck_assert_uint_eq(sph_hierarchy_collapse_count(NULL) + sph_hierarchy_first_forced(NULL), 0);
    ck_assert_uint_eq(sph_hierarchy_evaluation_count(NULL), 0);
    ck_assert_double_eq(sph_hierarchy_bounding_diagonal(NULL), 0);
    ck_assert_int_eq(sph_hierarchy_collapse(NULL, 0, &collapse), SPH_E_INVALID);
    ck_assert_int_eq(sph_hierarchy_sphere(NULL, 0, NULL, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_hierarchy_count_for_error(NULL, 1, &count), SPH_E_INVALID);
    sph_hierarchy_destroy(NULL);
    h = build(animation, NULL);
    ck_assert_int_eq(sph_hierarchy_collapse(h, 0, NULL), SPH_E_INVALID);
    ck_assert_int_eq(sph_hierarchy_collapse(h, sph_hierarchy_collapse_count(h), &collapse), SPH_E_INVALID);
    ck_assert_int_eq(sph_hierarchy_collapse(h, UINT32_MAX, &collapse), SPH_E_INVALID);
    ck_assert_int_eq(sph_hierarchy_sphere(h, 15, NULL, NULL), SPH_E_INVALID); /* 8 + 7 */
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "15"));
    ck_assert_int_eq(sph_hierarchy_sphere(h, 14, NULL, NULL), SPH_OK);
    ck_assert_int_eq(sph_hierarchy_count_for_error(h, -1, &count), SPH_E_INVALID);
    ck_assert_int_eq(sph_hierarchy_count_for_error(h, (double)NAN, &count), SPH_E_INVALID);
    ck_assert_int_eq(sph_hierarchy_count_for_error(h, 1, NULL), SPH_E_INVALID);
    ck_assert_uint_eq(count, 77);
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
}
END_TEST

/* --- input that is refused --- */

static const struct {
    float value;
    uint32_t frame, vertex, axis;
} BAD_COORDINATES[] = {{NAN, 0, 0, 0},     {NAN, 2, 7, 2},    {INFINITY, 1, 3, 1}, {-INFINITY, 0, 5, 0},
                       {3.4e38f, 1, 0, 0}, {-1e20f, 2, 6, 2}, {2e19f, 0, 7, 2}};
enum { BAD_COORDINATE_COUNT = sizeof BAD_COORDINATES / sizeof *BAD_COORDINATES };

START_TEST(a_bad_coordinate_is_refused_and_the_message_names_frame_and_vertex)
{
    sph_animation *animation = test_cube(context, 3);
    sph_hierarchy *h = (sph_hierarchy *)animation;
    float xyz[8][3];
    char text[64];
    ck_assert_int_eq(sph_animation_read_frame(animation, BAD_COORDINATES[_i].frame, xyz[0]), SPH_OK);
    xyz[BAD_COORDINATES[_i].vertex][BAD_COORDINATES[_i].axis] = BAD_COORDINATES[_i].value;
    ck_assert_int_eq(sph_animation_set_frame(animation, BAD_COORDINATES[_i].frame, xyz[0], 0), SPH_OK);
    ck_assert_int_eq(sph_hierarchy_create(animation, NULL, &h), SPH_E_INVALID);
    ck_assert_ptr_null(h);
    snprintf(text, sizeof text, "frame %u", BAD_COORDINATES[_i].frame);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), text));
    snprintf(text, sizeof text, "vertex %u", BAD_COORDINATES[_i].vertex);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), text));
    sph_animation_destroy(animation);
}
END_TEST

static const float BAD_WEIGHTS[] = {-1, -1e-40f, NAN, INFINITY, -INFINITY};
enum { BAD_WEIGHT_COUNT = sizeof BAD_WEIGHTS / sizeof *BAD_WEIGHTS };

START_TEST(a_bad_weight_is_refused_and_the_message_names_frame_and_vertex)
{
    sph_animation *animation = test_cube(context, 3);
    sph_hierarchy_options o = default_options();
    sph_hierarchy *h;
    float weights[3 * 10];
    for (unsigned i = 0; i < 30; ++i)
        weights[i] = i % 10 < 8 ? 1 : -5; /* what lies between is not read */
    o.importance = SPH_IMPORTANCE_CALLER;
    o.importance_weights = weights;
    o.importance_frame_stride = 10;
    sph_hierarchy_destroy(build(animation, &o));
    weights[25] = BAD_WEIGHTS[_i];
    ck_assert_int_eq(sph_hierarchy_create(animation, &o, &h), SPH_E_INVALID);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "frame 2"));
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "vertex 5"));
    o.importance_frame_stride = 0; /* then only the first eight count */
    sph_hierarchy_destroy(build(animation, &o));
    weights[3] = BAD_WEIGHTS[_i];
    ck_assert_int_eq(sph_hierarchy_create(animation, &o, &h), SPH_E_INVALID);
    ck_assert_ptr_nonnull(strstr(sph_context_last_message(context), "vertex 3"));
    sph_animation_destroy(animation);
}
END_TEST

/* --- what holds of every hierarchy --- */

/* The largest distance of two vertices in any frame: no width of any region, and so no radius, can be more. */
static double largest_distance(const sph_animation *animation)
{
    const uint32_t n = sph_animation_vertex_count(animation);
    float(*xyz)[3] = test_malloc(n, sizeof *xyz);
    double largest = 0;
    for (uint32_t f = 0; f < sph_animation_frame_count(animation); ++f) {
        ck_assert_int_eq(sph_animation_read_frame(animation, f, xyz[0]), SPH_OK);
        for (uint32_t i = 0; i < n; ++i)
            for (uint32_t j = 0; j < i; ++j) {
                const double x = (double)xyz[i][0] - (double)xyz[j][0], y = (double)xyz[i][1] - (double)xyz[j][1];
                const double z = (double)xyz[i][2] - (double)xyz[j][2];
                largest = fmax(largest, sqrt(x * x + y * y + z * z));
            }
    }
    free(xyz);
    return largest;
}

/* Leaves are the input's vertices. What is smaller than the whole by more than 32 bits hold may be lost. */
static void check_leaves(const sph_hierarchy *h, const sph_animation *animation)
{
    const double tiny = 0x1p-125 * sph_hierarchy_bounding_diagonal(h);
    const uint32_t n = sph_animation_vertex_count(animation), frames = sph_animation_frame_count(animation);
    float(*xyz)[3] = test_malloc(n, sizeof *xyz), (*centers)[3] = test_malloc(frames, sizeof *centers);
    float *radii = test_malloc(frames, sizeof *radii);
    for (uint32_t f = 0; f < frames; ++f) {
        ck_assert_int_eq(sph_animation_read_frame(animation, f, xyz[0]), SPH_OK);
        for (uint32_t v = 0; v < n; ++v) {
            ck_assert_int_eq(sph_hierarchy_sphere(h, v, centers[0], radii), SPH_OK);
            for (unsigned k = 0; k < 3; ++k)
                ck_assert_double_le(fabs((double)centers[f][k] - (double)xyz[v][k]), tiny);
            ck_assert_float_eq(radii[f], 0);
        }
    }
    free(xyz);
    free(centers);
    free(radii);
}

static void check_spheres(const sph_hierarchy *h, int32_t mode, double radius_most)
{
    const uint32_t frames = sph_hierarchy_frame_count(h);
    const uint32_t nodes = sph_hierarchy_vertex_count(h) + sph_hierarchy_collapse_count(h);
    float(*centers)[3] = test_malloc(frames, sizeof *centers), *radii = test_malloc(frames, sizeof *radii);
    for (uint32_t node = 0; node < nodes; ++node) {
        ck_assert_int_eq(sph_hierarchy_sphere(h, node, centers[0], radii), SPH_OK);
        for (uint32_t f = 0; f < frames; ++f) {
            for (unsigned k = 0; k < 3; ++k)
                ck_assert(isfinite(centers[f][k]));
            ck_assert(isfinite(radii[f]) && radii[f] >= 0);
            ck_assert_double_le((double)radii[f], radius_most * (1 + 1e-5));
            if (mode == SPH_RADIUS_ZERO) ck_assert_float_eq(radii[f], 0);
            if (mode == SPH_RADIUS_CONSTANT) ck_assert_float_eq(radii[f], radii[0]);
        }
    }
    free(centers);
    free(radii);
}

/* That collapses are a forest over the vertices, and their numbers sane. */
static void check_collapses(const sph_hierarchy *h)
{
    const uint32_t n = sph_hierarchy_vertex_count(h), collapses = sph_hierarchy_collapse_count(h);
    unsigned char *united = test_malloc(n + (size_t)collapses, 1);
    uint32_t first_forced = collapses;
    double error = 0;
    for (uint32_t t = 0; t < collapses; ++t) {
        sph_collapse c;
        ck_assert_int_eq(sph_hierarchy_collapse(h, t, &c), SPH_OK);
        ck_assert_uint_eq(c.node, n + t);
        ck_assert_uint_lt(c.u, c.v);
        ck_assert_uint_lt(c.v, c.node);
        ck_assert_msg(!united[c.u] && !united[c.v], "a node is united twice");
        united[c.u] = united[c.v] = 1;
        ck_assert(isfinite(c.cost) && c.cost >= 0);
        ck_assert(isfinite(c.error) && c.error >= error);
        ck_assert_uint_le(c.forced, 1);
        if (c.forced && first_forced == collapses) first_forced = t;
        error = c.error;
    }
    ck_assert_uint_eq(sph_hierarchy_first_forced(h), first_forced);
    free(united);
}

static void check_hierarchy(const sph_hierarchy *h, const sph_animation *animation, const sph_hierarchy_options *o)
{
    double diagonal = -1;
    const double bound = o->radius_factor * largest_distance(animation);
    ck_assert_uint_eq(sph_hierarchy_vertex_count(h), sph_animation_vertex_count(animation));
    ck_assert_uint_eq(sph_hierarchy_frame_count(h), sph_animation_frame_count(animation));
    ck_assert_uint_eq(sph_hierarchy_vertex_count(h) - sph_hierarchy_collapse_count(h), test_component_count(animation));
    ck_assert_uint_ge(sph_hierarchy_evaluation_count(h), sph_hierarchy_collapse_count(h));
    ck_assert_int_eq(sph_animation_bounding_diagonal(animation, &diagonal), SPH_OK);
    ck_assert_double_le(fabs(diagonal - sph_hierarchy_bounding_diagonal(h)), 1e-12 * diagonal);
    check_leaves(h, animation);
    check_collapses(h);
    check_spheres(h, o->radius_mode, bound);
}

/* Builds with every radius mode and importance, and checks. */
static void check_animation(sph_animation *animation, double coherence)
{
    ck_assert_ptr_nonnull(animation);
    for (int32_t mode = 0; mode < MODES; ++mode)
        for (int32_t importance = SPH_IMPORTANCE_NONE; importance <= SPH_IMPORTANCE_CURVATURE; ++importance) {
            sph_hierarchy_options o = default_options();
            sph_hierarchy *h;
            o.radius_mode = mode;
            o.importance = importance;
            o.temporal_coherence = coherence;
            h = build(animation, &o);
            check_hierarchy(h, animation, &o);
            sph_hierarchy_destroy(h);
        }
    sph_animation_destroy(animation);
}

START_TEST(every_input_comes_down_to_one_sphere_per_component)
{
    const unsigned kind = (unsigned)_i % AWKWARD_KIND_COUNT, frames = FRAMES[_i / AWKWARD_KIND_COUNT];
    check_animation(awkward(context, kind, frames), 0);
}
END_TEST

static const awkward_options PLACES[] = {{.frames = 3, .scale = 1e8},
                                         {.frames = 3, .scale = 2e16},
                                         {.frames = 3, .scale = 1e-20},
                                         {.frames = 3, .scale = 1e-37},
                                         {.frames = 3, .scale = 1e-44},
                                         {.frames = 3, .scale = 1, .shift = 1e5},
                                         {.frames = 3, .scale = 1, .shift = -1e9},
                                         {.frames = 3, .scale = 1e-3, .shift = 1e17}};
enum { PLACE_COUNT = sizeof PLACES / sizeof *PLACES };

START_TEST(inputs_of_any_size_anywhere_are_accepted)
{
    check_animation(awkward_animation(context, (unsigned)_i % AWKWARD_KIND_COUNT, PLACES[_i / AWKWARD_KIND_COUNT]), 0);
}
END_TEST

/* One frame small beyond all measure of the others, and far from them. */
START_TEST(frames_of_very_different_sizes_are_accepted)
{
    static const double SIZES[] = {1e-30, 1, 2e16, 0, 1e-44, 1e5};
    const unsigned kind = (unsigned)_i;
    sph_animation *animation = awkward(context, kind, 6);
    const uint32_t n = sph_animation_vertex_count(animation);
    float *xyz = test_malloc(n, 3 * sizeof *xyz);
    for (uint32_t f = 0; f < 6; ++f) {
        ck_assert_int_eq(sph_animation_read_frame(animation, f, xyz), SPH_OK);
        for (size_t i = 0; i < 3 * (size_t)n; ++i)
            xyz[i] = (float)((double)xyz[i] * SIZES[f]);
        ck_assert_int_eq(sph_animation_set_frame(animation, f, xyz, 0), SPH_OK);
    }
    free(xyz);
    check_animation(animation, 0);
}
END_TEST

/* All but a point in one frame, at the limit of coordinates: normalising the small frame may not overflow the other. */
START_TEST(a_small_mesh_that_jumps_far_away_stays_finite)
{
    sph_animation *animation = awkward_animation(context, AWKWARD_CUBE, (awkward_options){.frames = 2, .scale = 1e-30});
    float xyz[8][3];
    for (unsigned i = 0; i < 24; ++i)
        xyz[i / 3][i % 3] = 1e18f;
    ck_assert_int_eq(sph_animation_set_frame(animation, 1, xyz[0], 0), SPH_OK);
    check_animation(animation, 0);
}
END_TEST

START_TEST(temporal_coherence_keeps_everything_sane)
{
    static const double DELTAS[] = {1e-9, 0.02, 10, 1e300};
    const unsigned kind = (unsigned)_i % AWKWARD_KIND_COUNT;
    check_animation(awkward(context, kind, 9), DELTAS[_i / AWKWARD_KIND_COUNT]);
}
END_TEST

/* --- numbers that are known --- */

START_TEST(weights_of_zero_cost_nothing)
{
    sph_animation *animation = test_torus(context, 8, 6, 3);
    sph_hierarchy_options o = default_options();
    float weights[48] = {0};
    o.importance = SPH_IMPORTANCE_CALLER;
    o.importance_weights = weights;
    for (int32_t mode = 0; mode < MODES; ++mode) {
        sph_hierarchy *h;
        o.radius_mode = mode;
        h = build(animation, &o);
        check_hierarchy(h, animation, &o);
        for (uint32_t t = 0; t < sph_hierarchy_collapse_count(h); ++t) {
            sph_collapse c;
            ck_assert_int_eq(sph_hierarchy_collapse(h, t, &c), SPH_OK);
            ck_assert_double_eq(c.cost, 0);
            ck_assert_double_eq(c.error, 0);
        }
        sph_hierarchy_destroy(h);
    }
    sph_animation_destroy(animation);
}
END_TEST

/* A flat sheet in any frame is a plane: no sphere of it costs anything. */
START_TEST(flat_sheets_cost_nothing)
{
    sph_animation *animation = awkward(context, AWKWARD_FLAT, (unsigned)_i + 1);
    sph_hierarchy_options o = default_options();
    sph_hierarchy *h = build(animation, &o);
    for (uint32_t t = 0; t < sph_hierarchy_collapse_count(h); ++t) {
        sph_collapse c;
        ck_assert_int_eq(sph_hierarchy_collapse(h, t, &c), SPH_OK);
        ck_assert_double_le(c.error, 1e-6 * sph_hierarchy_bounding_diagonal(h));
    }
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
}
END_TEST

/* The planes of a cube touch the sphere inside it, of radius 1; of half that where the bound says so. */
START_TEST(a_cube_becomes_the_sphere_inside_it)
{
    static const double FACTORS[] = {0.75, 0.25, 100, 1e308};
    sph_animation *animation = test_cube(context, 1);
    sph_hierarchy_options o = default_options();
    sph_hierarchy *h;
    sph_collapse c;
    float center[3], radius;
    o.importance = SPH_IMPORTANCE_NONE;
    o.radius_factor = FACTORS[_i];
    h = build(animation, &o);
    ck_assert_int_eq(sph_hierarchy_collapse(h, 6, &c), SPH_OK);
    ck_assert_int_eq(sph_hierarchy_sphere(h, c.node, center, &radius), SPH_OK);
    for (unsigned k = 0; k < 3; ++k)
        ck_assert_float_le(fabsf(center[k]), 1e-4f);
    if (_i == 1) { /* width: 2, or a little more in directions beside the axes */
        ck_assert_float_ge(radius, 0.5f);
        ck_assert_float_le(radius, 0.6f);
        ck_assert_double_eq_tol(c.cost, 24 * (1 - radius) * (1 - radius), 1e-4); /* 24: the cube's area */
    } else {
        ck_assert_float_le(fabsf(radius - 1), 1e-4f);
        ck_assert_double_le(c.cost, 1e-4);
    }
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
}
END_TEST

/* The error of a level: the costs of its spheres over the area of all frames. */
START_TEST(errors_are_root_mean_square_distances)
{
    sph_animation *animation = awkward(context, _i == 0 ? AWKWARD_TORUS : AWKWARD_SOUP, 3);
    sph_hierarchy_options o = default_options();
    const uint32_t n = sph_animation_vertex_count(animation), *corner = sph_animation_triangles(animation);
    float(*xyz)[3] = test_malloc(n, sizeof *xyz);
    double *costs = test_malloc(2 * (size_t)n, sizeof *costs), area = 0, sum = 0, error = 0;
    sph_hierarchy *h;
    for (uint32_t f = 0; f < 3; ++f) {
        ck_assert_int_eq(sph_animation_read_frame(animation, f, xyz[0]), SPH_OK);
        for (size_t t = 0; t < sph_animation_triangle_count(animation); ++t) {
            double e[2][3], squared = 0;
            for (unsigned i = 0; i < 6; ++i)
                e[i / 3][i % 3] = (double)xyz[corner[3 * t + 1 + i / 3]][i % 3] - (double)xyz[corner[3 * t]][i % 3];
            for (unsigned k = 0; k < 3; ++k)
                squared += pow(e[0][(k + 1) % 3] * e[1][(k + 2) % 3] - e[0][(k + 2) % 3] * e[1][(k + 1) % 3], 2);
            area += sqrt(squared) / 2;
        }
    }
    o.importance = SPH_IMPORTANCE_NONE;
    h = build(animation, &o);
    for (uint32_t t = 0; t < sph_hierarchy_collapse_count(h); ++t) {
        sph_collapse c;
        ck_assert_int_eq(sph_hierarchy_collapse(h, t, &c), SPH_OK);
        costs[c.node] = c.cost;
        sum += c.cost - costs[c.u] - costs[c.v];
        error = fmax(error, sqrt(fmax(sum, 0) / area));
        ck_assert_double_eq_tol(c.error, error, 1e-9 + 1e-6 * error);
    }
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
    free(xyz);
    free(costs);
}
END_TEST

/* Where the attachment is all that counts, a sphere is at the area-weighted mean of its vertices (Eq. 11-12). */
START_TEST(strong_coherence_puts_centres_at_area_weighted_means)
{
    sph_animation *animation = test_torus(context, 8, 6, 5);
    const uint32_t *corner = sph_animation_triangles(animation);
    sph_hierarchy_options o = default_options();
    float xyz[48][3], centers[5][3];
    sph_hierarchy *h;
    o.temporal_coherence = 1e9;
    h = build(animation, &o);
    ck_assert_int_eq(sph_hierarchy_sphere(h, 48 + 46, centers[0], NULL), SPH_OK);
    for (uint32_t f = 0; f < 5; ++f) {
        double mean[3] = {0, 0, 0}, total = 0;
        ck_assert_int_eq(sph_animation_read_frame(animation, f, xyz[0]), SPH_OK);
        for (size_t t = 0; t < 96; ++t) {
            double e[2][3], squared = 0;
            for (unsigned i = 0; i < 6; ++i)
                e[i / 3][i % 3] = (double)xyz[corner[3 * t + 1 + i / 3]][i % 3] - (double)xyz[corner[3 * t]][i % 3];
            for (unsigned k = 0; k < 3; ++k)
                squared += pow(e[0][(k + 1) % 3] * e[1][(k + 2) % 3] - e[0][(k + 2) % 3] * e[1][(k + 1) % 3], 2);
            for (unsigned i = 0; i < 9; ++i)
                mean[i % 3] += sqrt(squared) * (double)xyz[corner[3 * t + i / 3]][i % 3] / 3;
            total += sqrt(squared);
        }
        for (unsigned k = 0; k < 3; ++k)
            ck_assert_double_eq_tol((double)centers[f][k], mean[k] / total, 1e-5);
    }
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
}
END_TEST

/* --- the radius bound --- */

/* Extent in a frame and direction of the cells of the vertices that `inside` marks. */
static double extent_of(const sph_animation *animation, float (*xyz)[3], const unsigned char *inside, const double k[3])
{
    const uint32_t n = sph_animation_vertex_count(animation), *corner = sph_animation_triangles(animation);
    double *x = test_malloc(n, sizeof *x), low = INFINITY, high = -INFINITY;
    for (uint32_t v = 0; v < n; ++v) {
        x[v] = k[0] * (double)xyz[v][0] + k[1] * (double)xyz[v][1] + k[2] * (double)xyz[v][2];
        if (inside[v]) low = fmin(low, x[v]);
        if (inside[v]) high = fmax(high, x[v]);
    }
    for (size_t t = 0; t < sph_animation_triangle_count(animation); ++t, corner += 3)
        for (unsigned c = 0; c < 3; ++c) {
            const double a = x[corner[c]], b = x[corner[(c + 1) % 3]], d = x[corner[(c + 2) % 3]];
            const double points[3] = {(a + b) / 2, (a + d) / 2, (a + b + d) / 3};
            for (unsigned i = 0; i < 3 && inside[corner[c]]; ++i) {
                low = fmin(low, points[i]);
                high = fmax(high, points[i]);
            }
        }
    free(x);
    return high - low;
}

/*
 * With 1,024 evenly spread directions none is further than 0.12 from one of the library's (a hexagonal grid of as many
 * would have 0.05), so that the library's width is at most that much of the diameter above one taken in any directions.
 */
START_TEST(radii_stay_within_the_width_of_their_regions)
{
    enum { DIRECTIONS = 200 };
    sph_animation *animation = awkward(context, _i == 0 ? AWKWARD_TORUS : _i == 1 ? AWKWARD_SOUP : AWKWARD_WHISKERS, 3);
    const uint32_t n = sph_animation_vertex_count(animation);
    float(*xyz)[3] = test_malloc(n, sizeof *xyz), radii[3];
    unsigned char *inside = test_malloc(n, 1);
    uint32_t *members = test_malloc(2 * (size_t)n, sizeof *members); /* to which node a vertex belongs by now */
    sph_hierarchy_options o = default_options();
    unsigned at_bound = 0;
    sph_hierarchy *h;
    o.width_directions = 1024;
    o.radius_factor = 0.4;
    h = build(animation, &o);
    for (uint32_t v = 0; v < n; ++v)
        members[v] = v;
    for (uint32_t t = 0; t < sph_hierarchy_collapse_count(h); ++t) {
        double width = INFINITY;
        sph_collapse c;
        ck_assert_int_eq(sph_hierarchy_collapse(h, t, &c), SPH_OK);
        for (uint32_t v = 0; v < n; ++v) {
            if (members[v] == c.u || members[v] == c.v) members[v] = c.node;
            inside[v] = members[v] == c.node;
        }
        for (uint32_t f = 0; f < 3; ++f) {
            uint64_t state = 99;
            double least = INFINITY, diameter = 0;
            ck_assert_int_eq(sph_animation_read_frame(animation, f, xyz[0]), SPH_OK);
            for (unsigned j = 0; j < DIRECTIONS; ++j) {
                const double z = 2 * test_random_unit(&state) - 1, a = 6.2831853 * test_random_unit(&state);
                const double k[3] = {sqrt(1 - z * z) * cos(a), sqrt(1 - z * z) * sin(a), z};
                const double extent = extent_of(animation, xyz, inside, k);
                least = fmin(least, extent);
                diameter = fmax(diameter, extent);
            }
            width = fmin(width, least + 0.12 * diameter * 1.1);
        }
        ck_assert_int_eq(sph_hierarchy_sphere(h, c.node, NULL, radii), SPH_OK);
        ck_assert_double_le((double)radii[0], o.radius_factor * width);
        at_bound += (double)radii[0] > 0.6 * o.radius_factor * width;
    }
    ck_assert_uint_gt(at_bound, 0); /* or it was no test */
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
    free(xyz);
    free(inside);
    free(members);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("hierarchy");
    TCase *tc = tcase_create("all");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_set_timeout(tc, 60);
    tcase_add_test(tc, options_have_the_documented_defaults);
    tcase_add_test(tc, a_newer_callers_options_are_read_and_its_settings_refused);
    tcase_add_test(tc, options_that_are_too_small_or_raw_are_refused);
    tcase_add_loop_test(tc, a_bad_option_is_refused_and_the_message_names_it, 0, BAD_OPTION_COUNT);
    tcase_add_test(tc, weights_without_their_mode_are_refused);
    tcase_add_test(tc, null_and_numbers_out_of_range_are_answered);
    tcase_add_loop_test(tc, a_bad_coordinate_is_refused_and_the_message_names_frame_and_vertex, 0,
                        BAD_COORDINATE_COUNT);
    tcase_add_loop_test(tc, a_bad_weight_is_refused_and_the_message_names_frame_and_vertex, 0, BAD_WEIGHT_COUNT);
    tcase_add_loop_test(tc, every_input_comes_down_to_one_sphere_per_component, 0, AWKWARD_KIND_COUNT * FRAME_CHOICES);
    tcase_add_loop_test(tc, inputs_of_any_size_anywhere_are_accepted, 0, AWKWARD_KIND_COUNT * PLACE_COUNT);
    tcase_add_loop_test(tc, frames_of_very_different_sizes_are_accepted, 0, AWKWARD_KIND_COUNT);
    tcase_add_test(tc, a_small_mesh_that_jumps_far_away_stays_finite);
    tcase_add_loop_test(tc, temporal_coherence_keeps_everything_sane, 0, AWKWARD_KIND_COUNT * 4);
    tcase_add_test(tc, weights_of_zero_cost_nothing);
    tcase_add_loop_test(tc, flat_sheets_cost_nothing, 0, 9);
    tcase_add_loop_test(tc, a_cube_becomes_the_sphere_inside_it, 0, 4);
    tcase_add_loop_test(tc, errors_are_root_mean_square_distances, 0, 2);
    tcase_add_test(tc, strong_coherence_puts_centres_at_area_weighted_means);
    tcase_add_loop_test(tc, radii_stay_within_the_width_of_their_regions, 0, 3);
    return run_suite(suite, tc);
}
