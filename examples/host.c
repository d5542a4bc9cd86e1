/* SPDX-License-Identifier: MIT */
/* An engine has memory that it counts and worker threads that it keeps busy: the library uses both, and nothing else.
 */
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

#include <sphmesh/io.h>

enum { WORKERS = 3 };

/* Memory: what the engine's own allocator would be, with a counter. Called from any thread. */
static void *take(void *user, size_t size, size_t alignment)
{
    void *memory = aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    if (memory != NULL) atomic_fetch_add((atomic_size_t *)user, size);
    return memory;
}

static void give_back(void *user, void *memory, size_t size)
{
    atomic_fetch_sub((atomic_size_t *)user, size);
    free(memory);
}

/* Jobs: one loop at a time, whose blocks the workers and the caller take in turn. All under the lock but the blocks. */
typedef struct jobs {
    pthread_mutex_t lock;
    pthread_cond_t wake, idle;
    sph_range_fn *body;
    void *argument;
    size_t count, grain, next, running, blocks;
    bool quit;
} jobs;

static void take_blocks(jobs *j)
{
    while (j->next < j->count) {
        const size_t begin = j->next, end = j->count - begin < j->grain ? j->count : begin + j->grain;
        j->next = end, ++j->running, ++j->blocks;
        pthread_mutex_unlock(&j->lock);
        j->body(j->argument, begin, end);
        pthread_mutex_lock(&j->lock);
        if (--j->running == 0) pthread_cond_signal(&j->idle);
    }
}

static void *worker(void *user)
{
    jobs *j = user;
    pthread_mutex_lock(&j->lock);
    for (take_blocks(j); !j->quit; take_blocks(j))
        pthread_cond_wait(&j->wake, &j->lock);
    return pthread_mutex_unlock(&j->lock), NULL;
}

static void parallel_for(void *user, size_t count, size_t grain, sph_range_fn *body, void *argument)
{
    jobs *j = user;
    pthread_mutex_lock(&j->lock);
    j->count = count, j->grain = grain, j->next = 0, j->body = body, j->argument = argument;
    pthread_cond_broadcast(&j->wake);
    for (take_blocks(j); j->running > 0;)
        pthread_cond_wait(&j->idle, &j->lock);
    pthread_mutex_unlock(&j->lock);
}

int main(int argc, char **argv)
{
    atomic_size_t bytes = 0;
    pthread_t threads[WORKERS];
    jobs j = {.lock = PTHREAD_MUTEX_INITIALIZER, .wake = PTHREAD_COND_INITIALIZER, .idle = PTHREAD_COND_INITIALIZER};
    sph_context *context = NULL;
    sph_animation *animation = NULL;
    sph_hierarchy *hierarchy = NULL;
    sph_context_options host;
    sph_io_open_options o;
    if (argc != 4) return fprintf(stderr, "usage: host MESH CACHE OUT.sphm\n"), 2;
    for (int i = 0; i < WORKERS; ++i)
        if (pthread_create(&threads[i], NULL, worker, &j) != 0) return 1;
    sph_context_options_init(&host, sizeof host);
    host.allocator = (sph_allocator){&bytes, take, give_back};
    host.executor = (sph_executor){&j, parallel_for};
    sph_io_open_options_init(&o, sizeof o);
    o.cache_path = argv[2];
    const bool done = sph_context_create(&host, &context) == SPH_OK &&
                      sph_io_open_animation(context, (const char *const *)&argv[1], 1, &o, &animation) == SPH_OK &&
                      sph_hierarchy_create(animation, NULL, &hierarchy) == SPH_OK &&
                      sph_io_save_hierarchy(context, hierarchy, argv[3]) == SPH_OK;
    if (!done) fprintf(stderr, "host: %s\n", sph_context_last_message(context));
    printf("%zu blocks of loops ran here; %zu bytes are in use\n", j.blocks, atomic_load(&bytes));
    sph_hierarchy_destroy(hierarchy), sph_animation_destroy(animation), sph_context_destroy(context);
    pthread_mutex_lock(&j.lock), j.quit = true, pthread_mutex_unlock(&j.lock), pthread_cond_broadcast(&j.wake);
    for (int i = 0; i < WORKERS; ++i)
        pthread_join(threads[i], NULL);
    return done && bytes == 0 ? 0 : 1; /* all memory has come back */
}
