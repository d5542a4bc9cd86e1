/* SPDX-License-Identifier: MIT */
/* From an animation to what an engine takes: a rig that plays it (bones, weights, a clip), and the capsules to collide
   with, which contain the mesh in every frame. */
#include <stdio.h>

#include <sphmesh/io.h>

enum { BONES = 20, CAPSULES = 40 };

static bool save_rig(sph_context *context, const sph_hierarchy *hierarchy, const sph_animation *animation,
                     const char *path)
{
    const sph_skin_source walk = {animation, "walk", 24};
    sph_skin_options options;
    sph_skin_error error;
    sph_level *level = NULL;
    sph_skin *skin = NULL;
    sph_skeleton *skeleton = NULL;
    sph_skin_options_init(&options, sizeof options);
    options.mode = SPH_SKIN_ANIMATION; /* play it back as exactly as can be; the default is made for editing */
    const bool done = sph_level_create(hierarchy, BONES, &level) == SPH_OK &&
                      sph_skin_create(level, &walk, 1, &options, &skin) == SPH_OK &&
                      sph_skin_get_errors(skin, &error, NULL) == SPH_OK &&
                      sph_skeleton_create(skin, NULL, &skeleton) == SPH_OK &&
                      sph_io_save_rig(context, skin, skeleton, NULL, path) == SPH_OK;
    if (done)
        printf("%s: %u bones; off by %.3f %% of the size on average, by %.3f %% at most (frame %u)\n", path,
               sph_skin_bone_count(skin), error.rmse_percent, error.max_percent, error.max_frame);
    sph_skeleton_destroy(skeleton), sph_skin_destroy(skin), sph_level_destroy(level);
    return done;
}

static bool save_capsules(sph_context *context, const sph_hierarchy *hierarchy, const sph_animation *animation,
                          const char *path)
{
    sph_level *level = NULL, *safe = NULL;
    sph_coverage before = {.struct_size = sizeof before}, after = {.struct_size = sizeof after};
    sph_io_export_options options;
    sph_io_export_report report = {.struct_size = sizeof report};
    sph_io_export_options_init(&options, sizeof options);
    options.coverage = &after; /* the file says that it contains the mesh */
    const bool done = sph_level_create(hierarchy, CAPSULES, &level) == SPH_OK &&
                      sph_coverage_measure(animation, level, &before) == SPH_OK &&
                      sph_coverage_inflate(animation, level, NULL, NULL, &safe) == SPH_OK &&
                      sph_coverage_measure(animation, safe, &after) == SPH_OK &&
                      sph_io_export_level(context, safe, path, &options, &report) == SPH_OK;
    if (done)
        printf("%s: %llu capsules and %llu thick triangles; vertices stuck out by %g, now by %g\n", path,
               (unsigned long long)report.capsule_count, (unsigned long long)report.triangle_count, before.distance,
               after.distance);
    sph_level_destroy(safe), sph_level_destroy(level);
    return done;
}

int main(int argc, char **argv)
{
    sph_context *context = NULL;
    sph_animation *animation = NULL;
    sph_hierarchy *hierarchy = NULL;
    sph_io_open_options options;
    if (argc != 5) return fprintf(stderr, "usage: rig_export MESH CACHE RIG.glb CAPSULES.json\n"), 2;
    sph_io_open_options_init(&options, sizeof options);
    options.cache_path = argv[2];
    const bool done =
        sph_context_create(NULL, &context) == SPH_OK &&
        sph_io_open_animation(context, (const char *const *)&argv[1], 1, &options, &animation) == SPH_OK &&
        sph_hierarchy_create(animation, NULL, &hierarchy) == SPH_OK &&
        save_rig(context, hierarchy, animation, argv[3]) && save_capsules(context, hierarchy, animation, argv[4]);
    if (!done) fprintf(stderr, "rig_export: %s\n", sph_context_last_message(context));
    sph_hierarchy_destroy(hierarchy), sph_animation_destroy(animation), sph_context_destroy(context);
    return done ? 0 : 1;
}
