/* SPDX-License-Identifier: MIT */
/* The clips of an animation: some of its frames each, under a name. */
#ifndef CLIPS_H
#define CLIPS_H

#include "session.h"

enum { CLIPS_MOST = 256 };

typedef struct clips {
    sph_animation *whole; /* borrowed */
    uint32_t count, frame_count;
    char *names;        /* of all, each ended by a zero */
    uint32_t *frames;   /* [frame_count]: which of the whole, clip after clip */
    sph_animation *all; /* just these; `whole` itself where they are all, in their order */
    sph_skin_source sources[CLIPS_MOST];
    struct clip_view *views; /* [count + 1] */
    bool every;              /* `all` is `whole` */
} clips;

/*
 * `text` is NAME=A:B,NAME=A:B:STEP,...; NULL: the clips of a glTF, if that is the input, else one of all frames. DONE,
 * or USAGE or FAILED after it has said why. Close it also then.
 */
int clips_open(session *s, const input_options *input, const arguments *paths, const char *text, sph_animation *whole,
               clips *out);
void clips_close(clips *c);

#endif
