/* SPDX-License-Identifier: MIT */
/*
 * bake FILE FPS OUT: bakes each clip of a glTF, unwelded, for three_check.mjs. OUT gets the positions of all frames as
 * floats in the machine's order, clip after clip; stdout a JSON array of what they are.
 */
#include <stdio.h>
#include <stdlib.h>

#include <sphmesh/io.h>

typedef struct clip_counter {
    unsigned count;
} clip_counter;

static void count_clip(void *user, const sph_io_clip *clip)
{
    (void)clip;
    ++((clip_counter *)user)->count;
}

/* Writes all frames of one clip; `number` NULL: the pose at rest. */
static sph_status bake(sph_context *context, const char *path, double fps, const char *number, FILE *out)
{
    sph_io_open_options options;
    sph_animation *animation;
    float *xyz;
    sph_status status;
    sph_io_open_options_init(&options, sizeof options);
    options.fps = fps;
    options.clip = number;
    options.weld = SPH_IO_WELD_NONE;
    status = sph_io_open_animation(context, &path, 1, &options, &animation);
    if (status != SPH_OK) return status;
    xyz = calloc(3 * (size_t)sph_animation_vertex_count(animation), sizeof *xyz);
    for (uint32_t f = 0; xyz != NULL && status == SPH_OK && f < sph_animation_frame_count(animation); ++f) {
        status = sph_animation_read_frame(animation, f, xyz);
        fwrite(xyz, 3 * sizeof *xyz, sph_animation_vertex_count(animation), out);
    }
    printf("{\"vertices\": %u, \"triangles\": %zu, \"frames\": %u}", (unsigned)sph_animation_vertex_count(animation),
           sph_animation_triangle_count(animation), (unsigned)sph_animation_frame_count(animation));
    sph_animation_destroy(animation);
    free(xyz);
    return status;
}

int main(int argc, char **argv)
{
    sph_context *context;
    clip_counter clips = {0};
    FILE *out;
    sph_status status;
    if (argc != 4 || sph_context_create(NULL, &context) != SPH_OK || (out = fopen(argv[3], "wb")) == NULL) {
        fputs("usage: bake FILE FPS OUT\n", stderr);
        return EXIT_FAILURE;
    }
    status = sph_io_list_clips(context, argv[1], 0, count_clip, &clips);
    fputs("[", stdout);
    if (status == SPH_OK && clips.count == 0) status = bake(context, argv[1], atof(argv[2]), NULL, out);
    for (unsigned i = 0; i < clips.count && status == SPH_OK; ++i) {
        char number[16];
        snprintf(number, sizeof number, "%u", i);
        if (i > 0) fputs(", ", stdout);
        status = bake(context, argv[1], atof(argv[2]), number, out);
    }
    puts("]");
    if (status != SPH_OK) fprintf(stderr, "%s\n", sph_context_last_message(context));
    if (fclose(out) != 0) status = SPH_E_IO;
    sph_context_destroy(context);
    return status == SPH_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
