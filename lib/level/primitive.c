/* SPDX-License-Identifier: MIT */
#include "level/primitive.h"

#include <float.h>
#include <string.h>

#include "numeric/vector.h"

static void set_edge(sph__primitive *p, sph__primitive_edge *e, int32_t from, int32_t to)
{
    const double difference = p->radius[from] - p->radius[to];
    *e = (sph__primitive_edge){.from = from, .to = to, .only = -1};
    sph__subtract(p->center[to], p->center[from], e->axis);
    e->length = sph__norm(e->axis);
    if (e->length > fabs(difference)) {
        e->sine = difference / e->length;
        e->cosine = sqrt((1 - e->sine) * (1 + e->sine));
    }
    if (!(e->cosine > 0)) {
        e->only = difference >= 0 ? from : to;
        return;
    }
    for (int k = 0; k < 3; ++k)
        e->axis[k] /= e->length;
}

/*
 * The unit normal n of a plane that touches the three spheres satisfies n.(c1 - c0) = r0 - r1 and n.(c2 - c0) = r0 -
 * r2. Its part in the plane of the centres is a combination of the weights' gradients, which are dual to these edges.
 */
static void set_faces(sph__primitive *p)
{
    double u[3], v[3], w[3], area, length, longest, squared;
    sph__subtract(p->center[1], p->center[0], u);
    sph__subtract(p->center[2], p->center[0], v);
    sph__subtract(p->center[2], p->center[1], w);
    sph__cross(u, v, p->plane_normal);
    area = sph__norm(p->plane_normal);
    longest = fmax(sph__dot(w, w), fmax(sph__dot(u, u), sph__dot(v, v)));
    if (!(area > 1e-8 * longest)) return; /* collinear: the three capsules are the solid, but for 1e-8 of its size */
    for (int k = 0; k < 3; ++k)
        p->plane_normal[k] /= area;
    sph__cross(v, p->plane_normal, p->gradient[0]);
    sph__cross(p->plane_normal, u, p->gradient[1]);
    for (int k = 0; k < 3; ++k) {
        p->gradient[0][k] /= area;
        p->gradient[1][k] /= area;
        p->tilt[k] =
            (p->radius[0] - p->radius[1]) * p->gradient[0][k] + (p->radius[0] - p->radius[2]) * p->gradient[1][k];
    }
    length = sph__norm(p->tilt);
    squared = (1 - length) * (1 + length);
    if (!(squared > 0)) return; /* no plane touches all three */
    p->rise = sqrt(squared);
    p->gradient_tilt[0] = sph__dot(p->gradient[0], p->tilt) / p->rise;
    p->gradient_tilt[1] = sph__dot(p->gradient[1], p->tilt) / p->rise;
    p->has_faces = true;
}

void sph__primitive_set(sph__primitive *p, int32_t corner_count, const double (*centers)[3], const double *radii)
{
    memset(p, 0, sizeof *p);
    p->corner_count = corner_count;
    for (int32_t i = 0; i < corner_count; ++i) {
        sph__copy3(centers[i], p->center[i]);
        p->radius[i] = radii[i];
    }
    if (corner_count == 2) set_edge(p, &p->edge[0], 0, 1);
    if (corner_count != 3) return;
    for (int32_t i = 0; i < 3; ++i)
        set_edge(p, &p->edge[i], i, (i + 1) % 3);
    set_faces(p);
}

/* Where on the skeleton the nearest sphere sits. */
typedef struct foot {
    double distance;
    int32_t edge;   /* its edge; -1: none: a corner, or within the triangle */
    int32_t corner; /* its corner; -1: none */
    double a, b;    /* on an edge: the parameter in a; within the triangle: weights of corners 1 and 2 */
} foot;

static double sphere_distance(const sph__primitive *p, int32_t i, const double x[3])
{
    return sph__distance(x, p->center[i]) - p->radius[i];
}

static inline void edge_foot(const sph__primitive *p, int32_t index, const double x[3], foot *f)
{
    const sph__primitive_edge *e = &p->edge[index];
    double d[3], along, across, m;
    f->edge = -1;
    if (e->only >= 0) {
        f->corner = e->only;
        f->distance = sphere_distance(p, e->only, x);
        return;
    }
    sph__subtract(x, p->center[e->from], d);
    along = sph__dot(d, e->axis);
    sph__add_scaled(d, -along, e->axis, d);
    across = sph__norm(d);
    m = along * e->cosine - across * e->sine; /* the parameter, times cosine * length */
    if (m <= 0 || m >= e->cosine * e->length) {
        f->corner = m <= 0 ? e->from : e->to;
        f->distance = sphere_distance(p, f->corner, x);
        return;
    }
    f->edge = index;
    f->corner = -1;
    f->a = m / (e->cosine * e->length);
    f->distance = across * e->cosine + along * e->sine - p->radius[e->from];
}

/*
 * The function of the weights is convex: where its least value in their whole plane is not within the triangle, the
 * least value within is on one of the edges that lie between.
 */
static inline void find_foot(const sph__primitive *p, const double x[3], foot *f)
{
    int edges = p->corner_count == 3 ? 7 : 1; /* as bits */
    if (p->corner_count == 1) {
        *f = (foot){.distance = sphere_distance(p, 0, x), .edge = -1, .corner = 0};
        return;
    }
    if (p->has_faces) {
        double d[3], height;
        sph__subtract(x, p->center[0], d);
        height = fabs(sph__dot(d, p->plane_normal));
        edges = sph__primitive_weights(p, d, height, &f->a, &f->b);
        if (edges == 0) {
            f->edge = f->corner = -1;
            f->distance = sph__dot(d, p->tilt) + height * p->rise - p->radius[0];
            return;
        }
    }
    f->distance = DBL_MAX;
    for (int32_t i = 0; edges >> i != 0; ++i) {
        foot other;
        if ((edges >> i & 1) == 0) continue;
        other.a = other.b = 0;
        edge_foot(p, i, x, &other);
        if (other.distance < f->distance) *f = other;
    }
}

double sph__primitive_distance(const sph__primitive *p, const double x[3])
{
    foot f = {0};
    find_foot(p, x, &f);
    return f.distance;
}

double sph__primitive_slope(const sph__primitive *p, const double x[3], const double direction[3], double *slope)
{
    foot f = {0};
    double v[3], length;
    find_foot(p, x, &f);
    if (f.corner >= 0) {
        sph__subtract(x, p->center[f.corner], v);
        length = sph__norm(v);
        *slope = length > 0 ? sph__dot(v, direction) / length : 0;
    } else if (f.edge >= 0) {
        const sph__primitive_edge *e = &p->edge[f.edge];
        sph__subtract(x, p->center[e->from], v);
        sph__add_scaled(v, -sph__dot(v, e->axis), e->axis, v);
        length = sph__norm(v);
        *slope = e->sine * sph__dot(e->axis, direction);
        if (length > DBL_MIN) *slope += e->cosine * sph__dot(v, direction) / length;
    } else {
        sph__subtract(x, p->center[0], v);
        *slope = sph__dot(p->tilt, direction) +
                 (sph__dot(v, p->plane_normal) < 0 ? -p->rise : p->rise) * sph__dot(p->plane_normal, direction);
    }
    return f.distance;
}

/* How far the plane with normal n that touches sphere i leaves the other spheres below it, at the worst. */
static double clearance(const sph__primitive *p, int32_t i, const double n[3])
{
    double least = DBL_MAX;
    for (int32_t j = 0; j < p->corner_count; ++j) {
        double d[3];
        if (j == i) continue;
        sph__subtract(p->center[i], p->center[j], d);
        least = fmin(least, sph__dot(d, n) + p->radius[i] - p->radius[j]);
    }
    return least;
}

/* At right angles to the edge, away from the third corner where there is one. */
static void choose_across(const sph__primitive *p, const sph__primitive_edge *e, double across[3])
{
    double length = 0;
    if (p->corner_count == 3) {
        sph__subtract(p->center[e->from], p->center[3 - e->from - e->to], across);
        sph__add_scaled(across, -sph__dot(across, e->axis), e->axis, across);
        length = sph__norm(across);
    }
    if (length > 1e-9 * e->length)
        for (int k = 0; k < 3; ++k)
            across[k] /= length;
    else
        sph__perpendicular(e->axis, across);
}

/* A normal with which sphere i touches the boundary, for a point at its centre: all that do are equally near. */
static void free_normal(const sph__primitive *p, int32_t i, double normal[3])
{
    const int32_t edge_count = p->corner_count == 3 ? 3 : p->corner_count - 1;
    double n[3] = {0, 0, 1}, across[3], best = clearance(p, i, n);
    sph__copy3(n, normal);
    if (p->has_faces) {
        sph__add_scaled(p->tilt, p->rise, p->plane_normal, normal);
        return;
    }
    for (int32_t k = 0; k < edge_count; ++k) {
        const sph__primitive_edge *e = &p->edge[k];
        if (e->only >= 0 || (e->from != i && e->to != i)) continue;
        choose_across(p, e, across);
        for (int j = 0; j < 3; ++j)
            n[j] = e->sine * e->axis[j] + e->cosine * across[j];
        if (clearance(p, i, n) <= best) continue;
        best = clearance(p, i, n);
        sph__copy3(n, normal);
    }
}

static void corner_contact(const sph__primitive *p, int32_t i, const double x[3], sph__contact *c)
{
    double length;
    sph__subtract(x, p->center[i], c->normal);
    length = sph__norm(c->normal);
    if (length > 1e-14 * p->radius[i]) /* nearer the direction is noise */
        for (int k = 0; k < 3; ++k)
            c->normal[k] /= length;
    else
        free_normal(p, i, c->normal);
    c->weights[i] = 1;
}

static void edge_contact(const sph__primitive *p, const foot *f, const double x[3], sph__contact *c)
{
    const sph__primitive_edge *e = &p->edge[f->edge];
    double d[3], length;
    sph__subtract(x, p->center[e->from], d);
    sph__add_scaled(d, -sph__dot(d, e->axis), e->axis, d);
    length = sph__norm(d);
    if (length > 1e-14 * e->length) { /* nearer the direction is noise; near, it takes twice to be quite across */
        for (int k = 0; k < 3; ++k)
            d[k] /= length;
        sph__add_scaled(d, -sph__dot(d, e->axis), e->axis, d);
        length = sph__norm(d);
    } else {
        length = 0;
    }
    if (length > 0.5)
        for (int k = 0; k < 3; ++k)
            d[k] /= length;
    else
        choose_across(p, e, d);
    for (int k = 0; k < 3; ++k)
        c->normal[k] = e->sine * e->axis[k] + e->cosine * d[k];
    c->weights[e->from] = 1 - f->a;
    c->weights[e->to] = f->a;
}

static void face_contact(const sph__primitive *p, const foot *f, const double x[3], sph__contact *c)
{
    double d[3], side, length;
    sph__subtract(x, p->center[0], d);
    side = sph__dot(d, p->plane_normal) < 0 ? -p->rise : p->rise;
    sph__add_scaled(p->tilt, side, p->plane_normal, c->normal);
    length = sph__norm(c->normal); /* 1, but for what a sliver's tilt has lost */
    for (int k = 0; k < 3; ++k)
        c->normal[k] /= length;
    c->weights[1] = f->a;
    c->weights[2] = f->b;
    c->weights[0] = fmax(0, 1 - f->a - f->b);
}

void sph__primitive_closest(const sph__primitive *p, const double x[3], sph__contact *c)
{
    foot f = {0};
    double radius = 0;
    find_foot(p, x, &f);
    memset(c, 0, sizeof *c);
    c->distance = f.distance;
    if (f.corner >= 0)
        corner_contact(p, f.corner, x, c);
    else if (f.edge >= 0)
        edge_contact(p, &f, x, c);
    else
        face_contact(p, &f, x, c);
    for (int32_t i = 0; i < p->corner_count; ++i) {
        sph__add_scaled(c->point, c->weights[i], p->center[i], c->point);
        radius += c->weights[i] * p->radius[i];
    }
    sph__add_scaled(c->point, radius, c->normal, c->point);
}

void sph__primitive_bounds(const sph__primitive *p, double low[3], double high[3])
{
    for (int k = 0; k < 3; ++k) {
        low[k] = DBL_MAX;
        high[k] = -DBL_MAX;
        for (int32_t i = 0; i < p->corner_count; ++i) {
            low[k] = fmin(low[k], p->center[i][k] - p->radius[i]);
            high[k] = fmax(high[k], p->center[i][k] + p->radius[i]);
        }
    }
}

void sph__primitive_face(const sph__primitive *p, int side, double corners[3][3], double normal[3])
{
    sph__add_scaled(p->tilt, side < 0 ? -p->rise : p->rise, p->plane_normal, normal);
    for (int i = 0; i < 3; ++i)
        sph__add_scaled(p->center[i], p->radius[i], normal, corners[i]);
}
