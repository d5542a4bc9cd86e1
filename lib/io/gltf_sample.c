/* SPDX-License-Identifier: MIT */
/* The value of an animated property at a time. */
#include <math.h>

#include "io/gltf.h"

/* From quaternion a to b by the shorter way, at constant speed. */
static void slerp(const float *a, const float *b, double t, double *out)
{
    double cosine = 0, u = 1 - t, v = t;
    for (int i = 0; i < 4; ++i)
        cosine += (double)a[i] * (double)b[i];
    if (fabs(cosine) < 0.9999999) { /* else straight is as good */
        const double angle = acos(fabs(cosine)), sine = sin(angle);
        u = sin(u * angle) / sine;
        v = sin(v * angle) / sine;
    }
    if (cosine < 0) v = -v;
    for (int i = 0; i < 4; ++i)
        out[i] = u * (double)a[i] + v * (double)b[i];
}

/* The cubic between two keys, each with its tangents before and after its value. */
static void cubic(const sph__gltf_channel *c, uint32_t k, double t, double step, double *out)
{
    const size_t w = c->width;
    const float *a = c->values + 3 * w * k, *b = a + 3 * w;
    const double t2 = t * t, t3 = t2 * t;
    for (size_t i = 0; i < w; ++i)
        out[i] = (2 * t3 - 3 * t2 + 1) * (double)a[w + i] + step * (t3 - 2 * t2 + t) * (double)a[2 * w + i] +
                 (3 * t2 - 2 * t3) * (double)b[w + i] + step * (t3 - t2) * (double)b[i];
}

static void copy_key(const sph__gltf_channel *c, uint32_t k, double *out)
{
    const bool spline = c->interpolation == SPH__GLTF_CUBIC;
    const float *value = c->values + (spline ? 3 * (size_t)k + 1 : k) * c->width;
    for (uint32_t i = 0; i < c->width; ++i)
        out[i] = (double)value[i];
}

/* The last key that is not after the time; 0 where all are. */
static uint32_t find_key(const sph__gltf_channel *c, double time)
{
    uint32_t low = 0, high = c->key_count;
    while (high - low > 1) {
        const uint32_t middle = low + (high - low) / 2;
        if ((double)c->times[middle] <= time)
            low = middle;
        else
            high = middle;
    }
    return low;
}

void sph__gltf_sample(const sph__gltf_channel *c, double time, double *out)
{
    const uint32_t k = find_key(c, time);
    const double begin = (double)c->times[k], step = k + 1 < c->key_count ? (double)c->times[k + 1] - begin : 0;
    const double t = step > 0 ? (time - begin) / step : 0;
    const float *a = c->values + (size_t)c->width * k, *b = a + c->width;
    if (!(t > 0) || c->interpolation == SPH__GLTF_STEP)
        copy_key(c, k, out);
    else if (c->interpolation == SPH__GLTF_CUBIC)
        cubic(c, k, t, step, out);
    else if (c->path == SPH__GLTF_ROTATION)
        slerp(a, b, t, out);
    else
        for (uint32_t i = 0; i < c->width; ++i)
            out[i] = (double)a[i] + t * ((double)b[i] - (double)a[i]);
}
