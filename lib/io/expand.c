/* SPDX-License-Identifier: MIT */
/* From what the caller names to the files: globs (wolf_*.obj) and printf patterns (wolf_%d.obj, wolf_%04d.obj). */
#include <dirent.h>
#include <errno.h>
#include <glob.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "io/io.h"

enum { WIDTH_LIMIT = 64 };

/* A printf pattern in the last part of a path. */
typedef struct pattern {
    const char *directory_end;         /* where the last part begins */
    const char *number, *after_number; /* the conversion, from '%' */
    size_t width;                      /* least number of digits; 1 without zero padding */
} pattern;

static bool exists(const char *path)
{
    struct stat found;
    return stat(path, &found) == 0;
}

/* Whether the path has a conversion of an integer: %d, %i, %u, with zero padding or not. */
static bool find_conversion(const char *path, pattern *found)
{
    const char *slash = strrchr(path, '/');
    *found = (pattern){.directory_end = slash == NULL ? path : slash + 1, .width = 1};
    for (const char *p = path; (p = strchr(p, '%')) != NULL; ++p) {
        const char *q = p + 1;
        size_t width = 0;
        if (*q == '%') {
            ++p;
            continue;
        }
        for (; *q >= '0' && *q <= '9'; ++q)
            if (width <= WIDTH_LIMIT) width = width * 10 + (size_t)(*q - '0');
        if (*q != 'd' && *q != 'i' && *q != 'u') continue;
        found->number = p;
        found->after_number = q + 1;
        if (p[1] == '0' && width > 1) found->width = width;
        return true;
    }
    return false;
}

/* Compares `size` bytes of text with the same number of characters of the pattern's `part`, in which %% stands for %.
 */
static size_t match_part(const char *part, const char *part_end, const char *text)
{
    size_t matched = 0;
    for (; part < part_end; ++part, ++matched) {
        if (*part == '%' && part + 1 < part_end && part[1] == '%') ++part;
        if (text[matched] != *part) return SIZE_MAX;
    }
    return matched;
}

/* Whether printf would give this file name for some number >= 0. */
static bool matches(const pattern *p, const char *name)
{
    const size_t before = match_part(p->directory_end, p->number, name);
    const char *digits;
    size_t count = 0, after;
    if (before == SIZE_MAX) return false;
    digits = name + before;
    while (digits[count] >= '0' && digits[count] <= '9')
        ++count;
    if (count == 0 || count < p->width || (count > p->width && digits[0] == '0')) return false;
    after = match_part(p->after_number, p->after_number + strlen(p->after_number), digits + count);
    return after != SIZE_MAX && digits[count + after] == '\0';
}

static sph_status add(sph__io_names *names, const char *path)
{
    return sph__io_names_add(names, path) ? SPH_OK : sph__io_fail_memory(names->context, path);
}

static sph_status read_directory(sph__io_names *names, const char *path, const pattern *p, DIR *directory)
{
    const size_t length = (size_t)(p->directory_end - path);
    const struct dirent *entry;
    while (errno = 0, (entry = readdir(directory)) != NULL) {
        const size_t size = strlen(entry->d_name) + 1;
        char *whole;
        sph_status status;
        if (!matches(p, entry->d_name)) continue;
        whole = sph_context_allocate(names->context, length + size, 1);
        if (whole == NULL) return sph__io_fail_memory(names->context, path);
        memcpy(whole, path, length);
        memcpy(whole + length, entry->d_name, size);
        status = add(names, whole);
        sph_context_release(names->context, whole);
        if (status != SPH_OK) return status;
    }
    return errno == 0 ? SPH_OK : sph__io_fail_system(names->context, path, "its directory cannot be read");
}

static sph_status expand_pattern(sph__io_names *names, const char *path, const pattern *p)
{
    const size_t before = names->count, length = (size_t)(p->directory_end - path);
    pattern second;
    char *folder;
    DIR *directory;
    sph_status status;
    if (p->number < p->directory_end)
        return sph__io_fail(names->context, SPH_E_UNSUPPORTED, "%s: the number's place must be in the file's name",
                            sph__io_shown(path));
    if (find_conversion(p->after_number, &second))
        return sph__io_fail(names->context, SPH_E_UNSUPPORTED, "%s: more than one number in a pattern",
                            sph__io_shown(path));
    folder = sph_context_allocate(names->context, length + 2, 1);
    if (folder == NULL) return sph__io_fail_memory(names->context, path);
    memcpy(folder, path, length);
    memcpy(folder + length, length == 0 ? "." : "", length == 0 ? 2 : 1);
    directory = opendir(folder);
    status = directory == NULL ? sph__io_fail_system(names->context, folder, "the directory cannot be read")
                               : read_directory(names, path, p, directory);
    if (directory != NULL) closedir(directory);
    sph_context_release(names->context, folder);
    if (status == SPH_OK && names->count == before)
        status = sph__io_fail(names->context, SPH_E_IO, "%s: no file has such a name", sph__io_shown(path));
    return status;
}

static sph_status expand_glob(sph__io_names *names, const char *path)
{
    glob_t found;
    sph_status status = SPH_OK;
    const int failed = glob(path, GLOB_NOSORT, NULL, &found);
    if (failed == GLOB_NOSPACE) {
        status = sph__io_fail_memory(names->context, path);
    } else if (failed != 0) {
        status = sph__io_fail(names->context, SPH_E_IO, "%s: no file has such a name", sph__io_shown(path));
    } else {
        for (size_t i = 0; i < found.gl_pathc && status == SPH_OK; ++i)
            status = add(names, found.gl_pathv[i]);
    }
    globfree(&found);
    return status;
}

sph_status sph__io_expand(sph__io_names *names, const char *const *paths, size_t path_count)
{
    sph_status status = SPH_OK;
    for (size_t i = 0; i < path_count && status == SPH_OK; ++i) {
        pattern p;
        const bool plain = exists(paths[i]); /* a file may have such characters in its name */
        if (!plain && find_conversion(paths[i], &p))
            status = expand_pattern(names, paths[i], &p);
        else if (!plain && strpbrk(paths[i], "*?[") != NULL)
            status = expand_glob(names, paths[i]);
        else
            status = add(names, paths[i]);
    }
    if (status == SPH_OK) sph_io_sort_natural(names->names, names->count);
    return status;
}
