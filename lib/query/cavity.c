/* SPDX-License-Identifier: MIT */
/*
 * Containment with cavities as solid: which space is connected to infinity. A grid over the pose: cells that are surely
 * free of the solid as a whole, joined through their faces to the border, are outside. Any other free point is told by
 * a free way to such a cell. So nothing leaks, whatever the thickness; what is called outside has a way there.
 */
#include <float.h>
#include <math.h>

#include "numeric/vector.h"
#include "query/query.h"

enum {
    RESOLUTION = 64,
    BORDER = 2,
    MOST_CELLS = (RESOLUTION + 2 * BORDER) * (RESOLUTION + 2 * BORDER) * (RESOLUTION + 2 * BORDER)
};
enum { MIXED = 0, FREE = 1, OUTSIDE = 2 }; /* FREE: not reached from outside */
enum { DIRECTIONS = 26, CLIMBS = 48, PROBES = 512 };

bool sph__query_cavities_create(sph_query *q)
{
    sph__query_cavities *c = sph__zalloc(q->context, 1, sizeof *c);
    q->cavities = c;
    if (c == NULL) return false;
    c->has_mutex = pthread_mutex_init(&c->mutex, NULL) == 0;
    return c->has_mutex;
}

void sph__query_cavities_destroy(sph_query *q)
{
    sph__query_cavities *c = q->cavities;
    if (c == NULL) return;
    if (c->has_mutex) pthread_mutex_destroy(&c->mutex);
    sph__free(q->context, c->cells);
    sph__free(q->context, c);
    q->cavities = NULL;
}

static size_t index_of(const sph__query_cavities *c, int32_t x, int32_t y, int32_t z)
{
    return ((size_t)z * (size_t)c->size[1] + (size_t)y) * (size_t)c->size[0] + (size_t)x;
}

/* The kind of the cell that x is in; beyond the grid all is outside. */
static int kind_at(const sph__query_cavities *c, const double x[3])
{
    int32_t cell[3];
    for (int k = 0; k < 3; ++k) {
        const double place = (x[k] - c->low[k]) / c->cell;
        if (!(place >= 0 && place < c->size[k])) return OUTSIDE;
        cell[k] = (int32_t)place;
    }
    return c->cells[index_of(c, cell[0], cell[1], cell[2])];
}

/* Marks the free cells of a cube of `side` cells (a power of two), some of which may be beyond the grid. */
static void mark_free(const sph_query *q, sph__query_cavities *c, const int32_t at[3], int32_t side)
{
    const double reach = 0.5 * side * c->cell, diagonal = sqrt(3.0) * reach * (1 + 1e-9);
    double x[3], distance;
    uint32_t slot;
    for (int k = 0; k < 3; ++k) {
        if (at[k] >= c->size[k]) return;
        x[k] = c->low[k] + at[k] * c->cell + reach;
    }
    distance = sph__query_distance(q, x, &slot);
    if (distance < -diagonal) return;
    if (distance > diagonal) {
        for (int32_t z = at[2]; z < at[2] + side && z < c->size[2]; ++z)
            for (int32_t y = at[1]; y < at[1] + side && y < c->size[1]; ++y)
                for (int32_t i = at[0]; i < at[0] + side && i < c->size[0]; ++i)
                    c->cells[index_of(c, i, y, z)] = FREE;
        return;
    }
    for (int part = 0; part < 8 && side > 1; ++part) {
        const int32_t half = side / 2;
        const int32_t to[3] = {at[0] + (part & 1) * half, at[1] + (part >> 1 & 1) * half, at[2] + (part >> 2) * half};
        mark_free(q, c, to, half);
    }
}

static void mark_border(sph__query_cavities *c)
{
    for (int32_t z = 0; z < c->size[2]; ++z)
        for (int32_t y = 0; y < c->size[1]; ++y)
            for (int32_t x = 0; x < c->size[0]; ++x)
                if (x == 0 || y == 0 || z == 0 || x == c->size[0] - 1 || y == c->size[1] - 1 || z == c->size[2] - 1)
                    c->cells[index_of(c, x, y, z)] = OUTSIDE;
}

/* From cells that are outside to free ones beside them, up and down the rows until nothing changes. */
static void spread(sph__query_cavities *c)
{
    const ptrdiff_t step[3] = {1, c->size[0], (ptrdiff_t)c->size[0] * c->size[1]};
    const ptrdiff_t first = step[0] + step[1] + step[2], last = step[2] * c->size[2] - 1 - first;
    bool changed = true;
    while (changed) {
        changed = false;
        for (int back = 0; back < 2; ++back)
            for (ptrdiff_t n = first; n <= last; ++n) {
                const ptrdiff_t i = back ? last + first - n : n;
                const uint8_t *cell = c->cells + i;
                if (*cell != FREE) continue;
                if (cell[-1] != OUTSIDE && cell[1] != OUTSIDE && cell[-step[1]] != OUTSIDE &&
                    cell[step[1]] != OUTSIDE && cell[-step[2]] != OUTSIDE && cell[step[2]] != OUTSIDE)
                    continue;
                c->cells[i] = OUTSIDE;
                changed = true;
            }
    }
}

/* Walks from x to where the solid is hit; the first kind of cell on the way that is not mixed. */
static int look(const sph_query *q, const double x[3], const double direction[3])
{
    const sph__query_cavities *c = q->cavities;
    double to[3], t, length;
    int kind = MIXED;
    sph__add_scaled(x, 4 / sph__norm(direction), direction, to); /* the solid is within [-1, 1]^3 */
    if (!sph__query_cast_frame(q, x, to, &t)) return OUTSIDE;
    length = 4 * t;
    for (double s = 0.5 * c->cell; s < length && kind == MIXED; s += 0.5 * c->cell) {
        double y[3];
        sph__add_scaled(x, s / sph__norm(direction), direction, y);
        kind = kind_at(c, y);
    }
    return kind;
}

/* One of the directions to the neighbours of a cell. */
static void choose_direction(int number, double out[3])
{
    const int code = number < 13 ? number : number + 1; /* 13 is the middle */
    out[0] = code % 3 - 1;
    out[1] = code / 3 % 3 - 1;
    out[2] = code / 9 - 1;
}

/* Looks out of some of the cells that were not reached: passages that are narrower than cells. */
static void look_out(const sph_query *q, sph__query_cavities *c)
{
    const size_t count = (size_t)c->size[0] * (size_t)c->size[1] * (size_t)c->size[2];
    size_t left = 0, every, seen = 0;
    for (size_t i = 0; i < count; ++i)
        left += c->cells[i] == FREE;
    every = left / PROBES + 1;
    for (size_t i = 0; i < count; ++i) {
        double x[3];
        if (c->cells[i] != FREE || seen++ % every != 0) continue;
        x[0] = c->low[0] + ((double)(i % (size_t)c->size[0]) + 0.5) * c->cell;
        x[1] = c->low[1] + ((double)(i / (size_t)c->size[0] % (size_t)c->size[1]) + 0.5) * c->cell;
        x[2] = c->low[2] + ((double)(i / (size_t)c->size[0] / (size_t)c->size[1]) + 0.5) * c->cell;
        c->cells[i] = MIXED; /* so as not to be seen by itself */
        for (int number = 0; number < DIRECTIONS; ++number) {
            double direction[3];
            choose_direction(number, direction);
            if (look(q, x, direction) != OUTSIDE) continue;
            c->cells[i] = OUTSIDE;
            spread(c);
            break;
        }
        if (c->cells[i] == MIXED) c->cells[i] = FREE;
    }
}

static sph_status make(const sph_query *q, sph__query_cavities *c)
{
    const int32_t origin[3] = {0, 0, 0};
    const double most = fmax(q->half[0], fmax(q->half[1], q->half[2]));
    int32_t side = 1;
    if (c->cells == NULL) c->cells = sph__alloc(q->context, MOST_CELLS, 1);
    if (c->cells == NULL) return sph__fail_memory(q->context);
    c->cell = most > 0 ? 2 * most / RESOLUTION : 1;
    for (int k = 0; k < 3; ++k) {
        const double cells = ceil(2 * q->half[k] / c->cell * (1 - 1e-9));
        c->size[k] = (int32_t)fmin(cells, RESOLUTION) + 2 * BORDER;
        c->low[k] = -0.5 * c->size[k] * c->cell;
        while (side < c->size[k])
            side *= 2;
    }
    memset(c->cells, MIXED, (size_t)c->size[0] * (size_t)c->size[1] * (size_t)c->size[2]);
    mark_free(q, c, origin, side);
    mark_border(c);
    spread(c);
    look_out(q, c);
    return SPH_OK;
}

static sph_status ensure(const sph_query *q)
{
    sph__query_cavities *c = q->cavities;
    sph_status status = SPH_OK;
    if (atomic_load_explicit(&c->pose, memory_order_acquire) == q->pose) return SPH_OK;
    pthread_mutex_lock(&c->mutex);
    if (atomic_load_explicit(&c->pose, memory_order_relaxed) != q->pose) {
        status = make(q, c);
        if (status == SPH_OK) atomic_store_explicit(&c->pose, q->pose, memory_order_release);
    }
    pthread_mutex_unlock(&c->mutex);
    return status;
}

/* The kind of cell that a free point's climb away from the solid leads to. */
static int climb(const sph_query *q, double x[3])
{
    int kind = MIXED;
    double before = 0;
    for (int i = 0; i < CLIMBS && kind == MIXED; ++i) {
        sph__contact contact;
        uint32_t slot;
        const double distance = sph__query_distance(q, x, &slot);
        if (!(distance > 0)) return MIXED;
        sph__primitive_closest(&q->solid.primitives[slot], x, &contact);
        sph__add_scaled(x, (distance > 1.5 * before ? 0.9 : 0.5) * distance, contact.normal, x);
        before = distance;
        kind = kind_at(q->cavities, x);
    }
    return kind;
}

/* Is the free point x connected to infinity? */
static bool is_outside(const sph_query *q, const double x[3], const double normal[3])
{
    double y[3];
    int kind = kind_at(q->cavities, x);
    if (kind == MIXED) kind = look(q, x, normal);
    if (kind == MIXED) {
        sph__copy3(x, y);
        kind = climb(q, y);
    }
    for (int number = 0; number < DIRECTIONS && kind == MIXED; ++number) {
        double direction[3];
        choose_direction(number, direction);
        kind = look(q, x, direction);
        if (kind == MIXED) kind = look(q, y, direction);
    }
    return kind == OUTSIDE;
}

sph_status sph_query_contains(const sph_query *q, const float *points, size_t stride, size_t count, int32_t cavities,
                              uint8_t *inside)
{
    SPH__OWN(q, SPH__QUERY);
    sph_status status;
    if (q == NULL || (inside == NULL && count != 0))
        return sph__fail(q == NULL ? NULL : q->context, SPH_E_INVALID, "sph_query_contains: an argument is NULL");
    if (cavities != SPH_CAVITY_SOLID && cavities != SPH_CAVITY_SPACE)
        return sph__fail(q->context, SPH_E_INVALID, "sph_query_contains: cavities is %d", (int)cavities);
    if ((status = sph__query_check_points(q, "sph_query_contains", points, &stride, count)) != SPH_OK) return status;
    if (cavities == SPH_CAVITY_SOLID && count != 0 && (status = ensure(q)) != SPH_OK) return status;
    for (size_t i = 0; i < count; ++i) {
        sph__contact contact;
        uint32_t slot;
        float f[3];
        double x[3];
        memcpy(f, (const char *)points + i * stride, sizeof f);
        sph__query_to_frame(q, (const double[3]){f[0], f[1], f[2]}, x);
        if (cavities == SPH_CAVITY_SPACE) {
            inside[i] = sph__query_covers(q, x, 0);
            continue;
        }
        if (fabs(x[0]) > q->half[0] || fabs(x[1]) > q->half[1] || fabs(x[2]) > q->half[2]) {
            inside[i] = 0;
            continue;
        }
        inside[i] = sph__query_distance(q, x, &slot) <= 0;
        if (inside[i]) continue;
        sph__primitive_closest(&q->solid.primitives[slot], x, &contact);
        inside[i] = !is_outside(q, x, contact.normal);
    }
    return SPH_OK;
}
