/* SPDX-License-Identifier: MIT */
/* The memory of poses that are worked on. */
#include "implicit/tracker.h"

static bool allocate_track(const sph_tracker *tracker, sph__track *t)
{
    const sph_context *context = tracker->context;
    const size_t room = tracker->node_room;
    double *doubles = t->at[0] = sph__zalloc(context, room, 12 * sizeof *doubles);
    float *floats = t->direction[0] = sph__zalloc(context, room, 7 * sizeof *floats);
    if (doubles == NULL || floats == NULL) return false;
    for (size_t c = 0; c < 3; ++c) {
        t->at[c] = doubles + room * c;
        t->base[c] = doubles + room * (3 + c);
        t->low[c] = doubles + room * (6 + c);
        t->high[c] = doubles + room * (9 + c);
        t->direction[c] = floats + room * c;
    }
    t->share[0] = floats + room * 3;
    t->share[1] = floats + room * 4;
    t->goal = floats + room * 5;
    t->reach = floats + room * 6;
    t->trust = sph__alloc(context, tracker->implicit->joint_count, sizeof *t->trust);
    t->low_bone = sph__zalloc(context, room, 2 * sizeof *t->low_bone);
    t->state = sph__zalloc(context, room, 2);
    t->active = sph__zalloc(context, tracker->block_count, sizeof *t->active);
    t->placed = sph__alloc(context, tracker->implicit->bone_count, sizeof *t->placed);
    if (t->low_bone == NULL || t->state == NULL || t->active == NULL || t->trust == NULL || t->placed == NULL)
        return false;
    t->high_bone = t->low_bone + room;
    t->count = t->state + room;
    return true;
}

static sph_status allocate_guard(const sph_tracker *tracker, sph__track *t)
{
    const sph__shell *s = &tracker->shell;
    t->places[0] = sph__alloc(tracker->context, s->node_count, 6 * sizeof *t->places[0]);
    t->kept = sph__alloc(tracker->context, s->node_count, 2 * sizeof *t->kept);
    t->marks = sph__zalloc(tracker->context, s->triangle_count, 2);
    if (t->places[0] == NULL || t->kept == NULL || t->marks == NULL) return sph__fail_memory(tracker->context);
    t->moved = t->marks + s->triangle_count;
    t->best = t->kept + s->node_count;
    t->moved = t->marks + s->triangle_count;
    t->best = t->kept + s->node_count;
    t->places[1] = t->places[0] + 3 * (size_t)s->node_count;
    if (s->triangle_count == 0) return SPH_OK;
    const sph_status status =
        sph__intersector_init(&t->search, tracker->context, s->triangles, s->triangle_count, s->rest);
    t->search.marks = t->marks;
    return status;
}

sph_status sph__tracks_allocate(sph_tracker *tracker)
{
    for (uint32_t i = 0; i < tracker->batch_size; ++i) {
        sph__track *t = tracker->tracks + i;
        t->search.context = tracker->context;
        t->search.tree.context = tracker->context;
        if (!allocate_track(tracker, t)) return sph__fail_memory(tracker->context);
        if ((tracker->options.flags & SPH_TRACKER_UNGUARDED) == 0) {
            const sph_status status = allocate_guard(tracker, t);
            if (status != SPH_OK) return status;
        }
    }
    return SPH_OK;
}

void sph__tracks_free(sph_tracker *tracker)
{
    const sph_context *context = tracker->context;
    for (uint32_t i = 0; i < tracker->batch_size; ++i) {
        sph__track *t = tracker->tracks + i;
        sph__free(context, t->at[0]);
        sph__free(context, t->direction[0]);
        sph__free(context, t->low_bone);
        sph__free(context, t->state);
        sph__free(context, t->active);
        sph__free(context, t->placed);
        sph__free(context, t->trust);
        sph__free(context, t->places[0]);
        sph__free(context, t->kept);
        sph__free(context, t->marks);
        sph__free(context, t->now.items);
        if (t->search.context != NULL) sph__intersector_free(&t->search);
    }
}
