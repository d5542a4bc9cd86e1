/* SPDX-License-Identifier: MIT */
/* Levels for other tools: what is asked for, and who writes it. */
#include "io/level_export.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { OPTIONS_V1 = offsetof(sph_io_export_options, coverage) + sizeof(const sph_coverage *), NAME_SIZE = 100 };
static const double GAP_SHARE = 0.02;

static const sph_io_export_options DEFAULTS = {.struct_size = sizeof(sph_io_export_options), .frame_step = 1};

static const struct {
    const char *ending;
    int32_t format;
    bool one_frame;
    sph__io_export_fn *write;
} FORMATS[] = {{"json", SPH_IO_EXPORT_PRIMITIVES, false, sph__io_export_primitives},
               {"ma", SPH_IO_EXPORT_MA, true, sph__io_export_ma},
               {"srdf", SPH_IO_EXPORT_SRDF, true, sph__io_export_srdf},
               {"yaml", SPH_IO_EXPORT_YAML, true, sph__io_export_yaml},
               {"yml", SPH_IO_EXPORT_YAML, true, sph__io_export_yaml},
               {"urdf", SPH_IO_EXPORT_URDF, true, sph__io_export_urdf},
               {"glb", SPH_IO_EXPORT_GLB, false, sph__io_export_glb}};
enum { FORMAT_COUNT = sizeof FORMATS / sizeof *FORMATS };

void sph_io_export_options_init(sph_io_export_options *options, size_t size)
{
    const uint32_t struct_size = (uint32_t)size;
    if (options == NULL || size < OPTIONS_V1 || size > UINT32_MAX) return;
    memset(options, 0, size); /* a newer caller's tail becomes 0 */
    memcpy(options, &DEFAULTS, size < sizeof DEFAULTS ? size : sizeof DEFAULTS);
    memcpy(options, &struct_size, sizeof struct_size);
}

static bool is_name(const char *name)
{
    const size_t length = strlen(name);
    for (size_t i = 0; i < length; ++i)
        if (name[i] < ' ' || name[i] > '~' || strchr("\"'<>&\\", name[i]) != NULL) return false;
    return length > 0 && length <= NAME_SIZE;
}

static sph_status read_options(sph_context *context, const sph_io_export_options *in, sph_io_export_options *o)
{
    *o = DEFAULTS;
    if (in != NULL) {
        if (in->struct_size < OPTIONS_V1)
            return sph__io_fail(context, SPH_E_INVALID,
                                "sph_io_export_options was not initialised: struct_size is %u, at least %d is needed",
                                (unsigned)in->struct_size, OPTIONS_V1);
        for (size_t i = sizeof *o; i < in->struct_size; ++i)
            if (((const unsigned char *)in)[i] != 0)
                return sph__io_fail(context, SPH_E_VERSION,
                                    "sph_io_export_options has a field set (byte %zu) that this version does not know",
                                    i);
        memcpy(o, in, in->struct_size < sizeof *o ? in->struct_size : sizeof *o);
    }
    if (o->flags != 0 || o->reserved0 != 0 || o->cover_solid > 1)
        return sph__io_fail(context, SPH_E_INVALID,
                            "sph_io_export_options: flags and reserved0 must be 0, cover_solid 0 or 1");
    if (o->frame_step == 0) return sph__io_fail(context, SPH_E_INVALID, "the step between frames is 0");
    if (!isfinite(o->gap) || o->gap < 0)
        return sph__io_fail(context, SPH_E_INVALID, "sph_io_export_options: gap is %g", o->gap);
    if (o->name != NULL && !is_name(o->name))
        return sph__io_fail(context, SPH_E_INVALID,
                            "the name of a link has 1 to %d printable characters, none of \" ' < > & \\", NAME_SIZE);
    if (o->coverage != NULL && o->coverage->struct_size != sizeof *o->coverage)
        return sph__io_fail(context, SPH_E_INVALID, "sph_coverage: struct_size is %u, not %zu",
                            (unsigned)o->coverage->struct_size, sizeof *o->coverage);
    return SPH_OK;
}

/* Place in FORMATS, or FORMAT_COUNT. */
static size_t find_format(const char *path, int32_t format)
{
    for (size_t i = 0; i < FORMAT_COUNT; ++i)
        if (format == SPH_IO_EXPORT_BY_NAME ? sph__io_has_ending(path, FORMATS[i].ending)
                                            : format == FORMATS[i].format)
            return i;
    return FORMAT_COUNT;
}

/* --- the frames that were picked --- */

/* Diagonal of the box around the spheres of the first frame. */
static double extent(const sph_level_arrays *a)
{
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
        double low = DBL_MAX, high = -DBL_MAX;
        for (size_t i = 0; i < a->sphere_count; ++i) {
            low = fmin(low, (double)a->centers[3 * i + (size_t)k] - a->radii[i]);
            high = fmax(high, (double)a->centers[3 * i + (size_t)k] + a->radii[i]);
        }
        sum += (high - low) * (high - low);
    }
    return sqrt(sum);
}

/* Copies of the arrays, of these frames; `memory` is to be released. */
static sph_status pick_frames(sph__io_export *e, uint32_t count, float **memory)
{
    const sph_level_arrays *a = &e->a;
    const size_t spheres = a->sphere_count;
    float *centers, *radii;
    if (e->first_frame == 0 && (e->frame_step == 1 || count == 1)) { /* they are the first ones */
        e->a.frame_count = count;
        return SPH_OK;
    }
    /* no more than the level holds itself */
    centers = sph_context_allocate(e->context, 4 * spheres * count, sizeof *centers);
    if (centers == NULL) return sph__io_fail(e->context, SPH_E_NOMEM, "out of memory");
    radii = centers + 3 * spheres * count;
    for (size_t f = 0; f < count; ++f) {
        const size_t from = e->first_frame + f * e->frame_step;
        memcpy(centers + 3 * spheres * f, a->centers + 3 * spheres * from, 3 * spheres * sizeof *centers);
        if (a->radii_per_frame)
            memcpy(radii + spheres * f, a->radii + spheres * from, spheres * sizeof *radii);
    }
    e->a.frame_count = count;
    e->a.centers = centers;
    if (a->radii_per_frame) e->a.radii = radii;
    *memory = centers;
    return SPH_OK;
}

static sph_status choose_frames(sph__io_export *e, const sph_io_export_options *o, bool one_frame, float **memory)
{
    uint32_t count;
    if (o->first_frame >= e->a.frame_count)
        return sph__io_fail(e->context, SPH_E_INVALID, "first_frame is %u, the level has %u frames",
                            (unsigned)o->first_frame, (unsigned)e->a.frame_count);
    count = (e->a.frame_count - o->first_frame - 1) / o->frame_step + 1;
    if (o->frame_limit != 0 && o->frame_limit < count) count = o->frame_limit;
    if (one_frame && count > 1) {
        if (o->frame_limit > 1)
            return sph__io_fail(e->context, SPH_E_INVALID, "%u frames, for a file that holds one",
                                (unsigned)o->frame_limit);
        count = 1;
    }
    e->first_frame = o->first_frame;
    e->frame_step = o->frame_step;
    return pick_frames(e, count, memory);
}

/* --- the whole --- */

static sph_status write_file(sph__io_export *e, const char *path, sph__io_export_fn *write)
{
    sph__io_output output;
    sph_status status = sph__io_output_open(e->context, path, &output);
    if (status != SPH_OK) return status;
    write(&output, e);
    status = sph__io_output_finish(&output);
    if (status == SPH_OK) status = sph__io_output_commit(&output);
    sph__io_output_release(&output);
    return status;
}

static sph_status count_primitives(sph__io_export *e)
{
    bool *used = sph__io_export_used(e);
    if (used == NULL) return sph__io_fail(e->context, SPH_E_NOMEM, "out of memory");
    for (uint32_t i = 0; i < e->a.sphere_count; ++i)
        e->report->sphere_count += !used[i];
    sph_context_release(e->context, used);
    e->report->capsule_count = e->a.edge_count;
    e->report->triangle_count = e->a.triangle_count;
    e->report->frame_count = e->a.frame_count;
    return SPH_OK;
}

sph_status sph_io_export_level(sph_context *context, const sph_level *level, const char *path,
                               const sph_io_export_options *options, sph_io_export_report *report)
{
    SPH__IO_OWN(context, sph_context_memory_used);
    SPH__IO_OWN(level, sph_level_sphere_count);
    sph_io_export_report done = {.struct_size = sizeof done};
    sph__io_export e = {.context = context, .a = {.struct_size = sizeof e.a}, .report = &done};
    sph_io_export_options o;
    float *memory = NULL;
    size_t format;
    sph_status status;
    if (context == NULL || level == NULL || path == NULL)
        return sph_context_fail(context, SPH_E_INVALID, "sph_io_export_level: an argument is NULL");
    if (report != NULL && report->struct_size != sizeof *report)
        return sph__io_fail(context, SPH_E_INVALID, "sph_io_export_report: struct_size is %u, not %zu",
                            (unsigned)report->struct_size, sizeof *report);
    if ((status = read_options(context, options, &o)) != SPH_OK) return status;
    if ((format = find_format(path, o.format)) == FORMAT_COUNT)
        return sph__io_fail(context, o.format == SPH_IO_EXPORT_BY_NAME ? SPH_E_UNSUPPORTED : SPH_E_INVALID,
                            "%s: levels are exported as .json, .ma, .srdf, .yaml, .urdf or .glb", sph__io_shown(path));
    if ((status = sph_level_get_arrays(level, &e.a)) != SPH_OK) return status;
    e.name = o.name == NULL ? "sphmesh" : o.name;
    e.cover_solid = o.cover_solid == 1;
    e.coverage = o.coverage;
    status = choose_frames(&e, &o, FORMATS[format].one_frame, &memory);
    if (status == SPH_OK) {
        e.gap = o.gap > 0 ? o.gap : GAP_SHARE * extent(&e.a);
        status = count_primitives(&e);
    }
    if (status == SPH_OK) status = write_file(&e, path, FORMATS[format].write);
    sph_context_release(context, memory);
    if (status == SPH_OK && report != NULL) *report = done;
    return status;
}
