/* SPDX-License-Identifier: MIT */
/* A rig, and what moves it: blending, or a tracker that corrects it. */
#ifndef POSING_H
#define POSING_H

#include "session.h"

/* How a rig is corrected. */
typedef struct correction {
    bool wanted, exact, unguarded, pairs;
    int operation;                    /* of all joints */
    const char *fields, *save_fields; /* files; NULL: none */
} correction;

typedef struct posing {
    sph_io_rig *rig;
    sph_io_rig_arrays parts;
    sph_skin_arrays skin;
    sph_deformer *deformer;
    sph_implicit *implicit; /* NULL: nothing is corrected */
    sph_tracker *tracker;
    sph_tracker_report *reports; /* [F] */
    int32_t method;
} posing;

/* The tracker of an open rig, and its fields. Releases nothing on failure: posing_close() does. */
sph_status posing_correct(session *s, posing *p, const correction *c);
/* One frame, corrected where there is a tracker. `normals` may be NULL. */
sph_status posing_frame(posing *p, uint32_t frame, float *positions, float *normals);
/* The same without the correction. */
sph_status posing_blend(posing *p, int32_t method, uint32_t frame, float *positions, float *normals);
/* All frames in one array, which sph_context_release() takes back; NULL: out of memory. */
float *posing_frames(session *s, posing *p, bool corrected, int32_t method, sph_status *status);
void posing_close(session *s, posing *p);

#endif
