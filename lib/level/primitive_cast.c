/* SPDX-License-Identifier: MIT */
/* Rays against primitives, in closed form: spheres, the sides of cones, faces. */
#include <float.h>

#include "level/primitive.h"
#include "numeric/vector.h"

/* The first s in [0, *best] at which the ray enters the sphere; *best becomes it. */
static void cast_sphere(const double c[3], double r, const double o[3], const double d[3], double *best)
{
    double v[3], a = sph__dot(d, d), b, root, s;
    sph__subtract(o, c, v);
    b = sph__dot(v, d);
    root = b * b - a * (sph__dot(v, v) - r * r);
    if (root < 0 || b > 0 || a == 0) return;
    s = (-b - sqrt(root)) / a;
    if (s >= 0 && s <= *best) *best = s;
}

/* Is the point origin + s * direction of the cone one of the side between the two circles of contact? */
static bool on_side(const sph__primitive_edge *e, double radius, double along)
{
    const double m = along - radius * e->sine, slack = e->cosine * e->cosine;
    return m >= 0 && m <= e->length * slack && radius - e->sine * along >= 0;
}

/* A point of the side has across * cosine = radius - sine * along: a quadratic in s. */
static void cast_side(const sph__primitive *p, const sph__primitive_edge *e, const double o[3], const double d[3],
                      double *best)
{
    const double radius = p->radius[e->from];
    double v[3], across[3], step[3], along, rate, a, b, c, root, q, s[2];
    sph__subtract(o, p->center[e->from], v);
    along = sph__dot(v, e->axis);
    rate = sph__dot(d, e->axis);
    for (int k = 0; k < 3; ++k) {
        across[k] = e->cosine * (v[k] - along * e->axis[k]);
        step[k] = e->cosine * (d[k] - rate * e->axis[k]);
    }
    a = sph__dot(step, step) - e->sine * e->sine * rate * rate;
    b = sph__dot(across, step) + e->sine * rate * (radius - e->sine * along);
    c = sph__dot(across, across) - (radius - e->sine * along) * (radius - e->sine * along);
    root = b * b - a * c;
    if (root < 0) return;
    q = b < 0 ? -b + sqrt(root) : -b - sqrt(root); /* without cancellation; a or q may vanish: not finite below */
    s[0] = q / a;
    s[1] = c / q;
    for (int i = 0; i < 2; ++i)
        if (s[i] >= 0 && s[i] <= *best && on_side(e, radius, along + s[i] * rate)) *best = s[i];
}

static void cast_face(const sph__primitive *p, int side, const double o[3], const double d[3], double *best)
{
    double n[3], v[3], x[3], rate, s, b1, b2;
    sph__add_scaled(p->tilt, side < 0 ? -p->rise : p->rise, p->plane_normal, n);
    rate = sph__dot(n, d);
    if (!(rate < 0)) return;
    sph__subtract(o, p->center[0], v);
    s = (p->radius[0] - sph__dot(n, v)) / rate;
    if (!(s >= 0 && s <= *best)) return;
    sph__add_scaled(v, s, d, x);
    if (sph__primitive_weights(p, x, side * sph__dot(x, p->plane_normal), &b1, &b2) == 0) *best = s;
}

bool sph__primitive_cast(const sph__primitive *p, const double o[3], const double d[3], double limit, double *s)
{
    const int32_t edge_count = p->corner_count == 3 ? 3 : p->corner_count - 1;
    sph__contact c;
    double best, slope;
    if (!(limit >= 0)) return false;
    if (limit > DBL_MAX / 2) limit = DBL_MAX / 2;
    sph__primitive_closest(p, o, &c);
    if (c.distance < 0) {
        *s = 0;
        return true;
    }
    slope = sph__dot(c.normal, d); /* distance is convex: along the ray it grows at least like this */
    if (slope > 0 || c.distance * (1 - 1e-9) > -slope * limit) return false;
    best = nextafter(limit, DBL_MAX); /* so that a hit at the limit itself counts */
    for (int32_t i = 0; i < p->corner_count; ++i)
        cast_sphere(p->center[i], p->radius[i], o, d, &best);
    for (int32_t i = 0; i < edge_count; ++i)
        if (p->edge[i].only < 0) cast_side(p, &p->edge[i], o, d, &best);
    if (p->has_faces) {
        cast_face(p, 1, o, d, &best);
        cast_face(p, -1, o, d, &best);
    }
    if (best > limit) return false;
    *s = best;
    return true;
}
