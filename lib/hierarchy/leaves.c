/* SPDX-License-Identifier: MIT */
/* The regions of single vertices: their quadrics, from the triangles around them. */
#include "hierarchy/caps.h"
#include "hierarchy/single.h"

/* Triangles whose planes are added in one pass over the frames. */
enum { FAN = 16, LINE = 16, AHEAD = 48 };

/* The triangles of a fan: the rows of v, and of the two other corners of each. */
typedef struct fan {
    const float *center;
    const float *corners[FAN][2];
    size_t count;
    double weight;        /* 1/3 of the importance */
    const float *weights; /* per frame besides; may be NULL */
    double cap_weight;    /* above 0: these are all triangles, and their angles make a cap */
} fan;

/* Eight frames of a leaf's quadric while it is made: its rows, its W, and the angles of its triangles. */
typedef struct leaf_sums {
    sph__v8d rows[SPH__LEAF_ROWS], w;
    sph__turn angles;
    sph__v8d edge[3]; /* from the vertex to the last corner of the last triangle */
} leaf_sums;

/* Adds the plane of one triangle (p, q, r). */
SPH__INLINE void add_plane(const fan *f, size_t t, size_t s, size_t i, leaf_sums *sums)
{
    const float *p = f->center, *q = f->corners[t][0], *r = f->corners[t][1];
    const sph__v8d px = sph__load(p, i), py = sph__load(p, s + i), pz = sph__load(p, 2 * s + i);
    const bool chained = t > 0 && q == f->corners[t - 1][1];
    const sph__v8d ex = chained ? sums->edge[0] : sph__load(q, i) - px;
    const sph__v8d ey = chained ? sums->edge[1] : sph__load(q, s + i) - py;
    const sph__v8d ez = chained ? sums->edge[2] : sph__load(q, 2 * s + i) - pz;
    const sph__v8d fx = sph__load(r, i) - px, fy = sph__load(r, s + i) - py, fz = sph__load(r, 2 * s + i) - pz;
    const sph__v8d nx = ey * fz - ez * fy, ny = ez * fx - ex * fz, nz = ex * fy - ey * fx;
    const sph__v8d squared = nx * nx + ny * ny + nz * nz;
    const sph__v8d zero = {0};
    sph__v8d length, scale, w = zero, x, y, z;
    length = sph__root(squared);
    w += f->weight;
    if (f->weights != NULL) w *= sph__load(f->weights, i);
    /* w = weight * area: N = 2 w n = weight' * (length / 2) n, and 2 * area / 3 = length / 3 */
    scale = sph__where(squared, zero, w / length, squared - squared);
    x = scale * nx;
    y = scale * ny;
    z = scale * nz;
    sums->w += w * length;
    sums->rows[SPH__M00] += x * nx;
    sums->rows[SPH__M01] += x * ny;
    sums->rows[SPH__M02] += x * nz;
    sums->rows[SPH__M11] += y * ny;
    sums->rows[SPH__M12] += y * nz;
    sums->rows[SPH__M22] += z * nz;
    sums->rows[SPH__N0] += w * nx;
    sums->rows[SPH__N1] += w * ny;
    sums->rows[SPH__N2] += w * nz;
    if (f->cap_weight > 0) {
        const sph__v8d cosine = ex * fx + ey * fy + ez * fz;
        sph__turn_by(&cosine, &length, &sums->angles);
    }
    sums->edge[0] = fx;
    sums->edge[1] = fy;
    sums->edge[2] = fz;
}

/* Adds the planes of a fan in eight frames, and their W; what their angles add up to. */
SPH__INLINE void add_planes(const fan *f, size_t s, size_t i, bool first, float *eight, sph__v8d *w, sph__turn *angles)
{
    leaf_sums sums = {.w = *w};
    sph__turn_start(&sums.angles);
    for (size_t k = 0; k < SPH__LEAF_ROWS && !first; ++k) sums.rows[k] = sph__load(eight, k * SPH__LANES);
    for (size_t t = 0; t < f->count; ++t) add_plane(f, t, s, i, &sums);
    for (size_t k = 0; k < SPH__LEAF_ROWS; ++k) sph__store(eight, k * SPH__LANES, sums.rows[k]);
    *w = sums.w;
    *angles = sums.angles;
}

/* Asks for a line of all rows of a fan. */
SPH__INLINE void ask_for_rows(const fan *f, size_t s, size_t i)
{
    for (size_t k = 0; k < 3; ++k) __builtin_prefetch(f->center + k * s + i);
    for (size_t t = 0; t < f->count; ++t)
        for (size_t k = t > 0 && f->corners[t][0] == f->corners[t - 1][1] ? 3 : 0; k < 6; ++k)
            __builtin_prefetch(f->corners[t][k / 3] + k % 3 * s + i);
}

/* Frames whose caps are added together: each takes long to come by, and none waits for another. */
enum { TOGETHER = 16 };

/* Adds the planes of a fan, and at the end its cap, to the leaf rows of a block of `rows` rows; the sum over frames of their
 * W into `w`, lane by lane. */
SPH__CLONES static void add_fan(const fan *f, size_t s, size_t rows, bool first, float *block, double w[SPH__LANES])
{
    const size_t leaf = SPH__LEAF_ROWS * SPH__LANES, rest = (rows - SPH__LEAF_ROWS) * SPH__LANES * sizeof *block;
    sph__v8d planes = {0}, caps = {0};
    sph__turn turns[TOGETHER];
    for (size_t i = 0; i < s && i < AHEAD; i += LINE) ask_for_rows(f, s, i);
    for (size_t begin = 0, end; begin < s; begin = end) {
        end = s - begin < TOGETHER * SPH__LANES ? s : begin + TOGETHER * SPH__LANES;
        for (size_t i = begin; i < end; i += SPH__LANES) {
            if (i % LINE == 0 && i + AHEAD < s) ask_for_rows(f, s, i + AHEAD);
            add_planes(f, s, i, first, block + i * rows, &planes, &turns[(i - begin) / SPH__LANES]);
            if (first && rest > 0) memset(block + i * rows + leaf, 0, rest);
        }
        for (size_t i = begin; i < end && f->cap_weight > 0; i += SPH__LANES)
            sph__add_cap_plane(&turns[(i - begin) / SPH__LANES], f->cap_weight, block + i * rows, &caps);
    }
    planes += caps;
    memcpy(w, &planes, sizeof planes);
}

static double leaf_weight(const sph__builder *b, uint32_t v)
{
    return (b->importance != NULL && !b->importance_per_frame ? (double)b->importance[v] : 1) / 3;
}

/* The cap's weight where it is made with the planes. */
static double fan_cap_weight(const sph__builder *b, uint32_t v)
{
    return b->cell_starts[v + 1] - b->cell_starts[v] <= FAN ? sph__cap_weight(b, v) : 0;
}

/* The quadric of vertex v into the leaf rows of `block`; returns W. */
static double make_leaf(const sph__builder *b, uint32_t v, float *block)
{
    _Alignas(SPH__ALIGN) double lanes[SPH__LANES];
    fan f = {.center = sph__node_center(b, v), .weights = b->importance_per_frame ? b->importance + v * b->stride : NULL};
    double w = 0;
    size_t at = b->cell_starts[v];
    f.weight = leaf_weight(b, v);
    f.cap_weight = fan_cap_weight(b, v);
    do {
        const bool first = at == b->cell_starts[v];
        for (f.count = 0; f.count < FAN && at < b->cell_starts[v + 1]; ++f.count, ++at) {
            f.corners[f.count][0] = sph__node_center(b, b->vertex_cells[at][0]);
            f.corners[f.count][1] = sph__node_center(b, b->vertex_cells[at][1]);
        }
        add_fan(&f, b->stride, b->leaf_rows, first, block, lanes);
        w += sph__sum_doubles(lanes);
    } while (at < b->cell_starts[v + 1]);
    return f.cap_weight > 0 ? w : w + sph__add_cap(b, v, block);
}

/* --- a single frame: eight leaves side by side --- */

/* Lanes: their vertices, the rows of these, and of the corners of their triangles. */
typedef struct leaf_lanes {
    _Alignas(SPH__ALIGN) float center[3][SPH__LANES], corners[FAN][2][3][SPH__LANES];
    uint32_t vertices[SPH__LANES];
    size_t count, ends[SPH__LANES]; /* triangles of each that have been put */
    double weight, cap_weight;
} leaf_lanes;

static void put_row(const float *xyz, size_t lane, float rows[3][SPH__LANES])
{
    for (size_t k = 0; k < 3; ++k) rows[k][lane] = xyz[k];
}

/* The triangles of a lane's vertex from `at` on, as many as there is room for; returns where it stopped. */
static size_t put_cells(const sph__builder *b, leaf_lanes *lanes, size_t lane, size_t at)
{
    const uint32_t v = lanes->vertices[lane];
    size_t t = 0;
    for (; t < FAN && at < b->cell_starts[v + 1]; ++t, ++at) {
        put_row(sph__node_center(b, b->vertex_cells[at][0]), lane, lanes->corners[t][0]);
        put_row(sph__node_center(b, b->vertex_cells[at][1]), lane, lanes->corners[t][1]);
    }
    lanes->ends[lane] = t;
    return at;
}

/* Adds them to the leaf rows. Where a lane has fewer triangles than others, they are points, which add nothing. */
static void add_lanes(leaf_lanes *lanes, bool first, float block[SPH__BLOCK_ROWS][SPH__LANES], double w[SPH__LANES])
{
    fan f = {.center = lanes->center[0], .weight = lanes->weight, .cap_weight = lanes->cap_weight};
    for (size_t l = 0; l < lanes->count; ++l) f.count = lanes->ends[l] > f.count ? lanes->ends[l] : f.count;
    for (size_t l = 0; l < SPH__LANES; ++l)
        for (size_t t = l < lanes->count ? lanes->ends[l] : 0; t < f.count; ++t)
            for (size_t k = 0; k < 6; ++k) lanes->corners[t][k / 3][k % 3][l] = lanes->center[k % 3][l];
    for (size_t t = 0; t < f.count; ++t) {
        f.corners[t][0] = lanes->corners[t][0][0];
        f.corners[t][1] = lanes->corners[t][1][0];
    }
    add_fan(&f, SPH__LANES, SPH__BLOCK_ROWS, first, block[0], w);
}

static void finish_lanes(const sph__builder *b, leaf_lanes *lanes)
{
    _Alignas(SPH__ALIGN) float block[SPH__BLOCK_ROWS][SPH__LANES];
    _Alignas(SPH__ALIGN) double each[SPH__LANES], more[SPH__LANES];
    if (lanes->count > 0) add_lanes(lanes, true, block, each);
    for (size_t l = 0; l < lanes->count; ++l) {
        const uint32_t v = lanes->vertices[l];
        float *rows = sph__single_rows(b, v);
        double w = each[l];
        size_t at = b->cell_starts[v] + lanes->ends[l];
        while (at < b->cell_starts[v + 1]) { /* then it is alone */
            at = put_cells(b, lanes, l, at);
            add_lanes(lanes, false, block, more);
            w += more[l];
        }
        b->slots[v].w = lanes->cap_weight > 0 ? w : w + sph__add_cap(b, v, block[0]);
        for (size_t k = 0; k < SPH__BLOCK_ROWS; ++k) rows[k] = block[k][l];
        memcpy(rows + SPH__SINGLE_CENTER, sph__node_center(b, v), 3 * sizeof(float));
        rows[SPH__SINGLE_RADIUS] = 0;
    }
    lanes->count = 0;
}

/* Those that follow each other and are alike share a pass. */
static void make_single_leaves(void *argument, size_t begin, size_t end)
{
    const sph__builder *b = argument;
    leaf_lanes lanes = {.count = 0};
    for (size_t v = begin; v < end; ++v) {
        const double weight = leaf_weight(b, (uint32_t)v), cap_weight = fan_cap_weight(b, (uint32_t)v);
        /* its cap, if any, is made apart */
        const bool alone = !(cap_weight > 0) && sph__cap_weight(b, (uint32_t)v) > 0;
        const bool many = b->cell_starts[v + 1] - b->cell_starts[v] > FAN;
        if (lanes.count == SPH__LANES || alone || many || weight < lanes.weight || weight > lanes.weight ||
            cap_weight < lanes.cap_weight || cap_weight > lanes.cap_weight)
            finish_lanes(b, &lanes);
        lanes.weight = weight;
        lanes.cap_weight = cap_weight;
        lanes.vertices[lanes.count] = (uint32_t)v;
        put_row(sph__node_center(b, (uint32_t)v), lanes.count, lanes.center);
        put_cells(b, &lanes, lanes.count, b->cell_starts[v]);
        ++lanes.count;
        if (alone || many) finish_lanes(b, &lanes);
    }
    finish_lanes(b, &lanes);
}

sph_status sph__single_leaves(sph__builder *b)
{
    enum { GRAIN = 512 };
    b->rows = sph__alloc(b->context, b->n, SPH__SINGLE_ROWS * sizeof *b->rows);
    if (b->rows == NULL) return sph__fail_memory(b->context);
    for (uint32_t v = 0; v < b->n; ++v) b->slots[v].block = sph__single_rows(b, v);
    sph__parallel_for(b->context, b->n, GRAIN, make_single_leaves, b);
    return SPH_OK;
}

/* Area of v's cell and its mean (the vertex itself) per frame. */
static void make_mean(const sph__builder *b, uint32_t v, float *rows)
{
    const size_t s = b->stride;
    const float *p = sph__node_center(b, v);
    memcpy(rows, p, 3 * s * sizeof *rows);
    for (size_t f = 0; f < s; ++f) {
        double area = 0;
        for (size_t i = b->cell_starts[v]; i < b->cell_starts[v + 1]; ++i) {
            const float *x = sph__node_center(b, b->vertex_cells[i][0]), *y = sph__node_center(b, b->vertex_cells[i][1]);
            double e[3], g[3], squared = 0;
            for (unsigned k = 0; k < 3; ++k) {
                e[k] = (double)x[k * s + f] - p[k * s + f];
                g[k] = (double)y[k * s + f] - p[k * s + f];
            }
            for (unsigned k = 0; k < 3; ++k) {
                const double n = e[(k + 1) % 3] * g[(k + 2) % 3] - e[(k + 2) % 3] * g[(k + 1) % 3];
                squared += n * n;
            }
            area += sqrt(squared) / 6;
        }
        rows[3 * s + f] = (float)area;
    }
}

static sph_status make_means(sph__builder *b)
{
    b->means = sph__alloc(b->context, (size_t)b->n, 4 * b->stride * sizeof *b->means);
    if (b->means == NULL) return sph__fail_memory(b->context);
    for (uint32_t v = 0; v < b->n; ++v) make_mean(b, v, b->means + v * 4 * b->stride);
    return SPH_OK;
}

static void fill_range(void *argument, size_t begin, size_t end)
{
    const sph__builder *b = argument;
    for (size_t v = begin; v < end; ++v) sph__fill_leaf(b, (uint32_t)v);
}

/* With radii per frame all leaves have blocks from the start. */
static sph_status make_blocks(sph__builder *b)
{
    enum { GRAIN = 64 };
    for (uint32_t v = 0; v < b->n; ++v)
        if (!sph__blocks_take(&b->blocks, v)) return sph__fail_memory(b->context);
    sph__parallel_for(b->context, b->n, GRAIN, fill_range, b);
    return SPH_OK;
}

sph_status sph__make_leaves(sph__builder *b)
{
    sph_status status = SPH_OK;
    for (uint32_t v = 0; v < b->n; ++v) {
        b->slots[v] = (sph__slot){.node = v, .last = v, .count = 1};
        b->mesh.nodes[v].slot = v;
        b->next_member[v] = SPH__NO_NODE;
        if (b->h->radii_per_frame)
            memset(b->h->radii + v * b->stride, 0, b->stride * sizeof *b->h->radii);
        else
            b->h->radii[v] = 0;
    }
    if (b->single) status = sph__single_leaves(b);
    if (b->h->radii_per_frame) status = make_blocks(b);
    return status == SPH_OK && b->coherence > 0 ? make_means(b) : status;
}

/* --- leaves come and go --- */

void sph__release_leaves(sph__builder *b)
{
    if (++b->pin != 0) return;
    for (uint32_t v = 0; v < b->n; ++v) b->slots[v].pin = 0;
    b->pin = 1;
}

/* The slot of a leaf whose block is not needed now and was not of late; SPH__NO_NODE where all are held. */
static uint32_t find_idle(sph__builder *b)
{
    for (size_t i = 0; i < 2 * b->leaf_blocks.count; ++i) {
        sph__slot *slot;
        if (b->leaf_hand >= b->leaf_blocks.count) b->leaf_hand = 0;
        slot = &b->slots[b->leaf_blocks.owners[b->leaf_hand++]];
        if (slot->pin == b->pin) continue;
        if (!slot->used) return (uint32_t)(slot - b->slots);
        slot->used = 0;
    }
    return SPH__NO_NODE;
}

sph_status sph__hold_leaf(sph__builder *b, uint32_t node, bool *fresh)
{
    sph__slot *slot;
    uint32_t idle;
    *fresh = false;
    if (node >= b->n || b->single || b->h->radii_per_frame) return SPH_OK;
    slot = &b->slots[node]; /* a leaf is in its own */
    slot->pin = b->pin;
    slot->used = slot->block != NULL;
    if (slot->block != NULL) return SPH_OK;
    *fresh = true;
    idle = b->leaf_blocks.count < b->leaf_capacity ? SPH__NO_NODE : find_idle(b);
    if (idle != SPH__NO_NODE)
        sph__blocks_pass(&b->leaf_blocks, idle, node);
    else if (!sph__blocks_take(&b->leaf_blocks, node))
        return sph__fail_memory(b->context);
    return SPH_OK;
}

void sph__fill_leaf(const sph__builder *b, uint32_t v)
{
    b->slots[v].w = make_leaf(b, v, b->slots[v].block);
}

sph_status sph__need_leaf(sph__builder *b, uint32_t node)
{
    bool fresh;
    const sph_status status = sph__hold_leaf(b, node, &fresh);
    if (status == SPH_OK && fresh) sph__fill_leaf(b, node);
    return status;
}

void sph__limit_leaves(sph__builder *b)
{
    enum { LEAST = 128 };
    const size_t collapses = b->h->collapse_count * b->node_floats * sizeof(float);
    const size_t regions = sph__blocks_bytes(&b->blocks) + collapses, block = b->leaf_blocks.size * sizeof(float);
    const size_t left = regions < b->block_budget ? (b->block_budget - regions) / block : 0;
    b->leaf_capacity = left < LEAST ? LEAST : left;
    while (b->leaf_blocks.count > b->leaf_capacity)
        sph__blocks_give(&b->leaf_blocks, b->leaf_blocks.owners[b->leaf_blocks.count - 1]);
}

sph__region sph__region_of(const sph__builder *b, uint32_t node)
{
    const sph__slot *slot = &b->slots[b->mesh.nodes[node].slot];
    return (sph__region){.block = slot->block,
                         .center = sph__node_center(b, node),
                         .mean = b->means == NULL ? NULL : b->means + b->mesh.nodes[node].slot * 4 * b->stride,
                         .radius = b->h->radii_per_frame ? 0 : (double)b->h->radii[node],
                         .w = slot->w,
                         .b = slot->b,
                         .c = slot->c,
                         .leaf = node < b->n};
}
