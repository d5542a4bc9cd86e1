/* SPDX-License-Identifier: MIT */
/* Options of the decomposition: defaults, and what is refused. */
#include <math.h>

#include "skin/job.h"

static const sph_skin_options DEFAULTS = {.struct_size = sizeof(sph_skin_options),
                                          .mode = SPH_SKIN_MIXED,
                                          .influence_limit = 4,
                                          .rings = 1,
                                          .round_limit = SPH_SKIN_AUTO,
                                          .rest_interval = SPH_SKIN_AUTO,
                                          .tolerance = 1e-3,
                                          .smoothness = 1e-4,
                                          .filter_radius = 0.03,
                                          .minor_bone = 3};
enum { OPTIONS_V1 = offsetof(sph_skin_options, step_user) + sizeof(void *) };
_Static_assert(sizeof(void *) != 8 || OPTIONS_V1 == 128, "a field of 0.1 moved");

void sph_skin_options_init(sph_skin_options *options, size_t size)
{
    sph__options_init(options, size, &DEFAULTS, sizeof DEFAULTS, OPTIONS_V1);
}

static sph_status check_number(const sph_context *context, const char *name, double value)
{
    if (isfinite(value) && value >= 0) return SPH_OK;
    return sph__fail(context, SPH_E_INVALID, "sph_skin_options: %s is %g", name, value);
}

static sph_status check_choices(const sph_context *context, const sph_skin_options *o)
{
    if ((o->flags & ~(uint32_t)SPH_SKIN_UNIFORM) != 0)
        return sph__fail(context, SPH_E_INVALID, "sph_skin_options: flags %#x are not known", (unsigned)o->flags);
    if (o->mode < SPH_SKIN_MIXED || o->mode > SPH_SKIN_GEOMETRIC)
        return sph__fail(context, SPH_E_INVALID, "sph_skin_options: mode is %d", (int)o->mode);
    if (o->influence_limit == 0) return sph__fail(context, SPH_E_INVALID, "sph_skin_options: influence_limit is 0");
    if ((o->initial_influence_count != 0) != (o->initial_weights != NULL) ||
        (o->initial_influence_count != 0) != (o->initial_bones != NULL))
        return sph__fail(context, SPH_E_INVALID,
                         "sph_skin_options: initial weights need bones, weights, and their count");
    if (o->locked_bones != NULL && o->initial_transforms == NULL)
        return sph__fail(context, SPH_E_INVALID, "sph_skin_options: locked bones need initial transforms");
    return SPH_OK;
}

sph_status sph__skin_read_options(sph__skin_job *j, const sph_skin_options *in)
{
    const sph_context *context = j->level->context;
    sph_skin_options *o = &j->options;
    sph_status status;
    *o = DEFAULTS;
    status = sph__options_read(context, "sph_skin_options", in, o, sizeof *o, OPTIONS_V1);
    if (status == SPH_OK) status = check_choices(context, o);
    if (status == SPH_OK) status = check_number(context, "tolerance", o->tolerance);
    if (status == SPH_OK) status = check_number(context, "error_limit", o->error_limit);
    if (status == SPH_OK) status = check_number(context, "smoothness", o->smoothness);
    if (status == SPH_OK) status = check_number(context, "filter_radius", o->filter_radius);
    if (status == SPH_OK) status = check_number(context, "minor_bone", o->minor_bone);
    if (o->round_limit == SPH_SKIN_AUTO) o->round_limit = o->mode == SPH_SKIN_ANIMATION ? 60 : 30;
    if (o->rest_interval == SPH_SKIN_AUTO) o->rest_interval = o->mode == SPH_SKIN_ANIMATION ? 1 : 5;
    return status;
}

static sph_status check_weights(const sph__skin_job *j)
{
    const sph_skin_options *o = &j->options;
    const uint32_t k = o->initial_influence_count;
    for (size_t v = 0; v < j->level->label_count; ++v)
        for (uint32_t s = 0; s < k; ++s) {
            const double w = (double)o->initial_weights[v * k + s];
            if (o->initial_bones[v * k + s] >= j->level->sphere_count)
                return sph__fail(j->level->context, SPH_E_INVALID, "initial weight %u of vertex %zu names bone %u of %u",
                                 (unsigned)s, v, (unsigned)o->initial_bones[v * k + s],
                                 (unsigned)j->level->sphere_count);
            if (!isfinite(w) || w < 0)
                return sph__fail(j->level->context, SPH_E_INVALID, "initial weight %u of vertex %zu is %g", (unsigned)s,
                                 v, w);
        }
    return SPH_OK;
}

sph_status sph__skin_check_arrays(const sph__skin_job *j, uint32_t frame_count)
{
    const size_t bones = j->level->sphere_count;
    const double *transforms = j->options.initial_transforms;
    for (size_t i = 0; i < bones * frame_count && transforms != NULL; ++i)
        for (int k = 0; k < 12; ++k)
            if (!isfinite(transforms[12 * i + k]) || (k == 11 && !sph__skin_is_rigid(transforms + 12 * i)))
                return sph__fail(j->level->context, SPH_E_INVALID,
                                 "the initial transform of bone %zu in frame %zu is not a rigid motion", i % bones,
                                 i / bones);
    return check_weights(j);
}
