/* SPDX-License-Identifier: MIT */
#include "numeric/numeric.h"

#include <math.h>
#include <string.h>

static double largest_of(const double *values, int count)
{
    double largest = 0.0;
    for (int i = 0; i < count; ++i)
        if (fabs(values[i]) > largest || isnan(values[i])) largest = fabs(values[i]);
    return largest;
}

double sph__length(const double a[3])
{
    const double largest = largest_of(a, 3);
    double scaled[3];
    if (largest == 0.0 || !isfinite(largest)) return largest;
    for (int i = 0; i < 3; ++i)
        scaled[i] = a[i] / largest;
    return largest * sqrt(sph__dot(scaled, scaled));
}

bool sph__normalize(double a[3])
{
    const double largest = largest_of(a, 3);
    double scaled[3], length;
    if (!(largest > 0.0) || !sph__is_finite3(a)) return false;
    for (int i = 0; i < 3; ++i)
        scaled[i] = a[i] / largest;
    length = sqrt(sph__dot(scaled, scaled));
    for (int i = 0; i < 3; ++i)
        a[i] = scaled[i] / length;
    return true;
}

bool sph__is_finite3(const double a[3])
{
    return isfinite(a[0]) && isfinite(a[1]) && isfinite(a[2]);
}

double sph__sym3_determinant(const double m[6])
{
    return m[0] * (m[3] * m[5] - m[4] * m[4]) - m[1] * (m[1] * m[5] - m[4] * m[2]) + m[2] * (m[1] * m[4] - m[3] * m[2]);
}

void sph__sym3_adjugate(const double m[6], double adjugate[6])
{
    const double result[6] = {m[3] * m[5] - m[4] * m[4], m[2] * m[4] - m[1] * m[5], m[1] * m[4] - m[2] * m[3],
                              m[0] * m[5] - m[2] * m[2], m[1] * m[2] - m[0] * m[4], m[0] * m[3] - m[1] * m[1]};
    memcpy(adjugate, result, sizeof result);
}

static int place_of(int row, int column)
{
    static const int places[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    return places[row][column];
}

static void exchange(int *a, int *b)
{
    const int t = *a;
    *a = *b;
    *b = t;
}

bool sph__sym3_factorize(const double m[6], sph__sym3_factor *out)
{
    int o[3] = {0, 1, 2};
    double l10, l20, l21, m11, m12, m22;
    if (m[3] > m[0]) exchange(&o[0], &o[1]);
    if (m[5] > m[place_of(o[0], o[0])]) exchange(&o[0], &o[2]);
    out->pivot[0] = m[place_of(o[0], o[0])];
    if (!(out->pivot[0] > 0.0)) return false;
    l10 = m[place_of(o[1], o[0])] / out->pivot[0];
    l20 = m[place_of(o[2], o[0])] / out->pivot[0];
    m11 = m[place_of(o[1], o[1])] - l10 * m[place_of(o[1], o[0])];
    m22 = m[place_of(o[2], o[2])] - l20 * m[place_of(o[2], o[0])];
    m12 = m[place_of(o[1], o[2])] - l10 * m[place_of(o[2], o[0])];
    if (m22 > m11) {
        const double t = m11, tl = l10;
        m11 = m22;
        m22 = t;
        l10 = l20;
        l20 = tl;
        exchange(&o[1], &o[2]);
    }
    out->pivot[1] = m11;
    if (!(m11 > 0.0)) return false;
    l21 = m12 / m11;
    out->pivot[2] = m22 - l21 * m12;
    out->lower[0] = l10;
    out->lower[1] = l20;
    out->lower[2] = l21;
    memcpy(out->order, o, sizeof o);
    return out->pivot[2] > 0.0;
}

void sph__sym3_solve(const sph__sym3_factor *factor, const double b[3], double x[3])
{
    const int *o = factor->order;
    const double *l = factor->lower, *d = factor->pivot;
    const double y0 = b[o[0]], y1 = b[o[1]] - l[0] * y0, y2 = b[o[2]] - l[1] * y0 - l[2] * y1;
    const double x2 = y2 / d[2], x1 = y1 / d[1] - l[2] * x2, x0 = y0 / d[0] - l[0] * x1 - l[1] * x2;
    x[o[0]] = x0;
    x[o[1]] = x1;
    x[o[2]] = x2;
}

/* One Jacobi rotation that makes a[p][q] zero. */
static void rotate(double a[3][3], double vectors[3][3], int p, int q)
{
    const double theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    const double t = copysign(1.0, theta) / (fabs(theta) + hypot(1.0, theta));
    const double c = 1.0 / sqrt(1.0 + t * t), s = t * c;
    const int r = 3 - p - q;
    const double arp = a[r][p], arq = a[r][q];
    a[p][p] -= t * a[p][q];
    a[q][q] += t * a[p][q];
    a[p][q] = a[q][p] = 0.0;
    a[r][p] = a[p][r] = c * arp - s * arq;
    a[r][q] = a[q][r] = s * arp + c * arq;
    for (int i = 0; i < 3; ++i) {
        const double vp = vectors[p][i], vq = vectors[q][i];
        vectors[p][i] = c * vp - s * vq;
        vectors[q][i] = s * vp + c * vq;
    }
}

static void sort_eigen(double values[3], double vectors[3][3])
{
    for (int pass = 0; pass < 2; ++pass)
        for (int i = 0; i < 2 - pass; ++i)
            if (values[i + 1] < values[i]) {
                const double t = values[i];
                double row[3];
                values[i] = values[i + 1];
                values[i + 1] = t;
                memcpy(row, vectors[i], sizeof row);
                memcpy(vectors[i], vectors[i + 1], sizeof row);
                memcpy(vectors[i + 1], row, sizeof row);
            }
}

void sph__sym3_eigen(const double m[6], double values[3], double vectors[3][3])
{
    enum { SWEEPS = 24 }; /* convergence is quadratic: 5 or 6 do */
    const double largest = largest_of(m, 6);
    const double scale = largest > 0.0 && isfinite(largest) ? largest : 1.0;
    double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, a[3][3];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            a[i][j] = m[place_of(i, j)] / scale;
    for (int sweep = 0; sweep < SWEEPS && (a[0][1] != 0.0 || a[0][2] != 0.0 || a[1][2] != 0.0); ++sweep)
        for (int p = 0; p < 2; ++p)
            for (int q = p + 1; q < 3; ++q) {
                /* Beneath the last bit of both diagonal entries a rotation would change nothing. */
                if (fabs(a[p][q]) < 1e-18 * fmin(fabs(a[p][p]), fabs(a[q][q])) || fabs(a[p][q]) < 1e-150)
                    a[p][q] = a[q][p] = 0.0;
                else
                    rotate(a, v, p, q);
            }
    for (int i = 0; i < 3; ++i)
        values[i] = a[i][i] * scale;
    sort_eigen(values, v);
    sph__cross(v[0], v[1], v[2]);
    if (vectors != NULL) memcpy(vectors, v, sizeof v);
}
