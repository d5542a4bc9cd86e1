/* SPDX-License-Identifier: MIT */
/*
 * Which free points are joined to infinity: bricks wait in a queue; one that has its turn takes over what is outer
 * around it, spreads it within, and wakes its neighbours when it has changed. The outcome is a set, whatever the order.
 */
#include "surface/surface.h"

typedef struct queue {
    uint32_t *items; /* a ring with room for every brick */
    bool *waiting;   /* of each brick of the table: is it in the ring? */
    uint32_t capacity, first, count;
} queue;

static void push(queue *q, uint32_t brick)
{
    const uint64_t end = (uint64_t)q->first + q->count++;
    q->items[end % q->capacity] = brick;
    q->waiting[brick] = true;
}

static uint32_t pop(queue *q)
{
    const uint32_t brick = q->items[q->first];
    q->first = q->first + 1 == q->capacity ? 0 : q->first + 1;
    --q->count;
    q->waiting[brick] = false;
    return brick;
}

/* Everything beside the points of one row: their six neighbours of the same kind and eight of the other. */
static unsigned row_and_around(sph__brick_rows rows, int kind, int z, int y)
{
    unsigned all = rows[kind][z][y];
    all |= all << 1 | all >> 1;
    all |= rows[kind][z - 1][y] | rows[kind][z + 1][y] | rows[kind][z][y - 1] | rows[kind][z][y + 1];
    for (int dz = 0; dz < 2; ++dz)
        for (int dy = 0; dy < 2; ++dy) { /* the centres of a corner are before it, the corners of a centre after it */
            const unsigned other = rows[1 - kind][z + dz - 1 + kind][y + dy - 1 + kind];
            all |= other | (kind == 0 ? other << 1 : other >> 1);
        }
    return all;
}

/* Spreads the outer points of the rows over the open ones of the brick; `open` NULL: all are. */
static bool spread(sph__brick_rows rows, const uint64_t (*open)[8])
{
    bool any = false, changed = true;
    while (changed) { /* every round but the last adds a point */
        changed = false;
        for (int kind = 0; kind < 2; ++kind)
            for (int z = 1; z <= 8; ++z)
                for (int y = 1; y <= 8; ++y) {
                    const unsigned free = open == NULL ? 255 : open[kind][z - 1] >> (8 * (y - 1)) & 255;
                    const unsigned now = rows[kind][z][y];
                    const unsigned then = now | (row_and_around(rows, kind, z, y) & free << 1);
                    if (then == now) continue;
                    rows[kind][z][y] = (uint16_t)then;
                    any = changed = true;
                }
    }
    return any;
}

static void store(sph__brick *brick, sph__brick_rows rows)
{
    for (int kind = 0; kind < 2; ++kind)
        for (int z = 0; z < 8; ++z) {
            uint64_t layer = 0;
            for (int y = 0; y < 8; ++y)
                layer |= (uint64_t)(rows[kind][z + 1][y + 1] >> 1 & 255) << (8 * y);
            brick->outer[kind][z] = layer;
        }
}

/* True where the brick has changed. */
static bool visit(sph__grid *grid, uint32_t index, const uint32_t at[3])
{
    const int32_t state = grid->table[index];
    sph__brick_rows rows;
    if (state != SPH__BRICK_OPEN && state < 0) return false;
    sph__grid_rows(grid, at, rows);
    if (!spread(rows, state >= 0 ? (const uint64_t(*)[8])grid->bricks[state].open : NULL)) return false;
    if (state >= 0)
        store(&grid->bricks[state], rows);
    else
        grid->table[index] = SPH__BRICK_OUTER;
    return true;
}

static void wake_neighbours(const sph__grid *grid, const uint32_t at[3], queue *q)
{
    for (int i = 0; i < 27; ++i) {
        const int64_t x = (int64_t)at[0] + i % 3 - 1, y = (int64_t)at[1] + i / 3 % 3 - 1,
                      z = (int64_t)at[2] + i / 9 - 1;
        const int32_t state = sph__grid_state(grid, x, y, z);
        uint32_t index;
        if (i == 13 || state == SPH__BRICK_OUTER || state == SPH__BRICK_SOLID) continue;
        index = (uint32_t)((z * grid->size[1] + y) * grid->size[0] + x);
        if (!q->waiting[index]) push(q, index);
    }
}

static void place_of(const sph__grid *grid, uint32_t index, uint32_t at[3])
{
    at[0] = index % grid->size[0];
    at[1] = index / grid->size[0] % grid->size[1];
    at[2] = index / grid->size[0] / grid->size[1];
}

static bool is_at_the_border(const sph__grid *grid, const uint32_t at[3])
{
    for (int k = 0; k < 3; ++k)
        if (at[k] == 0 || at[k] + 1 == grid->size[k]) return true;
    return false;
}

static sph_status run(sph__grid *grid, queue *q)
{
    enum { REPORT = 4096 };
    uint32_t at[3];
    memset(q->waiting, 0, grid->table_count * sizeof *q->waiting);
    for (uint32_t i = 0; i < grid->table_count; ++i) {
        place_of(grid, i, at);
        if (is_at_the_border(grid, at)) push(q, i);
    }
    for (uint64_t turn = 0; q->count > 0; ++turn) {
        const uint32_t index = pop(q);
        place_of(grid, index, at);
        if (visit(grid, index, at)) wake_neighbours(grid, at, q);
        if (turn % REPORT == 0) {
            const sph_status status = sph__progress_report(grid->progress, "surface", 0.6);
            if (status != SPH_OK) return status;
        }
    }
    return SPH_OK;
}

sph_status sph__grid_flood(sph__grid *grid)
{
    const uint32_t count = grid->table_count;
    sph_status status = SPH_OK;
    queue q = {.capacity = count};
    q.items = sph__memory_allocate(grid->memory, count, sizeof *q.items, &status);
    if (q.items != NULL) q.waiting = sph__memory_allocate(grid->memory, count, sizeof *q.waiting, &status);
    if (q.waiting != NULL) status = run(grid, &q);
    sph__memory_free(grid->memory, q.waiting, count, sizeof *q.waiting);
    sph__memory_free(grid->memory, q.items, count, sizeof *q.items);
    return status;
}
