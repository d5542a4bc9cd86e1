/* SPDX-License-Identifier: MIT */
/* Nodes walk along the gradient of the composed field to their own values, or to a contact (Vaillant et al. 2013, 5).
 */
#include <math.h>

#include "implicit/tracker.h"
#include "numeric/vector.h"
#include "pose/pose.h"

enum { BLOCK = SPH__IMPLICIT_BLOCK, HALVINGS = 6, PART_ROUNDS = 3, PART_ROUNDS_FROM_BASE = 16 };

/* A step is no longer than this part of the bone's radius. */
static const double STEP_LIMIT = 0.2;
/* A bone that moves a node by less than this is another's. */
static const double OWN_WEIGHT = 0.02;
/* Nearer than this part of a bone's radius is touching. */
static const double NEAR_AT_REST = 0.25;
/* One that moves it by less than this may be in the way of others that move it more. */
static const double MAIN_WEIGHT = 0.45;
/* Paths along gradients are longer than straight ones. */
static const double NEAREST_REACH = 1.2;
/* By how much a node's own field leads the other at a contact, and how far it may go for it, in radii. */
static const double PART_LEAD = 0.02, PART_LIMIT = 0.1;
/* By how much another field leads where a node is on the wrong side of it. */
static const double FOREIGN_LEAD = 0.05;
/* Fields that are trusted less settle nothing. */
static const float LEAST_TRUST = 0.7f;
/* Where the value is this near, Newton's steps are as good as exact. */
static const double WHOLE_STEP = 0.02;
/* Slopes, in field values per radius, below which there is no direction. */
static const double LEAST_SLOPE = 1e-6;

double sph__node_weight(const sph_tracker *tracker, uint32_t node, uint32_t bone)
{
    const sph_deformer *d = tracker->deformer;
    const size_t k = d->influence_count, v = tracker->shell.vertices[node];
    for (size_t s = v * k; s < (v + 1) * k && d->weights[s] > 0; ++s)
        if (d->bones[s] == bone) return (double)d->weights[s];
    return 0;
}

void sph__march_start(void *argument, size_t begin, size_t end)
{
    const sph__batch *b = argument;
    const sph_tracker *tracker = b->tracker;
    const uint32_t nodes = tracker->shell.node_count;
    for (size_t item = begin; item < end; ++item) {
        sph__track *t = b->tracker->tracks + item / b->blocks;
        const size_t block = item % b->blocks;
        uint32_t active = 0;
        for (size_t i = block * BLOCK; i < (block + 1) * BLOCK; ++i) {
            const float *p = i < nodes ? t->positions + 3 * (size_t)tracker->shell.vertices[i] : NULL;
            bool finite = true;
            for (int c = 0; c < 3; ++c) {
                t->at[c][i] = t->base[c][i] = p == NULL ? 0 : (double)p[c];
                finite = finite && isfinite(t->at[c][i]);
            }
            t->count[i] = 0;
            t->share[0][i] = 0;
            t->goal[i] = p == NULL ? 0 : (float)tracker->iso[i];
            t->state[i] = p != NULL && finite && tracker->iso[i] >= 0 ? SPH__NODE_WALKS : SPH__NODE_FREE;
            active += t->state[i] == SPH__NODE_WALKS;
        }
        t->active[block] = active;
    }
}

/* What a node finds where it is. */
typedef struct finding {
    double f, slope, direction[3]; /* unit; 0 where there is none */
    uint32_t bone;
} finding;

static double dot_low(const sph__track *t, size_t i, const double direction[3])
{
    return (double)t->direction[0][i] * direction[0] + (double)t->direction[1][i] * direction[1] +
           (double)t->direction[2][i] * direction[2];
}

/* Remembers where a node is and what it found, before it goes on. */
static void set_low(sph__track *t, size_t i, const finding *f)
{
    for (int c = 0; c < 3; ++c) {
        t->low[c][i] = t->at[c][i];
        t->direction[c][i] = (float)f->direction[c];
    }
    t->low_bone[i] = f->bone;
}

static void set_high(sph__track *t, size_t i, const finding *f)
{
    for (int c = 0; c < 3; ++c)
        t->high[c][i] = t->at[c][i];
    t->high_bone[i] = f->bone;
}

/*
 * Of both sides of the contact the one that is the node's own; where it hangs on both alike, where it came from. From
 * now on `low_bone` is its own and `high_bone` the other.
 */
static void settle(const sph_tracker *tracker, sph__track *t, uint32_t i)
{
    const uint32_t low = t->low_bone[i], high = t->high_bone[i];
    if (sph__node_weight(tracker, i, high) > sph__node_weight(tracker, i, low)) {
        for (int c = 0; c < 3; ++c)
            t->at[c][i] = t->high[c][i];
        t->low_bone[i] = high;
        t->high_bone[i] = low;
    } else {
        for (int c = 0; c < 3; ++c)
            t->at[c][i] = t->low[c][i];
    }
    t->state[i] = SPH__NODE_TOUCHES;
}

static void halve(const sph_tracker *tracker, sph__track *t, uint32_t i)
{
    if (t->count[i]-- == 0) {
        settle(tracker, t, i);
        return;
    }
    for (int c = 0; c < 3; ++c)
        t->at[c][i] = 0.5 * (t->low[c][i] + t->high[c][i]);
}

/* Parts that touch in the rest pose, as a ball its socket, are in nobody's way. */
static bool is_near_at_rest(const sph_tracker *tracker, uint32_t node, uint32_t bone)
{
    const sph__field *field = tracker->implicit->fields + bone;
    double p[3], distance, gradient[3];
    for (int c = 0; c < 3; ++c) {
        p[c] = (double)tracker->shell.rest[3 * (size_t)node + c];
        if (p[c] < field->low[c] || p[c] > field->high[c]) return false;
    }
    sph__field_distance(field, p, &distance, gradient);
    return distance < NEAR_AT_REST * field->radius;
}

/*
 * The first look. Each bone alone would put the node on its own surface, at its value: so the surface is no farther
 * than the nearest of these places. Only what is in another part's way may have to go farther.
 */
static void look(const sph_tracker *tracker, sph__track *t, uint32_t i, const finding *f)
{
    double nearest, farthest, reach;
    const double trust = sph__trust_node(tracker, t, i, &nearest, &farthest);
    const double weight = sph__node_weight(tracker, i, f->bone);
    const bool foreign = f->bone != tracker->rest_bone[i] && weight < MAIN_WEIGHT;
    t->goal[i] = (float)(f->f + trust * (tracker->iso[i] - f->f));
    reach = NEAREST_REACH * nearest;
    if (foreign && weight >= OWN_WEIGHT) reach = NEAREST_REACH * farthest;
    if (foreign && weight < OWN_WEIGHT && !is_near_at_rest(tracker, i, f->bone)) reach = tracker->limit[i];
    t->reach[i] = (float)fmin(reach, tracker->limit[i]);
    t->share[1][i] = (float)trust;
}

/* A Newton step, bounded; nowhere farther from the base than the node may go. */
static void step(const sph_tracker *tracker, sph__track *t, uint32_t i, const finding *f)
{
    const double reach = (double)t->reach[i], most = STEP_LIMIT * tracker->limit[i];
    const double rest = (double)t->goal[i] - f->f; /* the last step is a whole one */
    double length = (fabs(rest) < WHOLE_STEP ? 1 : tracker->options.step) * rest / f->slope, off[3], far;
    length = length > most ? most : length < -most ? -most : length;
    for (int c = 0; c < 3; ++c)
        off[c] = t->at[c][i] + length * f->direction[c] - t->base[c][i];
    far = sph__norm(off);
    for (int c = 0; c < 3; ++c)
        t->at[c][i] = t->base[c][i] + off[c] * (far > reach ? reach / far : 1);
}

static void advance(const sph_tracker *tracker, sph__track *t, uint32_t i, const finding *f)
{
    const bool none = !(f->slope * tracker->limit[i] > LEAST_SLOPE); /* also for a NaN */
    if (t->state[i] == SPH__NODE_HALVES) {
        if (!none && dot_low(t, i, f->direction) >= tracker->contact_cosine)
            set_low(t, i, f);
        else
            set_high(t, i, f);
        halve(tracker, t, i);
        return;
    }
    if (none) {
        t->state[i] = SPH__NODE_ARRIVED;
        t->share[0][i] = 0;
        return;
    }
    if (t->count[i] == 1 && dot_low(t, i, f->direction) < tracker->contact_cosine) {
        set_high(t, i, f);
        t->state[i] = SPH__NODE_HALVES;
        t->count[i] = HALVINGS;
        t->share[0][i] = 0;
        halve(tracker, t, i);
        return;
    }
    if (t->count[i] == 0 && fabs(f->f - tracker->iso[i]) > tracker->options.tolerance) look(tracker, t, i, f);
    if (fabs(f->f - (double)t->goal[i]) <= tracker->options.tolerance) {
        t->state[i] = SPH__NODE_ARRIVED;
        t->share[0][i] = 0;
        return;
    }
    {
        const double off = fabs(f->f - (double)t->goal[i]) - 1, square = off * off;
        t->share[0][i] = (float)(square < 1 ? 1 - square * square : 0);
    }
    set_low(t, i, f);
    t->count[i] = 1;
    step(tracker, t, i, f);
}

void sph__march_step(void *argument, size_t begin, size_t end)
{
    const sph__batch *b = argument;
    const sph_tracker *tracker = b->tracker;
    for (size_t item = begin; item < end; ++item) {
        sph__track *t = b->tracker->tracks + item / b->blocks;
        const size_t block = item % b->blocks, first = block * BLOCK;
        uint32_t nodes[BLOCK], bones[BLOCK], active = 0;
        size_t count = 0;
        sph__points p;
        sph__values v;
        if (t->active[block] == 0) continue;
        for (size_t i = first; i < first + BLOCK; ++i) {
            if (t->state[i] != SPH__NODE_WALKS && t->state[i] != SPH__NODE_HALVES) continue;
            p.x[count] = t->at[0][i];
            p.y[count] = t->at[1][i];
            p.z[count] = t->at[2][i];
            nodes[count++] = (uint32_t)i;
        }
        sph__compose_block(tracker->implicit, t->placed, tracker->options.evaluation, count, &p, &v, bones);
        for (size_t i = 0; i < count; ++i) {
            finding f = {.f = v.f[i], .direction = {v.x[i], v.y[i], v.z[i]}, .bone = bones[i]};
            f.slope = sph__norm(f.direction);
            for (int c = 0; c < 3 && f.slope > 0; ++c)
                f.direction[c] /= f.slope;
            advance(tracker, t, nodes[i], &f);
            active += t->state[nodes[i]] == SPH__NODE_WALKS || t->state[nodes[i]] == SPH__NODE_HALVES;
        }
        t->active[block] = active;
    }
}

/* --- contacts --- */

/* One field at one point. */
static double evaluate(const sph_tracker *tracker, const sph__track *t, uint32_t bone, const double x[3],
                       double gradient[3])
{
    const sph__field *f = tracker->implicit->fields + bone;
    sph__points p;
    sph__values v;
    gradient[0] = gradient[1] = gradient[2] = 0;
    if (bone == SPH__NO_PART || !t->placed[bone].live) return 0;
    for (int i = 0; i < 8; ++i) {
        p.x[i] = x[0];
        p.y[i] = x[1];
        p.z[i] = x[2];
    }
    if (tracker->options.evaluation == SPH_EVALUATION_TABLE)
        sph__field_table(f, t->placed + bone, 1, &p, &v);
    else
        sph__field_exact(f, t->placed + bone, 8, &p, &v);
    gradient[0] = v.x[0];
    gradient[1] = v.y[0];
    gradient[2] = v.z[0];
    return v.f[0];
}

/*
 * By how much its own field is to lead: a little, but no more than it does in the rest pose, where parts may overlap.
 */
static double wanted_lead(const sph_tracker *tracker, uint32_t i, uint32_t own, uint32_t other)
{
    const sph__field *f[2] = {tracker->implicit->fields + own, tracker->implicit->fields + other};
    double p[3], gradient[3], distances[2];
    for (int c = 0; c < 3; ++c) {
        p[c] = (double)tracker->shell.rest[3 * (size_t)i + c];
        if (p[c] < f[1]->low[c] || p[c] > f[1]->high[c]) return PART_LEAD;
    }
    for (int k = 0; k < 2; ++k)
        sph__field_distance(f[k], p, distances + k, gradient);
    /* on the surface fields fall by 15/16 per radius */
    return fmin(PART_LEAD, 0.9375 * (distances[1] / f[1]->radius - distances[0] / f[0]->radius));
}

/* Onto the node's own side of the surface where both fields are equal, and a little away from it; false: not there. */
static bool part_from(const sph_tracker *tracker, sph__track *t, uint32_t i, double x[3], double wanted, int rounds)
{
    for (int round = 0; round <= rounds; ++round) {
        double own[3], other[3], slope[3], square, length, lead;
        lead = evaluate(tracker, t, t->low_bone[i], x, own) - evaluate(tracker, t, t->high_bone[i], x, other);
        if (lead >= wanted) return true;
        sph__subtract(own, other, slope);
        square = sph__dot(slope, slope);
        if (round == rounds || !(sqrt(square) * tracker->limit[i] > LEAST_SLOPE)) return lead >= fmin(wanted, 0);
        length = fmin((wanted - lead) / square, PART_LIMIT * tracker->limit[i] / sqrt(square));
        sph__add_scaled(x, length, slope, x);
    }
    return false;
}

static void part_node(const sph_tracker *tracker, sph__track *t, uint32_t i)
{
    double x[3], wanted;
    if (t->low_bone[i] == SPH__NO_PART || t->high_bone[i] == SPH__NO_PART) return;
    wanted = wanted_lead(tracker, i, t->low_bone[i], t->high_bone[i]);
    for (int start = 0; start < 2; ++start) { /* from where it is; else from where blending put it */
        for (int c = 0; c < 3; ++c)
            x[c] = start == 0 ? t->at[c][i] : t->base[c][i];
        if (!part_from(tracker, t, i, x, wanted, start == 0 ? PART_ROUNDS : PART_ROUNDS_FROM_BASE)) continue;
        for (int c = 0; c < 3; ++c)
            t->at[c][i] = x[c];
        return;
    }
}

/*
 * A node that has come to rest on another bone's surface has gone the wrong way around: past the middle of what it was
 * in. It belongs to the contact.
 */
static void claim(const sph_tracker *tracker, sph__track *t, uint32_t i)
{
    double x[3], gradient[3];
    uint32_t own, other;
    if ((t->state[i] != SPH__NODE_ARRIVED && t->state[i] != SPH__NODE_WALKS) || t->count[i] != 1) return;
    own = tracker->shell.parts[i]; /* only now: rows are longer than there are nodes */
    other = t->low_bone[i];
    if (own == other || own == SPH__NO_PART || other == SPH__NO_PART || other == tracker->rest_bone[i]) return;
    if (t->share[1][i] < LEAST_TRUST) return;
    if (sph__node_weight(tracker, i, other) < OWN_WEIGHT) {
        if (is_near_at_rest(tracker, i, other)) return;
    } else if (sph__trust_pair(tracker, t, i, own, other) < (double)LEAST_TRUST) {
        return;
    }
    for (int c = 0; c < 3; ++c)
        x[c] = t->at[c][i];
    if (evaluate(tracker, t, own, x, gradient) > evaluate(tracker, t, other, x, gradient) - FOREIGN_LEAD) return;
    t->low_bone[i] = own;
    t->high_bone[i] = other;
    t->state[i] = SPH__NODE_TOUCHES;
    for (int c = 0; c < 3; ++c)
        t->at[c][i] = t->base[c][i];
}

/* Those that are still between two points take the one that is their own. */
void sph__march_end(void *argument, size_t begin, size_t end)
{
    const sph__batch *b = argument;
    for (size_t item = begin; item < end; ++item) {
        sph__track *t = b->tracker->tracks + item / b->blocks;
        const size_t first = item % b->blocks * BLOCK;
        for (size_t i = first; i < first + BLOCK; ++i)
            if (t->state[i] == SPH__NODE_HALVES)
                settle(b->tracker, t, (uint32_t)i);
            else
                claim(b->tracker, t, (uint32_t)i);
    }
}

void sph__march_part(void *argument, size_t begin, size_t end)
{
    const sph__batch *b = argument;
    for (size_t item = begin; item < end; ++item) {
        sph__track *t = b->tracker->tracks + item / b->blocks;
        const size_t first = item % b->blocks * BLOCK;
        for (size_t i = first; i < first + BLOCK; ++i)
            if (t->state[i] == SPH__NODE_TOUCHES) part_node(b->tracker, t, (uint32_t)i);
    }
}
