/* SPDX-License-Identifier: MIT */
/* Transforms: stacks of operations, whose values may change from sample to sample. */
#include <math.h>
#include <string.h>

#include "io/alembic.h"
#include "io/bytes.h"

/* The upper four bits of an operation's byte; the lower ones are a hint. */
enum { SCALE, TRANSLATE, ROTATE, MATRIX, ROTATE_X, ROTATE_Y, ROTATE_Z, OPERATIONS };
static const unsigned char VALUES[OPERATIONS] = {3, 3, 4, 16, 1, 1, 1};
enum { OP_SHIFT = 4, SAMPLE_WORK = 16 };

/* Around an axis of any length, by degrees. */
static sph__io_affine rotation(double x, double y, double z, double degrees)
{
    const double length = sqrt(x * x + y * y + z * z), angle = degrees * (3.14159265358979323846 / 180);
    const double c = cos(angle), s = sin(angle), d = 1 - c;
    if (!(length > 0)) return sph__io_identity;
    x /= length;
    y /= length;
    z /= length;
    return (sph__io_affine){{d * x * x + c, d * x * y - s * z, d * x * z + s * y, 0, d * x * y + s * z, d * y * y + c,
                              d * y * z - s * x, 0, d * x * z - s * y, d * y * z + s * x, d * z * z + c, 0}};
}

/* Of one operation. Matrices are stored for rows of numbers from the left, so that they are transposed here. */
static sph__io_affine operation(int kind, const double *v)
{
    sph__io_affine m = sph__io_identity;
    switch (kind) {
    case SCALE:
        for (int i = 0; i < 3; ++i)
            m.m[5 * i] = v[i];
        return m;
    case TRANSLATE:
        for (int i = 0; i < 3; ++i)
            m.m[4 * i + 3] = v[i];
        return m;
    case ROTATE:
        return rotation(v[0], v[1], v[2], v[3]);
    case MATRIX:
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 4; ++column)
                m.m[4 * row + column] = v[4 * column + row];
        return m;
    default:
        return rotation(kind == ROTATE_X, kind == ROTATE_Y, kind == ROTATE_Z, v[0]);
    }
}

/* All samples that there are must have a value for each operation. */
static sph_status check_values(sph__abc_file *f, const sph__abc_objects *objects, const sph__abc_xform *x)
{
    sph_status status = sph__abc_check_sampling(f, &x->values);
    for (uint32_t i = 0; i < sph__abc_stored_count(&x->values) && status == SPH_OK; ++i) {
        sph__abc_bytes sample;
        status = sph__abc_sample(f, &x->values, i, &sample);
        if (status == SPH_OK) status = sph__abc_charge_work(f, SAMPLE_WORK);
        if (status == SPH_OK && sample.size != 8 * (size_t)x->value_count)
            status = sph__abc_fail_object(
                f, objects, x->object, SPH_E_FORMAT, "sample %u of its transform has %zu values, not %u",
                (unsigned)sph__abc_first_of(&x->values, i), sample.size / 8, (unsigned)x->value_count);
    }
    return status;
}

static sph_status read_operations(sph__abc_file *f, const sph__abc_objects *objects, const sph__abc_group *schema,
                                  sph__abc_xform *x)
{
    sph__abc_property ops;
    sph_status status = sph__abc_find(f, schema, ".ops", &ops);
    if (status != SPH_OK || ops.kind == SPH__ABC_MISSING || ops.sample_count == 0) return status;
    if (ops.kind == SPH__ABC_COMPOUND || ops.type != SPH__ABC_U8)
        return sph__abc_fail_object(f, objects, x->object, SPH_E_FORMAT, "its operations are of another type");
    if ((status = sph__abc_sample(f, &ops, 0, &x->ops)) != SPH_OK) return status;
    for (size_t i = 0; i < x->ops.size; ++i) {
        const int kind = x->ops.p[i] >> OP_SHIFT;
        if (kind >= OPERATIONS)
            return sph__abc_fail_object(f, objects, x->object, SPH_E_UNSUPPORTED,
                                        "operation %d of its transform is not known", kind);
        x->value_count += VALUES[kind];
    }
    return SPH_OK;
}

static sph_status read_inherits(sph__abc_file *f, const sph__abc_group *schema, sph__abc_xform *x)
{
    uint32_t roots = 0;
    sph_status status = sph__abc_find_typed(f, schema, ".inherits", SPH__ABC_SCALAR, SPH__ABC_BOOL, 1, &x->inherits);
    if (status != SPH_OK || x->inherits.kind == SPH__ABC_MISSING) return status;
    status = sph__abc_check_sampling(f, &x->inherits);
    for (uint32_t i = 0; i < sph__abc_stored_count(&x->inherits) && status == SPH_OK; ++i) {
        sph__abc_bytes sample;
        status = sph__abc_sample(f, &x->inherits, i, &sample);
        if (status == SPH_OK) status = sph__abc_charge_work(f, SAMPLE_WORK);
        roots += status == SPH_OK && sample.size > 0 && sample.p[0] == 0;
    }
    x->roots = roots > 0 && roots == sph__abc_stored_count(&x->inherits);
    x->switches = roots > 0 && !x->roots;
    return status;
}

sph_status sph__abc_read_xform(sph__abc_file *f, const sph__abc_objects *objects, uint32_t object, sph__abc_xform *x)
{
    const sph__abc_object *o = &objects->items[object];
    sph__abc_property schema;
    sph_status status;
    *x = (sph__abc_xform){.object = object, .parent = SPH__ABC_NONE, .global = sph__io_identity};
    if (!sph__abc_equals(o->schema, "AbcGeom_Xform_v3"))
        return sph__abc_fail_object(f, objects, object, SPH_E_UNSUPPORTED, "a transform of another version than 3");
    status = sph__abc_find(f, &o->properties, ".xform", &schema);
    if (status != SPH_OK || schema.kind != SPH__ABC_COMPOUND) return status;
    status = read_operations(f, objects, &schema.group, x);
    if (status == SPH_OK) status = read_inherits(f, &schema.group, x);
    if (status == SPH_OK) status = sph__abc_find(f, &schema.group, ".vals", &x->values);
    if (status != SPH_OK || x->values.kind == SPH__ABC_MISSING) return status;
    if (x->values.kind == SPH__ABC_COMPOUND || x->values.type != SPH__ABC_F64)
        return sph__abc_fail_object(f, objects, object, SPH_E_FORMAT, "the values of its transform are no doubles");
    if (x->values.sample_count == 0) x->values.kind = SPH__ABC_MISSING;
    return x->values.kind == SPH__ABC_MISSING ? SPH_OK : check_values(f, objects, x);
}

bool sph__abc_xform_moves(const sph__abc_xform *x)
{
    return sph__abc_stored_count(&x->values) > 1 || x->switches;
}

/* Values `begin` and on at a time, between two samples in proportion. */
static void blend(const sph__abc_bytes samples[2], double share, size_t begin, unsigned count, double *out)
{
    for (unsigned i = 0; i < count; ++i) {
        out[i] = sph__io_load_double(samples[0].p + 8 * (begin + i), false);
        if (share > 0) out[i] += share * (sph__io_load_double(samples[1].p + 8 * (begin + i), false) - out[i]);
    }
}

static sph_status local_matrix(const sph__abc_file *f, const sph__abc_xform *x, double time, sph__io_affine *out)
{
    sph__abc_bytes samples[2];
    double share, values[16];
    size_t place = 0;
    uint32_t sample;
    sph_status status;
    *out = sph__io_identity;
    if (x->values.kind == SPH__ABC_MISSING) return SPH_OK;
    sample = sph__abc_locate(f, &x->values, time, &share);
    status = sph__abc_sample(f, &x->values, sph__abc_stored(&x->values, sample), &samples[0]);
    if (status == SPH_OK && share > 0)
        status = sph__abc_sample(f, &x->values, sph__abc_stored(&x->values, sample + 1), &samples[1]);
    if (status != SPH_OK) return status;
    for (size_t i = 0; i < x->ops.size; ++i) {
        const int kind = x->ops.p[i] >> OP_SHIFT;
        sph__io_affine m;
        blend(samples, share, place, VALUES[kind], values);
        place += VALUES[kind];
        m = operation(kind, values);
        *out = sph__io_multiply(out, &m); /* the first one is applied to points last */
    }
    return SPH_OK;
}

static sph_status inherits(const sph__abc_file *f, const sph__abc_xform *x, double time, bool *out)
{
    sph__abc_bytes sample;
    double share;
    uint32_t stored;
    sph_status status;
    *out = true;
    if (x->inherits.kind == SPH__ABC_MISSING) return SPH_OK;
    stored = sph__abc_stored(&x->inherits, sph__abc_locate(f, &x->inherits, time, &share));
    status = sph__abc_sample(f, &x->inherits, stored, &sample);
    if (status == SPH_OK) *out = sample.size == 0 || sample.p[0] != 0;
    return status;
}

sph_status sph__abc_pose(const sph__abc_file *f, sph__abc_xform *xforms, size_t count, double time)
{
    for (size_t i = 0; i < count; ++i) {
        sph__abc_xform *x = &xforms[i];
        sph__io_affine local;
        bool below;
        sph_status status;
        x->global = sph__io_identity;
        if (x->placement) continue;
        status = local_matrix(f, x, time, &local);
        if (status == SPH_OK) status = inherits(f, x, time, &below);
        if (status != SPH_OK) return status;
        x->global = !below || x->parent == SPH__ABC_NONE ? local : sph__io_multiply(&xforms[x->parent].global, &local);
    }
    return SPH_OK;
}
