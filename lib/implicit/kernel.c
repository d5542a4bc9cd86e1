/* SPDX-License-Identifier: MIT */
/* Fields at many points: the loops. They allocate nothing and cannot fail; lanes do not mix. */
#include <math.h>

#include "hierarchy/lanes.h"
#include "implicit/implicit.h"

typedef float v4f __attribute__((vector_size(16), may_alias));

enum { BLOCK = SPH__IMPLICIT_BLOCK, CENTER_SIZE = 8 };

/* Squares of distances to centres are no less, so that what is divided by them stays finite. */
#define LEAST_SQUARE 1e-30

/* d += lambda r^3 + 3 r beta.x and its gradient, for eight points at (px, py, pz), scaled. */
#define ADD_CENTERS(field, px, py, pz, d, gx, gy, gz)                                                                  \
    for (size_t k_ = 0; k_ < (field)->count; ++k_) {                                                                   \
        const double *c_ = (field)->centers + CENTER_SIZE * k_;                                                        \
        const sph__v8d dx_ = (px)-c_[0], dy_ = (py)-c_[1], dz_ = (pz)-c_[2];                                           \
        const sph__v8d square_ = dx_ * dx_ + dy_ * dy_ + dz_ * dz_ + LEAST_SQUARE, length_ = sph__root(square_);       \
        const sph__v8d along_ = c_[4] * dx_ + c_[5] * dy_ + c_[6] * dz_;                                               \
        const sph__v8d r3_ = 3.0 * length_, scale_ = c_[3] * r3_ + 3.0 * along_ / length_;                             \
        d += c_[3] * (square_ * length_) + r3_ * along_;                                                               \
        gx += scale_ * dx_ + c_[4] * r3_;                                                                              \
        gy += scale_ * dy_ + c_[5] * r3_;                                                                              \
        gz += scale_ * dz_ + c_[6] * r3_;                                                                              \
    }

/* One lane: the distance (model units) and its gradient at rest become the field's value and gradient in the pose. */
#define FINISH(field, inverse, inside, i, d, gx, gy, gz, out)                                                          \
    do {                                                                                                               \
        const double u_ = (d)*per_radius, v_ = u_ > 1 ? 1 : u_ < -1 ? -1 : u_, w_ = 1 - v_ * v_;                       \
        const double slope_ = (inside) ? -0.9375 * w_ * w_ * per_radius : 0;                                           \
        (out)->f[i] = (inside) ? ((-0.1875 * v_ * v_ + 0.625) * v_ * v_ - 0.9375) * v_ + 0.5 : 0;                      \
        (out)->x[i] = slope_ * ((inverse)[0] * (gx) + (inverse)[4] * (gy) + (inverse)[8] * (gz));                      \
        (out)->y[i] = slope_ * ((inverse)[1] * (gx) + (inverse)[5] * (gy) + (inverse)[9] * (gz));                      \
        (out)->z[i] = slope_ * ((inverse)[2] * (gx) + (inverse)[6] * (gy) + (inverse)[10] * (gz));                     \
    } while (0)

#define INSIDE(field, x, y, z)                                                                                         \
    ((x) >= (field)->low[0] && (x) <= (field)->high[0] && (y) >= (field)->low[1] && (y) <= (field)->high[1] &&         \
     (z) >= (field)->low[2] && (z) <= (field)->high[2])

SPH__CLONES static void exact_clones(const sph__field *field, const double *m, size_t count, const sph__points *points,
                                     sph__values *out)
{
    const double o0 = field->origin[0], o1 = field->origin[1], o2 = field->origin[2], per = 1 / field->scale;
    const double per_radius = 1 / field->radius;
    for (size_t i = 0; i < count; i += SPH__LANES) {
        const sph__v8d x = *(const sph__v8d *)(points->x + i), y = *(const sph__v8d *)(points->y + i);
        const sph__v8d z = *(const sph__v8d *)(points->z + i);
        const sph__v8d rx = m[0] * x + m[1] * y + m[2] * z + m[3], ry = m[4] * x + m[5] * y + m[6] * z + m[7];
        const sph__v8d rz = m[8] * x + m[9] * y + m[10] * z + m[11];
        const sph__v8d px = (rx - o0) * per, py = (ry - o1) * per, pz = (rz - o2) * per;
        sph__v8d d = {0}, gx = {0}, gy = {0}, gz = {0};
        ADD_CENTERS(field, px, py, pz, d, gx, gy, gz)
        for (size_t l = 0; l < SPH__LANES; ++l) {
            const bool inside = INSIDE(field, rx[l], ry[l], rz[l]);
            FINISH(field, m, inside, i + l, d[l] * field->scale, gx[l], gy[l], gz[l], out);
        }
    }
}

void sph__field_exact(const sph__field *field, const sph__placed *placed, size_t count, const sph__points *points,
                      sph__values *out)
{
    exact_clones(field, placed->inverse, count, points, out);
}

#define MIX(a, b, t) ((a) + ((b) - (a)) * (t))

/* The node below a coordinate in cells, and how far beyond it. */
SPH__INLINE size_t split(double u, uint32_t size, float *rest)
{
    const double most = size - 1 - 1e-6, v = u < 0 ? 0 : u > most ? most : u; /* a NaN becomes `most` */
    const size_t at = (size_t)(v >= 0 ? v : 0);
    *rest = (float)(v - (double)at);
    return at;
}

SPH__CLONES static void table_clones(const sph__field *field, const double *m, size_t count, const sph__points *points,
                                     sph__values *out)
{
    const size_t row = field->table_size, slice = row * row;
    const double per_radius = 1 / field->radius;
    for (size_t i = 0; i < count; ++i) {
        const double x = points->x[i], y = points->y[i], z = points->z[i];
        const double rx = m[0] * x + m[1] * y + m[2] * z + m[3], ry = m[4] * x + m[5] * y + m[6] * z + m[7];
        const double rz = m[8] * x + m[9] * y + m[10] * z + m[11];
        if (!INSIDE(field, rx, ry, rz)) {
            out->f[i] = out->x[i] = out->y[i] = out->z[i] = 0;
            continue;
        }
        {
            float a, b, c;
            const size_t ix = split((rx - field->low[0]) * field->cell[0], field->table_size, &a);
            const size_t iy = split((ry - field->low[1]) * field->cell[1], field->table_size, &b);
            const size_t iz = split((rz - field->low[2]) * field->cell[2], field->table_size, &c);
            const v4f *t = (const v4f *)field->table + iz * slice + iy * row + ix;
            const v4f low = MIX(MIX(t[0], t[1], a), MIX(t[row], t[row + 1], a), b);
            const v4f high = MIX(MIX(t[slice], t[slice + 1], a), MIX(t[slice + row], t[slice + row + 1], a), b);
            const v4f v = MIX(low, high, c);
            FINISH(field, m, true, i, (double)v[0] * field->scale, (double)v[1], (double)v[2], (double)v[3], out);
        }
    }
}

void sph__field_table(const sph__field *field, const sph__placed *placed, size_t count, const sph__points *points,
                      sph__values *out)
{
    table_clones(field, placed->inverse, count, points, out);
}

SPH__CLONES static void field_distances_clones(const sph__field *field, const double points[3][8], double out[4][8])
{
    const double per = 1 / field->scale;
    const sph__v8d px = (*(const sph__v8d *)points[0] - field->origin[0]) * per;
    const sph__v8d py = (*(const sph__v8d *)points[1] - field->origin[1]) * per;
    const sph__v8d pz = (*(const sph__v8d *)points[2] - field->origin[2]) * per;
    sph__v8d d = {0}, gx = {0}, gy = {0}, gz = {0};
    ADD_CENTERS(field, px, py, pz, d, gx, gy, gz)
    *(sph__v8d *)out[0] = d * field->scale;
    *(sph__v8d *)out[1] = gx;
    *(sph__v8d *)out[2] = gy;
    *(sph__v8d *)out[3] = gz;
}

void sph__field_distances(const sph__field *field, const sph__eight *points, sph__eight *out)
{
    field_distances_clones(field, (const double(*)[8])points->rows, out->rows);
}

void sph__field_distance(const sph__field *field, const double point[3], double *distance, double gradient[3])
{
    sph__eight p, v;
    for (int i = 0; i < 32; ++i)
        p.rows[i / 8][i % 8] = i < 24 ? point[i / 8] : 0;
    sph__field_distances(field, &p, &v);
    *distance = v.rows[0][0];
    for (int c = 0; c < 3; ++c)
        gradient[c] = v.rows[1 + c][0];
}
