/* SPDX-License-Identifier: MIT */
/* Skins of the caller's arrays, made from bytes: checked, hung into trees, posed, and saved and read again. */
#include <math.h>

#include "fuzz.h"
#include "fuzz_rig.h"

enum { VERTEX_LIMIT = 24, BONE_LIMIT = 9, SLOT_LIMIT = 6, POSE_LIMIT = 4, TRIANGLE_LIMIT = 30, LINK_LIMIT = 12 };

typedef struct parts {
    sph_skin_arrays arrays;
    sph_skin_clip clips[POSE_LIMIT];
    float rest[3 * VERTEX_LIMIT], weights[VERTEX_LIMIT * SLOT_LIMIT];
    uint32_t bones[VERTEX_LIMIT * SLOT_LIMIT], triangles[3 * TRIANGLE_LIMIT], links[2 * LINK_LIMIT];
    double transforms[12 * POSE_LIMIT * BONE_LIMIT], pivots[3 * BONE_LIMIT], radii[BONE_LIMIT];
} parts;

static double number(fuzz_bytes *b)
{
    static const double AWKWARD[] = {0,   -0.0, 5e-324, 1e-300, 1e-40, 1e-20, 1e-7,     1.0 / 3,
                                     1e7, 1e15, 1e30,   1e38,   1e39,  1e300, INFINITY, NAN};
    const uint8_t kind = fuzz_byte(b);
    return kind >= 240 ? AWKWARD[kind - 240] : 0.25 * (kind % 32) - 4;
}

/* A turn and a shift, which glTF can hold, or twelve numbers. */
static void make_transform(fuzz_bytes *b, double m[12])
{
    const uint8_t kind = fuzz_byte(b);
    const double angle = kind * 0.1, c = cos(angle), s = sin(angle);
    if (kind >= 224) {
        for (unsigned i = 0; i < 12; ++i)
            m[i] = number(b);
        return;
    }
    for (unsigned i = 0; i < 12; ++i)
        m[i] = i % 5 == 0 ? 1 : 0;
    m[kind % 3 == 0 ? 0 : 5] = m[kind % 3 == 2 ? 0 : 10] = c;
    if (kind % 3 == 0) m[0] = m[10] = c, m[5] = 1, m[2] = s, m[8] = -s;
    if (kind % 3 == 1) m[5] = m[10] = c, m[0] = 1, m[6] = -s, m[9] = s;
    if (kind % 3 == 2) m[0] = m[5] = c, m[10] = 1, m[1] = -s, m[4] = s;
    for (unsigned i = 0; i < 3; ++i)
        m[4 * i + 3] = number(b);
}

static void make_weights(fuzz_bytes *b, parts *p, uint32_t v)
{
    const uint32_t k = p->arrays.influence_count;
    float sum = 0;
    for (uint32_t i = v * k; i < (v + 1) * k; ++i) {
        p->bones[i] = fuzz_below(b, p->arrays.bone_count);
        p->weights[i] = (float)fuzz_byte(b);
        sum += p->weights[i];
    }
    for (uint32_t i = v * k; sum > 0 && i < (v + 1) * k; ++i)
        p->weights[i] /= sum;
    if (sum == 0) p->weights[v * k] = 1;
}

static void make_clips(fuzz_bytes *b, parts *p)
{
    static const double RATES[] = {0, 30, 24, 1, 1e-7, 60, 29.97, 1e5};
    uint32_t first = 0;
    while (first < p->arrays.frame_count && fuzz_below(b, 4) != 0) {
        const uint32_t count = 1 + fuzz_below(b, p->arrays.frame_count - first);
        p->clips[p->arrays.clip_count++] = (sph_skin_clip){.name = fuzz_below(b, 2) != 0 ? "a \"clip\"" : NULL,
                                                           .first_frame = first,
                                                           .frame_count = count,
                                                           .frames_per_second = RATES[fuzz_below(b, 8)]};
        first += count;
    }
}

static void make_parts(fuzz_bytes *b, parts *p)
{
    sph_skin_arrays *a = &p->arrays;
    *a = (sph_skin_arrays){.struct_size = sizeof *a,
                           .vertex_count = 1 + fuzz_below(b, VERTEX_LIMIT),
                           .bone_count = 1 + fuzz_below(b, BONE_LIMIT),
                           .influence_count = 1 + fuzz_below(b, SLOT_LIMIT),
                           .frame_count = fuzz_below(b, POSE_LIMIT + 1),
                           .triangle_count = fuzz_below(b, TRIANGLE_LIMIT + 1),
                           .link_count = fuzz_below(b, LINK_LIMIT + 1),
                           .rest = p->rest,
                           .bones = p->bones,
                           .weights = p->weights,
                           .triangles = p->triangles,
                           .links = p->links,
                           .clips = p->clips};
    make_clips(b, p);
    for (uint32_t i = 0; i < 3 * a->vertex_count; ++i)
        p->rest[i] = (float)number(b);
    for (uint32_t v = 0; v < a->vertex_count; ++v)
        make_weights(b, p, v);
    for (uint32_t i = 0; i < 3 * a->triangle_count; ++i)
        p->triangles[i] = fuzz_below(b, a->vertex_count);
    for (uint32_t i = 0; i < 2 * a->link_count; ++i)
        p->links[i] = fuzz_below(b, a->bone_count);
    for (uint32_t i = 0; i < a->frame_count * a->bone_count; ++i)
        make_transform(b, p->transforms + 12 * i);
    if (a->frame_count > 0) a->transforms = p->transforms;
    if (fuzz_below(b, 2) != 0) a->pivots = p->pivots;
    if (fuzz_below(b, 2) != 0) a->radii = p->radii;
    for (uint32_t i = 0; i < 3 * a->bone_count && a->pivots != NULL; ++i)
        p->pivots[i] = number(b);
    for (uint32_t i = 0; i < a->bone_count && a->radii != NULL; ++i)
        p->radii[i] = fabs(number(b));
}

/* Any places of the spheres give finite transforms or a reason. */
static void move_spheres(const sph_skin *skin, uint32_t bones, fuzz_bytes *b)
{
    double centers[3 * BONE_LIMIT] = {0}, transforms[12 * BONE_LIMIT];
    for (uint32_t i = 0; i < 3 * bones; ++i)
        centers[i] = number(b);
    if (sph_pose_from_spheres(skin, NULL, centers, transforms) != SPH_OK) return;
    for (uint32_t i = 0; i < 12 * bones; ++i)
        FUZZ_CHECK(isfinite(transforms[i]));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_bytes b = {data, size};
    fuzz_patience patience = {.reports_left = 10000};
    sph_context *context = fuzz_context(&patience);
    const uint64_t idle = sph_context_memory_used(context);
    parts *p = calloc(1, sizeof *p);
    sph_skin *skin = NULL;
    sph_status status;
    FUZZ_CHECK(p != NULL);
    make_parts(&b, p);
    status = sph_skin_create_from_arrays(context, &p->arrays, &skin);
    FUZZ_CHECK((skin != NULL) == (status == SPH_OK) && (status == SPH_OK || status == SPH_E_INVALID));
    if (status == SPH_OK) {
        fuzz_use_skin(skin);
        move_spheres(skin, p->arrays.bone_count, &b);
        fuzz_save_skin(context, skin);
    }
    sph_skin_destroy(skin);
    free(p);
    fuzz_end(context, status, idle);
    return 0;
}
