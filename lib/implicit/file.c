/* SPDX-License-Identifier: MIT */
/* Set-ups in `.sphm` containers (docs/formats.md). Tables are made anew. */
#include <math.h>

#include "base/container.h"
#include "implicit/implicit.h"

enum { META_COUNT = 5, COUNTS = 3, NUMBERS = 11, JOINT_COUNTS = 3, JOINT_NUMBERS = 12, CENTER_LIMIT = 1024 };

static const uint32_t META = SPH__TAG('M', 'E', 'T', 'A'), PARTS = SPH__TAG('P', 'A', 'R', 'T'),
                      SIZES = SPH__TAG('S', 'I', 'Z', 'E'), SAMPLES = SPH__TAG('S', 'A', 'M', 'P'),
                      NORMALS = SPH__TAG('N', 'O', 'R', 'M'), CENTERS = SPH__TAG('H', 'R', 'B', 'F'),
                      JOINTS = SPH__TAG('J', 'O', 'I', 'N'), CURVES = SPH__TAG('C', 'U', 'R', 'V');

/* The numbers of a set-up, one kind after another. */
typedef struct image {
    const sph_context *context;
    size_t bones, joints, centers;
    uint32_t *parts, *joint_bones; /* [J][3], [joints][3] */
    double *sizes, *samples, *normals, *coefficients, *curves;
} image;

static sph_status allocate(image *m)
{
    m->parts = sph__alloc(m->context, m->bones, COUNTS * sizeof *m->parts);
    m->sizes = sph__alloc(m->context, m->bones, NUMBERS * sizeof *m->sizes);
    m->samples = sph__alloc(m->context, m->centers, 3 * sizeof *m->samples);
    m->normals = sph__alloc(m->context, m->centers, 3 * sizeof *m->normals);
    m->coefficients = sph__alloc(m->context, m->centers, 8 * sizeof *m->coefficients);
    m->joint_bones = sph__alloc(m->context, m->joints, JOINT_COUNTS * sizeof *m->joint_bones);
    m->curves = sph__alloc(m->context, m->joints, JOINT_NUMBERS * sizeof *m->curves);
    return m->parts == NULL || m->sizes == NULL || m->samples == NULL || m->normals == NULL ||
                   m->coefficients == NULL || m->joint_bones == NULL || m->curves == NULL
               ? sph__fail_memory(m->context)
               : SPH_OK;
}

static void release(const image *m)
{
    sph__free(m->context, m->parts);
    sph__free(m->context, m->sizes);
    sph__free(m->context, m->samples);
    sph__free(m->context, m->normals);
    sph__free(m->context, m->coefficients);
    sph__free(m->context, m->joint_bones);
    sph__free(m->context, m->curves);
}

/* --- out --- */

static void put_fields(const sph_implicit *implicit, image *m)
{
    size_t at = 0;
    for (size_t b = 0; b < m->bones; ++b) {
        const sph__field *f = implicit->fields + b;
        const uint32_t counts[COUNTS] = {f->vertex_count, f->count, f->closing_count};
        double *n = m->sizes + NUMBERS * b;
        memcpy(m->parts + COUNTS * b, counts, sizeof counts);
        memset(n, 0, NUMBERS * sizeof *n);
        if (f->count == 0) continue;
        n[0] = f->radius;
        memcpy(n + 1, f->low, sizeof f->low);
        memcpy(n + 4, f->high, sizeof f->high);
        memcpy(n + 7, f->origin, sizeof f->origin);
        n[10] = f->scale;
        memcpy(m->samples + 3 * at, f->samples, 3 * f->count * sizeof *f->samples);
        memcpy(m->normals + 3 * at, f->normals, 3 * f->count * sizeof *f->normals);
        memcpy(m->coefficients + 8 * at, f->centers, 8 * f->count * sizeof *f->centers);
        at += f->count;
    }
}

static void put_joints(const sph_implicit *implicit, image *m)
{
    for (size_t j = 0; j < m->joints; ++j) {
        const sph_implicit_joint *g = &implicit->joints[j].given;
        const uint32_t bones[JOINT_COUNTS] = {g->bones[0], g->bones[1], (uint32_t)g->operation};
        double *n = m->curves + JOINT_NUMBERS * j;
        memcpy(m->joint_bones + JOINT_COUNTS * j, bones, sizeof bones);
        memcpy(n, g->position, sizeof g->position);
        n[3] = g->strength;
        memcpy(n + 4, g->curve.angles, sizeof g->curve.angles);
        memcpy(n + 7, g->curve.thetas, sizeof g->curve.thetas);
        memcpy(n + 10, g->curve.exponents, sizeof g->curve.exponents);
    }
}

sph_status sph_implicit_write(const sph_implicit *implicit, sph_write_fn *write, void *user)
{
    SPH__OWN(implicit, SPH__IMPLICIT);
    image m = {.centers = 0};
    sph_status status;
    if (implicit == NULL || write == NULL)
        return sph__fail(implicit == NULL ? NULL : implicit->context, SPH_E_INVALID,
                         "sph_implicit_write: an argument is NULL");
    m.context = implicit->context;
    m.bones = implicit->bone_count;
    m.joints = implicit->joint_count;
    for (size_t b = 0; b < m.bones; ++b)
        m.centers += implicit->fields[b].count;
    status = allocate(&m);
    if (status == SPH_OK) {
        const uint64_t meta[META_COUNT] = {m.bones, m.joints, m.centers, implicit->table_size,
                                           implicit->operator_table_size};
        const sph__chunk chunks[] = {{META, 8, meta, META_COUNT, 0, 0},
                                     {PARTS, 4, m.parts, COUNTS * m.bones, 0, 0},
                                     {SIZES, 8, m.sizes, NUMBERS * m.bones, 0, 0},
                                     {SAMPLES, 8, m.samples, 3 * m.centers, 0, 0},
                                     {NORMALS, 8, m.normals, 3 * m.centers, 0, 0},
                                     {CENTERS, 8, m.coefficients, 8 * m.centers, 0, 0},
                                     {JOINTS, 4, m.joint_bones, JOINT_COUNTS * m.joints, 0, 0},
                                     {CURVES, 8, m.curves, JOINT_NUMBERS * m.joints, 0, 0}};
        put_fields(implicit, &m);
        put_joints(implicit, &m);
        status = sph__container_write(m.context, SPH__CONTAINER_IMPLICIT, chunks, sizeof chunks / sizeof *chunks, write,
                                      user);
    }
    release(&m);
    return status;
}

/* --- in --- */

/* The counts, which must be those of the chunks: then no allocation but the tables is larger than the container. */
static sph_status read_meta(const sph__container *c, image *m, uint64_t meta[META_COUNT])
{
    static const uint32_t WIDTHS[] = {4, 8, 8, 8, 8, 4, 8},
                          ROWS[] = {COUNTS, NUMBERS, 3, 3, 8, JOINT_COUNTS, JOINT_NUMBERS};
    const uint32_t tags[] = {PARTS, SIZES, SAMPLES, NORMALS, CENTERS, JOINTS, CURVES};
    sph_status status = sph__container_copy(c, META, 8, META_COUNT, meta);
    if (status != SPH_OK) return status;
    if (meta[0] == 0 || meta[0] > UINT32_MAX || meta[1] > UINT32_MAX || meta[2] > meta[0] * CENTER_LIMIT ||
        meta[3] < 8 || meta[3] > 128 || meta[4] < 8 || meta[4] > 256)
        return sph__fail(c->context, SPH_E_FORMAT, "byte %zu: the counts are out of range",
                         sph__container_byte(c, META, 8, 0));
    for (int i = 0; i < 7; ++i) {
        const uint64_t rows = i < 2 ? meta[0] : i < 5 ? meta[2] : meta[1];
        size_t count;
        if ((status = sph__container_count(c, tags[i], WIDTHS[i], &count)) != SPH_OK) return status;
        if (count % ROWS[i] != 0 || count / ROWS[i] != rows)
            return sph__fail(c->context, SPH_E_FORMAT, "byte %zu: the counts are not those of the chunks",
                             sph__container_byte(c, META, 8, 0));
    }
    m->bones = (size_t)meta[0];
    m->joints = (size_t)meta[1];
    m->centers = (size_t)meta[2];
    return SPH_OK;
}

static sph_status read_chunks(const sph__container *c, const image *m)
{
    sph_status status = sph__container_copy(c, PARTS, 4, COUNTS * m->bones, m->parts);
    if (status == SPH_OK) status = sph__container_copy(c, SIZES, 8, NUMBERS * m->bones, m->sizes);
    if (status == SPH_OK) status = sph__container_copy(c, SAMPLES, 8, 3 * m->centers, m->samples);
    if (status == SPH_OK) status = sph__container_copy(c, NORMALS, 8, 3 * m->centers, m->normals);
    if (status == SPH_OK) status = sph__container_copy(c, CENTERS, 8, 8 * m->centers, m->coefficients);
    if (status == SPH_OK) status = sph__container_copy(c, JOINTS, 4, JOINT_COUNTS * m->joints, m->joint_bones);
    if (status == SPH_OK) status = sph__container_copy(c, CURVES, 8, JOINT_NUMBERS * m->joints, m->curves);
    return status;
}

/* Numbers that may be multiplied without overflow. */
static bool all_sane(const double *numbers, size_t count)
{
    for (size_t i = 0; i < count; ++i)
        if (!(fabs(numbers[i]) < 1e60)) return false;
    return true;
}

static bool is_size(const double *n)
{
    if (!all_sane(n, NUMBERS) || !(n[0] > 1e-60) || !(n[10] > 1e-60)) return false;
    for (int c = 0; c < 3; ++c)
        if (!(n[4 + c] - n[1 + c] > 1e-60)) return false;
    return true;
}

static sph_status read_field(const sph__container *c, const image *m, size_t bone, size_t *at, sph__field *f)
{
    const uint32_t *counts = m->parts + COUNTS * bone;
    const double *n = m->sizes + NUMBERS * bone;
    f->vertex_count = counts[0];
    if (counts[1] == 0 && counts[2] == 0) return SPH_OK;
    if (counts[1] > CENTER_LIMIT || counts[2] > counts[1] || counts[1] > m->centers - *at || !is_size(n) ||
        !all_sane(m->samples + 3 * *at, 3 * (size_t)counts[1]) ||
        !all_sane(m->normals + 3 * *at, 3 * (size_t)counts[1]) ||
        !all_sane(m->coefficients + 8 * *at, 8 * (size_t)counts[1]))
        return sph__fail(c->context, SPH_E_FORMAT, "byte %zu: the part of bone %zu is out of range",
                         sph__container_byte(c, PARTS, 4, COUNTS * bone), bone);
    f->count = counts[1];
    f->closing_count = counts[2];
    f->radius = n[0];
    memcpy(f->low, n + 1, sizeof f->low);
    memcpy(f->high, n + 4, sizeof f->high);
    memcpy(f->origin, n + 7, sizeof f->origin);
    f->scale = n[10];
    f->samples = sph__alloc(c->context, f->count, 3 * sizeof *f->samples);
    f->normals = sph__alloc(c->context, f->count, 3 * sizeof *f->normals);
    f->centers = sph__alloc(c->context, f->count, 8 * sizeof *f->centers);
    if (f->samples == NULL || f->normals == NULL || f->centers == NULL) return sph__fail_memory(c->context);
    memcpy(f->samples, m->samples + 3 * *at, 3 * (size_t)f->count * sizeof *f->samples);
    memcpy(f->normals, m->normals + 3 * *at, 3 * (size_t)f->count * sizeof *f->normals);
    memcpy(f->centers, m->coefficients + 8 * *at, 8 * (size_t)f->count * sizeof *f->centers);
    *at += f->count;
    return SPH_OK;
}

static sph_status read_joint(const sph__container *c, const image *m, const sph_implicit *implicit, size_t j)
{
    const uint32_t *bones = m->joint_bones + JOINT_COUNTS * j;
    const double *n = m->curves + JOINT_NUMBERS * j;
    sph_implicit_joint *g = &implicit->joints[j].given;
    *g = (sph_implicit_joint){.struct_size = sizeof *g,
                              .operation = bones[2] > INT32_MAX ? -1 : (int32_t)bones[2],
                              .bones = {bones[0], bones[1]},
                              .strength = n[3]};
    memcpy(g->position, n, sizeof g->position);
    memcpy(g->curve.angles, n + 4, sizeof g->curve.angles);
    memcpy(g->curve.thetas, n + 7, sizeof g->curve.thetas);
    memcpy(g->curve.exponents, n + 10, sizeof g->curve.exponents);
    if (sph__joint_check(c->context, g, implicit->bone_count, "joint", j) != SPH_OK)
        return SPH_E_FORMAT; /* the message stays */
    if (g->bones[0] >= g->bones[1] || implicit->fields[g->bones[0]].count == 0 ||
        implicit->fields[g->bones[1]].count == 0)
        return sph__fail(c->context, SPH_E_FORMAT,
                         "byte %zu: joint %zu is of bones without a field, or the higher first",
                         sph__container_byte(c, JOINTS, 4, JOINT_COUNTS * j), j);
    return SPH_OK;
}

static bool in_order(const sph_implicit *implicit, size_t j)
{
    const uint32_t *a = implicit->joints[j - 1].given.bones, *b = implicit->joints[j].given.bones;
    return a[0] < b[0] || (a[0] == b[0] && a[1] < b[1]);
}

static sph_status fill(const sph__container *c, const image *m, sph_implicit *implicit)
{
    sph_status status = SPH_OK;
    size_t at = 0;
    for (size_t b = 0; b < m->bones && status == SPH_OK; ++b)
        status = read_field(c, m, b, &at, implicit->fields + b);
    for (size_t j = 0; j < m->joints && status == SPH_OK; ++j) {
        status = read_joint(c, m, implicit, j);
        if (status == SPH_OK && j > 0 && !in_order(implicit, j))
            status = sph__fail(c->context, SPH_E_FORMAT, "byte %zu: joint %zu is out of order",
                               sph__container_byte(c, JOINTS, 4, JOINT_COUNTS * j), j);
    }
    if (status == SPH_OK && at != m->centers)
        status = sph__fail(c->context, SPH_E_FORMAT, "byte %zu: %zu centres belong to no part",
                           sph__container_byte(c, CENTERS, 8, 8 * at), m->centers - at);
    return status == SPH_OK ? sph__implicit_tabulate(implicit) : status;
}

sph_status sph_implicit_read(sph_context *context, const void *bytes, size_t size, sph_implicit **out)
{
    SPH__OWN(context, SPH__CONTEXT);
    sph__container container;
    sph_implicit *implicit = NULL;
    image m = {.context = context};
    uint64_t meta[META_COUNT];
    sph_status status;
    if (out != NULL) *out = NULL;
    if (context == NULL || bytes == NULL || out == NULL)
        return sph__fail(context, SPH_E_INVALID, "sph_implicit_read: an argument is NULL");
    status = sph__container_open(context, bytes, size, SPH__CONTAINER_IMPLICIT, &container);
    if (status == SPH_OK) status = read_meta(&container, &m, meta);
    if (status == SPH_OK) status = allocate(&m);
    if (status == SPH_OK) status = read_chunks(&container, &m);
    if (status == SPH_OK) status = sph__implicit_allocate(context, (uint32_t)m.bones, (uint32_t)m.joints, &implicit);
    if (status == SPH_OK) {
        implicit->table_size = (uint32_t)meta[3];
        implicit->operator_table_size = (uint32_t)meta[4];
        status = fill(&container, &m, implicit);
    }
    release(&m);
    if (status != SPH_OK) {
        sph_implicit_destroy(implicit);
        return status;
    }
    *out = implicit;
    return SPH_OK;
}
