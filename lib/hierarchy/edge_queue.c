/* SPDX-License-Identifier: MIT */
#include "hierarchy/edge_queue.h"

void sph__edge_queue_init(sph__edge_queue *queue, sph_context *context)
{
    sph__heap_init(&queue->open, context);
    sph__heap_init(&queue->refused, context);
    queue->touched = NULL;
    queue->touched_capacity = 0;
}

void sph__edge_queue_free(sph__edge_queue *queue)
{
    sph__heap_free(&queue->open);
    sph__free(queue->refused.context, queue->touched);
    queue->touched = NULL;
    queue->touched_capacity = 0;
    sph__heap_free(&queue->refused);
}

sph_status sph__edge_queue_set(sph__edge_queue *queue, const sph__connectivity *mesh, uint32_t edge, double cost)
{
    sph__heap_remove(&queue->refused, edge);
    return sph__heap_set(&queue->open, edge, cost, sph__edge_tie(mesh, edge));
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

sph_status sph__edge_queue_refuse(sph__edge_queue *queue, const sph__connectivity *mesh, uint32_t edge, double cost)
{
    const uint32_t *ends = mesh->edges[edge];
    if (!touch(queue, ends[0]) || !touch(queue, ends[1])) return sph__fail_memory(queue->refused.context);
    return sph__heap_set(&queue->refused, edge, cost, sph__edge_tie(mesh, edge));
}

void sph__edge_queue_forget(sph__edge_queue *queue, const sph__connectivity *mesh)
{
    for (size_t i = 0; i < mesh->removed_count; ++i) {
        sph__heap_remove(&queue->open, mesh->removed[i]);
        sph__heap_remove(&queue->refused, mesh->removed[i]);
    }
}

static sph_status readmit_around(sph__edge_queue *queue, const sph__connectivity *mesh, uint32_t node)
{
    const uint32_t *edges = sph__list_items(&mesh->node_edges, node);
    const uint32_t count = sph__list_count(&mesh->node_edges, node);
    queue->touched[node] = 0;
    for (uint32_t i = 0; i < count; ++i) {
        sph_status status;
        if (!sph__heap_contains(&queue->refused, edges[i])) continue;
        status = sph__edge_queue_set(queue, mesh, edges[i], sph__heap_key(&queue->refused, edges[i]));
        if (status != SPH_OK) return status;
    }
    return SPH_OK;
}

sph_status sph__edge_queue_readmit(sph__edge_queue *queue, const sph__connectivity *mesh, uint32_t node)
{
    sph_status status = SPH_OK;
    if (sph__heap_count(&queue->refused) == 0) return SPH_OK;
    for (uint32_t i = 0; i < sph__list_count(&mesh->node_edges, node) && status == SPH_OK; ++i) {
        const uint32_t x = sph__edge_other(mesh, sph__list_items(&mesh->node_edges, node)[i], node);
        if (x < queue->touched_capacity && queue->touched[x]) status = readmit_around(queue, mesh, x);
    }
    return status;
}
