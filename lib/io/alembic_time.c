/* SPDX-License-Identifier: MIT */
/* Times: of samples, and of the frames that are taken from them. */
#include <math.h>
#include <string.h>

#include "io/alembic.h"
#include "io/bytes.h"

enum { FRAME_LIMIT = 1 << 22 };

/* Times that are one, in seconds; and shares of the way between two samples that are none. */
static const double SAME_TIME = 1e-6, SAME_PLACE = 1e-6;
/* Seconds; below it times and their differences keep their digits. */
static const double TIME_LIMIT = 1e12;
/* A time that is a whole number of frames, but for rounding, has its last frame. */
static const double FRAME_TOLERANCE = 1e-3;

static double stored_time(const sph__abc_sampling *s, uint32_t i)
{
    return sph__io_load_double(s->times + 8 * (size_t)i, false);
}

double sph__abc_time(const sph__abc_sampling *s, uint32_t i)
{
    if (isinf(s->period)) return stored_time(s, i);
    return stored_time(s, i % s->count) + s->period * (i / s->count);
}

static sph_status fail(const sph__abc_file *f, const sph__abc_property *p, const char *what)
{
    return sph__abc_fail(f, p->group.place, "time sampling %u of a property of %u samples: %s", (unsigned)p->sampling,
                         (unsigned)p->sample_count, what);
}

const char *sph__abc_sampling_fault(const sph__abc_sampling *s)
{
    if (s->count == 0) return "it has no times";
    if (!(s->period > 0)) return "its period is not above 0";
    for (uint32_t i = 0; i < s->count; ++i) {
        const double time = stored_time(s, i);
        if (!(fabs(time) < TIME_LIMIT)) return "a time that is no number, or too large";
        if (i > 0 && !(time > stored_time(s, i - 1))) return "its times do not ascend";
        if (!(time - stored_time(s, 0) < s->period)) return "its times exceed its period";
    }
    return NULL;
}

sph_status sph__abc_check_sampling(const sph__abc_file *f, const sph__abc_property *p)
{
    const sph__abc_sampling *s;
    if (p->sampling >= f->sampling_count) return fail(f, p, "it is not there");
    s = &f->samplings[p->sampling];
    if (s->fault != NULL) return fail(f, p, s->fault);
    if (isinf(s->period) && s->count < p->sample_count) return fail(f, p, "it has too few times");
    if (!isinf(s->period) && !(s->period * p->sample_count < TIME_LIMIT)) return fail(f, p, "its times are too large");
    return SPH_OK;
}

uint32_t sph__abc_locate(const sph__abc_file *f, const sph__abc_property *p, double time, double *share)
{
    const sph__abc_sampling *s = &f->samplings[p->sampling];
    uint32_t low = 0, high = p->sample_count; /* low is at or before the time, or the first */
    double from, to;
    *share = 0;
    while (high - low > 1) {
        const uint32_t middle = low + (high - low) / 2;
        if (sph__abc_time(s, middle) <= time)
            low = middle;
        else
            high = middle;
    }
    if (low + 1 >= p->sample_count) return low;
    from = sph__abc_time(s, low);
    to = sph__abc_time(s, low + 1);
    *share = time <= from ? 0 : (time - from) / (to - from);
    if (*share < SAME_PLACE) *share = 0;
    if (*share <= 1 - SAME_PLACE) return low;
    *share = 0;
    return low + 1;
}

sph_status sph__abc_frames_start(sph__abc_file *f, sph__abc_frames *frames)
{
    sph_status status;
    *frames = (sph__abc_frames){.single = SPH__ABC_NONE};
    status = sph__abc_charge(f, f->sampling_count, sizeof *frames->counts);
    if (status != SPH_OK) return status;
    frames->counts = sph_context_allocate(f->context, f->sampling_count + (size_t)1, sizeof *frames->counts);
    if (frames->counts == NULL) return sph__io_fail_memory(f->context, f->path);
    memset(frames->counts, 0, (f->sampling_count + (size_t)1) * sizeof *frames->counts);
    return SPH_OK;
}

void sph__abc_frames_add(sph__abc_frames *frames, const sph__abc_property *p)
{
    if (sph__abc_stored_count(p) > 1 && frames->counts[p->sampling] < p->sample_count)
        frames->counts[p->sampling] = p->sample_count;
}

static sph_status fail_limit(const sph__abc_file *f)
{
    return sph__io_fail(f->context, SPH_E_LIMIT, "%s: more than %d frames", sph__io_shown(f->path), FRAME_LIMIT);
}

/* The least time of a sample that is after `time`; infinite where there is none. */
static double next_time(const sph__abc_file *f, const sph__abc_frames *frames, double time)
{
    double next = (double)INFINITY;
    for (uint32_t i = 0; i < f->sampling_count; ++i) {
        const sph__abc_sampling *s = &f->samplings[i];
        uint32_t low = 0, high = frames->counts[i];
        while (low < high) {
            const uint32_t middle = low + (high - low) / 2;
            if (sph__abc_time(s, middle) > time)
                high = middle;
            else
                low = middle + 1;
        }
        if (low < frames->counts[i] && sph__abc_time(s, low) < next) next = sph__abc_time(s, low);
    }
    return next;
}

/* Frames where any of several samplings has a sample. */
static sph_status merge(sph__abc_file *f, sph__abc_frames *frames)
{
    double time = next_time(f, frames, -(double)INFINITY);
    while (!isinf(time)) {
        void *memory = frames->times;
        sph_status status = sph__abc_charge(f, 1, 2 * sizeof time);
        if (status == SPH_OK) status = sph__abc_charge_work(f, 64 * (uint64_t)f->sampling_count);
        if (status != SPH_OK) return status;
        if (frames->count == FRAME_LIMIT) return fail_limit(f);
        if (!sph__io_reserve(f->context, &memory, &frames->time_capacity, frames->count + (size_t)1, sizeof time))
            return sph__io_fail_memory(f->context, f->path);
        frames->times = memory;
        frames->times[frames->count++] = time;
        time = next_time(f, frames, time + SAME_TIME);
    }
    return SPH_OK;
}

sph_status sph__abc_frames_finish(sph__abc_file *f, sph__abc_frames *frames, double fps, double still)
{
    uint32_t kinds = 0;
    frames->start = frames->end = still;
    frames->fps = fps;
    frames->count = 1;
    for (uint32_t i = 0; i < f->sampling_count; ++i) {
        double first, last;
        if (frames->counts[i] == 0) continue;
        first = sph__abc_time(&f->samplings[i], 0);
        last = sph__abc_time(&f->samplings[i], frames->counts[i] - 1);
        if (kinds == 0 || first < frames->start) frames->start = first;
        if (kinds == 0 || last > frames->end) frames->end = last;
        frames->single = i;
        ++kinds;
    }
    if (kinds == 0) return SPH_OK;
    if (fps > 0) {
        const double count = floor((frames->end - frames->start) * fps + FRAME_TOLERANCE) + 1;
        if (!(count <= FRAME_LIMIT)) return fail_limit(f);
        frames->count = (uint32_t)count;
    } else if (kinds == 1) {
        frames->count = frames->counts[frames->single];
        if (frames->count > FRAME_LIMIT) return fail_limit(f);
    } else {
        frames->single = SPH__ABC_NONE;
        frames->count = 0;
        return merge(f, frames);
    }
    return SPH_OK;
}

double sph__abc_frame_time(const sph__abc_file *f, const sph__abc_frames *frames, uint32_t frame)
{
    if (frames->times != NULL) return frames->times[frame];
    if (frames->fps > 0) return fmin(frames->start + frame / frames->fps, frames->end);
    return frames->single == SPH__ABC_NONE ? frames->start : sph__abc_time(&f->samplings[frames->single], frame);
}

void sph__abc_frames_release(const sph__abc_file *f, sph__abc_frames *frames)
{
    sph_context_release(f->context, frames->counts);
    sph_context_release(f->context, frames->times);
    frames->counts = NULL;
    frames->times = NULL;
}
