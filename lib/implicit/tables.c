/* SPDX-License-Identifier: MIT */
/* Grids of fields and operators, for trilinear evaluation. */
#include <math.h>

#include "implicit/implicit.h"

static const double PI = 3.14159265358979323846;

typedef struct grid {
    sph__field *field;
    uint32_t size;
} grid;

/* Eight nodes of a row from `first` on; those beyond its end are its last. */
static void fill_nodes(const grid *g, size_t first, size_t y, size_t z)
{
    const sph__field *f = g->field;
    const size_t count = g->size - first < 8 ? g->size - first : 8;
    float *out = f->table + 4 * ((z * g->size + y) * g->size + first);
    sph__eight p, v;
    for (size_t i = 0; i < 8; ++i) {
        const size_t at[3] = {first + (i < count ? i : count - 1), y, z};
        for (int c = 0; c < 3; ++c)
            p.rows[c][i] = f->low[c] + (f->high[c] - f->low[c]) * (double)at[c] / (g->size - 1);
    }
    sph__field_distances(f, &p, &v);
    for (size_t i = 0; i < count; ++i)
        for (size_t c = 0; c < 4; ++c)
            out[4 * i + c] = (float)(c == 0 ? v.rows[0][i] / f->scale : v.rows[c][i]);
}

static void fill_slice(void *argument, size_t begin, size_t end)
{
    const grid *g = argument;
    for (size_t z = begin; z < end; ++z)
        for (size_t y = 0; y < g->size; ++y)
            for (size_t x = 0; x < g->size; x += 8)
                fill_nodes(g, x, y, z);
}

sph_status sph__field_tabulate(const sph_context *context, sph__field *field, uint32_t size)
{
    grid g = {field, size};
    if (field->count == 0) return SPH_OK;
    field->table = sph__alloc(context, (size_t)size * size * size, 4 * sizeof *field->table);
    if (field->table == NULL) return sph__fail_memory(context);
    field->table_size = size;
    for (int c = 0; c < 3; ++c)
        field->cell[c] = (size - 1) / (field->high[c] - field->low[c]);
    sph__parallel_for(context, size, 1, fill_slice, &g);
    return SPH_OK;
}

/* --- operators --- */

static void fill_operator(void *argument, size_t begin, size_t end)
{
    const sph__operator_table *t = argument;
    const size_t size = t->size;
    double slopes[2];
    for (size_t k = begin; k < end; ++k)
        for (size_t j = 0; j < size; ++j)
            for (size_t i = 0; i <= j; ++i) {
                const double per = 1 / (double)(size - 1), theta = SPH__UNION_THETA * (double)k * per;
                const double value =
                    sph__compose(t->operation, t->strength, theta, (double)i * per, (double)j * per, slopes);
                t->values[(k * size + j) * size + i] = t->values[(k * size + i) * size + j] = (float)value;
            }
}

static void fill_curve(sph__joint *joint)
{
    for (int i = 0; i < SPH__CURVE_SIZE; ++i)
        joint->curve[i] = (float)sph__curve_at(&joint->given.curve, PI * i / (SPH__CURVE_SIZE - 1));
}

sph_status sph__joint_tabulate(sph_implicit *implicit, sph__joint *joint)
{
    const sph_implicit_joint *g = &joint->given;
    const size_t size = implicit->operator_table_size;
    const double strength = g->operation == SPH_OPERATION_BULGE ? g->strength : 0;
    sph__operator_table *table;
    fill_curve(joint);
    joint->table = SPH__NO_PART;
    if (g->operation == SPH_OPERATION_UNION) return SPH_OK;
    for (uint32_t i = 0; i < implicit->table_count; ++i) {
        table = implicit->tables + i;
        if (table->operation != g->operation || table->strength > strength || table->strength < strength) continue;
        joint->table = i;
        return SPH_OK;
    }
    table = implicit->tables + implicit->table_count; /* joints that use an earlier one leave room */
    for (uint32_t i = 0; i < implicit->table_count; ++i) {
        bool used = false;
        for (uint32_t k = 0; k < implicit->joint_count; ++k)
            used = used || implicit->joints[k].table == i;
        if (!used) table = implicit->tables + i;
    }
    if (table->values == NULL) table->values = sph__alloc(implicit->context, size * size * size, sizeof *table->values);
    if (table->values == NULL) return sph__fail_memory(implicit->context);
    table->operation = g->operation;
    table->strength = strength;
    table->size = implicit->operator_table_size;
    sph__parallel_for(implicit->context, size, 1, fill_operator, table);
    joint->table = (uint32_t)(table - implicit->tables);
    if (joint->table == implicit->table_count) ++implicit->table_count;
    return SPH_OK;
}
