/* SPDX-License-Identifier: MIT */
#include <check.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "mesh_check.h"
#include "support.h"

static sph_context *context;

static void setup(void)
{
    context = test_context();
}

static void teardown(void)
{
    sph_context_destroy(context);
}

/* --- levels --- */

enum { MOST_SPHERES = 128, MOST_SIMPLICES = 256 };

typedef struct shape {
    uint32_t spheres;
    size_t edges, triangles;
    float centers[3 * MOST_SPHERES], radii[MOST_SPHERES];
    uint32_t edge[2 * MOST_SIMPLICES], triangle[3 * MOST_SIMPLICES];
} shape;

static uint32_t add_sphere(shape *s, double x, double y, double z, double r)
{
    const double c[3] = {x, y, z};
    for (uint32_t k = 0; k < 3; ++k)
        s->centers[3 * s->spheres + k] = (float)c[k];
    s->radii[s->spheres] = (float)r;
    return s->spheres++;
}

static void add_edge(shape *s, uint32_t a, uint32_t b)
{
    s->edge[2 * s->edges] = a;
    s->edge[2 * s->edges++ + 1] = b;
}

static void add_triangle(shape *s, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *t = s->triangle + 3 * s->triangles++;
    t[0] = a;
    t[1] = b;
    t[2] = c;
}

static sph_level *make_level(sph_context *of, const shape *s)
{
    const sph_level_arrays arrays = {.struct_size = sizeof arrays,
                                     .sphere_count = s->spheres,
                                     .frame_count = 1,
                                     .centers = s->centers,
                                     .radii = s->radii,
                                     .edge_count = s->edges,
                                     .edges = s->edge,
                                     .triangle_count = s->triangles,
                                     .triangles = s->triangle};
    sph_level *level = NULL;
    sph_level_create_from_arrays(of, &arrays, &level);
    return level;
}

static sph_surface *extract(const shape *s, uint32_t resolution)
{
    sph_surface_options o;
    sph_surface *surface = NULL;
    sph_level *level = make_level(context, s);
    sph_surface_options_init(&o, sizeof o);
    o.resolution = resolution;
    ck_assert_msg(sph_surface_create(level, &o, &surface) == SPH_OK, "%s", sph_context_last_message(context));
    sph_level_destroy(level);
    return surface;
}

/* A cube of side 2 out of 12 triangles of spheres; `faces` bits leave pairs of them out. */
static void add_cube(shape *s, double half, double r, unsigned faces)
{
    static const uint32_t QUADS[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    const uint32_t first = s->spheres;
    for (int i = 0; i < 8; ++i)
        add_sphere(s, i & 1 ? half : -half, i & 2 ? half : -half, i & 4 ? half : -half, r);
    for (int i = 0; i < 6; ++i) {
        const uint32_t *q = QUADS[i];
        if ((faces >> i & 1) == 0) continue;
        add_triangle(s, first + q[0], first + q[1], first + q[2]);
        add_triangle(s, first + q[0], first + q[2], first + q[3]);
    }
}

static void add_ring(shape *s, double radius, double r, uint32_t count)
{
    const uint32_t first = s->spheres;
    for (uint32_t i = 0; i < count; ++i) {
        const double a = 2 * M_PI * i / count;
        add_sphere(s, radius * cos(a), radius * sin(a), 0.1 * sin(2 * a), r * (1 + 0.3 * sin(3 * a)));
    }
    for (uint32_t i = 0; i < count; ++i)
        add_edge(s, first + i, first + (i + 1) % count);
}

/* A wavy sheet of n by n squares in [-1, 1]^2. */
static void add_sheet(shape *s, uint32_t n, double wave, double r)
{
    const uint32_t first = s->spheres;
    for (uint32_t i = 0; i <= n; ++i)
        for (uint32_t j = 0; j <= n; ++j)
            add_sphere(s, -1 + 2.0 * i / n, -1 + 2.0 * j / n, wave * sin(3.0 * i / n) * cos(4.0 * j / n), r);
    for (uint32_t i = 0; i < n; ++i)
        for (uint32_t j = 0; j < n; ++j) {
            const uint32_t a = first + i * (n + 1) + j, b = a + n + 1;
            add_triangle(s, a, b, b + 1);
            add_triangle(s, a, b + 1, a + 1);
        }
}

static void add_star(shape *s, uint32_t branches, double r)
{
    const uint32_t middle = add_sphere(s, 0, 0, 0, 2 * r);
    for (uint32_t i = 0; i < branches; ++i) {
        const double z = 1 - 2 * (i + 0.5) / branches, a = 2.4 * i, w = sqrt(1 - z * z);
        add_edge(s, middle, add_sphere(s, w * cos(a), w * sin(a), z, r));
    }
}

/* Shapes of a known topology. */
enum {
    SPHERE,
    CAPSULE,
    TRIANGLE,
    BALLS,
    RING,
    THETA,
    STAR,
    THIN_STAR,
    SHEET,
    FLAT,
    SHELL,
    THIN_SHELL,
    FILLED_SHELL,
    CUP,
    NESTED_RINGS,
    POINT,
    WIRE,
    CONTAINED,
    TWICE,
    SHAPES
};
static const struct {
    const char *name;
    int euler, parts;
} EXPECTED[SHAPES] = {{"a sphere", 2, 1},
                      {"a tapered capsule", 2, 1},
                      {"a thick triangle", 2, 1},
                      {"three balls apart", 6, 3},
                      {"a ring", 0, 1},
                      {"a ring with a bar", -2, 1},
                      {"a star", 2, 1},
                      {"a star of no thickness", 2, 1},
                      {"a wavy sheet of no thickness", 2, 1},
                      {"a flat sheet of no thickness", 2, 1},
                      {"a shell", 2, 1},
                      {"a shell of no thickness", 2, 1},
                      {"a shell with a ball in it", 2, 1},
                      {"a cup of no thickness", 2, 1},
                      {"two rings linked", 0, 2},
                      {"a point", 2, 1},
                      {"a wire", 2, 1},
                      {"a capsule that is one sphere", 2, 1},
                      {"a capsule twice, its ends in one place", 2, 1}};

static void make_shape(int kind, shape *s)
{
    memset(s, 0, sizeof *s);
    switch (kind) {
    case SPHERE:
        add_sphere(s, 0.3, -0.2, 0.1, 1);
        break;
    case CAPSULE:
        add_edge(s, add_sphere(s, 0, 0, 0, 0.5), add_sphere(s, 1, 0.5, -0.3, 0.2));
        break;
    case TRIANGLE:
        add_triangle(s, add_sphere(s, 0, 0, 0, 0.3), add_sphere(s, 1, 0.2, 0.4, 0.1),
                     add_sphere(s, -0.2, 1.1, 0.7, 0.2));
        break;
    case BALLS:
        for (int i = 0; i < 3; ++i)
            add_sphere(s, i, i * i, -i, 0.4 + 0.1 * i);
        break;
    case RING:
        add_ring(s, 1, 0.15, 24);
        break;
    case THETA:
        add_ring(s, 1, 0.15, 24);
        add_edge(s, 3, 15);
        break;
    case STAR:
        add_star(s, 12, 0.1);
        break;
    case THIN_STAR:
        add_star(s, 12, 0);
        break;
    case SHEET:
        add_sheet(s, 6, 0.3, 0);
        break;
    case FLAT:
        add_sheet(s, 3, 0, 0);
        break;
    case SHELL:
        add_cube(s, 1, 0.15, 63);
        break;
    case THIN_SHELL:
        add_cube(s, 1, 0, 63);
        break;
    case FILLED_SHELL:
        add_cube(s, 1, 0.1, 63);
        add_sphere(s, 0, 0, 0, 0.4);
        break;
    case CUP:
        add_cube(s, 1, 0, 31);
        break;
    case NESTED_RINGS:
        add_ring(s, 1, 0.12, 24);
        add_ring(s, 1, 0.12, 24);
        for (uint32_t i = 24; i < 48; ++i) { /* turned into another plane, and moved along x */
            s->centers[3 * i + 2] = s->centers[3 * i + 1];
            s->centers[3 * i] += 1;
            s->centers[3 * i + 1] = 0;
        }
        break;
    case POINT:
        add_sphere(s, 5, -3, 2, 0);
        break;
    case WIRE:
        add_edge(s, add_sphere(s, 0, 0, 0, 0), add_sphere(s, 1, 1, 1, 0));
        break;
    case CONTAINED:
        add_edge(s, add_sphere(s, 0, 0, 0, 1), add_sphere(s, 0.3, 0.2, 0, 0.5));
        break;
    default:
        add_edge(s, add_sphere(s, 0, 0, 0, 0.5), add_sphere(s, 0, 0, 0, 0.25));
        add_edge(s, 0, add_sphere(s, 0, 0, 1, 0.25));
        add_edge(s, 1, 2);
    }
}

/* --- signed distance by brute force: |x - c(b)| - r(b) is convex in b --- */

typedef struct simplex {
    double c[3][3], r[3];
} simplex;

static double value(const simplex *s, const double x[3], double b1, double b2)
{
    double d = 0;
    for (int k = 0; k < 3; ++k)
        d += pow(x[k] - (1 - b1 - b2) * s->c[0][k] - b1 * s->c[1][k] - b2 * s->c[2][k], 2);
    return sqrt(d) - (1 - b1 - b2) * s->r[0] - b1 * s->r[1] - b2 * s->r[2];
}

/* The least value over b2 in [0, 1 - b1], or, outer, of that over b1 in [0, 1]: by thirds. */
static double least(const simplex *s, const double x[3], int corners, double b1)
{
    const bool outer = b1 < 0;
    double low = 0, high = outer ? 1 : 1 - b1;
    if (!outer && corners < 3) return value(s, x, b1, 0);
    for (int i = 0; i < 50; ++i) {
        const double p = low + (high - low) / 3, q = high - (high - low) / 3;
        const double fp = outer ? least(s, x, corners, p) : value(s, x, b1, p);
        const double fq = outer ? least(s, x, corners, q) : value(s, x, b1, q);
        if (fp < fq)
            high = q;
        else
            low = p;
    }
    return outer ? least(s, x, corners, low) : value(s, x, b1, low);
}

/* Of the shape's solid with radii of at least `least_radius`. */
static double brute_distance(const shape *s, const double x[3], double least_radius)
{
    double best = 1e300;
    for (size_t i = 0; i < s->spheres + s->edges + s->triangles; ++i) {
        const size_t e = i - s->spheres, t = e - s->edges;
        const int corners = i < s->spheres ? 1 : e < s->edges ? 2 : 3;
        simplex p = {0};
        for (int k = 0; k < corners; ++k) {
            const uint32_t j = corners == 1   ? (uint32_t)i
                               : corners == 2 ? s->edge[2 * e + (size_t)k]
                                              : s->triangle[3 * t + (size_t)k];
            for (uint32_t l = 0; l < 3; ++l)
                p.c[k][l] = s->centers[3 * j + l];
            p.r[k] = fmax(s->radii[j], least_radius);
        }
        best = fmin(best, corners == 1 ? value(&p, x, 0, 0) : least(&p, x, corners, -1));
    }
    return best;
}

static void random_shape(uint64_t *state, shape *s)
{
    memset(s, 0, sizeof *s);
    for (int i = 0; i < 9; ++i) {
        const double r = test_random_unit(state);
        add_sphere(s, test_random_unit(state), test_random_unit(state), test_random_unit(state),
                   r < 0.3 ? 0 : 0.2 * r * r);
    }
    for (int i = 0; i < 5; ++i)
        add_edge(s, (uint32_t)(test_random(state) % 9), (uint32_t)(test_random(state) % 9));
    for (int i = 0; i < 4; ++i)
        add_triangle(s, (uint32_t)(test_random(state) % 9), (uint32_t)(test_random(state) % 9),
                     (uint32_t)(test_random(state) % 9));
}

/* --- tests --- */

static const uint32_t RESOLUTIONS[] = {5, 16, 48};

START_TEST(shapes_have_closed_manifold_surfaces_of_their_topology)
{
    shape s;
    make_shape(_i, &s);
    for (int i = 0; i < 3; ++i) {
        sph_surface *surface = extract(&s, RESOLUTIONS[i]);
        const mesh_facts f = check_surface(surface, 0);
        ck_assert_double_gt(f.volume, 0);
        if (RESOLUTIONS[i] > 10) { /* coarser ones may close holes */
            ck_assert_msg(f.euler == EXPECTED[_i].euler, "%s at %u: Euler characteristic %d", EXPECTED[_i].name,
                          (unsigned)RESOLUTIONS[i], f.euler);
            ck_assert_msg(f.parts == EXPECTED[_i].parts, "%s at %u: %d parts", EXPECTED[_i].name,
                          (unsigned)RESOLUTIONS[i], f.parts);
        }
        sph_surface_destroy(surface);
    }
}
END_TEST

START_TEST(vertices_are_on_the_surface_and_triangles_near_it)
{
    shape s;
    sph_surface *surface;
    const float *xyz, *normals;
    const uint32_t *t;
    double cell;
    size_t step;
    make_shape(_i, &s);
    surface = extract(&s, 24);
    xyz = sph_surface_positions(surface, 0);
    normals = sph_surface_normals(surface, 0);
    t = sph_surface_triangles(surface, 0);
    cell = sph_surface_cell(surface);
    step = sph_surface_vertex_count(surface, 0) / 60 + 1;
    for (size_t i = 0; i < sph_surface_vertex_count(surface, 0); i += step) {
        double x[3], up[3], d;
        for (size_t k = 0; k < 3; ++k)
            x[k] = xyz[3 * i + k];
        d = brute_distance(&s, x, SPH_SURFACE_LEAST_RADIUS * cell);
        /* rounding to float, and the share of an edge that vertices stay off its ends */
        ck_assert_msg(fabs(d) < 3e-4 * cell + 3e-7 * (fabs(x[0]) + fabs(x[1]) + fabs(x[2])),
                      "%s: vertex %zu is %g cells off", EXPECTED[_i].name, i, d / cell);
        for (size_t k = 0; k < 3; ++k)
            up[k] = x[k] + 0.01 * cell * normals[3 * i + k];
        ck_assert_double_gt(brute_distance(&s, up, SPH_SURFACE_LEAST_RADIUS * cell),
                            -1e-3 * cell - 1e-6); /* at creases; and floats */
    }
    step = sph_surface_triangle_count(surface, 0) / 60 + 1;
    for (size_t i = 0; i < sph_surface_triangle_count(surface, 0); i += step) {
        double x[3];
        for (size_t k = 0; k < 3; ++k)
            x[k] = ((double)xyz[3 * t[3 * i] + k] + xyz[3 * t[3 * i + 1] + k] + xyz[3 * t[3 * i + 2] + k]) / 3;
        ck_assert_double_lt(fabs(brute_distance(&s, x, SPH_SURFACE_LEAST_RADIUS * cell)), 0.4 * cell);
    }
    sph_surface_destroy(surface);
}
END_TEST

START_TEST(area_and_volume_of_a_sphere_and_a_capsule_converge)
{
    /* a cylinder of radius 0.5 and length 1 with two half spheres */
    const double area[2] = {4 * M_PI, 2 * M_PI}, volume[2] = {4 * M_PI / 3, M_PI / 4 + M_PI / 6};
    double last_area = 1, last_volume = 1;
    shape s = {0};
    if (_i == 0)
        make_shape(SPHERE, &s);
    else
        add_edge(&s, add_sphere(&s, 0.1, 0.2, 0.3, 0.5), add_sphere(&s, 1.1, 0.2, 0.3, 0.5));
    for (uint32_t n = 10; n <= 80; n *= 2) {
        sph_surface *surface = extract(&s, n);
        const mesh_facts f = check_surface(surface, 0);
        const double da = fabs(f.area - area[_i]) / area[_i], dv = fabs(f.volume - volume[_i]) / volume[_i];
        if (n > 10) { /* of second order */
            ck_assert_double_lt(da, last_area / 3);
            ck_assert_double_lt(dv, last_volume / 3);
        }
        ck_assert_double_lt(da, 6.0 / n / n);
        ck_assert_double_lt(dv, 8.0 / n / n);
        last_area = da;
        last_volume = dv;
        sph_surface_destroy(surface);
    }
}
END_TEST

START_TEST(sheets_of_no_thickness_are_meshed_on_both_sides)
{
    shape s;
    sph_surface *surface;
    mesh_facts f;
    double r;
    make_shape(FLAT, &s);
    surface = extract(&s, 60);
    f = check_surface(surface, 0);
    r = SPH_SURFACE_LEAST_RADIUS * sph_surface_cell(surface);
    /* a slab of 2 x 2 with a round rim */
    ck_assert_double_eq_tol(f.volume, 8 * r + 4 * M_PI * r * r, 0.05 * f.volume);
    ck_assert_double_eq_tol(f.area, 8 + 8 * M_PI * r, 0.05 * f.area);
    sph_surface_destroy(surface);
}
END_TEST

START_TEST(cavities_are_no_part_of_the_surface)
{
    static const double radii[] = {0.15, 0, 0.1};
    shape s;
    sph_surface *surface;
    mesh_facts f;
    double r, nearest = 1e300;
    make_shape(SHELL + _i, &s);
    surface = extract(&s, 40);
    f = check_surface(surface, 0);
    r = fmax(radii[_i], SPH_SURFACE_LEAST_RADIUS * sph_surface_cell(surface));
    /* a filled cube of side 2 and r around it: faces, edges, corners */
    ck_assert_double_eq_tol(f.volume, 8 + 24 * r + 6 * M_PI * r * r + 4 * M_PI / 3 * r * r * r, 0.01 * f.volume);
    for (size_t i = 0; i < 3 * (size_t)sph_surface_vertex_count(surface, 0); i += 3) {
        const float *x = sph_surface_positions(surface, 0) + i;
        nearest = fmin(nearest, fmax(fabs(x[0]), fmax(fabs(x[1]), fabs(x[2]))));
    }
    ck_assert_double_gt(nearest, 1 + 0.5 * r); /* corners are round */
    sph_surface_destroy(surface);
    make_shape(CUP, &s);
    surface = extract(&s, 40);
    ck_assert_double_lt(check_surface(surface, 0).volume, 2); /* but an open one holds no water */
    sph_surface_destroy(surface);
}
END_TEST

START_TEST(surfaces_of_random_levels_separate_inside_from_outside)
{
    uint64_t state = 100 + (uint64_t)_i;
    shape s;
    sph_surface *surface;
    double cell;
    random_shape(&state, &s);
    surface = extract(&s, 20);
    check_surface(surface, 0);
    cell = sph_surface_cell(surface);
    for (int i = 0; i < 60; ++i) {
        double x[3], d, turns;
        for (int k = 0; k < 3; ++k)
            x[k] = 1.6 * test_random_unit(&state) - 0.3;
        d = brute_distance(&s, x, SPH_SURFACE_LEAST_RADIUS * cell);
        if (fabs(d) < 0.5 * cell) continue;
        turns = winding_number(surface, 0, x);
        ck_assert_double_eq_tol(turns, round(turns), 1e-6);
        if (d < 0) {
            ck_assert_double_eq_tol(turns, 1, 1e-6);
        } else if (d > 0.25) { /* too far for a gap or a cavity of these */
            ck_assert_double_eq_tol(turns, 0, 1e-6);
        }
    }
    sph_surface_destroy(surface);
}
END_TEST

static void same_surface(const sph_surface *a, uint32_t i, const sph_surface *b, uint32_t j)
{
    const size_t n = sph_surface_vertex_count(a, i), m = sph_surface_triangle_count(a, i);
    ck_assert_uint_gt(n, 0);
    ck_assert_uint_eq(n, sph_surface_vertex_count(b, j));
    ck_assert_uint_eq(m, sph_surface_triangle_count(b, j));
    ck_assert_mem_eq(sph_surface_positions(a, i), sph_surface_positions(b, j), 12 * n);
    ck_assert_mem_eq(sph_surface_normals(a, i), sph_surface_normals(b, j), 12 * n);
    ck_assert_mem_eq(sph_surface_triangles(a, i), sph_surface_triangles(b, j), 12 * m);
}

/* A star whose branches move: in frame 2 they touch. */
static sph_level *make_moving(sph_context *of)
{
    shape s = {0};
    float centers[3 * 3 * MOST_SPHERES];
    sph_level_arrays arrays = {.struct_size = sizeof arrays, .frame_count = 3, .centers = centers};
    sph_level *level = NULL;
    add_star(&s, 5, 0.1);
    for (uint32_t f = 0; f < 3; ++f)
        for (uint32_t i = 0; i < 3 * s.spheres; ++i)
            centers[3 * s.spheres * f + i] = s.centers[i] * (1 + 0.1f * (float)(f * (i % 4)));
    arrays.sphere_count = s.spheres;
    arrays.radii = s.radii;
    arrays.edge_count = s.edges;
    arrays.edges = s.edge;
    sph_level_create_from_arrays(of, &arrays, &level);
    return level;
}

static sph_status extract_moving(sph_context *of, sph_surface **out)
{
    sph_surface_options o;
    sph_level *level = make_moving(of);
    sph_status status = SPH_E_NOMEM;
    sph_surface_options_init(&o, sizeof o);
    o.resolution = 20;
    *out = NULL;
    if (level != NULL) status = sph_surface_create(level, &o, out);
    sph_level_destroy(level);
    return status;
}

START_TEST(surfaces_are_the_same_for_any_threads_and_executor)
{
    const sph_executor executors[] = {test_executor_reverse(), test_executor_scattered(), test_executor_threads()};
    sph_context *one = test_context_with_threads(1);
    sph_surface *expected, *surface;
    ck_assert_int_eq(extract_moving(one, &expected), SPH_OK);
    sph_context_destroy(one); /* the surface keeps it */
    for (int i = 0; i < 5; ++i) {
        sph_context *other = i < 3 ? test_context_with_executor(&executors[i]) : test_context_with_threads((uint32_t)i);
        ck_assert_int_eq(extract_moving(other, &surface), SPH_OK);
        for (uint32_t f = 0; f < 3; ++f)
            same_surface(surface, f, expected, f);
        sph_surface_destroy(surface);
        sph_context_destroy(other);
    }
    sph_surface_destroy(expected);
}
END_TEST

START_TEST(a_frame_is_the_same_alone_and_in_a_sequence)
{
    sph_level *level = make_moving(context);
    sph_surface *all = NULL, *some = NULL;
    sph_surface_options o;
    sph_surface_options_init(&o, sizeof o);
    o.resolution = 20;
    ck_assert_int_eq(sph_surface_create(level, &o, &all), SPH_OK);
    ck_assert_uint_eq(sph_surface_frame_count(all), 3);
    o.first_frame = 1;
    o.frame_limit = 1;
    ck_assert_int_eq(sph_surface_create(level, &o, &some), SPH_OK);
    ck_assert_uint_eq(sph_surface_frame_count(some), 1);
    same_surface(some, 0, all, 1);
    sph_surface_destroy(some);
    o = (sph_surface_options){o.struct_size, 0, 20, 0, 2, 0, o.memory_limit};
    ck_assert_int_eq(sph_surface_create(level, &o, &some), SPH_OK);
    ck_assert_uint_eq(sph_surface_frame_count(some), 2);
    same_surface(some, 1, all, 2);
    ck_assert_double_eq(sph_surface_cell(some), sph_surface_cell(all));
    sph_surface_destroy(some);
    sph_surface_destroy(all);
    sph_level_destroy(level);
}
END_TEST

START_TEST(every_allocation_may_fail)
{
    for (size_t n = 1;; ++n) {
        test_faulty faulty = {.fail_at = n, .sticky = _i};
        const sph_allocator allocator = test_faulty_allocator(&faulty);
        sph_context *own = test_context_with_allocator(&allocator);
        sph_surface *surface = NULL;
        sph_status status = SPH_E_NOMEM;
        if (own != NULL) status = extract_moving(own, &surface);
        ck_assert(status == SPH_OK ? surface != NULL : surface == NULL);
        sph_surface_destroy(surface);
        sph_context_destroy(own);
        ck_assert_uint_eq(faulty.live_blocks, 0);
        ck_assert(!faulty.misused);
        if (faulty.calls < n) {
            ck_assert_int_eq(status, SPH_OK);
            ck_assert_uint_gt(n, 20);
            return;
        }
        ck_assert_int_eq(status, SPH_E_NOMEM);
    }
}
END_TEST

START_TEST(progress_rises_and_may_cancel_at_any_call)
{
    for (size_t n = 0;; ++n) {
        test_progress progress = {.cancel_at = n};
        sph_context *own = test_context_with_progress(test_progress_callback, &progress);
        sph_surface *surface;
        const sph_status status = extract_moving(own, &surface);
        ck_assert(!progress.fell);
        if (status == SPH_OK) ck_assert_uint_gt(progress.calls, 10);
        ck_assert_int_eq(status, n == 0 || progress.calls < n ? SPH_OK : SPH_E_CANCELLED);
        sph_surface_destroy(surface);
        sph_context_destroy(own);
        if (n > 0 && status == SPH_OK) return;
    }
}
END_TEST

START_TEST(memory_stays_within_its_limit)
{
    shape s;
    sph_surface_options o;
    test_faulty faulty = {0};
    const sph_allocator allocator = test_faulty_allocator(&faulty);
    sph_context *own = test_context_with_allocator(&allocator);
    sph_level *level;
    uint64_t limit = 1000;
    sph_status status = SPH_E_LIMIT;
    make_shape(STAR, &s);
    level = make_level(own, &s);
    sph_surface_options_init(&o, sizeof o);
    o.resolution = 30;
    for (; status != SPH_OK; limit += limit / 4) {
        sph_surface *surface;
        const size_t before = faulty.live_bytes;
        faulty.peak_bytes = before;
        o.memory_limit = limit;
        status = sph_surface_create(level, &o, &surface);
        ck_assert(status == SPH_OK || status == SPH_E_LIMIT);
        ck_assert((status == SPH_OK) == (surface != NULL));
        /* what depends on the level alone is not counted */
        ck_assert_uint_lt(faulty.peak_bytes - before, limit + 50000);
        sph_surface_destroy(surface);
    }
    ck_assert_uint_gt(limit, 100000);
    sph_level_destroy(level);
    sph_context_destroy(own);
    ck_assert_uint_eq(faulty.live_blocks, 0);
}
END_TEST

static void refused(const sph_level *level, const sph_surface_options *o, sph_status expected, const char *part)
{
    sph_surface *surface = NULL;
    ck_assert_int_eq(sph_surface_create(level, o, &surface), expected);
    ck_assert_ptr_null(surface);
    ck_assert_msg(strstr(sph_context_last_message(context), part) != NULL, "message: %s",
                  sph_context_last_message(context));
}

START_TEST(what_cannot_be_extracted_is_refused_with_a_reason)
{
    shape s;
    sph_level *level, *huge;
    sph_surface_options o;
    sph_surface *surface;
    make_shape(SPHERE, &s);
    level = make_level(context, &s);
    s.radii[0] = 2e38f;
    huge = make_level(context, &s);
    sph_surface_options_init(&o, sizeof o);
    o.resolution = 0;
    refused(level, &o, SPH_E_INVALID, "0 cells");
    o.resolution = 4097;
    refused(level, &o, SPH_E_INVALID, "4097");
    sph_surface_options_init(&o, sizeof o);
    o.first_frame = 1;
    refused(level, &o, SPH_E_INVALID, "first_frame is 1");
    sph_surface_options_init(&o, sizeof o);
    o.frame_step = 0;
    refused(level, &o, SPH_E_INVALID, "frame_step");
    sph_surface_options_init(&o, sizeof o);
    o.flags = 1;
    refused(level, &o, SPH_E_INVALID, "flags");
    memset(&o, 0, sizeof o);
    refused(level, &o, SPH_E_INVALID, "not initialised");
    refused(huge, NULL, SPH_E_LIMIT, "too far");
    ck_assert_int_eq(sph_surface_create(NULL, NULL, &surface), SPH_E_INVALID);
    ck_assert_int_eq(sph_surface_create(level, NULL, NULL), SPH_E_INVALID);
    sph_surface_destroy(NULL);
    sph_level_destroy(level);
    sph_level_destroy(huge);
}
END_TEST

START_TEST(getters_take_null_and_any_index)
{
    shape s;
    sph_surface *surface;
    make_shape(SPHERE, &s);
    surface = extract(&s, 4);
    ck_assert_uint_eq(sph_surface_frame_count(NULL), 0);
    ck_assert_double_eq(sph_surface_cell(NULL), 0);
    ck_assert_double_eq(sph_surface_cell(surface), 0.5);
    for (int i = 0; i < 2; ++i) {
        const sph_surface *of = i == 0 ? NULL : surface;
        ck_assert_uint_eq(sph_surface_vertex_count(of, 1), 0);
        ck_assert_uint_eq(sph_surface_triangle_count(of, 1), 0);
        ck_assert_ptr_null(sph_surface_positions(of, 1));
        ck_assert_ptr_null(sph_surface_normals(of, 1));
        ck_assert_ptr_null(sph_surface_triangles(of, 1));
    }
    sph_surface_destroy(surface);
}
END_TEST

/* Sizes and places at which floats still have something to say. */
START_TEST(tiny_huge_and_far_levels_are_extracted)
{
    static const double SCALES[][2] = {{1e-30, 0}, {1e30, 0}, {1, 1e4}, {1e-3, 1e6}, {0, 1e20}, {0, 0}};
    shape s;
    sph_surface *surface;
    mesh_facts f;
    make_shape(STAR, &s);
    for (uint32_t i = 0; i < s.spheres; ++i) {
        for (uint32_t k = 0; k < 3; ++k)
            s.centers[3 * i + k] = (float)(s.centers[3 * i + k] * SCALES[_i][0] + SCALES[_i][1]);
        s.radii[i] = (float)(s.radii[i] * SCALES[_i][0]);
    }
    surface = extract(&s, 30);
    f = check_surface(surface, 0);
    ck_assert_int_eq(f.euler, 2);
    ck_assert_int_eq(f.parts, 1);
    sph_surface_destroy(surface);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("surface");
    TCase *shapes = tcase_create("shapes"), *distances = tcase_create("distances"), *limits = tcase_create("limits");
    SRunner *runner;
    int failed;
    tcase_add_checked_fixture(shapes, setup, teardown);
    tcase_add_loop_test(shapes, shapes_have_closed_manifold_surfaces_of_their_topology, 0, SHAPES);
    tcase_add_loop_test(shapes, area_and_volume_of_a_sphere_and_a_capsule_converge, 0, 2);
    tcase_add_test(shapes, sheets_of_no_thickness_are_meshed_on_both_sides);
    tcase_add_loop_test(shapes, cavities_are_no_part_of_the_surface, 0, 3);
    tcase_add_loop_test(shapes, tiny_huge_and_far_levels_are_extracted, 0, 6);
    suite_add_tcase(suite, shapes);
    tcase_add_checked_fixture(distances, setup, teardown);
    tcase_add_loop_test(distances, vertices_are_on_the_surface_and_triangles_near_it, 0, SHAPES);
    tcase_add_loop_test(distances, surfaces_of_random_levels_separate_inside_from_outside, 0, 20);
    suite_add_tcase(suite, distances);
    tcase_add_checked_fixture(limits, setup, teardown);
    tcase_add_test(limits, surfaces_are_the_same_for_any_threads_and_executor);
    tcase_add_test(limits, a_frame_is_the_same_alone_and_in_a_sequence);
    tcase_add_loop_test(limits, every_allocation_may_fail, 0, 2);
    tcase_add_test(limits, progress_rises_and_may_cancel_at_any_call);
    tcase_add_test(limits, memory_stays_within_its_limit);
    tcase_add_test(limits, what_cannot_be_extracted_is_refused_with_a_reason);
    tcase_add_test(limits, getters_take_null_and_any_index);
    suite_add_tcase(suite, limits);
    runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
