/* SPDX-License-Identifier: MIT */
#include "surface/surface.h"

#include "numeric/vector.h"

enum { GROUP = 8, BATCH = 256, MOST_NEAR = 64 };

/*
 * From the middle of a brick's points to the farthest of them, in cells, and one edge more: beyond it nothing matters
 * to the brick. The same for a group of 8^3 bricks.
 */
static const double BRICK_MIDDLE = 3.75, BRICK_REACH = 7.6, GROUP_MIDDLE = 31.75, GROUP_REACH = 56.1;

void *sph__memory_allocate(sph__memory *memory, size_t count, size_t size, sph_status *status)
{
    size_t bytes;
    void *block;
    if (!sph__multiply_size(count, size, &bytes) || bytes > memory->limit - memory->used) {
        *status = sph__fail(memory->context, SPH_E_LIMIT,
                            "the surface at resolution %u needs more than %llu bytes (memory_limit)",
                            (unsigned)memory->resolution, (unsigned long long)memory->limit);
        return NULL;
    }
    block = sph__alloc(memory->context, count, size);
    if (block == NULL)
        *status = sph__fail_memory(memory->context);
    else
        memory->used += bytes;
    return block;
}

void sph__memory_free(sph__memory *memory, void *block, size_t count, size_t size)
{
    if (block == NULL) return;
    memory->used -= (uint64_t)count * size;
    sph__free(memory->context, block);
}

/* --- loops that report --- */

typedef struct part {
    sph__grid_body *body;
    void *argument;
    size_t offset;
} part;

static void run_part(void *argument, size_t begin, size_t end)
{
    const part *p = argument;
    p->body(p->argument, p->offset + begin, p->offset + end);
}

sph_status sph__grid_loop(sph__grid *grid, size_t count, size_t grain, sph__grid_body *body, void *argument,
                          double from, double to)
{
    const size_t step = BATCH * grain;
    for (size_t begin = 0; begin < count; begin += step) {
        part p = {body, argument, begin};
        const size_t left = count - begin;
        const sph_status status =
            sph__progress_report(grid->progress, "surface", from + (to - from) * (double)begin / (double)count);
        if (status != SPH_OK) return status;
        sph__parallel_for(grid->context, left < step ? left : step, grain, run_part, &p);
    }
    return SPH_OK;
}

/* --- places --- */

int32_t sph__grid_state(const sph__grid *grid, int64_t x, int64_t y, int64_t z)
{
    const uint32_t *size = grid->size;
    if (x < 0 || y < 0 || z < 0 || x >= size[0] || y >= size[1] || z >= size[2]) return SPH__BRICK_OUTER;
    return grid->table[((size_t)z * size[1] + (size_t)y) * size[0] + (size_t)x];
}

void sph__grid_point(const sph__grid *grid, const sph__brick *brick, int kind, int x, int y, int z, double point[3])
{
    const int local[3] = {x, y, z};
    for (int k = 0; k < 3; ++k)
        point[k] = grid->origin[k] + grid->cell * ((double)SPH__BRICK_SIDE * brick->at[k] + local[k] + 0.5 * kind);
}

static uint64_t outer_layer(const sph__grid *grid, int64_t x, int64_t y, int64_t z, int kind, int layer)
{
    const int32_t state = sph__grid_state(grid, x, y, z);
    if (state >= 0) return grid->bricks[state].outer[kind][layer];
    return state == SPH__BRICK_OUTER ? UINT64_MAX : 0;
}

void sph__grid_rows(const sph__grid *grid, const uint32_t at[3], sph__brick_rows rows)
{
    for (int kind = 0; kind < 2; ++kind)
        for (int z = -1; z <= 8; ++z)
            for (int side = -1; side <= 1; ++side) {
                const int64_t by = (int64_t)at[1] + side, bz = (int64_t)at[2] + (z < 0 ? -1 : z > 7);
                const uint64_t left = outer_layer(grid, (int64_t)at[0] - 1, by, bz, kind, z & 7);
                const uint64_t middle = outer_layer(grid, at[0], by, bz, kind, z & 7);
                const uint64_t right = outer_layer(grid, (int64_t)at[0] + 1, by, bz, kind, z & 7);
                for (int y = side < 0 ? 7 : 0; y <= (side > 0 ? 0 : 7); ++y)
                    rows[kind][z + 1][y + 8 * side + 1] =
                        (uint16_t)((left >> (8 * y + 7) & 1) | (middle >> (8 * y) & 255) << 1 |
                                   (right >> (8 * y) & 1) << 9);
            }
}

/* --- which bricks the surface may cross --- */

static int32_t judge(const sph__grid *grid, const double corner[3], double middle, double reach)
{
    double x[3], d;
    for (int k = 0; k < 3; ++k)
        x[k] = grid->origin[k] + grid->cell * (corner[k] + middle);
    d = sph__solid_distance(grid->solid, x, NULL);
    if (d > reach * grid->cell) return SPH__BRICK_OPEN;
    return d < -reach * grid->cell ? SPH__BRICK_SOLID : SPH__BRICK_MIXED;
}

static uint32_t groups_along(const sph__grid *grid, int axis)
{
    return (grid->size[axis] + GROUP - 1) / GROUP;
}

static void judge_group(sph__grid *grid, const uint32_t first[3])
{
    const double corner[3] = {8.0 * first[0], 8.0 * first[1], 8.0 * first[2]};
    const int32_t all = judge(grid, corner, GROUP_MIDDLE, GROUP_REACH);
    const uint32_t *size = grid->size;
    for (uint32_t z = first[2]; z < first[2] + GROUP && z < size[2]; ++z)
        for (uint32_t y = first[1]; y < first[1] + GROUP && y < size[1]; ++y)
            for (uint32_t x = first[0]; x < first[0] + GROUP && x < size[0]; ++x) {
                const double own[3] = {8.0 * x, 8.0 * y, 8.0 * z};
                grid->table[((size_t)z * size[1] + y) * size[0] + x] =
                    all != SPH__BRICK_MIXED ? all : judge(grid, own, BRICK_MIDDLE, BRICK_REACH);
            }
}

static void judge_groups(void *argument, size_t begin, size_t end)
{
    sph__grid *grid = argument;
    const size_t nx = groups_along(grid, 0), ny = groups_along(grid, 1);
    for (size_t i = begin; i < end; ++i) {
        const uint32_t first[3] = {(uint32_t)(GROUP * (i % nx)), (uint32_t)(GROUP * (i / nx % ny)),
                                   (uint32_t)(GROUP * (i / nx / ny))};
        judge_group(grid, first);
    }
}

static sph_status make_table(sph__grid *grid)
{
    const uint64_t layer = (uint64_t)grid->size[0] * grid->size[1]; /* sizes are a few thousand at the most */
    const size_t groups = (size_t)groups_along(grid, 0) * groups_along(grid, 1) * groups_along(grid, 2);
    sph_status status = SPH_OK;
    if (layer * grid->size[2] > INT32_MAX)
        return sph__fail(grid->context, SPH_E_LIMIT, "resolution %u: too many cells",
                         (unsigned)grid->memory->resolution);
    grid->table_count = (uint32_t)(layer * grid->size[2]);
    grid->table = sph__memory_allocate(grid->memory, grid->table_count, sizeof *grid->table, &status);
    if (grid->table == NULL) return status;
    return sph__grid_loop(grid, groups, 1, judge_groups, grid, 0, 0.2);
}

static sph_status make_bricks(sph__grid *grid)
{
    sph_status status = SPH_OK;
    uint32_t count = 0;
    for (uint32_t i = 0; i < grid->table_count; ++i)
        if (grid->table[i] == SPH__BRICK_MIXED) ++count;
    grid->bricks = sph__memory_allocate(grid->memory, count, sizeof *grid->bricks, &status);
    if (grid->bricks == NULL) return status;
    grid->brick_count = count;
    count = 0;
    for (uint32_t i = 0; i < grid->table_count; ++i) {
        sph__brick *brick = &grid->bricks[count];
        if (grid->table[i] != SPH__BRICK_MIXED) continue;
        memset(brick, 0, sizeof *brick);
        brick->at[0] = i % grid->size[0];
        brick->at[1] = i / grid->size[0] % grid->size[1];
        brick->at[2] = i / grid->size[0] / grid->size[1];
        grid->table[i] = (int32_t)count++;
    }
    return SPH_OK;
}

/* --- which points of theirs the solid covers --- */

/* The primitives that can cover a point of a brick, the last one that did first. */
typedef struct nearby {
    const sph__solid *solid;
    uint32_t count; /* more than MOST_NEAR: they are not all here */
    uint32_t items[MOST_NEAR];
} nearby;

static bool covers(nearby *near, const double x[3])
{
    if (near->count > MOST_NEAR) return sph__solid_covers(near->solid, x, 0, NULL);
    for (uint32_t i = 0; i < near->count; ++i) {
        const uint32_t p = near->items[i];
        if (sph__primitive_distance(&near->solid->primitives[p], x) >= 0) continue;
        near->items[i] = near->items[0];
        near->items[0] = p;
        return true;
    }
    return false;
}

static void sample_brick(const sph__grid *grid, sph__brick *brick)
{
    nearby near = {.solid = grid->solid};
    double middle[3];
    for (int k = 0; k < 3; ++k)
        middle[k] = grid->origin[k] + grid->cell * ((double)SPH__BRICK_SIDE * brick->at[k] + BRICK_MIDDLE);
    near.count = sph__solid_gather(grid->solid, middle, BRICK_REACH * grid->cell, near.items, MOST_NEAR);
    for (int kind = 0; kind < 2; ++kind)
        for (int z = 0; z < 8; ++z)
            for (int i = 0; i < 64; ++i) {
                double x[3];
                sph__grid_point(grid, brick, kind, i & 7, i >> 3, z, x);
                if (!covers(&near, x)) brick->open[kind][z] |= UINT64_C(1) << i;
            }
}

static void sample_bricks(void *argument, size_t begin, size_t end)
{
    const sph__grid *grid = argument;
    for (size_t i = begin; i < end; ++i)
        sample_brick(grid, &grid->bricks[i]);
}

sph_status sph__grid_sample(sph__grid *grid)
{
    sph_status status = make_table(grid);
    if (status == SPH_OK) status = make_bricks(grid);
    if (status == SPH_OK) status = sph__grid_loop(grid, grid->brick_count, 4, sample_bricks, grid, 0.2, 0.6);
    return status;
}

void sph__grid_free(sph__grid *grid)
{
    sph__memory_free(grid->memory, grid->table, grid->table_count, sizeof *grid->table);
    sph__memory_free(grid->memory, grid->bricks, grid->brick_count, sizeof *grid->bricks);
    grid->table = NULL;
    grid->bricks = NULL;
}
