/* SPDX-License-Identifier: MIT */
/*
 * The library's hierarchy against the reference, collapse by collapse, on small meshes of every awkward kind.
 *
 * The library keeps quadrics in 32 bits, so a cost is known to a few units of 1e-7 of weight times squared extent of
 * the region, and no better: two edges whose costs differ by less may come in either order. The reference then follows
 * the library's choice, so that everything after is compared as well; the tests demand that this is rare where the mesh
 * is not flat. In the same way a centre may slide where the quadric does not hold it: it must cost as little, and the
 * reference goes on from there.
 */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hierarchy/hierarchy.h"
#include "runner.h"
#include "support.h"
#include "variants.h"

enum { VARIANTS = 20 };

/* Relative precision of costs; and what of weight * extent^2 they cannot resolve. */
static const double PRECISION = 1e-5, RESOLUTION = 1e-6;
/* Order may differ only where costs differ by less than this, relatively (or by what cannot be resolved). */
static const double NEAR_TIE = 1e-6;
/* Centres and radii, relative to the region's extent. */
static const double CLOSE = 1e-3;
/* A triangle's turn this close to zero may be judged either way: an area of nearly nothing enters by its root. */
static const double NEAR_TURN = 1e-4;

struct tally {
    size_t collapses, near_ties, unresolved_ties, near_turns, slides, forced;
};

static void read_sphere(const sph_hierarchy *hierarchy, uint32_t node, uint32_t frame_count,
                        struct reference_sphere *sphere)
{
    float *centers = test_malloc(frame_count, 3 * sizeof *centers), *radii = test_malloc(frame_count, sizeof *radii);
    ck_assert_int_eq(sph_hierarchy_sphere(hierarchy, node, centers, radii), SPH_OK);
    for (uint32_t f = 0; f < frame_count; ++f) {
        for (int i = 0; i < 3; ++i)
            sphere->centers[f][i] = centers[3 * f + (uint32_t)i];
        sphere->radii[f] = radii[f];
    }
    free(centers);
    free(radii);
}

/* Largest difference between two spheres over all frames. */
static double sphere_distance(const struct reference_sphere *a, const struct reference_sphere *b, uint32_t frame_count)
{
    double most = 0;
    for (uint32_t f = 0; f < frame_count; ++f) {
        for (int i = 0; i < 3; ++i)
            most = fmax(most, fabs(a->centers[f][i] - b->centers[f][i]));
        most = fmax(most, fabs(a->radii[f] - b->radii[f]));
    }
    return most;
}

struct comparison {
    const struct case_mesh *mesh;
    const struct reference_input *input;
    struct reference *reference;
    const sph_hierarchy *hierarchy;
    struct tally *tally;
    double *blurs; /* of the nodes so far */
    char name[160];
};

/* What the cost of an edge is known to in 32 bits, see the top; what was lost before stays lost. */
static double resolution(const struct comparison *c, const struct reference_edge *edge)
{
    const uint32_t frame_count = c->input->frame_count;
    const struct reference_sphere *u = reference_node(c->reference, edge->u),
                                  *v = reference_node(c->reference, edge->v);
    const double weight =
        reference_weight(c->reference, edge->u, edge->v) + reference_coherence_weight(c->reference, edge->u, edge->v);
    const double spread = fmax(sphere_distance(u, v, frame_count), sphere_distance(u, &edge->sphere, frame_count));
    const double size = fmax(reference_extent(c->reference, edge->u, edge->v), spread);
    return RESOLUTION * weight * size * size + c->blurs[edge->u] + c->blurs[edge->v];
}

/* The library refuses as the reference does, but where a turn is too close to call. */
static void check_turn(const struct comparison *c, const struct reference_edge *edge, const sph_collapse *collapse,
                       const struct reference_sphere *sphere, bool forced)
{
    const double turn = reference_least_turn(c->reference, edge->u, edge->v, sphere);
    ck_assert_msg(collapse->forced != 0 ? turn < NEAR_TURN : turn > -NEAR_TURN,
                  "%s: node %u (%u and %u): forced is %u, turn %g", c->name, collapse->node, edge->u, edge->v,
                  collapse->forced, turn);
    ck_assert_msg(forced == (collapse->forced != 0) || fabs(turn) < NEAR_TURN,
                  "%s: node %u (%u and %u): forced is %u, should be %d, turn %g", c->name, collapse->node, edge->u,
                  edge->v, collapse->forced, forced, turn);
    c->tally->near_turns += forced != (collapse->forced != 0);
}

/* The reference's edge for what the library collapsed; where that is not its own choice, it must be as good. */
static const struct reference_edge *matching_edge(const struct comparison *c, const sph_collapse *collapse,
                                                  const struct reference_sphere *sphere)
{
    bool forced;
    const struct reference_edge *own = reference_next(c->reference, &forced), *edge;
    ck_assert_msg(own != NULL, "%s: collapse %u too many", c->name, collapse->node - c->mesh->vertex_count);
    edge = reference_find(c->reference, collapse->u, collapse->v);
    ck_assert_msg(edge != NULL, "%s: node %u unites %u and %u, which share no edge", c->name, collapse->node,
                  collapse->u, collapse->v);
    check_turn(c, edge, collapse, sphere, edge->refused && own->refused ? forced : false);
    if (edge != own) {
        const double blur = resolution(c, own) + resolution(c, edge), difference = fabs(edge->cost - own->cost);
        const double own_turn = reference_least_turn(c->reference, own->u, own->v, &own->sphere);
        const bool near_tie = difference <= NEAR_TIE * own->cost, unresolved = difference <= blur;
        /* refused here and now, but not with the library's sphere, which compare_collapse() finds to be as good */
        const bool other_turn =
            edge->refused && reference_least_turn(c->reference, edge->u, edge->v, &edge->sphere) < 0;
        const bool near_turn = fabs(own_turn) < NEAR_TURN || (other_turn && collapse->forced == 0);
        ck_assert_msg(near_tie || unresolved || near_turn,
                      "%s: node %u unites %u and %u (cost %.9g, refused %d; library's cost %.9g, forced %u), "
                      "not %u and %u (cost %.9g, turn %.3g, refused %d), blur %.3g",
                      c->name, collapse->node, edge->u, edge->v, edge->cost, edge->refused, collapse->cost,
                      collapse->forced, own->u, own->v, own->cost, own_turn, own->refused, blur);
        if (near_tie)
            ++c->tally->near_ties;
        else if (unresolved)
            ++c->tally->unresolved_ties;
        else
            ++c->tally->near_turns;
    }
    return edge;
}

/* In degenerate frames the centre is on the segment, everywhere at the same place. */
static void check_segment(const struct comparison *c, const struct reference_edge *edge,
                          const struct reference_sphere *sphere)
{
    const struct reference_sphere *u = reference_node(c->reference, edge->u),
                                  *v = reference_node(c->reference, edge->v);
    const bool per_frame = c->input->radius_mode == REFERENCE_RADIUS_PER_FRAME;
    const double extent = reference_extent(c->reference, edge->u, edge->v);
    double along = 0, square = 0, lambda = 0;
    for (int pass = 0; pass < 2; ++pass)
        for (uint32_t f = 0; f < c->input->frame_count; ++f) {
            if (!reference_is_degenerate(c->reference, edge->u, edge->v, f)) continue;
            if (per_frame) along = square = 0;
            for (int i = 0; i < 3 && (pass == 0 || per_frame); ++i) {
                const double d = v->centers[f][i] - u->centers[f][i];
                along += d * (sphere->centers[f][i] - u->centers[f][i]);
                square += d * d;
            }
            lambda = square > 0 ? fmin(fmax(along / square, 0), 1) : 0;
            for (int i = 0; i < 3 && pass == 1; ++i) {
                const double at = u->centers[f][i] + lambda * (v->centers[f][i] - u->centers[f][i]);
                ck_assert_msg(fabs(sphere->centers[f][i] - at) < CLOSE * extent,
                              "%s: node of %u and %u is off its segment by %g (extent %g) in the degenerate frame %u",
                              c->name, edge->u, edge->v, sphere->centers[f][i] - at, extent, f);
            }
        }
}

static void compare_collapse(const struct comparison *c, uint32_t index, double *error)
{
    const uint32_t frame_count = c->input->frame_count;
    struct reference_sphere sphere = {test_malloc(frame_count, sizeof *sphere.centers),
                                      test_malloc(frame_count, sizeof *sphere.radii)};
    struct reference_collapse done;
    const struct reference_edge *edge;
    sph_collapse collapse;
    double blur, extent, distance, cost;
    size_t degenerate_frames;
    bool slid;
    ck_assert_int_eq(sph_hierarchy_collapse(c->hierarchy, index, &collapse), SPH_OK);
    ck_assert_uint_eq(collapse.node, c->mesh->vertex_count + index);
    read_sphere(c->hierarchy, collapse.node, frame_count, &sphere);
    edge = matching_edge(c, &collapse, &sphere);
    ck_assert_uint_eq(collapse.u, edge->u);
    ck_assert_uint_eq(collapse.v, edge->v);
    blur = resolution(c, edge);
    degenerate_frames = edge->degenerate_frames;
    extent = reference_extent(c->reference, edge->u, edge->v);
    for (uint32_t f = 0; f < frame_count; ++f)
        ck_assert_double_le(sphere.radii[f], reference_radius_bound(c->reference, edge->u, edge->v, f) + 1e-6 * extent);
    check_segment(c, edge, &sphere);
    cost = reference_cost(c->reference, edge->u, edge->v, &sphere);
    ck_assert_msg(
        fabs(cost - edge->cost) <= PRECISION * edge->cost + blur,
        "%s: the sphere of node %u (%u and %u) costs %.9g, not %.9g (off by %.3g; blur %.3g; %zu of %u frames "
        "degenerate)",
        c->name, collapse.node, edge->u, edge->v, cost, edge->cost, cost - edge->cost, blur, edge->degenerate_frames,
        frame_count);
    distance = sphere_distance(&sphere, &edge->sphere, frame_count);
    slid = distance > CLOSE * extent;
    reference_collapse(c->reference, edge->u, edge->v, collapse.forced != 0, slid ? &sphere : NULL, &done);
    ck_assert_msg(fabs(collapse.cost - done.cost) <= PRECISION * done.cost + blur,
                  "%s: node %u (%u and %u) costs %.9g, not %.9g (off by %.3g; blur %.3g; %zu of %u frames degenerate)",
                  c->name, collapse.node, done.u, done.v, collapse.cost, done.cost, collapse.cost - done.cost, blur,
                  degenerate_frames, frame_count);
    ck_assert_msg(fabs(collapse.error - done.error) <=
                      1e-4 * done.error + 1e-4 * sph_hierarchy_bounding_diagonal(c->hierarchy),
                  "%s: node %u: error %.9g, not %.9g", c->name, collapse.node, collapse.error, done.error);
    ck_assert_double_ge(collapse.error, *error);
    *error = collapse.error;
    c->blurs[collapse.node] = blur;
    ++c->tally->collapses;
    c->tally->slides += slid;
    c->tally->forced += collapse.forced;
    reference_collapse_free(&done);
    free(sphere.centers);
    free(sphere.radii);
}

static bool reference_has_triangle(const struct reference *reference, const uint32_t *corners)
{
    for (size_t t = 0; t < reference_triangle_count(reference); ++t) {
        const uint32_t *x = reference_triangle(reference, t);
        int same = 0;
        for (int i = 0; i < 3; ++i)
            same += corners[i] == x[0] || corners[i] == x[1] || corners[i] == x[2];
        if (same == 3) return true;
    }
    return false;
}

static bool is_wire(const struct reference *reference, const struct reference_edge *edge)
{
    for (size_t t = 0; t < reference_triangle_count(reference); ++t) {
        const uint32_t *x = reference_triangle(reference, t);
        int ends = 0;
        for (int i = 0; i < 3; ++i)
            ends += x[i] == edge->u || x[i] == edge->v;
        if (ends == 2) return false;
    }
    return true;
}

/* The level after so many collapses has the reference's triangles and wire edges: as many, and each of them. */
static void compare_mesh(const struct comparison *c, sph_cursor *cursor, uint32_t collapses)
{
    size_t wires = 0;
    uint32_t *nodes, *edges, *triangles;
    ck_assert_int_eq(sph_cursor_move(cursor, c->mesh->vertex_count - collapses), SPH_OK);
    for (size_t e = 0; e < reference_edge_count(c->reference); ++e)
        wires += is_wire(c->reference, reference_edge(c->reference, e));
    ck_assert_msg(sph_cursor_edge_count(cursor) == wires &&
                      sph_cursor_triangle_count(cursor) == reference_triangle_count(c->reference),
                  "%s: after %u collapses %zu wire edges and %zu triangles, not %zu and %zu", c->name, collapses,
                  sph_cursor_edge_count(cursor), sph_cursor_triangle_count(cursor), wires,
                  reference_triangle_count(c->reference));
    if (collapses % 8 != 0) return;
    nodes = test_malloc(c->mesh->vertex_count, sizeof *nodes);
    edges = test_malloc(wires + 1, 2 * sizeof *edges);
    triangles = test_malloc(reference_triangle_count(c->reference) + 1, 3 * sizeof *triangles);
    ck_assert_int_eq(sph_cursor_read(cursor, nodes, edges, triangles), SPH_OK);
    for (size_t e = 0; e < wires; ++e) {
        const struct reference_edge *edge = reference_find(c->reference, edges[2 * e], edges[2 * e + 1]);
        ck_assert_msg(edge != NULL && is_wire(c->reference, edge), "%s: wire %u %u", c->name, edges[2 * e],
                      edges[2 * e + 1]);
    }
    for (size_t t = 0; t < sph_cursor_triangle_count(cursor); ++t)
        ck_assert_msg(reference_has_triangle(c->reference, triangles + 3 * t), "%s: triangle %u %u %u", c->name,
                      triangles[3 * t], triangles[3 * t + 1], triangles[3 * t + 2]);
    free(nodes);
    free(edges);
    free(triangles);
}

static void compare(enum case_shape shape, const struct variant *variant, uint64_t seed, struct tally *tally)
{
    struct case_mesh mesh;
    struct reference_input input;
    struct comparison c = {.mesh = &mesh, .input = &input, .tally = tally};
    sph_hierarchy_options options;
    sph_context *context = test_context();
    sph_animation *animation;
    sph_hierarchy *hierarchy;
    sph_cursor *cursor;
    double(*directions)[3] = test_malloc(variant->width_directions, sizeof *directions), error = 0;
    float *importance;
    bool forced;

    case_create(&mesh, shape, variant->motion, variant->frame_count, seed);
    snprintf(c.name, sizeof c.name, "%s, radius %d * %g, coherence %g, importance %d", mesh.name,
             (int)variant->radius_mode, variant->radius_factor, variant->temporal_coherence, (int)variant->importance);
    importance = make_importance(&mesh, variant->importance, seed + 77);
    sph__width_directions(variant->width_directions, directions);
    input = make_input(variant, &mesh, importance, directions[0]);
    options = make_options(variant, &mesh, importance);
    animation = make_animation(context, &mesh);
    ck_assert_int_eq(sph_hierarchy_create(animation, &options, &hierarchy), SPH_OK);
    ck_assert_uint_eq(sph_hierarchy_collapse_count(hierarchy), mesh.vertex_count - mesh.components);

    c.hierarchy = hierarchy;
    c.reference = reference_create(&input);
    c.blurs = calloc(2 * mesh.vertex_count, sizeof *c.blurs);
    ck_assert_ptr_nonnull(c.blurs);
    ck_assert_int_eq(sph_cursor_create(hierarchy, &cursor), SPH_OK);
    compare_mesh(&c, cursor, 0);
    for (uint32_t t = 0; t < sph_hierarchy_collapse_count(hierarchy); ++t) {
        compare_collapse(&c, t, &error);
        compare_mesh(&c, cursor, t + 1);
    }
    ck_assert_ptr_null(reference_next(c.reference, &forced));

    reference_destroy(c.reference);
    sph_cursor_destroy(cursor);
    sph_hierarchy_destroy(hierarchy);
    sph_animation_destroy(animation);
    sph_context_destroy(context);
    case_free(&mesh);
    free(importance);
    free(directions);
    free(c.blurs);
}

static void add_tally(struct tally *to, const struct tally *tally)
{
    to->collapses += tally->collapses;
    to->near_ties += tally->near_ties;
    to->unresolved_ties += tally->unresolved_ties;
    to->near_turns += tally->near_turns;
    to->slides += tally->slides;
    to->forced += tally->forced;
}

static void print_tally(const char *what, int shape, const struct tally *tally)
{
    if (getenv("SPHMESH_TALLY") == NULL) return;
    fprintf(
        stderr,
        "# shape %2d, %s: %4zu collapses, %2zu near ties, %3zu unresolved, %zu near turns, %3zu slides, %zu forced\n",
        shape, what, tally->collapses, tally->near_ties, tally->unresolved_ties, tally->near_turns, tally->slides,
        tally->forced);
}

START_TEST(library_and_reference_collapse_alike)
{
    const enum case_shape shape = (enum case_shape)_i;
    /* Lone triangles and twins make many edges that cost nothing, and so does what is flat and moves rigidly. */
    const bool is_tied = shape == CASE_FANS || shape == CASE_SOUP || shape == CASE_DUPLICATES;
    struct tally flat = {0}, curved = {0};
    for (unsigned index = 0; index < VARIANTS; ++index) {
        const struct variant variant = make_variant(shape, index);
        struct tally tally = {0};
        compare(shape, &variant, index, &tally);
        add_tally(is_tied || variant.motion == CASE_RIGID ? &flat : &curved, &tally);
    }
    print_tally("flat", _i, &flat);
    print_tally("curved", _i, &curved);
    ck_assert_uint_le(50 * curved.near_ties, curved.collapses + 50);
    ck_assert_uint_le(20 * curved.unresolved_ties, curved.collapses + 20);
    ck_assert_uint_le(20 * curved.slides, curved.collapses + 20);
    ck_assert_uint_le(100 * (flat.near_turns + curved.near_turns), flat.collapses + curved.collapses + 100);
}
END_TEST

/* Found by searching through 36,000 tetrahedra that tumble: only now and then do all edges invert. */
static const struct {
    uint32_t frame_count;
    uint64_t seed;
} FORCED[6] = {{2, 711}, {2, 1117}, {2, 845}, {2, 949}, {3, 590}, {3, 2400}};

START_TEST(cheapest_edge_is_forced_where_all_invert)
{
    const struct variant variant = {.motion = CASE_TUMBLE,
                                    .frame_count = FORCED[_i].frame_count,
                                    .importance = EXTREME,
                                    .radius_mode = REFERENCE_RADIUS_CONSTANT,
                                    .radius_factor = 0.75,
                                    .width_directions = 7};
    struct tally tally = {0};
    compare(CASE_TETRAHEDRON, &variant, FORCED[_i].seed, &tally);
    ck_assert_uint_eq(tally.forced, 1);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("hierarchy against reference");
    TCase *tcase = tcase_create("hierarchy against reference");
    tcase_set_timeout(tcase, 60);
    tcase_add_loop_test(tcase, library_and_reference_collapse_alike, 0, CASE_SHAPE_COUNT);
    tcase_add_loop_test(tcase, cheapest_edge_is_forced_where_all_invert, 0, 6);
    return run_suite(suite, tcase);
}
