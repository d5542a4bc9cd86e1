/* SPDX-License-Identifier: MIT */
/*
 * The creature's skin: marching tetrahedra over a body-centred lattice, whose tetrahedra are all alike. A tetrahedron
 * has no ambiguous case, so the surface is closed and manifold by construction; then the vertices are spread evenly
 * over it.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "creature_parts.h"

enum { RELAX_ROUNDS = 12 };

static const point BOX_LOW = {-1.85, -0.04, -0.45}, BOX_HIGH = {1.46, 1.93, 0.45};
enum { MARGIN = 2 }; /* cells beyond the box */

/* Lattice points: corners (even) and centres (odd) of the cells, by 2 * index + kind. */
typedef struct lattice {
    uint32_t nx, ny, nz; /* corners along each axis; centres are one fewer but take as many numbers */
    double cell;
    point low;
    float *values; /* the distance at each point */
} lattice;

typedef struct edge_slot {
    uint64_t key; /* both lattice points; 0: free (no edge has it, as points of an edge differ) */
    uint32_t vertex;
} edge_slot;

typedef struct builder {
    lattice grid;
    edge_slot *slots; /* open addressing; size is a power of two */
    size_t slot_count;
    size_t vertex_capacity, triangle_capacity;
    bool failed;
    skin *out;
} builder;

static uint64_t point_number(const lattice *g, uint32_t x, uint32_t y, uint32_t z, uint32_t kind)
{
    return 2 * (((uint64_t)z * g->ny + y) * g->nx + x) + kind;
}

static point point_place(const lattice *g, uint64_t number)
{
    const uint64_t corner = number / 2;
    const double half = number % 2 == 0 ? 0 : 0.5;
    return (point){g->low.x + ((double)(corner % g->nx) + half) * g->cell,
                   g->low.y + ((double)(corner / g->nx % g->ny) + half) * g->cell,
                   g->low.z + ((double)(corner / g->nx / g->ny) + half) * g->cell};
}

static bool grow(void **memory, size_t *capacity, size_t need, size_t size)
{
    const size_t wanted = *capacity == 0 ? 4096 : *capacity * 2;
    void *grown;
    if (need <= *capacity) return true;
    grown = realloc(*memory, wanted * size);
    if (grown == NULL) return false;
    *memory = grown;
    *capacity = wanted;
    return true;
}

static bool grow_slots(builder *b)
{
    const size_t count = b->slot_count == 0 ? 16384 : b->slot_count * 2;
    edge_slot *slots = calloc(count, sizeof *slots);
    if (slots == NULL) return false;
    for (size_t i = 0; i < b->slot_count; ++i) {
        size_t at;
        if (b->slots[i].key == 0) continue;
        at = (size_t)(b->slots[i].key * 0x9E3779B97F4A7C15u >> 20) & (count - 1);
        while (slots[at].key != 0)
            at = (at + 1) & (count - 1);
        slots[at] = b->slots[i];
    }
    free(b->slots);
    b->slots = slots;
    b->slot_count = count;
    return true;
}

/* The vertex where the skin crosses the lattice edge from `inside` to `outside`; made when it is first asked for. */
static uint32_t crossing(builder *b, uint64_t inside, uint64_t outside)
{
    const uint64_t key = inside << 32 | outside;
    const double in = (double)b->grid.values[inside], out = (double)b->grid.values[outside];
    const point p = point_place(&b->grid, inside), q = point_place(&b->grid, outside);
    double t = in / (in - out);
    size_t at;
    if (b->failed) return 0;
    if (2 * b->out->vertex_count >= b->slot_count && !grow_slots(b)) goto fail;
    at = (size_t)(key * 0x9E3779B97F4A7C15u >> 20) & (b->slot_count - 1);
    for (; b->slots[at].key != 0; at = (at + 1) & (b->slot_count - 1))
        if (b->slots[at].key == key) return b->slots[at].vertex;
    if (!grow((void **)&b->out->vertices, &b->vertex_capacity, b->out->vertex_count + 1, sizeof(point))) goto fail;
    t = t < 0.1 ? 0.1 : t > 0.9 ? 0.9 : t; /* no two vertices in one place */
    b->slots[at] = (edge_slot){key, (uint32_t)b->out->vertex_count};
    b->out->vertices[b->out->vertex_count++] = add(p, scale(subtract(q, p), t));
    return b->slots[at].vertex;
fail:
    b->failed = true;
    return 0;
}

static void emit(builder *b, uint32_t v0, uint32_t v1, uint32_t v2)
{
    uint32_t *t;
    if (b->failed ||
        !grow((void **)&b->out->triangles, &b->triangle_capacity, b->out->triangle_count + 1, 3 * sizeof(uint32_t))) {
        b->failed = true;
        return;
    }
    t = b->out->triangles + 3 * b->out->triangle_count++;
    t[0] = v0;
    t[1] = v1;
    t[2] = v2;
}

/* Cuts one corner off: `lone` alone is inside, or alone outside. Crossings are made line by line, as they get numbers.
 */
static void cut_corner(builder *b, const uint64_t corner[4], int lone, bool inside)
{
    /* Even permutations that bring each corner to the front keep the volume's sign. */
    static const uint8_t FRONT[4][4] = {{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 3, 0, 1}, {3, 2, 1, 0}};
    const uint8_t *order = FRONT[lone];
    uint32_t v[3];
    for (int i = 0; i < 3; ++i) {
        const uint64_t other = corner[order[i + 1]];
        v[i] = inside ? crossing(b, corner[lone], other) : crossing(b, other, corner[lone]);
    }
    emit(b, v[0], v[inside ? 1 : 2], v[inside ? 2 : 1]);
}

/* Cuts between the corners first and second, which are inside, and the other two. */
static void cut_middle(builder *b, const uint64_t corner[4], int first, int second)
{
    const bool flip = (first + second) % 2 == 0; /* the parity of (first, second, rest) decides the winding */
    uint64_t out[2];
    uint32_t v[4];
    int count = 0;
    for (int i = 0; i < 4; ++i)
        if (i != first && i != second) out[count++] = corner[i];
    v[0] = crossing(b, corner[first], out[0]);
    v[1] = crossing(b, corner[first], out[1]);
    v[2] = crossing(b, corner[second], out[1]);
    v[3] = crossing(b, corner[second], out[0]);
    emit(b, v[0], v[flip ? 2 : 1], v[flip ? 1 : 2]);
    emit(b, v[0], v[flip ? 3 : 2], v[flip ? 2 : 3]);
}

/* One tetrahedron a, b, c, d of positive volume: (b - a) x (c - a) points to d. */
static void tetrahedron(builder *b, const uint64_t corner[4])
{
    int in[4], out[4], in_count = 0, out_count = 0;
    for (int i = 0; i < 4; ++i) {
        if (b->grid.values[corner[i]] < 0)
            in[in_count++] = i;
        else
            out[out_count++] = i;
    }
    if (in_count == 1)
        cut_corner(b, corner, in[0], true);
    else if (in_count == 2)
        cut_middle(b, corner, in[0], in[1]);
    else if (in_count == 3)
        cut_corner(b, corner, out[0], false);
}

/* The four tetrahedra around the line between the centres of two cells that are neighbours along `axis`. */
static void cell_pair(builder *b, uint32_t x, uint32_t y, uint32_t z, int axis)
{
    static const uint32_t STEP[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const uint32_t *s = STEP[axis], *u = STEP[(axis + 1) % 3], *v = STEP[(axis + 2) % 3];
    const uint64_t low = point_number(&b->grid, x, y, z, 1);
    const uint64_t high = point_number(&b->grid, x + s[0], y + s[1], z + s[2], 1);
    uint64_t ring[4];
    for (uint32_t i = 0; i < 4; ++i) {
        const uint32_t du = i == 1 || i == 2, dv = i >= 2;
        ring[i] = point_number(&b->grid, x + s[0] + du * u[0] + dv * v[0], y + s[1] + du * u[1] + dv * v[1],
                               z + s[2] + du * u[2] + dv * v[2], 0);
    }
    for (int i = 0; i < 4; ++i)
        tetrahedron(b, (uint64_t[4]){low, ring[i], ring[(i + 1) % 4], high});
}

static bool sample(lattice *g, uint32_t resolution)
{
    uint64_t count;
    g->cell = (BOX_HIGH.x - BOX_LOW.x) / resolution;
    g->low = subtract(BOX_LOW, (point){MARGIN * g->cell, MARGIN * g->cell, MARGIN * g->cell});
    g->nx = resolution + 2 * MARGIN + 1;
    g->ny = (uint32_t)((BOX_HIGH.y - BOX_LOW.y) / g->cell) + 2 * MARGIN + 2;
    g->nz = (uint32_t)((BOX_HIGH.z - BOX_LOW.z) / g->cell) + 2 * MARGIN + 2;
    count = 2 * (uint64_t)g->nx * g->ny * g->nz;
    if (count > UINT32_MAX) return false;
    g->values = malloc((size_t)count * sizeof *g->values);
    if (g->values == NULL) return false;
    for (uint64_t i = 0; i < count; ++i)
        g->values[i] = (float)creature_distance(point_place(g, i));
    return true;
}

/* Which way is out of the flesh, as steep as it is there. */
static point slope(point p)
{
    const double h = 1e-5;
    return (point){
        (creature_distance((point){p.x + h, p.y, p.z}) - creature_distance((point){p.x - h, p.y, p.z})) / (2 * h),
        (creature_distance((point){p.x, p.y + h, p.z}) - creature_distance((point){p.x, p.y - h, p.z})) / (2 * h),
        (creature_distance((point){p.x, p.y, p.z + h}) - creature_distance((point){p.x, p.y, p.z - h})) / (2 * h)};
}

/* Moves a point from `p` on the skin towards `q`, along the skin only: thin ends must not shrink. */
static point slide(point p, point q)
{
    point g = slope(p);
    q = subtract(q, scale(g, dot(subtract(q, p), g) / dot(g, g)));
    g = slope(q);
    return subtract(q, scale(g, creature_distance(q) / dot(g, g)));
}

bool creature_skin_smooth(const skin *s, double *values, size_t width, int rounds)
{
    double *sum = malloc(s->vertex_count * width * sizeof *sum);
    double *weight = malloc(s->vertex_count * sizeof *weight);
    const bool done = sum != NULL && weight != NULL;
    for (int r = 0; done && r < rounds; ++r) {
        for (size_t i = 0; i < s->vertex_count; ++i)
            weight[i] = 0;
        for (size_t i = 0; i < s->vertex_count * width; ++i)
            sum[i] = 0;
        for (size_t i = 0; i < 3 * s->triangle_count;
             ++i) { /* each neighbour comes once: every edge has two triangles */
            const size_t a = s->triangles[i], b = s->triangles[i % 3 == 2 ? i - 2 : i + 1];
            for (size_t k = 0; k < width; ++k)
                sum[a * width + k] += values[b * width + k];
            weight[a] += 1;
        }
        for (size_t i = 0; i < s->vertex_count; ++i)
            for (size_t k = 0; k < width; ++k)
                values[i * width + k] = 0.5 * values[i * width + k] + 0.5 * sum[i * width + k] / weight[i];
    }
    free(sum);
    free(weight);
    return done;
}

static bool relax(skin *s)
{
    point *before = malloc(s->vertex_count * sizeof *before);
    bool done = before != NULL;
    for (int r = 0; done && r < RELAX_ROUNDS; ++r) {
        memcpy(before, s->vertices, s->vertex_count * sizeof *before);
        done = creature_skin_smooth(s, &s->vertices[0].x, 3, 1);
        for (size_t i = 0; done && i < s->vertex_count; ++i)
            s->vertices[i] = slide(before[i], s->vertices[i]);
    }
    free(before);
    return done;
}

bool creature_skin_make(skin *s, uint32_t resolution)
{
    builder b = {.out = s};
    *s = (skin){0};
    b.failed = !sample(&b.grid, resolution);
    for (uint32_t z = 0; z + 2 < b.grid.nz && !b.failed; ++z)
        for (uint32_t y = 0; y + 2 < b.grid.ny; ++y)
            for (uint32_t x = 0; x + 2 < b.grid.nx; ++x)
                for (int axis = 0; axis < 3; ++axis)
                    cell_pair(&b, x, y, z, axis);
    free(b.grid.values);
    free(b.slots);
    return !b.failed && s->vertex_count > 0 && relax(s);
}

void creature_skin_free(skin *s)
{
    free(s->vertices);
    free(s->triangles);
    *s = (skin){0};
}
