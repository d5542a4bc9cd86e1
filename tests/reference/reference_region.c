/* SPDX-License-Identifier: MIT */
#include "reference_region.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef reference_real real;

void *reference_allocate(size_t count, size_t size)
{
    void *memory = calloc(count ? count : 1, size);
    if (memory == NULL) abort();
    return memory;
}

void reference_sphere_create(struct reference_sphere *sphere, uint32_t frame_count)
{
    sphere->centers = reference_allocate(frame_count, sizeof *sphere->centers);
    sphere->radii = reference_allocate(frame_count, sizeof *sphere->radii);
}

void reference_sphere_copy(struct reference_sphere *to, const struct reference_sphere *from, uint32_t frame_count)
{
    memcpy(to->centers, from->centers, frame_count * sizeof *to->centers);
    memcpy(to->radii, from->radii, frame_count * sizeof *to->radii);
}

void reference_sphere_free(struct reference_sphere *sphere)
{
    free(sphere->centers);
    free(sphere->radii);
    *sphere = (struct reference_sphere){0};
}

static void region_allocate(struct region *region, const struct reference_input *input)
{
    *region = (struct region){.alive = true};
    region->frames = reference_allocate(input->frame_count, sizeof *region->frames);
    region->extents = reference_allocate((size_t)input->frame_count * input->direction_count, sizeof *region->extents);
    reference_sphere_create(&region->sphere, input->frame_count);
}

void region_free(struct region *region)
{
    free(region->frames);
    free(region->extents);
    reference_sphere_free(&region->sphere);
    *region = (struct region){0};
}

static void extend(double (*extents)[2], const struct reference_input *input, const real point[3])
{
    for (uint32_t k = 0; k < input->direction_count; ++k) {
        const double *n = input->directions + 3 * (size_t)k;
        const double x = (double)(n[0] * point[0] + n[1] * point[1] + n[2] * point[2]);
        if (x < extents[k][0]) extents[k][0] = x;
        if (x > extents[k][1]) extents[k][1] = x;
    }
}

/* Adds the part that a triangle has in the region of its corner `a`: a third of its plane and area, and one cell. */
static void add_corner(struct region_frame *frame, double (*extents)[2], const struct reference_input *input,
                       const real a[3], const real b[3], const real c[3], real importance)
{
    real n[3], ab[3], ac[3], length, middle_ab[3], middle_ac[3], centroid[3];
    for (int i = 0; i < 3; ++i) {
        ab[i] = b[i] - a[i];
        ac[i] = c[i] - a[i];
        middle_ab[i] = (a[i] + b[i]) / 2;
        middle_ac[i] = (a[i] + c[i]) / 2;
        centroid[i] = (a[i] + b[i] + c[i]) / 3;
    }
    extend(extents, input, middle_ab);
    extend(extents, input, middle_ac);
    extend(extents, input, centroid);
    for (int i = 0; i < 3; ++i)
        n[i] = ab[(i + 1) % 3] * ac[(i + 2) % 3] - ab[(i + 2) % 3] * ac[(i + 1) % 3];
    length = sqrtl(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (length > 0) {
        const real at_anchor[3] = {0, 0, 0}, third = length / 2 / 3;
        for (int i = 0; i < 3; ++i)
            n[i] /= length;
        reference_quadric_add_plane(&frame->quadric, at_anchor, n, third * importance);
        frame->area += third;
    }
}

static void read_position(const struct reference_input *input, uint32_t frame, uint32_t vertex, real out[3])
{
    for (int i = 0; i < 3; ++i)
        out[i] = input->positions[((size_t)frame * input->vertex_count + vertex) * 3 + i];
}

static bool is_triangle(const uint32_t *t)
{
    return t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
}

void region_create_leaf(struct region *region, const struct reference_input *input, uint32_t vertex)
{
    region_allocate(region, input);
    for (uint32_t f = 0; f < input->frame_count; ++f) {
        struct region_frame *frame = &region->frames[f];
        double(*extents)[2] = region->extents + (size_t)f * input->direction_count;
        const real importance = input->importance ? input->importance[(size_t)f * input->vertex_count + vertex] : 1;
        read_position(input, f, vertex, frame->anchor);
        for (int i = 0; i < 3; ++i)
            region->sphere.centers[f][i] = (double)frame->anchor[i];
        for (uint32_t k = 0; k < input->direction_count; ++k) {
            extents[k][0] = HUGE_VAL;
            extents[k][1] = -HUGE_VAL;
        }
        extend(extents, input, frame->anchor);
        for (size_t t = 0; t < input->triangle_count; ++t) {
            const uint32_t *corners = input->triangles + 3 * t;
            for (int i = 0; i < 3 && is_triangle(corners); ++i) {
                real b[3], c[3];
                if (corners[i] != vertex) continue;
                read_position(input, f, corners[(i + 1) % 3], b);
                read_position(input, f, corners[(i + 2) % 3], c);
                add_corner(frame, extents, input, frame->anchor, b, c, importance);
            }
        }
    }
}

void region_unite(struct region *w, const struct region *u, const struct region *v, const struct reference_input *input)
{
    region_allocate(w, input);
    for (uint32_t f = 0; f < input->frame_count; ++f) {
        struct region_frame *frame = &w->frames[f];
        const struct region_frame *other = &v->frames[f];
        real d[3];
        *frame = u->frames[f];
        for (int i = 0; i < 3; ++i) {
            d[i] = other->anchor[i] - frame->anchor[i];
            frame->moment[i] += other->moment[i] + other->area * d[i];
        }
        frame->area += other->area;
        reference_quadric_add(&frame->quadric, &other->quadric, d);
    }
    for (size_t k = 0; k < (size_t)input->frame_count * input->direction_count; ++k) {
        w->extents[k][0] = fmin(u->extents[k][0], v->extents[k][0]);
        w->extents[k][1] = fmax(u->extents[k][1], v->extents[k][1]);
    }
}

double region_width(const struct region *region, const struct reference_input *input, uint32_t frame)
{
    double width = HUGE_VAL;
    for (uint32_t k = 0; k < input->direction_count; ++k) {
        const double *extent = region->extents[(size_t)frame * input->direction_count + k];
        width = fmin(width, extent[1] - extent[0]);
    }
    return width;
}

double region_radius_bound(const struct region *region, const struct reference_input *input, uint32_t frame)
{
    double width;
    if (input->radius_mode == REFERENCE_RADIUS_ZERO) return 0;
    width = region_width(region, input, frame);
    if (input->radius_mode == REFERENCE_RADIUS_CONSTANT)
        for (uint32_t f = 0; f < input->frame_count; ++f)
            width = fmin(width, region_width(region, input, f));
    return input->radius_factor * width;
}

struct reference_quadric region_candidate_quadric(const struct region *region, const struct reference_input *input,
                                                  uint32_t frame)
{
    const struct region_frame *r = &region->frames[frame];
    struct reference_quadric quadric = r->quadric;
    if (input->temporal_coherence > 0 && r->area > 0) {
        const real mean[3] = {r->moment[0] / r->area, r->moment[1] / r->area, r->moment[2] / r->area};
        reference_quadric_add_attachment(&quadric, mean, input->temporal_coherence * r->area);
    }
    return quadric;
}

static void to_anchor(const struct region *region, uint32_t frame_count, const struct reference_sphere *sphere,
                      real (*out)[3])
{
    for (uint32_t f = 0; f < frame_count; ++f)
        for (int i = 0; i < 3; ++i)
            out[f][i] = sphere->centers[f][i] - region->frames[f].anchor[i];
}

real region_fit(const struct region *region, const struct reference_input *input, const struct reference_sphere *u,
                const struct reference_sphere *v, struct reference_sphere *sphere, size_t *degenerate_frames)
{
    const uint32_t frame_count = input->frame_count;
    const bool per_frame = input->radius_mode == REFERENCE_RADIUS_PER_FRAME;
    const uint32_t step = per_frame ? 1 : frame_count; /* frames that make one problem */
    struct reference_quadric *quadrics = reference_allocate(frame_count, sizeof *quadrics);
    real(*at_u)[3] = reference_allocate(frame_count, sizeof *at_u);
    real(*at_v)[3] = reference_allocate(frame_count, sizeof *at_v);
    real(*centers)[3] = reference_allocate(frame_count, sizeof *centers);
    real cost = 0;
    *degenerate_frames = 0;
    to_anchor(region, frame_count, u, at_u);
    to_anchor(region, frame_count, v, at_v);
    for (uint32_t f = 0; f < frame_count; ++f)
        quadrics[f] = region_candidate_quadric(region, input, f);
    for (uint32_t first = 0; first < frame_count; first += step) {
        struct reference_minimum minimum;
        reference_quadric_minimise(quadrics + first, step, at_u + first, at_v + first,
                                   region_radius_bound(region, input, first), &minimum, centers + first);
        cost += minimum.cost;
        *degenerate_frames += minimum.degenerate_frames;
        for (uint32_t f = first; f < first + step; ++f)
            sphere->radii[f] = (double)minimum.radius;
    }
    for (uint32_t f = 0; f < frame_count; ++f)
        for (int i = 0; i < 3; ++i)
            sphere->centers[f][i] = (double)(region->frames[f].anchor[i] + centers[f][i]);
    free(centers);
    free(at_v);
    free(at_u);
    free(quadrics);
    return cost;
}

real region_cost(const struct region *region, uint32_t frame_count, const struct reference_sphere *sphere)
{
    real cost = 0;
    for (uint32_t f = 0; f < frame_count; ++f) {
        real center[3];
        for (int i = 0; i < 3; ++i)
            center[i] = sphere->centers[f][i] - region->frames[f].anchor[i];
        cost += reference_quadric_evaluate(&region->frames[f].quadric, center, sphere->radii[f]);
    }
    return cost > 0 ? cost : 0;
}
