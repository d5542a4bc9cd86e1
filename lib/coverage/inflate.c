/* SPDX-License-Identifier: MIT */
/*
 * Larger radii that contain every vertex. Each round looks for the vertices that stick out farthest, one per frame and
 * primitive, demands that their places be covered, and solves for the least growth under all demands so far. What is
 * left after the last round is covered by raising all corners concerned: that takes no more than another pass.
 */
#include <float.h>
#include <math.h>

#include "coverage/coverage.h"

enum { MOST_ROUNDS = 1000, MOST_COVERS = 1 << 20, LAST_PASSES = 8, SWEEPS = 200 };
/* Covers reach deeper than they must, and are kept within that, by this share of the level's size: else ever smaller
 * gaps would be found beside each. */
static const double SLACK = 2e-5;

enum { OPTIONS_V1 = offsetof(sph_inflation_options, margin) + sizeof(double) };

typedef struct inflation {
    sph__coverage_job job;
    const sph_level *from;
    sph_level *level; /* the one whose radii grow */
    size_t radius_count, stride;
    double *radii; /* before they are rounded up to the level's */
    double *raises;
    double slack;
    sph__cover *covers;
    size_t cover_count, cover_capacity;
    bool is_full, has_gaps;
} inflation;

void sph_inflation_options_init(sph_inflation_options *options, size_t size)
{
    const sph_inflation_options defaults = {.struct_size = (uint32_t)size, .rounds = 24};
    sph__options_init(options, size, &defaults, sizeof defaults, OPTIONS_V1);
}

static sph_status read_options(const sph_context *context, const sph_inflation_options *in, sph_inflation_options *out)
{
    sph_status status;
    sph_inflation_options_init(out, sizeof *out);
    if (in == NULL) return SPH_OK;
    status = sph__options_read(context, "sph_inflation_options", in, out, sizeof *out, OPTIONS_V1);
    if (status != SPH_OK) return status;
    if (out->flags != 0 || out->reserved0 != 0)
        return sph__fail(context, SPH_E_INVALID, "sph_inflation_options: flags and reserved0 must be 0");
    if (out->rounds > MOST_ROUNDS)
        return sph__fail(context, SPH_E_INVALID, "sph_inflation_options: %u rounds, at most %d", (unsigned)out->rounds,
                         MOST_ROUNDS);
    if (!isfinite(out->margin) || out->margin < 0)
        return sph__fail(context, SPH_E_INVALID, "sph_inflation_options: margin is %g", out->margin);
    return SPH_OK;
}

/* --- a pass --- */

/* Demands that the worst vertex of a primitive be covered where it is nearest. */
static sph_status demand(inflation *n, const sph__coverage_slot *s, uint32_t primitive)
{
    const sph__solid *solid = &s->solid;
    const float *p = s->xyz + 3 * (size_t)s->where[primitive];
    const double x[3] = {p[0], p[1], p[2]};
    void *memory = n->covers;
    sph__cover *c;
    if (n->cover_count == MOST_COVERS) {
        n->is_full = true;
        return SPH_OK;
    }
    if (!sph__reserve(n->job.context, &memory, &n->cover_capacity, n->cover_count + 1, sizeof *n->covers))
        return sph__fail_memory(n->job.context);
    n->covers = memory;
    c = &n->covers[n->cover_count++];
    *c = (sph__cover){.frame = s->frame};
    (void)sph__coverage_excess(&solid->primitives[primitive], x, c->weights, &c->reach);
    c->reach += n->job.margin + n->slack;
    for (int32_t k = 0; k < solid->corner_counts[primitive]; ++k)
        c->spheres[k] = solid->corners[primitive][k];
    return SPH_OK;
}

static sph_status visit(void *user, const sph__coverage_slot *s)
{
    inflation *n = user;
    sph_status status = SPH_OK;
    double *raises = n->raises + s->frame * n->stride;
    if (s->count > 0) n->has_gaps = true;
    for (uint32_t i = 0; i < s->solid.sphere_count; ++i)
        raises[i] = fmax(raises[i], s->raises[i]);
    for (uint32_t i = 0; i < s->solid.primitive_count && status == SPH_OK; ++i)
        if (s->worst[i] > 0) status = demand(n, s, i);
    return status;
}

/* --- between passes --- */

/* Covers that do not matter now may come back. */
static void drop_idle(inflation *n)
{
    size_t kept = 0;
    for (size_t i = 0; i < n->cover_count; ++i)
        if (n->covers[i].multiplier > 0) n->covers[kept++] = n->covers[i];
    n->cover_count = kept;
}

/* Gives the level the least floats that are not below the radii. */
static sph_status set_radii(inflation *n)
{
    for (size_t i = 0; i < n->radius_count; ++i) {
        const double r = fmax(n->radii[i], (double)n->from->radii[i]);
        float rounded;
        if (!(r <= FLT_MAX))
            return sph__fail(n->job.context, SPH_E_LIMIT, "sphere %zu would need a radius of %g",
                             i % n->from->sphere_count, r);
        rounded = (float)r;
        if (rounded < r) rounded = nextafterf(rounded, INFINITY);
        if (!isfinite(rounded))
            return sph__fail(n->job.context, SPH_E_LIMIT, "sphere %zu would need a radius of %g",
                             i % n->from->sphere_count, r);
        n->level->radii[i] = rounded;
    }
    return SPH_OK;
}

/* At its own place, a vertex is covered when all corners concerned grow by what it lacks. */
static void raise_all(inflation *n)
{
    for (size_t i = 0; i < n->radius_count; ++i)
        if (n->raises[i] > 0) n->radii[i] = (double)n->level->radii[i] + n->raises[i] * (1 + 1e-6);
}

static sph_status grow(inflation *n, uint32_t rounds, uint32_t *passes)
{
    sph_status status = SPH_OK;
    for (uint32_t i = 0; i < rounds + LAST_PASSES; ++i) {
        const bool is_last = i >= rounds || n->is_full;
        n->has_gaps = false;
        for (size_t k = 0; k < n->radius_count; ++k)
            n->raises[k] = 0;
        sph__progress_part(&n->job.progress, i < 20 ? 0.15 * pow(0.85, i) : 0);
        status = sph__coverage_pass(&n->job, visit, n);
        ++*passes;
        if (status != SPH_OK || !n->has_gaps) return status;
        if (is_last || n->is_full) {
            raise_all(n);
        } else {
            sph__least_growth(n->covers, n->cover_count, n->radii, n->stride, SWEEPS, n->slack / 4);
            drop_idle(n);
        }
        if ((status = set_radii(n)) != SPH_OK) return status;
    }
    return sph__fail(n->job.context, SPH_E_LIMIT, "radii cannot grow enough in 32-bit floats");
}

/* --- the whole --- */

/* Diagonal of the box around all spheres of all frames. */
static double level_size(const sph_level *level)
{
    double low[3] = {DBL_MAX, DBL_MAX, DBL_MAX}, high[3] = {-DBL_MAX, -DBL_MAX, -DBL_MAX}, sum = 0;
    for (uint32_t f = 0; f < level->frame_count; ++f) {
        const float *c = sph__level_centers(level, f), *r = sph__level_radii(level, f);
        for (size_t i = 0; i < 3 * (size_t)level->sphere_count; ++i) {
            low[i % 3] = fmin(low[i % 3], (double)c[i] - r[i / 3]);
            high[i % 3] = fmax(high[i % 3], (double)c[i] + r[i / 3]);
        }
    }
    for (int k = 0; k < 3; ++k)
        sum += (high[k] - low[k]) * (high[k] - low[k]);
    return sqrt(sum);
}

static sph_status prepare(inflation *n)
{
    sph_level_arrays arrays = {.struct_size = sizeof arrays};
    sph_status status = sph_level_get_arrays(n->from, &arrays);
    if (status == SPH_OK) status = sph_level_create_from_arrays(n->job.animation->context, &arrays, &n->level);
    if (status != SPH_OK) return status;
    n->stride = n->from->radii_per_frame ? n->from->sphere_count : 0;
    n->radius_count = (size_t)n->from->sphere_count * (n->from->radii_per_frame ? n->from->frame_count : 1);
    n->slack = SLACK * level_size(n->from);
    n->radii = sph__alloc(n->job.context, n->radius_count, sizeof *n->radii);
    n->raises = sph__alloc(n->job.context, n->radius_count, sizeof *n->raises);
    if (n->radii == NULL || n->raises == NULL) return sph__fail_memory(n->job.context);
    for (size_t i = 0; i < n->radius_count; ++i)
        n->radii[i] = n->from->radii[i];
    n->job.level = n->level;
    return sph__coverage_job_init(&n->job);
}

static sph_status summarise(inflation *n, uint32_t passes, sph_inflation *out)
{
    sph_inflation r = {.struct_size = sizeof r, .rounds = passes};
    sph_status status;
    for (size_t i = 0; i < n->radius_count; ++i) {
        const double growth = (double)n->level->radii[i] - n->from->radii[i];
        r.grown_count += growth > 0;
        r.max_growth = fmax(r.max_growth, growth);
        r.mean_growth += growth / (double)n->radius_count;
    }
    sph__progress_part(&n->job.progress, 0);
    status = sph__coverage_volumes(&n->job, n->from, &r.volume_before, &r.volume_after);
    if (status == SPH_OK) *out = r;
    return status;
}

sph_status sph_coverage_inflate(const sph_animation *animation, const sph_level *level,
                                const sph_inflation_options *options, sph_inflation *inflation_out, sph_level **out)
{
    SPH__OWN(animation, SPH__ANIMATION);
    SPH__OWN(level, SPH__LEVEL);
    inflation n = {.job = {.animation = animation, .collects = true}, .from = level};
    sph_inflation_options o;
    uint32_t passes = 0;
    sph_status status;
    if (out != NULL) *out = NULL;
    if (animation != NULL) n.job.context = animation->context;
    status = sph__coverage_check(n.job.context, animation, level, "sph_coverage_inflate");
    if (status != SPH_OK) return status;
    if (out == NULL || (inflation_out != NULL && inflation_out->struct_size != sizeof *inflation_out))
        return sph__fail(n.job.context, SPH_E_INVALID,
                         "sph_coverage_inflate: no place for the level, or struct_size is not %zu",
                         sizeof *inflation_out);
    if ((status = read_options(n.job.context, options, &o)) != SPH_OK) return status;
    n.job.margin = o.margin;
    sph__progress_begin(&n.job.progress, n.job.context);
    status = prepare(&n);
    if (status == SPH_OK) status = grow(&n, o.rounds, &passes);
    if (status == SPH_OK && inflation_out != NULL) status = summarise(&n, passes, inflation_out);
    sph__coverage_job_free(&n.job);
    sph__free(n.job.context, n.radii);
    sph__free(n.job.context, n.raises);
    sph__free(n.job.context, n.covers);
    if (status == SPH_OK)
        *out = n.level;
    else
        sph_level_destroy(n.level);
    return status;
}
