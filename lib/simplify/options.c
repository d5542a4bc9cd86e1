/* SPDX-License-Identifier: MIT */
/* Options: defaults, and what is refused. */
#include <math.h>

#include "simplify/simplify.h"

enum {
    OPTIONS_V1 = offsetof(sph_simplify_options, locked) + sizeof(const uint8_t *),
    INFLUENCE_LIMIT = 32,
    ROUND_LIMIT = 1000,
    ATTRIBUTE_LIMIT = 4096,
    VERTEX_LIMIT = 1 << 30
};
_Static_assert(sizeof(void *) != 8 || OPTIONS_V1 == 88, "a field of 0.1 moved");
_Static_assert(2 * INFLUENCE_LIMIT <= SPH__SIMPLIFY_BONES, "two ends have too many bones");

static const sph_simplify_options DEFAULTS = {.struct_size = sizeof(sph_simplify_options),
                                              .method = SPH_SIMPLIFY_SKINNED,
                                              .pose_limit = 64,
                                              .border_weight = 1,
                                              .tolerance = 1e-4,
                                              .round_limit = 8};

void sph_simplify_options_init(sph_simplify_options *options, size_t size)
{
    sph__options_init(options, size, &DEFAULTS, sizeof DEFAULTS, OPTIONS_V1);
}

static sph_status check_numbers(const sph_context *context, const sph_simplify_options *o)
{
    if (o->flags != 0) return sph__fail(context, SPH_E_INVALID, "sph_simplify_options: flags must be 0");
    if (o->method < SPH_SIMPLIFY_SKINNED || o->method > SPH_SIMPLIFY_REST)
        return sph__fail(context, SPH_E_INVALID, "sph_simplify_options: method %d is unknown", (int)o->method);
    if (o->influence_limit > INFLUENCE_LIMIT)
        return sph__fail(context, SPH_E_INVALID, "sph_simplify_options: %u influences per vertex are more than %d",
                         (unsigned)o->influence_limit, INFLUENCE_LIMIT);
    if (!(isfinite(o->border_weight) && o->border_weight >= 0))
        return sph__fail(context, SPH_E_INVALID, "sph_simplify_options: border_weight is %g", o->border_weight);
    if (!(isfinite(o->tolerance) && o->tolerance >= 0))
        return sph__fail(context, SPH_E_INVALID, "sph_simplify_options: tolerance is %g", o->tolerance);
    if (o->round_limit == 0 || o->round_limit > ROUND_LIMIT)
        return sph__fail(context, SPH_E_INVALID, "sph_simplify_options: round_limit is %u, not from 1 to %d",
                         (unsigned)o->round_limit, ROUND_LIMIT);
    if (o->attribute_count > ATTRIBUTE_LIMIT)
        return sph__fail(context, SPH_E_INVALID, "sph_simplify_options: %u attributes are more than %d",
                         (unsigned)o->attribute_count, ATTRIBUTE_LIMIT);
    if (o->attribute_count != 0 && o->attributes == NULL)
        return sph__fail(context, SPH_E_INVALID, "sph_simplify_options: attributes is NULL");
    if ((o->pose_count != 0) != (o->poses != NULL))
        return sph__fail(context, SPH_E_INVALID, "sph_simplify_options: poses and pose_count go together");
    return SPH_OK;
}

static sph_status check_arrays(const sph_skin *skin, const sph_simplify_options *o)
{
    const size_t n = skin->vertex_count, bones = skin->bone_count;
    size_t poses;
    for (size_t i = 0; i < n * o->attribute_count; ++i)
        if (!isfinite(o->attributes[i]))
            return sph__fail(skin->context, SPH_E_INVALID, "attribute %zu of vertex %zu is not finite",
                             i % o->attribute_count, i / o->attribute_count);
    for (size_t i = 0; i < 3 * n && o->normals != NULL; ++i)
        if (!isfinite(o->normals[i]))
            return sph__fail(skin->context, SPH_E_INVALID, "the normal of vertex %zu is not finite", i / 3);
    if (!sph__multiply_size(o->pose_count, 12 * bones, &poses))
        return sph__fail(skin->context, SPH_E_INVALID, "%u poses are too many", (unsigned)o->pose_count);
    for (size_t i = 0; i < poses; ++i)
        if (!isfinite(o->poses[i]))
            return sph__fail(skin->context, SPH_E_INVALID, "the transform of bone %zu in pose %zu is not finite",
                             i / 12 % bones, i / 12 / bones);
    return SPH_OK;
}

sph_status sph__simplify_read_options(const sph_skin *skin, const sph_simplify_options *in, sph_simplify_options *o)
{
    sph_status status;
    *o = DEFAULTS;
    status = sph__options_read(skin->context, "sph_simplify_options", in, o, sizeof *o, OPTIONS_V1);
    if (status == SPH_OK) status = check_numbers(skin->context, o);
    if (status != SPH_OK) return status;
    if (skin->triangle_count == 0)
        return sph__fail(skin->context, SPH_E_INVALID, "a skin without triangles has no levels");
    if (skin->vertex_count > VERTEX_LIMIT || skin->triangle_count > INT32_MAX)
        return sph__fail(skin->context, SPH_E_INVALID, "%u vertices and %zu triangles: at most 2^30 and 2^31 - 1",
                         (unsigned)skin->vertex_count, skin->triangle_count);
    if (o->influence_limit == 0)
        o->influence_limit = skin->influence_count < INFLUENCE_LIMIT ? skin->influence_count : INFLUENCE_LIMIT;
    return check_arrays(skin, o);
}
