/* SPDX-License-Identifier: MIT */
/* The frames of the input as decimation wants them: all frames of a vertex side by side. */
#include <math.h>

#include "hierarchy/build.h"
#include "hierarchy/lanes.h"

/* The squares of coordinates, and of their differences, stay within 32 bits. */
#define COORDINATE_LIMIT 1e18f

/* Frames on their way to the vertices' rows: several at once, so that each row is passed a few times only. */
enum { BATCH_FRAMES = 64, BATCH_GRAIN = 256, GROUP = 3 * SPH__LANES };

typedef struct batch {
    sph__builder *b;
    float *pulled; /* [BATCH_FRAMES][n][3]: frames that the animation does not hold */
    const float *xyz[BATCH_FRAMES];
    uint32_t first, count;
    double diagonals[BATCH_FRAMES]; /* of bounding boxes */
    float largest[BATCH_FRAMES];    /* coordinates without sign */
    uint8_t refused[BATCH_FRAMES];  /* some coordinate is beyond the limit, or no number */
    double factor;                  /* that brings the first batch near size 1 */
} batch;

/* Eight vertices at a time; how they end up in lanes makes no difference to what is least and greatest. */
SPH__CLONES static int find_box(const float *xyz, size_t n, float low[3], float high[3])
{
    float least[GROUP], most[GROUP];
    int32_t beyond[GROUP] = {0}, any = 0;
    size_t i = 0;
    for (size_t k = 0; k < GROUP; ++k) least[k] = most[k] = xyz[k % 3];
    for (; i + SPH__LANES <= n; i += SPH__LANES)
        for (size_t k = 0; k < GROUP; ++k) {
            const float x = xyz[3 * i + k];
            beyond[k] |= !(fabsf(x) <= COORDINATE_LIMIT);
            least[k] = x < least[k] ? x : least[k];
            most[k] = x > most[k] ? x : most[k];
        }
    for (; i < n; ++i)
        for (size_t k = 0; k < 3; ++k) {
            const float x = xyz[3 * i + k];
            beyond[k] |= !(fabsf(x) <= COORDINATE_LIMIT);
            least[k] = x < least[k] ? x : least[k];
            most[k] = x > most[k] ? x : most[k];
        }
    for (size_t k = 0; k < 3; ++k) {
        low[k] = least[k];
        high[k] = most[k];
    }
    for (size_t k = 0; k < GROUP; ++k) {
        low[k % 3] = least[k] < low[k % 3] ? least[k] : low[k % 3];
        high[k % 3] = most[k] > high[k % 3] ? most[k] : high[k % 3];
        any |= beyond[k];
    }
    return any;
}

static void measure_frames(void *argument, size_t begin, size_t end)
{
    batch *frames = argument;
    for (size_t f = begin; f < end; ++f) {
        float low[3], high[3];
        double squared = 0;
        frames->refused[f] = find_box(frames->xyz[f], frames->b->n, low, high) != 0;
        frames->largest[f] = 0;
        for (size_t k = 0; k < 3; ++k) {
            squared += ((double)high[k] - low[k]) * ((double)high[k] - low[k]);
            frames->largest[f] = fmaxf(frames->largest[f], fmaxf(fabsf(low[k]), fabsf(high[k])));
        }
        frames->diagonals[f] = sqrt(squared);
    }
}

static void scatter_vertices(void *argument, size_t begin, size_t end)
{
    const batch *frames = argument;
    const sph__builder *b = frames->b;
    const size_t s = b->stride;
    for (size_t v = begin; v < end; ++v) {
        float *row = b->h->centers + v * b->node_floats + frames->first;
        for (size_t f = 0; f < frames->count; ++f) {
            const float *xyz = frames->xyz[f] + 3 * v;
            row[f] = (float)(xyz[0] * frames->factor);
            row[s + f] = (float)(xyz[1] * frames->factor);
            row[2 * s + f] = (float)(xyz[2] * frames->factor);
        }
        /* Padding: zeros, so that its matrices are zero. */
        for (size_t f = frames->first + frames->count == b->frames ? frames->count : s; f + frames->first < s; ++f)
            row[f] = row[s + f] = row[2 * s + f] = 0;
    }
}

/* Says what is wrong with a frame. */
static sph_status refuse_frame(const sph__builder *b, uint32_t frame, const float *xyz)
{
    const sph_status status = sph__check_finite(b->context, frame, xyz, b->n);
    size_t i = 0;
    if (status != SPH_OK) return status;
    while (fabsf(xyz[i]) <= COORDINATE_LIMIT) ++i;
    return sph__fail(b->context, SPH_E_INVALID, "frame %u, vertex %zu: coordinate %g is beyond +-%g", frame, i / 3,
                     (double)xyz[i], (double)COORDINATE_LIMIT);
}

/* Most often the size of the first frames is that of all: then coordinates are scaled on their way. By a factor that takes
 * none of them beyond what a float holds. */
static void guess_size(batch *frames, double diagonal, double largest)
{
    enum { LEAST_EXPONENT = -60 };
    const int exponent = sph__size_exponent(diagonal, largest);
    frames->b->size_exponent = exponent < LEAST_EXPONENT ? LEAST_EXPONENT : exponent;
    frames->factor = ldexp(1.0, -frames->b->size_exponent);
}

/* Sends a batch off. */
static sph_status finish_batch(batch *frames, double *diagonals, float *largest)
{
    const sph__builder *b = frames->b;
    sph__parallel_for(b->context, frames->count, 1, measure_frames, frames);
    for (uint32_t f = 0; f < frames->count; ++f) {
        if (frames->refused[f]) return refuse_frame(b, frames->first + f, frames->xyz[f]);
        *diagonals += frames->diagonals[f];
        *largest = fmaxf(*largest, frames->largest[f]);
    }
    if (frames->first == 0) guess_size(frames, *diagonals / frames->count, (double)*largest);
    sph__parallel_for(b->context, b->n, BATCH_GRAIN, scatter_vertices, frames);
    frames->first += frames->count;
    frames->count = 0;
    return SPH_OK;
}

sph_status sph__load_frames(sph__builder *b)
{
    const size_t pitch = 3 * (size_t)b->n;
    float largest = 0;
    double diagonals = 0;
    batch frames = {.b = b};
    sph_status status = SPH_OK;
    if (b->animation->positions == NULL) {
        frames.pulled = sph__alloc(b->context, b->frames < BATCH_FRAMES ? b->frames : BATCH_FRAMES, pitch * sizeof(float));
        if (frames.pulled == NULL) return sph__fail_memory(b->context);
    }
    for (uint32_t f = 0; f < b->frames && status == SPH_OK; ++f) {
        float *room = frames.pulled == NULL ? NULL : frames.pulled + frames.count * pitch;
        status = sph__progress_report(&b->progress, "frames", (double)f / b->frames);
        if (status == SPH_OK) status = sph__animation_frame(b->animation, f, room, &frames.xyz[frames.count]);
        if (status != SPH_OK) break;
        if (++frames.count == BATCH_FRAMES || f + 1 == b->frames) status = finish_batch(&frames, &diagonals, &largest);
    }
    sph__free(b->context, frames.pulled);
    if (status == SPH_OK) sph__normalise_size(b, diagonals / b->frames, (double)largest);
    return status;
}
