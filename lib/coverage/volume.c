/* SPDX-License-Identifier: MIT */
/* Volumes of a level before and after, by counting the same points. */
#include <float.h>
#include <math.h>

#include "coverage/coverage.h"

enum { MOST_FRAMES = 32, POINTS = 8192 };

typedef struct volume_job {
    const sph__coverage_job *of;
    const sph_level *before;
    uint32_t frame_count; /* frames that are looked at */
    uint32_t first;       /* of the batch */
    double volumes[MOST_FRAMES][2];
} volume_job;

/* Digits of `index` mirrored at the point. */
static double radical_inverse(uint32_t index, uint32_t base)
{
    double value = 0, digit = 1;
    for (; index > 0; index /= base) {
        digit /= base;
        value += digit * (index % base);
    }
    return value;
}

static void bounds(const sph__solid *solid, double low[3], double high[3])
{
    for (int k = 0; k < 3; ++k) {
        low[k] = DBL_MAX;
        high[k] = -DBL_MAX;
    }
    for (uint32_t i = 0; i < solid->primitive_count; ++i)
        for (int k = 0; k < 3; ++k) {
            low[k] = fmin(low[k], (double)solid->boxes[i].low[k]);
            high[k] = fmax(high[k], (double)solid->boxes[i].high[k]);
        }
}

static double count_points(const sph__solid *solid, const double low[3], const double high[3])
{
    static const uint32_t BASES[3] = {2, 3, 5};
    double box = 1;
    uint32_t inside = 0;
    for (int k = 0; k < 3; ++k)
        box *= high[k] - low[k];
    for (uint32_t i = 0; i < POINTS; ++i) {
        double x[3];
        for (int k = 0; k < 3; ++k)
            x[k] = low[k] + (high[k] - low[k]) * radical_inverse(i + 1, BASES[k]);
        inside += sph__solid_covers(solid, x, 0, NULL);
    }
    return box * inside / POINTS;
}

static void count_frames(void *argument, size_t begin, size_t end)
{
    volume_job *v = argument;
    for (size_t i = begin; i < end; ++i) {
        sph__solid *solid = &v->of->slots[i].solid;
        const uint32_t number = v->first + (uint32_t)i;
        const uint32_t frame = (uint32_t)((uint64_t)number * v->before->frame_count / v->frame_count);
        const float *centers = sph__level_centers(v->before, frame);
        double low[3], high[3];
        sph__solid_pose(solid, centers, sph__level_radii(v->of->level, frame), 0);
        bounds(solid, low, high);
        v->volumes[number][1] = count_points(solid, low, high);
        sph__solid_pose(solid, centers, sph__level_radii(v->before, frame), 0);
        v->volumes[number][0] = count_points(solid, low, high);
    }
}

sph_status sph__coverage_volumes(sph__coverage_job *j, const sph_level *before, double *volume_before,
                                 double *volume_after)
{
    volume_job v = {.of = j, .before = before};
    double sums[2] = {0, 0};
    v.frame_count = before->frame_count < MOST_FRAMES ? before->frame_count : MOST_FRAMES;
    for (; v.first < v.frame_count; v.first += j->slot_count) {
        const uint32_t left = v.frame_count - v.first, count = left < j->slot_count ? left : j->slot_count;
        const sph_status status = sph__progress_report(&j->progress, "volume", v.first / (double)v.frame_count);
        if (status != SPH_OK) return status;
        sph__parallel_for(j->context, count, 1, count_frames, &v);
    }
    for (uint32_t i = 0; i < v.frame_count; ++i)
        for (int k = 0; k < 2; ++k)
            sums[k] += v.volumes[i][k] / v.frame_count;
    *volume_before = sums[0];
    *volume_after = sums[1];
    return SPH_OK;
}
