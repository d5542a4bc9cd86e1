/* SPDX-License-Identifier: MIT */
/* Importance given by the caller. That of curvature is made with the leaves: caps.c. */
#include <math.h>

#include "hierarchy/build.h"

/* The greatest weight is brought near 1, as the size of the input is: see scale.c. Coherence goes with them, as
 * it counts by area alone. */
static void normalise_weights(sph__builder *b, size_t count, float greatest)
{
    double factor;
    if (!(greatest > 0)) return;
    frexp((double)greatest, &b->weight_exponent);
    factor = ldexp(1.0, -b->weight_exponent);
    for (size_t i = 0; i < count; ++i) b->importance[i] = (float)(b->importance[i] * factor);
    b->coherence *= factor;
}

static sph_status copy_callers(sph__builder *b)
{
    const sph_hierarchy_options *o = &b->options;
    const uint32_t frames = o->importance_frame_stride == 0 ? 1 : b->frames;
    const size_t stride = frames == 1 ? 1 : b->stride;
    float greatest = 0;
    b->importance = sph__zalloc(b->context, b->n, stride * sizeof *b->importance);
    if (b->importance == NULL) return sph__fail_memory(b->context);
    b->importance_per_frame = stride != 1;
    for (uint32_t f = 0; f < frames; ++f)
        for (uint32_t v = 0; v < b->n; ++v) {
            const float k = o->importance_weights[f * o->importance_frame_stride + v];
            if (!(k >= 0) || isinf(k))
                return sph__fail(b->context, SPH_E_INVALID, "frame %u, vertex %u: importance %g is not finite and >= 0",
                                 f, v, (double)k);
            b->importance[v * stride + f] = k;
            greatest = k > greatest ? k : greatest;
        }
    normalise_weights(b, b->n * stride, greatest);
    return SPH_OK;
}

sph_status sph__make_importance(sph__builder *b)
{
    return b->options.importance == SPH_IMPORTANCE_CALLER ? copy_callers(b) : SPH_OK;
}
