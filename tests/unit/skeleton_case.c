/* SPDX-License-Identifier: MIT */
#include "skeleton_case.h"

#include <math.h>

uint64_t seed;
uint32_t bone_count, links[3 * MOST][2];
double transforms[FRAMES][MOST][12], packed[FRAMES * MOST * 12], pivots[MOST][3], radii[MOST];
size_t link_count;

double uniform(double low, double high)
{
    return test_random_between(&seed, low, high);
}

void turn(const double axis[3], double angle, double t[12])
{
    const double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    const double u[3] = {axis[0] / length, axis[1] / length, axis[2] / length}, c = cos(angle), s = sin(angle);
    const double r[9] = {
        c + u[0] * u[0] * (1 - c),        u[0] * u[1] * (1 - c) - u[2] * s, u[0] * u[2] * (1 - c) + u[1] * s,
        u[1] * u[0] * (1 - c) + u[2] * s, c + u[1] * u[1] * (1 - c),        u[1] * u[2] * (1 - c) - u[0] * s,
        u[2] * u[0] * (1 - c) - u[1] * s, u[2] * u[1] * (1 - c) + u[0] * s, c + u[2] * u[2] * (1 - c)};
    for (int i = 0; i < 9; ++i)
        t[4 * (i / 3) + i % 3] = r[i];
    t[3] = t[7] = t[11] = 0;
}

void turn_about(const double p[3], const double axis[3], double angle, double t[12])
{
    turn(axis, angle, t);
    for (int r = 0; r < 3; ++r)
        t[4 * r + 3] = p[r] - t[4 * r] * p[0] - t[4 * r + 1] * p[1] - t[4 * r + 2] * p[2];
}

static void any_motion(double t[12])
{
    const double axis[3] = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    turn(axis, uniform(0, 3), t);
    for (int r = 0; r < 3; ++r)
        t[4 * r + 3] = uniform(-2, 2);
}

void product(const double a[12], const double b[12], double out[12])
{
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 4; ++c) {
            out[4 * r + c] = c == 3 ? a[4 * r + 3] : 0;
            for (int k = 0; k < 3; ++k)
                out[4 * r + c] += a[4 * r + k] * b[4 * k + c];
        }
}

void setup_skeleton(void)
{
    setup();
    seed = 11;
    bone_count = 2;
    link_count = 1;
    memset(transforms, 0, sizeof transforms);
    memset(radii, 0, sizeof radii);
    links[0][0] = 0;
    links[0][1] = 1;
    for (int b = 0; b < MOST; ++b)
        for (int k = 0; k < 3; ++k)
            pivots[b][k] = uniform(-1, 1);
    for (int f = 0; f < FRAMES; ++f)
        for (int b = 0; b < MOST; ++b)
            any_motion(transforms[f][b]);
}

sph_skin *make_skin_in(sph_context *own)
{
    static const uint32_t TRIANGLE[3] = {0, 1, 2};
    static const float WEIGHTS[3] = {1, 1, 1}, REST[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const uint32_t second = bone_count > 1, bones[3] = {0, second, second};
    const sph_skin_arrays arrays = {.struct_size = sizeof arrays,
                                    .vertex_count = 3,
                                    .bone_count = bone_count,
                                    .influence_count = 1,
                                    .frame_count = FRAMES,
                                    .rest = REST,
                                    .bones = bones,
                                    .weights = WEIGHTS,
                                    .transforms = packed,
                                    .pivots = pivots[0],
                                    .radii = radii,
                                    .triangle_count = 1,
                                    .triangles = TRIANGLE,
                                    .link_count = link_count,
                                    .links = links[0]};
    sph_skin *skin = NULL;
    for (uint32_t f = 0; f < FRAMES; ++f)
        memcpy(packed + 12 * (size_t)f * bone_count, transforms[f], bone_count * sizeof transforms[f][0]);
    (void)sph_skin_create_from_arrays(own, &arrays, &skin);
    return skin;
}

sph_skeleton *make_with(const sph_skeleton_options *options, sph_skeleton_arrays *a)
{
    sph_skin *skin = make_skin_in(context);
    sph_skeleton *skeleton = NULL;
    ck_assert_msg(sph_skeleton_create(skin, options, &skeleton) == SPH_OK, "%s", sph_context_last_message(context));
    sph_skin_destroy(skin);
    a->struct_size = sizeof *a;
    ck_assert_int_eq(sph_skeleton_get_arrays(skeleton, a), SPH_OK);
    return skeleton;
}

sph_skeleton *make_rooted(uint32_t root, sph_skeleton_arrays *a)
{
    sph_skeleton_options o;
    sph_skeleton_options_init(&o, sizeof o);
    o.root = SPH_ROOT_GIVEN;
    o.root_bone = root;
    return make_with(&o, a);
}

void check_point(const double *p, const double *expected, double tolerance)
{
    for (int k = 0; k < 3; ++k)
        ck_assert_msg(fabs(p[k] - expected[k]) <= tolerance, "axis %d: %.17g, not %.17g", k, p[k], expected[k]);
}

void hinge(uint32_t a, uint32_t b, const double point[3], const double *axis, double angle)
{
    for (int f = 0; f < FRAMES; ++f) {
        const double any[3] = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
        double t[12];
        turn_about(point, axis == NULL ? any : axis, uniform(-angle, angle), t);
        product(transforms[f][a], t, transforms[f][b]);
    }
}

void check_tree(const sph_skeleton_arrays *a, uint32_t roots)
{
    bool seen[MOST + 1] = {false};
    uint32_t found = 0;
    for (uint32_t i = 0; i < a->joint_count; ++i) {
        const uint32_t j = a->order[i], parent = a->parents[j];
        ck_assert_uint_lt(j, a->joint_count);
        ck_assert(!seen[j]);
        seen[j] = true;
        if (parent == SPH_NO_JOINT)
            ++found;
        else
            ck_assert(parent < a->joint_count && seen[parent]);
    }
    ck_assert_uint_eq(found, roots);
}

void use_random_links(void)
{
    bone_count = 17;
    link_count = 30;
    for (size_t i = 0; i < link_count; ++i) {
        links[i][0] = (uint32_t)(i % 17);
        links[i][1] = (uint32_t)((i * 5 + 3) % 17);
    }
}
