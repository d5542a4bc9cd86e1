/* SPDX-License-Identifier: MIT */
/* The built-in executor: threads that sleep until a loop comes, and claim its blocks one by one. */
#include <pthread.h>
#include <stdatomic.h>

#include "base/base.h"

typedef struct loop {
    sph_range_fn *body;
    void *argument;
    size_t count, grain;
} loop;

struct sph__pool {
    sph_allocator allocator;
    size_t allocated_size;
    uint32_t thread_count;
    pthread_mutex_t busy; /* held by the thread whose loop runs */
    pthread_mutex_t mutex;
    pthread_cond_t wake, done;
    uint64_t generation; /* of the loop; grows by one for each */
    uint32_t running;    /* workers that have not finished the current loop */
    bool stop;
    loop current;
    atomic_size_t next; /* first item that nobody has claimed */
    pthread_t threads[];
};

static void run_blocks(sph__pool *pool, const loop *l)
{
    for (;;) {
        const size_t begin = atomic_fetch_add_explicit(&pool->next, l->grain, memory_order_relaxed);
        if (begin >= l->count) return;
        l->body(l->argument, begin, l->count - begin < l->grain ? l->count : begin + l->grain);
    }
}

static void *worker(void *argument)
{
    sph__pool *pool = argument;
    uint64_t seen = 0;
    pthread_mutex_lock(&pool->mutex);
    for (;;) {
        loop l;
        while (!pool->stop && pool->generation == seen) pthread_cond_wait(&pool->wake, &pool->mutex);
        if (pool->stop) break;
        seen = pool->generation;
        l = pool->current;
        pthread_mutex_unlock(&pool->mutex);
        run_blocks(pool, &l);
        pthread_mutex_lock(&pool->mutex);
        if (--pool->running == 0) pthread_cond_signal(&pool->done);
    }
    pthread_mutex_unlock(&pool->mutex);
    return NULL;
}

sph__pool *sph__pool_create(const sph_allocator *allocator, uint32_t thread_count)
{
    const size_t size = sizeof(sph__pool) + thread_count * sizeof(pthread_t);
    sph__pool *pool = allocator->allocate(allocator->user, size, SPH__ALIGN);
    if (pool == NULL) return NULL;
    memset(pool, 0, size);
    pool->allocator = *allocator;
    pool->allocated_size = size;
    pool->thread_count = thread_count;
    atomic_init(&pool->next, 0);
    pthread_mutex_init(&pool->busy, NULL);
    pthread_mutex_init(&pool->mutex, NULL);
    pthread_cond_init(&pool->wake, NULL);
    pthread_cond_init(&pool->done, NULL);
    for (uint32_t i = 0; i < thread_count; ++i)
        if (pthread_create(&pool->threads[i], NULL, worker, pool) != 0) {
            pool->thread_count = i; /* fewer threads do: results do not depend on their number */
            break;
        }
    return pool;
}

void sph__pool_destroy(sph__pool *pool)
{
    sph_allocator allocator;
    if (pool == NULL) return;
    pthread_mutex_lock(&pool->mutex);
    pool->stop = true;
    pthread_cond_broadcast(&pool->wake);
    pthread_mutex_unlock(&pool->mutex);
    for (uint32_t i = 0; i < pool->thread_count; ++i) pthread_join(pool->threads[i], NULL);
    pthread_cond_destroy(&pool->done);
    pthread_cond_destroy(&pool->wake);
    pthread_mutex_destroy(&pool->mutex);
    pthread_mutex_destroy(&pool->busy);
    allocator = pool->allocator;
    allocator.release(allocator.user, pool, pool->allocated_size);
}

void sph__pool_parallel_for(void *user, size_t count, size_t grain, sph_range_fn *body, void *argument)
{
    sph__pool *pool = user;
    const loop l = {body, argument, count, grain};
    if (pthread_mutex_trylock(&pool->busy) != 0) { /* another thread's loop, or a loop within a loop */
        for (size_t begin = 0; begin < count; begin += grain)
            body(argument, begin, count - begin < grain ? count : begin + grain);
        return;
    }
    pthread_mutex_lock(&pool->mutex);
    pool->current = l;
    atomic_store_explicit(&pool->next, 0, memory_order_relaxed);
    pool->running = pool->thread_count;
    ++pool->generation;
    pthread_cond_broadcast(&pool->wake);
    pthread_mutex_unlock(&pool->mutex);
    run_blocks(pool, &l);
    pthread_mutex_lock(&pool->mutex);
    while (pool->running != 0) pthread_cond_wait(&pool->done, &pool->mutex);
    pthread_mutex_unlock(&pool->mutex);
    pthread_mutex_unlock(&pool->busy);
}
