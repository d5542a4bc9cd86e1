/* SPDX-License-Identifier: MIT */
/* The allocator whose large blocks lie in a file, and the thread that keeps them from filling memory. */
#define _GNU_SOURCE

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include "io/spill.h"

struct sph_io_spill {
    SPH__IO_MARK
    sph_context *context; /* borrowed */
    char *folder;
    size_t least_size;
    uint64_t limit;
    uint64_t high, low;   /* above `high` pages are taken away until there are `low` */
    int statm;            /* /proc/self/statm */
    pthread_mutex_t lock; /* of the arena and of `stop` */
    sph__io_arena arena;
    pthread_mutex_t trim_lock; /* of what follows */
    size_t hand;               /* of the clock: the byte of the arena to go on from */
    uint64_t trims;
    pthread_cond_t wake;
    pthread_t thread;
    bool started, stop;
};

/* Pages are taken away by parts of the file: this share of it, as what is resident may lie far apart, within bounds. */
enum { SHARE = 128, LEAST_PART = 1 << 20, MOST_PART = 32 << 20 };
/* Most bytes between the limit and where pages begin to be taken away; else that is at half of the limit. */
enum { MOST_ROOM = 256 << 20 };
/* Nanoseconds between two looks: near to the limit, and far from it. */
enum { NEAR_PERIOD = 500000, FAR_PERIOD = 4000000 };

enum { OPTIONS_V1 = offsetof(sph_io_spill_options, folder) + sizeof(const char *) };
_Static_assert(sizeof(void *) != 8 || OPTIONS_V1 == 32, "a field of 0.1 moved");

static const sph_io_spill_options DEFAULTS = {
    .struct_size = sizeof(sph_io_spill_options), .least_size = 65536, .folder = "/var/tmp"};

void sph_io_spill_options_init(sph_io_spill_options *options, size_t size)
{
    const uint32_t struct_size = (uint32_t)size;
    if (options == NULL || size < OPTIONS_V1 || size > UINT32_MAX) return;
    memset(options, 0, size); /* a newer caller's tail becomes 0 */
    memcpy(options, &DEFAULTS, size < sizeof DEFAULTS ? size : sizeof DEFAULTS);
    options->folder = NULL;
    memcpy(options, &struct_size, sizeof struct_size);
}

static sph_status read_options(sph_context *context, const sph_io_spill_options *in, sph_io_spill_options *o)
{
    *o = DEFAULTS;
    if (in->struct_size < OPTIONS_V1)
        return sph__io_fail(context, SPH_E_INVALID,
                            "sph_io_spill_options was not initialised: struct_size is %u, at least %d is needed",
                            (unsigned)in->struct_size, OPTIONS_V1);
    for (size_t i = sizeof *o; i < in->struct_size; ++i)
        if (((const unsigned char *)in)[i] != 0)
            return sph__io_fail(context, SPH_E_VERSION,
                                "sph_io_spill_options has a field set (byte %zu) that this version does not know", i);
    memcpy(o, in, in->struct_size < sizeof *o ? in->struct_size : sizeof *o);
    if (o->flags != 0 || o->least_size == 0)
        return sph__io_fail(context, SPH_E_INVALID, "sph_io_spill_options: flags are set, or least_size is 0");
    if (o->memory_limit < SPH_IO_SPILL_LEAST)
        return sph__io_fail(context, SPH_E_INVALID, "a memory limit of %llu bytes: at least %llu are needed",
                            (unsigned long long)o->memory_limit, (unsigned long long)SPH_IO_SPILL_LEAST);
    if (o->folder == NULL) o->folder = DEFAULTS.folder;
    return SPH_OK;
}

/* Bytes of the process that are resident; 0 where it cannot be told. */
static uint64_t resident(const sph_io_spill *s)
{
    char text[128];
    const ssize_t length = pread(s->statm, text, sizeof text - 1, 0);
    const char *second;
    if (length <= 0) return 0;
    text[length] = '\0';
    second = strchr(text, ' ');
    return second == NULL ? 0 : strtoull(second, NULL, 10) * s->arena.page;
}

/* Takes pages away, once around at most. Others may be using them: what is in them stays in the file. */
static void turn_clock(sph_io_spill *s, size_t size)
{
    size_t part = size / SHARE / LEAST_PART * LEAST_PART;
    if (part < LEAST_PART) part = LEAST_PART;
    if (part > MOST_PART) part = MOST_PART;
    ++s->trims;
    for (size_t turned = 0; turned < size; turned += part) {
        const size_t begin = s->hand < size ? s->hand : 0, end = size - begin < part ? size : begin + part;
        (void)madvise(s->arena.base + begin, end - begin, MADV_DONTNEED);
        s->hand = end;
        if (resident(s) <= s->low) return;
    }
}

/* Whether the process is nearer to the limit than to nothing. */
static bool trim(sph_io_spill *s)
{
    const uint64_t now = resident(s);
    size_t size;
    if (now <= s->high) return now > s->low / 2;
    pthread_mutex_lock(&s->trim_lock); /* where another is at it: who waits touches nothing meanwhile */
    if (resident(s) <= s->high) {
        pthread_mutex_unlock(&s->trim_lock);
        return true;
    }
    pthread_mutex_lock(&s->lock);
    size = s->arena.size;
    pthread_mutex_unlock(&s->lock);
    turn_clock(s, size);
    pthread_mutex_unlock(&s->trim_lock);
    return true;
}

static void *watch(void *argument)
{
    sph_io_spill *s = argument;
    pthread_mutex_lock(&s->lock);
    while (!s->stop) {
        struct timespec until;
        bool near;
        pthread_mutex_unlock(&s->lock);
        near = trim(s);
        clock_gettime(CLOCK_MONOTONIC, &until);
        until.tv_nsec += near ? NEAR_PERIOD : FAR_PERIOD;
        if (until.tv_nsec >= 1000000000) {
            until.tv_nsec -= 1000000000;
            ++until.tv_sec;
        }
        pthread_mutex_lock(&s->lock);
        if (!s->stop) (void)pthread_cond_timedwait(&s->wake, &s->lock, &until);
    }
    pthread_mutex_unlock(&s->lock);
    return NULL;
}

/* Signals are for the host's threads. */
static sph_status start_watch(sph_io_spill *s)
{
    sigset_t all, before;
    int error;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    error = pthread_create(&s->thread, NULL, watch, s);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    s->started = error == 0;
    return s->started ? SPH_OK
                      : sph__io_fail(s->context, SPH_E_NOMEM, "a memory limit needs a thread, and none starts");
}

static sph_status make_locks(sph_io_spill *s)
{
    pthread_condattr_t attributes;
    bool made = pthread_mutex_init(&s->lock, NULL) == 0 && pthread_mutex_init(&s->trim_lock, NULL) == 0 &&
                pthread_condattr_init(&attributes) == 0;
    if (!made) return sph_context_fail(s->context, SPH_E_NOMEM, "out of memory");
    made =
        pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC) == 0 && pthread_cond_init(&s->wake, &attributes) == 0;
    pthread_condattr_destroy(&attributes);
    return made ? SPH_OK : sph_context_fail(s->context, SPH_E_NOMEM, "out of memory");
}

/* Far enough below the limit for what is touched between two looks. */
static void set_marks(sph_io_spill *s, uint64_t limit)
{
    const uint64_t room = limit / 2 < MOST_ROOM ? limit / 2 : MOST_ROOM;
    s->limit = limit;
    s->high = limit - room;
    s->low = s->high - s->high / 4;
}

static sph_status start(sph_io_spill *s, const sph_io_spill_options *o)
{
    sph_status status;
    s->least_size = o->least_size < SIZE_MAX ? (size_t)o->least_size : SIZE_MAX;
    set_marks(s, o->memory_limit);
    s->folder = sph__io_copy_string(s->context, o->folder);
    if (s->folder == NULL) return sph_context_fail(s->context, SPH_E_NOMEM, "out of memory");
    s->statm = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
    status = sph__io_arena_open(s->context, s->folder, &s->arena);
    if (status != SPH_OK) return status;
    if (s->statm < 0 || resident(s) == 0)
        return sph_context_fail(s->context, SPH_E_UNSUPPORTED,
                                "a memory limit needs /proc/self/statm, which cannot be read here");
    return start_watch(s);
}

sph_status sph_io_spill_create(sph_context *context, const sph_io_spill_options *options, sph_io_spill **out)
{
    SPH__IO_OWN(context, sph_context_memory_used);
    sph_io_spill_options o;
    sph_io_spill *s;
    sph_status status;
    if (out != NULL) *out = NULL;
    if (context == NULL || options == NULL || out == NULL)
        return sph_context_fail(context, SPH_E_INVALID, "sph_io_spill_create: an argument is NULL");
    if ((status = read_options(context, options, &o)) != SPH_OK) return status;
    s = sph_context_allocate(context, 1, sizeof *s);
    if (s == NULL) return sph_context_fail(context, SPH_E_NOMEM, "out of memory");
    memset(s, 0, sizeof *s);
    s->context = context;
    SPH__IO_SET_MARK(s, SPH__IO_SPILL);
    s->statm = -1;
    if ((status = make_locks(s)) != SPH_OK) {
        sph_context_release(context, s);
        return status;
    }
    if ((status = start(s, &o)) != SPH_OK) {
        sph_io_spill_destroy(s);
        return status;
    }
    *out = s;
    return SPH_OK;
}

void sph_io_spill_destroy(sph_io_spill *s)
{
    SPH__IO_OWN_MARKED(s, SPH__IO_SPILL);
    sph_context *context;
    if (s == NULL) return;
    context = s->context;
    if (s->started) {
        pthread_mutex_lock(&s->lock);
        s->stop = true;
        pthread_cond_signal(&s->wake);
        pthread_mutex_unlock(&s->lock);
        pthread_join(s->thread, NULL);
    }
    sph__io_arena_close(&s->arena);
    if (s->statm >= 0) close(s->statm);
    pthread_cond_destroy(&s->wake);
    pthread_mutex_destroy(&s->trim_lock);
    pthread_mutex_destroy(&s->lock);
    sph_context_release(context, s->folder);
    SPH__IO_SET_MARK(s, SPH__IO_DESTROYED);
    sph_context_release(context, s);
}

static void *spill_allocate(void *user, size_t size, size_t alignment)
{
    sph_io_spill *s = user;
    void *memory;
    (void)alignment; /* both kinds are aligned to 64 bytes */
    if (size < s->least_size) return sph_context_allocate(s->context, 1, size);
    trim(s);
    pthread_mutex_lock(&s->lock);
    memory = sph__io_arena_take(&s->arena, size);
    pthread_mutex_unlock(&s->lock);
    return memory;
}

static void spill_release(void *user, void *memory, size_t size)
{
    sph_io_spill *s = user;
    if (!sph__io_arena_has(&s->arena, memory)) {
        sph_context_release(s->context, memory);
        return;
    }
    pthread_mutex_lock(&s->lock);
    sph__io_arena_give(&s->arena, memory, size);
    pthread_mutex_unlock(&s->lock);
}

void sph_io_spill_get_allocator(sph_io_spill *s, sph_allocator *allocator)
{
    SPH__IO_OWN_MARKED(s, SPH__IO_SPILL);
    if (allocator == NULL) return;
    *allocator = s == NULL ? (sph_allocator){NULL, NULL, NULL} : (sph_allocator){s, spill_allocate, spill_release};
}

/* A parallel loop that looks at memory after each block. */
typedef struct loop {
    sph_io_spill *spill;
    sph_range_fn *body;
    void *argument;
} loop;

static void run_block(void *user, size_t begin, size_t end)
{
    const loop *l = user;
    l->body(l->argument, begin, end);
    trim(l->spill);
}

static void spill_parallel_for(void *user, size_t count, size_t grain, sph_range_fn *body, void *argument)
{
    sph_io_spill *s = user;
    loop l = {s, body, argument};
    sph_context_parallel_for(s->context, count, grain, run_block, &l);
}

void sph_io_spill_get_executor(sph_io_spill *s, sph_executor *executor)
{
    SPH__IO_OWN_MARKED(s, SPH__IO_SPILL);
    if (executor == NULL) return;
    *executor = s == NULL ? (sph_executor){NULL, NULL} : (sph_executor){s, spill_parallel_for};
}

void sph_io_spill_trim(sph_io_spill *s)
{
    SPH__IO_OWN_MARKED(s, SPH__IO_SPILL);
    if (s != NULL) trim(s);
}

sph_status sph_io_spill_get_figures(sph_io_spill *s, sph_io_spill_figures *figures)
{
    SPH__IO_OWN_MARKED(s, SPH__IO_SPILL);
    if (s == NULL || figures == NULL)
        return sph_context_fail(s == NULL ? NULL : s->context, SPH_E_INVALID,
                                "sph_io_spill_get_figures: an argument is NULL");
    if (figures->struct_size != sizeof *figures)
        return sph__io_fail(s->context, SPH_E_INVALID, "sph_io_spill_figures: struct_size is %u, not %zu",
                            (unsigned)figures->struct_size, sizeof *figures);
    *figures = (sph_io_spill_figures){.struct_size = sizeof *figures, .resident_bytes = resident(s)};
    pthread_mutex_lock(&s->lock);
    figures->live_bytes = s->arena.live;
    figures->peak_live_bytes = s->arena.peak;
    figures->file_bytes = s->arena.size;
    pthread_mutex_unlock(&s->lock);
    pthread_mutex_lock(&s->trim_lock);
    figures->trims = s->trims;
    pthread_mutex_unlock(&s->trim_lock);
    return SPH_OK;
}
