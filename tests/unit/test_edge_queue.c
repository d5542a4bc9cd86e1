/* SPDX-License-Identifier: MIT */
#include <check.h>
#include <math.h>

#include "hierarchy/edge_queue.h"
#include "runner.h"
#include "support.h"

/* More edges than the queue sorts at once. */
enum { VERTICES = 12000, EDGES = 2 * VERTICES - 3, LOOK_EVERY = 24 };

static sph_context *context;
static sph__connectivity mesh;
static sph__edge_queue queue;
static double expected[EDGES]; /* what each edge costs; -1: taken, -2: refused */
static uint64_t state;

/* Vertices in a row, each joined to the next two. */
static void setup(void)
{
    static uint32_t edges[EDGES][2];
    uint32_t count = 0;
    for (uint32_t i = 0; i < VERTICES; ++i)
        for (uint32_t k = 1; k < 3 && i + k < VERTICES; ++k) {
            edges[count][0] = i;
            edges[count++][1] = i + k;
        }
    state = 88172645463325252u;
    ck_assert_uint_eq(count, EDGES);
    ck_assert_int_eq(sph_context_create(NULL, &context), SPH_OK);
    ck_assert_int_eq(sph__connectivity_init(&mesh, context, VERTICES, NULL, 0, edges[0], EDGES, false, NULL), SPH_OK);
    ck_assert_uint_eq(mesh.edge_count, EDGES);
    sph__edge_queue_init(&queue, context);
    ck_assert_int_eq(sph__edge_queue_reserve(&queue, &mesh), SPH_OK);
}

static void teardown(void)
{
    sph__edge_queue_free(&queue);
    sph__connectivity_free(&mesh);
    sph_context_destroy(context);
}

/* One in so many is zero, infinite or no number; of the others many are equal. */
static double random_cost(unsigned rare)
{
    static const double special[] = {0, 0, INFINITY, (double)NAN};
    const uint64_t dice = test_random(&state);
    return dice % rare == 0 ? special[dice / rare % 4] : (double)(test_random(&state) % 5000) * 1e-3;
}

static void set(uint32_t edge, double cost)
{
    sph__edge_queue_set(&queue, &mesh, edge, cost);
    expected[edge] = cost;
}

static bool comes_before(uint32_t a, uint32_t b)
{
    const double x = expected[a], y = expected[b];
    uint32_t ends[2][2];
    if (isnan(x) != isnan(y)) return isnan(y);
    if (!isnan(x) && x != y) return x < y;
    sph__edge_ends(&mesh, a, &ends[0][0], &ends[0][1]);
    sph__edge_ends(&mesh, b, &ends[1][0], &ends[1][1]);
    return ends[0][0] != ends[1][0] ? ends[0][0] < ends[1][0] : ends[0][1] < ends[1][1];
}

static uint32_t first_of_all(void)
{
    uint32_t best = UINT32_MAX;
    for (uint32_t e = 0; e < EDGES; ++e)
        if (!(expected[e] < 0) && (best == UINT32_MAX || comes_before(e, best))) best = e;
    return best;
}

/* Takes all edges while others get other costs or are refused; 1 in `rare` costs is no plain number. */
static void take_all(unsigned rare)
{
    uint32_t edge, taken = 0, refused = 0;
    for (uint32_t e = 0; e < EDGES; ++e) set(e, random_cost(rare));
    while (sph__edge_queue_top(&queue, &mesh, &edge)) {
        const uint32_t other = (uint32_t)(test_random(&state) % EDGES);
        if (taken++ % LOOK_EVERY == 0) ck_assert_uint_eq(edge, first_of_all());
        ck_assert(!(expected[edge] < 0));
        sph__edge_queue_take(&queue, &mesh, edge);
        expected[edge] = SPH__NO_COST;
        if (taken % 7 == 0) {
            ck_assert_int_eq(sph__edge_queue_refuse(&queue, &mesh, edge, random_cost(2)), SPH_OK);
            expected[edge] = SPH__REFUSED;
        }
        if (taken < EDGES && (!(expected[other] < 0) || taken % 3 == 0)) set(other, random_cost(rare));
    }
    ck_assert_uint_eq(first_of_all(), UINT32_MAX);
    while (sph__edge_queue_pop_refused(&queue, &edge)) {
        ck_assert(expected[edge] < SPH__NO_COST);
        expected[edge] = SPH__NO_COST;
        ++refused;
    }
    for (uint32_t e = 0; e < EDGES; ++e) ck_assert(expected[e] < 0 && expected[e] >= SPH__NO_COST);
    ck_assert_uint_gt(refused, 100);
}

START_TEST(the_cheapest_edge_is_what_a_search_of_all_finds)
{
    static const unsigned RARE[] = {20, 1, 1000000};
    take_all(RARE[_i]);
}
END_TEST

START_TEST(edges_that_are_gone_never_come_up)
{
    uint32_t edge, count = 0;
    for (uint32_t e = 0; e < EDGES; ++e) set(e, random_cost(50));
    for (uint32_t round = 0; round < 4; ++round) {
        uint32_t gone[500];
        for (uint32_t i = 0; i < 500; ++i) {
            gone[i] = (uint32_t)(test_random(&state) % EDGES);
            expected[gone[i]] = SPH__GONE;
        }
        mesh.removed = gone;
        mesh.removed_count = 500;
        sph__edge_queue_forget(&queue, &mesh);
        mesh.removed = NULL;
        for (uint32_t i = 0; i < 3000 && sph__edge_queue_top(&queue, &mesh, &edge); ++i) {
            ck_assert(!(expected[edge] < 0));
            sph__edge_queue_take(&queue, &mesh, edge);
            expected[edge] = SPH__NO_COST;
            ++count;
        }
    }
    ck_assert_uint_eq(count, 12000);
    ck_assert(sph__edge_queue_top(&queue, &mesh, &edge));
    ck_assert_uint_eq(edge, first_of_all());
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("edge_queue");
    TCase *tests = tcase_create("edge_queue");
    tcase_add_checked_fixture(tests, setup, teardown);
    tcase_add_loop_test(tests, the_cheapest_edge_is_what_a_search_of_all_finds, 0, 3);
    tcase_add_test(tests, edges_that_are_gone_never_come_up);
    return run_suite(suite, tests);
}
