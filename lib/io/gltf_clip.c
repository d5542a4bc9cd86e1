/* SPDX-License-Identifier: MIT */
/* Clips: how long they are, which are played, and the keys of their channels. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "io/gltf.h"

/* Frames of one clip: more is a damaged time rather than an animation. */
enum { FRAME_LIMIT = 1 << 22 };

/* A clip whose length is a whole number of frames, but for rounding, has its last frame. */
static const double FRAME_TOLERANCE = 1e-3;

uint32_t sph__gltf_frames_of(const sph__gltf_clip *clip, double fps)
{
    const double frames = floor(clip->duration * fps + FRAME_TOLERANCE);
    return frames >= FRAME_LIMIT ? FRAME_LIMIT + 1 : (uint32_t)frames + 1;
}

/* The samplers of a clip, objects of the JSON. */
static sph_status list_samplers(sph__gltf_document *d, uint32_t animation, sph__gltf_list *list)
{
    uint32_t array, value;
    sph_status status = sph__gltf_get_kind(d, animation, "samplers", '[', &array);
    *list = (sph__gltf_list){NULL, 0};
    if (status != SPH_OK || array == 0) return status;
    status = sph__gltf_allocate(d, d->values[array].count, sizeof *list->values, &list->values);
    if (status != SPH_OK) return status;
    list->count = d->values[array].count;
    value = array + 1;
    for (uint32_t i = 0; i < list->count; ++i, value = d->values[value].next)
        list->values[i] = value;
    return SPH_OK;
}

static sph_status open_part(sph__gltf_document *d, uint32_t sampler, const char *name, uint32_t width,
                            sph__gltf_accessor *a)
{
    uint32_t index;
    const sph_status status = sph__gltf_get_index(d, sampler, name, SPH__GLTF_ACCESSORS, &index);
    if (status != SPH_OK) return status;
    if (index == SPH__GLTF_NONE) return sph__gltf_fail(d, sampler, "a sampler without %s", name);
    return sph__gltf_accessor_open(d, index, width, a);
}

static sph_status open_times(sph__gltf_document *d, uint32_t sampler, sph__gltf_accessor *a)
{
    const sph_status status = open_part(d, sampler, "input", 1, a);
    if (status == SPH_OK && a->type != SPH__GLTF_F32) return sph__gltf_fail(d, a->value, "times that are not floats");
    return status;
}

/* The time of the last key of all. */
static sph_status measure_clip(sph__gltf_document *d, uint32_t animation, double *duration)
{
    uint32_t array, sampler;
    sph_status status = sph__gltf_get_kind(d, animation, "samplers", '[', &array);
    *duration = 0;
    if (status != SPH_OK || array == 0) return status;
    sampler = array + 1;
    for (uint32_t i = 0; i < d->values[array].count; ++i, sampler = d->values[sampler].next) {
        sph__gltf_accessor times;
        float last;
        if ((status = open_times(d, sampler, &times)) != SPH_OK) return status;
        sph__gltf_accessor_floats(&times, times.count - 1, &last);
        if (!isfinite(last)) return sph__gltf_fail(d, times.value, "key %u has no time", (unsigned)times.count - 1);
        if ((double)last > *duration) *duration = (double)last;
    }
    return SPH_OK;
}

sph_status sph__gltf_read_clips(sph__gltf_document *d, sph__io_gltf *g)
{
    const uint32_t count = d->lists[SPH__GLTF_ANIMATIONS].count;
    sph_status status = sph__gltf_allocate(d, count, sizeof *g->clips, &g->clips);
    for (; g->clip_count < count && status == SPH_OK;) {
        const uint32_t object = d->lists[SPH__GLTF_ANIMATIONS].values[g->clip_count];
        sph__gltf_clip *clip = &g->clips[g->clip_count];
        uint32_t name;
        if ((status = sph__gltf_get_kind(d, object, "name", '"', &name)) != SPH_OK) return status;
        *clip = (sph__gltf_clip){NULL, 0};
        ++g->clip_count;
        if (name != 0)
            status = sph__gltf_copy_text(d, name, &clip->name);
        else if ((clip->name = sph__io_copy_string(d->context, "")) == NULL)
            status = sph__io_fail_memory(d->context, d->path);
        if (status == SPH_OK) status = measure_clip(d, object, &clip->duration);
    }
    return status;
}

/* Which property of which node; node SPH__GLTF_NONE where it is nothing that moves vertices. */
static sph_status read_aim(const sph__gltf_document *d, const sph__io_gltf *g, uint32_t channel, sph__gltf_channel *c)
{
    static const char *const PATHS[] = {"translation", "rotation", "scale", "weights"};
    uint32_t target, path;
    sph_status status = sph__gltf_get_kind(d, channel, "target", '{', &target);
    c->node = SPH__GLTF_NONE;
    if (status != SPH_OK) return status;
    if (target == 0) return sph__gltf_fail(d, channel, "a channel without a target");
    status = sph__gltf_get_kind(d, target, "path", '"', &path);
    for (c->path = 0; c->path < 4 && status == SPH_OK && path != 0; ++c->path)
        if (sph__gltf_is(d, path, PATHS[c->path])) {
            status = sph__gltf_get_index(d, target, "node", SPH__GLTF_NODES, &c->node);
            break;
        }
    if (status != SPH_OK || c->node == SPH__GLTF_NONE) return status;
    if (c->path != SPH__GLTF_WEIGHTS && g->nodes[c->node].has_matrix)
        return sph__gltf_fail(d, target, "node %u has a matrix, and is animated", (unsigned)c->node);
    c->width = c->path == SPH__GLTF_WEIGHTS ? g->nodes[c->node].weight_count : c->path == SPH__GLTF_ROTATION ? 4 : 3;
    if (c->width == 0) c->node = SPH__GLTF_NONE;
    return SPH_OK;
}

static sph_status read_interpolation(const sph__gltf_document *d, uint32_t sampler, sph__gltf_channel *c)
{
    uint32_t value;
    const sph_status status = sph__gltf_get_kind(d, sampler, "interpolation", '"', &value);
    c->interpolation = SPH__GLTF_LINEAR;
    if (status != SPH_OK || value == 0 || sph__gltf_is(d, value, "LINEAR")) return status;
    c->interpolation = sph__gltf_is(d, value, "STEP") ? SPH__GLTF_STEP : SPH__GLTF_CUBIC;
    if (c->interpolation == SPH__GLTF_CUBIC && !sph__gltf_is(d, value, "CUBICSPLINE"))
        return sph__gltf_fail(d, value, "an interpolation that is not known");
    return SPH_OK;
}

static sph_status read_keys(sph__gltf_document *d, uint32_t sampler, sph__gltf_channel *c)
{
    const uint32_t each = c->interpolation == SPH__GLTF_CUBIC ? 3 : 1;
    const uint32_t element = c->path == SPH__GLTF_WEIGHTS ? 1 : c->width;
    sph__gltf_accessor times, values;
    uint64_t count;
    sph_status status = open_times(d, sampler, &times);
    if (status == SPH_OK) status = open_part(d, sampler, "output", element, &values);
    if (status != SPH_OK) return status;
    count = (uint64_t)times.count * each * (c->width / element);
    if (values.count != count)
        return sph__gltf_fail(d, values.value, "%u values for %u keys: %llu are needed", (unsigned)values.count,
                              (unsigned)times.count, (unsigned long long)count);
    c->key_count = times.count;
    status = sph__gltf_allocate(d, times.count, sizeof(float), &c->times);
    if (status == SPH_OK) status = sph__gltf_allocate(d, (size_t)count * element, sizeof(float), &c->values);
    if (status != SPH_OK) return status;
    for (uint32_t i = 0; i < times.count; ++i) {
        sph__gltf_accessor_floats(&times, i, &c->times[i]);
        if (!isfinite(c->times[i]) || (i > 0 && c->times[i] < c->times[i - 1]))
            return sph__gltf_fail(d, times.value, "key %u is before the one before it, or has no time", (unsigned)i);
    }
    for (uint32_t i = 0; i < values.count; ++i)
        sph__gltf_accessor_floats(&values, i, c->values + (size_t)i * element);
    return SPH_OK;
}

static sph_status read_channel(sph__gltf_document *d, sph__io_gltf *g, const sph__gltf_list *samplers, uint32_t channel)
{
    sph__gltf_channel c = {.times = NULL}, *kept;
    uint64_t index = UINT64_MAX;
    uint32_t sampler;
    sph_status status = read_aim(d, g, channel, &c);
    if (status != SPH_OK || c.node == SPH__GLTF_NONE) return status;
    if ((status = sph__gltf_get_unsigned(d, channel, "sampler", &index)) != SPH_OK) return status;
    if (index >= samplers->count) return sph__gltf_fail(d, channel, "a channel without a sampler");
    sampler = samplers->values[index];
    if ((status = read_interpolation(d, sampler, &c)) != SPH_OK) return status;
    status = sph__gltf_push(d, &g->channels, &g->channel_capacity, g->channel_count, sizeof *g->channels);
    if (status != SPH_OK) return status;
    kept = &g->channels[g->channel_count++];
    *kept = c;
    return read_keys(d, sampler, kept);
}

static sph_status add_run(sph__gltf_document *d, sph__io_gltf *g, uint32_t clip)
{
    const uint32_t animation = d->lists[SPH__GLTF_ANIMATIONS].values[clip];
    sph__gltf_run *run = &g->runs[g->run_count++];
    sph__gltf_list samplers;
    uint32_t array, channel;
    sph_status status = sph__gltf_get_kind(d, animation, "channels", '[', &array);
    *run = (sph__gltf_run){clip, g->frame_count, sph__gltf_frames_of(&g->clips[clip], g->fps), g->channel_count, 0};
    if (run->frame_count > FRAME_LIMIT || g->frame_count > FRAME_LIMIT)
        return sph__io_fail(d->context, SPH_E_LIMIT,
                            "%s: clip %u lasts %g s, which is too many frames at %g frames per second",
                            sph__io_shown(d->path), (unsigned)clip, g->clips[clip].duration, g->fps);
    g->frame_count += run->frame_count;
    if (status != SPH_OK || array == 0) return status;
    if ((status = list_samplers(d, animation, &samplers)) != SPH_OK) return status;
    channel = array + 1;
    for (uint32_t i = 0; i < d->values[array].count && status == SPH_OK; ++i, channel = d->values[channel].next)
        status = read_channel(d, g, &samplers, channel);
    sph_context_release(d->context, samplers.values);
    run->channel_count = g->channel_count - run->first_channel;
    return status;
}

/* A clip of that name, or of that number, counted from 0. */
static uint32_t find_clip(const sph__io_gltf *g, const char *name)
{
    uint64_t number = 0;
    const char *p = name;
    for (uint32_t i = 0; i < g->clip_count; ++i)
        if (strcmp(g->clips[i].name, name) == 0) return i;
    for (; *p >= '0' && *p <= '9' && p - name < 9; ++p)
        number = number * 10 + (uint64_t)(*p - '0');
    return p > name && *p == '\0' && number < g->clip_count ? (uint32_t)number : SPH__GLTF_NONE;
}

static sph_status fail_clip(const sph__gltf_document *d, const sph__io_gltf *g, const char *name)
{
    char list[256] = "";
    size_t length = 0;
    for (uint32_t i = 0; i < g->clip_count && length < sizeof list - 1; ++i)
        length += (size_t)snprintf(list + length, sizeof list - length, "%s%s", i == 0 ? ": it has " : ", ",
                                   g->clips[i].name);
    return sph__io_fail(d->context, SPH_E_INVALID, "%s: no clip '%.80s'%s", sph__io_shown(d->path), name,
                        g->clip_count == 0 ? ": it has none" : list);
}

sph_status sph__gltf_choose_clips(sph__gltf_document *d, sph__io_gltf *g, const char *name)
{
    const uint32_t chosen = name == NULL ? SPH__GLTF_NONE : find_clip(g, name);
    sph_status status;
    if (name != NULL && chosen == SPH__GLTF_NONE) return fail_clip(d, g, name);
    status = sph__gltf_allocate(d, g->clip_count, sizeof *g->runs, &g->runs);
    for (uint32_t i = 0; i < g->clip_count && status == SPH_OK; ++i)
        if (name == NULL || i == chosen) status = add_run(d, g, i);
    if (g->clip_count == 0) g->frame_count = 1;
    return status;
}
