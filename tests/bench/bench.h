/* SPDX-License-Identifier: MIT */
/* What the parts of bench_build share: options, clocks, the report, and animations to measure on. */
#ifndef SPH_BENCH_H
#define SPH_BENCH_H

#include <sphmesh/io.h>

typedef struct bench_options {
    bool json, markdown, tiny;
    uint32_t repeats;   /* medians are of so many runs */
    const char *data;   /* the folder of real data, or NULL */
    const char *folder; /* of temporary files, or NULL */
    const char *only;   /* the one section to run, or NULL */
    const char *self;   /* how to start this program again */
} bench_options;

extern bench_options bench;

/* --- report.c --- */
void bench_begin(void);
void bench_end(void);
/* A part of the table; false where --only names another. */
bool bench_section(const char *name, const char *title);
/* One figure. `relation` is '<' or '>' where there is a target, else 0. A value that is NaN could not be measured. */
void bench_figure(const char *key, double value, const char *unit, char relation, double target);
/* Something left out, or to be known. */
void bench_note(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* Tells and exits: there is no point in going on. */
void bench_die(const sph_context *context, const char *what) __attribute__((noreturn));

/* --- clock.c --- */
double bench_wall(void);
double bench_processor(void);                      /* of all threads of the process */
double bench_median(double *values, size_t count); /* sorts them */
uint64_t bench_random(uint64_t *state);
/* The most memory that this process has had resident, in bytes; 0 where it cannot be told. */
double bench_peak_resident(void);

/* --- shapes.c: animations that everybody can make again --- */
typedef struct bench_shape {
    uint32_t rings, sides, frames;
} bench_shape;

/* A torus of rings * sides vertices with bumps that bends and breathes; pulled frame by frame, so that nothing holds
 * its input. */
sph_animation *bench_torus(sph_context *context, bench_shape shape);
/* Near to n vertices. */
bench_shape bench_shape_of(uint32_t n, uint32_t frames);
/* Samba from the data folder; NULL where it is not there. */
sph_animation *bench_samba(sph_context *context);
/* Samba, or a torus of its size; *name says which. */
sph_animation *bench_samba_or_torus(sph_context *context, const char **name);

/* --- building --- */
typedef struct bench_times {
    double wall, processor; /* seconds of the whole */
    double init, decimate;  /* processor time of the parts */
} bench_times;

sph_context *bench_context(uint32_t threads);
/* Frames are pulled ahead of the clock: `animation` is copied into memory where it is not yet. */
sph_animation *bench_hold(sph_context *context, const sph_animation *animation);
sph_hierarchy *bench_hierarchy(const sph_animation *animation, bench_times *times);
/* A hash of what sph_hierarchy_write gives. */
uint64_t bench_hash(const sph_hierarchy *hierarchy);

/* --- the rows --- */
void bench_rows_samba(void);
void bench_rows_static(void);
void bench_rows_growth(void);
void bench_rows_threads(void);
void bench_rows_memory(void);
void bench_rows_levels(void);
/* One build in a process of its own, for bench_rows_memory. */
int bench_child(const char *input, const char *limit);

#endif
