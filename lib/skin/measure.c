/* SPDX-License-Identifier: MIT */
/* How far a skin is from animations (Eq. 13). */
#include <math.h>

#include "animation/animation.h"
#include "skin/skin.h"

enum { BLOCK = 1024 };

/* Sums over a block of vertices. */
typedef struct block_sums {
    double weighted, area, squared, max; /* `max` squared too */
    uint32_t vertex;
} block_sums;

typedef struct measurement {
    const sph_skin *skin;
    const double *transforms; /* of the frame at hand, as are these: */
    const float *xyz;
    double *areas;
    block_sums *blocks;
} measurement;

void sph__cell_areas(const uint32_t *triangles, size_t triangle_count, const float *xyz, uint32_t n, double *areas)
{
    memset(areas, 0, n * sizeof *areas);
    for (size_t t = 0; t < triangle_count; ++t) {
        const uint32_t *corner = triangles + 3 * t;
        const float *a = xyz + 3 * (size_t)corner[0], *b = xyz + 3 * (size_t)corner[1], *c = xyz + 3 * (size_t)corner[2];
        double u[3], v[3], x, y, z, third;
        for (int k = 0; k < 3; ++k) {
            u[k] = (double)b[k] - (double)a[k];
            v[k] = (double)c[k] - (double)a[k];
        }
        x = u[1] * v[2] - u[2] * v[1];
        y = u[2] * v[0] - u[0] * v[2];
        z = u[0] * v[1] - u[1] * v[0];
        third = sqrt(x * x + y * y + z * z) / 6;
        for (int k = 0; k < 3; ++k)
            areas[corner[k]] += third;
    }
}

static double squared_distance(const measurement *m, size_t v)
{
    const sph_skin *skin = m->skin;
    const uint32_t k = skin->influence_count;
    const float *p = skin->rest + 3 * v, *target = m->xyz + 3 * v;
    const double rest[3] = {(double)p[0], (double)p[1], (double)p[2]};
    double off[3] = {-(double)target[0], -(double)target[1], -(double)target[2]};
    for (size_t s = v * k; s < (v + 1) * k && skin->weights[s] > 0; ++s) {
        double q[3];
        sph__transform_point(m->transforms + 12 * (size_t)skin->bones[s], rest, q);
        for (int c = 0; c < 3; ++c)
            off[c] += (double)skin->weights[s] * q[c];
    }
    return off[0] * off[0] + off[1] * off[1] + off[2] * off[2];
}

static void sum_block(void *argument, size_t begin, size_t end)
{
    const measurement *m = argument;
    block_sums sums = {.vertex = (uint32_t)begin};
    for (size_t v = begin; v < end; ++v) {
        const double d2 = squared_distance(m, v);
        sums.weighted += m->areas[v] * d2;
        sums.area += m->areas[v];
        sums.squared += d2;
        if (d2 > sums.max) {
            sums.max = d2;
            sums.vertex = (uint32_t)v;
        }
    }
    m->blocks[begin / BLOCK] = sums;
}

/* Lengths absolute, and `mse` not yet divided by the squared diagonal. Without area every vertex counts alike. */
static void measure_frame(const measurement *m, uint32_t frame, sph_skin_error *error)
{
    const size_t n = m->skin->vertex_count;
    block_sums all = {0};
    sph__cell_areas(m->skin->triangles, m->skin->triangle_count, m->xyz, (uint32_t)n, m->areas);
    sph__parallel_for(m->skin->context, n, BLOCK, sum_block, (void *)(uintptr_t)m);
    for (size_t b = 0; b < (n + BLOCK - 1) / BLOCK; ++b) {
        const block_sums *block = &m->blocks[b];
        all.weighted += block->weighted;
        all.area += block->area;
        all.squared += block->squared;
        if (block->max > all.max) {
            all.max = block->max;
            all.vertex = block->vertex;
        }
    }
    *error = (sph_skin_error){.mse = all.area > 0 ? all.weighted / all.area : all.squared / (double)n,
                              .rmse = sqrt(all.squared / (double)n),
                              .max = sqrt(all.max),
                              .max_vertex = all.vertex,
                              .max_frame = frame};
}

double sph__frame_diagonal(const float *xyz, uint32_t n)
{
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
        float low = xyz[k], high = xyz[k];
        for (size_t v = 1; v < n; ++v) {
            const float x = xyz[3 * v + k];
            low = x < low ? x : low;
            high = x > high ? x : high;
        }
        sum += ((double)high - (double)low) * ((double)high - (double)low);
    }
    return sqrt(sum);
}

/* What is over all frames, and what is relative to the diagonal. */
static void finish(sph_skin_error *errors, uint32_t frame_count, double diagonal)
{
    sph_skin_error all = {0};
    const double percent = diagonal > 0 ? 100 / diagonal : 0;
    for (uint32_t f = 0; f < frame_count; ++f) {
        all.mse += errors[f].mse / frame_count;
        all.rmse += errors[f].rmse * errors[f].rmse / frame_count;
        if (f == 0 || errors[f].max > all.max) {
            all.max = errors[f].max;
            all.max_vertex = errors[f].max_vertex;
            all.max_frame = f;
        }
    }
    all.rmse = sqrt(all.rmse);
    errors[frame_count] = all;
    for (uint32_t f = 0; f <= frame_count; ++f) {
        errors[f].mse *= percent * percent * 1e-4;
        errors[f].rmse_percent = errors[f].rmse * percent;
        errors[f].max_percent = errors[f].max * percent;
        errors[f].diagonal = diagonal;
    }
}

/* `errors` has frame_count + 1 entries. */
static sph_status measure(const sph_skin *skin, const sph_skin_source *sources, size_t source_count,
                          sph_skin_error *errors, sph__progress *progress)
{
    const sph_context *context = skin->context;
    measurement m = {.skin = skin};
    sph_status status = SPH_OK;
    double diagonal = 0;
    uint32_t frame = 0;
    m.areas = sph__alloc(context, skin->vertex_count, sizeof *m.areas);
    m.blocks = sph__alloc(context, skin->vertex_count / BLOCK + 1, sizeof *m.blocks);
    if (m.areas == NULL || m.blocks == NULL) status = sph__fail_memory(context);
    for (size_t s = 0; s < source_count && status == SPH_OK; ++s) {
        const sph_animation *animation = sources[s].animation;
        float *scratch = NULL;
        status = sph__animation_scratch(animation, &scratch);
        for (uint32_t f = 0; f < animation->frame_count && status == SPH_OK; ++f, ++frame) {
            status = sph__progress_report(progress, "measuring", (double)frame / skin->frame_count);
            if (status == SPH_OK) status = sph__animation_frame(animation, f, scratch, &m.xyz);
            if (status == SPH_OK) status = sph__check_finite(context, f, m.xyz, skin->vertex_count);
            if (status != SPH_OK) break;
            m.transforms = skin->transforms + 12 * (size_t)frame * skin->bone_count;
            measure_frame(&m, frame, &errors[frame]);
            diagonal += sph__frame_diagonal(m.xyz, skin->vertex_count) / skin->frame_count;
        }
        sph__free(animation->context, scratch);
    }
    if (status == SPH_OK) finish(errors, skin->frame_count, diagonal);
    sph__free(context, m.areas);
    sph__free(context, m.blocks);
    return status;
}

sph_status sph__skin_check_sources(const sph_context *context, const sph_skin_source *sources, size_t source_count,
                                   uint32_t vertex_count, uint32_t *frame_count)
{
    uint64_t frames = 0;
    if (source_count == 0 || sources == NULL) return sph__fail(context, SPH_E_INVALID, "there are no sources");
    for (size_t s = 0; s < source_count; ++s) {
        const sph_skin_source *source = &sources[s];
        const sph_animation *animation = source->animation;
        SPH__OWN(animation, SPH__ANIMATION);
        if (animation == NULL) return sph__fail(context, SPH_E_INVALID, "the animation of source %zu is NULL", s);
        if (source->animation->vertex_count != vertex_count)
            return sph__fail(context, SPH_E_INVALID, "source %zu has %u vertices, not %u", s,
                             (unsigned)source->animation->vertex_count, (unsigned)vertex_count);
        if (source->animation->triangle_count != sources[0].animation->triangle_count)
            return sph__fail(context, SPH_E_INVALID, "source %zu has %zu triangles, the first has %zu", s,
                             source->animation->triangle_count, sources[0].animation->triangle_count);
        if (!isfinite(source->frames_per_second) || source->frames_per_second < 0)
            return sph__fail(context, SPH_E_INVALID, "source %zu has %g frames per second", s,
                             source->frames_per_second);
        frames += source->animation->frame_count;
        if (frames > INT32_MAX) return sph__fail(context, SPH_E_LIMIT, "more than 2^31 - 1 frames in all sources");
    }
    *frame_count = (uint32_t)frames;
    return SPH_OK;
}

static sph_status allocate_errors(const sph_skin *skin, sph_skin_error **errors)
{
    *errors = sph__alloc(skin->context, (size_t)skin->frame_count + 1, sizeof **errors);
    return *errors == NULL ? sph__fail_memory(skin->context) : SPH_OK;
}

sph_status sph__skin_measure_self(sph_skin *skin, const sph_skin_source *sources, size_t source_count,
                                  sph__progress *progress)
{
    sph_status status = allocate_errors(skin, &skin->errors);
    if (status == SPH_OK) status = measure(skin, sources, source_count, skin->errors, progress);
    return status;
}

sph_status sph_skin_measure(const sph_skin *skin, const sph_skin_source *sources, size_t source_count,
                            sph_skin_error *overall, sph_skin_error *per_frame)
{
    SPH__OWN(skin, SPH__SKIN);
    sph_skin_error *errors = NULL;
    sph__progress progress;
    uint32_t frames;
    sph_status status;
    if (skin == NULL) return SPH_E_INVALID;
    status = sph__skin_check_sources(skin->context, sources, source_count, skin->vertex_count, &frames);
    if (status != SPH_OK) return status;
    if (frames != skin->frame_count)
        return sph__fail(skin->context, SPH_E_INVALID, "the sources have %u frames, the skin has %u", (unsigned)frames,
                         (unsigned)skin->frame_count);
    status = allocate_errors(skin, &errors);
    sph__progress_begin(&progress, skin->context);
    sph__progress_part(&progress, 1);
    if (status == SPH_OK) status = measure(skin, sources, source_count, errors, &progress);
    if (status == SPH_OK && overall != NULL) *overall = errors[frames];
    if (status == SPH_OK && per_frame != NULL) memcpy(per_frame, errors, frames * sizeof *per_frame);
    sph__free(skin->context, errors);
    return status;
}
