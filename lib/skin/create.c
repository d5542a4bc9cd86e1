/* SPDX-License-Identifier: MIT */
/* Skins whose bones are the spheres of a level: options, and the order of things. */
#include <math.h>

#include "animation/animation.h"
#include "level/level.h"
#include "numeric/rotation.h"
#include "skin/skin.h"

static const sph_skin_options DEFAULTS = {.struct_size = sizeof(sph_skin_options),
                                          .mode = SPH_SKIN_MIXED,
                                          .influence_limit = 4,
                                          .rings = 1,
                                          .round_limit = 30,
                                          .rest_interval = 5,
                                          .tolerance = 1e-3,
                                          .smoothness = 1e-4,
                                          .filter_radius = 0.03,
                                          .minor_bone = 3};
enum { OPTIONS_V1 = offsetof(sph_skin_options, step_user) + sizeof(void *) };

/* What one call works on. */
typedef struct job {
    const sph_level *level;
    const sph_skin_source *sources;
    size_t source_count;
    sph_skin_options options;
    sph__progress progress;
    sph__reach reach;
    uint32_t *labels;
    double *sums; /* [J][16]: weight, rest, place, and their product */
    sph_skin *skin;
} job;

void sph_skin_options_init(sph_skin_options *options, size_t size)
{
    sph__options_init(options, size, &DEFAULTS, sizeof DEFAULTS, OPTIONS_V1);
}

static sph_status read_options(job *j, const sph_skin_options *in)
{
    const sph_context *context = j->level->context;
    sph_skin_options *o = &j->options;
    sph_status status;
    *o = DEFAULTS;
    status = sph__options_read(context, "sph_skin_options", in, o, sizeof *o, OPTIONS_V1);
    if (status != SPH_OK) return status;
    if (o->flags != 0) return sph__fail(context, SPH_E_INVALID, "sph_skin_options: flags must be 0");
    if (o->mode < SPH_SKIN_MIXED || o->mode > SPH_SKIN_GEOMETRIC)
        return sph__fail(context, SPH_E_INVALID, "sph_skin_options: mode is %d", (int)o->mode);
    if (o->influence_limit == 0) return sph__fail(context, SPH_E_INVALID, "sph_skin_options: influence_limit is 0");
    return SPH_OK;
}

/* The cells: vertices that the level gives to no sphere go to the nearest in the first frame. */
static sph_status find_cells(job *j)
{
    const sph_level *level = j->level;
    const sph_animation *animation = j->sources[0].animation;
    const float *centers = sph__level_centers(level, 0);
    j->labels = sph__alloc(level->context, level->label_count, sizeof *j->labels);
    if (j->labels == NULL) return sph__fail_memory(level->context);
    for (size_t v = 0; v < level->label_count; ++v) {
        double least = INFINITY;
        j->labels[v] = level->labels[v];
        for (uint32_t s = 0; s < level->sphere_count && level->labels[v] == SPH_NO_SPHERE; ++s) {
            double d2 = 0;
            for (int k = 0; k < 3; ++k) {
                const double d = (double)j->skin->rest[3 * v + k] - (double)centers[3 * (size_t)s + k];
                d2 += d * d;
            }
            if (d2 >= least) continue;
            least = d2;
            j->labels[v] = s;
        }
    }
    return sph__reach_find(&j->reach, level->context, level->sphere_count, j->labels, animation->triangles,
                           animation->triangle_count, animation->edges, animation->edge_count, j->options.rings);
}

/* Geometric weights: the inverse squared distance to the bones within reach. */
static sph_status start_weights(job *j)
{
    sph_skin *skin = j->skin;
    const uint32_t k = skin->influence_count;
    uint32_t *bones = sph__alloc(skin->context, j->reach.most, sizeof *bones);
    double *weights = sph__alloc(skin->context, j->reach.most, sizeof *weights);
    sph_status status = bones == NULL || weights == NULL ? sph__fail_memory(skin->context) : SPH_OK;
    for (size_t v = 0; v < skin->vertex_count && status == SPH_OK; ++v) {
        const size_t begin = j->reach.starts[j->labels[v]], end = j->reach.starts[j->labels[v] + 1];
        for (size_t i = begin; i < end; ++i) {
            const uint32_t bone = j->reach.bones[i];
            double d2 = 1e-300;
            for (int c = 0; c < 3; ++c) {
                const double d = (double)skin->rest[3 * v + c] - skin->pivots[3 * (size_t)bone + c];
                d2 += d * d;
            }
            bones[i - begin] = bone;
            weights[i - begin] = 1 / d2;
        }
        sph__weights_order(bones, weights, (uint32_t)(end - begin), k, skin->bones + v * k, skin->weights + v * k);
    }
    sph__free(skin->context, bones);
    sph__free(skin->context, weights);
    return status;
}

/* The rigid motion that takes the rest pose's weighted vertices nearest to those of a frame. */
static void fit(const double sums[16], double transform[12])
{
    double m[9], r[9];
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            m[3 * a + b] = sums[7 + 3 * a + b] - (sums[0] > 0 ? sums[4 + a] * sums[1 + b] / sums[0] : 0);
    sph__nearest_rotation(m, r);
    for (int a = 0; a < 3; ++a) {
        double turned = 0;
        for (int b = 0; b < 3; ++b) {
            transform[4 * a + b] = r[3 * a + b];
            turned += r[3 * a + b] * sums[1 + b];
        }
        transform[4 * a + 3] = sums[0] > 0 ? (sums[4 + a] - turned) / sums[0] : 0;
    }
}

static void fit_frame(const job *j, const float *xyz, double *transforms)
{
    const sph_skin *skin = j->skin;
    const uint32_t k = skin->influence_count;
    memset(j->sums, 0, (size_t)skin->bone_count * 16 * sizeof *j->sums);
    for (size_t v = 0; v < skin->vertex_count; ++v)
        for (uint32_t s = 0; s < k; ++s) {
            const double w = (double)skin->weights[v * k + s];
            double *sums = j->sums + 16 * (size_t)skin->bones[v * k + s];
            sums[0] += w;
            for (int a = 0; a < 3; ++a) {
                sums[1 + a] += w * (double)skin->rest[3 * v + a];
                sums[4 + a] += w * (double)xyz[3 * v + a];
                for (int b = 0; b < 3; ++b)
                    sums[7 + 3 * a + b] += w * (double)xyz[3 * v + a] * (double)skin->rest[3 * v + b];
            }
        }
    for (uint32_t b = 0; b < skin->bone_count; ++b)
        fit(j->sums + 16 * (size_t)b, transforms + 12 * (size_t)b);
}

static sph_status fit_transforms(job *j)
{
    sph_skin *skin = j->skin;
    sph_status status = SPH_OK;
    uint32_t frame = 0;
    j->sums = sph__alloc(skin->context, skin->bone_count, 16 * sizeof *j->sums);
    if (j->sums == NULL) return sph__fail_memory(skin->context);
    for (size_t s = 0; s < j->source_count && status == SPH_OK; ++s) {
        const sph_animation *animation = j->sources[s].animation;
        const float *xyz;
        float *scratch = NULL;
        status = sph__animation_scratch(animation, &scratch);
        for (uint32_t f = 0; f < animation->frame_count && status == SPH_OK; ++f, ++frame) {
            status = sph__progress_report(&j->progress, "transforms", (double)frame / skin->frame_count);
            if (status == SPH_OK) status = sph__animation_frame(animation, f, scratch, &xyz);
            if (status == SPH_OK) status = sph__check_finite(skin->context, f, xyz, skin->vertex_count);
            if (status == SPH_OK) fit_frame(j, xyz, skin->transforms + 12 * (size_t)frame * skin->bone_count);
        }
        sph__free(animation->context, scratch);
    }
    return status;
}

static sph_status copy_links(sph_skin *skin, const sph_level *level)
{
    sph__keyed *keys;
    uint32_t *at = skin->links;
    keys = sph__alloc(skin->context, skin->link_count, sizeof *keys);
    if (keys == NULL) return sph__fail_memory(skin->context);
    for (size_t e = 0; e < 2 * level->edge_count; ++e)
        *at++ = level->edges[e];
    for (size_t t = 0; t < level->triangle_count; ++t)
        for (unsigned k = 0; k < 3; ++k) {
            *at++ = level->triangles[3 * t + k];
            *at++ = level->triangles[3 * t + (k + 1) % 3];
        }
    skin->link_count = sph__skin_order_links(skin->links, skin->link_count, keys);
    sph__free(skin->context, keys);
    return SPH_OK;
}

static sph_status set_clips(job *j)
{
    sph_skin_clip *clips = sph__alloc(j->skin->context, j->source_count, sizeof *clips);
    uint32_t at = 0;
    sph_status status;
    if (clips == NULL) return sph__fail_memory(j->skin->context);
    for (size_t s = 0; s < j->source_count; ++s) {
        const sph_skin_source *source = &j->sources[s];
        clips[s] = (sph_skin_clip){source->name, at, source->animation->frame_count, source->frames_per_second};
        at += source->animation->frame_count;
    }
    status = sph__skin_set_clips(j->skin, clips, (uint32_t)j->source_count);
    sph__free(j->skin->context, clips);
    return status;
}

/* What of the skin does not depend on any fit. */
static sph_status begin_skin(job *j, uint32_t frame_count)
{
    const sph_level *level = j->level;
    const sph_animation *animation = j->sources[0].animation;
    const uint32_t k = j->options.influence_limit < level->sphere_count ? j->options.influence_limit
                                                                         : level->sphere_count;
    const sph_skin_arrays sizes = {.vertex_count = animation->vertex_count,
                                   .bone_count = level->sphere_count,
                                   .influence_count = k,
                                   .frame_count = frame_count,
                                   .triangle_count = animation->triangle_count,
                                   .link_count = level->edge_count + 3 * level->triangle_count};
    sph_status status = sph__skin_allocate(level->context, &sizes, &j->skin);
    if (status != SPH_OK) return status;
    for (size_t i = 0; i < 3 * (size_t)level->sphere_count; ++i)
        j->skin->pivots[i] = (double)sph__level_centers(level, 0)[i];
    for (size_t i = 0; i < level->sphere_count; ++i)
        j->skin->radii[i] = (double)sph__level_radii(level, 0)[i];
    if (animation->triangle_count != 0)
        memcpy(j->skin->triangles, animation->triangles, animation->triangle_count * 3 * sizeof(uint32_t));
    j->skin->rigid = 1;
    status = sph_animation_read_frame(animation, 0, j->skin->rest);
    if (status == SPH_OK) status = sph__check_finite(level->context, 0, j->skin->rest, animation->vertex_count);
    if (status == SPH_OK) status = copy_links(j->skin, level);
    return status == SPH_OK ? set_clips(j) : status;
}

static sph_status run(job *j, uint32_t frame_count)
{
    sph_status status = begin_skin(j, frame_count);
    if (status == SPH_OK && j->options.mode != SPH_SKIN_GEOMETRIC)
        status = sph__fail(j->level->context, SPH_E_UNSUPPORTED, "only geometric weights are implemented so far");
    if (status == SPH_OK) status = find_cells(j);
    if (status == SPH_OK) status = start_weights(j);
    sph__progress_part(&j->progress, 0.9);
    if (status == SPH_OK) status = fit_transforms(j);
    sph__progress_part(&j->progress, 0.1);
    if (status == SPH_OK) status = sph__skin_measure_self(j->skin, j->sources, j->source_count, &j->progress);
    return status;
}

sph_status sph_skin_create(const sph_level *level, const sph_skin_source *sources, size_t source_count,
                           const sph_skin_options *options, sph_skin **out)
{
    job j = {.level = level, .sources = sources, .source_count = source_count};
    uint32_t frames;
    sph_status status;
    if (out != NULL) *out = NULL;
    if (level == NULL || out == NULL)
        return sph__fail(level == NULL ? NULL : level->context, SPH_E_INVALID,
                         "sph_skin_create: an argument is NULL");
    if (level->labels == NULL || level->label_count > UINT32_MAX)
        return sph__fail(level->context, SPH_E_INVALID, "the level has no labels: it was not made from a hierarchy");
    status = read_options(&j, options);
    if (status == SPH_OK)
        status = sph__skin_check_sources(level->context, sources, source_count, (uint32_t)level->label_count, &frames);
    if (status != SPH_OK) return status;
    sph__progress_begin(&j.progress, level->context);
    status = run(&j, frames);
    sph__reach_free(&j.reach);
    sph__free(level->context, j.labels);
    sph__free(level->context, j.sums);
    if (status != SPH_OK) {
        sph_skin_destroy(j.skin);
        return status;
    }
    *out = j.skin;
    return SPH_OK;
}
