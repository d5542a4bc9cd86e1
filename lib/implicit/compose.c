/* SPDX-License-Identifier: MIT */
/* The fields of a pose, and what they are together. */
#include <math.h>

#include "implicit/implicit.h"
#include "numeric/affine.h"
#include "numeric/vector.h"

static const double PI = 3.14159265358979323846;
void sph__place_fields(const sph_implicit *implicit, const double *transforms, sph__placed *placed)
{
    static const double IDENTITY[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    for (size_t b = 0; b < implicit->bone_count; ++b) {
        const sph__field *f = implicit->fields + b;
        const double *m = transforms == NULL ? IDENTITY : transforms + 12 * b;
        sph__placed *p = placed + b;
        *p = (sph__placed){.live = false};
        if (f->count == 0 || !sph__affine_invert(m, p->inverse)) continue;
        p->live = true;
    }
}

/* A box around points. */
typedef struct box {
    double low[3], high[3];
} box;

static box bound(size_t count, const sph__points *p)
{
    box b = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (size_t i = 0; i < count; ++i) {
        const double x[3] = {p->x[i], p->y[i], p->z[i]};
        for (int c = 0; c < 3; ++c) {
            b.low[c] = x[c] < b.low[c] ? x[c] : b.low[c];
            b.high[c] = x[c] > b.high[c] ? x[c] : b.high[c];
        }
    }
    return b;
}

/* Whether the box, in the frame of the field at rest, meets that of its support. */
static bool reaches(const sph__field *f, const sph__placed *p, const box *b)
{
    if (!p->live) return false;
    for (int r = 0; r < 3; ++r) {
        const double *row = p->inverse + 4 * r;
        double middle = row[3], half = 0;
        for (int c = 0; c < 3; ++c) {
            middle += row[c] * 0.5 * (b->low[c] + b->high[c]);
            half += fabs(row[c]) * 0.5 * (b->high[c] - b->low[c]);
        }
        half *= 1 + 1e-9;
        if (middle + half < f->low[r] || middle - half > f->high[r]) return false;
    }
    return true;
}

static void evaluate(const sph_implicit *implicit, const sph__placed *placed, uint32_t bone, int32_t evaluation,
                     size_t count, const sph__points *points, sph__values *out)
{
    if (evaluation == SPH_EVALUATION_TABLE)
        sph__field_table(implicit->fields + bone, placed + bone, count, points, out);
    else
        sph__field_exact(implicit->fields + bone, placed + bone, count, points, out);
}

/* Where a field is the largest so far it takes the place of what was. */
static void unite(uint32_t bone, size_t count, const sph__values *v, sph__values *out, uint32_t *bones)
{
    for (size_t i = 0; i < count; ++i) {
        if (!(v->f[i] > out->f[i])) continue;
        out->f[i] = v->f[i];
        out->x[i] = v->x[i];
        out->y[i] = v->y[i];
        out->z[i] = v->z[i];
        bones[i] = bone;
    }
}

/* --- operators --- */

static double angle_between(const double g[3], const double h[3])
{
    const double lengths = sqrt(sph__dot(g, g) * sph__dot(h, h));
    const double cosine = lengths > 0 ? sph__dot(g, h) / lengths : 1;
    return acos(cosine > 1 ? 1 : cosine < -1 ? -1 : cosine);
}

static double curve_at(const sph__joint *joint, double alpha)
{
    const double u = alpha / PI * (SPH__CURVE_SIZE - 1);
    const int at = u < SPH__CURVE_SIZE - 2 ? (int)u : SPH__CURVE_SIZE - 2;
    return (double)joint->curve[at] + ((double)joint->curve[at + 1] - (double)joint->curve[at]) * (u - at);
}

/* Trilinear, and the slopes of that. */
static double look_up(const sph__operator_table *t, double theta, double f1, double f2, double slopes[2])
{
    const double per = (double)(t->size - 1), u[3] = {f1 * per, f2 * per, theta / SPH__UNION_THETA * per};
    const size_t step[3] = {1, t->size, (size_t)t->size * t->size};
    double rest[3], v[4];
    size_t at = 0;
    for (int c = 0; c < 3; ++c) {
        const size_t cell = u[c] < per - 1 ? (u[c] > 0 ? (size_t)u[c] : 0) : t->size - 2;
        rest[c] = u[c] - (double)cell;
        at += cell * step[c];
    }
    for (size_t i = 0; i < 4; ++i) {
        const float *p = t->values + at + i % 2 * step[0] + i / 2 * step[1];
        v[i] = (double)p[0] + ((double)p[step[2]] - (double)p[0]) * rest[2];
    }
    slopes[0] = ((v[1] - v[0]) * (1 - rest[1]) + (v[3] - v[2]) * rest[1]) * per;
    slopes[1] = ((v[2] - v[0]) * (1 - rest[0]) + (v[3] - v[1]) * rest[0]) * per;
    return (v[0] * (1 - rest[0]) + v[1] * rest[0]) * (1 - rest[1]) + (v[2] * (1 - rest[0]) + v[3] * rest[0]) * rest[1];
}

static void join(const sph_implicit *implicit, const sph__joint *joint, int32_t evaluation, size_t count,
                 const sph__values *a, const sph__values *b, sph__values *out, uint32_t *bones)
{
    const sph_implicit_joint *j = &joint->given;
    for (size_t i = 0; i < count; ++i) {
        const double g[3] = {a->x[i], a->y[i], a->z[i]}, h[3] = {b->x[i], b->y[i], b->z[i]};
        double slopes[2], value, alpha;
        if (!(a->f[i] > 0) || !(b->f[i] > 0)) continue; /* the union has been taken */
        alpha = angle_between(g, h);
        if (evaluation == SPH_EVALUATION_TABLE)
            value = look_up(implicit->tables + joint->table, curve_at(joint, alpha), a->f[i], b->f[i], slopes);
        else
            value = sph__compose(j->operation, j->strength, sph__curve_at(&j->curve, alpha), a->f[i], b->f[i], slopes);
        if (!(value > out->f[i])) continue;
        out->f[i] = value;
        out->x[i] = slopes[0] * g[0] + slopes[1] * h[0];
        out->y[i] = slopes[0] * g[1] + slopes[1] * h[1];
        out->z[i] = slopes[0] * g[2] + slopes[1] * h[2];
        bones[i] = a->f[i] >= b->f[i] ? j->bones[0] : j->bones[1];
    }
}

void sph__compose_block(const sph_implicit *implicit, const sph__placed *placed, int32_t evaluation, size_t count,
                        sph__points *points, sph__values *out, uint32_t bones[SPH__IMPLICIT_BLOCK])
{
    const box b = bound(count, points);
    sph__values first, second;
    for (size_t i = 0; i < SPH__IMPLICIT_BLOCK; ++i) {
        out->f[i] = out->x[i] = out->y[i] = out->z[i] = 0;
        bones[i] = SPH__NO_PART;
        if (i >= count) points->x[i] = points->y[i] = points->z[i] = 0;
    }
    count = (count + 7) / 8 * 8;
    for (uint32_t k = 0; k < implicit->bone_count; ++k) {
        if (!reaches(implicit->fields + k, placed + k, &b)) continue;
        evaluate(implicit, placed, k, evaluation, count, points, &first);
        unite(k, count, &first, out, bones);
    }
    for (uint32_t k = 0; k < implicit->joint_count; ++k) {
        const sph_implicit_joint *j = &implicit->joints[k].given;
        if (j->operation == SPH_OPERATION_UNION || !reaches(implicit->fields + j->bones[0], placed + j->bones[0], &b) ||
            !reaches(implicit->fields + j->bones[1], placed + j->bones[1], &b))
            continue;
        evaluate(implicit, placed, j->bones[0], evaluation, count, points, &first);
        evaluate(implicit, placed, j->bones[1], evaluation, count, points, &second);
        join(implicit, implicit->joints + k, evaluation, count, &first, &second, out, bones);
    }
}
