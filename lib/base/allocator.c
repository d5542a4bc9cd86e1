/* SPDX-License-Identifier: MIT */
/* The allocator of contexts whose host brings none. */
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/base.h"

/* Large memory comes from the system and goes back to it at once, where the C library might keep it. */
#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__)
#  define HAVE_LARGE 1
enum { LARGE = 1 << 18, HUGE_PAGE = 1 << 21 };

static void *map_pages(size_t size)
{
    void *memory = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    return memory == MAP_FAILED ? NULL : memory;
}

/* A few megabytes, as levels have, in huge pages where they are offered: small ones take longer to come than most that is
 * done with them. More of them would take up more memory than was asked for. */
static void *map_large(size_t size)
{
    const long page = sysconf(_SC_PAGESIZE);
    char *memory, *aligned;
    size_t whole;
    if (size < HUGE_PAGE || size > 4 * HUGE_PAGE || page <= 0 || HUGE_PAGE % page != 0) return map_pages(size);
    whole = (size + (size_t)page - 1) / (size_t)page * (size_t)page;
    memory = map_pages(whole + HUGE_PAGE);
    if (memory == NULL) return map_pages(size);
    aligned = memory + (HUGE_PAGE - (uintptr_t)memory % HUGE_PAGE) % HUGE_PAGE;
    if (aligned != memory) (void)munmap(memory, (size_t)(aligned - memory));
    (void)munmap(aligned + whole, (size_t)(memory + HUGE_PAGE - aligned));
    (void)madvise(aligned, size, MADV_HUGEPAGE);
    return aligned;
}
#endif

void *sph__default_allocate(void *user, size_t size, size_t alignment)
{
    void *memory = NULL;
    (void)user;
#if defined(HAVE_LARGE)
    if (size >= LARGE) {
        return map_large(size);
    }
#endif
    return posix_memalign(&memory, alignment < sizeof(void *) ? sizeof(void *) : alignment, size) == 0 ? memory : NULL;
}

void sph__default_release(void *user, void *memory, size_t size)
{
    (void)user;
#if defined(HAVE_LARGE)
    if (size >= LARGE) {
        (void)munmap(memory, size);
        return;
    }
#endif
    (void)size;
    free(memory);
}
