/* SPDX-License-Identifier: MIT */
/* A file that is mapped as it grows, and which of it is free. Not thread-safe: spill.c has the lock. */
#ifndef SPH_IO_SPILL_INTERNAL_H
#define SPH_IO_SPILL_INTERNAL_H

#include <stddef.h>

#include "io/io.h"

/* Bytes [begin, end) of the file. */
typedef struct sph__io_extent {
    size_t begin, end;
} sph__io_extent;

typedef struct sph__io_arena {
    sph_context *context; /* borrowed */
    const char *folder;   /* borrowed; for messages */
    int file;
    char *base;      /* where byte 0 of the file is mapped; NULL: nothing is reserved yet */
    size_t reserved; /* addresses from there on that are ours */
    size_t size;     /* of the file; that much is mapped */
    size_t page;
    size_t live, peak; /* bytes in blocks */
    size_t blocks;
    sph__io_extent *free; /* ascending; no two touch */
    size_t free_count, free_capacity;
} sph__io_arena;

/* Makes the file, without a name, and reserves addresses. `folder` must outlive the arena. */
sph_status sph__io_arena_open(sph_context *context, const char *folder, sph__io_arena *arena);
/* A zeroed arena is fine, as is one whose opening failed. */
void sph__io_arena_close(sph__io_arena *arena);

/* NULL where the file cannot grow; the context's message says why. */
void *sph__io_arena_take(sph__io_arena *arena, size_t size);
void sph__io_arena_give(sph__io_arena *arena, void *memory, size_t size);
static inline bool sph__io_arena_has(const sph__io_arena *arena, const void *memory)
{
    return (const char *)memory >= arena->base && (const char *)memory < arena->base + arena->reserved;
}

#endif
