/* SPDX-License-Identifier: MIT */
/* The report on what tends to be wrong with input. */
#include <math.h>

#include "animation/animation.h"
#include "animation/partition.h"
#include "animation/topology.h"

static const char STAGE[] = "checking frames";
/* Of the work, what topology takes; the rest goes to frames. A guess: it only steers the progress bar. */
static const double TOPOLOGY_SHARE = 0.2;
/* A triangle has no area below this part of the frame's squared diagonal. */
static const double ZERO_AREA = 1e-12;
/* A volume is 0 below this part of the sum of what it is made of. */
static const double ZERO_VOLUME = 1e-12;

enum { REPORT_V1 = offsetof(sph_animation_report, inward_component_count) + sizeof(uint64_t) };
_Static_assert(REPORT_V1 == 128, "a field of 0.1 moved");

/* A signed volume and the sum of its parts' absolute values, times 6. */
typedef struct volume {
    double sum, absolute;
} volume;

typedef struct check {
    const sph_animation *animation;
    sph_animation_report report;
    sph__patches patches;
    sph__partition partition;
    float *scratch;
    volume *frame_volumes, *volumes; /* by patch, of the frame and of all frames */
} check;

void sph_animation_report_init(sph_animation_report *report, size_t size)
{
    const sph_animation_report zero = {0};
    sph__options_init(report, size, &zero, sizeof zero, REPORT_V1);
}

static bool finite_vertex(const float *v)
{
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

/* Counts vertices that are not finite, and returns the squared diagonal of the box around the others. */
static double check_vertices(check *c, uint32_t frame, const float *xyz)
{
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    double square = 0;
    for (uint32_t i = 0; i < c->animation->vertex_count; ++i) {
        const float *v = xyz + 3 * (size_t)i;
        if (!finite_vertex(v)) {
            if (c->report.non_finite_count++ == 0) {
                c->report.first_non_finite_frame = frame;
                c->report.first_non_finite_vertex = i;
            }
            continue;
        }
        for (size_t k = 0; k < 3; ++k) {
            low[k] = v[k] < low[k] ? v[k] : low[k];
            high[k] = v[k] > high[k] ? v[k] : high[k];
        }
    }
    if (low[0] > high[0]) return 0;
    for (size_t k = 0; k < 3; ++k)
        square += ((double)high[k] - low[k]) * ((double)high[k] - low[k]);
    return square;
}

static double triangle_area(const float *a, const float *b, const float *c)
{
    double u[3], v[3];
    for (size_t k = 0; k < 3; ++k) {
        u[k] = (double)b[k] - a[k];
        v[k] = (double)c[k] - a[k];
    }
    const double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
    return 0.5 * sqrt(x * x + y * y + z * z);
}

static void check_areas(check *c, uint32_t frame, const float *xyz, double square)
{
    for (size_t t = 0; t < c->animation->triangle_count; ++t) {
        const uint32_t *v = c->animation->triangles + 3 * t;
        const float *corners[3] = {xyz + 3 * (size_t)v[0], xyz + 3 * (size_t)v[1], xyz + 3 * (size_t)v[2]};
        /* not finite: neither at most nor above */
        if (!(triangle_area(corners[0], corners[1], corners[2]) <= ZERO_AREA * square)) continue;
        if (c->report.zero_area_count++ == 0) {
            c->report.first_zero_area_frame = frame;
            c->report.first_zero_area_triangle = (uint32_t)t;
        }
    }
}

/*
 * Adds the frame's volumes of closed patches. Each patch is measured from its own lowest vertex, for far from the
 * origin the parts would swamp the sum. A patch with a vertex that is not finite is left out in this frame.
 */
static void add_volumes(check *c, const float *xyz)
{
    const uint32_t n = c->animation->vertex_count;
    memset(c->frame_volumes, 0, n * sizeof *c->frame_volumes);
    for (size_t t = 0; t < c->animation->triangle_count; ++t) {
        const uint32_t *v = c->animation->triangles + 3 * t;
        const uint32_t patch = c->patches.of[v[0]];
        double p[3][3], part;
        if (c->patches.closed[patch] == 0 || sph__names_vertex_twice(v, 3)) continue;
        for (size_t k = 0; k < 9; ++k)
            p[k / 3][k % 3] = (double)xyz[3 * (size_t)v[k / 3] + k % 3] - xyz[3 * (size_t)patch + k % 3];
        part = p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) + p[0][1] * (p[1][2] * p[2][0] - p[1][0] * p[2][2]) +
               p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
        c->frame_volumes[patch].sum += part;
        c->frame_volumes[patch].absolute += fabs(part);
    }
    for (uint32_t i = 0; i < n; ++i)
        if (isfinite(c->frame_volumes[i].absolute)) {
            c->volumes[i].sum += c->frame_volumes[i].sum;
            c->volumes[i].absolute += c->frame_volumes[i].absolute;
        }
}

static sph_status check_frames(check *c, sph__progress *progress)
{
    const sph_animation *a = c->animation;
    for (uint32_t f = 0; f < a->frame_count; ++f) {
        const float *xyz;
        double square;
        sph_status status = sph__progress_report(progress, STAGE, (double)f / a->frame_count);
        if (status == SPH_OK) status = sph__animation_frame(a, f, c->scratch, &xyz);
        if (status != SPH_OK) return status;
        square = check_vertices(c, f, xyz);
        check_areas(c, f, xyz, square);
        add_volumes(c, xyz);
        sph__partition_refine(&c->partition, xyz, 0);
    }
    return sph__progress_report(progress, STAGE, 1);
}

static void count_inward(check *c)
{
    for (uint32_t i = 0; i < c->animation->vertex_count; ++i)
        if (c->volumes[i].sum < -ZERO_VOLUME * c->volumes[i].absolute) ++c->report.inward_component_count;
}

static void count_coincident(check *c)
{
    const sph__partition *p = &c->partition;
    for (uint32_t begin = 0, end; begin < p->member_count; begin = end) {
        end = sph__group_end(p, begin);
        c->report.coincident_vertex_count += end - begin - 1;
    }
}

static sph_status check_positions(check *c, sph__progress *progress)
{
    const sph_animation *a = c->animation;
    sph_status status = sph__partition_init(&c->partition, a->context, a->vertex_count);
    if (status == SPH_OK) status = sph__animation_scratch(a, &c->scratch);
    if (status != SPH_OK) return status;
    c->frame_volumes = sph__alloc(a->context, a->vertex_count, sizeof *c->frame_volumes);
    c->volumes = sph__zalloc(a->context, a->vertex_count, sizeof *c->volumes);
    if (c->frame_volumes == NULL || c->volumes == NULL) return sph__fail_memory(a->context);
    status = check_frames(c, progress);
    if (status != SPH_OK) return status;
    count_inward(c);
    count_coincident(c);
    return SPH_OK;
}

static void free_check(check *c)
{
    const sph_context *context = c->animation->context;
    sph__patches_free(context, &c->patches);
    sph__partition_free(&c->partition);
    sph__free(context, c->scratch);
    sph__free(context, c->frame_volumes);
    sph__free(context, c->volumes);
}

sph_status sph_animation_check(const sph_animation *animation, sph_animation_report *report)
{
    SPH__OWN(animation, SPH__ANIMATION);
    check c = {.animation = animation};
    sph__progress progress;
    sph_status status;
    uint32_t size;
    if (animation == NULL) return SPH_E_INVALID;
    if (report == NULL) return sph__fail(animation->context, SPH_E_INVALID, "check: report is NULL");
    size = report->struct_size;
    if (size < REPORT_V1)
        return sph__fail(animation->context, SPH_E_INVALID,
                         "sph_animation_report was not initialised: struct_size is %u, at least %d is needed",
                         (unsigned)size, REPORT_V1);
    c.partition.context = animation->context;
    sph__progress_begin(&progress, animation->context);
    sph__progress_part(&progress, TOPOLOGY_SHARE);
    status = sph__topology_count(animation, &c.report, &c.patches, &progress);
    sph__progress_part(&progress, 1 - TOPOLOGY_SHARE);
    if (status == SPH_OK) status = check_positions(&c, &progress);
    if (status == SPH_OK) sph__options_init(report, size, &c.report, sizeof c.report, REPORT_V1);
    free_check(&c);
    return status;
}
