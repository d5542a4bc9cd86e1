/* SPDX-License-Identifier: MIT */
#include "numeric/rotation.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "numeric/numeric.h"

/* One Jacobi rotation that makes a[p][q] zero. */
static void annihilate(double a[4][4], double v[4][4], int p, int q)
{
    const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
    const double t = (theta >= 0 ? 1 : -1) / (fabs(theta) + sqrt(theta * theta + 1));
    const double c = 1 / sqrt(t * t + 1), s = t * c;
    for (int k = 0; k < 4; ++k) {
        const double x = a[k][p], y = a[k][q];
        a[k][p] = c * x - s * y;
        a[k][q] = s * x + c * y;
    }
    for (int k = 0; k < 4; ++k) {
        const double x = a[p][k], y = a[q][k];
        a[p][k] = c * x - s * y;
        a[q][k] = s * x + c * y;
    }
    a[p][q] = a[q][p] = 0;
    for (int k = 0; k < 4; ++k) {
        const double x = v[p][k], y = v[q][k];
        v[p][k] = c * x - s * y;
        v[q][k] = s * x + c * y;
    }
}

void sph__sym4_eigen(const double m[16], double values[4], double vectors[16])
{
    enum { SWEEPS = 30 }; /* some six are ever needed */
    double a[4][4], v[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    double scale = 0;
    int order[4] = {0, 1, 2, 3};
    memcpy(a, m, sizeof a);
    for (int i = 0; i < 16; ++i)
        scale = fmax(scale, fabs(m[i]));
    for (int sweep = 0; sweep < SWEEPS; ++sweep) {
        bool done = true;
        for (int p = 0; p < 3; ++p)
            for (int q = p + 1; q < 4; ++q) {
                if (!(fabs(a[p][q]) > 1e-17 * scale)) continue;
                annihilate(a, v, p, q);
                done = false;
            }
        if (done) break;
    }
    for (int i = 1; i < 4; ++i)
        for (int k = i; k > 0 && a[order[k]][order[k]] > a[order[k - 1]][order[k - 1]]; --k) {
            const int swap = order[k];
            order[k] = order[k - 1];
            order[k - 1] = swap;
        }
    for (int i = 0; i < 4; ++i) {
        values[i] = a[order[i]][order[i]];
        memcpy(vectors + 4 * i, v[order[i]], sizeof v[0]);
    }
}

void sph__rotation_from_quaternion(const double q[4], double r[9])
{
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    const double s = 2 / (x * x + y * y + z * z + w * w);
    r[0] = 1 - s * (y * y + z * z);
    r[1] = s * (x * y - z * w);
    r[2] = s * (x * z + y * w);
    r[3] = s * (x * y + z * w);
    r[4] = 1 - s * (x * x + z * z);
    r[5] = s * (y * z - x * w);
    r[6] = s * (x * z - y * w);
    r[7] = s * (y * z + x * w);
    r[8] = 1 - s * (x * x + y * y);
}

/* trace(R' M) = q' S q for this symmetric S (Horn 1987). */
static void quaternion_form(const double m[9], double s[16])
{
    const double upper[10] = {m[0] - m[4] - m[8], m[1] + m[3],        m[2] + m[6], m[7] - m[5], m[4] - m[0] - m[8],
                              m[5] + m[7],        m[2] - m[6],        m[8] - m[0] - m[4],       m[3] - m[1],
                              m[0] + m[4] + m[8]};
    int at = 0;
    for (int i = 0; i < 4; ++i)
        for (int k = i; k < 4; ++k)
            s[4 * i + k] = s[4 * k + i] = upper[at++];
}

void sph__nearest_rotation(const double m[9], double rotation[9])
{
    static const double IDENTITY[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    double s[16], values[4], vectors[16];
    bool zero = true;
    for (int i = 0; i < 9; ++i)
        zero = zero && m[i] == 0;
    if (zero) {
        memcpy(rotation, IDENTITY, sizeof IDENTITY);
        return;
    }
    quaternion_form(m, s);
    sph__sym4_eigen(s, values, vectors);
    sph__rotation_from_quaternion(vectors, rotation);
}

static void multiply(const double a[9], const double b[9], double out[9])
{
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k)
            out[3 * i + k] = a[3 * i] * b[k] + a[3 * i + 1] * b[3 + k] + a[3 * i + 2] * b[6 + k];
}

/*
 * Newton's method for the turn w after which R'M is symmetric: (trace S I - S) w = axis of R'M, S its symmetric part. The
 * matrix on the left is positive definite at the maximum of the trace, and at no other rotation where R'M is symmetric.
 */
void sph__nearest_rotation_from(const double m[9], const double near[9], double rotation[9])
{
    enum { STEPS = 6 };
    double r[9], next[9];
    memcpy(r, near, sizeof r);
    for (int step = 0; step < STEPS; ++step) {
        double a[9], left[6], axis[3], turn[4] = {0, 0, 0, 1}, by[9], size = 0, trace;
        sph__sym3_factor factor;
        for (int i = 0; i < 3; ++i)
            for (int k = 0; k < 3; ++k)
                a[3 * i + k] = r[i] * m[k] + r[3 + i] * m[3 + k] + r[6 + i] * m[6 + k];
        trace = a[0] + a[4] + a[8];
        left[0] = trace - a[0];
        left[3] = trace - a[4];
        left[5] = trace - a[8];
        left[1] = -0.5 * (a[1] + a[3]);
        left[2] = -0.5 * (a[2] + a[6]);
        left[4] = -0.5 * (a[5] + a[7]);
        axis[0] = a[7] - a[5];
        axis[1] = a[2] - a[6];
        axis[2] = a[3] - a[1];
        for (int i = 0; i < 9; ++i)
            size = fmax(size, fabs(a[i]));
        if (!sph__sym3_factorize(left, &factor) || !(factor.pivot[2] > 1e-6 * size)) break;
        if (fmax(fabs(axis[0]), fmax(fabs(axis[1]), fabs(axis[2]))) <= 4e-16 * size) {
            memcpy(rotation, r, sizeof r);
            return;
        }
        sph__sym3_solve(&factor, axis, turn);
        if (!(sph__dot(turn, turn) < 1)) break; /* too far for a quadratic model */
        for (int k = 0; k < 3; ++k)
            turn[k] *= 0.5;
        sph__rotation_from_quaternion(turn, by);
        multiply(r, by, next);
        memcpy(r, next, sizeof r);
    }
    sph__nearest_rotation(m, rotation);
}

void sph__quaternion_from_rotation(const double r[9], double q[4])
{
    const double squares[4] = {1 + r[0] - r[4] - r[8], 1 - r[0] + r[4] - r[8], 1 - r[0] - r[4] + r[8],
                               1 + r[0] + r[4] + r[8]};
    int most = 3;
    double length = 0;
    for (int i = 0; i < 3; ++i)
        if (squares[i] > squares[most]) most = i;
    if (most == 3) {
        q[0] = r[7] - r[5];
        q[1] = r[2] - r[6];
        q[2] = r[3] - r[1];
    } else {
        const int a = (most + 1) % 3, b = (most + 2) % 3;
        q[a] = r[3 * a + most] + r[3 * most + a];
        q[b] = r[3 * b + most] + r[3 * most + b];
        q[3] = r[3 * b + a] - r[3 * a + b];
    }
    q[most] = squares[most];
    for (int i = 0; i < 4; ++i)
        length += q[i] * q[i];
    for (int i = 0; i < 4; ++i)
        q[i] /= sqrt(length);
}
