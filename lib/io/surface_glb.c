/* SPDX-License-Identifier: MIT */
/* One frame of a surface as a GLB: a mesh of positions, normals and triangles. */
#include <stdio.h>
#include <string.h>

#include "io/io.h"

enum { FLOAT_TYPE = 5126, INTEGER_TYPE = 5125, VERTEX_TARGET = 34962, INDEX_TARGET = 34963, JSON_SIZE = 1400 };

static void put(sph__io_output *o, uint32_t value)
{
    const unsigned char bytes[4] = {(unsigned char)value, (unsigned char)(value >> 8), (unsigned char)(value >> 16),
                                    (unsigned char)(value >> 24)};
    sph__io_output_bytes(o, bytes, sizeof bytes);
}

static void put_floats(sph__io_output *o, const float *values, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        put(o, bits);
    }
}

/* The bounds that the format wants of positions: "x,y,z". */
static void bound(const float *xyz, size_t vertices, bool upper, char text[3 * SPH__IO_FLOAT_TEXT])
{
    size_t length = 0;
    for (size_t k = 0; k < 3; ++k) {
        float most = vertices == 0 ? 0 : xyz[k];
        for (size_t i = 1; i < vertices; ++i)
            if (upper ? xyz[3 * i + k] > most : xyz[3 * i + k] < most) most = xyz[3 * i + k];
        if (k > 0) text[length++] = ',';
        length += sph__io_format_float(text + length, most);
    }
}

static size_t describe(char text[JSON_SIZE], const float *xyz, size_t vertices, size_t triangles)
{
    char low[3 * SPH__IO_FLOAT_TEXT], high[3 * SPH__IO_FLOAT_TEXT];
    size_t length;
    bound(xyz, vertices, false, low);
    bound(xyz, vertices, true, high);
    snprintf(
        text, JSON_SIZE,
        "{\"asset\":{\"version\":\"2.0\",\"generator\":\"libsphmesh\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
        "\"nodes\":[{\"name\":\"surface\",\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,"
        "\"NORMAL\":1},\"indices\":2,\"material\":0}]}],\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorFactor\":"
        "[0.25,0.5,0.8,1],\"metallicFactor\":0}}],\"accessors\":[{\"bufferView\":0,\"componentType\":%d,\"type\":"
        "\"VEC3\",\"count\":%zu,\"min\":[%s],\"max\":[%s]},{\"bufferView\":1,\"componentType\":%d,\"type\":\"VEC3\","
        "\"count\":%zu},{\"bufferView\":2,\"componentType\":%d,\"type\":\"SCALAR\",\"count\":%zu}],\"bufferViews\":"
        "[{\"buffer\":0,\"byteOffset\":0,\"byteLength\":%zu,\"target\":%d},{\"buffer\":0,\"byteOffset\":%zu,"
        "\"byteLength\":%zu,\"target\":%d},{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu,\"target\":%d}],"
        "\"buffers\":[{\"byteLength\":%zu}]}",
        FLOAT_TYPE, vertices, low, high, FLOAT_TYPE, vertices, INTEGER_TYPE, 3 * triangles, 12 * vertices,
        VERTEX_TARGET, 12 * vertices, 12 * vertices, VERTEX_TARGET, 24 * vertices, 12 * triangles, INDEX_TARGET,
        24 * vertices + 12 * triangles);
    for (length = strlen(text); length % 4 != 0;)
        text[length++] = ' ';
    return length;
}

void sph__io_surface_glb_write(sph__io_output *o, const sph_surface *surface, uint32_t index)
{
    const size_t vertices = sph_surface_vertex_count(surface, index),
                 triangles = sph_surface_triangle_count(surface, index);
    const float *xyz = sph_surface_positions(surface, index);
    const uint32_t *t = sph_surface_triangles(surface, index);
    const uint64_t binary = 24 * (uint64_t)vertices + 12 * (uint64_t)triangles;
    char text[JSON_SIZE];
    const size_t length = describe(text, xyz, vertices, triangles);
    if (binary > UINT32_MAX - 28 - length) {
        o->status = sph__io_fail(o->context, SPH_E_LIMIT, "%s: more than 4 GB, which a GLB cannot be",
                                 sph__io_shown(o->target));
        return;
    }
    sph__io_output_bytes(o, "glTF", 4);
    put(o, 2);
    put(o, (uint32_t)(12 + 8 + length + 8 + binary));
    put(o, (uint32_t)length);
    sph__io_output_bytes(o, "JSON", 4);
    sph__io_output_bytes(o, text, length);
    put(o, (uint32_t)binary);
    sph__io_output_bytes(o, "BIN", 4);
    put_floats(o, xyz, 3 * vertices);
    put_floats(o, sph_surface_normals(surface, index), 3 * vertices);
    for (size_t i = 0; i < 3 * triangles; ++i)
        put(o, t[i]);
}
