/* SPDX-License-Identifier: MIT */
/*
 * Distance to a primitive is convex, so beyond the tangent plane at the foot of p nothing of the primitive lies. The
 * half-spaces of all primitives around p meet in a convex set that holds p and is free of the solid; its point nearest
 * to x is the next p. The way there is free, so p stays on its side of sheets and shells, and comes nearer each time.
 */
#include "measure/measure.h"

#include "numeric/vector.h"

enum { MOST_PLANES = 96, MOST_STEPS = 100 };

/* Points z with normal.z >= -gap are free. */
typedef struct plane {
    double normal[3];
    double gap;
} plane;

static double height(const plane *p, const double z[3])
{
    return sph__dot(p->normal, z) + p->gap;
}

/* Onto the line where planes i and j meet, as far as the planes before j allow. */
static void project_on_line(const plane *planes, uint32_t i, uint32_t j, const double direction[3],
                            const double target[3], double z[3])
{
    const double *a = planes[i].normal, *b = planes[j].normal;
    const double cosine = sph__dot(a, b), square = sph__dot(direction, direction);
    const double u = (-planes[i].gap + planes[j].gap * cosine) / square;
    const double v = (-planes[j].gap + planes[i].gap * cosine) / square;
    double t = sph__dot(target, direction) / square, low = -1e300, high = 1e300;
    for (int k = 0; k < 3; ++k)
        z[k] = u * a[k] + v * b[k];
    for (uint32_t k = 0; k < j; ++k) {
        const double slope = sph__dot(planes[k].normal, direction), at = height(&planes[k], z);
        if (k == i || fabs(slope) < 1e-12) continue;
        if (slope > 0)
            low = fmax(low, -at / slope);
        else
            high = fmin(high, -at / slope);
    }
    t = fmax(low, fmin(high, t));
    sph__add_scaled(z, t, direction, z);
}

/* Onto plane i, as far as the planes before it allow. */
static void project_on_plane(const plane *planes, uint32_t i, double slack, const double target[3], double z[3])
{
    sph__add_scaled(target, -height(&planes[i], target), planes[i].normal, z);
    for (uint32_t j = 0; j < i; ++j) {
        double direction[3];
        if (height(&planes[j], z) >= -slack) continue;
        sph__cross(planes[i].normal, planes[j].normal, direction);
        if (sph__dot(direction, direction) > 1e-20) project_on_line(planes, i, j, direction, target, z);
    }
}

/* The point nearest to `target` that all planes allow, plane by plane; 0 is allowed by all. */
static void project(const plane *planes, uint32_t count, double slack, const double target[3], double z[3])
{
    double scale = 1;
    sph__copy3(target, z);
    for (uint32_t i = 0; i < count; ++i)
        if (height(&planes[i], z) < -slack) project_on_plane(planes, i, slack, target, z);
    for (uint32_t i = 0; i < count; ++i) /* where rounding left some plane crossed, stop short of it */
        if (height(&planes[i], z) < -100 * slack)
            scale = fmin(scale, planes[i].gap / (planes[i].gap - height(&planes[i], z)));
    for (int k = 0; k < 3; ++k)
        z[k] *= scale;
}

/* Planes of the primitives nearer to p than *reach, which becomes less where there are too many. */
static uint32_t set_planes(const sph__solid *solid, const double p[3], double *reach, plane *planes)
{
    uint32_t found[MOST_PLANES], count;
    while ((count = sph__solid_gather(solid, p, *reach, found, MOST_PLANES)) > MOST_PLANES && *reach > 0)
        *reach *= 0.5;
    if (count > MOST_PLANES) count = MOST_PLANES;
    for (uint32_t i = 0; i < count; ++i) {
        sph__contact c;
        sph__primitive_closest(&solid->primitives[found[i]], p, &c);
        sph__copy3(c.normal, planes[i].normal);
        planes[i].gap = c.distance > 0 ? c.distance : 0;
    }
    return count;
}

double sph__outer_descend(const sph__solid *solid, const double x[3], double p[3], double tolerance, double enough)
{
    plane planes[MOST_PLANES];
    double distance = sph__distance(x, p);
    for (int i = 0; i < MOST_STEPS && distance > enough; ++i) {
        double reach = distance, target[3], z[3], length, next;
        const uint32_t count = set_planes(solid, p, &reach, planes);
        sph__subtract(x, p, target);
        project(planes, count, 1e-5 * tolerance, target, z);
        length = sph__norm(z);
        sph__add_scaled(p, length > reach ? reach / length : 1, z, z);
        next = sph__distance(x, z);
        if (!(next < distance)) break;
        sph__copy3(z, p);
        if (distance - next < tolerance) return next;
        distance = next;
    }
    return distance;
}
