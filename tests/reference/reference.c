/* SPDX-License-Identifier: MIT */
#include "reference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "reference_region.h"

typedef reference_real real;

struct reference {
    const struct reference_input *input;
    size_t node_count; /* made so far */
    struct region *nodes;
    size_t edge_count;
    struct reference_edge *edges; /* alive, in no order */
    size_t edge_capacity;
    size_t triangle_count;
    uint32_t (*triangles)[3]; /* alive */
    double largest_error;
};

static bool same_triangle(const uint32_t *a, const uint32_t *b)
{
    for (int i = 0; i < 3; ++i)
        if (a[i] != b[0] && a[i] != b[1] && a[i] != b[2]) return false;
    return true;
}

/* Of triangles with the same corners the first stays; those that name a corner twice go. */
static void drop_degenerate_triangles(struct reference *reference)
{
    size_t kept = 0;
    for (size_t t = 0; t < reference->triangle_count; ++t) {
        const uint32_t *corners = reference->triangles[t];
        bool drop = corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0];
        for (size_t s = 0; s < kept && !drop; ++s)
            drop = same_triangle(corners, reference->triangles[s]);
        if (!drop) memmove(reference->triangles[kept++], corners, sizeof *reference->triangles);
    }
    reference->triangle_count = kept;
}

static struct reference_edge *find_edge(const struct reference *reference, uint32_t u, uint32_t v)
{
    for (size_t e = 0; e < reference->edge_count; ++e) {
        struct reference_edge *edge = &reference->edges[e];
        if ((edge->u == u && edge->v == v) || (edge->u == v && edge->v == u)) return edge;
    }
    return NULL;
}

static void add_edge(struct reference *reference, uint32_t a, uint32_t b)
{
    const struct reference_input *input = reference->input;
    struct reference_edge edge = {.u = a < b ? a : b, .v = a < b ? b : a};
    struct region united, *u = &reference->nodes[edge.u], *v = &reference->nodes[edge.v];
    if (a == b || find_edge(reference, a, b) != NULL) return;
    reference_sphere_create(&edge.sphere, input->frame_count);
    region_unite(&united, u, v, input);
    edge.cost = (double)region_fit(&united, input, &u->sphere, &v->sphere, &edge.sphere, &edge.degenerate_frames);
    region_free(&united);
    if (reference->edge_count == reference->edge_capacity) {
        reference->edge_capacity = 2 * reference->edge_capacity + 16;
        reference->edges = realloc(reference->edges, reference->edge_capacity * sizeof edge);
        if (reference->edges == NULL) abort();
    }
    reference->edges[reference->edge_count++] = edge;
}

struct reference *reference_create(const struct reference_input *input)
{
    struct reference *reference = reference_allocate(1, sizeof *reference);
    const size_t n = input->vertex_count;
    reference->input = input;
    reference->nodes = reference_allocate(2 * n, sizeof *reference->nodes);
    reference->node_count = n;
    for (uint32_t i = 0; i < n; ++i)
        region_create_leaf(&reference->nodes[i], input, i);
    for (size_t t = 0; t < input->triangle_count; ++t)
        for (int i = 0; i < 3; ++i)
            add_edge(reference, input->triangles[3 * t + i], input->triangles[3 * t + (i + 1) % 3]);
    for (size_t e = 0; e < input->edge_count; ++e)
        add_edge(reference, input->edges[2 * e], input->edges[2 * e + 1]);
    reference->triangle_count = input->triangle_count;
    reference->triangles = reference_allocate(input->triangle_count, sizeof *reference->triangles);
    if (input->triangle_count > 0)
        memcpy(reference->triangles, input->triangles, input->triangle_count * sizeof *reference->triangles);
    drop_degenerate_triangles(reference);
    return reference;
}

void reference_destroy(struct reference *reference)
{
    if (reference == NULL) return;
    for (size_t e = 0; e < reference->edge_count; ++e)
        reference_sphere_free(&reference->edges[e].sphere);
    for (size_t i = 0; i < reference->node_count; ++i)
        region_free(&reference->nodes[i]);
    free(reference->triangles);
    free(reference->edges);
    free(reference->nodes);
    free(reference);
}

static void cross_of(double (*const corners[3])[3], uint32_t frame, real out[3])
{
    const double *a = corners[0][frame], *b = corners[1][frame], *c = corners[2][frame];
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = ((real)b[j] - a[j]) * ((real)c[k] - a[k]) - ((real)b[k] - a[k]) * ((real)c[j] - a[j]);
    }
}

static real length(const real a[3])
{
    return sqrtl(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

static real longest_side(double (*const corners[3])[3], uint32_t frame)
{
    real longest = 0;
    for (int i = 0; i < 3; ++i) {
        const double *a = corners[i][frame], *b = corners[(i + 1) % 3][frame];
        const real d[3] = {(real)b[0] - a[0], (real)b[1] - a[1], (real)b[2] - a[2]};
        longest = fmaxl(longest, length(d));
    }
    return longest;
}

/* sum_f sqrt(area area') n.n' of a triangle whose corner at u or v moves to `sphere`, over the sum of longest sides
 * before and after, multiplied. */
static real turn_of(const struct reference *reference, const uint32_t *triangle, uint32_t u, uint32_t v,
                    const struct reference_sphere *sphere)
{
    double(*before[3])[3], (*after[3])[3];
    real sum = 0, scale = 0;
    for (int i = 0; i < 3; ++i) {
        before[i] = reference->nodes[triangle[i]].sphere.centers;
        after[i] = triangle[i] == u || triangle[i] == v ? sphere->centers : before[i];
    }
    for (uint32_t f = 0; f < reference->input->frame_count; ++f) {
        real a[3], b[3];
        cross_of(before, f, a);
        cross_of(after, f, b);
        if (length(a) > 0 && length(b) > 0)
            sum += (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) / sqrtl(length(a) * length(b)) / 2;
        scale += longest_side(before, f) * longest_side(after, f);
    }
    return scale > 0 ? sum / scale : 0;
}

static int corners_at(const uint32_t *triangle, uint32_t u, uint32_t v)
{
    int count = 0;
    for (int i = 0; i < 3; ++i)
        count += triangle[i] == u || triangle[i] == v;
    return count;
}

double reference_least_turn(const struct reference *reference, uint32_t u, uint32_t v,
                            const struct reference_sphere *sphere)
{
    real least = 1;
    for (size_t t = 0; t < reference->triangle_count; ++t) {
        if (corners_at(reference->triangles[t], u, v) == 1)
            least = fminl(least, turn_of(reference, reference->triangles[t], u, v, sphere));
    }
    return (double)least;
}

static bool comes_before(const struct reference_edge *a, const struct reference_edge *b)
{
    if (a->cost != b->cost) return a->cost < b->cost;
    return a->u != b->u ? a->u < b->u : a->v < b->v;
}

static struct reference_edge *cheapest(struct reference *reference, bool refused)
{
    struct reference_edge *best = NULL;
    for (size_t e = 0; e < reference->edge_count; ++e) {
        struct reference_edge *edge = &reference->edges[e];
        if (edge->refused == refused && (best == NULL || comes_before(edge, best))) best = edge;
    }
    return best;
}

const struct reference_edge *reference_next(struct reference *reference, bool *forced)
{
    struct reference_edge *edge;
    *forced = false;
    while ((edge = cheapest(reference, false)) != NULL) {
        if (reference_least_turn(reference, edge->u, edge->v, &edge->sphere) >= 0) return edge;
        edge->refused = true;
    }
    edge = cheapest(reference, true);
    *forced = edge != NULL;
    return edge;
}

const struct reference_edge *reference_find(const struct reference *reference, uint32_t u, uint32_t v)
{
    return find_edge(reference, u, v);
}

/* Takes the edges at u and v away and notes who was at their other ends. */
static void remove_edges(struct reference *reference, uint32_t u, uint32_t v, bool *is_neighbour)
{
    size_t kept = 0;
    for (size_t e = 0; e < reference->edge_count; ++e) {
        struct reference_edge *edge = &reference->edges[e];
        if (edge->u == u || edge->u == v || edge->v == u || edge->v == v) {
            is_neighbour[edge->u] = is_neighbour[edge->v] = true;
            reference_sphere_free(&edge->sphere);
        } else {
            reference->edges[kept++] = *edge;
        }
    }
    reference->edge_count = kept;
    is_neighbour[u] = is_neighbour[v] = false;
}

static double error_now(struct reference *reference)
{
    real cost = 0, weight = 0;
    for (size_t i = 0; i < reference->node_count; ++i) {
        const struct region *region = &reference->nodes[i];
        if (!region->alive) continue;
        cost += region->cost;
        for (uint32_t f = 0; f < reference->input->frame_count; ++f)
            weight += region->frames[f].quadric.W / 2;
    }
    if (weight > 0) reference->largest_error = fmax(reference->largest_error, (double)sqrtl(cost / weight));
    return reference->largest_error;
}

void reference_collapse(struct reference *reference, uint32_t u, uint32_t v, bool forced,
                        const struct reference_sphere *sphere, struct reference_collapse *collapse)
{
    const struct reference_input *input = reference->input;
    const struct reference_edge *edge = find_edge(reference, u, v);
    const uint32_t node = (uint32_t)reference->node_count++;
    struct region *w = &reference->nodes[node];
    bool *is_neighbour = reference_allocate(reference->node_count, sizeof *is_neighbour);

    region_unite(w, &reference->nodes[edge->u], &reference->nodes[edge->v], input);
    reference_sphere_copy(&w->sphere, sphere ? sphere : &edge->sphere, input->frame_count);
    w->cost = region_cost(w, input->frame_count, &w->sphere);
    *collapse = (struct reference_collapse){
        .u = edge->u, .v = edge->v, .node = node, .forced = forced, .cost = (double)w->cost};
    reference_sphere_create(&collapse->sphere, input->frame_count);
    reference_sphere_copy(&collapse->sphere, &w->sphere, input->frame_count);
    reference->nodes[u].alive = reference->nodes[v].alive = false;

    for (size_t t = 0; t < reference->triangle_count; ++t)
        for (int i = 0; i < 3; ++i)
            if (reference->triangles[t][i] == u || reference->triangles[t][i] == v) reference->triangles[t][i] = node;
    drop_degenerate_triangles(reference);

    remove_edges(reference, u, v, is_neighbour);
    for (size_t e = 0; e < reference->edge_count; ++e)
        if (is_neighbour[reference->edges[e].u] || is_neighbour[reference->edges[e].v])
            reference->edges[e].refused = false;
    for (uint32_t x = 0; x < node; ++x)
        if (is_neighbour[x]) add_edge(reference, x, node);
    free(is_neighbour);
    collapse->error = error_now(reference);
}

void reference_collapse_free(struct reference_collapse *collapse)
{
    reference_sphere_free(&collapse->sphere);
}

void reference_run(const struct reference_input *input, struct reference_result *result)
{
    struct reference *reference = reference_create(input);
    const struct reference_edge *edge;
    bool forced;
    *result =
        (struct reference_result){.collapses = reference_allocate(input->vertex_count, sizeof *result->collapses)};
    while ((edge = reference_next(reference, &forced)) != NULL)
        reference_collapse(reference, edge->u, edge->v, forced, NULL, &result->collapses[result->collapse_count++]);
    reference_destroy(reference);
}

void reference_result_free(struct reference_result *result)
{
    for (size_t t = 0; t < result->collapse_count; ++t)
        reference_collapse_free(&result->collapses[t]);
    free(result->collapses);
    *result = (struct reference_result){0};
}

/* ---- questions ---- */

double reference_cost(const struct reference *reference, uint32_t u, uint32_t v, const struct reference_sphere *sphere)
{
    const struct reference_input *input = reference->input;
    struct region united;
    real cost = 0;
    region_unite(&united, &reference->nodes[u], &reference->nodes[v], input);
    for (uint32_t f = 0; f < input->frame_count; ++f) {
        const struct reference_quadric quadric = region_candidate_quadric(&united, input, f);
        real center[3];
        for (int i = 0; i < 3; ++i)
            center[i] = sphere->centers[f][i] - united.frames[f].anchor[i];
        cost += reference_quadric_evaluate(&quadric, center, sphere->radii[f]);
    }
    region_free(&united);
    return (double)cost;
}

double reference_radius_bound(const struct reference *reference, uint32_t u, uint32_t v, uint32_t frame)
{
    struct region united;
    double bound;
    region_unite(&united, &reference->nodes[u], &reference->nodes[v], reference->input);
    bound = region_radius_bound(&united, reference->input, frame);
    region_free(&united);
    return bound;
}

bool reference_is_degenerate(const struct reference *reference, uint32_t u, uint32_t v, uint32_t frame)
{
    struct region united;
    struct reference_quadric quadric;
    region_unite(&united, &reference->nodes[u], &reference->nodes[v], reference->input);
    quadric = region_candidate_quadric(&united, reference->input, frame);
    region_free(&united);
    return reference_quadric_is_degenerate(&quadric);
}

double reference_weight(const struct reference *reference, uint32_t u, uint32_t v)
{
    real weight = 0;
    for (uint32_t f = 0; f < reference->input->frame_count; ++f)
        weight += reference->nodes[u].frames[f].quadric.W + reference->nodes[v].frames[f].quadric.W;
    return (double)weight;
}

double reference_coherence_weight(const struct reference *reference, uint32_t u, uint32_t v)
{
    real area = 0;
    for (uint32_t f = 0; f < reference->input->frame_count; ++f)
        area += reference->nodes[u].frames[f].area + reference->nodes[v].frames[f].area;
    return 2 * reference->input->temporal_coherence * (double)area;
}

double reference_extent(const struct reference *reference, uint32_t u, uint32_t v)
{
    const size_t count = (size_t)reference->input->frame_count * reference->input->direction_count;
    const struct region *a = &reference->nodes[u], *b = &reference->nodes[v];
    double extent = 0;
    for (size_t k = 0; k < count; ++k)
        extent = fmax(extent, fmax(a->extents[k][1], b->extents[k][1]) - fmin(a->extents[k][0], b->extents[k][0]));
    return extent;
}

const struct reference_sphere *reference_node(const struct reference *reference, uint32_t node)
{
    return &reference->nodes[node].sphere;
}

size_t reference_triangle_count(const struct reference *reference)
{
    return reference->triangle_count;
}

size_t reference_edge_count(const struct reference *reference)
{
    return reference->edge_count;
}

const uint32_t *reference_triangle(const struct reference *reference, size_t index)
{
    return reference->triangles[index];
}

const struct reference_edge *reference_edge(const struct reference *reference, size_t index)
{
    return &reference->edges[index];
}
