/* SPDX-License-Identifier: MIT */
#include "rig.h"

#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support.h"

static void turn_about(const double p[3], const double axis[3], double angle, double t[12])
{
    const double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]), c = cos(angle),
                 s = sin(angle);
    double u[3];
    for (int k = 0; k < 3; ++k)
        u[k] = axis[k] / length;
    for (int r = 0; r < 3; ++r) {
        const int a = (r + 1) % 3, b = (r + 2) % 3;
        for (int k = 0; k < 3; ++k)
            t[4 * r + k] = u[r] * u[k] * (1 - c) + (r == k ? c : 0);
        t[4 * r + a] -= s * u[b];
        t[4 * r + b] += s * u[a];
    }
    for (int r = 0; r < 3; ++r)
        t[4 * r + 3] = p[r] - t[4 * r] * p[0] - t[4 * r + 1] * p[1] - t[4 * r + 2] * p[2];
}

static void product(const double a[12], const double b[12], double out[12])
{
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 4; ++c) {
            out[4 * r + c] = c == 3 ? a[4 * r + 3] : 0;
            for (int k = 0; k < 3; ++k)
                out[4 * r + c] += a[4 * r + k] * b[4 * k + c];
        }
}

static void make_motion(rig_input *r, uint32_t bones, uint64_t *seed)
{
    for (uint32_t b = 0; b < bones; ++b) {
        for (uint32_t k = 0; k < 3; ++k)
            r->pivots[3 * b + k] = k == 0 ? 2.0 * b / bones - 1 : 0.1 * test_random_unit(seed);
        if (b > 0) {
            r->links[2 * b - 2] = b - 1;
            r->links[2 * b - 1] = b;
        }
    }
    for (uint32_t f = 0; f < RIG_FRAMES; ++f)
        for (uint32_t b = 0; b < bones; ++b) {
            double axis[3], t[12], middle[3], *to = r->transforms + 12 * (f * bones + b);
            for (int k = 0; k < 3; ++k) {
                axis[k] = test_random_unit(seed) - 0.5;
                middle[k] = (r->pivots[3 * b + (unsigned)k] + r->pivots[3 * (b > 0 ? b - 1 : b) + (unsigned)k]) / 2;
            }
            turn_about(middle, axis, b == 0 ? 3.0 * (f + 1) : 0.6 * test_random_unit(seed), t);
            if (b == 0)
                memcpy(to, t, sizeof t);
            else
                product(to - 12, t, to);
        }
}

void rig_input_make(rig_input *r, uint32_t vertices, uint32_t bones, uint32_t slots)
{
    uint64_t seed = vertices + 1000 * bones + 7 * slots;
    memset(r, 0, sizeof *r);
    for (uint32_t v = 0; v < vertices; ++v) {
        r->rest[3 * v] = 2 * (float)v / (float)vertices - 1;
        r->rest[3 * v + 1] = 0.25f * (float)(v % 2);
        r->rest[3 * v + 2] = 0.1f * (float)test_random_unit(&seed);
        for (uint32_t s = 0; s < slots; ++s) {
            r->bones[v * slots + s] = (uint32_t)(test_random(&seed) % bones);
            r->weights[v * slots + s] = s == 0 || v % slots >= s ? 1 : 0;
        }
    }
    for (uint32_t v = 0; v < vertices; ++v) {
        double sum = 0;
        for (uint32_t s = 0; s < slots; ++s) {
            r->weights[v * slots + s] *= (float)(0.05 + test_random_unit(&seed));
            sum += (double)r->weights[v * slots + s];
        }
        for (uint32_t s = 0; s < slots; ++s)
            r->weights[v * slots + s] = (float)((double)r->weights[v * slots + s] / sum);
    }
    for (uint32_t t = 0; t + 2 < vertices; ++t)
        for (uint32_t k = 0; k < 3; ++k)
            r->triangles[3 * t + k] = t + (t % 2 == 0 ? k : 2 - k);
    make_motion(r, bones, &seed);
    r->clips[0] = (sph_skin_clip){"walk", 0, 10, 24};
    r->clips[1] = (sph_skin_clip){NULL, 10, 5, 0};
    r->arrays = (sph_skin_arrays){.struct_size = sizeof r->arrays,
                                  .vertex_count = vertices,
                                  .bone_count = bones,
                                  .influence_count = slots,
                                  .frame_count = RIG_FRAMES,
                                  .clip_count = 2,
                                  .rest = r->rest,
                                  .bones = r->bones,
                                  .weights = r->weights,
                                  .transforms = r->transforms,
                                  .clips = r->clips,
                                  .pivots = r->pivots,
                                  .triangle_count = vertices - 2,
                                  .triangles = r->triangles,
                                  .link_count = bones - 1,
                                  .links = r->links};
}

sph_skin *rig_skin(sph_context *context, const rig_input *r)
{
    sph_skin *skin = NULL;
    (void)sph_skin_create_from_arrays(context, &r->arrays, &skin);
    return skin;
}

void rig_vertex(const sph_skin_arrays *skin, uint32_t frame, uint32_t vertex, double out[3])
{
    const uint32_t k = skin->influence_count;
    for (int r = 0; r < 3; ++r)
        out[r] = 0;
    for (uint32_t s = vertex * k; s < (vertex + 1) * k; ++s) {
        const double *t = skin->transforms + 12 * ((size_t)frame * skin->bone_count + skin->bones[s]);
        for (int r = 0; r < 3; ++r) {
            double moved = t[4 * r + 3];
            for (int c = 0; c < 3; ++c)
                moved += t[4 * r + c] * (double)skin->rest[3 * vertex + (unsigned)c];
            out[r] += (double)skin->weights[s] * moved;
        }
    }
}

static uint32_t little(const unsigned char *p, unsigned size)
{
    uint32_t value = 0;
    while (size-- > 0)
        value = value << 8 | p[size];
    return value;
}

void rig_open(rig_file *f, const char *path)
{
    json_error_t error;
    size_t length;
    f->bytes = file_read(path, &f->size);
    ck_assert_uint_gt(f->size, 28);
    ck_assert_mem_eq(f->bytes, "glTF\2\0\0\0", 8);
    ck_assert_uint_eq(little(f->bytes + 8, 4), f->size);
    length = little(f->bytes + 12, 4);
    ck_assert_uint_eq(length % 4, 0);
    ck_assert_mem_eq(f->bytes + 16, "JSON", 4);
    f->json = json_loadb((const char *)f->bytes + 20, length, JSON_REJECT_DUPLICATES, &error);
    ck_assert_msg(f->json != NULL, "%s", error.text);
    f->binary_size = little(f->bytes + 20 + length, 4);
    ck_assert_uint_eq(28 + length + f->binary_size, f->size);
    ck_assert_uint_eq(f->binary_size % 4, 0);
    ck_assert_mem_eq(f->bytes + 24 + length, "BIN", 4);
    f->binary = f->bytes + 28 + length;
}

void rig_close(rig_file *f)
{
    json_decref(f->json);
    free(f->bytes);
}

json_t *rig_value(const rig_file *f, const char *path)
{
    char part[64];
    json_t *at = f->json;
    while (*path != '\0' && at != NULL) {
        const size_t length = strcspn(path, "/");
        snprintf(part, sizeof part, "%.*s", (int)length, path);
        at = json_is_array(at) ? json_array_get(at, (size_t)atoi(part)) : json_object_get(at, part);
        path += length + (path[length] == '/');
    }
    return at;
}

json_int_t rig_integer(const rig_file *f, const char *path)
{
    const json_t *value = rig_value(f, path);
    return json_is_integer(value) ? json_integer_value(value) : -1;
}

static json_t *accessor_of(const rig_file *f, json_int_t accessor)
{
    json_t *a = json_array_get(json_object_get(f->json, "accessors"), (size_t)accessor);
    ck_assert_ptr_nonnull(a);
    return a;
}

static json_int_t member(const json_t *object, const char *name)
{
    return json_integer_value(json_object_get(object, name));
}

size_t rig_count(const rig_file *f, json_int_t accessor)
{
    return (size_t)member(accessor_of(f, accessor), "count");
}

const char *rig_type(const rig_file *f, json_int_t accessor)
{
    return json_string_value(json_object_get(accessor_of(f, accessor), "type"));
}

json_int_t rig_component_type(const rig_file *f, json_int_t accessor)
{
    return member(accessor_of(f, accessor), "componentType");
}

double rig_number(const rig_file *f, json_int_t accessor, size_t element, unsigned component)
{
    const json_t *a = accessor_of(f, accessor);
    const json_t *view = json_array_get(json_object_get(f->json, "bufferViews"), (size_t)member(a, "bufferView"));
    const char *type = json_string_value(json_object_get(a, "type"));
    const json_int_t kind = member(a, "componentType");
    const unsigned size = kind == 5121 ? 1 : kind == 5123 ? 2 : 4;
    const unsigned components = strcmp(type, "SCALAR") == 0 ? 1
                                : strcmp(type, "MAT4") == 0 ? 16
                                                            : (unsigned)type[3] - '0';
    const size_t offset = (size_t)member(a, "byteOffset") + (element * components + component) * size;
    const unsigned char *p = f->binary + member(view, "byteOffset") + offset;
    uint32_t bits;
    float value;
    ck_assert_uint_lt(element, (size_t)member(a, "count"));
    ck_assert_uint_le(offset + size, (size_t)member(view, "byteLength"));
    ck_assert_uint_le((size_t)(p + size - f->binary), f->binary_size);
    ck_assert_uint_eq((size_t)(p - f->binary) % size, 0);
    bits = little(p, size);
    memcpy(&value, &bits, sizeof value);
    return kind == 5126 ? (double)value : bits;
}
