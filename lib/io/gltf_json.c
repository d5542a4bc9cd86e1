/* SPDX-License-Identifier: MIT */
/* The JSON of a glTF as a tree of places in its text, and checked looks at its members. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "io/gltf.h"

enum { DEPTH_LIMIT = 64, TEXT_SIZE = 256 };

static sph__io_json reader_at(const sph__gltf_document *d, uint32_t value)
{
    return (sph__io_json){.context = d->context,
                          .path = d->path,
                          .start = (const char *)d->map->bytes,
                          .p = d->text + d->values[value].begin,
                          .end = d->text_end};
}

sph_status sph__gltf_fail(const sph__gltf_document *d, uint32_t value, const char *format, ...)
{
    const sph__io_json json = reader_at(d, value);
    char text[TEXT_SIZE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return sph__io_json_fail(&json, text);
}

static sph_status add_value(sph__gltf_document *d, sph__io_json *json);

static sph_status add_members(sph__gltf_document *d, sph__io_json *json, size_t place, char open)
{
    const char close = open == '{' ? '}' : ']';
    bool first = true, more;
    sph_status status;
    if (json->depth == DEPTH_LIMIT) return sph__io_json_fail(json, "nested too deep");
    ++json->depth;
    ++json->p;
    while ((status = sph__io_json_next(json, close, &first, &more)) == SPH_OK && more) {
        if (open == '{') {
            if (sph__io_json_peek(json) != '"') return sph__io_json_fail(json, "not a name");
            status = add_value(d, json);
            if (status == SPH_OK) status = sph__io_json_take(json, ':', "not :");
        }
        if (status == SPH_OK) status = add_value(d, json);
        if (status != SPH_OK) return status;
        ++d->values[place].count;
    }
    --json->depth;
    return status;
}

static sph_status add_value(sph__gltf_document *d, sph__io_json *json)
{
    const char kind = sph__io_json_peek(json);
    const size_t place = d->value_count;
    void *memory = d->values;
    sph_status status;
    if (!sph__io_reserve(d->context, &memory, &d->value_capacity, place + 1, sizeof *d->values))
        return sph__io_fail_memory(d->context, d->path);
    d->values = memory;
    d->values[place] = (sph__gltf_value){.begin = (uint32_t)(json->p - d->text),
                                         .kind = kind == '-' || (kind >= '0' && kind <= '9') ? '0' : kind};
    ++d->value_count;
    status = kind == '{' || kind == '[' ? add_members(d, json, place, kind) : sph__io_json_skip(json);
    d->values[place].next = (uint32_t)d->value_count;
    return status;
}

static sph_status list_values(sph__gltf_document *d, const char *name, sph__gltf_list *list)
{
    uint32_t array, value;
    sph_status status = sph__gltf_get_kind(d, 0, name, '[', &array);
    if (status != SPH_OK || array == 0) return status;
    list->count = d->values[array].count;
    list->values = sph_context_allocate(d->context, (size_t)list->count + 1, sizeof *list->values);
    if (list->values == NULL) return sph__io_fail_memory(d->context, d->path);
    value = array + 1;
    for (uint32_t i = 0; i < list->count; ++i, value = d->values[value].next) {
        list->values[i] = value;
        if (d->values[value].kind != '{') return sph__gltf_fail(d, value, "%s %u is not an object", name, (unsigned)i);
    }
    return SPH_OK;
}

static const char *const LIST_NAMES[SPH__GLTF_LISTS] = {"accessors", "animations", "buffers", "bufferViews",
                                                        "meshes",    "nodes",      "scenes",  "skins"};

sph_status sph__gltf_parse(sph__gltf_document *d)
{
    sph__io_json json = {
        .context = d->context, .path = d->path, .start = (const char *)d->map->bytes, .p = d->text, .end = d->text_end};
    sph_status status;
    if ((size_t)(d->text_end - d->text) >= UINT32_MAX)
        return sph__io_fail(d->context, SPH_E_LIMIT, "%s: more than 4 GB of JSON", sph__io_shown(d->path));
    if (sph__io_json_peek(&json) != '{') return sph__io_json_fail(&json, "not the JSON object of a glTF");
    if ((status = add_value(d, &json)) != SPH_OK) return status;
    while (json.p < json.end && sph__io_json_peek(&json) == '\0' && json.p < json.end)
        ++json.p; /* some fill the chunk of a GLB up with zeros */
    if (json.p < json.end) return sph__io_json_fail(&json, "something after the end of the JSON");
    for (int i = 0; i < SPH__GLTF_LISTS && status == SPH_OK; ++i)
        status = list_values(d, LIST_NAMES[i], &d->lists[i]);
    return status;
}

bool sph__gltf_is(const sph__gltf_document *d, uint32_t value, const char *text)
{
    const size_t length = strlen(text);
    const char *p = d->text + d->values[value].begin;
    return d->values[value].kind == '"' && (size_t)(d->text_end - p) >= length + 2 &&
           memcmp(p + 1, text, length) == 0 && p[length + 1] == '"';
}

uint32_t sph__gltf_get(const sph__gltf_document *d, uint32_t object, const char *name)
{
    uint32_t key = object + 1;
    if (d->values[object].kind != '{') return 0;
    for (uint32_t i = 0; i < d->values[object].count; ++i) {
        if (sph__gltf_is(d, key, name)) return key + 1;
        key = d->values[key + 1].next;
    }
    return 0;
}

sph_status sph__gltf_get_kind(const sph__gltf_document *d, uint32_t object, const char *name, char kind,
                              uint32_t *value)
{
    *value = sph__gltf_get(d, object, name);
    if (*value == 0 || d->values[*value].kind == kind) return SPH_OK;
    return sph__gltf_fail(d, *value, "%s is not %s", name,
                          kind == '{'   ? "an object"
                          : kind == '[' ? "an array"
                                        : "a string");
}

sph_status sph__gltf_get_unsigned(const sph__gltf_document *d, uint32_t object, const char *name, uint64_t *number)
{
    const uint32_t value = sph__gltf_get(d, object, name);
    sph__io_json json;
    int64_t integer;
    sph_status status;
    if (value == 0) return SPH_OK;
    json = reader_at(d, value);
    if (d->values[value].kind != '0') return sph__gltf_fail(d, value, "%s is not a number", name);
    status = sph__io_json_integer(&json, &integer);
    if (status != SPH_OK) return status;
    if (integer < 0) return sph__gltf_fail(d, value, "%s is negative", name);
    *number = (uint64_t)integer;
    return SPH_OK;
}

sph_status sph__gltf_get_numbers(const sph__gltf_document *d, uint32_t object, const char *name, uint32_t count,
                                 double *numbers)
{
    uint32_t array, value;
    sph_status status = sph__gltf_get_kind(d, object, name, '[', &array);
    if (status != SPH_OK || array == 0) return status;
    if (d->values[array].count != count)
        return sph__gltf_fail(d, array, "%s has %u numbers, not %u", name, (unsigned)d->values[array].count,
                              (unsigned)count);
    value = array + 1;
    for (uint32_t i = 0; i < count; ++i, value = d->values[value].next) {
        sph__io_json json = reader_at(d, value);
        float number;
        if (d->values[value].kind != '0') return sph__gltf_fail(d, value, "%s has what is not a number", name);
        if ((status = sph__io_json_float(&json, &number)) != SPH_OK) return status;
        if (!isfinite(number)) return sph__gltf_fail(d, value, "a number beyond what a float holds");
        numbers[i] = (double)number;
    }
    return SPH_OK;
}

sph_status sph__gltf_read_index(const sph__gltf_document *d, uint32_t value, int list, uint32_t *index)
{
    sph__io_json json = reader_at(d, value);
    int64_t integer;
    sph_status status;
    if (d->values[value].kind != '0') return sph__gltf_fail(d, value, "not an index of %s", LIST_NAMES[list]);
    if ((status = sph__io_json_integer(&json, &integer)) != SPH_OK) return status;
    if (integer < 0 || integer >= (int64_t)d->lists[list].count)
        return sph__gltf_fail(d, value, "index %lld of %s, of which there are %u", (long long)integer, LIST_NAMES[list],
                              (unsigned)d->lists[list].count);
    *index = (uint32_t)integer;
    return SPH_OK;
}

sph_status sph__gltf_get_index(const sph__gltf_document *d, uint32_t object, const char *name, int list,
                               uint32_t *index)
{
    const uint32_t value = sph__gltf_get(d, object, name);
    *index = SPH__GLTF_NONE;
    return value == 0 ? SPH_OK : sph__gltf_read_index(d, value, list, index);
}

sph_status sph__gltf_get_text(const sph__gltf_document *d, uint32_t value, const char **text, size_t *length)
{
    sph__io_json json = reader_at(d, value);
    const sph_status status = sph__io_json_skip(&json);
    *text = d->text + d->values[value].begin;
    *length = (size_t)(json.p - *text);
    return status;
}

sph_status sph__gltf_copy_text(const sph__gltf_document *d, uint32_t value, char **text)
{
    sph__io_json json = reader_at(d, value);
    const sph__io_json start = json;
    size_t size;
    sph_status status = sph__io_json_string(&json, NULL, 0);
    *text = NULL;
    if (status != SPH_OK) return status;
    size = (size_t)(json.p - start.p) + 1; /* escapes are longer than what they stand for */
    *text = sph_context_allocate(d->context, size, 1);
    if (*text == NULL) return sph__io_fail_memory(d->context, d->path);
    json = start;
    return sph__io_json_string(&json, *text, size);
}
