/* SPDX-License-Identifier: MIT */
/* Poses: from spheres in the model to primitives and bounds in the frame of the pose. */
#include <float.h>
#include <math.h>

#include "numeric/vector.h"
#include "query/query.h"

/* The frame: the middle of all spheres, and a power of two. */
static void set_frame(sph_query *q)
{
    const sph__solid *s = &q->solid;
    double low[3] = {DBL_MAX, DBL_MAX, DBL_MAX}, high[3] = {-DBL_MAX, -DBL_MAX, -DBL_MAX}, most = 0;
    int exponent = 0;
    for (uint32_t i = 0; i < q->sphere_count; ++i)
        for (int k = 0; k < 3; ++k) {
            low[k] = fmin(low[k], s->centers[i][k] - s->radii[i]);
            high[k] = fmax(high[k], s->centers[i][k] + s->radii[i]);
        }
    for (int k = 0; k < 3; ++k) {
        q->origin[k] = 0.5 * (low[k] + high[k]);
        q->half[k] = fmax(high[k] - q->origin[k], q->origin[k] - low[k]);
        most = fmax(most, q->half[k]);
    }
    if (most > 0) frexp(most, &exponent);
    q->scale = ldexp(1, -exponent);
    q->unit = 1 / q->scale;
    for (int k = 0; k < 3; ++k)
        q->half[k] *= q->scale;
}

/* Of the slabs that which is thinnest, compared with the box. */
static void choose_slab(sph_query *q, uint32_t slot)
{
    const sph__query_fan *fan = &q->fans[slot];
    const sph__box *box = &q->solid.boxes[slot];
    float most = -1;
    int best = 0;
    for (int lane = 0; lane < SPH__QUERY_FAN; ++lane) {
        float width = 0, share;
        for (int k = 0; k < 3; ++k)
            width += fabsf(fan->normal[k][lane]) * (box->high[k] - box->low[k]);
        share = width / (fan->high[lane] - fan->low[lane] + 1e-9f);
        best = share > most ? lane : best;
        most = share > most ? share : most;
    }
    for (int k = 0; k < 3; ++k)
        q->bounds.normal[k][slot] = fan->normal[k][best];
    q->bounds.slab_low[slot] = fan->low[best];
    q->bounds.slab_high[slot] = fan->high[best];
}

static void set_primitive(sph_query *q, uint32_t slot)
{
    sph__solid *s = &q->solid;
    const int32_t count = s->corner_counts[slot];
    double c[3][3], r[3];
    for (int32_t i = 0; i < count; ++i) {
        sph__query_to_frame(q, s->centers[s->corners[slot][i]], c[i]);
        r[i] = s->radii[s->corners[slot][i]] * q->scale;
    }
    sph__primitive_set(&s->primitives[slot], count, (const double(*)[3])c, r);
    for (int k = 0; k < 3; ++k) {
        double low = c[0][k] - r[0], high = c[0][k] + r[0];
        for (int32_t i = 1; i < count; ++i) {
            low = c[i][k] - r[i] < low ? c[i][k] - r[i] : low;
            high = c[i][k] + r[i] > high ? c[i][k] + r[i] : high;
        }
        /* rounded to nearest: the margin of every search covers it */
        q->bounds.low[k][slot] = s->boxes[slot].low[k] = (float)low;
        q->bounds.high[k][slot] = s->boxes[slot].high[k] = (float)high;
    }
    sph__query_fan_set(&q->fans[slot], &s->primitives[slot]);
    choose_slab(q, slot);
    sph__query_parts_set(&q->parts[slot], &s->primitives[slot], q->shared[slot]);
}

void sph__query_repose(sph_query *q)
{
    set_frame(q);
    for (uint32_t i = 0; i < q->primitive_count; ++i)
        set_primitive(q, i);
    if (q->leaf_bounds != NULL) sph__query_leaves_pose(q);
    if (q->solid.tree.item_count > 0) sph__box_tree_refit(&q->solid.tree, q->solid.boxes);
    ++q->pose;
}

static const float *radii_of(const sph_query *q, uint32_t frame)
{
    return q->radii_per_frame ? q->frame_radii + (size_t)frame * q->sphere_count : q->frame_radii;
}

/* Between two frames, `share` of the way. */
static void pose_between(sph_query *q, uint32_t before, uint32_t after, double share)
{
    const float *a = q->frame_centers + 3 * (size_t)before * q->sphere_count, *r = radii_of(q, before);
    const float *b = q->frame_centers + 3 * (size_t)after * q->sphere_count, *t = radii_of(q, after);
    for (size_t i = 0; i < q->sphere_count; ++i) {
        for (size_t k = 0; k < 3; ++k)
            q->solid.centers[i][k] = a[3 * i + k] + share * ((double)b[3 * i + k] - a[3 * i + k]);
        q->solid.radii[i] = r[i] + share * ((double)t[i] - r[i]);
    }
    sph__query_repose(q);
}

sph_status sph_query_pose_frame(sph_query *q, uint32_t frame)
{
    SPH__OWN(q, SPH__QUERY);
    if (q == NULL) return sph__fail(NULL, SPH_E_INVALID, "sph_query_pose_frame: the handle is NULL");
    if (frame >= q->frame_count)
        return sph__fail(q->context, SPH_E_INVALID, "frame %u of %u", (unsigned)frame, (unsigned)q->frame_count);
    pose_between(q, frame, frame, 0);
    return SPH_OK;
}

sph_status sph_query_pose_time(sph_query *q, double frame)
{
    SPH__OWN(q, SPH__QUERY);
    uint32_t before;
    if (q == NULL) return sph__fail(NULL, SPH_E_INVALID, "sph_query_pose_time: the handle is NULL");
    if (!(frame >= 0 && frame <= (double)(q->frame_count - 1)))
        return sph__fail(q->context, SPH_E_INVALID, "frame %g is not in [0, %u]", frame,
                         (unsigned)(q->frame_count - 1));
    before = (uint32_t)frame;
    pose_between(q, before, before + 1 < q->frame_count ? before + 1 : before, frame - before);
    return SPH_OK;
}

static const float *row_at(const float *rows, size_t stride, size_t i)
{
    return (const float *)((const char *)rows + i * stride);
}

sph_status sph__query_check_points(const sph_query *q, const char *name, const float *points, size_t *stride,
                                   size_t count)
{
    enum { TIGHT = 3 * sizeof(float) };
    size_t span;
    if (points == NULL && count != 0) return sph__fail(q->context, SPH_E_INVALID, "%s: an argument is NULL", name);
    if (*stride == 0) *stride = TIGHT;
    if (*stride < TIGHT || !sph__multiply_size(count, *stride, &span) || span > PTRDIFF_MAX)
        return sph__fail(q->context, SPH_E_INVALID, "%s: a stride of %zu bytes is out of range", name, *stride);
    for (size_t i = 0; i < count; ++i) {
        float x[3];
        memcpy(x, row_at(points, *stride, i), sizeof x);
        if (!isfinite(x[0]) || !isfinite(x[1]) || !isfinite(x[2]))
            return sph__fail(q->context, SPH_E_INVALID, "%s: point %zu is not finite", name, i);
    }
    return SPH_OK;
}

sph_status sph_query_pose_centers(sph_query *q, const float *centers, size_t stride, const float *radii)
{
    SPH__OWN(q, SPH__QUERY);
    sph_status status;
    if (q == NULL || centers == NULL)
        return sph__fail(q == NULL ? NULL : q->context, SPH_E_INVALID, "sph_query_pose_centers: an argument is NULL");
    if (radii == NULL && q->radii_per_frame)
        return sph__fail(q->context, SPH_E_INVALID, "sph_query_pose_centers: this level's radii vary: pass some");
    status = sph__query_check_points(q, "sph_query_pose_centers", centers, &stride, q->sphere_count);
    if (status != SPH_OK) return status;
    if (radii == NULL) radii = q->frame_radii;
    for (uint32_t i = 0; i < q->sphere_count; ++i)
        if (!(isfinite(radii[i]) && radii[i] >= 0))
            return sph__fail(q->context, SPH_E_INVALID, "sph_query_pose_centers: the radius of sphere %u is %g",
                             (unsigned)i, (double)radii[i]);
    for (uint32_t i = 0; i < q->sphere_count; ++i) {
        float x[3];
        memcpy(x, row_at(centers, stride, i), sizeof x);
        for (int k = 0; k < 3; ++k)
            q->solid.centers[i][k] = x[k];
        q->solid.radii[i] = radii[i];
    }
    sph__query_repose(q);
    return SPH_OK;
}

void sph__query_contact(const sph_query *q, uint32_t slot, const sph__contact *c, sph_contact *out)
{
    const sph__query_simplex *simplex = &q->simplices[slot];
    const double weights[4] = {c->weights[0], c->weights[1], c->weights[2], 0};
    for (int k = 0; k < 3; ++k) {
        out->point[k] = c->point[k] * q->unit + q->origin[k];
        out->normal[k] = c->normal[k];
        out->weights[k] = weights[simplex->corner[k]];
        out->spheres[k] = simplex->spheres[k];
    }
    out->simplex = simplex->number;
    out->kind = simplex->kind;
    out->reserved0 = 0;
}

void sph__query_no_contact(sph_contact *out)
{
    *out = (sph_contact){.spheres = {SPH_NO_SPHERE, SPH_NO_SPHERE, SPH_NO_SPHERE}};
}
