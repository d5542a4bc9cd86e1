/* SPDX-License-Identifier: MIT */
/* Internal door of the room "implicit": fields of parts, operators, and the set-up laid open. */
#ifndef SPH_IMPLICIT_INTERNAL_H
#define SPH_IMPLICIT_INTERNAL_H

#include <sphmesh/implicit.h>

#include "base/base.h"

/* Points that are evaluated together: a constant of the layout, a multiple of every vector. */
enum { SPH__IMPLICIT_BLOCK = 64 };
#define SPH__NO_PART UINT32_MAX
#define SPH__UNION_THETA 0.78539816339744831 /* pi / 4 */

/* The field of a bone's part, in the rest pose. */
typedef struct sph__field {
    uint32_t vertex_count;
    uint32_t count, closing_count; /* of centres; 0: there is no field */
    double radius;
    double low[3], high[3];
    double origin[3], scale; /* centres and coefficients are those of (x - origin) / scale */
    double *samples;         /* [m][3], model units */
    double *normals;         /* [m][3] */
    double *centers;         /* [m][8]: centre, lambda, beta, 0 */
    float *table;            /* [size]^3 of distance (in units of `scale`), gradient; x runs fastest */
    double cell[3];          /* cells per model unit */
    uint32_t table_size;
} sph__field;

/* A field in a pose. */
typedef struct sph__placed {
    double inverse[12]; /* pose to rest */
    bool live;
} sph__placed;

/* Values and gradients of a block's points. */
typedef struct sph__values {
    double f[SPH__IMPLICIT_BLOCK], x[SPH__IMPLICIT_BLOCK], y[SPH__IMPLICIT_BLOCK], z[SPH__IMPLICIT_BLOCK];
} sph__values;

typedef struct sph__points {
    double x[SPH__IMPLICIT_BLOCK] __attribute__((aligned(64)));
    double y[SPH__IMPLICIT_BLOCK], z[SPH__IMPLICIT_BLOCK];
} sph__points;

/* An operator on a grid of [theta][f2][f1]. */
typedef struct sph__operator_table {
    int32_t operation;
    double strength;
    uint32_t size;
    float *values;
} sph__operator_table;

enum { SPH__CURVE_SIZE = 257 };

typedef struct sph__joint {
    sph_implicit_joint given;
    float curve[SPH__CURVE_SIZE]; /* theta over the angle, 0 to pi */
    uint32_t table;               /* index of the operator's; SPH__NO_PART: none yet */
} sph__joint;

struct sph_implicit {
    sph_context *context; /* retained */
    uint32_t bone_count, joint_count, table_count;
    uint32_t table_size, operator_table_size;
    sph__field *fields;          /* [J] */
    sph__joint *joints;          /* [joint_count] */
    sph__operator_table *tables; /* [table_count], at most one per joint */
};

/* --- implicit.c --- */
sph_status sph__implicit_allocate(sph_context *context, uint32_t bone_count, uint32_t joint_count, sph_implicit **out);
sph_status sph__joint_check(const sph_context *context, const sph_implicit_joint *joint, uint32_t bone_count,
                            const char *what, size_t index);
/* Makes the tables of fields, of curves, and of the operators in use. */
sph_status sph__implicit_tabulate(sph_implicit *implicit);
/* A copy for a tracker, with tables of its own. */
sph_status sph__implicit_copy(const sph_implicit *implicit, sph_implicit **out);

/* --- fit.c: coefficients from samples and normals; false where there are none --- */
bool sph__field_fit(const sph_context *context, sph__field *field, bool *out_of_memory);

/* --- tables.c --- */
sph_status sph__field_tabulate(const sph_context *context, sph__field *field, uint32_t size);
sph_status sph__joint_tabulate(sph_implicit *implicit, sph__joint *joint);

/* --- operation.c --- */
double sph__curve_at(const sph_theta_curve *curve, double alpha);
double sph__compose(int32_t operation, double strength, double theta, double f1, double f2, double slopes[2]);

/* --- kernel.c: `count` is rounded up to eight; points beyond it must be finite --- */
void sph__field_exact(const sph__field *field, const sph__placed *placed, size_t count, const sph__points *points,
                      sph__values *out);
void sph__field_table(const sph__field *field, const sph__placed *placed, size_t count, const sph__points *points,
                      sph__values *out);
/* Eight points (three rows), or distances and gradients (four). */
typedef struct sph__eight {
    double rows[4][8] __attribute__((aligned(64)));
} sph__eight;
/* Distances and gradients, model units, without the clamp to the support; of one point too. */
void sph__field_distances(const sph__field *field, const sph__eight *points, sph__eight *out);
void sph__field_distance(const sph__field *field, const double point[3], double *distance, double gradient[3]);

/* --- compose.c --- */
void sph__place_fields(const sph_implicit *implicit, const double *transforms, sph__placed *placed);
/* The composed field at a block's points; `bones` are whose field is the largest. */
void sph__compose_block(const sph_implicit *implicit, const sph__placed *placed, int32_t evaluation, size_t count,
                        sph__points *points, sph__values *out, uint32_t bones[SPH__IMPLICIT_BLOCK]);

#endif
