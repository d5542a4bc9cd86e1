/* SPDX-License-Identifier: MIT */
/*
 * What the fuzz targets share. A target is one function over bytes; a fuzzer looks for bytes that make it crash, hang, leak
 * or fail one of its checks, and replay.c runs it over the bytes that were kept.
 */
#ifndef SPH_FUZZ_H
#define SPH_FUZZ_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sphmesh/sphmesh.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A check that no build leaves out. */
#define FUZZ_CHECK(condition)                                                                                          \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            fprintf(stderr, "%s:%d: not so: %s\n", __FILE__, __LINE__, #condition);                                    \
            abort();                                                                                                   \
        }                                                                                                              \
    } while (0)

/* Bytes that are taken one value after another; zeros at the end. */
typedef struct fuzz_bytes {
    const uint8_t *data;
    size_t size;
} fuzz_bytes;

static inline uint8_t fuzz_byte(fuzz_bytes *b)
{
    if (b->size == 0) return 0;
    --b->size;
    return *b->data++;
}

static inline uint32_t fuzz_below(fuzz_bytes *b, uint32_t limit)
{
    const uint32_t low = fuzz_byte(b), high = limit > 256 ? fuzz_byte(b) : 0;
    return (high << 8 | low) % limit;
}

/* Takes what a handle is written as: a sph_write_fn, with a fuzz_buffer for its user. Free `data` at the end. */
typedef struct fuzz_buffer {
    uint8_t *data;
    size_t size, capacity;
} fuzz_buffer;

static inline sph_status fuzz_append(void *user, const void *bytes, size_t size)
{
    fuzz_buffer *b = user;
    if (size > b->capacity - b->size) {
        b->capacity = 2 * (b->size + size);
        b->data = realloc(b->data, b->capacity);
        FUZZ_CHECK(b->data != NULL);
    }
    memcpy(b->data + b->size, bytes, size);
    b->size += size;
    return SPH_OK;
}

/* Ends work that would take too long for a fuzzer: not a finding, as every loop asks. */
typedef struct fuzz_patience {
    unsigned reports_left;
} fuzz_patience;

static inline bool fuzz_progress(void *user, const char *stage, double fraction)
{
    fuzz_patience *p = user;
    FUZZ_CHECK(stage != NULL && fraction >= 0 && fraction <= 1);
    return p->reports_left > 0 && --p->reports_left > 0;
}

/* One thread, a limit of memory, and a limit of patience. */
static inline sph_context *fuzz_context(fuzz_patience *patience)
{
    sph_context_options o;
    sph_context *context = NULL;
    sph_context_options_init(&o, sizeof o);
    o.thread_count = 1;
    o.memory_limit = UINT64_C(256) << 20;
    o.progress = fuzz_progress;
    o.progress_user = patience;
    FUZZ_CHECK(sph_context_create(&o, &context) == SPH_OK);
    return context;
}

/* A failure says why, and everything that was taken has been given back. */
static inline void fuzz_end(sph_context *context, sph_status status, uint64_t idle)
{
    if (status != SPH_OK) FUZZ_CHECK(sph_context_last_message(context)[0] != '\0');
    FUZZ_CHECK(sph_context_memory_used(context) == idle);
    sph_context_destroy(context);
}

#endif
