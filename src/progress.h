/* SPDX-License-Identifier: MIT */
/* Progress on stderr, the times of the stages, and Ctrl-C. */
#ifndef PROGRESS_H
#define PROGRESS_H

#include <stdbool.h>

typedef struct progress {
    int mode;         /* PROGRESS_BAR, _PLAIN, _JSON or _NONE */
    const char *task; /* what the program is doing; the library's stages are parts of it */
    double started, shown;
    char stage[32];
    double stage_started, stage_fraction;
    double decimation; /* seconds from the start until decimation was first reported; below 0: not yet */
    bool bar_open;     /* a bar stands on the current line */
} progress;

double seconds_now(void);

/* From now on Ctrl-C and SIGTERM make progress_callback() ask the library to stop; the second one ends the program. */
void interrupt_catch(void);
bool interrupted(void);

void progress_init(progress *p, int mode, bool quiet);
/* Around each library call that may take long. */
void progress_start(progress *p, const char *task);
/* Returns the seconds since the start. */
double progress_end(progress *p);
/* Takes the bar off the screen, so that something else can be printed. */
void progress_clear(progress *p);
/* The library's callback; `user` is the progress. */
bool progress_callback(void *user, const char *stage, double fraction);

#endif
