/* SPDX-License-Identifier: MIT */
#include "hierarchy/edge_queue.h"

void sph__edge_queue_init(sph__edge_queue *queue, sph_context *context)
{
    sph__heap_init(&queue->open, context);
    sph__heap_init(&queue->refused, context);
}

void sph__edge_queue_free(sph__edge_queue *queue)
{
    sph__heap_free(&queue->open);
    sph__heap_free(&queue->refused);
}

sph_status sph__edge_queue_set(sph__edge_queue *queue, const sph__connectivity *mesh, uint32_t edge, double cost)
{
    sph__heap_remove(&queue->refused, edge);
    return sph__heap_set(&queue->open, edge, cost, sph__edge_tie(mesh, edge));
}

sph_status sph__edge_queue_refuse(sph__edge_queue *queue, const sph__connectivity *mesh, uint32_t edge, double cost)
{
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
    for (uint32_t i = 0; i < sph__list_count(&mesh->node_edges, node) && status == SPH_OK; ++i)
        status = readmit_around(queue, mesh,
                                sph__edge_other(mesh, sph__list_items(&mesh->node_edges, node)[i], node));
    return status;
}
