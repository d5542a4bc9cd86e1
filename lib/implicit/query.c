/* SPDX-License-Identifier: MIT */
/* Fields at the caller's points. */
#include <math.h>

#include "implicit/implicit.h"

sph_status sph_implicit_distances(const sph_implicit *implicit, uint32_t bone, size_t count, const double *points,
                                  double *distances, double *gradients)
{
    SPH__OWN(implicit, SPH__IMPLICIT);
    if (implicit == NULL || (count != 0 && (points == NULL || distances == NULL)))
        return sph__fail(implicit == NULL ? NULL : implicit->context, SPH_E_INVALID,
                         "sph_implicit_distances: an argument is NULL");
    if (bone >= implicit->bone_count)
        return sph__fail(implicit->context, SPH_E_INVALID, "there is no bone %u", (unsigned)bone);
    if (implicit->fields[bone].count == 0)
        return sph__fail(implicit->context, SPH_E_STATE, "bone %u has no field", (unsigned)bone);
    for (size_t i = 0; i < count; ++i)
        for (size_t c = 0; c < 3; ++c)
            if (!isfinite(points[3 * i + c]))
                return sph__fail(implicit->context, SPH_E_INVALID, "point %zu is not finite", i);
    for (size_t i = 0; i < count; ++i) {
        double gradient[3];
        sph__field_distance(implicit->fields + bone, points + 3 * i, distances + i, gradient);
        if (gradients != NULL) memcpy(gradients + 3 * i, gradient, sizeof gradient);
    }
    return SPH_OK;
}

typedef struct job {
    const sph_implicit *implicit;
    const sph__placed *placed;
    const double *points;
    double *values, *gradients;
    uint32_t *bones;
    size_t count;
    int32_t evaluation;
} job;

static void evaluate_blocks(void *argument, size_t begin, size_t end)
{
    const job *j = argument;
    for (size_t b = begin; b < end; ++b) {
        const size_t first = b * SPH__IMPLICIT_BLOCK;
        const size_t count = j->count - first < SPH__IMPLICIT_BLOCK ? j->count - first : SPH__IMPLICIT_BLOCK;
        sph__points p;
        sph__values v;
        uint32_t bones[SPH__IMPLICIT_BLOCK];
        for (size_t i = 0; i < count; ++i) {
            const double *x = j->points + 3 * (first + i);
            p.x[i] = x[0];
            p.y[i] = x[1];
            p.z[i] = x[2];
        }
        sph__compose_block(j->implicit, j->placed, j->evaluation, count, &p, &v, bones);
        for (size_t i = 0; i < count; ++i) {
            const double g[3] = {v.x[i], v.y[i], v.z[i]};
            j->values[first + i] = v.f[i];
            if (j->gradients != NULL) memcpy(j->gradients + 3 * (first + i), g, sizeof g);
            if (j->bones != NULL) j->bones[first + i] = bones[i];
        }
    }
}

static sph_status check(const sph_implicit *implicit, const double *transforms, size_t count, const double *points)
{
    for (size_t i = 0; transforms != NULL && i < 12 * (size_t)implicit->bone_count; ++i)
        if (!isfinite(transforms[i]))
            return sph__fail(implicit->context, SPH_E_INVALID, "the transform of bone %zu is not finite", i / 12);
    for (size_t i = 0; i < count; ++i)
        for (size_t c = 0; c < 3; ++c)
            if (!isfinite(points[3 * i + c]))
                return sph__fail(implicit->context, SPH_E_INVALID, "point %zu is not finite", i);
    return SPH_OK;
}

sph_status sph_implicit_evaluate(const sph_implicit *implicit, const double *transforms, int32_t evaluation,
                                 size_t count, const double *points, double *values, double *gradients, uint32_t *bones)
{
    SPH__OWN(implicit, SPH__IMPLICIT);
    sph__placed *placed;
    sph_status status;
    if (implicit == NULL || (count != 0 && (points == NULL || values == NULL)))
        return sph__fail(implicit == NULL ? NULL : implicit->context, SPH_E_INVALID,
                         "sph_implicit_evaluate: an argument is NULL");
    if (evaluation != SPH_EVALUATION_TABLE && evaluation != SPH_EVALUATION_EXACT)
        return sph__fail(implicit->context, SPH_E_INVALID, "sph_implicit_evaluate: evaluation is %d", (int)evaluation);
    if ((status = check(implicit, transforms, count, points)) != SPH_OK) return status;
    placed = sph__alloc(implicit->context, implicit->bone_count, sizeof *placed);
    if (placed == NULL) return sph__fail_memory(implicit->context);
    sph__place_fields(implicit, transforms, placed);
    {
        job j = {implicit, placed, points, values, gradients, bones, count, evaluation};
        sph__parallel_for(implicit->context, count / SPH__IMPLICIT_BLOCK + (count % SPH__IMPLICIT_BLOCK != 0), 4,
                          evaluate_blocks, &j);
    }
    sph__free(implicit->context, placed);
    return SPH_OK;
}
