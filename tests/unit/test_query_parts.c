/* SPDX-License-Identifier: MIT */
/*
 * The 32-bit bounds of casts never lose a hit and never begin later than it: against Newton's method on the distance of
 * every primitive, from the segment's beginning on, without any bound.
 */
#include <check.h>
#include <math.h>
#include <string.h>

#include "query/query.h"
#include "runner.h"
#include "support.h"

enum { SPHERES = 12, EDGES = 4, TRIANGLES = 6, RAYS = 256, SOLIDS = 30, SLOTS = 64, SIDE = SPH__QUERY_SIDE };

static sph_context *context;
static uint64_t state;
static float centers[SPHERES][3], radii[SPHERES];
static uint32_t edges[EDGES][2], triangles[TRIANGLES][3];
typedef struct move {
    double start[3], way[3], radius, tolerance;
} move;

static move moves[RAYS];
static sph__query_aim aims[RAYS]; /* in lane 0 */
static sph__query_line lines[RAYS];
static float waves[SLOTS][RAYS]; /* keys side by side; SPH__QUERY_MISS: none */
static bool is_met[SLOTS][RAYS], is_begun[SLOTS][RAYS];

static const double SCALES[] = {1, 1e-30, 1e30, 1e-4, 3e5};

static double between(double low, double high)
{
    return low + (high - low) * test_random_unit(&state);
}

static uint32_t below(uint32_t count)
{
    return (uint32_t)(test_random(&state) % count);
}

static void random_spheres(double scale)
{
    for (uint32_t i = 0; i < SPHERES; ++i) {
        const uint32_t other = below(i + 1);
        const double far = below(3) ? 0.3 : 1;
        double r = below(3) ? between(0, 0.3) : pow(10, between(-9, 0));
        for (int k = 0; k < 3; ++k)
            centers[i][k] = (float)(scale * between(-far, far));
        switch (below(8)) {
        case 0:
            r = 0;
            break;
        case 1:
            memcpy(centers[i], centers[other], sizeof *centers);
            break;
        case 2: /* nearly in one place, or a sliver later */
            for (int k = 0; k < 3; ++k)
                centers[i][k] = centers[other][k] + (float)(scale * between(-1e-5, 1e-5));
            break;
        default:
            break;
        }
        radii[i] = below(10) == 0 ? radii[other] : (float)(scale * r);
    }
}

static sph_query *random_query(double scale, int32_t search)
{
    const sph_level_arrays arrays = {.struct_size = sizeof arrays,
                                     .sphere_count = SPHERES,
                                     .frame_count = 1,
                                     .centers = centers[0],
                                     .radii = radii,
                                     .edge_count = EDGES,
                                     .edges = edges[0],
                                     .triangle_count = TRIANGLES,
                                     .triangles = triangles[0]};
    sph_query_options options;
    sph_level *level = NULL;
    sph_query *q = NULL;
    random_spheres(scale);
    for (uint32_t i = 0; i < EDGES; ++i)
        edges[i][1] = (edges[i][0] = below(SPHERES - 1)) + 1;
    for (uint32_t i = 0; i < TRIANGLES; ++i)
        for (uint32_t k = 0; k < 3; ++k)
            triangles[i][k] = (triangles[i][0] + k * (1 + below(3))) % SPHERES;
    for (uint32_t i = 0; i < TRIANGLES; ++i)
        triangles[i][0] = below(SPHERES);
    sph_query_options_init(&options, sizeof options);
    options.search = search;
    ck_assert_int_eq(sph_level_create_from_arrays(context, &arrays, &level), SPH_OK);
    ck_assert_int_eq(sph_query_create(level, &options, &q), SPH_OK);
    sph_level_destroy(level);
    return q;
}

static void random_direction(double d[3])
{
    double length;
    do {
        for (int k = 0; k < 3; ++k)
            d[k] = between(-1, 1);
        length = sph__norm(d);
    } while (length > 1 || length < 0.1);
    for (int k = 0; k < 3; ++k)
        d[k] /= length;
}

/* Past the surface of a primitive, nearer and nearer; or anywhere. */
static void random_move(const sph_query *q, move *m)
{
    static const double OFF[] = {0, 1e-15, -1e-13, 1e-9, -1e-7, 1e-6, -1e-5, 1e-4, -1e-3};
    const sph__primitive *p = &q->solid.primitives[below(q->primitive_count)];
    double x[3], d[3], length = below(4) ? between(0.5, 3) : pow(10, between(-14, 0)), before = between(0, length);
    sph__contact c;
    m->radius = below(3) ? 0 : below(2) ? between(0, 0.1) : pow(10, between(-3, 2));
    for (int k = 0; k < 3; ++k)
        x[k] = between(-1, 1);
    random_direction(d);
    sph__primitive_closest(p, x, &c);
    if (below(4) != 0) {
        double off = OFF[below(9)], slope = sph__dot(d, c.normal);
        if (below(4) == 0) /* along the edge, or nearly */
            sph__add_scaled(p->edge[0].axis, between(-1e-2, 1e-2), d, d);
        slope = sph__dot(d, c.normal) * (1 - (below(2) ? 0 : between(-1e-6, 1e-6)));
        sph__add_scaled(d, -slope, c.normal, d);
        sph__add_scaled(c.point, m->radius + off, c.normal, x);
    }
    for (int k = 0; k < 3; ++k) {
        m->start[k] = x[k] - before * d[k];
        m->way[k] = length * d[k];
    }
    m->tolerance = 1e-14 * (1 + m->radius);
}

/* The first t at which it touches; above 1: never. */
static double first_touch(const sph__primitive *p, const move *m)
{
    double t = 0;
    for (int step = 0; step < 200 && t <= 1; ++step) {
        double x[3], slope, distance;
        sph__add_scaled(m->start, t, m->way, x);
        distance = sph__primitive_slope(p, x, m->way, &slope) - m->radius;
        if (distance <= m->tolerance) return t;
        if (slope >= 0) return 2;
        t -= distance / slope;
    }
    return 2;
}

/* Cuts the move to where it is near; false: it is not. */
static bool aim(const sph_query *q, uint32_t i)
{
    sph__query_room room = {.scale = q->scale};
    move *m = &moves[i];
    double from[3], to[3];
    memcpy(room.origin, q->origin, sizeof room.origin);
    memcpy(room.half, q->half, sizeof room.half);
    memcpy(from, m->start, sizeof from);
    for (int k = 0; k < 3; ++k)
        to[k] = from[k] + m->way[k];
    if (!sph__query_aim_one(&aims[i], &room, from, to, m->radius)) return false;
    for (int k = 0; k < 3; ++k) {
        m->way[k] = aims[i].span[0] * (to[k] - from[k]);
        m->start[k] = from[k] + aims[i].start[0] * (to[k] - from[k]);
    }
    sph__query_aim_line(&aims[i], &lines[i]);
    return true;
}

static void make_rays(const sph_query *q)
{
    for (uint32_t i = 0; i < RAYS; ++i) {
        do
            random_move(q, &moves[i]);
        while (!aim(q, i));
    }
}

/* Of a line and primitive: is its bound met, and does the line begin in it? */
static bool has_bit(const sph_query *q, const uint64_t *masks, uint32_t slot)
{
    uint32_t leaf = 0;
    while (q->twigs[2 * leaf + 2] <= slot)
        ++leaf;
    return masks[0] >> (SPH__QUERY_LANES * leaf + slot - q->twigs[2 * leaf]) & 1;
}

static void ask_bounds(const sph_query *q, uint32_t i)
{
    uint64_t met[SPH__QUERY_AIM], begun[SPH__QUERY_AIM];
    ck_assert_uint_le(q->leaf_count, SPH__QUERY_LEAVES);
    sph__query_wave_meet(q->leaf_bounds, &aims[i], ((uint64_t)1 << q->leaf_count) - 1, met, begun);
    for (uint32_t slot = 0; slot < q->primitive_count; ++slot) {
        is_met[slot][i] = has_bit(q, met, slot);
        is_begun[slot][i] = has_bit(q, begun, slot);
    }
}

typedef void ask_fn(const sph__query_parts *, const sph__query_line *, const uint8_t *, sph__query_called *);

/* The keys of 16 lines; fewer may go another way. */
static void ask_side(ask_fn *ask, const sph__query_parts *parts, const uint8_t *which, float limit, float *keys)
{
    sph__query_called called = {.count = SIDE}, some;
    ask(parts, lines, which, &called);
    some.count = 1 + below(SIDE);
    ask(parts, lines, which, &some);
    memcpy(keys, called.keys, sizeof called.keys);
    for (uint32_t k = 0; k < SIDE; ++k) {
        ck_assert_uint_eq(called.listed >> k & 1, keys[k] <= limit);
        ck_assert_uint_eq(some.listed >> k & 1, k < some.count && keys[k] <= limit);
        if (k < some.count) ck_assert_float_eq(some.keys[k], keys[k]);
    }
}

/* Keys of all primitives and lines. */
static void ask_wave(const sph_query *q)
{
    for (uint32_t i = 0; i < RAYS; ++i)
        ask_bounds(q, i);
    for (uint32_t i = 0; i < RAYS; i += SIDE) {
        uint8_t which[SIDE];
        for (uint32_t k = 0; k < SIDE; ++k)
            which[k] = (uint8_t)(i + k);
        for (uint32_t slot = 0; slot < q->primitive_count; ++slot) {
            float within[SIDE], ahead[SIDE];
            ask_side(sph__query_wave_begin, &q->parts[slot], which, 0, within);
            ask_side(sph__query_wave_touch, &q->parts[slot], which, 1, ahead);
            for (uint32_t k = 0; k < SIDE; ++k)
                waves[slot][i + k] = is_begun[slot][i + k] && within[k] <= 0 ? within[k]
                                     : is_met[slot][i + k]                   ? ahead[k]
                                                                             : SPH__QUERY_MISS;
        }
    }
}

static void set_ray(const sph__query_aim *a, sph__query_ray *ray)
{
    for (int k = 0; k < 3; ++k) {
        ray->above[k] = a->above[k][0];
        ray->below[k] = a->below[k][0];
        ray->inverse[k] = a->inverse[k][0];
        ray->from[k] = a->place[k][0];
        ray->way[k] = a->slope[k][0];
    }
    ray->reach = a->reach[0];
}

/* What a single ray is told; returns how many it may touch, whose keys are in `keys`. */
static uint32_t ask_alone(const sph_query *q, uint32_t i, float keys[SLOTS])
{
    sph__query_ray ray;
    uint32_t met[SPH__QUERY_CHUNK], count, kept = 0, found = 0;
    float entry[SPH__QUERY_CHUNK], ahead[SPH__QUERY_CHUNK];
    for (uint32_t slot = 0; slot < q->primitive_count; ++slot)
        keys[slot] = SPH__QUERY_MISS;
    set_ray(&aims[i], &ray);
    count = sph__query_kernel_meet(&q->bounds, 0, q->primitive_count, &ray, met, entry);
    for (uint32_t k = 0; k < count; ++k) {
        const uint32_t slot = met[k];
        const bool begins = entry[k] <= 0 && sph__query_begins_in_slab(&q->bounds, slot, &ray);
        ck_assert_int_eq(begins, is_begun[slot][i]);
        if (begins) sph__query_parts_begin(q->parts, &lines[i], &slot, 1, &keys[slot]);
        if (begins && keys[slot] <= 0) {
            ++found;
            continue;
        }
        keys[slot] = SPH__QUERY_MISS;
        met[kept] = slot;
        entry[kept++] = entry[k];
    }
    kept = sph__query_fan_enter(q->fans, &ray, entry, met, kept, 1);
    sph__query_parts_touch(q->parts, &lines[i], met, kept, ahead);
    for (uint32_t k = 0; k < kept; ++k) {
        keys[met[k]] = ahead[k];
        found += ahead[k] <= 1;
    }
    return found;
}

/* Every primitive that is touched is listed, no later; returns how many there are. */
static size_t check_ray(const sph_query *q, uint32_t i, size_t *kept)
{
    float keys[SLOTS];
    size_t hits = 0;
    *kept += ask_alone(q, i, keys);
    for (uint32_t slot = 0; slot < q->primitive_count; ++slot) {
        const double t = first_touch(&q->solid.primitives[slot], &moves[i]);
        if (keys[slot] <= 1 && waves[slot][i] <= 1) ck_assert_float_eq(keys[slot], waves[slot][i]);
        if (t > 1) continue;
        ck_assert_float_eq(keys[slot], waves[slot][i]);
        ck_assert_msg(keys[slot] <= t, "touches at %.17g, but not before %.9g", t, (double)keys[slot]);
        if (t == 0)
            ck_assert_double_ge(sph__primitive_distance(&q->solid.primitives[slot], moves[i].start) - moves[i].radius,
                                keys[slot]);
        ++hits;
    }
    return hits;
}

/* Where primitives share parts: the first that is touched is not listed later than it is, for whichever of them. */
static void check_first(const sph_query *q, uint32_t i)
{
    float keys[SLOTS], least = SPH__QUERY_MISS;
    double first = 2;
    (void)ask_alone(q, i, keys);
    for (uint32_t slot = 0; slot < q->primitive_count; ++slot) {
        first = fmin(first, first_touch(&q->solid.primitives[slot], &moves[i]));
        least = fminf(least, keys[slot]);
        if (keys[slot] <= 1 && is_met[slot][i]) ck_assert_float_eq(keys[slot], waves[slot][i]);
    }
    if (first <= 1) ck_assert_double_le(least, first);
}

START_TEST(a_bound_never_loses_a_hit_nor_begins_after_it)
{
    size_t hits = 0, kept = 0;
    for (int turn = 0; turn < SOLIDS; ++turn) {
        sph_query *q = random_query(SCALES[_i], SPH_SEARCH_EXHAUSTIVE);
        ck_assert_uint_le(q->primitive_count, SLOTS);
        make_rays(q);
        ask_wave(q);
        for (uint32_t i = 0; i < RAYS; ++i)
            check_first(q, i);
        memset(q->shared, 0, q->primitive_count); /* each answers for itself */
        ck_assert_int_eq(sph_query_pose_frame(q, 0), SPH_OK);
        ask_wave(q);
        for (uint32_t i = 0; i < RAYS; ++i)
            hits += check_ray(q, i, &kept);
        sph_query_destroy(q);
    }
    ck_assert_uint_gt(hits, (size_t)SOLIDS * RAYS);
    ck_assert_uint_lt(kept, 2 * hits); /* bounds that keep everything would be of no use */
}
END_TEST

START_TEST(the_first_hit_is_that_of_the_search_without_bounds)
{
    size_t hits = 0, open = 0;
    for (int turn = 0; turn < SOLIDS / 2; ++turn) {
        sph_query *q = random_query(SCALES[_i], turn % 2 ? SPH_SEARCH_TREE : SPH_SEARCH_EXHAUSTIVE);
        make_rays(q);
        for (uint32_t i = 0; i < RAYS; ++i) {
            double to[3], t, first = 2, last = 2;
            move thick = moves[i], thin;
            const double slack = 1e-9 / sph__norm(moves[i].way);
            bool hit;
            for (int k = 0; k < 3; ++k) { /* as it is handed on */
                to[k] = moves[i].start[k] + moves[i].way[k];
                thick.way[k] = to[k] - moves[i].start[k];
            }
            thick.radius = 1e-12;
            thin = thick;
            thin.radius = -1e-12;
            for (uint32_t slot = 0; slot < q->primitive_count; ++slot) {
                first = fmin(first, first_touch(&q->solid.primitives[slot], &thick));
                last = fmin(last, first_touch(&q->solid.primitives[slot], &thin));
            }
            hit = sph__query_cast_frame(q, moves[i].start, to, &t);
            if (hit)
                ck_assert_msg(t >= first - slack && t <= last + slack, "at %g, not between %g and %g", t, first, last);
            else
                ck_assert_msg(last > 1, "lost a hit at %.17g", last);
            hits += hit;
            open += !hit;
        }
        sph_query_destroy(q);
    }
    ck_assert_uint_gt(hits, 1000);
    ck_assert_uint_gt(open, 1000);
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
    enum { SCALE_COUNT = sizeof SCALES / sizeof *SCALES };
    Suite *s = suite_create("query_parts");
    TCase *tc = tcase_create("query_parts");
    tcase_add_checked_fixture(tc, setup, teardown);
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, a_bound_never_loses_a_hit_nor_begins_after_it, 0, SCALE_COUNT);
    tcase_add_loop_test(tc, the_first_hit_is_that_of_the_search_without_bounds, 0, SCALE_COUNT);
    return run_suite(s, tc);
}
