/* SPDX-License-Identifier: MIT */
/* Animations as OBJ with a PC2 or MDD cache. */
#include <math.h>
#include <string.h>

#include "io/bytes.h"
#include "io/io.h"

/* A cache: what comes before its frames, from the two numbers that the caller gives, and its byte order. */
typedef struct cache_format {
    void (*write_header)(sph__io_output *o, const sph_animation *animation, double first, double rate);
    bool big;
} cache_format;

static void write_pc2_header(sph__io_output *o, const sph_animation *animation, double first, double rate)
{
    unsigned char header[32] = "POINTCACHE2";
    sph__io_store_32(header + 12, 1, false);
    sph__io_store_32(header + 16, sph_animation_vertex_count(animation), false);
    sph__io_store_float(header + 20, (float)first, false);
    sph__io_store_float(header + 24, (float)rate, false);
    sph__io_store_32(header + 28, sph_animation_frame_count(animation), false);
    sph__io_output_bytes(o, header, sizeof header);
}

static void write_mdd_header(sph__io_output *o, const sph_animation *animation, double first, double rate)
{
    const uint32_t frames = sph_animation_frame_count(animation);
    unsigned char bytes[8];
    sph__io_store_32(bytes, frames, true);
    sph__io_store_32(bytes + 4, sph_animation_vertex_count(animation), true);
    sph__io_output_bytes(o, bytes, 8);
    for (uint32_t f = 0; f < frames; ++f) {
        sph__io_store_float(bytes, (float)(first + f / rate), true);
        sph__io_output_bytes(o, bytes, 4);
    }
}

static const cache_format PC2 = {write_pc2_header, false}, MDD = {write_mdd_header, true};

static void write_cache_frame(sph__io_output *o, const float *xyz, size_t vertex_count, bool big)
{
    for (size_t i = 0; i < 3 * vertex_count; ++i) {
        unsigned char bytes[4];
        sph__io_store_float(bytes, xyz[i], big);
        sph__io_output_bytes(o, bytes, sizeof bytes);
    }
}

static void write_obj(sph__io_output *o, const sph_animation *animation, const float *xyz)
{
    const uint32_t *triangles = sph_animation_triangles(animation), *edges = sph_animation_edges(animation);
    const size_t n = sph_animation_vertex_count(animation);
    for (size_t i = 0; i < n; ++i) {
        sph__io_output_text(o, "v ");
        sph__io_output_floats(o, xyz + 3 * i, 3);
        sph__io_output_text(o, "\n");
    }
    for (size_t i = 0; i < sph_animation_triangle_count(animation); ++i)
        sph__io_output_text(o, "f %u %u %u\n", (unsigned)triangles[3 * i] + 1, (unsigned)triangles[3 * i + 1] + 1,
                            (unsigned)triangles[3 * i + 2] + 1);
    for (size_t i = 0; i < sph_animation_edge_count(animation); ++i)
        sph__io_output_text(o, "l %u %u\n", (unsigned)edges[2 * i] + 1, (unsigned)edges[2 * i + 1] + 1);
}

static sph_status write_frames(sph_context *context, const sph_animation *animation, float *xyz, sph__io_output *obj,
                               sph__io_output *cache, bool big)
{
    const uint32_t frames = sph_animation_frame_count(animation);
    for (uint32_t f = 0; f < frames; ++f) {
        sph_status status = sph_context_report_progress(context, "writing frames", (double)f / frames);
        if (status == SPH_OK) status = sph_animation_read_frame(animation, f, xyz);
        if (status != SPH_OK) return status;
        if (f == 0) write_obj(obj, animation, xyz);
        write_cache_frame(cache, xyz, sph_animation_vertex_count(animation), big);
        if (obj->status != SPH_OK) return obj->status;
        if (cache->status != SPH_OK) return cache->status;
    }
    return SPH_OK;
}

static sph_status save(sph_context *context, const sph_animation *animation, const cache_format *format, double first,
                       double rate, const char *obj_path, const char *cache_path)
{
    sph__io_output obj = {.file = -1}, cache = {.file = -1};
    sph_status status;
    float *xyz;
    if (context == NULL || animation == NULL || obj_path == NULL || cache_path == NULL)
        return sph_context_fail(context, SPH_E_INVALID, "an animation to save, or one of its paths, is NULL");
    if (!isfinite((float)first) || !isfinite((float)rate) || !((float)rate > 0))
        return sph__io_fail(context, SPH_E_INVALID, "a cache from %s %g with %g frames per %s",
                            format->big ? "second" : "frame", first, rate, format->big ? "second" : "sample");
    if (strcmp(obj_path, cache_path) == 0)
        return sph__io_fail(context, SPH_E_INVALID, "%s: both the mesh and its cache", sph__io_shown(obj_path));
    xyz = sph_context_allocate(context, sph_animation_vertex_count(animation), 3 * sizeof *xyz);
    if (xyz == NULL) return sph__io_fail_memory(context, obj_path);
    status = sph__io_output_open(context, obj_path, &obj);
    if (status == SPH_OK) status = sph__io_output_open(context, cache_path, &cache);
    if (status == SPH_OK) {
        format->write_header(&cache, animation, first, rate);
        status = write_frames(context, animation, xyz, &obj, &cache, format->big);
    }
    if (status == SPH_OK) status = sph__io_output_finish(&obj);
    if (status == SPH_OK) status = sph__io_output_finish(&cache);
    if (status == SPH_OK) status = sph__io_output_commit(&obj);
    if (status == SPH_OK) status = sph__io_output_commit(&cache);
    sph__io_output_release(&obj);
    sph__io_output_release(&cache);
    sph_context_release(context, xyz);
    return status;
}

sph_status sph_io_save_obj_pc2(sph_context *context, const sph_animation *animation, double first_frame,
                               double frames_per_sample, const char *obj_path, const char *pc2_path)
{
    SPH__IO_OWN(context, sph_context_memory_used);
    SPH__IO_OWN(animation, sph_animation_vertex_count);
    return save(context, animation, &PC2, first_frame, frames_per_sample, obj_path, pc2_path);
}

sph_status sph_io_save_obj_mdd(sph_context *context, const sph_animation *animation, double first_second,
                               double frames_per_second, const char *obj_path, const char *mdd_path)
{
    SPH__IO_OWN(context, sph_context_memory_used);
    SPH__IO_OWN(animation, sph_animation_vertex_count);
    return save(context, animation, &MDD, first_second, frames_per_second, obj_path, mdd_path);
}
