/* SPDX-License-Identifier: MIT */
/*
 * rigs FOLDER NAME SPHERES INPUT [CACHE]: rigs an animation in three ways and writes for each a glTF into FOLDER, what
 * the library makes of every vertex in every frame (floats in the machine's order, frame by frame), and a line of JSON
 * to stdout that tells what there is.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <sphmesh/io.h>

enum { FPS = 24, PATH_SIZE = 4096 };

typedef struct variant {
    const char *name, *ending;
    int32_t mode, layout, weights;
    uint32_t influences, single_root;
} variant;

static const variant VARIANTS[] = {
    {"tree", "glb", SPH_SKIN_MIXED, SPH_SKELETON_TREE, SPH_IO_WEIGHTS_FLOAT, 4, 0},
    {"list", "glb", SPH_SKIN_ANIMATION, SPH_SKELETON_FLAT, SPH_IO_WEIGHTS_U8, 4, 0},
    {"root", "gltf", SPH_SKIN_ANIMATION, SPH_SKELETON_TREE, SPH_IO_WEIGHTS_U16, 8, 1},
};

static sph_context *context;

/* The weights of a vertex as whole numbers of the given sum, the largest remainders rounded up. */
static void round_weights(const float *weights, uint32_t count, double one, float *out)
{
    double left = one;
    for (uint32_t i = 0; i < count; ++i)
        left -= (double)(out[i] = (float)floor((double)weights[i] * one));
    for (; left >= 1; --left) {
        uint32_t best = 0;
        for (uint32_t i = 1; i < count; ++i)
            if ((double)weights[i] * one - (double)out[i] > (double)weights[best] * one - (double)out[best]) best = i;
        ++out[best];
    }
    for (uint32_t i = 0; i < count; ++i)
        out[i] = (float)((double)out[i] / one);
}

/* The skin with two clips instead of one, and the weights that its file will have. */
static sph_skin *change(sph_skin *skin, const variant *v)
{
    sph_skin_arrays a = {.struct_size = sizeof a};
    sph_skin *changed = NULL;
    sph_skin_clip clips[2];
    float *weights;
    if (skin == NULL || sph_skin_get_arrays(skin, &a) != SPH_OK) return NULL;
    clips[0] = (sph_skin_clip){"first", 0, (a.frame_count + 1) / 2, FPS};
    clips[1] = (sph_skin_clip){"second", (a.frame_count + 1) / 2, a.frame_count / 2, FPS};
    a.clips = clips;
    a.clip_count = a.frame_count < 2 ? 1 : 2;
    weights = malloc((size_t)a.vertex_count * a.influence_count * sizeof *weights);
    for (size_t i = 0; weights != NULL && i < a.vertex_count && v->weights != SPH_IO_WEIGHTS_FLOAT; ++i)
        round_weights(a.weights + i * a.influence_count, a.influence_count,
                      v->weights == SPH_IO_WEIGHTS_U8 ? 255 : 65535, weights + i * a.influence_count);
    if (v->weights != SPH_IO_WEIGHTS_FLOAT) a.weights = weights;
    if (weights != NULL) (void)sph_skin_create_from_arrays(context, &a, &changed);
    free(weights);
    sph_skin_destroy(skin);
    return changed;
}

static sph_status save(const sph_skin *skin, const variant *v, const char *path)
{
    sph_skeleton_options s;
    sph_io_rig_options o;
    sph_skeleton *skeleton = NULL;
    sph_status status;
    sph_skeleton_options_init(&s, sizeof s);
    sph_io_rig_options_init(&o, sizeof o);
    s.layout = v->layout;
    s.single_root = v->single_root;
    o.weights = v->weights;
    status = sph_skeleton_create(skin, &s, &skeleton);
    if (status == SPH_OK) status = sph_io_save_rig(context, skin, skeleton, &o, path);
    sph_skeleton_destroy(skeleton);
    return status;
}

static int write_frames(const sph_skin_arrays *a, const char *path)
{
    FILE *file = fopen(path, "wb");
    if (file == NULL) return -1;
    for (size_t f = 0; f < a->frame_count; ++f)
        for (size_t v = 0; v < a->vertex_count; ++v) {
            double sum[3] = {0, 0, 0};
            float out[3];
            for (size_t i = v * a->influence_count; i < (v + 1) * a->influence_count; ++i) {
                const double *t = a->transforms + 12 * (f * a->bone_count + a->bones[i]);
                const float *p = a->rest + 3 * v;
                for (int r = 0; r < 3; ++r)
                    sum[r] += (double)a->weights[i] * (t[4 * r] * (double)p[0] + t[4 * r + 1] * (double)p[1] +
                                                       t[4 * r + 2] * (double)p[2] + t[4 * r + 3]);
            }
            for (int r = 0; r < 3; ++r)
                out[r] = (float)sum[r];
            fwrite(out, sizeof out, 1, file);
        }
    return fclose(file);
}

static sph_status make(const variant *v, const sph_level *level, const sph_animation *animation, const char *folder,
                       const char *name)
{
    const sph_skin_source source = {animation, "all", FPS};
    sph_skin_options options;
    sph_skin_arrays a = {.struct_size = sizeof a};
    sph_skin *skin = NULL;
    sph_status status;
    char rig[PATH_SIZE], frames[PATH_SIZE];
    sph_skin_options_init(&options, sizeof options);
    options.mode = v->mode;
    options.influence_limit = v->influences;
    options.round_limit = 10;
    status = sph_skin_create(level, &source, 1, &options, &skin);
    if (status != SPH_OK) return status;
    skin = change(skin, v);
    if (skin == NULL) return SPH_E_NOMEM;
    snprintf(rig, sizeof rig, "%s/%s-%s.%s", folder, name, v->name, v->ending);
    snprintf(frames, sizeof frames, "%s/%s-%s.frames", folder, name, v->name);
    status = sph_skin_get_arrays(skin, &a);
    if (status == SPH_OK) status = save(skin, v, rig);
    if (status == SPH_OK && write_frames(&a, frames) != 0) status = SPH_E_IO;
    if (status == SPH_OK) {
        printf("{\"rig\": \"%s\", \"frames\": \"%s\", \"fps\": %d, \"vertices\": %u, \"clips\": [", rig, frames, FPS,
               (unsigned)a.vertex_count);
        for (uint32_t c = 0; c < a.clip_count; ++c)
            printf("%s{\"name\": \"%s\", \"frames\": %u}", c == 0 ? "" : ", ", a.clips[c].name,
                   (unsigned)a.clips[c].frame_count);
        puts("]}");
    }
    sph_skin_destroy(skin);
    return status;
}

int main(int argc, char **argv)
{
    const char *input = argc > 4 ? argv[4] : NULL;
    sph_io_open_options options;
    sph_animation *animation = NULL;
    sph_hierarchy *hierarchy = NULL;
    sph_level *level = NULL;
    sph_status status;
    if (argc < 5 || sph_context_create(NULL, &context) != SPH_OK) {
        fputs("usage: rigs FOLDER NAME SPHERES INPUT [CACHE]\n", stderr);
        return EXIT_FAILURE;
    }
    sph_io_open_options_init(&options, sizeof options);
    options.cache_path = argc > 5 ? argv[5] : NULL;
    status = sph_io_open_animation(context, &input, 1, &options, &animation);
    if (status == SPH_OK) status = sph_hierarchy_create(animation, NULL, &hierarchy);
    if (status == SPH_OK) status = sph_level_create(hierarchy, (uint32_t)atoi(argv[3]), &level);
    for (size_t v = 0; v < sizeof VARIANTS / sizeof *VARIANTS && status == SPH_OK; ++v)
        status = make(&VARIANTS[v], level, animation, argv[1], argv[2]);
    if (status != SPH_OK) fprintf(stderr, "%s: %s\n", input, sph_context_last_message(context));
    sph_level_destroy(level);
    sph_hierarchy_destroy(hierarchy);
    sph_animation_destroy(animation);
    sph_context_destroy(context);
    return status == SPH_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
