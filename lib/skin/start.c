/* SPDX-License-Identifier: MIT */
/* Where the solver starts: cells, weights and poses. */
#include <math.h>

#include "animation/animation.h"
#include "skin/heat.h"
#include "skin/job.h"

/* Vertices that the level gives to no sphere go to the nearest in the first frame. */
static uint32_t nearest_sphere(const sph__skin_job *j, size_t vertex)
{
    double least = INFINITY;
    uint32_t best = 0;
    for (uint32_t s = 0; s < j->level->sphere_count; ++s) {
        double d2 = 0;
        for (int k = 0; k < 3; ++k) {
            const double d = (double)j->skin->rest[3 * vertex + k] - j->skin->pivots[3 * (size_t)s + k];
            d2 += d * d;
        }
        if (!(d2 < least)) continue;
        least = d2;
        best = s;
    }
    return best;
}

sph_status sph__skin_find_cells(sph__skin_job *j)
{
    const sph_level *level = j->level;
    const sph_animation *animation = j->sources[0].animation;
    j->labels = sph__alloc(level->context, level->label_count, sizeof *j->labels);
    if (j->labels == NULL) return sph__fail_memory(level->context);
    for (size_t v = 0; v < level->label_count; ++v)
        j->labels[v] = level->labels[v] == SPH_NO_SPHERE ? nearest_sphere(j, v) : level->labels[v];
    return sph__reach_find(&j->reach, level->context, level->sphere_count, j->labels, animation->triangles,
                           animation->triangle_count, animation->edges, animation->edge_count, j->options.rings);
}

/* --- weights --- */

/* The caller's, of the bones within reach, into a row of heat; false where a locked vertex would lose some. */
static bool take_initial(const sph__skin_job *j, size_t v, double *row)
{
    const sph_skin_options *o = &j->options;
    const size_t begin = j->reach.starts[j->labels[v]], end = j->reach.starts[j->labels[v] + 1];
    const uint32_t k = o->initial_influence_count;
    bool lost = false;
    for (uint32_t s = 0; s < k; ++s) {
        const double w = (double)o->initial_weights[v * k + s];
        bool found = false;
        for (size_t i = begin; i < end; ++i)
            if (j->reach.bones[i] == o->initial_bones[v * k + s]) {
                row[i - begin] += w;
                found = true;
            }
        lost = lost || (!found && w > 0);
    }
    return !lost || o->locked_vertices == NULL || !o->locked_vertices[v];
}

static sph_status make_rows(sph__skin_job *j, double *rows)
{
    const sph_animation *animation = j->sources[0].animation;
    const sph__heat_input input = {.context = j->level->context,
                                   .n = j->skin->vertex_count,
                                   .bones = j->skin->bone_count,
                                   .rest = j->skin->rest,
                                   .labels = j->labels,
                                   .triangles = animation->triangles,
                                   .edges = animation->edges,
                                   .triangle_count = animation->triangle_count,
                                   .edge_count = animation->edge_count,
                                   .pivots = j->skin->pivots,
                                   .scale = sph__frame_diagonal(j->skin->rest, j->skin->vertex_count),
                                   .reach = &j->reach};
    if (j->options.initial_weights == NULL) return sph__heat_weights(&input, rows, &j->progress);
    for (size_t v = 0; v < j->skin->vertex_count; ++v)
        if (!take_initial(j, v, rows + v * j->reach.most))
            return sph__fail(j->level->context, SPH_E_INVALID,
                             "vertex %zu is locked with a weight for a bone that is not within %u rings", v,
                             (unsigned)j->options.rings);
    return SPH_OK;
}

sph_status sph__skin_start_weights(sph__skin_job *j)
{
    sph_skin *skin = j->skin;
    const uint32_t k = skin->influence_count;
    double *rows = sph__zalloc(skin->context, skin->vertex_count, j->reach.most * sizeof *rows);
    uint32_t *bones = sph__alloc(skin->context, j->reach.most, sizeof *bones);
    sph_status status = bones == NULL || rows == NULL ? sph__fail_memory(skin->context) : SPH_OK;
    if (status == SPH_OK) status = make_rows(j, rows);
    for (size_t v = 0; v < skin->vertex_count && status == SPH_OK; ++v) {
        const size_t begin = j->reach.starts[j->labels[v]];
        const uint32_t count = (uint32_t)(j->reach.starts[j->labels[v] + 1] - begin);
        double *row = rows + v * j->reach.most;
        memcpy(bones, j->reach.bones + begin, count * sizeof *bones);
        if (sph__weights_order(bones, row, count, k, skin->bones + v * k, skin->weights + v * k)) continue;
        skin->bones[v * k] = j->labels[v]; /* nothing within reach: its cell's own */
        skin->weights[v * k] = 1;
    }
    sph__free(skin->context, rows);
    sph__free(skin->context, bones);
    return status;
}

static void follow_cell(sph__problem *p, size_t v)
{
    const sph__candidates *set = &p->sets[p->set[v]];
    for (uint32_t place = 0; place < set->count; ++place)
        if (set->bones[place] == p->set[v]) p->now.places[v * p->limit] = place;
    p->now.weights[v * p->limit] = 1;
    p->now.count[v] = 1;
}

/* Of more bones within reach than a vertex may have candidates some are lost: the others share what they had. */
void sph__skin_load_weights(sph__problem *p, const sph_skin *skin)
{
    const uint32_t k = skin->influence_count;
    for (size_t v = 0; v < p->n; ++v) {
        const sph__candidates *set = &p->sets[p->set[v]];
        const size_t from = (size_t)p->vertex[v] * k;
        double sum = 0;
        p->now.count[v] = 0;
        for (uint32_t s = 0; s < k && skin->weights[from + s] > 0; ++s)
            for (uint32_t place = 0; place < set->count; ++place) {
                const size_t to = v * p->limit + p->now.count[v];
                if (set->bones[place] != skin->bones[from + s]) continue;
                p->now.places[to] = place;
                p->now.weights[to] = (double)skin->weights[from + s];
                sum += p->now.weights[to];
                ++p->now.count[v];
            }
        if (sum == 0) follow_cell(p, v);
        for (uint32_t s = 0; s < p->now.count[v] && sum > 0 && sum < 1; ++s)
            p->now.weights[v * p->limit + s] /= sum;
    }
}

/* --- poses --- */

static void load_poses(sph__problem *p, const double *transforms)
{
    enum { L = SPH__SKIN_LANES };
    for (uint32_t f = 0; f < p->frames; ++f)
        for (uint32_t b = 0; b < p->bones; ++b) {
            const double *from = transforms + 12 * ((size_t)f * p->bones + b);
            double *pose = sph__problem_pose(p, f / L, b) + f % L, at[3];
            sph__transform_point(from, p->origin, at);
            for (int r = 0; r < 3; ++r) {
                for (int c = 0; c < 3; ++c)
                    pose[(4 * r + c) * L] = from[4 * r + c];
                pose[(4 * r + 3) * L] = at[r] - p->origin[r];
            }
        }
}

sph_status sph__skin_start_poses(sph__skin_job *j)
{
    sph__problem *p = &j->problem;
    if (j->options.initial_transforms != NULL) {
        load_poses(p, j->options.initial_transforms);
        for (uint32_t b = 0; b < p->bones && j->options.locked_bones != NULL; ++b)
            p->still[b] = j->options.locked_bones[b] != 0;
        return SPH_OK;
    }
    for (size_t v = 0; v < p->n; ++v) /* every vertex the bone of its cell alone */
        follow_cell(p, v);
    return sph__fit_poses(p, j->skin, 0, 1, true);
}
