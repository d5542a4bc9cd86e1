/* SPDX-License-Identifier: MIT */
/*
 * What the tests share: contexts, an allocator that fails, executors that run blocks in odd orders, and meshes whose
 * shape is known. Public API only. The test program is aborted when the test's own memory runs out; failures of the
 * library are handed on: a function that makes a handle returns NULL then, so that it can be used while allocations
 * fail.
 */
#ifndef SPH_TEST_SUPPORT_H
#define SPH_TEST_SUPPORT_H

#include <sphmesh/sphmesh.h>

/* --- contexts --- */

/* All defaults. */
sph_context *test_context(void);
/* The built-in executor with so many threads. */
sph_context *test_context_with_threads(uint32_t thread_count);
sph_context *test_context_with_allocator(const sph_allocator *allocator);
sph_context *test_context_with_executor(const sph_executor *executor);
sph_context *test_context_with_progress(sph_progress_fn *progress, void *user);

/* --- memory of the test program itself --- */
void *test_malloc(size_t count, size_t size);

/* --- an allocator that counts, checks what it is given back, and fails on request --- */
typedef struct test_faulty {
    size_t fail_at;     /* fails allocation 1, 2, 3 ...; 0: none */
    bool sticky;        /* fails from there on */
    size_t calls;       /* allocations asked for */
    size_t live_blocks; /* handed out and not given back */
    size_t live_bytes, peak_bytes;
    bool misused; /* a block came back with another size, or twice */
    unsigned char lock;
} test_faulty;
/* `faulty` must outlive the allocator's users. */
sph_allocator test_faulty_allocator(test_faulty *faulty);

/* --- executors --- */
/* Blocks from last to first, on the calling thread. */
sph_executor test_executor_reverse(void);
/* Blocks in a scattered order, on the calling thread. */
sph_executor test_executor_scattered(void);
/* Each of four new threads takes every fourth block. */
sph_executor test_executor_threads(void);

/* --- progress: pass a test_progress to test_progress_callback --- */
typedef struct test_progress {
    size_t calls;
    size_t cancel_at; /* answers false at call 1, 2, 3 ...; 0: never */
    double last;      /* set to 0 before each library call */
    bool fell;        /* a fraction was lower than the one before, or out of [0, 1] */
} test_progress;
bool test_progress_callback(void *test_progress, const char *stage, double fraction);

/* --- numbers --- */
/* A good 64-bit sequence, the same everywhere. */
uint64_t test_random(uint64_t *state);
/* In [0, 1). */
double test_random_unit(uint64_t *state);
/* In [low, high). */
double test_random_between(uint64_t *state, double low, double high);

/*
 * --- meshes --- Outward triangles. Frame 0 is the shape as described; frame f is test_wave() of it. All start with at
 * least one frame.
 */
/* Bends a point of the rest shape for frame f of `frames`; frame 0 leaves it alone. */
void test_wave(const float rest[3], unsigned frame, unsigned frames, float bent[3]);
/* An animation by the wave of any rest shape. `triangles` may be NULL where there are none. */
sph_animation *test_animation(sph_context *context, const float *rest, uint32_t n, const uint32_t *triangles,
                              size_t triangle_count, unsigned frames);
/* [-1, 1]^3: 8 vertices, 12 triangles. */
sph_animation *test_cube(sph_context *context, unsigned frames);
/* An icosahedron on the unit sphere, subdivided so many times: 10 * 4^s + 2 vertices, 20 * 4^s triangles. */
sph_animation *test_sphere(sph_context *context, unsigned subdivisions, unsigned frames);
/* Around the z axis, radii 1 and 0.4: rings * sides vertices, twice as many triangles; both at least 3. */
sph_animation *test_torus(sph_context *context, unsigned rings, unsigned sides, unsigned frames);
/* Flat in z = 0, open, facing +z: columns * rows unit squares, two triangles each. With one row it is a strip. */
sph_animation *test_grid(sph_context *context, unsigned columns, unsigned rows, unsigned frames);
/* Random points of the unit cube; triangles of three different random vertices, with no further order among them. */
sph_animation *test_soup(sph_context *context, uint32_t n, size_t triangle_count, unsigned frames, uint64_t seed);

/* --- a frame source that reads from another animation, counts, and fails on request --- */
typedef struct test_source {
    const sph_animation *from; /* must outlive the source */
    size_t reads, destroys;
    size_t fail_at; /* read 1, 2, 3 ... returns `failure`; 0: none */
    sph_status failure;
} test_source;
sph_frame_source test_frame_source(test_source *source);
/* An animation with the counts and topology of source->from that pulls its frames from it. */
sph_animation *test_pulled(sph_context *context, test_source *source);

#endif
