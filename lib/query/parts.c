/* SPDX-License-Identifier: MIT */
#include "query/parts.h"

#include <math.h>
#include <string.h>

#include "numeric/vector.h"

/* The corner again: a cone of no length around its sphere is that sphere. */
static void set_edge(sph__query_parts *parts, int lane, const sph__primitive *p, int index)
{
    const sph__primitive_edge *e = &p->edge[index];
    parts->cosine[lane] = 1;
    if (p->corner_count == 1 || e->only >= 0) return;
    for (int k = 0; k < 3; ++k)
        parts->axis[k][lane] = (float)e->axis[k];
    parts->sine[lane] = (float)e->sine;
    parts->cosine[lane] = (float)e->cosine;
    parts->length[lane] = (float)(e->length * e->cosine * e->cosine);
    parts->tangent[lane] = (float)(e->sine / e->cosine);
    parts->whole[lane] = (float)e->length;
}

/* The prism's corners are centre + radius * (tilt +- rise * plane_normal). Any direction gives a bound. */
static void set_side(sph__query_parts *parts, int lane, const sph__primitive *p, const double feet[3][3])
{
    const int i = lane % 3;
    double along[3], normal[3], length, most = 0;
    sph__subtract(feet[(i + 1) % 3], feet[i], along);
    sph__cross(along, p->plane_normal, normal);
    length = sph__norm(normal);
    for (int k = 0; k < 3; ++k)
        normal[k] = length > 0 ? normal[k] / length : 0;
    for (int j = 0; j < 3; ++j) {
        const double place = sph__dot(normal, feet[j]);
        most = j == 0 || place > most ? place : most;
    }
    for (int k = 0; k < 3; ++k)
        parts->side[k][lane] = (float)normal[k];
    parts->beyond[lane] = (float)(most - sph__dot(normal, p->center[i]));
    parts->growth[lane] = (float)sph__dot(normal, p->tilt);
}

static void set_prism(sph__query_parts *parts, const sph__primitive *p)
{
    double feet[3][3];
    for (int i = 0; i < 3; ++i) {
        sph__copy3(p->center[i], feet[i]);
        sph__add_scaled(feet[i], p->radius[i], p->tilt, feet[i]);
    }
    for (int lane = 0; lane < SPH__QUERY_FAN; ++lane)
        set_side(parts, lane, p, (const double(*)[3])feet);
    for (int k = 0; k < 3; ++k) {
        parts->face[0][k] = (float)(p->tilt[k] + p->rise * p->plane_normal[k]);
        parts->face[1][k] = (float)(p->tilt[k] - p->rise * p->plane_normal[k]);
    }
}

/* What tells how far a place is from the faces; without any, no weights are those of a place on one. */
static void set_plane(sph__query_parts *parts, const sph__primitive *p)
{
    if (!p->has_faces) {
        parts->plane_constant[1] = -1;
        return;
    }
    for (int k = 0; k < 3; ++k) {
        const double row[SPH__QUERY_FAN] = {p->plane_normal[k], p->gradient[0][k], p->gradient[1][k], p->tilt[k]};
        for (int lane = 0; lane < SPH__QUERY_FAN; ++lane)
            parts->plane[k][lane] = (float)row[lane];
    }
    parts->plane_height[1] = (float)-p->gradient_tilt[0];
    parts->plane_height[2] = (float)-p->gradient_tilt[1];
    parts->plane_height[3] = (float)p->rise;
    parts->plane_constant[3] = (float)-p->radius[0];
}

/*
 * Where the nearest sphere is on an edge is off by as much as its slope is steep; where it is on the face, by as much
 * as its weights change across it. The distance changes at most twice as fast as that place.
 */
static float loose_of(const sph__primitive *p)
{
    double steep = 0, flat = 0;
    const int edges = p->corner_count == 3 ? 3 : p->corner_count - 1;
    for (int i = 0; i < edges; ++i)
        if (p->edge[i].only < 0) steep = fmax(steep, fabs(p->edge[i].sine) / p->edge[i].cosine);
    for (int i = 0; p->has_faces && i < 2; ++i) {
        double way[3];
        sph__subtract(p->center[i + 1], p->center[0], way);
        flat += (sph__norm(p->gradient[i]) + fabs(p->gradient_tilt[i])) * sph__norm(way);
    }
    return (float)fmin(4e-6 * (1 + steep + flat), SPH__QUERY_FAR); /* also where it is no number */
}

void sph__query_parts_set(sph__query_parts *parts, const sph__primitive *p, uint32_t shared)
{
    memset(parts, 0, sizeof *parts);
    parts->corner_count = (uint32_t)p->corner_count;
    for (int lane = 0; lane < SPH__QUERY_FAN; ++lane) {
        const int i = p->corner_count == 3 ? lane % 3 : lane % p->corner_count;
        const bool has_edge = p->corner_count == 3 || i == 0;
        for (int k = 0; k < 3; ++k)
            parts->center[k][lane] = (float)p->center[i][k];
        parts->radius[lane] = (float)p->radius[i];
        parts->shared_corner[lane] = shared >> i & 1 ? SPH__QUERY_NEVER : 0;
        parts->shared_edge[lane] = shared >> (3 + i) & 1 || !has_edge ? SPH__QUERY_NEVER : 0;
        if (has_edge)
            set_edge(parts, lane, p, i);
        else
            parts->cosine[lane] = 1;
    }
    parts->room = p->has_faces ? 0 : -1e15f;
    if (p->has_faces) set_prism(parts, p);
    set_plane(parts, p);
    parts->loose = loose_of(p);
}
