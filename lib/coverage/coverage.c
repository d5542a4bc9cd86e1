/* SPDX-License-Identifier: MIT */
/* Passes over an animation: which vertices are outside the level, and how far. */
#include "coverage/coverage.h"

enum { MOST_SLOTS = 64 };

sph_status sph__coverage_check(const sph_context *context, const sph_animation *animation, const sph_level *level,
                               const char *function)
{
    if (animation == NULL || level == NULL)
        return sph__fail(context, SPH_E_INVALID, "%s: an argument is NULL", function);
    if (animation->frame_count != level->frame_count)
        return sph__fail(context, SPH_E_INVALID, "the animation has %u frames, the level %u",
                         (unsigned)animation->frame_count, (unsigned)level->frame_count);
    return SPH_OK;
}

static sph_status init_slot(const sph__coverage_job *j, sph__coverage_slot *s)
{
    sph_status status = sph__solid_init(&s->solid, j->level);
    if (status != SPH_OK) return status;
    s->xyz = sph__alloc(j->context, j->animation->vertex_count, 3 * sizeof *s->xyz);
    if (s->xyz == NULL) return sph__fail_memory(j->context);
    if (!j->collects) return SPH_OK;
    s->raises = sph__alloc(j->context, s->solid.sphere_count, sizeof *s->raises);
    s->worst = sph__alloc(j->context, s->solid.primitive_count, sizeof *s->worst);
    s->where = sph__alloc(j->context, s->solid.primitive_count, sizeof *s->where);
    if (s->raises == NULL || s->worst == NULL || s->where == NULL) return sph__fail_memory(j->context);
    return SPH_OK;
}

sph_status sph__coverage_job_init(sph__coverage_job *j)
{
    sph_status status = SPH_OK;
    j->slot_count = 2 * sph__worker_count(j->context);
    if (j->slot_count > MOST_SLOTS) j->slot_count = MOST_SLOTS;
    if (j->slot_count > j->level->frame_count) j->slot_count = j->level->frame_count;
    j->slots = sph__zalloc(j->context, j->slot_count, sizeof *j->slots);
    if (j->slots == NULL) return sph__fail_memory(j->context);
    for (uint32_t i = 0; i < j->slot_count && status == SPH_OK; ++i)
        status = init_slot(j, &j->slots[i]);
    return status;
}

void sph__coverage_job_free(sph__coverage_job *j)
{
    for (uint32_t i = 0; j->slots != NULL && i < j->slot_count; ++i) {
        sph__coverage_slot *s = &j->slots[i];
        sph__solid_free(&s->solid);
        sph__free(j->context, s->xyz);
        sph__free(j->context, s->raises);
        sph__free(j->context, s->worst);
        sph__free(j->context, s->where);
    }
    sph__free(j->context, j->slots);
    j->slots = NULL;
}

static void collect(sph__coverage_slot *s, uint32_t vertex, uint32_t primitive, const double weights[3], double lack)
{
    const sph__solid *solid = &s->solid;
    if (lack > s->worst[primitive]) {
        s->worst[primitive] = lack;
        s->where[primitive] = vertex;
    }
    for (int32_t k = 0; k < solid->corner_counts[primitive]; ++k) {
        double *raise = &s->raises[solid->corners[primitive][k]];
        if (weights[k] > 0 && lack > *raise) *raise = lack;
    }
}

/* Neighbours in the order of vertices are mostly near each other: the primitive of the last one is tried first. */
static void look_at_frame(const sph__coverage_job *j, sph__coverage_slot *s)
{
    uint32_t hint = 0;
    sph__solid_pose(&s->solid, sph__level_centers(j->level, s->frame), sph__level_radii(j->level, s->frame), 0);
    s->largest = 0;
    s->vertex = 0;
    s->count = 0;
    for (uint32_t i = 0; j->collects && i < s->solid.sphere_count; ++i)
        s->raises[i] = 0;
    for (uint32_t i = 0; j->collects && i < s->solid.primitive_count; ++i)
        s->worst[i] = 0;
    for (uint32_t v = 0; v < j->animation->vertex_count; ++v) {
        const float *p = s->xyz + 3 * (size_t)v;
        const double x[3] = {p[0], p[1], p[2]};
        double weights[3], excess = sph__coverage_excess(&s->solid.primitives[hint], x, weights, NULL);
        if (excess <= -j->margin) continue;
        (void)sph__solid_distance(&s->solid, x, &hint);
        excess = sph__coverage_excess(&s->solid.primitives[hint], x, weights, NULL);
        if (excess <= -j->margin) continue;
        ++s->count;
        if (excess > s->largest) {
            s->largest = excess;
            s->vertex = v;
        }
        if (j->collects) collect(s, v, hint, weights, excess + j->margin);
    }
}

static void look(void *argument, size_t begin, size_t end)
{
    const sph__coverage_job *j = argument;
    for (size_t i = begin; i < end; ++i)
        look_at_frame(j, &j->slots[i]);
}

static sph_status read_slot(const sph__coverage_job *j, sph__coverage_slot *s, uint32_t frame)
{
    const sph_status status = sph_animation_read_frame(j->animation, frame, s->xyz);
    s->frame = frame;
    return status != SPH_OK ? status : sph__check_finite(j->context, frame, s->xyz, j->animation->vertex_count);
}

/* Frames are read on this thread, a batch at a time, and looked at on any. */
sph_status sph__coverage_pass(sph__coverage_job *j, sph__coverage_visit_fn *visit, void *user)
{
    const uint32_t frames = j->level->frame_count;
    sph_status status = sph__progress_report(&j->progress, "coverage", 0);
    for (uint32_t begin = 0; begin < frames && status == SPH_OK; begin += j->slot_count) {
        const uint32_t count = frames - begin < j->slot_count ? frames - begin : j->slot_count;
        for (uint32_t i = 0; i < count && status == SPH_OK; ++i)
            status = read_slot(j, &j->slots[i], begin + i);
        if (status != SPH_OK) break;
        sph__parallel_for(j->context, count, 1, look, j);
        for (uint32_t i = 0; i < count && status == SPH_OK; ++i)
            status = visit(user, &j->slots[i]);
        if (status == SPH_OK)
            status = sph__progress_report(&j->progress, "coverage", (begin + count) / (double)frames);
    }
    return status;
}

static sph_status add_frame(void *user, const sph__coverage_slot *s)
{
    sph_coverage *total = user;
    total->uncovered_count += s->count;
    if (s->count > 0 && s->largest > total->distance) {
        total->distance = s->largest;
        total->frame = s->frame;
        total->vertex = s->vertex;
    }
    return SPH_OK;
}

sph_status sph_coverage_measure(const sph_animation *animation, const sph_level *level, sph_coverage *coverage)
{
    SPH__OWN(animation, SPH__ANIMATION);
    SPH__OWN(level, SPH__LEVEL);
    sph__coverage_job j = {.animation = animation, .level = level};
    sph_coverage total = {.struct_size = sizeof total};
    sph_status status;
    if (animation != NULL) j.context = animation->context;
    status = sph__coverage_check(j.context, animation, level, "sph_coverage_measure");
    if (status != SPH_OK) return status;
    if (coverage == NULL || coverage->struct_size != sizeof total)
        return sph__fail(j.context, SPH_E_INVALID, "sph_coverage: NULL, or struct_size is not %zu", sizeof total);
    sph__progress_begin(&j.progress, j.context);
    sph__progress_part(&j.progress, 1);
    status = sph__coverage_job_init(&j);
    if (status == SPH_OK) status = sph__coverage_pass(&j, add_frame, &total);
    sph__coverage_job_free(&j);
    if (status == SPH_OK) *coverage = total;
    return status;
}
