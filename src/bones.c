/* SPDX-License-Identifier: MIT */
/* Colours by bones: hues a golden section apart, so that neighbours in number differ, mixed by weight. */
#include <math.h>
#include <stdio.h>

#include "figure.h"

/* Linear red, green and blue of a hue from 0 to 1, in three degrees of brightness. */
static void bone_colour(uint32_t bone, double colour[3])
{
    const double hue = fmod(bone * 0.61803398874989485, 1), bright = 0.75 - 0.22 * (bone % 3);
    for (int k = 0; k < 3; ++k) {
        const double wheel = fabs(fmod(hue * 6 + (k == 0 ? 0 : k == 1 ? 4 : 2), 6) - 3) - 1;
        const double pure = wheel < 0 ? 0 : wheel > 1 ? 1 : wheel;
        colour[k] = bright * (0.06 + 0.94 * pure * pure);
    }
}

sph_status figure_colour_by_bones(figure *f, sph_context *context, const sph_skin *skin)
{
    sph_skin_arrays a = {.struct_size = sizeof a};
    const uint32_t n = sph_animation_vertex_count(f->animation);
    const sph_status status = sph_skin_get_arrays(skin, &a);
    char message[160];
    if (status != SPH_OK) return status;
    if (a.vertex_count != n) {
        snprintf(message, sizeof message, "the rig has %u vertices, the mesh %u: they do not belong together",
                 (unsigned)a.vertex_count, (unsigned)n);
        return sph_context_fail(context, SPH_E_INVALID, message);
    }
    f->colours = sph_context_allocate(context, n, 3 * sizeof *f->colours);
    if (f->colours == NULL) return sph_context_fail(context, SPH_E_NOMEM, "out of memory");
    for (size_t i = 0; i < n; ++i) {
        double sum[3] = {0, 0, 0}, colour[3];
        for (size_t j = 0; j < a.influence_count; ++j) {
            bone_colour(a.bones[i * a.influence_count + j], colour);
            for (int k = 0; k < 3; ++k) sum[k] += (double)a.weights[i * a.influence_count + j] * colour[k];
        }
        for (size_t k = 0; k < 3; ++k) f->colours[3 * i + k] = (float)sum[k];
    }
    return SPH_OK;
}
