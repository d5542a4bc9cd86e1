/* SPDX-License-Identifier: MIT */
#include "base/container.h"

/*
 * Header, 32 bytes: magic (8), major and minor version (2 + 2), kind (4), size of the container (8), number of chunks
 * (4), CRC-32C of these 28 bytes and of the table (4). Table, 24 bytes per chunk: tag (4), CRC-32C of the chunk's bytes
 * (4), offset (8), size (8). Chunks in the table's order, each padded with zeros to a multiple of 16 bytes.
 */
enum { HEADER_SIZE = 32, ENTRY_SIZE = 24, CRC_AT = 28, ALIGNMENT = 16, SWAP_SIZE = 1024 };

static const unsigned char MAGIC[8] = {0x89, 'S', 'P', 'H', '\r', '\n', 0x1A, '\n'};

static bool little_endian(void)
{
    const uint16_t one = 1;
    unsigned char first;
    memcpy(&first, &one, 1);
    return first == 1;
}

static void put(unsigned char *p, unsigned size, uint64_t value)
{
    for (unsigned i = 0; i < size; ++i)
        p[i] = (unsigned char)(value >> 8 * i);
}

static uint64_t get(const unsigned char *p, unsigned size)
{
    uint64_t value = 0;
    for (unsigned i = size; i-- > 0;)
        value = value << 8 | p[i];
    return value;
}

/* The machine's numbers as little-endian bytes or the other way round. */
static void swap_numbers(unsigned char *to, const unsigned char *from, size_t bytes, uint32_t size)
{
    for (size_t i = 0; i < bytes; i += size)
        for (uint32_t j = 0; j < size; ++j)
            to[i + j] = from[i + size - 1 - j];
}

static uint64_t padded(uint64_t size)
{
    return (size + (ALIGNMENT - 1)) / ALIGNMENT * ALIGNMENT;
}

/* --- writing --- */

typedef struct writer {
    sph_write_fn *write; /* NULL: only the checksum is wanted */
    void *user;
    sph__crc32c crc;
    uint32_t sum;
} writer;

static sph_status write_bytes(writer *w, const void *bytes, size_t size)
{
    if (w->write != NULL && size != 0) return w->write(w->user, bytes, size);
    w->sum = sph__crc32c_add(&w->crc, w->sum, bytes, size);
    return SPH_OK;
}

static sph_status write_row(writer *w, const unsigned char *data, size_t left, uint32_t size)
{
    if (little_endian() || size == 1) return write_bytes(w, data, left);
    while (left != 0) {
        unsigned char swapped[SWAP_SIZE];
        const size_t part = left < SWAP_SIZE ? left : SWAP_SIZE;
        sph_status status;
        swap_numbers(swapped, data, part, size);
        if ((status = write_bytes(w, swapped, part)) != SPH_OK) return status;
        data += part;
        left -= part;
    }
    return SPH_OK;
}

static sph_status write_chunk(writer *w, const sph__chunk *chunk)
{
    const unsigned char *data = chunk->data;
    sph_status status = SPH_OK;
    if (chunk->row == chunk->stride) return write_row(w, data, chunk->count * chunk->size, chunk->size);
    for (size_t i = 0; i < chunk->count && status == SPH_OK; i += chunk->row, data += chunk->stride * chunk->size)
        status = write_row(w, data, chunk->row * chunk->size, chunk->size);
    return status;
}

/* Header and table; false where the container would be larger than can be addressed. */
static bool lay_out(writer *w, uint32_t kind, const sph__chunk *chunks, size_t chunk_count, unsigned char *head)
{
    const size_t table_end = HEADER_SIZE + ENTRY_SIZE * chunk_count;
    uint64_t offset = padded(table_end);
    for (size_t i = 0; i < chunk_count; ++i) {
        unsigned char *entry = head + HEADER_SIZE + ENTRY_SIZE * i;
        size_t size;
        if (!sph__multiply_size(chunks[i].count, chunks[i].size, &size) || size > PTRDIFF_MAX ||
            offset > PTRDIFF_MAX - (uint64_t)size - ALIGNMENT)
            return false;
        w->sum = 0;
        (void)write_chunk(w, &chunks[i]);
        put(entry, 4, chunks[i].tag);
        put(entry + 4, 4, w->sum);
        put(entry + 8, 8, offset);
        put(entry + 16, 8, size);
        offset += padded(size);
    }
    memcpy(head, MAGIC, sizeof MAGIC);
    put(head + 8, 2, SPH__CONTAINER_MAJOR);
    put(head + 10, 2, SPH__CONTAINER_MINOR);
    put(head + 12, 4, kind);
    put(head + 16, 8, offset);
    put(head + 24, 4, chunk_count);
    w->sum = sph__crc32c_add(&w->crc, 0, head, CRC_AT);
    put(head + CRC_AT, 4, sph__crc32c_add(&w->crc, w->sum, head + HEADER_SIZE, table_end - HEADER_SIZE));
    return true;
}

sph_status sph__container_write(const sph_context *context, uint32_t kind, const sph__chunk *chunks, size_t chunk_count,
                                sph_write_fn *write, void *user)
{
    static const unsigned char ZEROS[ALIGNMENT];
    unsigned char head[HEADER_SIZE + ENTRY_SIZE * SPH__CONTAINER_CHUNK_LIMIT + ALIGNMENT] = {0};
    writer w = {.write = NULL};
    sph_status status;
    if (chunk_count > SPH__CONTAINER_CHUNK_LIMIT) return sph__fail(context, SPH_E_LIMIT, "too many chunks");
    sph__crc32c_init(&w.crc);
    if (!lay_out(&w, kind, chunks, chunk_count, head)) return sph__fail_memory(context);
    w.write = write;
    w.user = user;
    status = write_bytes(&w, head, padded(HEADER_SIZE + ENTRY_SIZE * chunk_count));
    for (size_t i = 0; i < chunk_count && status == SPH_OK; ++i) {
        const size_t size = chunks[i].count * chunks[i].size;
        status = write_chunk(&w, &chunks[i]);
        if (status == SPH_OK) status = write_bytes(&w, ZEROS, padded(size) - size);
    }
    return status;
}

/* --- reading --- */

static sph_status damaged(const sph__container *c, size_t byte, const char *what)
{
    return sph__fail(c->context, SPH_E_FORMAT, "byte %zu: %s", byte, what);
}

static const unsigned char *entry_of(const sph__container *c, uint32_t index)
{
    return c->bytes + HEADER_SIZE + (size_t)ENTRY_SIZE * index;
}

static sph_status check_header(sph__container *c, uint32_t kind)
{
    static const char *const KINDS[] = {"nothing known", "a hierarchy", "a level", "an implicit skin"};
    const unsigned char *p = c->bytes;
    uint64_t major, found, size, count;
    if (c->size < sizeof MAGIC || memcmp(p, MAGIC, sizeof MAGIC) != 0) {
        if (c->size >= 4 && memcmp(p + 1, "SPH", 3) == 0)
            return damaged(c, 0, "a .sphm container that was damaged in transfer as text");
        return damaged(c, 0, "not a .sphm container");
    }
    if (c->size < HEADER_SIZE) return damaged(c, c->size, "the container ends within its header");
    major = get(p + 8, 2);
    if (major > SPH__CONTAINER_MAJOR)
        return sph__fail(c->context, SPH_E_VERSION, "byte 8: version %u.%u of the container, this library reads %d",
                         (unsigned)major, (unsigned)get(p + 10, 2), SPH__CONTAINER_MAJOR);
    if (major == 0) return damaged(c, 8, "not a version");
    size = get(p + 16, 8);
    if (size != c->size)
        return sph__fail(c->context, SPH_E_FORMAT, "byte 16: the container should have %llu bytes, but has %zu",
                         (unsigned long long)size, c->size);
    count = get(p + 24, 4);
    if (count > SPH__CONTAINER_CHUNK_LIMIT || padded(HEADER_SIZE + ENTRY_SIZE * count) > c->size)
        return damaged(c, 24, "more chunks than there is room for");
    c->chunk_count = (uint32_t)count;
    found = get(p + 12, 4);
    if (found == kind) return SPH_OK;
    return sph__fail(c->context, SPH_E_FORMAT, "byte 12: the container holds %s, not %s", KINDS[found > SPH__CONTAINER_IMPLICIT ? 0 : found],
                     KINDS[kind]);
}

static sph_status check_padding(const sph__container *c, size_t begin, size_t end)
{
    for (size_t i = begin; i < end; ++i)
        if (c->bytes[i] != 0) return damaged(c, i, "not zero between chunks");
    return SPH_OK;
}

static sph_status check_chunks(const sph__container *c, const sph__crc32c *crc)
{
    const size_t table_end = HEADER_SIZE + (size_t)ENTRY_SIZE * c->chunk_count;
    uint64_t place = padded(table_end);
    sph_status status = check_padding(c, table_end, place);
    for (uint32_t i = 0; i < c->chunk_count && status == SPH_OK; ++i) {
        const unsigned char *entry = entry_of(c, i);
        const uint64_t offset = get(entry + 8, 8), size = get(entry + 16, 8);
        const size_t entry_byte = (size_t)(entry - c->bytes);
        if (offset != place) return damaged(c, entry_byte + 8, "a chunk is not where it should be");
        if (size > c->size - offset || padded(size) > c->size - offset)
            return damaged(c, entry_byte + 16, "a chunk is longer than the container");
        for (uint32_t j = 0; j < i; ++j)
            if (get(entry_of(c, j), 4) == get(entry, 4)) return damaged(c, entry_byte, "a second chunk of one name");
        if (sph__crc32c_add(crc, 0, c->bytes + offset, size) != get(entry + 4, 4))
            return sph__fail(c->context, SPH_E_FORMAT, "bytes %llu to %llu: the checksum of chunk %.4s is wrong",
                             (unsigned long long)offset, (unsigned long long)offset + size, (const char *)entry);
        place = offset + padded(size);
        status = check_padding(c, offset + size, place);
    }
    if (status == SPH_OK && place != c->size) return damaged(c, place, "more after the last chunk");
    return status;
}

sph_status sph__container_open(sph_context *context, const void *bytes, size_t size, uint32_t kind,
                               sph__container *container)
{
    sph__crc32c crc;
    uint32_t sum;
    sph_status status;
    *container = (sph__container){context, bytes, size, 0};
    if ((status = check_header(container, kind)) != SPH_OK) return status;
    sph__crc32c_init(&crc);
    sum = sph__crc32c_add(&crc, 0, container->bytes, CRC_AT);
    sum = sph__crc32c_add(&crc, sum, container->bytes + HEADER_SIZE, (size_t)ENTRY_SIZE * container->chunk_count);
    if (sum != get(container->bytes + CRC_AT, 4))
        return damaged(container, CRC_AT, "the checksum of the header and the table is wrong");
    return check_chunks(container, &crc);
}

static const unsigned char *find(const sph__container *c, uint32_t tag)
{
    for (uint32_t i = 0; i < c->chunk_count; ++i)
        if (get(entry_of(c, i), 4) == tag) return entry_of(c, i);
    return NULL;
}

sph_status sph__container_count(const sph__container *container, uint32_t tag, uint32_t size, size_t *count)
{
    const unsigned char *entry = find(container, tag);
    char name[5] = "";
    *count = 0;
    for (unsigned i = 0; i < 4; ++i)
        name[i] = (char)(tag >> 8 * i);
    if (entry == NULL) return sph__fail(container->context, SPH_E_FORMAT, "the container has no chunk %s", name);
    if (get(entry + 16, 8) % size != 0)
        return sph__fail(container->context, SPH_E_FORMAT, "byte %zu: chunk %s is not of numbers of %u bytes",
                         (size_t)(entry - container->bytes) + 16, name, (unsigned)size);
    *count = get(entry + 16, 8) / size;
    return SPH_OK;
}

static void copy_numbers(unsigned char *to, const unsigned char *from, size_t bytes, uint32_t size)
{
    if (!little_endian())
        swap_numbers(to, from, bytes, size);
    else if (bytes != 0)
        memcpy(to, from, bytes);
}

sph_status sph__container_copy_rows(const sph__container *container, uint32_t tag, uint32_t size, size_t count,
                                    size_t row, size_t stride, void *to)
{
    const unsigned char *entry = find(container, tag), *from;
    unsigned char *place = to;
    size_t found;
    const sph_status status = sph__container_count(container, tag, size, &found);
    if (status != SPH_OK) return status;
    if (found != count)
        return sph__fail(container->context, SPH_E_FORMAT, "byte %zu: chunk %.4s holds %zu numbers, not %zu",
                         (size_t)(entry - container->bytes) + 16, (const char *)entry, found, count);
    from = container->bytes + get(entry + 8, 8);
    if (stride == row) row = stride = count;
    for (size_t i = 0; i < count; i += row, from += row * size, place += stride * size) {
        copy_numbers(place, from, row * size, size);
        if (stride != row) memset(place + row * size, 0, (stride - row) * size);
    }
    return SPH_OK;
}

sph_status sph__container_copy(const sph__container *container, uint32_t tag, uint32_t size, size_t count, void *to)
{
    return sph__container_copy_rows(container, tag, size, count, count, count, to);
}

size_t sph__container_byte(const sph__container *container, uint32_t tag, uint32_t size, size_t index)
{
    const unsigned char *entry = find(container, tag);
    return entry == NULL ? 0 : (size_t)get(entry + 8, 8) + index * size;
}
