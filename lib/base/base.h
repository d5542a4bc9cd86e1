/* SPDX-License-Identifier: MIT */
/* Internal door of the room "base": memory, messages, progress, parallel loops, options. */
#ifndef SPH_BASE_H
#define SPH_BASE_H

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <sphmesh/context.h>

/* Alignment of everything that sph__alloc returns: a cache line, and the widest vector. */
enum { SPH__ALIGN = 64 };

/* --- context --- */
sph_context *sph__context_retain(sph_context *context);
void sph__context_release(sph_context *context);

/* Stores the calling thread's message and returns `status`. `context` may be NULL: nothing is stored. */
sph_status sph__fail(const sph_context *context, sph_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* The same for #SPH_E_NOMEM. */
sph_status sph__fail_memory(const sph_context *context);
/* Changes with every message of the calling thread: tells whether a callback left one. 0 where there is none. */
uint64_t sph__message_stamp(const sph_context *context);
void sph__log(const sph_context *context, int32_t severity, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* --- memory: NULL on overflow, on a size of zero bytes it returns a valid pointer --- */
void *sph__alloc(const sph_context *context, size_t count, size_t size);
void *sph__zalloc(const sph_context *context, size_t count, size_t size);
/* Enlarges `memory` (from sph__alloc, or NULL) to `count` elements; on failure it returns NULL and `memory` stays. */
void *sph__realloc(const sph_context *context, void *memory, size_t count, size_t size);
void sph__free(const sph_context *context, void *memory);
/* a * b into *out; false on overflow. */
bool sph__multiply_size(size_t a, size_t b, size_t *out);

/* Makes room for `need` elements of `size` bytes in the growing array *memory of *capacity; false when out of memory. */
bool sph__reserve(const sph_context *context, void **memory, size_t *capacity, size_t need, size_t size);

/*
 * --- handles --- With the build option handle-checks (on in debug builds) the block of every handle says what it is, and
 * stays for a while after it was destroyed. SPH__OWN, first in each public function, turns what is not a living handle of
 * that kind into NULL, which the function refuses, and tells the host. Otherwise it is nothing at all.
 */
enum {
    SPH__NO_HANDLE,
    SPH__CONTEXT,
    SPH__ANIMATION,
    SPH__QUADRIC,
    SPH__HIERARCHY,
    SPH__CURSOR,
    SPH__LEVEL,
    SPH__QUERY,
    SPH__SURFACE,
    SPH__SKIN,
    SPH__SKELETON,
    SPH__DEFORMER,
    SPH__PROGRESSIVE,
    SPH__IMPLICIT,
    SPH__TRACKER,
    SPH__DESTROYED
};

/* Zeroed memory for a handle of that kind, which sph__free takes back. */
void *sph__new(const sph_context *context, size_t size, int kind);

#if defined(SPH_HANDLE_CHECKS)
bool sph__handle_is(const void *handle, int kind, const char *function);
#  define SPH__OWN(handle, kind) ((handle) = sph__handle_is(handle, kind, __func__) ? (handle) : NULL)
#else
#  define SPH__OWN(handle, kind) ((void)0)
#endif

/* --- parallel loops --- */
void sph__parallel_for(const sph_context *context, size_t count, size_t grain, sph_range_fn *body, void *argument);
/* Workers that a parallel loop may use at once, the caller included; with a caller's executor a guess. */
uint32_t sph__worker_count(const sph_context *context);

/* --- progress of one public call, in parts --- */
typedef struct sph__progress {
    const sph_context *context;
    double base, span; /* the part of the call that is running: [base, base + span] */
    double last;
} sph__progress;

void sph__progress_begin(sph__progress *progress, const sph_context *context);
/* The next part of the call takes `span` of the whole. */
void sph__progress_part(sph__progress *progress, double span);
/* Reports `fraction` of the current part; SPH_OK, or SPH_E_CANCELLED with its message set. */
sph_status sph__progress_report(sph__progress *progress, const char *stage, double fraction);

/* --- sorting: in place, O(n log n), equal keys by item --- */
typedef struct sph__keyed {
    uint64_t key, item;
} sph__keyed;

void sph__sort(sph__keyed *entries, size_t count);

/* --- options that grow --- */
/* Fills `options` of the caller's `size` with `defaults` of `full` bytes; nothing below `least` bytes. */
void sph__options_init(void *options, size_t size, const void *defaults, size_t full, size_t least);
/* Reads a caller's struct (its first field is struct_size) over the defaults that `out` already holds. */
sph_status sph__options_read(const sph_context *context, const char *name, const void *in, void *out, size_t full,
                             size_t least);

/* The built-in allocator. */
void *sph__default_allocate(void *user, size_t size, size_t alignment);
void sph__default_release(void *user, void *memory, size_t size);

/* The built-in executor. */
typedef struct sph__pool sph__pool;
sph__pool *sph__pool_create(const sph_allocator *allocator, uint32_t thread_count);
void sph__pool_destroy(sph__pool *pool);
void sph__pool_parallel_for(void *pool, size_t count, size_t grain, sph_range_fn *body, void *argument);

#endif
