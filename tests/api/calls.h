/* SPDX-License-Identifier: MIT */
/* What the generated calls are made of. */
#ifndef SPH_TEST_CALLS_H
#define SPH_TEST_CALLS_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sphmesh/io.h>
#include <sphmesh/sphmesh.h>

#define CHECK(condition)                                                                                               \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            fprintf(stderr, "%s: not so: %s\n", __func__, #condition);                                                 \
            abort();                                                                                                   \
        }                                                                                                              \
    } while (0)

/* One good handle of each kind. */
typedef struct api_fixture {
    sph_context *context;
    sph_animation *animation;
    sph_quadric *quadric;
    sph_hierarchy *hierarchy;
    sph_cursor *cursor;
    sph_level *level;
    sph_query *query;
    sph_surface *surface;
    sph_skin *skin;
    sph_skeleton *skeleton;
    sph_deformer *deformer;
    sph_progressive *progressive;
    sph_implicit *implicit;
    sph_tracker *tracker;
} api_fixture;
extern api_fixture fixture;

/* A call of one public function with arguments picked by the random state. */
typedef struct api_call {
    const char *name;
    void (*run)(uint64_t *random);
} api_call;
extern const api_call API_CALLS[];
extern const size_t API_CALL_COUNT;

uint32_t pick(uint64_t *random, uint32_t below);
size_t small(uint64_t *random);
size_t odd_stride(uint64_t *random);
uint32_t odd_uint32(uint64_t *random);
int32_t odd_int32(uint64_t *random);
double odd_number(uint64_t *random);
/* A path, a name, or NULL. */
const char *text(uint64_t *random);
/* Four of them. */
const char **names(uint64_t *random);
/* A megabyte of zeros, or of small numbers and some that are odd; another one in each of eight calls. */
void *scratch(uint64_t *random);
/* Zeroed memory for a struct, which nothing else uses until many more have been asked for. */
void *room(size_t size);

#endif
