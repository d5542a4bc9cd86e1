/* SPDX-License-Identifier: MIT */
#include "posing.h"

static sph_status find_fields(session *s, posing *p, const correction *c)
{
    sph_implicit_options o;
    if (c->fields != NULL) return sph_io_load_implicit(s->context, c->fields, &p->implicit);
    sph_implicit_options_init(&o, sizeof o);
    o.operation = c->operation;
    o.parents = p->parts.parents;
    return sph_implicit_create(sph_io_rig_skin(p->rig), &o, &p->implicit);
}

sph_status posing_correct(session *s, posing *p, const correction *c)
{
    sph_tracker_options o;
    sph_status status = find_fields(s, p, c);
    if (status == SPH_OK && c->save_fields != NULL)
        status = sph_io_save_implicit(s->context, p->implicit, c->save_fields);
    if (status != SPH_OK) return status;
    sph_tracker_options_init(&o, sizeof o);
    o.method = p->method;
    o.evaluation = c->exact ? SPH_EVALUATION_EXACT : SPH_EVALUATION_TABLE;
    o.flags = (c->unguarded ? (uint32_t)SPH_TRACKER_UNGUARDED : 0) | (c->pairs ? (uint32_t)SPH_TRACKER_COUNTED : 0);
    p->reports = sph_context_allocate(s->context, p->skin.frame_count, sizeof *p->reports);
    if (p->reports == NULL) return sph_context_fail(s->context, SPH_E_NOMEM, "out of memory");
    return sph_tracker_create(p->implicit, sph_io_rig_skin(p->rig), &o, &p->tracker);
}

static const double *transforms_of(const posing *p, uint32_t frame)
{
    return p->skin.transforms + (size_t)12 * p->skin.bone_count * frame;
}

sph_status posing_blend(posing *p, int32_t method, uint32_t frame, float *positions, float *normals)
{
    return sph_deformer_pose(p->deformer, transforms_of(p, frame), 1, method, positions, normals);
}

sph_status posing_frame(posing *p, uint32_t frame, float *positions, float *normals)
{
    if (p->tracker == NULL) return posing_blend(p, p->method, frame, positions, normals);
    return sph_tracker_pose(p->tracker, transforms_of(p, frame), 1, positions, normals, p->reports + frame);
}

float *posing_frames(session *s, posing *p, bool corrected, int32_t method, sph_status *status)
{
    const size_t numbers = (size_t)3 * p->skin.vertex_count;
    float *all = sph_context_allocate(s->context, p->skin.frame_count, numbers * sizeof *all);
    *status = all == NULL ? sph_context_fail(s->context, SPH_E_NOMEM, "out of memory") : SPH_OK;
    if (all == NULL) return NULL;
    *status = corrected ? sph_tracker_pose(p->tracker, p->skin.transforms, p->skin.frame_count, all, NULL, p->reports)
                        : sph_deformer_pose(p->deformer, p->skin.transforms, p->skin.frame_count, method, all, NULL);
    return all;
}

void posing_close(session *s, posing *p)
{
    sph_context_release(s->context, p->reports);
    sph_tracker_destroy(p->tracker);
    sph_implicit_destroy(p->implicit);
    sph_deformer_destroy(p->deformer);
    sph_io_rig_destroy(p->rig);
}
