/* SPDX-License-Identifier: MIT */
/*
 * What many casts are sieved by never loses one that touches: against samples of the distance to every primitive along
 * the segment. Segments pass the surface or end at it, at all scales, near the origin and far from it, some of them
 * long.
 */
#include <check.h>
#include <math.h>
#include <string.h>

#include "query/query.h"
#include "query/sieve.h"
#include "runner.h"
#include "support.h"

enum { SPHERES = 60, TRIANGLES = 40, SWEEPS = SPH__QUERY_SIEVED, TURNS = 25, SAMPLES = 32 };

static sph_context *context;
static uint64_t state;
static float centers[SPHERES][3], radii[SPHERES];
static uint32_t triangles[TRIANGLES][3];
static sph_sweep sweeps[SWEEPS];

static const struct {
    double scale, far;
} PLACES[] = {{1, 0}, {1, 1e4}, {1e-3, 1e3}, {1e-38, 0}, {1e36, 0}, {1e-42, 1e-40}};

static double between(double low, double high)
{
    return low + (high - low) * test_random_unit(&state);
}

static sph_query *random_query(double scale, double far)
{
    const sph_level_arrays arrays = {.struct_size = sizeof arrays,
                                     .sphere_count = SPHERES,
                                     .frame_count = 1,
                                     .centers = centers[0],
                                     .radii = radii,
                                     .triangle_count = TRIANGLES,
                                     .triangles = triangles[0]};
    sph_level *level = NULL;
    sph_query *q = NULL;
    for (uint32_t i = 0; i < SPHERES; ++i) {
        for (int k = 0; k < 3; ++k)
            centers[i][k] = (float)(far * (k + 1) + scale * (i / 10 + between(0, 1)) * (k == 0 ? 1 : 0.5));
        radii[i] = (float)(scale * between(0, 0.2));
    }
    for (uint32_t i = 0; i < TRIANGLES; ++i)
        for (uint32_t k = 0; k < 3; ++k)
            triangles[i][k] = i + k * 3;
    ck_assert_int_eq(sph_level_create_from_arrays(context, &arrays, &level), SPH_OK);
    ck_assert_int_eq(sph_query_create(level, NULL, &q), SPH_OK);
    sph_level_destroy(level);
    return q;
}

/* Ends at the surface of a primitive, or passes it; short, long or very long. */
static void random_sweep(const sph_query *q, sph_sweep *w)
{
    const sph__primitive *p = &q->solid.primitives[test_random(&state) % q->primitive_count];
    const double length = pow(10, between(-4, test_random(&state) % 8 == 0 ? 4 : 1)), before = between(0, 1);
    sph__contact c;
    double x[3], d[3], r = test_random(&state) % 2 ? 0 : between(0, 0.1);
    for (int k = 0; k < 3; ++k) {
        x[k] = between(-1, 1);
        d[k] = between(-1, 1);
    }
    sph__primitive_closest(p, x, &c);
    for (int k = 0; k < 3; ++k) {
        x[k] = c.point[k] + (r + between(-1e-5, 1e-3)) * c.normal[k];
        w->from[k] = (float)((x[k] - (test_random(&state) % 2 ? 1 : before) * length * d[k]) * q->unit + q->origin[k]);
        w->to[k] =
            (float)((x[k] + (test_random(&state) % 2 ? 0 : 1 - before) * length * d[k]) * q->unit + q->origin[k]);
    }
    w->radius = (float)(r * q->unit);
    w->reserved0 = 0;
}

static bool touches(const sph_query *q, const sph__primitive *p, const sph_sweep *w)
{
    for (int i = 0; i <= SAMPLES; ++i) {
        double x[3];
        for (int k = 0; k < 3; ++k) {
            const double from = (w->from[k] - q->origin[k]) * q->scale, to = (w->to[k] - q->origin[k]) * q->scale;
            x[k] = from + (to - from) * i / SAMPLES;
        }
        if (sph__primitive_distance(p, x) <= w->radius * q->scale) return true;
    }
    return false;
}

/* The leaves whose primitives a sweep touches, as bits. */
static uint32_t touched_leaves(const sph_query *q, const sph_sweep *w)
{
    uint32_t bits = 0;
    for (uint32_t leaf = 0; leaf < q->leaf_count; ++leaf)
        for (uint32_t slot = q->twigs[2 * leaf]; slot < q->twigs[2 * leaf + 2]; ++slot)
            if (touches(q, &q->solid.primitives[slot], w)) bits |= 1u << leaf;
    return bits;
}

START_TEST(what_touches_a_leaf_is_never_sieved_out)
{
    size_t touched = 0, left = 0;
    for (int turn = 0; turn < TURNS; ++turn) {
        const uint32_t first = turn % 2 ? 0 : 5, count = turn % 3 ? SWEEPS - 5 : 1 + (uint32_t)turn;
        sph_query *q = random_query(PLACES[_i].scale, PLACES[_i].far);
        sph__query_room room = {.scale = q->scale};
        sph__query_sieved sieved;
        uint32_t next = 0;
        memcpy(room.origin, q->origin, sizeof room.origin);
        memcpy(room.half, q->half, sizeof room.half);
        for (uint32_t i = 0; i < SWEEPS; ++i)
            random_sweep(q, &sweeps[i]);
        sph__query_sieve(&sieved, &room, sweeps, first, count, q->twig_boxes, q->leaf_count);
        for (uint32_t i = first; i < first + count; ++i) {
            const uint32_t bits = touched_leaves(q, &sweeps[i]);
            uint32_t found = 0;
            if (next < sieved.count && sieved.which[next] == i) found = sieved.leaves[next++];
            ck_assert_msg((bits & ~found) == 0, "sweep %u: touches %x, not %x", (unsigned)i, (unsigned)bits,
                          (unsigned)found);
            touched += (size_t)__builtin_popcount(bits);
            left += (size_t)__builtin_popcount(found);
        }
        ck_assert_uint_eq(next, sieved.count);
        sph_query_destroy(q);
    }
    ck_assert_uint_gt(touched, 500);
    if (PLACES[_i].scale > 1e-30 && PLACES[_i].scale < 1e30) ck_assert_uint_lt(left, 3 * touched);
}
END_TEST

static void setup(void)
{
    context = test_context();
    state = 20160301;
}

static void teardown(void)
{
    sph_context_destroy(context);
}

int main(void)
{
    Suite *s = suite_create("query_sieve");
    TCase *tc = tcase_create("query_sieve");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, what_touches_a_leaf_is_never_sieved_out, 0, sizeof PLACES / sizeof *PLACES);
    return run_suite(s, tc);
}
