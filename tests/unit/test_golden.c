/* SPDX-License-Identifier: MIT */
/*
 * The same bits everywhere: hashes of results, which every compiler, optimisation, instruction set and number of threads
 * has to give. The input is made by additions, multiplications, divisions and square roots alone, which IEEE 754 rounds in
 * one way. Where a change of the algorithm means to change results, the new hashes go here, and NEWS.md says so.
 */
#include <check.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "runner.h"
#include "support.h"

enum { RINGS = 24, SIDES = 12, VERTICES = RINGS * SIDES, FRAMES = 5, TRIANGLES = 2 * VERTICES, SAMPLES = 500 };

typedef struct hash {
    uint64_t value;
} hash;

/* FNV-1a. */
static sph_status add_bytes(void *user, const void *bytes, size_t size)
{
    hash *h = user;
    for (size_t i = 0; i < size; ++i) h->value = (h->value ^ ((const unsigned char *)bytes)[i]) * UINT64_C(0x100000001b3);
    return SPH_OK;
}

static hash new_hash(void)
{
    return (hash){.value = UINT64_C(0xcbf29ce484222325)};
}

/* A point of the unit circle, i of n of the way around: not evenly, but without a cosine. */
static void circle(unsigned i, unsigned n, double *x, double *y)
{
    const unsigned quarter = 4 * i / n;
    const double t = 4.0 * i / n - quarter, u = (1 - t * t) / (1 + t * t), v = 2 * t / (1 + t * t);
    *x = quarter == 0 ? u : quarter == 1 ? -v : quarter == 2 ? -u : v;
    *y = quarter == 0 ? v : quarter == 1 ? u : quarter == 2 ? -v : -u;
}

/* A torus that grows bumps and bends. */
static void place(unsigned ring, unsigned side, unsigned frame, float xyz[3])
{
    double cx, cy, sx, sy, tube, reach;
    circle(ring, RINGS, &cx, &cy);
    circle(side, SIDES, &sx, &sy);
    tube = 0.3 + 0.05 * frame * cx * cy * sx;
    reach = 1 + tube * sx;
    xyz[0] = (float)(reach * cx);
    xyz[1] = (float)(reach * cy * (1 + 0.1 * frame));
    xyz[2] = (float)(tube * sy + 0.08 * frame * cx * cx);
}

static sph_animation *make_animation(sph_context *context, unsigned frames)
{
    static uint32_t triangles[TRIANGLES][3];
    sph_animation *animation = NULL;
    for (unsigned r = 0; r < RINGS; ++r) {
        for (unsigned s = 0; s < SIDES; ++s) {
            const uint32_t a = r * SIDES + s, b = r * SIDES + (s + 1) % SIDES;
            const uint32_t c = (r + 1) % RINGS * SIDES + s, d = (r + 1) % RINGS * SIDES + (s + 1) % SIDES;
            const uint32_t pair[2][3] = {{a, c, d}, {a, d, b}};
            memcpy(triangles[2 * a], pair, sizeof pair);
        }
    }
    ck_assert_int_eq(sph_animation_create(context, VERTICES, frames, &animation), SPH_OK);
    ck_assert_int_eq(sph_animation_set_triangles(animation, triangles[0], TRIANGLES, 0), SPH_OK);
    for (unsigned f = 0; f < frames; ++f) {
        float frame[VERTICES][3];
        for (unsigned v = 0; v < VERTICES; ++v) place(v / SIDES, v % SIDES, f, frame[v]);
        ck_assert_int_eq(sph_animation_set_frame(animation, f, frame[0], 0), SPH_OK);
    }
    return animation;
}

static sph_context *make_context(int which)
{
    const sph_executor executor = which == 2 ? test_executor_reverse() : test_executor_scattered();
    return which < 2 ? test_context_with_threads(which == 0 ? 1 : 3) : test_context_with_executor(&executor);
}

/* Nodes, spheres and simplices, not the container around them: that may change without a result changing. */
static uint64_t hash_hierarchy(const sph_hierarchy *h)
{
    const uint32_t collapses = sph_hierarchy_collapse_count(h);
    hash sum = new_hash();
    for (uint32_t t = 0; t < collapses; ++t) {
        float centers[FRAMES][3] = {{0}}, radii[FRAMES] = {0};
        sph_collapse collapse;
        ck_assert_int_eq(sph_hierarchy_collapse(h, t, &collapse), SPH_OK);
        ck_assert_int_eq(sph_hierarchy_sphere(h, collapse.node, centers[0], radii), SPH_OK);
        add_bytes(&sum, &collapse, sizeof collapse);
        add_bytes(&sum, centers, sizeof centers);
        add_bytes(&sum, radii, sizeof radii);
    }
    return sum.value;
}

typedef struct golden {
    const char *name;
    unsigned frames;
    int32_t radius_mode, importance;
    double coherence;
    uint64_t value;
} golden;

static const golden HIERARCHIES[] = {
    {"default", FRAMES, SPH_RADIUS_CONSTANT, SPH_IMPORTANCE_CURVATURE, 0, UINT64_C(0x5ad4d03c0a1abc54)},
    {"by area alone", FRAMES, SPH_RADIUS_CONSTANT, SPH_IMPORTANCE_NONE, 0, UINT64_C(0x170f28840e85db4d)},
    {"coherent", FRAMES, SPH_RADIUS_CONSTANT, SPH_IMPORTANCE_CURVATURE, 0.02, UINT64_C(0x77b7d870e5564705)},
    {"radii per frame", FRAMES, SPH_RADIUS_PER_FRAME, SPH_IMPORTANCE_CURVATURE, 0, UINT64_C(0xe07bbc100dc903f6)},
    {"points", FRAMES, SPH_RADIUS_ZERO, SPH_IMPORTANCE_CURVATURE, 0, UINT64_C(0x01164d55d66b7b37)},
    {"one frame", 1, SPH_RADIUS_CONSTANT, SPH_IMPORTANCE_CURVATURE, 0, UINT64_C(0x4f57a3428d06c4f1)},
    {"points of one frame", 1, SPH_RADIUS_ZERO, SPH_IMPORTANCE_NONE, 0, UINT64_C(0x29dce7be25b591cc)},
};
enum { HIERARCHY_COUNT = sizeof HIERARCHIES / sizeof *HIERARCHIES, CONTEXTS = 4 };

static sph_hierarchy *build(const sph_animation *animation, const golden *g)
{
    sph_hierarchy_options o;
    sph_hierarchy *h = NULL;
    sph_hierarchy_options_init(&o, sizeof o);
    o.radius_mode = g->radius_mode;
    o.importance = g->importance;
    o.temporal_coherence = g->coherence;
    ck_assert_int_eq(sph_hierarchy_create(animation, &o, &h), SPH_OK);
    return h;
}

static void expect(const char *name, uint64_t found, uint64_t golden_value)
{
    ck_assert_msg(found == golden_value, "%s: 0x%016" PRIx64 ", not 0x%016" PRIx64, name, found, golden_value);
}

START_TEST(hierarchies_are_the_same_everywhere)
{
    const golden *g = &HIERARCHIES[_i / CONTEXTS];
    sph_context *context = make_context(_i % CONTEXTS);
    sph_animation *animation = make_animation(context, g->frames);
    sph_hierarchy *h = build(animation, g);
    expect(g->name, hash_hierarchy(h), g->value);
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
    sph_context_destroy(context);
}
END_TEST

static uint64_t hash_queries(const sph_level *level)
{
    hash sum = new_hash();
    sph_query *query = NULL;
    ck_assert_int_eq(sph_query_create(level, NULL, &query), SPH_OK);
    ck_assert_int_eq(sph_query_pose_time(query, 1.25), SPH_OK);
    for (unsigned i = 0; i < 64; ++i) {
        double x, y;
        sph_sweep sweep = {.radius = (float)(i % 4) * 0.05F};
        sph_hit hit;
        sph_nearest nearest;
        circle(i, 64, &x, &y);
        sweep.from[0] = (float)(2 * x);
        sweep.from[1] = (float)(2 * y);
        sweep.to[1] = (float)(x * 0.7);
        sweep.to[2] = 0.1F;
        ck_assert_int_eq(sph_query_cast(query, &sweep, 1, &hit), SPH_OK);
        ck_assert_int_eq(sph_query_nearest(query, sweep.from, 0, 1, &nearest), SPH_OK);
        add_bytes(&sum, &hit.s, sizeof hit.s);
        add_bytes(&sum, hit.contact.normal, sizeof hit.contact.normal);
        add_bytes(&sum, &nearest.distance, sizeof nearest.distance);
    }
    sph_query_destroy(query);
    return sum.value;
}

static uint64_t hash_surface(const sph_level *level)
{
    hash sum = new_hash();
    sph_surface_options o;
    sph_surface *surface = NULL;
    sph_surface_options_init(&o, sizeof o);
    o.resolution = 24;
    o.frame_limit = 2;
    ck_assert_int_eq(sph_surface_create(level, &o, &surface), SPH_OK);
    for (uint32_t f = 0; f < 2; ++f) {
        add_bytes(&sum, sph_surface_positions(surface, f), 12 * (size_t)sph_surface_vertex_count(surface, f));
        add_bytes(&sum, sph_surface_triangles(surface, f), 12 * sph_surface_triangle_count(surface, f));
    }
    sph_surface_destroy(surface);
    return sum.value;
}

START_TEST(what_levels_are_asked_has_the_same_answer_everywhere)
{
    sph_context *context = make_context(_i);
    sph_animation *animation = make_animation(context, FRAMES);
    sph_hierarchy *h = build(animation, &HIERARCHIES[0]);
    sph_level *level = NULL;
    ck_assert_int_eq(sph_level_create(h, 20, &level), SPH_OK);
    expect("queries", hash_queries(level), UINT64_C(0x1c06402c32c73424));
    expect("surface", hash_surface(level), UINT64_C(0x22b7d07fb7730546));
    sph_level_destroy(level);
    sph_hierarchy_destroy(h);
    sph_animation_destroy(animation);
    sph_context_destroy(context);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("golden");
    TCase *tc = tcase_create("golden");
    tcase_add_loop_test(tc, hierarchies_are_the_same_everywhere, 0, HIERARCHY_COUNT * CONTEXTS);
    tcase_add_loop_test(tc, what_levels_are_asked_has_the_same_answer_everywhere, 0, CONTEXTS);
    return run_suite(suite, tc);
}
