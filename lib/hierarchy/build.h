/* SPDX-License-Identifier: MIT */
/* What the steps of sph_hierarchy_create share. */
#ifndef SPH_HIERARCHY_BUILD_H
#define SPH_HIERARCHY_BUILD_H

#include "animation/animation.h"
#include "hierarchy/blocks.h"
#include "hierarchy/edge_queue.h"
#include "hierarchy/hierarchy.h"
#include "hierarchy/inversion.h"
#include "hierarchy/kernel.h"

/* A live region keeps its data in the slot of one of its leaves: one cache line. */
typedef struct sph__slot {
    double w, b, c;
    double width;    /* lower bound of the region's width */
    float *block;    /* NULL: a leaf without one */
    uint32_t node;
    uint32_t last;   /* the region's vertices: a chain from that of the slot's number through sph__builder.next_member */
    uint32_t count : 31, used : 1; /* of the vertices; a leaf whose block was of use since the cache last came by */
    uint32_t place;  /* of the block in its pool */
    uint32_t pin;    /* a leaf whose block must stay while this is sph__builder.pin */
    uint32_t batch;  /* the last one in which one of its collapses was worked out ahead */
} sph__slot;
_Static_assert(sizeof(void *) != 8 || sizeof(sph__slot) == 64, "a slot is a cache line");

/* The state of an edge in the queue. */
typedef struct sph__candidate {
    double lambda;
    float radius;
    float width; /* of the union where it was needed, or somewhat less, else 0; below 0: its cost is a lower bound */
} sph__candidate;

/* The cost of an edge by its radius where no frame is degenerate: r (w2 r / 2 - beta3) + constant. w2 is 0 where one is. */
typedef struct sph__parabola {
    double w2, beta3, constant;
} sph__parabola;

/* The cost is that of the exact radius bound. */
static inline bool sph__is_exact(const sph__candidate *candidate)
{
    return candidate->width >= 0;
}

/* Points of a union whose extents are taken before those of all: of all directions; of some. */
enum { SPH__WITNESSES = 4, SPH__GUARDS = 8 };

/* What finding the exact width of a union needs. */
typedef struct sph__extents {
    struct sph__extent_vertex {
        uint32_t member_stamp; /* in the union, where this is `stamp` */
        uint32_t place_stamp;  /* then it is in `vertices`, at this place: */
        uint32_t place;
    } *places; /* [n] */
    uint32_t stamp;
    uint32_t *vertices; /* that the points are made of */
    size_t vertex_count, vertex_capacity;
    uint32_t (*points)[3]; /* places of the vertices whose mean is the point; SPH__NO_NODE: of two */
    size_t point_count, point_capacity, spread_stride;
    double *placed, *placed_vertices; /* [points][3][lanes], and so for the vertices behind them */
    size_t placed_capacity;
    double *witnesses;   /* [SPH__WITNESSES - 1][3][stride]: a few of the points, from the first of them */
    size_t guards[SPH__GUARDS], guard_count; /* numbers of points */
    double *chunk_least; /* [stride / lanes][direction_stride]: their least extents in each chunk of frames */
    double *chunk_floor; /* [stride / lanes]: the least of these */
} sph__extents;

typedef struct sph__builder {
    sph_hierarchy *h;
    const sph_context *context;
    const sph_animation *animation;
    sph_hierarchy_options options;
    sph__progress progress;

    uint32_t n, frames;
    bool single;                /* one frame: rows of one float, and loops over edges instead (single.h) */
    size_t stride, node_floats; /* node_floats = 3 * stride */
    double radius_factor;
    double coherence;
    int size_exponent, weight_exponent; /* the input's size and weights are 2^ these times those computed with */

    uint32_t *cells;      /* triangles of the input, wound outward; 3 indices each */
    size_t cell_count;
    uint32_t *wire;       /* further edges, 2 indices each */
    size_t wire_count;
    size_t *cell_starts;  /* [n + 1] into vertex_cells */
    uint32_t (*vertex_cells)[2]; /* of the cells around each vertex the other corners, in the order of the winding */
    float *importance;    /* [n], or [n][stride] where importance_per_frame; NULL: 1 */
    int importance_per_frame;

    double (*directions)[3];
    uint32_t direction_count;
    double *direction_rows;      /* [3][direction_stride] the same, padded */
    size_t direction_stride;
    uint32_t probe_frames;       /* frames whose extents are kept */
    size_t probe_count;          /* probe_frames * direction_stride */
    double *probes;              /* [slots][2][probe_count]: low and high ends of the extents; NULL where */
    float *probe_bounds;         /* they are not all frames: intervals that hold them are enough then */
    sph__extents extents;
    uint8_t *cell_open;          /* [n]: the triangles do not close around the vertex */
    uint32_t *next_member; /* [n] */

    sph__slabs slabs;
    sph__blocks blocks;      /* of regions that collapses have made; with radii per frame of leaves too */
    sph__blocks leaf_blocks; /* of some leaves: made when they are needed */
    size_t leaf_rows;        /* of a leaf's block */
    size_t leaf_capacity;    /* blocks in leaf_blocks, unless more are needed at once */
    size_t block_budget;     /* bytes that blocks and the centres of collapses may take where leaves have a choice */
    size_t leaf_hand;        /* where the search for a block to do without goes on */
    uint32_t pin;
    sph__slot *slots;     /* [n], and those of guesses */
    float *rows;          /* [n][SPH__SINGLE_ROWS] by slot where there is a single frame; else NULL */
    double *costs;        /* scratch: of a new node's edges */
    size_t cost_capacity;
    float *means;         /* [2 n][4][stride] by slot: temporal coherence; else NULL */

    struct sph__guesses *guesses; /* NULL with one thread */
    sph__connectivity mesh;
    sph__candidate *candidates; /* per edge */
    sph__parabola *parabolas;   /* per edge, for the exact cost; NULL where costs are exact from the start */
    sph__edge_queue queue;
    float *new_center;    /* [3][stride] */
    float *new_block;     /* [rows][stride] */
    /* With radii per frame: */
    float *new_radii;     /* [stride] */
    double *union_widths; /* [stride]: exact, of the edge exact_edge */
    uint32_t exact_edge;
    double live_cost, live_weight; /* of all regions: costs, W */
    sph__births births;
} sph__builder;

static inline float *sph__node_center(const sph__builder *b, uint32_t node)
{
    return b->h->centers + node * b->node_floats;
}

/* Around a vertex of more triangles they count as not closed: finding out would take the square of their number. */
enum { SPH__FAN_LIMIT = 1024 };

/* The exact cost of an edge takes no more than its width. */
static inline bool sph__is_parabola(const sph__builder *b, uint32_t edge)
{
    return b->parabolas != NULL && b->parabolas[edge].w2 > 0;
}

/* Steps, in order. */
sph_status sph__load_frames(sph__builder *b); /* ends with sph__normalise_size */
sph_status sph__make_cells(sph__builder *b);
sph_status sph__make_importance(sph__builder *b);
sph_status sph__make_leaves(sph__builder *b);
sph_status sph__make_widths(sph__builder *b);
sph_status sph__decimate(sph__builder *b);
void sph__restore_size(sph__builder *b);

/* The exponent of the power of two that brings a mean diagonal near 1; `largest`: of all coordinates, without sign. */
int sph__size_exponent(double diagonal, double largest);
/* Brings all to that size, from 2^size_exponent. */
void sph__normalise_size(sph__builder *b, double diagonal, double largest);

/*
 * Importance from curvature: the plane that a vertex of positive curvature adds to its leaf's quadric; returns what it
 * adds to W. The radius is in bounding-box diagonals. The weight is that of a unit of curvature; 0: there is no plane.
 */
#define SPH__CAP_RADIUS 0.04
double sph__cap_weight(const sph__builder *b, uint32_t v);
double sph__add_cap(const sph__builder *b, uint32_t v, float *block);

/* Leaves that are held keep their blocks until this is called again. */
void sph__release_leaves(sph__builder *b);
/*
 * Gives a leaf a block, if it has none: then *fresh is set, and sph__fill_leaf must follow. Nodes that are no leaves have
 * theirs.
 */
sph_status sph__hold_leaf(sph__builder *b, uint32_t node, bool *fresh);
void sph__fill_leaf(const sph__builder *b, uint32_t v);
/* Both. */
sph_status sph__need_leaf(sph__builder *b, uint32_t node);
/* Regions take ever more of what there is for blocks: leaves have to do with the rest. */
void sph__limit_leaves(sph__builder *b);

/* The region as the kernels want it. */
sph__region sph__region_of(const sph__builder *b, uint32_t node);

sph_status sph__extents_init(const sph__builder *b, sph__extents *extents);
void sph__extents_free(const sph__builder *b, sph__extents *extents);
/* Exact width of the union of two regions. */
sph_status sph__union_width(const sph__builder *b, sph__extents *extents, const sph__slot *u, const sph__slot *v,
                            double *width);
/* An upper bound of it that costs little. */
double sph__union_width_bound(const sph__builder *b, const sph__slot *u, const sph__slot *v);
void sph__prefetch_widths(const sph__builder *b, const sph__slot *slot);
/* What is known of a region's extents, to another slot's rows. */
void sph__copy_widths(const sph__builder *b, sph__slot *to, const sph__slot *from);
/* What is known of the union's extents, into u's rows. */
void sph__unite_widths(const sph__builder *b, sph__slot *u, const sph__slot *v, const sph__candidate *candidate);

/* Exact widths of the union of two regions in every frame. */
sph_status sph__union_frame_widths(const sph__builder *b, sph__extents *extents, const sph__slot *u,
                                   const sph__slot *v, double *widths);

/* Radii per frame. Blocks have FRAME_ROWS more rows: W, B and c of each frame. */
enum { SPH__FRAME_ROWS = 3 };
sph_status sph__per_frame_start(sph__builder *b);
/* The cost within the bounds of `widths`; NULL: without bounds, which is no more. */
double sph__per_frame_cost(const sph__builder *b, uint32_t u, uint32_t v, const double *widths);
/* The sphere into new_center and new_radii. */
void sph__per_frame_sphere(sph__builder *b, uint32_t u, uint32_t v, const double *widths);
double sph__per_frame_unite(sph__builder *b, uint32_t u, uint32_t v);

static inline sph__slot *sph__slot_of(const sph__builder *b, uint32_t node)
{
    return &b->slots[b->mesh.nodes[node].slot];
}

/* The cost of an edge with the best bound of the radius that is at hand: exact where the bound does not matter, else a
 * lower bound of the cost. Both ends have blocks. `next`: a node whose rows are asked for meanwhile, or SPH__NO_NODE. */
double sph__evaluate(const sph__builder *b, uint32_t edge, uint32_t next, sph__candidate *candidate);
/* The same of regions (not with radii per frame), u the older. */
double sph__evaluate_regions(const sph__builder *b, const sph__region *u, const sph__region *v, const sph__slot *su,
                             const sph__slot *sv, sph__candidate *candidate, sph__parabola *parabola);
/* What will be read soon is asked for, so that one wait serves for all of it: for the collapse of u and v, and of what is
 * next in the queue; for the edges of a new node. */
void sph__prefetch_collapse(const sph__builder *b, uint32_t u, uint32_t v);
void sph__prefetch_neighbours(const sph__builder *b, uint32_t node);
void sph__prefetch_around(const sph__builder *b, uint32_t node);

/* That from the sums. */
double sph__evaluate_sums(const sph__builder *b, const sph__sums *sums, double u_radius, const sph__slot *su,
                          const sph__slot *sv, sph__candidate *candidate, sph__parabola *parabola);
/* The exact cost (not with radii per frame). Both ends have blocks where it is no parabola. */
sph_status sph__evaluate_exactly(const sph__builder *b, sph__extents *extents, uint32_t edge, sph__candidate *candidate,
                                 double *cost);
/* Whether one of the surviving triangles of u or v turns over when both move to `center`. */
static inline bool sph__inverts(const sph__builder *b, uint32_t u, uint32_t v, const float *center)
{
    return sph__collapse_inverts(&b->mesh, b->h->centers, b->stride, u, v, center);
}
/* The costs of all edges of the input, into the queue. */
sph_status sph__fill_queue(sph__builder *b);

/* Collapses worked out ahead: guess.h. Their new nodes have slots behind those of regions. */
enum { SPH__GUESS_SLOTS = 64 };
typedef struct sph__guess sph__guess;
sph_status sph__guesses_create(sph__builder *b);
void sph__guesses_destroy(sph__builder *b);
/* The guess for the edge between its two nodes; NULL where there is none. */
const sph__guess *sph__guess_find(const sph__builder *b, uint32_t edge);
/* The exact cost, and what belongs to it. */
double sph__guess_exact(const sph__guess *guess, sph__candidate *candidate);
/* The sphere into new_center, and whether that inverts triangles; false where the guess is too old for that. */
bool sph__guess_sphere(sph__builder *b, const sph__guess *guess, bool *inverts);
/* The scalars of the united quadric into the slot; returns its block. Only where it does not invert triangles. */
const float *sph__guess_block(const sph__builder *b, const sph__guess *guess, sph__slot *slot);
/* The cost of the new node's edge to `other`, and what belongs to it, where they are known. */
bool sph__guess_cost(sph__builder *b, const sph__guess *guess, uint32_t edge, uint32_t other, double *cost);
/* For an edge without a guess: works out those on top of the queue, if there are enough. */
sph_status sph__guess_ahead(sph__builder *b);

/* The minimum of the united quadric with 0 <= r <= radius_max, from its sums. */
sph__minimum sph__sums_minimize(const sph__sums *sums, double u_radius, double radius_max);

#endif
