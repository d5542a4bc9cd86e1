/* SPDX-License-Identifier: MIT */
#include "base/base.h"

static bool before(const sph__keyed *a, const sph__keyed *b)
{
    return a->key != b->key ? a->key < b->key : a->item < b->item;
}

static void sift_down(sph__keyed *a, size_t root, size_t count)
{
    const sph__keyed moving = a[root];
    for (size_t child; (child = 2 * root + 1) < count; root = child) {
        if (child + 1 < count && before(&a[child], &a[child + 1])) ++child;
        if (!before(&moving, &a[child])) break;
        a[root] = a[child];
    }
    a[root] = moving;
}

void sph__sort(sph__keyed *a, size_t count)
{
    if (count <= 24) {
        for (size_t i = 1; i < count; ++i) {
            const sph__keyed moving = a[i];
            size_t j = i;
            for (; j > 0 && before(&moving, &a[j - 1]); --j) a[j] = a[j - 1];
            a[j] = moving;
        }
        return;
    }
    for (size_t i = count / 2; i-- > 0;) sift_down(a, i, count);
    for (size_t end = count - 1; end > 0; --end) {
        const sph__keyed last = a[end];
        a[end] = a[0];
        a[0] = last;
        sift_down(a, 0, end);
    }
}
