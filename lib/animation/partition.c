/* SPDX-License-Identifier: MIT */
/*
 * A group splits along an axis where, in order of the coordinate, two neighbours lie further apart than the tolerance.
 * That is cheap, needs one frame at a time, has no bad case as hashing has, and with tolerance 0 is already the exact
 * answer.
 */
#include <math.h>

#include "animation/partition.h"

sph_status sph__partition_init(sph__partition *partition, const sph_context *context, uint32_t n)
{
    *partition = (sph__partition){.context = context};
    partition->members = sph__alloc(context, n, sizeof *partition->members);
    partition->keys = sph__alloc(context, n, sizeof *partition->keys);
    partition->scratch = sph__alloc(context, n, sizeof *partition->scratch);
    if (partition->members == NULL || partition->keys == NULL || partition->scratch == NULL)
        return sph__fail_memory(context);
    if (n < 2) return SPH_OK;
    for (uint32_t i = 0; i < n; ++i)
        partition->members[i] = i;
    partition->members[n - 1] |= SPH__GROUP_END;
    partition->member_count = n;
    return SPH_OK;
}

void sph__partition_free(sph__partition *partition)
{
    sph__free(partition->context, partition->members);
    sph__free(partition->context, partition->keys);
    sph__free(partition->context, partition->scratch);
    *partition = (sph__partition){.context = partition->context};
}

uint32_t sph__group_end(const sph__partition *partition, uint32_t begin)
{
    while ((partition->members[begin] & SPH__GROUP_END) == 0)
        ++begin;
    return begin + 1;
}

static void insertion_sort(uint64_t *keys, size_t count)
{
    for (size_t i = 1; i < count; ++i) {
        const uint64_t key = keys[i];
        size_t at = i;
        for (; at > 0 && keys[at - 1] > key; --at)
            keys[at] = keys[at - 1];
        keys[at] = key;
    }
}

static void merge(const uint64_t *a, size_t a_count, const uint64_t *b, size_t b_count, uint64_t *to)
{
    while (a_count > 0 && b_count > 0)
        if (*b < *a) {
            *to++ = *b++;
            --b_count;
        } else {
            *to++ = *a++;
            --a_count;
        }
    memcpy(to, a, a_count * sizeof *to);
    memcpy(to + a_count, b, b_count * sizeof *to);
}

void sph__sort_keys(uint64_t *keys, uint64_t *scratch, size_t count)
{
    enum { RUN = 16 };
    uint64_t *from = keys, *to = scratch;
    for (size_t i = 0; i < count; i += RUN)
        insertion_sort(keys + i, count - i < RUN ? count - i : RUN);
    for (size_t width = RUN; width < count; width *= 2) {
        uint64_t *const swap = from;
        for (size_t i = 0; i < count; i += 2 * width) {
            const size_t left = count - i < width ? count - i : width;
            const size_t right = count - i - left < width ? count - i - left : width;
            merge(from + i, left, from + i + left, right, to + i);
        }
        from = to;
        to = swap;
    }
    if (from != keys) memcpy(keys, from, count * sizeof *keys);
}

/* Bits that sort like the number; -0 and 0 differ, which does no harm, for the gap between them is 0. */
static uint32_t sortable(float x)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return (bits & SPH__GROUP_END) != 0 ? ~bits : bits | SPH__GROUP_END;
}

static double extent(const uint64_t *keys, size_t count, const float *x)
{
    float low = x[3 * (size_t)(uint32_t)keys[0]], high = low;
    for (size_t i = 1; i < count; ++i) {
        const float value = x[3 * (size_t)(uint32_t)keys[i]];
        low = value < low ? value : low;
        high = value > high ? value : high;
    }
    return (double)high - low;
}

/* Writes keys [0, count) as one group at members[at]; returns what follows. One vertex alone is no group. */
static uint32_t write_group(uint32_t *members, uint32_t at, const uint64_t *keys, size_t count)
{
    if (count < 2) return at;
    for (size_t i = 0; i < count; ++i)
        members[at + i] = (uint32_t)keys[i];
    members[at + count - 1] |= SPH__GROUP_END;
    return at + (uint32_t)count;
}

/* Splits every group along one axis; `x` is that coordinate of vertex 0. Groups move forward over what was read. */
static void split_axis(sph__partition *partition, const float *x, double tolerance)
{
    uint32_t written = 0;
    for (uint32_t begin = 0, end; begin < partition->member_count; begin = end) {
        uint64_t *const keys = partition->keys;
        size_t count = 0, first = 0;
        end = sph__group_end(partition, begin);
        for (uint32_t i = begin; i < end; ++i) {
            const uint32_t vertex = partition->members[i] & ~SPH__GROUP_END;
            if (isfinite(x[3 * (size_t)vertex]))
                keys[count++] = (uint64_t)sortable(x[3 * (size_t)vertex]) << 32 | vertex;
        }
        if (count < 2) continue;
        if (extent(keys, count, x) > tolerance) sph__sort_keys(keys, partition->scratch, count);
        for (size_t i = 1; i < count; ++i) {
            const double gap = (double)x[3 * (size_t)(uint32_t)keys[i]] - x[3 * (size_t)(uint32_t)keys[i - 1]];
            if (!(gap > tolerance)) continue;
            written = write_group(partition->members, written, keys + first, i - first);
            first = i;
        }
        written = write_group(partition->members, written, keys + first, count - first);
    }
    partition->member_count = written;
}

void sph__partition_refine(sph__partition *partition, const float *xyz, double tolerance)
{
    for (size_t axis = 0; axis < 3; ++axis)
        split_axis(partition, xyz + axis, tolerance);
}
