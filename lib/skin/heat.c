/* SPDX-License-Identifier: MIT */
#include "skin/heat.h"

#include <math.h>

#include "numeric/vector.h"
#include "skin/visible.h"

enum { L = SPH__HEAT_LANES, TRIES = 16 /* bones that a vertex looks for */, ROUNDS = 2000, GRAIN = 64 };

static const double RESIDUAL = 1e-7, SAME_DISTANCE = 1.0001, MOST_COTANGENT = 1e4;

/* Where the heat of a vertex goes: at once the nearest bones that it sees. */
typedef struct sink {
    double rate; /* area over squared distance */
    uint32_t count, bones[4];
} sink;

typedef struct heat_job {
    const sph__heat_input *in;
    sph__occluder occluder;
    sph__heat_matrix matrix;
    double *areas;
    sink *sinks;
    double *vectors; /* [tasks][5][n][8] */
    uint32_t first;  /* bone of the batch */
    double *weights; /* [n][reach->most] */
} heat_job;

enum { BATCH = 4 /* tasks at once */, VECTORS = 5 };

/* --- the Laplacian --- */

/* Cotangents of the angles of a triangle; 0 where it has no area. */
static void cotangents(const sph__heat_input *in, const uint32_t *corner, double out[3])
{
    double x[3][3], u[3], v[3], n[3], area;
    for (int c = 0; c < 3; ++c)
        for (int k = 0; k < 3; ++k)
            x[c][k] = (double)in->rest[3 * (size_t)corner[c] + k];
    sph__subtract(x[1], x[0], u);
    sph__subtract(x[2], x[0], v);
    sph__cross(u, v, n);
    area = sph__norm(n);
    for (int c = 0; c < 3; ++c) {
        sph__subtract(x[(c + 1) % 3], x[c], u);
        sph__subtract(x[(c + 2) % 3], x[c], v);
        out[c] = area > 0 ? fmax(-MOST_COTANGENT, fmin(sph__dot(u, v) / area, MOST_COTANGENT)) : 0;
    }
}

static size_t list_entry(sph__keyed *keys, size_t count, uint32_t a, uint32_t b, double value)
{
    uint64_t bits;
    if (a == b) return count;
    memcpy(&bits, &value, sizeof bits);
    keys[count] = (sph__keyed){(uint64_t)a << 32 | b, bits};
    keys[count + 1] = (sph__keyed){(uint64_t)b << 32 | a, bits};
    return count + 2;
}

/* Edges that are no triangle's conduct as one of two equilateral triangles does. */
static size_t list_entries(const sph__heat_input *in, sph__keyed *keys)
{
    size_t count = 0;
    for (size_t t = 0; t < in->triangle_count; ++t) {
        const uint32_t *corner = in->triangles + 3 * t;
        double cot[3];
        cotangents(in, corner, cot);
        for (int c = 0; c < 3; ++c)
            count = list_entry(keys, count, corner[(c + 1) % 3], corner[(c + 2) % 3], 0.5 * cot[c]);
    }
    for (size_t e = 0; e < in->edge_count; ++e)
        count = list_entry(keys, count, in->edges[2 * e], in->edges[2 * e + 1], 0.57735026918962576);
    return count;
}

/* Obtuse angles can make an edge conduct less than nothing: it then conducts nothing, and weights stay in [0, 1]. */
static sph_status make_matrix(heat_job *j)
{
    const sph__heat_input *in = j->in;
    sph__heat_matrix *m = &j->matrix;
    const size_t most = 6 * in->triangle_count + 2 * in->edge_count;
    sph__keyed *keys = sph__alloc(in->context, most, sizeof *keys);
    size_t count, at = 0, entries = 0;
    m->n = in->n;
    m->starts = sph__alloc(in->context, (size_t)in->n + 1, sizeof *m->starts);
    m->diagonal = sph__alloc(in->context, in->n, sizeof *m->diagonal);
    m->columns = sph__alloc(in->context, most, sizeof *m->columns);
    m->entries = sph__alloc(in->context, most, sizeof *m->entries);
    if (keys == NULL || m->starts == NULL || m->diagonal == NULL || m->columns == NULL || m->entries == NULL) {
        sph__free(in->context, keys);
        return sph__fail_memory(in->context);
    }
    count = list_entries(in, keys);
    sph__sort(keys, count);
    for (uint32_t v = 0; v < in->n; ++v) {
        m->starts[v] = entries;
        m->diagonal[v] = j->sinks[v].rate;
        while (at < count && keys[at].key >> 32 == v) {
            const uint64_t key = keys[at].key;
            double sum = 0, value;
            for (; at < count && keys[at].key == key; ++at) {
                memcpy(&value, &keys[at].item, sizeof value);
                sum += value;
            }
            if (!(sum > 0)) continue;
            m->columns[entries] = (uint32_t)key;
            m->entries[entries++] = -sum;
            m->diagonal[v] += sum;
        }
    }
    m->starts[in->n] = entries;
    sph__free(in->context, keys);
    return SPH_OK;
}

/* --- what vertices see --- */

/* The nearest `TRIES` bones of a point, rising by distance; returns how many. */
static uint32_t nearest_bones(const sph__heat_input *in, const double x[3], uint32_t found[TRIES],
                              double distances[TRIES])
{
    uint32_t count = 0;
    for (uint32_t b = 0; b < in->bones; ++b) {
        const double d = sph__distance(in->pivots + 3 * (size_t)b, x);
        uint32_t at = TRIES - 1;
        if (count < TRIES)
            at = count++;
        else if (!(d < distances[at]))
            continue;
        for (; at > 0 && d < distances[at - 1]; --at) {
            distances[at] = distances[at - 1];
            found[at] = found[at - 1];
        }
        distances[at] = d;
        found[at] = b;
    }
    return count;
}

static void find_sinks(void *argument, size_t begin, size_t end)
{
    heat_job *j = argument;
    const sph__heat_input *in = j->in;
    for (size_t v = begin; v < end; ++v) {
        sink *s = &j->sinks[v];
        uint32_t found[TRIES];
        double distances[TRIES], x[3], distance = INFINITY;
        uint32_t count;
        for (int k = 0; k < 3; ++k)
            x[k] = (double)in->rest[3 * v + k];
        count = nearest_bones(in, x, found, distances);
        s->count = 0;
        for (uint32_t i = 0; i < count && s->count < 4 && distances[i] <= SAME_DISTANCE * distance; ++i) {
            if (!sph__occluder_sees(&j->occluder, (uint32_t)v, in->pivots + 3 * (size_t)found[i])) continue;
            if (s->count == 0) distance = fmax(distances[i], 1e-6 * in->scale);
            s->bones[s->count++] = found[i];
        }
        if (s->count == 0) { /* it sees none: that of its cell */
            s->bones[s->count++] = in->labels[v];
            distance = fmax(sph__distance(in->pivots + 3 * (size_t)in->labels[v], x), 1e-6 * in->scale);
        }
        s->rate = fmax(j->areas[v], 1e-12 * in->scale * in->scale) / (distance * distance);
    }
}

/* --- conjugate gradients for eight bones --- */

static void start_vectors(const heat_job *j, uint32_t bone, double *x, double *r)
{
    for (size_t v = 0; v < j->in->n; ++v)
        for (uint32_t lane = 0; lane < L; ++lane) {
            double p = 0;
            for (uint32_t i = 0; i < j->sinks[v].count; ++i)
                if (j->sinks[v].bones[i] == bone + lane) p = 1.0 / j->sinks[v].count;
            x[v * L + lane] = 0;
            r[v * L + lane] = j->sinks[v].rate * p;
        }
}

static void precondition(const heat_job *j, const double *r, double *z)
{
    for (size_t v = 0; v < j->in->n; ++v)
        for (uint32_t lane = 0; lane < L; ++lane)
            z[v * L + lane] = r[v * L + lane] / j->matrix.diagonal[v];
}

/* z += s[lane] * way, into way: way = z + s way */
static void turn(double *way, const double s[L], const double *z, size_t n)
{
    for (size_t i = 0; i < n; ++i)
        for (uint32_t lane = 0; lane < L; ++lane)
            way[i * L + lane] = z[i * L + lane] + s[lane] * way[i * L + lane];
}

/* Lanes that are done, or whose right-hand side is 0, go on with steps of 0. */
static void solve_bones(const heat_job *j, uint32_t bone, double *vectors)
{
    const size_t n = j->in->n;
    double *x = vectors, *r = x + n * L, *z = r + n * L, *way = z + n * L, *image = way + n * L;
    double rho[L], first[L], dots[L], step[L];
    start_vectors(j, bone, x, r);
    precondition(j, r, z);
    memcpy(way, z, n * L * sizeof *way);
    sph__heat_kernel_dot(r, z, n, rho);
    memcpy(first, rho, sizeof first);
    for (int round = 0; round < ROUNDS; ++round) {
        bool done = true;
        sph__heat_kernel_apply(&j->matrix, way, image);
        sph__heat_kernel_dot(way, image, n, dots);
        for (uint32_t lane = 0; lane < L; ++lane) {
            const bool going = rho[lane] > RESIDUAL * RESIDUAL * first[lane] && dots[lane] > 0;
            step[lane] = going ? rho[lane] / dots[lane] : 0;
            done = done && !going;
        }
        if (done) return;
        sph__heat_kernel_add(x, step, way, n);
        for (uint32_t lane = 0; lane < L; ++lane)
            step[lane] = -step[lane];
        sph__heat_kernel_add(r, step, image, n);
        precondition(j, r, z);
        sph__heat_kernel_dot(r, z, n, dots);
        for (uint32_t lane = 0; lane < L; ++lane) {
            step[lane] = rho[lane] > 0 ? dots[lane] / rho[lane] : 0;
            rho[lane] = dots[lane];
        }
        turn(way, step, z, n);
    }
}

static void heat_task(void *argument, size_t begin, size_t end)
{
    const heat_job *j = argument;
    const sph__reach *reach = j->in->reach;
    for (size_t task = begin; task < end; ++task) {
        const uint32_t bone = j->first + (uint32_t)task * L;
        double *x = j->vectors + task * VECTORS * j->in->n * L;
        solve_bones(j, bone, x);
        for (size_t v = 0; v < j->in->n; ++v) {
            const size_t start = reach->starts[j->in->labels[v]], stop = reach->starts[j->in->labels[v] + 1];
            for (size_t i = start; i < stop; ++i)
                if (reach->bones[i] >= bone && reach->bones[i] - bone < L)
                    j->weights[v * reach->most + (i - start)] = fmax(x[v * L + (reach->bones[i] - bone)], 0);
        }
    }
}

static sph_status allocate(heat_job *j)
{
    const sph__heat_input *in = j->in;
    size_t numbers;
    if (!sph__multiply_size(in->n, (size_t)BATCH * VECTORS * L, &numbers)) return sph__fail_memory(in->context);
    j->areas = sph__alloc(in->context, in->n, sizeof *j->areas);
    j->sinks = sph__alloc(in->context, in->n, sizeof *j->sinks);
    j->vectors = sph__alloc(in->context, numbers, sizeof *j->vectors);
    return j->areas == NULL || j->sinks == NULL || j->vectors == NULL ? sph__fail_memory(in->context) : SPH_OK;
}

static sph_status run(heat_job *j, sph__progress *progress)
{
    const sph__heat_input *in = j->in;
    sph_status status = allocate(j);
    if (status == SPH_OK)
        status = sph__occluder_init(&j->occluder, in->context, in->rest, in->triangles, in->triangle_count);
    if (status != SPH_OK) return status;
    sph__cell_areas(in->triangles, in->triangle_count, in->rest, in->n, j->areas);
    sph__parallel_for(in->context, in->n, GRAIN, find_sinks, j);
    status = make_matrix(j);
    for (; status == SPH_OK && j->first < in->bones; j->first += BATCH * L) {
        const uint32_t tasks = (in->bones - j->first + L - 1) / L;
        status = sph__progress_report(progress, "weights", (double)j->first / in->bones);
        if (status == SPH_OK) sph__parallel_for(in->context, tasks < BATCH ? tasks : BATCH, 1, heat_task, j);
    }
    return status;
}

sph_status sph__heat_weights(const sph__heat_input *in, double *weights, sph__progress *progress)
{
    heat_job j = {.in = in, .weights = weights};
    const sph_status status = run(&j, progress);
    sph__occluder_free(&j.occluder);
    sph__free(in->context, j.matrix.starts);
    sph__free(in->context, j.matrix.columns);
    sph__free(in->context, j.matrix.entries);
    sph__free(in->context, j.matrix.diagonal);
    sph__free(in->context, j.areas);
    sph__free(in->context, j.sinks);
    sph__free(in->context, j.vectors);
    return status;
}
