/* SPDX-License-Identifier: MIT */
/* What stands in front of a block where handles are checked; nothing where they are not. */
#ifndef SPH_BASE_HANDLE_H
#define SPH_BASE_HANDLE_H

#include <pthread.h>

#include "base/base.h"

#if defined(SPH_HANDLE_CHECKS)

enum { SPH__IN_FRONT = SPH__ALIGN, SPH__GRAVES = 256 };

/* Of each context the blocks of the handles that were destroyed last: kept, so that they can be told. Zeroed at first. */
typedef struct sph__graves {
    pthread_mutex_t mutex;
    void *handles[SPH__GRAVES];
    size_t next;
} sph__graves;

/* Writes into the space in front of a block what it is, and whose. */
void sph__handle_mark(void *handle, const sph_context *context, int kind);
/* Takes over a block of the built-in allocator that is a handle; false for others. */
bool sph__bury(sph__graves *graves, const sph_allocator *allocator, void *block);
/* Releases all, at the context's end. */
void sph__graves_clear(sph__graves *graves, const sph_allocator *allocator);

#else

enum { SPH__IN_FRONT = 0 };
typedef struct sph__graves {
    char nothing;
} sph__graves;
#  define sph__handle_mark(handle, context, kind) ((void)(kind))
#  define sph__bury(graves, allocator, block) false
#  define sph__graves_clear(graves, allocator) ((void)0)

#endif

#endif
