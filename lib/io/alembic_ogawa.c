/* SPDX-License-Identifier: MIT */
/*
 * An Ogawa file: 16 bytes of header, then groups (a count and as many places of children) and data (a size and as many
 * bytes), in any order. A place with its highest bit set is that of data.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "io/alembic.h"
#include "io/bytes.h"

enum { HEADER = 16, FROZEN = 5, FORMAT_VERSION = 6, ROOT_CHILDREN = 6, LEAST_VERSION = 9999 };
enum { ROOT_VERSION, ROOT_LIBRARY, ROOT_TOP, ROOT_ABOUT, ROOT_SAMPLINGS, ROOT_METADATA };
static const uint64_t DATA_BIT = (uint64_t)1 << 63;

/* What is made of a file may take so many bytes in any case, and so many for each byte of it; the same for headers. */
#define BUDGET_BASE ((uint64_t)1 << 26)
#define WORK_BASE ((uint64_t)1 << 29)
enum { FACTOR = 64 };

/* Stands for "no more than the stored times"; what is written is the largest number divided by 32. */
static const double ACYCLIC = 1e300;

sph_status sph__abc_fail(const sph__abc_file *f, uint64_t place, const char *format, ...)
{
    char text[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return sph__io_fail(f->context, SPH_E_FORMAT, "%s: byte %llu: %s", sph__io_shown(f->path),
                        (unsigned long long)place, text);
}

static uint64_t load(const sph__abc_file *f, uint64_t place)
{
    return sph__io_load_64(f->map.bytes + place, false);
}

static uint64_t reference(const sph__abc_file *f, const sph__abc_group *group, uint64_t child)
{
    return load(f, group->place + 8 + 8 * child);
}

static sph_status open_group(const sph__abc_file *f, uint64_t place, sph__abc_group *out)
{
    *out = (sph__abc_group){place, 0};
    if (place == 0) return SPH_OK; /* an empty one is not stored */
    if (f->map.size < 8 || place > f->map.size - 8 || place < HEADER)
        return sph__abc_fail(f, place, "a group beyond the file's %zu bytes", f->map.size);
    out->count = load(f, place);
    if (out->count > (f->map.size - place - 8) / 8)
        return sph__abc_fail(f, place, "a group of %llu children, which the file has no room for",
                             (unsigned long long)out->count);
    return SPH_OK;
}

bool sph__abc_is_group(const sph__abc_file *f, const sph__abc_group *group, uint64_t child)
{
    return child < group->count && (reference(f, group, child) & DATA_BIT) == 0;
}

sph_status sph__abc_child_group(const sph__abc_file *f, const sph__abc_group *group, uint64_t child,
                                sph__abc_group *out)
{
    if (!sph__abc_is_group(f, group, child))
        return sph__abc_fail(f, group->place, "child %llu of a group of %llu is missing, or no group",
                             (unsigned long long)child, (unsigned long long)group->count);
    return open_group(f, reference(f, group, child), out);
}

sph_status sph__abc_child_data(const sph__abc_file *f, const sph__abc_group *group, uint64_t child, sph__abc_bytes *out)
{
    uint64_t place, size;
    if (child >= group->count || (reference(f, group, child) & DATA_BIT) == 0)
        return sph__abc_fail(f, group->place, "child %llu of a group of %llu is missing, or no data",
                             (unsigned long long)child, (unsigned long long)group->count);
    place = reference(f, group, child) & ~DATA_BIT;
    *out = (sph__abc_bytes){f->map.bytes, 0};
    if (place == 0) return SPH_OK;
    if (place > f->map.size - 8 || place < HEADER)
        return sph__abc_fail(f, place, "data beyond the file's %zu bytes", f->map.size);
    size = load(f, place);
    if (size > f->map.size - place - 8)
        return sph__abc_fail(f, place, "data of %llu bytes, which the file has no room for", (unsigned long long)size);
    *out = (sph__abc_bytes){f->map.bytes + place + 8, (size_t)size};
    return SPH_OK;
}

sph_status sph__abc_charge(sph__abc_file *f, uint64_t count, uint64_t size)
{
    if (count > f->budget / size)
        return sph__io_fail(f->context, SPH_E_LIMIT, "%s: it would take far more memory than a file of its size should",
                            sph__io_shown(f->path));
    f->budget -= count * size;
    return SPH_OK;
}

sph_status sph__abc_charge_work(sph__abc_file *f, uint64_t size)
{
    if (size > f->work)
        return sph__io_fail(f->context, SPH_E_LIMIT, "%s: it leads to the same headers again and again",
                            sph__io_shown(f->path));
    f->work -= size;
    return SPH_OK;
}

bool sph__abc_begins(sph__abc_bytes text, const char *with)
{
    const size_t size = strlen(with);
    return text.size >= size && memcmp(text.p, with, size) == 0;
}

bool sph__abc_equals(sph__abc_bytes text, const char *with)
{
    return text.size == strlen(with) && memcmp(text.p, with, text.size) == 0;
}

sph__abc_bytes sph__abc_value(sph__abc_bytes metadata, const char *key)
{
    const size_t length = strlen(key);
    const unsigned char *p = metadata.p, *end = p + metadata.size;
    while (p < end) {
        const unsigned char *stop = memchr(p, ';', (size_t)(end - p));
        const size_t size = (size_t)((stop == NULL ? end : stop) - p);
        if (size > length && memcmp(p, key, length) == 0 && p[length] == '=')
            return (sph__abc_bytes){p + length + 1, size - length - 1};
        p += size + 1;
    }
    return (sph__abc_bytes){metadata.p, 0};
}

char *sph__abc_copy(const sph__abc_file *f, sph__abc_bytes text)
{
    char *copy = sph_context_allocate(f->context, text.size + 1, 1);
    if (copy == NULL) return NULL;
    memcpy(copy, text.p, text.size);
    copy[text.size] = '\0';
    return copy;
}

/* Each: uint32 samples (not used), double period, uint32 count, the times. */
static sph_status read_samplings(sph__abc_file *f, const sph__abc_group *root)
{
    sph__abc_cursor c = {.at = 0};
    size_t capacity = 0;
    sph_status status = sph__abc_child_data(f, root, ROOT_SAMPLINGS, &c.bytes);
    while (status == SPH_OK && c.at < c.bytes.size) {
        const uint64_t place = sph__abc_place(f, &c);
        uint64_t ignored, period, count;
        sph__abc_bytes times;
        sph__abc_sampling *s;
        void *memory = f->samplings;
        if (!sph__abc_take(&c, 4, &ignored) || !sph__abc_take(&c, 8, &period) || !sph__abc_take(&c, 4, &count) ||
            !sph__abc_take_bytes(&c, 8 * count, &times))
            return sph__abc_fail(f, place, "a time sampling that is cut off");
        if (!sph__io_reserve(f->context, &memory, &capacity, f->sampling_count + (size_t)1, sizeof *s))
            return sph__io_fail_memory(f->context, f->path);
        f->samplings = memory;
        s = &f->samplings[f->sampling_count++];
        *s = (sph__abc_sampling){0, (uint32_t)count, times.p, NULL};
        memcpy(&s->period, &period, sizeof period);
        if (s->period >= ACYCLIC) s->period = (double)INFINITY;
        s->fault = sph__abc_sampling_fault(s);
    }
    return status;
}

/* Each: uint8 size, the text. Number 0 is the empty one, which is not stored. */
static sph_status read_metadata(sph__abc_file *f, const sph__abc_group *root)
{
    sph__abc_cursor c = {.at = 0};
    sph_status status = sph__abc_child_data(f, root, ROOT_METADATA, &c.bytes);
    f->metadata[f->metadata_count++] = (sph__abc_bytes){f->map.bytes, 0};
    while (status == SPH_OK && c.at < c.bytes.size) {
        const uint64_t place = sph__abc_place(f, &c);
        uint64_t size;
        if (f->metadata_count == SPH__ABC_METADATA_MAX || !sph__abc_take(&c, 1, &size) ||
            !sph__abc_take_bytes(&c, size, &f->metadata[f->metadata_count]))
            return sph__abc_fail(f, place, "metadata that are cut off, or too many");
        ++f->metadata_count;
    }
    return status;
}

static sph_status read_version(sph__abc_file *f, const sph__abc_group *root)
{
    sph__abc_bytes format, library;
    sph_status status = sph__abc_child_data(f, root, ROOT_VERSION, &format);
    if (status == SPH_OK) status = sph__abc_child_data(f, root, ROOT_LIBRARY, &library);
    if (status != SPH_OK) return status;
    if (format.size != 4 || library.size != 4) return sph__abc_fail(f, root->place, "no version of the archive");
    f->version = sph__io_load_32(library.p, false);
    if (sph__io_load_32(format.p, false) != 0 || f->version < LEAST_VERSION)
        return sph__io_fail(f->context, SPH_E_UNSUPPORTED, "%s: Alembic archive version %u of library version %u",
                            sph__io_shown(f->path), (unsigned)sph__io_load_32(format.p, false), (unsigned)f->version);
    return SPH_OK;
}

static sph_status read_root(sph__abc_file *f)
{
    sph__abc_group root;
    sph_status status;
    if (f->map.size < HEADER || memcmp(f->map.bytes, "Ogawa", 5) != 0)
        return sph__abc_fail(f, 0, "not an Alembic (Ogawa) file");
    if (f->map.bytes[FROZEN] != 0xFF)
        return sph__abc_fail(f, FROZEN, "the program that wrote this Alembic file did not finish it");
    if (sph__io_load_16(f->map.bytes + FORMAT_VERSION, true) != 1)
        return sph__io_fail(f->context, SPH_E_UNSUPPORTED, "%s: byte %d: Ogawa version %u, only 1 is read",
                            sph__io_shown(f->path), FORMAT_VERSION,
                            (unsigned)sph__io_load_16(f->map.bytes + FORMAT_VERSION, true));
    status = open_group(f, load(f, 8), &root);
    if (status != SPH_OK) return status;
    if (root.count < ROOT_CHILDREN) return sph__abc_fail(f, root.place, "no Alembic archive: its root lacks children");
    status = read_version(f, &root);
    if (status == SPH_OK) status = sph__abc_child_data(f, &root, ROOT_ABOUT, &f->about);
    if (status == SPH_OK) status = read_samplings(f, &root);
    if (status == SPH_OK) status = read_metadata(f, &root);
    if (status == SPH_OK) status = sph__abc_child_group(f, &root, ROOT_TOP, &f->top);
    return status;
}

sph_status sph__abc_file_open(sph_context *context, const char *path, const sph__io_map *map, sph__abc_file *f)
{
    sph_status status;
    *f = (sph__abc_file){.context = context, .map = *map};
    f->budget = BUDGET_BASE + FACTOR * (uint64_t)map->size;
    f->work = WORK_BASE + FACTOR * (uint64_t)map->size;
    f->path = sph__io_copy_string(context, path);
    if (f->path == NULL) return sph__io_fail_memory(context, path);
    status = read_root(f);
    if (status != SPH_OK) sph__abc_file_close(f);
    return status;
}

void sph__abc_file_close(sph__abc_file *f)
{
    sph_context_release(f->context, f->path);
    sph_context_release(f->context, f->samplings);
    f->path = NULL;
    f->samplings = NULL;
}
