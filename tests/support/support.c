/* SPDX-License-Identifier: MIT */
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support.h"

void *test_malloc(size_t count, size_t size)
{
    void *memory = calloc(count > 0 ? count : 1, size > 0 ? size : 1);
    if (memory == NULL) {
        fprintf(stderr, "test: out of memory\n");
        abort();
    }
    return memory;
}

/* --- contexts --- */

static sph_context *make_context(const sph_context_options *options)
{
    sph_context *context;
    return sph_context_create(options, &context) == SPH_OK ? context : NULL;
}

sph_context *test_context(void)
{
    return make_context(NULL);
}

sph_context *test_context_with_threads(uint32_t thread_count)
{
    sph_context_options options;
    sph_context_options_init(&options, sizeof options);
    options.thread_count = thread_count;
    return make_context(&options);
}

sph_context *test_context_with_allocator(const sph_allocator *allocator)
{
    sph_context_options options;
    sph_context_options_init(&options, sizeof options);
    options.allocator = *allocator;
    return make_context(&options);
}

sph_context *test_context_with_executor(const sph_executor *executor)
{
    sph_context_options options;
    sph_context_options_init(&options, sizeof options);
    options.executor = *executor;
    return make_context(&options);
}

sph_context *test_context_with_progress(sph_progress_fn *progress, void *user)
{
    sph_context_options options;
    sph_context_options_init(&options, sizeof options);
    options.progress = progress;
    options.progress_user = user;
    return make_context(&options);
}

/* --- the allocator --- */

enum { HEADER = 64 };
static const uint64_t ALIVE = 0x616c697665626c6bu;

typedef struct block_header {
    uint64_t mark;
    size_t size;
} block_header;
_Static_assert(sizeof(block_header) <= HEADER, "the header fits in front of an aligned block");

static void lock(test_faulty *f)
{
    while (__atomic_test_and_set(&f->lock, __ATOMIC_ACQUIRE))
        continue;
}

static void unlock(test_faulty *f)
{
    __atomic_clear(&f->lock, __ATOMIC_RELEASE);
}

static void *faulty_allocate(void *user, size_t size, size_t alignment)
{
    test_faulty *f = user;
    const block_header header = {ALIVE, size};
    void *memory = NULL;
    bool fails;
    lock(f);
    ++f->calls;
    fails = f->fail_at != 0 && (f->calls == f->fail_at || (f->sticky && f->calls > f->fail_at));
    if (size == 0 || alignment > HEADER || (alignment & (alignment - 1)) != 0) f->misused = true;
    if (!fails && size <= SIZE_MAX / 2 && posix_memalign(&memory, HEADER, size + HEADER) == 0) {
        ++f->live_blocks;
        f->live_bytes += size;
        if (f->live_bytes > f->peak_bytes) f->peak_bytes = f->live_bytes;
    } else {
        memory = NULL;
    }
    unlock(f);
    if (memory == NULL) return NULL;
    memset(memory, 0xa5, size + HEADER); /* nobody may count on zeros */
    memcpy(memory, &header, sizeof header);
    return (char *)memory + HEADER;
}

static void faulty_release(void *user, void *memory, size_t size)
{
    test_faulty *f = user;
    char *start = memory == NULL ? NULL : (char *)memory - HEADER;
    block_header header = {0, 0};
    if (start != NULL) memcpy(&header, start, sizeof header);
    lock(f);
    if (header.mark != ALIVE || header.size != size) {
        f->misused = true;
    } else {
        --f->live_blocks;
        f->live_bytes -= size;
    }
    unlock(f);
    if (header.mark != ALIVE) return;
    memset(start, 0x5a, header.size + HEADER);
    free(start);
}

sph_allocator test_faulty_allocator(test_faulty *faulty)
{
    return (sph_allocator){faulty, faulty_allocate, faulty_release};
}

/* --- executors --- */

static void run_block(size_t block, size_t count, size_t grain, sph_range_fn *body, void *argument)
{
    const size_t begin = block * grain;
    body(argument, begin, count - begin < grain ? count : begin + grain);
}

static size_t block_count(size_t count, size_t grain)
{
    return count / grain + (count % grain != 0);
}

static void reverse_for(void *user, size_t count, size_t grain, sph_range_fn *body, void *argument)
{
    (void)user;
    for (size_t b = block_count(count, grain); b-- > 0;)
        run_block(b, count, grain, body, argument);
}

static void scattered_for(void *user, size_t count, size_t grain, sph_range_fn *body, void *argument)
{
    const size_t blocks = block_count(count, grain);
    (void)user;
    for (size_t phase = 7; phase-- > 0;)
        for (size_t b = phase; b < blocks; b += 7)
            run_block(b, count, grain, body, argument);
}

typedef struct stripe {
    size_t first, count, grain;
    sph_range_fn *body;
    void *argument;
} stripe;

enum { STRIPES = 4 };

static void *run_stripe(void *argument)
{
    const stripe *s = argument;
    for (size_t b = s->first; b < block_count(s->count, s->grain); b += STRIPES)
        run_block(b, s->count, s->grain, s->body, s->argument);
    return NULL;
}

static void threads_for(void *user, size_t count, size_t grain, sph_range_fn *body, void *argument)
{
    pthread_t threads[STRIPES];
    stripe stripes[STRIPES];
    (void)user;
    for (size_t i = 0; i < STRIPES; ++i) {
        stripes[i] = (stripe){i, count, grain, body, argument};
        if (pthread_create(&threads[i], NULL, run_stripe, &stripes[i]) != 0) abort();
    }
    for (size_t i = 0; i < STRIPES; ++i)
        pthread_join(threads[i], NULL);
}

sph_executor test_executor_reverse(void)
{
    return (sph_executor){NULL, reverse_for};
}

sph_executor test_executor_scattered(void)
{
    return (sph_executor){NULL, scattered_for};
}

sph_executor test_executor_threads(void)
{
    return (sph_executor){NULL, threads_for};
}

/* --- progress --- */

bool test_progress_callback(void *user, const char *stage, double fraction)
{
    test_progress *p = user;
    ++p->calls;
    if (stage == NULL || !(fraction >= p->last && fraction <= 1)) p->fell = true;
    p->last = fraction;
    return p->cancel_at == 0 || p->calls < p->cancel_at;
}

/* --- numbers: splitmix64 --- */

uint64_t test_random(uint64_t *state)
{
    uint64_t x = (*state += 0x9e3779b97f4a7c15u);
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

double test_random_unit(uint64_t *state)
{
    return (double)(test_random(state) >> 11) * 0x1p-53;
}

double test_random_between(uint64_t *state, double low, double high)
{
    return low + (high - low) * test_random_unit(state);
}

/* --- the frame source --- */

static sph_status source_read(void *user, uint32_t frame, float *xyz)
{
    test_source *s = user;
    if (++s->reads == s->fail_at) return s->failure;
    return sph_animation_read_frame(s->from, frame, xyz);
}

static void source_destroy(void *user)
{
    ++((test_source *)user)->destroys;
}

sph_frame_source test_frame_source(test_source *source)
{
    return (sph_frame_source){source, source_read, source_destroy};
}

sph_animation *test_pulled(sph_context *context, test_source *source)
{
    const sph_frame_source frames = test_frame_source(source);
    const sph_animation *from = source->from;
    sph_animation *animation;
    if (sph_animation_create_from_source(context, sph_animation_vertex_count(from), sph_animation_frame_count(from),
                                         &frames, &animation) != SPH_OK)
        return NULL;
    if (sph_animation_set_triangles(animation, sph_animation_triangles(from), sph_animation_triangle_count(from), 0) ==
            SPH_OK &&
        sph_animation_set_edges(animation, sph_animation_edges(from), sph_animation_edge_count(from), 0) == SPH_OK)
        return animation;
    sph_animation_destroy(animation);
    return NULL;
}
