/* SPDX-License-Identifier: MIT */
/* Properties: the headers of a compound, and the samples of each. */
#include <string.h>

#include "io/alembic.h"
#include "io/bytes.h"

enum { KEY = 16 }; /* a digest before each sample */

/* Of the first 32 bits of a header. */
enum {
    HINT_SHIFT = 2,
    TYPE_SHIFT = 4,
    HAS_SAMPLING = 0x100,
    HAS_CHANGES = 0x200,
    IS_CONSTANT = 0x800,
    EXTENT_SHIFT = 12,
    METADATA_SHIFT = 20,
    OWN_METADATA = 0xFF
};

static const unsigned char TYPE_SIZES[] = {1, 1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8, 1, 4};
enum { TYPES = sizeof TYPE_SIZES };

bool sph__abc_take(sph__abc_cursor *c, unsigned size, uint64_t *value)
{
    if (c->bytes.size - c->at < size) return false;
    *value = 0;
    for (unsigned i = 0; i < size; ++i)
        *value |= (uint64_t)c->bytes.p[c->at + i] << 8 * i;
    c->at += size;
    return true;
}

bool sph__abc_take_bytes(sph__abc_cursor *c, uint64_t size, sph__abc_bytes *out)
{
    if (c->bytes.size - c->at < size) return false;
    *out = (sph__abc_bytes){c->bytes.p + c->at, (size_t)size};
    c->at += (size_t)size;
    return true;
}

uint64_t sph__abc_place(const sph__abc_file *f, const sph__abc_cursor *c)
{
    return (uint64_t)(c->bytes.p - f->map.bytes) + c->at;
}

/* Samples, which of them change, and when they are: each number as wide as `width` says. */
static bool take_samples(sph__abc_cursor *c, uint32_t info, unsigned width, sph__abc_property *p)
{
    uint64_t count, first = 1, last, sampling = 0;
    if (!sph__abc_take(c, width, &count)) return false;
    last = count == 0 ? 0 : count - 1;
    if ((info & HAS_CHANGES) != 0) {
        if (!sph__abc_take(c, width, &first) || !sph__abc_take(c, width, &last)) return false;
    }
    if ((info & HAS_SAMPLING) != 0 && !sph__abc_take(c, width, &sampling)) return false;
    if (count <= 1 || (info & (IS_CONSTANT | HAS_CHANGES)) == IS_CONSTANT) first = last = 0;
    p->sample_count = (uint32_t)count;
    p->first_changed = (uint32_t)first;
    p->last_changed = (uint32_t)last;
    p->sampling = (uint32_t)sampling;
    return first <= last && (count == 0 || last < count);
}

/* The header at the cursor; `name` is where its name stands. */
static bool take_header(sph__abc_cursor *c, sph__abc_property *p, sph__abc_bytes *name)
{
    static const int KINDS[] = {SPH__ABC_COMPOUND, SPH__ABC_SCALAR, SPH__ABC_ARRAY, SPH__ABC_ARRAY};
    uint64_t word, size;
    uint32_t info;
    unsigned width;
    sph__abc_bytes ignored;
    *p = (sph__abc_property){.kind = SPH__ABC_MISSING};
    if (!sph__abc_take(c, 4, &word)) return false;
    info = (uint32_t)word;
    if ((info >> HINT_SHIFT & 3) == 3) return false;
    width = 1U << (info >> HINT_SHIFT & 3);
    p->kind = KINDS[info & 3];
    if (p->kind != SPH__ABC_COMPOUND) {
        p->type = (int)(info >> TYPE_SHIFT & 15);
        p->extent = info >> EXTENT_SHIFT & 255;
        if (p->type >= TYPES || !take_samples(c, info, width, p)) return false;
    }
    if (!sph__abc_take(c, width, &size) || !sph__abc_take_bytes(c, size, name)) return false;
    if ((info >> METADATA_SHIFT & 255) != OWN_METADATA) return true;
    return sph__abc_take(c, width, &size) && sph__abc_take_bytes(c, size, &ignored);
}

sph_status sph__abc_find(sph__abc_file *f, const sph__abc_group *compound, const char *name, sph__abc_property *out)
{
    sph__abc_cursor c = {.at = 0};
    sph_status status;
    *out = (sph__abc_property){.kind = SPH__ABC_MISSING};
    if (compound->count == 0 || sph__abc_is_group(f, compound, compound->count - 1)) return SPH_OK; /* no properties */
    status = sph__abc_child_data(f, compound, compound->count - 1, &c.bytes);
    if (status == SPH_OK) status = sph__abc_charge_work(f, 64 + c.bytes.size);
    for (uint64_t i = 0; status == SPH_OK && c.at < c.bytes.size; ++i) {
        const uint64_t place = sph__abc_place(f, &c);
        sph__abc_bytes found;
        sph__abc_property p;
        if (!take_header(&c, &p, &found)) return sph__abc_fail(f, place, "the header of a property is damaged");
        if (!sph__abc_equals(found, name)) continue;
        status = sph__abc_child_group(f, compound, i, &p.group);
        if (status == SPH_OK) *out = p;
        break;
    }
    return status;
}

sph_status sph__abc_find_typed(sph__abc_file *f, const sph__abc_group *compound, const char *name, int kind, int type,
                               unsigned extent, sph__abc_property *out)
{
    const sph_status status = sph__abc_find(f, compound, name, out);
    if (status != SPH_OK || out->kind == SPH__ABC_MISSING) return status;
    if (out->kind != kind || out->type != type || (extent != 0 && out->extent != extent))
        return sph__abc_fail(f, out->group.place, "%s is of another type (%d with %u values) than it should be", name,
                             out->type, out->extent);
    if (out->sample_count == 0) out->kind = SPH__ABC_MISSING;
    return SPH_OK;
}

static bool is_constant(const sph__abc_property *p)
{
    return p->first_changed == 0 && p->last_changed == 0;
}

uint32_t sph__abc_stored_count(const sph__abc_property *p)
{
    if (p->sample_count == 0) return 0;
    return is_constant(p) ? 1 : p->last_changed - p->first_changed + 2;
}

uint32_t sph__abc_stored(const sph__abc_property *p, uint32_t i)
{
    if (is_constant(p) || i < p->first_changed) return 0;
    return (i < p->last_changed ? i : p->last_changed) - p->first_changed + 1;
}

uint32_t sph__abc_first_of(const sph__abc_property *p, uint32_t stored)
{
    return stored == 0 ? 0 : p->first_changed + stored - 1;
}

sph_status sph__abc_sample(const sph__abc_file *f, const sph__abc_property *p, uint32_t stored, sph__abc_bytes *out)
{
    /* Each sample of an array is followed by its dimensions, which its size tells too. */
    const uint64_t child = p->kind == SPH__ABC_ARRAY ? 2 * (uint64_t)stored : stored;
    const sph_status status = sph__abc_child_data(f, &p->group, child, out);
    const size_t element = TYPE_SIZES[p->type] * (size_t)(p->extent == 0 ? 1 : p->extent);
    if (status != SPH_OK || out->size == 0) return status;
    if (out->size < KEY) return sph__abc_fail(f, p->group.place, "a sample that is shorter than its key");
    out->p += KEY;
    out->size -= KEY;
    if (out->size % element != 0 || (p->kind == SPH__ABC_SCALAR && p->type != SPH__ABC_STRING && out->size != element))
        return sph__abc_fail(f, (uint64_t)(out->p - f->map.bytes), "a sample of %zu bytes, of values of %zu bytes",
                             out->size, element);
    return SPH_OK;
}
