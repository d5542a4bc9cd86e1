/* SPDX-License-Identifier: MIT */
/* A pose that no frame has, by moving a few spheres (Thiery et al. 2016, section 6.2): the walking creature of
   `sphmesh demo` turns its head and lifts a foreleg. Writes the mesh, and the spheres. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <sphmesh/io.h>

enum { SPHERES = 40 };
static const double DEGREE = 3.14159265358979323846 / 180;

/* What an artist does by hand: spheres beyond x, below z, with y between these, turn about an axis through a point. */
static const struct edit {
    double x, low, high, z, point[3], axis[3], degrees;
} EDITS[] = {
    {0.68, 1.38, 9, 9, {0.75, 1.35, -0.05}, {0, 1, 0}, -38},       /* the head to its right ... */
    {0.68, 1.38, 9, 9, {0.75, 1.35, -0.05}, {-0.62, 0, 0.79}, 12}, /* ... and up */
    {0.6, -9, 0.5, 0, {0.54, 0.58, -0.2}, {0, 0, 1}, 62},          /* a foreleg, at its shoulder ... */
    {0.77, -9, 0.3, 0, {0.82, 0.66, -0.2}, {0, 0, 1}, -75},        /* ... and at its knee */
};

static void turn(const struct edit *e, double c[3])
{
    const double s = sin(e->degrees * DEGREE), k = cos(e->degrees * DEGREE), *a = e->axis;
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
        memcpy(centers[b], c, sizeof centers[b]);
        for (const struct edit *e = EDITS; e < EDITS + sizeof EDITS / sizeof *EDITS; ++e)
            if (c[0] >= e->x && c[1] >= e->low && c[1] <= e->high && c[2] <= e->z) turn(e, centers[b]);
    }
}

/* The level in the new pose: its spheres where they were put, everything else as it was. */
static bool save_spheres(sph_context *context, const sph_level *level, const double *centers, const char *path)
{
    sph_level_arrays a = {.struct_size = sizeof a};
    float moved[3 * SPHERES];
    sph_level *posed = NULL;
    for (int i = 0; i < 3 * SPHERES; ++i)
        moved[i] = (float)centers[i];
    bool done = sph_level_get_arrays(level, &a) == SPH_OK;
    a.centers = moved, a.frame_count = 1;
    done = done && sph_level_create_from_arrays(context, &a, &posed) == SPH_OK &&
           sph_io_save_level(context, posed, path) == SPH_OK;
    sph_level_destroy(posed);
    return done;
}

static bool pose(sph_context *context, const sph_level *level, const sph_skin *skin, char **names)
{
    sph_skin_arrays a = {.struct_size = sizeof a};
    double centers[SPHERES][3], transforms[SPHERES][12];
    sph_deformer *deformer = NULL;
    const uint32_t n = sph_skin_vertex_count(skin);
    float *xyz = sph_context_allocate(context, n, 6 * sizeof *xyz); /* positions, then normals */
    bool done = xyz != NULL && sph_skin_get_arrays(skin, &a) == SPH_OK;
    if (done) move_spheres(&a, centers);
    done =
        done && sph_pose_from_spheres(skin, NULL, centers[0], transforms[0]) == SPH_OK &&
        sph_deformer_create(skin, NULL, &deformer) == SPH_OK &&
        sph_deformer_pose(deformer, transforms[0], 1, SPH_POSE_DUAL_QUATERNION, xyz, xyz + 3 * (size_t)n) == SPH_OK &&
        sph_io_save_mesh(context, n, xyz, xyz + 3 * (size_t)n, a.triangle_count, a.triangles, names[0]) == SPH_OK &&
        save_spheres(context, level, centers[0], names[1]);
    sph_deformer_destroy(deformer), sph_context_release(context, xyz);
    return done;
}

int main(int argc, char **argv)
{
    sph_context *context = NULL;
    sph_animation *walk = NULL;
    sph_hierarchy *hierarchy = NULL;
    sph_level *level = NULL;
    sph_skin *skin = NULL;
    sph_io_open_options o;
    sph_io_open_options_init(&o, sizeof o);
    if (argc != 5) return fprintf(stderr, "usage: new_pose MESH.obj CACHE.pc2 OUT.obj OUT.json\n"), 2;
    o.cache_path = argv[2];
    bool done = sph_context_create(NULL, &context) == SPH_OK &&
                sph_io_open_animation(context, (const char *const *)&argv[1], 1, &o, &walk) == SPH_OK &&
                sph_hierarchy_create(walk, NULL, &hierarchy) == SPH_OK &&
                sph_level_create(hierarchy, SPHERES, &level) == SPH_OK &&
                sph_skin_create(level, &(sph_skin_source){walk, "walk", 24}, 1, NULL, &skin) == SPH_OK &&
                pose(context, level, skin, argv + 3);
    if (!done) fprintf(stderr, "new_pose: %s\n", sph_context_last_message(context));
    sph_skin_destroy(skin), sph_level_destroy(level), sph_hierarchy_destroy(hierarchy), sph_animation_destroy(walk);
    sph_context_destroy(context);
    return done ? 0 : 1;
}
