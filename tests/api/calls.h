/* SPDX-License-Identifier: MIT */
/* What the generated calls are made of. */
#ifndef SPH_TEST_CALLS_H
#define SPH_TEST_CALLS_H

#include <check.h>
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
    sph_io_rig *io_rig;     /* NULL but where a call is about rigs or handles */
    sph_io_rig_levels *io_rig_levels;
    sph_io_spill *io_spill; /* NULL but where a call is about handles */
} api_fixture;
extern api_fixture fixture;
extern bool api_files_are_there; /* texts are names of files that can be read */
void api_make_context(void);
void api_make_handles(void);      /* all but the last three, with fixture.context */
void api_make_file_handles(void); /* and these */
void api_destroy_handles(void);   /* all but the context */
void api_make_scratches(void);
void api_free_scratches(void);

/* A call of one public function with arguments picked by the random state. */
typedef struct api_call {
    const char *name;
    sph_status (*run)(uint64_t *random); /* SPH_OK of those without a status */
} api_call;
extern const api_call API_CALLS[];
extern const size_t API_CALL_COUNT;

/* A call with anything for one handle: what comes of it. */
typedef struct api_foreign_call {
    const char *name;
    const char *kind; /* of the handle: a field of api_fixture */
    bool has_status;
    sph_status (*run)(uint64_t *random, void *handle);
} api_foreign_call;
extern const api_foreign_call API_FOREIGN_CALLS[];
extern const size_t API_FOREIGN_CALL_COUNT;

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
/* 128 kB of zeros, more than any counts here ask for, or of small numbers and some that are odd; another one in each of eight calls. */
void *scratch(uint64_t *random);
/* Zeroed memory for a struct, which nothing else uses until many more have been asked for. */
void *room(size_t size);

/* --- test_failures.c --- */
void api_add_failure_tests(TCase *tc);

/* --- test_foreign.c --- */
void api_add_foreign_tests(TCase *tc);

#endif
