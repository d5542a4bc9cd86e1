/* SPDX-License-Identifier: MIT */
/* Tangential relaxation of nodes on their way, and smoothing of contact regions. Each reads what no one writes. */
#include <math.h>

#include "implicit/tracker.h"
#include "numeric/vector.h"

enum { BLOCK = SPH__IMPLICIT_BLOCK };
/* Weights below this are as good as none. */
static const float LEAST_SHARE = 1e-3f;

static size_t block_end(const sph_tracker *tracker, size_t first)
{
    const size_t n = tracker->shell.node_count;
    return n - first < BLOCK ? n : first + BLOCK;
}

/* Towards the place in the ring that the node has at rest, along the surface that the gradient is at right angles to.
 */
static void relax_node(const sph_tracker *tracker, sph__track *t, size_t i)
{
    const sph__shell *s = &tracker->shell;
    const double mu = (double)t->share[0][i];
    double off[3] = {0, 0, 0}, normal[3], along;
    for (size_t k = s->starts[i]; k < s->starts[i + 1]; ++k)
        for (int c = 0; c < 3; ++c)
            off[c] += (double)s->shares[k] * (t->at[c][s->ring[k]] - t->at[c][i]);
    for (int c = 0; c < 3; ++c)
        normal[c] = (double)t->direction[c][i];
    along = sph__dot(off, normal);
    for (int c = 0; c < 3; ++c)
        t->high[c][i] = t->at[c][i] + mu * (off[c] - along * normal[c]);
}

void sph__relax_find(void *argument, size_t begin, size_t end)
{
    const sph__batch *b = argument;
    for (size_t item = begin; item < end; ++item) {
        sph__track *t = b->tracker->tracks + item / b->blocks;
        const size_t first = item % b->blocks * BLOCK;
        if (t->active[item % b->blocks] == 0) continue;
        for (size_t i = first; i < block_end(b->tracker, first); ++i)
            if (t->state[i] == SPH__NODE_WALKS) relax_node(b->tracker, t, i);
    }
}

void sph__relax_take(void *argument, size_t begin, size_t end)
{
    const sph__batch *b = argument;
    for (size_t item = begin; item < end; ++item) {
        sph__track *t = b->tracker->tracks + item / b->blocks;
        const size_t first = item % b->blocks * BLOCK;
        if (t->active[item % b->blocks] == 0) continue;
        for (size_t i = first; i < block_end(b->tracker, first); ++i)
            for (int c = 0; c < 3 && t->state[i] == SPH__NODE_WALKS; ++c)
                t->at[c][i] = t->high[c][i];
    }
}

/* --- smoothing --- */

void sph__smooth_start(void *argument, size_t begin, size_t end)
{
    const sph__batch *b = argument;
    for (size_t item = begin; item < end; ++item) {
        sph__track *t = b->tracker->tracks + item / b->blocks;
        const size_t first = item % b->blocks * BLOCK;
        for (size_t i = first; i < first + BLOCK; ++i)
            t->share[0][i] = t->state[i] == SPH__NODE_TOUCHES || t->state[i] == SPH__NODE_HALVES ? 1 : 0;
    }
}

/* Contacts keep 1; the others take the mean of their ring and themselves. */
void sph__smooth_spread(void *argument, size_t begin, size_t end)
{
    const sph__batch *b = argument;
    const sph__shell *s = &b->tracker->shell;
    const uint32_t from = b->round % 2;
    for (size_t item = begin; item < end; ++item) {
        sph__track *t = b->tracker->tracks + item / b->blocks;
        const size_t first = item % b->blocks * BLOCK;
        for (size_t i = first; i < block_end(b->tracker, first); ++i) {
            float sum = t->share[from][i];
            const size_t count = s->starts[i + 1] - s->starts[i];
            for (size_t k = s->starts[i]; k < s->starts[i + 1]; ++k)
                sum += t->share[from][s->ring[k]];
            if (t->state[i] != SPH__NODE_TOUCHES && t->state[i] != SPH__NODE_HALVES)
                t->share[1 - from][i] = t->state[i] == SPH__NODE_FREE ? 0 : sum / (float)(count + 1);
            else
                t->share[1 - from][i] = 1;
        }
    }
}

static bool is_closed(const sph__shell *s, size_t i)
{
    for (size_t k = s->starts[i]; k < s->starts[i + 1]; ++k)
        if (s->shares[k] < 0 || s->shares[k] > 0) return true;
    return false;
}

void sph__smooth_find(void *argument, size_t begin, size_t end)
{
    const sph__batch *b = argument;
    const sph__shell *s = &b->tracker->shell;
    for (size_t item = begin; item < end; ++item) {
        sph__track *t = b->tracker->tracks + item / b->blocks;
        const size_t first = item % b->blocks * BLOCK;
        for (size_t i = first; i < block_end(b->tracker, first); ++i) {
            const double beta = (double)t->share[0][i], count = (double)(s->starts[i + 1] - s->starts[i]);
            if (t->share[0][i] < LEAST_SHARE || !is_closed(s, i)) continue;
            for (int c = 0; c < 3; ++c) {
                double sum = 0;
                for (size_t k = s->starts[i]; k < s->starts[i + 1]; ++k)
                    sum += t->at[c][s->ring[k]];
                t->high[c][i] = (1 - beta) * t->at[c][i] + beta * sum / count;
            }
        }
    }
}

void sph__smooth_take(void *argument, size_t begin, size_t end)
{
    const sph__batch *b = argument;
    const sph__shell *s = &b->tracker->shell;
    for (size_t item = begin; item < end; ++item) {
        sph__track *t = b->tracker->tracks + item / b->blocks;
        const size_t first = item % b->blocks * BLOCK;
        for (size_t i = first; i < block_end(b->tracker, first); ++i)
            for (int c = 0; c < 3 && t->share[0][i] >= LEAST_SHARE && is_closed(s, i); ++c)
                t->at[c][i] = t->high[c][i];
    }
}
