/* SPDX-License-Identifier: MIT */
#include "rigging.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "program.h"
#include "report.h"

/* --- the level whose spheres are the bones --- */

static int take_level(session *s, const sph_hierarchy *h, uint32_t count, sph_level **out)
{
    const uint32_t least = coarsest_count(h), most = sph_hierarchy_vertex_count(h);
    sph_status status;
    if (count < least || count > most)
        return usage_error("skin", "--spheres: %u is not from %u to %u, which is what there is", count, least, most);
    status = sph_level_create(h, count, out);
    return status == SPH_OK ? DONE : session_fail(s, status, NULL);
}

static int load(session *s, const rigging_options *o, sph_level **out)
{
    sph_hierarchy *hierarchy = NULL;
    int32_t kind = SPH_IO_LEVEL;
    sph_status status = name_ends(o->level, ".sphm") ? sph_io_identify(s->context, o->level, &kind) : SPH_OK;
    int result;
    if (status != SPH_OK) return session_fail(s, status, o->level);
    if (kind == SPH_IO_LEVEL) {
        if (o->spheres != 0)
            return usage_error("skin", "--spheres: %s is a level, and has the spheres that it has", o->level);
        return load_level(s, o->level, out);
    }
    if (o->spheres == 0)
        return usage_error("skin", "--level: %s holds a hierarchy; say how many spheres: --spheres K", o->level);
    status = sph_io_load_hierarchy(s->context, o->level, &hierarchy);
    if (status != SPH_OK) return session_fail(s, status, o->level);
    result = take_level(s, hierarchy, o->spheres, out);
    sph_hierarchy_destroy(hierarchy);
    return result;
}

static int build(session *s, const rigging_options *o, const clips *c, rigging *r, sph_level **out)
{
    sph_hierarchy *hierarchy = NULL;
    sph_status status;
    int result;
    progress_start(&s->progress, "building");
    status = sph_hierarchy_create(c->all, NULL, &hierarchy);
    r->hierarchy_s = progress_end(&s->progress);
    if (status == SPH_OK && interrupted()) status = SPH_E_CANCELLED;
    result = status == SPH_OK ? take_level(s, hierarchy, o->spheres, out) : session_fail(s, status, NULL);
    sph_hierarchy_destroy(hierarchy);
    return result;
}

/* A level of the whole input, where clips begin in another frame: its spheres as they are in that. */
static int begin_at(session *s, const clips *c, const char *path, sph_level **level)
{
    sph_level_arrays a = {.struct_size = sizeof a};
    sph_level *moved = NULL;
    sph_status status = sph_level_get_arrays(*level, &a);
    const uint32_t whole = sph_animation_frame_count(c->whole);
    if (status == SPH_OK && a.frame_count != whole && a.frame_count != c->frame_count)
        return failure("%s: has %u frames, the input %u", path, a.frame_count, whole);
    if (status == SPH_OK && a.frame_count == whole && c->frames[0] != 0) {
        const size_t at = (size_t)c->frames[0] * a.sphere_count;
        a.centers += 3 * at;
        if (a.radii_per_frame) a.radii += at;
        a.radii_per_frame = 0;
        a.frame_count = 1;
        status = sph_level_create_from_arrays(s->context, &a, &moved);
        if (status == SPH_OK) {
            sph_level_destroy(*level);
            *level = moved;
        }
    }
    return status == SPH_OK ? DONE : session_fail(s, status, path);
}

/* --- weights as whole numbers, as the file will have them: so that the errors told are those of the file --- */

static void round_weights(const float *weights, uint32_t count, double one, float *out)
{
    double left = one;
    for (uint32_t i = 0; i < count; ++i) {
        out[i] = (float)floor((double)weights[i] * one);
        left -= (double)out[i];
    }
    for (; left >= 1; --left) {
        uint32_t best = 0;
        for (uint32_t i = 1; i < count; ++i)
            if ((double)weights[i] * one - (double)out[i] > (double)weights[best] * one - (double)out[best]) best = i;
        ++out[best];
    }
    for (uint32_t i = 0; i < count; ++i)
        out[i] /= (float)one;
}

static sph_status use_whole_numbers(session *s, rigging *r, int32_t weights)
{
    const uint32_t k = r->arrays.influence_count;
    const size_t n = r->arrays.vertex_count;
    sph_skin_arrays a = r->arrays;
    sph_skin *rounded = NULL;
    sph_status status;
    float *numbers = malloc(n * k * sizeof *numbers);
    if (numbers == NULL) return sph_context_fail(s->context, SPH_E_NOMEM, "out of memory");
    for (size_t v = 0; v < n; ++v)
        round_weights(a.weights + v * k, k, weights == SPH_IO_WEIGHTS_U8 ? 255 : 65535, numbers + v * k);
    a.weights = numbers;
    status = sph_skin_create_from_arrays(s->context, &a, &rounded);
    free(numbers);
    if (status != SPH_OK) return status;
    sph_skin_destroy(r->skin);
    r->skin = rounded;
    return sph_skin_get_arrays(r->skin, &r->arrays);
}

/* --- the skin --- */

static uint32_t count_influences(const sph_skin_arrays *a)
{
    uint32_t most = 1;
    for (size_t v = 0; v < a->vertex_count; ++v)
        while (most < a->influence_count && a->weights[v * a->influence_count + most] > 0)
            ++most;
    return most;
}

static sph_status solve(session *s, const rigging_options *o, const clips *c, const sph_level *level, rigging *r)
{
    sph_status status;
    progress_start(&s->progress, "rigging");
    status = sph_skin_create(level, c->sources, c->count, &o->skin, &r->skin);
    r->arrays.struct_size = sizeof r->arrays;
    if (status == SPH_OK) status = sph_skin_get_arrays(r->skin, &r->arrays);
    if (status == SPH_OK) {
        r->frames = malloc(r->arrays.frame_count * sizeof *r->frames);
        if (r->frames == NULL) status = sph_context_fail(s->context, SPH_E_NOMEM, "out of memory");
    }
    if (status == SPH_OK && o->file.weights == SPH_IO_WEIGHTS_FLOAT) {
        status = sph_skin_get_errors(r->skin, &r->error, r->frames);
    } else if (status == SPH_OK) {
        status = use_whole_numbers(s, r, o->file.weights);
        if (status == SPH_OK) status = sph_skin_measure(r->skin, c->sources, c->count, &r->error, r->frames);
    }
    r->skin_s = progress_end(&s->progress);
    if (status == SPH_OK) r->influences = count_influences(&r->arrays);
    return status;
}

int rigging_make(session *s, const rigging_options *o, const clips *c, rigging *out)
{
    sph_level *level = NULL;
    sph_status status;
    int result;
    *out = (rigging){.hierarchy_s = -1};
    result = o->level == NULL ? build(s, o, c, out, &level) : load(s, o, &level);
    if (result == DONE && o->level != NULL) result = begin_at(s, c, o->level, &level);
    if (result == DONE) {
        status = solve(s, o, c, level, out);
        if (status == SPH_OK && interrupted()) status = SPH_E_CANCELLED;
        if (status != SPH_OK) result = session_fail(s, status, o->level);
    }
    sph_level_destroy(level);
    return result;
}

int rigging_save(session *s, const rigging_options *o, rigging *r, const char *path)
{
    sph_skeleton_arrays a = {.struct_size = sizeof a};
    sph_skeleton *skeleton = NULL;
    sph_status status;
    if (o->joints.root == SPH_ROOT_GIVEN && o->joints.root_bone >= r->arrays.bone_count)
        return usage_error("skin", "--root: there are bones 0 to %u", r->arrays.bone_count - 1);
    progress_start(&s->progress, "writing");
    status = sph_skeleton_create(r->skin, &o->joints, &skeleton);
    if (status == SPH_OK) status = sph_skeleton_get_arrays(skeleton, &a);
    r->joint_count = a.joint_count;
    if (status == SPH_OK) status = sph_io_save_rig(s->context, r->skin, skeleton, &o->file, path);
    progress_end(&s->progress);
    sph_skeleton_destroy(skeleton);
    return status == SPH_OK ? DONE : session_fail(s, status, path);
}

void rigging_free(rigging *r)
{
    sph_skin_destroy(r->skin);
    free(r->frames);
    *r = (rigging){0};
}

sph_skin_error rigging_clip_error(const rigging *r, uint32_t clip)
{
    const sph_skin_clip *c = &r->arrays.clips[clip];
    sph_skin_error all = {.diagonal = r->error.diagonal};
    for (uint32_t f = c->first_frame; f < c->first_frame + c->frame_count; ++f) {
        const sph_skin_error *e = &r->frames[f];
        all.mse += e->mse / c->frame_count;
        all.rmse += e->rmse * e->rmse / c->frame_count;
        if (f > c->first_frame && e->max <= all.max) continue;
        all.max = e->max;
        all.max_percent = e->max_percent;
        all.max_vertex = e->max_vertex;
        all.max_frame = f - c->first_frame;
    }
    all.rmse = sqrt(all.rmse);
    all.rmse_percent = all.diagonal > 0 ? 100 * all.rmse / all.diagonal : 0;
    return all;
}

uint64_t rigging_bytes(const char *path)
{
    uint64_t bytes = file_size(path);
    if (name_ends(path, ".gltf")) {
        const size_t stem = strlen(path) - 4;
        char *beside = malloc(stem + 4);
        if (beside != NULL) {
            memcpy(beside, path, stem);
            memcpy(beside + stem, "bin", 4);
            bytes += file_size(beside);
        }
        free(beside);
    }
    return bytes;
}
