/* SPDX-License-Identifier: MIT */
#include "simplify/kernel.h"

#include <math.h>
#include <string.h>

#include "hierarchy/lanes.h"

typedef sph__v8d v8d;

enum { BONE_ROWS = 24, PAIR_ROWS = SPH__FORM_SIZE, LANES = SPH__LANES };

/* Where the numbers of a form are in its 4x4 matrix. */
static const uint8_t ROWS[SPH__FORM_SIZE] = {0, 0, 0, 1, 1, 2, 0, 1, 2, 3};
static const uint8_t COLUMNS[SPH__FORM_SIZE] = {0, 1, 2, 1, 2, 2, 3, 3, 3, 3};

size_t sph__form_room(uint32_t count)
{
    const size_t k = count;
    return ((BONE_ROWS + 4) * k + PAIR_ROWS * (k * (k + 1) / 2)) * LANES;
}

/* M, b of the sum of two quadrics, relative to the first's point, in eight poses; what is added to c. */
#define SUM_QUADRICS(u, v, stride, i, m, b, c)                                                                         \
    do {                                                                                                               \
        const float *ub_ = (u)->block + (i)*SPH__QUADRIC_ROWS, *vb_ = (v)->block + (i)*SPH__QUADRIC_ROWS;              \
        v8d vm_[6], vl_[3], d_[3], e_[3];                                                                              \
        for (size_t k_ = 0; k_ < 6; ++k_) {                                                                            \
            vm_[k_] = sph__load(vb_, k_ * LANES);                                                                      \
            m[k_] = sph__load(ub_, k_ * LANES) + vm_[k_];                                                              \
        }                                                                                                              \
        for (size_t k_ = 0; k_ < 3; ++k_) {                                                                            \
            vl_[k_] = sph__load(vb_, (6 + k_) * LANES);                                                                \
            d_[k_] = sph__load((v)->center, k_ * (stride) + (i)) - sph__load((u)->center, k_ * (stride) + (i));        \
        }                                                                                                              \
        e_[0] = vm_[0] * d_[0] + vm_[1] * d_[1] + vm_[2] * d_[2];                                                      \
        e_[1] = vm_[1] * d_[0] + vm_[3] * d_[1] + vm_[4] * d_[2];                                                      \
        e_[2] = vm_[2] * d_[0] + vm_[4] * d_[1] + vm_[5] * d_[2];                                                      \
        for (size_t k_ = 0; k_ < 3; ++k_) {                                                                            \
            b[k_] = sph__load(ub_, (6 + k_) * LANES) + vl_[k_] + e_[k_];                                               \
            c += d_[k_] * (e_[k_] + 2.0 * vl_[k_]);                                                                    \
        }                                                                                                              \
    } while (0)

SPH__CLONES static void form_clones(const sph__posed *u, const sph__posed *v, size_t stride, const double *transforms,
                                    uint32_t transform_count, const uint32_t *bones, const double anchor[3],
                                    double *room, sph__form *form)
{
    const uint32_t count = form->count;
    v8d *moved = (v8d *)room, *pulled = moved + 12 * (size_t)count, *linear = pulled + 12 * (size_t)count;
    v8d *pairs = linear + 4 * (size_t)count, constant = {0};
    memset(linear, 0, (4 * (size_t)count + PAIR_ROWS * sph__form_pair(count, 0)) * sizeof *linear);
    for (size_t i = 0; i < stride; i += LANES) {
        const double *palette = transforms + i / LANES * transform_count * 12 * LANES;
        v8d m[6], b[3];
        SUM_QUADRICS(u, v, stride, i, m, b, constant);
        for (uint32_t k = 0; k < count; ++k) {
            const v8d *t = (const v8d *)(palette + (size_t)bones[k] * 12 * LANES);
            v8d *a = moved + 12 * (size_t)k, *w = pulled + 12 * (size_t)k,
                *sums = pairs + PAIR_ROWS * sph__form_pair(k, 0);
            for (size_t r = 0; r < 3; ++r) {
                a[r] = t[4 * r];
                a[3 + r] = t[4 * r + 1];
                a[6 + r] = t[4 * r + 2];
                a[9 + r] = t[4 * r] * anchor[0] + t[4 * r + 1] * anchor[1] + t[4 * r + 2] * anchor[2] + t[4 * r + 3] -
                           sph__load(u->center, r * stride + i);
            }
            for (size_t c = 0; c < 12; c += 3) {
                w[c] = m[0] * a[c] + m[1] * a[c + 1] + m[2] * a[c + 2];
                w[c + 1] = m[1] * a[c] + m[3] * a[c + 1] + m[4] * a[c + 2];
                w[c + 2] = m[2] * a[c] + m[4] * a[c + 1] + m[5] * a[c + 2];
                linear[4 * (size_t)k + c / 3] += b[0] * a[c] + b[1] * a[c + 1] + b[2] * a[c + 2];
            }
            for (uint32_t l = 0; l < k; ++l, sums += PAIR_ROWS) {
                const v8d *y = pulled + 12 * (size_t)l;
                for (size_t q = 0; q < PAIR_ROWS; ++q) {
                    const size_t r = 3 * (size_t)ROWS[q], c = 3 * (size_t)COLUMNS[q];
                    sums[q] += (a[r] * y[c] + a[r + 1] * y[c + 1] + a[r + 2] * y[c + 2]) +
                               (a[c] * y[r] + a[c + 1] * y[r + 1] + a[c + 2] * y[r + 2]);
                }
            }
            for (size_t q = 0; q < PAIR_ROWS; ++q) {
                const size_t r = 3 * (size_t)ROWS[q], c = 3 * (size_t)COLUMNS[q];
                sums[q] += 2.0 * (a[r] * w[c] + a[r + 1] * w[c + 1] + a[r + 2] * w[c + 2]);
            }
        }
    }
    for (size_t k = 0; k < 4 * (size_t)count; ++k)
        form->linear[k] = sph__sum(linear[k]);
    for (size_t k = 0; k < PAIR_ROWS * sph__form_pair(count, 0); ++k)
        form->pairs[k] = 0.5 * sph__sum(pairs[k]);
    form->constant = u->constant + v->constant + sph__sum(constant);
}

void sph__kernel_form(const sph__posed *u, const sph__posed *v, size_t stride, const double *transforms,
                      uint32_t transform_count, const uint32_t *bones, const double anchor[3], double *room,
                      sph__form *form)
{
    form_clones(u, v, stride, transforms, transform_count, bones, anchor, room, form);
}

SPH__CLONES static double unite_posed_clones(const sph__posed *u, const sph__posed *v, size_t stride, const float *center,
                                             float *block)
{
    v8d constant = {0};
    for (size_t i = 0; i < stride; i += LANES) {
        float *out = block + i * SPH__QUADRIC_ROWS;
        v8d m[6], b[3], d[3], e[3];
        SUM_QUADRICS(u, v, stride, i, m, b, constant);
        for (size_t k = 0; k < 3; ++k)
            d[k] = sph__load(center, k * stride + i) - sph__load(u->center, k * stride + i);
        e[0] = m[0] * d[0] + m[1] * d[1] + m[2] * d[2];
        e[1] = m[1] * d[0] + m[3] * d[1] + m[4] * d[2];
        e[2] = m[2] * d[0] + m[4] * d[1] + m[5] * d[2];
        for (size_t k = 0; k < 3; ++k) {
            constant += d[k] * (e[k] - 2.0 * b[k]);
            sph__store(out, (6 + k) * LANES, b[k] - e[k]);
        }
        for (size_t k = 0; k < 6; ++k)
            sph__store(out, k * LANES, m[k]);
    }
    return u->constant + v->constant + sph__sum(constant);
}

double sph__kernel_unite_posed(const sph__posed *u, const sph__posed *v, size_t stride, const float *center,
                               float *block)
{
    return unite_posed_clones(u, v, stride, center, block);
}

SPH__CLONES static void place_clones(const double *transforms, uint32_t transform_count, size_t stride,
                                     const double rest[3], const uint32_t *bones, const float *weights, uint32_t count,
                                     float *center)
{
    for (size_t i = 0; i < stride; i += LANES) {
        v8d sum[3] = {{0}, {0}, {0}};
        for (uint32_t k = 0; k < count; ++k) {
            const v8d *t = (const v8d *)(transforms + (i / LANES * transform_count + bones[k]) * 12 * LANES);
            const double weight = (double)weights[k];
            for (size_t r = 0; r < 3; ++r)
                sum[r] +=
                    weight * (t[4 * r] * rest[0] + t[4 * r + 1] * rest[1] + t[4 * r + 2] * rest[2] + t[4 * r + 3]);
        }
        for (size_t r = 0; r < 3; ++r)
            sph__store(center, r * stride + i, sum[r]);
    }
}

void sph__kernel_place(const double *transforms, uint32_t transform_count, size_t stride, const double rest[3],
                       const uint32_t *bones, const float *weights, uint32_t count, float *center)
{
    place_clones(transforms, transform_count, stride, rest, bones, weights, count, center);
}

/* Adds scale n n' as a plane through `at`, relative to the centre. */
#define ADD_PLANE(sums, n, scale, at, constant)                                                                        \
    do {                                                                                                               \
        const v8d distance_ = (n)[0] * (at)[0] + (n)[1] * (at)[1] + (n)[2] * (at)[2], by_ = (scale)*distance_;         \
        (sums)[0] += (scale) * (n)[0] * (n)[0];                                                                        \
        (sums)[1] += (scale) * (n)[0] * (n)[1];                                                                        \
        (sums)[2] += (scale) * (n)[0] * (n)[2];                                                                        \
        (sums)[3] += (scale) * (n)[1] * (n)[1];                                                                        \
        (sums)[4] += (scale) * (n)[1] * (n)[2];                                                                        \
        (sums)[5] += (scale) * (n)[2] * (n)[2];                                                                        \
        for (size_t k_ = 0; k_ < 3; ++k_)                                                                              \
            (sums)[6 + k_] += by_ * (n)[k_];                                                                           \
        (constant) += by_ * distance_;                                                                                 \
    } while (0)

/* Edge and normal (twice the area long) of the triangle, and where its plane is. */
#define SPAN(p, q, r, center, stride, i, at, e, n)                                                                     \
    do {                                                                                                               \
        v8d f_[3];                                                                                                     \
        for (size_t k_ = 0; k_ < 3; ++k_) {                                                                            \
            const v8d o_ = sph__load(p, k_ * (stride) + (i));                                                          \
            at[k_] = o_ - sph__load(center, k_ * (stride) + (i));                                                      \
            e[k_] = sph__load(q, k_ * (stride) + (i)) - o_;                                                            \
            f_[k_] = sph__load(r, k_ * (stride) + (i)) - o_;                                                           \
        }                                                                                                              \
        for (size_t k_ = 0; k_ < 3; ++k_) {                                                                            \
            const size_t k1_ = (k_ + 1) % 3, k2_ = (k_ + 2) % 3;                                                       \
            n[k_] = e[k1_] * f_[k2_] - e[k2_] * f_[k1_];                                                               \
        }                                                                                                              \
    } while (0)

SPH__CLONES static void plane_clones(const float *p, const float *q, const float *r, const float *center, size_t stride,
                                     double *block, double sums[2])
{
    v8d constant = {0}, area = {0};
    for (size_t i = 0; i < stride; i += LANES) {
        const v8d zero = {0};
        v8d *into = (v8d *)(block + i * SPH__QUADRIC_ROWS), at[3], e[3], n[3], squared, length, scale;
        SPAN(p, q, r, center, stride, i, at, e, n);
        squared = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
        length = sph__root(squared);
        /* a third of half the length, by the unit normal twice */
        scale = sph__where(squared, zero, 1.0 / (6.0 * length), zero);
        ADD_PLANE(into, n, scale, at, constant);
        area += length / 6.0;
    }
    sums[0] += sph__sum(constant);
    sums[1] += sph__sum(area);
}

void sph__kernel_add_plane(const float *p, const float *q, const float *r, const float *center, size_t stride,
                           double *block, double sums[2])
{
    plane_clones(p, q, r, center, stride, block, sums);
}

SPH__CLONES static double border_clones(const float *p, const float *q, const float *r, const float *center,
                                        size_t stride, double weight, double *block)
{
    v8d constant = {0};
    for (size_t i = 0; i < stride; i += LANES) {
        const v8d zero = {0};
        v8d *into = (v8d *)(block + i * SPH__QUADRIC_ROWS), at[3], e[3], n[3], side[3], along, across, scale;
        SPAN(p, q, r, center, stride, i, at, e, n);
        for (size_t k = 0; k < 3; ++k) {
            const size_t k1 = (k + 1) % 3, k2 = (k + 2) % 3;
            side[k] = e[k1] * n[k2] - e[k2] * n[k1];
        }
        along = e[0] * e[0] + e[1] * e[1] + e[2] * e[2];
        across = side[0] * side[0] + side[1] * side[1] + side[2] * side[2];
        scale = sph__where(across, zero, weight * along / (3.0 * across), zero);
        ADD_PLANE(into, side, scale, at, constant);
    }
    return sph__sum(constant);
}

double sph__kernel_add_border(const float *p, const float *q, const float *r, const float *center, size_t stride,
                              double weight, double *block)
{
    return border_clones(p, q, r, center, stride, weight, block);
}

SPH__CLONES static void pull_clones(const double *block, const double *transforms, uint32_t transform_count,
                                    size_t stride, const uint32_t *bones, const float *weights, uint32_t count,
                                    double out[6])
{
    v8d sums[6] = {{0}, {0}, {0}, {0}, {0}, {0}};
    for (size_t i = 0; i < stride; i += LANES) {
        const v8d *m = (const v8d *)(block + i * SPH__QUADRIC_ROWS);
        v8d a[9], w[9];
        for (size_t q = 0; q < 9; ++q) {
            v8d sum = {0};
            for (uint32_t k = 0; k < count; ++k) {
                const v8d *t = (const v8d *)(transforms + (i / LANES * transform_count + bones[k]) * 12 * LANES);
                sum += (double)weights[k] * t[4 * (q % 3) + q / 3];
            }
            a[q] = sum;
        }
        for (size_t c = 0; c < 9; c += 3) {
            w[c] = m[0] * a[c] + m[1] * a[c + 1] + m[2] * a[c + 2];
            w[c + 1] = m[1] * a[c] + m[3] * a[c + 1] + m[4] * a[c + 2];
            w[c + 2] = m[2] * a[c] + m[4] * a[c + 1] + m[5] * a[c + 2];
        }
        for (size_t q = 0; q < 6; ++q) {
            const size_t r = 3 * (size_t)ROWS[q], c = 3 * (size_t)COLUMNS[q];
            sums[q] += a[r] * w[c] + a[r + 1] * w[c + 1] + a[r + 2] * w[c + 2];
        }
    }
    for (size_t q = 0; q < 6; ++q)
        out[q] = sph__sum(sums[q]);
}

void sph__kernel_pull_back(const double *block, const double *transforms, uint32_t transform_count, size_t stride,
                           const uint32_t *bones, const float *weights, uint32_t count, double out[6])
{
    pull_clones(block, transforms, transform_count, stride, bones, weights, count, out);
}
