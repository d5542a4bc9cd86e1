/* SPDX-License-Identifier: MIT */
/* A copy of a set-up: what a tracker keeps, whatever is edited later. */
#include "implicit/implicit.h"

static void *copy_of(const sph_context *context, const void *from, size_t count, size_t size)
{
    void *to = sph__alloc(context, count, size);
    if (to != NULL && count != 0) memcpy(to, from, count * size);
    return to;
}

static sph_status copy_field(const sph_context *context, const sph__field *from, sph__field *to)
{
    const size_t count = from->count, size = from->table_size;
    *to = *from;
    to->samples = to->normals = to->centers = NULL;
    to->table = NULL;
    if (count == 0) return SPH_OK;
    to->samples = copy_of(context, from->samples, count, 3 * sizeof *to->samples);
    to->normals = copy_of(context, from->normals, count, 3 * sizeof *to->normals);
    to->centers = copy_of(context, from->centers, count, 8 * sizeof *to->centers);
    to->table = copy_of(context, from->table, size * size * size, 4 * sizeof *to->table);
    return to->samples == NULL || to->normals == NULL || to->centers == NULL || to->table == NULL
               ? sph__fail_memory(context)
               : SPH_OK;
}

sph_status sph__implicit_copy(const sph_implicit *implicit, sph_implicit **out)
{
    sph_status status = sph__implicit_allocate(implicit->context, implicit->bone_count, implicit->joint_count, out);
    sph_implicit *to = *out;
    if (status != SPH_OK) return status;
    to->table_size = implicit->table_size;
    to->operator_table_size = implicit->operator_table_size;
    to->table_count = implicit->table_count;
    memcpy(to->joints, implicit->joints, implicit->joint_count * sizeof *to->joints);
    for (size_t b = 0; b < to->bone_count && status == SPH_OK; ++b)
        status = copy_field(to->context, implicit->fields + b, to->fields + b);
    for (size_t i = 0; i < to->table_count && status == SPH_OK; ++i) {
        const sph__operator_table *from = implicit->tables + i;
        to->tables[i] = *from;
        to->tables[i].values =
            copy_of(to->context, from->values, (size_t)from->size * from->size * from->size, sizeof *from->values);
        if (to->tables[i].values == NULL) status = sph__fail_memory(to->context);
    }
    return status;
}
