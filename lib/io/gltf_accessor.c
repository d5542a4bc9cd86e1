/* SPDX-License-Identifier: MIT */
/* Accessors: typed elements in buffers, checked once, then read one by one. */
#include <string.h>

#include "io/gltf.h"

enum { STRIDE_LIMIT = 1024 };

static size_t size_of(int type)
{
    switch (type) {
    case SPH__GLTF_I8:
    case SPH__GLTF_U8:
        return 1;
    case SPH__GLTF_I16:
    case SPH__GLTF_U16:
        return 2;
    case SPH__GLTF_U32:
    case SPH__GLTF_F32:
        return 4;
    default:
        return 0;
    }
}

/* Where `count` elements of `size` bytes begin in a view; *stride is replaced by the view's, if it has one. */
static sph_status locate(sph__gltf_document *d, uint32_t object, uint32_t count, size_t size, size_t *stride,
                         const unsigned char **bytes)
{
    const unsigned char *buffer;
    size_t buffer_size;
    uint64_t offset = 0, begin = 0, length = 0, step = 0;
    uint32_t index, view;
    sph_status status = sph__gltf_get_index(d, object, "bufferView", SPH__GLTF_VIEWS, &index);
    if (status != SPH_OK) return status;
    if (index == SPH__GLTF_NONE) return sph__gltf_fail(d, object, "no bufferView");
    view = d->lists[SPH__GLTF_VIEWS].values[index];
    status = sph__gltf_get_unsigned(d, object, "byteOffset", &offset);
    if (status == SPH_OK) status = sph__gltf_get_unsigned(d, view, "byteOffset", &begin);
    if (status == SPH_OK) status = sph__gltf_get_unsigned(d, view, "byteLength", &length);
    if (status == SPH_OK) status = sph__gltf_get_unsigned(d, view, "byteStride", &step);
    if (status == SPH_OK) status = sph__gltf_get_index(d, view, "buffer", SPH__GLTF_BUFFERS, &index);
    if (status != SPH_OK) return status;
    if (index == SPH__GLTF_NONE) return sph__gltf_fail(d, view, "a bufferView without a buffer");
    if ((status = sph__gltf_buffer_bytes(d, index, &buffer, &buffer_size)) != SPH_OK) return status;
    if (begin > buffer_size || length > buffer_size - begin)
        return sph__gltf_fail(d, view, "a bufferView of %llu bytes from %llu, but the buffer has %zu",
                              (unsigned long long)length, (unsigned long long)begin, buffer_size);
    if (step == 0) step = size;
    if (step < size || step > STRIDE_LIMIT)
        return sph__gltf_fail(d, view, "byteStride is %llu for elements of %zu bytes", (unsigned long long)step, size);
    if (offset > length || length - offset < size || (length - offset - size) / step < count - 1)
        return sph__gltf_fail(d, object, "%u elements of %zu bytes from byte %llu of a bufferView of %llu bytes",
                              (unsigned)count, size, (unsigned long long)offset, (unsigned long long)length);
    *stride = (size_t)step;
    *bytes = buffer + begin + offset;
    return SPH_OK;
}

/* The component `c` of an element, as an integer that may be negative. */
static int64_t integer_at(const unsigned char *p, int type)
{
    switch (type) {
    case SPH__GLTF_I8:
        return (int8_t)*p;
    case SPH__GLTF_U8:
        return *p;
    case SPH__GLTF_I16:
        return (int16_t)(p[0] | p[1] << 8);
    case SPH__GLTF_U16:
        return p[0] | p[1] << 8;
    default:
        return p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
    }
}

static float float_at(const unsigned char *p, int type, bool normalized)
{
    const int64_t integer = integer_at(p, type);
    float value;
    if (type == SPH__GLTF_F32) {
        const uint32_t bits = (uint32_t)integer;
        memcpy(&value, &bits, sizeof value);
        return value;
    }
    value = (float)integer;
    if (!normalized) return value;
    switch (type) {
    case SPH__GLTF_I8:
        return integer < -127 ? -1 : value / 127;
    case SPH__GLTF_U8:
        return value / 255;
    case SPH__GLTF_I16:
        return integer < -32767 ? -1 : value / 32767;
    case SPH__GLTF_U16:
        return value / 65535;
    default:
        return (float)((double)integer / UINT32_MAX);
    }
}

static uint32_t sparse_index(const sph__gltf_accessor *a, uint32_t i)
{
    return (uint32_t)integer_at(a->sparse_indices + i * size_of(a->sparse_type), a->sparse_type);
}

static sph_status check_sparse(const sph__gltf_document *d, uint32_t object, const sph__gltf_accessor *a)
{
    for (uint32_t i = 0; i < a->sparse_count; ++i) {
        const uint32_t index = sparse_index(a, i);
        if (index >= a->count || (i > 0 && index <= sparse_index(a, i - 1)))
            return sph__gltf_fail(d, object, "sparse index %u of %u elements is out of range, or out of order",
                                  (unsigned)index, (unsigned)a->count);
    }
    return SPH_OK;
}

static sph_status open_sparse(sph__gltf_document *d, uint32_t object, sph__gltf_accessor *a)
{
    const size_t size = a->width * a->component_size;
    uint64_t count = 0, type = 0;
    uint32_t indices, values;
    size_t stride = 0;
    sph_status status = sph__gltf_get_unsigned(d, object, "count", &count);
    if (status == SPH_OK) status = sph__gltf_get_kind(d, object, "indices", '{', &indices);
    if (status == SPH_OK) status = sph__gltf_get_kind(d, object, "values", '{', &values);
    if (status != SPH_OK) return status;
    if (count > a->count || indices == 0 || values == 0)
        return sph__gltf_fail(d, object, "a sparse accessor without indices or values, or with more than its elements");
    if (count == 0) return SPH_OK;
    if ((status = sph__gltf_get_unsigned(d, indices, "componentType", &type)) != SPH_OK) return status;
    if (type != SPH__GLTF_U8 && type != SPH__GLTF_U16 && type != SPH__GLTF_U32)
        return sph__gltf_fail(d, indices, "sparse indices of type %llu", (unsigned long long)type);
    a->sparse_count = (uint32_t)count;
    a->sparse_type = (int)type;
    status = locate(d, indices, a->sparse_count, size_of(a->sparse_type), &stride, &a->sparse_indices);
    if (status == SPH_OK && stride != size_of(a->sparse_type))
        status = sph__gltf_fail(d, indices, "sparse indices with a stride");
    if (status == SPH_OK) status = locate(d, values, a->sparse_count, size, &stride, &a->sparse_values);
    if (status == SPH_OK && stride != size) status = sph__gltf_fail(d, values, "sparse values with a stride");
    return status == SPH_OK ? check_sparse(d, object, a) : status;
}

/* Numbers of an element. Matrices of small integers have gaps in them, and nothing that is read needs them. */
static uint32_t read_width(const sph__gltf_document *d, uint32_t object)
{
    static const struct {
        const char *name;
        uint32_t width;
    } TYPES[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
    const uint32_t value = sph__gltf_get(d, object, "type");
    for (size_t i = 0; i < sizeof TYPES / sizeof *TYPES && value != 0; ++i)
        if (sph__gltf_is(d, value, TYPES[i].name)) return TYPES[i].width;
    return 0;
}

sph_status sph__gltf_accessor_open(sph__gltf_document *d, uint32_t index, uint32_t width, sph__gltf_accessor *a)
{
    const uint32_t object = d->lists[SPH__GLTF_ACCESSORS].values[index], flag = sph__gltf_get(d, object, "normalized");
    uint64_t count = 0, type = 0;
    uint32_t sparse;
    sph_status status = sph__gltf_get_unsigned(d, object, "count", &count);
    if (status == SPH_OK) status = sph__gltf_get_unsigned(d, object, "componentType", &type);
    if (status == SPH_OK) status = sph__gltf_get_kind(d, object, "sparse", '{', &sparse);
    if (status != SPH_OK) return status;
    *a = (sph__gltf_accessor){.value = object, .width = read_width(d, object)};
    a->type = type > SPH__GLTF_F32 ? 0 : (int)type;
    a->component_size = size_of(a->type);
    a->normalized = flag != 0 && d->values[flag].kind == 't';
    if (a->width == 0 || a->component_size == 0 || (width != 0 && a->width != width))
        return sph__gltf_fail(d, object, "accessor %u has not the type that is needed here", (unsigned)index);
    if (count == 0 || count > INT32_MAX)
        return sph__gltf_fail(d, object, "accessor %u has %llu elements", (unsigned)index, (unsigned long long)count);
    a->count = (uint32_t)count;
    if (sph__gltf_get(d, object, "bufferView") != 0)
        status = locate(d, object, a->count, a->width * a->component_size, &a->stride, &a->bytes);
    if (status == SPH_OK && sparse != 0) status = open_sparse(d, sparse, a);
    return status;
}

/* The bytes of an element, NULL: zeros. */
static const unsigned char *element_bytes(const sph__gltf_accessor *a, uint32_t i)
{
    uint32_t low = 0, high = a->sparse_count;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (sparse_index(a, middle) < i)
            low = middle + 1;
        else
            high = middle;
    }
    if (low < a->sparse_count && sparse_index(a, low) == i)
        return a->sparse_values + (size_t)low * a->width * a->component_size;
    return a->bytes == NULL ? NULL : a->bytes + i * a->stride;
}

void sph__gltf_accessor_floats(const sph__gltf_accessor *a, uint32_t i, float *out)
{
    const unsigned char *p = element_bytes(a, i);
    for (uint32_t c = 0; c < a->width; ++c)
        out[c] = p == NULL ? 0 : float_at(p + c * a->component_size, a->type, a->normalized);
}

void sph__gltf_accessor_integers(const sph__gltf_accessor *a, uint32_t i, uint32_t *out)
{
    const unsigned char *p = element_bytes(a, i);
    for (uint32_t c = 0; c < a->width; ++c)
        out[c] = p == NULL ? 0 : (uint32_t)integer_at(p + c * a->component_size, a->type);
}
