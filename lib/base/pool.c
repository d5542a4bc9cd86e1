/* SPDX-License-Identifier: MIT */
/*
 * The built-in executor: threads that sleep until a loop comes, and claim its blocks one by one. A loop is over when
 * its blocks are claimed and those who joined it have left; threads that wake too late are not waited for.
 */
#include <pthread.h>
#include <signal.h>
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
    pthread_mutex_t busy;  /* held by the thread whose loop runs */
    pthread_mutex_t mutex; /* guards what follows up to `current` */
    pthread_cond_t wake, done;
    uint64_t generation; /* of the loop; grows by one for each */
    uint32_t joined;     /* workers in the current loop */
    bool open;           /* the current loop may be joined */
    bool stop;
    loop current;
    atomic_size_t next; /* first block that nobody has claimed */
    pthread_t threads[];
};

static size_t block_count(const loop *l)
{
    return l->count / l->grain + (l->count % l->grain != 0);
}

static void run_block(const loop *l, size_t block)
{
    const size_t begin = block * l->grain;
    l->body(l->argument, begin, l->count - begin < l->grain ? l->count : begin + l->grain);
}

static void run_blocks(sph__pool *pool, const loop *l)
{
    const size_t blocks = block_count(l);
    for (;;) {
        const size_t block = atomic_fetch_add_explicit(&pool->next, 1, memory_order_relaxed);
        if (block >= blocks) return;
        run_block(l, block);
    }
}

static void *worker(void *argument)
{
    sph__pool *pool = argument;
    uint64_t seen = 0;
    pthread_mutex_lock(&pool->mutex);
    for (;;) {
        loop l;
        while (!pool->stop && !(pool->open && pool->generation != seen))
            pthread_cond_wait(&pool->wake, &pool->mutex);
        if (pool->stop) break;
        seen = pool->generation;
        l = pool->current;
        ++pool->joined;
        pthread_mutex_unlock(&pool->mutex);
        run_blocks(pool, &l);
        pthread_mutex_lock(&pool->mutex);
        if (--pool->joined == 0) pthread_cond_signal(&pool->done);
    }
    pthread_mutex_unlock(&pool->mutex);
    return NULL;
}

/* The host's signals are handled by the host's threads. */
static void start_threads(sph__pool *pool, uint32_t thread_count)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    for (uint32_t i = 0; i < thread_count; ++i) {
        if (pthread_create(&pool->threads[i], NULL, worker, pool) != 0) break;
        pool->thread_count = i + 1; /* fewer threads do: results do not depend on their number */
    }
    pthread_sigmask(SIG_SETMASK, &before, NULL);
}

sph__pool *sph__pool_create(const sph_allocator *allocator, uint32_t thread_count)
{
    const size_t size = sizeof(sph__pool) + thread_count * sizeof(pthread_t);
    sph__pool *pool = allocator->allocate(allocator->user, size, SPH__ALIGN);
    if (pool == NULL) return NULL;
    memset(pool, 0, size);
    pool->allocator = *allocator;
    pool->allocated_size = size;
    atomic_init(&pool->next, 0);
    if (pthread_mutex_init(&pool->busy, NULL) != 0 || pthread_mutex_init(&pool->mutex, NULL) != 0 ||
        pthread_cond_init(&pool->wake, NULL) != 0 || pthread_cond_init(&pool->done, NULL) != 0) {
        allocator->release(allocator->user, pool, size);
        return NULL;
    }
    start_threads(pool, thread_count);
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
    for (uint32_t i = 0; i < pool->thread_count; ++i)
        pthread_join(pool->threads[i], NULL);
    pthread_cond_destroy(&pool->done);
    pthread_cond_destroy(&pool->wake);
    pthread_mutex_destroy(&pool->mutex);
    pthread_mutex_destroy(&pool->busy);
    allocator = pool->allocator;
    allocator.release(allocator.user, pool, pool->allocated_size);
}

static void open_loop(sph__pool *pool, const loop *l)
{
    pthread_mutex_lock(&pool->mutex);
    pool->current = *l;
    atomic_store_explicit(&pool->next, 0, memory_order_relaxed);
    ++pool->generation;
    pool->open = true;
    if (block_count(l) > pool->thread_count)
        pthread_cond_broadcast(&pool->wake);
    else
        for (size_t i = 1; i < block_count(l); ++i)
            pthread_cond_signal(&pool->wake);
    pthread_mutex_unlock(&pool->mutex);
}

static void close_loop(sph__pool *pool)
{
    pthread_mutex_lock(&pool->mutex);
    pool->open = false;
    while (pool->joined != 0)
        pthread_cond_wait(&pool->done, &pool->mutex);
    pthread_mutex_unlock(&pool->mutex);
}

void sph__pool_parallel_for(void *user, size_t count, size_t grain, sph_range_fn *body, void *argument)
{
    sph__pool *pool = user;
    const loop l = {body, argument, count, grain};
    if (pthread_mutex_trylock(&pool->busy) != 0) { /* another thread's loop, or a loop within a loop */
        for (size_t block = 0; block < block_count(&l); ++block)
            run_block(&l, block);
        return;
    }
    open_loop(pool, &l);
    run_blocks(pool, &l);
    close_loop(pool);
    pthread_mutex_unlock(&pool->busy);
}
