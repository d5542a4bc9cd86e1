/* SPDX-License-Identifier: MIT */
/* A rig that was read: its options, its memory, and what it tells. */
#include <math.h>
#include <string.h>

#include "io/rig_open.h"

static const sph_io_open_rig_options DEFAULTS = {.struct_size = sizeof(sph_io_open_rig_options), .frame_step = 1};
enum { OPTIONS_V1 = offsetof(sph_io_open_rig_options, reserved0) + sizeof(uint32_t) };
_Static_assert(sizeof(void *) != 8 || OPTIONS_V1 == 40, "a field of 0.1 moved");

void sph_io_open_rig_options_init(sph_io_open_rig_options *options, size_t size)
{
    const uint32_t struct_size = (uint32_t)size;
    if (options == NULL || size < OPTIONS_V1 || size > UINT32_MAX) return;
    memset(options, 0, size); /* a newer caller's tail becomes 0 */
    memcpy(options, &DEFAULTS, size < sizeof DEFAULTS ? size : sizeof DEFAULTS);
    memcpy(options, &struct_size, sizeof struct_size);
}

sph_status sph__io_rig_read_options(sph_context *context, const sph_io_open_rig_options *in, sph_io_open_rig_options *o)
{
    *o = DEFAULTS;
    o->fps = SPH__IO_FPS;
    if (in == NULL) return SPH_OK;
    if (in->struct_size < OPTIONS_V1)
        return sph__io_fail(context, SPH_E_INVALID,
                            "sph_io_open_rig_options was not initialised: struct_size is %u, at least %d is needed",
                            (unsigned)in->struct_size, OPTIONS_V1);
    for (size_t i = sizeof *o; i < in->struct_size; ++i)
        if (((const unsigned char *)in)[i] != 0)
            return sph__io_fail(context, SPH_E_VERSION,
                                "sph_io_open_rig_options has a field set (byte %zu) that this version does not know",
                                i);
    memcpy(o, in, in->struct_size < sizeof *o ? in->struct_size : sizeof *o);
    if (o->flags != 0 || o->reserved0 != 0)
        return sph__io_fail(context, SPH_E_INVALID, "sph_io_open_rig_options: flags and reserved0 must be 0");
    if (o->frame_step == 0) return sph__io_fail(context, SPH_E_INVALID, "the step between frames is 0");
    if (o->end_frame != 0 && o->end_frame <= o->first_frame)
        return sph__io_fail(context, SPH_E_INVALID, "frames %u to before %u: none", (unsigned)o->first_frame,
                            (unsigned)o->end_frame);
    if (!isfinite(o->fps) || o->fps < 0)
        return sph__io_fail(context, SPH_E_INVALID, "%g frames per second: not finite, or negative", o->fps);
    if (o->fps == 0) o->fps = SPH__IO_FPS;
    return SPH_OK;
}

void sph_io_rig_destroy(sph_io_rig *rig)
{
    SPH__IO_OWN_MARKED(rig, SPH__IO_RIG);
    sph_context *context;
    sph_skin *skin;
    if (rig == NULL) return;
    context = rig->context;
    skin = rig->skin;
    for (uint32_t i = 0; i < rig->name_count; ++i)
        sph_context_release(context, rig->node_names[i]);
    sph_context_release(context, rig->node_names);
    sph_context_release(context, rig->names);
    sph_context_release(context, rig->nodes);
    sph_context_release(context, rig->parents);
    sph_context_release(context, rig->inverse_bind);
    sph_context_release(context, rig->joints_rest);
    sph_context_release(context, rig->joints);
    sph_context_release(context, rig->edges);
    SPH__IO_SET_MARK(rig, SPH__IO_DESTROYED);
    sph_context_release(context, rig);
    sph_skin_destroy(skin); /* may be the last to hold the context */
}

const sph_skin *sph_io_rig_skin(const sph_io_rig *rig)
{
    SPH__IO_OWN_MARKED(rig, SPH__IO_RIG);
    return rig == NULL ? NULL : rig->skin;
}

sph_status sph_io_rig_get_arrays(const sph_io_rig *rig, sph_io_rig_arrays *arrays)
{
    SPH__IO_OWN_MARKED(rig, SPH__IO_RIG);
    if (rig == NULL || arrays == NULL)
        return sph_context_fail(rig == NULL ? NULL : rig->context, SPH_E_INVALID,
                                "sph_io_rig_get_arrays: an argument is NULL");
    if (arrays->struct_size != sizeof *arrays)
        return sph__io_fail(rig->context, SPH_E_INVALID, "sph_io_rig_arrays: struct_size is %u, not %zu",
                            (unsigned)arrays->struct_size, sizeof *arrays);
    *arrays = (sph_io_rig_arrays){.struct_size = sizeof *arrays,
                                  .bone_count = rig->bone_count,
                                  .frame_count = rig->frame_count,
                                  .morphs = rig->morphs,
                                  .names = rig->names,
                                  .nodes = rig->nodes,
                                  .parents = rig->parents,
                                  .inverse_bind = rig->inverse_bind,
                                  .joints_rest = rig->joints_rest,
                                  .joints = rig->joints,
                                  .edge_count = rig->edge_count,
                                  .edges = rig->edge_count == 0 ? NULL : rig->edges};
    return SPH_OK;
}
