/* SPDX-License-Identifier: MIT */
#include "glb.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static void put_text(layout *l, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void put_text(layout *l, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    put_bytes(l, text, strlen(text));
}

uint32_t glb_view(glb *g, const void *bytes, size_t size, unsigned stride)
{
    while (g->binary.size % 4 != 0)
        put_bytes(&g->binary, "", 1);
    put_text(&g->views, "%s{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu", g->view_count == 0 ? "" : ",",
             g->binary.size, size);
    if (stride != 0) put_text(&g->views, ",\"byteStride\":%u", stride);
    put_text(&g->views, "}");
    put_bytes(&g->binary, bytes, size);
    return g->view_count++;
}

uint32_t glb_accessor(glb *g, uint32_t view, int component, const char *type, uint32_t count, const char *more)
{
    put_text(&g->accessors, "%s{\"bufferView\":%u,\"componentType\":%d,\"type\":\"%s\",\"count\":%u%s}",
             g->accessor_count == 0 ? "" : ",", (unsigned)view, component, type, (unsigned)count, more);
    return g->accessor_count++;
}

static unsigned width_of(const char *type)
{
    return strcmp(type, "SCALAR") == 0 ? 1 : strcmp(type, "MAT4") == 0 ? 16 : (unsigned)(type[3] - '0');
}

uint32_t glb_numbers(glb *g, int component, const char *type, uint32_t count, const double *numbers, const char *more)
{
    const unsigned bytes = component >= GLB_U32 ? 4 : component >= GLB_I16 ? 2 : 1;
    layout l = {NULL, 0, 0};
    uint32_t view;
    for (uint32_t i = 0; i < count * width_of(type); ++i)
        if (component == GLB_F32)
            put_little_float(&l, (float)numbers[i]);
        else
            put_little(&l, (uint64_t)(int64_t)numbers[i], bytes);
    view = glb_view(g, l.bytes, l.size, 0);
    layout_free(&l);
    return glb_accessor(g, view, component, type, count, more);
}

uint32_t glb_floats(glb *g, const char *type, uint32_t count, const double *numbers)
{
    return glb_numbers(g, GLB_F32, type, count, numbers, "");
}

void glb_json(const glb *g, const char *rest, const char *uri, layout *out)
{
    put_text(out, "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":%zu", g->binary.size);
    if (uri != NULL) {
        put_text(out, ",\"uri\":\"");
        put_bytes(out, uri, strlen(uri));
        put_text(out, "\"");
    }
    put_text(out, "}],\"bufferViews\":[");
    put_bytes(out, g->views.bytes, g->views.size);
    put_text(out, "],\"accessors\":[");
    put_bytes(out, g->accessors.bytes, g->accessors.size);
    put_text(out, "],");
    put_bytes(out, rest, strlen(rest));
    put_text(out, "}");
}

void glb_layout(const glb *g, const char *rest, layout *out)
{
    layout json = {NULL, 0, 0};
    const size_t padding = (4 - g->binary.size % 4) % 4;
    glb_json(g, rest, NULL, &json);
    while (json.size % 4 != 0)
        put_bytes(&json, " ", 1);
    put_bytes(out, "glTF", 4);
    put_little(out, 2, 4);
    put_little(out, 12 + 8 + json.size + 8 + g->binary.size + padding, 4);
    put_little(out, json.size, 4);
    put_bytes(out, "JSON", 4);
    put_bytes(out, json.bytes, json.size);
    put_little(out, g->binary.size + padding, 4);
    put_bytes(out, "BIN", 4);
    put_bytes(out, g->binary.bytes, g->binary.size);
    put_bytes(out, "\0\0\0", padding);
    layout_free(&json);
}

const char *glb_write(glb *g, const char *name, const char *rest)
{
    layout l = {NULL, 0, 0};
    const char *path;
    glb_layout(g, rest, &l);
    path = file_write(name, l.bytes, l.size);
    layout_free(&l);
    glb_free(g);
    return path;
}

void glb_free(glb *g)
{
    layout_free(&g->binary);
    layout_free(&g->views);
    layout_free(&g->accessors);
    *g = (glb){.view_count = 0};
}
