/* SPDX-License-Identifier: MIT */
#include "numbered.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LEAST_DIGITS = 4, MOST_DIGITS = 20 };

/* A %d with its digits: where it begins, its length, and how wide the number is to be; false: there is none. */
static bool find_pattern(const char *name, size_t *begin, size_t *length, int *width)
{
    for (const char *p = strchr(name, '%'); p != NULL; p = strchr(p + 1, '%')) {
        const size_t digits = strspn(p + 1, "0123456789");
        if (p[1 + digits] != 'd' || digits > 2) continue;
        *begin = (size_t)(p - name);
        *length = digits + 2;
        *width = digits == 0 ? 0 : atoi(p + 1) % (MOST_DIGITS + 1);
        return true;
    }
    return false;
}

bool name_is_pattern(const char *path)
{
    const char *slash = strrchr(path, '/');
    size_t begin, length;
    int width;
    return find_pattern(slash == NULL ? path : slash + 1, &begin, &length, &width);
}

static int digits_of(uint32_t number)
{
    int digits = 1;
    for (; number > 9; number /= 10)
        ++digits;
    return digits;
}

char *numbered_name(const char *path, uint32_t number, uint32_t last)
{
    const char *slash = strrchr(path, '/'), *name = slash == NULL ? path : slash + 1, *dot = strrchr(name, '.');
    const size_t folder = (size_t)(name - path), size = strlen(path) + MOST_DIGITS + 2;
    char *made = malloc(size);
    size_t begin, length;
    int width;
    if (made == NULL) return NULL;
    if (find_pattern(name, &begin, &length, &width)) {
        snprintf(made, size, "%.*s%0*u%s", (int)(folder + begin), path, width, number, name + begin + length);
        return made;
    }
    if (dot == NULL || dot == name) dot = name + strlen(name);
    width = digits_of(last) > LEAST_DIGITS ? digits_of(last) : LEAST_DIGITS;
    snprintf(made, size, "%.*s-%0*u%s", (int)(dot - path), path, width, number, dot);
    return made;
}

uint32_t range_count(const frame_range *r, uint32_t frame_count)
{
    const uint32_t end = r->end == 0 || r->end > frame_count ? frame_count : r->end;
    return r->first >= end ? 0 : (end - r->first - 1) / r->step + 1;
}
