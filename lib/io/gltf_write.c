/* SPDX-License-Identifier: MIT */
#include "io/gltf_write.h"

#include <stdio.h>
#include <string.h>

#include "io/bytes.h"

enum { HEAD_SIZE = 12 + 8 + 8 };

void sph__io_text_bytes(sph__io_text *t, const char *bytes, size_t length)
{
    void *memory = t->text;
    if (length == 0) return;
    if (t->failed || !sph__io_reserve(t->context, &memory, &t->capacity, t->length + length, 1)) {
        t->failed = true;
        return;
    }
    t->text = memory;
    memcpy(t->text + t->length, bytes, length);
    t->length += length;
}

void sph__io_text_add(sph__io_text *t, const char *format, ...)
{
    char text[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    sph__io_text_bytes(t, text, strlen(text));
}

void sph__io_text_float(sph__io_text *t, float value)
{
    char text[SPH__IO_FLOAT_TEXT];
    sph__io_text_bytes(t, text, sph__io_format_float(text, value));
}

void sph__io_text_floats(sph__io_text *t, const float *values, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        sph__io_text_bytes(t, i == 0 ? "[" : ",", 1);
        sph__io_text_float(t, values[i]);
    }
    sph__io_text_bytes(t, "]", 1);
}

/* Bytes of the well-formed character at `s`, or 0 (no overlong ones, no surrogates, nothing beyond U+10FFFF). */
static size_t character(const unsigned char *s)
{
    const size_t size = s[0] < 0x80 ? 1 : s[0] >= 0xC2 && s[0] < 0xE0 ? 2 : (s[0] & 0xF0) == 0xE0 ? 3 : 4;
    if (size == 4 && (s[0] < 0xF0 || s[0] > 0xF4)) return 0;
    for (size_t i = 1; i < size; ++i)
        if ((s[i] & 0xC0) != 0x80) return 0;
    if ((s[0] == 0xE0 && s[1] < 0xA0) || (s[0] == 0xED && s[1] > 0x9F) || (s[0] == 0xF0 && s[1] < 0x90) ||
        (s[0] == 0xF4 && s[1] > 0x8F))
        return 0;
    return size;
}

void sph__io_text_string(sph__io_text *t, const char *string)
{
    sph__io_text_bytes(t, "\"", 1);
    while (*string != '\0') {
        const size_t size = character((const unsigned char *)string);
        const unsigned char c = (unsigned char)*string;
        if (size == 0)
            sph__io_text_bytes(t, "\xEF\xBF\xBD", 3);
        else if (c < 0x20 || c == 0x7F)
            sph__io_text_add(t, "\\u%04x", c);
        else if (c == '"' || c == '\\')
            sph__io_text_add(t, "\\%c", c);
        else
            sph__io_text_bytes(t, string, size);
        string += size == 0 ? 1 : size;
    }
    sph__io_text_bytes(t, "\"", 1);
}

void sph__io_text_release(sph__io_text *t)
{
    sph_context_release(t->context, t->text);
    *t = (sph__io_text){0};
}

void sph__io_gltf_writer_open(sph__io_gltf_writer *w, sph_context *context)
{
    *w = (sph__io_gltf_writer){
        .json = {.context = context}, .views = {.context = context}, .accessors = {.context = context}};
    sph__io_text_add(&w->json, "{\"asset\":{\"version\":\"2.0\",\"generator\":\"libsphmesh\"}");
}

void sph__io_gltf_writer_release(sph__io_gltf_writer *w)
{
    sph__io_text_release(&w->json);
    sph__io_text_release(&w->views);
    sph__io_text_release(&w->accessors);
}

unsigned sph__io_gltf_add_view(sph__io_gltf_writer *w, uint64_t size, int target)
{
    sph__io_text_add(&w->views, "%s{\"buffer\":0,\"byteOffset\":%llu,\"byteLength\":%llu",
                     w->view_count == 0 ? "" : ",", (unsigned long long)w->binary, (unsigned long long)size);
    if (target != 0) sph__io_text_add(&w->views, ",\"target\":%d", target);
    sph__io_text_add(&w->views, "}");
    w->binary += size + 3 - (size + 3) % 4;
    return w->view_count++;
}

unsigned sph__io_gltf_add_accessor(sph__io_gltf_writer *w, unsigned view, uint64_t offset, int type, const char *width,
                                   size_t count, const char *more)
{
    sph__io_text_add(&w->accessors, "%s{\"bufferView\":%u,\"byteOffset\":%llu,\"componentType\":%d,\"type\":\"%s\",",
                     w->accessor_count == 0 ? "" : ",", view, (unsigned long long)offset, type, width);
    sph__io_text_add(&w->accessors, "\"count\":%zu", count);
    sph__io_text_bytes(&w->accessors, more, strlen(more));
    sph__io_text_add(&w->accessors, "}");
    return w->accessor_count++;
}

void sph__io_gltf_close_json(sph__io_gltf_writer *w, const char *uri)
{
    sph__io_text *t = &w->json;
    sph__io_text_add(t, ",\"bufferViews\":[");
    sph__io_text_bytes(t, w->views.text, w->views.length);
    sph__io_text_add(t, "],\"accessors\":[");
    sph__io_text_bytes(t, w->accessors.text, w->accessors.length);
    sph__io_text_add(t, "],\"buffers\":[{\"byteLength\":%llu", (unsigned long long)w->binary);
    if (uri != NULL) {
        sph__io_text_add(t, ",\"uri\":");
        sph__io_text_string(t, uri);
    }
    sph__io_text_add(t, "}]}");
    t->failed = t->failed || w->views.failed || w->accessors.failed;
    while (t->length % 4 != 0 && !t->failed)
        sph__io_text_add(t, " ");
}

sph_status sph__io_gltf_check(const sph__io_gltf_writer *w, const char *path)
{
    if (w->json.failed) return sph__io_fail_memory(w->json.context, path);
    if (w->binary <= UINT32_MAX - HEAD_SIZE && w->json.length <= UINT32_MAX - HEAD_SIZE - w->binary) return SPH_OK;
    return sph__io_fail(w->json.context, SPH_E_LIMIT, "%s: more than 4 GB, which a GLB cannot be", sph__io_shown(path));
}

void sph__io_gltf_put_head(sph__io_output *o, const sph__io_text *json, uint64_t binary)
{
    sph__io_output_bytes(o, "glTF", 4);
    sph__io_put(o, 2, 4);
    sph__io_put(o, (uint32_t)(HEAD_SIZE + json->length + binary), 4);
    sph__io_put(o, (uint32_t)json->length, 4);
    sph__io_output_bytes(o, "JSON", 4);
    sph__io_output_bytes(o, json->text, json->length);
    sph__io_put(o, (uint32_t)binary, 4);
    sph__io_output_bytes(o, "BIN", 4);
}

void sph__io_put(sph__io_output *o, uint32_t value, unsigned size)
{
    unsigned char bytes[4];
    sph__io_store_32(bytes, value, false);
    sph__io_output_bytes(o, bytes, size);
}

void sph__io_put_float(sph__io_output *o, float value)
{
    unsigned char bytes[4];
    sph__io_store_float(bytes, value, false);
    sph__io_output_bytes(o, bytes, 4);
}
