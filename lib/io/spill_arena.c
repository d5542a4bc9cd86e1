/* SPDX-License-Identifier: MIT */
/*
 * Blocks in a temporary file. Addresses are reserved once and the file is mapped into them as it grows, so that a
 * block's place in the file is its address, and all of it is one mapping.
 */
#define _GNU_SOURCE

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/statfs.h>
#include <unistd.h>

#include "io/spill.h"

/* The file grows by so much at least; blocks of so much are cleared from the file when they are given back. */
enum { GROWTH = 16 << 20, LARGE = 1 << 20, NAME_SIZE = 4096 };

/* File systems in memory, by what statfs calls them. */
static const uint32_t TMPFS = 0x01021994, RAMFS = 0x858458f6;

/* A file without a name; where the file system has no such thing, one whose name is taken away at once. */
static int make_file(const char *folder)
{
    char name[NAME_SIZE];
    int file = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC | O_EXCL, 0600);
    if (file >= 0 || (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL)) return file;
    if (snprintf(name, sizeof name, "%s/sphmesh-XXXXXX", folder) >= (int)sizeof name) {
        errno = ENAMETOOLONG;
        return -1;
    }
    file = mkostemp(name, O_CLOEXEC);
    if (file >= 0) unlink(name);
    return file;
}

static void warn_of_memory(const sph__io_arena *a)
{
    struct statfs found;
    char text[256];
    if (fstatfs(a->file, &found) != 0 || ((uint32_t)found.f_type != TMPFS && (uint32_t)found.f_type != RAMFS)) return;
    snprintf(text, sizeof text, "%.180s is kept in memory: a temporary file there saves none",
             sph__io_shown(a->folder));
    sph_context_log(a->context, SPH_LOG_WARNING, text);
}

sph_status sph__io_arena_open(sph_context *context, const char *folder, sph__io_arena *a)
{
    const long page = sysconf(_SC_PAGESIZE);
    *a = (sph__io_arena){.context = context, .folder = folder, .file = -1, .page = page > 0 ? (size_t)page : 4096};
    a->file = make_file(folder);
    if (a->file < 0) return sph__io_fail_system(context, folder, "no temporary file can be made there");
    warn_of_memory(a);
    for (a->reserved = SIZE_MAX / 2 + 1 > (size_t)1 << 31 ? (size_t)1 << (sizeof(size_t) > 4 ? 44 : 30) : 1 << 30;
         a->reserved >= LARGE; a->reserved /= 2) {
        void *base = mmap(NULL, a->reserved, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
        if (base == MAP_FAILED) continue;
        a->base = base;
        return SPH_OK;
    }
    a->reserved = 0;
    return sph__io_fail(context, SPH_E_NOMEM, "no addresses can be had for a temporary file");
}

void sph__io_arena_close(sph__io_arena *a)
{
    if (a->context == NULL) return;
    if (a->base != NULL) munmap(a->base, a->reserved);
    if (a->file >= 0) close(a->file);
    sph_context_release(a->context, a->free);
    *a = (sph__io_arena){.context = NULL};
}

static void remove_extent(sph__io_arena *a, size_t at)
{
    --a->free_count;
    memmove(a->free + at, a->free + at + 1, (a->free_count - at) * sizeof *a->free);
}

/* Room for the extent is there: sph__io_arena_take saw to it. */
static void insert_extent(sph__io_arena *a, size_t begin, size_t end)
{
    size_t low = 0, high = a->free_count;
    while (low < high) { /* the first that begins after this one */
        const size_t middle = low + (high - low) / 2;
        if (a->free[middle].begin < begin)
            low = middle + 1;
        else
            high = middle;
    }
    if (low > 0 && a->free[low - 1].end == begin) {
        a->free[low - 1].end = end;
        if (low < a->free_count && a->free[low].begin == end) {
            a->free[low - 1].end = a->free[low].end;
            remove_extent(a, low);
        }
        return;
    }
    if (low < a->free_count && a->free[low].begin == end) {
        a->free[low].begin = begin;
        return;
    }
    memmove(a->free + low + 1, a->free + low, (a->free_count - low) * sizeof *a->free);
    a->free[low] = (sph__io_extent){begin, end};
    ++a->free_count;
}

/* Enlarges the file so that a block of `size` fits at its end. Disk space is taken now: a page that found none later
 * would end the process. */
static bool grow(sph__io_arena *a, size_t size)
{
    const bool open_end = a->free_count > 0 && a->free[a->free_count - 1].end == a->size;
    const size_t there = open_end ? a->size - a->free[a->free_count - 1].begin : 0, old = a->size;
    const size_t lacking = size - there;
    size_t more = lacking < GROWTH ? GROWTH : lacking;
    if (lacking > a->reserved - old) {
        sph__io_fail(a->context, SPH_E_NOMEM, "the addresses for the temporary file are used up");
        return false;
    }
    if (more > a->reserved - old) more = lacking;
    int error = posix_fallocate(a->file, (off_t)old, (off_t)more);
    if (error != 0 && more > lacking) error = posix_fallocate(a->file, (off_t)old, (off_t)(more = lacking));
    if (error == 0 &&
        mmap(a->base + old, more, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_FIXED, a->file, (off_t)old) == MAP_FAILED)
        error = errno;
    if (error != 0) {
        char what[96];
        snprintf(what, sizeof what, "the temporary file there cannot grow to %zu MiB", (old + lacking) >> 20);
        errno = error;
        sph__io_fail_system(a->context, a->folder, what);
        return false;
    }
    a->size = old + more;
    insert_extent(a, old, a->size);
    return true;
}

static size_t rounded(const sph__io_arena *a, size_t size)
{
    return (size + (a->page - 1)) / a->page * a->page;
}

void *sph__io_arena_take(sph__io_arena *a, size_t size)
{
    if (size > a->reserved) {
        sph__io_fail(a->context, SPH_E_NOMEM, "%zu bytes are more than can be addressed", size);
        return NULL;
    }
    size = rounded(a, size);
    /* Free extents are at most one more than blocks; there may be two while the file grows. */
    if (!sph__io_reserve(a->context, (void **)&a->free, &a->free_capacity, a->blocks + 4, sizeof *a->free)) return NULL;
    for (int grown = 0; grown < 2; ++grown) {
        for (size_t i = 0; i < a->free_count; ++i) {
            const size_t begin = a->free[i].begin;
            if (a->free[i].end - begin < size) continue;
            a->free[i].begin += size;
            if (a->free[i].begin == a->free[i].end) remove_extent(a, i);
            ++a->blocks;
            a->live += size;
            a->peak = a->live > a->peak ? a->live : a->peak;
            return a->base + begin;
        }
        if (grown != 0 || !grow(a, size)) return NULL;
    }
    return NULL;
}

void sph__io_arena_give(sph__io_arena *a, void *memory, size_t size)
{
    const size_t begin = (size_t)((char *)memory - a->base);
    size = rounded(a, size);
    (void)madvise(memory, size, MADV_DONTNEED);
#ifdef FALLOC_FL_ZERO_RANGE
    /* Else the system would yet write out what nobody wants. The space stays taken. */
    if (size >= LARGE) (void)fallocate(a->file, FALLOC_FL_ZERO_RANGE | FALLOC_FL_KEEP_SIZE, (off_t)begin, (off_t)size);
#endif
    --a->blocks;
    a->live -= size;
    insert_extent(a, begin, begin + size);
}
