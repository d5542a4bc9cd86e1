/* SPDX-License-Identifier: MIT */
/* The set-up: its options, its making, and what it tells. */
#include <math.h>

#include "implicit/setup.h"

static const double PI = 3.14159265358979323846;
static const sph_implicit_options DEFAULTS = {.struct_size = sizeof(sph_implicit_options),
                                              .sample_count = 50,
                                              .table_size = 32,
                                              .operator_table_size = 128,
                                              .joint_gap = 0.05};
enum { OPTIONS_V1 = offsetof(sph_implicit_options, joint_count) + sizeof(size_t) };
_Static_assert(sizeof(void *) != 8 || OPTIONS_V1 == 64, "a field of 0.1 moved");

void sph_implicit_options_init(sph_implicit_options *options, size_t size)
{
    sph__options_init(options, size, &DEFAULTS, sizeof DEFAULTS, OPTIONS_V1);
}

static void free_field(const sph_context *context, const sph__field *f)
{
    sph__free(context, f->samples);
    sph__free(context, f->normals);
    sph__free(context, f->centers);
    sph__free(context, f->table);
}

void sph_implicit_destroy(sph_implicit *implicit)
{
    SPH__OWN(implicit, SPH__IMPLICIT);
    sph_context *context;
    if (implicit == NULL) return;
    context = implicit->context;
    for (size_t b = 0; implicit->fields != NULL && b < implicit->bone_count; ++b)
        free_field(context, implicit->fields + b);
    for (size_t t = 0; implicit->tables != NULL && t < implicit->joint_count; ++t)
        sph__free(context, implicit->tables[t].values);
    sph__free(context, implicit->fields);
    sph__free(context, implicit->joints);
    sph__free(context, implicit->tables);
    sph__free(context, implicit);
    sph__context_release(context);
}

sph_status sph__implicit_allocate(sph_context *context, uint32_t bone_count, uint32_t joint_count, sph_implicit **out)
{
    sph_implicit *i = sph__new(context, sizeof *i, SPH__IMPLICIT);
    if (i == NULL) return sph__fail_memory(context);
    i->context = sph__context_retain(context);
    i->bone_count = bone_count;
    i->joint_count = joint_count;
    i->fields = sph__zalloc(context, bone_count, sizeof *i->fields);
    i->joints = sph__zalloc(context, joint_count, sizeof *i->joints);
    i->tables = sph__zalloc(context, joint_count, sizeof *i->tables);
    for (uint32_t j = 0; j < joint_count && i->joints != NULL; ++j)
        i->joints[j].table = SPH__NO_PART;
    *out = i;
    return i->fields == NULL || i->joints == NULL || i->tables == NULL ? sph__fail_memory(context) : SPH_OK;
}

/* --- checks --- */

static bool in_range(double x, double low, double high)
{
    return x >= low && x <= high; /* false for a NaN */
}

static bool is_curve(const sph_theta_curve *c)
{
    const double *a = c->angles;
    for (int i = 0; i < 3; ++i)
        if (!in_range(c->thetas[i], 0, SPH__UNION_THETA + 1e-12)) return false;
    return in_range(a[0], 0, PI + 1e-12) && in_range(a[1], a[0], PI + 1e-12) && in_range(a[2], a[1], PI + 1e-12) &&
           in_range(c->exponents[0], 0.01, 100) && in_range(c->exponents[1], 0.01, 100);
}

sph_status sph__joint_check(const sph_context *context, const sph_implicit_joint *j, uint32_t bone_count,
                            const char *what, size_t index)
{
    const sph_status bad = SPH_E_INVALID;
    if (j->struct_size != sizeof *j)
        return sph__fail(context, bad, "%s %zu: struct_size is %u", what, index, (unsigned)j->struct_size);
    if (j->operation < SPH_OPERATION_UNION || j->operation > SPH_OPERATION_BULGE)
        return sph__fail(context, bad, "%s %zu: operation is %d", what, index, (int)j->operation);
    if (j->bones[0] >= bone_count || j->bones[1] >= bone_count || j->bones[0] == j->bones[1])
        return sph__fail(context, bad, "%s %zu: its bones are %u and %u, of %u", what, index, (unsigned)j->bones[0],
                         (unsigned)j->bones[1], (unsigned)bone_count);
    for (int c = 0; c < 3; ++c)
        if (!isfinite(j->position[c]))
            return sph__fail(context, bad, "%s %zu: its position is not finite", what, index);
    if (!in_range(j->strength, 0, SPH_BULGE_LIMIT))
        return sph__fail(context, bad, "%s %zu: strength is %g", what, index, j->strength);
    if (!is_curve(&j->curve)) return sph__fail(context, bad, "%s %zu: its curve is out of range", what, index);
    return SPH_OK;
}

static sph_status check_numbers(const sph_context *context, const sph_implicit_options *o)
{
    const char *what = NULL;
    if (o->flags != 0) what = "flags";
    if (o->sample_count < 4 || o->sample_count > 400) what = "sample_count";
    if (o->operation < SPH_OPERATION_UNION || o->operation > SPH_OPERATION_BULGE) what = "operation";
    if (o->table_size < 8 || o->table_size > 128) what = "table_size";
    if (o->operator_table_size < 8 || o->operator_table_size > 256) what = "operator_table_size";
    if (!in_range(o->joint_gap, 0, 0.4)) what = "joint_gap";
    if (o->joint_count != 0 && o->joints == NULL) what = "joint_count";
    return what == NULL ? SPH_OK : sph__fail(context, SPH_E_INVALID, "sph_implicit_options: %s is out of range", what);
}

static sph_status read_options(const sph_skin *skin, const sph_implicit_options *in, sph_implicit_options *o)
{
    sph_status status;
    *o = DEFAULTS;
    status = sph__options_read(skin->context, "sph_implicit_options", in, o, sizeof *o, OPTIONS_V1);
    if (status == SPH_OK) status = check_numbers(skin->context, o);
    for (size_t v = 0; status == SPH_OK && o->parts != NULL && v < skin->vertex_count; ++v)
        if (o->parts[v] != SPH__NO_PART && o->parts[v] >= skin->bone_count)
            return sph__fail(skin->context, SPH_E_INVALID, "vertex %zu belongs to bone %u, of %u", v,
                             (unsigned)o->parts[v], (unsigned)skin->bone_count);
    return status;
}

/* --- making --- */

/* The joints whose both bones have come to have a field. */
static sph_status keep_joints(sph__setup *s, sph_implicit **out)
{
    uint32_t count = 0;
    sph__field *fields = s->implicit->fields;
    sph_implicit *i;
    sph_status status;
    for (uint32_t j = 0; j < s->joint_count; ++j)
        if (fields[s->joints[j].bones[0]].count > 0 && fields[s->joints[j].bones[1]].count > 0)
            s->joints[count++] = s->joints[j];
    status = sph__implicit_allocate(s->skin->context, s->skin->bone_count, count, out);
    if (status != SPH_OK) return status;
    i = *out;
    s->implicit->fields = i->fields; /* empty ones, for those that were made */
    i->fields = fields;
    i->table_size = s->options->table_size;
    i->operator_table_size = s->options->operator_table_size;
    for (uint32_t j = 0; j < count; ++j)
        i->joints[j].given = s->joints[j];
    return sph__implicit_tabulate(i);
}

sph_status sph__implicit_tabulate(sph_implicit *i)
{
    sph_status status = SPH_OK;
    for (size_t b = 0; b < i->bone_count && status == SPH_OK; ++b)
        status = sph__field_tabulate(i->context, i->fields + b, i->table_size);
    for (size_t j = 0; j < i->joint_count && status == SPH_OK; ++j)
        status = sph__joint_tabulate(i, i->joints + j);
    return status;
}

static void free_setup(sph__setup *s)
{
    const sph_context *context = s->skin->context;
    sph__shell_free(&s->shell);
    sph__free(context, s->owners);
    sph__free(context, s->starts);
    sph__free(context, s->members);
    sph__free(context, s->node_starts);
    sph__free(context, s->signs);
    sph__free(context, s->joints);
    sph__free(context, s->upper);
    sph__free(context, s->openings);
    sph_implicit_destroy(s->implicit);
}

sph_status sph_implicit_create(const sph_skin *skin, const sph_implicit_options *options, sph_implicit **out)
{
    SPH__OWN(skin, SPH__SKIN);
    sph_implicit_options o;
    sph__setup s = {.skin = skin, .options = &o};
    sph__progress progress;
    sph_status status;
    if (out != NULL) *out = NULL;
    if (skin == NULL || out == NULL)
        return sph__fail(skin == NULL ? NULL : skin->context, SPH_E_INVALID,
                         "sph_implicit_create: an argument is NULL");
    if ((status = read_options(skin, options, &o)) != SPH_OK) return status;
    sph__progress_begin(&progress, skin->context);
    sph__progress_part(&progress, 1);
    status = sph__implicit_allocate(skin->context, skin->bone_count, 0, &s.implicit);
    if (status == SPH_OK) status = sph__shell_init(&s.shell, skin, o.parts);
    if (status == SPH_OK) status = sph__setup_parts(&s);
    if (status == SPH_OK) status = sph__setup_joints(&s);
    if (status == SPH_OK) status = sph__progress_report(&progress, "fitting fields", 0.1);
    if (status == SPH_OK) {
        sph__parallel_for(skin->context, skin->bone_count, 1, sph__setup_fields, &s);
        if (s.out_of_memory) status = sph__fail_memory(skin->context);
    }
    if (status == SPH_OK) status = sph__progress_report(&progress, "fitting fields", 0.8);
    if (status == SPH_OK) status = keep_joints(&s, out);
    free_setup(&s);
    if (status != SPH_OK) {
        sph_implicit_destroy(*out);
        *out = NULL;
    }
    return status;
}

/* --- what it tells --- */

uint32_t sph_implicit_bone_count(const sph_implicit *implicit)
{
    SPH__OWN(implicit, SPH__IMPLICIT);
    return implicit == NULL ? 0 : implicit->bone_count;
}

uint32_t sph_implicit_joint_count(const sph_implicit *implicit)
{
    SPH__OWN(implicit, SPH__IMPLICIT);
    return implicit == NULL ? 0 : implicit->joint_count;
}

sph_status sph_implicit_get_part(const sph_implicit *implicit, uint32_t bone, sph_implicit_part *part)
{
    SPH__OWN(implicit, SPH__IMPLICIT);
    const sph__field *f;
    if (implicit == NULL || part == NULL || part->struct_size != sizeof *part || bone >= implicit->bone_count)
        return sph__fail(implicit == NULL ? NULL : implicit->context, SPH_E_INVALID,
                         "sph_implicit_get_part: NULL, a size that is not known, or no bone %u", (unsigned)bone);
    f = implicit->fields + bone;
    *part = (sph_implicit_part){.struct_size = sizeof *part,
                                .vertex_count = f->vertex_count,
                                .sample_count = f->count,
                                .closing_count = f->closing_count,
                                .radius = f->count > 0 ? f->radius : 0,
                                .samples = f->samples,
                                .normals = f->normals};
    for (int c = 0; c < 3 && f->count > 0; ++c) {
        part->low[c] = f->low[c];
        part->high[c] = f->high[c];
    }
    return SPH_OK;
}

sph_status sph_implicit_get_joint(const sph_implicit *implicit, uint32_t index, sph_implicit_joint *joint)
{
    SPH__OWN(implicit, SPH__IMPLICIT);
    if (implicit == NULL || joint == NULL || joint->struct_size != sizeof *joint || index >= implicit->joint_count)
        return sph__fail(implicit == NULL ? NULL : implicit->context, SPH_E_INVALID,
                         "sph_implicit_get_joint: NULL, a size that is not known, or no joint %u", (unsigned)index);
    *joint = implicit->joints[index].given;
    return SPH_OK;
}

sph_status sph_implicit_set_joint(sph_implicit *implicit, uint32_t index, const sph_implicit_joint *joint)
{
    SPH__OWN(implicit, SPH__IMPLICIT);
    sph__joint held;
    sph__joint *own;
    sph_status status;
    if (implicit == NULL || joint == NULL || index >= implicit->joint_count)
        return sph__fail(implicit == NULL ? NULL : implicit->context, SPH_E_INVALID,
                         "sph_implicit_set_joint: NULL, or no joint %u", (unsigned)index);
    own = implicit->joints + index;
    status = sph__joint_check(implicit->context, joint, implicit->bone_count, "joint", index);
    if (status != SPH_OK) return status;
    if (joint->bones[0] != own->given.bones[0] || joint->bones[1] != own->given.bones[1])
        return sph__fail(implicit->context, SPH_E_INVALID, "joint %u is of bones %u and %u, not of %u and %u",
                         (unsigned)index, (unsigned)own->given.bones[0], (unsigned)own->given.bones[1],
                         (unsigned)joint->bones[0], (unsigned)joint->bones[1]);
    held = *own;
    own->given.operation = joint->operation;
    own->given.strength = joint->strength;
    own->given.curve = joint->curve;
    status = sph__joint_tabulate(implicit, own);
    if (status != SPH_OK) *own = held;
    return status;
}
