/* SPDX-License-Identifier: MIT */
#include "query/fan.h"

#include <string.h>

#include "numeric/vector.h"

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

static sph__primitive_edge reverse(const sph__primitive_edge *e)
{
    sph__primitive_edge back = *e;
    back.from = e->to;
    back.to = e->from;
    back.sine = -e->sine;
    return back;
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

static void set_face(sph__query_fan *fan, const sph__primitive *p)
{
    if (!p->has_faces) {
        fan->face_constant[1] = -1;
        return;
    }
    for (int k = 0; k < 3; ++k) {
        const double row[SPH__QUERY_FAN] = {p->plane_normal[k], p->gradient[0][k], p->gradient[1][k], p->tilt[k]};
        memcpy(fan->face[k], row, sizeof row);
    }
    fan->face_height[1] = -p->gradient_tilt[0];
    fan->face_height[2] = -p->gradient_tilt[1];
    fan->face_height[3] = p->rise;
    fan->face_constant[3] = -p->radius[0];
}

void sph__query_fan_set(sph__query_fan *fan, const sph__primitive *p)
{
    memset(fan, 0, sizeof *fan);
    set_slabs(fan, p);
    for (int lane = 0; lane < SPH__QUERY_FAN; ++lane) {
        if (p->corner_count == 3) {
            set_edge(fan, lane, p, &p->edge[lane % 3]);
            continue;
        }
        if (p->corner_count == 2) {
            const sph__primitive_edge back = reverse(&p->edge[0]);
            set_edge(fan, lane, p, lane == 1 ? &back : &p->edge[0]);
            continue;
        }
        for (int k = 0; k < 3; ++k)
            fan->from[k][lane] = p->center[0][k];
        fan->radius[lane] = p->radius[0];
    }
    set_face(fan, p);
}
