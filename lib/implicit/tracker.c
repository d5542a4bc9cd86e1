/* SPDX-License-Identifier: MIT */
/* The tracker: its options, what it knows of the rest pose, and poses in batches. */
#include <math.h>

#include "implicit/tracker.h"
#include "numeric/vector.h"

enum { BLOCK = SPH__IMPLICIT_BLOCK, RELAX_INTERVAL = 2, SPREAD_ROUNDS = 4 };

/* At rest the gradient leaves the surface: where their cosine is less, the field says nothing of it. */
static const double LEAST_COSINE = 0.2;
/* Values as near to 0 or 1 have hardly any slope. */
static const double LEAST_VALUE = 0.01;

static const sph_tracker_options DEFAULTS = {.struct_size = sizeof(sph_tracker_options),
                                             .method = SPH_POSE_DUAL_QUATERNION,
                                             .evaluation = SPH_EVALUATION_TABLE,
                                             .iteration_limit = 24,
                                             .smoothing_rounds = 4,
                                             .step = 0.35,
                                             .contact_angle = 0.95993108859688125, /* 55 degrees */
                                             .tolerance = 1e-4,
                                             .reach = 1};
enum { OPTIONS_V1 = offsetof(sph_tracker_options, reach) + sizeof(double) };
_Static_assert(OPTIONS_V1 == 56, "a field of 0.1 moved");

void sph_tracker_options_init(sph_tracker_options *options, size_t size)
{
    sph__options_init(options, size, &DEFAULTS, sizeof DEFAULTS, OPTIONS_V1);
}

static sph_status read_options(const sph_context *context, const sph_tracker_options *in, sph_tracker_options *o)
{
    const char *what = NULL;
    sph_status status;
    *o = DEFAULTS;
    status = sph__options_read(context, "sph_tracker_options", in, o, sizeof *o, OPTIONS_V1);
    if (status != SPH_OK) return status;
    if ((o->flags & ~(uint32_t)(SPH_TRACKER_UNGUARDED | SPH_TRACKER_UNSMOOTHED | SPH_TRACKER_COUNTED)) != 0)
        what = "flags";
    if (o->method != SPH_POSE_LINEAR && o->method != SPH_POSE_DUAL_QUATERNION) what = "method";
    if (o->evaluation != SPH_EVALUATION_TABLE && o->evaluation != SPH_EVALUATION_EXACT) what = "evaluation";
    if (o->iteration_limit < 1 || o->iteration_limit > 1000) what = "iteration_limit";
    if (o->smoothing_rounds > 100) what = "smoothing_rounds";
    if (!(o->step > 0 && o->step <= 1)) what = "step";
    if (!(o->contact_angle > 0 && o->contact_angle < 3.14159265358979323846)) what = "contact_angle";
    if (!(o->tolerance >= 0 && o->tolerance <= 0.1)) what = "tolerance";
    if (!(o->reach > 0 && o->reach <= 10)) what = "reach";
    return what == NULL ? SPH_OK : sph__fail(context, SPH_E_INVALID, "sph_tracker_options: %s is out of range", what);
}

void sph_tracker_destroy(sph_tracker *tracker)
{
    SPH__OWN(tracker, SPH__TRACKER);
    sph_context *context;
    if (tracker == NULL) return;
    context = tracker->context;
    sph__tracks_free(tracker);
    sph__shell_free(&tracker->shell);
    sph__free(context, tracker->triangles);
    sph__free(context, tracker->around_starts);
    sph__free(context, tracker->around);
    sph__free(context, tracker->iso);
    sph__free(context, tracker->limit);
    sph__free(context, tracker->rest_bone);
    sph__free(context, tracker->joint_sizes);
    sph_deformer_destroy(tracker->deformer);
    sph_implicit_destroy(tracker->implicit);
    sph__free(context, tracker);
    sph__context_release(context);
}

/* --- the rest pose --- */

static bool is_told(const sph__shell *s, size_t node, double f, const double gradient[3])
{
    const double slope = sph__norm(gradient), along = sph__dot(gradient, s->normals + 3 * node);
    return f > LEAST_VALUE && f < 1 - LEAST_VALUE && slope > 0 && fabs(along) >= LEAST_COSINE * slope;
}

static void tell_block(void *argument, size_t begin, size_t end)
{
    sph_tracker *t = argument;
    const sph__shell *s = &t->shell;
    for (size_t block = begin; block < end; ++block) {
        const size_t first = block * BLOCK, count = s->node_count - first < BLOCK ? s->node_count - first : BLOCK;
        uint32_t bones[BLOCK];
        sph__points p;
        sph__values v;
        for (size_t i = 0; i < count; ++i) {
            p.x[i] = (double)s->rest[3 * (first + i)];
            p.y[i] = (double)s->rest[3 * (first + i) + 1];
            p.z[i] = (double)s->rest[3 * (first + i) + 2];
        }
        sph__compose_block(t->implicit, t->tracks[0].placed, t->options.evaluation, count, &p, &v, bones);
        for (size_t i = 0; i < count; ++i) {
            const double gradient[3] = {v.x[i], v.y[i], v.z[i]};
            t->iso[first + i] = is_told(s, first + i, v.f[i], gradient) ? v.f[i] : -1;
            t->rest_bone[first + i] = bones[i];
            t->limit[first + i] =
                bones[i] == SPH__NO_PART ? 0 : t->options.reach * t->implicit->fields[bones[i]].radius;
        }
    }
}

/* From each joint to the nearest node: how thick the limb is there. */
static void measure_joints(void *argument, size_t begin, size_t end)
{
    sph_tracker *t = argument;
    for (size_t j = begin; j < end; ++j) {
        double least = INFINITY;
        for (size_t i = 0; i < t->shell.node_count; ++i) {
            double p[3];
            for (int c = 0; c < 3; ++c)
                p[c] = (double)t->shell.rest[3 * i + c];
            least = fmin(least, sph__distance(p, t->implicit->joints[j].given.position));
        }
        t->joint_sizes[j] = least;
    }
}

static sph_status fill(sph_tracker *t, const sph_implicit *implicit, const sph_skin *skin)
{
    sph_status status = sph__shell_init(&t->shell, skin, NULL);
    size_t nodes;
    if (status == SPH_OK) status = sph__shell_find_shares(&t->shell);
    if (status == SPH_OK) status = sph__implicit_copy(implicit, &t->implicit);
    if (status == SPH_OK) status = sph_deformer_create(skin, NULL, &t->deformer);
    if (status == SPH_OK) status = sph__write_init(t, skin);
    if (status != SPH_OK) return status;
    nodes = t->shell.node_count;
    t->block_count = (uint32_t)((nodes + BLOCK - 1) / BLOCK);
    if (nodes > UINT32_MAX - BLOCK) return sph__fail(t->context, SPH_E_LIMIT, "%zu vertices are too many", nodes);
    t->node_room = t->block_count * BLOCK;
    t->batch_size = nodes * SPH__TRACK_BATCH <= SPH__TRACK_BATCH_NODES ? SPH__TRACK_BATCH
                    : nodes >= SPH__TRACK_BATCH_NODES                  ? 1
                                                                       : (uint32_t)(SPH__TRACK_BATCH_NODES / nodes);
    t->iso = sph__alloc(t->context, nodes, sizeof *t->iso);
    t->limit = sph__alloc(t->context, nodes, sizeof *t->limit);
    t->rest_bone = sph__alloc(t->context, nodes, sizeof *t->rest_bone);
    t->joint_sizes = sph__alloc(t->context, t->implicit->joint_count, sizeof *t->joint_sizes);
    if (t->joint_sizes == NULL || t->iso == NULL || t->limit == NULL || t->rest_bone == NULL)
        return sph__fail_memory(t->context);
    status = sph__tracks_allocate(t);
    if (status != SPH_OK) return status;
    sph__place_fields(t->implicit, NULL, t->tracks[0].placed);
    sph__parallel_for(t->context, t->block_count, 4, tell_block, t);
    sph__parallel_for(t->context, t->implicit->joint_count, 1, measure_joints, t);
    return SPH_OK;
}

sph_status sph_tracker_create(const sph_implicit *implicit, const sph_skin *skin, const sph_tracker_options *options,
                              sph_tracker **out)
{
    SPH__OWN(implicit, SPH__IMPLICIT);
    SPH__OWN(skin, SPH__SKIN);
    sph_tracker_options o;
    sph_tracker *t;
    sph_status status;
    if (out != NULL) *out = NULL;
    if (implicit == NULL || skin == NULL || out == NULL)
        return sph__fail(skin == NULL ? NULL : skin->context, SPH_E_INVALID, "sph_tracker_create: an argument is NULL");
    if ((status = read_options(skin->context, options, &o)) != SPH_OK) return status;
    if (implicit->bone_count != skin->bone_count)
        return sph__fail(skin->context, SPH_E_INVALID, "the set-up is of %u bones, the skin of %u",
                         (unsigned)implicit->bone_count, (unsigned)skin->bone_count);
    t = sph__new(skin->context, sizeof *t, SPH__TRACKER);
    if (t == NULL) return sph__fail_memory(skin->context);
    t->context = sph__context_retain(skin->context);
    t->shell.context = t->context;
    t->options = o;
    t->contact_cosine = cos(o.contact_angle);
    status = fill(t, implicit, skin);
    if (status != SPH_OK) {
        sph_tracker_destroy(t);
        return status;
    }
    *out = t;
    return SPH_OK;
}

/* --- poses --- */

static void run(sph__batch *b, size_t blocks, sph_range_fn *body)
{
    b->blocks = blocks;
    sph__parallel_for(b->tracker->context, b->count * blocks, 1, body, b);
}

static bool any_active(const sph_tracker *t, size_t count)
{
    for (size_t i = 0; i < count; ++i)
        for (uint32_t k = 0; k < t->block_count; ++k)
            if (t->tracks[i].active[k] != 0) return true;
    return false;
}

static void smooth(sph__batch *b)
{
    const size_t blocks = b->tracker->block_count;
    run(b, blocks, sph__smooth_start);
    for (b->round = 0; b->round < SPREAD_ROUNDS; ++b->round)
        run(b, blocks, sph__smooth_spread);
    for (uint32_t i = 0; i < b->tracker->options.smoothing_rounds; ++i) {
        run(b, blocks, sph__smooth_find);
        run(b, blocks, sph__smooth_take);
    }
}

/* Of the caller's positions as they are. */
static sph_status count_pairs(const sph_tracker *t, const sph__track *track, uint64_t *pairs)
{
    return sph_mesh_intersections(t->context, t->shell.vertex_count, track->positions, t->triangle_count, t->triangles,
                                  pairs);
}

static sph_status correct(sph_tracker *t, size_t count)
{
    const size_t blocks = t->block_count;
    const uint32_t flags = t->options.flags;
    sph__batch b = {.tracker = t, .count = count};
    sph_status status = SPH_OK;
    for (size_t i = 0; i < count; ++i) {
        sph__place_fields(t->implicit, t->tracks[i].transforms, t->tracks[i].placed);
        sph__trust_joints(t, t->tracks + i);
    }
    run(&b, blocks, sph__march_start);
    for (uint32_t i = 1; i <= t->options.iteration_limit && any_active(t, count); ++i) {
        run(&b, blocks, sph__march_step);
        if (i % RELAX_INTERVAL != 0) continue;
        run(&b, blocks, sph__relax_find);
        run(&b, blocks, sph__relax_take);
    }
    run(&b, blocks, sph__march_end);
    run(&b, blocks, sph__march_part);
    run(&b, 1, sph__write_contacts);
    if ((flags & SPH_TRACKER_UNSMOOTHED) == 0 && t->options.smoothing_rounds > 0) smooth(&b);
    run(&b, blocks, sph__march_part);
    if ((flags & SPH_TRACKER_UNGUARDED) == 0 && t->shell.triangle_count > 0) status = sph__guard(t, count);
    for (size_t i = 0; i < count && status == SPH_OK && (flags & SPH_TRACKER_COUNTED) != 0; ++i)
        status = count_pairs(t, t->tracks + i, &t->tracks[i].report.pairs_before);
    if (status != SPH_OK) return status;
    run(&b, 1, sph__write_positions);
    for (size_t i = 0; i < count && status == SPH_OK && (flags & SPH_TRACKER_COUNTED) != 0; ++i)
        status = count_pairs(t, t->tracks + i, &t->tracks[i].report.pairs_after);
    if (status != SPH_OK) return status;
    if (t->tracks[0].normals != NULL)
        run(&b, ((size_t)t->shell.vertex_count + SPH__WRITE_BLOCK - 1) / SPH__WRITE_BLOCK, sph__write_normals);
    return SPH_OK;
}

static sph_status check(const sph_tracker *t, const double *transforms, size_t pose_count)
{
    size_t bytes;
    if (!sph__multiply_size(pose_count, 12 * sizeof(double) * t->implicit->bone_count, &bytes) ||
        !sph__multiply_size(pose_count, 3 * sizeof(float) * t->shell.vertex_count, &bytes))
        return sph__fail(t->context, SPH_E_INVALID, "sph_tracker_pose: %zu poses are too many", pose_count);
    for (size_t i = 0; i < 12 * pose_count * t->implicit->bone_count; ++i)
        if (!isfinite(transforms[i]))
            return sph__fail(t->context, SPH_E_INVALID, "the transform of bone %zu in pose %zu is not finite",
                             i / 12 % t->implicit->bone_count, i / 12 / t->implicit->bone_count);
    return SPH_OK;
}

sph_status sph_tracker_pose(sph_tracker *tracker, const double *transforms, size_t pose_count, float *positions,
                            float *normals, sph_tracker_report *reports)
{
    SPH__OWN(tracker, SPH__TRACKER);
    sph__progress progress;
    sph_status status;
    if (tracker == NULL || (pose_count != 0 && (transforms == NULL || positions == NULL)))
        return sph__fail(tracker == NULL ? NULL : tracker->context, SPH_E_INVALID,
                         "sph_tracker_pose: an argument is NULL");
    if ((status = check(tracker, transforms, pose_count)) != SPH_OK) return status;
    sph__progress_begin(&progress, tracker->context);
    sph__progress_part(&progress, 1);
    for (size_t pose = 0; pose < pose_count && status == SPH_OK; pose += tracker->batch_size) {
        const size_t count = pose_count - pose < tracker->batch_size ? pose_count - pose : tracker->batch_size;
        const size_t at = 3 * (size_t)tracker->shell.vertex_count * pose, bones = tracker->implicit->bone_count;
        if (pose > 0) status = sph__progress_report(&progress, "posing", (double)pose / (double)pose_count);
        if (status != SPH_OK) return status;
        for (size_t i = 0; i < count; ++i) {
            sph__track *t = tracker->tracks + i;
            t->transforms = transforms + 12 * bones * (pose + i);
            t->positions = positions + at + 3 * (size_t)tracker->shell.vertex_count * i;
            t->normals = normals == NULL ? NULL : normals + at + 3 * (size_t)tracker->shell.vertex_count * i;
        }
        status = sph_deformer_pose(tracker->deformer, transforms + 12 * bones * pose, count, tracker->options.method,
                                   positions + at, NULL);
        if (status == SPH_OK) status = correct(tracker, count);
        for (size_t i = 0; i < count && status == SPH_OK && reports != NULL; ++i)
            reports[pose + i] = tracker->tracks[i].report;
    }
    return status;
}
