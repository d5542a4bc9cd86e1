/* SPDX-License-Identifier: MIT */
/* The tracker laid open: poses on their way from where blending puts them to where the fields want them. */
#ifndef SPH_IMPLICIT_TRACKER_H
#define SPH_IMPLICIT_TRACKER_H

#include "implicit/implicit.h"
#include "implicit/intersect.h"
#include "implicit/shell.h"

/* How a node stands. */
enum {
    SPH__NODE_FREE = 0,    /* the fields have no say: it stays */
    SPH__NODE_WALKS = 1,   /* on its way */
    SPH__NODE_HALVES = 2,  /* between two points on both sides of a contact */
    SPH__NODE_ARRIVED = 3, /* at its value */
    SPH__NODE_TOUCHES = 4  /* at a contact */
};

/* Poses that are worked on together: as many as fit into so many nodes, so that few vertices keep many threads busy. */
enum { SPH__TRACK_BATCH = 8, SPH__TRACK_BATCH_NODES = 1 << 17 };

/* A pose. Rows of the nodes, padded to whole blocks. */
typedef struct sph__track {
    const double *transforms;
    float *positions, *normals; /* the caller's */
    sph_tracker_report report;
    sph__placed *placed;      /* [J] */
    double *at[3], *base[3];  /* now, and by blending */
    double *low[3], *high[3]; /* the last step's beginning, and for halving its end; in relaxation: where to go */
    float *direction[3];      /* of the gradient at `low`; unit */
    float *share[2];          /* mu, trust; then beta, twice */
    float *goal, *reach;      /* the value that a node walks to, and how far it may go */
    double *trust;            /* [joint_count]: from 1 down to 0 as bones come apart */
    uint32_t *low_bone, *high_bone;
    uint8_t *state, *count; /* `count`: halvings left; before, whether `low` is known */
    uint32_t *active;       /* [blocks]: nodes on their way */
    /* --- the guard's --- */
    sph__intersector search;
    float *places[2];       /* [node_count][3]: before and after */
    float *kept, *best;     /* [node_count]: how much of the way is kept, and was when there were fewest pairs */
    uint8_t *marks, *moved; /* [t]: whether a triangle is to be looked at, and whether it has moved at all */
    sph__pairs now;         /* of triangles that moved */
    size_t fresh;           /* of these those that were not before */
    size_t best_count, best_fresh;
    bool guarding;
} sph__track;

struct sph_tracker {
    sph_context *context; /* retained */
    sph_implicit *implicit;
    sph_deformer *deformer;
    sph_tracker_options options;
    sph__shell shell;
    size_t triangle_count;
    uint32_t *triangles;             /* the skin's, of vertices */
    double *iso;                     /* [node_count]; < 0: the node is free */
    double *limit;                   /* [node_count]: how far it may be moved by contact */
    double *joint_sizes;             /* [joint_count]: from the joint to the nearest node */
    uint32_t *rest_bone;             /* [node_count]: whose field it is in at rest */
    uint32_t node_room, block_count; /* nodes padded to whole blocks */
    uint32_t batch_size;
    double contact_cosine;
    size_t *around_starts; /* [n + 1]: triangles around a vertex */
    uint32_t *around;
    sph__track tracks[SPH__TRACK_BATCH];
};

/* What a loop over blocks of a batch of poses is told. */
typedef struct sph__batch {
    sph_tracker *tracker;
    size_t count;  /* poses */
    size_t blocks; /* of each */
    uint32_t round;
} sph__batch;

/* How much a node hangs on a bone. */
double sph__node_weight(const sph_tracker *tracker, uint32_t node, uint32_t bone);

/* --- trust.c --- */
/* What a joint is worth in a pose. */
void sph__trust_joints(const sph_tracker *tracker, sph__track *track);
/* What the fields are worth to a node in a pose, 0 to 1, and how far its bones would have it. */
double sph__trust_node(const sph_tracker *tracker, const sph__track *track, uint32_t node, double *nearest,
                       double *farthest);

/* Of two bones at a node. */
double sph__trust_pair(const sph_tracker *tracker, const sph__track *track, uint32_t node, uint32_t a, uint32_t b);

/* --- tracks.c --- */
sph_status sph__tracks_allocate(sph_tracker *tracker);
void sph__tracks_free(sph_tracker *tracker);

/* --- march.c: loops over items of a #sph__batch --- */
void sph__march_start(void *batch, size_t begin, size_t end);
void sph__march_step(void *batch, size_t begin, size_t end);
void sph__march_end(void *batch, size_t begin, size_t end);
/* Nodes at contacts, to their own sides. */
void sph__march_part(void *batch, size_t begin, size_t end);

/* --- relax.c --- */
void sph__relax_find(void *batch, size_t begin, size_t end);
void sph__relax_take(void *batch, size_t begin, size_t end);
void sph__smooth_start(void *batch, size_t begin, size_t end);
void sph__smooth_spread(void *batch, size_t begin, size_t end);
void sph__smooth_find(void *batch, size_t begin, size_t end);
void sph__smooth_take(void *batch, size_t begin, size_t end);

/* --- write.c: items are blocks of vertices, of all poses of a batch --- */
enum { SPH__WRITE_BLOCK = 1024 };
sph_status sph__write_init(sph_tracker *tracker, const sph_skin *skin);
void sph__write_positions(void *batch, size_t begin, size_t end);
void sph__write_normals(void *batch, size_t begin, size_t end);
/* Counts what has moved and what touches; before the guard, which has its own use for states. */
void sph__write_contacts(void *batch, size_t begin, size_t end);

/* --- guard.c --- */
sph_status sph__guard(sph_tracker *tracker, size_t count);

#endif
