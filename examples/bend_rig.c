/* SPDX-License-Identifier: MIT */
/* Implicit skinning of any rigged glTF: a bone is turned at its joint, and what hangs on it comes along, first by dual
   quaternions alone and then corrected, so that skin comes into contact where it would pass through itself. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <sphmesh/io.h>

/* Rest pose to pose: bones that hang on `bone`, itself included, turn about its pivot; all others stay. */
static void turn(const sph_skin_arrays *a, const uint32_t *parents, uint32_t bone, double degrees, double *transforms)
{
    const double s = sin(degrees * 3.14159265358979323846 / 180), c = sqrt(1 - s * s) * (fabs(degrees) > 90 ? -1 : 1);
    const double *p = a->pivots + 3 * bone, rows[3][3] = {{c, -s, 0}, {s, c, 0}, {0, 0, 1}}; /* about z */
    for (uint32_t j = 0; j < a->bone_count; ++j) {
        uint32_t up = j;
        while (up != bone && up != SPH_NO_JOINT)
            up = parents[up];
        for (int row = 0; row < 3; ++row) {
            double *t = transforms + 12 * (size_t)j + 4 * row;
            for (int k = 0; k < 3; ++k)
                t[k] = up == bone ? rows[row][k] : row == k;
            t[3] = up == bone ? p[row] - rows[row][0] * p[0] - rows[row][1] * p[1] - rows[row][2] * p[2] : 0;
        }
    }
}

static bool pose(sph_context *context, const sph_io_rig *rig, uint32_t bone, double degrees, const char *path)
{
    const sph_skin *skin = sph_io_rig_skin(rig);
    sph_skin_arrays a = {.struct_size = sizeof a};
    sph_io_rig_arrays joints = {.struct_size = sizeof joints};
    sph_implicit_options options;
    sph_tracker_report report;
    sph_implicit *implicit = NULL;
    sph_tracker *tracker = NULL;
    const size_t n = sph_skin_vertex_count(skin);
    double *transforms = sph_context_allocate(context, sph_skin_bone_count(skin), 12 * sizeof *transforms);
    float *xyz = sph_context_allocate(context, n, 6 * sizeof *xyz); /* positions, then normals */
    bool done = transforms != NULL && xyz != NULL && sph_skin_get_arrays(skin, &a) == SPH_OK &&
                sph_io_rig_get_arrays(rig, &joints) == SPH_OK;
    if (done && bone >= a.bone_count) {
        sph_context_fail(context, SPH_E_INVALID, "the rig has no such bone");
        done = false;
    }
    if (done) turn(&a, joints.parents, bone, degrees, transforms);
    sph_implicit_options_init(&options, sizeof options);
    options.parents = joints.parents;
    options.operation = SPH_OPERATION_BLEND; /* of joints; SPH_OPERATION_BULGE for fingers, say */
    done = done && sph_implicit_create(skin, &options, &implicit) == SPH_OK &&
           sph_tracker_create(implicit, skin, NULL, &tracker) == SPH_OK &&
           sph_tracker_pose(tracker, transforms, 1, xyz, xyz + 3 * n, &report) == SPH_OK &&
           sph_io_save_mesh(context, a.vertex_count, xyz, xyz + 3 * n, a.triangle_count, a.triangles, path) == SPH_OK;
    if (done)
        printf(
            "%s of %u turned by %g degrees: %u vertices corrected, by up to %.4f; %llu pairs of triangles intersected, "
            "%llu do\n",
            joints.names[bone], a.bone_count, degrees, report.moved, report.farthest,
            (unsigned long long)report.pairs_before, (unsigned long long)report.pairs_after);
    sph_tracker_destroy(tracker), sph_implicit_destroy(implicit);
    sph_context_release(context, xyz), sph_context_release(context, transforms);
    return done;
}

int main(int argc, char **argv)
{
    sph_context *context = NULL;
    sph_io_rig *rig = NULL;
    if (argc != 5) return fprintf(stderr, "usage: bend_rig RIG.glb BONE DEGREES OUT.obj\n"), 2;
    const bool done = sph_context_create(NULL, &context) == SPH_OK &&
                      sph_io_open_rig(context, argv[1], NULL, &rig) == SPH_OK &&
                      pose(context, rig, (uint32_t)strtoul(argv[2], NULL, 10), strtod(argv[3], NULL), argv[4]);
    if (!done) fprintf(stderr, "bend_rig: %s\n", sph_context_last_message(context));
    sph_io_rig_destroy(rig), sph_context_destroy(context);
    return done ? 0 : 1;
}
