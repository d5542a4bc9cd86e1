/* SPDX-License-Identifier: MIT */
#include <float.h>

#include "animation/animation.h"
#include "measure/measure.h"
#include "measure/mesh.h"
#include "numeric/vector.h"

/* Frames in flight: one per slot. Each is measured on its own, so their number changes no result. */
enum { MOST_SLOTS = 64, MOST_SAMPLES = 1 << 28 };

typedef struct slot {
    sph__mesh mesh1, mesh2; /* the second only for meshes */
    sph__outer outer;       /* for levels */
    double *bounds;         /* of the distance from each vertex of a mesh to the other surface */
    uint32_t frame;
    sph_status status;
    sph_distances result;
} slot;

typedef struct job {
    const sph_context *context;
    const sph_animation *animation1, *animation2; /* the second is NULL for levels */
    const sph_level *level;
    sph_measure_options options;
    uint32_t frame_count; /* to measure */
    uint32_t slot_count;
    slot *slots;
} job;

/* --- options --- */

static const sph_measure_options DEFAULTS = {
    .struct_size = sizeof(sph_measure_options), .samples = 10000, .seed = 1, .frame_step = 1};
enum { OPTIONS_V1 = offsetof(sph_measure_options, reserved0) + sizeof(uint32_t) };
_Static_assert(OPTIONS_V1 == 32, "a field of 0.1 moved");

void sph_measure_options_init(sph_measure_options *options, size_t size)
{
    sph__options_init(options, size, &DEFAULTS, sizeof DEFAULTS, OPTIONS_V1);
}

static sph_status read_options(job *j, const sph_measure_options *in)
{
    sph_measure_options *o = &j->options;
    const uint32_t frames = j->animation1->frame_count;
    sph_status status;
    *o = DEFAULTS;
    status = sph__options_read(j->context, "sph_measure_options", in, o, sizeof *o, OPTIONS_V1);
    if (status != SPH_OK) return status;
    if (o->flags != 0 || o->reserved0 != 0)
        return sph__fail(j->context, SPH_E_INVALID, "sph_measure_options: flags and reserved0 must be 0");
    if (o->samples == 0 || o->samples > MOST_SAMPLES)
        return sph__fail(j->context, SPH_E_INVALID, "%u samples; from 1 to %d are possible", (unsigned)o->samples,
                         MOST_SAMPLES);
    if (o->frame_step == 0) return sph__fail(j->context, SPH_E_INVALID, "frame_step is 0");
    if (o->first_frame >= frames)
        return sph__fail(j->context, SPH_E_INVALID, "first_frame is %u, but there are %u frames",
                         (unsigned)o->first_frame, (unsigned)frames);
    j->frame_count = (frames - o->first_frame - 1) / o->frame_step + 1;
    if (o->frame_limit != 0 && o->frame_limit < j->frame_count) j->frame_count = o->frame_limit;
    return SPH_OK;
}

/* --- one frame --- */

/* Distances from one surface to the other: those of spread points count in the mean, all in the maximum. */
typedef struct tally {
    double sum, most;
    uint32_t count;
} tally;

typedef double distance_fn(const void *surface, const double x[3], uint32_t *guess);

static double distance_to_mesh(const void *surface, const double x[3], uint32_t *guess)
{
    return sph__mesh_distance(surface, x, guess);
}

static double distance_to_outer(const void *surface, const double x[3], uint32_t *guess)
{
    (void)guess;
    return sph__outer_distance(surface, x);
}

static void add(tally *t, double distance)
{
    t->sum += distance;
    ++t->count;
    if (distance > t->most) t->most = distance;
}

static void read_vertex(const sph__mesh *mesh, uint32_t vertex, double x[3])
{
    for (size_t k = 0; k < 3; ++k)
        x[k] = mesh->xyz[3 * (size_t)vertex + k];
}

/* A vertex is no farther than a point near it plus the way there. */
static void bound_corners(const sph__mesh *mesh, const sph__mesh_point *point, double distance, double *bounds)
{
    for (size_t k = 0; k < 3; ++k) {
        const uint32_t vertex = mesh->triangles[3 * (size_t)point->triangle + k];
        double x[3], bound;
        read_vertex(mesh, vertex, x);
        bound = distance + sph__distance(x, point->position);
        if (bound < bounds[vertex]) bounds[vertex] = bound;
    }
}

/* From points of the mesh, and from its vertices, to `surface`. Vertices that cannot be the farthest are passed over.
 */
static void measure_mesh(const sph__mesh *mesh, const void *surface, distance_fn *distance_to, uint32_t samples,
                         const double shift[2], double *bounds, tally *t)
{
    uint32_t cursor = 0, guess = 0;
    for (uint32_t i = 0; i < mesh->vertex_count; ++i)
        bounds[i] = -1; /* of no triangle */
    for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; ++i)
        bounds[mesh->triangles[i]] = DBL_MAX;
    for (uint32_t i = 0; i < samples; ++i) {
        sph__mesh_point point;
        double distance;
        sph__mesh_sample(mesh, i, samples, shift, &cursor, &point);
        distance = distance_to(surface, point.position, &guess);
        add(t, distance);
        bound_corners(mesh, &point, distance, bounds);
    }
    for (uint32_t i = 0; i < mesh->vertex_count; ++i) {
        double x[3];
        if (bounds[i] <= t->most) continue;
        read_vertex(mesh, i, x);
        t->most = fmax(t->most, distance_to(surface, x, &guess));
    }
}

/* All points on a sphere of no radius are one, and deep inside a mesh a distance takes long: once is enough. */
static void measure_outer(const sph__outer *outer, const sph__mesh *mesh, tally *t)
{
    double x[3] = {0}, last[3] = {0}, distance = -1;
    uint32_t guess = 0;
    for (uint32_t i = 0; i < outer->outer_count; ++i) {
        sph__outer_point(outer, i, x);
        if (distance < 0 || sph__distance(x, last) > outer->skin) {
            distance = sph__mesh_distance(mesh, x, &guess);
            sph__copy3(x, last);
        }
        if (i < outer->extreme_begin)
            add(t, distance);
        else
            t->most = fmax(t->most, distance);
    }
}

static void set_result(sph_distances *d, const tally *from1, const tally *from2, double area1, double area2)
{
    d->mean12 = from1->count == 0 ? 0 : from1->sum / from1->count;
    d->mean21 = from2->count == 0 ? 0 : from2->sum / from2->count;
    d->max12 = from1->most;
    d->max21 = from2->most;
    d->hausdorff = fmax(d->max12, d->max21);
    d->area1 = area1;
    d->area2 = area2;
}

static sph_status measure_frame_of_level(const job *j, slot *s)
{
    const uint32_t samples = j->options.samples;
    tally from1 = {0}, from2 = {0};
    double low[3], high[3], shift[2];
    sph_status status;
    sph__measure_shift(j->options.seed, s->frame, 2, shift);
    status = sph__outer_pose(&s->outer, sph__level_centers(j->level, s->frame), sph__level_radii(j->level, s->frame),
                             sph__mesh_diagonal(&s->mesh1, low, high), samples, shift);
    if (status != SPH_OK) return status;
    measure_outer(&s->outer, &s->mesh1, &from2);
    sph__measure_shift(j->options.seed, s->frame, 1, shift);
    measure_mesh(&s->mesh1, &s->outer, distance_to_outer, samples, shift, s->bounds, &from1);
    set_result(&s->result, &from1, &from2, s->mesh1.area, s->outer.area);
    return SPH_OK;
}

static sph_status measure_frame_of_meshes(const job *j, slot *s)
{
    tally from1 = {0}, from2 = {0};
    double shift[2];
    sph__mesh_refit(&s->mesh2);
    sph__measure_shift(j->options.seed, s->frame, 1, shift);
    measure_mesh(&s->mesh1, &s->mesh2, distance_to_mesh, j->options.samples, shift, s->bounds, &from1);
    sph__measure_shift(j->options.seed, s->frame, 2, shift);
    measure_mesh(&s->mesh2, &s->mesh1, distance_to_mesh, j->options.samples, shift, s->bounds, &from2);
    set_result(&s->result, &from1, &from2, s->mesh1.area, s->mesh2.area);
    return SPH_OK;
}

static void measure_slots(void *argument, size_t begin, size_t end)
{
    const job *j = argument;
    for (size_t i = begin; i < end; ++i) {
        slot *s = &j->slots[i];
        sph__mesh_refit(&s->mesh1);
        s->status = j->level != NULL ? measure_frame_of_level(j, s) : measure_frame_of_meshes(j, s);
    }
}

/* --- all frames --- */

static sph_status read_frame(const job *j, const sph_animation *animation, uint32_t frame, sph__mesh *mesh)
{
    const sph_status status = sph_animation_read_frame(animation, frame, mesh->xyz);
    if (status != SPH_OK) return status;
    return sph__check_finite(j->context, frame, mesh->xyz, mesh->vertex_count);
}

/* The order of the triangles in their trees comes from the first frame, so it is the same in all slots. */
static sph_status init_mesh(const job *j, const sph_animation *animation, sph__mesh *mesh, const sph__mesh *first)
{
    sph_status status =
        sph__mesh_init(mesh, j->context, animation->vertex_count, animation->triangles, animation->triangle_count);
    if (status != SPH_OK) return status;
    if (first != mesh) {
        sph__mesh_copy_order(mesh, first);
        return SPH_OK;
    }
    status = read_frame(j, animation, j->options.first_frame, mesh);
    if (status == SPH_OK) sph__mesh_build(mesh);
    return status;
}

static sph_status init_slots(job *j)
{
    const uint32_t vertices1 = j->animation1->vertex_count;
    const uint32_t vertices2 = j->animation2 == NULL ? 0 : j->animation2->vertex_count;
    sph_status status = SPH_OK;
    j->slot_count = 2 * sph__worker_count(j->context);
    if (j->slot_count > MOST_SLOTS) j->slot_count = MOST_SLOTS;
    if (j->slot_count > j->frame_count) j->slot_count = j->frame_count;
    j->slots = sph__zalloc(j->context, j->slot_count, sizeof *j->slots);
    if (j->slots == NULL) return sph__fail_memory(j->context);
    for (uint32_t i = 0; i < j->slot_count && status == SPH_OK; ++i) {
        slot *s = &j->slots[i];
        s->bounds = sph__alloc(j->context, vertices1 > vertices2 ? vertices1 : vertices2, sizeof *s->bounds);
        if (s->bounds == NULL) return sph__fail_memory(j->context);
        status = init_mesh(j, j->animation1, &s->mesh1, &j->slots[0].mesh1);
        if (status != SPH_OK) return status;
        status = j->level != NULL ? sph__outer_init(&s->outer, j->level)
                                  : init_mesh(j, j->animation2, &s->mesh2, &j->slots[0].mesh2);
    }
    return status;
}

static void free_slots(job *j)
{
    for (uint32_t i = 0; j->slots != NULL && i < j->slot_count; ++i) {
        sph__mesh_free(&j->slots[i].mesh1);
        sph__mesh_free(&j->slots[i].mesh2);
        sph__outer_free(&j->slots[i].outer);
        sph__free(j->context, j->slots[i].bounds);
    }
    sph__free(j->context, j->slots);
}

static void add_distances(sph_distances *sum, const sph_distances *d, double scale)
{
    sum->hausdorff += scale * d->hausdorff;
    sum->mean12 += scale * d->mean12;
    sum->mean21 += scale * d->mean21;
    sum->max12 += scale * d->max12;
    sum->max21 += scale * d->max21;
    sum->area1 += scale * d->area1;
    sum->area2 += scale * d->area2;
}

/* Frames are read on this thread, a batch at a time, and measured on any. */
static sph_status measure_batch(job *j, uint32_t begin, uint32_t count, sph_distances *sum, sph_distances *per_frame)
{
    sph_status status = SPH_OK;
    for (uint32_t i = 0; i < count; ++i) {
        slot *s = &j->slots[i];
        s->frame = j->options.first_frame + (begin + i) * j->options.frame_step;
        if ((status = read_frame(j, j->animation1, s->frame, &s->mesh1)) != SPH_OK) return status;
        if (j->animation2 == NULL) continue;
        if ((status = read_frame(j, j->animation2, s->frame, &s->mesh2)) != SPH_OK) return status;
    }
    sph__parallel_for(j->context, count, 1, measure_slots, j);
    for (uint32_t i = 0; i < count; ++i) {
        if (j->slots[i].status != SPH_OK) return sph__fail_memory(j->context);
        add_distances(sum, &j->slots[i].result, 1.0 / j->frame_count);
        if (per_frame != NULL) per_frame[begin + i] = j->slots[i].result;
    }
    return SPH_OK;
}

static sph_status run(job *j, const sph_measure_options *options, sph_distances *mean, sph_distances *per_frame)
{
    sph_distances sum = {0};
    sph__progress progress;
    sph_status status = read_options(j, options);
    if (status != SPH_OK) return status;
    sph__progress_begin(&progress, j->context);
    sph__progress_part(&progress, 1);
    status = sph__progress_report(&progress, "measure", 0);
    if (status == SPH_OK) status = init_slots(j);
    for (uint32_t begin = 0; begin < j->frame_count && status == SPH_OK; begin += j->slot_count) {
        const uint32_t left = j->frame_count - begin, count = left < j->slot_count ? left : j->slot_count;
        status = measure_batch(j, begin, count, &sum, per_frame);
        if (status == SPH_OK)
            status = sph__progress_report(&progress, "measure", (begin + count) / (double)j->frame_count);
    }
    free_slots(j);
    if (status == SPH_OK) *mean = sum;
    return status;
}

static sph_status check_mesh(const sph_context *context, const sph_animation *animation, const char *which)
{
    if (animation->triangle_count != 0) return SPH_OK;
    return sph__fail(context, SPH_E_INVALID, "%s has no triangles", which);
}

sph_status sph_measure_level(const sph_animation *animation, const sph_level *level, const sph_measure_options *options,
                             sph_distances *mean, sph_distances *per_frame)
{
    SPH__OWN(animation, SPH__ANIMATION);
    SPH__OWN(level, SPH__LEVEL);
    job j = {.animation1 = animation, .level = level};
    sph_status status;
    if (animation != NULL) j.context = animation->context;
    if (animation == NULL || level == NULL || mean == NULL)
        return sph__fail(j.context, SPH_E_INVALID, "sph_measure_level: an argument is NULL");
    if ((status = check_mesh(j.context, animation, "the animation")) != SPH_OK) return status;
    if (animation->frame_count != level->frame_count)
        return sph__fail(j.context, SPH_E_INVALID, "the animation has %u frames, the level %u",
                         (unsigned)animation->frame_count, (unsigned)level->frame_count);
    return run(&j, options, mean, per_frame);
}

sph_status sph_measure_meshes(const sph_animation *animation1, const sph_animation *animation2,
                              const sph_measure_options *options, sph_distances *mean, sph_distances *per_frame)
{
    SPH__OWN(animation1, SPH__ANIMATION);
    SPH__OWN(animation2, SPH__ANIMATION);
    job j = {.animation1 = animation1, .animation2 = animation2};
    sph_status status;
    if (animation1 != NULL) j.context = animation1->context;
    if (animation1 == NULL || animation2 == NULL || mean == NULL)
        return sph__fail(j.context, SPH_E_INVALID, "sph_measure_meshes: an argument is NULL");
    if ((status = check_mesh(j.context, animation1, "the first animation")) != SPH_OK) return status;
    if ((status = check_mesh(j.context, animation2, "the second animation")) != SPH_OK) return status;
    if (animation1->frame_count != animation2->frame_count)
        return sph__fail(j.context, SPH_E_INVALID, "the first animation has %u frames, the second %u",
                         (unsigned)animation1->frame_count, (unsigned)animation2->frame_count);
    return run(&j, options, mean, per_frame);
}
