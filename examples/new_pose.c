/* SPDX-License-Identifier: MIT */
/*
 * A pose that no frame has, by moving a few spheres (Thiery et al. 2016, section 6.2): the walking creature of
 * `sphmesh demo` turns its head and lifts a foreleg. Writes the mesh, and the spheres.
 */
#include <math.h>
#include <stdio.h>

#include <sphmesh/io.h>

enum { SPHERES = 40 };

/* What an artist does by hand: the spheres within a box, in the rest pose, are turned about an axis through a point. */
typedef struct edit {
    double low[3], high[3], point[3], axis[3], degrees;
} edit;

static const edit EDITS[] = {
    {{0.68, 1.38, -9}, {9, 9, 9}, {0.75, 1.35, -0.05}, {0, 1, 0}, -38},       /* the head to its right ... */
    {{0.68, 1.38, -9}, {9, 9, 9}, {0.75, 1.35, -0.05}, {-0.62, 0, 0.79}, 12}, /* ... and up */
    {{0.6, -9, -9}, {9, 0.5, 0}, {0.54, 0.58, -0.2}, {0, 0, 1}, 62},          /* a foreleg, at its shoulder ... */
    {{0.77, -9, -9}, {9, 0.3, 0}, {0.82, 0.66, -0.2}, {0, 0, 1}, -75},        /* ... and at its knee */
};

static void turn(const edit *e, double c[3])
{
    const double s = sin(e->degrees * M_PI / 180), k = cos(e->degrees * M_PI / 180), *a = e->axis;
    const double p[3] = {c[0] - e->point[0], c[1] - e->point[1], c[2] - e->point[2]};
    const double along = (1 - k) * (a[0] * p[0] + a[1] * p[1] + a[2] * p[2]);
    for (int i = 0; i < 3; ++i)
        c[i] = e->point[i] + k * p[i] + along * a[i] +
               s * (a[(i + 1) % 3] * p[(i + 2) % 3] - a[(i + 2) % 3] * p[(i + 1) % 3]);
}

static void move_spheres(const sph_skin_arrays *skin, double centers[SPHERES][3])
{
    for (uint32_t b = 0; b < skin->bone_count; ++b) {
        const double *c = skin->pivots + 3 * b;
        for (int i = 0; i < 3; ++i)
            centers[b][i] = c[i];
        for (size_t e = 0; e < sizeof EDITS / sizeof *EDITS; ++e) {
            bool inside = true;
            for (int i = 0; i < 3; ++i)
                inside = inside && c[i] >= EDITS[e].low[i] && c[i] <= EDITS[e].high[i];
            if (inside) turn(&EDITS[e], centers[b]);
        }
    }
}

/* The level in the new pose: its spheres where they were put, everything else as it was. */
static sph_status save_spheres(sph_context *context, const sph_level *level, double centers[SPHERES][3],
                               const char *path)
{
    sph_level_arrays a = {.struct_size = sizeof a};
    float moved[SPHERES][3];
    sph_level *posed = NULL;
    sph_status status = sph_level_get_arrays(level, &a);
    for (int i = 0; i < 3 * SPHERES; ++i)
        moved[i / 3][i % 3] = (float)centers[i / 3][i % 3];
    a.centers = moved[0];
    a.frame_count = 1;
    if (status == SPH_OK) status = sph_level_create_from_arrays(context, &a, &posed);
    if (status == SPH_OK) status = sph_io_save_level(context, posed, path);
    sph_level_destroy(posed);
    return status;
}

static sph_status pose(sph_context *context, const sph_level *level, const sph_skin *skin, char **names)
{
    sph_skin_arrays a = {.struct_size = sizeof a};
    double centers[SPHERES][3], transforms[SPHERES][12];
    sph_deformer *deformer = NULL;
    sph_status status = sph_skin_get_arrays(skin, &a);
    float *xyz = sph_context_allocate(context, sph_skin_vertex_count(skin), 6 * sizeof *xyz);
    if (xyz == NULL) status = SPH_E_NOMEM;
    if (status == SPH_OK) move_spheres(&a, centers);
    if (status == SPH_OK) status = sph_pose_from_spheres(skin, NULL, centers[0], transforms[0]);
    if (status == SPH_OK) status = sph_deformer_create(skin, NULL, &deformer);
    if (status == SPH_OK) /* positions, then normals */
        status = sph_deformer_pose(deformer, transforms[0], 1, SPH_POSE_DUAL_QUATERNION, xyz,
                                   xyz + 3 * (size_t)a.vertex_count);
    if (status == SPH_OK)
        status = sph_io_save_mesh(context, a.vertex_count, xyz, xyz + 3 * (size_t)a.vertex_count, a.triangle_count,
                                  a.triangles, names[0]);
    if (status == SPH_OK) status = save_spheres(context, level, centers, names[1]);
    sph_deformer_destroy(deformer);
    sph_context_release(context, xyz);
    return status;
}

int main(int argc, char **argv)
{
    sph_context *context = NULL;
    sph_skin_source source = {NULL, "walk", 24};
    sph_animation *walk = NULL;
    sph_hierarchy *hierarchy = NULL;
    sph_level *level = NULL;
    sph_skin *skin = NULL;
    sph_io_open_options options;
    sph_io_open_options_init(&options, sizeof options);
    if (argc != 5) return fprintf(stderr, "usage: new_pose MESH.obj CACHE.pc2 OUT.obj OUT.json\n"), 2;
    if (sph_context_create(NULL, &context) != SPH_OK) return 1;
    options.cache_path = argv[2];
    sph_status status = sph_io_open_animation(context, (const char *const *)&argv[1], 1, &options, &walk);
    source.animation = walk;
    if (status == SPH_OK) status = sph_hierarchy_create(walk, NULL, &hierarchy);
    if (status == SPH_OK) status = sph_level_create(hierarchy, SPHERES, &level);
    if (status == SPH_OK) status = sph_skin_create(level, &source, 1, NULL, &skin);
    if (status == SPH_OK) status = pose(context, level, skin, argv + 3);
    if (status != SPH_OK) fprintf(stderr, "new_pose: %s\n", sph_context_last_message(context));
    sph_skin_destroy(skin), sph_level_destroy(level), sph_hierarchy_destroy(hierarchy), sph_animation_destroy(walk);
    sph_context_destroy(context);
    return status == SPH_OK ? 0 : 1;
}
