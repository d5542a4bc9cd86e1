/* SPDX-License-Identifier: MIT */
/* Skins whose bones are the spheres of a level: the order of things. */
#include "animation/animation.h"
#include "skin/job.h"
#include "skin/solve.h"

enum { LAST_SWEEPS = 8 };

/* What the solver came to, as the numbers that leave. */
static sph_status store(const sph__problem *p, sph_skin *skin)
{
    const uint32_t k = skin->influence_count;
    uint32_t *bones = sph__alloc(p->context, k, sizeof *bones);
    double *weights = sph__alloc(p->context, k, sizeof *weights);
    if (bones == NULL || weights == NULL) {
        sph__free(p->context, bones);
        sph__free(p->context, weights);
        return sph__fail_memory(p->context);
    }
    for (size_t v = 0; v < p->n; ++v) {
        const size_t to = p->vertex[v];
        for (uint32_t s = 0; s < p->now.count[v]; ++s) {
            bones[s] = p->sets[p->set[v]].bones[p->now.places[v * p->limit + s]];
            weights[s] = p->now.weights[v * p->limit + s];
        }
        sph__weights_order(bones, weights, p->now.count[v], k, skin->bones + to * k, skin->weights + to * k);
        for (int c = 0; c < 3; ++c)
            skin->rest[3 * to + c] = (float)(p->rest[3 * v + c] + p->origin[c]);
    }
    sph__free(p->context, bones);
    sph__free(p->context, weights);
    return SPH_OK;
}

static void store_poses(const sph__problem *p, sph_skin *skin)
{
    enum { L = SPH__SKIN_LANES };
    for (uint32_t f = 0; f < p->frames; ++f)
        for (uint32_t b = 0; b < p->bones; ++b) {
            const double *pose = sph__problem_pose(p, f / L, b) + f % L;
            double *to = skin->transforms + 12 * ((size_t)f * p->bones + b);
            for (int r = 0; r < 3; ++r) {
                double turned = 0;
                for (int c = 0; c < 3; ++c) {
                    to[4 * r + c] = pose[(4 * r + c) * L];
                    turned += to[4 * r + c] * p->origin[c];
                }
                to[4 * r + 3] = pose[(4 * r + 3) * L] + p->origin[r] - turned;
            }
        }
}

static sph_status lock_vertices(sph__skin_job *j)
{
    sph__problem *p = &j->problem;
    if (j->options.locked_vertices == NULL) return SPH_OK;
    j->fixed = sph__alloc(p->context, p->n, 1);
    if (j->fixed == NULL) return sph__fail_memory(p->context);
    for (uint32_t v = 0; v < p->n; ++v)
        j->fixed[v] = j->options.locked_vertices[p->vertex[v]] != 0;
    p->fixed = j->fixed;
    return SPH_OK;
}

static sph_status make_filter(sph__skin_job *j)
{
    const sph_animation *animation = j->sources[0].animation;
    const sph__filter_input input = {.context = j->level->context,
                                     .problem = &j->problem,
                                     .rest = j->skin->rest,
                                     .triangles = animation->triangles,
                                     .edges = animation->edges,
                                     .triangle_count = animation->triangle_count,
                                     .edge_count = animation->edge_count,
                                     .sigma = j->options.filter_radius * j->problem.diagonal};
    return input.sigma > 0 ? sph__filter_init(&j->filter, &input, &j->progress) : SPH_OK;
}

static sph_status decompose(sph__skin_job *j)
{
    const sph__problem_input input = {.context = j->level->context,
                                      .sources = j->sources,
                                      .source_count = j->source_count,
                                      .n = j->skin->vertex_count,
                                      .bones = j->skin->bone_count,
                                      .frames = j->skin->frame_count,
                                      .limit = j->skin->influence_count,
                                      .labels = j->labels,
                                      .reach = &j->reach,
                                      .rest = j->skin->rest,
                                      .pivots = j->skin->pivots,
                                      .uniform = (j->options.flags & SPH_SKIN_UNIFORM) != 0};
    sph__problem *p = &j->problem;
    sph_status status;
    sph__progress_part(&j->progress, 0.1);
    status = sph__problem_init(p, &input, &j->progress);
    if (status == SPH_OK) status = lock_vertices(j);
    sph__progress_part(&j->progress, 0.1);
    if (status == SPH_OK && j->options.mode == SPH_SKIN_MIXED && j->options.filter_radius > 0) status = make_filter(j);
    if (status == SPH_OK) status = sph__skin_start_poses(j);
    if (status != SPH_OK) return status;
    sph__skin_load_weights(p, j->skin);
    sph__progress_part(&j->progress, 0.65);
    status = sph__solve(p, j->skin, &j->options, &j->filter, &j->progress);
    if (status == SPH_OK) status = store(p, j->skin);
    if (status != SPH_OK) return status;
    /* Poses for the weights and positions as they were rounded. */
    sph__skin_load_weights(p, j->skin);
    for (size_t v = 0; v < p->n; ++v)
        for (int k = 0; k < 3; ++k)
            p->rest[3 * v + k] = (double)j->skin->rest[3 * (size_t)p->vertex[v] + k] - p->origin[k];
    status = sph__fit_poses(p, j->skin, j->options.minor_bone, LAST_SWEEPS, true);
    if (status == SPH_OK) store_poses(p, j->skin);
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

static sph_status set_clips(sph__skin_job *j)
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
static sph_status begin_skin(sph__skin_job *j, uint32_t frame_count)
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

static sph_status run(sph__skin_job *j, uint32_t frame_count)
{
    sph_status status = begin_skin(j, frame_count);
    if (status == SPH_OK) status = sph__skin_find_cells(j);
    sph__progress_part(&j->progress, 0.1);
    if (status == SPH_OK) status = sph__skin_start_weights(j);
    if (status == SPH_OK) status = decompose(j);
    sph__progress_part(&j->progress, 0.05);
    if (status == SPH_OK) status = sph__skin_measure_self(j->skin, j->sources, j->source_count, &j->progress);
    return status;
}

sph_status sph_skin_create(const sph_level *level, const sph_skin_source *sources, size_t source_count,
                           const sph_skin_options *options, sph_skin **out)
{
    SPH__OWN(level, SPH__LEVEL);
    sph__skin_job j = {.level = level, .sources = sources, .source_count = source_count};
    uint32_t frames;
    sph_status status;
    if (out != NULL) *out = NULL;
    if (level == NULL || out == NULL)
        return sph__fail(level == NULL ? NULL : level->context, SPH_E_INVALID,
                         "sph_skin_create: an argument is NULL");
    if (level->labels == NULL || level->label_count > UINT32_MAX)
        return sph__fail(level->context, SPH_E_INVALID, "the level has no labels: it was not made from a hierarchy");
    status = sph__skin_read_options(&j, options);
    if (status == SPH_OK)
        status = sph__skin_check_sources(level->context, sources, source_count, (uint32_t)level->label_count, &frames);
    if (status == SPH_OK) status = sph__skin_check_arrays(&j, frames);
    if (status != SPH_OK) return status;
    sph__progress_begin(&j.progress, level->context);
    status = run(&j, frames);
    sph__filter_free(&j.filter);
    sph__reach_free(&j.reach);
    sph__free(level->context, j.fixed);
    sph__free(level->context, j.labels);
    sph__problem_free(&j.problem);
    if (status != SPH_OK) {
        sph_skin_destroy(j.skin);
        return status;
    }
    *out = j.skin;
    return SPH_OK;
}
