/* SPDX-License-Identifier: MIT */
#include "query/fan.h"

#include <string.h>

#include "hierarchy/lanes.h"
#include "numeric/vector.h"

enum { MOST_STEPS = 100 };

typedef double v4d __attribute__((vector_size(32), may_alias));
typedef int64_t v4i __attribute__((vector_size(32)));

#define LOAD4(row) (*(const v4d *)(row))
#define SELECT4(mask, a, b) ((v4d)(((mask) & (v4i)(a)) | (~(mask) & (v4i)(b))))

static void set_edge(sph__query_fan *fan, int lane, const sph__primitive *p, const sph__primitive_edge *e)
{
    double span[3], squared;
    sph__subtract(p->center[e->to], p->center[e->from], span);
    squared = e->length * e->length;
    for (int k = 0; k < 3; ++k) {
        fan->from[k][lane] = p->center[e->from][k];
        fan->span[k][lane] = span[k];
    }
    fan->radius[lane] = p->radius[e->from];
    fan->growth[lane] = p->radius[e->to] - p->radius[e->from];
    if (e->only >= 0) { /* one end alone */
        fan->bias[lane] = e->only == e->to;
        return;
    }
    for (int k = 0; k < 3; ++k)
        fan->share[k][lane] = span[k] / squared;
    fan->lean[lane] = e->sine / (e->cosine * e->length);
}

/* Across a triangle and its three edges; around the axis of anything else. */
static void choose_slabs(const sph__primitive *p, double normals[SPH__QUERY_FAN][3])
{
    static const double TURN = 0.7071067811865476;
    double axis[3] = {0, 0, 1};
    if (p->has_faces) {
        sph__copy3(p->plane_normal, normals[3]);
        for (int i = 0; i < 3; ++i) {
            double length;
            sph__subtract(p->center[p->edge[i].to], p->center[p->edge[i].from], axis);
            sph__cross(axis, p->plane_normal, normals[i]);
            length = sph__norm(normals[i]);
            for (int k = 0; k < 3; ++k)
                normals[i][k] = length > 0 ? normals[i][k] / length : k == 0;
        }
        return;
    }
    for (int i = 0; i < (p->corner_count == 3 ? 3 : p->corner_count - 1); ++i)
        if (p->edge[i].only < 0) sph__copy3(p->edge[i].axis, axis);
    sph__perpendicular(axis, normals[0]);
    sph__cross(axis, normals[0], normals[1]);
    for (int k = 0; k < 3; ++k) {
        normals[2][k] = TURN * (normals[0][k] + normals[1][k]);
        normals[3][k] = TURN * (normals[0][k] - normals[1][k]);
    }
}

static void set_slabs(sph__query_fan *fan, const sph__primitive *p)
{
    double normals[SPH__QUERY_FAN][3];
    choose_slabs(p, normals);
    for (int lane = 0; lane < SPH__QUERY_FAN; ++lane) {
        double low = 1e15, high = -1e15;
        for (int32_t i = 0; i < p->corner_count; ++i) {
            const double place = sph__dot(normals[lane], p->center[i]);
            low = place - p->radius[i] < low ? place - p->radius[i] : low;
            high = place + p->radius[i] > high ? place + p->radius[i] : high;
        }
        for (int k = 0; k < 3; ++k)
            fan->normal[k][lane] = (float)normals[lane][k];
        fan->low[lane] = (float)low;
        fan->high[lane] = (float)high;
    }
}

void sph__query_fan_set(sph__query_fan *fan, const sph__primitive *p)
{
    memset(fan, 0, sizeof *fan);
    set_slabs(fan, p);
    for (int lane = 0; lane < SPH__QUERY_FAN; ++lane) {
        if (p->corner_count > 1) {
            set_edge(fan, lane, p, &p->edge[p->corner_count == 3 ? lane % 3 : 0]);
            continue;
        }
        for (int k = 0; k < 3; ++k)
            fan->from[k][lane] = p->center[0][k];
        fan->radius[lane] = p->radius[0];
    }
    if (!p->has_faces) return;
    fan->has_faces = 1;
    sph__copy3(p->center[0], fan->center);
    sph__copy3(p->plane_normal, fan->plane_normal);
    sph__copy3(p->tilt, fan->tilt);
    memcpy(fan->gradient, p->gradient, sizeof fan->gradient);
    memcpy(fan->gradient_tilt, p->gradient_tilt, sizeof fan->gradient_tilt);
    fan->rise = p->rise;
    fan->face_radius = p->radius[0];
}

typedef float v4f __attribute__((vector_size(16), may_alias));
typedef int32_t v4fi __attribute__((vector_size(16)));

#define LOAD4F(row) (*(const v4f *)(row))
#define SELECT4F(mask, a, b) ((v4f)(((mask) & (v4fi)(a)) | (~(mask) & (v4fi)(b))))

float sph__query_fan_entry(const sph__query_fan *f, const sph__query_ray *ray, float entry)
{
    const v4f zero = {0}, tiny = zero + 1e-18f;
    const v4f n0 = LOAD4F(f->normal[0]), n1 = LOAD4F(f->normal[1]), n2 = LOAD4F(f->normal[2]);
    const v4f place = n0 * ray->from[0] + n1 * ray->from[1] + n2 * ray->from[2];
    const v4f rate = n0 * ray->way[0] + n1 * ray->way[1] + n2 * ray->way[2];
    const v4f inverse = 1.0f / (rate + SELECT4F(rate < zero, -tiny, tiny)); /* never infinite */
    const v4f a = (LOAD4F(f->low) - ray->reach - place) * inverse, b = (LOAD4F(f->high) + ray->reach - place) * inverse;
    const v4f first = SELECT4F(a < b, a, b), last = SELECT4F(a < b, b, a);
    float in = entry, out = 1;
    for (int l = 0; l < SPH__QUERY_FAN; ++l) {
        in = first[l] > in ? first[l] : in;
        out = last[l] < out ? last[l] : out;
    }
    return in <= out ? in : SPH__QUERY_MISS;
}

float sph__query_fan_bound(const sph__query_fan *f, const float x[3])
{
    const v4f place = LOAD4F(f->normal[0]) * x[0] + LOAD4F(f->normal[1]) * x[1] + LOAD4F(f->normal[2]) * x[2];
    const v4f below = LOAD4F(f->low) - place, above = place - LOAD4F(f->high);
    const v4f d = SELECT4F(below > above, below, above);
    const float m = d[0] > d[1] ? d[0] : d[1], n = d[2] > d[3] ? d[2] : d[3];
    return m > n ? m : n;
}

/* Is the face nearest to x? Then its distance and slope along `way`. */
SPH__INLINE int face(const sph__query_fan *f, const double x[3], const double way[3], double *distance, double *slope)
{
    const double d[3] = {x[0] - f->center[0], x[1] - f->center[1], x[2] - f->center[2]};
    const double above = sph__dot(d, f->plane_normal), height = fabs(above);
    const double b1 = sph__dot(f->gradient[0], d) - height * f->gradient_tilt[0];
    const double b2 = sph__dot(f->gradient[1], d) - height * f->gradient_tilt[1];
    if (b1 < 0 || b2 < 0 || b1 + b2 > 1) return 0;
    *distance = sph__dot(d, f->tilt) + height * f->rise - f->face_radius;
    *slope = sph__dot(f->tilt, way) + (above < 0 ? -f->rise : f->rise) * sph__dot(f->plane_normal, way);
    return 1;
}

/* Of four edges the least distance, and its slope. */
SPH__INLINE double edges(const sph__query_fan *f, const double x[3], const double way[3], double *slope)
{
    const v4d zero = {0}, one = zero + 1.0;
    const v4d d0 = x[0] - LOAD4(f->from[0]), d1 = x[1] - LOAD4(f->from[1]), d2 = x[2] - LOAD4(f->from[2]);
    const v4d s0 = LOAD4(f->span[0]), s1 = LOAD4(f->span[1]), s2 = LOAD4(f->span[2]);
    const v4d along = d0 * LOAD4(f->share[0]) + d1 * LOAD4(f->share[1]) + d2 * LOAD4(f->share[2]);
    const v4d w0 = d0 - along * s0, w1 = d1 - along * s1, w2 = d2 - along * s2;
    v4d u, y0, y1, y2, across = w0 * w0 + w1 * w1 + w2 * w2, length, distance, rate;
    int least, third;
    for (int l = 0; l < SPH__QUERY_FAN; ++l)
        across[l] = sqrt(across[l]);
    u = along - across * LOAD4(f->lean) + LOAD4(f->bias);
    u = SELECT4(u > zero, u, zero);
    u = SELECT4(u < one, u, one);
    y0 = d0 - u * s0;
    y1 = d1 - u * s1;
    y2 = d2 - u * s2;
    length = y0 * y0 + y1 * y1 + y2 * y2;
    for (int l = 0; l < SPH__QUERY_FAN; ++l)
        length[l] = sqrt(length[l]);
    distance = length - (LOAD4(f->radius) + u * LOAD4(f->growth));
    rate = y0 * way[0] + y1 * way[1] + y2 * way[2];
    least = distance[1] < distance[0]; /* by arithmetic: a branch would be a guess */
    third = distance[2] < distance[least];
    least += third * (2 - least);
    *slope = length[least] > 0 ? rate[least] / length[least] : 0;
    return distance[least];
}

SPH__CLONES static int approach_clones(const sph__query_fan *fan, const sph__query_move *m, double limit, double *t,
                                       double *distance)
{
    double at = *t;
    for (int i = 0; i < MOST_STEPS; ++i) {
        const double x[3] = {m->start[0] + at * m->way[0], m->start[1] + at * m->way[1], m->start[2] + at * m->way[2]};
        double f = 0, slope = 0, next;
        if (!fan->has_faces || !face(fan, x, m->way, &f, &slope)) f = edges(fan, x, m->way, &slope);
        f -= m->radius;
        if (f <= m->tolerance) {
            *t = at;
            *distance = f;
            return 1;
        }
        if (!(slope < 0)) return 0;
        next = at - f / slope;
        if (!(next <= 1)) {
            if (!(next <= 1 + 1e-12) || at == 1) return 0;
            next = 1;
        }
        if (next > limit) return 0;
        if (next == at) next = nextafter(at, 2);
        at = next;
    }
    return 0;
}

bool sph__query_approach(const sph__query_fan *fan, const sph__query_move *move, double limit, double *t,
                         double *distance)
{
    return approach_clones(fan, move, limit, t, distance) != 0;
}

SPH__CLONES static double distance_clones(const sph__query_fan *fan, const double x[3])
{
    static const double STILL[3] = {0, 0, 0};
    double f = 0, slope = 0;
    if (fan->has_faces && face(fan, x, STILL, &f, &slope)) return f;
    return edges(fan, x, STILL, &slope);
}

double sph__query_fan_distance(const sph__query_fan *fan, const double x[3])
{
    return distance_clones(fan, x);
}
