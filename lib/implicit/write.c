/* SPDX-License-Identifier: MIT */
/* What comes out: the caller's vertices, their normals, and what was done. */
#include <math.h>

#include "implicit/tracker.h"
#include "numeric/vector.h"

sph_status sph__write_init(sph_tracker *tracker, const sph_skin *skin)
{
    const size_t n = skin->vertex_count, count = skin->triangle_count;
    size_t *next;
    tracker->triangle_count = count;
    tracker->triangles = sph__alloc(tracker->context, count, 3 * sizeof *tracker->triangles);
    tracker->around_starts = sph__zalloc(tracker->context, n + 2, sizeof *tracker->around_starts);
    tracker->around = sph__alloc(tracker->context, count, 3 * sizeof *tracker->around);
    if (tracker->triangles == NULL || tracker->around_starts == NULL || tracker->around == NULL || count > UINT32_MAX)
        return sph__fail_memory(tracker->context);
    memcpy(tracker->triangles, skin->triangles, 3 * count * sizeof *tracker->triangles);
    next = tracker->around_starts + 1;
    for (size_t i = 0; i < 3 * count; ++i)
        ++tracker->around_starts[skin->triangles[i] + 2];
    for (size_t v = 0; v < n; ++v)
        next[v + 1] += next[v];
    for (size_t i = 0; i < 3 * count; ++i)
        tracker->around[next[skin->triangles[i]]++] = (uint32_t)(i / 3);
    return SPH_OK;
}

static size_t block_end(const sph_tracker *tracker, size_t first)
{
    const size_t n = tracker->shell.vertex_count;
    return n - first < SPH__WRITE_BLOCK ? n : first + SPH__WRITE_BLOCK;
}

void sph__write_contacts(void *argument, size_t begin, size_t end)
{
    const sph__batch *b = argument;
    const sph__shell *s = &b->tracker->shell;
    for (size_t i = begin; i < end; ++i) {
        sph__track *t = b->tracker->tracks + i;
        t->report = (sph_tracker_report){0};
        for (size_t v = 0; v < s->vertex_count; ++v)
            t->report.contacts += t->state[s->nodes[v]] == SPH__NODE_TOUCHES;
    }
}

static void write_vertex(const sph__track *t, size_t node, float *out)
{
    for (int c = 0; c < 3; ++c)
        out[c] = (float)t->at[c][node];
}

/* One item is one pose: what has moved is counted, too. */
void sph__write_positions(void *argument, size_t begin, size_t end)
{
    const sph__batch *b = argument;
    const sph__shell *s = &b->tracker->shell;
    for (size_t i = begin; i < end; ++i) {
        sph__track *t = b->tracker->tracks + i;
        for (size_t v = 0; v < s->vertex_count; ++v) {
            const size_t node = s->nodes[v];
            float *out = t->positions + 3 * v;
            double way[3];
            for (int c = 0; c < 3; ++c)
                way[c] = t->at[c][node] - t->base[c][node];
            if (!(way[0] < 0) && !(way[0] > 0) && !(way[1] < 0) && !(way[1] > 0) && !(way[2] < 0) && !(way[2] > 0))
                continue;
            ++t->report.moved;
            t->report.farthest = fmax(t->report.farthest, sph__norm(way));
            write_vertex(t, node, out);
        }
    }
}

static void add_area(const float *positions, const uint32_t *corner, double sum[3])
{
    double u[3], v[3], area[3];
    for (int c = 0; c < 3; ++c) {
        const double origin = (double)positions[3 * (size_t)corner[0] + c];
        u[c] = (double)positions[3 * (size_t)corner[1] + c] - origin;
        v[c] = (double)positions[3 * (size_t)corner[2] + c] - origin;
    }
    sph__cross(u, v, area);
    sph__add_scaled(sum, 1, area, sum);
}

void sph__write_normals(void *argument, size_t begin, size_t end)
{
    const sph__batch *b = argument;
    const sph_tracker *tracker = b->tracker;
    for (size_t item = begin; item < end; ++item) {
        const sph__track *t = tracker->tracks + item / b->blocks;
        const size_t first = item % b->blocks * SPH__WRITE_BLOCK;
        for (size_t v = first; v < block_end(tracker, first); ++v) {
            double sum[3] = {0, 0, 0}, length;
            for (size_t i = tracker->around_starts[v]; i < tracker->around_starts[v + 1]; ++i)
                add_area(t->positions, tracker->triangles + 3 * (size_t)tracker->around[i], sum);
            length = sph__norm(sum);
            for (int c = 0; c < 3; ++c)
                t->normals[3 * v + c] = length > 0 && isfinite(length) ? (float)(sum[c] / length) : 0;
        }
    }
}
