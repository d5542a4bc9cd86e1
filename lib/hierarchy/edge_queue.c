/* SPDX-License-Identifier: MIT */
#include "hierarchy/edge_queue.h"

#include <math.h>

/* The heap is filled up when it has fewer edges than FEWEST, with one in PART of what is left; of MANY edges or fewer none
 * waits. The limit is chosen by SAMPLES of the costs. */
enum { FEWEST = 512, PART = 16, MANY = 1 << 14, SAMPLES = 512 };

void sph__edge_queue_init(sph__edge_queue *queue, sph_context *context)
{
    *queue = (sph__edge_queue){.limit = 0};
    sph__heap_init(&queue->open, context);
    sph__heap_init(&queue->refused, context);
}

void sph__edge_queue_free(sph__edge_queue *queue)
{
    sph__heap_free(&queue->open);
    sph__free(queue->refused.context, queue->waiting);
    sph__free(queue->refused.context, queue->touched);
    sph__heap_free(&queue->refused);
    sph__edge_queue_init(queue, queue->refused.context);
}

sph_status sph__edge_queue_reserve(sph__edge_queue *queue, const sph__connectivity *mesh)
{
    queue->waiting = sph__alloc(queue->open.context, mesh->edge_count, sizeof *queue->waiting);
    if (queue->waiting == NULL) return sph__fail_memory(queue->open.context);
    for (uint32_t e = 0; e < mesh->edge_count; ++e) queue->waiting[e] = e;
    queue->waiting_count = mesh->edge_count;
    return sph__heap_reserve(&queue->open, mesh->edge_count);
}

/* Edges of equal cost go by their ends. */
static uint64_t tie_of(const sph__connectivity *mesh, uint32_t edge)
{
    uint32_t u, v;
    sph__edge_ends(mesh, edge, &u, &v);
    return (uint64_t)u << 32 | v;
}

static bool is_refused(const sph__edge *edge)
{
    return edge->cost < SPH__NO_COST && edge->cost > SPH__GONE;
}

void sph__edge_queue_set(sph__edge_queue *queue, sph__connectivity *mesh, uint32_t edge, double cost)
{
    const bool sorted = sph__edge_queue_sorts(queue, mesh->edges[edge].cost);
    if (is_refused(&mesh->edges[edge])) sph__heap_remove(&queue->refused, edge);
    mesh->edges[edge].cost = cost;
    if (sph__edge_queue_sorts(queue, cost))
        (void)sph__heap_set(&queue->open, edge, cost, tie_of(mesh, edge)); /* there is room */
    else if (sorted)
        sph__heap_remove(&queue->open, edge);
}

void sph__edge_queue_take(sph__edge_queue *queue, sph__connectivity *mesh, uint32_t edge)
{
    sph__edge_queue_set(queue, mesh, edge, SPH__NO_COST);
}

/* A cost that about one in PART of the edges that wait are below; infinity where that cannot be told. */
static double choose_limit(const sph__edge_queue *queue, const sph__connectivity *mesh)
{
    sph__keyed samples[SAMPLES];
    size_t count = 0, at;
    double least, limit;
    for (size_t i = 0; i < SAMPLES; ++i) {
        const double cost = mesh->edges[queue->waiting[i * queue->waiting_count / SAMPLES]].cost;
        if (!(cost >= queue->limit)) continue;
        memcpy(&samples[count].key, &cost, sizeof cost); /* in order, as they are not below 0 */
        samples[count++].item = i;
    }
    if (count == 0) return (double)INFINITY;
    sph__sort(samples, count);
    memcpy(&least, &samples[0].key, sizeof least);
    for (at = count / PART; at < count; ++at) {
        memcpy(&limit, &samples[at].key, sizeof limit);
        if (limit > least) return limit;
    }
    return (double)INFINITY;
}

/* Raises the limit, and puts those below it into the heap; drops what is no more from those that wait. */
static void fill_up(sph__edge_queue *queue, const sph__connectivity *mesh)
{
    const double before = queue->limit;
    size_t kept = 0;
    queue->all = queue->waiting_count <= MANY || isinf(before);
    queue->limit = queue->all ? (double)INFINITY : choose_limit(queue, mesh);
    for (size_t i = 0; i < queue->waiting_count; ++i) {
        const uint32_t edge = queue->waiting[i];
        const double cost = mesh->edges[edge].cost;
        queue->waiting[kept] = edge;
        kept += !(cost <= SPH__GONE);
        if (sph__edge_queue_sorts(queue, cost) && !(cost < before))
            sph__heap_append(&queue->open, edge, cost, tie_of(mesh, edge));
    }
    queue->waiting_count = kept;
    sph__heap_order(&queue->open);
}

bool sph__edge_queue_top(sph__edge_queue *queue, const sph__connectivity *mesh, uint32_t *edge)
{
    while (sph__heap_count(&queue->open) < FEWEST && !queue->all) fill_up(queue, mesh);
    return sph__heap_top(&queue->open, edge);
}

static bool touch(sph__edge_queue *queue, uint32_t node)
{
    const size_t before = queue->touched_capacity;
    if (!sph__reserve(queue->refused.context, (void **)&queue->touched, &queue->touched_capacity, (size_t)node + 1, 1))
        return false;
    memset(queue->touched + before, 0, queue->touched_capacity - before);
    queue->touched[node] = 1;
    return true;
}

sph_status sph__edge_queue_refuse(sph__edge_queue *queue, sph__connectivity *mesh, uint32_t edge, double cost)
{
    const uint32_t *ends = mesh->edges[edge].ends;
    const sph_status status = sph__heap_reserve(&queue->refused, mesh->edge_count); /* at once: it is by edge */
    if (status != SPH_OK) return status;
    if (!touch(queue, ends[0]) || !touch(queue, ends[1])) return sph__fail_memory(queue->refused.context);
    mesh->edges[edge].cost = SPH__REFUSED;
    return sph__heap_set(&queue->refused, edge, cost, tie_of(mesh, edge));
}

bool sph__edge_queue_pop_refused(sph__edge_queue *queue, uint32_t *edge)
{
    return sph__heap_pop(&queue->refused, edge);
}

void sph__edge_queue_forget(sph__edge_queue *queue, sph__connectivity *mesh)
{
    for (size_t i = 0; i < mesh->removed_count; ++i) sph__edge_queue_set(queue, mesh, mesh->removed[i], SPH__GONE);
}

static void readmit_around(sph__edge_queue *queue, sph__connectivity *mesh, uint32_t node)
{
    const uint32_t *edges = sph__edges_of(mesh, node);
    const uint32_t count = sph__edge_count_of(mesh, node);
    queue->touched[node] = 0;
    for (uint32_t i = 0; i < count; ++i)
        if (is_refused(&mesh->edges[edges[i]]))
            sph__edge_queue_set(queue, mesh, edges[i], sph__heap_key(&queue->refused, edges[i]));
}

void sph__edge_queue_readmit(sph__edge_queue *queue, sph__connectivity *mesh, uint32_t node)
{
    if (sph__heap_count(&queue->refused) == 0) return;
    for (uint32_t i = 0; i < sph__edge_count_of(mesh, node); ++i) {
        const uint32_t x = sph__edge_other(mesh, sph__edges_of(mesh, node)[i], node);
        if (x < queue->touched_capacity && queue->touched[x]) readmit_around(queue, mesh, x);
    }
}
