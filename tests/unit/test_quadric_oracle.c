/* SPDX-License-Identifier: MIT */
/*
 * The minimiser against brute force. The oracle knows no quadric: every plane is one row of a linear least-squares
 * problem in all centres, lambda and r at once, solved by LAPACK's SVD once for each choice of which bounds hold.
 */
#include <check.h>
#include <float.h>
#include <lapacke.h>
#include <math.h>
#include <string.h>

#include <sphmesh/quadric.h>

#include "runner.h"
#include "support.h"

enum { FRAMES = 8, PLANES = 8, ROWS = FRAMES * (PLANES + 3), COLUMNS = 3 * FRAMES + 2 };

typedef enum frame_kind { EMPTY, FLAT, TUBE, CORNER, SHALLOW, ROUND, KINDS } frame_kind;

typedef struct plane {
    double point[3], normal[3], weight;
} plane;

typedef struct scene {
    uint32_t frame_count;
    frame_kind kind[FRAMES];
    int plane_count[FRAMES];
    plane planes[FRAMES][PLANES];
    double center[FRAMES][3], attachment[FRAMES]; /* attachment: its weight, at `center` */
    double u[3 * FRAMES], v[3 * FRAMES];
    double radius_max;
} scene;

static uint64_t seed;

static double uniform(double low, double high)
{
    return low + (high - low) * test_random_unit(&seed);
}

static int pick(int count)
{
    return (int)(test_random(&seed) % (uint64_t)count);
}

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void make_unit(double a[3])
{
    const double length = sqrt(dot(a, a));
    for (int i = 0; i < 3; ++i)
        a[i] /= length;
}

static void random_direction(double a[3])
{
    do {
        for (int i = 0; i < 3; ++i)
            a[i] = uniform(-1, 1);
    } while (dot(a, a) > 1 || dot(a, a) < 0.01);
    make_unit(a);
}

/* --- scenes --- */

static void random_axes(double axes[3][3])
{
    double projection;
    random_direction(axes[0]);
    do {
        random_direction(axes[1]);
        projection = dot(axes[0], axes[1]);
    } while (fabs(projection) > 0.9);
    for (int i = 0; i < 3; ++i)
        axes[1][i] -= projection * axes[0][i];
    make_unit(axes[1]);
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        axes[2][i] = axes[0][j] * axes[1][k] - axes[0][k] * axes[1][j];
    }
}

static void random_normal(frame_kind kind, int index, double axes[3][3], double normal[3])
{
    const double angle = uniform(0, 6.28);
    const double tilt = uniform(0.05, 0.3);
    for (int i = 0; i < 3; ++i)
        switch (kind) {
        case FLAT:
            normal[i] = axes[0][i];
            break;
        case TUBE:
            normal[i] = cos(angle) * axes[0][i] + sin(angle) * axes[1][i];
            break;
        case CORNER:
            normal[i] = axes[index % 3][i] + tilt * axes[(index + 1) % 3][i];
            break;
        case SHALLOW:
            normal[i] = axes[0][i] + tilt * (cos(angle) * axes[1][i] + sin(angle) * axes[2][i]);
            break;
        default:
            normal[i] = uniform(-1, 1);
            break;
        }
    make_unit(normal);
}

/* Determinant of the normals' weighted sum against the cube of a third of its trace. */
static double regularity(const scene *s, uint32_t f)
{
    double m[9] = {0}, values[3];
    for (int i = 0; i < s->plane_count[f]; ++i)
        for (int j = 0; j < 9; ++j)
            m[j] += s->planes[f][i].weight * s->planes[f][i].normal[j / 3] * s->planes[f][i].normal[j % 3];
    for (int j = 0; j < 9; j += 4)
        m[j] += s->attachment[f];
    if (m[0] + m[4] + m[8] == 0) return 0;
    ck_assert_int_eq(LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'N', 'U', 3, m, 3, values), 0);
    return 27 * values[0] * values[1] * values[2] / pow(values[0] + values[1] + values[2], 3);
}

static void random_planes(scene *s, uint32_t f, double unit)
{
    static const int least[KINDS] = {0, 1, 2, 3, 5, 5};
    const frame_kind kind = s->kind[f];
    const double size = uniform(0.2, 3) * (pick(4) == 0 ? -1 : 1); /* turned inside out: the best radius is negative */
    const double roughness = pick(3) == 0 ? 0 : uniform(0, 0.5);
    double axes[3][3];
    random_axes(axes);
    s->plane_count[f] = kind == EMPTY || kind == CORNER ? least[kind] : least[kind] + pick(PLANES - least[kind] + 1);
    for (int i = 0; i < s->plane_count[f]; ++i) {
        plane *p = &s->planes[f][i];
        random_normal(kind, i, axes, p->normal);
        p->weight = uniform(0.1, 1) * unit;
        for (int j = 0; j < 3; ++j)
            p->point[j] = s->center[f][j] + size * (p->normal[j] + roughness * uniform(-1, 1));
    }
}

/* Any segment; of no length; along the first plane's normal; or in that plane. */
static void random_segment(scene *s, uint32_t f, int shape)
{
    const double *normal = s->planes[f][0].normal;
    double d[3], along;
    for (int j = 0; j < 3; ++j)
        d[j] = shape == 1 ? 0 : uniform(-2, 2);
    along = dot(d, normal);
    for (int j = 0; j < 3 && s->plane_count[f] > 0; ++j) {
        if (shape == 2) d[j] = along * normal[j];
        if (shape == 3) d[j] -= along * normal[j];
    }
    for (int j = 0; j < 3; ++j) {
        s->u[3 * f + j] = s->center[f][j] + uniform(-2, 2);
        s->v[3 * f + j] = s->u[3 * f + j] + d[j];
    }
}

static scene random_scene(double unit)
{
    static const double bounds[] = {0, INFINITY, 0.3, 1, 3, 100};
    scene s = {.frame_count = 1 + (uint32_t)pick(FRAMES), .radius_max = bounds[pick(6)]};
    const int mixture = pick(5), shape = pick(6), attached = pick(8);
    for (uint32_t f = 0; f < s.frame_count; ++f) {
        s.kind[f] = (frame_kind)(mixture == 0   ? FLAT
                                 : mixture == 1 ? pick(3)
                                 : mixture == 2 ? CORNER + pick(3)
                                                : pick(KINDS));
        for (int j = 0; j < 3; ++j)
            s.center[f][j] = uniform(-1, 1);
        do
            random_planes(&s, f, unit);
        while (s.kind[f] >= CORNER && regularity(&s, f) < 1e-5);
        if (attached == 0 || (attached == 1 && pick(2))) s.attachment[f] = uniform(0.1, 1) * unit;
        random_segment(&s, f, shape);
    }
    return s;
}

static void move_vector(double *a, double by)
{
    for (int j = 0; j < 3; ++j)
        a[j] += by;
}

/* To and fro: coordinates as a scene far from the origin can hold them, and the same scene back at the origin. */
static scene move(const scene *s, double by)
{
    scene moved = *s;
    for (uint32_t f = 0; f < s->frame_count; ++f) {
        for (int i = 0; i < s->plane_count[f]; ++i)
            move_vector(moved.planes[f][i].point, by);
        move_vector(moved.center[f], by);
        move_vector(moved.u + 3 * f, by);
        move_vector(moved.v + 3 * f, by);
    }
    return moved;
}

/* --- the oracle --- */

/* The cost, from the definition. */
static double cost_of(const scene *s, const double *centers, double r)
{
    double cost = 0;
    for (uint32_t f = 0; f < s->frame_count; ++f) {
        double d[3];
        for (int i = 0; i < s->plane_count[f]; ++i) {
            const plane *p = &s->planes[f][i];
            for (int j = 0; j < 3; ++j)
                d[j] = p->point[j] - centers[3 * f + j];
            cost += p->weight * pow(dot(p->normal, d) - r, 2);
        }
        for (int j = 0; j < 3; ++j)
            d[j] = centers[3 * f + j] - s->center[f][j];
        cost += s->attachment[f] * dot(d, d);
    }
    return cost;
}

static bool is_fixed(const scene *s, uint32_t f)
{
    return regularity(s, f) > 1e-6;
}

/* One row: root * (direction . q_f + r_part * r) = root * value. */
typedef struct least_squares {
    double a[ROWS * COLUMNS], y[ROWS];
    int rows, columns, column_of[FRAMES], lambda_column, r_column;
} least_squares;

static void add_row(least_squares *ls, const scene *s, uint32_t f, const double direction[3], double r_part,
                    double value, double root, double lambda, double r)
{
    double *row = ls->a + (size_t)ls->rows * COLUMNS;
    if (ls->column_of[f] >= 0) {
        for (int j = 0; j < 3; ++j)
            row[ls->column_of[f] + j] = root * direction[j];
    } else {
        double d[3];
        for (int j = 0; j < 3; ++j)
            d[j] = s->v[3 * f + j] - s->u[3 * f + j];
        value -= dot(direction, s->u + 3 * f);
        if (ls->lambda_column >= 0)
            row[ls->lambda_column] = root * dot(direction, d);
        else
            value -= lambda * dot(direction, d);
    }
    if (ls->r_column >= 0)
        row[ls->r_column] = root * r_part;
    else
        value -= r_part * r;
    ls->y[ls->rows++] = root * value;
}

/* With lambda and r fixed to the given values, or free where those are NaN. False if what comes out is not in the box.
 */
static bool solve_side(const scene *s, double lambda, double r, double *best)
{
    static least_squares ls;
    double singular[COLUMNS], centers[3 * FRAMES], x[ROWS] = {0};
    lapack_int rank;
    memset(&ls, 0, sizeof ls);
    for (uint32_t f = 0; f < s->frame_count; ++f) {
        ls.column_of[f] = is_fixed(s, f) ? ls.columns : -1;
        if (ls.column_of[f] >= 0) ls.columns += 3;
    }
    ls.lambda_column = isnan(lambda) ? ls.columns++ : -1;
    ls.r_column = isnan(r) ? ls.columns++ : -1;
    for (uint32_t f = 0; f < s->frame_count; ++f) {
        for (int i = 0; i < s->plane_count[f]; ++i) {
            const plane *p = &s->planes[f][i];
            add_row(&ls, s, f, p->normal, 1, dot(p->normal, p->point), sqrt(p->weight), lambda, r);
        }
        for (int j = 0; j < 3 && s->attachment[f] > 0; ++j) {
            double axis[3] = {0, 0, 0};
            axis[j] = 1;
            add_row(&ls, s, f, axis, 0, s->center[f][j], sqrt(s->attachment[f]), lambda, r);
        }
    }
    if (ls.rows > 0 && ls.columns > 0) {
        memcpy(x, ls.y, sizeof ls.y);
        ck_assert_int_eq(
            LAPACKE_dgelsd(LAPACK_ROW_MAJOR, ls.rows, ls.columns, 1, ls.a, COLUMNS, x, 1, singular, 1e-13, &rank), 0);
    }
    if (ls.lambda_column >= 0) lambda = x[ls.lambda_column];
    if (ls.r_column >= 0) r = x[ls.r_column];
    if (lambda < 0 || lambda > 1 || r < 0 || r > s->radius_max) return false;
    for (uint32_t f = 0; f < s->frame_count; ++f)
        for (int j = 0; j < 3; ++j)
            centers[3 * f + j] = ls.column_of[f] >= 0 ? x[ls.column_of[f] + j]
                                                      : s->u[3 * f + j] + lambda * (s->v[3 * f + j] - s->u[3 * f + j]);
    *best = cost_of(s, centers, r);
    return true;
}

static double brute_force(const scene *s)
{
    const double lambdas[3] = {(double)NAN, 0, 1}, radii[3] = {(double)NAN, 0, s->radius_max};
    double best = INFINITY, cost;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (!isinf(radii[j]) && solve_side(s, lambdas[i], radii[j], &cost) && cost < best) best = cost;
    ck_assert(isfinite(best));
    return best;
}

/* --- the comparison --- */

static sph_quadric *quadric_of(sph_context *context, const scene *s, uint32_t first, uint32_t step)
{
    sph_quadric *q;
    ck_assert_int_eq(sph_quadric_create(context, s->frame_count, &q), SPH_OK);
    for (uint32_t f = 0; f < s->frame_count; ++f) {
        for (int i = (int)first; i < s->plane_count[f]; i += (int)step) {
            const plane *p = &s->planes[f][i];
            ck_assert_int_eq(sph_quadric_add_plane(q, f, p->point, p->normal, p->weight), SPH_OK);
        }
        if (first == 0) ck_assert_int_eq(sph_quadric_add_attachment(q, f, s->center[f], s->attachment[f]), SPH_OK);
    }
    return q;
}

static double total_weight(const scene *s)
{
    double total = 0;
    for (uint32_t f = 0; f < s->frame_count; ++f) {
        total += s->attachment[f];
        for (int i = 0; i < s->plane_count[f]; ++i)
            total += s->planes[f][i].weight;
    }
    return total;
}

/* `local` is `s` moved back by `by`: the oracle has no anchors, so it works there. */
static void compare(sph_context *context, const scene *s, const scene *local, double by)
{
    /* Lengths are some units. Where the optimum itself is rounding, so is the difference. */
    const double weight = total_weight(s), best = brute_force(local),
                 tolerance = 1e-9 * best + 1e-13 * weight + DBL_MIN;
    sph_quadric *q = quadric_of(context, s, 0, 2), *rest = quadric_of(context, s, 1, 2);
    sph_quadric_minimum minimum;
    double centers[3 * FRAMES], evaluated;
    uint32_t degenerate = 0;
    ck_assert_int_eq(sph_quadric_add(q, rest), SPH_OK);
    ck_assert_int_eq(sph_quadric_minimize(q, s->u, s->v, s->radius_max, &minimum, centers), SPH_OK);
    ck_assert_int_eq(sph_quadric_evaluate(q, centers, minimum.radius, &evaluated), SPH_OK);

    ck_assert(minimum.radius >= 0 && minimum.radius <= s->radius_max);
    ck_assert(minimum.lambda >= 0 && minimum.lambda <= 1);
    for (uint32_t f = 0; f < s->frame_count; ++f) {
        if (is_fixed(local, f)) continue;
        ++degenerate;
        for (int j = 0; j < 3; ++j) {
            const uint32_t k = 3 * f + (uint32_t)j;
            ck_assert_double_eq_tol(centers[k] - s->u[k], minimum.lambda * (s->v[k] - s->u[k]), 1e-14 + 1e-15 * by);
        }
    }
    ck_assert_uint_eq(minimum.degenerate_frames, degenerate);
    ck_assert_double_eq_tol(minimum.cost, best, tolerance);
    for (uint32_t f = 0; f < s->frame_count; ++f)
        move_vector(centers + 3 * f, -by);
    /* Rounded so far away, the centres in frames on the segment are no longer quite those that the cost is of. */
    ck_assert_double_eq_tol(cost_of(local, centers, minimum.radius), best,
                            tolerance + 1e-14 * by * (weight + sqrt(weight * best)));
    ck_assert_double_eq_tol(evaluated, best, tolerance + 1e-14 * by * (weight + sqrt(weight * best)));
    sph_quadric_destroy(q);
    sph_quadric_destroy(rest);
}

START_TEST(minima_agree_with_brute_force)
{
    static const double distances[] = {0, 0, 1000, 1e6};
    sph_context *context = test_context();
    seed = 77 + (uint64_t)_i;
    for (int i = 0; i < 2500; ++i) {
        const scene drawn = random_scene(i % 7 ? 1.0 : 1e-12);
        const scene s = move(&drawn, distances[_i]), local = move(&s, -distances[_i]);
        compare(context, &s, &local, distances[_i]);
    }
    sph_context_destroy(context);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("quadric_oracle");
    TCase *tests = tcase_create("quadric_oracle");
    tcase_add_loop_test(tests, minima_agree_with_brute_force, 0, 4);
    suite_add_tcase(suite, tests);
    return run_all(suite);
}
