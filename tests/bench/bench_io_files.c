/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench_io.h"

enum { SIDES = 20 };

static void place(uint32_t v, uint32_t frame, double out[3])
{
    const double ring = v / SIDES, angle = 2 * M_PI * (v % SIDES) / SIDES;
    out[0] = (1 + 0.1 * sin(0.3 * ring + 0.05 * frame)) * cos(angle);
    out[1] = (1 + 0.1 * cos(0.2 * ring + 0.03 * frame)) * sin(angle);
    out[2] = 0.1 * ring;
}

/* With six digits after the point, as most programs print them; printf would take longer than all that is measured. */
static char *put_number(char *p, double value)
{
    uint64_t digits = (uint64_t)(fabs(value) * 1e6 + 0.5);
    char reversed[24];
    int count = 0;
    if (value < 0) *p++ = '-';
    while (count < 7 || digits != 0) {
        if (count == 6) reversed[count++] = '.';
        reversed[count++] = (char)('0' + digits % 10);
        digits /= 10;
    }
    while (count > 0)
        *p++ = reversed[--count];
    return p;
}

static char *put_integer(char *p, uint32_t value)
{
    char reversed[12];
    int count = 0;
    do
        reversed[count++] = (char)('0' + value % 10);
    while ((value /= 10) != 0);
    while (count > 0)
        *p++ = reversed[--count];
    return p;
}

static char *put_record(char *p, const char *keyword, const double *values, int count)
{
    while (*keyword != '\0')
        *p++ = *keyword++;
    for (int i = 0; i < count; ++i) {
        *p++ = ' ';
        p = put_number(p, values[i]);
    }
    *p++ = '\n';
    return p;
}

static char *put_face(char *p, const uint32_t *corners, int count, bool rich)
{
    *p++ = 'f';
    for (int i = 0; i < count; ++i) {
        *p++ = ' ';
        p = put_integer(p, corners[i] + 1);
        for (int k = 0; k < 2 && rich; ++k) {
            *p++ = '/';
            p = put_integer(p, corners[i] + 1);
        }
    }
    *p++ = '\n';
    return p;
}

static FILE *create(const char *path)
{
    FILE *file = fopen(path, "wb");
    if (file == NULL) bench_die(path);
    return file;
}

static void finish(FILE *file, const char *path)
{
    if (ferror(file) || fclose(file) != 0) bench_die(path);
}

void bench_write_obj(const char *path, uint32_t vertices, uint32_t frame, bool rich)
{
    char *text = malloc((size_t)vertices * 400 + 100), *p = text;
    FILE *file = create(path);
    if (text == NULL) bench_die("memory");
    for (uint32_t v = 0; v < vertices; ++v) {
        double xyz[3];
        place(v, frame, xyz);
        p = put_record(p, "v", xyz, 3);
    }
    for (uint32_t v = 0; v < vertices && rich; ++v) {
        const double uv[2] = {(double)(v % SIDES) / SIDES, (double)v / vertices};
        const double normal[3] = {cos(0.1 * v), sin(0.1 * v), 0};
        p = put_record(p, "vt", uv, 2);
        p = put_record(p, "vn", normal, 3);
    }
    for (uint32_t v = 0; v + SIDES < vertices; ++v) {
        const uint32_t next = v - v % SIDES + (v + 1) % SIDES;
        const uint32_t quad[4] = {v, next, next + SIDES, v + SIDES},
                       triangles[2][3] = {{v, next, v + SIDES}, {next, next + SIDES, v + SIDES}};
        if (next + SIDES >= vertices) continue;
        if (rich) {
            p = put_face(p, quad, 4, true);
        } else {
            p = put_face(p, triangles[0], 3, false);
            p = put_face(p, triangles[1], 3, false);
        }
    }
    fwrite(text, 1, (size_t)(p - text), file);
    finish(file, path);
    free(text);
}

/* A 32-bit number, in the order of bytes that the format has. */
static void put_word(FILE *file, uint32_t word, bool big)
{
    unsigned char bytes[4];
    for (unsigned i = 0; i < 4; ++i)
        bytes[big ? 3 - i : i] = (unsigned char)(word >> 8 * i);
    fwrite(bytes, 1, 4, file);
}

static void put_floats(FILE *file, const float *values, size_t count, bool big)
{
    for (size_t i = 0; i < count; ++i) {
        uint32_t word;
        memcpy(&word, &values[i], sizeof word);
        put_word(file, word, big);
    }
}

void bench_write_cache(const char *path, uint32_t vertices, uint32_t frames)
{
    const bool mdd = strstr(path, ".mdd") != NULL;
    float *xyz = calloc(vertices, 3 * sizeof *xyz);
    FILE *file = create(path);
    const float header[2] = {0, 1};
    if (xyz == NULL) bench_die("memory");
    if (mdd) {
        put_word(file, frames, true);
        put_word(file, vertices, true);
        for (uint32_t f = 0; f < frames; ++f) {
            const float time = (float)f / 30;
            put_floats(file, &time, 1, true);
        }
    } else {
        fwrite("POINTCACHE2", 1, 12, file);
        put_word(file, 1, false);
        put_word(file, vertices, false);
        put_floats(file, header, 2, false);
        put_word(file, frames, false);
    }
    for (uint32_t i = 0; i < 3 * vertices; ++i)
        xyz[i] = (float)sin(0.01 * i);
    for (uint32_t f = 0; f < frames; ++f) {
        xyz[f % (3 * vertices)] += 1;
        put_floats(file, xyz, 3 * (size_t)vertices, mdd);
    }
    finish(file, path);
    free(xyz);
}

/* --- GLB --- */

typedef struct glb {
    char *json;
    FILE *binary;
    char *bytes;
    size_t size, views;
    char *accessors;
    size_t accessor_size;
    FILE *accessor_list, *view_list;
    char *view_text;
    size_t view_size;
} glb;

/* The bytes since the last view become one, and an accessor. */
static void end_view(glb *g, size_t begin, int type, const char *shape, uint32_t count)
{
    const size_t end = (size_t)ftell(g->binary);
    fprintf(g->view_list, "%s{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu}", g->views == 0 ? "" : ",", begin,
            end - begin);
    fprintf(g->accessor_list, "%s{\"bufferView\":%zu,\"componentType\":%d,\"type\":\"%s\",\"count\":%u}",
            g->views == 0 ? "" : ",", g->views, type, shape, (unsigned)count);
    ++g->views;
}

static void put_view(glb *g, const float *values, const char *shape, uint32_t width, uint32_t count)
{
    const size_t begin = (size_t)ftell(g->binary);
    put_floats(g->binary, values, (size_t)width * count, false);
    end_view(g, begin, 5126, shape, count);
}

static void put_mesh(glb *g, uint32_t vertices, uint32_t joints)
{
    float *values = calloc(vertices, 4 * sizeof *values);
    uint32_t count = 0;
    size_t begin;
    if (values == NULL) bench_die("memory");
    for (uint32_t v = 0; v < vertices; ++v) {
        double xyz[3];
        place(v, 0, xyz);
        for (int k = 0; k < 3; ++k)
            values[3 * v + (uint32_t)k] = (float)xyz[k];
    }
    put_view(g, values, "VEC3", 3, vertices);
    begin = (size_t)ftell(g->binary);
    for (uint32_t v = 0; v < vertices; ++v)
        for (uint32_t k = 0; k < 4; ++k)
            fputc((int)((v * 7 + 11 * k) % joints), g->binary);
    end_view(g, begin, 5121, "VEC4", vertices);
    for (uint32_t i = 0; i < 4 * vertices; ++i)
        values[i] = 0.1f + 0.1f * (float)(i % 4);
    put_view(g, values, "VEC4", 4, vertices);
    begin = (size_t)ftell(g->binary);
    for (uint32_t v = 0; v + SIDES + 1 < vertices; ++v) {
        const uint32_t corners[6] = {v, v + 1, v + SIDES, v + 1, v + SIDES + 1, v + SIDES};
        for (int k = 0; k < 6; ++k)
            put_word(g->binary, corners[k], false);
        count += 6;
    }
    end_view(g, begin, 5125, "SCALAR", count);
    free(values);
}

static void put_motion(glb *g, uint32_t joints, uint32_t frames)
{
    float *values = calloc(joints + frames, 16 * sizeof *values);
    if (values == NULL) bench_die("memory");
    for (uint32_t i = 0; i < 16 * joints; ++i)
        values[i] = i % 16 % 5 == 0;
    for (uint32_t j = 0; j < joints; ++j)
        values[16 * j + 14] = -(float)j;
    put_view(g, values, "MAT4", 16, joints);
    for (uint32_t f = 0; f < frames; ++f)
        values[f] = (float)f / 30;
    put_view(g, values, "SCALAR", 1, frames);
    for (uint32_t j = 0; j < joints; ++j) {
        for (uint32_t f = 0; f < frames; ++f) {
            const double half = 0.1 * sin(0.05 * f * (1 + j % 3));
            values[4 * f] = (float)sin(half);
            values[4 * f + 1] = values[4 * f + 2] = 0;
            values[4 * f + 3] = (float)cos(half);
        }
        put_view(g, values, "VEC4", 4, frames);
    }
    free(values);
}

/* Node 0 is the mesh, node 1 + j joint j, below the one before it. */
static char *make_json(glb *g, uint32_t joints)
{
    char *text = NULL;
    size_t size = 0;
    FILE *json = open_memstream(&text, &size);
    if (json == NULL) bench_die("memory");
    fprintf(json, "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0,1]}],\"nodes\":[{\"mesh\":0,\"skin\":0}");
    for (uint32_t j = 0; j < joints; ++j) {
        fprintf(json, ",{\"translation\":[0,0,%d]", j > 0);
        if (j + 1 < joints) fprintf(json, ",\"children\":[%u]", (unsigned)j + 2);
        fputc('}', json);
    }
    fputs(
        "],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"JOINTS_0\":1,\"WEIGHTS_0\":2},\"indices\":3}]"
        "}],\"skins\":[{\"inverseBindMatrices\":4,\"joints\":[",
        json);
    for (uint32_t j = 0; j < joints; ++j)
        fprintf(json, "%s%u", j == 0 ? "" : ",", (unsigned)j + 1);
    fputs("]}],\"animations\":[{\"channels\":[", json);
    for (uint32_t j = 0; j < joints; ++j)
        fprintf(json, "%s{\"sampler\":%u,\"target\":{\"node\":%u,\"path\":\"rotation\"}}", j == 0 ? "" : ",",
                (unsigned)j, (unsigned)j + 1);
    fputs("],\"samplers\":[", json);
    for (uint32_t j = 0; j < joints; ++j)
        fprintf(json, "%s{\"input\":5,\"output\":%u}", j == 0 ? "" : ",", (unsigned)j + 6);
    fprintf(json, "]}],\"buffers\":[{\"byteLength\":%zu}],\"bufferViews\":[%s],\"accessors\":[%s]}", g->size,
            g->view_text, g->accessors);
    fclose(json);
    return text;
}

void bench_write_glb(const char *path, uint32_t vertices, uint32_t joints, uint32_t frames)
{
    glb g = {.json = NULL};
    FILE *file = create(path);
    size_t length;
    g.binary = open_memstream(&g.bytes, &g.size);
    g.view_list = open_memstream(&g.view_text, &g.view_size);
    g.accessor_list = open_memstream(&g.accessors, &g.accessor_size);
    if (g.binary == NULL || g.view_list == NULL || g.accessor_list == NULL) bench_die("memory");
    put_mesh(&g, vertices, joints);
    put_motion(&g, joints, frames);
    fclose(g.binary);
    fclose(g.view_list);
    fclose(g.accessor_list);
    g.json = make_json(&g, joints);
    length = (strlen(g.json) + 3) / 4 * 4;
    fwrite("glTF\2\0\0", 1, 8, file);
    put_word(file, (uint32_t)(12 + 8 + length + 8 + g.size), false);
    put_word(file, (uint32_t)length, false);
    fprintf(file, "JSON%-*s", (int)length, g.json);
    put_word(file, (uint32_t)g.size, false);
    fwrite("BIN", 1, 4, file);
    fwrite(g.bytes, 1, g.size, file);
    finish(file, path);
    free(g.json);
    free(g.bytes);
    free(g.view_text);
    free(g.accessors);
}
