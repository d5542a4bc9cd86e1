/* SPDX-License-Identifier: MIT */
/* A rig posed over and over, as a game or a viewer does it, corrected by implicit skinning: prints frames per second.
 */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include <sphmesh/io.h>
#include <sphmesh/io_rig.h>

static double seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Plays the clips of the rig for `limit` seconds; `positions` are what would be drawn. */
static sph_status play(const sph_skin_arrays *skin, sph_tracker *tracker, double limit, float *positions)
{
    const double start = seconds();
    unsigned frames = 0;
    uint64_t contacts = 0;
    double now = 0;
    do {
        const size_t frame = frames % skin->frame_count;
        sph_tracker_report report;
        const sph_status status =
            sph_tracker_pose(tracker, skin->transforms + 12 * skin->bone_count * frame, 1, positions, NULL, &report);
        if (status != SPH_OK) return status;
        contacts += report.contacts;
        ++frames;
        now = seconds() - start;
    } while (now < limit);
    printf("%u vertices, %u bones: %.1f frames per second, %.1f vertices in contact per frame\n",
           (unsigned)skin->vertex_count, (unsigned)skin->bone_count, frames / now, (double)contacts / frames);
    return SPH_OK;
}

static sph_status run(sph_context *context, const char *path, double limit)
{
    sph_io_rig *rig = NULL;
    sph_io_rig_arrays parts = {.struct_size = sizeof parts};
    sph_skin_arrays skin = {.struct_size = sizeof skin};
    sph_implicit_options options;
    sph_implicit *implicit = NULL;
    sph_tracker *tracker = NULL;
    float *positions = NULL;
    sph_status status = sph_io_open_rig(context, path, NULL, &rig);
    sph_implicit_options_init(&options, sizeof options);
    if (status == SPH_OK) status = sph_io_rig_get_arrays(rig, &parts);
    if (status == SPH_OK) status = sph_skin_get_arrays(sph_io_rig_skin(rig), &skin);
    options.parents = parts.parents;
    if (status == SPH_OK) status = sph_implicit_create(sph_io_rig_skin(rig), &options, &implicit);
    if (status == SPH_OK) status = sph_tracker_create(implicit, sph_io_rig_skin(rig), NULL, &tracker);
    if (status == SPH_OK) positions = malloc(skin.vertex_count * 3 * sizeof *positions);
    if (positions != NULL) status = play(&skin, tracker, limit, positions);
    free(positions);
    sph_tracker_destroy(tracker);
    sph_implicit_destroy(implicit);
    sph_io_rig_destroy(rig);
    return status;
}

int main(int argc, char **argv)
{
    sph_context *context = NULL;
    sph_status status;
    if (argc < 2) {
        fprintf(stderr, "usage: pose_loop RIG.glb [SECONDS]\n");
        return 2;
    }
    status = sph_context_create(NULL, &context);
    if (status == SPH_OK) status = run(context, argv[1], argc > 2 ? atof(argv[2]) : 2);
    if (status != SPH_OK) fprintf(stderr, "pose_loop: %s\n", sph_context_last_message(context));
    sph_context_destroy(context);
    return status == SPH_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
