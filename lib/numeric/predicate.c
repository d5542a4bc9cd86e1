/* SPDX-License-Identifier: MIT */
#include "numeric/predicate.h"

#include <math.h>
#include <stddef.h>

/* --- exact sums: numbers that do not overlap, the smallest first (Dekker 1971, Shewchuk 1997) --- */

enum { TERMS = 256 };

typedef struct expansion {
    int count;
    double terms[TERMS];
} expansion;

static double sum_of(double a, double b, double *rest)
{
    const double sum = a + b, part = sum - a;
    *rest = (a - (sum - part)) + (b - part);
    return sum;
}

static double product_of(double a, double b, double *rest)
{
    const double split = 134217729; /* 2^27 + 1 */
    const double ca = split * a, cb = split * b, ah = ca - (ca - a), bh = cb - (cb - b), al = a - ah, bl = b - bh;
    const double product = a * b;
    *rest = al * bl - (((product - ah * bh) - al * bh) - ah * bl);
    return product;
}

static void add_term(expansion *e, double b)
{
    int count = 0;
    for (int i = 0; i < e->count; ++i) {
        double rest;
        b = sum_of(b, e->terms[i], &rest);
        if (rest < 0 || rest > 0) e->terms[count++] = rest;
    }
    if (b < 0 || b > 0) e->terms[count++] = b;
    e->count = count;
}

/* out += sign e f; at most 2 count(e) count(f) terms more */
static void add_product(const expansion *e, const expansion *f, double sign, expansion *out)
{
    for (int i = 0; i < e->count; ++i)
        for (int k = 0; k < f->count; ++k) {
            double rest;
            const double product = product_of(sign * e->terms[i], f->terms[k], &rest);
            add_term(out, rest);
            add_term(out, product);
        }
}

static void subtract(float a, float b, expansion *out)
{
    out->count = 0;
    add_term(out, (double)a);
    add_term(out, -(double)b);
}

static int sign_of(const expansion *e)
{
    return e->count == 0 ? 0 : e->terms[e->count - 1] > 0 ? 1 : -1;
}

static void minor(const expansion *a, const expansion *b, int x, int y, expansion *out)
{
    out->count = 0;
    add_product(a + x, b + y, 1, out);
    add_product(a + y, b + x, -1, out);
}

static int orient3_exactly(const float a[3], const float b[3], const float c[3], const float d[3])
{
    expansion u[3], v[3], w[3], part, sum;
    sum.count = 0;
    for (int k = 0; k < 3; ++k) {
        subtract(b[k], a[k], u + k);
        subtract(c[k], a[k], v + k);
        subtract(d[k], a[k], w + k);
    }
    for (int k = 0; k < 3; ++k) {
        minor(u, v, (k + 1) % 3, (k + 2) % 3, &part);
        add_product(&part, w + k, 1, &sum);
    }
    return sign_of(&sum);
}

static int orient2_exactly(const float a[3], const float b[3], const float c[3], int x, int y)
{
    expansion u[3], v[3], sum;
    for (int k = 0; k < 3; ++k) {
        subtract(b[k], a[k], u + k);
        subtract(c[k], a[k], v + k);
    }
    minor(u, v, x, y, &sum);
    return sign_of(&sum);
}

/* --- filters: bounds of the error of the plain formulas, generous --- */

static const double ERROR3 = 1.2e-15, ERROR2 = 6e-16;

int sph__orient3(const float a[3], const float b[3], const float c[3], const float d[3])
{
    double u[3], v[3], w[3], determinant = 0, bound = 0;
    for (int k = 0; k < 3; ++k) {
        u[k] = (double)b[k] - (double)a[k];
        v[k] = (double)c[k] - (double)a[k];
        w[k] = (double)d[k] - (double)a[k];
    }
    for (int k = 0; k < 3; ++k) {
        const int x = (k + 1) % 3, y = (k + 2) % 3;
        const double p = u[x] * v[y], q = u[y] * v[x];
        determinant += (p - q) * w[k];
        bound += (fabs(p) + fabs(q)) * fabs(w[k]);
    }
    if (determinant > ERROR3 * bound) return 1;
    if (determinant < -ERROR3 * bound) return -1;
    if (!(bound > 0)) return 0;
    return orient3_exactly(a, b, c, d);
}

int sph__orient2(const float a[3], const float b[3], const float c[3], int x, int y)
{
    const double p = ((double)b[x] - (double)a[x]) * ((double)c[y] - (double)a[y]);
    const double q = ((double)b[y] - (double)a[y]) * ((double)c[x] - (double)a[x]);
    const double determinant = p - q, bound = ERROR2 * (fabs(p) + fabs(q));
    if (determinant > bound) return 1;
    if (determinant < -bound) return -1;
    if (!(bound > 0)) return 0;
    return orient2_exactly(a, b, c, x, y);
}

/* --- triangles --- */

/* The coordinates in which the triangle is widest; false where it has no area. */
static bool choose_plane(const float *const t[3], int *x, int *y)
{
    double u[3], v[3], most = 0;
    for (int k = 0; k < 3; ++k) {
        u[k] = (double)t[1][k] - (double)t[0][k];
        v[k] = (double)t[2][k] - (double)t[0][k];
    }
    for (int k = 0; k < 3; ++k) {
        const double area = fabs(u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]);
        if (!(area > most)) continue;
        most = area;
        *x = (k + 1) % 3;
        *y = (k + 2) % 3;
    }
    return most > 0 && sph__orient2(t[0], t[1], t[2], *x, *y) != 0;
}

/* Closed segments in the plane. */
static bool segments_meet(const float *p, const float *q, const float *a, const float *b, int x, int y)
{
    const int s = sph__orient2(p, q, a, x, y), t = sph__orient2(p, q, b, x, y);
    const int u = sph__orient2(a, b, p, x, y), v = sph__orient2(a, b, q, x, y);
    if (s == 0 && t == 0 && u == 0 && v == 0) { /* on one line: their extents decide */
        for (int i = 0; i < 2; ++i) {
            const int k = i == 0 ? x : y;
            if (fmaxf(p[k], q[k]) < fminf(a[k], b[k]) || fmaxf(a[k], b[k]) < fminf(p[k], q[k])) return false;
        }
        return true;
    }
    return s * t <= 0 && u * v <= 0;
}

static bool is_within(const float *p, const float *const t[3], int x, int y)
{
    const int a = sph__orient2(t[0], t[1], p, x, y), b = sph__orient2(t[1], t[2], p, x, y);
    const int c = sph__orient2(t[2], t[0], p, x, y);
    return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

/* A segment in the plane of a triangle. */
static bool flat_segment_meets(const float *p, const float *q, const float *const t[3])
{
    int x = 0, y = 1;
    if (!choose_plane(t, &x, &y)) return false;
    if (is_within(p, t, x, y) || is_within(q, t, x, y)) return true;
    for (int i = 0; i < 3; ++i)
        if (segments_meet(p, q, t[i], t[(i + 1) % 3], x, y)) return true;
    return false;
}

/* The segment pq, whose ends are on these sides of the triangle's plane. */
static bool segment_meets(const float *p, const float *q, int p_side, int q_side, const float *const t[3])
{
    int a, b, c;
    if (p_side * q_side > 0) return false;
    if (p_side == 0 && q_side == 0) return flat_segment_meets(p, q, t);
    a = sph__orient3(p, q, t[0], t[1]);
    b = sph__orient3(p, q, t[1], t[2]);
    if (a * b < 0) return false;
    c = sph__orient3(p, q, t[2], t[0]);
    return a * c >= 0 && b * c >= 0;
}

static bool is_same(const float *a, const float *b)
{
    return !(a[0] < b[0] || a[0] > b[0] || a[1] < b[1] || a[1] > b[1] || a[2] < b[2] || a[2] > b[2]);
}

/* Two corners in one place leave no triangle. */
static bool is_segment(const float *const t[3])
{
    return is_same(t[0], t[1]) || is_same(t[1], t[2]) || is_same(t[2], t[0]);
}

/* Shared corners come first, in the same order, in both; returns how many. */
static int find_shared(const float *p[3], const float *q[3])
{
    int shared = 0;
    for (int i = 0; i < 3; ++i)
        for (int k = shared; k < 3; ++k) {
            const float *held;
            if (i < shared || !is_same(p[i], q[k])) continue;
            held = p[i];
            p[i] = p[shared];
            p[shared] = held;
            held = q[k];
            q[k] = q[shared];
            q[shared++] = held;
            break;
        }
    return shared;
}

/* Two triangles on one edge: flat, and on the same side of it. */
static bool lie_upon(const float *const p[3], const float *const q[3])
{
    int x = 0, y = 1;
    if (sph__orient3(p[0], p[1], p[2], q[2]) != 0 || !choose_plane(p, &x, &y)) return false;
    return sph__orient2(p[0], p[1], p[2], x, y) * sph__orient2(p[0], p[1], q[2], x, y) > 0;
}

bool sph__triangles_meet(const float *const p[3], const float *const q[3])
{
    const float *a[3] = {p[0], p[1], p[2]}, *b[3] = {q[0], q[1], q[2]};
    const int shared = is_segment(p) || is_segment(q) ? 3 : find_shared(a, b);
    int a_sides[3], b_sides[3];
    if (shared == 3) return false;
    if (shared == 2) return lie_upon(a, b);
    for (int i = 0; i < 3; ++i)
        b_sides[i] = i < shared ? 0 : sph__orient3(a[0], a[1], a[2], b[i]);
    if (shared == 0 && b_sides[0] == b_sides[1] && b_sides[1] == b_sides[2] && b_sides[0] != 0) return false;
    if (shared == 1 && b_sides[1] * b_sides[2] > 0) return false;
    for (int i = 0; i < 3; ++i)
        a_sides[i] = i < shared ? 0 : sph__orient3(b[0], b[1], b[2], a[i]);
    if (shared == 1)
        return segment_meets(b[1], b[2], b_sides[1], b_sides[2], a) ||
               segment_meets(a[1], a[2], a_sides[1], a_sides[2], b);
    for (int i = 0; i < 3; ++i) {
        const int k = (i + 1) % 3;
        if (segment_meets(b[i], b[k], b_sides[i], b_sides[k], a) ||
            segment_meets(a[i], a[k], a_sides[i], a_sides[k], b))
            return true;
    }
    return false;
}
