/* SPDX-License-Identifier: MIT */
#include "base/base.h"
#include "hierarchy/kernel.h"
#include "hierarchy/united.h"

/* Asks for eight frames of a region's rows. */
SPH__INLINE void ask_for_rows(const sph__region *region, size_t i)
{
    const size_t rows = region->leaf ? SPH__LEAF_ROWS : SPH__BLOCK_ROWS;
    const char *begin = (const char *)(region->block + i * rows);
    for (size_t line = 0; line < rows * SPH__LANES * sizeof(float); line += 64) __builtin_prefetch(begin + line);
}

/* Asks for the rows of the frames that come so many later: the machine's own guesses end with each page. */
enum { AHEAD = 32 };

SPH__INLINE void ask_ahead(const sph__region *region, size_t s, size_t i)
{
    if (i + AHEAD < s) ask_for_rows(region, i + AHEAD);
}

/* Asks for as many frames of what is read next as are read now. */
SPH__INLINE void ask_meanwhile(const sph__region *next, size_t s, size_t i)
{
    ask_for_rows(next, i);
    for (size_t k = 0; k < 3; ++k) __builtin_prefetch(next->center + k * s + i);
}

/* What sums over frames are made of, lane by lane. */
enum { SUM_B, SUM_C, SUM_NN, SUM_NB, SUM_BB, SUM_MU, SUM_NU, SUM_B1, SUM_SCALE, SUM_COUNT, SUMS };

/* What the degenerate of eight frames add. */
SPH__INLINE void add_degenerate(const frame_quadric *q, const frame_inverse *a, sph__v8d sums[SUMS])
{
    const sph__v8d zero = {0};
    const sph__v8d part = sph__where(a->det, a->least, zero, zero + 1.0);
    sph__v8d x0, x1, x2;
    if (sph__is_zero(&part)) return;
    x0 = q->m00 * q->d0 + q->m01 * q->d1 + q->m02 * q->d2;
    x1 = q->m01 * q->d0 + q->m11 * q->d1 + q->m12 * q->d2;
    x2 = q->m02 * q->d0 + q->m12 * q->d1 + q->m22 * q->d2;
    sums[SUM_MU] += part * (x0 * q->d0 + x1 * q->d1 + x2 * q->d2);
    sums[SUM_NU] += part * (q->n0 * q->d0 + q->n1 * q->d1 + q->n2 * q->d2);
    sums[SUM_B1] += part * (q->b0 * q->d0 + q->b1 * q->d1 + q->b2 * q->d2);
    sums[SUM_SCALE] += part * ((q->m00 + q->m11 + q->m22) * (q->d0 * q->d0 + q->d1 * q->d1 + q->d2 * q->d2));
    sums[SUM_COUNT] += part;
}

/* Adds eight frames. */
SPH__INLINE void add_sums(const sph__region *u, const sph__region *v, size_t s, size_t i, const sph__v8d *offset,
                          double coherence, sph__v8d sums[SUMS])
{
    frame_quadric q;
    frame_inverse a;
    sph__v8d x0, x1, x2, y0, y1, y2;
    unite_frames(u, v, s, i, offset, &q);
    if (coherence > 0) add_coherence(u, v, s, i, coherence, &q);
    invert_frames(&q, &a);
    sums[SUM_B] += q.sum_b;
    sums[SUM_C] += q.sum_c;
    x0 = a.a00 * q.n0 + a.a01 * q.n1 + a.a02 * q.n2;
    x1 = a.a01 * q.n0 + a.a11 * q.n1 + a.a12 * q.n2;
    x2 = a.a02 * q.n0 + a.a12 * q.n1 + a.a22 * q.n2;
    y0 = a.a00 * q.b0 + a.a01 * q.b1 + a.a02 * q.b2;
    y1 = a.a01 * q.b0 + a.a11 * q.b1 + a.a12 * q.b2;
    y2 = a.a02 * q.b0 + a.a12 * q.b1 + a.a22 * q.b2;
    sums[SUM_NN] += (q.n0 * x0 + q.n1 * x1 + q.n2 * x2) * a.inverse;
    sums[SUM_NB] += (q.b0 * x0 + q.b1 * x1 + q.b2 * x2) * a.inverse;
    sums[SUM_BB] += (q.b0 * y0 + q.b1 * y1 + q.b2 * y2) * a.inverse;
    add_degenerate(&q, &a, sums);
}

SPH__CLONES static void sums_clones(const sph__region *u, const sph__region *v, size_t s, double coherence, double *out)
{
    const sph__v8d zero = {0}, offset = zero + (v->radius - u->radius);
    sph__v8d sums[SUMS] = {{0}};
    for (size_t i = 0; i < s; i += SPH__LANES) {
        ask_ahead(u, s, i);
        ask_ahead(v, s, i);
        if (u->next != NULL) ask_meanwhile(u->next, s, i);
        add_sums(u, v, s, i, &offset, coherence, sums);
    }
    for (size_t k = 0; k < SUMS; ++k) out[k] = sph__sum(sums[k]);
}

static void scale_sums(const sph__region *u, const sph__region *v, const double *from, size_t pitch, sph__sums *sums)
{
    const double offset = v->radius - u->radius;
    sums->w = u->w + v->w;
    sums->b = u->b + v->b + from[SUM_B * pitch] + offset * v->w;
    sums->c = u->c + v->c + from[SUM_C * pitch] + offset * (v->b + 0.5 * offset * v->w);
    sums->nn = from[SUM_NN * pitch];
    sums->nb = from[SUM_NB * pitch];
    sums->bb = from[SUM_BB * pitch];
    sums->mu = from[SUM_MU * pitch];
    sums->nu = from[SUM_NU * pitch];
    sums->b1 = from[SUM_B1 * pitch];
    sums->mu_scale = from[SUM_SCALE * pitch];
    sums->degenerate = (uint32_t)from[SUM_COUNT * pitch];
}

void sph__kernel_sums(const sph__region *u, const sph__region *v, size_t frames, size_t stride, double coherence,
                      sph__sums *sums)
{
    double out[SUMS];
    sums_clones(u, v, stride, coherence, out);
    scale_sums(u, v, out, 1, sums);
    sums->degenerate -= (uint32_t)(stride - frames); /* padding is always degenerate */
}

/* One frame of eight regions side by side. */
typedef struct lanes {
    sph__v8f rows[SPH__SINGLE_ROWS];
} lanes;

SPH__INLINE sph__region region_of(const lanes *from)
{
    return (sph__region){.block = (const float *)from->rows, .center = (const float *)(from->rows + SPH__SINGLE_CENTER)};
}

SPH__INLINE void gather(const sph__region regions[SPH__LANES], lanes *to)
{
    for (size_t k = 0; k < SPH__SINGLE_ROWS; k += SPH__LANES) {
        sph__v8f rows[SPH__LANES];
        for (size_t l = 0; l < SPH__LANES; ++l) rows[l] = *(const sph__v8f *)(regions[l].block + k);
        sph__transpose(rows, to->rows + k);
    }
}

SPH__CLONES static void pair_sums_clones(const sph__region *us, const sph__region *vs, double out[SUMS][SPH__LANES])
{
    lanes u, v;
    sph__region ru, rv;
    sph__v8d offset, sums[SUMS] = {{0}};
    gather(us, &u);
    gather(vs, &v);
    ru = region_of(&u);
    rv = region_of(&v);
    offset = sph__widen(v.rows[SPH__SINGLE_RADIUS]) - sph__widen(u.rows[SPH__SINGLE_RADIUS]);
    add_sums(&ru, &rv, SPH__LANES, 0, &offset, 0, sums);
    memcpy(out, sums, sizeof sums);
}

void sph__kernel_pair_sums(const sph__region us[SPH__LANES], const sph__region vs[SPH__LANES], size_t count,
                           sph__sums *sums)
{
    _Alignas(SPH__ALIGN) double out[SUMS][SPH__LANES];
    pair_sums_clones(us, vs, out);
    for (size_t i = 0; i < count; ++i) scale_sums(&us[i], &vs[i], out[0] + i, SPH__LANES, &sums[i]);
}

/* Eight frames of the centres; r: the radius beyond that of u. */
SPH__INLINE void make_centers(const sph__region *u, const sph__region *v, size_t s, size_t i, const sph__v8d *offset,
                              double coherence, double lambda, double r, float *center)
{
    frame_quadric q;
    frame_inverse a;
    sph__v8d x0, x1, x2;
    unite_frames(u, v, s, i, offset, &q);
    if (coherence > 0) add_coherence(u, v, s, i, coherence, &q);
    invert_frames(&q, &a);
    q.b0 -= r * q.n0;
    q.b1 -= r * q.n1;
    q.b2 -= r * q.n2;
    x0 = (a.a00 * q.b0 + a.a01 * q.b1 + a.a02 * q.b2) * a.inverse;
    x1 = (a.a01 * q.b0 + a.a11 * q.b1 + a.a12 * q.b2) * a.inverse;
    x2 = (a.a02 * q.b0 + a.a12 * q.b1 + a.a22 * q.b2) * a.inverse;
    x0 = sph__where(a.det, a.least, x0, lambda * q.d0);
    x1 = sph__where(a.det, a.least, x1, lambda * q.d1);
    x2 = sph__where(a.det, a.least, x2, lambda * q.d2);
    sph__store(center, i, x0 + sph__load(u->center, i));
    sph__store(center, s + i, x1 + sph__load(u->center, s + i));
    sph__store(center, 2 * s + i, x2 + sph__load(u->center, 2 * s + i));
}

SPH__CLONES static void centers_clones(const sph__region *u, const sph__region *v, size_t s, double coherence,
                                       double lambda, double radius, float *center)
{
    const sph__v8d zero = {0}, offset = zero + (v->radius - u->radius);
    for (size_t i = 0; i < s; i += SPH__LANES)
        make_centers(u, v, s, i, &offset, coherence, lambda, radius - u->radius, center);
}

void sph__kernel_centers(const sph__region *u, const sph__region *v, size_t stride, double coherence, double lambda,
                         double radius, float *center)
{
    centers_clones(u, v, stride, coherence, lambda, radius, center);
}

/* One region in the first of eight lanes; the others are padding. */
SPH__INLINE void pad(const sph__region *region, lanes *to)
{
    for (size_t k = 0; k < SPH__SINGLE_ROWS; ++k) to->rows[k] = (sph__v8f){region->block[k]};
}

SPH__CLONES static void single_center_clones(const sph__region *u, const sph__region *v, double lambda, double radius,
                                             float *out)
{
    const sph__v8d zero = {0}, offset = zero + (v->radius - u->radius);
    lanes lu, lv;
    sph__region ru, rv;
    sph__v8f center[3];
    pad(u, &lu);
    pad(v, &lv);
    ru = region_of(&lu);
    rv = region_of(&lv);
    make_centers(&ru, &rv, SPH__LANES, 0, &offset, 0, lambda, radius - u->radius, (float *)center);
    for (size_t k = 0; k < 3; ++k) out[k] = center[k][0];
}

void sph__kernel_single_center(const sph__region *u, const sph__region *v, double lambda, double radius, float center[3])
{
    single_center_clones(u, v, lambda, radius, center);
}

enum { UNITE_B, UNITE_C, UNITE_NQ, UNITE_Q, UNITE_SUMS };

/* Eight frames of the united quadric, and what its scalars are made of; r: the radius beyond that of u. */
SPH__INLINE void unite_eight(const sph__region *u, const sph__region *v, size_t s, size_t i, const sph__v8d *offset,
                             const float *center, double r, float *to, sph__v8d sums[UNITE_SUMS])
{
    frame_quadric q;
    sph__v8d x0, x1, x2, t0, t1, t2, nq;
    unite_frames(u, v, s, i, offset, &q);
    sums[UNITE_B] += q.sum_b;
    sums[UNITE_C] += q.sum_c;
    x0 = sph__load(center, i) - sph__load(u->center, i);
    x1 = sph__load(center, s + i) - sph__load(u->center, s + i);
    x2 = sph__load(center, 2 * s + i) - sph__load(u->center, 2 * s + i);
    t0 = q.m00 * x0 + q.m01 * x1 + q.m02 * x2;
    t1 = q.m01 * x0 + q.m11 * x1 + q.m12 * x2;
    t2 = q.m02 * x0 + q.m12 * x1 + q.m22 * x2;
    nq = q.n0 * x0 + q.n1 * x1 + q.n2 * x2;
    sums[UNITE_NQ] += nq;
    sums[UNITE_Q] += 0.5 * (t0 * x0 + t1 * x1 + t2 * x2) + r * nq - (q.b0 * x0 + q.b1 * x1 + q.b2 * x2);
    sph__store(to, SPH__M00 * SPH__LANES, q.m00);
    sph__store(to, SPH__M01 * SPH__LANES, q.m01);
    sph__store(to, SPH__M02 * SPH__LANES, q.m02);
    sph__store(to, SPH__M11 * SPH__LANES, q.m11);
    sph__store(to, SPH__M12 * SPH__LANES, q.m12);
    sph__store(to, SPH__M22 * SPH__LANES, q.m22);
    sph__store(to, SPH__N0 * SPH__LANES, q.n0);
    sph__store(to, SPH__N1 * SPH__LANES, q.n1);
    sph__store(to, SPH__N2 * SPH__LANES, q.n2);
    sph__store(to, SPH__B0 * SPH__LANES, q.b0 - t0 - r * q.n0);
    sph__store(to, SPH__B1 * SPH__LANES, q.b1 - t1 - r * q.n1);
    sph__store(to, SPH__B2 * SPH__LANES, q.b2 - t2 - r * q.n2);
}

SPH__CLONES static void unite_clones(const sph__region *u, const sph__region *v, size_t s, const float *center,
                                     double radius, float *block, double *out)
{
    const sph__v8d zero = {0}, offset = zero + (v->radius - u->radius);
    sph__v8d sums[UNITE_SUMS] = {{0}};
    for (size_t i = 0; i < s; i += SPH__LANES)
        unite_eight(u, v, s, i, &offset, center, radius - u->radius, block + i * SPH__BLOCK_ROWS, sums);
    for (size_t k = 0; k < UNITE_SUMS; ++k) out[k] = sph__sum(sums[k]);
}

static void unite_scalars(const sph__region *u, const sph__region *v, double radius, const double out[UNITE_SUMS],
                          double *w, double *b, double *c)
{
    const double offset = v->radius - u->radius, r = radius - u->radius, uw = u->w + v->w;
    const double ub = u->b + v->b + out[UNITE_B] + offset * v->w;
    const double uc = u->c + v->c + out[UNITE_C] + offset * (v->b + 0.5 * offset * v->w);
    *w = uw;
    *b = ub - out[UNITE_NQ] - r * uw;
    *c = uc + out[UNITE_Q] + r * (0.5 * r * uw - ub);
}

void sph__kernel_unite(const sph__region *u, const sph__region *v, size_t stride, const float *center, double radius,
                       float *block, double *w, double *b, double *c)
{
    double out[UNITE_SUMS];
    unite_clones(u, v, stride, center, radius, block, out);
    unite_scalars(u, v, radius, out, w, b, c);
}

SPH__CLONES static void single_unite_clones(const sph__region *u, const sph__region *v, const float *center,
                                            double radius, float *rows, double *out)
{
    const sph__v8d zero = {0}, offset = zero + (v->radius - u->radius);
    sph__v8d sums[UNITE_SUMS] = {{0}};
    sph__v8f to[SPH__BLOCK_ROWS], at[3];
    lanes lu, lv;
    sph__region ru, rv;
    pad(u, &lu);
    pad(v, &lv);
    for (size_t k = 0; k < 3; ++k) at[k] = (sph__v8f){center[k]};
    ru = region_of(&lu);
    rv = region_of(&lv);
    unite_eight(&ru, &rv, SPH__LANES, 0, &offset, (const float *)at, radius - u->radius, (float *)to, sums);
    /* Whole vectors: the costs of the new node's edges, which read it as such, need not wait for its parts. */
    *(sph__v8f *)rows = (sph__v8f){to[0][0], to[1][0], to[2][0], to[3][0], to[4][0], to[5][0], to[6][0], to[7][0]};
    *(sph__v8f *)(rows + SPH__LANES) = (sph__v8f){to[8][0], to[9][0], to[10][0], to[11][0], center[0], center[1], center[2],
                                                  (float)radius};
    for (size_t k = 0; k < UNITE_SUMS; ++k) out[k] = sums[k][0];
}

void sph__kernel_single_unite(const sph__region *u, const sph__region *v, const float center[3], double radius,
                              float rows[SPH__SINGLE_ROWS], double *w, double *b, double *c)
{
    double out[UNITE_SUMS];
    single_unite_clones(u, v, center, radius, rows, out);
    unite_scalars(u, v, radius, out, w, b, c);
}

void sph__kernel_unite_means(const float *u, const float *v, size_t stride, float *out)
{
    for (size_t i = 0; i < stride; i += SPH__LANES) {
        const sph__v8d zero = {0}, au = sph__load(u, 3 * stride + i), av = sph__load(v, 3 * stride + i), area = au + av;
        const sph__v8d share = sph__where(area, zero, av / area, area);
        for (size_t k = 0; k < 3; ++k) {
            const sph__v8d mu = sph__load(u, k * stride + i), mv = sph__load(v, k * stride + i);
            sph__store(out, k * stride + i, mu + share * (mv - mu));
        }
        sph__store(out, 3 * stride + i, area);
    }
}
