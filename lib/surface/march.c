/* SPDX-License-Identifier: MIT */
/*
 * Marching tetrahedra. A vertex sits on every edge between an outer point and one that is not; a tetrahedron that has
 * both kinds holds one triangle or two. Neighbours share the vertices of their common edges, so that the mesh is closed
 * and a manifold whatever the points are.
 */
#include "surface/surface.h"

#include <float.h>

#include "numeric/vector.h"

/* From a point to the other end of the edges that it owns, in half cells. */
static const int8_t STEPS[SPH__POINT_EDGES][3] = {{2, 0, 0},  {0, 2, 0},  {0, 0, 2}, {-1, -1, 1},
                                                  {1, -1, 1}, {-1, 1, 1}, {1, 1, 1}};

/* Vertices stay this far from the ends of their edges, as a share of the edge: floats can tell them apart. */
static const double MARGIN = 2e-4;

/* A point of a brick or of the ones after it: coordinates from 0 to 8. */
typedef struct place {
    int kind, at[3];
} place;

typedef struct march {
    const sph__grid *grid;
    sph__surface_mesh *mesh;
} march;

/* --- crossings --- */

/* For a row of points, the states of the points at the end of edge number `edge`. */
static unsigned row_across(sph__brick_rows rows, int kind, int z, int y, int edge)
{
    const int8_t *step = STEPS[edge];
    int dx, dy, dz;
    unsigned row;
    if (edge < 3) return rows[kind][z + step[2] / 2][y + step[1] / 2] >> step[0] / 2;
    dx = (step[0] - 1) / 2 + kind; /* the centre before a corner has the corner's number less one */
    dy = (step[1] - 1) / 2 + kind;
    dz = (step[2] - 1) / 2 + kind;
    row = rows[1 - kind][z + dz][y + dy];
    return dx < 0 ? row << 1 : row >> dx;
}

static void find_crossings(sph__brick *brick, sph__brick_rows rows)
{
    uint32_t count = 0;
    for (int kind = 0; kind < 2; ++kind)
        for (int z = 0; z < 8; ++z)
            for (int y = 0; y < 8; ++y) {
                uint8_t *edges = brick->edges[kind][z][y];
                brick->before[kind][z][y] = (uint16_t)count;
                memset(edges, 0, 8);
                for (int edge = 0; edge < SPH__POINT_EDGES; ++edge) {
                    const unsigned own = rows[kind][z + 1][y + 1];
                    const unsigned differ = (own ^ row_across(rows, kind, z + 1, y + 1, edge)) >> 1 & 255;
                    for (int x = 0; x < 8; ++x)
                        edges[x] |= (uint8_t)((differ >> x & 1) << edge);
                    count += (uint32_t)__builtin_popcount(differ);
                }
            }
    brick->vertex_count = count;
}

static uint32_t crossing_number(const sph__brick *brick, int kind, const int at[3], int edge)
{
    const uint8_t *edges = brick->edges[kind][at[2] & 7][at[1] & 7];
    const int x = at[0] & 7;
    int before = brick->before[kind][at[2] & 7][at[1] & 7];
    for (int i = 0; i < x; ++i)
        before += __builtin_popcount(edges[i]);
    return brick->first_vertex + (uint32_t)(before + __builtin_popcount(edges[x] & ((1u << edge) - 1)));
}

/* --- tetrahedra --- */

/*
 * Tetrahedron `number` (0 to 11) of a centre: it and the next centre along an axis, and two neighbouring corners of the
 * face between them. Its corners in this order have a positive volume.
 */
static void tetrahedron(int number, int x, int y, int z, place corners[4])
{
    static const int8_t AROUND[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
    const int axis = number >> 2, k = number & 3;
    const place centre = {1, {x, y, z}};
    corners[0] = corners[1] = corners[2] = corners[3] = centre;
    ++corners[1].at[axis];
    for (int i = 0; i < 2; ++i) {
        place *corner = &corners[2 + i];
        corner->kind = 0;
        ++corner->at[axis];
        corner->at[(axis + 1) % 3] += AROUND[k + i][0];
        corner->at[(axis + 2) % 3] += AROUND[k + i][1];
    }
}

static bool is_outer(sph__brick_rows rows, const place *p)
{
    return rows[p->kind][p->at[2] + 1][p->at[1] + 1] >> (p->at[0] + 1) & 1;
}

/* The vertex on the edge between two places. Both ends are in bricks that are held; see SPH__BRICK_SOLID. */
static uint32_t vertex_between(const march *m, sph__brick *const bricks[8], const place *a, const place *b)
{
    int step[3], edge;
    const sph__brick *brick;
    for (int k = 2; k >= 0; --k) {
        step[k] = 2 * (b->at[k] - a->at[k]) + b->kind - a->kind;
        if (step[k] >= 0) continue;
        if (a->kind == b->kind || k == 2) return vertex_between(m, bricks, b, a); /* b owns the edge */
    }
    if (a->kind == b->kind)
        edge = step[0] != 0 ? 0 : step[1] != 0 ? 1 : 2;
    else
        edge = 3 + (step[0] > 0) + 2 * (step[1] > 0);
    brick = bricks[(a->at[0] >> 3) | (a->at[1] >> 3) << 1 | (a->at[2] >> 3) << 2];
    return brick == NULL ? 0 : crossing_number(brick, a->kind, a->at, edge);
}

static double squared_distance(const march *m, uint32_t a, uint32_t b)
{
    const float *p = m->mesh->positions + 3 * (size_t)a, *q = m->mesh->positions + 3 * (size_t)b;
    double sum = 0;
    for (int k = 0; k < 3; ++k)
        sum += ((double)p[k] - q[k]) * ((double)p[k] - q[k]);
    return sum;
}

static void set_triangle(uint32_t *triangle, uint32_t a, uint32_t b, uint32_t c)
{
    triangle[0] = a;
    triangle[1] = b;
    triangle[2] = c;
}

/*
 * The triangles of a tetrahedron, of whose corners those in `inner` (bits) are not outer; returns how many. Where
 * `triangles` is NULL they are only counted.
 */
static uint32_t cut(const march *m, sph__brick *const bricks[8], const place corners[4], unsigned inner,
                    uint32_t *triangles)
{
    /* even permutations that put the odd one out, or the inner two, first */
    static const int8_t ORDER[16][4] = {
        [1] = {0, 1, 2, 3},  [2] = {1, 0, 3, 2},  [4] = {2, 3, 0, 1},  [8] = {3, 2, 1, 0}, [14] = {0, 1, 2, 3},
        [13] = {1, 0, 3, 2}, [11] = {2, 3, 0, 1}, [7] = {3, 2, 1, 0},  [3] = {0, 1, 2, 3}, [5] = {0, 2, 3, 1},
        [9] = {0, 3, 1, 2},  [6] = {1, 2, 0, 3},  [10] = {1, 3, 2, 0}, [12] = {2, 3, 0, 1}};
    const int inner_count = __builtin_popcount(inner);
    const place *a = &corners[ORDER[inner][0]], *b = &corners[ORDER[inner][1]];
    const place *c = &corners[ORDER[inner][2]], *d = &corners[ORDER[inner][3]];
    uint32_t v[4];
    if (triangles == NULL) return inner_count == 2 ? 2 : 1;
    if (inner_count != 2) {
        v[0] = vertex_between(m, bricks, a, b);
        v[1] = vertex_between(m, bricks, a, inner_count == 1 ? c : d);
        v[2] = vertex_between(m, bricks, a, inner_count == 1 ? d : c);
        set_triangle(triangles, v[0], v[1], v[2]);
        return 1;
    }
    v[0] = vertex_between(m, bricks, a, c);
    v[1] = vertex_between(m, bricks, a, d);
    v[2] = vertex_between(m, bricks, b, d);
    v[3] = vertex_between(m, bricks, b, c);
    if (squared_distance(m, v[0], v[2]) <= squared_distance(m, v[1], v[3])) {
        set_triangle(triangles, v[0], v[1], v[2]);
        set_triangle(triangles + 3, v[0], v[2], v[3]);
    } else {
        set_triangle(triangles, v[1], v[2], v[3]);
        set_triangle(triangles + 3, v[1], v[3], v[0]);
    }
    return 2;
}

/* Are all points that the tetrahedra of a row of centres have of one kind? */
static bool row_is_even(sph__brick_rows rows, int z, int y)
{
    unsigned any = rows[1][z + 1][y + 1] | rows[1][z + 2][y + 1] | rows[1][z + 1][y + 2];
    unsigned all = rows[1][z + 1][y + 1] & rows[1][z + 2][y + 1] & rows[1][z + 1][y + 2];
    for (int i = 0; i < 4; ++i) {
        any |= rows[0][z + 1 + i / 2][y + 1 + i % 2];
        all &= rows[0][z + 1 + i / 2][y + 1 + i % 2];
    }
    return (any >> 1 & 511) == 0 || (all >> 1 & 511) == 511;
}

/* The triangles of all tetrahedra of a brick's centres. */
static uint32_t march_brick(const march *m, sph__brick *const bricks[8], sph__brick_rows rows, uint32_t *triangles)
{
    uint32_t count = 0;
    for (int z = 0; z < 8; ++z)
        for (int y = 0; y < 8; ++y) {
            if (row_is_even(rows, z, y)) continue;
            for (int i = 0; i < 8 * 12; ++i) {
                place corners[4];
                unsigned inner = 0;
                tetrahedron(i % 12, i / 12, y, z, corners);
                for (int k = 0; k < 4; ++k)
                    inner |= (unsigned)!is_outer(rows, &corners[k]) << k;
                if (inner == 0 || inner == 15) continue;
                count += cut(m, bricks, corners, inner, triangles == NULL ? NULL : triangles + 3 * (size_t)count);
            }
        }
    return count;
}

/* --- passes over the bricks --- */

static void count_bricks(void *argument, size_t begin, size_t end)
{
    const march *m = argument;
    for (size_t i = begin; i < end; ++i) {
        sph__brick *brick = &m->grid->bricks[i];
        sph__brick_rows rows;
        sph__grid_rows(m->grid, brick->at, rows);
        find_crossings(brick, rows);
        brick->triangle_count = march_brick(m, NULL, rows, NULL);
    }
}

static void fill_triangles(void *argument, size_t begin, size_t end)
{
    const march *m = argument;
    for (size_t i = begin; i < end; ++i) {
        const sph__brick *brick = &m->grid->bricks[i];
        sph__brick *bricks[8];
        sph__brick_rows rows;
        if (brick->triangle_count == 0) continue;
        for (int k = 0; k < 8; ++k) {
            const int32_t state =
                sph__grid_state(m->grid, (int64_t)brick->at[0] + (k & 1), (int64_t)brick->at[1] + (k >> 1 & 1),
                                (int64_t)brick->at[2] + (k >> 2));
            bricks[k] = state >= 0 ? &m->grid->bricks[state] : NULL;
        }
        sph__grid_rows(m->grid, brick->at, rows);
        march_brick(m, bricks, rows, m->mesh->triangles + 3 * brick->first_triangle);
    }
}

/* Casts along an edge from its outer end: where the solid begins is the vertex. */
static void place_vertex(const march *m, const double outer[3], const double inner[3], uint32_t vertex)
{
    const sph__solid *solid = m->grid->solid;
    double direction[3], x[3], s = 1 - MARGIN;
    uint32_t which = UINT32_MAX;
    sph__contact contact;
    sph__subtract(inner, outer, direction);
    sph__solid_cast(solid, outer, direction, 1, &s, &which);
    s = fmin(fmax(s, MARGIN), 1 - MARGIN);
    sph__add_scaled(outer, s, direction, x);
    if (which == UINT32_MAX) sph__solid_distance(solid, x, &which); /* the inner end is in by a hair's breadth */
    sph__primitive_closest(&solid->primitives[which], x, &contact);
    for (int k = 0; k < 3; ++k) {
        m->mesh->positions[3 * (size_t)vertex + (size_t)k] = (float)x[k];
        m->mesh->normals[3 * (size_t)vertex + (size_t)k] = (float)contact.normal[k];
    }
}

static void fill_vertices_of(const march *m, const sph__brick *brick)
{
    uint32_t vertex = brick->first_vertex;
    for (int kind = 0; kind < 2; ++kind)
        for (int i = 0; i < 512; ++i) {
            const int x = i & 7, y = i >> 3 & 7, z = i >> 6;
            const bool outer = brick->outer[kind][z] >> (i & 63) & 1;
            for (int edge = 0; edge < SPH__POINT_EDGES; ++edge) {
                double from[3], to[3];
                if ((brick->edges[kind][z][y][x] >> edge & 1) == 0) continue;
                sph__grid_point(m->grid, brick, kind, x, y, z, from);
                for (int k = 0; k < 3; ++k)
                    to[k] = from[k] + 0.5 * m->grid->cell * STEPS[edge][k];
                place_vertex(m, outer ? from : to, outer ? to : from, vertex++);
            }
        }
}

static void fill_vertices(void *argument, size_t begin, size_t end)
{
    const march *m = argument;
    for (size_t i = begin; i < end; ++i)
        fill_vertices_of(m, &m->grid->bricks[i]);
}

/* Numbers what the bricks have; SPH_E_LIMIT where 32 bits will not do. */
static sph_status number(const sph__grid *grid, sph__surface_mesh *mesh)
{
    uint64_t vertices = 0, triangles = 0;
    for (uint32_t i = 0; i < grid->brick_count; ++i) {
        grid->bricks[i].first_vertex = (uint32_t)vertices;
        grid->bricks[i].first_triangle = (size_t)triangles;
        vertices += grid->bricks[i].vertex_count;
        triangles += grid->bricks[i].triangle_count;
        if (vertices > UINT32_MAX || triangles > SIZE_MAX / 12)
            return sph__fail(grid->context, SPH_E_LIMIT, "the surface has too many vertices for 32 bits");
    }
    mesh->vertex_count = (uint32_t)vertices;
    mesh->triangle_count = (size_t)triangles;
    return SPH_OK;
}

static sph_status allocate(const sph__grid *grid, sph__surface_mesh *mesh)
{
    const size_t vector = 3 * sizeof(float);
    sph_status status = SPH_OK;
    mesh->positions = sph__memory_allocate(grid->memory, mesh->vertex_count, vector, &status);
    if (status == SPH_OK) mesh->normals = sph__memory_allocate(grid->memory, mesh->vertex_count, vector, &status);
    if (status == SPH_OK)
        mesh->triangles =
            sph__memory_allocate(grid->memory, mesh->triangle_count, 3 * sizeof *mesh->triangles, &status);
    return status;
}

sph_status sph__grid_march(sph__grid *grid, sph__surface_mesh *mesh)
{
    march m = {grid, mesh};
    sph_status status;
    memset(mesh, 0, sizeof *mesh);
    status = sph__grid_loop(grid, grid->brick_count, 8, count_bricks, &m, 0.65, 0.75);
    if (status == SPH_OK) status = number(grid, mesh);
    if (status == SPH_OK) status = allocate(grid, mesh);
    if (status == SPH_OK) status = sph__grid_loop(grid, grid->brick_count, 4, fill_vertices, &m, 0.75, 0.9);
    if (status == SPH_OK) status = sph__grid_loop(grid, grid->brick_count, 8, fill_triangles, &m, 0.9, 1);
    return status;
}
