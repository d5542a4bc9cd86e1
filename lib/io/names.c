/* SPDX-License-Identifier: MIT */
/* Lists of file names, and the order in which people count. */
#include <string.h>

#include "io/io.h"

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static size_t digit_count(const char *p)
{
    size_t count = 0;
    while (is_digit(p[count]))
        ++count;
    return count;
}

/* Compares the numbers that both begin with, of any length, and passes over them. */
static int compare_numbers(const char **a, const char **b)
{
    size_t count_a, count_b;
    int order;
    while (**a == '0')
        ++*a;
    while (**b == '0')
        ++*b;
    count_a = digit_count(*a);
    count_b = digit_count(*b);
    order = count_a != count_b ? (count_a < count_b ? -1 : 1) : memcmp(*a, *b, count_a);
    *a += count_a;
    *b += count_b;
    return order;
}

int sph__io_compare_natural(const char *a, const char *b)
{
    const char *p = a, *q = b;
    while (*p != '\0' && *q != '\0') {
        if (is_digit(*p) && is_digit(*q)) {
            const int order = compare_numbers(&p, &q);
            if (order != 0) return order;
        } else if (*p != *q) {
            return (unsigned char)*p < (unsigned char)*q ? -1 : 1;
        } else {
            ++p;
            ++q;
        }
    }
    if (*p != *q) return *p == '\0' ? -1 : 1;
    return strcmp(a, b); /* they differ in zeros before a number at most */
}

/* NULL before everything else. */
static bool before(const char *a, const char *b)
{
    if (a == NULL || b == NULL) return a == NULL && b != NULL;
    return sph__io_compare_natural(a, b) < 0;
}

static void sift_down(const char **names, size_t start, size_t count)
{
    const char *name = names[start];
    size_t place = start;
    while (place < count / 2) { /* it has a child */
        size_t child = 2 * place + 1;
        if (child + 1 < count && before(names[child], names[child + 1])) ++child;
        if (!before(name, names[child])) break;
        names[place] = names[child];
        place = child;
    }
    names[place] = name;
}

/* A heap sort, as it needs no memory: equal names are the same text, so it does not matter that it is not stable. */
void sph_io_sort_natural(const char **names, size_t count)
{
    if (names == NULL || count < 2) return;
    for (size_t i = count / 2; i-- > 0;)
        sift_down(names, i, count);
    for (size_t last = count - 1; last > 0; --last) {
        const char *top = names[0];
        names[0] = names[last];
        names[last] = top;
        sift_down(names, 0, last);
    }
}

void sph__io_names_release(sph__io_names *names)
{
    for (size_t i = 0; i < names->count; ++i)
        sph_context_release(names->context, (void *)(uintptr_t)names->names[i]);
    sph_context_release(names->context, names->names);
    *names = (sph__io_names){.context = names->context};
}

bool sph__io_names_add(sph__io_names *names, const char *name)
{
    void *memory = names->names;
    char *copy;
    if (!sph__io_reserve(names->context, &memory, &names->capacity, names->count + 1, sizeof *names->names))
        return false;
    names->names = memory;
    copy = sph__io_copy_string(names->context, name);
    if (copy == NULL) return false;
    names->names[names->count++] = copy;
    return true;
}
