/* SPDX-License-Identifier: MIT */
#include "surface_shapes.h"

#include <check.h>
#include <math.h>
#include <string.h>

#include "support.h"

uint32_t add_sphere(shape *s, double x, double y, double z, double r)
{
    const double c[3] = {x, y, z};
    for (uint32_t k = 0; k < 3; ++k)
        s->centers[3 * s->spheres + k] = (float)c[k];
    s->radii[s->spheres] = (float)r;
    return s->spheres++;
}

void add_edge(shape *s, uint32_t a, uint32_t b)
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

sph_level *make_level(sph_context *of, const shape *s)
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

sph_surface *extract(sph_context *context, const shape *s, uint32_t resolution)
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

void add_star(shape *s, uint32_t branches, double r)
{
    const uint32_t middle = add_sphere(s, 0, 0, 0, 2 * r);
    for (uint32_t i = 0; i < branches; ++i) {
        const double z = 1 - 2 * (i + 0.5) / branches, a = 2.4 * i, w = sqrt(1 - z * z);
        add_edge(s, middle, add_sphere(s, w * cos(a), w * sin(a), z, r));
    }
}

const shape_facts EXPECTED[SHAPES] = {{"a sphere", 2, 1},
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

void make_shape(int kind, shape *s)
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
double brute_distance(const shape *s, const double x[3], double least_radius)
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

void random_shape(uint64_t *state, shape *s)
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
