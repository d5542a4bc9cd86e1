/* SPDX-License-Identifier: MIT */
#include "pose_case.h"

#include <check.h>
#include <math.h>

sph_context *context;
static uint64_t state;
float rest[VERTICES][3], normals[VERTICES][3], weights[VERTICES][SLOTS];
uint32_t bones[VERTICES][SLOTS];
double transforms[POSES][BONES][12], pivots[BONES][3];
float moved[POSES][VERTICES][3], turned[POSES][VERTICES][3];
sph_skin_arrays arrays;

const double IDENTITY[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

double uniform(double low, double high)
{
    return test_random_between(&state, low, high);
}

void make_rigid(const double axis[3], double angle, const double shift[3], double out[12])
{
    const double c = cos(angle), s = sin(angle), *a = axis;
    for (int r = 0; r < 3; ++r) {
        const int n = (r + 1) % 3, m = (r + 2) % 3;
        for (int k = 0; k < 3; ++k)
            out[4 * r + k] = (1 - c) * a[r] * a[k] + c * (r == k);
        out[4 * r + n] -= s * a[m];
        out[4 * r + m] += s * a[n];
        out[4 * r + 3] = shift[r];
    }
}

void random_rigid(double angle, double out[12])
{
    double axis[3], shift[3], length = 0;
    for (int k = 0; k < 3; ++k) {
        axis[k] = uniform(-1, 1);
        shift[k] = uniform(-1, 1);
        length += axis[k] * axis[k];
    }
    for (int k = 0; k < 3; ++k)
        axis[k] /= sqrt(length);
    make_rigid(axis, angle, shift, out);
}

void setup(void)
{
    context = test_context();
    state = 5;
    for (int v = 0; v < VERTICES; ++v) {
        double sum = 0, w[SLOTS], length = 0;
        const uint32_t first = (uint32_t)(test_random(&state) % BONES);
        for (int k = 0; k < 3; ++k) {
            rest[v][k] = (float)uniform(-1, 1);
            normals[v][k] = (float)uniform(-1, 1);
            length += normals[v][k] * normals[v][k];
        }
        for (int k = 0; k < 3; ++k)
            normals[v][k] /= (float)sqrt(length);
        for (int s = 0; s < SLOTS; ++s)
            sum += w[s] = s == 3 && v % 2 == 0 ? 0 : uniform(0.1, 1) / (s + 1);
        for (int s = 0; s < SLOTS; ++s) {
            weights[v][s] = (float)(w[s] / sum);
            bones[v][s] = (first + (uint32_t)s) % BONES;
        }
    }
    for (int f = 0; f < POSES; ++f)
        for (int b = 0; b < BONES; ++b)
            random_rigid(uniform(0, 1.5), transforms[f][b]);
    for (int b = 0; b < BONES; ++b)
        for (int k = 0; k < 3; ++k)
            pivots[b][k] = uniform(-1, 1);
    arrays = (sph_skin_arrays){.struct_size = sizeof arrays,
                               .vertex_count = VERTICES,
                               .bone_count = BONES,
                               .influence_count = SLOTS,
                               .rest = rest[0],
                               .bones = bones[0],
                               .weights = weights[0],
                               .pivots = pivots[0]};
}

void teardown(void)
{
    sph_context_destroy(context);
}

sph_deformer *make(void)
{
    sph_skin *skin = NULL;
    sph_deformer *deformer = NULL;
    sph_deformer_options o;
    sph_deformer_options_init(&o, sizeof o);
    o.normals = normals[0];
    ck_assert_int_eq(sph_skin_create_from_arrays(context, &arrays, &skin), SPH_OK);
    ck_assert_int_eq(sph_deformer_create(skin, &o, &deformer), SPH_OK);
    sph_skin_destroy(skin);
    return deformer;
}

void pose(int32_t method, size_t count)
{
    sph_deformer *deformer = make();
    ck_assert_int_eq(sph_deformer_pose(deformer, transforms[0][0], count, method, moved[0][0], turned[0][0]), SPH_OK);
    sph_deformer_destroy(deformer);
}

void apply(const double t[12], const double p[3], double out[3])
{
    for (int r = 0; r < 3; ++r)
        out[r] = t[4 * r] * p[0] + t[4 * r + 1] * p[1] + t[4 * r + 2] * p[2] + t[4 * r + 3];
}

void check_point(const float *got, const double *expected, double tolerance)
{
    for (int k = 0; k < 3; ++k)
        ck_assert_double_eq_tol((double)got[k], expected[k], tolerance);
}

void turn_normal(const double m[12], const float *n, double out[3])
{
    double length = 0, determinant = 0, cofactor[9];
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) {
            const int a = (i + 1) % 3, b = (i + 2) % 3, c = (k + 1) % 3, d = (k + 2) % 3;
            cofactor[3 * i + k] = m[4 * a + c] * m[4 * b + d] - m[4 * a + d] * m[4 * b + c];
        }
    for (int k = 0; k < 3; ++k)
        determinant += m[k] * cofactor[k];
    for (int i = 0; i < 3; ++i) { /* inverse transposed, with the side that the determinant's sign says */
        out[i] = 0;
        for (int k = 0; k < 3; ++k)
            out[i] += cofactor[3 * i + k] / determinant * (double)n[k] * (determinant < 0 ? -1 : 1);
        length += out[i] * out[i];
    }
    for (int i = 0; i < 3; ++i)
        out[i] /= sqrt(length);
}
