/* SPDX-License-Identifier: MIT */
/* What a glTF's vertices have besides their positions and weights, as columns of numbers. */
#include <string.h>

#include "io/rig_levels.h"

static bool starts_with(const sph__gltf_document *d, uint32_t value, const char *text)
{
    const char *p = d->text + d->values[value].begin;
    const size_t length = strlen(text);
    return (size_t)(d->text_end - p) > length && memcmp(p + 1, text, length) == 0;
}

static sph_status add_attribute(sph_io_rig_levels *l, const sph__levels_attribute *attribute)
{
    const sph_status status =
        sph__gltf_push(&l->d, &l->attributes, &l->attribute_capacity, l->attribute_count, sizeof *l->attributes);
    if (status == SPH_OK) l->attributes[l->attribute_count++] = *attribute;
    return status;
}

/* The members of an "attributes" or of a morph target, from column *column on. */
static sph_status list_attributes(sph_io_rig_levels *l, uint32_t object, uint32_t target, uint32_t *column)
{
    const sph__gltf_document *d = &l->d;
    uint32_t key = object + 1;
    sph_status status = SPH_OK;
    for (uint32_t i = 0; i < d->values[object].count && status == SPH_OK; ++i, key = d->values[key + 1].next) {
        sph__levels_attribute attribute = {.name = key, .target = target, .column = *column};
        sph__gltf_accessor a;
        uint32_t index;
        if (target == SPH__GLTF_NONE &&
            (sph__gltf_is(d, key, "POSITION") || starts_with(d, key, "JOINTS_") || starts_with(d, key, "WEIGHTS_")))
            continue;
        attribute.normal = target == SPH__GLTF_NONE && sph__gltf_is(d, key, "NORMAL");
        status = sph__gltf_read_index(d, key + 1, SPH__GLTF_ACCESSORS, &index);
        if (status == SPH_OK) status = sph__gltf_accessor_open(&l->d, index, attribute.normal ? 3 : 0, &a);
        if (status != SPH_OK) return status;
        if (a.width > 4) return sph__gltf_fail(d, key, "an attribute of %u numbers", (unsigned)a.width);
        attribute.width = a.width;
        *column += attribute.normal ? 0 : a.width;
        status = add_attribute(l, &attribute);
    }
    return status;
}

static sph_status list_part(sph_io_rig_levels *l, size_t part)
{
    const uint32_t primitive = l->g->parts[part].primitive;
    uint32_t column = 0, array, value;
    sph_status status;
    l->parts[part].first_attribute = l->attribute_count;
    status = list_attributes(l, sph__gltf_get(&l->d, primitive, "attributes"), SPH__GLTF_NONE, &column);
    if (status == SPH_OK) status = sph__gltf_get_kind(&l->d, primitive, "targets", '[', &array);
    if (status != SPH_OK) return status;
    value = array + 1;
    for (uint32_t t = 0; array != 0 && t < l->d.values[array].count && status == SPH_OK; ++t) {
        if (l->d.values[value].kind != '{') return sph__gltf_fail(&l->d, value, "a morph target is not an object");
        status = list_attributes(l, value, t, &column);
        value = l->d.values[value].next;
    }
    l->parts[part].attribute_count = l->attribute_count - l->parts[part].first_attribute;
    if (column > l->columns) l->columns = column;
    return status;
}

/* The numbers of one attribute of a part. */
static sph_status read_attribute(sph_io_rig_levels *l, size_t part, const sph__levels_attribute *attribute)
{
    const sph__gltf_part *p = &l->g->parts[part];
    sph__gltf_accessor a;
    uint32_t index;
    sph_status status = sph__gltf_read_index(&l->d, attribute->name + 1, SPH__GLTF_ACCESSORS, &index);
    if (status == SPH_OK) status = sph__gltf_accessor_open(&l->d, index, attribute->width, &a);
    for (size_t i = 0; i < p->used_count && status == SPH_OK; ++i) {
        const size_t v = p->first_vertex + i;
        float *out = attribute->normal ? l->normals + 3 * v : l->numbers + v * l->columns + attribute->column;
        if (p->used[i] >= a.count)
            return sph__gltf_fail(&l->d, attribute->name, "an attribute of %u vertices; there is vertex %u",
                                  (unsigned)a.count, (unsigned)p->used[i]);
        sph__gltf_accessor_floats(&a, p->used[i], out);
    }
    return status;
}

/* Parts of one skin, or of one node, may be joined where they touch. */
static void set_groups(sph_io_rig_levels *l)
{
    for (size_t k = 0; k < l->g->part_count; ++k) {
        const sph__gltf_part *p = &l->g->parts[k];
        const uint32_t skin = l->g->nodes[p->node].skin;
        for (size_t i = 0; i < p->used_count; ++i)
            l->groups[p->first_vertex + i] = skin == SPH__GLTF_NONE ? p->node : l->g->node_count + skin;
    }
}

static sph_status allocate(sph_io_rig_levels *l)
{
    const size_t n = l->g->vertex_count;
    sph_status status = SPH_OK;
    bool normals = false;
    for (size_t i = 0; i < l->attribute_count; ++i)
        normals = normals || l->attributes[i].normal;
    status = sph__gltf_allocate(&l->d, n, sizeof *l->groups, &l->groups);
    if (status == SPH_OK && l->columns > 0)
        status = sph__gltf_allocate(&l->d, n, l->columns * sizeof *l->numbers, &l->numbers);
    if (status == SPH_OK && normals) status = sph__gltf_allocate(&l->d, n, 3 * sizeof *l->normals, &l->normals);
    if (status != SPH_OK) return status;
    if (l->columns > 0) memset(l->numbers, 0, n * l->columns * sizeof *l->numbers);
    if (normals) memset(l->normals, 0, n * 3 * sizeof *l->normals);
    return SPH_OK;
}

static sph_status refuse_instances(const sph__gltf_document *d)
{
    uint32_t array, value;
    const sph_status status = sph__gltf_get_kind(d, 0, "extensionsUsed", '[', &array);
    if (status != SPH_OK || array == 0) return status;
    value = array + 1;
    for (uint32_t i = 0; i < d->values[array].count; ++i, value = d->values[value].next)
        if (sph__gltf_is(d, value, "EXT_mesh_gpu_instancing"))
            return sph__io_fail(d->context, SPH_E_UNSUPPORTED, "%s: it draws instances of meshes, which have no levels",
                                sph__io_shown(d->path));
    return SPH_OK;
}

sph_status sph__levels_read(sph_io_rig_levels *l)
{
    const size_t count = l->g->part_count;
    sph_status status = refuse_instances(&l->d);
    if (status == SPH_OK) status = sph__gltf_allocate(&l->d, count, sizeof *l->parts, &l->parts);
    for (size_t k = 0; k < count && status == SPH_OK; ++k) {
        const size_t end = k + 1 < count ? l->g->parts[k + 1].first_triangle : l->triangle_count;
        l->parts[k] = (sph__levels_part){.triangle_count = end - l->g->parts[k].first_triangle};
        if (l->parts[k].triangle_count > 0) status = list_part(l, k);
    }
    if (status == SPH_OK) status = allocate(l);
    if (status != SPH_OK) return status;
    set_groups(l);
    for (size_t k = 0; k < count && status == SPH_OK; ++k)
        for (size_t i = 0; i < l->parts[k].attribute_count && status == SPH_OK; ++i)
            status = read_attribute(l, k, &l->attributes[l->parts[k].first_attribute + i]);
    return status;
}
