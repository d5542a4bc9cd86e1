/* SPDX-License-Identifier: MIT */
/* Distances are those along edges, found by Dijkstra's search as far as the filter reaches. */
#include "skin/filter.h"

#include <math.h>

#include "numeric/heap.h"

enum { TASKS = 8 /* searches at once */, TASK = 128 /* vertices of each */, APPLY = 64, APPLY_BATCH = 64 };

/* The mesh's edges. */
typedef struct graph {
    size_t *starts;
    uint32_t *others;
} graph;

typedef struct search {
    sph__heap heap;
    double *distances;                 /* [n]; below 0 where not reached */
    uint32_t *reached;                 /* [n] */
    uint32_t counts[TASK];
    uint32_t others[TASK][SPH__FILTER_MOST];
    float shares[TASK][SPH__FILTER_MOST];
} search;

typedef struct filter_job {
    const sph__filter_input *in;
    graph edges;
    uint32_t *places; /* of the caller's vertices in the problem's order */
    double *areas;    /* the caller's order */
    search *searches; /* [TASKS] */
    size_t first;
} filter_job;

/* --- the graph --- */

static size_t list_edge(sph__keyed *keys, size_t count, uint32_t a, uint32_t b)
{
    if (a == b) return count;
    keys[count] = (sph__keyed){a, b};
    keys[count + 1] = (sph__keyed){b, a};
    return count + 2;
}

static sph_status make_graph(filter_job *j)
{
    const sph__filter_input *in = j->in;
    const size_t most = 6 * in->triangle_count + 2 * in->edge_count;
    const uint32_t n = in->problem->n;
    sph__keyed *keys = sph__alloc(in->context, most, sizeof *keys);
    size_t count = 0, kept = 0, at = 0;
    j->edges.starts = sph__alloc(in->context, (size_t)n + 1, sizeof *j->edges.starts);
    j->edges.others = sph__alloc(in->context, most, sizeof *j->edges.others);
    if (keys == NULL || j->edges.starts == NULL || j->edges.others == NULL) {
        sph__free(in->context, keys);
        return sph__fail_memory(in->context);
    }
    for (size_t t = 0; t < in->triangle_count; ++t)
        for (int k = 0; k < 3; ++k)
            count = list_edge(keys, count, in->triangles[3 * t + k], in->triangles[3 * t + (k + 1) % 3]);
    for (size_t e = 0; e < in->edge_count; ++e)
        count = list_edge(keys, count, in->edges[2 * e], in->edges[2 * e + 1]);
    sph__sort(keys, count);
    for (uint32_t v = 0; v < n; ++v) {
        j->edges.starts[v] = kept;
        for (; at < count && keys[at].key == v; ++at)
            if (kept == j->edges.starts[v] || j->edges.others[kept - 1] != keys[at].item)
                j->edges.others[kept++] = (uint32_t)keys[at].item;
    }
    j->edges.starts[n] = kept;
    sph__free(in->context, keys);
    return SPH_OK;
}

/* --- searches --- */

static double edge_length(const filter_job *j, uint32_t a, uint32_t b)
{
    const float *x = j->in->rest + 3 * (size_t)a, *y = j->in->rest + 3 * (size_t)b;
    double sum = 0;
    for (int k = 0; k < 3; ++k)
        sum += ((double)x[k] - (double)y[k]) * ((double)x[k] - (double)y[k]);
    return sqrt(sum);
}

/* All vertices within three sigma of `start`, nearest first; returns how many. */
static uint32_t walk(const filter_job *j, search *s, uint32_t start)
{
    const double limit = 3 * j->in->sigma;
    uint32_t count = 0, at;
    sph__heap_set(&s->heap, start, 0, 0); /* room was made: these cannot fail */
    while (sph__heap_top(&s->heap, &at)) {
        const double distance = sph__heap_key(&s->heap, at);
        sph__heap_pop(&s->heap, NULL);
        s->distances[at] = distance;
        s->reached[count++] = at;
        for (size_t e = j->edges.starts[at]; e < j->edges.starts[at + 1]; ++e) {
            const uint32_t other = j->edges.others[e];
            const double longer = distance + edge_length(j, at, other);
            if (s->distances[other] >= 0 || longer > limit) continue;
            if (sph__heap_contains(&s->heap, other) && sph__heap_key(&s->heap, other) <= longer) continue;
            sph__heap_set(&s->heap, other, longer, 0);
        }
    }
    return count;
}

/* Of too many vertices every second, third ... counts for those around it. */
static void search_vertex(const filter_job *j, search *s, uint32_t vertex, uint32_t slot)
{
    const uint32_t count = walk(j, s, vertex), stride = (count + SPH__FILTER_MOST - 1) / SPH__FILTER_MOST;
    const double scale = -0.5 / (j->in->sigma * j->in->sigma);
    double sum = 0;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i += stride, ++kept) {
        const uint32_t other = s->reached[i];
        const double share = exp(scale * s->distances[other] * s->distances[other]) * j->areas[other];
        s->others[slot][kept] = j->places[other];
        s->shares[slot][kept] = (float)share;
        sum += share;
    }
    for (uint32_t i = 0; i < kept; ++i)
        s->shares[slot][i] = (float)((double)s->shares[slot][i] / sum);
    s->counts[slot] = kept;
    for (uint32_t i = 0; i < count; ++i)
        s->distances[s->reached[i]] = -1;
}

static void search_task(void *argument, size_t begin, size_t end)
{
    const filter_job *j = argument;
    for (size_t task = begin; task < end; ++task)
        for (uint32_t slot = 0; slot < TASK; ++slot) {
            const size_t v = j->first + task * TASK + slot;
            if (v < j->in->problem->n) search_vertex(j, &j->searches[task], j->in->problem->vertex[v], slot);
        }
}

static sph_status begin_searches(filter_job *j)
{
    const uint32_t n = j->in->problem->n;
    sph_context *context = j->in->context;
    j->places = sph__alloc(context, n, sizeof *j->places);
    j->areas = sph__alloc(context, n, sizeof *j->areas);
    j->searches = sph__zalloc(context, TASKS, sizeof *j->searches);
    if (j->places == NULL || j->areas == NULL || j->searches == NULL) return sph__fail_memory(context);
    for (uint32_t v = 0; v < n; ++v)
        j->places[j->in->problem->vertex[v]] = v;
    sph__cell_areas(j->in->triangles, j->in->triangle_count, j->in->rest, n, j->areas);
    for (uint32_t v = 0; v < n; ++v)
        j->areas[v] = fmax(j->areas[v], 1e-6 * j->in->sigma * j->in->sigma);
    for (int t = 0; t < TASKS; ++t) {
        search *s = &j->searches[t];
        sph_status status;
        sph__heap_init(&s->heap, context);
        status = sph__heap_reserve(&s->heap, n);
        if (status != SPH_OK) return status;
        s->distances = sph__alloc(context, n, sizeof *s->distances);
        s->reached = sph__alloc(context, n, sizeof *s->reached);
        if (s->distances == NULL || s->reached == NULL) return sph__fail_memory(context);
        for (uint32_t v = 0; v < n; ++v)
            s->distances[v] = -1;
    }
    return SPH_OK;
}

/* What the searches of one batch found, behind what there is. */
static bool append(const filter_job *j, sph__filter *f, size_t *count, size_t capacity[2])
{
    for (uint32_t i = 0; i < TASKS * TASK; ++i) {
        const search *s = &j->searches[i / TASK];
        const size_t v = j->first + i, more = s->counts[i % TASK];
        if (v >= j->in->problem->n) break;
        f->starts[v] = *count;
        if (!sph__reserve(f->context, (void **)&f->others, &capacity[0], *count + more, sizeof *f->others) ||
            !sph__reserve(f->context, (void **)&f->shares, &capacity[1], *count + more, sizeof *f->shares))
            return false;
        memcpy(f->others + *count, s->others[i % TASK], more * sizeof *f->others);
        memcpy(f->shares + *count, s->shares[i % TASK], more * sizeof *f->shares);
        *count += more;
    }
    return true;
}

static sph_status run_searches(filter_job *j, sph__filter *f, sph__progress *progress)
{
    const uint32_t n = j->in->problem->n;
    size_t count = 0, capacity[2] = {0};
    f->starts = sph__alloc(f->context, (size_t)n + 1, sizeof *f->starts);
    if (f->starts == NULL) return sph__fail_memory(f->context);
    for (; j->first < n; j->first += TASKS * TASK) {
        const size_t tasks = (n - j->first + TASK - 1) / TASK;
        const sph_status status = sph__progress_report(progress, "filter", (double)j->first / n);
        if (status != SPH_OK) return status;
        sph__parallel_for(f->context, tasks < TASKS ? tasks : TASKS, 1, search_task, j);
        if (!append(j, f, &count, capacity)) return sph__fail_memory(f->context);
    }
    f->starts[n] = count;
    return SPH_OK;
}

sph_status sph__filter_init(sph__filter *filter, const sph__filter_input *in, sph__progress *progress)
{
    filter_job j = {.in = in};
    sph_status status;
    *filter = (sph__filter){.context = in->context};
    status = make_graph(&j);
    if (status == SPH_OK) status = begin_searches(&j);
    if (status == SPH_OK) status = run_searches(&j, filter, progress);
    for (int t = 0; t < TASKS && j.searches != NULL; ++t) {
        sph__heap_free(&j.searches[t].heap);
        sph__free(in->context, j.searches[t].distances);
        sph__free(in->context, j.searches[t].reached);
    }
    sph__free(in->context, j.searches);
    sph__free(in->context, j.places);
    sph__free(in->context, j.areas);
    sph__free(in->context, j.edges.starts);
    sph__free(in->context, j.edges.others);
    return status;
}

void sph__filter_free(sph__filter *filter)
{
    sph__free(filter->context, filter->starts);
    sph__free(filter->context, filter->others);
    sph__free(filter->context, filter->shares);
    *filter = (sph__filter){0};
}

/* --- smoothing --- */

typedef struct apply_job {
    const sph__filter *filter;
    const sph__problem *p;
    double *smooth, *sums; /* sums: [APPLY_BATCH][bones], all 0 between vertices */
    size_t first;
} apply_job;

static void smooth_vertex(const apply_job *j, size_t v, double *sums)
{
    const sph__problem *p = j->p;
    const sph__candidates *set = &p->sets[p->set[v]];
    const size_t begin = j->filter->starts[v], end = j->filter->starts[v + 1];
    for (int pass = 0; pass < 2; ++pass) {
        for (size_t i = begin; i < end; ++i) {
            const size_t other = j->filter->others[i], at = other * p->limit;
            const uint32_t *bones = p->sets[p->set[other]].bones;
            const double share = (double)j->filter->shares[i];
            for (uint32_t s = 0; s < p->now.count[other]; ++s) {
                double *sum = &sums[bones[p->now.places[at + s]]];
                *sum = pass == 0 ? *sum + share * p->now.weights[at + s] : 0;
            }
        }
        for (uint32_t a = 0; a < set->count && pass == 0; ++a)
            j->smooth[v * p->most + a] = sums[set->bones[a]];
    }
}

static void smooth_range(void *argument, size_t begin, size_t end)
{
    const apply_job *j = argument;
    for (size_t task = begin; task < end; ++task)
        for (size_t i = 0; i < APPLY; ++i) {
            const size_t v = (j->first + task) * APPLY + i;
            if (v < j->p->n) smooth_vertex(j, v, j->sums + task * j->p->bones);
        }
}

sph_status sph__filter_apply(const sph__filter *filter, const sph__problem *p, double *smooth)
{
    const size_t tasks = (p->n + APPLY - 1) / APPLY;
    apply_job j = {.filter = filter, .p = p, .smooth = smooth};
    j.sums = sph__zalloc(p->context, p->bones, APPLY_BATCH * sizeof *j.sums);
    if (j.sums == NULL) return sph__fail_memory(p->context);
    for (; j.first < tasks; j.first += APPLY_BATCH) {
        const size_t left = tasks - j.first;
        sph__parallel_for(p->context, left < APPLY_BATCH ? left : APPLY_BATCH, 1, smooth_range, &j);
    }
    sph__free(p->context, j.sums);
    return SPH_OK;
}
