/* SPDX-License-Identifier: MIT */
#include "progress.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "json.h"
#include "options.h"

/* Seconds between two updates, and before a time left is named. */
static const double BAR_PERIOD = 0.1, PLAIN_PERIOD = 2, ESTIMATE_AFTER = 1;
enum { BAR_WIDTH = 28 };

/* A signal handler can reach nothing else. */
static volatile sig_atomic_t interrupt_seen;

static void on_interrupt(int number)
{
    (void)number;
    interrupt_seen = 1;
}

void interrupt_catch(void)
{
    struct sigaction action = {.sa_handler = on_interrupt, .sa_flags = (int)SA_RESETHAND};
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
}

bool interrupted(void)
{
    return interrupt_seen != 0;
}

double seconds_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

void progress_init(progress *p, int mode, bool quiet)
{
    if (mode == PROGRESS_AUTO) mode = isatty(STDERR_FILENO) ? PROGRESS_BAR : PROGRESS_NONE;
    *p = (progress){.mode = quiet ? PROGRESS_NONE : mode, .task = ""};
}

void progress_start(progress *p, const char *task)
{
    p->task = task;
    p->started = seconds_now();
    p->shown = 0;
    p->stage[0] = '\0';
    p->decimation = -1;
}

void progress_clear(progress *p)
{
    if (p->bar_open) fputs("\r\033[K", stderr);
    p->bar_open = false;
}

double progress_end(progress *p)
{
    const double elapsed = seconds_now() - p->started;
    progress_clear(p);
    if (p->mode == PROGRESS_PLAIN && p->stage[0] != '\0') fprintf(stderr, "%s: %.1f s\n", p->task, elapsed);
    return elapsed;
}

/* "1:05 left" and the like; "" while there is too little to tell by. */
static const char *time_left(char text[32], double left)
{
    if (left < 0)
        text[0] = '\0';
    else if (left < 60)
        snprintf(text, 32, "%.0f s left", left < 1 ? 1 : left);
    else if (left < 3600)
        snprintf(text, 32, "%d:%02d min left", (int)left / 60, (int)left % 60);
    else
        snprintf(text, 32, "%d:%02d h left", (int)(left / 3600), (int)left / 60 % 60);
    return text;
}

static void show_bar(progress *p, double fraction, double left)
{
    char text[32], bar[BAR_WIDTH + 1];
    memset(bar, '.', BAR_WIDTH);
    memset(bar, '#', (size_t)(fraction * BAR_WIDTH));
    bar[BAR_WIDTH] = '\0';
    fprintf(stderr, "\r\033[K%.20s [%s] %3.0f %% %.12s  %s", p->task, bar, 100 * fraction, p->stage,
            time_left(text, left));
    p->bar_open = true;
}

static void show_plain(progress *p, double fraction, double left)
{
    char text[32];
    time_left(text, left);
    fprintf(stderr, "%s: %s, %.0f %%%s%s\n", p->task, p->stage, 100 * fraction, text[0] == '\0' ? "" : ", ", text);
}

static void show_json(progress *p, double fraction, double elapsed, double left)
{
    json j;
    json_start(&j, stderr, true);
    json_open(&j, NULL, '{');
    json_text(&j, "task", p->task);
    json_text(&j, "stage", p->stage);
    json_number(&j, "fraction", fraction);
    json_number(&j, "elapsed_s", elapsed);
    if (left < 0)
        json_null(&j, "remaining_s");
    else
        json_number(&j, "remaining_s", left);
    json_close(&j, '}');
    json_finish(&j);
}

/* Seconds left at the pace of the current stage, for the stages differ; below 0: too early to tell. */
static double time_to_go(const progress *p, double fraction, double now)
{
    const double spent = now - p->stage_started, made = fraction - p->stage_fraction;
    return now - p->started < ESTIMATE_AFTER || spent < ESTIMATE_AFTER / 2 || made < 0.005
               ? -1
               : spent * (1 - fraction) / made;
}

static void show(progress *p, double fraction, double now)
{
    const double elapsed = now - p->started;
    const double left = time_to_go(p, fraction, now);
    p->shown = now;
    if (p->mode == PROGRESS_BAR)
        show_bar(p, fraction, left);
    else if (p->mode == PROGRESS_PLAIN)
        show_plain(p, fraction, left);
    else
        show_json(p, fraction, elapsed, left);
    fflush(stderr);
}

bool progress_callback(void *user, const char *stage, double fraction)
{
    progress *p = user;
    const double now = seconds_now();
    const bool changed = strncmp(p->stage, stage, sizeof p->stage - 1) != 0;
    if (changed) {
        snprintf(p->stage, sizeof p->stage, "%s", stage);
        p->stage_started = now;
        p->stage_fraction = fraction;
        if (p->decimation < 0 && strcmp(stage, "decimation") == 0) p->decimation = now - p->started;
    }
    if (p->mode != PROGRESS_NONE && (now - p->shown >= (p->mode == PROGRESS_PLAIN ? PLAIN_PERIOD : BAR_PERIOD) ||
                                     (changed && p->mode != PROGRESS_BAR)))
        show(p, fraction, now);
    return !interrupted();
}
