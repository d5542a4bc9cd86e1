/* SPDX-License-Identifier: MIT */
/*
 * The container of `.sphm` files (docs/formats.md): a header, a table, and chunks of little-endian numbers, all under
 * checksums. No byte of a container can change without being noticed.
 */
#ifndef SPH_BASE_CONTAINER_H
#define SPH_BASE_CONTAINER_H

#include <sphmesh/hierarchy.h>

#include "base/base.h"

enum {
    SPH__CONTAINER_HIERARCHY = 1,
    SPH__CONTAINER_LEVEL = 2,
    SPH__CONTAINER_IMPLICIT = 3,
    SPH__CONTAINER_MAJOR = 1,
    SPH__CONTAINER_MINOR = 0,
    SPH__CONTAINER_CHUNK_LIMIT = 64
};

/* Four characters as one number, the first in the lowest byte. */
#define SPH__TAG(a, b, c, d) ((uint32_t)(a) | (uint32_t)(b) << 8 | (uint32_t)(c) << 16 | (uint32_t)(d) << 24)

/* An array to write: `count` numbers of `size` bytes (1, 4 or 8). */
typedef struct sph__chunk {
    uint32_t tag;
    uint32_t size;
    const void *data;
    size_t count;
    size_t row, stride; /* in rows of `row` numbers, `stride` numbers apart; equal: tight */
} sph__chunk;

sph_status sph__container_write(const sph_context *context, uint32_t kind, const sph__chunk *chunks, size_t chunk_count,
                                sph_write_fn *write, void *user);

/* A container that was found whole. */
typedef struct sph__container {
    sph_context *context;
    const unsigned char *bytes;
    size_t size;
    uint32_t chunk_count;
} sph__container;

/* Checks everything but what the numbers mean. The bytes are borrowed. */
sph_status sph__container_open(sph_context *context, const void *bytes, size_t size, uint32_t kind,
                               sph__container *container);
/* How many numbers of `size` bytes a chunk holds; SPH_E_FORMAT where there is no such chunk or it is no multiple. */
sph_status sph__container_count(const sph__container *container, uint32_t tag, uint32_t size, size_t *count);
/* Copies a chunk of exactly `count` numbers of `size` bytes out. */
sph_status sph__container_copy(const sph__container *container, uint32_t tag, uint32_t size, size_t count, void *to);
/* The same into rows of `row` numbers, `stride` numbers apart; what is between them becomes 0. */
sph_status sph__container_copy_rows(const sph__container *container, uint32_t tag, uint32_t size, size_t count,
                                    size_t row, size_t stride, void *to);
/* The byte where number `index` of a chunk stands, for messages; 0 where there is no such chunk. */
size_t sph__container_byte(const sph__container *container, uint32_t tag, uint32_t size, size_t index);

/* --- CRC-32C (Castagnoli), as in RFC 3720 --- */
typedef struct sph__crc32c {
    uint32_t tables[8][256];
} sph__crc32c;
void sph__crc32c_init(sph__crc32c *crc);
/* Of all bytes so far, `before` being that of those that came earlier; 0 at first. */
uint32_t sph__crc32c_add(const sph__crc32c *crc, uint32_t before, const void *bytes, size_t size);

#endif
