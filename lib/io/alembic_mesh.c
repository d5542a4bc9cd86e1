/* SPDX-License-Identifier: MIT */
/* Meshes: positions that may change from sample to sample, faces that may not. */
#include <string.h>

#include "io/alembic.h"
#include "io/bytes.h"
#include "io/reader.h"

enum { VERTEX_SIZE = 12, INDEX_SIZE = 4, SAMPLE_WORK = 16 };

static sph_status find_schema(sph__abc_file *f, const sph__abc_objects *objects, uint32_t object, sph__abc_group *out)
{
    sph__abc_property schema;
    const sph_status status = sph__abc_find(f, &objects->items[object].properties, ".geom", &schema);
    if (status != SPH_OK) return status;
    if (schema.kind != SPH__ABC_COMPOUND)
        return sph__abc_fail_object(f, objects, object, SPH_E_FORMAT, "a mesh without its .geom");
    *out = schema.group;
    return SPH_OK;
}

/* What a mesh must have. */
static sph_status find_array(sph__abc_file *f, const sph__abc_objects *objects, uint32_t object,
                             const sph__abc_group *schema, const char *name, int type, unsigned extent,
                             sph__abc_property *out)
{
    const sph_status status = sph__abc_find_typed(f, schema, name, SPH__ABC_ARRAY, type, extent, out);
    if (status == SPH_OK && out->kind == SPH__ABC_MISSING)
        return sph__abc_fail_object(f, objects, object, SPH_E_FORMAT, "a mesh without %s", name);
    return status == SPH_OK ? sph__abc_check_sampling(f, out) : status;
}

sph_status sph__abc_read_mesh(sph__abc_file *f, const sph__abc_objects *objects, uint32_t object, sph__abc_mesh *m)
{
    sph__abc_group schema;
    sph__abc_property counts;
    sph__abc_bytes sample;
    sph_status status = find_schema(f, objects, object, &schema);
    *m = (sph__abc_mesh){.object = object, .xform = SPH__ABC_NONE};
    if (status == SPH_OK) status = find_array(f, objects, object, &schema, "P", SPH__ABC_F32, 3, &m->positions);
    if (status == SPH_OK) status = sph__abc_sample(f, &m->positions, 0, &sample);
    if (status != SPH_OK) return status;
    m->vertex_count = sample.size / VERTEX_SIZE;
    status = find_array(f, objects, object, &schema, ".faceCounts", SPH__ABC_I32, 1, &counts);
    if (status == SPH_OK) status = sph__abc_sample(f, &counts, 0, &sample);
    if (status == SPH_OK) m->face_count = sample.size / INDEX_SIZE;
    return status;
}

static sph_status fail_topology(const sph__abc_file *f, const sph__abc_objects *objects, const sph__abc_mesh *m,
                                const sph__abc_property *p, uint32_t stored, const char *what)
{
    const uint32_t i = sph__abc_first_of(p, stored);
    return sph__abc_fail_object(f, objects, m->object, SPH_E_UNSUPPORTED,
                                "its topology changes: sample %u (frame %u, at %.6g s) has other %s than the first one",
                                (unsigned)i, (unsigned)i, sph__abc_time(&f->samplings[p->sampling], i), what);
}

/* Samples that are stored apart may still be the same. */
static sph_status check_constant(sph__abc_file *f, const sph__abc_objects *objects, const sph__abc_mesh *m,
                                 const sph__abc_property *p, sph__abc_bytes first, const char *what)
{
    for (uint32_t i = 1; i < sph__abc_stored_count(p); ++i) {
        sph__abc_bytes sample;
        sph_status status = sph__abc_sample(f, p, i, &sample);
        if (status == SPH_OK) status = sph__abc_charge_work(f, SAMPLE_WORK + (sample.p == first.p ? 0 : sample.size));
        if (status != SPH_OK) return status;
        if (sample.size != first.size || (sample.p != first.p && memcmp(sample.p, first.p, first.size) != 0))
            return fail_topology(f, objects, m, p, i, what);
    }
    return SPH_OK;
}

static sph_status check_positions(sph__abc_file *f, const sph__abc_objects *objects, const sph__abc_mesh *m)
{
    for (uint32_t i = 1; i < sph__abc_stored_count(&m->positions); ++i) {
        sph__abc_bytes sample;
        sph_status status = sph__abc_sample(f, &m->positions, i, &sample);
        if (status == SPH_OK) status = sph__abc_charge_work(f, SAMPLE_WORK);
        if (status != SPH_OK) return status;
        if (sample.size != m->vertex_count * VERTEX_SIZE)
            return fail_topology(f, objects, m, &m->positions, i, "vertices");
    }
    return SPH_OK;
}

/* Faces are clockwise seen from outside: from the last corner to the first they are as other formats have them. */
static sph_status add_faces(const sph__abc_file *f, const sph__abc_objects *objects, const sph__abc_mesh *m,
                            sph__abc_bytes counts, sph__abc_bytes indices, sph__io_mesh *mesh)
{
    size_t place = 0;
    for (size_t face = 0; face < counts.size / INDEX_SIZE; ++face) {
        const uint32_t corners = sph__io_load_32(counts.p + INDEX_SIZE * face, false);
        sph__io_fan fan = {0};
        if (corners < 3 || corners > INT32_MAX)
            return sph__abc_fail_object(f, objects, m->object, SPH_E_FORMAT, "face %zu has %d corners", face,
                                        (int)(int32_t)corners);
        if (corners > indices.size / INDEX_SIZE - place)
            return sph__abc_fail_object(f, objects, m->object, SPH_E_FORMAT, "face %zu has no indices", face);
        for (size_t i = place + corners; i-- > place;) {
            const uint32_t index = sph__io_load_32(indices.p + INDEX_SIZE * i, false);
            sph_status status;
            if (index >= m->vertex_count)
                return sph__abc_fail_object(f, objects, m->object, SPH_E_FORMAT,
                                            "face %zu names vertex %d, but there are %zu", face, (int)(int32_t)index,
                                            m->vertex_count);
            status = sph__io_add_corner(mesh, f->path, &fan, (uint32_t)(m->first_vertex + index));
            if (status != SPH_OK) return status;
        }
        place += corners;
    }
    if (place != indices.size / INDEX_SIZE)
        return sph__abc_fail_object(f, objects, m->object, SPH_E_FORMAT, "%zu indices, but its faces have %zu corners",
                                    indices.size / INDEX_SIZE, place);
    return SPH_OK;
}

sph_status sph__abc_read_faces(sph__abc_file *f, const sph__abc_objects *objects, sph__abc_mesh *m, sph__io_mesh *mesh)
{
    sph__abc_group schema;
    sph__abc_property counts, indices;
    sph__abc_bytes count_sample, index_sample;
    sph_status status = find_schema(f, objects, m->object, &schema);
    if (status == SPH_OK) status = find_array(f, objects, m->object, &schema, ".faceCounts", SPH__ABC_I32, 1, &counts);
    if (status == SPH_OK)
        status = find_array(f, objects, m->object, &schema, ".faceIndices", SPH__ABC_I32, 1, &indices);
    if (status == SPH_OK) status = sph__abc_sample(f, &counts, 0, &count_sample);
    if (status == SPH_OK) status = sph__abc_sample(f, &indices, 0, &index_sample);
    if (status == SPH_OK) status = check_positions(f, objects, m);
    if (status == SPH_OK) status = check_constant(f, objects, m, &counts, count_sample, "faces");
    if (status == SPH_OK) status = check_constant(f, objects, m, &indices, index_sample, "faces");
    /* Instances bring the same arrays many times. */
    if (status == SPH_OK) status = sph__abc_charge(f, index_sample.size / INDEX_SIZE, 6 * sizeof(uint32_t));
    if (status == SPH_OK) status = sph__abc_charge(f, m->vertex_count, 3 * sizeof(float));
    if (status != SPH_OK) return status;
    m->first_triangle = mesh->triangle_count;
    status = add_faces(f, objects, m, count_sample, index_sample, mesh);
    m->triangle_count = mesh->triangle_count - m->first_triangle;
    return status;
}

/* Between samples that are not at the time, in proportion. */
static void copy_positions(const unsigned char *from, const unsigned char *to, double share, size_t count, float *xyz)
{
    for (size_t i = 0; i < count; ++i)
        xyz[i] = sph__io_load_float(from + 4 * i, false);
    for (size_t i = 0; i < count && share > 0; ++i)
        xyz[i] = (float)((double)xyz[i] + share * ((double)sph__io_load_float(to + 4 * i, false) - (double)xyz[i]));
}

sph_status sph__abc_read_positions(const sph__abc_file *f, const sph__abc_mesh *m, double time,
                                   const sph__io_affine *matrix, float *xyz)
{
    double share;
    const uint32_t sample = sph__abc_locate(f, &m->positions, time, &share);
    sph__abc_bytes from, to;
    sph_status status = sph__abc_sample(f, &m->positions, sph__abc_stored(&m->positions, sample), &from);
    to = from;
    if (status == SPH_OK && share > 0)
        status = sph__abc_sample(f, &m->positions, sph__abc_stored(&m->positions, sample + 1), &to);
    if (status != SPH_OK) return status;
    if (from.size != VERTEX_SIZE * m->vertex_count || to.size != from.size)
        return sph__abc_fail(f, m->positions.group.place, "positions that are not as they were: the file changed");
    copy_positions(from.p, to.p, share, 3 * m->vertex_count, xyz);
    if (sph__io_is_identity(matrix)) return SPH_OK; /* bit for bit */
    for (size_t i = 0; i < m->vertex_count; ++i) {
        const double *r = matrix->m;
        const double x = (double)xyz[3 * i], y = (double)xyz[3 * i + 1], z = (double)xyz[3 * i + 2];
        for (int k = 0; k < 3; ++k, r += 4)
            xyz[3 * i + (size_t)k] = (float)(r[0] * x + r[1] * y + r[2] * z + r[3]);
    }
    return SPH_OK;
}
