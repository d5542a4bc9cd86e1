/* SPDX-License-Identifier: MIT */
/* The handle: frames, held or pulled from a source, and topology. */
#include <math.h>

#include "animation/animation.h"

enum { COUNT_LIMIT = 0x7fffffff, VERTEX_SIZE = 3 * sizeof(float) };

static void release_source(const sph_frame_source *source)
{
    if (source != NULL && source->destroy != NULL) source->destroy(source->user);
}

/* A handle without frames. */
static sph_status create_empty(sph_context *context, uint32_t vertex_count, uint32_t frame_count, sph_animation **out)
{
    sph_animation *animation;
    if (out == NULL) return sph__fail(context, SPH_E_INVALID, "animation: out is NULL");
    *out = NULL;
    if (context == NULL) return SPH_E_INVALID;
    if (vertex_count < 1 || vertex_count > COUNT_LIMIT)
        return sph__fail(context, SPH_E_INVALID, "animation: %u vertices, must be 1 to %d", (unsigned)vertex_count,
                         COUNT_LIMIT);
    if (frame_count < 1 || frame_count > COUNT_LIMIT)
        return sph__fail(context, SPH_E_INVALID, "animation: %u frames, must be 1 to %d", (unsigned)frame_count,
                         COUNT_LIMIT);
    animation = sph__new(context, sizeof *animation, SPH__ANIMATION);
    if (animation == NULL) return sph__fail_memory(context);
    animation->context = sph__context_retain(context);
    animation->vertex_count = vertex_count;
    animation->frame_count = frame_count;
    *out = animation;
    return SPH_OK;
}

sph_status sph_animation_create(sph_context *context, uint32_t vertex_count, uint32_t frame_count, sph_animation **out)
{
    SPH__OWN(context, SPH__CONTEXT);
    size_t count;
    const sph_status status = create_empty(context, vertex_count, frame_count, out);
    if (status != SPH_OK) return status;
    if (sph__multiply_size(vertex_count, frame_count, &count))
        (*out)->positions = sph__zalloc(context, count, 3 * sizeof(float));
    if ((*out)->positions != NULL) return SPH_OK;
    sph_animation_destroy(*out);
    *out = NULL;
    return sph__fail(context, SPH_E_NOMEM, "out of memory for %u frames of %u vertices", (unsigned)frame_count,
                     (unsigned)vertex_count);
}

sph_status sph_animation_create_from_source(sph_context *context, uint32_t vertex_count, uint32_t frame_count,
                                            const sph_frame_source *source, sph_animation **out)
{
    SPH__OWN(context, SPH__CONTEXT);
    sph_status status;
    if (out != NULL) *out = NULL;
    if (source == NULL || source->read_frame == NULL)
        status = sph__fail(context, SPH_E_INVALID, "animation: the source or its read_frame is NULL");
    else
        status = create_empty(context, vertex_count, frame_count, out);
    if (status == SPH_OK)
        (*out)->source = *source;
    else
        release_source(source);
    return status;
}

void sph_animation_destroy(sph_animation *animation)
{
    SPH__OWN(animation, SPH__ANIMATION);
    sph_context *context;
    if (animation == NULL) return;
    context = animation->context;
    release_source(&animation->source);
    sph__free(context, animation->positions);
    sph__free(context, animation->triangles);
    sph__free(context, animation->edges);
    sph__free(context, animation);
    sph__context_release(context);
}

/* The stride in bytes of `count` rows, 0 made `least`; false where it is too small or spans more than can be addressed.
 */
static bool resolve_stride(size_t *stride, size_t least, size_t count)
{
    size_t span;
    if (*stride == 0) *stride = least;
    return *stride >= least && (count == 0 || (sph__multiply_size(count - 1, *stride, &span) && span <= PTRDIFF_MAX));
}

static void gather(float *to, const char *from, uint32_t n, size_t stride)
{
    if (stride == VERTEX_SIZE)
        memcpy(to, from, (size_t)n * VERTEX_SIZE);
    else
        for (uint32_t i = 0; i < n; ++i)
            memcpy(to + 3 * (size_t)i, from + i * stride, VERTEX_SIZE);
}

/* Whether the last vertex of the last frame is within what can be addressed; fills in strides that were left to us. */
static bool resolve_borrowed(const float *positions, uint32_t n, uint32_t frames, size_t *stride, size_t *frame_stride)
{
    size_t last;
    if ((uintptr_t)positions % sizeof(float) != 0 || !resolve_stride(stride, VERTEX_SIZE, n)) return false;
    if (*frame_stride == 0 && !sph__multiply_size(n, *stride, frame_stride)) return false;
    return *stride % sizeof(float) == 0 && *frame_stride % sizeof(float) == 0 &&
           sph__multiply_size(frames - (size_t)1, *frame_stride, &last) &&
           last <= PTRDIFF_MAX - (n - (size_t)1) * *stride;
}

sph_status sph_animation_create_from_positions(sph_context *context, uint32_t vertex_count, uint32_t frame_count,
                                               const float *positions, size_t stride, size_t frame_stride,
                                               sph_animation **out)
{
    SPH__OWN(context, SPH__CONTEXT);
    const sph_status status = create_empty(context, vertex_count, frame_count, out);
    if (status != SPH_OK) return status;
    if (positions != NULL && resolve_borrowed(positions, vertex_count, frame_count, &stride, &frame_stride)) {
        (*out)->borrowed = (const char *)positions;
        (*out)->stride = stride;
        (*out)->frame_stride = frame_stride;
        return SPH_OK;
    }
    sph_animation_destroy(*out);
    *out = NULL;
    if (positions == NULL) return sph__fail(context, SPH_E_INVALID, "animation: positions are NULL");
    return sph__fail(context, SPH_E_INVALID,
                     "animation: positions are not aligned, or strides of %zu and %zu bytes are out of range", stride,
                     frame_stride);
}

sph_status sph_animation_set_frame(sph_animation *animation, uint32_t frame, const float *xyz, size_t stride)
{
    SPH__OWN(animation, SPH__ANIMATION);
    float *to;
    uint32_t n;
    if (animation == NULL) return SPH_E_INVALID;
    n = animation->vertex_count;
    if (xyz == NULL) return sph__fail(animation->context, SPH_E_INVALID, "frame %u: xyz is NULL", (unsigned)frame);
    if (frame >= animation->frame_count)
        return sph__fail(animation->context, SPH_E_INVALID, "frame %u is not below %u", (unsigned)frame,
                         (unsigned)animation->frame_count);
    if (!resolve_stride(&stride, VERTEX_SIZE, n))
        return sph__fail(animation->context, SPH_E_INVALID, "frame %u: a stride of %zu bytes is out of range",
                         (unsigned)frame, stride);
    if (animation->positions == NULL)
        return sph__fail(animation->context, SPH_E_STATE, "frame %u: the animation does not hold its frames",
                         (unsigned)frame);
    to = animation->positions + (size_t)frame * n * 3;
    gather(to, (const char *)xyz, n, stride);
    return SPH_OK;
}

/* Replaces *simplices by a checked copy of `count` rows of `corners` indices. `what` names a row in messages. */
static sph_status set_simplices(const sph_animation *animation, const char *what, const uint32_t *indices, size_t count,
                                size_t stride, uint32_t corners, uint32_t **simplices)
{
    const sph_context *context = animation->context;
    const size_t tight = corners * sizeof(uint32_t);
    uint32_t *copy = NULL;
    if (indices == NULL && count > 0) return sph__fail(context, SPH_E_INVALID, "%ss: indices are NULL", what);
    if (count > SPH__SIMPLEX_LIMIT)
        return sph__fail(context, SPH_E_LIMIT, "%zu %ss are more than %d", count, what, SPH__SIMPLEX_LIMIT);
    if (!resolve_stride(&stride, tight, count))
        return sph__fail(context, SPH_E_INVALID, "%ss: a stride of %zu bytes is out of range", what, stride);
    if (count > 0 && (copy = sph__alloc(context, count, tight)) == NULL) return sph__fail_memory(context);
    for (size_t i = 0; i < count; ++i) {
        uint32_t *row = copy + corners * i;
        memcpy(row, (const char *)indices + i * stride, tight);
        for (uint32_t k = 0; k < corners; ++k)
            if (row[k] >= animation->vertex_count) {
                const unsigned index = row[k];
                sph__free(context, copy);
                return sph__fail(context, SPH_E_INVALID, "%s %zu names vertex %u, but there are %u", what, i, index,
                                 (unsigned)animation->vertex_count);
            }
    }
    sph__free(context, *simplices);
    *simplices = copy;
    return SPH_OK;
}

sph_status sph_animation_set_triangles(sph_animation *animation, const uint32_t *indices, size_t triangle_count,
                                       size_t stride)
{
    SPH__OWN(animation, SPH__ANIMATION);
    sph_status status;
    if (animation == NULL) return SPH_E_INVALID;
    status = set_simplices(animation, "triangle", indices, triangle_count, stride, 3, &animation->triangles);
    if (status == SPH_OK) animation->triangle_count = triangle_count;
    return status;
}

sph_status sph_animation_set_edges(sph_animation *animation, const uint32_t *indices, size_t edge_count, size_t stride)
{
    SPH__OWN(animation, SPH__ANIMATION);
    sph_status status;
    if (animation == NULL) return SPH_E_INVALID;
    status = set_simplices(animation, "edge", indices, edge_count, stride, 2, &animation->edges);
    if (status == SPH_OK) animation->edge_count = edge_count;
    return status;
}

uint32_t sph_animation_vertex_count(const sph_animation *animation)
{
    SPH__OWN(animation, SPH__ANIMATION);
    return animation == NULL ? 0 : animation->vertex_count;
}

uint32_t sph_animation_frame_count(const sph_animation *animation)
{
    SPH__OWN(animation, SPH__ANIMATION);
    return animation == NULL ? 0 : animation->frame_count;
}

size_t sph_animation_triangle_count(const sph_animation *animation)
{
    SPH__OWN(animation, SPH__ANIMATION);
    return animation == NULL ? 0 : animation->triangle_count;
}

size_t sph_animation_edge_count(const sph_animation *animation)
{
    SPH__OWN(animation, SPH__ANIMATION);
    return animation == NULL ? 0 : animation->edge_count;
}

const uint32_t *sph_animation_triangles(const sph_animation *animation)
{
    SPH__OWN(animation, SPH__ANIMATION);
    return animation == NULL ? NULL : animation->triangles;
}

const uint32_t *sph_animation_edges(const sph_animation *animation)
{
    SPH__OWN(animation, SPH__ANIMATION);
    return animation == NULL ? NULL : animation->edges;
}

sph_status sph__animation_scratch(const sph_animation *animation, float **scratch)
{
    *scratch = NULL;
    if (animation->positions != NULL || (animation->borrowed != NULL && animation->stride == VERTEX_SIZE))
        return SPH_OK;
    *scratch = sph__alloc(animation->context, animation->vertex_count, 3 * sizeof(float));
    return *scratch != NULL ? SPH_OK : sph__fail_memory(animation->context);
}

sph_status sph__animation_frame(const sph_animation *animation, uint32_t frame, float *scratch, const float **xyz)
{
    uint64_t stamp;
    sph_status status;
    if (animation->positions != NULL) {
        *xyz = animation->positions + (size_t)frame * animation->vertex_count * 3;
        return SPH_OK;
    }
    *xyz = scratch;
    if (animation->borrowed != NULL) {
        const char *first = animation->borrowed + frame * animation->frame_stride;
        if (animation->stride == VERTEX_SIZE)
            *xyz = (const float *)(const void *)first;
        else
            gather(scratch, first, animation->vertex_count, animation->stride);
        return SPH_OK;
    }
    stamp = sph__message_stamp(animation->context);
    status = animation->source.read_frame(animation->source.user, frame, scratch);
    /* A source that explains itself is not talked over. */
    if (status != SPH_OK && sph__message_stamp(animation->context) == stamp)
        return sph__fail(animation->context, status, "frame %u: the frame source failed: %s", (unsigned)frame,
                         sph_status_text(status));
    return status;
}

sph_status sph__check_finite(const sph_context *context, uint32_t frame, const float *xyz, uint32_t n)
{
    for (uint32_t i = 0; i < n; ++i) {
        const float *v = xyz + 3 * (size_t)i;
        if (!isfinite(v[0]) || !isfinite(v[1]) || !isfinite(v[2]))
            return sph__fail(context, SPH_E_INVALID, "frame %u, vertex %u: the position (%g, %g, %g) is not finite",
                             (unsigned)frame, (unsigned)i, (double)v[0], (double)v[1], (double)v[2]);
    }
    return SPH_OK;
}

sph_status sph_animation_read_frame(const sph_animation *animation, uint32_t frame, float *xyz)
{
    SPH__OWN(animation, SPH__ANIMATION);
    const float *from;
    sph_status status;
    if (animation == NULL) return SPH_E_INVALID;
    if (xyz == NULL) return sph__fail(animation->context, SPH_E_INVALID, "frame %u: xyz is NULL", (unsigned)frame);
    if (frame >= animation->frame_count)
        return sph__fail(animation->context, SPH_E_INVALID, "frame %u is not below %u", (unsigned)frame,
                         (unsigned)animation->frame_count);
    status = sph__animation_frame(animation, frame, xyz, &from);
    if (status == SPH_OK && from != xyz) memcpy(xyz, from, (size_t)animation->vertex_count * 3 * sizeof *xyz);
    return status;
}

static double box_diagonal(const float *xyz, uint32_t n)
{
    double square = 0;
    for (uint32_t k = 0; k < 3; ++k) {
        float low = xyz[k], high = xyz[k];
        for (uint32_t i = 1; i < n; ++i) {
            const float x = xyz[3 * (size_t)i + k];
            low = x < low ? x : low;
            high = x > high ? x : high;
        }
        square += ((double)high - low) * ((double)high - low);
    }
    return sqrt(square);
}

sph_status sph_animation_bounding_diagonal(const sph_animation *animation, double *diagonal)
{
    SPH__OWN(animation, SPH__ANIMATION);
    double sum = 0;
    float *scratch;
    sph_status status;
    if (animation == NULL) return SPH_E_INVALID;
    if (diagonal == NULL) return sph__fail(animation->context, SPH_E_INVALID, "bounding diagonal: diagonal is NULL");
    status = sph__animation_scratch(animation, &scratch);
    for (uint32_t f = 0; status == SPH_OK && f < animation->frame_count; ++f) {
        const float *xyz;
        status = sph__animation_frame(animation, f, scratch, &xyz);
        if (status == SPH_OK) status = sph__check_finite(animation->context, f, xyz, animation->vertex_count);
        if (status == SPH_OK) sum += box_diagonal(xyz, animation->vertex_count);
    }
    if (status == SPH_OK) *diagonal = sum / animation->frame_count;
    sph__free(animation->context, scratch);
    return status;
}
