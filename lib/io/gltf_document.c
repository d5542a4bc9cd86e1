/* SPDX-License-Identifier: MIT */
/* The file around the JSON: the chunks of a GLB, what the glTF requires of its reader, and its buffers. */
#include <stdio.h>
#include <string.h>

#include "io/gltf.h"

enum { GLB_HEADER = 12, CHUNK_HEADER = 8, JSON_CHUNK = 0x4E4F534A, BINARY_CHUNK = 0x004E4942 };

/* Bytes of arrays: so many in any case, and so many for each byte of the file and its buffers. */
#define BUDGET_BASE ((uint64_t)1 << 26)
enum { BUDGET_FACTOR = 64 };

/* Extensions that leave positions as they are, or that add nothing but types of components, which are all read. */
static const char *const HARMLESS[] = {
    "KHR_mesh_quantization", "KHR_texture_transform", "KHR_texture_basisu", "KHR_lights_punctual", "KHR_xmp",
    "KHR_xmp_json_ld",       "EXT_texture_webp",      "EXT_texture_avif",   "MSFT_texture_dds"};
static const char MATERIALS[] = "KHR_materials_"; /* and all that begins like this */

static uint32_t read_little(const unsigned char *p)
{
    return p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static sph_status fail(const sph__gltf_document *d, const char *what, size_t byte)
{
    return sph__io_fail(d->context, SPH_E_FORMAT, "%s: byte %zu: %s", sph__io_shown(d->path), byte, what);
}

/* The chunk at *place; moves *place after it. */
static sph_status read_chunk(const sph__gltf_document *d, size_t end, size_t *place, uint32_t *type,
                             const unsigned char **bytes, size_t *size)
{
    const unsigned char *p = d->map->bytes + *place;
    if (end - *place < CHUNK_HEADER) return fail(d, "the file ends within the header of a chunk", *place);
    *size = read_little(p);
    *type = read_little(p + 4);
    *bytes = p + CHUNK_HEADER;
    if (*size > end - *place - CHUNK_HEADER) return fail(d, "a chunk that is longer than the file", *place);
    *place += CHUNK_HEADER + *size;
    return SPH_OK;
}

static sph_status read_glb(sph__gltf_document *d)
{
    const unsigned char *bytes = d->map->bytes;
    size_t place = GLB_HEADER, size, end;
    uint32_t type;
    sph_status status;
    if (d->map->size < GLB_HEADER) return fail(d, "the file ends within its header", d->map->size);
    if (read_little(bytes + 4) != 2)
        return sph__io_fail(d->context, SPH_E_UNSUPPORTED, "%s: byte 4: binary glTF version %u, only 2 is read",
                            sph__io_shown(d->path), (unsigned)read_little(bytes + 4));
    end = read_little(bytes + 8);
    if (end > d->map->size || end < GLB_HEADER)
        return sph__io_fail(d->context, SPH_E_FORMAT, "%s: byte 8: the header says %zu bytes, the file has %zu",
                            sph__io_shown(d->path), end, d->map->size);
    status = read_chunk(d, end, &place, &type, &bytes, &size);
    if (status != SPH_OK) return status;
    if (type != JSON_CHUNK) return fail(d, "the first chunk is not JSON", GLB_HEADER + 4);
    d->text = (const char *)bytes;
    d->text_end = d->text + size;
    while (place < end) {
        if ((status = read_chunk(d, end, &place, &type, &bytes, &size)) != SPH_OK) return status;
        if (type != BINARY_CHUNK || d->binary != NULL) continue;
        d->binary = bytes;
        d->binary_size = size;
    }
    return SPH_OK;
}

static bool is_harmless(const sph__gltf_document *d, uint32_t value)
{
    const char *p = d->text + d->values[value].begin;
    const size_t length = sizeof MATERIALS - 1;
    for (size_t i = 0; i < sizeof HARMLESS / sizeof *HARMLESS; ++i)
        if (sph__gltf_is(d, value, HARMLESS[i])) return true;
    return (size_t)(d->text_end - p) > length && memcmp(p + 1, MATERIALS, length) == 0;
}

static sph_status check_extensions(const sph__gltf_document *d)
{
    uint32_t array, value;
    sph_status status = sph__gltf_get_kind(d, 0, "extensionsRequired", '[', &array);
    if (status != SPH_OK || array == 0) return status;
    value = array + 1;
    for (uint32_t i = 0; i < d->values[array].count; ++i, value = d->values[value].next) {
        char *name;
        if (d->values[value].kind != '"') return sph__gltf_fail(d, value, "not the name of an extension");
        if (is_harmless(d, value)) continue;
        if ((status = sph__gltf_copy_text(d, value, &name)) == SPH_OK)
            status = sph__io_fail(d->context, SPH_E_UNSUPPORTED, "%s: it requires the extension %s, which is not read",
                                  sph__io_shown(d->path), sph__io_shown(name));
        sph_context_release(d->context, name);
        return status;
    }
    return SPH_OK;
}

static sph_status check_version(const sph__gltf_document *d)
{
    const char *const names[] = {"version", "minVersion"};
    uint32_t asset, value;
    sph_status status = sph__gltf_get_kind(d, 0, "asset", '{', &asset);
    if (status != SPH_OK) return status;
    if (asset == 0) return sph__gltf_fail(d, 0, "no asset with a version: not a glTF");
    for (int i = 0; i < 2; ++i) {
        if ((status = sph__gltf_get_kind(d, asset, names[i], '"', &value)) != SPH_OK) return status;
        if (value == 0 && i == 0) return sph__gltf_fail(d, asset, "no version");
        if (value == 0) continue;
        if (memcmp(d->text + d->values[value].begin, i == 0 ? "\"2." : "\"2.0", i == 0 ? 3 : 4) != 0)
            return sph__io_fail(d->context, SPH_E_UNSUPPORTED, "%s: byte %zu: of a glTF version that is not read",
                                sph__io_shown(d->path),
                                (size_t)(d->text - (const char *)d->map->bytes) + d->values[value].begin);
    }
    return SPH_OK;
}

sph_status sph__gltf_document_open(sph_context *context, const char *path, const sph__io_map *map,
                                   sph__gltf_document *d)
{
    const char *text = (const char *)map->bytes;
    sph_status status = SPH_OK;
    *d = (sph__gltf_document){.context = context, .path = path, .map = map, .text = text, .text_end = text + map->size};
    d->budget = BUDGET_BASE + BUDGET_FACTOR * (uint64_t)map->size;
    if (map->size >= 4 && memcmp(text, "glTF", 4) == 0)
        status = read_glb(d);
    else if (map->size >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0)
        d->text += 3;
    if (status == SPH_OK) status = sph__gltf_parse(d);
    if (status == SPH_OK) status = check_version(d);
    if (status == SPH_OK) status = check_extensions(d);
    if (status == SPH_OK) {
        const size_t count = d->lists[SPH__GLTF_BUFFERS].count;
        d->buffers = sph_context_allocate(context, count + 1, sizeof *d->buffers);
        if (d->buffers == NULL) status = sph__io_fail_memory(context, path);
        for (size_t i = 0; i < count && d->buffers != NULL; ++i)
            d->buffers[i] = (sph__gltf_buffer){NULL, 0, NULL, {NULL, 0}};
    }
    if (status != SPH_OK) sph__gltf_document_close(d);
    return status;
}

void sph__gltf_document_close(sph__gltf_document *d)
{
    for (uint32_t i = 0; i < d->lists[SPH__GLTF_BUFFERS].count && d->buffers != NULL; ++i) {
        sph_context_release(d->context, d->buffers[i].decoded);
        sph__io_map_close(&d->buffers[i].map);
    }
    for (int i = 0; i < SPH__GLTF_LISTS; ++i)
        sph_context_release(d->context, d->lists[i].values);
    sph_context_release(d->context, d->buffers);
    sph_context_release(d->context, d->values);
    *d = (sph__gltf_document){.context = d->context};
}

sph_status sph__gltf_allocate(sph__gltf_document *d, size_t count, size_t size, void *out)
{
    void *memory;
    if (count > d->budget / size)
        return sph__io_fail(d->context, SPH_E_LIMIT, "%s: it would take far more memory than a file of its size should",
                            sph__io_shown(d->path));
    d->budget -= count * size;
    memory = sph_context_allocate(d->context, count == 0 ? 1 : count, size);
    memcpy(out, &memory, sizeof memory);
    return memory == NULL ? sph__io_fail_memory(d->context, d->path) : SPH_OK;
}

static int hexadecimal(char c)
{
    const char lower = (char)(c | 0x20);
    if (c >= '0' && c <= '9') return c - '0';
    return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
}

/* Takes %20 and the like back, in place; false where that gives a zero. */
static bool decode_percent(char *text)
{
    char *to = text;
    for (const char *p = text; *p != '\0'; ++p) {
        const int high = *p == '%' ? hexadecimal(p[1]) : -1, low = high < 0 ? -1 : hexadecimal(p[2]);
        if (low >= 0) {
            *to = (char)(high << 4 | low);
            if (*to++ == '\0') return false;
            p += 2;
        } else {
            *to++ = *p;
        }
    }
    *to = '\0';
    return true;
}

/* A file beside the glTF. */
sph_status sph__gltf_map_file(const sph__gltf_document *d, uint32_t value, char *uri, sph__io_map *map)
{
    const char *slash = strrchr(d->path, '/');
    const size_t folder = slash == NULL ? 0 : (size_t)(slash - d->path) + 1;
    const size_t size = strcspn(uri, "/?#");
    char *path;
    sph_status status;
    if (memchr(uri, ':', size) != NULL || uri[0] == '/')
        return sph__io_fail(d->context, SPH_E_UNSUPPORTED, "%s: a part of it at %.100s: only files beside it are read",
                            sph__io_shown(d->path), uri);
    if (!decode_percent(uri)) return sph__gltf_fail(d, value, "a file name with a zero in it");
    path = sph_context_allocate(d->context, folder + strlen(uri) + 1, 1);
    if (path == NULL) return sph__io_fail_memory(d->context, d->path);
    memcpy(path, d->path, folder);
    memcpy(path + folder, uri, strlen(uri) + 1);
    status = sph__io_map_open(d->context, path, map);
    sph_context_release(d->context, path);
    return status;
}

static sph_status find_bytes(sph__gltf_document *d, uint32_t index, sph__gltf_buffer *buffer)
{
    const uint32_t object = d->lists[SPH__GLTF_BUFFERS].values[index];
    uint32_t value;
    char *uri;
    sph_status status = sph__gltf_get_kind(d, object, "uri", '"', &value);
    if (status != SPH_OK) return status;
    if (value == 0 && (index != 0 || d->binary == NULL))
        return sph__gltf_fail(d, object, "buffer %u has no bytes", (unsigned)index);
    if (value == 0) {
        buffer->bytes = d->binary;
        buffer->size = d->binary_size;
        return SPH_OK;
    }
    status = sph__gltf_copy_text(d, value, &uri);
    if (status == SPH_OK && strncmp(uri, "data:", 5) == 0) {
        status = sph__gltf_decode_base64(d, value, uri, buffer);
    } else if (status == SPH_OK) {
        status = sph__gltf_map_file(d, value, uri, &buffer->map);
        buffer->bytes = buffer->map.bytes;
        buffer->size = buffer->map.size;
    }
    sph_context_release(d->context, uri);
    d->budget += BUDGET_FACTOR * (uint64_t)buffer->map.size;
    return status;
}

sph_status sph__gltf_buffer_bytes(sph__gltf_document *d, uint32_t index, const unsigned char **bytes, size_t *size)
{
    sph__gltf_buffer *buffer = &d->buffers[index];
    const uint32_t object = d->lists[SPH__GLTF_BUFFERS].values[index];
    uint64_t length = 0;
    sph_status status = SPH_OK;
    if (buffer->bytes == NULL) {
        status = find_bytes(d, index, buffer);
        if (status == SPH_OK) status = sph__gltf_get_unsigned(d, object, "byteLength", &length);
        if (status == SPH_OK && (length == 0 || length > buffer->size))
            status = sph__gltf_fail(d, object, "buffer %u of %llu bytes, but there are %zu", (unsigned)index,
                                    (unsigned long long)length, buffer->size);
        if (status == SPH_OK) buffer->size = (size_t)length;
    }
    *bytes = buffer->bytes;
    *size = buffer->size;
    return status;
}
