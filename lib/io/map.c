/* SPDX-License-Identifier: MIT */
/* A file's bytes, memory-mapped. A file must not be made shorter while it is mapped. */
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/io.h"

static sph_status map_file(sph_context *context, const char *path, int file, sph__io_map *map)
{
    static const unsigned char EMPTY[1];
    struct stat found;
    void *bytes;
    if (fstat(file, &found) != 0) return sph__io_fail_system(context, path, "cannot be looked at");
    if (!S_ISREG(found.st_mode))
        return sph__io_fail(context, SPH_E_IO, "%s: %s, not a file", sph__io_shown(path),
                            S_ISDIR(found.st_mode) ? "a directory" : "a pipe or a device");
    if ((uintmax_t)found.st_size > PTRDIFF_MAX)
        return sph__io_fail(context, SPH_E_LIMIT, "%s: too large for this machine", sph__io_shown(path));
    *map = (sph__io_map){EMPTY, 0};
    if (found.st_size == 0) return SPH_OK;
    bytes = mmap(NULL, (size_t)found.st_size, PROT_READ, MAP_PRIVATE, file, 0);
    if (bytes == MAP_FAILED) {
        *map = (sph__io_map){NULL, 0};
        return sph__io_fail_system(context, path, "cannot be mapped");
    }
    (void)madvise(bytes, (size_t)found.st_size, MADV_SEQUENTIAL);
    *map = (sph__io_map){bytes, (size_t)found.st_size};
    return SPH_OK;
}

sph_status sph__io_map_open(sph_context *context, const char *path, sph__io_map *map)
{
    sph_status status;
    int file;
    *map = (sph__io_map){NULL, 0};
    /* Without O_NONBLOCK the opening of a pipe that nobody writes to would wait. */
    file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (file < 0) return sph__io_fail_system(context, path, "cannot be opened");
    status = map_file(context, path, file, map);
    close(file);
    return status;
}

void sph__io_map_close(sph__io_map *map)
{
    if (map->size != 0) munmap((void *)(uintptr_t)map->bytes, map->size);
    *map = (sph__io_map){NULL, 0};
}

void sph__io_map_drop(const sph__io_map *map, size_t begin, size_t end)
{
    const long page = sysconf(_SC_PAGESIZE);
    if (page <= 0 || map->size == 0) return;
    begin -= begin % (size_t)page;
    if (end < map->size) end -= end % (size_t)page;
    if (begin < end) (void)madvise((void *)(uintptr_t)(map->bytes + begin), end - begin, MADV_DONTNEED);
}
