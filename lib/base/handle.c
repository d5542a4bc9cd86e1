/* SPDX-License-Identifier: MIT */
#include "base/handle.h"

#if defined(SPH_HANDLE_CHECKS)

/* Stands in front of each block, after its size (context.c). */
typedef struct front {
    size_t bytes;
    const sph_context *context;
    uint64_t kind;
} front;
_Static_assert(sizeof(front) <= SPH__ALIGN, "there is room for it");

/* libsphmesh-io, which knows of public headers only, makes its handles of plain blocks; destroyed ones begin with this. */
static const uint64_t IO_DESTROYED = UINT64_C(0xdead5f6f6973f0e1);

static const char *const NAMES[] = {"memory or a handle of libsphmesh-io",
                                    "a sph_context",
                                    "a sph_animation",
                                    "a sph_quadric",
                                    "a sph_hierarchy",
                                    "a sph_cursor",
                                    "a sph_level",
                                    "a sph_query",
                                    "a sph_surface",
                                    "a sph_skin",
                                    "a sph_skeleton",
                                    "a sph_deformer",
                                    "a sph_progressive",
                                    "a sph_implicit",
                                    "a sph_tracker",
                                    "a handle that was destroyed"};
_Static_assert(sizeof NAMES / sizeof *NAMES == SPH__DESTROYED + 1, "each kind has a name");

static front *front_of(const void *handle)
{
    return (front *)(void *)((char *)(uintptr_t)handle - SPH__ALIGN);
}

void sph__handle_mark(void *handle, const sph_context *context, int kind)
{
    front_of(handle)->context = context;
    front_of(handle)->kind = (uint64_t)kind;
}

bool sph__handle_is(const void *handle, int kind, const char *function)
{
    const front *f;
    if (handle == NULL) return false;
    f = front_of(handle);
    if (f->kind == (uint64_t)kind) return true;
    if (f->kind <= SPH__DESTROYED) {
        (void)sph__fail(f->context, SPH_E_INVALID, "%s: %s is given in place of %s", function, NAMES[f->kind],
                        NAMES[kind]);
        sph__log(f->context, SPH_LOG_WARNING, "%s: %s is given in place of %s", function, NAMES[f->kind], NAMES[kind]);
    }
    return false;
}

static bool is_handle(const front *f, const void *block)
{
    uint64_t first;
    if (f->kind != SPH__NO_HANDLE) return true;
    if (f->bytes < SPH__ALIGN + sizeof first) return false;
    memcpy(&first, block, sizeof first);
    return first == IO_DESTROYED;
}

static void release(const sph_allocator *allocator, void *block)
{
    if (block != NULL) allocator->release(allocator->user, front_of(block), front_of(block)->bytes);
}

bool sph__bury(sph__graves *graves, const sph_allocator *allocator, void *block)
{
    void *oldest;
    if (!is_handle(front_of(block), block)) return false;
    /* A host that counts its memory gets it back when it expects it. */
    if (allocator->allocate != sph__default_allocate) return false;
    front_of(block)->kind = SPH__DESTROYED;
    pthread_mutex_lock(&graves->mutex);
    oldest = graves->handles[graves->next];
    graves->handles[graves->next] = block;
    graves->next = (graves->next + 1) % SPH__GRAVES;
    pthread_mutex_unlock(&graves->mutex);
    release(allocator, oldest);
    return true;
}

void sph__graves_clear(sph__graves *graves, const sph_allocator *allocator)
{
    for (size_t i = 0; i < SPH__GRAVES; ++i)
        release(allocator, graves->handles[i]);
    pthread_mutex_destroy(&graves->mutex);
}

#else

typedef int sph__nothing_to_check; /* no file is empty */

#endif
